//! The start of a run: joint variables of the file, or a posture from closed-loop inverse kinematics at the beginning of the path.

use std::f64::consts::PI;
use std::time::Duration;

use armgen_runtime::clik::{Clik, DampedLeastSquares, Outcome};
use armgen_runtime::linalg::Damping;
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::OperationalReference;

use super::clik::limits;
use super::instance::Functions;
use super::Instance;
use crate::model::{Sampling, Start};

/// Maximum task error, m and rad, of a posture at the beginning of the path.
const TOLERANCE: f64 = 1e-9;
/// Number of initial postures, and of steps from each.
const TRIES: u32 = 32;
const STEPS: u32 = 400;
/// Fraction of the error that a step removes.
const PART: f64 = 0.3;
/// Damping near singular postures: the manipulability below which it begins, and its maximum.
const DAMPING: (f64, f64) = (1e-3, 1e-2);

impl<R: Functions<N, P>, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    /// The joint variables at the start.
    ///
    /// # Errors
    /// No posture is found; the message gives the reason.
    pub(super) fn start(&self, start: &Start, sampling: &Sampling) -> Result<SVector<f64, N>, String> {
        match start {
            Start::Joints(values) => Ok(Self::joints(values)),
            Start::Path(near) => self.on_the_path(near.as_deref(), sampling),
        }
    }

    /// A posture at the beginning of the path: the first found from `near`, or else from points spread evenly over the limits, the
    /// middle first.
    fn on_the_path(&self, near: Option<&[f64]>, sampling: &Sampling) -> Result<SVector<f64, N>, String> {
        let refused = |error: &dyn std::fmt::Display| format!("there is no start on the path: {error}");
        let damping = Damping::below(DAMPING.0).at_most(DAMPING.1).map_err(|error| refused(&error))?;
        let algorithm = DampedLeastSquares::new([PART; M], damping).map_err(|error| refused(&error))?;
        let limits = limits(&self.robot.joints).map_err(|error| refused(&error))?;
        let clik = Clik::new(self.task, algorithm, 1.0, limits, [TOLERANCE; M]).map_err(|error| refused(&error))?;
        let goal = OperationalReference::at_rest(sampling.motion.trajectory.sample(Duration::ZERO).pose);
        let mut nearest = f64::INFINITY;
        for k in 0..TRIES {
            let from = match (k, near) {
                (0, Some(near)) => Self::joints(near),
                _ => self.spread(k),
            };
            let mut q = from;
            for _ in 0..STEPS {
                let Ok(step) = clik.step(&self.nominal, &q, &goal) else { break };
                if step.outcome == Outcome::Converged {
                    return Ok(q);
                }
                nearest = nearest.min(step.error.norm());
                q = step.q;
            }
        }
        Err(format!(
            "no posture within the limits is where the path begins: {TRIES} tries came as near as {nearest:.3} m and rad"
        ))
    }

    /// Point `k` of a sequence that fills the limits evenly (multiples of irrational numbers, modulo 1); `k` = 0 is the middle. A missing
    /// limit is half a turn or half a metre from zero.
    fn spread(&self, k: u32) -> SVector<f64, N> {
        SVector::from_fn(|i, _| {
            let joint = &self.robot.joints[i];
            let wide = if joint.revolute { PI } else { 0.5 };
            let [low, high] = joint.position;
            let [low, high] = [if low.is_finite() { low } else { -wide }, if high.is_finite() { high } else { wide }];
            let part = (0.5 + f64::from(k) * ((i + 2) as f64).sqrt()).fract();
            // Square numbers have integer roots, so their joints use multiples of π.
            let part =
                if ((i + 2) as f64).sqrt().fract() == 0.0 { (0.5 + f64::from(k) * PI * (i + 1) as f64).fract() } else { part };
            low + (high - low) * part
        })
    }
}
