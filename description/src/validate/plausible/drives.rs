//! Drives and limits of the joints: rotors, armatures, friction, limits of rates and efforts.

use super::slips::{in_text, written_as};
use super::{is_in_degrees, number, short, written, Arm, FASTEST_SLIDE, FASTEST_TURN, LEAST_RATIO, REFLECTED, SMALL_REACH};
use crate::description::{JointDescription, Value};
use crate::diagnostic::Code;
use crate::document::excerpt;
use crate::exact::Rational;
use crate::kinds::JointKind;
use crate::validate::parents::BASE;
use crate::validate::Context;

/// m/s²: what holds an arm is compared with its weight on earth, wherever it is.
const EARTH: f64 = 9.81;
/// Friction of a joint beyond so many times the weight of the arm at its reach is no friction of that arm.
const FRICTION: f64 = 5.0;
/// Load friction beyond: a joint would need three times the weight to lift it.
const MOST_LOAD: f64 = 2.0;
/// An effort limit beyond so many times that weight belongs to no motor of that arm.
const STRONGEST: f64 = 300.0;
/// rad/s and m/s: Stribeck friction has faded before.
const FADED_BY: [f64; 2] = [10.0, 1.0];
/// rad/s: a whole multiple of five from here on is a number of degrees per second.
const ROUND_RATE: f64 = 30.0;
/// Limits of acceleration and jerk beyond are in another unit: rad/s² and m/s², rad/s³ and m/s³.
const FASTEST_CHANGE: [[f64; 2]; 2] = [[500.0, 200.0], [1e6, 1e5]];
/// A joint this many times as fast as every other has a rate in another unit.
const OUTLYING_RATE: f64 = 8.0;

fn turns(joint: &JointDescription) -> bool {
    joint.kind.as_ref().is_none_or(|kind| kind.value == JointKind::Revolute)
}

impl Arm<'_> {
    pub(super) fn check_motor(&self, joint: &JointDescription, called: &str, context: &mut Context<'_>) {
        self.check_armature(joint, called, context);
        let Some(motor) = &joint.motor else { return };
        self.check_rotor_mass(motor, called, context);
        let ratio = motor.ratio.as_ref().map_or(1.0, |ratio| context.number(ratio).map_or(1.0, |number| number.to_f64())).abs();
        if let (true, Some(expression)) = (ratio > 0.0 && ratio < LEAST_RATIO, &motor.ratio) {
            let span = written(expression, context);
            let message =
                format!("the gear of joint {called} would make the joint {} times as fast as the rotor", short(1.0 / ratio));
            let help = format!(
                "`ratio` is rotor speed over joint speed; if this is the inverse, write {}",
                inverse(expression, context)
            );
            context.report(Code::InvertedRatio, span, message, "inverted?", help);
            return;
        }
        let (Some(expression), inertia) = (&motor.inertia, number(&motor.inertia, context)) else { return };
        let total: f64 = self.masses.iter().sum();
        let turns = joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Revolute);
        let (reach, unit) = if turns { (self.reach, "kg m²") } else { (1.0, "kg") };
        let whole = total * reach * reach;
        let reflected = inertia * ratio * ratio;
        if whole > 0.0 && self.reach > SMALL_REACH && ratio > 1.0 && reflected > REFLECTED * whole {
            let span = written(expression, context);
            let message = format!(
                "the rotor of joint {called} counts as {} {unit} at the joint, ratio² times its inertia; the whole arm at its reach is {} {unit}",
                short(reflected),
                short(whole)
            );
            // Of the units that data sheets of motors have, those with which it is a rotor of an arm.
            let units = super::UNITS_OF_INERTIA.iter().filter(|(_, unit)| ["in kg cm²", "in g cm²"].contains(unit));
            let fit = |factor: f64| reflected / factor <= REFLECTED * whole;
            let meant: String = units
                .filter(|(factor, unit)| fit(*factor) || *unit == "in g cm²")
                .filter_map(|(factor, unit)| {
                    Some(format!("; if it is {unit}, write {}", written_as(expression, *factor as u64, context)?))
                })
                .collect();
            let help = format!(
                "give the inertia before the gear in kg m²; if this is the one at the joint, divide it by ratio², {}{meant}",
                short(ratio * ratio)
            );
            context.report(Code::ReflectedRotor, span, message, "reflected already?", help);
        }
    }

    /// The addition to a joint's own entry of B, against the inertia of the whole arm at its reach.
    fn check_armature(&self, joint: &JointDescription, called: &str, context: &mut Context<'_>) {
        let Some(expression) = &joint.armature else { return };
        let (armature, total) = (number(&joint.armature, context), self.masses.iter().sum::<f64>());
        let (reach, unit) = if turns(joint) { (self.reach, "kg m²") } else { (1.0, "kg") };
        let whole = total * reach * reach;
        if whole <= 0.0 || self.reach <= SMALL_REACH || armature <= REFLECTED * whole {
            return;
        }
        let message = format!(
            "the armature of joint {called} is {} {unit}; the whole arm at its reach is {} {unit}",
            short(armature),
            short(whole)
        );
        let help = match written_as(expression, 10_000, context).filter(|_| turns(joint)) {
            Some(text) => format!("it counts at the joint, in {unit}; if this is in kg cm², write {text}"),
            None => format!("it counts at the joint, in {unit}"),
        };
        context.report(Code::ImplausibleArmature, written(expression, context), message, "more than the arm", help);
    }

    /// A rotor is lighter than the arm, and sits within it.
    fn check_rotor_mass(&self, motor: &crate::description::MotorDescription, called: &str, context: &mut Context<'_>) {
        let (mass, total) = (number(&motor.mass, context), self.masses.iter().sum::<f64>());
        if let (true, Some(expression)) = (total > 0.0 && mass > total, &motor.mass) {
            let message = format!(
                "the motor of joint {called} weighs {} kg, more than all links together, {} kg",
                short(mass),
                short(total)
            );
            let help = in_text("masses are in kg", "g", written_as(expression, 1000, context));
            context.report(Code::ImplausibleMass, written(expression, context), message, "in g?", help);
        }
        let Some(position) = &motor.position else { return };
        let far = position.value.iter().map(|value| number(value, context).powi(2)).sum::<f64>().sqrt();
        if self.reach > SMALL_REACH && mass > 0.0 && far > self.reach + super::HOUSING {
            let carrier = match &motor.on {
                None => "the link before it".to_owned(),
                Some(on) if on.value == BASE => "the base".to_owned(),
                Some(on) => format!("the link of joint `{}`", excerpt(&on.value)),
            };
            let message = format!(
                "the motor of joint {called} sits {} m from the frame of {carrier}, and the arm is {} m long",
                short(far),
                short(self.reach)
            );
            let help = format!("lengths are in m, from the frame of {carrier}; see whether this is in mm");
            context.report(Code::ImplausibleCom, position.span, message, "in mm?", help);
        }
    }

    /// The torque that holds the stretched arm on earth, N m or N; 0 if nothing follows from its size.
    fn weight(&self, joint: &JointDescription) -> f64 {
        let total: f64 = self.masses.iter().sum();
        match self.reach > SMALL_REACH {
            true if turns(joint) => EARTH * total * self.reach,
            true => EARTH * total,
            false => 0.0,
        }
    }

    /// Friction and efforts against the weight of the arm.
    pub(super) fn check_sizes(&self, joint: &JointDescription, called: &str, context: &mut Context<'_>) {
        let (weight, turns) = (self.weight(joint), turns(joint));
        let unit = if turns { "N m" } else { "N" };
        let ratio = |context: &mut Context<'_>| {
            joint
                .motor
                .as_ref()
                .and_then(|motor| motor.ratio.as_ref())
                .map_or(1.0, |ratio| context.number(ratio).map_or(1.0, |n| n.to_f64()))
        };
        let gear = ratio(context).powi(2);
        let at_rotor = joint.motor.as_ref().map_or(&None, |motor| &motor.viscous);
        // At 1 rad/s or 1 m/s.
        let kinds: [(&Value, &str, f64); 3] = [
            (&joint.friction.coulomb, "Coulomb friction", 1.0),
            (&joint.friction.viscous, "viscous friction at a rate of 1", 1.0),
            (at_rotor, "viscous friction of the rotor, at the joint and a rate of 1,", gear),
        ];
        for (value, kind, factor) in kinds {
            let size = number(value, context) * factor;
            let Some(expression) = value.as_ref().filter(|_| weight > 0.0 && size > FRICTION * weight) else { continue };
            let message = format!(
                "the {kind} of joint {called} is {} {unit}; to hold the whole arm at its reach takes {} {unit}",
                short(size),
                short(weight)
            );
            let milli = if turns { "mN m" } else { "mN" };
            let help = in_text("torques are in N m, forces in N", milli, written_as(expression, 1000, context));
            context.report(Code::ImplausibleFriction, written(expression, context), message, "too much", help);
        }
        let load = number(&joint.friction.load, context);
        if let (true, Some(expression)) = (load > MOST_LOAD, &joint.friction.load) {
            let message = format!("the friction of joint {called} grows by {} times its load", short(load));
            let help = in_text(
                "`load` is a part of the torque that gravity asks for, usually below 0.5",
                "percent",
                written_as(expression, 100, context),
            );
            context.report(Code::ImplausibleFriction, written(expression, context), message, "in percent?", help);
        }
        check_fading(joint, called, turns, context);
        let effort = number(&joint.limits.effort, context);
        if let (true, Some(expression)) = (weight > 0.0 && effort > STRONGEST * weight, &joint.limits.effort) {
            let message = format!(
                "the effort limit of joint {called} is {} {unit}; to hold the whole arm at its reach takes {} {unit}",
                short(effort),
                short(weight)
            );
            let milli = if turns { "mN m" } else { "mN" };
            let help = in_text("torques are in N m, forces in N", milli, written_as(expression, 1000, context));
            context.report(Code::ImplausibleEffort, written(expression, context), message, format!("in {milli}?"), help);
        }
    }

    /// The velocity limits of joints that turn: one in degrees per second may be one that others reach in radians.
    pub(super) fn check_rates(&self, context: &mut Context<'_>) {
        let rates: Vec<f64> = self.joints.iter().map(|joint| number(&joint.limits.velocity, context)).collect();
        for (i, joint) in self.joints.iter().enumerate() {
            let Some(expression) = joint.limits.velocity.as_ref().filter(|_| turns(joint)) else { continue };
            let definition = super::definition(expression, context).clone();
            let whole = definition.as_decimal().is_some_and(|value| (value / Rational::from(5)).is_int());
            let others: Vec<f64> =
                (0..rates.len()).filter(|&k| k != i && turns(&self.joints[k]) && rates[k] > 0.0).map(|k| rates[k]).collect();
            let fastest = others.iter().copied().fold(0.0, f64::max);
            let outlying = definition.as_decimal().is_some_and(|value| value.is_int())
                && fastest > 0.0
                && rates[i] > OUTLYING_RATE * fastest;
            let rate = rates[i];
            if rate > FASTEST_TURN || !(outlying || whole && rate >= ROUND_RATE) {
                continue;
            }
            let called = crate::validate::call(i, joint);
            let span = written(expression, context);
            let text = context.source.slice(span).to_owned();
            let message = match outlying {
                true => format!(
                    "the velocity limit of joint {called} is {} rad/s, that of every other joint {} or less",
                    short(rate),
                    short(fastest)
                ),
                false => format!(
                    "the velocity limit of joint {called} is {} rad/s, which hardly a joint of an arm reaches",
                    short(rate)
                ),
            };
            let help = format!(
                "rates are in rad/s; if this is in degrees per second, write `deg({text})`, which is {}",
                short(rate.to_radians())
            );
            context.report(Code::ImplausibleVelocity, span, message, "in degrees per second?", help);
        }
    }
}

/// 1 over a value.
fn inverse(expression: &crate::document::Expression, context: &Context<'_>) -> String {
    let definition = super::definition(expression, context);
    let exact = definition
        .as_decimal()
        .filter(|value| !value.is_zero())
        .and_then(|value| crate::document::decimal_text(&(Rational::from(1) / value)));
    exact.unwrap_or_else(|| match definition.as_decimal() {
        Some(_) => format!("1/{}", definition.text(context.source)),
        None => format!("1/({})", definition.text(context.source)),
    })
}

/// Stribeck friction fades at rates that joints creep at.
fn check_fading(joint: &JointDescription, called: &str, turns: bool, context: &mut Context<'_>) {
    let Some(stribeck) = &joint.friction.stribeck else { return };
    let velocity = number(&stribeck.velocity, context);
    let limit = joint.limits.velocity.as_ref().map_or(f64::INFINITY, |_| number(&joint.limits.velocity, context));
    let most = FADED_BY[usize::from(!turns)].min(limit);
    let Some(expression) = stribeck.velocity.as_ref().filter(|_| velocity > most) else { return };
    let span = written(expression, context);
    let text = context.source.slice(span).to_owned();
    let (unit, help) = match turns {
        true => ("rad/s", format!("rates are in rad/s; if this is in degrees per second, write `deg({text})`")),
        false => ("m/s", in_text("rates are in m/s", "mm/s", written_as(expression, 1000, context))),
    };
    let message = format!(
        "the Stribeck friction of joint {called} fades at {} {unit}, {}",
        short(velocity),
        if velocity > limit { "beyond the velocity limit" } else { "where no joint begins to move" }
    );
    context.report(Code::ImplausibleFriction, span, message, "the rate at which 1/e is left", help);
}

pub(super) fn check_effort(joint: &JointDescription, called: &str, context: &mut Context<'_>) {
    let Some(expression) = &joint.limits.effort else { return };
    let effort = number(&joint.limits.effort, context);
    let (coulomb, offset) = (number(&joint.friction.coulomb, context), number(&joint.friction.offset, context));
    let dry = coulomb + offset.abs();
    if effort > 0.0 && dry >= effort {
        let span = written(expression, context);
        let turns = joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Revolute);
        let unit = if turns { "N m" } else { "N" };
        let way = match coulomb - offset.abs() < effort {
            true if offset > 0.0 => " forwards",
            true => " backwards",
            false => "",
        };
        let message = format!(
            "joint {called} cannot move{way}: its dry friction of {} {unit} takes all of its effort limit of {} {unit}",
            short(dry),
            short(effort)
        );
        let help = "both count at the joint, behind the gear: a motor's torque is to be multiplied by `ratio`";
        context.report(Code::WeakEffort, span, message, "no more than friction", help);
    }
}

pub(super) fn check_velocity(joint: &JointDescription, called: &str, context: &mut Context<'_>) {
    let Some(expression) = &joint.limits.velocity else { return };
    let velocity = number(&joint.limits.velocity, context);
    let turns = joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Revolute);
    let span = written(expression, context);
    if turns && velocity > FASTEST_TURN {
        let text = context.source.slice(span).to_owned();
        let message =
            format!("the velocity limit of joint {called} is {} rad/s: no joint of an arm turns as fast", short(velocity));
        let help = format!(
            "rates are in rad/s; if this is in degrees per second, write `deg({text})`, which is {}",
            short(velocity.to_radians())
        );
        context.report(Code::ImplausibleVelocity, span, message, "in degrees per second?", help);
    } else if !turns && is_in_degrees(expression, context) {
        let message = format!("the velocity limit of joint {called} is an angle in degrees per second, and the joint slides");
        let help = "rates of a prismatic joint are in m/s; see whether the joint is `revolute`";
        context.report(Code::DegreesSuspected, span, message, "an angle?", help);
    } else if !turns && velocity > FASTEST_SLIDE {
        let message =
            format!("the velocity limit of joint {called} is {} m/s: no joint of an arm slides as fast", short(velocity));
        let help = in_text("rates are in m/s", "mm/s", written_as(expression, 1000, context));
        context.report(Code::ImplausibleVelocity, span, message, "in mm/s?", help);
    }
}

pub(super) fn check_acceleration(joint: &JointDescription, called: &str, context: &mut Context<'_>) {
    let limits = [("acceleration", "²", &joint.limits.acceleration), ("jerk", "³", &joint.limits.jerk)];
    for ((what, power, limit), fastest) in limits.into_iter().zip(FASTEST_CHANGE) {
        let (Some(expression), value) = (limit, number(limit, context)) else { continue };
        let (unit, fastest) = if turns(joint) { ("rad", fastest[0]) } else { ("m", fastest[1]) };
        if value <= fastest {
            continue;
        }
        let span = written(expression, context);
        let message =
            format!("the {what} limit of joint {called} is {} {unit}/s{power}: no joint of an arm has as much", short(value));
        let text = context.source.slice(span).to_owned();
        let (help, label) = match turns(joint) {
            true => (
                format!(
                    "it is in rad/s{power}; if this is in degrees, write `deg({text})`, which is {}",
                    short(value.to_radians())
                ),
                "in degrees?",
            ),
            false => (in_text(&format!("it is in m/s{power}"), "mm", written_as(expression, 1000, context)), "in mm?"),
        };
        context.report(Code::ImplausibleVelocity, span, message, label, help);
    }
}

/// How many rates of each Stribeck velocity are looked at.
const RATES: u32 = 64;
/// After so many Stribeck velocities 1e-17 is left of its torque.
const FADED: u32 = 40;

/// Friction against the motion at a rate v is F_c - |F_0| + F_s exp(-v / v_s) + F_v v + F_3 v³ on the side that has less: it must not be negative up
/// to the limit.
pub(super) fn check_friction(joint: &JointDescription, called: &str, context: &mut Context<'_>) {
    let friction = &joint.friction;
    let (coulomb, offset) = (number(&friction.coulomb, context), number(&friction.offset, context).abs());
    let (cubic, viscous) = (number(&friction.cubic, context), number(&friction.viscous, context));
    let ratio = joint.motor.as_ref().map_or(0.0, |motor| {
        let ratio = motor.ratio.as_ref().and_then(|ratio| context.number(ratio)).map_or(1.0, |ratio| ratio.to_f64());
        ratio * ratio * number(&motor.viscous, context)
    });
    let limit = joint.limits.velocity.as_ref().map(|_| number(&joint.limits.velocity, context));
    let stribeck = friction.stribeck.as_ref();
    let (torque, fade) = stribeck.map_or((0.0, 1.0), |s| (number(&s.torque, context), number(&s.velocity, context)));
    let at = |v: f64| coulomb - offset + torque * (-v / fade).exp() + (viscous + ratio) * v + cubic * v.powi(3);
    // Only what fades can make up for the offset at rest and leave the joint driven later.
    let mut rates = (0..=FADED * RATES).map(|k| fade * f64::from(k) / f64::from(RATES));
    let driven_at = rates.find(|v| limit.is_none_or(|limit| *v <= limit) && at(*v) < 0.0).filter(|_| offset > coulomb);
    if let (Some(v), Some(expression)) = (driven_at, &friction.offset) {
        let span = written(expression, context);
        let (offset, coulomb) = (short(offset), short(coulomb));
        let message = if v == 0.0 {
            format!("the friction of joint {called} drives it at low rates: its offset of {offset} is more than its Coulomb friction of {coulomb}")
        } else {
            let v = short(v);
            format!("the friction of joint {called} drives it at {v}, where its Stribeck friction has faded: its offset of {offset} is more than its Coulomb friction of {coulomb}")
        };
        let help =
            "Coulomb friction is coulomb + offset forwards and coulomb - offset backwards; see whether the two are exchanged";
        context.report(Code::ActiveFriction, span, message, "more than `coulomb`", help);
        return;
    }
    let Some(expression) = friction.cubic.as_ref().filter(|_| cubic < 0.0) else { return };
    // With F_3 < 0 it is concave in v but for what fades, and least at an end.
    let (driven, where_) = match limit {
        Some(limit) => (at(limit) < 0.0, format!("at its velocity limit, {}", short(limit))),
        None => (true, "at high rates, and it has no velocity limit".to_owned()),
    };
    if driven {
        let span = written(expression, context);
        let message = format!("the friction of joint {called} drives it {where_}: cubic friction below 0 outweighs the rest");
        let help = "give the velocity limit up to which friction was measured, or leave `cubic` out";
        context.report(Code::ActiveFriction, span, message, "drives the joint", help);
    }
}
