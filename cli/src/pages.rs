//! The pages of documentation: their commands are accepted, and their links lead somewhere.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::Parser;

use crate::Arguments;

/// All pages: their paths from the root, and their texts.
fn pages() -> BTreeMap<PathBuf, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the repository");
    let folders = ["", "docs", "docs/start", "python", "benches", "benches/peers", "inverse-kinematics"];
    let files = folders.iter().flat_map(|folder| fs::read_dir(root.join(folder)).expect("a folder").flatten());
    let pages = files.map(|file| file.path()).filter(|path| path.extension().is_some_and(|e| e == "md"));
    pages.map(|path| (path.clone(), fs::read_to_string(&path).expect("a page"))).collect()
}

/// Lines of a page with their numbers, and whether they belong to a block of code.
fn lines(page: &str) -> impl Iterator<Item = (usize, &str, bool)> {
    let mut inside = false;
    page.lines().enumerate().map(move |(i, line)| {
        let fence = line.trim_start().starts_with("```");
        inside ^= fence;
        (i + 1, line, inside || fence)
    })
}

/// The words of a command, quotes as in a shell, up to a comment or another command.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut word, mut quote): (Vec<String>, Option<String>, Option<char>) = (Vec::new(), None, None);
    for c in command.chars() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (None, '\'' | '"') => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (None, '#' | '|' | '>' | ';' | '&') if word.is_none() => break,
            (None, ' ') => words.extend(word.take()),
            (_, c) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

/// The commands of the program: whole ones in blocks of code, and those named in a line.
fn commands(page: &str) -> Vec<(usize, String, bool)> {
    let mut commands = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (number, line, is_code) in lines(page) {
        if !is_code {
            let named = line.split('`').skip(1).step_by(2).filter(|text| text.starts_with("armgen "));
            commands.extend(named.map(|text| (number, text.to_owned(), false)));
            continue;
        }
        let (number, text) = match open.take() {
            Some((number, text)) => (number, format!("{text} {}", line.trim())),
            None => match line.trim_start_matches("$ ") {
                text if text.starts_with("armgen ") => (number, text.to_owned()),
                text => match text.split_once("-p armgen -- ") {
                    Some((before, after)) if before.starts_with("cargo run") => (number, format!("armgen {after}")),
                    _ => continue,
                },
            },
        };
        match text.strip_suffix('\\') {
            Some(text) => open = Some((number, text.to_owned())),
            None => commands.push((number, text, true)),
        }
    }
    commands
}

#[test]
fn commands_are_accepted() {
    let (mut count, mut refused) = (0, Vec::new());
    for (path, page) in pages() {
        for (number, command, is_whole) in commands(&page) {
            // Experiments are simulated by another program.
            let words = words(&command);
            if words.get(1).is_some_and(|word| word == "run") {
                continue;
            }
            count += 1;
            if let Err(error) = Arguments::try_parse_from(&words) {
                // A command that is named, without its arguments or with placeholders.
                let is_named = !is_whole && error.kind() != ErrorKind::UnknownArgument;
                if error.use_stderr() && !is_named {
                    refused.push(format!("{}:{number}: {command}\n{error}", path.display()));
                }
            }
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
    assert!(count > 100, "{count} commands");
}

/// The anchor of a heading.
fn anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    text.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn links_lead_somewhere() {
    let pages = pages();
    let anchors = |page: &str| -> Vec<String> {
        lines(page).filter(|(_, line, is_code)| !is_code && line.starts_with('#')).map(|(_, line, _)| anchor(line)).collect()
    };
    let (mut count, mut lost) = (0, Vec::new());
    for (path, page) in &pages {
        for (number, line, is_code) in lines(page) {
            for link in line.split("](").skip(1).filter(|_| !is_code).filter_map(|rest| rest.split(')').next()) {
                if link.starts_with("http") {
                    continue;
                }
                count += 1;
                let (file, to) = link.split_once('#').unwrap_or((link, ""));
                let target = if file.is_empty() { path.clone() } else { path.with_file_name("").join(file) };
                let found = target.canonicalize().is_ok_and(|target| {
                    to.is_empty() || pages.get(&target).is_some_and(|page| anchors(page).iter().any(|anchor| anchor == to))
                });
                if !found {
                    lost.push(format!("{}:{number}: {link}", path.display()));
                }
            }
        }
    }
    assert!(lost.is_empty(), "{}", lost.join("\n"));
    assert!(count > 100, "{count} links");
}
