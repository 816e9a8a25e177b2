//! Coupled joints: their variables as exact sums over coordinates, q = S p + c.
//!
//! ```text
//! follows: {leader: k}    q_i = Σ k q_leader + offset          the joint has no coordinate of its own
//! adds: {leader: k}       q_i = p_i + Σ k q_leader + offset
//! ```
//!
//! Absent from here on: names of leaders, rings of joints that follow each other, factors of 0.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::number::{is_small, text_of};
use super::{call, geometry, Context};
use crate::description::{JointDescription, LeadersDescription, LimitsDescription};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::excerpt;
use crate::exact::{Angle, Number};
use crate::kinds::JointKind;
use crate::manipulator::{Coupling, JointVariable, Limits};
use crate::source::Span;
use crate::suggest::did_you_mean;
use armgen_algebra::ring::field::computed::ComputedAngles;

/// An offset beyond this many radians is a mistake.
const LARGEST_ANGLE: i64 = 1_000_000;

/// A leader: the place of its joint in the list, its factor, and where that is written.
pub(super) struct Leader {
    pub(super) joint: usize,
    pub(super) factor: Number,
    pub(super) span: Span,
}

/// The coupling of joints, `Some(None)` where no joint is coupled. Faults are reported.
pub(super) fn resolve(joints: &[JointDescription], context: &mut Context<'_>) -> Option<Option<Coupling>> {
    let all: Vec<Option<Vec<Leader>>> = joints.iter().enumerate().map(|(i, joint)| leaders(i, joint, joints, context)).collect();
    let offsets: Vec<Option<Number>> = joints.iter().enumerate().map(|(i, joint)| offset(i, joint, context)).collect();
    if joints.iter().all(|joint| joint.follows.is_none() && joint.adds.is_none()) {
        return offsets.into_iter().collect::<Option<Vec<_>>>().map(|_| None);
    }
    let all: Vec<Vec<Leader>> = all.into_iter().collect::<Option<_>>()?;
    let offsets: Vec<Number> = offsets.into_iter().collect::<Option<_>>()?;
    let order = leaders_first(joints, &all, context.diagnostics)?;
    let coordinates: Vec<usize> = (0..joints.len()).filter(|&i| joints[i].follows.is_none()).collect();
    let mut variables: Vec<Option<JointVariable>> = vec![None; joints.len()];
    let mut valid = true;
    for i in order {
        let (variable, is_valid) = variable(i, joints, (&all[i], &offsets[i]), (&coordinates, &variables), context);
        valid &= is_valid;
        variables[i] = Some(variable);
    }
    let variables: Vec<JointVariable> = variables.into_iter().collect::<Option<_>>()?;
    for (i, (joint, variable)) in joints.iter().zip(&variables).enumerate() {
        valid &= friction(i, joint, &variables, variable, &coordinates, context);
    }
    let limits = (0..coordinates.len()).map(|a| limits(a, joints, &variables, context)).collect::<Option<Vec<Limits>>>()?;
    for (i, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.follows.is_some()) {
        if let Some(effort) = &joint.limits.effort {
            let message = format!("the effort limit of joint {} limits no coordinate", call(i, joint));
            let help = "the joint follows others, whose drives have limits of their own: leave `effort` out";
            context.report(Code::FollowerEffort, effort.span, message, "not used", help);
        }
    }
    let coupling = Coupling { coordinates, limits, variables, sums: Vec::new() };
    unrelated(joints, &all, &coupling, context);
    valid.then_some(Some(coupling))
}

/// Warns of factors of so many digits that dependences between angles are not looked for.
fn unrelated(joints: &[JointDescription], all: &[Vec<Leader>], coupling: &Coupling, context: &mut Context<'_>) {
    let angles = coupling.computed();
    for angle in ComputedAngles::unrelated(&angles) {
        let own = |variable: &JointVariable| variable.computed().is_some_and(|(own, _)| own == angles[angle]);
        let Some(i) = coupling.variables.iter().position(own) else { continue };
        let place = all[i].first().map_or(joints[i].span, |leader| leader.span);
        let message = format!("the angle of joint {} is taken as unrelated to that of a leader", call(i, &joints[i]));
        let help = "the equations are right, and base parameters may be more than a motion can tell; a factor of fewer digits is related";
        context.report(Code::UnrelatedFactor, place, message, "its fraction has a denominator beyond 2^40", help);
    }
}

/// The leaders of a joint; `None` after a fault.
fn leaders(i: usize, joint: &JointDescription, joints: &[JointDescription], context: &mut Context<'_>) -> Option<Vec<Leader>> {
    if let (Some(follows), Some(adds)) = (&joint.follows, &joint.adds) {
        let message = format!("joint {} has `follows` and `adds`", call(i, joint));
        let help = "keep `follows` if the joint has no drive of its own, `adds` if it has: both sums in one";
        let fault = Diagnostic::new(Code::FollowsAndAdds, adds.key, message, "the second one", help);
        context.diagnostics.push(fault.also(follows.key, "the first one"));
        return None;
    }
    match (&joint.follows, &joint.adds) {
        (Some(follows), _) => named("follows", follows, joints, context),
        (None, Some(adds)) => named("adds", adds, joints, context),
        (None, None) => Some(Vec::new()),
    }
}

/// The joints that `key` names with factors; `None` after a fault.
pub(super) fn named(
    key: &str,
    description: &LeadersDescription,
    joints: &[JointDescription],
    context: &mut Context<'_>,
) -> Option<Vec<Leader>> {
    let mut found = Some(Vec::new());
    for (name, factor) in &description.leaders {
        let place = joints.iter().position(|other| other.name.as_ref().is_some_and(|own| own.value == name.value));
        if place.is_none() {
            let names: Vec<&str> =
                joints.iter().filter_map(|joint| joint.name.as_ref()).map(|name| name.value.as_str()).collect();
            let message = format!("`{key}` names `{}`, which is no joint", excerpt(&name.value));
            let help = match did_you_mean(&name.value, &names) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => "name a joint of this file, anywhere in the list".into(),
            };
            context.report(Code::UnknownLeader, name.span, message, "unknown joint", help);
        }
        let factor = factor.as_ref().and_then(|factor| Some((factor.span, context.number(factor)?)));
        let factor = factor.filter(|(span, factor)| {
            if factor.sign() == Ordering::Equal {
                let message = format!("the factor of `{}` is 0", excerpt(&name.value));
                let help = "leave out a joint that does not matter; write the ratio of the two variables otherwise";
                context.report(Code::ZeroFactor, *span, message, "this is 0", help);
            }
            factor.sign() != Ordering::Equal
        });
        found = found.zip(place.zip(factor)).map(|(mut all, (joint, (span, factor)))| {
            all.push(Leader { joint, factor, span });
            all
        });
    }
    found
}

/// The constant part of a joint's variable that its own row gives; `None` after a fault.
fn offset(i: usize, joint: &JointDescription, context: &mut Context<'_>) -> Option<Number> {
    let Some(given) = &joint.offset else { return Some(Number::zero()) };
    if joint.follows.is_none() && joint.adds.is_none() {
        let message = format!("joint {} has `offset`, and neither `follows` nor `adds`", call(i, joint));
        let help = "the zero of a joint of its own is part of its row: `theta` of a revolute joint, `d` of a prismatic one, `origin` of a frame";
        context.report(Code::OffsetWithoutLeader, given.span, message, "added to which variable?", help);
        return None;
    }
    if joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Revolute) {
        geometry::sine_cosine(&joint.offset, &format!("the offset of joint {}", call(i, joint)), context)?;
    }
    context.number(given)
}

/// The joints, each behind those that it follows; rings are reported.
fn leaders_first(joints: &[JointDescription], all: &[Vec<Leader>], diagnostics: &mut Diagnostics) -> Option<Vec<usize>> {
    let mut order = Vec::new();
    let mut done = vec![false; joints.len()];
    // Each round takes the joints whose leaders are all there.
    while let Some(next) = (0..joints.len()).find(|&i| !done[i] && all[i].iter().all(|leader| done[leader.joint])) {
        done[next] = true;
        order.push(next);
    }
    let Some(start) = done.iter().position(|done| !done) else { return Some(order) };
    // Every joint that is left has a leader that is left: the way along these ends in a ring.
    let leader = |i: usize| all[i].iter().find(|leader| !done[leader.joint]).expect("a joint that is left has such a leader");
    let mut way = vec![start];
    let ring = loop {
        let next = leader(*way.last().expect("not empty")).joint;
        if let Some(first) = way.iter().position(|&i| i == next) {
            break way.split_off(first);
        }
        way.push(next);
    };
    let names: Vec<String> = ring.iter().chain(ring.first()).map(|&i| call(i, &joints[i])).collect();
    let message = format!("joints follow each other in a ring: {}", names.join(" follows "));
    let help = format!("give {} a coordinate: leave `follows` or `adds` out there", names[0]);
    let place = leader(ring[0]).span;
    diagnostics.push(Diagnostic::new(Code::RingOfFollowers, place, message, "part of the ring", help));
    None
}

/// The variable of a joint whose leaders' variables are known, and whether it is valid.
fn variable(
    i: usize,
    joints: &[JointDescription],
    (leaders, offset): (&[Leader], &Number),
    (coordinates, known): (&[usize], &[Option<JointVariable>]),
    context: &mut Context<'_>,
) -> (JointVariable, bool) {
    let mut sums: BTreeMap<usize, Number> = BTreeMap::new();
    if let Some(own) = coordinates.iter().position(|&joint| joint == i) {
        sums.insert(own, Number::one());
    }
    let mut constant = offset.clone();
    let mut valid = true;
    let is_valid = |value: &Number| is_small(value) && value.to_f64().is_finite();
    for leader in leaders {
        let of_leader = known[leader.joint].as_ref().expect("leaders come first");
        let products = of_leader.factors.iter().map(|(a, k)| (*a, leader.factor.times(k)));
        for (a, product) in products {
            let sum = sums.entry(a).or_insert_with(Number::zero);
            *sum = sum.plus(&product);
        }
        constant = constant.plus(&leader.factor.times(&of_leader.offset));
        if valid && !(sums.values().all(is_valid) && is_valid(&constant)) {
            let message =
                format!("the factors that joint {} follows others by are too long or too large together", call(i, &joints[i]));
            let help = "write factors with fewer digits, or let the joint follow the first leader of the line";
            context.report(Code::TooComplex, leader.span, message, "multiplied with those before it", help);
            valid = false;
        }
    }
    if !valid {
        // Reported once; what follows this joint goes on with little numbers.
        (sums, constant) = (BTreeMap::new(), Number::zero());
    }
    sums.retain(|_, factor| factor.sign() != Ordering::Equal);
    let turns = |joint: usize| joints[joint].kind.as_ref().is_some_and(|kind| kind.value == JointKind::Revolute);
    if turns(i) {
        if (&size(&constant) - &Number::from(LARGEST_ANGLE)).sign() == Ordering::Greater {
            let place = joints[i].offset.as_ref().map_or(joints[i].span, |offset| offset.span);
            let message = format!("the variable of joint {} begins at {} rad", call(i, &joints[i]), text_of(&constant));
            context.report(Code::OutOfRange, place, message, "too large", "angles are in radians, at most 1e6");
            valid = false;
        } else {
            let angle = Angle::new(constant.clone());
            let turn = [angle.sin(), angle.cos()];
            return (JointVariable::of_angle(sums, constant, turn, |a| turns(coordinates[a])), valid);
        }
    }
    (JointVariable { factors: sums.into_iter().collect(), offset: constant, turn: None, is_whole: false }, valid)
}

fn size(number: &Number) -> Number {
    if number.sign() == Ordering::Less {
        -number
    } else {
        number.clone()
    }
}

/// Reports friction that the coupling does not determine, or that needs the sign of a rate that is no coordinate's; false where it reports any.
fn friction(
    i: usize,
    joint: &JointDescription,
    all: &[JointVariable],
    variable: &JointVariable,
    coordinates: &[usize],
    context: &mut Context<'_>,
) -> bool {
    let mut valid = true;
    let own = coordinates.iter().position(|&of| of == i);
    let is_free = |variable: &JointVariable, a: usize| variable.factors.iter().any(|(of, _)| *of == a);
    let is_coupled =
        own.is_none_or(|a| all.iter().filter(|variable| is_free(variable, a)).count() > 1) || variable.factors.len() > 1;
    if let Some(load) = joint.friction.load.as_ref().filter(|_| is_coupled) {
        let message = format!("joint {} is coupled and has friction that grows with its load", call(i, joint));
        let help = "gravity alone does not determine the force in a coupling: write the friction as `coulomb`";
        context.report(Code::CoupledLoad, load.span, message, "load of a coupled joint", help);
        valid = false;
    }
    let help = "write it at a joint that has a coordinate and neither `follows` nor `adds`";
    if let Some(coulomb) = joint.friction.coulomb.as_ref().filter(|_| variable.factors.len() > 1) {
        let message = format!("joint {} moves with several coordinates and has Coulomb friction", call(i, joint));
        context.report(Code::CoupledFriction, coulomb.span, message, "needs the sign of a sum of rates", help);
        valid = false;
    }
    if let Some(smooth) = joint.friction.smooth.as_ref().filter(|_| is_coupled) {
        let message = format!("joint {} is coupled and has smooth friction", call(i, joint));
        context.report(Code::CoupledFriction, smooth.span, message, "of a coupled joint", "leave `smooth` out, or the coupling");
        valid = false;
    }
    let is_plain = own.is_some() && variable.factors.len() == 1;
    if let Some(stribeck) = joint.friction.stribeck.as_ref().filter(|_| !is_plain) {
        let message = format!("joint {} follows others and has Stribeck friction", call(i, joint));
        context.report(Code::CoupledFriction, stribeck.key, message, "of a rate that is no coordinate's", help);
        valid = false;
    }
    valid
}

/// The limits of a coordinate: its own, and those that joints which follow it alone put on it.
fn limits(a: usize, joints: &[JointDescription], variables: &[JointVariable], context: &mut Context<'_>) -> Option<Limits> {
    let mut limits = Limits::default();
    let mut places: [Option<Span>; 2] = [None; 2];
    let follows = |variable: &JointVariable| match variable.factors.as_slice() {
        [(of, factor)] if *of == a => Some(factor.clone()),
        _ => None,
    };
    for (i, (joint, variable)) in joints.iter().zip(variables).enumerate() {
        let LimitsDescription { position, velocity, acceleration, jerk, effort } = &joint.limits;
        if let Some(effort) = effort.as_ref().filter(|_| owns(a, i, joints)) {
            limits.effort = Some(context.number(effort)?);
        }
        let Some(factor) = follows(variable) else { continue };
        let inverse = factor.inverse()?;
        for (given, limit) in
            [(velocity, &mut limits.velocity), (acceleration, &mut limits.acceleration), (jerk, &mut limits.jerk)]
        {
            let Some(given) = given else { continue };
            let own = size(&context.number(given)?.times(&inverse));
            if limit.as_ref().is_none_or(|known| (known - &own).sign() == Ordering::Greater) {
                *limit = Some(own);
            }
        }
        let Some(position) = position else { continue };
        let ends = context.numbers(&position.value)?.map(|end| end.minus(&variable.offset).times(&inverse));
        let ends = if factor.sign() == Ordering::Less { [ends[1].clone(), ends[0].clone()] } else { ends };
        let known = limits.position.take();
        let mut meet = known.clone().unwrap_or_else(|| ends.clone());
        for (end, tighter) in [(0, Ordering::Less), (1, Ordering::Greater)] {
            if known.is_none() || (&meet[end] - &ends[end]).sign() == tighter {
                meet[end].clone_from(&ends[end]);
                places[end] = Some(position.span);
            }
        }
        if (&meet[1] - &meet[0]).sign() != Ordering::Greater && known.is_some() {
            let message = format!("the position limits of joint {} and of joints coupled with it do not meet", call(i, joint));
            let help = "limits of a joint that follows another one limit that one, too: widen one of the two";
            let other = places.into_iter().flatten().find(|place| *place != position.span).unwrap_or(position.span);
            let label = format!("the coordinate from {} to {}", text_of(&ends[0]), text_of(&ends[1]));
            let fault = Diagnostic::new(Code::EmptyLimits, position.span, message, label, help);
            context.diagnostics.push(fault.also(other, "limits it elsewhere"));
            return None;
        }
        limits.position = Some(meet);
    }
    Some(limits)
}

/// Whether a coordinate is that of a joint.
fn owns(a: usize, i: usize, joints: &[JointDescription]) -> bool {
    joints[i].follows.is_none() && joints[..i].iter().filter(|joint| joint.follows.is_none()).count() == a
}
