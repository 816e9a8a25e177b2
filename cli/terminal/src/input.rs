//! Texts from files; why a file cannot be read goes to standard error.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use armgen_description::source::Source;

use crate::UNREADABLE;

/// The longest file that is read, in bytes.
pub const LONGEST: usize = 32 << 20;

/// What is said of a file that is too long, but for a log.
pub const OTHERS_ARE_SHORT: &str = "no file that armgen reads or writes is";

/// The text of a file, or the exit code after a message with the reason.
pub fn source(path: &Path) -> Result<Source, u8> {
    Ok(Source::new(path.display().to_string(), text(path, OTHERS_ARE_SHORT)?))
}

/// The text of a file as it is; why it cannot be had goes to standard error, and what is said of one that is too long.
pub fn text(path: &Path, of_long: &str) -> Result<String, u8> {
    let name = path.display().to_string();
    let mut bytes = Vec::new();
    // Never more than that, whatever the file is: a device may have no end.
    let read = File::open(path).and_then(|file| file.take(LONGEST as u64 + 1).read_to_end(&mut bytes));
    read.map_err(|error| {
        crate::error(&format!("cannot read {name}: {error}"));
        UNREADABLE
    })?;
    if bytes.len() > LONGEST {
        crate::error(&format!("{name} is longer than {} MiB: {of_long}", LONGEST >> 20));
        return Err(UNREADABLE);
    }
    decoded(bytes).map_err(|fault| {
        crate::error(&format!("{name} {fault}"));
        UNREADABLE
    })
}

/// Bytes as a text, or what they are that are none.
pub fn decoded(bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..valid].iter().filter(|&&b| b == b'\n').count() + 1;
        format!("is not UTF-8: line {line} holds a byte that belongs to no character; save it as UTF-8")
    })
}

/// `1 error`, `2 errors`.
pub fn counted(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}
