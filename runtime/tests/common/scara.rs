//! A SCARA (RRPR) by hand: links of 0.5 m, closed forms with the parameters
//! pi = [m_l1, m_l2, m_l3, I_l1, I_l2, I_l4, I_m1, I_m2, I_m3, I_m4, F_m1, F_m2, F_m3, F_m4].
//!
//! The closed forms follow from the DH table (a = .5 .5 0 0, alpha = 0 pi 0 0, d = 1 0 .5+q3 0, theta4 = q4 - pi/2). The centres of mass of
//! links 1 and 2 lie half way along them. The ratios are k_r = 1, 1, 50, 20, and each rotor is mounted on the link before it.

use armgen_runtime::robot::{Dynamics, EquationsOfMotion, Kinematics, Regressor};
use nalgebra::{convert, matrix, vector, Matrix4, RealField, SMatrix, SVector, Vector4};

/// The nominal parameters.
pub const NOMINAL: [f64; 14] = [20.0, 20.0, 10.0, 4.0, 4.0, 1.0, 0.01, 0.01, 0.005, 0.001, 5e-5, 5e-5, 0.01, 0.005];

/// The SCARA with parameters as data.
#[derive(Clone, Copy, Debug)]
pub struct Scara<T> {
    pub parameters: SVector<T, 14>,
    /// How many times what gravity asks of the slide its dry friction is.
    pub load: T,
}

fn l<T: RealField>(x: f64) -> T {
    convert(x)
}

impl<T: RealField + Copy> Scara<T> {
    pub fn nominal() -> Self {
        Self { parameters: SVector::from_fn(|i, _| l(NOMINAL[i])), load: T::zero() }
    }

    /// The nominal arm with 5 kg at its end effector: the mass of link 3 is 15.
    pub fn loaded() -> Self {
        let mut scara = Self::nominal();
        scara.parameters[2] = l(15.0);
        scara
    }

    /// Without friction.
    pub fn frictionless(mut self) -> Self {
        self.parameters.fixed_rows_mut::<4>(10).fill(T::zero());
        self
    }

    fn h(&self, q: &Vector4<T>) -> T {
        (self.parameters[1] * l(0.125) + self.parameters[2] * l(0.25)) * q[1].sin()
    }

    fn viscous(&self) -> Vector4<T> {
        let p = &self.parameters;
        vector![p[10], p[11], p[12] * l(2500.0), p[13] * l(400.0)]
    }
}

impl<T: RealField + Copy> Kinematics<4> for Scara<T> {
    type Real = T;

    fn direct_kinematics(&self, q: &Vector4<T>) -> Matrix4<T> {
        let (s1, c1) = q[0].sin_cos();
        let (s12, c12) = (q[0] + q[1]).sin_cos();
        let (s, c) = (q[0] + q[1] - q[3]).sin_cos();
        let (o, i, half) = (T::zero(), T::one(), l::<T>(0.5));
        // R = Rz(phi) [[0, 1, 0], [1, 0, 0], [0, 0, -1]]
        matrix![
            -s,  c,  o, half * (c12 + c1);
             c,  s,  o, half * (s12 + s1);
             o,  o, -i, half - q[2];
             o,  o,  o, i
        ]
    }

    fn link_frames(&self, q: &Vector4<T>) -> [Matrix4<T>; 4] {
        let dh = |a: f64, flip: bool, d: T, theta: T| {
            let (s, c) = theta.sin_cos();
            let (o, i) = (T::zero(), T::one());
            let turn = if flip { -i } else { i };
            matrix![
                c, -s * turn, o,    c * l(a);
                s,  c * turn, o,    s * l(a);
                o,  o,        turn, d;
                o,  o,        o,    i
            ]
        };
        let t1 = dh(0.5, false, T::one(), q[0]);
        let t2 = t1 * dh(0.5, true, T::zero(), q[1]);
        let t3 = t2 * dh(0.0, false, l::<T>(0.5) + q[2], T::zero());
        let t4 = t3 * dh(0.0, false, T::zero(), q[3] - T::frac_pi_2());
        [t1, t2, t3, t4]
    }

    fn geometric_jacobian(&self, q: &Vector4<T>) -> SMatrix<T, 6, 4> {
        let (s1, c1) = q[0].sin_cos();
        let (s12, c12) = (q[0] + q[1]).sin_cos();
        let (o, i, half) = (T::zero(), T::one(), l::<T>(0.5));
        matrix![
            -half * (s12 + s1), -half * s12, o,  o;
             half * (c12 + c1),  half * c12, o,  o;
             o, o, -i,  o;
             o, o,  o,  o;
             o, o,  o,  o;
             i, i,  o, -i
        ]
    }

    fn geometric_jacobian_dot(&self, q: &Vector4<T>, dq: &Vector4<T>) -> SMatrix<T, 6, 4> {
        let (s1, c1) = q[0].sin_cos();
        let (s12, c12) = (q[0] + q[1]).sin_cos();
        let half = l::<T>(0.5);
        let (w1, w12) = (dq[0], dq[0] + dq[1]);
        let mut j = SMatrix::zeros();
        j[(0, 0)] = -half * (c12 * w12 + c1 * w1);
        j[(0, 1)] = -half * c12 * w12;
        j[(1, 0)] = -half * (s12 * w12 + s1 * w1);
        j[(1, 1)] = -half * s12 * w12;
        j
    }
}

impl<T: RealField + Copy> Dynamics<4> for Scara<T> {
    fn inertia_matrix(&self, q: &Vector4<T>) -> Matrix4<T> {
        let p = &self.parameters;
        let (m1, m2, m3, i1, i2, i4) = (p[0], p[1], p[2], p[3], p[4], p[5]);
        let (r1, r2, r3, r4) = (p[6], p[7], p[8], p[9]);
        let c = q[1].cos();
        let x = l::<T>;
        let b22 = i2 + i4 + r2 + r3 + r4 + m2 * x(0.0625) + m3 * x(0.25);
        let b12 = b22 + (m2 * x(0.125) + m3 * x(0.25)) * c;
        let b11 =
            i1 + i2 + i4 + r1 + r2 + r3 + r4 + m1 * x(0.0625) + m2 * x(0.3125) + m3 * x(0.5) + (m2 * x(0.25) + m3 * x(0.5)) * c;
        let (b13, b14) = (r3 * x(-50.0), -i4 - r4 * x(20.0));
        let (b33, b44) = (m3 + r3 * x(2500.0), i4 + r4 * x(400.0));
        let o = T::zero();
        matrix![
            b11, b12, b13, b14;
            b12, b22, b13, b14;
            b13, b13, b33, o;
            b14, b14, o,   b44
        ]
    }

    fn coriolis_matrix(&self, q: &Vector4<T>, dq: &Vector4<T>) -> Matrix4<T> {
        let h = self.h(q);
        let mut c = Matrix4::zeros();
        c[(0, 0)] = -h * dq[1];
        c[(0, 1)] = -h * (dq[0] + dq[1]);
        c[(1, 0)] = h * dq[0];
        c
    }

    fn gravity(&self, _q: &Vector4<T>) -> Vector4<T> {
        vector![T::zero(), T::zero(), self.parameters[2] * l(-9.81), T::zero()]
    }

    fn friction(&self, dq: &Vector4<T>) -> Vector4<T> {
        self.viscous().component_mul(dq)
    }

    fn load_friction(&self, q: &Vector4<T>, dq: &Vector4<T>) -> Vector4<T> {
        let sign = |rate: T| if rate == T::zero() { rate } else { rate.signum() };
        vector![T::zero(), T::zero(), self.load * self.gravity(q)[2].abs() * sign(dq[2]), T::zero()]
    }

    fn equations_of_motion(&self, q: &Vector4<T>, dq: &Vector4<T>) -> EquationsOfMotion<T, 4> {
        EquationsOfMotion { inertia: self.inertia_matrix(q), coriolis: self.coriolis_matrix(q, dq), gravity: self.gravity(q) }
    }

    fn inverse_dynamics(&self, q: &Vector4<T>, dq: &Vector4<T>, ddq: &Vector4<T>) -> Vector4<T> {
        self.inertia_matrix(q) * ddq
            + self.coriolis_matrix(q, dq) * dq
            + self.friction(dq)
            + self.load_friction(q, dq)
            + self.gravity(q)
    }

    fn forward_dynamics(&self, q: &Vector4<T>, dq: &Vector4<T>, tau: &Vector4<T>) -> Vector4<T> {
        let rest = tau - self.coriolis_matrix(q, dq) * dq - self.friction(dq) - self.load_friction(q, dq) - self.gravity(q);
        match self.inertia_matrix(q).cholesky() {
            Some(b) => b.solve(&rest),
            None => rest * (T::zero() / T::zero()),
        }
    }

    fn kinetic_energy(&self, q: &Vector4<T>, dq: &Vector4<T>) -> T {
        dq.dot(&(self.inertia_matrix(q) * dq)) * l(0.5)
    }

    fn potential_energy(&self, q: &Vector4<T>) -> T {
        self.parameters[2] * l(9.81) * (l::<T>(0.5) - q[2])
    }
}

impl<T: RealField + Copy> Regressor<4, 14> for Scara<T> {
    fn regressor(&self, q: &Vector4<T>, dq: &Vector4<T>, r: &Vector4<T>, a: &Vector4<T>) -> SMatrix<T, 4, 14> {
        let x = l::<T>;
        let (s, c) = q[1].sin_cos();
        let (a1, a2, a3, a4) = (a[0], a[1], a[2], a[3]);
        let sum = a1 + a2;
        let k1 = dq[1] * r[0] + (dq[0] + dq[1]) * r[1];
        let k2 = dq[0] * r[0];
        let mut y = SMatrix::zeros();
        y[(0, 0)] = a1 * x(0.0625);
        y[(0, 1)] = (a1 * x(5.0) + a2 + c * (a1 * x(4.0) + a2 * x(2.0)) - s * k1 * x(2.0)) * x(0.0625);
        y[(0, 2)] = (a1 * x(2.0) + a2 + c * (a1 * x(2.0) + a2) - s * k1) * x(0.25);
        y[(1, 1)] = (sum + c * a1 * x(2.0) + s * k2 * x(2.0)) * x(0.0625);
        y[(1, 2)] = (sum + c * a1 + s * k2) * x(0.25);
        y[(0, 3)] = a1;
        y[(0, 6)] = a1;
        y[(0, 10)] = r[0];
        for row in 0..2 {
            y[(row, 4)] = sum;
            y[(row, 5)] = sum - a4;
            y[(row, 7)] = sum;
            y[(row, 8)] = sum - a3 * x(50.0);
            y[(row, 9)] = sum - a4 * x(20.0);
        }
        y[(1, 11)] = r[1];
        y[(2, 2)] = a3 - x(9.81);
        y[(2, 8)] = (sum - a3 * x(50.0)) * x(-50.0);
        y[(2, 12)] = r[2] * x(2500.0);
        y[(3, 5)] = a4 - sum;
        y[(3, 9)] = (sum - a4 * x(20.0)) * x(-20.0);
        y[(3, 13)] = r[3] * x(400.0);
        y
    }

    fn known_torque(&self, _: &Vector4<T>, _: &Vector4<T>, _: &Vector4<T>, _: &Vector4<T>) -> Vector4<T> {
        Vector4::zeros()
    }

    fn parameters(&self) -> SVector<T, 14> {
        self.parameters
    }
}
