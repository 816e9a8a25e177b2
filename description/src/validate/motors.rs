//! The motor of a joint: its rotor, the link that it rides on, and the joints that it spins with.
//!
//! ```text
//! T = ½ I_m (z · omega_on + k_r dq_i + Σ k_j dq_j)²      on: the link before, or that of `on`;  k_j: the factors of `coupling`
//! ```
//!
//! Absent from here on: names of carriers and of joints, factors of 0.

use std::cmp::Ordering;

use super::bodies::{optional_not_negative, warn_of_massless};
use super::coupling::named;
use super::number::text_of;
use super::parents::BASE;
use super::{call, geometry, zeros, Context};
use crate::description::{JointDescription, LeadersDescription, MotorDescription};
use crate::diagnostic::Code;
use crate::document::excerpt;
use crate::exact::{Number, Polynomial};
use crate::manipulator::{LinkId, Motor};
use crate::source::Spanned;
use crate::suggest::did_you_mean;

/// The motor of joint `i`; faults are reported. `joint_axis`: in the frame of `parent`, the link that carries the joint.
pub(super) fn motor(
    (i, description): (usize, &MotorDescription),
    joint_axis: Option<[Number; 3]>,
    parent: Option<LinkId>,
    joints: &[JointDescription],
    context: &mut Context<'_>,
) -> Option<Motor> {
    let called = &call(i, &joints[i]);
    let ratio = match &description.ratio {
        Some(ratio) => {
            let nominal = context.number(ratio);
            if nominal.is_some_and(|r| r.sign() == Ordering::Equal) {
                let message = format!("the gear ratio of joint {called} is 0");
                let help = "a rotor that does not turn with its joint drives nothing: give rotor speed over joint speed, or leave `motor` out";
                context.report(Code::ZeroRatio, ratio.span, message, "this is 0", help);
            }
            context.polynomial(ratio)
        }
        None => Some(Polynomial::from(Number::one())),
    };
    let carrier = match &description.on {
        Some(on) => carrier(on, description, called, joints, context),
        None => Some(parent),
    };
    let coupling = match &description.coupling {
        Some(coupling) => self::coupling(i, coupling, joints, context),
        None => Some(Vec::new()),
    };
    let of = |what: &str| format!("the {what} of the motor of joint {called}");
    let inertia = optional_not_negative(&description.inertia, &of("inertia"), Code::NegativeRotorInertia, context);
    let mass = optional_not_negative(&description.mass, &of("mass"), Code::NegativeMass, context);
    let viscous = optional_not_negative(&description.viscous, &of("viscous friction"), Code::NegativeFriction, context);
    let position = match &description.position {
        Some(position) => context.polynomials(&position.value),
        None => Some(zeros()),
    };
    if let (Some(given), Some(mass), Some(position)) = (&description.position, &mass, &position) {
        let none = Polynomial::zero();
        warn_of_massless(mass.as_ref().unwrap_or(&none), position, given.span, &of("position"), context);
    }
    let axis = match &description.axis {
        Some(axis) => context.numbers(&axis.value).and_then(|a| {
            let help = "give the direction as a vector other than 0, or leave `axis` out for the joint axis";
            geometry::unit_vector(a, axis.span, &format!("the motor axis of joint {called}"), help, context)
        }),
        None => joint_axis,
    };
    let gain = match &description.gain {
        Some(given) => {
            let gain = context.number(given)?;
            if gain.sign() != Ordering::Greater {
                let message = format!("the gain of the motor of joint {called} is not positive");
                let help = "give the torque at the joint per ampere, above 0; a current with the other sign is turned in its log";
                context.report(Code::NonPositiveLimit, given.span, message, format!("this is {}", text_of(&gain)), help);
            }
            Some(gain)
        }
        None => None,
    };
    Some(Motor {
        ratio: ratio?,
        carrier: carrier?,
        coupling: coupling?,
        inertia: inertia?,
        mass: mass?.unwrap_or_default(),
        position: position?,
        axis: axis?,
        viscous: viscous?,
        gain,
    })
}

/// The link that `on` names; `Some(None)` is the base.
fn carrier(
    on: &Spanned<String>,
    motor: &MotorDescription,
    called: &str,
    joints: &[JointDescription],
    context: &mut Context<'_>,
) -> Option<Option<LinkId>> {
    if motor.axis.is_none() {
        let message = format!("the motor of joint {called} has `on` and no `axis`");
        let help = "add the direction of the spin axis in the frame of that link: `axis: [0, 0, 1]`";
        context.report(Code::CarrierWithoutAxis, on.span, message, "about which axis of this link?", help);
    }
    if on.value == BASE {
        return Some(None);
    }
    let mut names: Vec<&str> = joints.iter().map(|joint| joint.name.as_ref().map_or("", |name| name.value.as_str())).collect();
    if let Some(place) = names.iter().position(|name| *name == on.value) {
        return Some(Some(LinkId(u32::try_from(place).expect("the number of joints is bounded"))));
    }
    names.push(BASE);
    let help = match did_you_mean(&on.value, &names) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => "name the joint whose link carries the motor, or `base`; leave `on` out for the link before".into(),
    };
    let message = format!("the motor of joint {called} is on `{}`, which is no joint", excerpt(&on.value));
    context.report(Code::UnknownCarrier, on.span, message, "unknown joint", help);
    None
}

/// The joints that the motor of joint `i` spins with, besides that one.
fn coupling(
    i: usize,
    description: &LeadersDescription,
    joints: &[JointDescription],
    context: &mut Context<'_>,
) -> Option<Vec<(usize, Number)>> {
    let mut others = named("coupling", description, joints, context)?;
    if let Some(own) = others.iter().find(|other| other.joint == i) {
        let message = format!("the motor of joint {} is coupled with that joint itself", call(i, &joints[i]));
        context.report(Code::UnknownLeader, own.span, message, "its own joint", "write this factor as `ratio`");
        return None;
    }
    others.sort_by_key(|other| other.joint);
    Some(others.into_iter().map(|other| (other.joint, other.factor)).collect())
}
