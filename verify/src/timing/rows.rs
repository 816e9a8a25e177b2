//! The limits of an arm as rows over a segment, by the checker's own dynamics in Taylor models.

use armgen_description::kinds::Feature;
use armgen_description::manipulator::{Joint, Manipulator};

use super::curve::Curve;
use super::file::{File, Kind, ROUNDING};
use super::taylor::{Constants, Range, Taylor};
use crate::textbook::equations::arm::Arm;
use crate::textbook::equations::lagrange::spring_torques;
use crate::textbook::equations::newton_euler::{ArmMotion, Motion};
use crate::textbook::equations::pose::Pose;
use crate::textbook::equations::state::State;
use crate::textbook::equations::vector::{add, cross, scale, sub};
use crate::values::element::Element;
use crate::values::float::Arguments;

/// A limit on a segment: m u + c x + v sqrt(x) + d <= 0, and a curve over dq² besides.
pub(super) struct Row {
    pub(super) m: Taylor,
    pub(super) c: Taylor,
    pub(super) v: Taylor,
    pub(super) d: Taylor,
    pub(super) curve: Option<Curve>,
}

/// The functions of a segment.
pub(super) struct Functions {
    pub(super) q: Vec<Taylor>,
    pub(super) rate: Vec<Taylor>,
    pub(super) curvature: Vec<Taylor>,
    /// m, c, g.
    pub(super) torques: [Vec<Taylor>; 3],
    /// Squares of the end effector's speed and turn rate for ds = 1, if one is limited.
    pub(super) tool: Option<[Taylor; 2]>,
    /// The share of the limits of speed.
    pub(super) share: Range,
    pub(super) h: Range,
}

/// A file, and the arm that it is about.
pub(super) struct Checker {
    pub(super) file: File,
    pub(super) arm: Arm<Taylor>,
    pub(super) ranges: Vec<Option<[f64; 2]>>,
}

impl Checker {
    pub(super) fn new(manipulator: &Manipulator, file: File) -> Result<Checker, String> {
        let names: Vec<&String> = manipulator.joints.iter().map(|joint| &joint.name).collect();
        let coupled = |joint: &Joint| joint.has(Feature::CoupledMotor);
        if manipulator.coupling.is_some() || manipulator.joints.iter().any(coupled) {
            return Err("coupled joints and motors are not treated".to_owned());
        }
        if names != file.joints.iter().collect::<Vec<_>>() {
            return Err("its joints are not those of the description".to_owned());
        }
        let parameters = Arm::nominal(&Constants, manipulator).ok_or("a parameter has no value")?;
        let arm = Arm::new(&Constants, manipulator, &parameters).ok_or("the arm has no numbers")?;
        if let Some(i) = manipulator.joints.iter().position(|joint| joint.smooth.is_some()) {
            return Err(format!("joint `{}` has smooth friction, which is not treated", file.joints[i]));
        }
        let range = |joint: &armgen_description::manipulator::Joint| {
            joint.limits.position.as_ref().map(|range| range.clone().map(|x| x.to_f64()))
        };
        let ranges = manipulator.joints.iter().map(range).collect();
        Ok(Checker { file, arm, ranges })
    }

    /// The functions of segment `i`, and its piece.
    pub(super) fn functions(&self, i: usize) -> Result<Functions, String> {
        let (from, to) = (self.file.s[i], self.file.s[i + 1]);
        let half = Range::of(0.5);
        let h = Range::of(to).minus(Range::of(from));
        let slack = ROUNDING * (1.0 + from.abs());
        let piece = self.file.knots.windows(2).position(|knots| knots[0] <= from + slack && to <= knots[1] + slack);
        let piece = piece.ok_or_else(|| format!("the segment from s = {from} to {to} crosses a knot"))?;
        // s - knot over t from -1 to 1.
        let middle = Range::of(from).plus(Range::of(to)).times(half).minus(Range::of(self.file.knots[piece]));
        let mut s = Taylor::constant(middle);
        s.terms[1] = h.times(half);
        let polynomial = |powers: &[f64], order: usize| {
            let mut sum = Taylor::constant(Range::ZERO);
            for (k, c) in powers.iter().enumerate().rev().filter(|(k, _)| *k >= order) {
                let factor = (k - order + 1..=k).fold(Range::of(1.0), |product, k| product.times(Range::of(k as f64)));
                sum = sum.times(&s).plus(&Taylor::constant(Range::of(*c).times(factor)));
            }
            sum
        };
        let joints = &self.file.coefficients[piece];
        let [q, rate, curvature] = [0, 1, 2].map(|order| joints.iter().map(|of| polynomial(of, order)).collect::<Vec<_>>());
        let (zero, one) = (&self.arm.zero, &self.arm.one);
        let angles =
            q.iter()
                .zip(&self.arm.joints)
                .map(|(q, joint)| if joint.revolute { q.sine_cosine() } else { Some((zero.clone(), one.clone())) });
        let angles = angles.collect::<Option<Vec<_>>>().ok_or_else(|| format!("the angles at s = {from} are too large"))?;
        let none = || vec![zero.clone(); q.len()];
        let arguments = Arguments {
            pi: Vec::new(),
            q: q.clone(),
            dq: none(),
            ddq: none(),
            dqr: none(),
            ddqr: none(),
            tau: none(),
            g0: Vec::new(),
        };
        let state = State::of(arguments, angles, none(), [zero.clone(), one.clone()]);
        let pose = Pose::new(&self.arm, &state);
        let torques = |rates: &[Taylor], accelerations: &[Taylor], gravity| {
            let motion = Motion { rates: rates.to_vec(), accelerations: accelerations.to_vec(), gravity };
            ArmMotion::new(&self.arm, &pose, motion).torques()
        };
        let inertial = torques(&none(), &rate, self.arm.nothing());
        let velocity = torques(&rate, &curvature, self.arm.nothing());
        let gravity = torques(&none(), &none(), self.arm.gravity.clone());
        let gravity = gravity.iter().zip(spring_torques(&self.arm, &q)).map(|(a, b)| a.plus(&b)).collect();
        let tool = if self.file.limits.tool == [None; 2] { None } else { Some(self.tool(&pose, &rate)?) };
        let share = Range::of(self.file.shares[piece]);
        Ok(Functions { q, rate, curvature, torques: [inertial, velocity, gravity], tool, share, h })
    }

    /// Squares of the speed of the end effector's origin and of its turn rate for ds = 1: each joint on the way to it turns it about its
    /// axis, or moves it along.
    fn tool(&self, pose: &Pose<Taylor>, rate: &[Taylor]) -> Result<[Taylor; 2], String> {
        let ([tip], [frame]) = (self.arm.tips.as_slice(), pose.tools.as_slice()) else {
            return Err("limits of the end effector need one".to_owned());
        };
        let (mut v, mut w) = (self.arm.nothing(), self.arm.nothing());
        for &joint in &pose.ancestors[tip.link] {
            let along = scale(&rate[joint], &pose.axes[joint]);
            if self.arm.joints[joint].revolute {
                v = add(&v, &cross(&along, &sub(&frame.origin, &pose.joints[joint].origin)));
                w = add(&w, &along);
            } else {
                v = add(&v, &along);
            }
        }
        Ok([v, w].map(|of| of.iter().fold(self.arm.zero.clone(), |sum, x| sum.plus(&x.times(x)))))
    }

    /// A limit on a segment; `None` without a limit.
    pub(super) fn row(&self, of: &Functions, joint: usize, kind: Kind) -> Option<Row> {
        let limits = &self.file.limits;
        let (zero, bound) = (Taylor::constant(Range::ZERO), |x: f64| Taylor::constant(Range::of(x)));
        let upper = |m: &Taylor, c: &Taylor, v: Taylor, d: Taylor, limit: f64| Row {
            m: m.clone(),
            c: c.clone(),
            v,
            d: d.minus(&bound(limit)),
            curve: None,
        };
        let lower = |m: &Taylor, c: &Taylor, v: Taylor, d: Taylor, limit: f64| Row {
            m: m.negated(),
            c: c.negated(),
            v: v.negated(),
            d: bound(limit).minus(&d),
            curve: None,
        };
        let (rate, curvature) = (&of.rate[joint], &of.curvature[joint]);
        let speed = |c: Taylor, limit: f64| {
            let limit = Range::of(limit).times(of.share);
            let d = Taylor::constant(limit.times(limit).negated());
            Row { m: zero.clone(), c, v: zero.clone(), d, curve: None }
        };
        Some(match kind {
            Kind::Speed => speed(rate.times(rate), limits.velocity[joint]?),
            Kind::ToolSpeed => speed(of.tool.as_ref()?[0].clone(), limits.tool[0]?),
            Kind::ToolTurnRate => speed(of.tool.as_ref()?[1].clone(), limits.tool[1]?),
            Kind::AccelerationHigh => upper(rate, curvature, zero.clone(), zero, limits.acceleration[joint]?),
            Kind::AccelerationLow => lower(rate, curvature, zero.clone(), zero, -limits.acceleration[joint]?),
            Kind::TorqueHigh | Kind::TorqueLow => {
                let [low, high] = limits.effort[joint];
                let [m, c, g] = [0, 1, 2].map(|part| &of.torques[part][joint]);
                let arm = &self.arm.joints[joint];
                let motor = arm.motor.as_ref().map(|motor| motor.rates[0].1.times(&motor.rates[0].1).times(&motor.viscous));
                let viscous = motor.map_or_else(|| arm.viscous.clone(), |motor| motor.plus(&arm.viscous));
                let dry = arm.coulomb.plus(&arm.load.times(&g.magnitude()));
                let mut d = g.plus(&dry.directed(rate)).plus(&arm.offset);
                let v = viscous.times(rate);
                let [cubic, stribeck, velocity] = [&arm.cubic, &arm.stribeck, &arm.stribeck_velocity].map(|of| of.terms[0]);
                let mut curve = None;
                if [cubic, stribeck] != [Range::ZERO; 2] {
                    match rate.direction() {
                        Some(sign) => curve = Some(Curve { cubic, stribeck, velocity }.times(sign)),
                        // Nothing is proved of a joint that turns round within a segment.
                        None => d.rest = Range::ALL,
                    }
                }
                if kind == Kind::TorqueHigh {
                    Row { curve, ..upper(m, c, v, d, high?) }
                } else {
                    Row { curve: curve.map(|curve| curve.negated()), ..lower(m, c, v, d, low?) }
                }
            }
        })
    }
}
