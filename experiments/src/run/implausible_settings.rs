//! What can be seen of an experiment before anything moves: a start outside the limits, a path beyond reach, a start off the path.
//!
//! Reach is bounded by the chain of frame origins stretched out, from the origin of the base on: |p_e| <= |p_1| + sum |p_{i+1} - p_i|.
//! These lengths do not change where joints turn, and change by the stroke where they slide. A path farther from the origin of the base is
//! out of reach for certain; one that is nearer may be so still.

use std::time::Duration;

use armgen_runtime::nalgebra::{SVector, Vector3};
use armgen_runtime::reference::Pose;
use armgen_runtime::task::Task;

use super::instance::Functions;
use super::Instance;
use crate::model::{number, Body, Experiment, Sampling};

/// A start off its path, m and rad, that closed-loop inverse kinematics is to bring onto it: beyond, the two hardly belong together.
const OFF: (f64, f64) = (0.05, 0.2);
/// An angle of a start, rad, beyond which it is in degrees rather than whole turns away.
const DEGREES: f64 = 10.0;
/// How often the path is looked at.
const STEP: Duration = Duration::from_millis(10);

impl<R: Functions<N, P>, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    /// What is to be said of an experiment.
    pub(super) fn implausible_settings(&self, experiment: &Experiment) -> Vec<String> {
        let (sampling, start) = match &experiment.body {
            Body::Clik(run) => (&run.sampling, &run.start),
            Body::Branch(run) => (&run.sampling, &run.start),
            Body::Control(run) => (&run.sampling, &run.start),
            Body::Postures(_) | Body::Path(_) => return Vec::new(),
        };
        let q = match self.start(start, sampling) {
            Ok(q) => q,
            // The run itself says so.
            Err(_) => return Vec::new(),
        };
        let mut said = self.outside(&q);
        said.extend(self.beyond_reach(&q, sampling).or_else(|| self.off_the_path(&q, sampling)));
        said
    }

    /// Joints whose start is outside their limits.
    fn outside(&self, q: &SVector<f64, N>) -> Vec<String> {
        let joints = self.robot.joints.iter().zip(q.iter());
        let said = joints.filter_map(|(joint, &start)| {
            let [low, high] = joint.position;
            let (name, unit) = (&joint.name, joint.unit());
            let within = |x: f64| x >= low && x <= high;
            if within(start) {
                // Without limits, or with wide ones, degrees show by their size.
                let turns = joint.revolute && start.abs() > std::f64::consts::TAU && low.is_infinite() && high.is_infinite();
                return turns.then(|| {
                    format!(
                        "joint `{name}` starts whole turns away, at {}: in degrees? write `deg({})`",
                        rounded(start),
                        number(start)
                    )
                });
            }
            let remedy = if joint.revolute && start.abs() > DEGREES && within(start.to_radians()) {
                format!("in degrees? write `deg({})`, which is {}", number(start), rounded(start.to_radians()))
            } else {
                let turned = start - std::f64::consts::TAU * (start / std::f64::consts::TAU).round();
                match joint.revolute && within(turned) {
                    true => format!("whole turns away is {}", rounded(turned)),
                    false => "another start, or other limits".to_owned(),
                }
            };
            Some(format!(
                "joint `{name}` starts at {} {unit}, outside its limits, {} to {} {unit}: {remedy}",
                rounded(start),
                rounded(low),
                rounded(high)
            ))
        });
        said.collect()
    }

    /// Where the path is farther away than the arm is long.
    fn beyond_reach(&self, q: &SVector<f64, N>, sampling: &Sampling) -> Option<String> {
        let origin = |frame: &armgen_runtime::nalgebra::Matrix4<f64>| Vector3::new(frame[(0, 3)], frame[(1, 3)], frame[(2, 3)]);
        let mut chain = vec![Vector3::zeros()];
        chain.extend(self.nominal.link_frames(q).iter().map(origin));
        chain.push(Pose::of(&self.nominal, q).position);
        let mut reach: f64 = chain.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        for (joint, q) in self.robot.joints.iter().zip(q.iter()).filter(|(joint, _)| !joint.revolute) {
            let [low, high] = joint.position;
            reach += (low - q).abs().max((high - q).abs());
        }
        if !reach.is_finite() {
            return None;
        }
        let trajectory = &sampling.motion.trajectory;
        let end = sampling.duration.min(trajectory.duration());
        let (mut t, mut first, mut nearest) = (Duration::ZERO, None, (f64::INFINITY, Duration::ZERO));
        while t <= end {
            let distance = trajectory.sample(t).pose.position.norm();
            if distance > reach && first.is_none() {
                first = Some((t, distance));
            }
            if distance < nearest.0 {
                nearest = (distance, t);
            }
            t += STEP;
        }
        let (t, distance) = first?;
        Some(format!(
            "the path leaves the reach of the arm: at {} s it is {} m from the base, and the arm is {} m long at most; it is nearest at {} s, {} m",
            rounded(t.as_secs_f64()),
            rounded(distance),
            rounded(reach),
            rounded(nearest.1.as_secs_f64()),
            rounded(nearest.0)
        ))
    }

    /// How far the start is from where the path begins, in the rows of the task.
    fn off_the_path(&self, q: &SVector<f64, N>, sampling: &Sampling) -> Option<String> {
        let task: &Task<M> = &self.task;
        let error = task.error(&sampling.motion.trajectory.sample(Duration::ZERO).pose, &Pose::of(&self.nominal, q));
        let norm = |linear: bool| {
            let rows = task.rows().iter().zip(error.iter()).filter(|(row, _)| row.is_angular() != linear);
            rows.map(|(_, e)| e * e).sum::<f64>().sqrt()
        };
        let (away, turned) = (norm(true), norm(false));
        (away > OFF.0 || turned > OFF.1).then(|| {
            format!(
                "the start is off the path: {} m and {} rad from where the path begins; what follows it there is a step",
                rounded(away),
                rounded(turned)
            )
        })
    }
}

/// Four digits after the point at most.
fn rounded(x: f64) -> String {
    number((x * 1e4).round() / 1e4)
}
