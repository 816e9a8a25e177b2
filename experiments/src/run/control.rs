//! A controller along a path: first the linearised sampled loop, then the run, whose plant has its own parameters.

use std::slice::from_ref;
use std::time::{Duration, Instant};

use armgen_runtime::clik::{Integration, JointLimits};
use armgen_runtime::control::{
    Adaptive, BoundaryLayer, ControlError, Interval, InverseDynamics, Limited, OperationalSpace, PdGravity, Robust, TorqueLimits,
};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::{JointReference, OperationalReference, Pose, State};
use armgen_runtime::settings::SettingError;
use armgen_runtime::simulation::{
    run as simulate, run_continuous, ContinuousOptions, Divergence, Integrator, RunError, RunOptions, Sensor, DIVERGENCE_BOUND,
};
use armgen_runtime::stability::{
    analyse, analyse_start, Delay, LineariseAtRest, LineariseInMotion, MotionAnalysis, MotionReport, Report, StabilityError,
    StablePeriod,
};

use super::instance::{padded, sized, Functions};
use super::{Instance, Run};
use crate::model::{
    number, Body, ControlLaw, ControlLawKind, ControlRun, Ended, EstimateBounds, Experiment, JointQuantity, Peak, Quantity,
    Record, ReferenceGains, Robot, Speed,
};

/// Time between the postures at which the loop is linearised.
const POSTURE_STEP: Duration = Duration::from_millis(250);
/// Divisors of the period for further analyses of an unstable loop.
const SHORTER: [u32; 6] = [2, 5, 10, 20, 50, 100];
/// Maximum number of samples in a simulation at a shorter period.
const MAX_REHEARSED: u128 = 400_000;
/// Joint error, rad or m, above which the run records `lost_at` ([`LARGE_ERROR`]), and above which it aborts ([`ABORT_ERROR`]).
const LARGE_ERROR: f64 = 0.1;
const ABORT_ERROR: f64 = 1.0;

/// A sampled controller as a trait object, so that linearisation and simulation are compiled once for all controllers.
trait SampledLaw<R: Functions<N, P>, W: Functions<N, P>, const N: usize, const P: usize>: Send {
    /// The torque for a sample; the controller chooses the reference it uses.
    fn torque(
        &mut self,
        model: &R,
        joints: &JointReference<f64, N>,
        operational: &OperationalReference<f64>,
        measured: &State<f64, N>,
    ) -> Result<SVector<f64, N>, ControlError>;

    /// The watched values before the last torque, in the order of [`ControlLawKind::watched`].
    fn watched(&self) -> &[f64];

    /// The controller, for linearisation at rest.
    fn as_linearised_at_rest(&self) -> &dyn LineariseAtRest<W, R, N>;

    /// Analyses the stability along the motion.
    fn analyse_motion(
        &self,
        analysis: &MotionAnalysis<'_, W, f64, N>,
        model: &R,
        operational: &[OperationalReference<f64>],
    ) -> Result<MotionReport<f64>, StabilityError>;
}

/// References in joint space or operational space.
trait OfKind<const N: usize>: Sized {
    fn of<'s>(joints: &'s [JointReference<f64, N>], operational: &'s [OperationalReference<f64>]) -> &'s [Self];
}

impl<const N: usize> OfKind<N> for JointReference<f64, N> {
    fn of<'s>(joints: &'s [JointReference<f64, N>], _: &'s [OperationalReference<f64>]) -> &'s [Self] {
        joints
    }
}

impl<const N: usize> OfKind<N> for OperationalReference<f64> {
    fn of<'s>(_: &'s [JointReference<f64, N>], operational: &'s [OperationalReference<f64>]) -> &'s [Self] {
        operational
    }
}

/// A controller with the function that reads its watched values.
struct Watched<C, F> {
    controller: C,
    watch: F,
    watched: Vec<f64>,
}

impl<R, W, C, F, const N: usize, const P: usize> SampledLaw<R, W, N, P> for Watched<C, F>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
    C: LineariseAtRest<W, R, N> + LineariseInMotion<W, R, N> + Send,
    C::Reference: OfKind<N>,
    F: Fn(&C, &C::Reference, &State<f64, N>, &mut Vec<f64>) + Send,
{
    fn torque(
        &mut self,
        model: &R,
        joints: &JointReference<f64, N>,
        operational: &OperationalReference<f64>,
        measured: &State<f64, N>,
    ) -> Result<SVector<f64, N>, ControlError> {
        let reference = &C::Reference::of(from_ref(joints), from_ref(operational))[0];
        self.watched.clear();
        (self.watch)(&self.controller, reference, measured, &mut self.watched);
        self.controller.torque(model, reference, measured).map(|torque| torque.tau)
    }

    fn watched(&self) -> &[f64] {
        &self.watched
    }

    fn as_linearised_at_rest(&self) -> &dyn LineariseAtRest<W, R, N> {
        &self.controller
    }

    fn analyse_motion(
        &self,
        analysis: &MotionAnalysis<'_, W, f64, N>,
        model: &R,
        operational: &[OperationalReference<f64>],
    ) -> Result<MotionReport<f64>, StabilityError> {
        analysis.of(model, &self.controller, C::Reference::of(analysis.joints, operational))
    }
}

/// The control law of a run: sampled, or adaptive in continuous time.
enum Drive<'a, R, W, const N: usize, const P: usize> {
    Sampled(Box<dyn SampledLaw<R, W, N, P> + 'a>),
    Continuous(Adaptive<f64, N, P>),
}

/// A run with its analysis.
struct Prepared<'a, R, W, const N: usize, const M: usize, const P: usize> {
    arm: &'a Instance<R, W, N, M, P>,
    run: &'a ControlRun,
    body: &'a Body,
    /// The start.
    start: SVector<f64, N>,
    drive: Drive<'a, R, W, N, P>,
    /// Joint references, a reference per sample.
    joints: Vec<JointReference<f64, N>>,
    operational: Vec<OperationalReference<f64>>,
    analysis: Analysis,
    /// The spectral radius with a sample of delay, if an expectation needs it.
    delayed: Option<f64>,
}

/// Stability of the sampled loop.
struct Analysis {
    /// At rest and in motion.
    report: Report<f64>,
    /// Linearised about the initial estimate.
    at_start: Report<f64>,
    /// For an unstable loop: the largest stable period of [`SHORTER`], if any, and the shortest period tried; s.
    holds_at: Option<(Option<f64>, f64)>,
}

/// The references for every sample, and some postures along the path.
type Desired<const N: usize> = (Vec<JointReference<f64, N>>, Vec<OperationalReference<f64>>, Vec<SVector<f64, N>>);

impl<R, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
{
    /// Computes the joint reference, and analyses the stability of the sampled loop along the path.
    pub(super) fn prepare_control<'a>(
        &'a self,
        run: &'a ControlRun,
        experiment: &'a Experiment,
    ) -> Result<Box<dyn Run + 'a>, String> {
        let begins = self.start(&run.start, &run.sampling)?;
        let (joints, operational, postures) = self.desired(run, begins, run.sampling.period)?;
        let period = run.sampling.period.as_secs_f64();
        let refused = |error: SettingError| format!("the controller is refused: {error}");
        let drive = match run.continuous {
            true => Drive::Continuous(adaptive(&run.law, period).map_err(refused)?),
            false => Drive::Sampled(self.sampled_law(&run.law, period).map_err(refused)?),
        };
        let plant = (self.with_parameters)(&self.nominal, padded(&run.plant, 0.0));
        let no_answer = |error: StabilityError| format!("the loop cannot be linearised: {error}");
        let at_rest: &dyn LineariseAtRest<W, R, N> = match &drive {
            Drive::Sampled(law) => law.as_linearised_at_rest(),
            Drive::Continuous(law) => law,
        };
        let rest =
            |delay: usize| analyse(&plant, &self.nominal, at_rest, &postures, period, Delay::samples(delay)).map_err(no_answer);
        let at_start =
            analyse_start(&plant, &self.nominal, at_rest, &postures, period, Delay::samples(run.delay)).map_err(no_answer)?;
        let asked = experiment.expect.iter().any(|e| e.channel.quantity == Quantity::DelayedSpectralRadius);
        let delayed = if asked {
            let delay = Delay::samples(1);
            Some(analyse_start(&plant, &self.nominal, at_rest, &postures, period, delay).map_err(no_answer)?.spectral_radius)
        } else {
            None
        };
        let mut report = rest(run.delay)?;
        if let Drive::Sampled(law) = &drive {
            let analysis = Self::motion_analysis(run, begins, &plant, &joints, period);
            // If the analysis in motion fails, the report still has the analysis at rest.
            report.motion = law.analyse_motion(&analysis, &self.nominal, &operational).ok();
        }
        let holds_at = if report.holds() || run.continuous { None } else { Some(self.shorter(run, begins, &plant, &postures)) };
        let analysis = Analysis { report, at_start, holds_at };
        Ok(Box::new(Prepared {
            arm: self,
            run,
            body: &experiment.body,
            start: begins,
            drive,
            joints,
            operational,
            analysis,
            delayed,
        }))
    }

    fn motion_analysis<'r>(
        run: &ControlRun,
        begins: SVector<f64, N>,
        plant: &'r W,
        joints: &'r [JointReference<f64, N>],
        period: f64,
    ) -> MotionAnalysis<'r, W, f64, N> {
        MotionAnalysis { plant, joints, start: State::at_rest(begins), period, delay: Delay::samples(run.delay) }
    }

    /// The largest stable period of [`SHORTER`], s, and the shortest that was tried.
    fn shorter(&self, run: &ControlRun, begins: SVector<f64, N>, plant: &W, postures: &[SVector<f64, N>]) -> (Option<f64>, f64) {
        let mut shortest = run.sampling.period.as_secs_f64();
        for part in SHORTER {
            let period = run.sampling.period / part;
            if period.is_zero() || run.sampling.duration.as_nanos() / period.as_nanos() > MAX_REHEARSED {
                break;
            }
            shortest = period.as_secs_f64();
            let delay = Delay::samples(run.delay);
            let holds = || {
                let law = self.sampled_law(&run.law, shortest).ok()?;
                let mut report = analyse(plant, &self.nominal, law.as_linearised_at_rest(), postures, shortest, delay).ok()?;
                if report.is_stable() {
                    let (joints, operational, _) = self.desired(run, begins, period).ok()?;
                    let analysis = Self::motion_analysis(run, begins, plant, &joints, shortest);
                    report.motion = Some(law.analyse_motion(&analysis, &self.nominal, &operational).ok()?);
                }
                Some(report.holds())
            };
            if holds() == Some(true) {
                return (Some(shortest), shortest);
            }
        }
        (None, shortest)
    }

    fn desired(&self, run: &ControlRun, begins: SVector<f64, N>, period: Duration) -> Result<Desired<N>, String> {
        let trajectory = &run.sampling.motion.trajectory;
        let ReferenceGains { proportional, derivative } = &run.reference;
        let clik = self.second_order((proportional, derivative), period.as_secs_f64(), Integration::HoldConsistent);
        let clik = clik.map_err(|error| format!("the gains of the reference are refused: {error}"))?;
        let mut state = State::at_rest(begins);
        let (mut joints, mut operational, mut postures) = (Vec::new(), Vec::new(), Vec::new());
        let (mut t, mut next_posture) = (Duration::ZERO, Duration::ZERO);
        while t <= run.sampling.duration {
            let sample = trajectory.sample(t);
            let step = clik.step(&self.nominal, &state, &sample);
            let step = step.map_err(|error| format!("the joint reference ends at {} s: {error}", t.as_secs_f64()))?;
            joints.push(step.reference);
            operational.push(sample);
            if t >= next_posture && t <= trajectory.duration() {
                postures.push(state.q);
                next_posture += POSTURE_STEP;
            }
            state = step.next;
            t += period;
        }
        Ok((joints, operational, postures))
    }

    /// The controller of a law. A new controller also needs a `ControlLawKind` (model/law.rs), and in the runtime `Linearise`,
    /// `LineariseAtRest` and `LineariseInMotion`.
    fn sampled_law<'a>(&self, law: &ControlLaw, period: f64) -> Result<Box<dyn SampledLaw<R, W, N, P> + 'a>, SettingError>
    where
        R: 'a,
        W: 'a,
    {
        let limits = limits(law)?;
        let scalar = |key: &str| law.gain(key).first().copied().unwrap_or(f64::NAN);
        Ok(match law.kind {
            ControlLawKind::PdGravity => {
                let controller = PdGravity::new(sized(law.gain("k_p")), sized(law.gain("k_d")))?;
                unwatched(limits.map_or(controller, |l| controller.with_torque_limits(l)))
            }
            ControlLawKind::InverseDynamics => {
                let controller = InverseDynamics::new(sized(law.gain("k_p")), sized(law.gain("k_d")))?;
                unwatched(limits.map_or(controller, |l| controller.with_torque_limits(l)))
            }
            ControlLawKind::Robust => {
                let [k_p, k_d, p_position, p_velocity] =
                    ["k_p", "k_d", "p_position", "p_velocity"].map(|key| sized(law.gain(key)));
                let layer = BoundaryLayer { rho: scalar("rho"), epsilon: scalar("epsilon") };
                let controller = Robust::new(k_p, k_d, p_position, p_velocity, layer)?;
                let controller = limits.map_or(controller, |l| controller.with_torque_limits(l));
                let z_norm = |c: &Robust<f64, N>, reference: &_, measured: &State<f64, N>, watched: &mut Vec<f64>| {
                    watched.push(c.z(reference, measured).norm());
                };
                Box::new(Watched { controller, watch: z_norm, watched: Vec::new() })
            }
            ControlLawKind::Adaptive => {
                let estimate = |c: &Adaptive<f64, N, P>, _: &_, _: &State<f64, N>, watched: &mut Vec<f64>| {
                    watched.extend(c.estimate().iter());
                };
                Box::new(Watched { controller: adaptive(law, period)?, watch: estimate, watched: Vec::new() })
            }
            ControlLawKind::OperationalSpace => {
                let [k_p, k_d, k_i] = ["k_p", "k_d", "k_i"].map(|key| sized(law.gain(key)));
                let controller = OperationalSpace::new(self.task, k_p, k_d, k_i, period)?;
                unwatched(limits.map_or(controller, |l| controller.with_torque_limits(l)))
            }
            ControlLawKind::Limited => {
                let [k_p, k_d, k_i] = ["k_p", "k_d", "k_i"].map(|key| sized(law.gain(key)));
                let controller = OperationalSpace::new(self.task, k_p, k_d, k_i, period)?;
                let range =
                    |side: usize| std::array::from_fn(|i| self.robot.joints.get(i).map_or(f64::NAN, |of| of.position[side]));
                let joints = JointLimits::rates(sized(law.gain("rate_limits")))?.with_range(range(0), range(1))?;
                let joints = joints.with_acceleration(sized(law.gain("acceleration_limits")))?;
                let free = || TorqueLimits::new([f64::INFINITY; N]);
                let torques = limits.map_or_else(free, Ok)?;
                unwatched(Limited::new(controller, torques, joints, scalar("horizon"), scalar("braking"))?)
            }
        })
    }
}

/// A controller without watched values.
fn unwatched<'a, R, W, C, const N: usize, const P: usize>(controller: C) -> Box<dyn SampledLaw<R, W, N, P> + 'a>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
    C: LineariseAtRest<W, R, N> + LineariseInMotion<W, R, N> + Send + 'a,
    C::Reference: OfKind<N>,
{
    let nothing = |_: &C, _: &C::Reference, _: &State<f64, N>, _: &mut Vec<f64>| {};
    Box::new(Watched { controller, watch: nothing, watched: Vec::new() })
}

fn limits<const N: usize>(law: &ControlLaw) -> Result<Option<TorqueLimits<f64, N>>, SettingError> {
    law.torque_limits.as_deref().map(|bound| TorqueLimits::new(sized(bound))).transpose()
}

fn adaptive<const N: usize, const P: usize>(law: &ControlLaw, period: f64) -> Result<Adaptive<f64, N, P>, SettingError> {
    let [lambda, k_d] = ["lambda", "k_d"].map(|key| sized(law.gain(key)));
    let adaptation = &law.adaptation;
    let mut controller = Adaptive::new(lambda, k_d, padded(law.gain("k_pi"), 1.0), padded(&adaptation.estimate, 0.0), period)?;
    if let Some(limits) = limits(law)? {
        controller = controller.with_torque_limits(limits);
    }
    if let Some(EstimateBounds { lowest, highest }) = &adaptation.bounds {
        controller = controller.with_projection(Interval::new(padded(lowest, 0.0), padded(highest, 0.0))?);
    }
    Ok(if adaptation.is_on { controller } else { controller.with_frozen([true; P]) })
}

/// The reasons why a controller stops.
#[derive(Debug)]
enum Stop {
    Control(ControlError),
    /// The error of this joint exceeds [`ABORT_ERROR`].
    GivenUp(usize),
}

/// Ends the run if a joint error exceeds the abort limit.
fn off<const N: usize>(desired: &SVector<f64, N>, found: &SVector<f64, N>) -> Result<(), Stop> {
    let error = (desired - found).abs();
    let joint = error.imax();
    // The run itself detects values that are not finite.
    if error[joint] > ABORT_ERROR && error[joint].is_finite() {
        return Err(Stop::GivenUp(joint));
    }
    Ok(())
}

/// The early end of a run. `lost_at` reports it if a joint was given up or diverged, and if the arm itself was lost, not only its
/// measurement.
fn ended(error: RunError<Stop>, is_lost: bool, robot: &Robot) -> Ended {
    use Divergence::{Position, Rate};
    let of_a_joint = match &error {
        RunError::Controller { error: Stop::GivenUp(_), .. } => true,
        RunError::Diverged { divergence, .. } => matches!(divergence, Rate(_) | Position(_)),
        _ => false,
    };
    Ended { why: explain(error, robot), told_by: (of_a_joint && is_lost).then_some(Quantity::LostAt) }
}

/// The reason and the time of an early end, with the joint.
fn explain(error: RunError<Stop>, robot: &Robot) -> String {
    let s = |t: Duration| format!("{} s", number(t.as_secs_f64()));
    let joint = |i: usize| (format!("joint `{}`", robot.joints[i].name), &robot.joints[i]);
    match error {
        RunError::Controller { time, error: Stop::GivenUp(i) } => {
            let (name, joint) = joint(i);
            format!("given up at {}: {name} is off by more than {ABORT_ERROR} {}", s(time), joint.unit())
        }
        RunError::Controller { time, error: Stop::Control(error) } => format!("no torque at {}: {error}", s(time)),
        RunError::Diverged { time, divergence } => {
            let divergence = match divergence {
                Divergence::Rate(i) => format!("{} passed {DIVERGENCE_BOUND:e} {}", joint(i).0, joint(i).1.rate_unit()),
                Divergence::Position(i) => format!("{} passed {DIVERGENCE_BOUND:e} {}", joint(i).0, joint(i).1.unit()),
                Divergence::ControllerState => divergence.to_string(),
            };
            format!("diverged at {}: {divergence}", s(time))
        }
        RunError::Integrator { time, error } => format!("not integrable at {}: {error}", s(time)),
        RunError::NoPeriod => "the sampling period is zero".to_owned(),
    }
}

impl<R, W, const N: usize, const M: usize, const P: usize> Run for Prepared<'_, R, W, N, M, P>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
{
    /// The warning about an unstable loop: at rest, in motion, and a stable period.
    fn warning(&self) -> Option<String> {
        let Analysis { report, holds_at, .. } = &self.analysis;
        let delay = match self.run.delay {
            0 => String::new(),
            1 => " with a delay of one sample".to_owned(),
            samples => format!(" with a delay of {samples} samples"),
        };
        let mut said = Vec::new();
        if !report.is_stable() {
            let holds = match report.period {
                StablePeriod::UpTo(limit) => format!("a period up to {} ms would hold", number((limit * 1e7).round() / 1e4)),
                StablePeriod::AtLeast(limit) => format!("it holds at {} ms", number(limit * 1e3)),
                StablePeriod::NotEvenAt(limit) => format!("not even {} ms would hold", number((limit * 1e7).round() / 1e4)),
            };
            // Two decimals; more if two decimals would show 1.00.
            let radius = report.spectral_radius;
            let radius = if radius < 1.005 { format!("{radius:.6}") } else { format!("{radius:.2}") };
            said.push(match report.without_rest {
                Some(_) => "cannot rest on its path: the gains do not hold what the model leaves out".to_owned(),
                None => format!("unstable at rest: spectral radius {radius}; {holds}"),
            });
        }
        let seconds = |t: f64| number((t * 1e4).round() / 1e4);
        if let Some(motion) = report.motion.filter(MotionReport::diverges) {
            said.push(match motion.lost {
                Some(lost) => {
                    let joint = &self.arm.robot.joints[lost.joint].name;
                    format!("diverges in motion: simulated without noise, joint `{joint}` is lost at {} s", seconds(lost.at))
                }
                None => format!(
                    "diverges in motion: a small deviation grows by a factor of {:.0e} within {} s",
                    motion.growth.largest,
                    seconds(motion.growth.at)
                ),
            });
        }
        if said.is_empty() {
            return None;
        }
        if let (true, Some((holds, shortest))) = (report.motion.is_some_and(|motion| motion.diverges()), holds_at) {
            said.push(match holds {
                Some(period) => format!("at {} ms it holds at rest and in motion", number(period * 1e3)),
                None => format!("nor does it hold at {} ms", number(shortest * 1e3)),
            });
        }
        let period = number(self.run.sampling.period.as_secs_f64() * 1e3);
        let then = if self.run.continuous { "; it runs in continuous time" } else { "" };
        Some(format!("sampled at {period} ms{delay}, {}{then}", said.join("; ")))
    }

    fn run(self: Box<Self>) -> Record {
        let Prepared {
            arm,
            run,
            body,
            start: begins,
            drive,
            joints,
            operational,
            analysis: Analysis { report, at_start, .. },
            delayed,
        } = *self;
        let mut writer = Writer {
            arm,
            begins,
            joints: &joints,
            operational: &operational,
            record: Record::new(body.channels(&arm.robot)),
            lost_at: f64::INFINITY,
            is_lost: false,
        };
        writer.record.peaks = vec![Peak::default(); N];
        let begun = Instant::now();
        let is_sampled = matches!(drive, Drive::Sampled(_));
        let outcome = match drive {
            Drive::Sampled(law) => writer.sampled(run, law),
            Drive::Continuous(law) => writer.continuous(run, &law),
        };
        let took = begun.elapsed().as_secs_f64();
        let Writer { mut record, lost_at, is_lost, .. } = writer;
        let limit = |report: &Report<f64>| match report.period {
            StablePeriod::UpTo(limit) | StablePeriod::AtLeast(limit) | StablePeriod::NotEvenAt(limit) => limit,
        };
        let motion = |of: fn(MotionReport<f64>) -> f64| report.motion.map_or(f64::NAN, of);
        let value = |quantity: Quantity| match quantity {
            Quantity::SpectralRadius => at_start.spectral_radius,
            Quantity::StablePeriod => limit(&at_start),
            Quantity::RestRadius => report.spectral_radius,
            Quantity::RestPeriod => limit(&report),
            Quantity::MotionGrowth => motion(|motion| motion.growth.largest),
            Quantity::MotionRate => motion(|motion| motion.growth.rate),
            Quantity::MotionLostAt => motion(|motion| motion.lost.map_or(f64::INFINITY, |lost| lost.at)),
            Quantity::DelayedSpectralRadius => delayed.unwrap_or(f64::NAN),
            Quantity::LostAt => lost_at,
            _ => f64::NAN,
        };
        record.numbers = body.numbers(&arm.robot).into_iter().map(|channel| (channel.clone(), value(channel.quantity))).collect();
        record.ended = outcome.err().map(|error| ended(error, is_lost, &arm.robot));
        if is_sampled {
            record.speed = Speed { simulated: record.end(), took };
        }
        record
    }
}

/// Runs the arm and writes the log.
struct Writer<'a, R, W, const N: usize, const M: usize, const P: usize> {
    arm: &'a Instance<R, W, N, M, P>,
    begins: SVector<f64, N>,
    joints: &'a [JointReference<f64, N>],
    operational: &'a [OperationalReference<f64>],
    record: Record,
    lost_at: f64,
    /// Whether a joint error exceeds [`LARGE_ERROR`] in the last sample.
    is_lost: bool,
}

impl<R, W, const N: usize, const M: usize, const P: usize> Writer<'_, R, W, N, M, P>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
{
    fn write(&mut self, index: usize, t: Duration, state: &State<f64, N>, tau: &SVector<f64, N>, watched: &[f64]) {
        let Writer { arm, joints, operational, record, lost_at, is_lost, .. } = self;
        for (i, peak) in record.peaks.iter_mut().enumerate() {
            *peak = Peak { rate: peak.rate.max(state.dq[i].abs()), effort: peak.effort.max(tau[i].abs()) };
        }
        let e = joints[index].q - state.q;
        *is_lost = e.amax() > LARGE_ERROR;
        if lost_at.is_infinite() && *is_lost {
            *lost_at = t.as_secs_f64();
        }
        let pose = Pose::of(&arm.nominal, &state.q);
        let task_error = arm.task.error(&operational[index].pose, &pose);
        record.sample(|quantity| match quantity {
            Quantity::Time => t.as_secs_f64(),
            Quantity::Joint(JointQuantity::Position, i) => state.q[i],
            Quantity::Joint(JointQuantity::Error, i) => e[i],
            Quantity::Joint(JointQuantity::Effort, i) => tau[i],
            Quantity::TaskError(row) => arm.robot.task.iter().position(|r| *r == row).map_or(f64::NAN, |i| task_error[i]),
            Quantity::Tip(axis) => pose.position[axis],
            Quantity::ZNorm => watched.first().copied().unwrap_or(f64::NAN),
            Quantity::Estimate(i) => watched.get(i).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        });
    }

    fn sampled(&mut self, run: &ControlRun, law: Box<dyn SampledLaw<R, W, N, P> + '_>) -> Result<(), RunError<Stop>> {
        let plant = (self.arm.with_parameters)(&self.arm.nominal, padded(&run.plant, 0.0));
        let mut options = RunOptions::new(run.sampling.period, run.sampling.duration);
        options.integrator = Integrator::RungeKutta4 { substeps: run.substeps };
        options.sensor = Sensor::new(run.delay, run.noise.position, run.noise.rate, u64::from(run.noise.seed));
        // The controller and the log use it in turn.
        let law = std::cell::RefCell::new(law);
        let (model, joints, operational, mut index) = (&self.arm.nominal, self.joints, self.operational, 0);
        let controller = |_: Duration, measured: &State<f64, N>| {
            let (joints, operational) = (&joints[index], &operational[index]);
            off(&joints.q, &measured.q)?;
            index += 1;
            law.borrow_mut().torque(model, joints, operational, measured).map_err(Stop::Control)
        };
        let end = simulate(&plant, State::at_rest(self.begins), options, controller, |sample| {
            self.write(sample.index as usize, sample.time, &sample.state, &sample.tau, law.borrow().watched());
        });
        end.map(|_| ())
    }

    fn continuous(&mut self, run: &ControlRun, controller: &Adaptive<f64, N, P>) -> Result<(), RunError<Stop>> {
        let plant = (self.arm.with_parameters)(&self.arm.nominal, padded(&run.plant, 0.0));
        let options = ContinuousOptions { period: run.sampling.period, duration: run.sampling.duration, substeps: run.substeps };
        let (model, joints) = (&self.arm.nominal, self.joints);
        let law = |k: u64, t: f64, state: &State<f64, N>, estimate: &SVector<f64, P>| {
            let reference = joints[k as usize].held(t);
            off(&reference.q, &state.q)?;
            let step = controller.law(model, &reference, state, estimate).map_err(Stop::Control);
            step.map(|(torque, rate)| (torque.tau, rate))
        };
        let start = State::at_rest(self.begins);
        let end = run_continuous(&plant, start, *controller.estimate(), options, law, |sample| {
            let tau = law(sample.index, 0.0, &sample.state, &sample.controller_state).map_or(SVector::zeros(), |(tau, _)| tau);
            self.write(sample.index as usize, sample.time, &sample.state, &tau, sample.controller_state.as_slice());
        });
        end.map(|_| ())
    }
}
