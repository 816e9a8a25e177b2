//! `armgen page`: one HTML file with the arm, its table, its equations and its numbers.

use std::path::Path;

use super::generate::{same_file, write};
use super::verify::with_spinner;
use crate::{input, terminal, DONE, UNREADABLE};

pub(crate) fn run(file: &Path, out: &Path) -> u8 {
    let source = match input::source(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    let (page, diagnostics) = with_spinner("deriving", || armgen_page::page(&source));
    let page = match input::report_or_exit_code(&source, page, &diagnostics, input::Warnings::Counted) {
        Ok(page) => page,
        Err(code) => return code,
    };
    if same_file(file, out) {
        terminal::error(&format!("{} is the description: it would be overwritten; name another file", out.display()));
        return UNREADABLE;
    }
    if let Err(error) = write(out, &page) {
        terminal::error(&format!("cannot write {}: {error}", out.display()));
        return UNREADABLE;
    }
    DONE
}
