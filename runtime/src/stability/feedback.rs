//! The controllers, linearised at rest: u = K_q δq + K_v δv + L m, dm/dt = E_q δq + E_v δv for small deviations δq of the joint
//! variables and δv of the rates dq.
//!
//! At rest C dq is of second order and drops out, so the derivatives are B, F and dg/dq of the model. B and F come from the model
//! exactly. dg/dq, and the derivative of the torque that holds an arm off its reference, come from central differences. Their
//! step is the cube root of epsilon, their error of the order of its square.

use super::{difference::derivative, rest::rest};
use crate::{
    control::{Adaptive, InverseDynamics, Limited, OperationalSpace, PdGravity, Robust},
    linalg::{lit, RightInverse},
    reference::Pose,
    robot::{Dynamics, Regressor},
};
use nalgebra::{DMatrix, DVector, RealField, SMatrix, SVector};

/// A linear feedback with states m of the controller (estimate or integral).
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback<T, const N: usize> {
    /// K_q = du/dq, N m/rad or N/m.
    pub position: SMatrix<T, N, N>,
    /// K_v = du/dv, v the rates, N m s/rad or N s/m.
    pub velocity: SMatrix<T, N, N>,
    /// L = du/dm, `N` rows, one column for each state of the controller; N m or N per unit of the state.
    pub torque_by_state: DMatrix<T>,
    /// E_q of dm/dt, one row for each state of the controller; its unit, per s and per rad or m.
    pub state_by_position: DMatrix<T>,
    /// E_v of dm/dt, one row for each state of the controller; its unit, per rad or m.
    pub state_by_velocity: DMatrix<T>,
    /// Joints that nothing pulls back: their position is no state of the loop.
    pub free: [bool; N],
}

impl<T: RealField + Copy, const N: usize> Feedback<T, N> {
    pub(super) fn without_state(position: SMatrix<T, N, N>, velocity: SMatrix<T, N, N>) -> Self {
        Self {
            position,
            velocity,
            torque_by_state: DMatrix::zeros(N, 0),
            state_by_position: DMatrix::zeros(0, N),
            state_by_velocity: DMatrix::zeros(0, N),
            free: [false; N],
        }
    }
}

/// A law where the arm rests under it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest<T, const N: usize> {
    /// Where it rests, rad or m; the reference itself where there is no such posture.
    pub q: SVector<T, N>,
    /// Whether it can rest: the error that makes up for the model does not grow without bound on the way to the plant.
    pub is_held: bool,
    /// The feedback about `q`.
    pub feedback: Feedback<T, N>,
}

/// A controller that can be linearised at rest.
pub trait Linearise<R: Dynamics<N>, const N: usize> {
    /// Its feedback about the posture `q`, with the reference at rest there; `None` where the law is singular.
    fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>>;
}

/// A controller that can be linearised where the arm can rest under it.
///
/// At rest the torque equals the plant's gravity and the offset of its friction. Estimates are the parameters of the plant, or
/// the bound of their projection; frozen estimates stay. Integrals compensate the model error. A law, or row, without either
/// rests off its reference. Coulomb friction, which holds an arm at any posture nearby, is left out.
pub trait LineariseAtRest<P: Dynamics<N>, R: Dynamics<N, Real = P::Real>, const N: usize>: Linearise<R, N> {
    /// Its feedback about rest under the reference `q`; `None` where the law is singular.
    fn settle(&self, plant: &P, model: &R, q: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>>;
}

/// g + F(0) - g_m - F_m(0), `m` for the model: the torque at rest that a law by inverse dynamics must add. F(0) is the offset of friction.
fn lack<P: Dynamics<N>, R: Dynamics<N, Real = P::Real>, const N: usize>(
    plant: &P,
    model: &R,
    q: &SVector<R::Real, N>,
) -> SVector<R::Real, N> {
    let still = SVector::zeros();
    plant.gravity(q) - model.gravity(q) + (plant.friction(&still) - model.friction(&still))
}

/// A rate, rad/s or m/s, beyond the Stribeck velocity of any joint: measured ones are below 1.
const FADED: f64 = 16.0;

/// Viscous friction F_v, column by column, from friction at x, 2 x and 3 x, with x a rate, rad/s or m/s, at which Stribeck
/// friction has faded. F(2 x e_i) - F(x e_i) cancels Coulomb friction. Subtracting 7/12 of the second difference F(3 x e_i) - 2
/// F(2 x e_i) + F(x e_i) = 12 F_3 x³ e_i removes cubic friction. The result is divided by x.
pub(crate) fn viscous<R: Dynamics<N>, const N: usize>(robot: &R) -> SMatrix<R::Real, N, N> {
    let mut f = SMatrix::<R::Real, N, N>::zeros();
    for i in 0..N {
        let mut e = SVector::zeros();
        e[i] = nalgebra::one::<R::Real>();
        let [one, two, three] = [1.0, 2.0, 3.0].map(|times| robot.friction(&(e * lit::<R::Real>(times * FADED))));
        let first = two - one;
        f.set_column(i, &((first - (three - two - first) * lit::<R::Real>(7.0 / 12.0)) / lit::<R::Real>(FADED)));
    }
    f
}

fn columns_scaled<T: RealField + Copy, const R: usize, const N: usize>(
    m: &SMatrix<T, R, N>,
    k: &SVector<T, N>,
) -> SMatrix<T, R, N> {
    SMatrix::from_fn(|i, j| m[(i, j)] * k[j])
}

fn rows_scaled<T: RealField + Copy, const R: usize, const N: usize>(k: &SVector<T, R>, m: &SMatrix<T, R, N>) -> SMatrix<T, R, N> {
    SMatrix::from_fn(|i, j| k[i] * m[(i, j)])
}

/// Feedback of u = B y + n about the posture `q`, with dy/dq = -`k_p`, dy/dv = -`k_d`, and y = `y` at rest.
fn inverse_dynamics<R: Dynamics<N>, const N: usize>(
    model: &R,
    q: &SVector<R::Real, N>,
    y: &SVector<R::Real, N>,
    [k_p, k_d]: [SMatrix<R::Real, N, N>; 2],
) -> Feedback<R::Real, N> {
    let b = model.inertia_matrix(q);
    let dg = derivative(q, |q| model.gravity(q) + model.inertia_matrix(q) * y);
    Feedback::without_state(dg - b * k_p, viscous(model) - b * k_d)
}

/// Where a law rests that adds the torque `held` to the model's, which lacks the torque `lack`, and its feedback there.
fn rest_off<T: RealField + Copy, const N: usize>(
    reference: &SVector<T, N>,
    held: impl Fn(&SVector<T, N>) -> SVector<T, N>,
    lack: impl Fn(&SVector<T, N>) -> SVector<T, N>,
    feedback: impl Fn(&SVector<T, N>) -> Feedback<T, N>,
) -> Rest<T, N> {
    let found = rest(reference, held, lack);
    let q = found.unwrap_or(*reference);
    Rest { q, is_held: found.is_some(), feedback: feedback(&q) }
}

impl<R: Dynamics<N>, const N: usize> Linearise<R, N> for PdGravity<R::Real, N> {
    fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>> {
        Some(self.about(model, q))
    }
}

impl<T: RealField + Copy, const N: usize> PdGravity<T, N> {
    /// The feedback at rest at `q`, whatever the reference.
    fn about<R: Dynamics<N, Real = T>>(&self, model: &R, q: &SVector<T, N>) -> Feedback<T, N> {
        let dg = derivative(q, |q| model.gravity(q));
        Feedback::without_state(dg - SMatrix::from_diagonal(&self.k_p), -SMatrix::from_diagonal(&self.k_d))
    }
}

impl<P: Dynamics<N>, R: Dynamics<N, Real = P::Real>, const N: usize> LineariseAtRest<P, R, N> for PdGravity<R::Real, N> {
    fn settle(&self, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>> {
        let held = |q: &SVector<R::Real, N>| self.k_p.component_mul(&(reference - q));
        // The law has gravity of its model, and no friction.
        let lack = |q: &SVector<R::Real, N>| plant.gravity(q) + plant.friction(&SVector::zeros()) - model.gravity(q);
        Some(rest_off(reference, held, lack, |q| self.about(model, q)))
    }
}

impl<R: Dynamics<N>, const N: usize> Linearise<R, N> for InverseDynamics<R::Real, N> {
    fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>> {
        Some(self.about(model, q, &SVector::zeros()))
    }
}

impl<T: RealField + Copy, const N: usize> InverseDynamics<T, N> {
    /// The feedback at rest at `q`, the reference `e` from there.
    fn about<R: Dynamics<N, Real = T>>(&self, model: &R, q: &SVector<T, N>, e: &SVector<T, N>) -> Feedback<T, N> {
        let gains = [SMatrix::from_diagonal(&self.k_p), SMatrix::from_diagonal(&self.k_d)];
        inverse_dynamics(model, q, &self.k_p.component_mul(e), gains)
    }
}

impl<P: Dynamics<N>, R: Dynamics<N, Real = P::Real>, const N: usize> LineariseAtRest<P, R, N> for InverseDynamics<R::Real, N> {
    fn settle(&self, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>> {
        let held = |q: &SVector<R::Real, N>| model.inertia_matrix(q) * self.k_p.component_mul(&(reference - q));
        Some(rest_off(reference, held, |q| lack(plant, model, q), |q| self.about(model, q, &(reference - q))))
    }
}

/// Inside the boundary layer the added term is linear and raises the gains to K_P + rho/eps Q12 and K_D + rho/eps Q22.
impl<R: Dynamics<N>, const N: usize> Linearise<R, N> for Robust<R::Real, N> {
    fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>> {
        Some(self.about(model, q, &SVector::zeros()))
    }
}

impl<T: RealField + Copy, const N: usize> Robust<T, N> {
    /// y at rest, the reference `e` from there, and dw/dz: rho/eps 1 inside the layer, rho/|z| (1 - z z'/|z|²) outside.
    fn at_rest(&self, e: &SVector<T, N>) -> (SVector<T, N>, SMatrix<T, N, N>) {
        let z = self.q.q12.component_mul(e);
        let size = z.norm();
        let slope = self.layer.rho / size.max(self.layer.epsilon);
        let mut along = SMatrix::identity();
        if size > self.layer.epsilon {
            along -= z * z.transpose() / (size * size);
        }
        (self.k_p.component_mul(e) + z * slope, along * slope)
    }

    /// The feedback at rest at `q`, the reference `e` from there.
    fn about<R: Dynamics<N, Real = T>>(&self, model: &R, q: &SVector<T, N>, e: &SVector<T, N>) -> Feedback<T, N> {
        let (y, slope) = self.at_rest(e);
        let gain = |linear, added| SMatrix::from_diagonal(linear) + columns_scaled(&slope, added);
        inverse_dynamics(model, q, &y, [gain(&self.k_p, &self.q.q12), gain(&self.k_d, &self.q.q22)])
    }
}

impl<P: Dynamics<N>, R: Dynamics<N, Real = P::Real>, const N: usize> LineariseAtRest<P, R, N> for Robust<R::Real, N> {
    fn settle(&self, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>> {
        let held = |q: &SVector<R::Real, N>| model.inertia_matrix(q) * self.at_rest(&(reference - q)).0;
        Some(rest_off(reference, held, |q| lack(plant, model, q), |q| self.about(model, q, &(reference - q))))
    }
}

/// At rest at q, with the reference at the distance e, dq_r = Lambda e and sigma = Lambda e - Lambda δq - δv. The estimate moves
/// along K_pi^-1 Y_0' with Y_0 = Y(q, 0, 0, 0). Its states are the at most N combinations that Y_0 K_pi^-1 Y_0' = L L' excites,
/// u = L m, dm/dt = L' sigma. Combinations that only e excites are left out, such as the drifting estimate of viscous friction.
impl<R: Regressor<N, P>, const N: usize, const P: usize> Linearise<R, N> for Adaptive<R::Real, N, P> {
    fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>> {
        Some(self.about(model, q, &SVector::zeros()))
    }
}

impl<T: RealField + Copy, const N: usize, const P: usize> Adaptive<T, N, P> {
    /// Y pi^ + tau_known at rates dq_r and no accelerations.
    fn modelled<R: Regressor<N, P, Real = T>>(&self, model: &R, [q, dq, dqr, ddqr]: [&SVector<T, N>; 4]) -> SVector<T, N> {
        model.regressor(q, dq, dqr, ddqr) * self.estimate + model.known_torque(q, dq, dqr, ddqr)
    }

    /// The combinations of the estimate that move at rest at `q`: L.
    fn excited<R: Regressor<N, P, Real = T>>(&self, model: &R, q: &SVector<T, N>) -> DMatrix<T> {
        let still = SVector::zeros();
        let y = model.regressor(q, &still, &still, &still);
        excited(&(columns_scaled(&y, &self.adaptation_gain) * y.transpose()))
    }

    /// The feedback at rest at `q`, the reference `e` from there.
    fn about<R: Regressor<N, P, Real = T>>(&self, model: &R, q: &SVector<T, N>, e: &SVector<T, N>) -> Feedback<T, N> {
        let (still, dqr) = (SVector::zeros(), self.lambda.component_mul(e));
        let rest = self.modelled(model, [q, &still, &still, &still]);
        let held = self.modelled(model, [q, &still, &dqr, &still]);
        let (mut b, mut f, mut c) = (SMatrix::<T, N, N>::zeros(), SMatrix::<T, N, N>::zeros(), SMatrix::<T, N, N>::zeros());
        for i in 0..N {
            let mut unit = SVector::zeros();
            unit[i] = T::one();
            b.set_column(i, &(self.modelled(model, [q, &still, &still, &unit]) - rest));
            f.set_column(i, &(self.modelled(model, [q, &still, &unit, &still]) - rest));
            // C(q, δv) dq_r: what friction makes of either rate cancels.
            let moving = self.modelled(model, [q, &unit, &dqr, &still]) - self.modelled(model, [q, &unit, &still, &still]);
            c.set_column(i, &(moving - (held - rest)));
        }
        let dg = derivative(q, |q| self.modelled(model, [q, &still, &still, &still]));
        let k_d = SMatrix::from_diagonal(&self.k_d);
        // dq_r = Lambda (e - δq) and ddq_r = -Lambda δv.
        let position = dg - columns_scaled(&(f + k_d), &self.lambda);
        let velocity = c - columns_scaled(&b, &self.lambda) - k_d;
        let l = self.excited(model, q);
        let transpose = l.transpose();
        let lambda = DMatrix::from_fn(N, N, |i, j| if i == j { self.lambda[i] } else { nalgebra::zero() });
        Feedback {
            position,
            velocity,
            state_by_position: -(&transpose * lambda),
            state_by_velocity: -transpose,
            torque_by_state: l,
            free: [false; N],
        }
    }
}

/// With the parameters of the plant the arm rests on its reference. Where bounds or frozen parameters prevent this, the
/// parameters that still move compensate as far as possible. At rest L' sigma = 0, and F(Lambda e) + K_D Lambda e supplies the
/// missing torque outside the span of the columns of L.
impl<P, R, const N: usize, const K: usize> LineariseAtRest<P, R, N> for Adaptive<R::Real, N, K>
where
    P: Regressor<N, K>,
    R: Regressor<N, K, Real = P::Real>,
{
    fn settle(&self, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>> {
        let law = self.at_rest(&plant.parameters());
        if law.estimate == plant.parameters() {
            return Some(Rest { q: *reference, is_held: true, feedback: law.about(model, reference, &SVector::zeros()) });
        }
        let still = SVector::zeros();
        // L (L'L)^-1, whose transpose gives the coordinates of a torque along the columns of L.
        let dual = |l: &DMatrix<R::Real>| {
            let square = (l.transpose() * l).cholesky();
            square.map_or_else(|| DMatrix::zeros(N, l.ncols()), |square| l * square.inverse())
        };
        let column = |x: DVector<R::Real>| SVector::<R::Real, N>::from_column_slice(x.as_slice());
        let dynamic = |x: &SVector<R::Real, N>| DVector::from_column_slice(x.as_slice());
        // The component in the columns of L.
        let along = |l: &DMatrix<R::Real>, x: &SVector<R::Real, N>| column(l * (dual(l).transpose() * dynamic(x)));
        let modelled = |q: &SVector<R::Real, N>, dqr: &SVector<R::Real, N>| law.modelled(model, [q, &still, dqr, &still]);
        let rates = |q: &SVector<R::Real, N>| law.lambda.component_mul(&(reference - q));
        let holding = |q: &SVector<R::Real, N>| modelled(q, &rates(q)) - modelled(q, &still) + law.k_d.component_mul(&rates(q));
        let lacking = |q: &SVector<R::Real, N>| plant.gravity(q) + plant.friction(&still) - modelled(q, &still);
        let held = |q: &SVector<R::Real, N>| {
            let (l, torque) = (law.excited(model, q), holding(q));
            torque - along(&l, &torque) + along(&l, &rates(q))
        };
        let lack = |q: &SVector<R::Real, N>| {
            let torque = lacking(q);
            torque - along(&law.excited(model, q), &torque)
        };
        Some(rest_off(reference, held, lack, |q| {
            // The torque that the estimate supplies, in the direction in which it moves.
            let dual = dual(&law.excited(model, q));
            let by = column(&dual * (dual.transpose() * dynamic(&(lacking(q) - holding(q)))));
            let mut taken = law;
            taken.estimate += model.regressor(q, &still, &still, &still).tr_mul(&by).component_mul(&law.adaptation_gain);
            taken.about(model, q, &(reference - q))
        }))
    }
}

/// L with L L' = g, symmetric positive semidefinite, one column for each direction that g has: Cholesky with pivots.
fn excited<T: RealField + Copy, const N: usize>(g: &SMatrix<T, N, N>) -> DMatrix<T> {
    let mut rest = *g;
    let scale = (0..N).map(|i| g[(i, i)]).fold(T::zero(), |a, b| a.max(b));
    let mut columns: Vec<SVector<T, N>> = Vec::new();
    for _ in 0..N {
        let pivot = (0..N).fold(0, |best, i| if rest[(i, i)] > rest[(best, best)] { i } else { best });
        if !(rest[(pivot, pivot)] > scale * T::default_epsilon() * lit(1e3)) {
            break;
        }
        let column: SVector<T, N> = rest.column(pivot) / rest[(pivot, pivot)].sqrt();
        rest -= column * column.transpose();
        columns.push(column);
    }
    DMatrix::from_fn(N, columns.len(), |i, j| columns[j][i])
}

/// y = J* (-K_P J δq - K_D J δv + K_I int) + (I - J* J)(-K_N δq - D_N δv), u = B y + F δv + dg/dq δq. J* is the inverse of the
/// law at this posture, damped or not. The rows with an integral are states of the controller, dm/dt = -J δq. The posture of the
/// null space is taken to be the posture of the linearisation.
impl<R: Dynamics<N>, const N: usize, const M: usize> Linearise<R, N> for OperationalSpace<R::Real, N, M> {
    fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>> {
        let j = self.task.jacobian(&model.geometric_jacobian(q));
        let b = model.inertia_matrix(q);
        let gain = b * self.inverse(&j)?;
        let dg = derivative(q, |q| model.gravity(q));
        let mut position = dg - gain * rows_scaled(&self.k_p, &j);
        let mut velocity = viscous(model) - gain * rows_scaled(&self.k_d, &j);
        if let Some((stiffness, damping)) = self.null_space.map(|null_space| null_space.gains()) {
            let free = b - gain * j;
            position -= columns_scaled(&free, &stiffness);
            velocity -= columns_scaled(&free, &damping);
        }
        let rows: Vec<usize> = (0..M).filter(|i| self.k_i[*i] > nalgebra::zero()).collect();
        Some(Feedback {
            position,
            velocity,
            torque_by_state: DMatrix::from_fn(N, rows.len(), |i, k| gain[(i, rows[k])] * self.k_i[rows[k]]),
            state_by_position: DMatrix::from_fn(rows.len(), N, |k, i| -j[(rows[k], i)]),
            state_by_velocity: DMatrix::zeros(rows.len(), N),
            free: [false; N],
        })
    }
}

/// The law where no limit acts. How it meets a limit is no matter of a linearisation.
impl<R: Dynamics<N>, const N: usize, const M: usize> Linearise<R, N> for Limited<R::Real, N, M> {
    fn linearise(&self, model: &R, q: &SVector<R::Real, N>) -> Option<Feedback<R::Real, N>> {
        self.law.linearise(model, q)
    }
}

impl<P, R, const N: usize, const M: usize> LineariseAtRest<P, R, N> for Limited<R::Real, N, M>
where
    P: Dynamics<N>,
    R: Dynamics<N, Real = P::Real>,
{
    fn settle(&self, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>> {
        self.law.settle(plant, model, reference)
    }
}

impl<T: RealField + Copy, const N: usize, const M: usize> OperationalSpace<T, N, M> {
    /// J*, the inverse of the law at the Jacobian `j` of its rows: J+, or the damped inverse where damping is active.
    fn inverse(&self, j: &SMatrix<T, M, N>) -> Option<SMatrix<T, N, M>> {
        let Some(damping) = &self.damping else { return Some(RightInverse::new(j)?.matrix()) };
        let mut inverse = SMatrix::<T, N, M>::zeros();
        for i in 0..M {
            let mut unit = SVector::<T, M>::zeros();
            unit[i] = T::one();
            inverse.set_column(i, &damping.solve(j, &unit)?.x);
        }
        Some(inverse)
    }

    /// y_0 at rest at `q`: K_N (q_0 - q), with the reference for the posture q_0 of the null space.
    fn posture_acceleration(&self, reference: &SVector<T, N>, q: &SVector<T, N>) -> SVector<T, N> {
        self.null_space.map_or_else(SVector::zeros, |null_space| null_space.gains().0.component_mul(&(reference - q)))
    }

    /// At rest at `q` under `reference`: J+, the errors e of the rows, y_0 of the null space, and a. The equation
    /// J* (a - J y_0) + y_0 = y, as far as the rows of J can give y, has the solution a = (J J*)^-1 J (y - y_0) + J y_0.
    /// `None` where the posture is singular.
    fn at_rest<R: Dynamics<N, Real = T>>(
        &self,
        model: &R,
        reference: &SVector<T, N>,
        q: &SVector<T, N>,
        y: &SVector<T, N>,
    ) -> Option<AtRest<T, N, M>> {
        let j = self.task.jacobian(&model.geometric_jacobian(q));
        let inverse = RightInverse::new(&j)?;
        let e = self.task.error(&Pose::of(model, reference), &Pose::of(model, q));
        let y_0 = self.posture_acceleration(reference, q);
        let through = j * self.inverse(&j)?;
        let a = RightInverse::new(&through)?.solve(&(j * (y - y_0))) + j * y_0;
        Some(AtRest { inverse, e, y_0, a })
    }
}

struct AtRest<T, const N: usize, const M: usize> {
    inverse: RightInverse<T, M, N>,
    e: SVector<T, M>,
    y_0: SVector<T, N>,
    a: SVector<T, M>,
}

/// At rest a = K_P e + K_I int, with e = 0 in rows with an integral and int = 0 in the others. Together with y_0 it gives the
/// acceleration y = B^-1 lack. So K_P e = a in rows without an integral, and (I - J+ J)(y_0 - y) = 0 in the null space. J+ joins
/// both, and B makes them the torques held and lacking. At a singular posture the arm is held only if the model lacks no torque.
impl<P, R, const N: usize, const M: usize> LineariseAtRest<P, R, N> for OperationalSpace<R::Real, N, M>
where
    P: Dynamics<N>,
    R: Dynamics<N, Real = P::Real>,
{
    fn settle(&self, plant: &P, model: &R, reference: &SVector<R::Real, N>) -> Option<Rest<R::Real, N>> {
        let mut feedback = self.linearise(model, reference)?;
        let missing = |q: &SVector<R::Real, N>| Some(model.inertia_matrix(q).cholesky()?.solve(&lack(plant, model, q)));
        if lack(plant, model, reference).amax() == nalgebra::zero() {
            return Some(Rest { q: *reference, is_held: true, feedback });
        }
        // NaN marks a missing posture.
        let nowhere = SVector::repeat(nalgebra::zero::<R::Real>() / nalgebra::zero());
        let torque = |q: &SVector<R::Real, N>, y: SVector<R::Real, N>, held: bool| {
            let torque = self.at_rest(model, reference, q, &y).map(|rest| {
                let without_integral = |i: usize| if self.k_i[i] > nalgebra::zero() { nalgebra::zero() } else { rest.a[i] };
                let (rows, beside) = if held {
                    (self.k_p.component_mul(&rest.e), rest.y_0)
                } else {
                    (SVector::from_fn(|i, _| without_integral(i)), y)
                };
                model.inertia_matrix(q) * (rest.inverse.solve(&rows) + rest.inverse.null_space(&beside))
            });
            torque.unwrap_or(nowhere)
        };
        let nothing = SVector::zeros();
        let held = |q: &SVector<R::Real, N>| torque(q, nothing, true) - torque(q, nothing, false);
        let lacking = |q: &SVector<R::Real, N>| missing(q).map_or(nowhere, |y| torque(q, y, false) - torque(q, nothing, false));
        let found = rest(reference, held, lacking);
        let q = found.unwrap_or(*reference);
        if found.is_some() {
            feedback = self.linearise(model, &q)?;
        }
        // Off the reference the error turns otherwise than by -J, and what holds the arm depends on q: the whole torque, by differences.
        if let Some(AtRest { e, a, .. }) = missing(&q).and_then(|y| self.at_rest(model, reference, &q, &y)) {
            let goal = Pose::of(model, reference);
            let error = |q: &SVector<R::Real, N>| self.task.error(&goal, &Pose::of(model, q));
            feedback.position = derivative(&q, |q| {
                let j = self.task.jacobian(&model.geometric_jacobian(q));
                let y_0 = self.posture_acceleration(reference, q);
                let rows = a + self.k_p.component_mul(&(error(q) - e));
                let y = self.inverse(&j).map(|inverse| inverse * (rows - j * y_0) + y_0);
                y.map_or_else(SVector::zeros, |y| model.inertia_matrix(q) * y + model.gravity(q))
            });
            let by_position = derivative(&q, error);
            let rows = (0..M).filter(|i| self.k_i[*i] > nalgebra::zero());
            for (k, row) in rows.enumerate() {
                feedback.state_by_position.row_mut(k).copy_from(&by_position.row(row));
            }
        }
        Some(Rest { q, is_held: found.is_some(), feedback })
    }
}
