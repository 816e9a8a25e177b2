//! The load of an arm, estimated while it moves: recursive least squares in square-root information form.
//!
//! A body in the end effector's frame has ten parameters pi = (m, m c, I), I about the origin of the frame. With the velocity v, omega of
//! the frame, its momentum l, k about the origin is linear in pi, and so is the torque that it asks for:
//!
//! ```text
//! tau_L = d(P pi)/dt + G pi,     P pi = J_v' l + J_o' k
//! G pi  = -J_v' m g + J_o' (v x l - m c x g) - dJ_v/dt' l - dJ_o/dt' k
//! ```
//!
//! J, dJ/dt are the emitted `geometric_jacobian` and `geometric_jacobian_dot`: every arm has this regressor, and no function is emitted
//! for it. Through the filter lambda/(s + lambda) no acceleration is needed; F below is the filter, 0 marks the unloaded arm:
//!
//! ```text
//! Y_f = lambda (P - F[P]) + F[G],     y_f = F[tau - F - g_0 + C_0' dq] - lambda (p_0 - F[p_0]),     Y_f pi = y_f
//! ```
//!
//! The filter runs by the backward rule, tau held over the past period, the rest as the mean of its ends. The rows, each divided by the spread of its joint, are
//! reflected into [R z] (Householder; Bierman, Factorization Methods for Discrete Sequential Estimation, 1977): R pi = z is the estimate.

use crate::{
    control::ControlError,
    linalg::{is_finite, lit, Cholesky},
    reference::State,
    robot::{CoriolisTransposeTimes, Dynamics, Kinematics, Momentum},
    settings::{self, Setting, SettingError},
};
use nalgebra::{Matrix3, RealField, SMatrix, SVector, Vector3};

/// Parameters of a body: m, m c_x, m c_y, m c_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz.
pub const PARAMETERS: usize = 10;

/// Momentum P and force G of unit payloads, `N` x 10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadRegressor<T, const N: usize> {
    /// P: P pi is the generalised momentum of the payload.
    pub momentum: SMatrix<T, N, PARAMETERS>,
    /// G: tau_L = d(P pi)/dt + G pi.
    pub force: SMatrix<T, N, PARAMETERS>,
}

/// The regressors of a payload; `gravity` is the acceleration of gravity in the base frame, m/s².
pub fn payload_regressor<R: Kinematics<N>, const N: usize>(
    model: &R,
    State { q, dq }: &State<R::Real, N>,
    gravity: &Vector3<R::Real>,
) -> PayloadRegressor<R::Real, N> {
    let (jacobian, slope) = (model.geometric_jacobian(q), model.geometric_jacobian_dot(q, dq));
    let frame = model.direct_kinematics(q);
    let rotation = Matrix3::from_fn(|i, j| frame[(i, j)]);
    let twist = jacobian * dq;
    let v = Vector3::new(twist[0], twist[1], twist[2]);
    let omega = Vector3::new(twist[3], twist[4], twist[5]);
    let w = rotation.tr_mul(&omega);
    let o = lit(0.0);
    let zero = Vector3::zeros();
    let axis = |k: usize| Vector3::new(rotation[(0, k)], rotation[(1, k)], rotation[(2, k)]);
    let of_first_moment = |k: usize| {
        let e = axis(k);
        let l = omega.cross(&e);
        (l, e.cross(&v), zero, v.cross(&l) - e.cross(gravity))
    };
    let of_inertia = |by: Vector3<R::Real>| (zero, rotation * by, zero, zero);
    // l, k, and the force and the moment that do not come from their derivatives.
    let columns = [
        (v, zero, -gravity, zero),
        of_first_moment(0),
        of_first_moment(1),
        of_first_moment(2),
        of_inertia(Vector3::new(w[0], o, o)),
        of_inertia(Vector3::new(w[1], w[0], o)),
        of_inertia(Vector3::new(o, w[1], o)),
        of_inertia(Vector3::new(w[2], o, w[0])),
        of_inertia(Vector3::new(o, w[2], w[1])),
        of_inertia(Vector3::new(o, o, w[2])),
    ];
    let six = |a: &Vector3<R::Real>, b: &Vector3<R::Real>| SVector::<R::Real, 6>::new(a[0], a[1], a[2], b[0], b[1], b[2]);
    let mut found = PayloadRegressor { momentum: SMatrix::zeros(), force: SMatrix::zeros() };
    for (column, (l, k, force, moment)) in columns.iter().enumerate() {
        let momentum = six(l, k);
        found.momentum.set_column(column, &jacobian.tr_mul(&momentum));
        found.force.set_column(column, &(jacobian.tr_mul(&six(force, moment)) - slope.tr_mul(&momentum)));
    }
    found
}

/// What an estimator of a payload is made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadSettings<T, const N: usize> {
    /// The acceleration of gravity in the base frame, m/s².
    pub gravity: Vector3<T>,
    /// The sampling period, s.
    pub period: T,
    /// lambda, rad/s.
    pub filter: T,
    /// The part of the information that is left after a second, above 0; 1: nothing is forgotten.
    pub forgetting: T,
    /// The spread of the filtered error of the torques, joint by joint; N m or N.
    pub spread: SVector<T, N>,
    /// The rate below which a joint's row does not count, since friction at rest is a reaction; rad/s or m/s.
    pub least_rate: T,
    /// The reference body, positive definite.
    pub body: [T; PARAMETERS],
    /// Its standard deviations.
    pub deviation: [T; PARAMETERS],
    /// Whether only gravity counts, for slow motion: mass and centre of mass are estimated, the inertia stays that of the reference.
    pub is_slow: bool,
}

/// An estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload<T> {
    /// The ten parameters.
    pub body: [T; PARAMETERS],
    /// Three standard deviations of each.
    pub three_sigma: [T; PARAMETERS],
}

/// Signals of the last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Before<T, const N: usize> {
    regressor: PayloadRegressor<T, N>,
    momentum: SVector<T, N>,
    force: SVector<T, N>,
}

/// The recursive estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadEstimator<T, const N: usize> {
    settings: PayloadSettings<T, N>,
    /// The square root of what is left of the information after a period.
    kept: T,
    before: Option<Before<T, N>>,
    regressor: SMatrix<T, N, PARAMETERS>,
    torque: SVector<T, N>,
    /// R, upper triangular.
    root: [[T; PARAMETERS]; PARAMETERS],
    z: [T; PARAMETERS],
    /// The last consistent body.
    consistent: [T; PARAMETERS],
}

/// The weight of log det J against half of the squared errors: it moves an estimate by far less than its standard deviation.
const BARRIER: f64 = 0.05;
/// Newton steps of [`PayloadEstimator::physical`].
const STEPS: usize = 12;
/// Halvings of a Newton step.
const HALVINGS: usize = 24;

impl<T: RealField + Copy, const N: usize> PayloadEstimator<T, N> {
    /// An estimator that knows the reference body alone.
    ///
    /// # Errors
    /// A period, a filter, a spread or a deviation that is not positive and finite, forgetting outside of ]0, 1], a negative rate, a body that is not positive definite.
    pub fn new(settings: PayloadSettings<T, N>) -> Result<Self, SettingError> {
        settings::positive_scalar(Setting::Period, settings.period)?;
        settings::positive_scalar(Setting::Filter, settings.filter)?;
        settings::positive_scalar(Setting::Forgetting, settings.forgetting)?;
        settings::not_negative_scalar(Setting::Forgetting, T::one() - settings.forgetting)?;
        settings::positive(Setting::TorqueSpread, &settings.spread)?;
        settings::not_negative_scalar(Setting::LeastRate, settings.least_rate)?;
        settings::finite(Setting::Estimate, &settings.gravity)?;
        settings::finite(Setting::Estimate, &SVector::from(settings.body))?;
        settings::positive(Setting::Estimate, &SVector::from(settings.deviation))?;
        if log_det(&settings.body).is_none() {
            return Err(SettingError::NotPositive { setting: Setting::Estimate, index: 0 });
        }
        let mut root = [[T::zero(); PARAMETERS]; PARAMETERS];
        let mut z = [T::zero(); PARAMETERS];
        for k in 0..PARAMETERS {
            root[k][k] = T::one() / settings.deviation[k];
            z[k] = settings.body[k] / settings.deviation[k];
        }
        Ok(Self {
            kept: (settings.forgetting.ln() * settings.period * lit(0.5)).exp(),
            before: None,
            regressor: SMatrix::zeros(),
            torque: SVector::zeros(),
            root,
            z,
            consistent: settings.body,
            settings,
        })
    }

    /// One sample of the loaded arm: the measurement, and the torque that acted since the last one, N m or N. `model` is the arm without
    /// the load.
    ///
    /// # Errors
    /// Where measurement or torque is not finite, or the model is not at this state; the estimator stays as it was.
    pub fn step<R>(&mut self, model: &R, measured: &State<T, N>, tau: &SVector<T, N>) -> Result<(), ControlError>
    where
        R: Dynamics<N, Real = T> + Momentum<N> + CoriolisTransposeTimes<N>,
    {
        if !(measured.is_finite() && is_finite(tau)) {
            return Err(ControlError::MeasurementNotFinite);
        }
        let State { q, dq } = measured;
        let of = &self.settings;
        let friction = model.friction(dq) + model.load_friction(q, dq);
        let bare = -friction - model.gravity(q);
        let now = if of.is_slow {
            let still = State { q: *q, dq: SVector::zeros() };
            let regressor = payload_regressor(model, &still, &of.gravity);
            Before { regressor, momentum: SVector::zeros(), force: bare }
        } else {
            let regressor = payload_regressor(model, measured, &of.gravity);
            Before { regressor, momentum: model.momentum(q, dq), force: bare + model.coriolis_transpose_times(q, dq) }
        };
        let first = now;
        let before = self.before.as_ref().unwrap_or(&first);
        let (lambda, step) = (of.filter, of.filter * of.period);
        let by = T::one() / (T::one() + step);
        let half = lit::<T>(0.5);
        // Entry by entry: sums of whole matrices cost a microcontroller twice the instructions.
        let mut regressor = SMatrix::zeros();
        let mut are_finite = true;
        for k in 0..PARAMETERS {
            for i in 0..N {
                let slope = now.regressor.momentum[(i, k)] - before.regressor.momentum[(i, k)];
                let force = now.regressor.force[(i, k)] + before.regressor.force[(i, k)];
                let x = (self.regressor[(i, k)] + slope * lambda + force * (half * step)) * by;
                are_finite &= x.is_finite();
                regressor[(i, k)] = x;
            }
        }
        let torque =
            (self.torque + (*tau + (now.force + before.force) * half) * step - (now.momentum - before.momentum) * lambda) * by;
        if !(are_finite && is_finite(&torque)) {
            return Err(ControlError::StateNotFinite);
        }
        if self.before.replace(now).is_none() {
            return Ok(());
        }
        (self.regressor, self.torque) = (regressor, torque);
        for k in 0..PARAMETERS {
            (k..PARAMETERS).for_each(|j| self.root[k][j] *= self.kept);
            self.z[k] *= self.kept;
        }
        // Errors behind the filter are correlated over 1/lambda: so much less each of them tells.
        let told = (step / (lit::<T>(2.0) + step)).sqrt();
        let (mut rows, mut right) = ([[T::zero(); PARAMETERS]; N], [T::zero(); N]);
        for i in 0..N {
            if dq[i].abs() >= self.settings.least_rate {
                let weight = told / self.settings.spread[i];
                (0..PARAMETERS).for_each(|k| rows[i][k] = regressor[(i, k)] * weight);
                right[i] = torque[i] * weight;
            }
        }
        reflect(&mut self.root, &mut self.z, rows, right);
        Ok(())
    }

    /// The least squares estimate with the reference body.
    pub fn estimate(&self) -> Payload<T> {
        // R^-1, upper triangular.
        let mut inverse = [[T::zero(); PARAMETERS]; PARAMETERS];
        for j in 0..PARAMETERS {
            for i in (0..j + 1).rev() {
                let mut sum = if i == j { T::one() } else { T::zero() };
                for k in i + 1..j + 1 {
                    sum -= self.root[i][k] * inverse[k][j];
                }
                inverse[i][j] = sum / self.root[i][i];
            }
        }
        let sum = |of: &dyn Fn(usize) -> T| (0..PARAMETERS).fold(T::zero(), |sum, k| sum + of(k));
        Payload {
            body: core::array::from_fn(|i| sum(&|k| inverse[i][k] * self.z[k])),
            three_sigma: core::array::from_fn(|i| sum(&|k| inverse[i][k] * inverse[i][k]).sqrt() * lit(3.0)),
        }
    }

    /// The body that is nearest to the estimate in the metric of R and positive definite: Newton steps on
    /// ½ |R pi - z|² - mu log det J from the last such body, feasible at every step.
    pub fn physical(&mut self) -> [T; PARAMETERS] {
        let mut x = self.consistent;
        for _ in 0..STEPS {
            let Some(step) = self.newton(&x) else { break };
            let Some(value) = self.objective(&x) else { break };
            let mut by = T::one();
            let mut next = None;
            for _ in 0..HALVINGS {
                let trial: [T; PARAMETERS] = core::array::from_fn(|k| x[k] + by * step[k]);
                if self.objective(&trial).is_some_and(|at| at < value) {
                    next = Some(trial);
                    break;
                }
                by *= lit(0.5);
            }
            let Some(next) = next else { break };
            x = next;
        }
        self.consistent = x;
        x
    }

    /// R x - z.
    fn error(&self, x: &[T; PARAMETERS]) -> [T; PARAMETERS] {
        core::array::from_fn(|i| (i..PARAMETERS).fold(-self.z[i], |sum, k| sum + self.root[i][k] * x[k]))
    }

    fn objective(&self, x: &[T; PARAMETERS]) -> Option<T> {
        let squares = self.error(x).iter().fold(T::zero(), |sum, e| sum + *e * *e);
        Some(squares * lit(0.5) - log_det(x)? * lit(BARRIER))
    }

    /// The Newton step.
    fn newton(&self, x: &[T; PARAMETERS]) -> Option<[T; PARAMETERS]> {
        let factor = Cholesky::new(&pseudo_inertia(x))?;
        let error = self.error(x);
        // J^-1 dJ/dx_k.
        let parts: [SMatrix<T, 4, 4>; PARAMETERS] = core::array::from_fn(|k| {
            let mut unit = [T::zero(); PARAMETERS];
            unit[k] = T::one();
            let mut part = pseudo_inertia(&unit);
            part.column_iter_mut().for_each(|mut column| {
                let solved = factor.solve(&column.clone_owned());
                column.copy_from(&solved);
            });
            part
        });
        let mu = lit::<T>(BARRIER);
        let mut matrix = SMatrix::<T, PARAMETERS, PARAMETERS>::zeros();
        let mut gradient = SVector::<T, PARAMETERS>::zeros();
        for a in 0..PARAMETERS {
            gradient[a] = (0..a + 1).fold(T::zero(), |sum, i| sum + self.root[i][a] * error[i]) - mu * parts[a].trace();
            for b in 0..PARAMETERS {
                let product = (0..PARAMETERS).fold(T::zero(), |sum, i| sum + self.root[i][a] * self.root[i][b]);
                matrix[(a, b)] = product + mu * parts[a].tr_dot(&parts[b]);
            }
        }
        // Parameters differ by powers of ten.
        let scale = matrix.diagonal().map(|x| T::one() / x.max(lit(1e-30)).sqrt());
        let scaled = SMatrix::<T, PARAMETERS, PARAMETERS>::from_fn(|a, b| matrix[(a, b)] * scale[a] * scale[b]);
        let step = Cholesky::new(&scaled)?.solve(&-gradient.component_mul(&scale)).component_mul(&scale);
        is_finite(&step).then(|| core::array::from_fn(|k| step[k]))
    }
}

/// Reflects rows into [R z] (Householder). Two reflections leave nothing below: this one keeps R's diagonal positive, and its first entry is a
/// quotient, not a difference.
fn reflect<T: RealField + Copy, const N: usize>(
    root: &mut [[T; PARAMETERS]; PARAMETERS],
    z: &mut [T; PARAMETERS],
    mut rows: [[T; PARAMETERS]; N],
    mut right: [T; N],
) {
    for k in 0..PARAMETERS {
        let column: [T; N] = core::array::from_fn(|i| rows[i][k]);
        let square = column.iter().fold(T::zero(), |sum, x| sum + *x * *x);
        if square <= T::zero() {
            continue;
        }
        let size = (root[k][k] * root[k][k] + square).sqrt();
        let first = -square / (root[k][k] + size);
        let by = lit::<T>(2.0) / (first * first + square);
        root[k][k] = size;
        for j in k + 1..PARAMETERS {
            let mut along = first * root[k][j];
            for i in 0..N {
                along += column[i] * rows[i][j];
            }
            along *= by;
            root[k][j] -= along * first;
            for i in 0..N {
                rows[i][j] -= along * column[i];
            }
        }
        let mut along = first * z[k];
        for i in 0..N {
            along += column[i] * right[i];
        }
        along *= by;
        z[k] -= along * first;
        for i in 0..N {
            right[i] -= along * column[i];
        }
    }
}

/// J = [[S, m c], [m c', m]], S = ½ tr(I) 1 - I.
fn pseudo_inertia<T: RealField + Copy>(&[m, x, y, z, xx, xy, yy, xz, yz, zz]: &[T; PARAMETERS]) -> SMatrix<T, 4, 4> {
    let half = (xx + yy + zz) * lit(0.5);
    SMatrix::<T, 4, 4>::new(
        half - xx,
        -xy,
        -xz,
        x, //
        -xy,
        half - yy,
        -yz,
        y, //
        -xz,
        -yz,
        half - zz,
        z, //
        x,
        y,
        z,
        m,
    )
}

/// log det J of a positive definite body.
fn log_det<T: RealField + Copy>(body: &[T; PARAMETERS]) -> Option<T> {
    let factor = Cholesky::new(&pseudo_inertia(body))?;
    let diagonal = factor.factor().diagonal();
    Some(diagonal.iter().fold(T::zero(), |sum, x| sum + x.ln()) * lit(2.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The possible body is a minimum of its objective: a step to either side along each parameter raises it.
    #[test]
    fn the_possible_body_is_the_nearest() {
        let body = [1.0, 0.02, -0.01, 0.05, 0.0075, 1e-4, 0.0075, -2e-4, 0.0, 0.005];
        let settings = PayloadSettings {
            gravity: Vector3::new(0.0, 0.0, -9.81),
            period: 0.01,
            filter: 20.0,
            forgetting: 1.0,
            spread: SVector::<f64, 2>::repeat(0.5),
            least_rate: 0.02,
            body,
            deviation: [0.1, 0.01, 0.01, 0.01, 0.002, 0.002, 0.002, 0.002, 0.002, 0.002],
            is_slow: false,
        };
        let mut estimator = PayloadEstimator::new(settings).unwrap();
        // An estimate without mass.
        estimator.z[0] = -1.0;
        let mut found = estimator.physical();
        // From far away twelve steps are not enough.
        for _ in 0..4 {
            found = estimator.physical();
        }
        let least = estimator.objective(&found).unwrap();
        for k in 0..PARAMETERS {
            for sign in [-1.0, 1.0] {
                let mut other = found;
                other[k] += sign * 1e-3 * settings.deviation[k];
                assert!(estimator.objective(&other).is_none_or(|at| at > least), "{k}: {found:?}");
            }
        }
    }
}
