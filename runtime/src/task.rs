//! The task: which rows of the operational space count.
//!
//! A velocity of the end effector has six rows, linear (x, y, z) then angular (rx, ry, rz), in the base frame. A four-joint arm can
//! follow four of them, a painting arm five. A task names M rows; Jacobians and errors are then M rows high, and an arm is singular
//! only where it loses a row of its task.

use crate::{orientation, reference::Pose};
use nalgebra::{RealField, SMatrix, SVector, Vector6};

/// A row of the operational space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Row {
    /// Translation along x0.
    X,
    /// Translation along y0.
    Y,
    /// Translation along z0.
    Z,
    /// Rotation about x0.
    Rx,
    /// Rotation about y0.
    Ry,
    /// Rotation about z0.
    Rz,
}

impl Row {
    /// All of them, each at its place in a six-vector.
    pub const ALL: [Row; 6] = [Row::X, Row::Y, Row::Z, Row::Rx, Row::Ry, Row::Rz];

    /// Its place in a six-vector, 0 to 5.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Whether it is a rotation.
    pub const fn is_angular(self) -> bool {
        self.index() >= 3
    }
}

impl core::fmt::Display for Row {
    /// `x`, `y`, `z`, `rx`, `ry`, `rz`: as descriptions name them.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Row::X => "x",
            Row::Y => "y",
            Row::Z => "z",
            Row::Rx => "rx",
            Row::Ry => "ry",
            Row::Rz => "rz",
        })
    }
}

/// `M` different rows of the operational space, in the order in which the task lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task<const M: usize> {
    rows: [Row; M],
}

/// Why a selection of rows is not a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskError {
    /// No row was named.
    Empty,
    /// This row was named twice; its Jacobian would be singular everywhere.
    Repeated(Row),
    /// There is no row of this index.
    NoSuchRow(usize),
}

messages! { TaskError,
    TaskError::Empty => "no row was named";
    TaskError::Repeated(row) => "row {} was named twice: its Jacobian would be singular everywhere", row;
    TaskError::NoSuchRow(index) => "there is no row {}: 0 to 2 are x, y, z, and 3 to 5 the rotations about them", index;
}

impl Task<6> {
    /// All six rows, in order.
    pub const fn full() -> Self {
        Self { rows: Row::ALL }
    }
}

impl<const M: usize> Task<M> {
    /// The task of these rows.
    ///
    /// # Errors
    /// Where `rows` is empty or repeats a row.
    pub fn new(rows: [Row; M]) -> Result<Self, TaskError> {
        if M == 0 {
            return Err(TaskError::Empty);
        }
        for (i, row) in rows.iter().enumerate() {
            if rows[..i].contains(row) {
                return Err(TaskError::Repeated(*row));
            }
        }
        Ok(Self { rows })
    }

    /// The task of the rows at these places of a six-vector: `Task::from_indices(robot::TASK)` is the task of an emitted robot.
    ///
    /// # Errors
    /// Where `indices` is empty, repeats an index, or holds an index beyond 5.
    pub fn from_indices(indices: [usize; M]) -> Result<Self, TaskError> {
        let mut rows = [Row::X; M];
        for (row, index) in rows.iter_mut().zip(indices) {
            *row = *Row::ALL.get(index).ok_or(TaskError::NoSuchRow(index))?;
        }
        Self::new(rows)
    }

    /// The rows, in the order of the task.
    pub const fn rows(&self) -> &[Row; M] {
        &self.rows
    }

    /// The task's rows of a six-vector (linear, angular).
    #[inline]
    pub fn select<T: RealField + Copy>(&self, v: &Vector6<T>) -> SVector<T, M> {
        SVector::from_fn(|i, _| v[self.rows[i].index()])
    }

    /// The task's rows of a geometric Jacobian or of its derivative.
    #[inline]
    pub fn jacobian<T: RealField + Copy, const N: usize>(&self, j: &SMatrix<T, 6, N>) -> SMatrix<T, M, N> {
        SMatrix::from_fn(|i, k| j[(self.rows[i].index(), k)])
    }

    /// Error of the actual pose against the desired one, desired minus actual; m and rad.
    ///
    /// Linear rows are differences of positions. Angular rows:
    /// - one angular row: the turn about that axis alone that brings the actual orientation nearest to the desired one,
    ///   [`orientation::turn_about`]. For an arm that can turn about this axis only it is the difference of the angles, in (-pi, pi];
    /// - two: the swing of R_d R' without the turn about the third axis, [`orientation::swing`]. The turn about the third axis is
    ///   free and does not enter;
    /// - three: the rotation vector of R_d R', [`orientation::rotation_vector`].
    ///
    /// How angular rows change with the angular velocities w_d and w: with two rows, let i be the missing axis; with one row, its
    /// own axis. Let R_d R' be the turn by theta about i after the swing by phi about r, and v = Rot(i, -theta) w_d. Then
    /// - three rows: de = w_d - w + (w_d + w)/2 x e + O(|e|^2 (|w_d| + |w|)), where the added term is of second order where both velocities
    ///   are small with the error;
    /// - two rows: de = v - w + w_i i x e + O(|e|^2 (|v| + |w|)) in the rows, and d|e| = r.(v - w) exactly. So the error closes as fast
    ///   whatever the free turn theta, but a velocity w_d that is fed forward is the right one where theta = 0 alone;
    /// - one row: de = w_d,i - w_i - tan(phi/2) (v + w).(i x r) exactly, and w_d - w for an arm that turns about that axis alone.
    pub fn error<T: RealField + Copy>(&self, desired: &Pose<T>, actual: &Pose<T>) -> SVector<T, M> {
        let linear = desired.position - actual.position;
        let relative = || desired.rotation * actual.rotation.transpose();
        let mut e = SVector::from_fn(|i, _| if self.rows[i].is_angular() { T::zero() } else { linear[self.rows[i].index()] });
        match self.rows.iter().filter(|row| row.is_angular()).count() {
            0 => {}
            1 => {
                let relative = relative();
                for (i, row) in self.rows.iter().enumerate().filter(|(_, row)| row.is_angular()) {
                    e[i] = orientation::turn_about(&relative, row.index() - 3);
                }
            }
            angular => {
                let relative = relative();
                let turn = match self.free_axis() {
                    Some(axis) if angular == 2 => orientation::swing(&relative, axis),
                    _ => orientation::rotation_vector(&relative),
                };
                for (i, row) in self.rows.iter().enumerate().filter(|(_, row)| row.is_angular()) {
                    e[i] = turn[row.index() - 3];
                }
            }
        }
        e
    }

    /// The first axis about which the task leaves the turn free.
    fn free_axis(&self) -> Option<usize> {
        [Row::Rx, Row::Ry, Row::Rz].iter().position(|row| !self.rows.contains(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angular_rows_change_as_stated() {
        use crate::orientation::rotation;
        use nalgebra::{Unit, Vector3};
        let about = |w: Vector3<f64>, t: f64| rotation(&Unit::new_normalize(w), w.norm() * t);
        let (w_d, w) = (Vector3::new(0.3, -0.8, 0.5), Vector3::new(-0.7, 0.2, 0.4));
        let (z, r) = (Vector3::z(), Vector3::new(0.6, -0.8, 0.0));
        let p = z.cross(&r);
        let pose = |rotation| Pose { position: Vector3::zeros(), rotation };
        for theta in [-3.0, -1.0, 0.0, 2.0] {
            for phi in [0.1f64, 1.0, 2.5] {
                let e = about(z, theta) * about(r, phi);
                let v = about(z, -theta) * w_d;
                let rate = |task: &dyn Fn(&Pose<f64>, &Pose<f64>) -> Vector3<f64>| {
                    let at = |t: f64| task(&pose(about(w_d, t) * e), &pose(about(w, t)));
                    (at(1e-5) - at(-1e-5)) / 2e-5
                };
                let two = Task::new([Row::Rx, Row::Ry]).unwrap();
                let found = rate(&|desired, actual| two.error(desired, actual).push(0.0));
                // Without the expansion in |e|: phi / sin(phi) and phi cot(phi) are 1 to second order.
                let across = phi / phi.sin() * v.dot(&p) - phi / phi.tan() * w.dot(&p) + phi * w.z;
                assert!((found - r * (v - w).dot(&r) - p * across).norm() < 1e-8, "{theta} {phi}: {found}");
                let one = Task::new([Row::Rz]).unwrap();
                let found = rate(&|desired, actual| z * one.error(desired, actual)[0]).z;
                assert!((found - (w_d.z - w.z - (phi / 2.0).tan() * (v + w).dot(&p))).abs() < 1e-8, "{theta} {phi}: {found}");
            }
        }
        let all = Task::new([Row::Rx, Row::Ry, Row::Rz]).unwrap();
        let turn = Vector3::new(1e-3, -2e-3, 3e-3);
        let at = |t: f64| all.error(&pose(about(w_d, t) * about(turn, 1.0)), &pose(about(w, t)));
        let found = (at(1e-5) - at(-1e-5)) / 2e-5;
        assert!((found - (w_d - w + (w_d + w).cross(&turn) / 2.0)).norm() < 2.0 * turn.norm_squared(), "{found}");
    }

    /// dw = K_P e - K_D w with K_P = k^2, K_D = 2 k, and w = K e, of a body that nothing turns about the axis left out.
    #[test]
    fn a_free_turn_does_not_disturb_the_loop() {
        use crate::orientation::rotation;
        use nalgebra::{Unit, Vector3};
        let task = Task::new([Row::Rx, Row::Ry]).unwrap();
        let pose = |rotation| Pose { position: Vector3::zeros(), rotation };
        let desired = pose(rotation(&Vector3::z_axis(), 0.4));
        for theta in [0.0, 1.0, 2.0, 2.6, 3.0, 3.1, -3.0] {
            let tilted = rotation(&Unit::new_normalize(Vector3::new(0.3, -0.4, 0.0)), 0.5);
            let start = rotation(&Vector3::z_axis(), 0.4 - theta) * tilted;
            let first = task.error(&desired, &pose(start)).norm();
            for gain in [0.15, 1.0] {
                let (mut r, mut size): (_, f64) = (start, first);
                for sample in 0..20 {
                    let e = task.error(&desired, &pose(r));
                    r = e
                        .push(0.0)
                        .try_normalize(1e-12)
                        .map_or(r, |axis| rotation(&Unit::new_unchecked(axis), gain * e.norm()) * r);
                    size *= 1.0 - gain;
                    let found = task.error(&desired, &pose(r)).norm();
                    assert!((found - size).abs() < 1e-14, "turn {theta}, gain {gain}, sample {sample}: {found} {size}");
                }
            }
            let (k, h) = (20.0, 1e-5);
            let (mut r, mut w, mut worst) = (start, Vector3::zeros(), 0.0f64);
            for step in 0..30_000 {
                let e = task.error(&desired, &pose(r)).push(0.0);
                let t = f64::from(step) * h;
                worst = worst.max((e.norm() - first * (1.0 + k * t) * (-k * t).exp()).abs());
                w += (e * (k * k) - w * (2.0 * k)) * h;
                r = w.try_normalize(0.0).map_or(r, |axis| rotation(&Unit::new_unchecked(axis), w.norm() * h) * r);
            }
            assert!(worst < 1e-4, "turn {theta}: off the critically damped error by {worst}");
        }
    }

    #[test]
    fn a_row_named_twice_is_refused() {
        assert_eq!(Task::new([Row::X, Row::Rz, Row::X]), Err(TaskError::Repeated(Row::X)));
        assert_eq!(Task::new([]), Err(TaskError::Empty));
        assert!(Task::new([Row::Rz, Row::X]).is_ok());
    }
}
