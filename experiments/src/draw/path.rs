//! The path in the plane of the sheet, planned and traced by the tip; its height over time; its profiles.

use std::time::Duration;

use super::plot::{figure, style, Panel, Series, WIDE};
use super::svg::Stroke;
use crate::model::{Motion, Quantity, Record};

/// The points with true condition; NaN marks the cuts elsewhere.
fn where_cut(points: &[(f64, f64)], z: &[f64], shown: impl Fn(f64) -> bool) -> Vec<(f64, f64)> {
    points.iter().zip(z).map(|(p, z)| if shown(*z) { *p } else { (f64::NAN, f64::NAN) }).collect()
}

/// Sampling period for drawing a plan.
const STEP: Duration = Duration::from_millis(2);

/// The plan alone, or the whole plan below the curve that the tip `traced`.
pub(super) fn plan(title: &str, motion: &Motion, record: &Record, traced: Option<&str>) -> String {
    let end = motion.trajectory.duration();
    let steps = (0..end.as_nanos().div_ceil(STEP.as_nanos()) as u32).map(|k| STEP * k).chain([end]);
    let (planned, planned_z): (Vec<(f64, f64)>, Vec<f64>) =
        steps.map(|t| motion.trajectory.sample(t).pose.position).map(|p| ((p.x, p.y), p.z)).unzip();
    // Over time, the plan ends where the record ends.
    let time = record.values(Quantity::Time);
    let along: Vec<f64> = time.iter().map(|t| motion.trajectory.sample(Duration::from_secs_f64(*t)).pose.position.z).collect();
    let top = motion.sheet.map_or(f64::INFINITY, |sheet| sheet.top);
    let metres = |name: &str| (name.to_owned(), "m".to_owned());
    let mut plane = Panel { title: "seen from above".into(), x: metres("x"), y: metres("y"), equal: true, ..Panel::default() };
    let planned_name = if motion.sheet.is_some() { "planned, in the sheet" } else { "planned" };
    plane.series.push(Series { name: planned_name.into(), points: where_cut(&planned, &planned_z, |z| z < top), stroke: WIDE });
    if motion.sheet.is_some() {
        let pale = Stroke { colour: "#8c8c8c", width: 1.0, dash: "2 3" };
        plane.series.push(Series {
            name: "planned, above it".into(),
            points: where_cut(&planned, &planned_z, |z| z >= top),
            stroke: pale,
        });
    }
    let mut height = Panel::over_time("height of the tip", "z", "m");
    height.series.push(Series {
        name: "planned".into(),
        points: time.iter().copied().zip(along.iter().copied()).collect(),
        stroke: WIDE,
    });
    let mut panels = 2;
    let mut depth = Panel::over_time("error of the height", "z_d − z", "m");
    if let Some(traced) = traced {
        let [x, y, z] = [0, 1, 2].map(|axis| record.values(Quantity::Tip(axis)));
        let points: Vec<(f64, f64)> = x.into_iter().zip(y).collect();
        plane.series.push(Series {
            name: if motion.sheet.is_some() { format!("{traced}, in the sheet") } else { traced.into() },
            points: where_cut(&points, &z, |z| z < top),
            stroke: style(0),
        });
        if motion.sheet.is_some() {
            plane.series.push(Series {
                name: format!("{traced}, above it"),
                points: where_cut(&points, &z, |z| z >= top),
                stroke: Stroke { width: 1.0, dash: "2 3", ..style(0) },
            });
        }
        let missed = z.iter().zip(&along).map(|(z, z_d)| z_d - z);
        depth.add("", time.iter().copied().zip(missed).collect());
        panels = 3;
        height.series.push(Series { name: traced.into(), points: time.iter().copied().zip(z).collect(), stroke: style(0) });
    }
    if let (Some(sheet), Some(first), Some(last)) = (motion.sheet, time.first(), time.last()) {
        let line = |z: f64| vec![(*first, z), (*last, z)];
        height.series.push(Series {
            name: "top of the sheet".into(),
            points: line(sheet.top),
            stroke: Stroke { width: 1.0, ..style(2) },
        });
        height.series.push(Series {
            name: "cutting depth".into(),
            points: line(sheet.depth),
            stroke: Stroke { width: 1.0, ..style(1) },
        });
    }
    if traced.is_none() {
        mark_points(motion, &mut plane);
    }
    figure(title, &[plane, height, depth][..panels], panels, (if panels == 2 { 450.0 } else { 390.0 }, 340.0))
}

/// The numbered ends of the segments; coincident points share a label.
fn mark_points(motion: &Motion, plane: &mut Panel) {
    let mut marks: Vec<(f64, f64, Vec<usize>)> = Vec::new();
    let segments = motion.trajectory.path.segments();
    let first = segments.first().map(|s| s.from());
    for (i, p) in first.into_iter().chain(segments.iter().map(|s| s.to())).enumerate() {
        match marks.iter_mut().find(|(x, y, _)| (x - p.x).hypot(y - p.y) < 1e-9) {
            Some((_, _, numbers)) => numbers.push(i),
            None => marks.push((p.x, p.y, vec![i])),
        }
    }
    let runs = |numbers: &[usize]| {
        let run = |run: &[usize]| if run.len() > 1 { format!("{}–{}", run[0], run[run.len() - 1]) } else { run[0].to_string() };
        numbers.chunk_by(|a, b| a + 1 == *b).map(run).collect::<Vec<_>>().join(", ")
    };
    plane.marks = marks.iter().map(|(x, y, numbers)| (*x, *y, runs(numbers))).collect();
}

/// Angle, speeds and accelerations over time.
pub(super) fn profiles(title: &str, record: &Record) -> String {
    let panel = |title: &str, symbol: &str, unit: &str, quantity: Quantity| {
        let mut panel = Panel::over_time(title, symbol, unit);
        panel.add("", record.series(quantity));
        panel
    };
    let panels = [
        panel("angle about z0", "φ", "rad", Quantity::Angle),
        panel("rate of the angle", "dφ/dt", "rad/s", Quantity::TurnRate),
        panel("speed along the path", "|v|", "m/s", Quantity::Speed),
        panel("acceleration", "|a|", "m/s²", Quantity::Acceleration),
    ];
    figure(title, &panels, 2, (430.0, 150.0))
}
