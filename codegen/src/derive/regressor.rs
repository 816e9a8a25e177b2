//! The regressor Y(q, dq, dqr, ddqr) and the known rest: B ddqr + C(q, dq) dqr + F + g = Y pi + tau_known.
//!
//! For named parameters a column is ∂tau/∂name: tau is linear in the names, so the derivative is the column itself.
//! For the ten standard parameters of a link the columns are written down directly. In the link's frame, with joint j's twist (z, v) there
//! and the acceleration field a + U r,
//!
//! ```text
//! tau_j = ∫ (z × r + v)·(a + U r) dm = m v·a + h·(U'v + a × z) + z · n(I)
//! ```
//!
//! where n(I) is the moment of Euler's equation, linear in the six inertias (the book, Sect. 7.2.2).

use super::arm::Arm;
use super::newton_euler::{inverse_dynamics, link_motions, LinkMotion, Motion};
use super::parameters::{ParameterKind, ParameterVector, StandardParameter};
use crate::ring::matrix::{transpose, Matrix, Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// Y, for an arm whose parameter vector are symbols (named parameters) or for the standard parameters of any arm.
pub fn regressor(pool: &mut Pool, arm: &Arm, vector: &ParameterVector) -> Vec<Vec<ExprId>> {
    let motion = Motion::with_reference(pool, arm);
    match &vector.kind {
        ParameterKind::Names(names) => {
            let tau = inverse_dynamics(pool, arm, &motion);
            let columns: Vec<Vec<ExprId>> = (0..names.len() as u16).map(|k| derivative_by_parameter(pool, &tau, k)).collect();
            (0..arm.dof()).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
        }
        ParameterKind::Standard(columns) => standard_columns(pool, arm, &motion, columns),
        ParameterKind::Base(columns) => columns_in_joint_frames(pool, arm, &motion, columns),
    }
}

/// ∂/∂pi_k of each expression.
pub fn derivative_by_parameter(pool: &mut Pool, exprs: &[ExprId], k: u16) -> Vec<ExprId> {
    pool.differentiate(exprs, &mut |_, symbol| if symbol == Symbol::Parameter(k) { ExprId::ONE } else { ExprId::ZERO })
}

/// Columns of standard parameters, those of a link in its link frame.
pub fn standard_columns(pool: &mut Pool, arm: &Arm, motion: &Motion, columns: &[StandardParameter]) -> Vec<Vec<ExprId>> {
    let frames: Vec<(Matrix, Vector)> = arm.joints.iter().map(|joint| (joint.link_rotation, joint.link_origin)).collect();
    columns_in(pool, arm, motion, columns, &frames)
}

/// The same with the parameters of a link in its joint frame.
pub fn columns_in_joint_frames(pool: &mut Pool, arm: &Arm, motion: &Motion, columns: &[StandardParameter]) -> Vec<Vec<ExprId>> {
    let frames: Vec<(Matrix, Vector)> = arm.joints.iter().map(|joint| (joint.own_axes, ZERO)).collect();
    columns_in(pool, arm, motion, columns, &frames)
}

fn columns_in(
    pool: &mut Pool,
    arm: &Arm,
    motion: &Motion,
    columns: &[StandardParameter],
    frames: &[(Matrix, Vector)],
) -> Vec<Vec<ExprId>> {
    let motions = link_motions(pool, arm, motion, true);
    let mut y = vec![vec![ExprId::ZERO; columns.len()]; arm.dof()];
    let mut links: Vec<Option<LinkColumns>> = vec![None; arm.dof()];
    let mut payload: Option<LinkColumns> = None;
    for (column, &parameter) in columns.iter().enumerate() {
        match parameter {
            StandardParameter::Link(i, k) => {
                let i = usize::from(i);
                let (rotation, origin) = &frames[i];
                let of = links[i].get_or_insert_with(|| link_columns(pool, arm, &motions, i, rotation, origin));
                of.iter().for_each(|(row, entries)| y[*row][column] = entries[usize::from(k)]);
            }
            StandardParameter::Payload(k) => {
                let of = payload
                    .get_or_insert_with(|| link_columns(pool, arm, &motions, arm.tip, &arm.tool_rotation, &arm.tool_origin));
                of.iter().for_each(|(row, entries)| y[*row][column] = entries[usize::from(k)]);
            }
            StandardParameter::RotorInertia(i) => {
                rotor_column(pool, arm, &motions, motion, usize::from(i))
                    .iter()
                    .enumerate()
                    .for_each(|(row, &e)| y[row][column] = e);
            }
            StandardParameter::RotorViscous(i) => {
                let i = usize::from(i);
                let ratio = arm.joints[i].rotor.expect("its friction is the rotor's").ratio;
                let square = pool.mul(ratio, ratio);
                y[i][column] = pool.mul(square, motion.reference[i]);
            }
            StandardParameter::Viscous(i) => y[usize::from(i)][column] = motion.reference[usize::from(i)],
            StandardParameter::Coulomb(i) => y[usize::from(i)][column] = pool.symbol(Symbol::RateSign(i)),
        }
    }
    y
}

/// For each joint that feels a link: the ten entries.
type LinkColumns = Vec<(usize, [ExprId; 10])>;

/// The columns of a body in a frame fixed in joint frame `i`.
fn link_columns(pool: &mut Pool, arm: &Arm, motions: &[LinkMotion], i: usize, rotation: &Matrix, origin: &Vector) -> LinkColumns {
    let m = &motions[i];
    let carried = pool.transform(&m.field, origin);
    let at_origin = pool.add_vectors(&m.acceleration, &carried);
    let a = pool.transform_back(rotation, &at_origin);
    let turned = pool.product(&m.field, rotation);
    let u = pool.product(&transpose(rotation), &turned);
    let moments = inertia_moments(pool, &u);
    // Twists of the joints from i down to the base, in the frame: z and the velocity v of its origin.
    let mut columns = Vec::new();
    let mut joint = Some(i);
    let mut path = Vec::new();
    while let Some(j) = joint {
        let mut z: Vector = ZERO;
        let mut v: Vector = ZERO;
        if arm.joints[j].is_revolute() {
            z[2] = ExprId::ONE;
        } else {
            v[2] = ExprId::ONE;
        }
        for &k in path.iter().rev() {
            let link: &super::arm::Joint = &arm.joints[k];
            let swept = pool.cross(&z, &link.origin);
            let at = pool.add_vectors(&v, &swept);
            (z, v) = (link.inward(pool, &z), link.inward(pool, &at));
        }
        let swept = pool.cross(&z, origin);
        let at = pool.add_vectors(&v, &swept);
        let (z, v) = (pool.transform_back(rotation, &z), pool.transform_back(rotation, &at));
        columns.push((j, entries(pool, &z, &v, &a, &u, &moments)));
        path.push(j);
        joint = arm.joints[j].parent;
    }
    columns
}

fn entries(pool: &mut Pool, z: &Vector, v: &Vector, a: &Vector, u: &Matrix, moments: &[Vector; 6]) -> [ExprId; 10] {
    let mass = pool.dot3(v, a);
    let (turned, lever) = (pool.transform_back(u, v), pool.cross(a, z));
    let first = pool.add_vectors(&turned, &lever);
    let inertia = moments.map(|moment| pool.dot3(z, &moment));
    let mut all = [ExprId::ZERO; 10];
    all[0] = mass;
    all[1..4].copy_from_slice(&first);
    all[4..].copy_from_slice(&inertia);
    all
}

/// The moment of each of Ixx Ixy Iyy Ixz Iyz Izz = 1: n = vee(U S - (U S)') with S = ½ tr(I) 1 - I.
///
/// U holds all that this needs, polarised where it has to be: (u_zy - u_yz)/2 = domega_x, (u_xy + u_yx)/2 = omega_x omega_y and
/// u_xx - u_yy = omega_x² - omega_y², and so on in turn.
fn inertia_moments(pool: &mut Pool, u: &Matrix) -> [Vector; 6] {
    let half = pool.fraction(1, 2);
    let dw = [(2, 1), (0, 2), (1, 0)].map(|(i, j)| {
        let difference = pool.sub(u[i][j], u[j][i]);
        pool.mul(half, difference)
    });
    let mut product = |i: usize, j: usize| {
        let sum = pool.add(u[i][j], u[j][i]);
        pool.mul(half, sum)
    };
    let (wxwy, wxwz, wywz) = (product(0, 1), product(0, 2), product(1, 2));
    let zero = ExprId::ZERO;
    [
        [dw[0], wxwz, -wxwy],
        [pool.sub(dw[1], wxwz), pool.add(dw[0], wywz), pool.sub(u[0][0], u[1][1])],
        [-wywz, dw[1], wxwy],
        [pool.add(dw[2], wxwy), pool.sub(u[2][2], u[0][0]), pool.sub(dw[0], wywz)],
        [pool.sub(u[1][1], u[2][2]), pool.sub(dw[2], wxwy), pool.add(dw[1], wxwz)],
        [wywz, -wxwz, dw[2]],
    ]
    .map(|v| if v == [zero; 3] { ZERO } else { v })
}

/// The column of a rotor's inertia: its whole angular momentum, that of the parent link's turning included.
fn rotor_column(pool: &mut Pool, arm: &Arm, motions: &[LinkMotion], motion: &Motion, i: usize) -> Vec<ExprId> {
    let mut column = vec![ExprId::ZERO; arm.dof()];
    let rotor = arm.joints[i].rotor.expect("its inertia is the rotor's");
    let own = pool.mul(rotor.ratio, motion.accelerations[i]);
    let Some(parent) = arm.joints[i].parent else {
        column[i] = pool.mul(rotor.ratio, own);
        return column;
    };
    let m = &motions[parent];
    // Spin s = z·omega + k dq; moment on the parent: z (z·domega + k ddq) + omega × z s, polarised.
    let of_link = pool.dot3(&rotor.axis, &m.domega);
    let change = pool.add(own, of_link);
    column[i] = pool.mul(rotor.ratio, change);
    let spin = |pool: &mut Pool, omega: &Vector, rate: ExprId| {
        let (along, own) = (pool.dot3(&rotor.axis, omega), pool.mul(rotor.ratio, rate));
        pool.add(along, own)
    };
    let (s, s_r) = (spin(pool, &m.omega, motion.rates[i]), spin(pool, &m.omega_r, motion.reference[i]));
    let (sweep, sweep_r) = (pool.cross(&m.omega, &rotor.axis), pool.cross(&m.omega_r, &rotor.axis));
    let half = pool.fraction(1, 2);
    let mut moment = [0, 1, 2].map(|k| {
        let (a, b) = (pool.mul(sweep[k], s_r), pool.mul(sweep_r[k], s));
        let gyroscopic = if a == b {
            a
        } else {
            let sum = pool.add(a, b);
            pool.mul(half, sum)
        };
        let spun = pool.mul(change, rotor.axis[k]);
        pool.add(spun, gyroscopic)
    });
    let mut link = parent;
    loop {
        if arm.joints[link].is_revolute() {
            column[link] = moment[2];
        }
        let Some(outer) = arm.joints[link].parent else { return column };
        moment = arm.joints[link].outward(pool, &moment);
        link = outer;
    }
}
