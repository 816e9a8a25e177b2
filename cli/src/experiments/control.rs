//! A controller along a path: first its sampled loop, linearised; then the run, with a plant that has parameters of its own.

use std::cell::RefCell;
use std::time::{Duration, Instant};

use armgen_generated::{Nominal, WithParameters, DOF, JOINT_NAMES, NOMINAL_PARAMETERS, PARAMETERS, PARAMETER_NAMES};
use armgen_runtime::clik::Integration;
use armgen_runtime::control::{Adaptive, ControlError};
use armgen_runtime::reference::{JointReference, OperationalReference, Pose, State};
use armgen_runtime::simulation::{
    run as simulate, run_continuous, ContinuousOptions, Integrator, Log, RunError, RunOptions, Sensor,
};
use armgen_runtime::stability::{analyse, Delay, Linearise, Report, StablePeriod};

use super::clik::second_order_of;
use super::expectation::number;
use super::file::{task, task_rows, ControlRun, Joints, Law};
use super::reader::row_name;
use super::record::Record;

/// Columns of the log: joint variables, errors of joints and of the task's rows, position of the tip, torques, and what the law has beside.
pub(crate) fn columns(run: &ControlRun) -> Vec<String> {
    let mut names = vec!["t".to_owned()];
    let joints = |prefix: &str| JOINT_NAMES.iter().map(|name| format!("{prefix}_{name}")).collect::<Vec<_>>();
    names.extend(joints("q"));
    names.extend(joints("eq"));
    names.extend(task_rows().iter().map(|row| format!("e_{}", row_name(*row))));
    names.extend(["x", "y", "z"].map(String::from));
    names.extend(joints("tau"));
    names.extend(extra_names(&run.law));
    names
}

fn extra_names(law: &Law) -> Vec<String> {
    match law {
        Law::Robust(_) => vec!["z_norm".to_owned()],
        Law::Adaptive(_) => PARAMETER_NAMES.iter().map(|name| format!("estimate_{name}")).collect(),
        _ => Vec::new(),
    }
}

/// The numbers of the whole run.
pub(crate) fn singles(_: &ControlRun) -> Vec<String> {
    ["radius", "stable_period", "radius_delayed", "lost_at"].map(String::from).to_vec()
}

/// What is known before anything moves.
#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    reference: Vec<JointReference<f64, DOF>>,
    desired: Vec<OperationalReference<f64>>,
    report: Report<f64>,
    delayed: Option<f64>,
}

impl Prepared {
    /// What has to be said of an unstable loop: its radius and the period that would hold.
    pub(crate) fn warning(&self, run: &ControlRun) -> Option<String> {
        if self.report.is_stable() {
            return None;
        }
        let period = number(run.sampling.period.as_secs_f64() * 1e3);
        let holds = match self.report.period {
            StablePeriod::UpTo(limit) => format!("a period up to {} ms would hold", number((limit * 1e7).round() / 1e4)),
            StablePeriod::AtLeast(limit) => format!("it holds at {} ms", number(limit * 1e3)),
            StablePeriod::NotEvenAt(limit) => format!("not even {} ms would hold", number(limit * 1e3)),
        };
        let delay = match run.delay {
            0 => String::new(),
            1 => " with a delay of one sample".to_owned(),
            samples => format!(" with a delay of {samples} samples"),
        };
        // Two decimals, more where these would say 1.00.
        let radius = self.report.radius;
        let radius = if radius < 1.005 { format!("{radius:.6}") } else { format!("{radius:.2}") };
        let then = if run.continuous.is_some() { "; it runs in continuous time" } else { "" };
        Some(format!("unstable when sampled at {period} ms{delay}: spectral radius {radius}; {holds}{then}"))
    }
}

/// Distance between the postures at which the loop is linearised.
const POSTURE_STEP: Duration = Duration::from_millis(250);

/// The joint reference, and the stability of the sampled loop along the path.
pub(crate) fn prepare(run: &ControlRun, delayed_too: bool) -> Result<Prepared, String> {
    let (period, trajectory) = (run.sampling.period, &run.sampling.motion.trajectory);
    let (k_p, k_d) = run.reference;
    let clik = second_order_of(k_p, k_d, period.as_secs_f64(), Integration::HoldConsistent)
        .map_err(|error| format!("the gains of the reference are refused: {error:?}"))?;
    let mut state = State::at_rest(run.start);
    let (mut reference, mut desired, mut postures) = (Vec::new(), Vec::new(), Vec::new());
    let (mut t, mut next_posture) = (Duration::ZERO, Duration::ZERO);
    while t <= run.sampling.duration {
        let sample = trajectory.sample(t);
        let step = clik.step(&Nominal, &state, &sample);
        let step = step.map_err(|error| format!("the joint reference ends at {} s: {error:?}", t.as_secs_f64()))?;
        reference.push(step.reference);
        desired.push(sample);
        if t >= next_posture && t <= trajectory.duration() {
            postures.push(state.q);
            next_posture += POSTURE_STEP;
        }
        state = step.next;
        t += period;
    }
    let delay = Delay::samples(run.delay);
    let of = |delay: Delay| match &run.law {
        Law::PdGravity(c) => stability(run, c, &postures, delay),
        Law::InverseDynamics(c) => stability(run, c, &postures, delay),
        Law::Robust(c) => stability(run, c, &postures, delay),
        Law::Adaptive(c) => stability(run, c.as_ref(), &postures, delay),
        Law::OperationalSpace(c) => stability(run, c.as_ref(), &postures, delay),
    };
    let report = of(delay)?;
    let delayed = if delayed_too { Some(of(Delay::samples(1))?.radius) } else { None };
    Ok(Prepared { reference, desired, report, delayed })
}

fn stability<C: Linearise<Nominal, DOF>>(
    run: &ControlRun,
    controller: &C,
    postures: &[Joints],
    delay: Delay,
) -> Result<Report<f64>, String> {
    let plant = WithParameters { parameters: run.plant };
    analyse(&plant, &Nominal, controller, postures, run.sampling.period.as_secs_f64(), delay)
        .map_err(|error| format!("the loop cannot be linearised: {error:?}"))
}

/// An error of a joint, rad or m, from which on the arm counts as lost, and one at which the run ends.
const LOST: f64 = 0.1;
const GIVEN_UP: f64 = 1.0;

/// Why a controller gives no torque any more.
#[derive(Debug)]
enum Stop {
    Control(ControlError),
    GivenUp,
}

/// One sample of the log.
struct Writer<'a> {
    run: &'a ControlRun,
    prepared: &'a Prepared,
    log: Log,
    lost_at: f64,
}

impl Writer<'_> {
    fn write(&mut self, index: usize, t: Duration, state: &State<f64, DOF>, tau: &Joints, extras: &[f64]) {
        let e = self.prepared.reference[index].q - state.q;
        if self.lost_at.is_infinite() && e.amax() > LOST {
            self.lost_at = t.as_secs_f64();
        }
        let pose = Pose::of(&Nominal, &state.q);
        let tip = task().error(&self.prepared.desired[index].pose, &pose);
        let row = [t.as_secs_f64()].into_iter().chain(state.q.iter().copied()).chain(e.iter().copied());
        let row = row.chain(tip.iter().copied()).chain(pose.position.iter().copied()).chain(tau.iter().copied());
        self.log.push(row.chain(extras.iter().copied()));
    }

    fn record(self, outcome: Result<(), String>, took: Duration) -> Record {
        let report = &self.prepared.report;
        let (StablePeriod::UpTo(limit) | StablePeriod::AtLeast(limit) | StablePeriod::NotEvenAt(limit)) = report.period;
        let values = [report.radius, limit, self.prepared.delayed.unwrap_or(f64::NAN), self.lost_at];
        let simulated = self.log.rows().last().map_or(0.0, |row| row[0]);
        let speed = if self.run.continuous.is_some() { (0.0, 0.0) } else { (simulated, took.as_secs_f64()) };
        let ended = outcome.err();
        Record { log: self.log, singles: singles(self.run).into_iter().zip(values).collect(), ended, speed }
    }
}

/// Moves the arm.
pub(crate) fn run(run: &ControlRun, prepared: &Prepared) -> Record {
    let mut writer = Writer { run, prepared, log: Log::new(columns(run)), lost_at: f64::INFINITY };
    let begun = Instant::now();
    let outcome = match (&run.law, run.continuous) {
        (Law::Adaptive(controller), Some(substeps)) => continuous(run, controller, substeps, &mut writer),
        _ => sampled(run, &mut writer),
    };
    writer.record(outcome, begun.elapsed())
}

fn sampled(run: &ControlRun, writer: &mut Writer<'_>) -> Result<(), String> {
    let plant = WithParameters { parameters: run.plant };
    let mut options = RunOptions::new(run.sampling.period, run.sampling.duration);
    options.integrator = Integrator::RungeKutta4 { substeps: run.substeps };
    options.sensor = Sensor::new(run.delay, run.noise.0, run.noise.1, u64::from(run.noise.2));
    let (mut law, mut index) = (run.law.clone(), 0);
    let extras = RefCell::new(Vec::new());
    let prepared = writer.prepared;
    let end = simulate(
        &plant,
        State::at_rest(run.start),
        options,
        |_, measured| {
            let reference = &prepared.reference[index];
            if (reference.q - measured.q).amax() > GIVEN_UP {
                return Err(Stop::GivenUp);
            }
            let mut extras = extras.borrow_mut();
            extras.clear();
            let torque = match &mut law {
                Law::PdGravity(c) => c.torque(&Nominal, reference, measured),
                Law::InverseDynamics(c) => c.torque(&Nominal, reference, measured),
                Law::Robust(c) => {
                    extras.push(c.z(reference, measured).norm());
                    c.torque(&Nominal, reference, measured)
                }
                Law::Adaptive(c) => {
                    extras.extend(c.estimate().iter());
                    c.torque(&Nominal, reference, measured)
                }
                Law::OperationalSpace(c) => c.torque(&Nominal, &prepared.desired[index], measured),
            };
            index += 1;
            torque.map(|torque| torque.tau).map_err(Stop::Control)
        },
        |sample| writer.write(sample.index as usize, sample.time, &sample.state, &sample.tau, &extras.borrow()),
    );
    end.map(|_| ()).map_err(explain)
}

fn continuous(
    run: &ControlRun,
    controller: &Adaptive<f64, DOF, PARAMETERS>,
    substeps: u32,
    writer: &mut Writer<'_>,
) -> Result<(), String> {
    let plant = WithParameters { parameters: run.plant };
    let prepared = writer.prepared;
    let options = ContinuousOptions { period: run.sampling.period, duration: run.sampling.duration, substeps };
    let law = |k: u64, t: f64, state: &State<f64, DOF>, estimate: &_| {
        let reference = prepared.reference[k as usize].held(t);
        if (reference.q - state.q).amax() > GIVEN_UP {
            return Err(Stop::GivenUp);
        }
        controller.law(&Nominal, &reference, state, estimate).map(|(torque, rate)| (torque.tau, rate)).map_err(Stop::Control)
    };
    let memory = *controller.estimate();
    debug_assert_eq!(memory.len(), NOMINAL_PARAMETERS.len());
    let end = run_continuous(&plant, State::at_rest(run.start), memory, options, law, |sample| {
        let tau = law(sample.index, 0.0, &sample.state, &sample.memory).map_or(Joints::zeros(), |(tau, _)| tau);
        writer.write(sample.index as usize, sample.time, &sample.state, &tau, sample.memory.as_slice());
    });
    end.map(|_| ()).map_err(explain)
}

fn explain(error: RunError<Stop>) -> String {
    let ms = |t: Duration| number(t.as_secs_f64() * 1e3);
    match error {
        RunError::Controller { time, error: Stop::GivenUp } => {
            format!("given up after {} ms: a joint is off by more than {GIVEN_UP} rad or m", ms(time))
        }
        RunError::Controller { time, error: Stop::Control(error) } => format!("no torque after {} ms: {error:?}", ms(time)),
        RunError::Diverged { time } => format!("diverged after {} ms", ms(time)),
        RunError::Integrator { time, error } => format!("not integrable after {} ms: {error:?}", ms(time)),
        RunError::NoPeriod => "the period is zero".into(),
    }
}
