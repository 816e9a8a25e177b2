//! How far the end effector comes from the origin of the base frame.
//!
//! With all other joints held, the square of that distance is a - b cos(q_i - q*) in the variable of a joint that turns, largest where the end
//! effector and the origin lie on opposite sides of its axis, and a parabola in that of a slide. So the best value of one joint is known, also
//! between limits. Joint after joint climbs to a maximum; the largest of several starts is taken.

use std::f64::consts::{PI, TAU};

use armgen_codegen::exact::Number;
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Joint, Manipulator};
use nalgebra::{Point3, Vector3};

use super::bodies::short;
use super::posture::{Axis, Frames};

/// Starts, and rounds over all joints from each.
const STARTS: u32 = 12;
const ROUNDS: usize = 30;

/// The reach within the limits.
pub(super) fn in_words(manipulator: &Manipulator) -> String {
    if manipulator.coupling.is_some() {
        return "of an arm with coupled joints it is not looked for".into();
    }
    let endless = |joint: &&Joint| joint.kind == JointKind::Prismatic && joint.limits.position.is_none();
    if let Some(slide) = manipulator.joints.iter().find(endless) {
        return format!("without bound: `{}` slides and has no limits", slide.name);
    }
    let limited = manipulator.joints.iter().any(|joint| joint.limits.position.is_some());
    let within = if limited { ", within the limits" } else { "" };
    let (of, reach) = match manipulator.tips.len() {
        0 | 1 => ("", farthest(manipulator)),
        count => ("farthest ", (0..count).map(|tip| farthest(&manipulator.arm_to(tip))).fold(0.0, f64::max)),
    };
    format!("{} m from the origin of the base frame to the {of}end effector{within}", short(reach))
}

/// m.
fn farthest(manipulator: &Manipulator) -> f64 {
    let frames = Frames::of(manipulator);
    let limits: Vec<Option<[f64; 2]>> = manipulator
        .joints
        .iter()
        .map(|joint| joint.limits.position.as_ref().map(|ends| ends.each_ref().map(Number::to_f64)))
        .collect();
    let climbed = |k: u32| {
        let mut q = start(&limits, k);
        for i in (0..ROUNDS).flat_map(|_| 0..limits.len()) {
            let posture = frames.at(&q);
            let tip = Point3::from(posture.flange());
            q[i] = match manipulator.joints[i].kind {
                JointKind::Revolute => turned(q[i], &posture.axes[i], &tip, limits[i]),
                JointKind::Prismatic => slid(q[i], &posture.axes[i].direction, &tip, limits[i]),
            };
        }
        frames.at(&q).flange().norm()
    };
    (0..STARTS).map(climbed).fold(0.0, f64::max)
}

/// Joint variables within the limits: the middle, then multiples of the golden ratio, which spread evenly.
fn start(limits: &[Option<[f64; 2]>], k: u32) -> Vec<f64> {
    let golden = 0.618_033_988_749_895;
    let part = |i: usize| (0.5 + golden * f64::from(k) * (i + 1) as f64).fract();
    let between = |(i, ends): (usize, &Option<[f64; 2]>)| {
        let [low, high] = ends.unwrap_or([-PI, PI]);
        low + part(i) * (high - low)
    };
    limits.iter().enumerate().map(between).collect()
}

/// The variable of a joint that turns at which the tip is farthest from the origin.
fn turned(q: f64, axis: &Axis, tip: &Point3<f64>, limits: Option<[f64; 2]>) -> f64 {
    let across = |point: &Point3<f64>| {
        let from = point - axis.point;
        from - axis.direction.scale(from.dot(&axis.direction))
    };
    let (from, to) = (across(tip), -across(&Point3::origin()));
    let best = q + axis.direction.dot(&from.cross(&to)).atan2(from.dot(&to));
    let Some([low, high]) = limits else { return best };
    let first = best + ((low - best) / TAU).ceil() * TAU;
    match first <= high {
        true => first,
        false if (low - best).cos() > (high - best).cos() => low,
        false => high,
    }
}

/// The variable of a slide at which the tip is farthest from the origin.
fn slid(q: f64, direction: &Vector3<f64>, tip: &Point3<f64>, limits: Option<[f64; 2]>) -> f64 {
    let nearest = q - direction.dot(&tip.coords);
    limits.map_or(q, |[low, high]| if nearest - low > high - nearest { low } else { high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use armgen_codegen::source::Source;

    fn arm(joints: &str) -> Manipulator {
        let text = format!("name: a\nconvention: standard\ngravity: [0, 0, -10]\njoints:\n{joints}");
        armgen_codegen::validate::read(&Source::new("a.yaml", text)).0.expect("it is valid").0
    }

    const LINK: &str = "link: {mass: 1, inertia: {xx: 1, yy: 1, zz: 1}}";

    /// Two links in a plane, 0.5 m and 0.3 m: 0.8 m, and by the law of cosines where the elbow is between 60 and 90 degrees.
    #[test]
    fn a_stretched_arm_reaches_the_sum_of_its_links() {
        let two = |limits: &str| {
            arm(&format!(
                "  - {{name: s, type: revolute, a: 0.5, alpha: 0, d: 0, theta: 0, {LINK}}}\n  \
                 - {{name: e, type: revolute, a: 0.3, alpha: 0, d: 0, theta: 0, {LINK}{limits}}}\n"
            ))
        };
        assert!((farthest(&two("")) - 0.8).abs() < 1e-9);
        let folded = farthest(&two(", limits: {position: [deg(60), deg(90)]}"));
        assert!((folded - (0.25f64 + 0.09 + 0.5 * 0.3).sqrt()).abs() < 1e-9, "{folded}");
        assert_eq!(in_words(&two("")), "0.8 m from the origin of the base frame to the end effector");
    }

    #[test]
    fn a_slide_reaches_the_farther_end() {
        let slide = |limits: &str| {
            arm(&format!("  - {{name: s, type: prismatic, a: 0.3, alpha: 0, d: 0.1, theta: 0, {LINK}{limits}}}\n"))
        };
        assert!((farthest(&slide(", limits: {position: [-0.5, 0.2]}")) - 0.5).abs() < 1e-9);
        assert_eq!(in_words(&slide("")), "without bound: `s` slides and has no limits");
    }
}
