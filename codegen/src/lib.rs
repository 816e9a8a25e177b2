//! From the description of a robot arm to its equations of motion, and from these to plain `no_std` Rust.
//!
//! The stages, in order; each type says what can no longer occur after it:
//!
//! | stage | from | to | can fail |
//! |---|---|---|---|
//! | parse | [`source::Source`] | [`description::RobotDescription`] | yes |
//! | validate | `RobotDescription` | [`manipulator::Manipulator`] | yes |
//! | derive | `Manipulator` | [`derive::Derivation`] of each [`catalogue::Quantity`] | no |
//! | schedule | derivations, [`schedule::Options`] | [`program::Module`] | no |
//! | emit | `Module` | text | no |
//!
//! Text goes in, text comes out; only [`build_script`] touches files and environment.

pub mod build_script;
pub mod catalogue;
pub mod derive;
pub mod description;
pub mod diagnostic;
pub mod document;
pub mod emit;
pub mod exact;
pub mod kinds;
pub mod manipulator;
pub mod pass;
pub mod program;
pub mod ring;
pub mod schedule;
mod scramble;
pub mod show;
pub mod source;
pub mod suggest;
pub mod validate;

use std::collections::BTreeMap;

use catalogue::Absent;
pub use derive::Model;
use diagnostic::Diagnostics;
use emit::c::CFace;
use emit::{Notes, Origin};
use exact::Number;
use program::Module;
use schedule::Options;
use source::Source;

/// The text of an emitted module and of the trait implementation that goes with it.
#[derive(Clone, Debug)]
pub struct Generated {
    /// The module: free functions over arrays.
    pub module: String,
    /// The implementation of the runtime's traits for it.
    pub runtime: String,
    /// The face for C: a header, and wrappers to stand beside the module.
    pub c: CFace,
    /// The exact constants behind the literals of the module, by function.
    pub constants: BTreeMap<String, Vec<Number>>,
    /// Functions that this arm does not have.
    pub absent: Vec<Absent>,
    /// What the texts print.
    program: Module,
    origin: Origin,
}

impl Generated {
    /// Prints the module again, with notes in its documentation.
    pub fn annotate(&mut self, notes: &Notes) {
        self.module = emit::rust::print(&self.program, &self.origin, notes);
    }
}

/// From text to text: the module if the description is valid, and all there is to say about the description.
pub fn generate(source: &Source, options: &Options) -> (Option<Generated>, Diagnostics) {
    let (valid, mut diagnostics) = validate::read_for(source, options.scalar);
    let Some((manipulator, places)) = valid else { return (None, diagnostics) };
    let module = schedule::module(&Model::new(manipulator), options);
    if let Some(value) = module.out_of_range() {
        diagnostics.push(validate::product_out_of_range(&places, options.scalar, value));
        return (None, diagnostics);
    }
    let origin = Origin::of(source);
    let generated = Generated {
        module: emit::rust::print(&module, &origin, &Notes::default()),
        runtime: emit::rust::print_runtime(&module, &origin),
        c: emit::c::print(&module, &origin),
        constants: module.constants(),
        absent: module.absent.clone(),
        program: module,
        origin,
    };
    (Some(generated), diagnostics)
}
