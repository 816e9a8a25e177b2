//! From posture to posture within the limits of the joints, by inverse dynamics in joint space: for any arm.
//!
//! Each joint in turn, then all together, move to either side of the posture in which the arm begins: the middle of its ranges, and zero
//! where a joint has none. The pace is what the velocity limits allow, and is reduced until the efforts stay within theirs.

use std::time::Duration;

use armgen_generated::{Nominal, DOF, EFFORT_LIMITS, JOINT_IS_REVOLUTE, JOINT_NAMES, POSITION_LIMITS, VELOCITY_LIMITS};
use armgen_runtime::control::InverseDynamics;
use armgen_runtime::reference::{Pose, State};
use armgen_runtime::robot::Dynamics;
use armgen_runtime::simulation::{run as simulate, Integrator, Log, RunOptions};
use armgen_runtime::trajectory::{JointSegment, JointTrajectory};

use super::{by_kind, effort_unit, joint_columns, joint_table, stability, tip_panel, title, unit, Outcome, Vector, PERIOD};
use crate::figure::{Figure, Panel, Scale};

type Postures = JointTrajectory<f64, DOF, Vec<JointSegment<f64, DOF>>>;

/// Rates and accelerations where the description gives no limit: rad/s or m/s, and per s.
const TURNING: (f64, f64) = (1.5, 4.0);
const SLIDING: (f64, f64) = (0.25, 1.0);
/// How far a joint goes to either side where its range allows it.
const SWING: f64 = 0.5;
const STROKE: f64 = 0.1;
/// Part of a limit that is used.
const PART: f64 = 0.8;
/// How often the pace is halved until the efforts are within their limits.
const HALVINGS: u32 = 6;
/// With a model that is right, sampling alone makes the joints miss: by less than this, rad or m.
const EXPECTED: f64 = 1e-4;
/// Diagonals of K_P, 1/s², and of K_D, 1/s: critically damped.
const GAINS: (f64, f64) = (1e4, 200.0);
/// Time at rest at the end.
const HOLD: Duration = Duration::from_millis(500);

pub(super) fn run() -> Result<Outcome, String> {
    let fault = |what: &dyn std::fmt::Debug| format!("the demonstration cannot be run: {what:?}");
    let (trajectory, pace) = within_efforts()?;
    let controller = InverseDynamics::new([GAINS.0; DOF], [GAINS.1; DOF]).map_err(|e| fault(&e))?;
    let end = trajectory.duration() + HOLD;
    let postures: Vec<Vector> =
        (0..=end.as_millis() / 100).map(|k| trajectory.sample(Duration::from_millis(100) * k as u32).q).collect();
    let stable = stability(&controller, &postures)?;

    let tip = ["t", "x", "y", "z", "x_d", "y_d", "z_d"].into_iter().map(String::from);
    let joints = joint_columns("q").chain(joint_columns("e")).chain(joint_columns("dq")).chain(joint_columns("tau"));
    let mut log = Log::new(tip.chain(joints));
    let options = RunOptions { integrator: Integrator::RungeKutta4 { substeps: 4 }, ..RunOptions::new(PERIOD, end) };
    simulate(
        &Nominal,
        State::at_rest(trajectory.sample(Duration::ZERO).q),
        options,
        |t, measured| controller.torque(&Nominal, &trajectory.sample(t), measured).map(|torque| torque.tau),
        |sample| {
            let desired = trajectory.sample(sample.time);
            let State { q, dq } = sample.state;
            let tip = [Pose::of(&Nominal, &q).position, Pose::of(&Nominal, &desired.q).position];
            let e = desired.q - q;
            let joints = q.iter().chain(e.iter()).chain(dq.iter()).chain(sample.tau.iter());
            log.push([sample.time.as_secs_f64()].iter().chain(tip.iter().flatten()).chain(joints).copied());
        },
    )
    .map_err(|e| fault(&e))?;

    let bounds = bounds(&postures);
    let fault = (0..DOF).find_map(|i| {
        let (name, unit, bound) = (JOINT_NAMES[i], unit(i), bounds[i]);
        let peak = log.peak(&format!("e{}", i + 1), |_| true).unwrap_or(f64::NAN);
        (peak.is_nan() || peak >= bound).then(|| {
            format!("joint `{name}` misses by {peak:.1e} {unit}: sampling and Coulomb friction explain {bound:.1e} {unit} with a model that is right")
        })
    });
    let seconds = log.rows().last().map_or(0.0, |row| row[0]);
    let report = format!(
        "  Demonstration: each joint to either side, then all together, {seconds:.1} s sampled at 1 ms\n  \
         inverse dynamics with K_P = 10000 1/s², K_D = 200 1/s; {stable}\n{pace}\n{}",
        joint_table(&log, Some(&|i| format!("e{}", i + 1)))
    );
    Ok(Outcome { report, name: "demonstration", figure: figure(&log), log, fault })
}

/// What the joints may miss by, rad or m.
///
/// A held torque has the wrong sign of Coulomb friction while a rate passes zero: a disturbance of up to 2 F_c, which moves the error
/// by no more than B⁻¹ 2 F_c / K_P.
fn bounds(postures: &[Vector]) -> Vector {
    let friction = Nominal.friction(&Vector::repeat(f64::MIN_POSITIVE)).abs() * 2.0;
    postures
        .iter()
        .filter_map(|q| Nominal.inertia_matrix(q).cholesky())
        .fold(Vector::repeat(EXPECTED), |bounds, b| bounds.sup(&((b.inverse().abs() * friction) / GAINS.0).add_scalar(EXPECTED)))
}

/// The trajectory at the greatest of a few paces that keeps the efforts within their limits, and a line if that is not the full one.
fn within_efforts() -> Result<(Postures, String), String> {
    let mut pace = 1.0;
    let mut beyond = String::new();
    for halving in 0..=HALVINGS {
        let trajectory = plan(pace)?;
        match beyond_efforts(&trajectory) {
            None if halving == 0 => return Ok((trajectory, String::new())),
            None => return Ok((trajectory, format!("  slowed down to {} of the full pace: {beyond}\n", pace))),
            Some(reason) => beyond = reason,
        }
        pace /= 2.0;
    }
    // Gravity alone asks for more than a joint gives: the data sheet says so, and the motion is shown all the same.
    Ok((plan(pace)?, format!("  even slow motion asks for more than a limit: {beyond}\n")))
}

/// The first joint whose effort exceeds its limit on the way, and by how much.
fn beyond_efforts(trajectory: &Postures) -> Option<String> {
    let mut worst: Option<(f64, usize, f64)> = None;
    for k in 0..=trajectory.duration().as_millis() / 10 {
        let desired = trajectory.sample(Duration::from_millis(10) * k as u32);
        let tau = Nominal.inverse_dynamics(&desired.q, &desired.dq, &desired.ddq);
        for i in 0..DOF {
            let excess = tau[i].abs() / EFFORT_LIMITS[i];
            if excess > 1.0 && worst.is_none_or(|(before, ..)| excess > before) {
                worst = Some((excess, i, tau[i].abs()));
            }
        }
    }
    let (_, i, tau) = worst?;
    let (joint, unit, limit) = (JOINT_NAMES[i], effort_unit(i), EFFORT_LIMITS[i]);
    Some(format!("joint `{joint}` would need {tau:.1} {unit}, and its limit is {limit} {unit}"))
}

fn plan(pace: f64) -> Result<Postures, String> {
    let (home, swing) = home_and_swing();
    let limit = |given: f64, own: f64| if given.is_finite() { (PART * given).min(own) } else { own };
    let own = |i: usize| if JOINT_IS_REVOLUTE[i] { TURNING } else { SLIDING };
    let velocity: [f64; DOF] = std::array::from_fn(|i| pace * limit(VELOCITY_LIMITS[i], own(i).0));
    let acceleration: [f64; DOF] = std::array::from_fn(|i| pace * pace * own(i).1);
    let to = |posture: [f64; DOF]| JointSegment::within_limits(posture, velocity, acceleration);
    let mut segments = Vec::new();
    for i in 0..DOF {
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
    JointTrajectory::plan(home, segments).map_err(|error| format!("the demonstration cannot be planned: {error:?}"))
}

/// Where the joints begin, and how far they go to either side.
fn home_and_swing() -> ([f64; DOF], [f64; DOF]) {
    let full = |i: usize| if JOINT_IS_REVOLUTE[i] { SWING } else { STROKE };
    let of = |i: usize| {
        let [low, high] = POSITION_LIMITS[i];
        match (low.is_finite(), high.is_finite()) {
            (true, true) => ((low + high) / 2.0, full(i).min(PART * (high - low) / 2.0)),
            (true, false) => (low + full(i) / PART, full(i)),
            (false, true) => (high - full(i) / PART, full(i)),
            (false, false) => (0.0, full(i)),
        }
    };
    (std::array::from_fn(|i| of(i).0), std::array::from_fn(|i| of(i).1))
}

fn figure(log: &Log) -> Figure {
    let joints = by_kind("Joint variables", ["q (rad)", "q (m)"], Scale::Linear, log, &|i| format!("q{}", i + 1));
    let errors =
        by_kind("Size of the joint errors", ["|e| (rad)", "|e| (m)"], Scale::Logarithmic, log, &|i| format!("e{}", i + 1));
    let efforts = by_kind("Efforts", ["torque (N m)", "force (N)"], Scale::Linear, log, &|i| format!("tau{}", i + 1));
    let row: Vec<Panel> = std::iter::once(tip_panel(log)).chain(joints).collect();
    Figure::new(title("demonstration by inverse dynamics in joint space")).row(360, row).row(300, errors).row(300, efforts)
}
