//! Columns of the regressor, for any choice of parameters.
//!
//! For named parameters a column is ∂tau/∂name: tau is linear in the names, so the derivative is the column itself.
//! For the ten standard parameters of a link the columns are written down directly. In the link's frame, with joint j's twist (z, v) there
//! and the acceleration field a + U r,
//!
//! ```text
//! tau_j = ∫ (z × r + v)·(a + U r) dm = v · f + z · n,   f = m a + U h,   n = h × a + n(I)
//! ```
//!
//! where n(I) is the moment of Euler's equation, linear in the six inertias (the book, Sect. 7.2.2). A parameter of 1 alone has a wrench (f, n)
//! with many zeros; z · n and v · f may be formed in the frame of any link between j and the body.

use std::collections::BTreeMap;

use super::arm::{Arm, CoupledRotor, Rotor};
use super::friction;
use super::motion::{link_motions, LinkMotion, Motion};
use super::newton_euler::{deflection, inverse_dynamics};
use super::parameters::{Inertial, ParameterKind, ParameterVector, StandardParameter};
use super::plan::{self, Place, Plan, Start};
use super::rotors;
use super::wrench::{axis_component, wrench_to_parent};
use crate::pass::Pass;
use crate::ring::matrix::{transpose, Matrix, Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// Where searches for the plan of a regressor start: plainly, where wrenches stay at their link and are felt by twists; with 5 = 2·2 + 1,
/// where they go two links towards the base and are felt by moments.
pub(crate) static STARTS: [Start; 2] = [Start::PLAIN, Start { wrench_frame: 5, ..Start::PLAIN }];

/// Y, for an arm whose parameters are symbols (named parameters) or for the standard parameters of any arm.
pub fn regressor(pool: &mut Pool, arm: &Arm, vector: &ParameterVector) -> Vec<Vec<ExprId>> {
    regressor_by_plan(pool, arm, vector, &mut Plan::default())
}

/// Y, in the ways that a plan takes.
pub fn regressor_by_plan(pool: &mut Pool, arm: &Arm, vector: &ParameterVector, plan: &mut Plan) -> Vec<Vec<ExprId>> {
    let motion = Motion::with_reference(pool, arm);
    match &vector.kind {
        ParameterKind::Names(names) => {
            let tau = inverse_dynamics(pool, arm, &motion);
            let columns: Vec<Vec<ExprId>> = (0..names.len() as u16).map(|k| derivative_by_parameter(pool, &tau, k)).collect();
            (0..arm.dof()).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
        }
        ParameterKind::Standard(columns) => standard_columns(pool, arm, &motion, columns, plan),
        ParameterKind::Base(columns) => columns_in_joint_frames(pool, arm, &motion, columns, plan),
    }
}

/// ∂/∂pi_k of each expression.
pub fn derivative_by_parameter(pool: &mut Pool, exprs: &[ExprId], k: u16) -> Vec<ExprId> {
    pool.differentiate(exprs, &mut |_, symbol| if symbol == Symbol::Parameter(k) { ExprId::ONE } else { ExprId::ZERO })
}

/// Columns of standard parameters, which refer to the frame of their link.
pub fn standard_columns(
    pool: &mut Pool,
    arm: &Arm,
    motion: &Motion,
    columns: &[StandardParameter],
    plan: &mut Plan,
) -> Vec<Vec<ExprId>> {
    let frames: Vec<(Matrix, Vector)> = arm.joints.iter().map(|joint| (joint.link_rotation, joint.link_origin)).collect();
    columns_in(pool, arm, motion, columns, &frames, plan)
}

/// The same with the parameters of a link in its joint frame.
pub fn columns_in_joint_frames(
    pool: &mut Pool,
    arm: &Arm,
    motion: &Motion,
    columns: &[StandardParameter],
    plan: &mut Plan,
) -> Vec<Vec<ExprId>> {
    let frames: Vec<(Matrix, Vector)> = arm.joints.iter().map(|joint| (joint.own_axes, joint.own_origin)).collect();
    columns_in(pool, arm, motion, columns, &frames, plan)
}

fn columns_in(
    pool: &mut Pool,
    arm: &Arm,
    motion: &Motion,
    columns: &[StandardParameter],
    frames: &[(Matrix, Vector)],
    plan: &mut Plan,
) -> Vec<Vec<ExprId>> {
    let mut twists = Twists { arm, axes: BTreeMap::new(), velocities: BTreeMap::new(), arms: BTreeMap::new() };
    let motions = link_motions(pool, arm, motion, true);
    let mut y = vec![vec![ExprId::ZERO; columns.len()]; arm.dof()];
    let mut links: Vec<Option<LinkColumns>> = vec![None; arm.dof()];
    let mut loads: Vec<Option<LinkColumns>> = vec![None; arm.loads.len()];
    for (column, &parameter) in columns.iter().enumerate() {
        match parameter {
            StandardParameter::Link(i, k) => {
                let i = usize::from(i);
                let (rotation, origin) = &frames[i];
                let of =
                    links[i].get_or_insert_with(|| link_columns(pool, plan, &mut twists, &motions, (i, i), (rotation, origin)));
                of.iter().for_each(|(row, entries)| y[*row][column] = entries[k.index()]);
            }
            StandardParameter::Payload(number, k) => {
                let number = usize::from(number);
                let load = &arm.loads[number];
                let (place, frame) = ((load.link, arm.dof() + number), (&load.rotation, &load.origin));
                let of = loads[number].get_or_insert_with(|| link_columns(pool, plan, &mut twists, &motions, place, frame));
                of.iter().for_each(|(row, entries)| y[*row][column] = entries[k.index()]);
            }
            StandardParameter::RotorInertia(i) => {
                rotor_column(pool, arm, &motions, motion, usize::from(i))
                    .iter()
                    .enumerate()
                    .for_each(|(row, &e)| y[row][column] = e);
            }
            StandardParameter::RotorViscous(i) => {
                let i = usize::from(i);
                match arm.joints[i].rotor {
                    Some(Rotor { ratio, .. }) => {
                        let square = pool.mul(ratio, ratio);
                        y[i][column] = pool.mul(square, motion.reference[i]);
                    }
                    None => rotors::friction_column(pool, &CoupledRotor::of(arm, i), &motion.reference)
                        .into_iter()
                        .for_each(|(row, entry)| y[row][column] = entry),
                }
            }
            StandardParameter::Armature(i) => y[usize::from(i)][column] = motion.accelerations[usize::from(i)],
            StandardParameter::Viscous(i)
            | StandardParameter::Coulomb(i)
            | StandardParameter::Stribeck(i)
            | StandardParameter::Offset(i)
            | StandardParameter::Cubic(i) => {
                let i = usize::from(i);
                y[i][column] = friction::column(pool, arm, i, parameter, motion.reference[i]).expect("a term of friction");
            }
            StandardParameter::Stiffness(i) => y[usize::from(i)][column] = deflection(pool, arm, usize::from(i)),
        }
    }
    y
}

/// For each joint that feels a link: the entries of the ten parameters, and of the two of a planar link.
type LinkColumns = Vec<(usize, [ExprId; Inertial::COUNT])>;

/// A wrench: force, and moment about an origin.
type Wrench = (Vector, Vector);

/// The twists of joints in the frames of the links that they move, computed at the first use.
struct Twists<'a> {
    arm: &'a Arm,
    /// z_j in frame i.
    axes: BTreeMap<(usize, usize), Vector>,
    /// Velocity of o_i as joint j turns by one, in frame i.
    velocities: BTreeMap<(usize, usize), Vector>,
    /// o_i - o_j in frame i.
    arms: BTreeMap<(usize, usize), Vector>,
}

impl Twists<'_> {
    fn axis(&mut self, pool: &mut Pool, j: usize, i: usize) -> Vector {
        if i == j {
            return [ExprId::ZERO, ExprId::ZERO, ExprId::ONE];
        }
        if let Some(&known) = self.axes.get(&(j, i)) {
            return known;
        }
        let outer = self.axis(pool, j, self.before(i));
        let found = self.arm.joints[i].from_parent(pool, &outer);
        self.axes.insert((j, i), found);
        found
    }

    fn velocity(&mut self, pool: &mut Pool, j: usize, i: usize) -> Vector {
        if !self.arm.joints[j].is_revolute() {
            return self.axis(pool, j, i);
        }
        if i == j {
            return ZERO;
        }
        if let Some(&known) = self.velocities.get(&(j, i)) {
            return known;
        }
        let p = self.before(i);
        let (z, v) = (self.axis(pool, j, p), self.velocity(pool, j, p));
        let swept = pool.cross(&z, &self.arm.joints[i].origin);
        let sum = pool.add_vectors(&v, &swept);
        let found = self.arm.joints[i].from_parent(pool, &sum);
        self.velocities.insert((j, i), found);
        found
    }

    fn arm(&mut self, pool: &mut Pool, j: usize, i: usize) -> Vector {
        if i == j {
            return ZERO;
        }
        if let Some(&known) = self.arms.get(&(j, i)) {
            return known;
        }
        let outer = self.arm(pool, j, self.before(i));
        let sum = pool.add_vectors(&outer, &self.arm.joints[i].origin);
        let found = self.arm.joints[i].from_parent(pool, &sum);
        self.arms.insert((j, i), found);
        found
    }

    fn before(&self, i: usize) -> usize {
        self.arm.joints[i].parent.expect("j is an ancestor of i")
    }

    /// What joint j feels of a wrench in frame i: z·n + v·f, or z·(n + (o_i - o_j) × f), where joints whose axes meet share the bracket.
    fn reciprocal_product(&mut self, pool: &mut Pool, j: usize, i: usize, wrench: &Wrench, by_moment: bool) -> ExprId {
        let (f, n) = wrench;
        let z = self.axis(pool, j, i);
        if !self.arm.joints[j].is_revolute() {
            return pool.dot3(&z, f);
        }
        if by_moment {
            let d = self.arm(pool, j, i);
            let lever = pool.cross(&d, f);
            let about = pool.add_vectors(n, &lever);
            return pool.dot3(&z, &about);
        }
        let v = self.velocity(pool, j, i);
        let (turned, pushed) = (pool.dot3(&z, n), pool.dot3(&v, f));
        pool.add(turned, pushed)
    }
}

/// The columns of a body in a frame fixed in joint frame `i`.
///
/// The wrench of each unit parameter goes from link to link towards the base, and each joint on the way feels it directly. Where
/// it stops, the joints further in feel it by their twists. The plan chooses the place and one of two forms, for forces and
/// couples apart.
fn link_columns(
    pool: &mut Pool,
    plan: &mut Plan,
    twists: &mut Twists<'_>,
    motions: &[LinkMotion],
    (i, place): (usize, usize),
    (rotation, origin): (&Matrix, &Vector),
) -> LinkColumns {
    let arm = twists.arm;
    let m = &motions[i];
    let carried = pool.transform(&m.field, origin);
    let at_origin = pool.add_vectors(&m.acceleration, &carried);
    let a = pool.transform_back(rotation, &at_origin);
    let turned = pool.product(&m.field, rotation);
    let u = pool.product(&transpose(rotation), &turned);
    let mut path = vec![i];
    while let Some(p) = arm.joints[*path.last().expect("not empty")].parent {
        path.push(p);
    }
    // Two forms (twist, moment) for each link of the path where a wrench may stop, and one form at the base, where no joint is
    // left.
    let ways = 2 * path.len() - 1;
    let forces =
        (plan.way(Pass::WrenchFrame, Place::Regressor(place, plan::UnitWrench::Force), ways) + plan.first_wrench_frame()) % ways;
    // Couples go as far as forces (way 0), so that one set of twists will do, or stop elsewhere.
    let couples = match plan.way(Pass::WrenchFrame, Place::Regressor(place, plan::UnitWrench::Couple), path.len()) {
        0 => (forces / 2).min(path.len().saturating_sub(2)),
        way => way - 1,
    };
    let mut columns: LinkColumns = path.iter().map(|&j| (j, [ExprId::ZERO; Inertial::COUNT])).collect();
    for (k, (force, moment)) in unit_wrenches(pool, &a, &u).into_iter().enumerate() {
        let (stop, by_moment) = if k < 4 { (forces / 2, forces % 2 == 1) } else { (couples, false) };
        // Into the joint frame.
        let force = pool.transform(rotation, &force);
        let turned = pool.transform(rotation, &moment);
        let lever = pool.cross(origin, &force);
        let mut wrench = (force, pool.add_vectors(&turned, &lever));
        for (step, &j) in path.iter().enumerate().take(stop + 1) {
            if step > 0 {
                wrench = wrench_to_parent(pool, arm, path[step - 1], &wrench.0, &wrench.1);
            }
            columns[step].1[k] = axis_component(arm, j, &wrench.0, &wrench.1);
        }
        for (step, &j) in path.iter().enumerate().skip(stop + 1) {
            columns[step].1[k] = twists.reciprocal_product(pool, j, path[stop], &wrench, by_moment);
        }
    }
    columns
}

/// The wrenches of m, mcx, mcy, mcz, Ixx, ... = 1 for a body whose origin accelerates by a and in which U is the field.
///
/// Those of a body without extent along z are e × U e, of a mass on the y axis (Ixx = Izz) and on the x axis (Iyy = Izz).
fn unit_wrenches(pool: &mut Pool, a: &Vector, u: &Matrix) -> [Wrench; Inertial::COUNT] {
    let mut all = [(ZERO, ZERO); Inertial::COUNT];
    all[0].0 = *a;
    for k in 0..3 {
        let mut unit = ZERO;
        unit[k] = ExprId::ONE;
        all[1 + k] = (u.map(|row| row[k]), pool.cross(&unit, a));
    }
    for (wrench, moment) in all[4..10].iter_mut().zip(inertia_moments(pool, u)) {
        wrench.1 = moment;
    }
    all[Inertial::PlanarIxx.index()].1 = [u[2][1], ExprId::ZERO, -u[0][1]];
    all[Inertial::PlanarIyy.index()].1 = [ExprId::ZERO, -u[2][0], u[1][0]];
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

/// The column of a rotor's inertia: its whole angular momentum, that of its carrier's turning included.
fn rotor_column(pool: &mut Pool, arm: &Arm, motions: &[LinkMotion], motion: &Motion, i: usize) -> Vec<ExprId> {
    let mut column = vec![ExprId::ZERO; arm.dof()];
    let rotor = CoupledRotor::of(arm, i);
    let own = rotor.spin(pool, &motion.accelerations);
    let Some(carrier) = rotor.carrier else {
        rotor.rates.iter().for_each(|&(joint, factor)| column[joint] = pool.mul(factor, own));
        return column;
    };
    let m = &motions[carrier];
    // Spin s = z·omega + k dq; moment on the carrier: z (z·domega + k ddq) + omega × z s, polarised.
    let of_link = pool.dot3(&rotor.axis, &m.domega);
    let change = pool.add(own, of_link);
    rotor.rates.iter().for_each(|&(joint, factor)| column[joint] = pool.mul(factor, change));
    let spin = |pool: &mut Pool, omega: &Vector, rates: &[ExprId]| {
        let (along, own) = (pool.dot3(&rotor.axis, omega), rotor.spin(pool, rates));
        pool.add(along, own)
    };
    let (s, s_r) = (spin(pool, &m.omega, &motion.rates), spin(pool, &m.omega_r, &motion.reference));
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
    let mut link = carrier;
    loop {
        if arm.joints[link].is_revolute() {
            column[link] = pool.add(column[link], moment[2]);
        }
        let Some(outer) = arm.joints[link].parent else { return column };
        moment = arm.joints[link].to_parent(pool, &moment);
        link = outer;
    }
}
