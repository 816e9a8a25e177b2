//! The documentation of emitted functions: formula, arguments, result, frames, units and signs, cost. Written for readers who never saw the
//! generator.

use crate::equations::{Argument, Quantity};
use crate::exact::Number;
use crate::program::{Cost, Function, Operand};

/// What a function is, the formula, and the result with its frame, unit and sign.
struct Text {
    title: &'static str,
    formula: &'static str,
    result: &'static str,
}

fn text(quantity: Quantity) -> Text {
    let (title, formula, result) = match quantity {
        Quantity::DirectKinematics => (
            "End-effector frame in the base frame, T_e(q).",
            "T_e = A_1(q_1) ... A_n(q_n) T_tool                                (Siciliano et al., Sect. 2.8)",
            "the 4 x 4 homogeneous transformation `t[row][column]`: the columns of the rotation are the axes of the end-effector frame in the base \
             frame, the last column is its origin in m.",
        ),
        Quantity::LinkFrames => (
            "Frame of every link in the base frame, T_i(q).",
            "T_i = A_1(q_1) ... A_i(q_i)                                       (Siciliano et al., Sect. 2.8)",
            "a 4 x 4 homogeneous transformation for each link, `t[link][row][column]`, the frames as the description's convention defines them; \
             translations in m.",
        ),
        Quantity::GeometricJacobian => (
            "Geometric Jacobian J(q) of the end effector, in the base frame.",
            "(v_e, omega_e) = J(q) dq                                          (Siciliano et al., Sect. 3.1)",
            "`j[row][joint]`, 6 rows: three linear (velocity of the end-effector frame's origin, m/s), then three angular (rad/s).",
        ),
        Quantity::GeometricJacobianDot => (
            "Time derivative of the geometric Jacobian along dq.",
            "d/dt (v_e, omega_e) = J ddq + (dJ/dt) dq",
            "`j[row][joint]`, 6 rows: three linear, then three angular, in the base frame.",
        ),
        Quantity::InertiaMatrix => (
            "Inertia matrix B(q) of links and rotors.",
            "B(q) = sum_i (m_i J_Pi' J_Pi + J_Oi' R_i I_i R_i' J_Oi) + rotors  (Siciliano et al., eq. 7.32)",
            "`b[row][column]`, symmetric and positive definite, all entries filled; kg m² between revolute joints, kg m between a revolute and a \
             prismatic one, kg between prismatic ones. J_Pi and J_Oi are the Jacobians of the centre of mass of link i, I_i is about it.",
        ),
        Quantity::CoriolisMatrix => (
            "Coriolis and centrifugal matrix C(q, dq) by Christoffel symbols of the first kind: dB/dt - 2C is skew-symmetric.",
            "C_ij = sum_k 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i) dq_k       (Siciliano et al., eq. 7.45)",
            "`c[row][column]`, on the left of the equation of motion: C dq is part of the torque.",
        ),
        Quantity::Gravity => (
            "Gravity term g(q) on the left of the equation of motion: the torque that holds the arm at rest.",
            "g(q) = dU/dq                                                      (Siciliano et al., eq. 7.39)",
            "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
        ),
        Quantity::Friction => (
            "Friction torque F(dq) on the left of the equation of motion: it has the sign of dq.",
            "F_i = (k_r² F_m + F_v) dq_i + F_c sign(dq_i), sign(0) = 0          (Siciliano et al., eq. 7.42)",
            "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
        ),
        Quantity::EquationsOfMotion => (
            "B(q), C(q, dq) and g(q) at one state, sharing their work.",
            "B(q) ddq + C(q, dq) dq + F(dq) + g(q) = tau                        (Siciliano et al., eq. 7.42)",
            "the three terms as the functions of their own return them.",
        ),
        Quantity::InverseDynamics => (
            "Torques that a motion needs, friction included.",
            "tau = B(q) ddq + C(q, dq) dq + F(dq) + g(q)                        (Siciliano et al., eq. 7.42)",
            "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
        ),
        Quantity::ForwardDynamics => (
            "Accelerations that torques cause, friction included.",
            "ddq = B(q)^-1 (tau - C(q, dq) dq - F(dq) - g(q))                    (Siciliano et al., Sect. 7.6)",
            "an acceleration for each joint, rad/s² (revolute) or m/s² (prismatic).",
        ),
        Quantity::Regressor => (
            "Regressor Y(q, dq, dqr, ddqr): the dynamics as a linear function of the parameters.",
            "B(q) ddqr + C(q, dq) dqr + F + g(q) = Y pi + tau_known             (Siciliano et al., Sects. 7.2.2 and 8.5.4)",
            "`y[joint][parameter]`, parameters in the order of `PARAMETER_NAMES`. In F viscous friction acts on dqr, Coulomb friction on sign(dq). \
             With dqr = dq and ddqr = ddq this is the regressor of inverse dynamics.",
        ),
        Quantity::KnownTorque => (
            "The torque of what is not among the parameters: tau_known of the regressor's equation.",
            "tau_known = B(q) ddqr + C(q, dq) dqr + F + g(q) - Y pi",
            "a torque, N m (revolute), or a force, N (prismatic), for each joint.",
        ),
        Quantity::KineticEnergy => (
            "Kinetic energy of links and rotors.",
            "T = 1/2 dq' B(q) dq                                               (Siciliano et al., eq. 7.31)",
            "an energy, J.",
        ),
        Quantity::PotentialEnergy => (
            "Potential energy of gravity; zero where all masses, rotors included, lie at the origin of the base frame.",
            "U(q) = - sum_i m_i g0' p_li                                       (Siciliano et al., eq. 7.36)",
            "an energy, J.",
        ),
        Quantity::Momentum => (
            "Generalised momentum B(q) dq, for a momentum observer.",
            "p = B(q) dq = dT/d(dq)                                            (De Luca and Mattone 2003)",
            "a momentum, N m s (revolute) or N s (prismatic), for each joint.",
        ),
        Quantity::CoriolisTransposeTimes => (
            "C(q, dq)' dq with C by Christoffel symbols, for a momentum observer.",
            "C' dq = dT/dq = (dB/dt) dq - C dq,  dp/dt = tau + C' dq - F - g    (De Luca and Mattone 2003)",
            "a torque, N m (revolute), or a force, N (prismatic), for each joint, on the right of the equation of dp/dt.",
        ),
        Quantity::BaseRegressor => (
            "Regressor Y_b(q, dq, ddq) of the base parameters: columns of full rank.",
            "B(q) ddq + C(q, dq) dq + F(dq) + g(q) = Y_b pi_b                  (Gautier and Khalil 1990)",
            "`y[joint][base parameter]`, parameters in the order of `BASE_PARAMETER_NAMES`: those of the links in their joint frames, inertias of rotors, \
             viscous and Coulomb friction, as far as the description gives them and they are not 0 at its values. Masses of rotors are part of the links \
             that carry them. With `NOMINAL_BASE_PARAMETERS` it is the torque of `inverse_dynamics`. For identification take `regressor` with \
             `regressor: base` in the description: it has all base parameters, zero or not.",
        ),
        Quantity::OperationalInertia => (
            "Inertia of the end effector along and about the rows of the task, in the base frame.",
            "B_A(q) = (J B(q)^-1 J')^-1, J the rows `TASK` of the geometric Jacobian (Siciliano et al., Sect. 7.8)",
            "`b[row][column]` in the order of `TASK`, symmetric; kg, kg m, kg m². Positive definite where those rows of J are independent; at a singular \
             configuration it is infinite, and its entries are not finite or, by rounding, very large.",
        ),
        Quantity::InverseDynamicsDerivatives => (
            "Derivatives of the torques of `inverse_dynamics` by joint variables and by rates.",
            "(dtau/dq, dtau/d(dq)) at (q, dq, ddq);  dtau/d(ddq) = B(q)         (Singh, Russell and Wensing 2022)",
            "two matrices `m[joint of tau][joint of q or dq]`; units of tau per rad or m, and per rad/s or m/s. Coulomb friction counts as constant: its \
             derivative is taken as 0, at rest too.",
        ),
        Quantity::ForwardDynamicsDerivatives => (
            "Derivatives of the accelerations of `forward_dynamics` by joint variables, by rates and by torques.",
            "(-B^-1 dtau/dq, -B^-1 dtau/d(dq), B^-1) at ddq = forward_dynamics(q, dq, tau)  (Carpentier and Mansard 2018)",
            "three matrices `m[joint of ddq][joint of q, dq or tau]`; units of ddq per rad or m, per rad/s or m/s, and per N m or N. The third is the \
             inverse of the inertia matrix. Coulomb friction counts as constant: its derivative is taken as 0, at rest too.",
        ),
    };
    Text { title, formula, result }
}

fn argument(argument: Argument) -> &'static str {
    match argument {
        Argument::Pi => "`pi`: the parameters in the order of `PARAMETER_NAMES`, SI units.",
        Argument::Q => "`q`: joint variables, rad (revolute) or m (prismatic).",
        Argument::Dq => "`dq`: joint rates, rad/s or m/s.",
        Argument::Ddq => "`ddq`: joint accelerations, rad/s² or m/s².",
        Argument::Dqr => "`dqr`: reference rates, rad/s or m/s.",
        Argument::Ddqr => "`ddqr`: reference accelerations, rad/s² or m/s².",
        Argument::Tau => "`tau`: joint torques (forces) on the joint side of the gears, N m or N.",
    }
}

/// The documentation of a function, line by line; `gravity` is the acceleration of free fall.
pub(super) fn function(function: &Function, gravity: &[Number; 3]) -> Vec<String> {
    let Text { title, formula, result } = text(function.quantity);
    let mut lines = vec![format!(" {title}")];
    if matches!(function.quantity, Quantity::Gravity | Quantity::PotentialEnergy) {
        let [x, y, z] = gravity.each_ref().map(Number::to_f64);
        lines.extend([String::new(), format!(" The acceleration of free fall is g0 = ({x}, {y}, {z}) m/s² in the base frame.")]);
    }
    if function.with_parameters {
        lines.extend([
            String::new(),
            " The parameters are given at run time; what is not among them is as in the description.".into(),
        ]);
    }
    // At any parameters the equations hold; what a body cannot have may cost B its inverse.
    let (result, failure) = match (function.with_parameters, function.quantity) {
        (true, Quantity::InertiaMatrix) => (
            result.replace("symmetric and positive definite", "symmetric, positive definite where `pi` is physically possible"),
            "cannot fail",
        ),
        (true, Quantity::ForwardDynamics) => (result.to_owned(), "not finite where B is singular"),
        (_, Quantity::OperationalInertia) => (result.to_owned(), "not finite where J is singular"),
        _ => (result.to_owned(), "cannot fail"),
    };
    let blank = || String::new();
    lines.extend([blank(), " ```text".into(), format!(" {formula}"), " ```".into(), blank()]);
    lines.extend(function.arguments.iter().map(|&a| format!(" - {}", argument(a))));
    lines.push(format!(" - Returns {result}"));
    if let Some(joint) = turned_joint(function) {
        lines.extend([
            blank(),
            format!(" Inside, the last link has axes whose x axis points to its centre of mass, seen along the joint axis: q{joint} and a constant angle."),
        ]);
    }
    lines.extend([
        blank(),
        format!(" Cost: {}. Derived by {}. Allocates nothing, {failure}.", cost(&Cost::of(function)), function.method),
    ]);
    lines
}

/// The joint whose variable a function turns by a constant angle, counted from 1.
fn turned_joint(function: &Function) -> Option<u16> {
    let operands = function.steps.iter().flat_map(|step| [&step.left, &step.right]);
    let angles = operands.filter_map(|operand| match operand {
        Operand::Input(symbol) => symbol.angle(),
        _ => None,
    });
    let turned = angles.filter(|angle| angle.turned).filter_map(|angle| angle.terms().last());
    turned.map(|(joint, _)| joint + 1).next()
}

/// Operations in words.
pub(super) fn cost(cost: &Cost) -> String {
    let count = |n: usize, one: &str, many: &str| match n {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{n} {many}")),
    };
    let parts: Vec<String> = [
        count(cost.mul, "multiplication", "multiplications"),
        count(cost.add, "addition", "additions"),
        count(cost.div, "division", "divisions"),
        count(cost.sincos, "sine and cosine pair", "sine and cosine pairs"),
    ]
    .into_iter()
    .flatten()
    .collect();
    if parts.is_empty() {
        "none, the result is constant".into()
    } else {
        parts.join(", ")
    }
}
