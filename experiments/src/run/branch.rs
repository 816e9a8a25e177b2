//! A branch of the inverse kinematics, followed along a path before the run.

use std::time::Duration;

use armgen_runtime::inverse_kinematics::BranchEnd;
use armgen_runtime::nalgebra::SVector;

use super::instance::Functions;
use super::{Instance, Run};
use crate::model::{Body, BranchRun, Ended, JointQuantity, Quantity, Record, Robot};

/// A followed branch.
struct Branch<'a, const N: usize> {
    body: &'a Body,
    robot: &'a Robot,
    /// The postures along the path, each with its path parameter in [0, 1] and its manipulability.
    way: Vec<(f64, SVector<f64, N>, f64)>,
    duration: f64,
    postures: usize,
    reached: f64,
    ended: Option<Ended>,
}

impl<const N: usize> Run for Branch<'_, N> {
    fn warning(&self) -> Option<String> {
        self.ended.as_ref().map(|end| end.why.clone())
    }

    fn run(self: Box<Self>) -> Record {
        let mut record = Record::new(self.body.channels(self.robot));
        for (s, q, w) in &self.way {
            record.sample(|quantity| match quantity {
                Quantity::Time => s * self.duration,
                Quantity::Joint(JointQuantity::Position, i) => q[i],
                Quantity::Manipulability => *w,
                _ => f64::NAN,
            });
        }
        let value = |quantity: Quantity| match quantity {
            Quantity::PosturesAtStart => self.postures as f64,
            Quantity::BranchEndsAt => self.reached * self.duration,
            _ => f64::NAN,
        };
        let numbers = self.body.numbers(self.robot).into_iter();
        record.numbers = numbers.map(|channel| (channel.clone(), value(channel.quantity))).collect();
        record.ended = self.ended;
        record
    }
}

impl<R: Functions<N, P>, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    /// Follows the branch along the path.
    ///
    /// # Errors
    /// The robot has no inverse kinematics, or there is no start.
    pub(super) fn prepare_branch<'a>(&'a self, run: &'a BranchRun, body: &'a Body) -> Result<Box<dyn Run + 'a>, String> {
        let solver = self.solver.ok_or("the robot has no inverse kinematics: `armgen show ROBOT inverse_kinematics` says why")?;
        let start = self.start(&run.start, &run.sampling)?;
        let duration = run.sampling.duration.as_secs_f64();
        let path = |s: f64| run.sampling.motion.trajectory.sample(Duration::from_secs_f64(s * duration)).pose;
        let mut way = Vec::new();
        let followed = (solver.follow)(&self.nominal, &path, &start, &mut |s, q| way.push((s, *q, self.manipulability(q))));
        let joint = |joint: usize| &self.robot.joints[joint].name;
        let ended = followed.end.map(|end| {
            // Other reasons mean that the branch did not begin or that following failed.
            let is_end =
                matches!(end, BranchEnd::Unreachable | BranchEnd::Singular | BranchEnd::Continuum | BranchEnd::Limit { .. });
            let why = match end {
                BranchEnd::Limit { joint: number } => format!("joint `{}` comes to its limit", joint(number)),
                end => end.to_string(),
            };
            let why = format!("the branch ends at {:.6} s of {duration} s: {why}", followed.s * duration);
            Ended { why, told_by: is_end.then_some(Quantity::BranchEndsAt) }
        });
        let postures = (solver.postures)(&self.nominal, &path(0.0)).len();
        Ok(Box::new(Branch { body, robot: &self.robot, way, duration, postures, reached: followed.s, ended }))
    }
}
