//! What the program writes about an arm, as texts: for the program, the package of Python and the playground. It opens no file and prints nothing.
//!
//! ```text
//! summary.rs  the summary of `armgen check`, in summary/ its tables
//! json.rs     diagnostics for programs
//! shown.rs    equations by name
//! module.rs   the files of a module
//! rows.rs     inverse kinematics of the rows in another convention
//! ```

pub mod json;
pub mod module;
pub mod rows;
pub mod shown;
pub mod summary;

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};

/// The arm of a description without errors, and all diagnostics.
pub fn judged(source: &Source) -> (Option<Manipulator>, Diagnostics) {
    let (valid, mut diagnostics) = validate::read_for(source, Scalar::F64);
    let Some((manipulator, places)) = valid else { return (None, diagnostics) };
    let model = Model::new(manipulator);
    // Only the programs show whether products of valid numbers still fit the scalar.
    match armgen_codegen::programs(&model, &places, &Options::default()) {
        Ok(_) => (Some(model.manipulator), diagnostics),
        Err(fault) => {
            let mut faults = Diagnostics::new();
            faults.push(*fault);
            diagnostics.extend(faults);
            (None, diagnostics)
        }
    }
}
