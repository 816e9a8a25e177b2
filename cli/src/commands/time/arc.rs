//! Circular arcs of the end effector.

use std::f64::consts::TAU;

use nalgebra::Vector3;

/// Directions closer than this, rad, make no corner, and three positions no circle.
pub(super) const STRAIGHT: f64 = 1e-6;

/// A circular arc of positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    centre: Vector3<f64>,
    /// From the centre to the start, and as long in the direction of the motion there.
    axes: [Vector3<f64>; 2],
    angle: f64,
}

impl Arc {
    /// From a through `via` to b; `None` where the three lie on a line.
    pub(super) fn new([a, via, b]: [Vector3<f64>; 3]) -> Option<Arc> {
        let (u, w) = (via - a, b - a);
        let normal = u.cross(&w);
        let is_bent = normal.norm() > STRAIGHT * u.norm() * w.norm();
        if !is_bent {
            return None;
        }
        let centre = a + (w * u.norm_squared() - u * w.norm_squared()).cross(&normal) / (2.0 * normal.norm_squared());
        let (first, last) = (a - centre, b - centre);
        let second = normal.normalize().cross(&first);
        let angle = last.dot(&second).atan2(last.dot(&first)).rem_euclid(TAU);
        Some(Arc { centre, axes: [first, second], angle })
    }

    /// Position, and its derivative by `share`, from 0 at the start to 1 at the end.
    pub(super) fn at(&self, share: f64) -> [Vector3<f64>; 2] {
        let (sine, cosine) = (self.angle * share).sin_cos();
        let [first, second] = self.axes;
        [self.centre + first * cosine + second * sine, (second * cosine - first * sine) * self.angle]
    }
}
