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
    /// Where there is none, or one is named twice.
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
    /// Where there is none, one is beyond 5, or one is named twice.
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
    /// - two or three: the rows of the rotation vector of R_d R', [`orientation::rotation_vector`].
    ///
    /// The derivative of an angular row is the difference w_d - w of the angular velocities up to a term of the size |w| |e|: for the
    /// rotation vector it is w_d - w + (w_d + w)/2 x e + O(|e|^2), in which the added term is of second order where both velocities are
    /// small with the error. It is exact for a single angular row of an arm that turns about that axis alone.
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
            _ => {
                let turn = orientation::rotation_vector(&relative());
                for (i, row) in self.rows.iter().enumerate().filter(|(_, row)| row.is_angular()) {
                    e[i] = turn[row.index() - 3];
                }
            }
        }
        e
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_named_twice_is_refused() {
        assert_eq!(Task::new([Row::X, Row::Rz, Row::X]), Err(TaskError::Repeated(Row::X)));
        assert_eq!(Task::new([]), Err(TaskError::Empty));
        assert!(Task::new([Row::Rz, Row::X]).is_ok());
    }
}
