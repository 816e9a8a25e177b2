//! `armgen run`: experiments on the arm of a description, which is executed without a compilation.

use std::path::{Path, PathBuf};

use armgen_codegen::derive::Model;
use armgen_codegen::kinds::Scalar;

use super::verify::with_spinner;
use crate::{input, terminal, FAULTY};

pub(crate) fn run(robot: &Path, files: &[PathBuf], out: &Path) -> u8 {
    let made = input::description(robot).and_then(|source| {
        let (manipulator, _) = input::manipulator(&source, Scalar::F64, input::Warnings::Counted)?;
        Ok((source, Model::new(manipulator)))
    });
    let (source, model) = match made {
        Ok(made) => made,
        Err(code) => return code,
    };
    match with_spinner("deriving", || armgen_run::any_arm(&model)) {
        Ok(arm) => armgen_run::run(files, out, arm.as_ref(), &source),
        Err(reason) => {
            terminal::error(&format!("{}: {reason}", source.name()));
            FAULTY
        }
    }
}
