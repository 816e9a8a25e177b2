//! Straight-line programs of an emitted module, and their execution in any number type.

use std::fmt;

use crate::values::element::Element;
use crate::values::formula::{Formula, MOST_BITS};

/// The constant of modules that have the acceleration of free fall as an argument.
pub const NOMINAL_GRAVITY: &str = "NOMINAL_GRAVITY";

/// The constant with the number of joints, of modules alone whose joints are coupled.
pub const JOINTS: &str = "JOINTS";
/// The number of motors, of arms whose motors turn with several coordinates.
pub const MOTORS: &str = "MOTORS";
/// The constant with the names of the end effectors, in modules where these have names.
pub const TIPS: &str = "TIPS";

/// Arguments of emitted functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Argument {
    /// The parameter vector.
    Pi,
    /// Joint variables.
    Q,
    /// Joint rates.
    Dq,
    /// Joint accelerations.
    Ddq,
    /// Reference rates.
    Dqr,
    /// Reference accelerations.
    Ddqr,
    /// Joint torques.
    Tau,
    /// Acceleration of free fall in the base frame. Last, because the seed of the random points has the numbers of the others.
    Gravity,
}

impl Argument {
    /// All arguments.
    pub const ALL: [Argument; 8] =
        [Argument::Pi, Argument::Q, Argument::Dq, Argument::Ddq, Argument::Dqr, Argument::Ddqr, Argument::Tau, Argument::Gravity];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Argument::Pi => "pi",
            Argument::Q => "q",
            Argument::Dq => "dq",
            Argument::Ddq => "ddq",
            Argument::Dqr => "dqr",
            Argument::Ddqr => "ddqr",
            Argument::Tau => "tau",
            Argument::Gravity => "g0",
        }
    }

    /// The argument with this name.
    pub fn named(name: &str) -> Option<Argument> {
        Some(match name {
            "pi" => Argument::Pi,
            "q" => Argument::Q,
            "dq" => Argument::Dq,
            "ddq" => Argument::Ddq,
            "dqr" => Argument::Dqr,
            "ddqr" => Argument::Ddqr,
            "tau" => Argument::Tau,
            "g0" => Argument::Gravity,
            _ => return None,
        })
    }
}

/// A step; operands are the numbers of earlier steps.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// An entry of an argument.
    Input(Argument, usize),
    /// A literal, by its number in the function's text.
    Literal(usize),
    /// Sine of an angle.
    Sine(Angle),
    /// Cosine of an angle.
    Cosine(Angle),
    /// Sign of a joint rate.
    Sign(usize),
    /// Sign of a value.
    SignOf(usize),
    /// exp(-|dq| / v) of a joint rate, with a literal v.
    Stribeck(usize, usize),
    /// -a
    Negate(usize),
    /// a + b
    Add(usize, usize),
    /// a - b
    Subtract(usize, usize),
    /// a b
    Multiply(usize, usize),
    /// a b without rounding: its only use is an addition, which rounds once.
    Product(usize, usize),
    /// a / b
    Divide(usize, usize),
}

impl Step {
    /// The operands.
    pub fn operands(&self) -> [Option<usize>; 2] {
        match self {
            Step::Negate(a) | Step::SignOf(a) => [Some(*a), None],
            Step::Add(a, b) | Step::Subtract(a, b) | Step::Multiply(a, b) | Step::Product(a, b) | Step::Divide(a, b) => {
                [Some(*a), Some(*b)]
            }
            Step::Input(..) | Step::Literal(_) | Step::Sine(_) | Step::Cosine(_) | Step::Sign(_) | Step::Stribeck(..) => {
                [None, None]
            }
        }
    }
}

/// A sum of joint variables, perhaps times literals, plus or minus a constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Angle {
    /// Joints with their factors.
    pub terms: Vec<(usize, i64)>,
    /// The index of the constant among the [`turns`](Program::turns) of the function, and whether it is subtracted.
    pub turn: Option<(usize, bool)>,
    /// The literals that the terms are multiplied by, if any are.
    pub factors: Vec<Option<usize>>,
    /// Which of the description's computed angles it is ([`Angles`](crate::textbook::equations::angles::Angles)).
    pub computed: Option<usize>,
}

impl Angle {
    /// The same with joints by number, as programs store them, and without factors where there are none.
    #[must_use]
    pub fn sorted(self) -> Angle {
        let factors = self.factors.into_iter().chain(std::iter::repeat(None));
        let mut terms: Vec<_> = self.terms.into_iter().zip(factors).collect();
        terms.sort_unstable();
        let (terms, mut factors): (Vec<_>, Vec<Option<usize>>) = terms.into_iter().unzip();
        if factors.iter().all(Option::is_none) {
            factors.clear();
        }
        Angle { terms, factors, turn: self.turn, computed: self.computed }
    }

    /// Its terms with the factors that literals of these values give.
    pub fn scaled<E: Clone>(&self, literals: &[E]) -> Vec<Scaled<E>> {
        let factor = |i: usize| Some(literals[self.factors.get(i).copied().flatten()?].clone());
        self.terms.iter().enumerate().map(|(i, &(joint, sign))| (joint, sign, factor(i))).collect()
    }

    /// Its constant, with its sign.
    pub fn constant<E: Element>(&self, turns: &[usize], literals: &[E]) -> Option<E> {
        self.turn.map(|(k, minus)| {
            let size = literals[turns[k]].clone();
            if minus {
                size.negated()
            } else {
                size
            }
        })
    }
}

/// A literal in the text: digits without a sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Literal {
    /// Its digits in the text.
    pub text: String,
    /// Its value in the module's scalar.
    pub value: f64,
}

/// An entry of a result: its place and its step.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// `[0][1]`, `.inertia[0][1]`, or empty for a scalar.
    pub place: String,
    /// The step.
    pub step: usize,
}

/// A function of the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Arguments in order.
    pub arguments: Vec<Argument>,
    /// Steps in order.
    pub steps: Vec<Step>,
    /// Literals in the order of the text.
    pub literals: Vec<Literal>,
    /// The literals that are constants of angles.
    pub turns: Vec<usize>,
    /// Entries of the result, row by row.
    pub outputs: Vec<Output>,
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.place)
    }
}

/// A joint, the sign of its term, and the factor of that; `None` is 1.
pub type Scaled<E> = (usize, i64, Option<E>);

/// Values of the inputs of a program.
pub trait Inputs<E> {
    /// An entry of an argument.
    fn entry(&self, argument: Argument, index: usize) -> E;
    /// Sine and cosine of an integer combination of joint variables.
    fn sine_cosine(&self, angle: &[(usize, i64)]) -> (E, E);
    /// Sign of a joint rate.
    fn sign(&self, joint: usize) -> E;
    /// exp(-|dq| / velocity) of a joint rate.
    fn stribeck(&self, joint: usize, velocity: &E) -> E;
    /// Sine and cosine of an integer combination plus a constant.
    fn turned(&self, angle: &[(usize, i64)], turn: &Turn<'_, E>) -> (E, E);
    /// Sine and cosine of a sum of joint variables times factors, and a constant with a sign.
    fn scaled(&self, terms: &[Scaled<E>], constant: Option<E>) -> (E, E);
    /// Sine and cosine of a computed angle of the description, where these are inputs.
    fn computed(&self, _: usize) -> Option<(E, E)> {
        None
    }
}

/// The constant of an angle.
#[derive(Clone, Copy, Debug)]
pub struct Turn<'a, E> {
    /// Whether it is subtracted.
    pub minus: bool,
    /// The value of its literal.
    pub value: &'a E,
    /// Sine and cosine of the constant, if known.
    pub circle: Option<(&'a E, &'a E)>,
}

/// Sine and cosine of an angle plus a constant by the addition theorem, from those of the angle.
///
/// # Panics
/// If sine and cosine of the constant are unknown; [`Program::exact_literals`] provides them.
pub fn by_addition<E: Element>((sine, cosine): (E, E), turn: &Turn<'_, E>) -> (E, E) {
    let (s, c) = turn.circle.expect("exact literals come with the circles of turns");
    let s = if turn.minus { s.negated() } else { s.clone() };
    (sine.times(c).plus(&cosine.times(&s)), cosine.times(c).minus(&sine.times(&s)))
}

/// Cost limit for the exact values of a function, in products of words: squares of lengths, the cost of common divisors of fractions.
const MOST_WORK: u64 = 1 << 32;
/// The same for entries of a known length. In addition, a number of steps with values of four times that length, and a number per entry, are
/// allowed: the derivatives of the forward dynamics of 32 joints take 76 steps per entry, nearly all of them long.
const MOST_WORK_BESIDE: u64 = 1 << 28;
const LONG_STEPS: u64 = 1 << 12;
const LONG_STEPS_OF_AN_ENTRY: u64 = 1 << 6;

/// Limits on the length of exact values.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Maximum number of bits of a value.
    bits: usize,
    /// Maximum total cost in products of words.
    work: u64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits { bits: MOST_BITS, work: MOST_WORK }
    }
}

impl Limits {
    /// The limits for this number of entries with at most `longest` bits, where no function has an entry of more than `of_all` bits. Intermediate
    /// values are several times as long, or as long as the inverse of a matrix that another function returns; an acceleration with five roots
    /// can itself have a million bits.
    pub fn beside(longest: usize, of_all: usize, entries: usize) -> Limits {
        let long = of_all.max(4 * longest);
        let steps = LONG_STEPS + LONG_STEPS_OF_AN_ENTRY * entries as u64;
        Limits {
            bits: MOST_BITS.max(long),
            work: MOST_WORK_BESIDE.saturating_add(steps.saturating_mul(squared_words(long as u64))),
        }
    }
}

/// The square of the number of words for this number of bits.
fn squared_words(bits: u64) -> u64 {
    (bits / 64 + 1).saturating_pow(2)
}

impl Program {
    /// The entries of the result; `None` for those that divide by 0.
    pub fn run<E: Element>(&self, inputs: &impl Inputs<E>, literals: &[E]) -> Vec<Option<E>> {
        self.run_within(Limits::default(), inputs, literals)
    }

    /// The same with other limits.
    pub fn run_within<E: Element>(&self, limits: Limits, inputs: &impl Inputs<E>, literals: &[E]) -> Vec<Option<E>> {
        // Values with heap memory are dropped after their last use.
        let last = std::mem::needs_drop::<E>().then(|| self.last_uses());
        let values = self.execute(inputs, literals, last.as_deref(), limits);
        self.outputs.iter().map(|output| values[output.step].clone()).collect()
    }

    /// For each step the last step that uses it on the way to an entry. The value is `usize::MAX` for an entry, and the step itself if it is unused.
    fn last_uses(&self) -> Vec<usize> {
        let mut last: Vec<usize> = (0..self.steps.len()).collect();
        let needed = self.needed(&self.outputs.iter().map(|output| output.step).collect::<Vec<usize>>());
        for (i, step) in self.steps.iter().enumerate().filter(|(i, _)| needed[*i]) {
            step.operands().into_iter().flatten().for_each(|operand| last[operand] = i);
        }
        self.outputs.iter().for_each(|output| last[output.step] = usize::MAX);
        last
    }

    /// The exact values of the literals, then sine and cosine of each constant of an angle, as exact runs need them.
    pub fn exact_literals(&self, values: &[Formula]) -> Vec<Formula> {
        let circles = self.turns.iter().flat_map(|&literal| {
            let (sine, cosine) = values[literal].circle();
            [sine, cosine]
        });
        values.iter().cloned().chain(circles).collect()
    }

    /// The divisor of a step that divides by what may come close to 0.
    pub fn divisor(&self, step: &Step) -> Option<usize> {
        match step {
            Step::Divide(_, divisor) => Some(*divisor).filter(|&divisor| !self.exceeds_one(divisor)),
            _ => None,
        }
    }

    /// Whether a step is 1 + exp(-|dq| / v), the divisor of smooth friction.
    fn exceeds_one(&self, step: usize) -> bool {
        let is_one = |step: usize| matches!(self.steps[step], Step::Literal(literal) if self.literals[literal].value == 1.0);
        let decays = |step: usize| matches!(self.steps[step], Step::Stribeck(..));
        matches!(self.steps[step], Step::Add(a, b) if is_one(a) && decays(b) || is_one(b) && decays(a))
    }

    /// All such divisors, as steps.
    pub fn divisors(&self) -> Vec<usize> {
        let mut divisors: Vec<usize> = self.steps.iter().filter_map(|step| self.divisor(step)).collect();
        divisors.sort_unstable();
        divisors.dedup();
        divisors
    }

    /// The factors of a product without rounding.
    pub fn factors(&self, step: usize) -> Option<(usize, usize)> {
        match self.steps[step] {
            Step::Product(a, b) => Some((a, b)),
            _ => None,
        }
    }

    /// The subprogram that computes some steps, which become its results.
    pub fn part(&self, results: &[usize]) -> Program {
        let needed = self.needed(results);
        let mut number = vec![0; self.steps.len()];
        let mut steps: Vec<Step> = Vec::new();
        for (i, step) in self.steps.iter().enumerate().filter(|&(i, _)| needed[i]) {
            number[i] = steps.len();
            steps.push(match step {
                Step::SignOf(a) => Step::SignOf(number[*a]),
                Step::Negate(a) => Step::Negate(number[*a]),
                Step::Add(a, b) => Step::Add(number[*a], number[*b]),
                Step::Subtract(a, b) => Step::Subtract(number[*a], number[*b]),
                Step::Multiply(a, b) => Step::Multiply(number[*a], number[*b]),
                Step::Product(a, b) => Step::Product(number[*a], number[*b]),
                Step::Divide(a, b) => Step::Divide(number[*a], number[*b]),
                leaf => leaf.clone(),
            });
        }
        let outputs = results.iter().map(|&step| Output { place: String::new(), step: number[step] }).collect();
        Program { steps, outputs, ..self.clone() }
    }

    /// Which steps some steps need, themselves included.
    pub fn needed(&self, results: &[usize]) -> Vec<bool> {
        let mut needed = vec![false; self.steps.len()];
        results.iter().for_each(|&step| needed[step] = true);
        for (i, step) in self.steps.iter().enumerate().rev() {
            if needed[i] {
                step.operands().into_iter().flatten().for_each(|operand| needed[operand] = true);
            }
        }
        needed
    }

    /// The value of every step. `None` for a division by zero, and for all steps after numbers have exceeded the limits: 2^20 bits for a value, 2^32
    /// products of words in total.
    pub fn values<E: Element>(&self, inputs: &impl Inputs<E>, literals: &[E]) -> Vec<Option<E>> {
        self.execute(inputs, literals, None, Limits::default())
    }

    /// The same, dropping values after their last uses.
    fn execute<E: Element>(
        &self,
        inputs: &impl Inputs<E>,
        literals: &[E],
        last: Option<&[usize]>,
        limits: Limits,
    ) -> Vec<Option<E>> {
        let mut values: Vec<Option<E>> = Vec::with_capacity(self.steps.len());
        let mut work = 0;
        for (i, step) in self.steps.iter().enumerate() {
            if last.is_some_and(|last| last[i] == i) {
                values.push(None);
                continue;
            }
            let of = |i: &usize| values[*i].as_ref();
            let both = |a: &usize, b: &usize| Some((values[*a].as_ref()?, values[*b].as_ref()?));
            let wave = |angle: &Angle| {
                if let Some(circle) = angle.computed.and_then(|k| inputs.computed(k)) {
                    return circle;
                }
                if !angle.factors.is_empty() {
                    return inputs.scaled(&angle.scaled(literals), angle.constant(&self.turns, literals));
                }
                let Some((k, minus)) = angle.turn else { return inputs.sine_cosine(&angle.terms) };
                let at = self.literals.len() + 2 * k;
                let turn = Turn { minus, value: &literals[self.turns[k]], circle: literals.get(at).zip(literals.get(at + 1)) };
                inputs.turned(&angle.terms, &turn)
            };
            let value = match step {
                Step::Input(argument, index) => Some(inputs.entry(*argument, *index)),
                Step::Literal(index) => Some(literals[*index].clone()),
                Step::Sine(angle) => Some(wave(angle).0),
                Step::Cosine(angle) => Some(wave(angle).1),
                Step::Sign(joint) => Some(inputs.sign(*joint)),
                Step::Stribeck(joint, velocity) => Some(inputs.stribeck(*joint, &literals[*velocity])),
                Step::SignOf(a) => of(a).map(Element::sign),
                Step::Negate(a) => of(a).map(Element::negated),
                Step::Add(a, b) => match self.factors(*a).and_then(|(x, y)| both(&x, &y)) {
                    Some((x, y)) => of(b).map(|b| x.times_plus(y, b)),
                    None => both(a, b).map(|(a, b)| a.plus(b)),
                },
                Step::Subtract(a, b) => both(a, b).map(|(a, b)| a.minus(b)),
                Step::Multiply(a, b) | Step::Product(a, b) => both(a, b).map(|(a, b)| a.times(b)),
                Step::Divide(a, b) => both(a, b).and_then(|(a, b)| a.over(b)),
            };
            let own = value.as_ref().map_or(0, Element::bits);
            let operands = step.operands().into_iter().flatten().filter_map(|k| values[k].as_ref().map(Element::bits));
            work += squared_words((operands.sum::<usize>() + own) as u64);
            if own > limits.bits || work > limits.work {
                values.resize(self.steps.len(), None);
                break;
            }
            values.push(value);
            let Some(last) = last else { continue };
            step.operands().into_iter().flatten().chain([i]).filter(|&k| last[k] == i).for_each(|k| values[k] = None);
        }
        values
    }

    /// The reason why an entry has no value: a division by 0, or numbers beyond the limits.
    pub fn without_value<E: Element>(&self, inputs: &impl Inputs<E>, literals: &[E]) -> &'static str {
        let values = self.values(inputs, literals);
        let zero = |step: &usize| values[*step].as_ref().is_some_and(Element::is_zero);
        if self.steps.iter().any(|step| matches!(step, Step::Divide(_, divisor) if zero(divisor))) {
            "divides by 0"
        } else {
            "has exact values of more than 2^20 bits, or too many long ones, which no robot's has,"
        }
    }

    /// The entries that depend on a literal.
    pub fn entries_with(&self, literal: usize) -> impl Iterator<Item = usize> + '_ {
        let mut touched = vec![false; self.steps.len()];
        for (i, step) in self.steps.iter().enumerate() {
            touched[i] = match step {
                Step::Literal(index) | Step::Stribeck(_, index) => *index == literal,
                Step::Negate(a) | Step::SignOf(a) => touched[*a],
                Step::Add(a, b) | Step::Subtract(a, b) | Step::Multiply(a, b) | Step::Product(a, b) | Step::Divide(a, b) => {
                    touched[*a] || touched[*b]
                }
                Step::Sine(angle) | Step::Cosine(angle) => {
                    angle.turn.is_some_and(|(k, _)| self.turns[k] == literal) || angle.factors.contains(&Some(literal))
                }
                Step::Input(..) | Step::Sign(_) => false,
            };
        }
        (0..self.outputs.len()).filter(move |&i| touched[self.outputs[i].step])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_arms_stay_within_the_limits() {
        // The derivatives of the forward dynamics of a chain of 32 joints at a rational point: 3072 entries of 8048 bits in 232 986 steps.
        let work = 232_986 * squared_words(3 * 8192);
        assert!(Limits::beside(8048, 8048, 3072).work > work, "{work}");
        assert!(Limits::beside(200, 200, 16).work < 2 * MOST_WORK_BESIDE);
        // The inertia in the task of six joints with general angles: its steps hold inverses, as the derivatives of the forward dynamics do.
        let work = 5_500_000_000;
        assert!(Limits::beside(11_149, 112_524, 36).work > work && Limits::beside(11_149, 11_149, 36).work < work);
    }
}
