//! Recursive Newton-Euler with rotors (the book, Sect. 7.5), and what follows from it.
//!
//! The outward recursion gives each link frame's angular velocity w, angular acceleration dw, and linear acceleration a of the origin minus
//! gravity. Each body, fixed in a frame whose origin accelerates with a, needs the force and the moment about that origin:
//!
//! ```text
//! F = m a + dw x mc + w x (w x mc)        N = I dw + w x (I w) + mc x a
//! ```
//!
//! A rotor has only the inertia I_m about its axis z, is mounted on a link and spins with k_r dq relative to it. Its angular
//! momentum is I_m (z·w + k_r dq) z. So the link must deliver the moment I_m (z·dw + k_r ddq) z + I_m (z·w + k_r dq) w x z, and
//! the joint k_r I_m (z·dw + k_r ddq). The inward recursion sums the forces and moments and projects them on the joint axes.

use super::kinematics::Posture;
use super::vector::{add, constant, cross, dot, scale, sub, Frame, Vector};
use super::{times, Dual, Matrix, Model, Scalar, Ten};
use crate::precision::RANK;

/// A body's ten numbers turned into base axes: m, m c, I about the frame's origin.
fn in_base<S: Scalar>(frame: &Frame<S>, body: &Ten) -> (S, Vector<S>, [Vector<S>; 3]) {
    let [m, x, y, z, xx, xy, yy, xz, yz, zz] = body.map(S::from);
    let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let rows = frame.r.map(|r| frame.r.map(|s| dot(r, inertia.map(|row| dot(row, s)))));
    (m, frame.turn([x, y, z]), rows)
}

/// A point mass as ten numbers.
fn point(m: f64, [x, y, z]: [f64; 3]) -> Ten {
    [m, m * x, m * y, m * z, m * (y * y + z * z), -m * x * y, m * (x * x + z * z), -m * x * z, -m * y * z, m * (x * x + y * y)]
}

/// How a frame moves: its own velocity and acceleration in base axes.
#[derive(Clone, Copy)]
struct Motion<S> {
    w: Vector<S>,
    dw: Vector<S>,
    v: Vector<S>,
    a: Vector<S>,
}

impl<S: Scalar> Motion<S> {
    /// Motion of a point of the same body at the distance r.
    fn at(self, r: Vector<S>) -> Self {
        let v = cross(self.w, r);
        Motion { v: add(self.v, v), a: add(self.a, add(cross(self.dw, r), cross(self.w, v))), ..self }
    }
}

/// A rigid body: the link that it belongs to (0 is the base), its frame, its ten numbers.
type Attached<S> = (usize, Frame<S>, Ten);

impl Model {
    fn bodies<S: Scalar>(&self, posture: &Posture<S>) -> Vec<Attached<S>> {
        let mut bodies = Vec::new();
        for (i, joint) in self.joints.iter().enumerate() {
            bodies.push((i + 1, posture.frames[i + 1], joint.link));
            if let Some(motor) = &joint.motor {
                bodies.push((joint.on, posture.frames[joint.on], point(motor.mass, motor.position)));
            }
        }
        if let Some(payload) = self.payload {
            bodies.push((self.tip, posture.end, payload));
        }
        bodies
    }

    /// Motions of frames 0 to n; the base falls upwards with -gravity.
    fn motions<S: Scalar>(&self, posture: &Posture<S>, dq: &[S], ddq: &[S], gravity: [f64; 3]) -> Vec<Motion<S>> {
        let rest = constant([0.0; 3]);
        let mut motions = vec![Motion { w: rest, dw: rest, v: rest, a: constant(gravity.map(|g| -g)) }];
        for (i, joint) in self.joints.iter().enumerate() {
            let (z, o) = posture.axes[i];
            let (from, to) = (posture.frames[joint.on].p, posture.frames[i + 1].p);
            let previous = motions[joint.on];
            motions.push(if joint.prismatic {
                let carried = previous.at(sub(to, from));
                let coriolis = scale(S::from(2.0) * dq[i], cross(previous.w, z));
                Motion { v: add(carried.v, scale(dq[i], z)), a: add(carried.a, add(coriolis, scale(ddq[i], z))), ..carried }
            } else {
                let turned = Motion {
                    w: add(previous.w, scale(dq[i], z)),
                    dw: add(previous.dw, add(scale(ddq[i], z), scale(dq[i], cross(previous.w, z)))),
                    ..previous.at(sub(o, from))
                };
                turned.at(sub(to, o))
            });
        }
        motions
    }

    /// Joint torques by Newton-Euler, without friction.
    pub fn newton_euler<S: Scalar>(&self, q: &[S], dq: &[S], ddq: &[S], gravity: [f64; 3]) -> Vec<S> {
        let n = self.dof();
        let posture = Posture::new(self, q);
        let motions = self.motions(&posture, dq, ddq, gravity);

        // Forces on each link, moments about its frame's origin.
        let mut forces = vec![constant::<S>([0.0; 3]); n + 1];
        let mut moments = forces.clone();
        for (link, frame, body) in self.bodies(&posture) {
            let r = sub(frame.p, posture.frames[link].p);
            let Motion { w, dw, a, .. } = motions[link].at(r);
            let (m, mc, inertia) = in_base(&frame, &body);
            let times = |v: Vector<S>| inertia.map(|row| dot(row, v));
            let force = add(scale(m, a), add(cross(dw, mc), cross(w, cross(w, mc))));
            let moment = add(times(dw), add(cross(w, times(w)), cross(mc, a)));
            forces[link] = add(forces[link], force);
            moments[link] = add(moments[link], add(moment, cross(r, force)));
        }

        let mut tau = vec![S::from(0.0); n];
        for (i, joint) in self.joints.iter().enumerate() {
            let Some(motor) = &joint.motor else { continue };
            let (k, inertia) = (S::from(motor.ratio), S::from(motor.inertia.unwrap_or(0.0)));
            let on = joint.on;
            let z = posture.frames[on].turn(constant(motor.axis));
            let Motion { w, dw, .. } = motions[on];
            let acceleration = inertia * (dot(z, dw) + k * ddq[i]);
            let momentum = inertia * (dot(z, w) + k * dq[i]);
            moments[on] = add(moments[on], add(scale(acceleration, z), scale(momentum, cross(w, z))));
            tau[i] = k * acceleration;
        }

        for (i, joint) in self.joints.iter().enumerate() {
            tau[i] = tau[i] + S::from(joint.armature.unwrap_or(0.0)) * ddq[i];
        }

        for i in (0..n).rev() {
            let (z, o) = posture.axes[i];
            let (force, p) = (forces[i + 1], posture.frames[i + 1].p);
            let projection = match self.joints[i].prismatic {
                true => dot(z, force),
                false => dot(z, add(moments[i + 1], cross(sub(p, o), force))),
            };
            tau[i] = tau[i] + projection;
            let on = self.joints[i].on;
            forces[on] = add(forces[on], force);
            moments[on] = add(moments[on], add(moments[i + 1], cross(sub(p, posture.frames[on].p), force)));
        }
        tau
    }

    /// Inertia matrix by unit accelerations, over any scalar.
    fn inertia<S: Scalar>(&self, q: &[S]) -> Vec<Vec<S>> {
        let n = self.dof();
        let rest = vec![S::from(0.0); n];
        let columns: Vec<Vec<S>> = (0..n)
            .map(|j| {
                let mut unit = rest.clone();
                unit[j] = S::from(1.0);
                self.newton_euler(q, &rest, &unit, [0.0; 3])
            })
            .collect();
        (0..n).map(|i| (0..n).map(|j| columns[j][i]).collect()).collect()
    }

    /// B(q), n x n, rotors included.
    pub fn inertia_matrix(&self, q: &[f64]) -> Matrix {
        self.inertia(q)
    }

    /// dB/dq_k for k = 1..n, each n x n, by dual numbers.
    pub fn inertia_matrix_derivatives(&self, q: &[f64]) -> Vec<Matrix> {
        (0..self.dof())
            .map(|k| {
                let mut direction = vec![0.0; self.dof()];
                direction[k] = 1.0;
                let b = self.inertia(&Dual::along(q, &direction));
                b.iter().map(|row| row.iter().map(|x| x.derivative).collect()).collect()
            })
            .collect()
    }

    /// C(q, dq) by Christoffel symbols of the first kind, n x n.
    pub fn coriolis_matrix(&self, q: &[f64], dq: &[f64]) -> Matrix {
        let n = self.dof();
        let db = self.inertia_matrix_derivatives(q);
        let symbol = |i: usize, j: usize, k: usize| 0.5 * (db[k][i][j] + db[j][i][k] - db[i][j][k]);
        (0..n).map(|i| (0..n).map(|j| (0..n).map(|k| symbol(i, j, k) * dq[k]).sum()).collect()).collect()
    }

    /// C(q, dq) v with Christoffel's C, from Newton-Euler alone.
    pub fn coriolis_times(&self, q: &[f64], dq: &[f64], v: &[f64]) -> Vec<f64> {
        let rest = vec![0.0; self.dof()];
        let at = |sign: f64| {
            let rate: Vec<f64> = dq.iter().zip(v).map(|(a, b)| a + sign * b).collect();
            self.newton_euler(q, &rate, &rest, [0.0; 3])
        };
        at(1.0).iter().zip(at(-1.0)).map(|(plus, minus)| 0.25 * (plus - minus)).collect()
    }

    /// g(q).
    pub fn gravity(&self, q: &[f64]) -> Vec<f64> {
        let rest = vec![0.0; self.dof()];
        self.with_springs(q, self.newton_euler(q, &rest, &rest, self.gravity))
    }

    /// Torques plus the spring torques k (q - rest).
    pub fn with_springs<S: Scalar>(&self, q: &[S], torques: Vec<S>) -> Vec<S> {
        let spring = |(joint, &q): (&super::Joint, &S)| S::from(joint.stiffness.unwrap_or(0.0)) * (q - S::from(joint.rest));
        torques.into_iter().zip(self.joints.iter().zip(q).map(spring)).map(|(torque, spring)| torque + spring).collect()
    }

    /// Diagonal of F_v: k_r² F_m + the joint's own.
    pub fn viscous(&self) -> Vec<f64> {
        let motor = |j: &super::Joint| j.motor.as_ref().map_or(0.0, |m| m.ratio * m.ratio * m.viscous.unwrap_or(0.0));
        self.joints.iter().map(|j| motor(j) + j.viscous.unwrap_or(0.0)).collect()
    }

    /// F_v dq + F_c sign(dq), sign(0) = 0.
    pub fn friction(&self, dq: &[f64]) -> Vec<f64> {
        self.friction_at(dq, dq)
    }

    /// F_v dqr + (F_c + F_s exp(-|dq| / v_s)) sign(dq) + F_0 + F_3 dq² dqr, with F_c tanh(dq / v) for F_c sign(dq) where friction is smooth.
    fn friction_at(&self, dq: &[f64], dqr: &[f64]) -> Vec<f64> {
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        let dry = |j: &super::Joint, x: f64| {
            let fading = j.stribeck.unwrap_or(0.0) * (-x.abs() / j.stribeck_velocity).exp();
            match j.smooth {
                Some(v) => j.coulomb.unwrap_or(0.0) * (x / v).tanh(),
                None => (j.coulomb.unwrap_or(0.0) + fading) * sign(x),
            }
        };
        let coulomb = self.joints.iter().zip(dq).map(|(j, &x)| dry(j, x) + j.offset.unwrap_or(0.0));
        let cubic = self.joints.iter().zip(dq).map(|(j, &x)| j.cubic.unwrap_or(0.0) * x * x);
        self.viscous().iter().zip(cubic).zip(dqr).zip(coulomb).map(|(((f, s), x), c)| (f + s) * x + c).collect()
    }

    /// F_l |g| sign(dq), springs part of g.
    pub fn load_friction(&self, q: &[f64], dq: &[f64]) -> Vec<f64> {
        let along = |(joint, &rate): (&super::Joint, &f64)| if rate == 0.0 { 0.0 } else { joint.load * rate.signum() };
        self.joints.iter().zip(dq).map(along).zip(self.gravity(q)).map(|(along, g)| along * g.abs()).collect()
    }

    /// B ddq + C dq + friction + g.
    pub fn inverse_dynamics(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
        let tau = self.with_springs(q, self.newton_euler(q, dq, ddq, self.gravity));
        tau.iter().zip(self.friction(dq)).zip(self.load_friction(q, dq)).map(|((a, b), c)| a + b + c).collect()
    }

    /// B ddqr + C(q, dq) dqr + F_v dqr + F_c sign(dq) + g: the four-argument form, without friction that grows with the load.
    pub fn inverse_dynamics_4(&self, q: &[f64], dq: &[f64], dqr: &[f64], ddqr: &[f64]) -> Vec<f64> {
        let rest = vec![0.0; self.dof()];
        let mut tau = self.with_springs(q, self.newton_euler(q, &rest, ddqr, self.gravity));
        for (i, (c, f)) in self.coriolis_times(q, dq, dqr).iter().zip(self.friction_at(dq, dqr)).enumerate() {
            tau[i] += c + f;
        }
        tau
    }

    /// B⁻¹ (tau - C dq - friction - g); `None` where B is singular to working precision.
    pub fn forward_dynamics(&self, q: &[f64], dq: &[f64], tau: &[f64]) -> Option<Vec<f64>> {
        let bias = self.inverse_dynamics(q, dq, &vec![0.0; self.dof()]);
        let right: Vec<f64> = tau.iter().zip(bias).map(|(t, b)| t - b).collect();
        solve(&self.inertia_matrix(q), &right)
    }

    /// B (ddq - ddq_ref) over max(1, |tau|): what `precision::FORWARD_RESIDUAL` bounds.
    pub fn forward_residual(&self, q: &[f64], ddq: &[f64], ddq_ref: &[f64], tau: &[f64]) -> f64 {
        let difference: Vec<f64> = ddq.iter().zip(ddq_ref).map(|(a, b)| a - b).collect();
        let largest = |v: &[f64]| v.iter().fold(0.0f64, |m, x| if x.is_nan() { f64::NAN } else { m.max(x.abs()) });
        largest(&times(&self.inertia_matrix(q), &difference)) / largest(tau).max(1.0)
    }

    /// Kinetic energy of links, rotors and load, body by body.
    pub fn kinetic_energy(&self, q: &[f64], dq: &[f64]) -> f64 {
        self.kinetic(q, dq)
    }

    pub(crate) fn kinetic<S: Scalar>(&self, q: &[S], dq: &[S]) -> S {
        let posture = Posture::new(self, q);
        let motions = self.motions(&posture, dq, &vec![S::from(0.0); self.dof()], [0.0; 3]);
        let mut twice = S::from(0.0);
        for (link, frame, body) in self.bodies(&posture) {
            let Motion { w, v, .. } = motions[link].at(sub(frame.p, posture.frames[link].p));
            let (m, mc, inertia) = in_base(&frame, &body);
            let spin = dot(w, inertia.map(|row| dot(row, w)));
            twice = twice + m * dot(v, v) + S::from(2.0) * dot(v, cross(w, mc)) + spin;
        }
        for (i, joint) in self.joints.iter().enumerate() {
            twice = twice + S::from(joint.armature.unwrap_or(0.0)) * dq[i] * dq[i];
            let Some(motor) = &joint.motor else { continue };
            let spin =
                dot(posture.frames[joint.on].turn(constant(motor.axis)), motions[joint.on].w) + S::from(motor.ratio) * dq[i];
            twice = twice + S::from(motor.inertia.unwrap_or(0.0)) * spin * spin;
        }
        S::from(0.5) * twice
    }

    /// Potential energy -Σ m g0·p of links, rotors (the first one's, fixed in the base, included) and load, 0 at the base origin, and of springs.
    pub fn potential_energy(&self, q: &[f64]) -> f64 {
        self.potential(q)
    }

    pub(crate) fn potential<S: Scalar>(&self, q: &[S]) -> S {
        let posture = Posture::new(self, q);
        let moment = self.bodies(&posture).into_iter().fold(constant([0.0; 3]), |sum, (_, frame, body)| {
            let (m, mc, _) = in_base(&frame, &body);
            add(sum, add(scale(m, frame.p), mc))
        });
        let twice = self.joints.iter().zip(q).fold(S::from(0.0), |sum, (joint, &q)| {
            let away = q - S::from(joint.rest);
            sum + S::from(joint.stiffness.unwrap_or(0.0)) * away * away
        });
        S::from(0.5) * twice - dot(constant(self.gravity), moment)
    }

    /// Derivative of kinetic plus potential energy along a motion, by dual numbers.
    pub fn power(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> f64 {
        let (q, dq) = (Dual::along(q, dq), Dual::along(dq, ddq));
        (self.kinetic(&q, &dq) + self.potential(&q)).derivative
    }

    /// dU/dq by dual numbers.
    pub fn potential_gradient(&self, q: &[f64]) -> Vec<f64> {
        let unit = |k: usize| (0..self.dof()).map(|i| f64::from(u8::from(i == k))).collect::<Vec<_>>();
        (0..self.dof()).map(|k| self.potential(&Dual::along(q, &unit(k))).derivative).collect()
    }

    /// Derivatives of the inverse dynamics: (∂tau/∂q, ∂tau/∂dq), each n x n, by dual numbers; sign(dq) counts as constant, tanh(dq / v) does not.
    pub fn inverse_dynamics_derivatives(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> (Matrix, Matrix) {
        let n = self.dof();
        let rest = vec![0.0; n];
        let fixed = |v: &[f64]| Dual::along(v, &rest);
        let (mut by_q, mut by_dq) = (vec![vec![0.0; n]; n], vec![vec![0.0; n]; n]);
        let cubic = self.joints.iter().zip(dq).map(|(joint, rate)| 3.0 * joint.cubic.unwrap_or(0.0) * rate * rate);
        let stribeck = self.joints.iter().zip(dq).map(|(joint, rate)| {
            let fading = (-rate.abs() / joint.stribeck_velocity).exp() / joint.stribeck_velocity;
            if *rate == 0.0 {
                0.0
            } else {
                -joint.stribeck.unwrap_or(0.0) * fading
            }
        });
        let smooth =
            self.joints.iter().zip(dq).map(|(joint, rate)| {
                joint.smooth.map_or(0.0, |v| joint.coulomb.unwrap_or(0.0) / (v * (rate / v).cosh().powi(2)))
            });
        let slopes = self.viscous().into_iter().zip(cubic).zip(stribeck).zip(smooth);
        let slope: Vec<f64> = slopes.map(|(((viscous, cubic), stribeck), smooth)| viscous + cubic + stribeck + smooth).collect();
        for k in 0..n {
            let mut unit = rest.clone();
            unit[k] = 1.0;
            let moved = |v: &[f64]| Dual::along(v, &unit);
            let to_q = self.with_springs(&moved(q), self.newton_euler(&moved(q), &fixed(dq), &fixed(ddq), self.gravity));
            let to_dq = self.newton_euler(&fixed(q), &moved(dq), &fixed(ddq), self.gravity);
            let weight = self.with_springs(&moved(q), self.newton_euler(&moved(q), &fixed(&rest), &fixed(&rest), self.gravity));
            for i in 0..n {
                let (g, along) = (&weight[i], if dq[i] == 0.0 { 0.0 } else { self.joints[i].load * dq[i].signum() });
                let sign = if g.value == 0.0 { 0.0 } else { g.value.signum() };
                by_q[i][k] = to_q[i].derivative + along * sign * g.derivative;
                by_dq[i][k] = to_dq[i].derivative + if i == k { slope[k] } else { 0.0 };
            }
        }
        (by_q, by_dq)
    }
}

/// Solves m x = right by elimination with row pivoting; `None` where a pivot vanishes.
pub fn solve(m: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    let n = right.len();
    let mut rows: Matrix = m.iter().zip(right).map(|(row, &r)| row.iter().copied().chain([r]).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, pivot);
        if rows[k][k] == 0.0 || !rows[k][k].is_finite() {
            return None;
        }
        for i in k + 1..n {
            let factor = rows[i][k] / rows[k][k];
            for j in k..=n {
                rows[i][j] -= factor * rows[k][j];
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (rows[k][n] - known) / rows[k][k];
    }
    Some(x)
}

/// Numerical rank of a matrix: columns scaled to length one, then Gram-Schmidt with pivoting, up to `precision::RANK`.
///
/// A column below this fraction of the longest column is rounding, for instance of a sine of pi, and counts as zero.
pub fn rank(rows: &[Vec<f64>]) -> usize {
    let width = rows.first().map_or(0, Vec::len);
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut columns: Matrix = (0..width).map(|j| rows.iter().map(|row| row[j]).collect()).collect();
    let longest = columns.iter().map(|v| length(v)).fold(0.0, f64::max);
    columns.retain(|v| length(v) > RANK * longest);
    for v in &mut columns {
        let l = length(v);
        v.iter_mut().for_each(|x| *x /= l);
    }
    let mut found = 0;
    while let Some(k) = (0..columns.len()).max_by(|&a, &b| length(&columns[a]).total_cmp(&length(&columns[b]))) {
        let pivot = columns.swap_remove(k);
        let l = length(&pivot);
        if l <= RANK {
            break;
        }
        found += 1;
        for v in &mut columns {
            // Twice, so that the rest is orthogonal to rounding.
            for _ in 0..2 {
                let along = v.iter().zip(&pivot).map(|(a, b)| a * b).sum::<f64>() / (l * l);
                v.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= along * p);
            }
        }
    }
    found
}
