//! The functions of an arm, computed in process from its description, without a compiler.
//!
//! Printers print the programs of `armgen-codegen`; this crate passes them to `armgen-numbers`, which executes them.
//! A result has the bits of the emitted Rust module with the same scalar and the same sines, unless that has fused operations.
//! The same holds for all solutions of inverse kinematics ([`solver`]).

mod postures;

use std::collections::BTreeMap;

use armgen_codegen::catalogue::Argument;
use armgen_codegen::exact::Number;
use armgen_codegen::program::listing::{angles, Name};
use armgen_codegen::program::{self as steps, Module};
use armgen_codegen::ring::{Elementary, Symbol};
use armgen_codegen::Trig;
use armgen_numbers as numbers;
pub use armgen_numbers::postures::{Postures, Redundancy, Solver, Unfit, Verdict};
use armgen_numbers::Sines;
pub use armgen_numbers::{
    Angle, Arithmetic, Function, Input, Mismatch, Operand, Operation, Operator, Output, Program, Workspace,
};
pub use postures::{inverse_kinematics, solver};

/// A scalar of executed programs.
pub trait Scalar: numbers::Compiled + numbers::postures::Solved {
    /// The scalar nearest to a number.
    fn nearest(number: &Number) -> Self;
}

impl Scalar for f64 {
    fn nearest(number: &Number) -> f64 {
        number.to_f64()
    }
}

impl Scalar for f32 {
    fn nearest(number: &Number) -> f32 {
        number.to_f32()
    }
}

/// The programs of all functions of a module, in its order.
pub fn programs<T: Scalar>(module: &Module) -> Vec<Program<T>> {
    module.functions.iter().map(|of| program(module, of)).collect()
}

/// The program of a function of a module.
pub fn program<T: Scalar>(module: &Module, of: &steps::Function) -> Program<T> {
    Program::new(&function(module, of)).expect("a step of codegen uses earlier steps and its arguments")
}

/// A function of a module as data of `armgen-numbers`. Multiplications that the function fuses with additions round by themselves here.
pub fn function<T: Scalar>(module: &Module, of: &steps::Function) -> Function<T> {
    let sizes = module.sizes();
    let symbols = of.symbols();
    let place = |argument: Argument| {
        of.arguments.iter().position(|own| *own == argument).expect("a function uses the arguments that it takes")
    };
    let mut inputs: Vec<Input<T>> = Vec::new();
    let mut known: BTreeMap<Symbol, usize> = BTreeMap::new();
    let mut waves = Vec::new();
    for (i, angle) in angles(&symbols, &of.computed).into_iter().enumerate() {
        for (name, input) in [(angle.sine, Input::Sine(i)), (angle.cosine, Input::Cosine(i))] {
            if let Some(Name::SineOrCosine(symbol)) = name {
                known.insert(symbol, inputs.len());
                inputs.push(input);
            }
        }
        waves.push(Angle {
            argument: place(Argument::Q),
            terms: angle.terms.iter().map(|&(joint, minus)| (usize::from(joint), minus)).collect(),
            factors: if angle.computed.is_some() {
                angle.factors().iter().map(|factor| factor.as_ref().map(T::nearest)).collect()
            } else {
                Vec::new()
            },
            turn: angle.constant(module.turn.as_ref()).map(T::nearest),
        });
    }
    for symbol in symbols.into_iter().filter(|symbol| symbol.angle().is_none()) {
        let (argument, entry) = (place(Argument::of(symbol)), usize::from(symbol.index()));
        known.insert(symbol, inputs.len());
        inputs.push(match symbol {
            Symbol::OfRate(Elementary::Sign, _) => Input::Sign { argument, entry },
            Symbol::OfRate(Elementary::Decay, joint) => {
                Input::Fading { argument, entry, velocity: T::nearest(&of.stribeck[&joint]) }
            }
            _ => Input::Entry { argument, entry },
        });
    }
    let operand = |operand: &steps::Operand| match operand {
        steps::Operand::Step(step) => Operand::Value(inputs.len() + *step as usize),
        steps::Operand::Input(symbol) => Operand::Value(known[symbol]),
        steps::Operand::Constant(value) => Operand::Constant(T::nearest(value)),
    };
    let operation = |step: &steps::Step| Operation {
        operator: match step.operation {
            steps::Operation::Add => Operator::Add,
            steps::Operation::Subtract => Operator::Subtract,
            steps::Operation::Multiply => Operator::Multiply,
            steps::Operation::Divide => Operator::Divide,
            steps::Operation::Sign => Operator::Sign,
            steps::Operation::OppositeSign => Operator::OppositeSign,
        },
        left: operand(&step.left),
        right: operand(&step.right),
    };
    let (operations, outputs) = (
        of.steps.iter().map(operation).collect(),
        of.outputs.iter().map(|output| Output { operand: operand(&output.operand), negated: output.negated }).collect(),
    );
    let argument = |argument: &Argument| numbers::Argument { name: argument.name().into(), length: argument.length().of(&sizes) };
    let results = of.quantity.result.iter().map(|part| numbers::Result {
        name: part.name.into(),
        shape: part.lengths.iter().map(|length| length.of(&sizes)).collect(),
    });
    Function {
        name: of.name(),
        arguments: of.arguments.iter().map(argument).collect(),
        results: results.collect(),
        sines: match module.trig {
            Trig::Libm => Sines::Libm,
            Trig::Std => Sines::Std,
            Trig::Fast => Sines::Fast,
            _ => unreachable!("codegen has these three"),
        },
        angles: waves,
        inputs,
        operations,
        outputs,
    }
}
