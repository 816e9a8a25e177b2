//! From the description of a robot arm to its equations of motion, and from these to plain `no_std` Rust.
//!
//! The stages, in order; each type says what can no longer occur after it:
//!
//! | stage | from | to | can fail |
//! |---|---|---|---|
//! | parse | [`source::Source`] | [`description::RobotDescription`] | yes |
//! | validate | `RobotDescription` | [`manipulator::Manipulator`] | yes |
//! | derive | `Manipulator` | [`equations::Derivation`] of each [`equations::Quantity`] | no |
//! | schedule | derivations, [`program::Options`] | [`program::Module`] | no |
//! | emit | `Module` | text | no |
//!
//! Text goes in, text comes out; only [`build_script`] touches files and environment.

pub mod build_script;
pub mod derive;
pub mod description;
pub mod diagnostic;
pub mod document;
pub mod emit;
pub mod equations;
pub mod exact;
pub mod manipulator;
pub mod program;
pub mod ring;
pub mod show;
pub mod source;

use std::collections::BTreeMap;
use std::sync::OnceLock;

use derive::parameters::ParameterVector;
use diagnostic::Diagnostics;
use emit::c::CFace;
use emit::rust::{Notes, Origin};
use exact::Number;
use manipulator::Manipulator;
use program::{Module, Options};
use ring::field::Field;
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
    /// Functions that this arm does not have: name and reason.
    pub absent: Vec<(String, String)>,
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

/// A valid arm with what its equations are formed in.
#[derive(Clone, Debug)]
pub struct Model {
    /// The arm.
    pub manipulator: Manipulator,
    /// The field of the fingerprints.
    pub field: Field,
    /// The parameter vector that its `regressor` chooses.
    pub parameters: ParameterVector,
    /// Its base parameters, found when first asked for.
    base: OnceLock<ParameterVector>,
}

impl Model {
    /// The model of a valid arm.
    pub fn new(manipulator: Manipulator) -> Model {
        let field = equations::field_of(&manipulator);
        let parameters = derive::parameter_vector(&manipulator, &field);
        Model { manipulator, field, parameters, base: OnceLock::new() }
    }

    /// The base parameters, the masses of rotors among their values.
    pub fn base_parameters(&self) -> &ParameterVector {
        self.base.get_or_init(|| derive::base::base_parameters_with_rotors(&self.manipulator, &self.field))
    }

    /// What the shapes of the quantities depend on.
    pub fn sizes(&self) -> equations::Sizes {
        equations::Sizes {
            dof: self.manipulator.dof(),
            parameters: self.parameters.len(),
            base_parameters: self.base_parameters().len(),
            task: self.manipulator.task.len(),
        }
    }

    /// The programs of all functions.
    pub fn module(&self, options: &Options) -> Module {
        program::module(self, options)
    }
}

/// From text to text: the module if the description is valid, and all there is to say about the description.
pub fn generate(source: &Source, options: &Options) -> (Option<Generated>, Diagnostics) {
    let (valid, mut diagnostics) = manipulator::read_for(source, options.scalar);
    let Some((manipulator, places)) = valid else { return (None, diagnostics) };
    let module = Model::new(manipulator).module(options);
    if let Some(value) = module.out_of_range() {
        diagnostics.push(manipulator::product_out_of_range(&places, options.scalar, value));
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
