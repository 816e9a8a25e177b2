//! Output files of commands.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::{DONE, UNREADABLE};

/// Writes `text` to a file that differs from all input files (each with its description); returns the exit code.
pub fn write_other<'f>(read: impl IntoIterator<Item = (&'f Path, &'f str)>, out: &Path, text: &str) -> u8 {
    if let Some((_, what)) = read.into_iter().find(|(file, _)| same_file(file, out)) {
        crate::error(&format!("{} is {what}: it would be overwritten; name another file", out.display()));
        return UNREADABLE;
    }
    if let Err(error) = write(out, text) {
        crate::error(&format!("cannot write {}: {error}", out.display()));
        return UNREADABLE;
    }
    DONE
}

/// Whether two paths lead to the same file, which need not exist.
pub fn same_file(a: &Path, b: &Path) -> bool {
    place(a) == place(b)
}

/// The location of a path, equal for all paths of a file, which need not exist.
pub fn place(path: &Path) -> PathBuf {
    if let Ok(place) = path.canonicalize() {
        return place;
    }
    match (path.parent(), path.file_name()) {
        (Some(folder), Some(name)) if folder == Path::new("") => place(Path::new(".")).join(name),
        (Some(folder), Some(name)) => place(folder).join(name),
        _ => path.to_path_buf(),
    }
}

/// Writes to a temporary file, then renames it, so that no reader finds a partial file. Creates a missing folder.
pub fn write(path: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    // A rename would turn a device or a link into a plain file.
    if path.symlink_metadata().is_ok_and(|found| !found.is_file()) {
        return std::fs::write(path, text);
    }
    let (beside, mut file) = new_beside(path)?;
    let written = file.write_all(text.as_bytes());
    drop(file);
    let written = written.and_then(|()| std::fs::rename(&beside, path));
    if written.is_err() {
        let _ = std::fs::remove_file(&beside);
    }
    written
}

/// A new file in the folder of another.
fn new_beside(path: &Path) -> std::io::Result<(PathBuf, File)> {
    let mut number = 0;
    loop {
        let mut name = path.file_name().unwrap_or_default().to_os_string();
        name.push(if number == 0 { ".new".to_owned() } else { format!(".new{number}") });
        let beside = path.with_file_name(name);
        match OpenOptions::new().write(true).create_new(true).open(&beside) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
            opened => return Ok((beside, opened?)),
        }
    }
}
