//! How well floats can compute the equations: errors of a plain program of them, entry by entry, at states and over boxes.
//!
//! The program is that of [`reference`](mod@crate::textbook::reference), in double precision. At states it is run in floats with running errors
//! ([`running`](mod@crate::values::arithmetic::running)); over a box in intervals with the largest errors of their values, by the rules of
//! [`mod@crate::values::ranges`]. What divides by an interval that 0 lies in has no bound there. Arguments are rounded once: no one has them better.
//! Unit vectors of the description are rounded at their length, so that axes apart by pi to sixteen digits turn by a rounding, not by a part of it.

use std::collections::BTreeMap;

use armgen_description::manipulator::{Coordinate, Manipulator};

use crate::textbook::base::{self, OwnParameters};
use crate::textbook::equations::angles::Angles;
use crate::textbook::equations::arm::formula;
use crate::textbook::equations::parameters::Vector;
use crate::textbook::equations::state::State;
use crate::textbook::reference::{BaseParameters, Values, Wanted};
use crate::values::arithmetic::running::{Running, RunningNumbers};
use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::float::{stribeck, stribeck_error, Arguments, LANES};
use crate::values::formula::Formula;
use crate::values::number::Member;
use crate::values::ranges::{Domain, Range};

/// What a plain program makes of an entry.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The bound of its error.
    pub error: f64,
    /// The size of its value, the largest in a box.
    pub size: f64,
}

/// The plain program of the equations of an arm.
#[derive(Clone, Copy)]
pub struct Plain<'a> {
    /// The arm.
    pub manipulator: &'a Manipulator,
    /// What its parameter vector is.
    pub vector: &'a Vector,
    /// The parameters of its `base_regressor`.
    pub base: Option<&'a OwnParameters>,
}

impl Plain<'_> {
    /// All functions in an arithmetic that gives `pi` where it draws.
    fn values<K: Arithmetic>(&self, numbers: &mut K, state: State<K::Element>) -> Option<Values<K::Element>>
    where
        K::Element: Member,
    {
        let wanted = Wanted { base: BaseParameters::Kept, pivots: false };
        let named = self.base.map(|base| base.named.as_slice());
        base::values(numbers, self.manipulator, self.vector, named, state, wanted).ok()
    }

    /// The velocities of the exponentials of friction, of joints that have them.
    fn decay_velocities(&self) -> impl Iterator<Item = Option<f64>> + '_ {
        let velocity =
            |of: Coordinate<'_>| of.joint.decay_velocity().and_then(|velocity| Float::F64.nearest(&formula(&velocity)));
        self.manipulator.coordinates().into_iter().map(velocity)
    }

    fn is_base(&self) -> bool {
        matches!(self.vector, Vector::Base(..))
    }

    /// By function: at each state, each entry.
    pub fn at_states(&self, states: &[Arguments<f64>; LANES]) -> BTreeMap<String, Vec<Vec<Entry>>> {
        let arguments = Arguments::gather(states, |entry| Running::rounded(entry, 1.0));
        let circle = |q: &Running| {
            let both = q.value.map(libm::sincos);
            // One unit in the last place each, and what the angle is off by.
            let wave =
                |value| Running { error: std::array::from_fn(|k| Running::rounded(value, 2.0).error[k] + q.error[k]), value };
            (wave(both.map(|(sine, _)| sine)), wave(both.map(|(_, cosine)| cosine)))
        };
        let sign = |rate: &Running| Running::exact(rate.value.map(|x| if x == 0.0 { 0.0 } else { x.signum() }));
        let (mut angles, signs): (Vec<_>, _) =
            (arguments.q.iter().map(circle).collect(), arguments.dq.iter().map(sign).collect());
        let of_arm = Angles::of(self.manipulator);
        let numbers = RunningNumbers::default();
        angles.extend(of_arm.values(&numbers, &arguments.q).unwrap_or_default().iter().map(circle));
        let computed = of_arm.factors(&numbers).unwrap_or_default();
        let stribeck = arguments.dq.iter().zip(self.decay_velocities()).map(|(rate, velocity)| {
            let both = rate.value.map(|rate| match velocity {
                Some(velocity) => {
                    let value = stribeck(rate, velocity);
                    (value, stribeck_error(rate.abs() / velocity, value, Float::F64))
                }
                None => (0.0, 0.0),
            });
            Running { value: both.map(|(value, _)| value), error: both.map(|(_, error)| error) }
        });
        let stribeck = stribeck.collect();
        let plain = State::of(arguments, angles, signs, [0.0, 1.0].map(|x| Running::exact([x; LANES])));
        let mut state = State { stribeck, computed, ..plain };
        let mut numbers = RunningNumbers::default();
        if self.is_base() {
            numbers.given = std::mem::take(&mut state.pi).into();
        }
        let at = |entries: &[Running], k: usize| {
            let entry = |entry: &Running| Entry { error: entry.error[k], size: entry.value[k].abs() };
            entries.iter().map(entry).collect::<Vec<Entry>>()
        };
        let values = self.values(&mut numbers, state).unwrap_or_default();
        values.into_iter().map(|(name, entries)| (name, (0..LANES).map(|k| at(&entries, k)).collect())).collect()
    }

    /// By function: each entry in a box with all angles.
    pub fn in_box(&self, domain: &Domain) -> BTreeMap<String, Vec<Entry>> {
        let unit = Float::F64.unit();
        let range = |(low, high): (f64, f64)| Range { low, high, error: unit * low.abs().max(high.abs()) };
        let arguments = domain.map(range);
        let circle = |q: &Range| Range { low: -1.0, high: 1.0, error: 2.0 * unit + q.error };
        let of_arm = Angles::of(self.manipulator);
        let values = of_arm.values(&Ranges::default(), &arguments.q).unwrap_or_default();
        let angles = arguments.q.iter().chain(&values).map(|q| (circle(q), circle(q))).collect();
        let computed = of_arm.factors(&Ranges::default()).unwrap_or_default();
        let signs = vec![Range { low: -1.0, high: 1.0, error: 0.0 }; arguments.q.len()];
        let stribeck = arguments.dq.iter().zip(self.decay_velocities());
        let stribeck = stribeck.map(|(rate, velocity)| {
            velocity.map_or(range((0.0, 0.0)), |velocity| Range::stribeck((rate.low, rate.high), velocity, Float::F64))
        });
        let stribeck = stribeck.collect();
        let mut state = State {
            stribeck,
            computed,
            ..State::of(arguments, angles, signs, [0.0, 1.0].map(|x| Range { low: x, high: x, error: 0.0 }))
        };
        let mut numbers = Ranges::default();
        if self.is_base() {
            numbers.given = std::mem::take(&mut state.pi).into_iter();
        }
        let values = self.values(&mut numbers, state).unwrap_or_default();
        let entry = |entry: &Range| Entry { error: entry.error, size: entry.size() };
        values.into_iter().map(|(name, entries)| (name, entries.iter().map(entry).collect())).collect()
    }
}

/// Constants as ranges; what is drawn are given ones, in their order.
#[derive(Default)]
struct Ranges {
    /// 1 where nothing is left.
    given: std::vec::IntoIter<Range>,
}

impl Arithmetic for Ranges {
    type Element = Range;

    fn integer(&self, value: i64) -> Range {
        Range { low: value as f64, high: value as f64, error: 0.0 }
    }

    fn constant(&self, formula: &Formula) -> Option<Range> {
        let value = Float::F64.nearest(formula)?;
        let exact =
            formula.as_rational().is_some_and(|e| crate::values::formula::Rational::try_from(value).is_ok_and(|f| f == *e));
        let error = if exact { 0.0 } else { Float::F64.unit() * value.abs() };
        Some(Range { low: value - error, high: value + error, error })
    }

    fn coordinate(&self, formula: &Formula) -> Option<Range> {
        let Range { low, high, error } = self.constant(formula)?;
        let error = if error == 0.0 { 0.0 } else { Float::F64.unit() };
        Some(Range { low: low - error, high: high + error, error })
    }

    fn draw(&mut self) -> Range {
        self.given.next().unwrap_or(Range { low: 1.0, high: 1.0, error: 0.0 })
    }
}

/// An exact number.
fn point(range: &Range) -> Option<f64> {
    (range.low == range.high && range.error == 0.0).then_some(range.low)
}

/// A range with these ends and an error that comes with the operands, once more rounded.
fn rounded(ends: &[f64], carried: f64) -> Range {
    let size = ends.iter().fold(0.0f64, |size, end| size.max(end.abs()));
    let range = Range::of(ends, carried + Float::F64.unit() * (size + carried));
    if range.error.is_nan() {
        Range::ANYTHING
    } else {
        range
    }
}

impl Element for Range {
    fn plus(&self, other: &Range) -> Range {
        if self.is_zero() {
            return *other;
        }
        if other.is_zero() {
            return *self;
        }
        if let (Some(a), Some(b)) = (point(self), point(other)) {
            let sum = a + b;
            // What a sum of two floats loses is a float (Knuth).
            let part = sum - a;
            if (a - (sum - part)) + (b - part) == 0.0 {
                return Range { low: sum, high: sum, error: 0.0 };
            }
        }
        rounded(&[self.low + other.low, self.high + other.high], self.error + other.error)
    }
    fn minus(&self, other: &Range) -> Range {
        self.plus(&other.negated())
    }
    fn times(&self, other: &Range) -> Range {
        for (a, b) in [(self, other), (other, self)] {
            match point(a) {
                Some(0.0) => return *a,
                Some(1.0) => return *b,
                Some(-1.0) => return b.negated(),
                _ => {}
            }
        }
        let ends = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        rounded(&ends, self.size() * other.error + other.size() * self.error + self.error * other.error)
    }
    fn negated(&self) -> Range {
        Range { low: -self.high, high: -self.low, error: self.error }
    }
    fn inverse(&self) -> Option<Range> {
        if self.is_zero() {
            return None;
        }
        let left = self.low.abs().min(self.high.abs()) - self.error;
        if left > 0.0 && self.low.signum() == self.high.signum() {
            let ends = [1.0 / self.low, 1.0 / self.high];
            Some(rounded(&ends, self.error / (self.low.abs().min(self.high.abs()) * left)))
        } else {
            Some(Range::ANYTHING)
        }
    }
    fn sign(&self) -> Range {
        Range::sign(self)
    }
    fn is_zero(&self) -> bool {
        point(self) == Some(0.0)
    }
}
