//! A planned path: position, angle, speed, acceleration, and distances to its points.

use std::time::Duration;

use armgen_runtime::nalgebra::{Matrix3, Vector6};
use armgen_runtime::orientation::turn_about;

use crate::model::{Body, Motion, Quantity, Record, Robot, Sampling};

/// An unwrapped angle.
struct Unwrapped {
    frame: Matrix3<f64>,
    last: f64,
}

impl Unwrapped {
    /// Measures angles relative to this frame.
    fn new(frame: Matrix3<f64>) -> Unwrapped {
        Unwrapped { frame, last: 0.0 }
    }

    /// The rotation about z0 of this orientation, chosen nearest to the previous angle.
    fn of(&mut self, rotation: &Matrix3<f64>) -> f64 {
        let angle = turn_about(&(rotation * self.frame.transpose()), 2);
        let turns = ((self.last - angle) / std::f64::consts::TAU).round();
        self.last = angle + turns * std::f64::consts::TAU;
        self.last
    }
}

/// Samples the path.
pub(super) fn run(sampling: &Sampling, body: &Body, robot: &Robot) -> Record {
    let Sampling { motion: Motion { trajectory, frame, .. }, period, duration } = sampling;
    let mut record = Record::new(body.channels(robot));
    let mut angle = Unwrapped::new(*frame);
    let mut earlier = trajectory.sample(Duration::ZERO);
    let mut t = Duration::ZERO;
    while t <= *duration {
        let s = trajectory.sample(t);
        let p = s.pose.position;
        let linear = |v: &Vector6<f64>| v.fixed_rows::<3>(0).norm();
        let turned = angle.of(&s.pose.rotation);
        record.sample(|quantity| match quantity {
            Quantity::Time => t.as_secs_f64(),
            Quantity::Tip(axis) => p[axis],
            Quantity::Angle => turned,
            Quantity::Speed => linear(&s.velocity),
            Quantity::Acceleration => linear(&s.acceleration),
            Quantity::TurnRate => s.velocity[5],
            Quantity::TurnAcceleration => s.acceleration[5],
            Quantity::Distance => p.x.hypot(p.y),
            Quantity::VelocityStep => (s.velocity - earlier.velocity).fixed_rows::<3>(0).amax(),
            _ => f64::NAN,
        });
        earlier = s;
        t += *period;
    }
    let segments = trajectory.path.segments();
    let miss = |i: usize, t: Duration| (trajectory.sample(t).pose.position - segments[i].to()).norm();
    let vias = sampling.motion.vias();
    let stops = || (0..segments.len()).filter(|i| !vias.contains(i)).map(|i| miss(i, segments[i].end())).fold(0.0, f64::max);
    // The least distance while this segment and the next are active; only within the run.
    let nearest = |i: usize| {
        if segments[i].end() > *duration {
            return f64::NAN;
        }
        let (mut t, mut nearest) = (segments[i + 1].start(), f64::INFINITY);
        while t <= segments[i].end() {
            nearest = nearest.min(miss(i, t));
            t += *period;
        }
        nearest
    };
    let value = |quantity: Quantity| match quantity {
        Quantity::Stops => stops(),
        Quantity::EndsAt => trajectory.duration().as_secs_f64(),
        Quantity::Via(i) => nearest(i),
        _ => f64::NAN,
    };
    record.numbers = body.numbers(robot).into_iter().map(|channel| (channel.clone(), value(channel.quantity))).collect();
    record
}
