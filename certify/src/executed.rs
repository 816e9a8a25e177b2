//! Functions as they are executed in process, before the checker: no text is in between.

use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{Scalar, Trig};
use armgen_evaluate::{Angle, Arithmetic, Input, Operator, Program};
use armgen_verify::certificate::report::Report;
use armgen_verify::judge::checker::{Checker, Effort};
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::Module;
use armgen_verify::textbook::equations::parameters::Vector;
use armgen_verify::values::program::{self as checked, Literal, Output, Step};
use armgen_verify::{hash, judge::constants};

/// Verifies programs of functions of an arm, as they are executed, against the text of its description.
///
/// Each is executed once more over the checker's steps, with its joined products and its places, and is then judged as the function of a text is: its
/// constants are the floats nearest to exact values, with which it equals the equations at random points. What is trusted is the execution of an
/// instruction, and the sines. Error bounds and identities are not looked at: the emitted module has them, with the same bits.
///
/// Names of parameters come from the emitted module of the same functions.
pub fn verify_executed(source: &Source, programs: &[&Program<f64>]) -> Report {
    let mut report = Report::of(hash(source.text()), String::new());
    match functions(source, programs, &mut report) {
        Ok(()) => report,
        Err(fault) => Report { faults: vec![fault], ..report },
    }
}

fn functions(source: &Source, programs: &[&Program<f64>], report: &mut Report) -> Result<(), String> {
    let manipulator = crate::valid(source)?;
    report.robot.clone_from(&manipulator.name);
    let functions = Selection::named(programs.iter().map(|program| program.name())).map_err(|unknown| unknown.to_string())?;
    let options = Options { scalar: Scalar::F64, trig: Trig::Fast, functions, ..Options::default() };
    let (generated, _) = armgen_codegen::generate(source, &options);
    let generated = generated.ok_or("the module of these functions is not generated")?;
    let mut module = Module::read(&generated.module)?;
    (report.scalar, report.trig) = ("f64".into(), module.trig.unwrap_or_default().into());
    for (name, function) in &mut module.functions {
        let function = function.as_mut().map_err(std::mem::take)?;
        let own = programs.iter().find(|program| program.name() == name.as_str());
        let own = own.ok_or_else(|| format!("{name}: the emitted module has it, and nothing was executed"))?;
        function.program = read(own, &function.program.outputs).map_err(|fault| format!("{name}: {fault}"))?;
    }
    let vector = Vector::of(&manipulator, &constants::parameter_names(&module))?;
    let claims = Claims::from_numbers(&generated.constants)?.used(&module, &constants::claimed_constants(&vector, &module));
    let base = constants::base_parameters(&manipulator, &claims, &module);
    constants::name_angles(&mut module, &manipulator, &claims);
    let checker = Checker::new(manipulator, vector, claims, Effort::default(), &module, base)?;
    report.functions = checker.functions(&module);
    Ok(())
}

/// A program as the checker's steps; `places` are those of the entries of its result, in its order.
fn read(program: &Program<f64>, places: &[Output]) -> Result<checked::Program, String> {
    let argument = |name: &str| checked::Argument::named(name).ok_or_else(|| format!("the checker knows no argument `{name}`"));
    let mut steps = Steps {
        arguments: program.arguments().iter().map(|of| argument(&of.name)).collect::<Result<_, _>>()?,
        steps: Vec::new(),
        literals: Vec::new(),
        turns: Vec::new(),
        unknown: None,
    };
    let results = program.over(&mut steps).ok_or("a place is read before it is written")?;
    if let Some(unknown) = steps.unknown {
        return Err(format!("the checker has no step for {unknown}"));
    }
    if results.len() != places.len() {
        return Err(format!("its result has {} entries, not {}", results.len(), places.len()));
    }
    let outputs = places.iter().zip(results).map(|(place, step)| Output { place: place.place.clone(), step });
    let outputs = outputs.collect();
    let Steps { arguments, steps, literals, turns, .. } = steps;
    Ok(checked::Program { name: program.name().into(), arguments, steps, literals, turns, outputs })
}

/// An arithmetic whose numbers are those of steps.
struct Steps {
    arguments: Vec<checked::Argument>,
    steps: Vec<Step>,
    literals: Vec<Literal>,
    turns: Vec<usize>,
    /// What it has no step for.
    unknown: Option<&'static str>,
}

impl Steps {
    fn unknown(&mut self, what: &'static str) -> usize {
        self.unknown = Some(what);
        self.constant(0.0)
    }

    fn push(&mut self, step: Step) -> usize {
        self.steps.push(step);
        self.steps.len() - 1
    }

    /// The number of a literal of this size.
    fn literal(&mut self, value: f64) -> usize {
        self.literals.push(Literal { text: format!("{:?}", value.abs()), value: value.abs() });
        self.literals.len() - 1
    }
}

impl Arithmetic<f64> for Steps {
    type Value = usize;

    fn input(&mut self, input: &Input<f64>) -> usize {
        let is_rate = |argument: usize| self.arguments[argument] == checked::Argument::Dq;
        match *input {
            Input::Entry { argument, entry } => self.push(Step::Input(self.arguments[argument], entry)),
            Input::Sign { argument, entry } if is_rate(argument) => self.push(Step::Sign(entry)),
            Input::Fading { argument, entry, velocity } if is_rate(argument) => {
                let velocity = self.literal(velocity);
                self.push(Step::Stribeck(entry, velocity))
            }
            Input::Sign { .. } | Input::Fading { .. } => self.unknown("the sign or the fading of anything but a joint rate"),
            Input::Sine(_) | Input::Cosine(_) => self.unknown("a sine without its angle"),
        }
    }

    fn sine_cosine(&mut self, angle: &Angle<f64>) -> (usize, usize) {
        if self.arguments[angle.argument] != checked::Argument::Q {
            let unknown = self.unknown("the sine of anything but joint variables");
            return (unknown, unknown);
        }
        let factors: Vec<Option<usize>> = angle.factors.iter().map(|factor| factor.map(|factor| self.literal(factor))).collect();
        let terms = angle.terms.iter().map(|&(joint, minus)| (joint, if minus { -1 } else { 1 })).collect();
        let turn = angle.turn.map(|turn| {
            let literal = self.literal(turn);
            self.turns.push(literal);
            (self.turns.len() - 1, turn.is_sign_negative())
        });
        let angle = checked::Angle { terms, turn, factors, computed: None }.sorted();
        (self.push(Step::Sine(angle.clone())), self.push(Step::Cosine(angle)))
    }

    fn constant(&mut self, value: f64) -> usize {
        let literal = self.literal(value);
        let size = self.push(Step::Literal(literal));
        match value.is_sign_negative() {
            true => self.push(Step::Negate(size)),
            false => size,
        }
    }

    fn result(&mut self, operator: Operator, left: &usize, right: &usize) -> usize {
        let (a, b) = (*left, *right);
        match operator {
            Operator::Add => self.push(Step::Add(a, b)),
            Operator::Subtract => self.push(Step::Subtract(a, b)),
            Operator::Multiply => self.push(Step::Multiply(a, b)),
            Operator::Divide => self.push(Step::Divide(a, b)),
            Operator::Sign => self.push(Step::SignOf(a)),
            Operator::OppositeSign => {
                let opposite = self.push(Step::Negate(a));
                self.push(Step::SignOf(opposite))
            }
        }
    }

    fn negated(&mut self, value: &usize) -> usize {
        self.push(Step::Negate(*value))
    }
}
