//! Postures of the arm with the ellipsoids of velocity and force, seen at right angles to a plane.

use armgen_generated::Nominal;
use armgen_runtime::manipulability::Ellipsoid;
use armgen_runtime::robot::Kinematics;
use armgen_runtime::task::Row;

use super::plot::{figure, style, Panel, Series};
use super::svg::{Stroke, INK};
use crate::experiments::{ellipses, plane_name, Joints, Postures};

/// The ellipse about a point, its axes as long as the file of ellipsoids says times `scale`.
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
fn links(plane: [Row; 2], q: &Joints) -> Vec<(f64, f64)> {
    let [a, b] = plane.map(Row::index);
    let frames = Nominal.link_frames(q);
    let mut points = vec![(0.0, 0.0)];
    points.extend(frames.iter().map(|t| (t[(a, 3)], t[(b, 3)])));
    let tip = Nominal.direct_kinematics(q);
    points.push((tip[(a, 3)], tip[(b, 3)]));
    points
}

const ARM: Stroke = Stroke { colour: INK, width: 3.0, dash: "" };

fn axes(plane: [Row; 2]) -> ((String, String), (String, String)) {
    let name: Vec<String> = plane_name(plane).chars().map(String::from).collect();
    ((name[0].clone(), "m".into()), (name[1].clone(), "m".into()))
}

/// Each posture with both ellipsoids; their scales stand in the legends.
pub(super) fn postures(title: &str, postures: &Postures) -> String {
    const VELOCITY: f64 = 0.25;
    let panels: Vec<Panel> = postures
        .list
        .iter()
        .map(|(name, q)| {
            let (x, y) = axes(postures.plane);
            let arm = links(postures.plane, q);
            let tip = arm.last().copied().unwrap_or_default();
            let (v, f) = ellipses(postures.plane, q);
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
                points: ellipse(tip, &v, VELOCITY),
                stroke: style(0),
            });
            if let Some(f) = f.filter(|f| f.semi_axes.max() < 1e6) {
                // The longer semi-axis fits beside the arm: a round scale below 0.6 m.
                let wanted = 0.6 / f.semi_axes.max();
                let power = 10f64.powf(wanted.log10().floor());
                let scale = [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|s| *s <= wanted).unwrap_or(power);
                let name = format!("force, 1 N = {} m", (scale * 1e6).round() / 1e6);
                panel.series.push(Series { name, points: ellipse(tip, &f, scale), stroke: style(1) });
            }
            panel.marks = vec![(arm[0].0, arm[0].1, String::new()), (tip.0, tip.1, String::new())];
            panel
        })
        .collect();
    figure(title, &panels, 3, (320.0, 250.0))
}

/// Both ellipsoids over all postures of the grid; `None` without one.
pub(super) fn workspace(postures: &Postures) -> Option<String> {
    let [first, second] = postures.grid.as_ref()?;
    let (x, y) = axes(postures.plane);
    let mut panels = ["velocity: 1 m/s = 0.08 m", "force: 1 N = 0.025 m"].map(|title| Panel {
        title: title.into(),
        x: x.clone(),
        y: y.clone(),
        equal: true,
        ..Panel::default()
    });
    for a in first {
        for b in second {
            let mut q = Joints::zeros();
            for (i, value) in [a, b].into_iter().enumerate().take(q.len()) {
                q[i] = *value;
            }
            let Some(tip) = links(postures.plane, &q).last().copied() else { continue };
            let (v, f) = ellipses(postures.plane, &q);
            let stroke = |i: usize| Stroke { width: 0.9, dash: "", ..style(i) };
            panels[0].series.push(Series { name: String::new(), points: ellipse(tip, &v, 0.08), stroke: stroke(0) });
            if let Some(f) = f.filter(|f| f.semi_axes.max() < 1e6) {
                panels[1].series.push(Series { name: String::new(), points: ellipse(tip, &f, 0.025), stroke: stroke(1) });
            }
        }
    }
    for panel in &mut panels {
        panel.marks.push((0.0, 0.0, "base".into()));
    }
    Some(figure("Ellipsoids over the workspace", &panels, 2, (440.0, 364.0)))
}
