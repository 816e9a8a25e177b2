//! B, C, g and the energies by Lagrange's method: sums over the bodies, with derivatives by dual numbers.

use armgen_description::parallel::parallel_map;

use super::arm::{Arm, Joint};
use super::pose::Pose;
use super::state::State;
use super::vector::{self, apply, dot, product, scale, solve, transpose, Vector};
use crate::values::arithmetic::dual::Dual;
use crate::values::element::Element;

/// The terms of the equations of motion: B and C row by row, g, F and U.
pub struct Parts<E> {
    /// B(q).
    pub b: Vec<Vec<E>>,
    /// C(q, dq).
    pub c: Vec<Vec<E>>,
    /// g(q).
    pub g: Vec<E>,
    /// F(dq).
    pub f: Vec<E>,
    /// U(q).
    pub u: E,
}

/// A body in its pose: mass, centre of mass, link, and inertia about the centre of mass in the base frame.
struct Placed<E> {
    mass: E,
    com: Vector<E>,
    link: Option<usize>,
    inertia: Option<[[E; 3]; 3]>,
}

/// Links, load, and rotor masses.
fn bodies<E: Element>(arm: &Arm<E>, pose: &Pose<E>) -> Vec<Placed<E>> {
    let mut bodies = Vec::new();
    let loads = arm.tips.iter().zip(&pose.tools).filter_map(|(tip, tool)| Some((tip.link, tool, tip.payload.as_ref()?)));
    let links = arm.joints.iter().enumerate().map(|(i, joint)| (i, &pose.links[i], &joint.link));
    for (link, frame, body) in links.chain(loads) {
        let inertia = product(&product(&frame.rotation, &body.inertia), &transpose(&frame.rotation));
        bodies.push(Placed { mass: body.mass.clone(), com: frame.point(&body.com), link: Some(link), inertia: Some(inertia) });
    }
    for joint in &arm.joints {
        if let Some(motor) = &joint.motor {
            let com = motor.carrier.map_or_else(|| motor.position.clone(), |p| pose.links[p].point(&motor.position));
            bodies.push(Placed { mass: motor.mass.clone(), com, link: motor.carrier, inertia: None });
        }
    }
    bodies
}

/// B(q), row by row (the book, eq. 7.32). A rotor rotates with the link that carries it, and about its own axis with its motor's rate.
pub fn inertia_matrix<E: Element>(arm: &Arm<E>, state: &State<E>) -> Vec<Vec<E>> {
    inertia_by(arm, state, &E::times)
}

/// The sum in B(q), with `times` applied to each pair of speeds: their product, or its derivative.
fn inertia_by<E: Element, R: Element>(arm: &Arm<E>, state: &State<E>, times: &dyn Fn(&E, &E) -> R) -> Vec<Vec<R>> {
    let pose = Pose::new(arm, state);
    let n = arm.dof();
    let dot = |a: &Vector<E>, b: &Vector<E>| times(&a[0], &b[0]).plus(&times(&a[1], &b[1])).plus(&times(&a[2], &b[2]));
    let mut b = vec![vec![times(&arm.zero, &arm.zero); n]; n];
    let mut accumulate = |columns: &[usize], entry: &dyn Fn(usize, usize) -> R| {
        for &i in columns {
            for &j in columns.iter().filter(|&&j| j >= i) {
                b[i][j] = b[i][j].plus(&entry(i, j));
            }
        }
    };
    for body in bodies(arm, &pose) {
        let Some(link) = body.link else { continue };
        let jacobian = pose.jacobian(Some(link), &body.com);
        let columns = &pose.moving[link];
        if !body.mass.is_zero() {
            let weighted: Vec<Vector<E>> = jacobian.iter().map(|(v, _)| scale(&body.mass, v)).collect();
            accumulate(columns, &|i, j| dot(&weighted[i], &jacobian[j].0));
        }
        if let Some(inertia) = &body.inertia {
            let turned: Vec<Vector<E>> = jacobian.iter().map(|(_, w)| apply(inertia, w)).collect();
            accumulate(columns, &|i, j| dot(&turned[i], &jacobian[j].1));
        }
    }
    for (i, joint) in arm.joints.iter().enumerate() {
        let own = arm.row(i);
        let columns: Vec<usize> = own.iter().map(|(a, _)| *a).collect();
        let mut rate = vec![arm.zero.clone(); n];
        own.iter().for_each(|(a, factor)| rate[*a].clone_from(factor));
        accumulate(&columns, &|i, j| times(&joint.armature.times(&rate[i]), &rate[j]));
        let Some(motor) = &joint.motor else { continue };
        let mut rotor_speed = vec![arm.zero.clone(); n];
        let mut columns: Vec<usize> = Vec::new();
        if let Some(carrier) = motor.carrier {
            let axis = pose.links[carrier].direction(&motor.axis);
            for (j, (_, w)) in pose.jacobian(Some(carrier), &pose.links[carrier].origin).iter().enumerate() {
                rotor_speed[j] = vector::dot(&axis, w);
            }
            columns.extend(&pose.moving[carrier]);
        }
        for (joint, ratio) in &motor.rates {
            for (a, factor) in arm.row(*joint) {
                rotor_speed[a] = rotor_speed[a].plus(&ratio.times(&factor));
                columns.push(a);
            }
        }
        columns.sort_unstable();
        columns.dedup();
        accumulate(&columns, &|i, j| times(&motor.inertia.times(&rotor_speed[i]), &rotor_speed[j]));
    }
    for i in 0..n {
        for j in 0..i {
            b[i][j] = b[j][i].clone();
        }
    }
    b
}

/// ∂B/∂q_k for each k.
pub fn inertia_derivatives<E: Element>(arm: &Arm<E>, state: &State<E>) -> Vec<Vec<Vec<E>>> {
    let still = vec![arm.zero.clone(); arm.dof()];
    let moving = arm.map(&|e| Dual::constant(e));
    along_joints(arm, &|along| inertia_by(&moving, &state.moving(along, &still), &Dual::rate_of_product))
}

/// From this number of joints on, derivatives run in parallel; for fewer, threads cost more than they save.
const LONG: usize = 16;

/// The values of `derivative` along the unit vector of each joint.
pub fn along_joints<E: Element, R: Send + Sync>(arm: &Arm<E>, derivative: &(dyn Fn(&[E]) -> R + Sync)) -> Vec<R> {
    let unit = |k: usize| {
        let mut along = vec![arm.zero.clone(); arm.dof()];
        along[k] = arm.one.clone();
        along
    };
    let units: Vec<Vec<E>> = (0..arm.dof()).map(unit).collect();
    if arm.dof() < LONG {
        units.iter().map(|along| derivative(along)).collect()
    } else {
        parallel_map(&units, |along| derivative(along))
    }
}

/// C(q, dq), row by row: C_ij = Σ_k ½ (∂B_ij/∂q_k + ∂B_ik/∂q_j - ∂B_jk/∂q_i) dq_k.
pub fn coriolis_matrix<E: Element>(derivatives: &[Vec<Vec<E>>], dq: &[E], half: &E) -> Vec<Vec<E>> {
    let n = dq.len();
    let entry = |i: usize, j: usize| {
        let mut sum = half.minus(half);
        for k in 0..n {
            let symbol = derivatives[k][i][j].plus(&derivatives[j][i][k]).minus(&derivatives[i][j][k]);
            sum = sum.plus(&symbol.times(&dq[k]));
        }
        sum.times(half)
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// U(q) = -Σ m g0'p + Σ ½ k (q - rest)², including rotors on the base.
pub fn potential_energy<E: Element>(arm: &Arm<E>, state: &State<E>) -> E {
    let pose = Pose::new(arm, state);
    let of_masses =
        bodies(arm, &pose).iter().fold(arm.zero.clone(), |sum, body| sum.minus(&body.mass.times(&dot(&arm.gravity, &body.com))));
    of_masses.plus(&spring_energy(arm, state, |_, joint| joint.stiffness.clone()))
}

/// Σ ½ k (q - rest)² of the springs, for a given stiffness.
pub fn spring_energy<E: Element>(arm: &Arm<E>, state: &State<E>, stiffness: impl Fn(usize, &Joint<E>) -> E) -> E {
    let q = arm.joint_variables(&state.q);
    let twice = arm.joints.iter().enumerate().fold(arm.zero.clone(), |sum, (i, joint)| {
        let away = q[i].minus(&joint.rest);
        sum.plus(&stiffness(i, joint).times(&away).times(&away))
    });
    twice.times(&arm.half())
}

/// The torques of springs, k (q - rest).
pub fn spring_torques<E: Element>(arm: &Arm<E>, q: &[E]) -> Vec<E> {
    let torques = arm.joints.iter().zip(arm.joint_variables(q)).map(|(joint, q)| joint.stiffness.times(&q.minus(&joint.rest)));
    arm.of_coordinates(torques.collect())
}

/// g(q) = ∂U/∂q.
pub fn gravity<E: Element>(arm: &Arm<E>, state: &State<E>) -> Vec<E> {
    let still = vec![arm.zero.clone(); arm.dof()];
    let moving = arm.map(&|e| Dual::constant(e));
    along_joints(arm, &|along| potential_energy(&moving, &state.moving(along, &still)).rate)
}

/// F_i = (F_v + F_3 dq_i²) rate_i + (F_c + F_s exp(-|dq_i| / v)) direction_i + F_0, and F_m times its rate at each rotor, with the drawn values of signs and exponentials. The
/// cubic term uses `rates` for one of its factors.
pub fn friction<E: Element>(arm: &Arm<E>, state: &State<E>, rates: &[E]) -> Vec<E> {
    let (state, rates) = (arm.state_of_joints(state), arm.of_joints(rates));
    let State { dq, directions, stribeck, .. } = &*state;
    let mut torques: Vec<E> = arm
        .joints
        .iter()
        .enumerate()
        .map(|(i, joint)| {
            let cubic = joint.cubic.times(&dq[i]).times(&dq[i]).times(&rates[i]);
            let dry = joint.coulomb.plus(&joint.stribeck.times(&stribeck[i]));
            joint.viscous.times(&rates[i]).plus(&dry.times(&directions[i])).plus(&joint.offset).plus(&cubic)
        })
        .collect();
    for motor in arm.joints.iter().filter_map(|joint| joint.motor.as_ref()) {
        motor.add_torque(&motor.viscous.times(&motor.spin(&arm.zero, &rates)), &mut torques);
    }
    arm.of_coordinates(torques)
}

/// Whether any joint has load-dependent friction.
pub fn has_load_friction<E: Element>(arm: &Arm<E>) -> bool {
    arm.joints.iter().any(|joint| !joint.load.is_zero())
}

/// F_l |g_i| sign_i with |g| = sign(g) g; `None` if no joint has it.
pub fn load_friction<E: Element>(arm: &Arm<E>, state: &State<E>, g: &[E]) -> Option<Vec<E>> {
    let of_joint = |(a, (sign, g)): (usize, (&E, &E))| arm.joints[arm.joint_of(a)].load.times(&g.sign().times(g)).times(sign);
    has_load_friction(arm).then(|| state.signs.iter().zip(g).enumerate().map(of_joint).collect())
}

/// M v.
pub fn times_vector<E: Element>(m: &[Vec<E>], v: &[E]) -> Vec<E> {
    m.iter()
        .map(|row| row.iter().zip(v).map(|(a, b)| a.times(b)).reduce(|a, b| a.plus(&b)).expect("at least one joint"))
        .collect()
}

/// The solution of B x = right, if B is regular.
pub fn accelerations<E: Element>(b: &[Vec<E>], right: &[E]) -> Option<Vec<E>> {
    let columns: Vec<Vec<E>> = right.iter().map(|r| vec![r.clone()]).collect();
    Some(solve(b, &columns)?.into_iter().map(|mut row| row.remove(0)).collect())
}
