//! A controller along a path: first its sampled loop, linearised; then the run, with a plant that has parameters of its own.

use std::fmt;
use std::time::{Duration, Instant};

use armgen_runtime::clik::Integration;
use armgen_runtime::control::{
    Adaptive, BoundaryLayer, ControlError, Controller, Interval, InverseDynamics, OperationalSpace, PdGravity, Robust,
    TorqueLimits,
};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::parameters::ParameterError;
use armgen_runtime::reference::{JointReference, OperationalReference, Pose, State};
use armgen_runtime::simulation::{run as simulate, run_continuous, ContinuousOptions, Integrator, RunError, RunOptions, Sensor};
use armgen_runtime::stability::{analyse, Delay, Linearise, Report, StablePeriod};

use super::instance::{sized, Functions};
use super::{Instance, Run};
use crate::model::{number, Body, ControlRun, Experiment, JointQuantity, Law, LawKind, Quantity, Record, Speed};

/// Distance between the postures at which the loop is linearised.
const POSTURE_STEP: Duration = Duration::from_millis(250);
/// An error of a joint, rad or m, from which on the arm counts as lost, and one at which the run ends.
const LOST: f64 = 0.1;
const GIVEN_UP: f64 = 1.0;

/// A sampled controller behind a pointer, so that linearisation and simulation are compiled once for all of them.
trait SampledLaw<R: Functions<N, P>, const N: usize, const P: usize>: Send {
    /// The torque of one sample: which of the two references counts is the controller's affair.
    fn torque(
        &mut self,
        model: &R,
        joints: &JointReference<f64, N>,
        tip: &OperationalReference<f64>,
        measured: &State<f64, N>,
    ) -> Result<SVector<f64, N>, ControlError>;

    /// What it told before the last torque, in the order of [`LawKind::watched`].
    fn watched(&self) -> &[f64];

    fn linearised(&self) -> &dyn Linearise<R, N>;
}

/// A reference as one of those of a sample.
trait OfSample<const N: usize> {
    fn of<'s>(joints: &'s JointReference<f64, N>, tip: &'s OperationalReference<f64>) -> &'s Self;
}

impl<const N: usize> OfSample<N> for JointReference<f64, N> {
    fn of<'s>(joints: &'s JointReference<f64, N>, _: &'s OperationalReference<f64>) -> &'s Self {
        joints
    }
}

impl<const N: usize> OfSample<N> for OperationalReference<f64> {
    fn of<'s>(_: &'s JointReference<f64, N>, tip: &'s OperationalReference<f64>) -> &'s Self {
        tip
    }
}

/// A controller, and what it tells of a sample.
struct Watched<C, F> {
    controller: C,
    watch: F,
    watched: Vec<f64>,
}

impl<R, C, F, const N: usize, const P: usize> SampledLaw<R, N, P> for Watched<C, F>
where
    R: Functions<N, P>,
    C: Controller<R, N> + Linearise<R, N> + Send,
    C::Reference: OfSample<N>,
    F: Fn(&C, &C::Reference, &State<f64, N>, &mut Vec<f64>) + Send,
{
    fn torque(
        &mut self,
        model: &R,
        joints: &JointReference<f64, N>,
        tip: &OperationalReference<f64>,
        measured: &State<f64, N>,
    ) -> Result<SVector<f64, N>, ControlError> {
        let reference = C::Reference::of(joints, tip);
        self.watched.clear();
        (self.watch)(&self.controller, reference, measured, &mut self.watched);
        self.controller.torque(model, reference, measured).map(|torque| torque.tau)
    }

    fn watched(&self) -> &[f64] {
        &self.watched
    }

    fn linearised(&self) -> &dyn Linearise<R, N> {
        &self.controller
    }
}

/// The law of a run: a sampled one, or the adaptive one in continuous time.
enum Drive<'a, R, const N: usize, const P: usize> {
    Sampled(Box<dyn SampledLaw<R, N, P> + 'a>),
    Continuous(Adaptive<f64, N, P>),
}

/// A run of which is known what can be known before anything moves.
struct Prepared<'a, R, W, const N: usize, const M: usize, const P: usize> {
    arm: &'a Instance<R, W, N, M, P>,
    run: &'a ControlRun,
    body: &'a Body,
    drive: Drive<'a, R, N, P>,
    /// What is desired at each sample.
    joints: Vec<JointReference<f64, N>>,
    tip: Vec<OperationalReference<f64>>,
    report: Report<f64>,
    /// The radius with one sample of delay, where it is asked for.
    delayed: Option<f64>,
}

/// What is desired at every sample, and some postures on the way.
type Desired<const N: usize> = (Vec<JointReference<f64, N>>, Vec<OperationalReference<f64>>, Vec<SVector<f64, N>>);

impl<R, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
{
    /// The joint reference, and the stability of the sampled loop along the path.
    pub(super) fn prepare_control<'a>(
        &'a self,
        run: &'a ControlRun,
        experiment: &'a Experiment,
    ) -> Result<Box<dyn Run + 'a>, String> {
        let (joints, tip, postures) = self.desired(run)?;
        let period = run.sampling.period.as_secs_f64();
        let refused = |error: ParameterError| format!("the controller is refused: {error}");
        let drive = match run.continuous {
            true => Drive::Continuous(adaptive(&run.law, period).map_err(refused)?),
            false => Drive::Sampled(self.sampled_law(&run.law, period).map_err(refused)?),
        };
        let linearised = match &drive {
            Drive::Sampled(law) => law.linearised(),
            Drive::Continuous(law) => law,
        };
        let report = |delay: usize| {
            let plant = (self.with_parameters)(sized(&run.plant));
            analyse(&plant, &self.nominal, linearised, &postures, period, Delay::samples(delay))
                .map_err(|error| format!("the loop cannot be linearised: {error}"))
        };
        let asked = experiment.expect.iter().any(|e| e.channel.quantity == Quantity::DelayedSpectralRadius);
        let delayed = if asked { Some(report(1)?.radius) } else { None };
        let report = report(run.delay)?;
        Ok(Box::new(Prepared { arm: self, run, body: &experiment.body, drive, joints, tip, report, delayed }))
    }

    fn desired(&self, run: &ControlRun) -> Result<Desired<N>, String> {
        let (period, trajectory) = (run.sampling.period, &run.sampling.motion.trajectory);
        let gains = (run.reference.0.as_slice(), run.reference.1.as_slice());
        let clik = self.second_order(gains, period.as_secs_f64(), Integration::HoldConsistent);
        let clik = clik.map_err(|error| format!("the gains of the reference are refused: {error}"))?;
        let mut state = State::at_rest(Self::joints(&run.start));
        let (mut joints, mut tip, mut postures) = (Vec::new(), Vec::new(), Vec::new());
        let (mut t, mut next_posture) = (Duration::ZERO, Duration::ZERO);
        while t <= run.sampling.duration {
            let sample = trajectory.sample(t);
            let step = clik.step(&self.nominal, &state, &sample);
            let step = step.map_err(|error| format!("the joint reference ends at {} s: {error}", t.as_secs_f64()))?;
            joints.push(step.reference);
            tip.push(sample);
            if t >= next_posture && t <= trajectory.duration() {
                postures.push(state.q);
                next_posture += POSTURE_STEP;
            }
            state = step.next;
            t += period;
        }
        Ok((joints, tip, postures))
    }

    /// The controller of a law: the one place that knows all of them.
    fn sampled_law<'a>(&self, law: &Law, period: f64) -> Result<Box<dyn SampledLaw<R, N, P> + 'a>, ParameterError>
    where
        R: 'a,
    {
        let limits = limits(law)?;
        let scalar = |key: &str| law.gain(key).first().copied().unwrap_or(f64::NAN);
        Ok(match law.kind {
            LawKind::PdGravity => {
                let controller = PdGravity::new(sized(law.gain("k_p")), sized(law.gain("k_d")))?;
                unwatched(limits.map_or(controller, |l| controller.with_torque_limits(l)))
            }
            LawKind::InverseDynamics => {
                let controller = InverseDynamics::new(sized(law.gain("k_p")), sized(law.gain("k_d")))?;
                unwatched(limits.map_or(controller, |l| controller.with_torque_limits(l)))
            }
            LawKind::Robust => {
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
            LawKind::Adaptive => {
                let estimate = |c: &Adaptive<f64, N, P>, _: &_, _: &State<f64, N>, watched: &mut Vec<f64>| {
                    watched.extend(c.estimate().iter());
                };
                Box::new(Watched { controller: adaptive(law, period)?, watch: estimate, watched: Vec::new() })
            }
            LawKind::OperationalSpace => {
                let [k_p, k_d, k_i] = ["k_p", "k_d", "k_i"].map(|key| sized(law.gain(key)));
                let controller = OperationalSpace::new(self.task, k_p, k_d, k_i, period)?;
                unwatched(limits.map_or(controller, |l| controller.with_torque_limits(l)))
            }
        })
    }
}

/// A controller that has nothing to tell.
fn unwatched<'a, R, C, const N: usize, const P: usize>(controller: C) -> Box<dyn SampledLaw<R, N, P> + 'a>
where
    R: Functions<N, P>,
    C: Controller<R, N> + Linearise<R, N> + Send + 'a,
    C::Reference: OfSample<N>,
{
    let nothing = |_: &C, _: &C::Reference, _: &State<f64, N>, _: &mut Vec<f64>| {};
    Box::new(Watched { controller, watch: nothing, watched: Vec::new() })
}

fn limits<const N: usize>(law: &Law) -> Result<Option<TorqueLimits<f64, N>>, ParameterError> {
    law.torque_limits.as_deref().map(|bound| TorqueLimits::new(sized(bound))).transpose()
}

fn adaptive<const N: usize, const P: usize>(law: &Law, period: f64) -> Result<Adaptive<f64, N, P>, ParameterError> {
    let [lambda, k_d] = ["lambda", "k_d"].map(|key| sized(law.gain(key)));
    let adaptation = &law.adaptation;
    let mut controller = Adaptive::new(lambda, k_d, sized(law.gain("k_pi")), sized(&adaptation.estimate), period)?;
    if let Some(limits) = limits(law)? {
        controller = controller.with_torque_limits(limits);
    }
    if let Some((lowest, highest)) = &adaptation.bounds {
        controller = controller.with_projection(Interval::new(sized(lowest), sized(highest))?);
    }
    Ok(if adaptation.is_on { controller } else { controller.with_frozen([true; P]) })
}

/// Why a controller gives no torque any more.
#[derive(Debug)]
enum Stop {
    Control(ControlError),
    GivenUp,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stop::Control(error) => error.fmt(f),
            Stop::GivenUp => write!(f, "a joint is off by more than {GIVEN_UP} rad or m"),
        }
    }
}

/// Why a run ended, and when.
fn explain(error: RunError<Stop>) -> String {
    let ms = |t: Duration| number(t.as_secs_f64() * 1e3);
    match error {
        RunError::Controller { time, error: error @ Stop::GivenUp } => format!("given up after {} ms: {error}", ms(time)),
        RunError::Controller { time, error } => format!("no torque after {} ms: {error}", ms(time)),
        RunError::Diverged { time } => format!("diverged after {} ms", ms(time)),
        RunError::Integrator { time, error } => format!("not integrable after {} ms: {error}", ms(time)),
        RunError::NoPeriod => error.to_string(),
    }
}

impl<R, W, const N: usize, const M: usize, const P: usize> Run for Prepared<'_, R, W, N, M, P>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
{
    /// What has to be said of an unstable loop: its radius and the period that would hold.
    fn warning(&self) -> Option<String> {
        if self.report.is_stable() {
            return None;
        }
        let period = number(self.run.sampling.period.as_secs_f64() * 1e3);
        let holds = match self.report.period {
            StablePeriod::UpTo(limit) => format!("a period up to {} ms would hold", number((limit * 1e7).round() / 1e4)),
            StablePeriod::AtLeast(limit) => format!("it holds at {} ms", number(limit * 1e3)),
            StablePeriod::NotEvenAt(limit) => format!("not even {} ms would hold", number(limit * 1e3)),
        };
        let delay = match self.run.delay {
            0 => String::new(),
            1 => " with a delay of one sample".to_owned(),
            samples => format!(" with a delay of {samples} samples"),
        };
        // Two decimals, more where these would say 1.00.
        let radius = self.report.radius;
        let radius = if radius < 1.005 { format!("{radius:.6}") } else { format!("{radius:.2}") };
        let then = if self.run.continuous { "; it runs in continuous time" } else { "" };
        Some(format!("unstable when sampled at {period} ms{delay}: spectral radius {radius}; {holds}{then}"))
    }

    fn run(self: Box<Self>) -> Record {
        let Prepared { arm, run, body, drive, joints, tip, report, delayed } = *self;
        let mut writer =
            Writer { arm, joints: &joints, tip: &tip, record: Record::new(body.channels(&arm.robot)), lost_at: f64::INFINITY };
        let begun = Instant::now();
        let is_sampled = matches!(drive, Drive::Sampled(_));
        let outcome = match drive {
            Drive::Sampled(law) => writer.sampled(run, law),
            Drive::Continuous(law) => writer.continuous(run, &law),
        };
        let took = begun.elapsed().as_secs_f64();
        let Writer { mut record, lost_at, .. } = writer;
        let (StablePeriod::UpTo(limit) | StablePeriod::AtLeast(limit) | StablePeriod::NotEvenAt(limit)) = report.period;
        let value = |quantity: Quantity| match quantity {
            Quantity::SpectralRadius => report.radius,
            Quantity::StablePeriod => limit,
            Quantity::DelayedSpectralRadius => delayed.unwrap_or(f64::NAN),
            Quantity::LostAt => lost_at,
            _ => f64::NAN,
        };
        record.numbers = body.numbers(&arm.robot).into_iter().map(|channel| (channel.clone(), value(channel.quantity))).collect();
        record.ended = outcome.err().map(explain);
        if is_sampled {
            record.speed = Speed { simulated: record.end(), took };
        }
        record
    }
}

/// Drives the arm and writes the log.
struct Writer<'a, R, W, const N: usize, const M: usize, const P: usize> {
    arm: &'a Instance<R, W, N, M, P>,
    joints: &'a [JointReference<f64, N>],
    tip: &'a [OperationalReference<f64>],
    record: Record,
    lost_at: f64,
}

impl<R, W, const N: usize, const M: usize, const P: usize> Writer<'_, R, W, N, M, P>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
{
    fn write(&mut self, index: usize, t: Duration, state: &State<f64, N>, tau: &SVector<f64, N>, watched: &[f64]) {
        let Writer { arm, joints, tip, record, lost_at } = self;
        let e = joints[index].q - state.q;
        if lost_at.is_infinite() && e.amax() > LOST {
            *lost_at = t.as_secs_f64();
        }
        let pose = Pose::of(&arm.nominal, &state.q);
        let tip_error = arm.task.error(&tip[index].pose, &pose);
        record.sample(|quantity| match quantity {
            Quantity::Time => t.as_secs_f64(),
            Quantity::Joint(JointQuantity::Position, i) => state.q[i],
            Quantity::Joint(JointQuantity::Error, i) => e[i],
            Quantity::Joint(JointQuantity::Effort, i) => tau[i],
            Quantity::TaskError(row) => arm.robot.task.iter().position(|r| *r == row).map_or(f64::NAN, |i| tip_error[i]),
            Quantity::Tip(axis) => pose.position[axis],
            Quantity::ZNorm => watched.first().copied().unwrap_or(f64::NAN),
            Quantity::Estimate(i) => watched.get(i).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        });
    }

    fn sampled(&mut self, run: &ControlRun, law: Box<dyn SampledLaw<R, N, P> + '_>) -> Result<(), RunError<Stop>> {
        let plant = (self.arm.with_parameters)(sized(&run.plant));
        let mut options = RunOptions::new(run.sampling.period, run.sampling.duration);
        options.integrator = Integrator::RungeKutta4 { substeps: run.substeps };
        options.sensor = Sensor::new(run.delay, run.noise.position, run.noise.rate, u64::from(run.noise.seed));
        // Both the controller and the log look at it, one after the other.
        let law = std::cell::RefCell::new(law);
        let (model, joints, tip, mut index) = (&self.arm.nominal, self.joints, self.tip, 0);
        let controller = |_: Duration, measured: &State<f64, N>| {
            let (joints, tip) = (&joints[index], &tip[index]);
            if (joints.q - measured.q).amax() > GIVEN_UP {
                return Err(Stop::GivenUp);
            }
            index += 1;
            law.borrow_mut().torque(model, joints, tip, measured).map_err(Stop::Control)
        };
        let end =
            simulate(&plant, State::at_rest(Instance::<R, W, N, M, P>::joints(&run.start)), options, controller, |sample| {
                self.write(sample.index as usize, sample.time, &sample.state, &sample.tau, law.borrow().watched());
            });
        end.map(|_| ())
    }

    fn continuous(&mut self, run: &ControlRun, controller: &Adaptive<f64, N, P>) -> Result<(), RunError<Stop>> {
        let plant = (self.arm.with_parameters)(sized(&run.plant));
        let options = ContinuousOptions { period: run.sampling.period, duration: run.sampling.duration, substeps: run.substeps };
        let (model, joints) = (&self.arm.nominal, self.joints);
        let law = |k: u64, t: f64, state: &State<f64, N>, estimate: &SVector<f64, P>| {
            let reference = joints[k as usize].held(t);
            if (reference.q - state.q).amax() > GIVEN_UP {
                return Err(Stop::GivenUp);
            }
            let step = controller.law(model, &reference, state, estimate).map_err(Stop::Control);
            step.map(|(torque, rate)| (torque.tau, rate))
        };
        let start = State::at_rest(Instance::<R, W, N, M, P>::joints(&run.start));
        let end = run_continuous(&plant, start, *controller.estimate(), options, law, |sample| {
            let tau = law(sample.index, 0.0, &sample.state, &sample.memory).map_or(SVector::zeros(), |(tau, _)| tau);
            self.write(sample.index as usize, sample.time, &sample.state, &tau, sample.memory.as_slice());
        });
        end.map(|_| ())
    }
}
