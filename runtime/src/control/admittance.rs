//! Admittance control, for arms that take positions: the measured force moves the reference.
//!
//! ```text
//! M dv + D v + K x = f,    dx = v        x: by how far the end effector gives way, f: the force on it, row by row of the task
//! ```
//!
//! Each row is advanced by the implicit rule v' = (m v + T (f - k x)) / (m + T d + T^2 k), x' = x + T v', which takes energy from every
//! motion whatever the period T. The pose is the reference moved by x: linear rows by their lengths, angular rows by the turn about
//! the vector of them. Its velocity and acceleration are those of the reference and of x, in angular rows to second order in x.
//!
//! The force closes a loop through the surroundings. An arm that follows its reference n samples late, against a surface of stiffness
//! k_e, needs about d > (n + 1) T k_e: D, not M, makes a contact stable.

use super::ControlError;
use crate::{
    linalg::{direction, is_finite},
    orientation::rotation,
    reference::OperationalReference,
    settings::{self, Setting, SettingError},
    task::Task,
};
use nalgebra::{RealField, SVector, Vector3, Vector6};

/// M dv + D v + K x = f, one row of the task after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Admittance<T, const M: usize> {
    task: Task<M>,
    mass: SVector<T, M>,
    damping: SVector<T, M>,
    stiffness: SVector<T, M>,
    period: T,
    displacement: SVector<T, M>,
    rate: SVector<T, M>,
}

impl<T: RealField + Copy, const M: usize> Admittance<T, M> {
    /// Diagonals of M, kg or kg m^2, of D, N s/m or N m s/rad, and of K, N/m or N m/rad, zero for a row that the hand moves
    /// freely; the sampling period, s.
    ///
    /// # Errors
    /// Where M, D or the period is not positive and finite, or K negative or not finite.
    pub fn new(task: Task<M>, mass: [T; M], damping: [T; M], stiffness: [T; M], period: T) -> Result<Self, SettingError> {
        let [mass, damping, stiffness] = [mass, damping, stiffness].map(SVector::from);
        settings::positive(Setting::Mass, &mass)?;
        settings::positive(Setting::Derivative, &damping)?;
        settings::not_negative(Setting::Stiffness, &stiffness)?;
        settings::positive_scalar(Setting::Period, period)?;
        Ok(Self { task, mass, damping, stiffness, period, displacement: SVector::zeros(), rate: SVector::zeros() })
    }

    /// x, m or rad, row by row of the task.
    pub fn displacement(&self) -> &SVector<T, M> {
        &self.displacement
    }

    /// The reference of the arm's position control: `reference`, moved by the `force` on the end effector, N and N m in the rows of the
    /// task, base frame.
    ///
    /// # Errors
    /// Where the force, the reference or the displacement is not finite; x stays as it was.
    pub fn step(
        &mut self,
        reference: &OperationalReference<T>,
        force: &SVector<T, M>,
    ) -> Result<OperationalReference<T>, ControlError> {
        if !is_finite(force) {
            return Err(ControlError::MeasurementNotFinite);
        }
        if !reference.is_finite() {
            return Err(ControlError::ReferenceNotFinite);
        }
        let h = self.period;
        let rate = SVector::<T, M>::from_fn(|i, _| {
            let (m, d, k) = (self.mass[i], self.damping[i], self.stiffness[i]);
            (m * self.rate[i] + h * (force[i] - k * self.displacement[i])) / (m + h * d + h * h * k)
        });
        let displacement = self.displacement + rate * h;
        let moved = self.moved(reference, &displacement, &rate, &((rate - self.rate) / h));
        if !(is_finite(&displacement) && moved.is_finite()) {
            return Err(ControlError::StateNotFinite);
        }
        (self.rate, self.displacement) = (rate, displacement);
        Ok(moved)
    }

    fn moved(
        &self,
        reference: &OperationalReference<T>,
        displacement: &SVector<T, M>,
        rate: &SVector<T, M>,
        acceleration: &SVector<T, M>,
    ) -> OperationalReference<T> {
        let six = |x: &SVector<T, M>| {
            let mut six = Vector6::<T>::zeros();
            for (i, row) in self.task.rows().iter().enumerate().take(M) {
                if let (Some(to), Some(from)) = (six.as_mut_slice().get_mut(row.index()), x.as_slice().get(i)) {
                    *to = *from;
                }
            }
            six
        };
        let by = six(displacement);
        let turn = Vector3::new(by[3], by[4], by[5]);
        let mut moved = *reference;
        moved.pose.position += Vector3::new(by[0], by[1], by[2]);
        if let Some(axis) = direction(&turn) {
            moved.pose.rotation = rotation(&axis, turn.norm()) * moved.pose.rotation;
        }
        moved.velocity += six(rate);
        moved.acceleration += six(acceleration);
        moved
    }
}
