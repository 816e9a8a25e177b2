//! First-order algorithms: joint rates from the error of the pose and the desired velocity.

use super::{ClikError, Objective};
use crate::{
    linalg::{left_singular, Damping, RightInverse},
    robot::Kinematics,
    settings::{self, Setting, SettingError},
};
use nalgebra::{RealField, SMatrix, SVector};

/// Joint rates of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<T, const N: usize> {
    /// Joint rates, rad/s or m/s; not bounded yet.
    pub dq: SVector<T, N>,
    /// Whether the inverse was damped.
    pub damped: bool,
}

/// A law that turns errors into joint rates.
pub trait Algorithm<R: Kinematics<N>, const N: usize, const M: usize> {
    /// Diagonal of K. The joint rates that follow from the error vanish where J' K e = 0.
    fn gain(&self) -> SVector<R::Real, M>;

    /// Joint rates, rad/s or m/s, at `q` for the error `e` of the task rows, desired minus actual, the desired velocity `v` of the rows and their
    /// Jacobian `j`.
    ///
    /// # Errors
    /// [`ClikError::Singular`], [`ClikError::RatesNotFinite`].
    fn rates(
        &self,
        robot: &R,
        q: &SVector<R::Real, N>,
        e: &SVector<R::Real, M>,
        v: &SVector<R::Real, M>,
        j: &SMatrix<R::Real, M, N>,
    ) -> Result<Rates<R::Real, N>, ClikError>;
}

impl<R: Kinematics<N>, A: Algorithm<R, N, M> + ?Sized, const N: usize, const M: usize> Algorithm<R, N, M> for &A {
    fn gain(&self) -> SVector<R::Real, M> {
        (**self).gain()
    }

    fn rates(
        &self,
        robot: &R,
        q: &SVector<R::Real, N>,
        e: &SVector<R::Real, M>,
        v: &SVector<R::Real, M>,
        j: &SMatrix<R::Real, M, N>,
    ) -> Result<Rates<R::Real, N>, ClikError> {
        (**self).rates(robot, q, e, v, j)
    }
}

fn positive<T: RealField + Copy, const M: usize>(k: [T; M]) -> Result<SVector<T, M>, SettingError> {
    let k = k.into();
    settings::positive(Setting::Proportional, &k)?;
    Ok(k)
}

/// dq = J^-1 (v_d + K e); J^+ of least norm where the arm has more joints than the task has rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JacobianInverse<T, const M: usize> {
    k: SVector<T, M>,
}

impl<T: RealField + Copy, const M: usize> JacobianInverse<T, M> {
    /// Diagonal of K, 1/s.
    ///
    /// # Errors
    /// Where an element is not positive and finite.
    pub fn new(k: [T; M]) -> Result<Self, SettingError> {
        Ok(Self { k: positive(k)? })
    }
}

impl<R: Kinematics<N>, const N: usize, const M: usize> Algorithm<R, N, M> for JacobianInverse<R::Real, M> {
    fn gain(&self) -> SVector<R::Real, M> {
        self.k
    }

    fn rates(
        &self,
        _: &R,
        _: &SVector<R::Real, N>,
        e: &SVector<R::Real, M>,
        v: &SVector<R::Real, M>,
        j: &SMatrix<R::Real, M, N>,
    ) -> Result<Rates<R::Real, N>, ClikError> {
        let inverse = RightInverse::new(j).ok_or(ClikError::Singular)?;
        Ok(Rates { dq: inverse.solve(&(v + self.k.component_mul(e))), damped: false })
    }
}

/// dq = J' K e: no inverse, no singularity, no desired velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JacobianTranspose<T, const M: usize> {
    k: SVector<T, M>,
}

impl<T: RealField + Copy, const M: usize> JacobianTranspose<T, M> {
    /// Diagonal of K, 1/(m^2 s) or 1/s.
    ///
    /// # Errors
    /// Where an element is not positive and finite.
    pub fn new(k: [T; M]) -> Result<Self, SettingError> {
        Ok(Self { k: positive(k)? })
    }

    /// T_s lambda_max(J' K J) of the Jacobian `j` of the task rows at the sampling period `period`, s.
    ///
    /// Sampled, e_{n+1} = (I - T_s J J' K) e_n: stable while this is below 2. It changes with the posture: look along the whole path.
    /// For a planar arm it grows as the arm is stretched out.
    pub fn loop_gain<const N: usize>(&self, j: &SMatrix<T, M, N>, period: T) -> T {
        const { assert!(M > 0, "a task has rows") };
        let weighted = SMatrix::<T, M, N>::from_fn(|i, k| self.k[i].sqrt() * j[(i, k)]);
        let sigma = left_singular(&weighted).sigma[0];
        period * sigma * sigma
    }
}

impl<R: Kinematics<N>, const N: usize, const M: usize> Algorithm<R, N, M> for JacobianTranspose<R::Real, M> {
    fn gain(&self) -> SVector<R::Real, M> {
        self.k
    }

    fn rates(
        &self,
        _: &R,
        _: &SVector<R::Real, N>,
        e: &SVector<R::Real, M>,
        _: &SVector<R::Real, M>,
        j: &SMatrix<R::Real, M, N>,
    ) -> Result<Rates<R::Real, N>, ClikError> {
        Ok(Rates { dq: j.tr_mul(&self.k.component_mul(e)), damped: false })
    }
}

/// dq = J^+ (v_d + K e) + (I - J^+ J) k_0 (dw/dq)': the free joint motions climb an [`Objective`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PseudoInverse<T, O, const M: usize> {
    k: SVector<T, M>,
    k_0: T,
    objective: O,
    damping: Option<Damping<T>>,
}

impl<T: RealField + Copy, O, const M: usize> PseudoInverse<T, O, M> {
    /// Diagonal of K, 1/s; k_0 >= 0, which with the unit of w makes a rate; and the objective w.
    ///
    /// # Errors
    /// Where an element of K is not positive and finite, or k_0 is negative or not finite.
    pub fn new(k: [T; M], k_0: T, objective: O) -> Result<Self, SettingError> {
        settings::not_negative_scalar(Setting::NullSpace, k_0)?;
        Ok(Self { k: positive(k)?, k_0, objective, damping: None })
    }

    /// The same with a damped inverse near singularities, instead of [`ClikError::Singular`] at them.
    ///
    /// While damping is active, I - J* J is no projector, so dq_0 disturbs the task, by at most lambda/2 |dq_0| with the lambda
    /// of [`Damping`].
    #[must_use]
    pub fn with_damping(self, damping: Damping<T>) -> Self {
        Self { damping: Some(damping), ..self }
    }
}

impl<R, O, const N: usize, const M: usize> Algorithm<R, N, M> for PseudoInverse<R::Real, O, M>
where
    R: Kinematics<N>,
    O: Objective<R, N>,
{
    fn gain(&self) -> SVector<R::Real, M> {
        self.k
    }

    fn rates(
        &self,
        robot: &R,
        q: &SVector<R::Real, N>,
        e: &SVector<R::Real, M>,
        v: &SVector<R::Real, M>,
        j: &SMatrix<R::Real, M, N>,
    ) -> Result<Rates<R::Real, N>, ClikError> {
        let dq_0 = match self.objective.gradient(robot, q) {
            Some(gradient) if self.k_0 > nalgebra::zero() => gradient * self.k_0,
            _ => SVector::zeros(),
        };
        // J^+ (v - J dq_0) + dq_0 is the law, and stays it with a damped inverse.
        let v = v + self.k.component_mul(e) - j * dq_0;
        match &self.damping {
            None => {
                let inverse = RightInverse::new(j).ok_or(ClikError::Singular)?;
                Ok(Rates { dq: inverse.solve(&v) + dq_0, damped: false })
            }
            Some(damping) => {
                let solution = damping.solve(j, &v).ok_or(ClikError::RatesNotFinite)?;
                Ok(Rates { dq: solution.x + dq_0, damped: solution.damped })
            }
        }
    }
}

/// dq = J' (J J' + lambda^2 I)^-1 (v_d + K e), lambda > 0 near singularities only (see [`Damping`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedLeastSquares<T, const M: usize> {
    k: SVector<T, M>,
    damping: Damping<T>,
}

impl<T: RealField + Copy, const M: usize> DampedLeastSquares<T, M> {
    /// Diagonal of K, 1/s, and the damping.
    ///
    /// # Errors
    /// Where an element of K is not positive and finite.
    pub fn new(k: [T; M], damping: Damping<T>) -> Result<Self, SettingError> {
        Ok(Self { k: positive(k)?, damping })
    }
}

impl<R: Kinematics<N>, const N: usize, const M: usize> Algorithm<R, N, M> for DampedLeastSquares<R::Real, M> {
    fn gain(&self) -> SVector<R::Real, M> {
        self.k
    }

    fn rates(
        &self,
        _: &R,
        _: &SVector<R::Real, N>,
        e: &SVector<R::Real, M>,
        v: &SVector<R::Real, M>,
        j: &SMatrix<R::Real, M, N>,
    ) -> Result<Rates<R::Real, N>, ClikError> {
        let solution = self.damping.solve(j, &(v + self.k.component_mul(e))).ok_or(ClikError::RatesNotFinite)?;
        Ok(Rates { dq: solution.x, damped: solution.damped })
    }
}
