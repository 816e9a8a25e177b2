//! Friction at joints: a sum of terms, each a coefficient times a function of the rate.
//!
//! ```text
//! F_i = F_v dq_i + F_3 dq_i³ + F_c sign(dq_i) + F_0 + F_s sign(dq_i) exp(-|dq_i| / v_s)
//! ```
//!
//! Smooth friction has tanh(dq_i / v) in place of sign(dq_i). F_v has what the rotor adds, k_r² F_m; that of a rotor
//! which spins with several joints is no term of one joint: `rotors.rs`. Friction that grows with the load depends on q: `quantities/load_friction.rs`.

use super::arm::{Arm, Joint};
use super::parameters::StandardParameter;
use super::rotors;
use crate::ring::{Elementary, ExprId, Pool, Symbol};

/// The function that a coefficient is multiplied with at joint `i`, but for the factor dq of viscous and cubic friction.
type Function = fn(&mut Pool, &Arm, usize) -> ExprId;

/// A term of friction.
struct Term {
    /// Its coefficient.
    coefficient: fn(&Joint) -> ExprId,
    /// The coefficient as a parameter.
    parameter: fn(u16) -> StandardParameter,
    /// The function without its factor dq.
    function: Function,
    /// Whether the function has the factor dq, which may be a reference rate.
    times_rate: bool,
    /// The derivative of the torque by dq, for a coefficient; `None`: 0, but where it jumps.
    slope: Option<fn(&mut Pool, &Arm, usize, ExprId) -> ExprId>,
}

/// All terms. Those with the factor dq come first, to be multiplied with it once.
static TERMS: [Term; 5] = [
    Term {
        coefficient: |joint| joint.viscous,
        parameter: StandardParameter::Viscous,
        function: |_, _, _| ExprId::ONE,
        times_rate: true,
        slope: Some(|_, _, _, coefficient| coefficient),
    },
    Term {
        coefficient: |joint| joint.cubic,
        parameter: StandardParameter::Cubic,
        function: square_of_rate,
        times_rate: true,
        slope: Some(|pool, arm, i, coefficient| {
            let square = square_of_rate(pool, arm, i);
            let (steep, three) = (pool.mul(coefficient, square), pool.integer(3));
            pool.mul(three, steep)
        }),
    },
    Term {
        coefficient: |joint| joint.coulomb,
        parameter: StandardParameter::Coulomb,
        function: direction,
        times_rate: false,
        // F_c (1 - tanh²) / v; 0 for a sign.
        slope: Some(|pool, arm, i, coefficient| {
            if !arm.joints[i].is_smooth {
                return ExprId::ZERO;
            }
            let (along, inverse) = (direction(pool, arm, i), pool.reciprocal(arm.joints[i].friction_velocity));
            let square = pool.mul(along, along);
            let (steepness, rest) = (pool.mul(coefficient, inverse), pool.sub(ExprId::ONE, square));
            pool.mul(steepness, rest)
        }),
    },
    Term {
        coefficient: |joint| joint.offset,
        parameter: StandardParameter::Offset,
        function: |_, _, _| ExprId::ONE,
        times_rate: false,
        slope: None,
    },
    Term {
        coefficient: |joint| joint.stribeck,
        parameter: StandardParameter::Stribeck,
        function: |pool, _, i| {
            let (sign, decay) = (of_rate(pool, Elementary::Sign, i), of_rate(pool, Elementary::Decay, i));
            pool.mul(sign, decay)
        },
        times_rate: false,
        // 0 at rest, where it jumps.
        slope: Some(|pool, arm, i, coefficient| {
            let (sign, decay) = (of_rate(pool, Elementary::Sign, i), of_rate(pool, Elementary::Decay, i));
            let inverse = pool.reciprocal(arm.joints[i].friction_velocity);
            let steepness = pool.mul(coefficient, inverse);
            let square = pool.mul(sign, sign);
            let moving = pool.mul(square, decay);
            -pool.mul(steepness, moving)
        }),
    },
];

fn of_rate(pool: &mut Pool, function: Elementary, i: usize) -> ExprId {
    pool.symbol(Symbol::OfRate(function, i as u16))
}

fn square_of_rate(pool: &mut Pool, _: &Arm, i: usize) -> ExprId {
    let rate = pool.symbol(Symbol::Rate(i as u16));
    pool.mul(rate, rate)
}

/// The function of Coulomb friction: sign(dq), with sign(0) = 0, or tanh(dq / v).
fn direction(pool: &mut Pool, arm: &Arm, i: usize) -> ExprId {
    of_rate(pool, if arm.joints[i].is_smooth { Elementary::Tanh } else { Elementary::Sign }, i)
}

/// F of each joint: terms with the factor dq take it from `rates`, and are linear in them where these are reference rates.
pub(super) fn friction(pool: &mut Pool, arm: &Arm, rates: &[ExprId]) -> Vec<ExprId> {
    let of_joint = |i: usize| {
        let joint = &arm.joints[i];
        let mut sum = ExprId::ZERO;
        for times_rate in [true, false] {
            for term in TERMS.iter().filter(|term| term.times_rate == times_rate) {
                let coefficient = (term.coefficient)(joint);
                if coefficient != ExprId::ZERO {
                    let function = (term.function)(pool, arm, i);
                    let torque = pool.mul(coefficient, function);
                    sum = pool.add(sum, torque);
                }
            }
            if times_rate {
                sum = pool.mul(sum, rates[i]);
                // Symbols of the joints follow each other, whatever joint needs them.
                direction(pool, arm, i);
            }
        }
        sum
    };
    let mut torques = (0..arm.dof()).map(of_joint).collect::<Vec<ExprId>>();
    rotors::add_friction(pool, arm, rates, &mut torques);
    torques
}

/// ∂F/∂dq of joint `i` beyond the derivatives that `rest` holds; functions that jump count as constant there.
pub(super) fn add_slopes(pool: &mut Pool, arm: &Arm, i: usize, rest: ExprId) -> ExprId {
    let mut sum = rest;
    for term in &TERMS {
        let coefficient = (term.coefficient)(&arm.joints[i]);
        if let Some(slope) = term.slope.filter(|_| coefficient != ExprId::ZERO) {
            let slope = slope(pool, arm, i, coefficient);
            sum = pool.add(sum, slope);
        }
    }
    sum
}

/// The column of a coefficient of friction at joint `i`, at a reference rate; `None` for another parameter.
pub(super) fn column(pool: &mut Pool, arm: &Arm, i: usize, parameter: StandardParameter, reference: ExprId) -> Option<ExprId> {
    let term = TERMS.iter().find(|term| (term.parameter)(i as u16) == parameter)?;
    let function = (term.function)(pool, arm, i);
    Some(if term.times_rate { pool.mul(function, reference) } else { function })
}
