//! Two lines of the technical project's path, P0-P1-P2, by inverse dynamics in the operational space: down into the sheet, then the first cut.

use std::f64::consts::FRAC_PI_4;
use std::time::Duration;

use armgen_generated::{Nominal, DOF, NAME, TASK, TASK_ROWS};
use armgen_runtime::clik::{
    Clik, DampedLeastSquares, Integration, JacobianInverse, JointLimits, Outcome as Reached, SecondOrder,
};
use armgen_runtime::control::OperationalSpace;
use armgen_runtime::linalg::Damping;
use armgen_runtime::nalgebra::Matrix3;
use armgen_runtime::reference::{OperationalReference, Pose, State};
use armgen_runtime::simulation::{run as simulate, Log, RunOptions};
use armgen_runtime::task::{Row, Task};
use armgen_runtime::trajectory::{Law, OperationalTrajectory, OrientationProfile, Path, Segment, Turn};

use super::{by_kind, joint_columns, joint_table, over_time, stability, tip_panel, title, Outcome, Vector, PERIOD};
use crate::figure::{Figure, Panel, Scale, Style};
use crate::table::{Align, Table};

/// The rows of the task: x, y, z and the turn about z.
const ROWS: [usize; 4] = [0, 1, 2, 5];
const ROW_NAMES: [&str; 4] = ["x", "y", "z", "phi"];
const P0: [f64; 3] = [0.48, -0.18, 0.10];
const P1: [f64; 3] = [0.48, -0.18, 0.0];
const P2: [f64; 3] = [0.48, 0.06, 0.0];
/// Near the posture at P0, elbow to the left.
const NEAR: [f64; 4] = [-1.4, 2.0, 0.4, 0.7];
/// Time at rest after the lines.
const HOLD: Duration = Duration::from_millis(500);
/// With a model that is right, sampling alone makes the tip miss: by less than this, m or rad.
const EXPECTED: f64 = 1e-5;

type Lines = OperationalTrajectory<f64, [Segment<f64>; 2], [Turn<f64>; 1]>;

/// The motion; `Err`: why this is not the arm for it, `Ok(Err)`: why it failed.
pub(super) fn run() -> Result<Result<Outcome, String>, String> {
    if NAME != "scara" {
        return Err(format!("it needs the arm `scara`, and this is `{NAME}`"));
    }
    if TASK[..] != ROWS[..] || DOF != ROWS.len() {
        return Err("it needs an arm of four joints with the task x, y, z, rz".into());
    }
    let lines = lines();
    let task = Task::new(TASK.map(row)).map_err(|error| format!("the task cannot be used: {error:?}"))?;
    let start = start(task, &lines.sample(Duration::ZERO).pose)?;
    Ok(drive(task, start, &lines))
}

fn row(index: usize) -> Row {
    [Row::X, Row::Y, Row::Z, Row::Rx, Row::Ry, Row::Rz][index]
}

/// P0 to P1 in 1 s, on to P2 in 1.5 s, with trapezoidal speed; the end effector turns about z0 meanwhile.
fn lines() -> Lines {
    let law = |milliseconds: u64| Law::Trapezoidal {
        duration: Duration::from_millis(milliseconds),
        acceleration_time: Duration::from_millis(200),
    };
    let path = Path::plan(P0, [Segment::line(P1, law(1000)), Segment::line(P2, law(1500))]).expect("the lines are as they are");
    // phi = 0: the y axis of the end effector along x0, its z axis downwards.
    let upright = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);
    let turns = [Turn::about([0.0, 0.0, 1.0], FRAC_PI_4, law(2500))];
    OperationalTrajectory { path, orientation: OrientationProfile::plan(upright, turns).expect("the turn is as it is") }
}

/// The posture in which the tip is at the start of the path.
fn start(task: Task<TASK_ROWS>, pose: &Pose<f64>) -> Result<Vector, String> {
    let fault = |what: &dyn std::fmt::Debug| format!("its start cannot be found: {what:?}");
    let period = PERIOD.as_secs_f64();
    let limits = JointLimits::rates([10.0; DOF]).map_err(|e| fault(&e))?;
    let damping = Damping::new(0.02, 0.05).map_err(|e| fault(&e))?;
    let approach = DampedLeastSquares::new([50.0; TASK_ROWS], damping).map_err(|e| fault(&e))?;
    let clik = Clik::new(task, approach, period, limits, [1e-6; TASK_ROWS]).map_err(|e| fault(&e))?;
    let near = Vector::from_fn(|i, _| NEAR.get(i).copied().unwrap_or(0.0));
    let reached = clik.approach(&Nominal, &near, pose, 20_000).map_err(|e| fault(&e))?;
    if reached.outcome != Reached::Converged {
        return Err(format!("this arm does not reach its start ({:?})", reached.outcome));
    }
    // With K = 1/T a step is one of Newton's method: from a millionth to rounding in a few.
    let newton = JacobianInverse::new([1.0 / period; TASK_ROWS]).map_err(|e| fault(&e))?;
    let clik = Clik::new(task, newton, period, limits, [1e-12; TASK_ROWS]).map_err(|e| fault(&e))?;
    let goal = OperationalReference::at_rest(*pose);
    (0..4).try_fold(reached.q, |q, _| clik.step(&Nominal, &q, &goal).map(|step| step.q)).map_err(|e| fault(&e))
}

fn drive(task: Task<TASK_ROWS>, start: Vector, lines: &Lines) -> Result<Outcome, String> {
    let fault = |what: &dyn std::fmt::Debug| format!("the motion cannot be run: {what:?}");
    let (k_p, k_d, k_i) = ([1e4; TASK_ROWS], [200.0; TASK_ROWS], [0.0; TASK_ROWS]);
    let mut controller = OperationalSpace::new(task, k_p, k_d, k_i, PERIOD.as_secs_f64()).map_err(|e| fault(&e))?;
    let end = lines.duration() + HOLD;
    let stable = stability(&controller, &postures(task, start, lines, end)?)?;

    let names = ["t"].into_iter().map(String::from);
    let tip = ["x", "y", "z", "x_d", "y_d", "z_d", "speed", "speed_d"].into_iter().map(String::from);
    let errors = ROW_NAMES.iter().map(|name| format!("e_{name}"));
    let joints = joint_columns("q").chain(joint_columns("dq")).chain(joint_columns("tau"));
    let mut log = Log::new(names.chain(tip).chain(errors).chain(joints));
    simulate(
        &Nominal,
        State::at_rest(start),
        RunOptions::new(PERIOD, end),
        |t, measured| controller.torque(&Nominal, &lines.sample(t), measured).map(|torque| torque.tau),
        |sample| {
            use armgen_runtime::robot::Kinematics;
            let desired = lines.sample(sample.time);
            let State { q, dq } = sample.state;
            let pose = Pose::of(&Nominal, &q);
            let v = Nominal.geometric_jacobian(&q) * dq;
            let speed = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let e = task.error(&desired.pose, &pose);
            let speeds = [speed(&v.as_slice()[..3]), speed(&desired.velocity.as_slice()[..3])];
            let tip = pose.position.iter().chain(desired.pose.position.iter()).chain(&speeds);
            let joints = q.iter().chain(dq.iter()).chain(sample.tau.iter());
            log.push([sample.time.as_secs_f64()].iter().chain(tip).chain(e.iter()).chain(joints).copied());
        },
    )
    .map_err(|e| fault(&e))?;
    Ok(outcome(log, &stable))
}

/// Postures on the way, one every 100 ms, by inverse kinematics alone: nothing has moved yet.
fn postures(task: Task<TASK_ROWS>, start: Vector, lines: &Lines, end: Duration) -> Result<Vec<Vector>, String> {
    let fault = |what: &dyn std::fmt::Debug| format!("the way cannot be followed: {what:?}");
    let limits = JointLimits::rates([100.0; DOF]).map_err(|e| fault(&e))?;
    let (k_p, k_d) = ([1000.0; TASK_ROWS], [50.0; TASK_ROWS]);
    let period = PERIOD.as_secs_f64();
    let clik = SecondOrder::new(task, k_p, k_d, period, Integration::HoldConsistent, limits, [1e-3; TASK_ROWS])
        .map_err(|e| fault(&e))?;
    let mut state = State::at_rest(start);
    let mut postures = Vec::new();
    let mut t = Duration::ZERO;
    while t <= end {
        if t.as_millis().is_multiple_of(100) {
            postures.push(state.q);
        }
        state = clik.step(&Nominal, &state, &lines.sample(t)).map_err(|e| fault(&e))?.next;
        t += PERIOD;
    }
    Ok(postures)
}

fn outcome(log: Log, stable: &str) -> Outcome {
    use Align::{Left, Right};
    let mut table = Table::new([("tip", Left), ("largest error", Right), ("error at end", Right), ("expected below", Right)]);
    let mut fault = None;
    for (i, name) in ROW_NAMES.iter().enumerate() {
        let column = format!("e_{name}");
        let largest = log.peak(&column, |_| true).unwrap_or(f64::NAN);
        let last = log.column(&column).and_then(Iterator::last).unwrap_or(f64::NAN);
        let unit = if i < 3 { "m" } else { "rad" };
        let large = |x: f64| x.is_nan() || x.abs() >= EXPECTED;
        if large(largest) || large(last) {
            fault = Some(format!(
                "the error of {name} exceeds {EXPECTED:.0e} {unit}: more than sampling makes of a model that is right"
            ));
        }
        let number = |x: f64| format!("{:.2e} {unit}", x.abs());
        table.row([(*name).to_string(), number(largest), number(last), format!("{EXPECTED:.0e} {unit}")]);
    }
    let seconds = log.rows().last().map_or(0.0, |row| row[0]);
    let report = format!(
        "  P0-P1-P2 by inverse dynamics in the operational space, {seconds} s sampled at 1 ms: K_P = 10000 1/s², K_D = 200 1/s\n  \
         {stable}\n\n{}\n{}",
        table.text(),
        joint_table(&log, None)
    );
    Outcome { report, name: "first-motion", figure: figure(&log), log, fault }
}

fn figure(log: &Log) -> Figure {
    let speed = Panel::new("Speed of the tip", "t (s)", "|v| (m/s)", Scale::Linear)
        .series("reached", over_time(log, "speed"), Style::Line, 6)
        .series("desired", over_time(log, "speed_d"), Style::Dashed, 0);
    let errors = ["x", "y", "z"]
        .iter()
        .fold(Panel::new("Errors of position", "t (s)", "desired minus actual (m)", Scale::Linear), |panel, name| {
            panel.line(format!("e_{name}"), over_time(log, &format!("e_{name}")))
        });
    let turn = Panel::new("Error of orientation", "t (s)", "desired minus actual (rad)", Scale::Linear)
        .line("e_phi", over_time(log, "e_phi"));
    let torques = by_kind("Efforts", ["torque (N m)", "force (N)"], Scale::Linear, log, &|i| format!("tau{}", i + 1));
    // The plane of the lines is that of y and z.
    let corners = [P0, P1, P2].map(|[_, y, z]| (y, z));
    let path = tip_panel(log).series("P0, P1, P2", corners, Style::Marks, 2);
    Figure::new(title("two lines of the path by inverse dynamics in the operational space"))
        .row(360, [path, speed])
        .row(300, [errors, turn])
        .row(300, torques)
}
