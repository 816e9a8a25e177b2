//! Executes programs in floats like the emitted functions: the same operations in the same order, with sine and cosine of libm.

use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::program::{Argument, Inputs, Program, Scaled, Turn};

/// Number of states that run in parallel lanes.
pub const LANES: usize = 8;

/// Arguments of emitted functions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arguments<T> {
    /// The parameter vector.
    pub pi: Vec<T>,
    /// Joint variables.
    pub q: Vec<T>,
    /// Joint rates.
    pub dq: Vec<T>,
    /// Joint accelerations.
    pub ddq: Vec<T>,
    /// Reference rates.
    pub dqr: Vec<T>,
    /// Reference accelerations.
    pub ddqr: Vec<T>,
    /// Joint torques.
    pub tau: Vec<T>,
    /// Acceleration of free fall; empty where that is no argument.
    pub g0: Vec<T>,
}

impl<T: Copy> Arguments<T> {
    /// An argument.
    pub fn of(&self, argument: Argument) -> &[T] {
        match argument {
            Argument::Pi => &self.pi,
            Argument::Q => &self.q,
            Argument::Dq => &self.dq,
            Argument::Ddq => &self.ddq,
            Argument::Dqr => &self.dqr,
            Argument::Ddqr => &self.ddqr,
            Argument::Tau => &self.tau,
            Argument::Gravity => &self.g0,
        }
    }

    /// Gathers each entry of all states into lanes.
    pub fn gather<U, const N: usize>(states: &[Arguments<T>; N], side: impl Fn([T; N]) -> U) -> Arguments<U> {
        Arguments::each(|argument| {
            let length = states.first().map_or(0, |state| state.of(argument).len());
            (0..length).map(|i| side(std::array::from_fn(|k| states[k].of(argument)[i]))).collect()
        })
    }

    /// Combines each entry with the same entry of others, in the order of the fields.
    pub fn beside<U: Copy, V>(&self, others: &Arguments<U>, mut f: impl FnMut(T, U) -> V) -> Arguments<V> {
        Arguments::each(|argument| self.of(argument).iter().zip(others.of(argument)).map(|(a, b)| f(*a, *b)).collect())
    }

    /// The same in another number type.
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> Arguments<U> {
        Arguments::each(|argument| self.of(argument).iter().map(|x| f(*x)).collect())
    }
}

impl<T> Arguments<T> {
    /// Builds all arguments from `of`, in the order of the fields.
    pub(crate) fn each(mut of: impl FnMut(Argument) -> Vec<T>) -> Arguments<T> {
        Arguments {
            pi: of(Argument::Pi),
            q: of(Argument::Q),
            dq: of(Argument::Dq),
            ddq: of(Argument::Ddq),
            dqr: of(Argument::Dqr),
            ddqr: of(Argument::Ddqr),
            tau: of(Argument::Tau),
            g0: of(Argument::Gravity),
        }
    }
}

/// The function of emitted modules, in both scalars.
macro_rules! stribeck {
    ($module:ident, $float:ty) => {
        pub(crate) mod $module {
            type Real = $float;
            include!("../read/reader/sines/stribeck.rs");

            /// exp(-|rate| / velocity), as computed by emitted modules.
            pub(crate) fn of(rate: Real, velocity: Real) -> Real {
                stribeck(rate, velocity)
            }
        }
    };
}

stribeck!(stribeck_f64, f64);
stribeck!(stribeck_f32, f32);

/// Error bound of exp(-x) at x = |dq| / v with a rounded v: two units of roundoff of the function, and two units of x, multiplied by x. Values
/// below 1e-17 become 0.
pub(crate) fn stribeck_error(x: f64, value: f64, real: Float) -> f64 {
    (2.1 + 2.1 * x.min(64.0)) * real.unit() * value + if value == 0.0 { 1e-17 } else { 0.0 }
}

pub(crate) use stribeck_f64::of as stribeck;

macro_rules! inputs {
    ($float:ty, $sincos:path, $stribeck:path) => {
        impl Arguments<$float> {
            fn angle(&self, terms: &[(usize, i64)]) -> $float {
                match terms {
                    [(joint, 1)] => self.q[*joint],
                    terms => terms.iter().map(|&(joint, factor)| factor as $float * self.q[joint]).sum(),
                }
            }
        }

        impl Inputs<$float> for Arguments<$float> {
            fn entry(&self, argument: Argument, index: usize) -> $float {
                self.of(argument)[index]
            }

            fn sine_cosine(&self, angle: &[(usize, i64)]) -> ($float, $float) {
                $sincos(self.angle(angle))
            }

            fn turned(&self, angle: &[(usize, i64)], turn: &Turn<'_, $float>) -> ($float, $float) {
                let sum = self.angle(angle);
                $sincos(if turn.minus { sum - turn.value } else { sum + turn.value })
            }

            fn scaled(&self, terms: &[Scaled<$float>], constant: Option<$float>) -> ($float, $float) {
                let term = |&(joint, sign, factor): &Scaled<$float>| sign as $float * (factor.unwrap_or(1.0) * self.q[joint]);
                $sincos(terms.iter().map(term).chain(constant).reduce(|sum, term| sum + term).unwrap_or(0.0))
            }

            fn sign(&self, joint: usize) -> $float {
                let x = self.dq[joint];
                if x > 0.0 {
                    1.0
                } else if x < 0.0 {
                    -1.0
                } else {
                    x
                }
            }

            fn stribeck(&self, joint: usize, velocity: &$float) -> $float {
                $stribeck(self.dq[joint], *velocity)
            }
        }
    };
}

inputs!(f64, libm::sincos, stribeck_f64::of);
inputs!(f32, libm::sincosf, stribeck_f32::of);

/// A float per lane, so that one pass through a program computes all states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    #[inline]
    fn each(of: impl Fn(usize) -> f64) -> Lanes {
        Lanes(std::array::from_fn(of))
    }

    #[inline]
    fn both(self, other: &Lanes, of: impl Fn(f64, f64) -> f64) -> Lanes {
        Lanes::each(|lane| of(self.0[lane], other.0[lane]))
    }
}

impl Element for Lanes {
    #[inline]
    fn plus(&self, other: &Lanes) -> Lanes {
        self.both(other, |a, b| a + b)
    }
    #[inline]
    fn minus(&self, other: &Lanes) -> Lanes {
        self.both(other, |a, b| a - b)
    }
    #[inline]
    fn times(&self, other: &Lanes) -> Lanes {
        self.both(other, |a, b| a * b)
    }
    #[inline]
    fn times_plus(&self, factor: &Lanes, other: &Lanes) -> Lanes {
        Lanes::each(|lane| self.0[lane].mul_add(factor.0[lane], other.0[lane]))
    }
    #[inline]
    fn negated(&self) -> Lanes {
        Lanes(self.0.map(|x| -x))
    }
    #[inline]
    fn inverse(&self) -> Option<Lanes> {
        Some(Lanes(self.0.map(|x| 1.0 / x)))
    }
    #[inline]
    fn is_zero(&self) -> bool {
        self.0 == [0.0; LANES]
    }
    #[inline]
    fn sign(&self) -> Lanes {
        Lanes(self.0.map(|x| x.sign()))
    }
    #[inline]
    fn over(&self, other: &Lanes) -> Option<Lanes> {
        Some(self.both(other, |a, b| a / b))
    }
}

impl Inputs<Lanes> for [Arguments<f64>; LANES] {
    fn entry(&self, argument: Argument, index: usize) -> Lanes {
        Lanes::each(|lane| self[lane].entry(argument, index))
    }

    fn sine_cosine(&self, angle: &[(usize, i64)]) -> (Lanes, Lanes) {
        let all: [(f64, f64); LANES] = std::array::from_fn(|lane| self[lane].sine_cosine(angle));
        (Lanes(all.map(|(sine, _)| sine)), Lanes(all.map(|(_, cosine)| cosine)))
    }

    fn turned(&self, angle: &[(usize, i64)], turn: &Turn<'_, Lanes>) -> (Lanes, Lanes) {
        let all: [(f64, f64); LANES] = std::array::from_fn(|lane| {
            let turn = Turn { minus: turn.minus, value: &turn.value.0[lane], circle: None };
            self[lane].turned(angle, &turn)
        });
        (Lanes(all.map(|(sine, _)| sine)), Lanes(all.map(|(_, cosine)| cosine)))
    }

    fn scaled(&self, terms: &[Scaled<Lanes>], constant: Option<Lanes>) -> (Lanes, Lanes) {
        let all: [(f64, f64); LANES] = std::array::from_fn(|lane| {
            let terms: Vec<Scaled<f64>> = terms.iter().map(|(i, sign, factor)| (*i, *sign, factor.map(|x| x.0[lane]))).collect();
            self[lane].scaled(&terms, constant.map(|x| x.0[lane]))
        });
        (Lanes(all.map(|(sine, _)| sine)), Lanes(all.map(|(_, cosine)| cosine)))
    }

    fn sign(&self, joint: usize) -> Lanes {
        Lanes::each(|lane| self[lane].sign(joint))
    }

    fn stribeck(&self, joint: usize, velocity: &Lanes) -> Lanes {
        Lanes::each(|lane| self[lane].stribeck(joint, &velocity.0[lane]))
    }
}

impl Program {
    /// The entries of the result in the module's scalar; rounds the arguments to it first.
    pub fn run_float(&self, arguments: &Arguments<f64>, real: Float) -> Vec<f64> {
        match real {
            Float::F64 => {
                let literals: Vec<f64> = self.literals.iter().map(|l| l.value).collect();
                self.run(arguments, &literals).into_iter().map(|v| v.unwrap_or(f64::NAN)).collect()
            }
            Float::F32 => {
                let literals: Vec<f32> = self.literals.iter().map(|l| l.value as f32).collect();
                let values = self.run(&arguments.map(|x| x as f32), &literals);
                values.into_iter().map(|v| v.map_or(f64::NAN, f64::from)).collect()
            }
        }
    }
}
