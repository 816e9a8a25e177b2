//! Runs over time: errors, torques, estimates.

use armgen_runtime::task::Row;

use super::plot::{figure, style, Panel, Series, WIDE};
use crate::model::{Channel, ClikRun, ControlRun, JointQuantity, Quantity, Record, Robot, Unit};

pub(super) type Points = Vec<(f64, f64)>;

const SIZE: (f64, f64) = (430.0, 165.0);

pub(super) fn absolute(points: Points) -> Points {
    points.into_iter().map(|(t, x)| (t, x.abs())).collect()
}

/// The rows whose errors the record contains.
pub(super) fn error_rows(record: &Record) -> impl Iterator<Item = Row> + '_ {
    record.channels().iter().filter_map(|channel| match channel.quantity {
        Quantity::TaskError(row) => Some(row),
        _ => None,
    })
}

/// Unit of w = sqrt(det(J J')): m for each linear row, but rad for m with each prismatic joint, which is a factor only of a square J.
pub(super) fn unit_of_w(rows: &[Row], robot: &Robot) -> String {
    let linear = rows.iter().filter(|row| !row.is_angular()).count();
    let prismatic = robot.joints.iter().filter(|joint| !joint.revolute).count();
    if prismatic > 0 && rows.len() != robot.dof() {
        return "SI".into();
    }
    match linear.saturating_sub(prismatic) {
        0 => String::new(),
        1 => "m".into(),
        2 => "m²".into(),
        _ => "m³".into(),
    }
}

/// The parameters that differ in the plant because of the load.
pub(super) fn loaded(run: &ControlRun, robot: &Robot) -> Vec<usize> {
    (0..robot.parameters.len()).filter(|i| run.plant[*i] != robot.parameters[*i].nominal).collect()
}

/// A panel with a quantity of all revolute joints, or of all prismatic joints.
fn of_joints(
    title: [&str; 2],
    symbol: &str,
    of: JointQuantity,
    revolute: bool,
    record: &Record,
    robot: &Robot,
    log: bool,
) -> Panel {
    let joints: Vec<usize> = (0..robot.dof()).filter(|i| robot.joints[*i].revolute == revolute).collect();
    let unit = joints.first().map_or(Unit::None, |i| Channel::new(Quantity::Joint(of, *i), robot).unit);
    let title = title[usize::from(!revolute)];
    let symbol = if log { format!("|{symbol}|") } else { symbol.to_owned() };
    let mut panel = Panel { log, ..Panel::over_time(title, &symbol, unit.symbol()) };
    for i in joints {
        let points = record.series(Quantity::Joint(of, i));
        panel.add(&robot.joints[i].name, if log { absolute(points) } else { points });
    }
    panel
}

/// The panels with content.
fn shown(panels: impl IntoIterator<Item = Panel>) -> Vec<Panel> {
    panels.into_iter().filter(|panel| !panel.series.is_empty()).collect()
}

/// The joint variables of all joints.
fn all_joints(record: &Record, robot: &Robot) -> Panel {
    let mut joints = Panel::over_time("joint variables", "q", "rad, m");
    for (i, joint) in robot.joints.iter().enumerate() {
        joints.add(&joint.name, record.series(Quantity::Joint(JointQuantity::Position, i)));
    }
    joints
}

/// Joint variables and w along a branch.
pub(super) fn branch(title: &str, record: &Record, robot: &Robot) -> String {
    let mut w = Panel::over_time("manipulability", "w", &unit_of_w(&robot.task, robot));
    w.add("", record.series(Quantity::Manipulability));
    figure(title, &[all_joints(record, robot), w], 2, SIZE)
}

/// Errors of the followed rows, joint variables, w.
pub(super) fn clik(title: &str, run: &ClikRun, record: &Record, robot: &Robot) -> String {
    let mut errors = Panel { log: true, ..Panel::over_time("errors of the task", "|e|", "m, rad") };
    for row in error_rows(record) {
        errors.add(&row.to_string(), absolute(record.series(Quantity::TaskError(row))));
    }
    let joints = all_joints(record, robot);
    let units = [unit_of_w(&robot.task, robot), unit_of_w(&run.rows, robot)];
    let mut w = Panel::over_time("manipulability", "w", if units[0] == units[1] { &units[0] } else { "SI" });
    w.add("whole task", record.series(Quantity::Manipulability));
    if robot.task != run.rows {
        w.add("followed rows", record.series(Quantity::FollowedManipulability));
    }
    let mut panels = vec![errors, joints, w];
    let gain = record.series(Quantity::LoopGain);
    if !gain.is_empty() {
        let mut panel = Panel::over_time("loop gain, stable below 2", "Ts λmax", "");
        panel.add("", gain);
        panels.push(panel);
    }
    figure(title, &panels, 2, SIZE)
}

/// Estimates of the parameters that the load changes, with their true values.
fn estimates(run: &ControlRun, record: &Record, robot: &Robot) -> Panel {
    let mut panel = Panel::over_time("estimate of the load's parameter (SI)", "estimate", "");
    for i in loaded(run, robot) {
        let (name, points) = (&robot.parameters[i].name, record.series(Quantity::Estimate(i)));
        if let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) {
            panel.add(name, points);
            panel.add(&format!("{name}, true"), vec![(first.0, run.plant[i]), (last.0, run.plant[i])]);
        }
    }
    panel
}

/// Errors of joints and tip, torques, estimates: revolute joints on the left, prismatic joints on the right.
pub(super) fn control(title: &str, run: &ControlRun, record: &Record, robot: &Robot) -> String {
    // A run that ended early shows its growth over decades.
    let lost = record.ended.is_some();
    let joints = |title: [&str; 2], symbol: &str, of: JointQuantity, log: bool| {
        [true, false].map(|revolute| of_joints(title, symbol, of, revolute, record, robot, log))
    };
    let tip = |title: &str, angular: bool| {
        let symbol = if lost { "|e|" } else { "e" };
        let unit = if angular { Unit::Radian } else { Unit::Metre };
        let mut panel = Panel { log: lost, ..Panel::over_time(title, symbol, unit.symbol()) };
        for row in error_rows(record).filter(|row| row.is_angular() == angular) {
            let points = record.series(Quantity::TaskError(row));
            panel.add(&row.to_string(), if lost { absolute(points) } else { points });
        }
        panel
    };
    let mut panels = Vec::new();
    panels.extend(joints(["errors of revolute joints", "errors of prismatic joints"], "q_d − q", JointQuantity::Error, lost));
    panels.extend([tip("orientation errors of the tip", true), tip("position errors of the tip", false)]);
    panels.extend(joints(["torques of revolute joints", "forces of prismatic joints"], "τ", JointQuantity::Effort, lost));
    panels.push(estimates(run, record, robot));
    figure(title, &shown(panels), 2, SIZE)
}

/// The path of the tip, desired and actual, in the coordinate plane of its largest extent.
fn tip(record: &Record) -> Panel {
    let span = |axis: usize| {
        let values = record.values(Quantity::DesiredTip(axis));
        values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let mut axes = [0, 1, 2];
    axes.sort_by(|a, b| span(*b).total_cmp(&span(*a)));
    let mut seen = [axes[0], axes[1]];
    seen.sort_unstable();
    let [x, y] = seen.map(|axis| (["x", "y", "z"][axis].to_owned(), "m".to_owned()));
    let way = |of: fn(usize) -> Quantity| record.values(of(seen[0])).into_iter().zip(record.values(of(seen[1]))).collect();
    let mut panel = Panel { title: "path of the tip".into(), x, y, equal: true, ..Panel::default() };
    panel.series.push(Series { name: "desired".into(), points: way(Quantity::DesiredTip), stroke: WIDE });
    panel.series.push(Series { name: "traced".into(), points: way(Quantity::Tip), stroke: style(0) });
    panel
}

/// A demonstration: joint variables, their errors, torques and forces, and the path of the tip.
pub fn demonstration(record: &Record, robot: &Robot) -> String {
    let of = |title: [&str; 2], symbol: &str, of: JointQuantity, log: bool| {
        [true, false].map(|revolute| of_joints(title, symbol, of, revolute, record, robot, log))
    };
    let mut panels = Vec::new();
    panels.extend(of(["revolute joints", "prismatic joints"], "q", JointQuantity::Position, false));
    panels.extend(of(["errors of revolute joints", "errors of prismatic joints"], "q_d − q", JointQuantity::Error, true));
    panels.extend(of(["torques of revolute joints", "forces of prismatic joints"], "τ", JointQuantity::Effort, false));
    panels.push(tip(record));
    let title = format!("{}: demonstration by inverse dynamics in joint space", robot.name);
    figure(&title, &shown(panels), 2, (430.0, 230.0))
}
