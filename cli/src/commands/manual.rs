//! `armgen manual`: pages of `man` from the same definitions as `--help`.

use std::io;
use std::path::Path;

use clap::CommandFactory;
use clap_mangen::Man;

use crate::{output, terminal, Arguments, DONE, UNREADABLE};

/// Writes `armgen.1` and a page for each command; the exit code.
pub(crate) fn run(folder: &Path) -> u8 {
    match pages() {
        Err(error) => {
            terminal::error(&format!("the manual cannot be written: {error}"));
            UNREADABLE
        }
        Ok(pages) => {
            for (name, text) in pages {
                let path = folder.join(name);
                if let Err(error) = output::write(&path, &text) {
                    terminal::error(&format!("cannot write {}: {error}", path.display()));
                    return UNREADABLE;
                }
            }
            DONE
        }
    }
}

/// Names and texts, without the commands that `--help` hides.
fn pages() -> io::Result<Vec<(String, String)>> {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let commands = program.get_subcommands().filter(|command| !command.is_hide_set());
    std::iter::once(&program)
        .chain(commands)
        .map(|command| {
            let man = Man::new(command.clone()).source(concat!("armgen ", env!("CARGO_PKG_VERSION")));
            let mut text = Vec::new();
            man.render(&mut text)?;
            Ok((man.get_filename(), String::from_utf8_lossy(&text).into_owned()))
        })
        .collect()
}
