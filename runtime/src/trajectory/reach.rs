//! The reach of an arm, as far as a plan can know it without solving for joints.

use crate::linalg::direction;
use nalgebra::{RealField, Vector3};

/// A bound on positions: between two distances from a point (a spatial arm about its shoulder) or from an axis (a planar arm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach<T> {
    origin: Vector3<T>,
    axis: Option<Vector3<T>>,
    inner: T,
    outer: T,
}

impl<T: RealField + Copy> Reach<T> {
    /// All points between `inner` and `outer`, m, from the point `origin`.
    pub fn about_point(origin: [T; 3], inner: T, outer: T) -> Self {
        Self { origin: origin.into(), axis: None, inner, outer }
    }

    /// All points between `inner` and `outer`, m, from the line through `origin` along `axis`; `None` if the axis has no direction.
    pub fn about_axis(origin: [T; 3], axis: [T; 3], inner: T, outer: T) -> Option<Self> {
        let axis = direction(&Vector3::from(axis))?;
        Some(Self { origin: origin.into(), axis: Some(axis.into_inner()), inner, outer })
    }

    /// Distance of `point` from the point or axis, m.
    pub fn distance(&self, point: &Vector3<T>) -> T {
        let d = point - self.origin;
        match self.axis {
            None => d.norm(),
            Some(axis) => (d - axis * axis.dot(&d)).norm(),
        }
    }

    /// Whether `point` lies within, bounds included.
    pub fn contains(&self, point: &Vector3<T>) -> bool {
        let d = self.distance(point);
        d >= self.inner && d <= self.outer
    }
}
