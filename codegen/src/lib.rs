//! From the description of a robot arm to its equations of motion, and from these to plain `no_std` Rust.
//!
//! The stages, in order; each type rules out a class of faults for the stages after it:
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
//!
//! A project that has a robot needs [`build_script::Robot`], or [`generate`] with [`Options`]. The modules hidden from the
//! documentation hold the stages. The program and the checker use them, and they change with the stages.

pub mod build_script;

#[doc(hidden)]
pub mod catalogue;
#[doc(hidden)]
pub mod derive;
#[doc(hidden)]
pub mod emit;
#[doc(hidden)]
pub mod equations;
#[doc(hidden)]
pub mod inverse_kinematics;
#[doc(hidden)]
pub mod pass;
#[doc(hidden)]
pub mod program;
#[doc(hidden)]
pub mod schedule;
#[doc(hidden)]
pub mod show;

// The algebra and the description, under the paths that the stages use.
#[doc(hidden)]
pub use armgen_algebra::{exact, ring};
#[doc(hidden)]
pub use armgen_description::{codes, description, document, kinds, manipulator, parallel, suggest};
pub use armgen_description::{diagnostic, source};
// Validation ends with the equations, and callers look for the whole of it under its own name.
#[doc(hidden)]
pub use equations as validate;

use std::collections::BTreeMap;
use std::sync::OnceLock;

pub use catalogue::Absent;
pub use derive::Model;
use diagnostic::{Diagnostic, Diagnostics};
use emit::c::CFace;
use emit::{Language, Notes, Origin};
use exact::Number;
use inverse_kinematics::Solved;
pub use kinds::Scalar;
use manipulator::Manipulator;
pub use pass::{Pass, Passes};
use program::Module;
pub use program::Trig;
pub use schedule::{Options, Selection, UnknownFunctions};
use source::Source;
use validate::Places;

/// The text of an emitted module and of the trait implementation that goes with it.
#[derive(Clone, Debug)]
pub struct Generated {
    /// The module: free functions over arrays.
    pub module: String,
    /// The implementation of the runtime's traits for it.
    pub runtime: String,
    /// The interface for C: a header, and wrappers to include next to the module.
    pub c: CFace,
    /// The exact constants of the literals of the module, by function.
    pub constants: BTreeMap<String, Vec<Number>>,
    /// Functions that this arm does not have.
    pub absent: Vec<Absent>,
    /// The program that all texts print.
    program: Module,
    /// The module without the parts that receive notes.
    text: emit::rust::Text,
    origin: Origin,
    notes: Notes,
    /// The arm of these equations.
    manipulator: Manipulator,
    /// Its end effectors with their constructions, found at the first use.
    solved: OnceLock<Vec<Solved>>,
}

impl Generated {
    /// The name of the robot.
    pub fn name(&self) -> &str {
        &self.program.name
    }

    /// Prints the module again, with notes in its documentation.
    pub fn annotate(&mut self, notes: &Notes) {
        self.module = self.text.documented(&self.program, &self.origin, notes);
        self.notes = notes.clone();
    }

    /// The declarations of the module in JavaScript, for TypeScript.
    pub fn declarations(&self) -> String {
        emit::javascript::declarations(&self.program.unfused(), &self.origin, &self.notes)
    }

    /// The files of the package in MATLAB.
    pub fn package(&self) -> Vec<emit::matlab::File> {
        emit::matlab::print(&self.program.unfused(), &self.origin, &self.notes)
    }

    /// The functions for many states as a library of C, and the module in Python that compiles and calls it.
    pub fn native(&self) -> emit::python::Native {
        emit::python::native(&self.program.unfused(), &self.origin)
    }

    /// The module in another language, with the same notes; the files of a package as one text.
    pub fn in_language(&self, language: Language) -> String {
        match language {
            Language::Rust => self.module.clone(),
            Language::C | Language::Cuda => emit::c::standalone(&self.program, language, &self.origin, &self.notes),
            Language::JavaScript => emit::javascript::print(&self.program.unfused(), &self.origin, &self.notes),
            Language::Python => emit::python::print(&self.program.unfused(), &self.origin, &self.notes),
            Language::Matlab => emit::matlab::joined(&self.package()),
        }
    }

    /// The end effectors with their inverse kinematics: one, or those with names in the order of the description.
    pub fn solvers(&self) -> impl Iterator<Item = Solver<'_>> {
        let solved = self.solved.get_or_init(|| Solved::all(&self.manipulator));
        solved.iter().map(|solved| Solver { solved, generated: self })
    }

    /// The module of inverse kinematics of the only end effector, or of the first one: [`Solver::text`].
    pub fn inverse_kinematics(&self) -> String {
        self.solver().text()
    }

    /// The same in C alone: [`Solver::in_c`].
    pub fn inverse_kinematics_in_c(&self) -> Result<String, String> {
        self.solver().in_c()
    }

    fn solver(&self) -> Solver<'_> {
        self.solvers().next().expect("an arm has an end effector")
    }

    /// `robot_runtime.rs` with the trait `InverseKinematics`, or `RedundantInverseKinematics` for a redundant arm. `ik` names the
    /// sibling module of the robot's module that holds inverse kinematics. The trait is left out if the arm has no construction or
    /// several end effectors, or the module lacks functions that the other traits need.
    pub fn runtime_with_inverse_kinematics(&self, ik: &str) -> String {
        let found = &self.solver().solved.found;
        let has_one = self.manipulator.tips.is_empty();
        let of_it = if has_one { emit::rust::print_inverse_kinematics_trait(&self.program, found, ik) } else { String::new() };
        self.runtime.clone() + &of_it
    }

    /// Laws of the runtime for C, `robot_laws.h` and `robot_laws_c.rs`, to be included next to the module and its traits. `header`: the file of
    /// [`Generated::c`]. `None` of an arm without dynamics, and of one with several end effectors.
    pub fn laws_for_c(&self, header: &str) -> Option<CFace> {
        emit::c::print_laws(&self.program, &self.origin, header)
    }
}

/// Inverse kinematics of an end effector, in a module of its own.
#[derive(Clone, Copy, Debug)]
pub struct Solver<'a> {
    solved: &'a Solved,
    generated: &'a Generated,
}

impl Solver<'_> {
    /// Part of the names of its files: `_left` of an end effector with this name, nothing of one without.
    pub fn infix(&self) -> String {
        self.solved.prefix.strip_suffix('_').map_or_else(String::new, |name| format!("_{name}"))
    }

    /// The end effector and its construction.
    #[doc(hidden)]
    pub fn solved(&self) -> &Solved {
        self.solved
    }

    /// The module, `robot_ik.rs`: all joint variables that reach a pose. It is self-contained, in a module of its own. Without a construction
    /// it holds a comment with the reason.
    pub fn text(&self) -> String {
        emit::rust::print_inverse_kinematics(self.solved, self.scalar(), &self.generated.origin)
    }

    /// The C interface of `robot_ik.rs`: `robot_ik.h`, and `robot_ik_c.rs` to be included next to it; `None` without a construction.
    pub fn for_c(&self) -> Option<CFace> {
        emit::c::print_inverse_kinematics(self.solved, self.scalar(), &self.generated.origin)
    }

    /// The same in C alone, `robot_ik.h`: the calls of the header of `for_c`, with their bodies. Without a construction it holds a
    /// comment with the reason. An error is a fault of this program.
    pub fn in_c(&self) -> Result<String, String> {
        emit::c::print_solver(self.solved, self.scalar(), &self.generated.origin)
    }

    /// The end of `robot_test.rs` of an arm with one end effector: the tests of the module, which is in `file` of the same folder.
    pub fn test(&self, file: &str) -> String {
        emit::rust::print_inverse_kinematics_test(self.solved, self.scalar(), file)
    }

    /// The program that tests it in C, `robot_ik_test.c`, of an arm with one end effector, with the names of both headers; none without a
    /// construction.
    pub fn test_in_c(&self, module: &str, solver: &str) -> Option<String> {
        emit::c::print_solver_test(self.solved, self.scalar(), [module, solver], &self.generated.origin)
    }

    fn scalar(&self) -> Scalar {
        self.generated.program.scalar
    }
}

/// The programs of all functions of an arm; the fault, if a number in them does not fit the scalar. (It is large, but rare.)
#[doc(hidden)]
pub fn programs(model: &Model, places: &Places, options: &Options) -> Result<Module, Box<Diagnostic>> {
    let module = schedule::module(model, options);
    match module.out_of_range() {
        Some(value) => Err(Box::new(validate::product_out_of_range(places, options.scalar, value))),
        None => Ok(module),
    }
}

/// From text to text: the module if the description is valid, and all diagnostics of the description.
pub fn generate(source: &Source, options: &Options) -> (Option<Generated>, Diagnostics) {
    let (valid, mut diagnostics) = validate::read_for(source, options.scalar);
    let Some((manipulator, places)) = valid else { return (None, diagnostics) };
    let model = Model::new(manipulator);
    let module = match programs(&model, &places, options) {
        Ok(module) => module,
        Err(fault) => {
            diagnostics.push(*fault);
            return (None, diagnostics);
        }
    };
    (Some(printed(source, model.manipulator, module)), diagnostics)
}

/// The texts of programs: those of the arm of a description.
#[doc(hidden)]
pub fn printed(source: &Source, manipulator: Manipulator, module: Module) -> Generated {
    let origin = Origin::of(source);
    let text = emit::rust::Text::of(&module);
    Generated {
        module: text.documented(&module, &origin, &Notes::default()),
        text,
        runtime: emit::rust::print_runtime(&module, &origin),
        c: emit::c::print(&module, &origin),
        constants: module.constants(),
        absent: module.absent.clone(),
        program: module,
        origin,
        notes: Notes::default(),
        manipulator,
        solved: OnceLock::new(),
    }
}
