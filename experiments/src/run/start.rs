//! The start of a run: joint variables of the file, or a posture from inverse kinematics at the beginning of the path.

use std::f64::consts::{PI, TAU};
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
/// A posture at a limit may be beyond it by this many turns: roundings.
const SLACK: f64 = 1e-12;
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

    /// A posture at the beginning of the path: the one that a search from `near` finds; else, of all postures of the inverse kinematics or
    /// of those that searches find, the one nearest to zero. The searches begin at points spread evenly over the limits, the middle first.
    fn on_the_path(&self, near: Option<&[f64]>, sampling: &Sampling) -> Result<SVector<f64, N>, String> {
        let refused = |error: &dyn std::fmt::Display| format!("there is no start on the path: {error}");
        let begin = sampling.motion.trajectory.sample(Duration::ZERO).pose;
        let nearest_to_zero = |postures: Vec<SVector<f64, N>>| {
            let within = postures.iter().filter_map(|q| self.nearest_turns(q));
            within.min_by(|a, b| a.norm().total_cmp(&b.norm()))
        };
        let solver = self.solver.filter(|_| near.is_none());
        if let Some(found) = solver.and_then(|solver| nearest_to_zero((solver.postures)(&self.nominal, &begin))) {
            return Ok(found);
        }
        let damping = Damping::below(DAMPING.0).at_most(DAMPING.1).map_err(|error| refused(&error))?;
        let algorithm = DampedLeastSquares::new([PART; M], damping).map_err(|error| refused(&error))?;
        let limits = limits(&self.robot.joints).map_err(|error| refused(&error))?;
        let clik = Clik::new(self.task, algorithm, 1.0, limits, [TOLERANCE; M]).map_err(|error| refused(&error))?;
        let goal = OperationalReference::at_rest(begin);
        let mut nearest = f64::INFINITY;
        let mut search = |from: SVector<f64, N>| {
            let mut q = from;
            for _ in 0..STEPS {
                let step = clik.step(&self.nominal, &q, &goal).ok()?;
                if step.outcome == Outcome::Converged {
                    return Some(q);
                }
                nearest = nearest.min(step.error.norm());
                q = step.q;
            }
            None
        };
        let found = match near.and_then(|near| search(Self::joints(near))) {
            Some(found) => Some(found),
            None => {
                let postures = (0..TRIES).map(|k| self.spread(k));
                nearest_to_zero(self.nearest_turns(&SVector::zeros()).into_iter().chain(postures).filter_map(search).collect())
            }
        };
        found.ok_or_else(|| {
            format!("no posture within the limits is where the path begins: {TRIES} tries came as near as {nearest:.3} m and rad")
        })
    }

    /// The posture with its angles by the whole turns that come nearest to zero within the limits; `None` where no number of turns does.
    fn nearest_turns(&self, q: &SVector<f64, N>) -> Option<SVector<f64, N>> {
        let mut turned = *q;
        for (x, joint) in turned.iter_mut().zip(&self.robot.joints).filter(|(x, _)| x.is_finite()) {
            let [low, high] = joint.position;
            if joint.revolute {
                let [least, most] = [((low - *x) / TAU - SLACK).ceil(), ((high - *x) / TAU + SLACK).floor()];
                if least > most {
                    return None;
                }
                *x += TAU * (-*x / TAU).round().clamp(least, most);
            }
            let inside = x.clamp(low, high);
            if (*x - inside).abs() > TAU * SLACK {
                return None;
            }
            *x = inside;
        }
        Some(turned)
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
