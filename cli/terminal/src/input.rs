//! Texts from files, with messages on standard error about unreadable files.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use armgen_description::source::Source;

use crate::UNREADABLE;

/// The maximum file length, in bytes.
pub const LONGEST: usize = 32 << 20;

/// The end of the message about a file that is too long, except for a log.
pub const OTHERS_ARE_SHORT: &str = "no file that armgen reads or writes is";

/// The text of a file; after a message, the exit code.
pub fn source(path: &Path) -> Result<Source, u8> {
    Ok(Source::new(path.display().to_string(), text(path, OTHERS_ARE_SHORT)?))
}

/// The text of a file. Reports a failure on standard error; `of_long` ends the message about a file that is too long.
pub fn text(path: &Path, of_long: &str) -> Result<String, u8> {
    let name = path.display().to_string();
    let mut bytes = Vec::new();
    // Read no more than this, because a device may be endless.
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

/// Decodes UTF-8; the error describes the first invalid line.
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
