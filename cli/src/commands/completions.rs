//! `armgen completions`: the script by which a shell completes the arguments.

use clap::CommandFactory;

use crate::{terminal, Arguments};

pub(crate) fn run(shell: clap_complete::Shell) -> u8 {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "armgen", &mut text);
    terminal::print(&String::from_utf8_lossy(&text))
}
