//! What a plain program of the equations makes of the entries of a function: the yardstick beside which the errors of a text are judged.

use std::collections::BTreeMap;

use armgen_description::kinds::JointKind;

use crate::checker::Checker;
use crate::enclosure::Float;
use crate::equations::parameters::{units, Unit};
use crate::float::{Arguments, LANES};
use crate::ranges::worst;

/// What a plain program of the equations makes of an entry.
#[derive(Clone, Debug, Default)]
pub(super) struct Plain {
    /// State by state the error and the size of the value, in f64.
    pub(super) states: Vec<(f64, f64)>,
    /// State by state the value.
    pub(super) values: Vec<f64>,
    /// The error over the wide box, and over that with the parameters of the description.
    pub(super) boxes: [f64; 2],
    /// The size of what stands beside it: of an entry of a regressor the largest of the same unit, of inertias at least that of rates.
    /// Rates about the axes of a tensor make its columns, and all of one can be what an angle of 1e-5 between two axes leaves of them.
    pub(super) beside: f64,
}

impl Plain {
    /// States where the program has a value: one that divides by a mass has none where that is 0.
    pub(super) fn finite(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.states.iter().filter(|state| is_finite(state))
    }

    /// At random states.
    pub(super) fn random(&self) -> Plain {
        let random = self.states.iter().enumerate().filter(|(state, _)| Kind::of(*state) == Kind::Random);
        Plain { states: random.map(|(_, own)| *own).collect(), values: Vec::new(), ..*self }
    }

    /// Whether it has a value at all states.
    pub(super) fn is_whole(&self) -> bool {
        self.states.iter().all(is_finite)
    }

    /// The largest error at states, one rounding included.
    pub(super) fn error(&self) -> f64 {
        worst(self.finite().map(|(error, _)| *error)) + self.rounding()
    }

    /// One rounding of the largest value, in f64.
    pub(super) fn rounding(&self) -> f64 {
        Float::F64.unit() * self.size().max(self.beside)
    }

    pub(super) fn size(&self) -> f64 {
        worst(self.finite().map(|(_, size)| *size))
    }

    /// Allows an operand a rounding of its own value at each state: it can be larger than all that it is part of, as a quotient by a short link is.
    pub(super) fn hold_value(&mut self, values: impl Iterator<Item = f64>) {
        for ((error, size), value) in self.states.iter_mut().zip(values).filter(|(_, value)| value.is_finite()) {
            *error = error.max(Float::F64.unit() * value.abs());
            *size = size.max(value.abs());
        }
    }

    /// That of so many times the entry.
    pub(super) fn times(&self, scale: f64) -> Plain {
        let states = self.states.iter().map(|(error, size)| (scale * error, scale * size)).collect();
        Plain { states, values: Vec::new(), boxes: self.boxes.map(|error| scale * error), beside: 0.0 }
    }
}

/// Where states are drawn from.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Within the limits, with the parameters of the description.
    Random,
    /// At the ends of the wide box.
    Corner,
    /// Within the limits at rest, or slow.
    Slow,
}

impl Kind {
    /// That of a state by its number: batch by batch one and another.
    pub(super) fn of(state: usize) -> Kind {
        match state / LANES {
            0 | 2 => Kind::Random,
            1 | 3 => Kind::Corner,
            _ => Kind::Slow,
        }
    }
}

pub(super) fn is_finite((error, size): &(f64, f64)) -> bool {
    error.is_finite() && size.is_finite()
}

/// Gives each entry of a regressor the largest size and the largest errors over boxes of its unit ([`Plain::beside`]).
pub(super) fn beside_their_units<'a>(
    plain: &mut BTreeMap<String, Vec<Plain>>,
    checker: &Checker,
    states: impl Iterator<Item = &'a Arguments<f64>>,
) {
    // Links can turn as fast as the rates of all joints together, though of parallel axes no square of a rate may be left.
    let joints = &checker.manipulator().joints;
    let turns = |rates: &[f64]| -> f64 {
        let revolute = joints.iter().zip(rates).filter(|(joint, _)| joint.kind == JointKind::Revolute);
        revolute.map(|(_, rate)| rate.abs()).sum()
    };
    let of_rates = worst(states.map(|state| turns(&state.dq) * turns(&state.dqr)));
    let base = checker.base().map(|own| units(own.named.iter().map(|(parameter, _)| *parameter)));
    for (name, columns) in [("regressor", checker.vector().units()), ("base_regressor", base.unwrap_or_default())] {
        let Some(entries) = plain.get_mut(name) else { continue };
        let rows = joints.iter().map(|joint| joint.kind == JointKind::Revolute);
        let units: Vec<(bool, Unit)> = rows.flat_map(|turns| columns.iter().map(move |unit| (turns, *unit))).collect();
        let mut largest = BTreeMap::from([((true, Unit::Inertia), (of_rates, [0.0f64; 2]))]);
        for (unit, entry) in units.iter().zip(entries.iter()) {
            let (size, boxes) = largest.entry(*unit).or_default();
            *size = worst([*size, entry.size()]);
            *boxes = [0, 1].map(|k| if entry.boxes[k].is_finite() { boxes[k].max(entry.boxes[k]) } else { boxes[k] });
        }
        for (unit, entry) in units.iter().zip(entries) {
            let (size, boxes) = largest[unit];
            entry.beside = size;
            entry.boxes = [0, 1].map(|k| entry.boxes[k].max(boxes[k]));
        }
    }
}
