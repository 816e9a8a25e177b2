//! Derivatives of inverse and of forward dynamics by joint variables and rates.
//!
//! ```text
//! ∂tau/∂dq = 2 C(q, dq) + ∂F/∂dq         as C dq is quadratic in dq with Christoffel's symbols for coefficients, symmetric in the last two
//! ∂tau_i/∂q_j = ∫ ∂_i ∂_j x · (d²x/dt² - g0) dm + ∫ ∂_i x · d²/dt² (∂_j x) dm         from tau_i = ∫ ∂_i x · (d²x/dt² - g0) dm
//! ```
//!
//! For a revolute joint j, ∂_j x = z × r with r from its origin o, over all that joint j carries, and
//! d²/dt² (z × r) = z'' × r + 2 z' × r' + z × r''. With the force f and moment n that move what joint j carries (Newton-Euler), the
//! acceleration a of o less g0, the angular velocity Ω and acceleration field U of the link, z' = Ω × z and z'' = U z, r' = Ω × r + v,
//! and the moments S, h, K = ∫ v rᵀ dm, h_v = ∫ v dm of `coriolis.rs`, each joint at or before j feels the wrench
//!
//! ```text
//! F = z × f - m z × a + z'' × h + 2 (z' · h) Ω + 2 z' × h_v
//! N = z × n - h × (z × a) + (tr S - S) z'' + 2 (S z') × Ω + 2 (tr K - K) z'
//! ```
//!
//! A joint i beyond j feels, with the column (f_i, n_i) of B and E_i = ∫ r' × (z_i × r_i) dm of `coriolis.rs`, all about o_j,
//!
//! ```text
//! ∂tau_i/∂q_j = z'' · n_i + 2 z' · E_i - (z × a) · f_i = (z'' - 2 Ω × z') · n_i + 2 z' · (E_i + n_i × Ω) - (z × a) · f_i
//! ```
//!
//! where `coriolis.rs` passes on E + n × Ω, and z'' - 2 Ω × z' is the z row of U, negated: both are known already.
//! A prismatic joint has ∂_j x = z: F = m z'', N = z × f + h × z'' before it, z'' · f_i beyond it.
//! A rotor adds to n, n_i and E_i what it adds to them in `newton_euler.rs` and `coriolis.rs`, and the rotors' momentum s adds z' × s to N.
//! The formulas follow Singh, Russell and Wensing (2022, "Efficient analytical derivatives of rigid-body dynamics using spatial
//! vector algebra"); moments instead of 6 x 6 matrices, and one set of columns for B, C and ∂tau/∂q, are ours.
//!
//! ```text
//! ∂ddq/∂q = -B^-1 ∂tau/∂q,   ∂ddq/∂dq = -B^-1 ∂tau/∂dq,   ∂ddq/∂tau = B^-1            at ddq = B^-1 (tau - C dq - F - g)
//! ```

use super::coriolis::{self, VelocityMoments};
use super::gravity::gravity;
use super::inertia::composite_bodies;
use super::load_friction::{add_load_friction, add_load_friction_derivatives};
use crate::derive::arm::{symmetric, Arm, Body};
use crate::derive::columns::ColumnPropagator;
use crate::derive::factors::LdlFactors;
use crate::derive::friction::{add_slopes, friction};
use crate::derive::motion::{link_motions, LinkMotion, Motion};
use crate::derive::newton_euler::wrenches;
use crate::derive::passes::RewriteScope;
use crate::derive::plan::Plan;
use crate::derive::quantity::{Argument, Documentation, Feature, Length, Quantity, Recursion, ResultPart, Typeset};
use crate::derive::rotors;
use crate::derive::wrench::{axis_component, wrench_to_parent};
use crate::ring::matrix::Vector;
use crate::ring::{ExprId, Pool, Symbol};

/// In the order of the emitted module.
pub(super) static DECLARED: [&Quantity; 2] = [&INVERSE_DYNAMICS_DERIVATIVES, &FORWARD_DYNAMICS_DERIVATIVES];

/// ∂tau/∂q and ∂tau/∂dq.
pub static INVERSE_DYNAMICS_DERIVATIVES: Quantity = Quantity {
    name: "inverse_dynamics_derivatives",
    symbol: Typeset::new("dtau/dq, dtau/d(dq)", "\\partial\\tau/\\partial q, \\partial\\tau/\\partial\\dot q"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq, Argument::Ddq],
    result: &[
        ResultPart {
            name: "by_q",
            meaning: ["Derivatives by joint variables", ""],
            ..ResultPart::whole(Typeset::new("dtau/dq", "\\partial\\tau/\\partial q"), Typeset::new("dtau", "\\partial\\tau"), &[Length::Dof, Length::Dof], "N m or N, per rad or m")
        },
        ResultPart {
            name: "by_dq",
            meaning: ["Derivatives by rates", ""],
            ..ResultPart::whole(Typeset::new("dtau/d(dq)", "\\partial\\tau/\\partial\\dot q"), Typeset::new("dtau", "\\partial\\tau"), &[Length::Dof, Length::Dof], "N m or N, per rad/s or m/s")
        },
    ],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Derivatives of the torques of {inverse_dynamics} by joint variables and by rates.",
        "(dtau/dq, dtau/d(dq)) at (q, dq, ddq);  dtau/d(ddq) = B(q)         (Singh, Russell and Wensing 2022)",
        "two matrices `m[joint of tau][joint of q or dq]`; units of tau per rad or m, and per rad/s or m/s. Coulomb friction counts as constant: its \
         derivative is taken as 0, at rest too.",
    )
    .with(Feature::SmoothFriction, SMOOTH)
    .with(Feature::LoadFriction, LOAD),
    recursion: Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| {
        let motion = Motion::plain(pool, arm);
        let (by_q, by_dq) = inverse_dynamics_derivatives(pool, arm, plan, &motion);
        [by_q, by_dq].concat().concat()
    }),
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("InverseDynamicsDerivatives"),
};

/// ∂ddq/∂q, ∂ddq/∂dq and B^-1.
pub static FORWARD_DYNAMICS_DERIVATIVES: Quantity = Quantity {
    name: "forward_dynamics_derivatives",
    symbol: Typeset::new("d(ddq)/dq, d(ddq)/d(dq), B^-1", "\\partial\\ddot q/\\partial q, \\partial\\ddot q/\\partial\\dot q, B^{-1}"),
    arguments: &[Argument::Gravity, Argument::Q, Argument::Dq, Argument::Tau],
    result: &[
        ResultPart {
            name: "by_q",
            meaning: ["Derivatives by joint variables", ""],
            ..ResultPart::whole(Typeset::new("d(ddq)/dq", "\\partial\\ddot q/\\partial q"), Typeset::new("dddq", "\\partial\\ddot q"), &[Length::Dof, Length::Dof], "rad/s² or m/s², per rad or m")
        },
        ResultPart {
            name: "by_dq",
            meaning: ["Derivatives by rates", ""],
            ..ResultPart::whole(Typeset::new("d(ddq)/d(dq)", "\\partial\\ddot q/\\partial\\dot q"), Typeset::new("dddq", "\\partial\\ddot q"), &[Length::Dof, Length::Dof], "rad/s² or m/s², per rad/s or m/s")
        },
        ResultPart {
            name: "by_tau",
            meaning: ["Derivatives by torques", ", the inverse of B"],
            ..ResultPart::whole(Typeset::new("B^-1", "B^{-1}"), Typeset::new("dddq", "\\partial\\ddot q"), &[Length::Dof, Length::Dof], "rad/s² or m/s², per N m or N")
        },
    ],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Derivatives of the accelerations of {forward_dynamics} by joint variables, by rates and by torques.",
        "(-B^-1 dtau/dq, -B^-1 dtau/d(dq), B^-1) at ddq = forward_dynamics(q, dq, tau)  (Carpentier and Mansard 2018)",
        "three matrices `m[joint of ddq][joint of q, dq or tau]`; units of ddq per rad or m, per rad/s or m/s, and per N m or N. The third is the \
         inverse of the inertia matrix. Coulomb friction counts as constant: its derivative is taken as 0, at rest too.",
    )
    .with(Feature::SmoothFriction, SMOOTH)
    .with(Feature::LoadFriction, LOAD),
    recursion: Recursion {
        in_coordinates: true,
        ..Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, _| {
            let (by_q, by_dq, inverse) = forward_dynamics_derivatives(pool, arm, plan);
            [by_q, by_dq, inverse].concat().concat()
        })
    },
    missing: Quantity::MISSING_WITHOUT_MASS,
    gathers: &[],
    interface: Some("ForwardDynamicsDerivatives"),
};

/// Documentation of the derivatives of smooth friction.
const SMOOTH: &str = "Smooth friction is no constant: its derivative by dq_i is F_c (1 - tanh(dq_i / v)²) / v.";

/// Documentation of the derivatives of friction that grows with the load.
const LOAD: &str =
    "Of friction that grows with the load they have F_l sign(g_i) sign(dq_i) dg_i/dq, sign(0) = 0: that jumps where g_i changes its sign.";

type Rows = Vec<Vec<ExprId>>;

/// ∂tau/∂q and ∂tau/∂dq of the torques with friction, in the second its slopes, and springs, k in the first; functions of
/// friction that jump count as constant there.
pub fn inverse_dynamics_derivatives(pool: &mut Pool, arm: &Arm, plan: &mut Plan, motion: &Motion) -> (Rows, Rows) {
    let c = coriolis::coriolis_matrix(pool, arm, plan);
    let two = pool.integer(2);
    let mut by_rates: Rows = c.iter().map(|row| row.iter().map(|&entry| pool.mul(two, entry)).collect()).collect();
    for i in 0..arm.dof() {
        by_rates[i][i] = add_slopes(pool, arm, i, by_rates[i][i]);
    }
    rotors::add_friction_slopes(pool, arm, &mut by_rates);
    let mut by_positions = by_positions(pool, arm, motion);
    for (i, joint) in arm.joints.iter().enumerate() {
        by_positions[i][i] = pool.add(by_positions[i][i], joint.stiffness);
    }
    add_load_friction_derivatives(pool, arm, plan, &mut by_positions);
    (by_positions, by_rates)
}

/// ∂ddq/∂q, ∂ddq/∂dq and B^-1.
pub fn forward_dynamics_derivatives(pool: &mut Pool, arm: &Arm, plan: &mut Plan) -> (Rows, Rows, Rows) {
    let (b, c) = coriolis::inertia_and_coriolis(pool, arm, plan);
    let g = gravity(pool, arm, plan);
    let rates = arm.symbols(pool, Symbol::Rate);
    let mut resistance = friction(pool, arm, &rates);
    add_load_friction(pool, arm, plan, &mut resistance);
    let bias: Vec<ExprId> = (0..arm.dof())
        .map(|i| {
            let centrifugal = pool.dot(&c[i], &rates);
            pool.sum([centrifugal, g[i], resistance[i]])
        })
        .collect();
    let (bias, b) = (arm.project(pool, bias), arm.project_matrix(pool, b));
    let n = b.len();
    let right: Vec<ExprId> = (0..n)
        .map(|i| {
            let tau = pool.symbol(Symbol::Torque(i as u16));
            pool.sub(tau, bias[i])
        })
        .collect();
    let factors = LdlFactors::of_inertia_under_gravity(pool, arm, &b);
    let accelerations = factors.solve(pool, &right);
    let motion = Motion { accelerations: arm.spread(pool, accelerations), ..Motion::plain(pool, arm) };
    let inverse = factors.inverse(pool);
    let (by_q, by_rates) = inverse_dynamics_derivatives(pool, arm, plan, &motion);
    let (by_q, by_rates) = (arm.project_matrix(pool, by_q), arm.project_matrix(pool, by_rates));
    let mut solved = |m: &Rows| -> Rows {
        let columns: Rows = (0..n).map(|j| m.iter().map(|row| row[j]).collect()).collect();
        inverse.iter().map(|row| columns.iter().map(|column| -pool.dot(row, column)).collect()).collect()
    };
    (solved(&by_q), solved(&by_rates), inverse)
}

/// ∂tau/∂q.
fn by_positions(pool: &mut Pool, arm: &Arm, motion: &Motion) -> Rows {
    let n = arm.dof();
    let motions = link_motions(pool, arm, motion, true);
    // Without rotors of their own file, which are added as a whole.
    let bare = Arm { rotors: Vec::new(), ..arm.clone() };
    let (_, loads) = wrenches(pool, &bare, motion, &motions);
    let composite = composite_bodies(pool, arm);
    let omega = coriolis::angular_velocities(pool, arm);
    let velocity_moments = coriolis::velocity_moments(pool, arm, &composite);
    let axes: Vec<AxisMotion> = (0..n).map(|j| AxisMotion::new(pool, &omega[j], &motions[j])).collect();
    let mut propagator = ColumnPropagator::new(arm, Some(&omega));
    let mut plain = Plan::default();
    let mut derivative = vec![vec![ExprId::ZERO; n]; n];
    for j in (0..n).rev() {
        // What joint j changes at itself and before it.
        let (mut force, mut moment) =
            changed_wrench(pool, arm, j, &axes[j], &omega[j], &loads[j], &composite[j], &velocity_moments[j]);
        derivative[j][j] = axis_component(arm, j, &force, &moment);
        let mut link = j;
        while let Some(parent) = arm.joints[link].parent {
            (force, moment) = wrench_to_parent(pool, arm, link, &force, &moment);
            derivative[parent][j] = axis_component(arm, parent, &force, &moment);
            link = parent;
        }
        // The effect of the joints before j.
        let column = coriolis::composite_column(pool, arm, j, &omega, &composite[j], &velocity_moments[j]);
        let mut propagated = propagator.start(pool, &mut plain, column, j);
        while let Some(parent) = propagator.propagate_to_parent(pool, &mut plain, &mut propagated) {
            derivative[j][parent] =
                torque_derivative(pool, arm.joints[parent].is_revolute(), &axes[parent], propagated.in_link_frame());
        }
    }
    rotors::add_position_derivatives(pool, arm, motion, &motions, &mut derivative);
    derivative
}

/// Motion of a joint axis, in its joint frame.
struct AxisMotion {
    /// 2 z'.
    twice_rate: Vector,
    /// z''.
    second_rate: Vector,
    /// z'' - 2 Ω × z'.
    row: Vector,
    /// z × a.
    z_cross_a: Vector,
}

impl AxisMotion {
    fn new(pool: &mut Pool, omega: &Vector, motion: &LinkMotion) -> AxisMotion {
        let two = pool.integer(2);
        let twice_rate = [pool.mul(two, omega[1]), -pool.mul(two, omega[0]), ExprId::ZERO];
        let second_rate = motion.field.map(|row| row[2]);
        let turning = pool.cross(omega, &twice_rate);
        let row = pool.sub_vectors(&second_rate, &turning);
        let a = motion.acceleration;
        AxisMotion { twice_rate, second_rate, row, z_cross_a: [-a[1], a[0], ExprId::ZERO] }
    }
}

/// F and N.
#[allow(clippy::too_many_arguments)]
fn changed_wrench(
    pool: &mut Pool,
    arm: &Arm,
    j: usize,
    axis: &AxisMotion,
    omega: &Vector,
    load: &(Vector, Vector),
    body: &Body,
    moments: &VelocityMoments,
) -> (Vector, Vector) {
    let (h, second) = (body.first, symmetric(&body.second));
    let AxisMotion { twice_rate, second_rate, z_cross_a, .. } = axis;
    let about_z = |v: &Vector| [-v[1], v[0], ExprId::ZERO];
    if !arm.joints[j].is_revolute() {
        let lever = pool.cross(&h, second_rate);
        return (pool.scale(body.mass, second_rate), pool.add_vectors(&about_z(&load.0), &lever));
    }
    let mut force = about_z(&load.0);
    let weighted = pool.scale(body.mass, z_cross_a);
    force = pool.sub_vectors(&force, &weighted);
    let along_rate = pool.dot3(twice_rate, &h);
    for part in [pool.cross(second_rate, &h), pool.scale(along_rate, omega), pool.cross(twice_rate, &moments.first)] {
        force = pool.add_vectors(&force, &part);
    }
    let mut moment = about_z(&load.1);
    let lever = pool.cross(&h, z_cross_a);
    moment = pool.sub_vectors(&moment, &lever);
    let half = pool.fraction(1, 2);
    let rotors = pool.scale(half, &moments.rotors);
    let turned = pool.transform(&second, twice_rate);
    for part in [
        less_trace(pool, &second, second_rate),
        pool.cross(&turned, omega),
        less_trace(pool, &moments.second, twice_rate),
        pool.cross(twice_rate, &rotors),
    ] {
        moment = pool.add_vectors(&moment, &part);
    }
    (force, moment)
}

/// (tr M - M) v.
fn less_trace(pool: &mut Pool, m: &crate::ring::matrix::Matrix, v: &Vector) -> Vector {
    let mut less = m.map(|row| row.map(|x| -x));
    for (k, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
        less[k][k] = pool.add(m[i][i], m[j][j]);
    }
    pool.transform(&less, v)
}

/// ∂tau_i/∂q_j, with the wrench (f_i, n_i) of the column of joint i and its E_i + n_i × Ω in the frame of joint j, where axis j moves so.
fn torque_derivative(
    pool: &mut Pool,
    revolute: bool,
    axis: &AxisMotion,
    (force, moment, rate): (Vector, Vector, Vector),
) -> ExprId {
    if !revolute {
        return pool.dot3(&axis.second_rate, &force);
    }
    let parts = [pool.dot3(&axis.row, &moment), pool.dot3(&axis.twice_rate, &rate), -pool.dot3(&axis.z_cross_a, &force)];
    pool.sum(parts)
}
