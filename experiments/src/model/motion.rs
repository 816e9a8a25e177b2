//! A planned motion of the end effector.

use armgen_runtime::nalgebra::Matrix3;
use armgen_runtime::trajectory::{OperationalTrajectory, Segment, Turn};

/// Position and orientation over time.
pub type Trajectory = OperationalTrajectory<f64, Vec<Segment<f64>>, Vec<Turn<f64>>>;

/// A motion, with what is needed to draw it.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Position and orientation over time.
    pub trajectory: Trajectory,
    /// The orientation from which angles count.
    pub frame: Matrix3<f64>,
    /// Height of the sheet that is cut, and of the cut; m.
    pub sheet: Option<Sheet>,
}

/// A sheet at right angles to z0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Height of its upper side.
    pub top: f64,
    /// Height of the tip while it cuts.
    pub depth: f64,
}

impl Motion {
    /// The segments whose ends are via points: the next segment begins before they end.
    pub fn vias(&self) -> Vec<usize> {
        let segments = self.trajectory.path.segments();
        let is_via = |i: &usize| segments.get(i + 1).is_some_and(|next| next.start() < segments[*i].end());
        (0..segments.len()).filter(is_via).collect()
    }
}
