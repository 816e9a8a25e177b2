//! Files that commands write.

use std::path::Path;

use crate::{terminal, DONE, UNREADABLE};

/// Writes what was made from a description into another file; the exit code.
pub(crate) fn write_other(description: &Path, out: &Path, text: &str) -> u8 {
    if same_file(description, out) {
        terminal::error(&format!("{} is the description: it would be overwritten; name another file", out.display()));
        return UNREADABLE;
    }
    if let Err(error) = write(out, text) {
        terminal::error(&format!("cannot write {}: {error}", out.display()));
        return UNREADABLE;
    }
    DONE
}

/// Whether two paths lead to one file, whatever they are called.
pub(crate) fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Writes beside the file first and then renames: nobody ever finds half of it. A folder that is not there is made.
pub(crate) fn write(path: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    // A rename would turn a device or a link into a plain file.
    if path.symlink_metadata().is_ok_and(|found| !found.is_file()) {
        return std::fs::write(path, text);
    }
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    let beside = path.with_file_name(name);
    let written = std::fs::write(&beside, text).and_then(|()| std::fs::rename(&beside, path));
    if written.is_err() {
        let _ = std::fs::remove_file(&beside);
    }
    written
}
