//! How fast a value grows with the arguments, as the text shows it: its degree in each entry of an argument, in all entries of an argument together,
//! in all arguments together, and in sine and cosine of each joint variable.
//!
//! Nothing here sees a cancellation, so a function that adds a high power and takes it away again shows the degree of the power. A quotient
//! grows in all parameters as its numerator less its denominator; in all else no divisor of an arm's equations shrinks. Of a quotient that
//! is all that is known: entry by entry it has the degrees of its numerator.

use std::sync::Arc;

use super::Arithmetic;
use crate::element::Element;
use crate::formula::Formula;
use crate::program::{Argument, Inputs, Turn};

/// Arguments, and all of them.
const TOTALS: usize = Argument::ALL.len() + 1;

/// Degrees of a value; `None` for 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth(Option<Arc<Powers>>);

#[derive(Clone, Debug, PartialEq)]
struct Powers {
    /// In all entries of an argument together, and in all arguments.
    totals: [i32; TOTALS],
    /// In each entry of each argument, and in each circle.
    each: Box<[u16]>,
}

impl Powers {
    /// The larger of two everywhere.
    fn most(&self, other: &Powers) -> Powers {
        Powers {
            totals: std::array::from_fn(|k| self.totals[k].max(other.totals[k])),
            each: self.each.iter().zip(&other.each).map(|(a, b)| *a.max(b)).collect(),
        }
    }

    fn is_at_least(&self, other: &Powers) -> bool {
        // All entries, which ends no earlier and takes many of them at a time.
        let each = || self.each.iter().zip(&other.each).fold(true, |all, (a, b)| all & (a >= b));
        self.totals.iter().zip(&other.totals).all(|(a, b)| a >= b) && each()
    }

    fn is_constant(&self) -> bool {
        self.totals.iter().all(|degree| *degree == 0) && self.each.iter().fold(0, |all, degree| all | degree) == 0
    }
}

/// A degree that is larger than another: in what, how large, and what the other one is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Beyond {
    /// `dq`, `dq[1]`, `the sine and cosine of q[1]`.
    pub of: String,
    /// The degree.
    pub found: i64,
    /// The other.
    pub own: i64,
}

impl Growth {
    /// The larger of two everywhere.
    #[must_use]
    pub fn most(self, other: &Growth) -> Growth {
        match (&self.0, &other.0) {
            (Some(a), Some(b)) if Arc::ptr_eq(a, b) || a.is_at_least(b) => self,
            (Some(a), Some(b)) if b.is_at_least(a) => other.clone(),
            (Some(a), Some(b)) => Growth(Some(Arc::new(a.most(b)))),
            (None, _) => other.clone(),
            (_, None) => self,
        }
    }

    /// The first argument, of all entries together, in which this is of a higher degree than another.
    pub fn total_beyond(&self, own: &Growth) -> Option<Beyond> {
        let degree = |growth: &Growth, k: usize| growth.0.as_ref().map_or(0, |powers| i64::from(powers.totals[k]));
        Argument::ALL.iter().enumerate().find_map(|(k, argument)| {
            let (found, own) = (degree(self, k), degree(own, k));
            (found > own).then(|| Beyond { of: format!("`{}`", argument.name()), found, own })
        })
    }

    /// The same of all arguments together.
    pub fn sum_beyond(&self, own: &Growth) -> Option<Beyond> {
        let degree = |growth: &Growth| growth.0.as_ref().map_or(0, |powers| i64::from(powers.totals[TOTALS - 1]));
        let (found, own) = (degree(self), degree(own));
        (found > own).then(|| Beyond { of: "all arguments together".into(), found, own })
    }

    /// The first entry of an argument, or circle, in which this is of a higher degree than an entry of the equations allows, `all` being
    /// the largest of all entries: of a parameter the degree of any entry and 1, of a rate or an acceleration that of `of_motion`, of sines
    /// and cosines twice the entry's own and a square.
    pub fn entry_beyond(&self, own: &Growth, of_motion: &Growth, all: &Growth, growths: &Growths) -> Option<Beyond> {
        let found = self.0.as_ref()?;
        let degree = |growth: &Growth, k: usize| growth.0.as_ref().map_or(0, |powers| powers.each[k]);
        let circles = growths.circles();
        let most = |k: usize| match k {
            k if k < growths.parameters => degree(all, k).max(1),
            k if growths.is_of_motion(k) => degree(of_motion, k),
            k if k < circles => degree(own, k),
            k => degree(own, k).saturating_mul(2).saturating_add(2),
        };
        let k = (0..found.each.len()).find(|&k| found.each[k] > most(k))?;
        Some(Beyond { of: growths.name(k), found: found.each[k].into(), own: degree(own, k).into() })
    }
}

impl Element for Growth {
    fn plus(&self, other: &Growth) -> Growth {
        self.clone().most(other)
    }
    fn minus(&self, other: &Growth) -> Growth {
        self.clone().most(other)
    }
    fn times(&self, other: &Growth) -> Growth {
        let (Some(a), Some(b)) = (&self.0, &other.0) else { return Growth(None) };
        if a.is_constant() {
            return other.clone();
        }
        if b.is_constant() {
            return self.clone();
        }
        Growth(Some(Arc::new(Powers {
            totals: std::array::from_fn(|k| a.totals[k].saturating_add(b.totals[k])),
            each: a.each.iter().zip(&b.each).map(|(a, b)| a.saturating_add(*b)).collect(),
        })))
    }
    fn negated(&self) -> Growth {
        self.clone()
    }
    fn inverse(&self) -> Option<Growth> {
        let powers = self.0.as_ref()?;
        let of = |k: usize| if k == 0 { powers.totals[k].saturating_neg() } else { 0 };
        debug_assert_eq!(Argument::ALL[0], Argument::Pi);
        Some(Growth(Some(Arc::new(Powers { totals: std::array::from_fn(of), each: vec![0; powers.each.len()].into() }))))
    }
    fn sign(&self) -> Growth {
        let constant = |powers: &Arc<Powers>| Arc::new(Powers { totals: [0; TOTALS], each: vec![0; powers.each.len()].into() });
        Growth(self.0.as_ref().map(constant))
    }
    fn is_zero(&self) -> bool {
        self.0.is_none()
    }
}

/// Where degrees come from: constants have none, what is drawn are the entries of the parameter vector in their order.
#[derive(Clone, Debug)]
pub struct Growths {
    joints: usize,
    parameters: usize,
    drawn: usize,
    constant: Growth,
}

impl Growths {
    /// For arms with so many joints and entries of the parameter vector.
    pub fn new(joints: usize, parameters: usize) -> Growths {
        // Entries of the other arguments, then circles.
        let powers = Powers { totals: [0; TOTALS], each: vec![0; parameters + Argument::ALL.len() * joints].into() };
        Growths { joints, parameters, drawn: 0, constant: Growth(Some(Arc::new(powers))) }
    }

    fn place(&self, argument: Argument, index: usize) -> usize {
        match Argument::ALL.iter().position(|&other| other == argument) {
            None | Some(0) => index,
            Some(k) => self.parameters + (k - 1) * self.joints + index,
        }
    }

    /// Where those of sines and cosines begin.
    fn circles(&self) -> usize {
        self.parameters + (Argument::ALL.len() - 1) * self.joints
    }

    /// The argument, none for a sine and cosine, and the index that a place among the degrees is of.
    fn entry(&self, place: usize) -> (Option<Argument>, usize) {
        match place.checked_sub(self.parameters) {
            None => (Some(Argument::Pi), place),
            Some(beyond) => (Argument::ALL.get(beyond / self.joints + 1).copied(), beyond % self.joints),
        }
    }

    fn is_of_motion(&self, place: usize) -> bool {
        matches!(self.entry(place).0, Some(Argument::Dq | Argument::Dqr | Argument::Ddq | Argument::Ddqr))
    }

    /// What a place among the degrees is of.
    fn name(&self, place: usize) -> String {
        match self.entry(place) {
            (Some(argument), index) => format!("`{}[{index}]`", argument.name()),
            (None, index) => format!("sine and cosine of `q[{index}]`"),
        }
    }

    /// An entry of an argument.
    pub fn of(&self, argument: Argument, index: usize) -> Growth {
        let Some(constant) = &self.constant.0 else { return self.constant.clone() };
        let mut powers = Powers::clone(constant);
        for (k, total) in powers.totals.iter_mut().enumerate() {
            *total = i32::from(k == TOTALS - 1 || Argument::ALL[k] == argument);
        }
        if argument != Argument::Pi || index < self.parameters {
            powers.each[self.place(argument, index)] = 1;
        }
        Growth(Some(Arc::new(powers)))
    }

    /// A sine or a cosine of an angle with these joints.
    pub fn circle(&self, joints: impl IntoIterator<Item = (usize, u16)>) -> Growth {
        let Some(constant) = &self.constant.0 else { return self.constant.clone() };
        let mut powers = Powers::clone(constant);
        for (joint, times) in joints {
            powers.each[self.circles() + joint] += times;
        }
        Growth(Some(Arc::new(powers)))
    }

    fn angle(&self, angle: &[(usize, i64)]) -> (Growth, Growth) {
        let circle = self.circle(angle.iter().map(|&(joint, factor)| (joint, factor.unsigned_abs().min(9) as u16)));
        (circle.clone(), circle)
    }
}

impl Arithmetic for Growths {
    type Element = Growth;

    fn integer(&self, value: i64) -> Growth {
        if value == 0 {
            Growth(None)
        } else {
            self.constant.clone()
        }
    }

    fn constant(&self, formula: &Formula) -> Option<Growth> {
        Some(if formula.as_rational().is_some_and(|value| value.is_zero()) { Growth(None) } else { self.constant.clone() })
    }

    fn draw(&mut self) -> Growth {
        self.drawn += 1;
        self.of(Argument::Pi, self.drawn - 1)
    }

    fn draw_angle(&mut self) -> (Growth, Growth) {
        (self.constant.clone(), self.constant.clone())
    }
}

/// The arguments themselves, for a program.
impl Inputs<Growth> for Growths {
    fn entry(&self, argument: Argument, index: usize) -> Growth {
        self.of(argument, index)
    }

    fn sine_cosine(&self, angle: &[(usize, i64)]) -> (Growth, Growth) {
        self.angle(angle)
    }

    fn turned(&self, angle: &[(usize, i64)], _: &Turn<'_, Growth>) -> (Growth, Growth) {
        self.angle(angle)
    }

    fn sign(&self, _: usize) -> Growth {
        self.constant.clone()
    }

    fn stribeck(&self, _: usize, _: &Growth) -> Growth {
        self.constant.clone()
    }
}
