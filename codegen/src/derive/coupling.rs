//! Coupled joints: equations in joint variables become equations in coordinates.
//!
//! Recursions run in the variables q of all joints, as if each had a drive. With q = S p + c, S and c constant, and the virtual work dp'τ = dq'τ_q
//!
//! ```text
//! τ = S' τ_q,   B = S' B(q) S,   C = S' C(q, S dp) S,   g = S' g(q),   J = J(q) S,   Y = S' Y_q
//! ```
//!
//! Under a constant map Christoffel's symbols of the first kind are carried over term by term: S' C S is Christoffel's of S' B S.
//! Where a joint that turns follows others by whole numbers, its sine and cosine are polynomials in those of coordinates. Else they are those of an
//! angle that the function computes ([`ComputedAngle`]), which the field of the coordinates relates to others; of joints about parallel axes
//! there is one for their sum, too. So the pool of coordinates
//! finds by its fingerprints all that the coupling cancels.

use std::cmp::Ordering;
use std::sync::Arc;

use crate::manipulator::{Coupling, JointVariable};
use crate::ring::field::computed::ComputedAngle;
use crate::ring::field::Field;
use crate::ring::{AngleSum, Elementary, ExprId, Pool, Symbol};

/// The coupling of an arm, with the factors in its pool.
#[derive(Clone, Debug)]
pub struct Coupled {
    coupling: Arc<Coupling>,
    /// S: for each joint its coordinates with their factors.
    rows: Vec<Vec<(usize, ExprId)>>,
    /// Angles that functions compute.
    computed: Vec<ComputedAngle>,
}

impl Coupled {
    /// The coupling in a pool.
    pub(super) fn new(pool: &mut Pool, coupling: &Coupling) -> Coupled {
        let row = |pool: &mut Pool, variable: &JointVariable| {
            variable.factors.iter().map(|(a, factor)| (*a, pool.constant(factor))).collect()
        };
        let rows = coupling.variables.iter().map(|variable| row(pool, variable)).collect();
        Coupled { coupling: Arc::new(coupling.clone()), rows, computed: coupling.all_computed() }
    }

    /// The field of coordinates from that of joint variables.
    pub(super) fn field(&self, of_joints: &Field) -> Field {
        if self.computed.is_empty() {
            return of_joints.clone();
        }
        of_joints.with_computed(self.coupling.coordinates.len() as u16, self.computed.clone())
    }

    /// S' x along one dimension of a list: of so many lists of as many entries as there are joints, each an entry of `inner` numbers.
    pub(super) fn contract(&self, pool: &mut Pool, entries: &[ExprId], inner: usize) -> Vec<ExprId> {
        let (joints, coordinates) = (self.rows.len(), self.coupling.coordinates.len());
        let mut sums = vec![ExprId::ZERO; entries.len() / joints * coordinates];
        for (place, &entry) in entries.iter().enumerate() {
            let (outer, joint, own) = (place / (joints * inner), place / inner % joints, place % inner);
            for &(a, factor) in &self.rows[joint] {
                let sum = &mut sums[(outer * coordinates + a) * inner + own];
                let product = pool.mul(factor, entry);
                *sum = pool.add(*sum, product);
            }
        }
        sums
    }

    /// Expressions in joint variables as expressions in coordinates.
    pub(super) fn substitute(&self, pool: &Pool, into: &mut Pool, exprs: &[ExprId]) -> Vec<ExprId> {
        let (all, joints) = pool.with_gravity(exprs);
        let mut found = pool.substitute_into(into, &all, &|pool, symbol| self.of_symbol(pool, symbol));
        // The gravity torque of a joint whose friction grows with it: the joint is not coupled.
        let coordinates: Vec<u16> = joints.into_iter().map(|joint| self.own(joint)).collect();
        into.take_gravity(&mut found, &coordinates);
        found
    }

    /// The joints with a coordinate.
    pub(super) fn coordinates(&self) -> &[usize] {
        &self.coupling.coordinates
    }

    /// S a of one number for each coordinate.
    pub(super) fn spread(&self, pool: &mut Pool, numbers: &[ExprId]) -> Vec<ExprId> {
        let of_joint = |pool: &mut Pool, row: &[(usize, ExprId)]| {
            let (factors, own): (Vec<ExprId>, Vec<ExprId>) = row.iter().map(|&(a, factor)| (factor, numbers[a])).unzip();
            pool.dot(&factors, &own)
        };
        self.rows.iter().map(|row| of_joint(pool, row)).collect()
    }

    /// Coordinates whose sum or difference is the variable of a joint that turns, and whether it is the difference.
    pub(super) fn pairs(&self) -> Vec<(usize, usize, bool)> {
        let of_joint = |variable: &JointVariable| {
            let sum = as_sum(&[(variable, false)])?;
            let [(first, plus), (second, minus)] = sum.terms().collect::<Vec<_>>().try_into().ok()?;
            let (low, high) = (first.min(second), first.max(second));
            Some((usize::from(low), usize::from(high), plus != minus))
        };
        self.coupling.variables.iter().filter(|variable| variable.turn.is_some()).filter_map(of_joint).collect()
    }

    /// Whether a joint moves with one coordinate.
    pub(super) fn has_one_coordinate(&self, joint: usize) -> bool {
        self.rows[joint].len() == 1
    }

    fn variable(&self, joint: u16) -> &JointVariable {
        &self.coupling.variables[usize::from(joint)]
    }

    /// The coordinate of a joint, where it has a coordinate.
    fn own(&self, joint: u16) -> u16 {
        let place = self.coupling.coordinates.iter().position(|&of| of == usize::from(joint));
        place.expect("validation asks for a coordinate here") as u16
    }

    fn of_symbol(&self, pool: &mut Pool, symbol: Symbol) -> ExprId {
        match symbol {
            Symbol::Position(i) => {
                let sum = self.sum(pool, i, Symbol::Position);
                let offset = pool.constant(&self.variable(i).offset);
                pool.add(sum, offset)
            }
            Symbol::Rate(i) => self.sum(pool, i, Symbol::Rate),
            Symbol::Acceleration(i) => self.sum(pool, i, Symbol::Acceleration),
            Symbol::ReferenceRate(i) => self.sum(pool, i, Symbol::ReferenceRate),
            Symbol::ReferenceAcceleration(i) => self.sum(pool, i, Symbol::ReferenceAcceleration),
            Symbol::Sine(i) => self.circle(pool, AngleSum::of(i)).0,
            Symbol::Cosine(i) => self.circle(pool, AngleSum::of(i)).1,
            Symbol::SineOf(sum) => self.circle(pool, sum).0,
            Symbol::CosineOf(sum) => self.circle(pool, sum).1,
            Symbol::OfRate(Elementary::Sign, i) => match self.variable(i).factors.as_slice() {
                [] => ExprId::ZERO,
                // Validation refuses a sign of several rates.
                [(a, factor), ..] => {
                    pool.symbol(Symbol::OfRate(Elementary::Sign, *a as u16)).signed(factor.sign() == Ordering::Less)
                }
            },
            Symbol::OfRate(of, i) => pool.symbol(Symbol::OfRate(of, self.own(i))),
            Symbol::GravitySize(i) => pool.symbol(Symbol::GravitySize(self.own(i))),
            Symbol::GravitySign(i) => pool.symbol(Symbol::GravitySign(self.own(i))),
            Symbol::Torque(_) | Symbol::Parameter(_) | Symbol::Gravity(_) => pool.symbol(symbol),
        }
    }

    /// Σ k x_a of the rates, or whatever `symbol` is, of the coordinates of a joint.
    fn sum(&self, pool: &mut Pool, joint: u16, symbol: fn(u16) -> Symbol) -> ExprId {
        let mut sum = ExprId::ZERO;
        for (a, factor) in &self.variable(joint).factors {
            let (factor, own) = (pool.constant(factor), pool.symbol(symbol(*a as u16)));
            let product = pool.mul(factor, own);
            sum = pool.add(sum, product);
        }
        sum
    }

    /// Sine and cosine of a sum of joint variables.
    fn circle(&self, pool: &mut Pool, sum: AngleSum) -> (ExprId, ExprId) {
        let known = self.coupling.sums.iter().find(|known| known.joints == sum);
        let terms: Vec<(&JointVariable, bool)> = match known {
            Some(known) => vec![(&known.variable, false)],
            None => sum.terms().map(|(joint, minus)| (self.variable(joint), minus)).collect(),
        };
        if let Some(sum) = as_sum(&terms) {
            let (sum, opposite) = sum.unsigned();
            let (sine, cosine) = match sum.plus | sum.minus {
                one if one.is_power_of_two() => {
                    let a = one.trailing_zeros() as u16;
                    (Symbol::Sine(a), Symbol::Cosine(a))
                }
                _ => (Symbol::SineOf(sum), Symbol::CosineOf(sum)),
            };
            return (pool.symbol(sine).signed(opposite), pool.symbol(cosine));
        }
        let mut circle = (ExprId::ZERO, ExprId::ONE);
        let plus = |pool: &mut Pool, (s, c): (ExprId, ExprId), (t, d): (ExprId, ExprId)| {
            (pool.dot(&[s, c], &[d, t]), pool.dot(&[c, -s], &[d, t]))
        };
        for (variable, minus) in terms {
            if let Some((sine, cosine)) = self.computed(pool, variable) {
                circle = plus(pool, circle, (sine.signed(minus), cosine));
                continue;
            }
            if let Some([sine, cosine]) = &variable.turn {
                let turn = (pool.constant(sine).signed(minus), pool.constant(cosine));
                circle = plus(pool, circle, turn);
            }
            for (a, factor) in &variable.factors {
                let (sine, cosine) = (pool.symbol(Symbol::Sine(*a as u16)), pool.symbol(Symbol::Cosine(*a as u16)));
                let opposite = minus != (factor.sign() == Ordering::Less);
                for _ in 0..factor.to_f64().abs() as usize {
                    circle = plus(pool, circle, (sine.signed(opposite), cosine));
                }
            }
        }
        circle
    }

    /// Sine and cosine of a variable whose angle the function computes.
    fn computed(&self, pool: &mut Pool, variable: &JointVariable) -> Option<(ExprId, ExprId)> {
        let (angle, opposite) = variable.computed()?;
        let place = self.computed.iter().position(|of| *of == angle)?;
        let index = (self.coupling.coordinates.len() + place) as u16;
        Some((pool.symbol(Symbol::Sine(index)).signed(opposite), pool.symbol(Symbol::Cosine(index))))
    }
}

/// A sum of variables, some of them taken away, as a sum of coordinates, where it is one without a constant in which each stands once.
fn as_sum(terms: &[(&JointVariable, bool)]) -> Option<AngleSum> {
    let mut all = AngleSum { plus: 0, minus: 0, turned: false };
    for (JointVariable { factors, offset, is_whole, .. }, minus) in terms {
        for (a, factor) in factors {
            let opposite = factor.sign() == Ordering::Less;
            let is_one = if opposite { (-factor).is_one() } else { factor.is_one() };
            if !is_one || (all.plus | all.minus) >> a & 1 == 1 {
                return None;
            }
            *(if opposite != *minus { &mut all.minus } else { &mut all.plus }) |= 1 << a;
        }
        if !offset.is_zero() || !is_whole {
            return None;
        }
    }
    (all.plus | all.minus != 0).then_some(all)
}
