//! Shared parts of the armgen programs: exit codes, standard output and error, aligned tables, files.
//!
//! Only terminals get colours. A reader may close the pipe early.

pub mod input;
pub mod number;
pub mod output;
pub mod table;

use std::io::{ErrorKind, IsTerminal, Write};

use armgen_description::diagnostic::Colour;

/// Exit code: the file is valid, or the task was done.
pub const DONE: u8 = 0;
/// Exit code: the content of a file is faulty, or a result is not as expected.
pub const FAULTY: u8 = 1;
/// Exit code: a file cannot be read or written or is not UTF-8, or options conflict.
pub const UNREADABLE: u8 = 2;

/// Whether a stream supports colours: a terminal that is not dumb, unless NO_COLOR is set.
pub fn colour(stream: &impl IsTerminal) -> Colour {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    if stream.is_terminal() && !refused && !dumb {
        Colour::Always
    } else {
        Colour::Never
    }
}

/// Line width if standard output is no terminal, in characters.
const LINE: usize = 100;
/// Minimum line width.
const SHORTEST_LINE: usize = 60;

/// Line width on standard output: the terminal's width, at most 100 characters.
pub fn width() -> usize {
    let of_terminal =
        terminal_size::terminal_size().filter(|_| std::io::stdout().is_terminal()).map(|(width, _)| usize::from(width.0));
    of_terminal.map_or(LINE, |width| width.clamp(SHORTEST_LINE, LINE))
}

/// Bold text, if the stream supports colours.
pub fn bold(text: &str, stream: &impl IsTerminal) -> String {
    match colour(stream) {
        Colour::Always => format!("\u{1b}[1m{text}\u{1b}[0m"),
        Colour::Never => text.to_string(),
    }
}

/// Writes to standard output and returns the exit code: a closed pipe is no error, a full disk is an error.
pub fn print(text: &str) -> u8 {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => DONE,
        Err(error) if error.kind() == ErrorKind::BrokenPipe => DONE,
        Err(reason) => {
            error(&format!("cannot write to standard output: {reason}"));
            UNREADABLE
        }
    }
}

/// Writes to standard error; a failure of it has no other channel for a report.
pub fn diagnose(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// `error: ...` on standard error.
pub fn error(message: &str) {
    labelled("error", "31", message);
}

/// `warning: ...` on standard error.
pub fn warning(message: &str) {
    labelled("warning", "33", message);
}

/// `note: ...` on standard error.
pub fn note(message: &str) {
    labelled("note", "32", message);
}

fn labelled(label: &str, code: &str, message: &str) {
    let label = match colour(&std::io::stderr()) {
        Colour::Always => format!("\u{1b}[1;{code}m{label}\u{1b}[0m"),
        Colour::Never => label.to_string(),
    };
    diagnose(&format!("{label}: {message}\n"));
}
