//! Postures of the arm with velocity and force ellipsoids, projected onto a plane.

use armgen_runtime::manipulability::Ellipsoid;
use armgen_runtime::task::Row;

use super::plot::{figure, style, Panel, Series};
use super::svg::{Stroke, INK};
use crate::model::{Posture, Postures, Shape, Shapes};

/// The ellipse around a point, with its semi-axes multiplied by `scale`.
fn ellipse(centre: (f64, f64), ellipsoid: &Ellipsoid<f64, 2>, scale: f64) -> Vec<(f64, f64)> {
    let (a, u) = (&ellipsoid.semi_axes, &ellipsoid.directions);
    let point = |k: usize| {
        let (s, c) = (k as f64 / 72.0 * std::f64::consts::TAU).sin_cos();
        let at = |row: usize| scale * (u[(row, 0)] * a[0] * c + u[(row, 1)] * a[1] * s);
        (centre.0 + at(0), centre.1 + at(1))
    };
    (0..=72).map(point).collect()
}

/// The origins of the base and of all link frames, and the tip, in the plane.
fn links(plane: [Row; 2], shape: &Shape) -> Vec<(f64, f64)> {
    let [a, b] = plane.map(Row::index);
    shape.points.iter().map(|p| (p[a], p[b])).collect()
}

/// The force ellipsoid, if its size is drawable.
fn force(shape: &Shape) -> Option<&Ellipsoid<f64, 2>> {
    shape.force.as_ref().filter(|force| force.semi_axes.max() < 1e6)
}

const ARM: Stroke = Stroke { colour: INK, width: 3.0, dash: "" };

fn axes(plane: [Row; 2]) -> ((String, String), (String, String)) {
    let [x, y] = plane.map(|row| (row.to_string(), "m".to_owned()));
    (x, y)
}

/// Each posture with both ellipsoids; the legends give their scales.
pub(super) fn postures(title: &str, postures: &Postures, shapes: &Shapes) -> String {
    const VELOCITY: f64 = 0.25;
    let panels: Vec<Panel> = postures
        .list
        .iter()
        .zip(&shapes.postures)
        .map(|(Posture { name, .. }, shape)| {
            let (x, y) = axes(postures.plane);
            let arm = links(postures.plane, shape);
            let tip = arm.last().copied().unwrap_or_default();
            let v = &shape.velocity;
            let mut panel = Panel {
                title: format!("{name}: σ = {:.3}, {:.3}", v.semi_axes[0], v.semi_axes[1]),
                x,
                y,
                equal: true,
                ..Panel::default()
            };
            panel.series.push(Series { name: "arm".into(), points: arm.clone(), stroke: ARM });
            panel.series.push(Series {
                name: format!("velocity, 1 m/s = {VELOCITY} m"),
                points: ellipse(tip, v, VELOCITY),
                stroke: style(0),
            });
            if let Some(f) = force(shape) {
                // The longer semi-axis fits next to the arm: a round scale below 0.6 m.
                let wanted = 0.6 / f.semi_axes.max();
                let power = 10f64.powf(wanted.log10().floor());
                let scale = [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|s| *s <= wanted).unwrap_or(power);
                let name = format!("force, 1 N = {} m", (scale * 1e6).round() / 1e6);
                panel.series.push(Series { name, points: ellipse(tip, f, scale), stroke: style(1) });
            }
            panel.marks = vec![(arm[0].0, arm[0].1, String::new()), (tip.0, tip.1, String::new())];
            panel
        })
        .collect();
    figure(title, &panels, 3, (320.0, 250.0))
}

/// Both ellipsoids over all postures of the grid.
pub(super) fn workspace(postures: &Postures, shapes: &Shapes) -> String {
    let (x, y) = axes(postures.plane);
    let mut panels = ["velocity: 1 m/s = 0.08 m", "force: 1 N = 0.025 m"].map(|title| Panel {
        title: title.into(),
        x: x.clone(),
        y: y.clone(),
        equal: true,
        ..Panel::default()
    });
    for shape in &shapes.grid {
        let Some(tip) = links(postures.plane, shape).last().copied() else { continue };
        let stroke = |i: usize| Stroke { width: 0.9, dash: "", ..style(i) };
        panels[0].series.push(Series { name: String::new(), points: ellipse(tip, &shape.velocity, 0.08), stroke: stroke(0) });
        if let Some(f) = force(shape) {
            panels[1].series.push(Series { name: String::new(), points: ellipse(tip, f, 0.025), stroke: stroke(1) });
        }
    }
    for panel in &mut panels {
        panel.marks.push((0.0, 0.0, "base".into()));
    }
    figure("Ellipsoids over the workspace", &panels, 2, (440.0, 364.0))
}
