//! Terms of friction that no motion can tell from other parameters, whatever their values: the rank of all columns, exactly.
//!
//! Along gravity the torque of a mass is m (ddq - g), that of a rotor inertia ratio² Im ddq, and an offset of friction is constant: one of
//! the three depends on the others. The coupling of a rotor with the turning of its link is left out here: it is weaker by the ratio, so
//! that in logs it does not tell the three apart. A gravity torque that is constant makes load friction a multiple of Coulomb friction.

use armgen_codegen::derive::base::{dependence, regressor_of, Dependence};
use armgen_codegen::derive::parameters::{ParameterKind, ParameterVector, StandardParameter};
use armgen_codegen::ring::{Elementary, ExprId, Pool, Symbol};
use armgen_codegen::Model;

/// A term of friction that depends on other columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependent {
    /// The joint.
    pub joint: usize,
    /// The term, in the order of the friction of a [`Joint`](super::Joint).
    pub term: usize,
    /// Base parameters and, by joint and term, friction that it is a combination of; both empty: it exerts no torque.
    pub on: (Vec<usize>, Vec<(usize, usize)>),
}

/// The terms of friction that depend on base parameters and on terms before them.
pub(super) fn dependent_friction(model: &Model, base: &ParameterVector) -> Vec<Dependent> {
    let (mut pool, mut y) = regressor_of(&model.manipulator, &model.field, base);
    let (joints, first) = (y.len(), base.len());
    let gravity = gravity(&pool, &y);
    if let ParameterKind::Base(kept) = &base.kind {
        let rotors = kept.iter().enumerate().filter_map(|(column, parameter)| match parameter {
            StandardParameter::RotorInertia(joint) => Some((column, usize::from(*joint))),
            _ => None,
        });
        for (column, joint) in rotors {
            y.iter_mut().for_each(|row| row[column] = ExprId::ZERO);
            y[joint][column] = pool.symbol(Symbol::ReferenceAcceleration(joint as u16));
        }
    }
    for (row, entries) in y.iter_mut().enumerate() {
        for joint in 0..joints {
            let terms = if row == joint { terms(&mut pool, joint as u16, gravity[joint]) } else { [ExprId::ZERO; 6] };
            entries.extend(terms);
        }
    }
    let place = |column: usize| ((column - first) / 6, (column - first) % 6);
    let Dependence { dependent, too_long, .. } = dependence(&pool, &y);
    let columns = |(column, combination): (usize, Vec<(usize, _)>)| (column, combination.into_iter().map(|(of, _)| of).collect());
    dependent
        .into_iter()
        .map(columns)
        .chain(too_long)
        .filter(|(column, _)| *column >= first)
        .map(|(column, combination): (usize, Vec<usize>)| {
            let (joint, term) = place(column);
            let of_base = combination.iter().copied().filter(|&column| column < first).collect();
            let of_friction = combination.iter().copied().filter(|&c| c >= first).map(place).collect();
            Dependent { joint, term, on: (of_base, of_friction) }
        })
        .collect()
}

/// What the gravity torque of a joint is as a function of the positions.
#[derive(Clone, Copy)]
enum Gravity {
    Zero,
    Constant,
    Varies,
}

fn gravity(pool: &Pool, y: &[Vec<ExprId>]) -> Vec<Gravity> {
    let mut at_rest = Pool::new(pool.field().clone());
    y.iter()
        .map(|row| {
            let entries = pool.substitute_into(&mut at_rest, row, &|at_rest, symbol| match symbol {
                Symbol::Rate(_) | Symbol::Acceleration(_) | Symbol::ReferenceRate(_) | Symbol::ReferenceAcceleration(_) => {
                    ExprId::ZERO
                }
                other => at_rest.symbol(other),
            });
            if entries.iter().all(|entry| *entry == ExprId::ZERO) {
                Gravity::Zero
            } else if entries.iter().all(|entry| at_rest.is_constant(*entry)) {
                Gravity::Constant
            } else {
                Gravity::Varies
            }
        })
        .collect()
}

/// Viscous, Coulomb, offset, load, cubic and Stribeck friction.
fn terms(pool: &mut Pool, joint: u16, gravity: Gravity) -> [ExprId; 6] {
    let rate = pool.symbol(Symbol::Rate(joint));
    let sign = pool.symbol(Symbol::OfRate(Elementary::Sign, joint));
    let square = pool.mul(rate, rate);
    let fading = pool.symbol(Symbol::OfRate(Elementary::Decay, joint));
    let load = match gravity {
        Gravity::Zero => ExprId::ZERO,
        Gravity::Constant => sign,
        Gravity::Varies => {
            // A symbol of its own: |g| is no polynomial of the positions.
            let size = pool.symbol(Symbol::Torque(joint));
            pool.mul(sign, size)
        }
    };
    [rate, sign, ExprId::ONE, load, pool.mul(square, rate), pool.mul(sign, fading)]
}
