//! From a function to a program: values get places by their last use, and a product that one sum takes is joined with it.

use std::fmt;

use crate::function::{Angle, Argument, Function, Input, Operand, Operator, Output, Result as Part, Sines};
use crate::scalar::Scalar;

/// A function in a form that can be executed.
#[derive(Clone, Debug)]
pub struct Program<T> {
    name: String,
    arguments: Vec<Argument>,
    results: Vec<Part>,
    pub(crate) sines: Sines,
    pub(crate) waves: Vec<Wave<T>>,
    pub(crate) loads: Vec<Load<T>>,
    pub(crate) instructions: Vec<Instruction<T>>,
    pub(crate) stores: Vec<Store>,
    pub(crate) places: usize,
    pub(crate) processor: pulp::Arch,
}

/// An angle, and the places of its sine and cosine, where these are used.
#[derive(Clone, Debug)]
pub(crate) struct Wave<T> {
    pub(crate) angle: Angle<T>,
    pub(crate) sine: Option<u32>,
    pub(crate) cosine: Option<u32>,
}

/// An entry of an argument and the place that it goes to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load<T> {
    pub(crate) argument: usize,
    pub(crate) entry: usize,
    pub(crate) form: Form<T>,
    pub(crate) place: u32,
}

/// The use of an entry.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form<T> {
    Itself,
    Sign,
    Fading(T),
}

/// An entry of the result: its place, and whether it is negated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Store {
    pub(crate) place: u32,
    pub(crate) negated: bool,
}

/// The kind of an instruction on the places a, b, c and the constant k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    /// a + b
    Add,
    /// a - b
    Subtract,
    /// a b
    Multiply,
    /// a / b
    Divide,
    /// sign(a)
    Sign,
    /// sign(-a)
    OppositeSign,
    /// a + k
    AddConstant,
    /// a - k
    SubtractConstant,
    /// k - a
    SubtractFromConstant,
    /// a k
    MultiplyConstant,
    /// a / k
    DivideByConstant,
    /// k / a
    DivideConstant,
    /// a b + c, rounded twice
    MultiplyAdd,
    /// a b - c, rounded twice
    MultiplySubtract,
    /// c - a b, rounded twice
    SubtractProduct,
    /// a k + c, rounded twice
    MultiplyConstantAdd,
    /// a k - c, rounded twice
    MultiplyConstantSubtract,
    /// c - a k, rounded twice
    SubtractConstantProduct,
    /// k
    Constant,
}

/// An instruction; places that its kind does not use are 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instruction<T> {
    pub(crate) code: Code,
    pub(crate) to: u32,
    pub(crate) a: u32,
    pub(crate) b: u32,
    pub(crate) c: u32,
    pub(crate) k: T,
}

/// Reasons why a function is no program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Invalid {
    /// This operation, or an output, uses a value that is not computed before it.
    Value {
        /// The place of the operation; `None` for an output.
        operation: Option<usize>,
        /// The number of the value.
        value: usize,
    },
    /// An input names an entry or an angle that does not exist.
    Input {
        /// The input, by its place.
        input: usize,
    },
    /// An angle has no terms, begins with a subtraction, has another number of factors, or names entries that do not exist.
    Angle {
        /// The angle, by its place.
        angle: usize,
    },
    /// The number of outputs differs from the number of entries in the results.
    Shapes {
        /// Entries of the shapes.
        entries: usize,
        /// Outputs.
        outputs: usize,
    },
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Invalid::Value { operation: Some(operation), value } => {
                write!(f, "operation {operation} uses value {value}, which does not stand before it")
            }
            Invalid::Value { operation: None, value } => write!(f, "an output is value {value}, which does not exist"),
            Invalid::Input { input } => write!(f, "input {input} is of an entry or an angle that does not exist"),
            Invalid::Angle { angle } => write!(f, "angle {angle} is not a sum that begins with an entry of an argument"),
            Invalid::Shapes { entries, outputs } => {
                write!(f, "the shapes of the results have {entries} entries, and the function has {outputs} outputs")
            }
        }
    }
}

impl std::error::Error for Invalid {}

/// An instruction on values, before they have places.
#[derive(Clone, Copy)]
struct Draft<T> {
    code: Code,
    to: usize,
    a: Option<usize>,
    b: Option<usize>,
    c: Option<usize>,
    k: T,
}

impl<T> Draft<T> {
    fn operands(&self) -> [Option<usize>; 3] {
        [self.a, self.b, self.c]
    }
}

impl<T: Scalar> Program<T> {
    /// The program of a function.
    ///
    /// Errors: a name of something that does not exist, or shapes that do not match the outputs.
    pub fn new(function: &Function<T>) -> Result<Self, Invalid> {
        check(function)?;
        let inputs = function.inputs.len();
        let mut values = inputs + function.operations.len();
        let drafts = drafts(function, &mut values);
        let (drafts, outputs) = with_outputs(function, drafts, &mut values);
        let (mut places, last) = (Places::new(values), last_uses(&drafts, &outputs, values));
        for input in 0..inputs {
            places.give(input);
        }
        let place_of = |wanted: &dyn Fn(&Input<T>) -> bool| function.inputs.iter().position(wanted);
        let wave = |(i, angle): (usize, &Angle<T>)| Wave {
            angle: angle.clone(),
            sine: place_of(&|input| *input == Input::Sine(i)).map(|value| places.of[value]),
            cosine: place_of(&|input| *input == Input::Cosine(i)).map(|value| places.of[value]),
        };
        let waves = function.angles.iter().enumerate().map(wave).collect();
        let load = |(value, input): (usize, &Input<T>)| {
            let (argument, entry, form) = match *input {
                Input::Entry { argument, entry } => (argument, entry, Form::Itself),
                Input::Sign { argument, entry } => (argument, entry, Form::Sign),
                Input::Fading { argument, entry, velocity } => (argument, entry, Form::Fading(velocity)),
                Input::Sine(_) | Input::Cosine(_) => return None,
            };
            Some(Load { argument, entry, form, place: places.of[value] })
        };
        let loads = function.inputs.iter().enumerate().filter_map(load).collect();
        let mut instructions = Vec::with_capacity(drafts.len());
        for (time, draft) in drafts.iter().enumerate() {
            let [a, b, c] = draft.operands().map(|value| value.map_or(0, |value| places.of[value]));
            // An instruction reads before it writes, so its result may take the place of an operand.
            for value in draft.operands().into_iter().flatten() {
                if last[value] == Some(time) {
                    places.release(value);
                }
            }
            places.give(draft.to);
            let to = places.of[draft.to];
            if last[draft.to].is_none() {
                places.release(draft.to);
            }
            instructions.push(Instruction { code: draft.code, to, a, b, c, k: draft.k });
        }
        let store = |(value, negated): &(usize, bool)| Store { place: places.of[*value], negated: *negated };
        Ok(Program {
            name: function.name.clone(),
            arguments: function.arguments.clone(),
            results: function.results.clone(),
            sines: function.sines,
            waves,
            loads,
            instructions,
            stores: outputs.iter().map(store).collect(),
            places: places.count as usize,
            processor: pulp::Arch::new(),
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its arguments, in order.
    pub fn arguments(&self) -> &[Argument] {
        &self.arguments
    }

    /// The parts of its result, in order.
    pub fn results(&self) -> &[Part] {
        &self.results
    }

    /// The number of entries of its result.
    pub fn outputs(&self) -> usize {
        self.stores.len()
    }
}

fn check<T: Scalar>(function: &Function<T>) -> Result<(), Invalid> {
    let is_entry = |argument: usize, entry: usize| function.arguments.get(argument).is_some_and(|of| entry < of.length);
    for (i, angle) in function.angles.iter().enumerate() {
        let begins = angle.terms.first().is_some_and(|&(_, minus)| !minus);
        let fits = angle.factors.is_empty() || angle.factors.len() == angle.terms.len();
        if !begins || !fits || !angle.terms.iter().all(|&(entry, _)| is_entry(angle.argument, entry)) {
            return Err(Invalid::Angle { angle: i });
        }
    }
    for (i, input) in function.inputs.iter().enumerate() {
        let is_there = match *input {
            Input::Entry { argument, entry } | Input::Sign { argument, entry } | Input::Fading { argument, entry, .. } => {
                is_entry(argument, entry)
            }
            Input::Sine(angle) | Input::Cosine(angle) => angle < function.angles.len() && !function.inputs[..i].contains(input),
        };
        if !is_there {
            return Err(Invalid::Input { input: i });
        }
    }
    let inputs = function.inputs.len();
    for (i, operation) in function.operations.iter().enumerate() {
        for operand in [operation.left, operation.right] {
            match operand {
                Operand::Value(value) if value >= inputs + i => return Err(Invalid::Value { operation: Some(i), value }),
                Operand::Value(_) | Operand::Constant(_) => {}
            }
        }
    }
    for output in &function.outputs {
        match output.operand {
            Operand::Value(value) if value >= inputs + function.operations.len() => {
                return Err(Invalid::Value { operation: None, value })
            }
            Operand::Value(_) | Operand::Constant(_) => {}
        }
    }
    let entries = function.results.iter().map(|part| part.shape.iter().product::<usize>()).sum();
    if entries != function.outputs.len() {
        return Err(Invalid::Shapes { entries, outputs: function.outputs.len() });
    }
    Ok(())
}

/// The instructions of the operations. A constant that an instruction has no room for becomes a value of its own, numbered from `values` on.
fn drafts<T: Scalar>(function: &Function<T>, values: &mut usize) -> Vec<Draft<T>> {
    let inputs = function.inputs.len();
    let mut uses = vec![0; *values];
    let operands = function.operations.iter().flat_map(|operation| match operation.operator {
        Operator::Sign | Operator::OppositeSign => vec![operation.left],
        _ => vec![operation.left, operation.right],
    });
    for operand in operands.chain(function.outputs.iter().map(|output| output.operand)) {
        if let Operand::Value(value) = operand {
            uses[value] += 1;
        }
    }
    let mut drafts: Vec<Option<Draft<T>>> = Vec::with_capacity(function.operations.len());
    // The products that a sum may take, by their values.
    let mut products: Vec<Option<usize>> = vec![None; *values];
    for (i, operation) in function.operations.iter().enumerate() {
        use Operand::{Constant, Value};
        let (to, zero) = (inputs + i, T::default());
        let mut alone = |k: T| {
            drafts.push(Some(Draft { code: Code::Constant, to: *values, a: None, b: None, c: None, k }));
            *values += 1;
            Value(*values - 1)
        };
        let is_sign = matches!(operation.operator, Operator::Sign | Operator::OppositeSign);
        let (left, right) = match (operation.left, operation.right) {
            (Constant(k), _) if is_sign => (alone(k), Constant(zero)),
            (left, _) if is_sign => (left, Constant(zero)),
            (Constant(left), right @ Constant(_)) => (alone(left), right),
            operands => operands,
        };
        let of_two = |code, a, b| Draft { code, to, a: Some(a), b: Some(b), c: None, k: zero };
        let of_one = |code, a, k| Draft { code, to, a: Some(a), b: None, c: None, k };
        let draft = match (operation.operator, left, right) {
            (Operator::Add | Operator::Subtract, Value(a), Value(b)) => {
                let of_operator = operation.operator == Operator::Add;
                let joined = match (products[a], products[b]) {
                    (Some(product), _) => Some((product, b, true)),
                    (None, Some(product)) => Some((product, a, false)),
                    (None, None) => None,
                };
                let product = joined.and_then(|(product, other, is_left)| Some((drafts[product].take()?, other, is_left)));
                match product {
                    Some((product, other, is_left)) => {
                        let code = match (product.code == Code::Multiply, of_operator, is_left) {
                            (true, true, _) => Code::MultiplyAdd,
                            (true, false, true) => Code::MultiplySubtract,
                            (true, false, false) => Code::SubtractProduct,
                            (false, true, _) => Code::MultiplyConstantAdd,
                            (false, false, true) => Code::MultiplyConstantSubtract,
                            (false, false, false) => Code::SubtractConstantProduct,
                        };
                        Draft { code, to, c: Some(other), ..product }
                    }
                    None => of_two(if of_operator { Code::Add } else { Code::Subtract }, a, b),
                }
            }
            (Operator::Add, Value(a), Constant(k)) | (Operator::Add, Constant(k), Value(a)) => of_one(Code::AddConstant, a, k),
            (Operator::Subtract, Value(a), Constant(k)) => of_one(Code::SubtractConstant, a, k),
            (Operator::Subtract, Constant(k), Value(a)) => of_one(Code::SubtractFromConstant, a, k),
            (Operator::Multiply, Value(a), Value(b)) => of_two(Code::Multiply, a, b),
            (Operator::Multiply, Value(a), Constant(k)) | (Operator::Multiply, Constant(k), Value(a)) => {
                of_one(Code::MultiplyConstant, a, k)
            }
            (Operator::Divide, Value(a), Value(b)) => of_two(Code::Divide, a, b),
            (Operator::Divide, Value(a), Constant(k)) => of_one(Code::DivideByConstant, a, k),
            (Operator::Divide, Constant(k), Value(a)) => of_one(Code::DivideConstant, a, k),
            (Operator::Sign, Value(a), _) => of_one(Code::Sign, a, zero),
            (Operator::OppositeSign, Value(a), _) => of_one(Code::OppositeSign, a, zero),
            (_, Constant(_), _) => unreachable!("a left constant beside a constant is a value"),
        };
        if uses[to] == 1 && matches!(draft.code, Code::Multiply | Code::MultiplyConstant) {
            products[to] = Some(drafts.len());
        }
        drafts.push(Some(draft));
    }
    drafts.into_iter().flatten().collect()
}

/// The instructions with those that make constants of outputs; the values of the outputs and whether they are negated.
fn with_outputs<T: Scalar>(
    function: &Function<T>,
    mut drafts: Vec<Draft<T>>,
    values: &mut usize,
) -> (Vec<Draft<T>>, Vec<(usize, bool)>) {
    let mut outputs = Vec::with_capacity(function.outputs.len());
    for Output { operand, negated } in &function.outputs {
        let value = match *operand {
            Operand::Value(value) => value,
            Operand::Constant(k) => {
                drafts.push(Draft { code: Code::Constant, to: *values, a: None, b: None, c: None, k });
                *values += 1;
                *values - 1
            }
        };
        outputs.push((value, *negated));
    }
    (drafts, outputs)
}

/// The last instruction that uses each value: `usize::MAX` for an output, `None` for an unused value.
fn last_uses<T>(drafts: &[Draft<T>], outputs: &[(usize, bool)], values: usize) -> Vec<Option<usize>> {
    let mut last = vec![None; values];
    for (time, draft) in drafts.iter().enumerate() {
        draft.operands().into_iter().flatten().for_each(|value| last[value] = Some(time));
    }
    outputs.iter().for_each(|&(value, _)| last[value] = Some(usize::MAX));
    last
}

/// The places of values.
struct Places {
    of: Vec<u32>,
    free: Vec<u32>,
    count: u32,
    is_held: Vec<bool>,
}

impl Places {
    fn new(values: usize) -> Places {
        Places { of: vec![0; values], free: Vec::new(), count: 0, is_held: vec![false; values] }
    }

    fn give(&mut self, value: usize) {
        self.of[value] = self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        });
        self.is_held[value] = true;
    }

    /// Releases the place of a value. A second release, of an operand that an instruction uses twice, does nothing.
    fn release(&mut self, value: usize) {
        if std::mem::take(&mut self.is_held[value]) {
            self.free.push(self.of[value]);
        }
    }
}
