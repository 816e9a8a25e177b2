//! Warnings before a run: a start outside the limits, a path out of reach, a start off the path.
//!
//! The stretched chain of frame origins, from the origin of the base, bounds the reach: |p_e| <= max |p_1| + sum |p_{i+1} - p_i|.
//! Revolute joints do not change these lengths; a prismatic joint changes them by its stroke.
//! |p_1| varies if the first joint is revolute and its axis has the distance r_0 from the origin of the base. Let p_1 have the distance r
//! from the axis, and the coordinate h along it, from the foot of the perpendicular. Then max |p_1|^2 = (r_0 + r)^2 + h^2.
//! A path beyond this bound is certainly out of reach; a path within it may also be out of reach.

use std::time::Duration;

use armgen_runtime::nalgebra::{Matrix4, SVector, Vector3};
use armgen_runtime::reference::Pose;
use armgen_runtime::robot::Kinematics;
use armgen_runtime::task::Task;

use super::instance::Functions;
use super::Instance;
use crate::model::{number, Body, Experiment, Joint, Sampling};

/// Maximum plausible distance, m and rad, of a start from its path, which closed-loop inverse kinematics then reduces.
const OFF: (f64, f64) = (0.05, 0.2);
/// Start angles above this, rad, are probably in degrees, not whole turns away.
const DEGREES: f64 = 10.0;
/// Maximum interval between the checked poses of the path.
const STEP: Duration = Duration::from_millis(10);

impl<R: Functions<N, P>, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    /// The warnings about an experiment.
    pub(super) fn implausible_settings(&self, experiment: &Experiment) -> Vec<String> {
        let (sampling, start) = match &experiment.body {
            Body::Clik(run) => (&run.sampling, &run.start),
            Body::Branch(run) => (&run.sampling, &run.start),
            Body::Control(run) => (&run.sampling, &run.start),
            Body::Postures(_) | Body::Path(_) => return Vec::new(),
        };
        let q = match self.start(start, sampling) {
            Ok(q) => q,
            // The run itself reports this error.
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
                // Without limits, or with wide limits, degrees are recognisable by their size.
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

    /// A warning if the path leaves the reach of the arm.
    fn beyond_reach(&self, q: &SVector<f64, N>, sampling: &Sampling) -> Option<String> {
        let reach = reach(&self.nominal, &self.robot.joints, q);
        if !reach.is_finite() {
            return None;
        }
        let trajectory = &sampling.motion.trajectory;
        let (end, step) = (sampling.duration.min(trajectory.duration()), STEP.max(sampling.period));
        let (mut t, mut first, mut nearest) = (Duration::ZERO, None, (f64::INFINITY, Duration::ZERO));
        while t <= end {
            let distance = trajectory.sample(t).pose.position.norm();
            if distance > reach && first.is_none() {
                first = Some((t, distance));
            }
            if distance < nearest.0 {
                nearest = (distance, t);
            }
            t += step;
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

    /// The distance of the start from the beginning of the path, in the rows of the task.
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

/// The joints that move the end effector, from the base on: J has a column of zeros for each other joint.
pub(super) fn joints_of_end_effector<R: Kinematics<N, Real = f64>, const N: usize>(robot: &R, q: &SVector<f64, N>) -> Vec<usize> {
    let jacobian = robot.geometric_jacobian(q);
    (0..N).filter(|&i| jacobian.column(i).iter().any(|entry| *entry != 0.0)).collect()
}

/// Upper bound of the end effector's distance from the origin of the base, m; infinite for an unlimited prismatic joint.
fn reach<R: Kinematics<N, Real = f64>, const N: usize>(robot: &R, joints: &[Joint], q: &SVector<f64, N>) -> f64 {
    let origin = |frame: &Matrix4<f64>| Vector3::new(frame[(0, 3)], frame[(1, 3)], frame[(2, 3)]);
    let (moving, frames) = (joints_of_end_effector(robot, q), robot.link_frames(q));
    let mut chain: Vec<Vector3<f64>> = moving.iter().map(|&i| origin(&frames[i])).collect();
    let tip = Pose::of(robot, q).position;
    chain.push(tip);
    let mut reach: f64 = chain.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let jacobian = robot.geometric_jacobian(q);
    let first_joint = moving.first().copied().unwrap_or(0);
    let [velocity, axis]: [Vector3<f64>; 2] = [0, 3].map(|row| jacobian.fixed_view::<3, 1>(row, first_joint).into_owned());
    // The axis z of the first joint, 0 if it is prismatic. (z × (p_e - a)) × z is the component of p_e - a perpendicular to z.
    let along = |p: Vector3<f64>| axis * axis.dot(&p);
    let foot = if joints[first_joint].revolute { tip - along(tip) - velocity.cross(&axis) } else { Vector3::zeros() };
    let (first, height) = (chain[0] - foot, along(chain[0]));
    reach += (foot.norm() + (first - height).norm()).hypot(height.norm());
    for (joint, q) in joints.iter().zip(q.iter()).filter(|(joint, _)| !joint.revolute) {
        let [low, high] = joint.position;
        reach += (low - q).abs().max((high - q).abs());
    }
    reach
}

/// Rounds to four decimals.
fn rounded(x: f64) -> String {
    number((x * 1e4).round() / 1e4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use armgen_runtime::nalgebra::SMatrix;

    /// A joint with a link of 0.5 m that rotates about z through (1, 0, 0), or slides along y from there.
    struct OneJoint(bool);

    impl Kinematics<1> for OneJoint {
        type Real = f64;

        fn direct_kinematics(&self, q: &SVector<f64, 1>) -> Matrix4<f64> {
            let (x, y) = if self.0 { (1.0 + 0.5 * q[0].cos(), 0.5 * q[0].sin()) } else { (1.0, q[0]) };
            Matrix4::new_translation(&Vector3::new(x, y, 0.7))
        }

        fn link_frames(&self, q: &SVector<f64, 1>) -> [Matrix4<f64>; 1] {
            [self.direct_kinematics(q)]
        }

        fn geometric_jacobian(&self, q: &SVector<f64, 1>) -> SMatrix<f64, 6, 1> {
            if self.0 {
                SMatrix::from([[-0.5 * q[0].sin(), 0.5 * q[0].cos(), 0.0, 0.0, 0.0, 1.0]])
            } else {
                SMatrix::from([[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]])
            }
        }

        fn geometric_jacobian_dot(&self, _: &SVector<f64, 1>, _: &SVector<f64, 1>) -> SMatrix<f64, 6, 1> {
            SMatrix::zeros()
        }
    }

    /// At q = 0 the link points away from the base, at π towards it; the bound must be the same for both, and in between.
    #[test]
    fn an_arm_beside_the_base_is_as_long_wherever_it_begins() {
        let joint = |revolute, position| Joint { name: String::new(), revolute, position, velocity: 1.0, effort: 1.0 };
        let turning = [joint(true, [f64::NEG_INFINITY, f64::INFINITY])];
        for q in [0.0, 1.0, std::f64::consts::PI, -2.0] {
            let found = reach(&OneJoint(true), &turning, &SVector::from([q]));
            assert!((found - 1.5f64.hypot(0.7)).abs() < 1e-14, "{q}: {found}");
        }
        let found = reach(&OneJoint(false), &[joint(false, [0.0, 0.25])], &SVector::from([0.0]));
        assert_eq!(found, 1.0f64.hypot(0.7) + 0.25);
    }
}
