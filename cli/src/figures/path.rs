//! The path in the plane of the sheet: as planned, and as the tip traced it; its height over time; its profiles.

use super::plot::{figure, style, Panel, Series};
use super::svg::Stroke;
use crate::experiments::{Motion, Record};

fn column(record: &Record, name: &str) -> Vec<f64> {
    record.log.column(name).map(Iterator::collect).unwrap_or_default()
}

fn over_time(record: &Record, name: &str) -> Vec<(f64, f64)> {
    column(record, "t").into_iter().zip(column(record, name)).collect()
}

/// The points where a condition holds, cut (by a NaN) where it does not.
fn where_cut(points: &[(f64, f64)], z: &[f64], shown: impl Fn(f64) -> bool) -> Vec<(f64, f64)> {
    points.iter().zip(z).map(|(p, z)| if shown(*z) { *p } else { (f64::NAN, f64::NAN) }).collect()
}

/// The plan alone, or the plan under what the tip `traced`.
pub(super) fn plan(title: &str, motion: &Motion, record: &Record, traced: Option<&str>) -> String {
    let samples: Vec<_> = column(record, "t")
        .iter()
        .map(|t| motion.trajectory.sample(std::time::Duration::from_secs_f64(*t)).pose.position)
        .collect();
    let planned: Vec<(f64, f64)> = samples.iter().map(|p| (p.x, p.y)).collect();
    let planned_z: Vec<f64> = samples.iter().map(|p| p.z).collect();
    let top = motion.sheet.map_or(f64::INFINITY, |sheet| sheet.top);
    let metres = |name: &str| (name.to_owned(), "m".to_owned());
    let mut plane = Panel { title: "seen from above".into(), x: metres("x"), y: metres("y"), equal: true, ..Panel::default() };
    let wide = Stroke { colour: "#f0b070", width: 4.0, dash: "" };
    let planned_name = if motion.sheet.is_some() { "planned, in the sheet" } else { "planned" };
    plane.series.push(Series { name: planned_name.into(), points: where_cut(&planned, &planned_z, |z| z < top), stroke: wide });
    if motion.sheet.is_some() {
        let pale = Stroke { colour: "#8c8c8c", width: 1.0, dash: "2 3" };
        plane.series.push(Series {
            name: "planned, above it".into(),
            points: where_cut(&planned, &planned_z, |z| z >= top),
            stroke: pale,
        });
    }
    let mut height = Panel::over_time("height of the tip", "z", "m");
    let time = column(record, "t");
    height.series.push(Series {
        name: "planned".into(),
        points: time.iter().copied().zip(planned_z.iter().copied()).collect(),
        stroke: wide,
    });
    if let Some(traced) = traced {
        let (x, y, z) = (column(record, "x"), column(record, "y"), column(record, "z"));
        let points: Vec<(f64, f64)> = x.into_iter().zip(y).collect();
        plane.series.push(Series {
            name: format!("{traced}, in the sheet"),
            points: where_cut(&points, &z, |z| z < top),
            stroke: style(0),
        });
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
    figure(title, &[plane, height], 2, (450.0, 340.0))
}

/// The ends of the segments, numbered; points at one place share their numbers.
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
    let panel = |title: &str, quantity: &str, unit: &str, name: &str| {
        let mut panel = Panel::over_time(title, quantity, unit);
        panel.add("", over_time(record, name));
        panel
    };
    let panels = [
        panel("angle about z0", "φ", "rad", "angle"),
        panel("rate of the angle", "dφ/dt", "rad/s", "turn_rate"),
        panel("speed along the path", "|v|", "m/s", "speed"),
        panel("acceleration", "|a|", "m/s²", "acceleration"),
    ];
    figure(title, &panels, 2, (430.0, 150.0))
}
