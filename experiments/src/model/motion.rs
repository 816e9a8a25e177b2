//! A planned motion of the end effector.

use armgen_runtime::nalgebra::Matrix3;
use armgen_runtime::trajectory::{OperationalTrajectory, Segment, Turn};

/// Position and orientation over time.
pub type Trajectory = OperationalTrajectory<f64, Vec<Segment<f64>>, Vec<Turn<f64>>>;

/// A motion, with the data for drawing it.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Position and orientation over time.
    pub trajectory: Trajectory,
    /// The orientation with angle zero.
    pub frame: Matrix3<f64>,
    /// The sheet to cut, if any.
    pub sheet: Option<Sheet>,
}

/// A sheet perpendicular to z0; heights in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Height of its upper side.
    pub top: f64,
    /// Height of the tip while cutting.
    pub depth: f64,
}

impl Motion {
    /// The segments that end at via points: the next segment begins before they end.
    pub fn vias(&self) -> Vec<usize> {
        let segments = self.trajectory.path.segments();
        let is_via = |i: &usize| segments.get(i + 1).is_some_and(|next| next.start() < segments[*i].end());
        (0..segments.len()).filter(is_via).collect()
    }
}
