//! Straight-line programs: operations in order, independent of a language.
//!
//! A function is a list of steps, each an operation on inputs, constants and earlier steps, and a list of outputs.
//! Absent from a `Function` on: graphs, sharing, mathematics. The algebra's `optimise` runs before: it works on shared expressions.

mod constants;
mod cost;
pub mod listing;

pub use cost::Cost;

use std::collections::BTreeMap;

use crate::catalogue::{Absent, Argument, Parameter, Quantity, Sizes};
use crate::exact::Number;
use crate::kinds::{Feature, Scalar};
use crate::ring::field::computed::ComputedAngle;
use crate::ring::Symbol;
use armgen_description::language::Language;

/// Where the sines and cosines of the emitted module come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Trig {
    /// The crate `libm`, angle by angle: the same bits on every machine.
    #[default]
    Libm,
    /// The standard library, angle by angle: the emitted module then needs `std`, and its last bits depend on the platform.
    Std,
    /// All angles of a function together in vector instructions, within 1 unit in the last place, the same bits on every machine.
    /// Large angles (beyond 65536 rad in f64, 128 rad in f32) use the crate `libm`.
    Fast,
}

impl Trig {
    /// Where the sines and cosines of a language come from unless chosen otherwise.
    pub fn of_language(language: Language) -> Trig {
        match language {
            Language::Rust => Trig::Libm,
            _ => Trig::Fast,
        }
    }

    /// The word of the option.
    pub fn name(self) -> &'static str {
        match self {
            Trig::Libm => "libm",
            Trig::Std => "std",
            Trig::Fast => "fast",
        }
    }
}

/// A value that a step uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Operand {
    /// The result of an earlier step.
    Step(u32),
    /// An input.
    Input(Symbol),
    /// An exact constant.
    Constant(Number),
}

/// An operation on two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// a + b
    Add,
    /// a - b
    Subtract,
    /// a b
    Multiply,
    /// a / b
    Divide,
    /// sign(a), with sign(0) = 0: the right operand is a, too
    Sign,
    /// sign(-a), likewise
    OppositeSign,
}

/// One step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The operation.
    pub operation: Operation,
    /// Its left operand.
    pub left: Operand,
    /// Its right operand.
    pub right: Operand,
}

/// An output entry: an operand and its sign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// The value.
    pub operand: Operand,
    /// Whether it is negated. Constants carry their sign themselves.
    pub negated: bool,
}

/// A function.
#[derive(Clone, Debug)]
pub struct Function {
    /// The quantity that it computes.
    pub quantity: &'static Quantity,
    /// Whether it takes the parameters at run time.
    pub with_parameters: bool,
    /// Arguments in order.
    pub arguments: Vec<Argument>,
    /// Steps in order.
    pub steps: Vec<Step>,
    /// Entries of the result, row by row.
    pub outputs: Vec<Output>,
    /// How it was derived.
    pub method: &'static str,
    /// The Stribeck velocities of the joints whose Stribeck friction it uses.
    pub stribeck: BTreeMap<u16, Number>,
    /// The angles that it computes, by the indices of their sines and cosines.
    pub computed: BTreeMap<u16, ComputedAngle>,
    /// Whether sums take products without rounding them: [`Function::products_in_sums`].
    pub fuse: bool,
}

impl Function {
    /// Its name in the emitted module.
    pub fn name(&self) -> String {
        self.quantity.function_name(self.with_parameters)
    }

    /// How often each step is used.
    pub fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.steps.len()];
        let operands = self.steps.iter().flat_map(|s| [&s.left, &s.right]).chain(self.outputs.iter().map(|o| &o.operand));
        for operand in operands {
            if let Operand::Step(i) = operand {
                uses[*i as usize] += 1;
            }
        }
        uses
    }

    /// The products that a sum or a difference fuses into one operation, which rounds once: products without another use, and the
    /// left one of two.
    pub fn products_in_sums(&self) -> Vec<bool> {
        let mut fused = vec![false; self.steps.len()];
        if !self.fuse {
            return fused;
        }
        let uses = self.uses();
        let is_product = |i: usize| self.steps[i].operation == Operation::Multiply && uses[i] == 1;
        for step in self.steps.iter().filter(|step| matches!(step.operation, Operation::Add | Operation::Subtract)) {
            let products = [&step.left, &step.right].into_iter().filter_map(|operand| match operand {
                Operand::Step(i) => Some(*i as usize).filter(|&i| is_product(i)),
                Operand::Input(_) | Operand::Constant(_) => None,
            });
            products.take(1).for_each(|i| fused[i] = true);
        }
        fused
    }
}

/// A joint of the emitted module; limits that are not given are infinite.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Whether it turns.
    pub is_revolute: bool,
    /// Lowest and highest q.
    pub position: [Option<Number>; 2],
    /// Highest |dq|.
    pub velocity: Option<Number>,
    /// Highest |tau|.
    pub effort: Option<Number>,
    /// Highest acceleration.
    pub acceleration: Option<Number>,
    /// Highest jerk.
    pub jerk: Option<Number>,
}

/// A named end effector of the emitted module.
#[derive(Clone, Debug)]
pub struct EndEffector {
    /// Its name.
    pub name: String,
    /// Rows of its task in its geometric Jacobian.
    pub task: Vec<usize>,
    /// The coordinates that move it, by their indices, from the base on.
    pub coordinates: Vec<usize>,
}

impl EndEffector {
    /// The name of one of its constants: `LEFT_TASK` of `TASK`.
    pub fn constant(&self, name: &str) -> String {
        format!("{}_{name}", self.name.to_ascii_uppercase())
    }
}

/// Joint variables as sums over coordinates: S q + c.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// Names of all joints.
    pub names: Vec<String>,
    /// S, a row for each joint.
    pub factors: Vec<Vec<Number>>,
    /// c.
    pub offsets: Vec<Number>,
}

/// The speeds of the rotors of motors beside the links that carry them.
#[derive(Clone, Debug)]
pub struct MotorRates {
    /// Names of the joints with a motor.
    pub joints: Vec<String>,
    /// Rotor speed over the rate of each coordinate, a row for each motor.
    pub rates: Vec<Vec<Number>>,
}

/// All that the emitted module holds.
#[derive(Clone, Debug)]
pub struct Module {
    /// Name of the robot.
    pub name: String,
    /// Joints, base to tip; of a robot with coupled joints those with a coordinate.
    pub joints: Vec<Joint>,
    /// The coupling of joints, if joints are coupled.
    pub coupling: Option<Coupling>,
    /// The speeds of motors, if a motor turns with several coordinates or with none of its own.
    pub motors: Option<MotorRates>,
    /// Acceleration of free fall in the base frame, m/s².
    pub gravity: [Number; 3],
    /// Whether that is an argument of the functions which it enters, and `gravity` its nominal value.
    pub gravity_is_argument: bool,
    /// What its joints have, which documentation names.
    pub features: Vec<Feature>,
    /// Rows of the task in the geometric Jacobian.
    pub task: Vec<usize>,
    /// The end effectors with names; none where there is one without a name.
    pub tips: Vec<EndEffector>,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Whether the parameters are a base set: combinations in joint frames.
    pub base_parameters: bool,
    /// Base parameters, their meanings exact combinations of standard parameters; none if no function needs them.
    pub base_set: Vec<Parameter>,
    /// Functions in order.
    pub functions: Vec<Function>,
    /// Functions that this arm does not have.
    pub absent: Vec<Absent>,
    /// The scalar.
    pub scalar: Scalar,
    /// Where sines and cosines come from.
    pub trig: Trig,
    /// The constant angle of turned sums, rad.
    pub turn: Option<Number>,
    /// The number of states in a block of the functions for many states; `None` without such functions.
    pub batch: Option<usize>,
    /// The names of the requested functions; `None` for all.
    pub asked_for: Option<Vec<String>>,
    /// The names of the passes that were not used.
    pub without: Vec<&'static str>,
}

impl Module {
    /// The same without fused operations, for languages without them.
    pub fn unfused(&self) -> Module {
        let functions = self.functions.iter().map(|function| Function { fuse: false, ..function.clone() }).collect();
        Module { functions, ..self.clone() }
    }

    /// Whether a function has a fused operation.
    pub fn is_fused(&self) -> bool {
        self.functions.iter().any(|function| function.products_in_sums().contains(&true))
    }

    /// The dimensions of its functions.
    pub fn sizes(&self) -> Sizes {
        Sizes {
            dof: self.joints.len(),
            joints: self.coupling.as_ref().map_or(self.joints.len(), |coupling| coupling.names.len()),
            parameters: self.parameters.len(),
            base_parameters: self.base_set.len(),
            task: self.task.len(),
        }
    }

    /// A constant that the scalar cannot hold: products of numbers that each fit may not.
    pub fn out_of_range(&self) -> Option<&Number> {
        let operands = self
            .functions
            .iter()
            .flat_map(|f| f.steps.iter().flat_map(|s| [&s.left, &s.right]).chain(f.outputs.iter().map(|o| &o.operand)));
        let constants = operands.filter_map(|operand| match operand {
            Operand::Constant(value) => Some(value),
            Operand::Step(_) | Operand::Input(_) => None,
        });
        let parameters = self.parameters.iter().chain(&self.base_set).map(|parameter| &parameter.nominal);
        let motors = self.motors.iter().flat_map(|motors| motors.rates.iter().flatten());
        let angles = self.functions.iter().flat_map(|f| f.computed.values());
        let of_angles = angles.flat_map(|angle| angle.factors.iter().map(|(_, factor)| factor).chain([&angle.offset]));
        constants.chain(of_angles).chain(parameters).chain(motors).find(|value| !self.scalar.holds(value))
    }
}
