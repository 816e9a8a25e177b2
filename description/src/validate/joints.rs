//! One joint: its frames, its link, limits, friction and spring.

use std::cmp::Ordering;

use super::bodies::{self, optional_not_negative};
use super::number::text_of;
use super::{call, geometry, motors, parents, Context};
use crate::description::{
    Convention, FrictionDescription, JointDescription, LimitsDescription, SpringDescription, StribeckDescription,
};
use crate::diagnostic::Code;
use crate::document::Expression;
use crate::exact::{Number, Polynomial};
use crate::kinds::JointKind;
use crate::manipulator::{Joint, Limits, LinkId, Pose, Spring, Stribeck};

/// The joint; faults are reported. `base`: the pose before rows on the base.
pub(super) fn joint(
    i: usize,
    all: &[JointDescription],
    base: Option<&Pose>,
    parent: Option<LinkId>,
    convention: Option<Convention>,
    context: &mut Context<'_>,
) -> Option<Joint> {
    let description = &all[i];
    let called = call(i, description);
    let start = parents::start(description, &called, base, context);
    let row = geometry::row(description, &called, convention, context);
    let row = start.zip(row).map(|(start, row)| row.behind(start));
    let kind = description.kind.as_ref().map(|k| k.value);
    let link = description.link.as_ref().and_then(|link| bodies::parts(link, &format!("the link of joint {called}"), context));
    let limits = limits(&description.limits, kind, &called, context);
    let motor = match &description.motor {
        Some(motor) => {
            let joint_axis = row.as_ref().map(|r| r.before.frame.direction(&r.axis));
            motors::motor((i, motor), joint_axis, parent, all, context).map(Some)
        }
        None => Some(None),
    };
    let what = |coefficient: &str| format!("the {coefficient} friction of joint {called}");
    let viscous = optional_not_negative(&description.friction.viscous, &what("viscous"), Code::NegativeFriction, context);
    let coulomb = optional_not_negative(&description.friction.coulomb, &what("Coulomb"), Code::NegativeFriction, context);
    let optional = |value: &Option<Expression>, context: &mut Context<'_>| match value {
        Some(value) => context.polynomial(value).map(Some),
        None => Some(None),
    };
    let offset = optional(&description.friction.offset, context);
    let cubic = optional(&description.friction.cubic, context);
    let load = match &description.friction.load {
        Some(load) => self::load(load, &called, context).map(Some),
        None => Some(None),
    };
    let smooth = match &description.friction.smooth {
        Some(smooth) => self::smooth(smooth, &description.friction, &called, context).map(Some),
        None => Some(None),
    };
    let stribeck = match &description.friction.stribeck {
        Some(stribeck) => self::stribeck(stribeck, &called, context).map(Some),
        None => Some(None),
    };
    let spring = match &description.spring {
        Some(spring) => self::spring(spring, kind, &called, context).map(Some),
        None => Some(None),
    };
    let armature =
        optional_not_negative(&description.armature, &format!("the armature of joint {called}"), Code::NegativeArmature, context);
    let row = row?;
    Some(Joint {
        name: description.name.as_ref()?.value.clone(),
        kind: kind?,
        parent,
        // In the link frame before, until all rows are known: `frames::lay` moves it into the joint frame of the parent.
        placement: row.before.frame.clone(),
        link_frame: row.after.frame.clone(),
        row,
        limits: limits?,
        link: link?,
        motor: motor?,
        viscous: viscous?,
        coulomb: coulomb?,
        smooth: smooth?,
        offset: offset?,
        cubic: cubic?,
        load: load?,
        stribeck: stribeck?,
        spring: spring?,
        armature: armature?,
    })
}

/// A number and no name of a parameter: the torque is a product with masses.
fn load(given: &Expression, called: &str, context: &mut Context<'_>) -> Option<Number> {
    let load = context.number(given)?;
    if load.sign() == Ordering::Less {
        let message = format!("the load friction of joint {called} is negative");
        let help =
            "give how many times the size of the joint's gravity torque its friction grows by, at least 0: friction takes energy";
        context.report(Code::NegativeFriction, given.span, message, format!("this is {}", text_of(&load)), help);
        return None;
    }
    Some(load)
}

fn smooth(given: &Expression, friction: &FrictionDescription, called: &str, context: &mut Context<'_>) -> Option<Number> {
    let velocity = context.number(given)?;
    if velocity.sign() != Ordering::Greater {
        let message = format!("the velocity of the smooth friction of joint {called} is not positive");
        let help =
            "give the rate at which 76 % of the Coulomb friction acts, above 0; leave `smooth` out for friction that jumps";
        context.report(Code::NonPositiveLimit, given.span, message, format!("this is {}", text_of(&velocity)), help);
        return None;
    }
    let jumps = [
        ("Stribeck friction", friction.stribeck.as_ref().map(|stribeck| stribeck.key)),
        ("friction that grows with its load", friction.load.as_ref().map(|load| load.span)),
    ];
    if friction.coulomb.is_none() {
        let message = format!("joint {called} has smooth friction without Coulomb friction");
        let help = "give the torque as `coulomb`, which acts as coulomb · tanh(dq/smooth), or leave `smooth` out";
        context.report(Code::SmoothFriction, given.span, message, "replaces sign(dq) of `coulomb`", help);
        return None;
    }
    for (name, span) in jumps {
        let Some(span) = span else { continue };
        let message = format!("joint {called} has smooth friction and {name}");
        context.report(Code::SmoothFriction, span, message, "jumps where the rate changes its sign", "leave one of the two out");
        return None;
    }
    Some(velocity)
}

fn stribeck(description: &StribeckDescription, called: &str, context: &mut Context<'_>) -> Option<Stribeck> {
    let what = format!("the Stribeck friction of joint {called}");
    let torque = bodies::not_negative(description.torque.as_ref()?, &what, Code::NegativeFriction, context);
    let given = description.velocity.as_ref()?;
    let velocity = context.number(given)?;
    if velocity.sign() != Ordering::Greater {
        let message = format!("the velocity of the Stribeck friction of joint {called} is not positive");
        let help = "give the rate at which 1/e of it is left, above 0; leave `stribeck` out if it does not fade: that is Coulomb friction";
        context.report(Code::NonPositiveLimit, given.span, message, format!("this is {}", text_of(&velocity)), help);
        return None;
    }
    Some(Stribeck { torque: torque?, velocity })
}

fn spring(description: &SpringDescription, kind: Option<JointKind>, called: &str, context: &mut Context<'_>) -> Option<Spring> {
    let what = format!("the stiffness of the spring of joint {called}");
    let stiffness = bodies::not_negative(description.stiffness.as_ref()?, &what, Code::NegativeStiffness, context);
    let rest = match &description.rest {
        Some(rest) => {
            let value = context.number(rest).filter(|_| kind == Some(JointKind::Revolute));
            if let Some(value) = value {
                geometry::doubt_limits(&[(rest, &value)], &format!("the rest of the spring of joint {called}"), context);
            }
            context.polynomial(rest)
        }
        None => Some(Polynomial::zero()),
    };
    Some(Spring { stiffness: stiffness?, rest: rest? })
}

fn limits(description: &LimitsDescription, kind: Option<JointKind>, called: &str, context: &mut Context<'_>) -> Option<Limits> {
    let position = match &description.position {
        Some(position) => {
            let bounds = context.numbers(&position.value);
            if let Some([lowest, highest]) = &bounds {
                if kind == Some(JointKind::Revolute) {
                    let limits: Vec<_> = position.value.iter().flatten().zip([lowest, highest]).collect();
                    geometry::doubt_limits(&limits, &format!("a limit of joint {called}"), context);
                }
                let order = (highest - lowest).sign();
                if order != Ordering::Greater {
                    let what = if order == Ordering::Less { "reversed" } else { "empty" };
                    let message = format!("the position limits of joint {called} are {what}");
                    let label = format!("from {} to {}", text_of(lowest), text_of(highest));
                    let help = "write [lowest, highest], the first below the second; leave a joint out that does not move";
                    context.report(Code::EmptyLimits, position.span, message, label, help);
                }
            }
            bounds.map(Some)
        }
        None => Some(None),
    };
    let velocity = positive(description.velocity.as_ref(), "velocity", called, context);
    let acceleration = positive(description.acceleration.as_ref(), "acceleration", called, context);
    let jerk = positive(description.jerk.as_ref(), "jerk", called, context);
    let effort = positive(description.effort.as_ref(), "effort", called, context);
    Some(Limits { position: position?, velocity: velocity?, acceleration: acceleration?, jerk: jerk?, effort: effort? })
}

/// A limit of a size; `Some(None)` without a limit.
fn positive(value: Option<&Expression>, what: &str, called: &str, context: &mut Context<'_>) -> Option<Option<Number>> {
    let Some(value) = value else { return Some(None) };
    let number = context.number(value)?;
    if number.sign() != Ordering::Greater {
        let message = format!("the {what} limit of joint {called} is not positive");
        let help = format!("give the largest size that is allowed, above 0; leave `{what}` out if there is no limit");
        context.report(Code::NonPositiveLimit, value.span, message, format!("this is {}", text_of(&number)), help);
        return None;
    }
    Some(Some(number))
}
