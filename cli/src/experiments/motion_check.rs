//! A path as planned: position, angle, speed, acceleration, and how its points are met.

use std::time::Duration;

use armgen_runtime::nalgebra::Matrix3;
use armgen_runtime::orientation::turn_about;
use armgen_runtime::simulation::Log;

use super::file::Sampling;
use super::motion::Motion;
use super::record::Record;

/// Columns of the log: `angle` is the turn about z0 from the frame of the path, without jumps.
pub(crate) fn columns() -> Vec<String> {
    ["t", "x", "y", "z", "angle", "speed", "acceleration", "turn_rate", "turn_acceleration", "distance", "velocity_step"]
        .map(String::from)
        .to_vec()
}

/// The numbers of the whole path: `stops` is the largest miss of a stop, `via_K` the least distance to the end of segment K.
pub(crate) fn singles(sampling: &Sampling) -> Vec<String> {
    let segments = sampling.motion.trajectory.path.segments();
    let via = |i: usize| segments.get(i + 1).is_some_and(|next| next.start() < segments[i].end());
    let mut names = vec!["stops".to_owned(), "ends_at".to_owned()];
    names.extend((0..segments.len()).filter(|i| via(*i)).map(|i| format!("via_{}", i + 1)));
    names
}

/// An angle that follows the one before it without jumps.
pub(crate) struct Unwrapped {
    frame: Matrix3<f64>,
    last: f64,
}

impl Unwrapped {
    /// From the frame from which it counts.
    pub(crate) fn new(frame: Matrix3<f64>) -> Unwrapped {
        Unwrapped { frame, last: 0.0 }
    }

    /// The turn about z0 of this orientation, next to the last one asked for.
    pub(crate) fn of(&mut self, rotation: &Matrix3<f64>) -> f64 {
        let angle = turn_about(&(rotation * self.frame.transpose()), 2);
        let turns = ((self.last - angle) / std::f64::consts::TAU).round();
        self.last = angle + turns * std::f64::consts::TAU;
        self.last
    }
}

/// Samples the path.
pub(crate) fn run(sampling: &Sampling) -> Record {
    let Sampling { motion: Motion { trajectory, frame, .. }, period, duration } = sampling;
    let mut log = Log::new(columns());
    let mut angle = Unwrapped::new(*frame);
    let mut earlier = trajectory.sample(Duration::ZERO);
    let mut t = Duration::ZERO;
    while t <= *duration {
        let s = trajectory.sample(t);
        let p = s.pose.position;
        let linear = |v: &armgen_runtime::nalgebra::Vector6<f64>| v.fixed_rows::<3>(0).norm();
        let angular = |v: &armgen_runtime::nalgebra::Vector6<f64>| v[5];
        let step = (s.velocity - earlier.velocity).fixed_rows::<3>(0).amax();
        log.push([
            t.as_secs_f64(),
            p.x,
            p.y,
            p.z,
            angle.of(&s.pose.rotation),
            linear(&s.velocity),
            linear(&s.acceleration),
            angular(&s.velocity),
            angular(&s.acceleration),
            p.x.hypot(p.y),
            step,
        ]);
        earlier = s;
        t += *period;
    }
    let segments = trajectory.path.segments();
    let (mut stops, mut via) = (0.0f64, Vec::new());
    for (i, segment) in segments.iter().enumerate() {
        let miss = |t: Duration| (trajectory.sample(t).pose.position - segment.to()).norm();
        match segments.get(i + 1).filter(|next| next.start() < segment.end()) {
            Some(next) => {
                let (mut t, mut nearest) = (next.start(), f64::INFINITY);
                while t <= segment.end() {
                    nearest = nearest.min(miss(t));
                    t += *period;
                }
                via.push(nearest);
            }
            None => stops = stops.max(miss(segment.end())),
        }
    }
    let values = [stops, trajectory.duration().as_secs_f64()].into_iter().chain(via);
    Record { log, singles: singles(sampling).into_iter().zip(values).collect(), ..Record::default() }
}
