//! Orientation errors, from rotation matrices and from quaternions.
//!
//! Let E = R_d R_e' be the rotation, in the base frame, that takes the actual orientation R_e to the desired one R_d: a turn by
//! theta about the unit vector r. Its skew part holds r sin(theta), its trace 1 + 2 cos(theta). Three error vectors and one angle
//! follow, all in the base frame, all desired minus actual:
//!
//! ```text
//! theta r                                          rotation vector: grows with the angle up to pi
//! sin(theta) r = 1/2 (n x n_d + s x s_d + a x a_d)  (the book, Sect. 3.7.3): vanishes again at pi
//! sin(theta/2) r                                   vector part of the quaternion (the book, Sect. 3.7.3)
//! atan2 about one axis                             the angle for tasks with a single angular row
//! swing beside one axis                            the error for tasks with two angular rows: E but for a free turn about the third axis
//! ```
//!
//! For small turns theta r and sin(theta) r agree, and sin(theta/2) r is half of them: it wants twice the gain.

use crate::linalg::lit;
use crate::scalar::sin_cos;
use nalgebra::{Matrix3, RealField, Rotation3, Unit, UnitQuaternion, Vector3};

/// sin(theta) r of a rotation matrix: the axial vector of its skew part.
#[inline]
fn axial<T: RealField + Copy>(e: &Matrix3<T>) -> Vector3<T> {
    Vector3::new(e[(2, 1)] - e[(1, 2)], e[(0, 2)] - e[(2, 0)], e[(1, 0)] - e[(0, 1)]) * lit::<T>(0.5)
}

/// Rotation vector theta r of the rotation matrix `e`, theta in [0, pi]; rad.
///
/// Accurate to a few roundings for every angle. At half a turn the sign of r is free: the first component with a magnitude above
/// 1e-3 is taken positive.
pub fn rotation_vector<T: RealField + Copy>(e: &Matrix3<T>) -> Vector3<T> {
    let v = axial(e);
    let (sine, cosine) = (v.norm(), (e.trace() - T::one()) * lit::<T>(0.5));
    if cosine > -lit::<T>(0.5) {
        if sine == T::zero() {
            return Vector3::zeros();
        }
        return v * (sine.atan2(cosine) / sine);
    }
    // Near half a turn the skew part fades; the symmetric part, S = r r' (1 - cos) + cos I, holds the axis.
    let symmetric = (e + e.transpose()) * lit::<T>(0.5) - Matrix3::from_diagonal_element(cosine);
    let mut largest = 0;
    for i in 1..3 {
        if symmetric[(i, i)] > symmetric[(largest, largest)] {
            largest = i;
        }
    }
    let column: Vector3<T> = symmetric.column(largest).into_owned();
    let mut r = column / column.norm();
    let along = r.dot(&v);
    let first_is_negative = r.iter().find(|x| x.abs() > lit(1e-3)).is_some_and(|x| *x < T::zero());
    if along < T::zero() || (along == T::zero() && first_is_negative) {
        r = -r;
    }
    r * sine.atan2(cosine)
}

/// Angle of the turn about base axis `axis` (0, 1, 2 for x, y, z) that comes nearest to the rotation `e`; rad, in (-pi, pi].
///
/// It maximises the trace of `Rot(axis, angle)' e`: atan2(e_kj - e_jk, e_jj + e_kk) with j, k the other two axes in cyclic order.
/// Where the axes are opposed (e turns `axis` over), within 16 roundings, every angle is as near, and the result is 0.
pub fn turn_about<T: RealField + Copy>(e: &Matrix3<T>, axis: usize) -> T {
    let [_, j, k] = cyclic(axis);
    let sine = e[(k, j)] - e[(j, k)];
    let cosine = e[(j, j)] + e[(k, k)];
    if sine.abs() + cosine.abs() <= T::default_epsilon() * lit(16.0) {
        return T::zero();
    }
    sine.atan2(cosine)
}

/// Rotation vector of the swing of `e` relative to base axis `axis` (0, 1, 2 for x, y, z); rad, of a length in [0, pi], at right
/// angles to `axis`.
///
/// `e` is a swing, about an axis at right angles to `axis`, and after it a turn about `axis`, which does not count. With i the axis and
/// (i, j, k) in cyclic order the swing turns by phi = atan2(s, e_ii), s = |(e_ij, e_ik)|, and is (phi/s) (e_ik, -e_ij) in j and k. Where
/// `e` turns `axis` over its direction is free, and j is taken.
pub fn swing<T: RealField + Copy>(e: &Matrix3<T>, axis: usize) -> Vector3<T> {
    let [i, j, k] = cyclic(axis);
    let (x, y, cosine) = (e[(i, k)], -e[(i, j)], e[(i, i)]);
    let mut swing = Vector3::zeros();
    // The direction first: an angle over a subnormal sine is beyond the scalar, and so may be the square of a sine.
    let largest = x.abs().max(y.abs());
    if largest > T::zero() {
        let (x, y) = (x / largest, y / largest);
        let norm = (x * x + y * y).sqrt();
        let angle = (norm * largest).atan2(cosine) / norm;
        (swing[j], swing[k]) = (angle * x, angle * y);
    } else if cosine < T::zero() {
        swing[j] = T::pi();
    }
    swing
}

/// An axis and the other two after it: 0, 1, 2 from any of them on.
fn cyclic(axis: usize) -> [usize; 3] {
    match axis {
        0 => [0, 1, 2],
        1 => [1, 2, 0],
        _ => [2, 0, 1],
    }
}

/// Orientation error e_O = 1/2 (n x n_d + s x s_d + a x a_d) = sin(theta) r of rotation matrices (the book, Sect. 3.7.3).
pub fn sine_error<T: RealField + Copy>(desired: &Matrix3<T>, actual: &Matrix3<T>) -> Vector3<T> {
    axial(&(desired * actual.transpose()))
}

/// Orientation error e_O = eta_e eps_d - eta_d eps_e - S(eps_d) eps_e = sin(theta/2) r of quaternions (the book, Sect. 3.7.3),
/// of the two turns the shorter one.
///
/// It is the vector part of the Hamilton product Q_d Q_e^-1, the turn from the actual to the desired orientation in the base frame.
pub fn quaternion_error<T: RealField + Copy>(desired: &UnitQuaternion<T>, actual: &UnitQuaternion<T>) -> Vector3<T> {
    let e = desired * actual.inverse();
    let vector = e.imag();
    // q and -q are the same orientation; the one with a positive scalar part turns by less than pi.
    if e.scalar() < T::zero() {
        -vector
    } else {
        vector
    }
}

/// The unit quaternion of a rotation matrix.
pub fn quaternion<T: RealField + Copy>(r: &Matrix3<T>) -> UnitQuaternion<T> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*r))
}

/// Rotation by `angle`, rad, about the unit vector `axis` (the book, eq. 2.25).
pub fn rotation<T: RealField + Copy>(axis: &Unit<Vector3<T>>, angle: T) -> Matrix3<T> {
    if angle == T::zero() {
        return Matrix3::identity();
    }
    let (sine, cosine) = sin_cos(angle);
    let (x, y, z) = (axis.x, axis.y, axis.z);
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let less = T::one() - cosine;
    Matrix3::new(
        xx + (T::one() - xx) * cosine,
        x * y * less - z * sine,
        x * z * less + y * sine,
        x * y * less + z * sine,
        yy + (T::one() - yy) * cosine,
        y * z * less - x * sine,
        x * z * less - y * sine,
        y * z * less + x * sine,
        zz + (T::one() - zz) * cosine,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    #[test]
    fn every_error_is_the_turn_it_measures() {
        let axis = Unit::new_normalize(Vector3::new(0.3, -0.5, 0.8));
        let actual = rotation(&Unit::new_normalize(Vector3::new(1.0, 2.0, -0.4)), 0.7);
        for angle in [0.0, 1e-9, 1e-4, 0.5, 1.5, 2.5, 3.1, PI - 1e-7] {
            let desired = rotation(&axis, angle) * actual;
            let e = desired * actual.transpose();
            assert!((rotation_vector(&e) - axis.into_inner() * angle).norm() < 4e-15, "{angle}");
            assert!((sine_error(&desired, &actual) - axis.into_inner() * angle.sin()).norm() < 1e-15);
            let q = quaternion_error(&quaternion(&desired), &quaternion(&actual));
            assert!((q - axis.into_inner() * (angle / 2.0).sin()).norm() < 1e-15, "{angle}");
        }
    }

    #[test]
    fn an_axis_that_is_turned_over_has_no_turn_about_it() {
        // Half a turn about any axis at right angles to the one asked for.
        for degrees in 0..360 {
            let (s, c) = f64::from(degrees).to_radians().sin_cos();
            for (axis, over) in [(0, Vector3::new(0.0, c, s)), (1, Vector3::new(s, 0.0, c)), (2, Vector3::new(c, s, 0.0))] {
                let e = rotation(&Unit::new_normalize(over), PI);
                assert_eq!(turn_about(&e, axis), 0.0, "{degrees} degrees, {e}");
                let swing = swing(&e, axis);
                assert!((swing.norm() - PI).abs() < 1e-15 && swing.cross(&over).norm() < 1e-14, "{degrees} degrees, {swing}");
            }
        }
        let over = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        assert_eq!((swing(&over, 0), swing(&over, 2)), (Vector3::zeros(), Vector3::x() * PI));
        // A sine below the smallest normal number.
        let mut barely = Matrix3::new(-1.0f32, 0.0, 1e-39, 0.0, 1.0, 0.0, 1e-39, 0.0, -1.0);
        assert_eq!(swing(&barely, 0), Vector3::y() * std::f32::consts::PI);
        barely.swap((0, 1), (0, 2));
        assert_eq!(swing(&barely, 0), -Vector3::z() * std::f32::consts::PI);
    }

    #[test]
    fn a_swing_does_not_see_the_turn_after_it() {
        for axis in 0..3 {
            let [_, j, k] = cyclic(axis);
            let mut unit = Vector3::zeros();
            unit[axis] = 1.0;
            for angle in [0.0, 1e-12, 0.3, 1.5, 3.0, PI - 1e-7] {
                let mut expected = Vector3::zeros();
                (expected[j], expected[k]) = (0.6 * angle, -0.8 * angle);
                let about = Unit::new_normalize(if angle > 0.0 { expected } else { Vector3::x() });
                for turn in [0.0, 0.5, -3.0, PI] {
                    let e = rotation(&Unit::new_unchecked(unit), turn) * rotation(&about, angle);
                    assert!((swing(&e, axis) - expected).norm() < 1e-15, "{axis} {angle} {turn}: {}", swing(&e, axis));
                }
            }
        }
    }

    #[test]
    fn half_a_turn_has_an_axis() {
        for axis in [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(1.0, -2.0, 0.5).normalize()] {
            let e = rotation(&Unit::new_unchecked(axis), PI);
            let v = rotation_vector(&e);
            assert!((v.norm() - PI).abs() < 1e-14 && v.cross(&axis).norm() < 1e-14, "{v}");
        }
    }

    #[test]
    fn a_turn_about_one_axis_ignores_the_tilt() {
        for axis in 0..3 {
            let mut unit = Vector3::zeros();
            unit[axis] = 1.0;
            for angle in [-3.0f64, -0.2, 0.0, 1e-12, 1.0, 3.1] {
                assert!((turn_about(&rotation(&Unit::new_unchecked(unit), angle), axis) - angle).abs() < 1e-15);
            }
        }
    }
}
