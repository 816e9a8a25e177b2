//! Runs modules next to the Rust module over the same states, and compares the results bit by bit.

use std::ops::Range;
use std::path::Path;

use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::read::reader::{Constant, Module};
use armgen_verify::values::contract::{Array, Length, Promise, Sizes};
use armgen_verify::values::program::Argument;
use armgen_verify::values::stream::Stream;

use super::programs::{batch, c, javascript, octave, python, rust};
use super::tools::write;
use crate::common;

/// The number of compilers and flags to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    Short,
    Full,
}

/// A function, its arguments with their positions in a state, and its results with their sizes.
pub(crate) struct Called {
    pub(crate) name: String,
    pub(crate) arguments: Vec<(Argument, Range<usize>)>,
    pub(crate) results: Vec<(String, Array, usize)>,
}

/// The data of a module that a driver needs.
pub(crate) struct Robot {
    pub(crate) name: String,
    pub(crate) scalar: Scalar,
    dof: usize,
    parameters: usize,
    sizes: Sizes,
    pub(crate) functions: Vec<Called>,
}

impl Robot {
    fn of(module: &Module, scalar: Scalar) -> Robot {
        let Constant::Text(name) = &module.constants["NAME"] else { panic!("a robot has a name") };
        let sizes = module.sizes();
        let (dof, parameters) = (sizes.n, sizes.p);
        let of_joints = |k: usize| parameters + k * dof..parameters + (k + 1) * dof;
        let called = |(name, program): (&str, &armgen_verify::values::program::Program)| {
            let promise = Promise::of(name).expect("a known function").0;
            let place = |argument: Argument| match argument {
                Argument::Pi => 0..parameters,
                Argument::Q => of_joints(0),
                Argument::Dq => of_joints(1),
                Argument::Ddq => of_joints(2),
                Argument::Dqr => of_joints(3),
                Argument::Ddqr => of_joints(4),
                Argument::Tau => of_joints(5),
                Argument::Gravity => parameters + 6 * dof..parameters + 6 * dof + 3,
            };
            let places = promise.returned.places(&sizes.of_function(name));
            let entries = |part: &str| places.iter().filter(|place| promise.returned.part_of(place).0 == part).count();
            Called {
                name: name.into(),
                arguments: program.arguments.iter().map(|&a| (a, place(a))).collect(),
                results: promise
                    .returned
                    .named()
                    .into_iter()
                    .map(|(part, array)| (part.clone(), array, entries(&part)))
                    .collect(),
            }
        };
        Robot {
            name: name.clone(),
            scalar,
            dof,
            parameters,
            sizes: sizes.clone(),
            functions: module.programs().map(called).collect(),
        }
    }

    /// States with positions of all sizes, including exact multiples of pi/2 and zeros of both signs.
    fn states(&self, count: usize) -> Vec<u8> {
        let mut stream = Stream::new(20_240);
        let range = if self.scalar == Scalar::F64 { 6500.0 } else { 30.0 };
        let mut bytes = Vec::new();
        for state in 0..count {
            for i in 0..self.numbers_of_state() {
                let unit = (stream.bits() >> 11) as f64 / (1u64 << 53) as f64;
                let signed = 2.0 * unit - 1.0;
                let position = (self.parameters..self.parameters + self.dof).contains(&i);
                let value = match (state % 8, position) {
                    (0, true) => [0.0, -0.0][usize::from(unit < 0.5)],
                    (1, true) => (signed * 8.0).round() * std::f64::consts::FRAC_PI_2,
                    (2, true) => signed * range,
                    (3, false) if i >= self.parameters && unit < 0.5 => 0.0 * signed,
                    (_, true) => 4.0 * signed,
                    _ if i < self.parameters => 0.1 + 3.0 * unit,
                    _ => 3.0 * signed,
                };
                match self.scalar {
                    Scalar::F64 => bytes.extend(value.to_le_bytes()),
                    Scalar::F32 => bytes.extend((value as f32).to_le_bytes()),
                }
            }
        }
        bytes
    }

    /// Number of values in a state: the parameters, six vectors of the joints, and the acceleration of free fall.
    pub(crate) fn numbers_of_state(&self) -> usize {
        self.parameters + 6 * self.dof + 3
    }

    /// A dimension of a result of a function.
    pub(crate) fn dimension(&self, function: &str, length: Length) -> usize {
        match length {
            Length::Dof => self.sizes.n,
            Length::Joints => self.sizes.joints.unwrap_or(self.sizes.n),
            Length::Parameters => self.sizes.p,
            Length::BaseParameters => self.sizes.b,
            Length::Task => self.sizes.of_function(function).m,
            Length::Of(value) => value,
        }
    }

    fn width(&self) -> usize {
        if self.scalar == Scalar::F64 {
            8
        } else {
            4
        }
    }
}

/// Runs the module in all languages over this number of states, and compares.
#[track_caller]
pub(crate) fn check(name: &str, scalar: Scalar, states: usize, effort: Effort) {
    #[allow(clippy::needless_update)]
    check_with(name, &common::source(name), &Options { scalar, trig: Trig::Fast, ..Options::default() }, states, effort);
}

/// The same for any description and some functions.
#[track_caller]
pub(crate) fn check_with(name: &str, source: &Source, options: &Options, states: usize, effort: Effort) {
    let scalar = options.scalar;
    let generated = common::generate_with(source, options);
    let module = Module::read(&generated.module).expect("the module in Rust");
    let robot = Robot::of(&module, scalar);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("languages_{effort:?}_{name}_{scalar:?}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    write(folder.join("states"), robot.states(states));
    rust(&folder, &robot, &generated);
    let has = |language: &Language| {
        language.scalars().contains(&scalar) && *language != Language::Cuda && (!options.fuse || *language == Language::C)
    };
    for language in super::others().filter(has) {
        let runs = match language {
            // The functions of CUDA are the text of C.
            Language::Rust | Language::Cuda => continue,
            Language::C => {
                let lanes = if scalar == Scalar::F64 { 8 } else { 16 };
                let batched = common::generate_with(source, &Options { batch: Some(lanes), ..options.clone() });
                let mut runs = c(&folder, &robot, &generated, effort);
                runs.extend(batch(&folder, &robot, &batched, effort));
                runs
            }
            Language::JavaScript => javascript(&folder, &robot, &generated),
            Language::Python => python(&folder, &robot, &generated),
            Language::Matlab => octave(&folder, &robot, &generated),
        };
        for run in runs {
            // GCC compiles a negated fused operation to a single instruction, which changes the sign of a zero.
            let zeros = options.fuse && run.split(' ').any(|word| ["gcc", "g++"].contains(&word));
            let results: usize = robot.functions.iter().map(|function| compare(&folder, &robot, function, &run, zeros)).sum();
            println!("{name} {scalar:?}: {run}: {results} numbers of {} functions have the bits of Rust", robot.functions.len());
            let _ = std::fs::remove_dir_all(folder.join(&run));
        }
    }
    let _ = std::fs::remove_dir_all(&folder);
}

/// Compares the results of a function; returns their number. `zeros`: both zeros are equal.
#[track_caller]
fn compare(folder: &Path, robot: &Robot, function: &Called, run: &str, zeros: bool) -> usize {
    let read = |run: &str| std::fs::read(folder.join(run).join(&function.name)).expect("the results");
    let (rust, other) = (read("rust"), read(run));
    let width = robot.width();
    assert_eq!(rust.len(), other.len(), "{}: {} by {run}", robot.name, function.name);
    let number = |bytes: &[u8]| match bytes.try_into() {
        Ok(eight) => f64::from_le_bytes(eight),
        Err(_) => f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes"))),
    };
    let entries: usize = function.results.iter().map(|(.., entries)| entries).sum();
    for (k, (a, b)) in rust.chunks(width).zip(other.chunks(width)).enumerate() {
        let same = a == b || number(a).is_nan() && number(b).is_nan() || zeros && number(a) == 0.0 && number(b) == 0.0;
        let (name, own) = (&robot.name, &function.name);
        assert!(
            same,
            "{name}: {own} by {run}: entry {} of state {} is {:e}, in Rust {:e}",
            k % entries,
            k / entries,
            number(b),
            number(a)
        );
    }
    rust.len() / width
}
