//! A function as lines to print, in the form that all languages share.
//!
//! A step that is used once is inlined into the step that uses it, as long as the line stays short. Every other step has a line
//! and a name, `t1`, `t2` and so on. Brackets appear only where the order of operations needs them, so that the same line means
//! the same operations in the same order wherever `+ - * /` bind as usual.
//!
//! The compile time of a straight line grows faster than its length: scheduling, vectorising and register allocation look at a
//! block as a whole. So a body of more than `LONG` lines is split into several functions. Each takes the values that it needs and
//! returns the values that later functions need. Names stay the same as in one piece.

use std::collections::{BTreeMap, BTreeSet};

use super::{Function, Operand, Operation, Scalar, Step};
use crate::catalogue::Argument;
use crate::exact::Number;
use crate::ring::field::computed::ComputedAngle;
use crate::ring::{AngleSum, Elementary, Symbol};

/// Steps with one use are inlined into the step that uses them, up to this many operands in a line.
const OPERANDS_IN_A_LINE: usize = 6;

/// A body of more lines than this is taken apart.
const LONG: usize = 4000;

/// Lines in a part.
const PART: usize = 1500;

/// A name that lines use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Name {
    /// An argument of the function.
    Argument(Argument),
    /// A sine or cosine.
    SineOrCosine(Symbol),
    /// A line.
    Step(usize),
}

/// The right-hand side of a line, or an entry of the result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expression {
    /// An entry of an argument, a sine or cosine, or the sign of a rate.
    Input(Symbol),
    /// A constant, with its sign.
    Constant(Number),
    /// exp(-|dq_i| / v) of a joint, with the velocity v.
    Stribeck(u16, Number),
    /// A line before.
    Step(usize),
    /// An operation.
    Operation(Operation, Box<Expression>, Box<Expression>),
    /// The product of the first two and the third, added to it in one operation that rounds once.
    Fused(Box<[Expression; 3]>),
    /// The sign of the inner expression.
    Sign(Box<Expression>),
    /// The inner expression, negated.
    Negation(Box<Expression>),
    /// The inner expression, in brackets.
    Brackets(Box<Expression>),
}

/// A line: its number and its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The number of its name.
    pub name: usize,
    /// Its value.
    pub value: Expression,
}

/// A piece of a long body: a function of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyPart {
    /// The arguments of the function that it uses.
    pub arguments: Vec<Argument>,
    /// The values that it takes.
    pub taken: Vec<Name>,
    /// Its lines.
    pub lines: Vec<Line>,
    /// The values that it returns.
    pub given: Vec<Name>,
}

/// The lines of a function in one piece.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    /// The lines.
    pub lines: Vec<Line>,
    /// The entries of the result, in order.
    pub entries: Vec<Expression>,
}

/// An angle whose sine or cosine a function uses: a sum of joint variables, and perhaps the constant angle of the module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Angle {
    /// The joints, and whether their variables are taken away.
    pub terms: Vec<(u16, bool)>,
    /// Whether the constant angle is added.
    pub turned: bool,
    /// Its own factors and constant, of an angle that the function computes; `terms` are then of its coordinates.
    pub computed: Option<ComputedAngle>,
    /// The name of its sine, where that is used.
    pub sine: Option<Name>,
    /// The name of its cosine, where that is used.
    pub cosine: Option<Name>,
}

impl Angle {
    /// The factors of its terms without their signs, `None` where a factor is 1.
    pub fn factors(&self) -> Vec<Option<Number>> {
        let size = |(_, factor): &(u16, Number)| {
            let size = if factor.is_negative() { -factor } else { factor.clone() };
            (!size.is_one()).then_some(size)
        };
        match &self.computed {
            Some(angle) => angle.factors.iter().map(size).collect(),
            None => vec![None; self.terms.len()],
        }
    }

    /// The constant that it adds; `turn` is that of turned sums.
    pub fn constant<'a>(&'a self, turn: Option<&'a Number>) -> Option<&'a Number> {
        match &self.computed {
            Some(angle) => Some(&angle.offset).filter(|offset| !offset.is_zero()),
            None => turn.filter(|_| self.turned),
        }
    }
}

impl Argument {
    /// The argument that a symbol is an entry of, or a function of an entry of.
    pub fn of(symbol: Symbol) -> Argument {
        match symbol {
            Symbol::Sine(_)
            | Symbol::Cosine(_)
            | Symbol::SineOf(_)
            | Symbol::CosineOf(_)
            | Symbol::Position(_)
            | Symbol::GravitySize(_)
            | Symbol::GravitySign(_) => Argument::Q,
            Symbol::Rate(_) | Symbol::OfRate(..) => Argument::Dq,
            Symbol::Acceleration(_) => Argument::Ddq,
            Symbol::ReferenceRate(_) => Argument::Dqr,
            Symbol::ReferenceAcceleration(_) => Argument::Ddqr,
            Symbol::Torque(_) => Argument::Tau,
            Symbol::Parameter(_) => Argument::Pi,
            Symbol::Gravity(_) => Argument::Gravity,
        }
    }
}

impl Name {
    fn of(symbol: Symbol) -> Name {
        if symbol.angle().is_some() {
            Name::SineOrCosine(symbol)
        } else {
            Name::Argument(Argument::of(symbol))
        }
    }

    /// The name: `q`, `t12`; of a sine or cosine `s2`, `c2`, `s2_3` of q2 + q3, `c1_2_less_4` of q1 + q2 - q4, `s7_turned` of q7 and the
    /// constant angle.
    pub fn text(self) -> String {
        match self {
            Name::Argument(argument) => argument.name().into(),
            Name::SineOrCosine(Symbol::Cosine(i)) => format!("c{}", i + 1),
            Name::SineOrCosine(Symbol::SineOf(sum)) => format!("s{}", of_sum(sum)),
            Name::SineOrCosine(Symbol::CosineOf(sum)) => format!("c{}", of_sum(sum)),
            Name::SineOrCosine(other) => format!("s{}", other.index() + 1),
            Name::Step(i) => format!("t{i}"),
        }
    }
}

/// C and MATLAB distinguish names by this many characters.
const LONGEST_NAME: usize = 63;

/// The joints of a sum, counted from 1; as sets of bits where a name of them would be too long: of 24 joints and more.
fn of_sum(sum: AngleSum) -> String {
    let mut text = String::new();
    for (k, (i, minus)) in sum.terms().enumerate() {
        let first = minus && (sum.plus.count_ones() as usize == k);
        text += if first {
            "_less_"
        } else if k > 0 {
            "_"
        } else {
            ""
        };
        text += &(i + 1).to_string();
    }
    let turned = if sum.turned { "_turned" } else { "" };
    // One more for the letter in front.
    if text.len() + turned.len() >= LONGEST_NAME {
        text = format!("0x{:x}", sum.plus);
        if sum.minus != 0 {
            text += &format!("_less_0x{:x}", sum.minus);
        }
    }
    text + turned
}

impl Function {
    /// The symbols that it uses, in order.
    pub fn symbols(&self) -> Vec<Symbol> {
        let operands = self.steps.iter().flat_map(|s| [&s.left, &s.right]).chain(self.outputs.iter().map(|o| &o.operand));
        let mut symbols: Vec<Symbol> = operands
            .filter_map(|operand| match operand {
                Operand::Input(symbol) => Some(*symbol),
                Operand::Step(_) | Operand::Constant(_) => None,
            })
            .collect();
        symbols.sort_unstable();
        symbols.dedup();
        symbols
    }

    /// Whether it takes the sign of a rate or of another value.
    pub fn takes_signs(&self) -> bool {
        self.steps.iter().any(|step| matches!(step.operation, Operation::Sign | Operation::OppositeSign))
            || self.symbols().iter().any(|symbol| matches!(symbol, Symbol::OfRate(Elementary::Sign, _)))
    }

    /// The arguments that its lines use directly, in order; an argument that only enters through its sine or cosine is not among them.
    pub fn used_arguments(&self) -> Vec<Argument> {
        let symbols = self.symbols();
        let used = |a: Argument| symbols.iter().any(|&s| Argument::of(s) == a && s.angle().is_none());
        self.arguments.iter().copied().filter(|&a| used(a)).collect()
    }

    /// The arguments that nothing of it uses, in order.
    pub fn unused_arguments(&self) -> Vec<Argument> {
        let symbols = self.symbols();
        self.arguments.iter().copied().filter(|&a| !symbols.iter().any(|&s| Argument::of(s) == a)).collect()
    }
}

/// The angles whose sines and cosines are among the symbols of a function: sums, then single joint variables, then those that it computes.
pub fn angles(symbols: &[Symbol], computed: &BTreeMap<u16, ComputedAngle>) -> Vec<Angle> {
    let mut sums: BTreeMap<AngleSum, Angle> = BTreeMap::new();
    let mut single: BTreeMap<u16, Angle> = BTreeMap::new();
    let plain = |terms: Vec<(u16, bool)>, turned: bool| Angle { terms, turned, computed: None, sine: None, cosine: None };
    let of_sum = |sum: AngleSum| plain(sum.terms().collect(), sum.turned);
    let of_one = |i: u16| match computed.get(&i) {
        Some(angle) => {
            let terms = angle.factors.iter().map(|(a, factor)| (*a, factor.is_negative())).collect();
            Angle { computed: Some(angle.clone()), ..plain(terms, false) }
        }
        None => plain(vec![(i, false)], false),
    };
    for &symbol in symbols {
        let name = Some(Name::SineOrCosine(symbol));
        match symbol {
            Symbol::Sine(i) => single.entry(i).or_insert_with(|| of_one(i)).sine = name,
            Symbol::Cosine(i) => single.entry(i).or_insert_with(|| of_one(i)).cosine = name,
            Symbol::SineOf(sum) => sums.entry(sum).or_insert_with(|| of_sum(sum)).sine = name,
            Symbol::CosineOf(sum) => sums.entry(sum).or_insert_with(|| of_sum(sum)).cosine = name,
            _ => {}
        }
    }
    sums.into_values().chain(single.into_values()).collect()
}

/// The shortest decimal that reads back as the float nearest to a number, with its sign.
pub fn decimal(value: &Number, scalar: Scalar) -> String {
    match scalar {
        Scalar::F64 => format!("{:?}", value.to_f64()),
        Scalar::F32 => format!("{:?}", value.to_f32()),
    }
}

impl Expression {
    /// The expression as an operand of an operation, in brackets where it needs them.
    fn inside(self, outer: Operation, right: bool) -> Expression {
        use Operation::{Add, Divide, Multiply, Subtract};
        let bare = match (&self, outer) {
            (Expression::Operation(Add | Subtract, ..), Multiply | Divide) => false,
            (Expression::Operation(Multiply | Divide, ..), Add | Subtract) => true,
            (Expression::Operation(..), _) => !right,
            _ => true,
        };
        if bare {
            self
        } else {
            Expression::Brackets(Box::new(self))
        }
    }

    /// Whether it begins with a sign: with a constant below 0.
    fn is_signed(&self) -> bool {
        match self {
            Expression::Constant(value) => value.to_f64().is_sign_negative(),
            Expression::Operation(_, left, _) => left.is_signed(),
            Expression::Negation(_) => true,
            Expression::Input(_)
            | Expression::Stribeck(..)
            | Expression::Step(_)
            | Expression::Fused(_)
            | Expression::Sign(_)
            | Expression::Brackets(_) => false,
        }
    }

    fn negated(self) -> Expression {
        // `--x` is a decrement in some languages, and compilers of others warn of it.
        let bare = !matches!(self, Expression::Operation(Operation::Add | Operation::Subtract, ..)) && !self.is_signed();
        Expression::Negation(Box::new(if bare { self } else { Expression::Brackets(Box::new(self)) }))
    }

    /// A product and an added or subtracted term as one operation; `self` is the product.
    fn fused(self, operation: Operation, product_is_left: bool, mut other: Expression) -> Expression {
        let Expression::Operation(_, left, right) = self else { unreachable!("a product that a sum takes is an operation") };
        let [mut left, right] = [left, right].map(|factor| match *factor {
            Expression::Brackets(inner) => *inner,
            factor => factor,
        });
        if operation == Operation::Subtract {
            let negated = if product_is_left { &mut other } else { &mut left };
            *negated = std::mem::replace(negated, Expression::Step(0)).negated();
        }
        Expression::Fused(Box::new([left, right, other]))
    }

    fn collect_constants<'a>(&'a self, constants: &mut Vec<&'a Number>) {
        match self {
            Expression::Constant(value) | Expression::Stribeck(_, value) => constants.push(value),
            Expression::Input(_) | Expression::Step(_) => {}
            Expression::Operation(_, left, right) => {
                left.collect_constants(constants);
                right.collect_constants(constants);
            }
            Expression::Fused(parts) => parts.iter().for_each(|part| part.collect_constants(constants)),
            Expression::Sign(inner) | Expression::Negation(inner) | Expression::Brackets(inner) => {
                inner.collect_constants(constants)
            }
        }
    }

    fn collect_names(&self, names: &mut BTreeSet<Name>) {
        match self {
            Expression::Input(symbol) => {
                names.insert(Name::of(*symbol));
            }
            Expression::Stribeck(..) => {
                names.insert(Name::Argument(Argument::Dq));
            }
            Expression::Step(i) => {
                names.insert(Name::Step(*i));
            }
            Expression::Constant(_) => {}
            Expression::Operation(_, left, right) => {
                left.collect_names(names);
                right.collect_names(names);
            }
            Expression::Fused(parts) => parts.iter().for_each(|part| part.collect_names(names)),
            Expression::Sign(inner) | Expression::Negation(inner) | Expression::Brackets(inner) => inner.collect_names(names),
        }
    }
}

fn names<'a>(expressions: impl Iterator<Item = &'a Expression>) -> BTreeSet<Name> {
    let mut names = BTreeSet::new();
    expressions.for_each(|expression| expression.collect_names(&mut names));
    names
}

/// An expression in the making, and how many operands it has.
struct Made {
    expression: Expression,
    operands: usize,
}

impl Made {
    /// For what needs it: of a line its name, everything else is needed once.
    fn take(&mut self) -> Made {
        let expression = match self.expression {
            Expression::Step(line) => Expression::Step(line),
            _ => std::mem::replace(&mut self.expression, Expression::Step(0)),
        };
        Made { expression, operands: self.operands }
    }
}

impl Listing {
    /// The lines of a function.
    pub fn of(function: &Function) -> Listing {
        let (uses, fused) = (function.uses(), function.products_in_sums());
        // An exponential is taken once, in a line of its own.
        let mut lines: Vec<Line> = function
            .stribeck
            .iter()
            .zip(1..)
            .map(|((&joint, velocity), name)| Line { name, value: Expression::Stribeck(joint, velocity.clone()) })
            .collect();
        let fading: BTreeMap<u16, usize> = function.stribeck.keys().copied().zip(1..).collect();
        let mut made: Vec<Made> = Vec::with_capacity(function.steps.len());
        let operand = |made: &mut [Made], operand: &Operand| match operand {
            Operand::Step(i) => made[*i as usize].take(),
            Operand::Input(Symbol::OfRate(Elementary::Decay, i)) => Made { expression: Expression::Step(fading[i]), operands: 1 },
            Operand::Input(symbol) => Made { expression: Expression::Input(*symbol), operands: 1 },
            Operand::Constant(value) => Made { expression: Expression::Constant(value.clone()), operands: 1 },
        };
        for (i, (Step { operation, left, right }, uses)) in function.steps.iter().zip(uses).enumerate() {
            let is_fused = |operand: &Operand| matches!(operand, Operand::Step(i) if fused[*i as usize]);
            let takes = [is_fused(left), is_fused(right)];
            let (left, right) = (operand(&mut made, left), operand(&mut made, right));
            if let Operation::Sign | Operation::OppositeSign = operation {
                let of = if *operation == Operation::Sign { left.expression } else { left.expression.negated() };
                let expression = Expression::Sign(Box::new(of));
                made.push(if uses == 1 {
                    Made { expression, operands: 1 }
                } else {
                    let name = lines.len() + 1;
                    lines.push(Line { name, value: expression });
                    Made { expression: Expression::Step(name), operands: 1 }
                });
                continue;
            }
            let operands = left.operands + right.operands;
            let expression = match takes {
                [true, _] => left.expression.fused(*operation, true, right.expression),
                [_, true] => right.expression.fused(*operation, false, left.expression),
                [false, false] => {
                    let (left, right) = (left.expression.inside(*operation, false), right.expression.inside(*operation, true));
                    Expression::Operation(*operation, Box::new(left), Box::new(right))
                }
            };
            made.push(if fused[i] || uses == 1 && operands <= OPERANDS_IN_A_LINE {
                Made { expression, operands }
            } else {
                let name = lines.len() + 1;
                lines.push(Line { name, value: expression });
                Made { expression: Expression::Step(name), operands: 1 }
            });
        }
        let entries = function.outputs.iter().map(|output| {
            let value = operand(&mut made, &output.operand).expression;
            if output.negated {
                value.negated()
            } else {
                value
            }
        });
        let entries = entries.collect();
        Listing { lines, entries }
    }

    /// The constants in the order in which they are printed, with their signs.
    pub fn constants(&self) -> Vec<&Number> {
        let mut constants = Vec::new();
        let all = self.lines.iter().map(|line| &line.value).chain(&self.entries);
        all.for_each(|expression| expression.collect_constants(&mut constants));
        constants
    }

    /// Number of lines up to and including the last line that these entries use.
    pub fn lines_before(&self, entries: &[usize]) -> usize {
        let of_line = |name: &Name| match name {
            Name::Step(line) => Some(*line),
            Name::Argument(_) | Name::SineOrCosine(_) => None,
        };
        names(entries.iter().map(|&entry| &self.entries[entry])).iter().filter_map(of_line).max().unwrap_or(0)
    }

    /// The lines of a long body in parts; none where it is not long.
    pub fn parts(&self) -> Vec<BodyPart> {
        if self.lines.len() <= LONG {
            return Vec::new();
        }
        // The part that uses each name last; names that the result needs last beyond every part.
        let values = |chunk: &[Line]| names(chunk.iter().map(|line| &line.value));
        let mut last_use: BTreeMap<Name, usize> = BTreeMap::new();
        for (part, chunk) in self.lines.chunks(PART).enumerate() {
            last_use.extend(values(chunk).into_iter().map(|name| (name, part)));
        }
        last_use.extend(names(self.entries.iter()).into_iter().map(|name| (name, usize::MAX)));
        let part = |(part, chunk): (usize, &[Line])| {
            let own: BTreeSet<Name> = chunk.iter().map(|line| Name::Step(line.name)).collect();
            let needed: BTreeSet<Name> = values(chunk).difference(&own).copied().collect();
            let given = own.iter().filter(|name| last_use.get(name).is_some_and(|&last| last > part)).copied().collect();
            let argument = |name: &Name| match name {
                Name::Argument(argument) => Some(*argument),
                Name::SineOrCosine(_) | Name::Step(_) => None,
            };
            BodyPart {
                arguments: needed.iter().filter_map(argument).collect(),
                taken: needed.iter().filter(|name| argument(name).is_none()).copied().collect(),
                lines: chunk.to_vec(),
                given,
            }
        };
        self.lines.chunks(PART).enumerate().map(part).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::quantities::gravity::GRAVITY;
    use crate::program::Output;

    /// An expression as most languages write it.
    fn text(expression: &Expression) -> String {
        match expression {
            Expression::Input(symbol) => format!("{}{}", Argument::of(*symbol).name(), symbol.index() + 1),
            Expression::Constant(value) => decimal(value, Scalar::F64),
            Expression::Stribeck(i, velocity) => format!("stribeck(dq{}, {})", i + 1, decimal(velocity, Scalar::F64)),
            Expression::Step(i) => Name::Step(*i).text(),
            Expression::Operation(operation, left, right) => {
                let sign = match operation {
                    Operation::Add => '+',
                    Operation::Subtract => '-',
                    Operation::Multiply => '*',
                    Operation::Divide => '/',
                    Operation::Sign | Operation::OppositeSign => unreachable!("of one operand"),
                };
                format!("{} {sign} {}", text(left), text(right))
            }
            Expression::Fused(parts) => format!("fma({}, {}, {})", text(&parts[0]), text(&parts[1]), text(&parts[2])),
            Expression::Sign(inner) => format!("sign({})", text(inner)),
            Expression::Negation(inner) => format!("-{}", text(inner)),
            Expression::Brackets(inner) => format!("({})", text(inner)),
        }
    }

    fn rate(i: u16) -> Operand {
        Operand::Input(Symbol::Rate(i))
    }

    /// The lines and entries of steps and outputs.
    #[track_caller]
    fn check(steps: &[(Operand, Operation, Operand)], outputs: &[(Operand, bool)], lines: &[&str], entries: &[&str]) {
        check_either(false, steps, outputs, lines, entries);
    }

    /// The same with fused operations.
    #[track_caller]
    fn check_fused(steps: &[(Operand, Operation, Operand)], outputs: &[(Operand, bool)], lines: &[&str], entries: &[&str]) {
        check_either(true, steps, outputs, lines, entries);
    }

    #[track_caller]
    fn check_either(
        fuse: bool,
        steps: &[(Operand, Operation, Operand)],
        outputs: &[(Operand, bool)],
        lines: &[&str],
        entries: &[&str],
    ) {
        let step = |(left, operation, right): &(Operand, Operation, Operand)| Step {
            operation: *operation,
            left: left.clone(),
            right: right.clone(),
        };
        let function = Function {
            quantity: &GRAVITY,
            with_parameters: false,
            arguments: vec![Argument::Dq],
            steps: steps.iter().map(step).collect(),
            outputs: outputs.iter().map(|(operand, negated)| Output { operand: operand.clone(), negated: *negated }).collect(),
            method: "hand",
            stribeck: BTreeMap::new(),
            computed: BTreeMap::new(),
            fuse,
        };
        let listing = Listing::of(&function);
        let found: Vec<String> = listing.lines.iter().map(|line| format!("t{} = {}", line.name, text(&line.value))).collect();
        assert_eq!(found, lines);
        assert_eq!(listing.entries.iter().map(text).collect::<Vec<_>>(), entries);
    }

    #[test]
    fn brackets_stand_where_the_order_of_operations_needs_them() {
        use Operation::{Add, Divide, Multiply, Subtract};
        let sum = (rate(0), Add, rate(1));
        for (outer, right, expected) in [
            (Add, false, "dq1 + dq2 + dq3"),
            (Add, true, "dq3 + (dq1 + dq2)"),
            (Subtract, false, "dq1 + dq2 - dq3"),
            (Subtract, true, "dq3 - (dq1 + dq2)"),
            (Multiply, false, "(dq1 + dq2) * dq3"),
            (Divide, true, "dq3 / (dq1 + dq2)"),
        ] {
            let (inner, other) = (Operand::Step(0), rate(2));
            let (left, right) = if right { (other, inner) } else { (inner, other) };
            check(&[sum.clone(), (left, outer, right)], &[(Operand::Step(1), false)], &[], &[expected]);
        }
        let product = (rate(0), Multiply, rate(1));
        for (outer, right, expected) in [
            (Subtract, true, "dq3 - dq1 * dq2"),
            (Multiply, false, "dq1 * dq2 * dq3"),
            (Multiply, true, "dq3 * (dq1 * dq2)"),
            (Divide, true, "dq3 / (dq1 * dq2)"),
        ] {
            let (inner, other) = (Operand::Step(0), rate(2));
            let (left, right) = if right { (other, inner) } else { (inner, other) };
            check(&[product.clone(), (left, outer, right)], &[(Operand::Step(1), false)], &[], &[expected]);
        }
    }

    #[test]
    fn what_is_used_twice_has_a_line_and_no_sign_follows_a_sign() {
        use Operation::{Add, Multiply};
        let minus_two = || Operand::Constant(Number::from(-2));
        check(
            &[(rate(0), Multiply, rate(0)), (Operand::Step(0), Add, rate(1)), (minus_two(), Multiply, Operand::Step(0))],
            &[(Operand::Step(0), true), (Operand::Step(1), true), (Operand::Step(2), true), (minus_two(), false)],
            &["t1 = dq1 * dq1"],
            &["-t1", "-(t1 + dq2)", "-(-2.0 * t1)", "-2.0"],
        );
    }

    #[test]
    fn a_product_that_a_sum_alone_takes_is_fused_with_it() {
        use Operation::{Add, Multiply, Subtract};
        let product = (rate(0), Multiply, rate(1));
        let of_sum = [(rate(0), Add, rate(1)), (Operand::Step(0), Multiply, rate(2))];
        let end = [(Operand::Step(1), false)];
        for (operation, right, fused) in [
            (Add, false, "fma(dq1, dq2, dq3)"),
            (Add, true, "fma(dq1, dq2, dq3)"),
            (Subtract, false, "fma(dq1, dq2, -dq3)"),
            (Subtract, true, "fma(-dq1, dq2, dq3)"),
        ] {
            let (left, right) = if right { (rate(2), Operand::Step(0)) } else { (Operand::Step(0), rate(2)) };
            check_fused(&[product.clone(), (left, operation, right)], &end, &[], &[fused]);
        }
        // No brackets around a factor, and of two products the left one.
        let sum = [&of_sum[..], &[(rate(0), Subtract, Operand::Step(1))]].concat();
        check_fused(&sum, &[(Operand::Step(2), true)], &[], &["-fma(-(dq1 + dq2), dq3, dq1)"]);
        let other = [product.clone(), (rate(2), Multiply, rate(3)), (Operand::Step(0), Subtract, Operand::Step(1))];
        check_fused(&other, &[(Operand::Step(2), false)], &[], &["fma(dq1, dq2, -dq3 * dq4)"]);
        // A product that is used twice, and one that is a result, are rounded.
        let twice = [product.clone(), (Operand::Step(0), Add, rate(2)), (Operand::Step(0), Add, rate(3))];
        let outputs = [(Operand::Step(1), false), (Operand::Step(2), false)];
        check_fused(&twice, &outputs, &["t1 = dq1 * dq2"], &["t1 + dq3", "t1 + dq4"]);
        check_fused(
            &twice[..2],
            &[(Operand::Step(1), false), (Operand::Step(0), false)],
            &["t1 = dq1 * dq2"],
            &["t1 + dq3", "t1"],
        );
    }

    #[test]
    fn a_long_body_hands_on_what_later_parts_need() {
        use Operation::Add;
        // Each step is used twice, and the first by the result.
        let count = 2 * PART + LONG;
        let mut steps = vec![(rate(0), Add, rate(1))];
        for i in 1..count as u32 {
            steps.push((Operand::Step(i - 1), Add, Operand::Step(i - 1)));
        }
        let step = |(left, operation, right): &(Operand, Operation, Operand)| Step {
            operation: *operation,
            left: left.clone(),
            right: right.clone(),
        };
        let outputs = [0, count as u32 - 1].map(|i| Output { operand: Operand::Step(i), negated: false });
        let function = Function {
            quantity: &GRAVITY,
            with_parameters: false,
            arguments: vec![Argument::Dq],
            steps: steps.iter().map(step).collect(),
            outputs: outputs.to_vec(),
            method: "hand",
            stribeck: BTreeMap::new(),
            computed: BTreeMap::new(),
            fuse: false,
        };
        let listing = Listing::of(&function);
        let parts = listing.parts();
        assert_eq!(parts.iter().map(|part| part.lines.len()).sum::<usize>(), listing.lines.len());
        assert_eq!((parts[0].arguments.as_slice(), parts[0].taken.as_slice()), (&[Argument::Dq][..], &[][..]));
        assert_eq!(parts[0].given, [Name::Step(1), Name::Step(PART)]);
        for (before, part) in parts.iter().zip(&parts[1..]) {
            assert!(part.arguments.is_empty());
            assert_eq!(part.taken, [Name::Step(before.lines[PART - 1].name)]);
        }
        let last = parts.last().expect("parts");
        assert_eq!(last.given, [Name::Step(last.lines[last.lines.len() - 1].name)]);
    }
}
