//! `armgen generate`: the module as a file or on standard output.

use std::path::Path;

use armgen_codegen::emit::rust::{print, Origin};
use armgen_codegen::manipulator::Scalar;
use armgen_codegen::program::Options;
use armgen_codegen::Model;

use crate::{input, terminal, ScalarName, DONE, FAULTY};

pub(crate) fn run(file: &Path, out: Option<&Path>, scalar: ScalarName) -> u8 {
    let scalar = match scalar {
        ScalarName::F64 => Scalar::F64,
        ScalarName::F32 => Scalar::F32,
    };
    let source = match input::source(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    let manipulator = match input::manipulator(&source, scalar, input::Warnings::Counted) {
        Ok((manipulator, _)) => manipulator,
        Err(code) => return code,
    };
    let text = print(&Model::new(manipulator).module(&Options { scalar }), &Origin::of(&source));
    let Some(out) = out else { return terminal::print(&text) };
    match std::fs::write(out, text) {
        Ok(()) => DONE,
        Err(error) => {
            terminal::error(&format!("cannot write {}: {error}", out.display()));
            FAULTY
        }
    }
}
