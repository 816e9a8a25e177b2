//! The rows of Denavit and Hartenberg of a description in another convention.

use armgen_codegen::description::Convention;
use armgen_codegen::inverse_kinematics::{InverseKinematics, Solved};
use armgen_codegen::source::Source;
use armgen_codegen::validate;

/// How the rows of a description are solved for the joints of an end effector, where the description itself gives no construction: the rows
/// may be rounded.
pub fn solved(source: &Source, tip: Option<&str>) -> Option<InverseKinematics> {
    let (converted, _) = armgen_import::convert(source, Convention::Standard);
    let rows = Source::new("rows.yaml", converted?.yaml);
    let (manipulator, _) = validate::read(&rows).0?;
    Solved::all(&manipulator).into_iter().find(|solved| solved.tip.as_deref() == tip)?.found.ok()
}
