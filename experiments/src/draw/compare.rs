//! The members of a group side by side, in panels of equal axes.

use super::plot::{figure, Panel};
use super::run::{absolute, error_rows, loaded, unit_of_w, Points};
use crate::model::{Body, ClikRun, ControlRun, Experiment, JointQuantity, Quantity, Record, Robot, Unit};

/// A member of a group: its name, its run, its record.
type Member<'m, T> = (&'m str, &'m T, &'m Record);

/// The comparison of a group whose members are of the same kind; otherwise `None`.
pub(super) fn group(group: &str, members: &[(&Experiment, &Record)], robot: &Robot) -> Option<String> {
    let recorded = members.iter().all(|(_, record)| record.log().len() > 1);
    if !recorded {
        return None;
    }
    let (mut panels, what) = match (clik_runs(members), control_runs(members)) {
        (Some(runs), _) => compare_clik(&runs, robot),
        (_, Some(runs)) => compare_control(&runs, robot),
        _ => return None,
    };
    // Logarithmic panels share their axis, so that a reader can compare heights.
    let logarithmic = |p: &&Panel| p.log;
    let low = panels.iter().filter(logarithmic).filter_map(Panel::decades).fold(f64::INFINITY, |a, r| a.min(r.0));
    let high = panels.iter().filter(logarithmic).filter_map(Panel::decades).fold(0.0, |a, r| f64::max(a, r.1));
    for panel in panels.iter_mut().filter(|p| p.log) {
        panel.range = Some((low.max(high * 1e-7), high)).filter(|(low, high)| low < high);
    }
    let name = group.replace('_', " ");
    let mut letters = name.chars();
    let name: String = letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
    Some(figure(&format!("{name}: {what}"), &panels, 2, (470.0, 175.0)))
}

fn clik_runs<'m>(members: &[(&'m Experiment, &'m Record)]) -> Option<Vec<Member<'m, ClikRun>>> {
    let run = |(experiment, record): &(&'m Experiment, &'m Record)| match &experiment.body {
        Body::Clik(run) => Some((experiment.name.as_str(), run, *record)),
        _ => None,
    };
    members.iter().map(run).collect()
}

fn control_runs<'m>(members: &[(&'m Experiment, &'m Record)]) -> Option<Vec<Member<'m, ControlRun>>> {
    let run = |(experiment, record): &(&'m Experiment, &'m Record)| match &experiment.body {
        Body::Control(run) => Some((experiment.name.as_str(), run, *record)),
        _ => None,
    };
    members.iter().map(run).collect()
}

/// The norm of the errors of the linear rows, or of the angular rows.
fn tip_error(record: &Record, angular: bool) -> Points {
    let rows = error_rows(record).filter(|row| row.is_angular() == angular);
    let columns: Vec<Points> = rows.map(|row| record.series(Quantity::TaskError(row))).collect();
    let Some(first) = columns.first() else { return Vec::new() };
    (0..first.len()).map(|k| (first[k].0, columns.iter().map(|c| c[k].1 * c[k].1).sum::<f64>().sqrt())).collect()
}

fn compare_clik(members: &[Member<'_, ClikRun>], robot: &Robot) -> (Vec<Panel>, &'static str) {
    let mut panels = Vec::new();
    let Some((_, first_run, first)) = members.first() else { return (panels, "") };
    for row in error_rows(first) {
        let mut panel = Panel { log: true, ..Panel::over_time(&format!("error of {row}"), "|e|", Unit::of_row(row).symbol()) };
        for (name, _, record) in members {
            panel.add(name, absolute(record.series(Quantity::TaskError(row))));
        }
        panels.push(panel);
    }
    let relaxed = members.iter().any(|(_, run, _)| run.rows.len() < robot.task.len());
    if !relaxed {
        return (panels, "errors of the task");
    }
    let whole = ("w of the whole task", Quantity::Manipulability, &robot.task);
    let followed = ("w of the followed rows", Quantity::FollowedManipulability, &first_run.rows);
    for (title, quantity, rows) in [whole, followed] {
        let mut panel = Panel::over_time(title, "w", &unit_of_w(rows, robot));
        for (name, _, record) in members {
            panel.add(name, record.series(quantity));
        }
        panels.push(panel);
    }
    // The joint with the largest spread of final positions.
    let spread = |joint: &usize| {
        let position = Quantity::Joint(JointQuantity::Position, *joint);
        let ends = members.iter().filter_map(|(_, _, record)| record.values(position).last().copied());
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        high - low
    };
    if let Some(i) = (0..robot.dof()).max_by(|a, b| spread(a).total_cmp(&spread(b))) {
        let joint = &robot.joints[i];
        let mut panel = Panel::over_time(&format!("joint {}", joint.name), "q", joint.unit().symbol());
        for (name, _, record) in members {
            panel.add(name, record.series(Quantity::Joint(JointQuantity::Position, i)));
        }
        panels.push(panel);
    }
    (panels, "errors of the task and manipulability")
}

fn compare_control(members: &[Member<'_, ControlRun>], robot: &Robot) -> (Vec<Panel>, &'static str) {
    let mut panels = Vec::new();
    for (title, unit, angular) in
        [("position error of the tip", Unit::Metre, false), ("orientation error of the tip", Unit::Radian, true)]
    {
        let mut panel = Panel { log: true, ..Panel::over_time(title, "|e|", unit.symbol()) };
        for (name, _, record) in members {
            panel.add(name, tip_error(record, angular));
        }
        if panel.series.iter().any(|series| !series.points.is_empty()) {
            panels.push(panel);
        }
    }
    let mut estimates = Panel::over_time("estimate of the load's parameter (SI)", "estimate", "");
    for (name, run, record) in members {
        for i in loaded(run, robot) {
            let points = record.series(Quantity::Estimate(i));
            if !points.is_empty() {
                estimates.add(&format!("{name}: {}", robot.parameters[i].name), points);
            }
        }
    }
    if estimates.series.is_empty() {
        return (panels, "errors of the tip");
    }
    panels.push(estimates);
    (panels, "errors of the tip and estimates of the load")
}
