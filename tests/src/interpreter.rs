//! Programs interpreted: the steps that would be printed as Rust, carried out in f64, so that a robot can be judged without a compiler.

use armgen_codegen::program::{Function, Module, Operand, Operation};
use armgen_codegen::ring::{AngleSum, Elementary, Symbol};
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::Model;

use crate::functions::{Arguments, Functions};

/// The programs of a robot.
#[derive(Clone, Debug)]
pub struct Interpreted {
    /// The programs.
    pub module: Module,
}

impl Interpreted {
    /// The programs of the robot that a text describes.
    ///
    /// Errors: the text is not valid; all that is wrong with it.
    pub fn new(text: &str) -> Result<Self, String> {
        Interpreted::with_options(text, &Options::default())
    }

    /// The same, generated with `options`.
    pub fn with_options(text: &str, options: &Options) -> Result<Self, String> {
        let source = Source::new("robot.yaml", text);
        let (valid, diagnostics) = validate::read(&source);
        match valid {
            Some((manipulator, _)) => {
                Ok(Interpreted { module: armgen_codegen::schedule::module(&Model::new(manipulator), options) })
            }
            None => Err(diagnostics.render(&source, armgen_codegen::diagnostic::Colour::Never)),
        }
    }
}

impl Functions for Interpreted {
    fn dof(&self) -> usize {
        self.module.joints.len()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.module.parameters.iter().map(|parameter| parameter.name.clone()).collect()
    }

    fn nominal(&self) -> Vec<f64> {
        self.module.parameters.iter().map(|parameter| parameter.nominal.to_f64()).collect()
    }

    fn nominal_base(&self) -> Vec<f64> {
        self.module.base_set.iter().map(|parameter| parameter.nominal.to_f64()).collect()
    }

    fn has(&self, function: &str) -> bool {
        self.module.functions.iter().any(|f| f.name() == function)
    }

    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64> {
        let found = self.module.functions.iter().find(|f| f.name() == function);
        run(&self.module, found.unwrap_or_else(|| panic!("no function `{function}`")), arguments)
    }
}

/// Carries out a program of a module.
///
/// Panics where it uses a step before it is there, or an input that is not among its arguments.
pub fn run(module: &Module, function: &Function, arguments: &Arguments) -> Vec<f64> {
    let turn = module.turn.as_ref().map_or(0.0, |turn| turn.to_f64());
    let mut values: Vec<f64> = Vec::with_capacity(function.steps.len());
    for step in &function.steps {
        let (a, b) =
            (operand(function, turn, &values, arguments, &step.left), operand(function, turn, &values, arguments, &step.right));
        values.push(match step.operation {
            Operation::Add => a + b,
            Operation::Subtract => a - b,
            Operation::Multiply => a * b,
            Operation::Divide => a / b,
            Operation::Sign | Operation::OppositeSign if a == 0.0 => 0.0,
            Operation::Sign => a.signum(),
            Operation::OppositeSign => -a.signum(),
        });
    }
    let output = |o: &armgen_codegen::program::Output| {
        let value = operand(function, turn, &values, arguments, &o.operand);
        if o.negated {
            -value
        } else {
            value
        }
    };
    function.outputs.iter().map(output).collect()
}

fn operand(function: &Function, turn: f64, values: &[f64], arguments: &Arguments, operand: &Operand) -> f64 {
    let symbol = match operand {
        Operand::Step(i) => return values[*i as usize],
        Operand::Constant(value) => return value.to_f64(),
        Operand::Input(symbol) => *symbol,
    };
    use armgen_codegen::catalogue::Argument;
    let given = |argument: Argument, vector: &[f64], i: u16| {
        assert!(function.arguments.contains(&argument), "{} does not take {argument:?}", function.name());
        vector[usize::from(i)]
    };
    let a = arguments;
    let angle = |i: u16| match function.computed.get(&i) {
        Some(angle) => {
            let terms = angle.factors.iter().map(|(of, factor)| factor.to_f64() * given(Argument::Q, &a.q, *of));
            terms.reduce(|a, b| a + b).unwrap_or_default() + angle.offset.to_f64()
        }
        None => given(Argument::Q, &a.q, i),
    };
    match symbol {
        Symbol::Sine(i) => angle(i).sin(),
        Symbol::Cosine(i) => angle(i).cos(),
        Symbol::SineOf(sum) => sum_of(sum, turn, &|i| given(Argument::Q, &a.q, i)).sin(),
        Symbol::CosineOf(sum) => sum_of(sum, turn, &|i| given(Argument::Q, &a.q, i)).cos(),
        Symbol::Position(i) => given(Argument::Q, &a.q, i),
        Symbol::Rate(i) => given(Argument::Dq, &a.dq, i),
        Symbol::OfRate(Elementary::Sign, i) => match given(Argument::Dq, &a.dq, i) {
            0.0 => 0.0,
            rate => rate.signum(),
        },
        Symbol::OfRate(Elementary::Decay, i) => (-given(Argument::Dq, &a.dq, i).abs() / function.stribeck[&i].to_f64()).exp(),
        Symbol::GravitySize(_) | Symbol::GravitySign(_) | Symbol::OfRate(..) => panic!("a step of a program, and no input"),
        Symbol::Acceleration(i) => given(Argument::Ddq, &a.ddq, i),
        Symbol::ReferenceRate(i) => given(Argument::Dqr, &a.dqr, i),
        Symbol::ReferenceAcceleration(i) => given(Argument::Ddqr, &a.ddqr, i),
        Symbol::Torque(i) => given(Argument::Tau, &a.tau, i),
        Symbol::Parameter(i) => given(Argument::Pi, &a.pi, i),
        Symbol::Gravity(i) => given(Argument::Gravity, &a.g0, i),
    }
}

/// A sum of joint variables and of the constant angle of a turned one, added in the order in which the text adds them.
fn sum_of(sum: AngleSum, turn: f64, of: &dyn Fn(u16) -> f64) -> f64 {
    let terms = sum.terms().map(|(i, minus)| if minus { -of(i) } else { of(i) });
    terms.chain(sum.turned.then_some(turn)).reduce(|a, b| a + b).unwrap_or_default()
}
