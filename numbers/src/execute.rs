//! Execution: an operation of a whole block of states before the next operation.

use std::fmt;

use crate::function::{Angle, Argument, Sines};
use crate::program::{Code, Form, Instruction, Load, Program, Wave};
use crate::scalar::Scalar;

/// States in a group: the numbers that an instruction takes together.
const LANES: usize = 8;

/// Groups in a large block, of 64 states, and in a small one, of 16.
const LARGE: usize = 8;
const SMALL: usize = 2;

/// Places that take more bytes than this in large blocks do not fit into a processor's second cache. Small blocks are faster
/// then.
const CACHE: usize = 256 << 10;

/// The numbers in the places of a program while it runs.
#[derive(Clone, Debug, Default)]
pub struct Workspace<T> {
    alone: Vec<[[T; 1]; 1]>,
    large: Vec<[[T; LANES]; LARGE]>,
    small: Vec<[[T; LANES]; SMALL]>,
}

/// Reasons why a program does not run. Most are slices of a wrong length.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mismatch {
    /// The number of arguments differs from the function's.
    Arguments {
        /// The function's number of arguments.
        expected: usize,
        /// The given number of arguments.
        found: usize,
    },
    /// The result is not a whole number of states.
    Result {
        /// Entries of a state.
        entries: usize,
        /// Its length.
        found: usize,
    },
    /// An argument's length fits neither one state nor all states.
    Argument {
        /// Its name.
        name: String,
        /// Entries of a state.
        entries: usize,
        /// States of the result.
        states: usize,
        /// Its length.
        found: usize,
    },
    /// The workspace is of another program.
    Workspace,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Mismatch::Arguments { expected, found } => write!(f, "the function takes {expected} arguments, not {found}"),
            Mismatch::Result { entries, found } => {
                write!(f, "the result has {found} numbers, which is no multiple of the {entries} of a state")
            }
            Mismatch::Argument { name, entries, states, found } => {
                write!(f, "`{name}` has {found} numbers, not {entries} for all states, nor {entries} for each of {states} states")
            }
            Mismatch::Workspace => write!(f, "the workspace is of another program"),
        }
    }
}

impl std::error::Error for Mismatch {}

/// `f64` or `f32`. Execution of both is compiled in this crate, with its settings; a calling crate's settings do not matter.
pub trait Compiled: Scalar {
    /// Executes all states.
    #[doc(hidden)]
    fn execute(run: &Run<'_, Self>, result: &mut [Self], workspace: &mut Workspace<Self>);
}

impl Compiled for f64 {
    fn execute(run: &Run<'_, f64>, result: &mut [f64], workspace: &mut Workspace<f64>) {
        run.all(result, workspace);
    }
}

impl Compiled for f32 {
    fn execute(run: &Run<'_, f32>, result: &mut [f32], workspace: &mut Workspace<f32>) {
        run.all(result, workspace);
    }
}

impl<T: Compiled> Program<T> {
    /// Room for the numbers of a run: at most 256 kB in blocks, as long as that is enough for 16 states.
    pub fn workspace(&self) -> Workspace<T> {
        let zero = T::default();
        let is_large = self.places * LARGE * LANES * size_of::<T>() <= CACHE;
        Workspace {
            alone: vec![[[zero]]; self.places],
            large: if is_large { vec![[[zero; LANES]; LARGE]; self.places] } else { Vec::new() },
            small: vec![[[zero; LANES]; SMALL]; self.places],
        }
    }

    /// Computes the result of every state, state by state. An argument has a vector for each state, one after the other, or one for all states.
    ///
    /// It allocates nothing, and its bits depend neither on the number of states nor on the processor.
    ///
    /// Errors: a slice has another length, or the workspace is of another program; nothing is written then.
    pub fn run(&self, arguments: &[&[T]], result: &mut [T], workspace: &mut Workspace<T>) -> Result<(), Mismatch> {
        let states = self.states(arguments, result.len())?;
        if workspace.alone.len() != self.places || workspace.small.len() != self.places {
            return Err(Mismatch::Workspace);
        }
        T::execute(&Run { program: self, arguments, states }, result, workspace);
        Ok(())
    }

    /// The number of states in slices of these lengths.
    fn states(&self, arguments: &[&[T]], result: usize) -> Result<usize, Mismatch> {
        let (expected, entries) = (self.arguments(), self.outputs());
        if arguments.len() != expected.len() {
            return Err(Mismatch::Arguments { expected: expected.len(), found: arguments.len() });
        }
        let states = result.checked_div(entries).unwrap_or(0);
        if states * entries != result {
            return Err(Mismatch::Result { entries, found: result });
        }
        for (Argument { name, length }, given) in expected.iter().zip(arguments) {
            if given.len() != *length && given.len() != states * length && entries > 0 {
                let (name, entries, found) = (name.clone(), *length, given.len());
                return Err(Mismatch::Argument { name, entries, states, found });
            }
        }
        Ok(states)
    }
}

/// A program with what it is given.
#[derive(Debug)]
pub struct Run<'a, T> {
    program: &'a Program<T>,
    arguments: &'a [&'a [T]],
    states: usize,
}

/// All states of a run, in blocks.
struct Blocks<'a, T> {
    run: &'a Run<'a, T>,
    result: &'a mut [T],
    workspace: &'a mut Workspace<T>,
}

// Everything here is inlined into the function that uses the processor's own instructions. Code that is not inlined cannot use
// them: a closure in place of this type is not, and takes twice the time.
impl<T: Scalar> pulp::NullaryFnOnce for Blocks<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Blocks { run, result, workspace } = self;
        let mut at = 0;
        if !workspace.large.is_empty() {
            while run.states - at > SMALL * LANES {
                run.block::<LANES, LARGE>(&mut workspace.large, at, result);
                at = run.states.min(at + LARGE * LANES);
            }
        }
        while at < run.states {
            run.block::<LANES, SMALL>(&mut workspace.small, at, result);
            at = run.states.min(at + SMALL * LANES);
        }
    }
}

impl<T: Scalar> Run<'_, T> {
    /// All states, in blocks.
    #[inline(always)]
    fn all(&self, result: &mut [T], workspace: &mut Workspace<T>) {
        match self.states {
            0 => {}
            1 => self.block::<1, 1>(&mut workspace.alone, 0, result),
            _ => self.program.processor.dispatch(Blocks { run: self, result, workspace }),
        }
    }

    /// An entry of `L` states from `first` on. The last state repeats if there are fewer.
    #[inline(always)]
    fn read<const L: usize>(&self, argument: usize, entry: usize, first: usize) -> [T; L] {
        let (given, width) = (self.arguments[argument], self.program.arguments()[argument].length);
        if given.len() == width {
            return [given[entry]; L];
        }
        let mut lanes = [T::default(); L];
        if first + L <= self.states {
            let rows = &given[first * width..(first + L) * width];
            for i in 0..L {
                lanes[i] = rows[i * width + entry];
            }
        } else {
            for i in 0..L {
                lanes[i] = given[(first + i).min(self.states - 1) * width + entry];
            }
        }
        lanes
    }

    /// A term of an angle without its sign.
    #[inline(always)]
    fn term<const L: usize>(&self, angle: &Angle<T>, i: usize, first: usize) -> [T; L] {
        let mut term: [T; L] = self.read(angle.argument, angle.terms[i].0, first);
        if let Some(Some(factor)) = angle.factors.get(i) {
            term.iter_mut().for_each(|x| *x = *factor * *x);
        }
        term
    }

    #[inline(always)]
    fn angle<const L: usize>(&self, angle: &Angle<T>, first: usize) -> [T; L] {
        let mut sum = self.term(angle, 0, first);
        for (k, &(_, minus)) in angle.terms.iter().enumerate().skip(1) {
            let term = self.term::<L>(angle, k, first);
            for i in 0..L {
                sum[i] = if minus { sum[i] - term[i] } else { sum[i] + term[i] };
            }
        }
        if let Some(turn) = angle.turn {
            for x in &mut sum {
                *x = *x + turn;
            }
        }
        sum
    }

    /// The block of `K` groups of `L` states from `at` on.
    #[inline(always)]
    fn block<const L: usize, const K: usize>(&self, places: &mut [[[T; L]; K]], at: usize, result: &mut [T]) {
        for Wave { angle, sine, cosine } in &self.program.waves {
            for group in 0..K {
                let (sines, cosines) = sin_cos(self.program.sines, &self.angle::<L>(angle, at + group * L));
                if let Some(place) = sine {
                    places[*place as usize][group] = sines;
                }
                if let Some(place) = cosine {
                    places[*place as usize][group] = cosines;
                }
            }
        }
        for &Load { argument, entry, form, place } in &self.program.loads {
            for group in 0..K {
                let mut lanes: [T; L] = self.read(argument, entry, at + group * L);
                match form {
                    Form::Itself => {}
                    Form::Sign => lanes.iter_mut().for_each(|x| *x = x.sign()),
                    Form::Fading(velocity) => lanes.iter_mut().for_each(|x| *x = x.fading(velocity)),
                }
                places[place as usize][group] = lanes;
            }
        }
        execute(&self.program.instructions, places);
        let width = self.program.stores.len();
        for (entry, store) in self.program.stores.iter().enumerate() {
            for group in 0..K {
                let lanes = places[store.place as usize][group];
                let first = at + group * L;
                let signed = |x: T| if store.negated { -x } else { x };
                if first + L <= self.states {
                    let rows = &mut result[first * width..(first + L) * width];
                    for i in 0..L {
                        rows[i * width + entry] = signed(lanes[i]);
                    }
                } else {
                    for i in 0..self.states.saturating_sub(first) {
                        result[(first + i) * width + entry] = signed(lanes[i]);
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn sin_cos<T: Scalar, const L: usize>(sines: Sines, x: &[T; L]) -> ([T; L], [T; L]) {
    let (mut s, mut c) = ([T::default(); L], [T::default(); L]);
    match sines {
        Sines::Libm => {
            for i in 0..L {
                (s[i], c[i]) = x[i].sin_cos_of_libm();
            }
        }
        Sines::Std => {
            for i in 0..L {
                (s[i], c[i]) = x[i].sin_cos_of_std();
            }
        }
        Sines::Fast => {
            let mut is_within = true;
            for i in 0..L {
                (s[i], c[i]) = x[i].sin_cos_within();
                is_within &= x[i].is_within();
            }
            if !is_within {
                for i in 0..L {
                    (s[i], c[i]) = x[i].sin_cos_of_any();
                }
            }
        }
    }
    (s, c)
}

#[inline(always)]
fn execute<T: Scalar, const L: usize, const K: usize>(instructions: &[Instruction<T>], places: &mut [[[T; L]; K]]) {
    /// Group by group and lane by lane: each place that is read gives a name its number.
    macro_rules! each {
        ($of:ident, [$($name:ident),*], $value:expr) => {
            for group in 0..K {
                $(let $name = places[$of.$name as usize][group];)*
                let mut lanes = [T::default(); L];
                for i in 0..L {
                    $(let $name = $name[i];)*
                    lanes[i] = $value;
                }
                places[$of.to as usize][group] = lanes;
            }
        };
    }
    for of in instructions {
        let k = of.k;
        match of.code {
            Code::Add => each!(of, [a, b], a + b),
            Code::Subtract => each!(of, [a, b], a - b),
            Code::Multiply => each!(of, [a, b], a * b),
            Code::Divide => each!(of, [a, b], a / b),
            Code::Sign => each!(of, [a], a.sign()),
            Code::OppositeSign => each!(of, [a], (-a).sign()),
            Code::AddConstant => each!(of, [a], a + k),
            Code::SubtractConstant => each!(of, [a], a - k),
            Code::SubtractFromConstant => each!(of, [a], k - a),
            Code::MultiplyConstant => each!(of, [a], a * k),
            Code::DivideByConstant => each!(of, [a], a / k),
            Code::DivideConstant => each!(of, [a], k / a),
            Code::MultiplyAdd => each!(of, [a, b, c], a * b + c),
            Code::MultiplySubtract => each!(of, [a, b, c], a * b - c),
            Code::SubtractProduct => each!(of, [a, b, c], c - a * b),
            Code::MultiplyConstantAdd => each!(of, [a, c], a * k + c),
            Code::MultiplyConstantSubtract => each!(of, [a, c], a * k - c),
            Code::SubtractConstantProduct => each!(of, [a, c], c - a * k),
            Code::Constant => each!(of, [], k),
        }
    }
}
