//! Arms of N rotary joints from tables of Denavit and Hartenberg: Newton and Euler in the base frame, B from Jacobians of the links.

use armgen_runtime::robot::{Dynamics, EquationsOfMotion, Kinematics};
use nalgebra::{vector, Matrix3, Matrix4, SMatrix, SVector, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A link and the joint before it; standard convention.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// a, alpha, d, offset of theta.
    pub table: [f64; 4],
    pub mass: f64,
    /// Centre of mass in the link's frame.
    pub centre: [f64; 3],
    /// xx, yy, zz, xy, yz, xz about the centre of mass.
    pub inertia: [f64; 6],
    /// Inertia of the rotor on the side of the joint, viscous and Coulomb friction.
    pub rotor: [f64; 3],
}

#[derive(Clone, Copy, Debug)]
pub struct Chain<const N: usize> {
    pub links: [Link; N],
}

const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

fn link(table: [f64; 4], mass: f64, centre: [f64; 3], inertia: [f64; 6]) -> Link {
    Link { table, mass, centre, inertia, rotor: [0.0; 3] }
}

/// The numbers of robots/ur5.yaml.
pub fn ur5() -> Chain<6> {
    let wrist = 0.111172756;
    Chain {
        links: [
            link([0.0, -FRAC_PI_2, 0.089159, 0.0], 3.7, [0.0; 3], [0.010267496, 0.00666, 0.010267496, 0.0, 0.0, 0.0]),
            link([0.425, 0.0, 0.0, 0.0], 8.393, [-0.145, 0.0, 0.13585], [0.0151074, 0.226890676, 0.226890676, 0.0, 0.0, 0.0]),
            link([0.39225, 0.0, 0.0, 0.0], 2.275, [-0.14225, 0.0, 0.01615], [0.004095, 0.049443314, 0.049443314, 0.0, 0.0, 0.0]),
            link([0.0, -FRAC_PI_2, 0.10915, 0.0], 1.219, [0.0, 0.093, 0.0], [wrist, wrist, 0.21942, 0.0, 0.0, 0.0]),
            link([0.0, FRAC_PI_2, 0.09465, 0.0], 1.219, [0.0, -0.09465, 0.0], [wrist, 0.21942, wrist, 0.0, 0.0, 0.0]),
            link([0.0, 0.0, 0.0823, 0.0], 0.1879, [0.0, 0.0, -0.0823], [0.017136473, 0.033822, 0.017136473, 0.0, 0.0, 0.0]),
        ],
    }
}

/// The numbers of robots/panda7.yaml.
pub fn panda() -> Chain<7> {
    let h = FRAC_PI_2;
    Chain {
        links: [
            link(
                [0.0, -h, 0.333, 0.0],
                4.970684,
                [0.003875, 0.04762, 0.002081],
                [0.70337, 0.009117, 0.70661, -0.006772, -0.019169, -0.000139],
            ),
            link(
                [0.0, h, 0.0, 0.0],
                0.646926,
                [-0.003141, 0.003495, 0.02872],
                [0.007962, 0.025995, 0.02811, 0.010254, -0.000704, 0.003925],
            ),
            link(
                [0.0825, h, 0.316, 0.0],
                3.228604,
                [-0.054982, -0.066502, -0.039252],
                [0.037242, 0.01083, 0.036155, -0.011396, 0.012805, 0.004761],
            ),
            link(
                [0.0825, h, 0.0, PI],
                3.587895,
                [-0.02933, 0.027454, 0.104419],
                [0.025853, 0.028323, 0.019552, 0.001332, 0.008641, -0.007796],
            ),
            link(
                [0.0, -h, 0.384, 0.0],
                1.225946,
                [0.011953, 0.038437, -0.041065],
                [0.035549, 0.008627, 0.029474, -0.004037, 0.000229, -0.002117],
            ),
            link(
                [0.088, h, 0.0, PI],
                1.666555,
                [-0.027851, -0.010517, 0.014117],
                [0.001964, 0.005433, 0.004354, -0.001158, -0.000341, -0.000109],
            ),
            link(
                [0.0, 0.0, 0.107, 0.0],
                1.495522,
                [0.001720874, 0.001360354, -0.006514719],
                [0.016529854, 0.014107249, 0.006676956, 0.000394892, -0.001051105, -0.000706696],
            ),
        ],
    }
}

/// An arm of five small servos, made up: links of 12 to 15 cm, rotors behind gears, dry friction.
pub fn hobby() -> Chain<5> {
    let rod = |mass: f64, a: f64| [1e-5, mass * a * a / 12.0, mass * a * a / 12.0, 0.0, 0.0, 0.0];
    let servo = |inertia: f64| [inertia, 0.02, 0.03];
    let with = |rotor, link: Link| Link { rotor, ..link };
    Chain {
        links: [
            with(servo(4e-3), link([0.0, FRAC_PI_2, 0.08, 0.0], 0.15, [0.0, -0.02, 0.0], [1e-4, 1e-4, 1e-4, 0.0, 0.0, 0.0])),
            with(servo(4e-3), link([0.15, 0.0, 0.0, 0.0], 0.12, [-0.07, 0.0, 0.0], rod(0.12, 0.15))),
            with(servo(4e-3), link([0.14, 0.0, 0.0, 0.0], 0.1, [-0.07, 0.0, 0.0], rod(0.1, 0.14))),
            with(servo(2e-3), link([0.0, FRAC_PI_2, 0.0, FRAC_PI_2], 0.06, [0.0, 0.0, 0.02], [4e-5, 4e-5, 4e-5, 0.0, 0.0, 0.0])),
            with(servo(2e-3), link([0.0, 0.0, 0.12, 0.0], 0.08, [0.0, 0.0, -0.04], [6e-5, 6e-5, 3e-5, 0.0, 0.0, 0.0])),
        ],
    }
}

impl<const N: usize> Chain<N> {
    /// Masses and inertias of link i times 1 + `by(i)`.
    pub fn off(mut self, mut by: impl FnMut(usize) -> f64) -> Self {
        for (i, link) in self.links.iter_mut().enumerate() {
            let factor = 1.0 + by(i);
            link.mass *= factor;
            link.inertia.iter_mut().for_each(|x| *x *= factor);
        }
        self
    }

    pub fn without_friction(mut self) -> Self {
        self.links.iter_mut().for_each(|link| link.rotor = [link.rotor[0], 0.0, 0.0]);
        self
    }

    /// Origins and axes of the joints, centres of mass and inertias of the links, in the base frame.
    fn bodies(&self, q: &SVector<f64, N>) -> [(Vector3<f64>, Vector3<f64>, Vector3<f64>, Matrix3<f64>); N] {
        let frames = self.link_frames(q);
        std::array::from_fn(|i| {
            let before = if i == 0 { Matrix4::identity() } else { frames[i - 1] };
            let (o, z) = (before.fixed_view::<3, 1>(0, 3).into_owned(), before.fixed_view::<3, 1>(0, 2).into_owned());
            let r = frames[i].fixed_view::<3, 3>(0, 0).into_owned();
            let [xx, yy, zz, xy, yz, xz] = self.links[i].inertia;
            let inertia = r * Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) * r.transpose();
            (o, z, frames[i].fixed_view::<3, 1>(0, 3) + r * Vector3::from(self.links[i].centre), inertia)
        })
    }

    /// Newton and Euler: B ddq + C dq + g with gravity `gravity`, no friction.
    fn torques(
        &self,
        q: &SVector<f64, N>,
        dq: &SVector<f64, N>,
        ddq: &SVector<f64, N>,
        gravity: Vector3<f64>,
    ) -> SVector<f64, N> {
        let bodies = self.bodies(q);
        let (mut w, mut dw, mut a, mut at) = (Vector3::zeros(), Vector3::zeros(), -gravity, Vector3::zeros());
        let mut loads = [(Vector3::zeros(), Vector3::zeros()); N];
        for (i, (o, z, c, inertia)) in bodies.iter().enumerate() {
            let to = |from: Vector3<f64>, to: Vector3<f64>, a: Vector3<f64>, w: Vector3<f64>, dw: Vector3<f64>| {
                a + dw.cross(&(to - from)) + w.cross(&w.cross(&(to - from)))
            };
            (a, at) = (to(at, *o, a, w, dw), *o);
            dw += z * ddq[i] + w.cross(&(z * dq[i]));
            w += z * dq[i];
            let force = to(at, *c, a, w, dw) * self.links[i].mass;
            loads[i] = (force, inertia * dw + w.cross(&(inertia * w)));
        }
        SVector::from_fn(|i, _| {
            let (o, z, ..) = bodies[i];
            let moment = (i..N).fold(Vector3::zeros(), |sum, k| sum + loads[k].1 + (bodies[k].2 - o).cross(&loads[k].0));
            z.dot(&moment) + self.links[i].rotor[0] * ddq[i]
        })
    }
}

impl<const N: usize> Kinematics<N> for Chain<N> {
    type Real = f64;
    fn direct_kinematics(&self, q: &SVector<f64, N>) -> Matrix4<f64> {
        self.link_frames(q)[N - 1]
    }
    fn link_frames(&self, q: &SVector<f64, N>) -> [Matrix4<f64>; N] {
        let mut t = Matrix4::identity();
        std::array::from_fn(|i| {
            let [a, alpha, d, theta] = self.links[i].table;
            let ((s, c), (sa, ca)) = ((q[i] + theta).sin_cos(), alpha.sin_cos());
            t *= Matrix4::new(c, -s * ca, s * sa, a * c, s, c * ca, -c * sa, a * s, 0.0, sa, ca, d, 0.0, 0.0, 0.0, 1.0);
            t
        })
    }
    fn geometric_jacobian(&self, q: &SVector<f64, N>) -> SMatrix<f64, 6, N> {
        let p = self.direct_kinematics(q).fixed_view::<3, 1>(0, 3).into_owned();
        let bodies = self.bodies(q);
        let mut j = SMatrix::<f64, 6, N>::zeros();
        for (i, (o, z, ..)) in bodies.iter().enumerate() {
            j.fixed_view_mut::<3, 1>(0, i).copy_from(&z.cross(&(p - o)));
            j.fixed_view_mut::<3, 1>(3, i).copy_from(z);
        }
        j
    }
    fn geometric_jacobian_dot(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> SMatrix<f64, 6, N> {
        let h = 1e-6;
        (self.geometric_jacobian(&(q + dq * h)) - self.geometric_jacobian(&(q - dq * h))) / (2.0 * h)
    }
}

impl<const N: usize> Dynamics<N> for Chain<N> {
    fn inertia_matrix(&self, q: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        let bodies = self.bodies(q);
        let mut b = SMatrix::<f64, N, N>::zeros();
        for k in 0..N {
            let (.., c, inertia) = bodies[k];
            for i in 0..=k {
                let (o, z, ..) = bodies[i];
                let (v, w) = (z.cross(&(c - o)) * self.links[k].mass, inertia * z);
                for m in 0..=i {
                    let (o, z, ..) = bodies[m];
                    b[(i, m)] += v.dot(&z.cross(&(c - o))) + w.dot(&z);
                }
            }
        }
        b.fill_upper_triangle_with_lower_triangle();
        b + SMatrix::from_diagonal(&SVector::from_fn(|i, _| self.links[i].rotor[0]))
    }
    /// Christoffel's symbols, by differences of B.
    fn coriolis_matrix(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        let h = 1e-5;
        let d: [SMatrix<f64, N, N>; N] = std::array::from_fn(|k| {
            let mut by = SVector::zeros();
            by[k] = h;
            (self.inertia_matrix(&(q + by)) - self.inertia_matrix(&(q - by))) / (2.0 * h)
        });
        SMatrix::from_fn(|i, j| (0..N).map(|k| 0.5 * (d[k][(i, j)] + d[j][(i, k)] - d[i][(j, k)]) * dq[k]).sum())
    }
    fn gravity(&self, q: &SVector<f64, N>) -> SVector<f64, N> {
        self.torques(q, &SVector::zeros(), &SVector::zeros(), GRAVITY)
    }
    fn friction(&self, dq: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|i, _| {
            let [_, viscous, coulomb] = self.links[i].rotor;
            viscous * dq[i] + if dq[i] == 0.0 { 0.0 } else { coulomb * dq[i].signum() }
        })
    }
    fn equations_of_motion(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> EquationsOfMotion<f64, N> {
        EquationsOfMotion { inertia: self.inertia_matrix(q), coriolis: self.coriolis_matrix(q, dq), gravity: self.gravity(q) }
    }
    fn inverse_dynamics(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>, ddq: &SVector<f64, N>) -> SVector<f64, N> {
        self.torques(q, dq, ddq, GRAVITY) + self.friction(dq)
    }
    fn forward_dynamics(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>, tau: &SVector<f64, N>) -> SVector<f64, N> {
        let n = self.inverse_dynamics(q, dq, &SVector::zeros());
        armgen_runtime::linalg::Cholesky::new(&self.inertia_matrix(q)).unwrap().solve(&(tau - n))
    }
    fn kinetic_energy(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> f64 {
        0.5 * dq.dot(&(self.inertia_matrix(q) * dq))
    }
    fn potential_energy(&self, q: &SVector<f64, N>) -> f64 {
        self.bodies(q).iter().zip(&self.links).map(|((.., c, _), link)| -link.mass * GRAVITY.dot(c)).sum()
    }
}

/// The two formulations agree: B from Newton and Euler, g the gradient of U, dB/dt - 2 C skew.
#[test]
fn a_chain_agrees_with_itself() {
    let (arm, q, dq) = (panda(), vector![0.2, -0.4, 0.3, -2.0, 0.1, 1.7, 0.7], vector![0.3, -0.2, 0.5, 0.1, -0.4, 0.2, 0.6]);
    let b = arm.inertia_matrix(&q);
    for i in 0..7 {
        let mut unit = SVector::<f64, 7>::zeros();
        unit[i] = 1.0;
        let column = arm.torques(&q, &SVector::zeros(), &unit, Vector3::zeros());
        assert!((column - b.column(i)).amax() < 1e-13, "{i}");
        let u = |h: f64| arm.potential_energy(&(q + unit * h));
        assert!((arm.gravity(&q)[i] - (u(1e-5) - u(-1e-5)) / 2e-5).abs() < 1e-8, "{i}");
    }
    let centrifugal = arm.torques(&q, &dq, &SVector::zeros(), Vector3::zeros());
    assert!((arm.coriolis_matrix(&q, &dq) * dq - centrifugal).amax() < 1e-8);
}
