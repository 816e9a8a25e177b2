//! Motion between postures within the joint limits by inverse dynamics in joint space, for any arm.
//!
//! Each joint in turn, then all together, move to both sides of the initial posture: the middle of a joint's range, or zero without a
//! range. The velocity limits set the pace, which is then reduced until the efforts are within their limits.

use std::time::Duration;

use armgen_runtime::control::InverseDynamics;
use armgen_runtime::nalgebra::{SMatrix, SVector};
use armgen_runtime::reference::{Pose, State};
use armgen_runtime::simulation::{run as simulate, Integrator, RunOptions};
use armgen_runtime::stability::{analyse, Delay, LineariseAtRest, Report, StablePeriod};
use armgen_runtime::trajectory::{JointSegment, JointTrajectory};

use super::instance::Functions;
use super::{Demonstration, Instance};
use crate::model::{Channel, JointQuantity, Quantity, Record};

type Postures<const N: usize> = JointTrajectory<f64, N, Vec<JointSegment<f64, N>>>;

/// The sampling period.
const PERIOD: Duration = Duration::from_millis(1);
/// Velocity and acceleration without limits in the description: rad/s or m/s, and rad/s² or m/s².
const TURNING: (f64, f64) = (1.5, 4.0);
const SLIDING: (f64, f64) = (0.25, 1.0);
/// Amplitude of a joint if its range is wide enough: rad, and m.
const SWING: f64 = 0.5;
const STROKE: f64 = 0.1;
/// Used fraction of a limit.
const PART: f64 = 0.8;
/// Maximum number of halvings of the pace to bring the efforts within their limits.
const HALVINGS: u32 = 6;
/// With an exact model, sampling alone causes a joint error below this, rad or m.
const EXPECTED: f64 = 1e-4;
/// Diagonals of K_P, 1/s², and of K_D, 1/s: critical damping.
const GAINS: (f64, f64) = (1e4, 200.0);
/// Minimum and maximum number of integrator steps per sample.
const STEPS: [u32; 2] = [4, 4096];
/// The classical Runge-Kutta method is stable if the step times the fastest decay rate is at most 2.78.
const DECAY_A_STEP: f64 = 2.0;
/// Time at rest at the end.
const HOLD: Duration = Duration::from_millis(500);

fn fault(error: &dyn std::fmt::Display) -> String {
    format!("the demonstration cannot be run: {error}")
}

impl<R: Functions<N, P>, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    pub(super) fn run_demonstration(&self) -> Result<Demonstration, String> {
        let (trajectory, pace) = self.within_efforts()?;
        let controller = InverseDynamics::new([GAINS.0; N], [GAINS.1; N]).map_err(|e| fault(&e))?;
        let end = trajectory.duration() + HOLD;
        let postures: Vec<SVector<f64, N>> =
            (0..=end.as_millis() / 100).map(|k| trajectory.sample(Duration::from_millis(100) * k as u32).q).collect();
        let stable = self.stability(&controller, &postures)?;

        let mut record = Record::new(self.channels());
        let substeps = self.steps_a_sample(&postures);
        let options = RunOptions { integrator: Integrator::RungeKutta4 { substeps }, ..RunOptions::new(PERIOD, end) };
        simulate(
            &self.nominal,
            State::at_rest(trajectory.sample(Duration::ZERO).q),
            options,
            |t, measured| controller.torque(&self.nominal, &trajectory.sample(t), measured).map(|torque| torque.tau),
            |sample| {
                let desired = trajectory.sample(sample.time);
                let State { q, dq } = sample.state;
                let [tip, desired_tip] = [q, desired.q].map(|q| Pose::of(&self.nominal, &q).position);
                record.sample(|quantity| match quantity {
                    Quantity::Time => sample.time.as_secs_f64(),
                    Quantity::Tip(axis) => tip[axis],
                    Quantity::DesiredTip(axis) => desired_tip[axis],
                    Quantity::Joint(JointQuantity::Position, i) => q[i],
                    Quantity::Joint(JointQuantity::Error, i) => desired.q[i] - q[i],
                    Quantity::Joint(JointQuantity::Rate, i) => dq[i],
                    Quantity::Joint(JointQuantity::Effort, i) => sample.tau[i],
                    _ => f64::NAN,
                });
            },
        )
        .map_err(|e| fault(&e))?;

        let mut summary = vec![
            format!(
                "Demonstration: each joint to either side, then all together, {:.1} s sampled at {} ms",
                record.end(),
                PERIOD.as_millis()
            ),
            format!("inverse dynamics with K_P = {} 1/s², K_D = {} 1/s; {stable}", GAINS.0, GAINS.1),
        ];
        summary.extend(pace);
        Ok(Demonstration { summary, fault: self.missed(&record, &postures), record })
    }

    /// The number of integrator steps per sample. Viscous friction damps a light joint at rates of up to the largest row sum of B⁻¹ ∂F/∂dq,
    /// which can reach 10⁵ per second for wrists in data sheets.
    fn steps_a_sample(&self, postures: &[SVector<f64, N>]) -> u32 {
        let slope = self.friction_slope();
        let decays = self.inverse_inertias(postures).map(|(_, inverse)| (inverse * slope).max());
        let steps = PERIOD.as_secs_f64() * decays.fold(0.0, f64::max) / DECAY_A_STEP;
        (steps.ceil() as u32).clamp(STEPS[0], STEPS[1])
    }

    /// The postures with positive definite B, each with the absolute values of the entries of B⁻¹.
    fn inverse_inertias<'a>(
        &'a self,
        postures: &'a [SVector<f64, N>],
    ) -> impl Iterator<Item = (&'a SVector<f64, N>, SMatrix<f64, N, N>)> + 'a {
        postures.iter().filter_map(|q| Some((q, self.nominal.inertia_matrix(q).cholesky()?.inverse().abs())))
    }

    /// |∂F/∂dq| between rates 1 and 2, without Coulomb friction: N m s/rad or N s/m.
    fn friction_slope(&self) -> SVector<f64, N> {
        let at = |rate: f64| self.nominal.friction(&SVector::repeat(rate));
        (at(2.0) - at(1.0)).abs()
    }

    fn channels(&self) -> Vec<Channel> {
        use JointQuantity::{Effort, Error, Position, Rate};
        let tip = (0..3).map(Quantity::Tip).chain((0..3).map(Quantity::DesiredTip));
        let joints = [Position, Error, Rate, Effort].into_iter().flat_map(|of| (0..N).map(move |i| Quantity::Joint(of, i)));
        let all = [Quantity::Time].into_iter().chain(tip).chain(joints);
        all.map(|quantity| Channel::new(quantity, &self.robot)).collect()
    }

    /// A summary of the loop's stability in these postures; an error, with a stable period, if it is unstable.
    fn stability(&self, controller: &dyn LineariseAtRest<R, R, N>, postures: &[SVector<f64, N>]) -> Result<String, String> {
        let report = analyse(&self.nominal, &self.nominal, controller, postures, PERIOD.as_secs_f64(), Delay::NONE)
            .map_err(|error| format!("the sampled loop has no spectral radius: {error}"))?;
        let Report { spectral_radius: radius, period, .. } = report;
        let milliseconds = |seconds: f64| format!("{:.3} ms", seconds * 1e3);
        let limit = match period {
            StablePeriod::UpTo(limit) => format!("stable up to {}", milliseconds(limit)),
            StablePeriod::AtLeast(limit) => format!("stable up to {} at least", milliseconds(limit)),
            StablePeriod::NotEvenAt(limit) => format!("unstable even at {}", milliseconds(limit)),
        };
        let text = format!("spectral radius {radius:.5} at {}, {limit}", milliseconds(PERIOD.as_secs_f64()));
        if report.is_stable() {
            Ok(text)
        } else {
            Err(format!("the sampled loop is unstable: {text}"))
        }
    }

    /// The first joint whose error exceeds its bound.
    fn missed(&self, record: &Record, postures: &[SVector<f64, N>]) -> Option<String> {
        let bounds = self.bounds(postures);
        self.robot.joints.iter().enumerate().find_map(|(i, joint)| {
            let (unit, bound) = (joint.unit(), bounds[i]);
            let error = Channel::new(Quantity::Joint(JointQuantity::Error, i), &self.robot);
            let peak = record.log().peak(&error.name, |_| true).unwrap_or(f64::NAN);
            (peak.is_nan() || peak >= bound).then(|| {
                let name = &joint.name;
                format!("joint `{name}` misses by {peak:.1e} {unit}: sampling and friction explain {bound:.1e} {unit} with a model that is right")
            })
        })
    }

    /// Bounds of the joint errors, rad or m.
    ///
    /// When a rate passes zero, the held torque has Coulomb and load-dependent friction with the wrong sign. This disturbance of up to 2 F_c
    /// changes the error by at most B⁻¹ 2 F_c / K_P. Viscous friction lags by at most a period, which adds ∂F/∂dq · ddq T.
    fn bounds(&self, postures: &[SVector<f64, N>]) -> SVector<f64, N> {
        let creeping = SVector::repeat(f64::MIN_POSITIVE);
        let acceleration: SVector<f64, N> =
            SVector::from_fn(|i, _| if self.robot.joints[i].revolute { TURNING.1 } else { SLIDING.1 });
        let late = self.friction_slope().component_mul(&acceleration) * PERIOD.as_secs_f64();
        let friction = |q: &SVector<f64, N>| {
            (self.nominal.friction(&creeping) + self.nominal.load_friction(q, &SVector::repeat(1.0))).abs() * 2.0 + late
        };
        self.inverse_inertias(postures).fold(SVector::repeat(EXPECTED), |bounds, (q, inverse)| {
            bounds.sup(&((inverse * friction(q)) / GAINS.0).add_scalar(EXPECTED))
        })
    }

    /// The trajectory at the fastest of a few paces with efforts within their limits, and a line about a reduced pace.
    fn within_efforts(&self) -> Result<(Postures<N>, Option<String>), String> {
        let mut pace = 1.0;
        let mut beyond = String::new();
        for halving in 0..=HALVINGS {
            let trajectory = self.plan(pace)?;
            match self.beyond_efforts(&trajectory) {
                None if halving == 0 => return Ok((trajectory, None)),
                None => return Ok((trajectory, Some(format!("slowed down to {pace} of the full pace: {beyond}")))),
                Some(reason) => beyond = reason,
            }
            pace /= 2.0;
        }
        // Gravity alone exceeds a limit. The summary reports it, and the motion still runs.
        Ok((self.plan(pace)?, Some(format!("even slow motion asks for more than a limit: {beyond}"))))
    }

    /// The joint with the largest excess over its effort limit, described in words.
    fn beyond_efforts(&self, trajectory: &Postures<N>) -> Option<String> {
        let mut worst: Option<(f64, usize, f64)> = None;
        for k in 0..=trajectory.duration().as_millis() / 10 {
            let desired = trajectory.sample(Duration::from_millis(10) * k as u32);
            let tau = self.nominal.inverse_dynamics(&desired.q, &desired.dq, &desired.ddq);
            for i in 0..N {
                let excess = tau[i].abs() / self.robot.joints[i].effort;
                if excess > 1.0 && worst.is_none_or(|(before, ..)| excess > before) {
                    worst = Some((excess, i, tau[i].abs()));
                }
            }
        }
        let (_, i, tau) = worst?;
        let joint = &self.robot.joints[i];
        let (name, unit, limit) = (&joint.name, joint.effort_unit(), joint.effort);
        Some(format!("joint `{name}` would need {tau:.1} {unit}, and its limit is {limit} {unit}"))
    }

    fn plan(&self, pace: f64) -> Result<Postures<N>, String> {
        let (home, swing) = self.home_and_swing();
        let joints = &self.robot.joints;
        let limit = |given: f64, own: f64| if given.is_finite() { (PART * given).min(own) } else { own };
        let own = |i: usize| if joints[i].revolute { TURNING } else { SLIDING };
        let velocity: [f64; N] = std::array::from_fn(|i| pace * limit(joints[i].velocity, own(i).0));
        let acceleration: [f64; N] = std::array::from_fn(|i| pace * pace * own(i).1);
        let to = |posture: [f64; N]| JointSegment::within_limits(posture, velocity, acceleration);
        let mut segments = Vec::new();
        for i in 0..N {
            for side in [1.0, -1.0] {
                let mut posture = home;
                posture[i] += side * swing[i];
                segments.push(to(posture));
            }
            segments.push(to(home));
        }
        for side in [1.0, -1.0] {
            let alternating = |i: usize| if i.is_multiple_of(2) { side } else { -side };
            segments.push(to(std::array::from_fn(|i| home[i] + alternating(i) * swing[i])));
        }
        segments.push(to(home));
        JointTrajectory::plan(home, segments).map_err(|error| format!("the demonstration cannot be planned: {error}"))
    }

    /// The initial positions of the joints, and their amplitudes.
    fn home_and_swing(&self) -> ([f64; N], [f64; N]) {
        let joints = &self.robot.joints;
        let full = |i: usize| if joints[i].revolute { SWING } else { STROKE };
        let of = |i: usize| {
            let [low, high] = joints[i].position;
            match (low.is_finite(), high.is_finite()) {
                (true, true) => ((low + high) / 2.0, full(i).min(PART * (high - low) / 2.0)),
                (true, false) => (low + full(i) / PART, full(i)),
                (false, true) => (high - full(i) / PART, full(i)),
                (false, false) => (0.0, full(i)),
            }
        };
        (std::array::from_fn(|i| of(i).0), std::array::from_fn(|i| of(i).1))
    }
}
