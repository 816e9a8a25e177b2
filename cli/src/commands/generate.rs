//! `armgen generate`: the module as a file or on standard output.

use std::path::Path;

use armgen_codegen::emit::rust::{print, Origin};
use armgen_codegen::manipulator::Scalar;
use armgen_codegen::program::{Options, Trig};
use armgen_codegen::Model;

use crate::{input, terminal, ScalarName, TrigName, DONE, FAULTY};

pub(crate) fn run(file: &Path, out: Option<&Path>, scalar: ScalarName, trig: TrigName, batch: Option<u16>) -> u8 {
    let scalar = match scalar {
        ScalarName::F64 => Scalar::F64,
        ScalarName::F32 => Scalar::F32,
    };
    let trig = match trig {
        TrigName::Libm => Trig::Libm,
        TrigName::Std => Trig::Std,
        TrigName::Fast => Trig::Fast,
    };
    let source = match input::source(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    let manipulator = match input::manipulator(&source, scalar, input::Warnings::Counted) {
        Ok((manipulator, _)) => manipulator,
        Err(code) => return code,
    };
    let text =
        print(&Model::new(manipulator).module(&Options { scalar, trig, batch: batch.map(usize::from) }), &Origin::of(&source));
    let Some(out) = out else { return terminal::print(&text) };
    match std::fs::write(out, text) {
        Ok(()) => DONE,
        Err(error) => {
            terminal::error(&format!("cannot write {}: {error}", out.display()));
            FAULTY
        }
    }
}
