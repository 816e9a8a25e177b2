//! Runs over time: errors, torques, estimates; and the members of a group side by side.

use armgen_generated::{JOINT_IS_REVOLUTE, JOINT_NAMES, NOMINAL_PARAMETERS, PARAMETER_NAMES};

use armgen_runtime::task::Row;

use super::plot::{figure, Panel};
use crate::experiments::{task_rows, Body, ControlRun, Experiment, Record};

type Points = Vec<(f64, f64)>;

fn over_time(record: &Record, name: &str) -> Points {
    let Some(values) = record.log.column(name) else { return Vec::new() };
    record.log.column("t").into_iter().flatten().zip(values).collect()
}

fn absolute(points: Points) -> Points {
    points.into_iter().map(|(t, x)| (t, x.abs())).collect()
}

fn names<'r>(record: &'r Record, prefix: &str) -> Vec<&'r str> {
    record.log.names().iter().map(String::as_str).filter(|name| name.starts_with(prefix)).collect()
}

/// What stands behind the first underscore.
fn short(name: &str) -> &str {
    name.split_once('_').map_or(name, |(_, rest)| rest)
}

fn unit(row: &str) -> &'static str {
    if row.starts_with('r') {
        "rad"
    } else {
        "m"
    }
}

const SIZE: (f64, f64) = (430.0, 165.0);

/// The rows that an experiment follows.
fn followed_rows(experiment: &Experiment) -> Vec<Row> {
    match &experiment.body {
        Body::Clik(run) => run.rows.clone(),
        _ => task_rows().to_vec(),
    }
}

/// Unit of w = sqrt(det(J J')): m for each linear row, but rad for m with each prismatic joint, which is a factor only of a square J.
fn unit_of_w(rows: &[Row]) -> String {
    let linear = rows.iter().filter(|row| !row.is_angular()).count();
    let prismatic = JOINT_IS_REVOLUTE.iter().filter(|is| !**is).count();
    if prismatic > 0 && rows.len() != JOINT_IS_REVOLUTE.len() {
        return "SI".into();
    }
    match linear.saturating_sub(prismatic) {
        0 => String::new(),
        1 => "m".into(),
        2 => "m²".into(),
        _ => "m³".into(),
    }
}

/// Errors of the followed rows, joint variables, w.
pub(super) fn clik(experiment: &Experiment, record: &Record) -> String {
    let mut errors = Panel { log: true, ..Panel::over_time("errors of the task", "|e|", "m, rad") };
    for name in names(record, "e_") {
        errors.add(short(name), absolute(over_time(record, name)));
    }
    let mut joints = Panel::over_time("joint variables", "q", "rad, m");
    for name in JOINT_NAMES {
        joints.add(name, over_time(record, &format!("q_{name}")));
    }
    let (whole, followed) = (task_rows().to_vec(), followed_rows(experiment));
    let units = [unit_of_w(&whole), unit_of_w(&followed)];
    let mut w = Panel::over_time("manipulability", "w", if units[0] == units[1] { &units[0] } else { "SI" });
    w.add("whole task", over_time(record, "w"));
    if whole != followed {
        w.add("followed rows", over_time(record, "w_followed"));
    }
    let mut panels = vec![errors, joints, w];
    if record.log.names().iter().any(|name| name == "loop_gain") {
        let mut gain = Panel::over_time("loop gain, stable below 2", "Ts λmax", "");
        gain.add("", over_time(record, "loop_gain"));
        panels.push(gain);
    }
    figure(&experiment.title, &panels, 2, SIZE)
}

/// Estimates of the parameters that the load changes, beside their true values.
fn estimates(control: &ControlRun, record: &Record) -> Option<Panel> {
    let mut panel = Panel::over_time("estimate of the load's parameter (SI)", "estimate", "");
    let changed = (0..PARAMETER_NAMES.len()).filter(|i| control.plant[*i] != NOMINAL_PARAMETERS[*i]);
    for i in changed {
        let points = over_time(record, &format!("estimate_{}", PARAMETER_NAMES[i]));
        if let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) {
            panel.add(PARAMETER_NAMES[i], points);
            panel.add(&format!("{}, true", PARAMETER_NAMES[i]), vec![(first.0, control.plant[i]), (last.0, control.plant[i])]);
        }
    }
    (!panel.series.is_empty()).then_some(panel)
}

/// Errors of joints and tip, torques, estimates; what turns on the left, what slides on the right.
pub(super) fn control(experiment: &Experiment, control: &ControlRun, record: &Record) -> String {
    // A run that ended early shows how fast it was lost: over decades.
    let lost = record.ended.is_some();
    let mut panels = Vec::new();
    let mut add = |title: &str, quantity: &str, unit: &str, columns: Vec<(&str, String)>, log: bool| {
        let quantity = if log { format!("|{quantity}|") } else { quantity.to_owned() };
        let mut panel = Panel { log, ..Panel::over_time(title, &quantity, unit) };
        for (name, column) in columns {
            let points = over_time(record, &column);
            panel.add(name, if log { absolute(points) } else { points });
        }
        if !panel.series.is_empty() {
            panels.push(panel);
        }
    };
    let joints = |prefix: &str, revolute: bool| {
        let all = JOINT_NAMES.iter().zip(JOINT_IS_REVOLUTE).filter(|(_, is)| *is == revolute);
        all.map(|(name, _)| (*name, format!("{prefix}_{name}"))).collect::<Vec<_>>()
    };
    let rows = |linear: bool| {
        let all = names(record, "e_").into_iter().filter(|name| (unit(short(name)) == "m") == linear);
        all.map(|name| (short(name), name.to_owned())).collect::<Vec<_>>()
    };
    add("errors of revolute joints", "q_d − q", "rad", joints("eq", true), lost);
    add("errors of prismatic joints", "q_d − q", "m", joints("eq", false), lost);
    add("orientation errors of the tip", "e", "rad", rows(false), lost);
    add("position errors of the tip", "e", "m", rows(true), lost);
    add("torques of revolute joints", "τ", "N m", joints("tau", true), lost);
    add("forces of prismatic joints", "τ", "N", joints("tau", false), lost);
    panels.extend(estimates(control, record));
    figure(&experiment.title, &panels, 2, SIZE)
}

/// The length of the errors of those rows that are linear, or angular.
fn tip_error(record: &Record, linear: bool) -> Points {
    let columns: Vec<Points> = names(record, "e_")
        .into_iter()
        .filter(|name| (unit(short(name)) == "m") == linear)
        .map(|name| over_time(record, name))
        .collect();
    let Some(first) = columns.first() else { return Vec::new() };
    (0..first.len()).map(|k| (first[k].0, columns.iter().map(|c| c[k].1 * c[k].1).sum::<f64>().sqrt())).collect()
}

/// The members of a group, in panels of equal axes.
pub(super) fn compare(group: &str, members: &[(&Experiment, &Record)]) -> Option<String> {
    let all = |matches: fn(&Body) -> bool| members.iter().all(|(e, r)| matches(&e.body) && r.log.len() > 1);
    let mut panels = if all(|body| matches!(body, Body::Clik(_))) {
        compare_clik(members)
    } else if all(|body| matches!(body, Body::Control(_))) {
        compare_control(members)
    } else {
        return None;
    };
    // Logarithmic panels share their axis, so that heights can be compared.
    let logarithmic = |p: &&Panel| p.log;
    let low = panels.iter().filter(logarithmic).filter_map(Panel::decades).fold(f64::INFINITY, |a, r| a.min(r.0));
    let high = panels.iter().filter(logarithmic).filter_map(Panel::decades).fold(0.0, |a, r| f64::max(a, r.1));
    for panel in panels.iter_mut().filter(|p| p.log) {
        panel.range = Some((low.max(high * 1e-7), high)).filter(|(low, high)| low < high);
    }
    let title = format!("Compared: {}", group.replace('_', " "));
    Some(figure(&title, &panels, 2, (470.0, 175.0)))
}

fn compare_clik(members: &[(&Experiment, &Record)]) -> Vec<Panel> {
    let mut panels = Vec::new();
    let Some((first_member, first)) = members.first() else { return panels };
    for name in names(first, "e_") {
        let row = short(name);
        let mut panel = Panel { log: true, ..Panel::over_time(&format!("error of {row}"), "|e|", unit(row)) };
        for (experiment, record) in members {
            panel.add(&experiment.name, absolute(over_time(record, name)));
        }
        panels.push(panel);
    }
    let relaxed = members.iter().any(|(e, _)| matches!(&e.body, Body::Clik(run) if run.rows.len() < armgen_generated::TASK_ROWS));
    if relaxed {
        let whole = [("w of the whole task", "w"), ("w of the followed rows", "w_followed")];
        for (title, column) in whole {
            let rows = if column == "w" { task_rows().to_vec() } else { followed_rows(first_member) };
            let mut panel = Panel::over_time(title, "w", &unit_of_w(&rows));
            for (experiment, record) in members {
                panel.add(&experiment.name, over_time(record, column));
            }
            panels.push(panel);
        }
        // The joint that tells them apart most.
        let spread = |name: &str| {
            let ends = members.iter().filter_map(|(_, r)| over_time(r, name).last().map(|p| p.1));
            let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            high - low
        };
        let joints =
            JOINT_NAMES.iter().zip(JOINT_IS_REVOLUTE).map(|(name, is)| (format!("q_{name}"), if is { "rad" } else { "m" }));
        if let Some((joint, unit)) = joints.max_by(|a, b| spread(&a.0).total_cmp(&spread(&b.0))) {
            let joint = joint.as_str();
            let mut panel = Panel::over_time(&format!("joint {}", short(joint)), "q", unit);
            for (experiment, record) in members {
                panel.add(&experiment.name, over_time(record, joint));
            }
            panels.push(panel);
        }
    }
    panels
}

fn compare_control(members: &[(&Experiment, &Record)]) -> Vec<Panel> {
    let mut panels = Vec::new();
    for (title, unit, linear) in [("position error of the tip", "m", true), ("orientation error of the tip", "rad", false)] {
        let mut panel = Panel { log: true, ..Panel::over_time(title, "|e|", unit) };
        for (experiment, record) in members {
            panel.add(&experiment.name, tip_error(record, linear));
        }
        if panel.series.iter().any(|series| !series.points.is_empty()) {
            panels.push(panel);
        }
    }
    let mut panel = Panel::over_time("estimate of the load's parameter (SI)", "estimate", "");
    for (experiment, record) in members {
        let Body::Control(control) = &experiment.body else { continue };
        let changed = (0..PARAMETER_NAMES.len()).filter(|i| control.plant[*i] != NOMINAL_PARAMETERS[*i]);
        for i in changed {
            let points = over_time(record, &format!("estimate_{}", PARAMETER_NAMES[i]));
            if !points.is_empty() {
                panel.add(&format!("{}: {}", experiment.name, PARAMETER_NAMES[i]), points);
            }
        }
    }
    if !panel.series.is_empty() {
        panels.push(panel);
    }
    panels
}
