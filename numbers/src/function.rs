//! A function as plain data.
//!
//! Values are numbered: first the inputs, then the results of the operations, in order.

/// A function of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Function<T> {
    /// Its name.
    pub name: String,
    /// Its arguments, in order.
    pub arguments: Vec<Argument>,
    /// The parts of its result, in order.
    pub results: Vec<Result>,
    /// Where sines and cosines come from.
    pub sines: Sines,
    /// Angles whose sines or cosines are inputs.
    pub angles: Vec<Angle<T>>,
    /// Values that the operations begin with.
    pub inputs: Vec<Input<T>>,
    /// Operations in order.
    pub operations: Vec<Operation<T>>,
    /// Entries of the result, row by row, of one part after the other.
    pub outputs: Vec<Output<T>>,
}

/// An argument: a vector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Argument {
    /// Its name.
    pub name: String,
    /// Its number of entries.
    pub length: usize,
}

/// A part of a result: a number, a vector, a matrix or a list of matrices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Result {
    /// Its name.
    pub name: String,
    /// Its dimensions, outermost first; empty for a number.
    pub shape: Vec<usize>,
}

/// Where sines and cosines come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sines {
    /// The crate `libm`, angle by angle.
    Libm,
    /// The standard library, angle by angle. The last bits depend on the platform.
    Std,
    /// Vector instructions, within 1 unit in the last place; large angles as documented in `armgen-elementary`.
    Fast,
}

/// An angle, rad: entries of one argument, each perhaps times a factor, added and subtracted from left to right, then a constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Angle<T> {
    /// The argument, by its place among the arguments.
    pub argument: usize,
    /// Its entries, and whether they are subtracted. The first one is added.
    pub terms: Vec<(usize, bool)>,
    /// Factors of the terms, each multiplied before it is added; `None` is 1. Empty where all are 1.
    pub factors: Vec<Option<T>>,
    /// The constant.
    pub turn: Option<T>,
}

/// A value that the operations begin with.
#[derive(Clone, Debug, PartialEq)]
pub enum Input<T> {
    /// An entry of an argument.
    Entry {
        /// The argument, by its place among the arguments.
        argument: usize,
        /// The entry.
        entry: usize,
    },
    /// The sign of an entry: 1, -1, or the entry itself where it is a zero or not a number.
    Sign {
        /// The argument, by its place among the arguments.
        argument: usize,
        /// The entry.
        entry: usize,
    },
    /// exp(-|x| / velocity) of an entry x.
    Fading {
        /// The argument, by its place among the arguments.
        argument: usize,
        /// The entry.
        entry: usize,
        /// The velocity.
        velocity: T,
    },
    /// The sine of an angle, by its place among the angles.
    Sine(usize),
    /// The cosine of an angle, by its place among the angles.
    Cosine(usize),
}

/// An operand of an operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operand<T> {
    /// A value by its number.
    Value(usize),
    /// A constant.
    Constant(T),
}

/// A kind of operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// a + b
    Add,
    /// a - b
    Subtract,
    /// a b
    Multiply,
    /// a / b
    Divide,
    /// The sign of a: 1, -1, or a itself where it is a zero or not a number. The right operand is not used.
    Sign,
    /// The sign of -a, likewise.
    OppositeSign,
}

/// An operation; it rounds once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operation<T> {
    /// Its kind.
    pub operator: Operator,
    /// Its left operand.
    pub left: Operand<T>,
    /// Its right operand.
    pub right: Operand<T>,
}

/// An entry of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<T> {
    /// The value.
    pub operand: Operand<T>,
    /// Whether it is negated.
    pub negated: bool,
}
