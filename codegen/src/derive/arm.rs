//! The arm as the derivations see it: joint frames, bodies, rotors, friction, all as expressions of one pool.
//!
//! All recursions run in joint frames, whose z axis is the joint axis, whatever convention the description uses. A vector then
//! turns by Rz(q) alone, and joint i either feels a parameter of a body or passes it to the link before.
//!
//! ```text
//! R_i = fixed_i · Rz(theta_i),   fixed_i = Rx(alpha) for Denavit-Hartenberg rows,   theta_i = q_i + offset
//! x_parent = R_i x_i + origin_i
//! ```
//!
//! A body is its mass m, first moment h = ∫ r dm and second moments S = ∫ r r' dm: with these, moving a body to another frame is
//! one congruence, and the inertia tensor is tr(S) 1 - S.

use super::coupling::Coupled;
use super::parameters::{second_moments, Inertial, StandardParameter, View};
use crate::exact::Number;
use crate::kinds::JointKind;
use crate::manipulator::{LinkId, Manipulator, Placement, Pose};
use crate::ring::field::Field;
use crate::ring::matrix::{transpose, Matrix, Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// A rigid body in a frame: mass, first moment, second moments xx xy yy xz yz zz.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// m, kg.
    pub mass: ExprId,
    /// ∫ r dm, kg m.
    pub first: Vector,
    /// ∫ r r' dm, kg m²: xx xy yy xz yz zz.
    pub second: [ExprId; 6],
}

/// A rotor on the parent link that spins with its joint alone: its coupling to the motion of the parent link.
#[derive(Clone, Copy, Debug)]
pub struct Rotor {
    /// I_m, kg m².
    pub inertia: ExprId,
    /// k_r.
    pub ratio: ExprId,
    /// Unit vector of the spin axis in the parent's joint frame (base frame without parent).
    pub axis: Vector,
}

/// A rotor that rides elsewhere than on the link before its joint, or spins with the rates of several joints.
#[derive(Clone, Debug)]
pub struct CoupledRotor {
    /// The joint that its motor is of.
    pub joint: usize,
    /// I, kg m².
    pub inertia: ExprId,
    /// Viscous friction at the rotor.
    pub viscous: ExprId,
    /// a: unit vector of the spin axis in the joint frame of its carrier (base frame without one).
    pub axis: Vector,
    /// The link that carries it; none for the base.
    pub carrier: Option<usize>,
    /// n: joints with factors, each joint once.
    pub rates: Vec<(usize, ExprId)>,
}

/// A joint and the link it moves.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Index of the link that carries it.
    pub parent: Option<usize>,
    /// The fixed part of the rotation.
    pub fixed: Matrix,
    /// sin(theta): of the joint angle with its offset; a constant for a prismatic joint.
    pub sine: ExprId,
    /// cos(theta).
    pub cosine: ExprId,
    /// Rate at which the joint frame turns about its z axis, seen from the parent's: dq, and 0 for a prismatic joint.
    pub frame_rate: ExprId,
    /// Rate at which the link turns about the z axis of the frame that it is described in, seen from that frame: 0 unless parallel axes
    /// share one orientation.
    pub link_rate: ExprId,
    /// The joint frame in the axes that the link is described in: turned only where parallel axes share one orientation.
    pub own_axes: Matrix,
    /// The origin of the joint frame before it slid along the axis.
    pub own_origin: Vector,
    /// Origin of the joint frame in the parent's joint frame.
    pub origin: Vector,
    /// Rotation of the user's link frame in the joint frame.
    pub link_rotation: Matrix,
    /// Origin of the user's link frame in the joint frame.
    pub link_origin: Vector,
    /// The link, in the joint frame, with the rotors that ride on it (their masses, and their inertia as far as it moves with the link).
    pub body: Body,
    /// The rotor that drives this joint, where it rides on the parent link and spins with this joint alone.
    pub rotor: Option<Rotor>,
    /// Inertia that the joint alone feels.
    pub armature: ExprId,
    /// Viscous friction seen at the joint: the joint's, and ratio² · that of `rotor`.
    pub viscous: ExprId,
    /// Coulomb friction.
    pub coulomb: ExprId,
    /// Friction whatever the rate.
    pub offset: ExprId,
    /// Coefficient of the cube of the rate.
    pub cubic: ExprId,
    /// How many times its gravity torque is added to its dry friction.
    pub load: ExprId,
    /// Stribeck friction at the lowest rates.
    pub stribeck: ExprId,
    /// The velocity of the elementary functions of its friction; 1 without any.
    pub friction_velocity: ExprId,
    /// Whether Coulomb friction has tanh(dq / v) in place of sign(dq).
    pub is_smooth: bool,
    /// Stiffness of its spring.
    pub stiffness: ExprId,
    /// The joint variable at which its spring is at rest.
    pub rest: ExprId,
}

/// The frame of an end effector.
#[derive(Clone, Copy, Debug)]
pub struct Tool {
    /// Index of the link that carries it.
    pub link: usize,
    /// Its rotation in the joint frame of that link.
    pub rotation: Matrix,
    /// Its origin there.
    pub origin: Vector,
}

/// The arm.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Joints, parents first.
    pub joints: Vec<Joint>,
    /// Acceleration of free fall in the base frame: numbers, or symbols where it is an argument.
    pub gravity: Vector,
    /// The other rotors.
    pub rotors: Vec<CoupledRotor>,
    /// The end effector.
    pub tool: Tool,
    /// The frames of payloads, those of the end effectors that have any.
    pub loads: Vec<Tool>,
    /// First moment, in the base frame, of the rotors that ride on the base: a constant of the potential energy.
    pub base_moment: Vector,
    /// The coupling of joints, where there is one.
    pub coupling: Option<Coupled>,
}

impl Body {
    /// A body without mass.
    pub const EMPTY: Body = Body { mass: ExprId::ZERO, first: ZERO, second: [ExprId::ZERO; 6] };

    /// The body in a parallel frame in which its own frame has the origin p: x_outer = x + p.
    pub fn moved(&self, pool: &mut Pool, origin: &Vector) -> Body {
        // S' = S + h p' + p h' + m p p', computed as S + (h + m p) p' + p h'.
        let weighted = pool.scale(self.mass, origin);
        let first = pool.add_vectors(&self.first, &weighted);
        let mut second = self.second;
        for (entry, (i, j)) in second.iter_mut().zip(PAIRS) {
            let (a, b) = (pool.mul(first[i], origin[j]), pool.mul(origin[i], self.first[j]));
            let sum = pool.add(a, b);
            *entry = pool.add(*entry, sum);
        }
        Body { mass: self.mass, first, second }
    }

    /// The sum of two bodies in one frame.
    pub fn plus(&self, pool: &mut Pool, other: &Body) -> Body {
        let mut second = self.second;
        for (a, b) in second.iter_mut().zip(other.second) {
            *a = pool.add(*a, b);
        }
        Body { mass: pool.add(self.mass, other.mass), first: pool.add_vectors(&self.first, &other.first), second }
    }

    /// Turned by a matrix of constants.
    pub(super) fn turned(&self, pool: &mut Pool, rotation: &Matrix) -> Body {
        Body { mass: self.mass, first: pool.transform(rotation, &self.first), second: turn_second(pool, rotation, &self.second) }
    }
}

/// Which second moment the regrouping of inertial parameters sets to zero in the body of a revolute joint, besides mass and first moment along
/// the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupingConvention {
    /// Szz = 0.
    NoSecondMomentAlongAxis,
    /// Iyy = 0.
    NoInertiaAboutY,
}

/// Index pairs of the six entries of a symmetric matrix, in the order xx xy yy xz yz zz.
pub const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];

/// A symmetric matrix from its six entries.
pub fn symmetric(s: &[ExprId; 6]) -> Matrix {
    [[s[0], s[1], s[3]], [s[1], s[2], s[4]], [s[3], s[4], s[5]]]
}

fn turn_second(pool: &mut Pool, rotation: &Matrix, second: &[ExprId; 6]) -> [ExprId; 6] {
    let half = pool.product(rotation, &symmetric(second));
    let full = pool.product(&half, &transpose(rotation));
    PAIRS.map(|(i, j)| full[i][j])
}

impl Joint {
    /// A vector of this joint frame in the parent's: R v.
    pub fn to_parent(&self, pool: &mut Pool, v: &Vector) -> Vector {
        let turned = self.about_axis(pool, v);
        pool.transform(&self.fixed, &turned)
    }

    /// A vector of the parent's joint frame in this one: R' v.
    pub fn from_parent(&self, pool: &mut Pool, v: &Vector) -> Vector {
        let turned = pool.transform_back(&self.fixed, v);
        self.about_axis_back(pool, &turned)
    }

    /// A vector of the parent's axes turned by `fixed`, in this joint frame: Rz' v.
    pub fn about_axis_back(&self, pool: &mut Pool, v: &Vector) -> Vector {
        let (s, c) = (self.sine, self.cosine);
        [pool.dot(&[c, s], &[v[0], v[1]]), pool.dot(&[c, -s], &[v[1], v[0]]), v[2]]
    }

    /// A vector of this joint frame in the parent's axes turned by `fixed`: Rz v.
    pub fn about_axis(&self, pool: &mut Pool, v: &Vector) -> Vector {
        let (s, c) = (self.sine, self.cosine);
        [pool.dot(&[c, -s], &[v[0], v[1]]), pool.dot(&[s, c], &[v[0], v[1]]), v[2]]
    }

    /// A tensor of this joint frame in the parent's axes turned by `fixed`: Rz M Rz'.
    ///
    /// With u = c (Mxx - Myy) - s (Mxy + Myx) it is Mxx' = Myy + c u, Myy' = Mxx - c u, Mxy' = Mxy + s u, Myx' = Myx + s u.
    pub fn tensor_about_axis(&self, pool: &mut Pool, m: &Matrix) -> Matrix {
        let (s, c) = (self.sine, self.cosine);
        let difference = pool.sub(m[0][0], m[1][1]);
        let sum = pool.add(m[0][1], m[1][0]);
        let u = pool.dot(&[c, -s], &[difference, sum]);
        let (cu, su) = (pool.mul(c, u), pool.mul(s, u));
        let mut turned = *m;
        turned[0][0] = pool.add(m[1][1], cu);
        turned[1][1] = pool.sub(m[0][0], cu);
        turned[0][1] = pool.add(m[0][1], su);
        turned[1][0] = pool.add(m[1][0], su);
        [turned[0][2], turned[1][2], _] = self.about_axis(pool, &[m[0][2], m[1][2], ExprId::ZERO]);
        [turned[2][0], turned[2][1], _] = self.about_axis(pool, &[m[2][0], m[2][1], ExprId::ZERO]);
        turned
    }

    /// A body of this joint frame in the parent's axes turned by `fixed`.
    pub fn body_about_axis(&self, pool: &mut Pool, body: &Body) -> Body {
        let second = self.tensor_about_axis(pool, &symmetric(&body.second));
        Body { mass: body.mass, first: self.about_axis(pool, &body.first), second: PAIRS.map(|(i, j)| second[i][j]) }
    }

    /// A body of this joint frame in the parent's.
    pub fn body_outward(&self, pool: &mut Pool, body: &Body) -> Body {
        let turned = self.body_about_axis(pool, body).turned(pool, &self.fixed);
        turned.moved(pool, &self.origin)
    }

    /// The rotation Rz(theta) about the joint axis.
    pub fn about_axis_matrix(&self) -> Matrix {
        let (s, c) = (self.sine, self.cosine);
        [[c, -s, ExprId::ZERO], [s, c, ExprId::ZERO], [ExprId::ZERO, ExprId::ZERO, ExprId::ONE]]
    }

    /// The joint's rotation matrix R.
    pub fn rotation(&self, pool: &mut Pool) -> Matrix {
        let about_z = self.about_axis_matrix();
        pool.product(&self.fixed, &about_z)
    }

    /// Whether the joint turns.
    pub fn is_revolute(&self) -> bool {
        self.kind == JointKind::Revolute
    }
}

impl Arm {
    /// The arm in a pool. `view` decides how parameters enter.
    pub fn new(pool: &mut Pool, manipulator: &Manipulator, view: View<'_>) -> Arm {
        let joints: Vec<Joint> = (0..manipulator.joints.len()).map(|i| joint(pool, manipulator, view, i)).collect();
        let gravity = if manipulator.gravity_is_argument {
            [0, 1, 2].map(|axis| pool.symbol(Symbol::Gravity(axis)))
        } else {
            manipulator.gravity.clone().map(|g| view.polynomial(pool, manipulator, &g))
        };
        let own = tool(pool, manipulator, view, &joints, manipulator.tip.index(), &manipulator.tool);
        let coupling = manipulator.coupling.as_ref().map(|coupling| Coupled::new(pool, coupling));
        let mut arm = Arm { joints, gravity, rotors: Vec::new(), tool: own, loads: Vec::new(), base_moment: ZERO, coupling };
        for (load, number) in manipulator.loads().into_iter().zip(0..) {
            let Tool { link, rotation, origin } = tool(pool, manipulator, view, &arm.joints, load.link, load.tool);
            arm.loads.push(Tool { link, rotation, origin });
            if !view.bodies_in_joint_frames() {
                let payload = inertial_body(pool, manipulator, view, |k| StandardParameter::Payload(number, k));
                let payload = payload.turned(pool, &rotation);
                let payload = payload.moved(pool, &origin);
                arm.joints[link].body = arm.joints[link].body.plus(pool, &payload);
            }
        }
        for i in 0..arm.joints.len() {
            add_rotor(pool, manipulator, view, &mut arm, i);
        }
        arm
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Whether each joint is on the link of the joint before it.
    pub fn is_chain(&self) -> bool {
        self.joints.iter().enumerate().all(|(i, joint)| joint.parent == i.checked_sub(1))
    }

    /// The frames of the end effector and of payloads that a link carries.
    pub(super) fn tools_of(&mut self, link: usize) -> impl Iterator<Item = &mut Tool> {
        std::iter::once(&mut self.tool).chain(&mut self.loads).filter(move |tool| tool.link == link)
    }

    /// The rotors beside those of joints that a link carries.
    pub(super) fn rotors_on(&mut self, link: usize) -> impl Iterator<Item = &mut CoupledRotor> {
        self.rotors.iter_mut().filter(move |rotor| rotor.carrier == Some(link))
    }

    /// The links from the base to a link.
    pub fn path_to(&self, link: usize) -> Vec<usize> {
        let mut path: Vec<usize> = std::iter::successors(Some(link), |&i| self.joints[i].parent).collect();
        path.reverse();
        path
    }

    /// Symbols of one kind, joint by joint.
    pub fn symbols(&self, pool: &mut Pool, symbol: impl Fn(u16) -> Symbol) -> Vec<ExprId> {
        (0..self.dof() as u16).map(|i| pool.symbol(symbol(i))).collect()
    }

    /// For each revolute joint the revolute joint before it, if their axes are parallel, and whether they point opposite ways.
    pub fn parallel_axes(&self) -> Vec<Option<(u16, bool)>> {
        self.joints
            .iter()
            .map(|joint| {
                let mut axis = joint.fixed.map(|row| row[2]);
                let mut before = joint.parent.filter(|_| joint.is_revolute())?;
                // Behind a prismatic joint the axes of the link before only turn by constants.
                while !self.joints[before].is_revolute() {
                    let outer = &self.joints[before];
                    if axis[..2] != [ExprId::ZERO; 2] {
                        return None;
                    }
                    axis = outer.fixed.map(|row| row[2].signed(axis[2].is_negated()));
                    before = outer.parent?;
                }
                (axis[..2] == [ExprId::ZERO; 2]).then_some((before as u16, axis[2].is_negated()))
            })
            .collect()
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.coupling.as_ref().map_or(self.dof(), |coupled| coupled.coordinates().len())
    }

    /// S' of a vector with an entry for each joint.
    pub fn project(&self, pool: &mut Pool, vector: Vec<ExprId>) -> Vec<ExprId> {
        match &self.coupling {
            Some(coupled) => coupled.contract(pool, &vector, 1),
            None => vector,
        }
    }

    /// M S, row by row, of a matrix with a column for each joint.
    pub fn project_columns(&self, pool: &mut Pool, rows: Vec<Vec<ExprId>>) -> Vec<Vec<ExprId>> {
        rows.into_iter().map(|row| self.project(pool, row)).collect()
    }

    /// S' M S.
    pub fn project_matrix(&self, pool: &mut Pool, matrix: Vec<Vec<ExprId>>) -> Vec<Vec<ExprId>> {
        let Some(coupled) = &self.coupling else { return matrix };
        let rows = self.project_columns(pool, matrix);
        let columns = self.coordinates();
        let entries = coupled.contract(pool, &rows.concat(), columns);
        entries.chunks(columns).map(<[ExprId]>::to_vec).collect()
    }

    /// S a of the accelerations of coordinates.
    pub fn spread(&self, pool: &mut Pool, accelerations: Vec<ExprId>) -> Vec<ExprId> {
        match &self.coupling {
            Some(coupled) => coupled.spread(pool, &accelerations),
            None => accelerations,
        }
    }

    /// The field of expressions in coordinates from that of expressions in joint variables.
    pub(crate) fn field_of_coordinates(&self, field: &Field) -> Field {
        self.coupling.as_ref().map_or_else(|| field.clone(), |coupled| coupled.field(field))
    }

    /// Expressions in the variables of joints as expressions in coordinates, in a pool of their own where joints are coupled.
    pub fn in_coordinates(&self, pool: Pool, exprs: Vec<ExprId>) -> (Pool, Vec<ExprId>) {
        let into = Pool::new(self.field_of_coordinates(pool.field()));
        self.in_coordinates_of(pool, exprs, into)
    }

    /// The same in the given pool.
    pub(super) fn in_coordinates_of(&self, pool: Pool, exprs: Vec<ExprId>, mut into: Pool) -> (Pool, Vec<ExprId>) {
        let Some(coupled) = &self.coupling else { return (pool, exprs) };
        let found = coupled.substitute(&pool, &mut into, &exprs);
        (into, found)
    }

    /// For each coordinate the one before it whose axis is parallel to its own, and whether it points the other way. So are two coordinates of which a
    /// joint has the sum or the difference, wherever their axes are.
    pub(super) fn parallel_coordinates(&self) -> Vec<Option<(u16, bool)>> {
        let parallel = self.parallel_axes();
        let Some(coupled) = &self.coupling else { return parallel };
        let of = |&joint: &usize| {
            let (before, opposite) = parallel[joint].filter(|_| coupled.has_one_coordinate(joint))?;
            let place = coupled.coordinates().iter().position(|&of| of == usize::from(before))?;
            coupled.has_one_coordinate(usize::from(before)).then_some((place as u16, opposite))
        };
        let mut all: Vec<Option<(u16, bool)>> = coupled.coordinates().iter().map(of).collect();
        for (first, second, opposite) in coupled.pairs() {
            all[second].get_or_insert((first as u16, opposite));
        }
        all
    }

    /// A body in joint frame i with mass, first and second moment along z only, in the parent's joint frame: the same for every joint angle.
    pub fn fixed_outward(&self, pool: &mut Pool, i: usize, body: &Body) -> Body {
        let joint = &self.joints[i];
        let turned = body.turned(pool, &joint.fixed);
        turned.moved(pool, &joint.origin)
    }

    /// Moves the second moments of a prismatic joint's link to its parent, in whose frame they are constant.
    pub fn move_second_moments_to_parent(&mut self, pool: &mut Pool, i: usize) {
        let second = std::mem::replace(&mut self.joints[i].body.second, [ExprId::ZERO; 6]);
        if let Some(p) = self.joints[i].parent {
            let rotation = self.joints[i].rotation(pool);
            let turned = Body { second, ..Body::EMPTY }.turned(pool, &rotation);
            self.joints[p].body = self.joints[p].body.plus(pool, &turned);
        }
    }

    /// Moves the origin of joint frame i along its axis.
    pub fn slide(&mut self, pool: &mut Pool, i: usize, shift: ExprId) {
        let joint = &mut self.joints[i];
        let along = pool.scale(shift, &joint.fixed.map(|row| row[2]));
        joint.origin = pool.add_vectors(&joint.origin, &along);
        joint.body = joint.body.moved(pool, &[ExprId::ZERO, ExprId::ZERO, -shift]);
        joint.link_origin[2] = pool.sub(joint.link_origin[2], shift);
        joint.own_origin[2] = pool.sub(joint.own_origin[2], shift);
        for tool in self.tools_of(i) {
            tool.origin[2] = pool.sub(tool.origin[2], shift);
        }
        for joint in self.joints.iter_mut().filter(|joint| joint.parent == Some(i)) {
            joint.origin[2] = pool.sub(joint.origin[2], shift);
        }
    }

    /// Moves parameters that a joint does not feel to the parent, exactly (Gautier and Khalil 1990, "Direct calculation of
    /// minimum set of inertial parameters of serial robots", in second-moment form).
    ///
    /// A mass on the axis of a revolute joint, its moment and second moment along the axis, look the same to the parent whatever the
    /// joint angle, and joint i does not feel them: m, hz and Szz move to the parent. A prismatic joint never turns the second
    /// moments of its link: all six move. Parameters that reach the base are dropped.
    ///
    /// How much second moment along the axis moves is free: all of Szz ([`GroupingConvention::NoSecondMomentAlongAxis`]), which leaves the least
    /// work, or Iyy = Sxx + Szz, which leaves the base parameters of the literature ([`GroupingConvention::NoInertiaAboutY`]).
    pub fn group_towards_base(&mut self, pool: &mut Pool, convention: GroupingConvention) {
        for i in (0..self.dof()).rev() {
            if !self.joints[i].is_revolute() {
                self.move_second_moments_to_parent(pool, i);
                continue;
            }
            let mut handed = Body::EMPTY;
            let body = &mut self.joints[i].body;
            handed.mass = std::mem::replace(&mut body.mass, ExprId::ZERO);
            handed.first[2] = std::mem::replace(&mut body.first[2], ExprId::ZERO);
            let along = match convention {
                GroupingConvention::NoSecondMomentAlongAxis => body.second[5],
                GroupingConvention::NoInertiaAboutY => pool.add(body.second[0], body.second[5]),
            };
            body.second[5] = pool.sub(body.second[5], along);
            handed.second[5] = along;
            if let Some(parent) = self.joints[i].parent {
                let moved = self.fixed_outward(pool, i, &handed);
                self.joints[parent].body = self.joints[parent].body.plus(pool, &moved);
            }
        }
    }
}

fn numbers(pool: &mut Pool, matrix: &[[Number; 3]; 3]) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| pool.constant(&matrix[i][j])))
}

fn placement(pool: &mut Pool, manipulator: &Manipulator, view: View<'_>, placement: &Placement) -> (Matrix, Vector) {
    let translation = placement.translation.clone().map(|t| view.polynomial(pool, manipulator, &t));
    (numbers(pool, &placement.rotation), translation)
}

/// The frame of an end effector.
fn tool(pool: &mut Pool, manipulator: &Manipulator, view: View<'_>, joints: &[Joint], link: usize, pose: &Pose) -> Tool {
    let (rotation, origin) = placement(pool, manipulator, view, &pose.frame);
    let carrier = &joints[link];
    let rotation = pool.product(&carrier.link_rotation, &rotation);
    let turned = pool.transform(&carrier.link_rotation, &origin);
    Tool { link, rotation, origin: pool.add_vectors(&turned, &carrier.link_origin) }
}

/// The ten parameters of a body as mass, first and second moments.
fn inertial_body(pool: &mut Pool, manipulator: &Manipulator, view: View<'_>, of: impl Fn(Inertial) -> StandardParameter) -> Body {
    let value = Inertial::TEN.map(|k| view.standard(pool, manipulator, of(k)));
    let [mass, x, y, z, inertia @ ..] = value;
    Body { mass, first: [x, y, z], second: second_moments(pool, &inertia) }
}

fn joint(pool: &mut Pool, manipulator: &Manipulator, view: View<'_>, i: usize) -> Joint {
    let joint = &manipulator.joints[i];
    let index = i as u16;
    let (rotation, mut origin) = placement(pool, manipulator, view, &joint.placement);
    let (link_rotation, link_origin) = placement(pool, manipulator, view, &joint.link_frame);
    let (mut fixed, mut sine, mut cosine) = (rotation, ExprId::ZERO, ExprId::ONE);
    let frame_rate = if joint.kind == JointKind::Prismatic { ExprId::ZERO } else { pool.symbol(Symbol::Rate(index)) };
    if joint.kind == JointKind::Prismatic {
        let position = pool.symbol(Symbol::Position(index));
        let slide = pool.scale(position, &[rotation[0][2], rotation[1][2], rotation[2][2]]);
        origin = pool.add_vectors(&origin, &slide);
    } else {
        let (s, c) = (pool.symbol(Symbol::Sine(index)), pool.symbol(Symbol::Cosine(index)));
        (sine, cosine) = (s, c);
        if rotation[0][2] == ExprId::ZERO {
            // The rotation is Rx(alpha) Rz(offset): the offset joins the joint angle.
            let (zy, zz) = (rotation[1][2], rotation[2][2]);
            fixed = [[ExprId::ONE, ExprId::ZERO, ExprId::ZERO], [ExprId::ZERO, zz, zy], [ExprId::ZERO, -zy, zz]];
            let offset = pool.product(&transpose(&fixed), &rotation);
            (sine, cosine) =
                (pool.dot(&[s, c], &[offset[0][0], offset[1][0]]), pool.dot(&[c, s], &[offset[0][0], -offset[1][0]]));
        }
    }
    let link = inertial_body(pool, manipulator, view, |k| StandardParameter::Link(index, k));
    let body = if view.bodies_in_joint_frames() {
        link
    } else {
        let turned = link.turned(pool, &link_rotation);
        turned.moved(pool, &link_origin)
    };
    let given = |pool: &mut Pool, parameter| view.standard(pool, manipulator, parameter);
    let mut viscous = given(pool, StandardParameter::Viscous(index));
    let coulomb = given(pool, StandardParameter::Coulomb(index));
    let armature = given(pool, StandardParameter::Armature(index));
    let offset = given(pool, StandardParameter::Offset(index));
    let cubic = given(pool, StandardParameter::Cubic(index));
    let load = joint.load.as_ref().map_or(ExprId::ZERO, |load| pool.constant(load));
    let stribeck = given(pool, StandardParameter::Stribeck(index));
    let friction_velocity = pool.constant(&joint.friction_velocity());
    let stiffness = given(pool, StandardParameter::Stiffness(index));
    let rest = joint.spring.as_ref().map_or(ExprId::ZERO, |spring| view.polynomial(pool, manipulator, &spring.rest));
    if let Some(motor) = joint.plain_motor() {
        let ratio = view.polynomial(pool, manipulator, &motor.ratio);
        let at_rotor = given(pool, StandardParameter::RotorViscous(index));
        let square = pool.mul(ratio, ratio);
        let seen = pool.mul(square, at_rotor);
        viscous = pool.add(viscous, seen);
    }
    Joint {
        kind: joint.kind,
        parent: joint.parent.map(LinkId::index),
        fixed,
        sine,
        cosine,
        frame_rate,
        link_rate: ExprId::ZERO,
        own_axes: crate::ring::matrix::IDENTITY,
        own_origin: ZERO,
        origin,
        link_rotation,
        link_origin,
        body,
        rotor: None,
        armature,
        viscous,
        coulomb,
        offset,
        cubic,
        load,
        stribeck,
        friction_velocity,
        is_smooth: joint.smooth.is_some(),
        stiffness,
        rest,
    }
}

/// Adds the rotor of joint i: mass and inertia as they move with the link that it rides on, and the coupling.
///
/// A rotor of inertia I_m about its axis z that turns with omega_p + k dq z has the kinetic energy
/// `½ I_m (z·omega_p)² + I_m k dq (z·omega_p) + ½ I_m k² dq²`: the first part is an inertia I_m z z' of that link, the others are the
/// coupling.
fn add_rotor(pool: &mut Pool, manipulator: &Manipulator, view: View<'_>, arm: &mut Arm, i: usize) {
    let joint = &manipulator.joints[i];
    let Some(motor) = &joint.motor else { return };
    let carrier = motor.carrier.map(LinkId::index);
    let axis = motor.axis.clone().map(|a| pool.constant(&a));
    let position = motor.position.clone().map(|x| view.polynomial(pool, manipulator, &x));
    let mass = view.polynomial(pool, manipulator, &motor.mass);
    let (axis, position) = match carrier {
        Some(p) => {
            let link = arm.joints[p];
            let turned = pool.transform(&link.link_rotation, &position);
            (pool.transform(&link.link_rotation, &axis), pool.add_vectors(&turned, &link.link_origin))
        }
        None => {
            let moment = pool.scale(mass, &position);
            arm.base_moment = pool.add_vectors(&arm.base_moment, &moment);
            (axis, position)
        }
    };
    let inertia = view.standard(pool, manipulator, StandardParameter::RotorInertia(i as u16));
    let ratio = view.polynomial(pool, manipulator, &motor.ratio);
    if joint.plain_motor().is_some() {
        arm.joints[i].rotor = Some(Rotor { inertia, ratio, axis });
    } else {
        let viscous = view.standard(pool, manipulator, StandardParameter::RotorViscous(i as u16));
        let mut rates = vec![(i, ratio)];
        rates.extend(motor.coupling.iter().map(|(joint, factor)| (*joint, pool.constant(factor))));
        arm.rotors.push(CoupledRotor { joint: i, inertia, viscous, axis, carrier, rates });
    }
    if let Some(p) = carrier {
        let tensor = PAIRS.map(|(a, b)| {
            let product = pool.mul(axis[a], axis[b]);
            pool.mul(inertia, product)
        });
        let carried = Body { second: second_moments(pool, &tensor), ..Body::EMPTY };
        let mass = Body { mass, ..Body::EMPTY }.moved(pool, &position);
        let body = arm.joints[p].body.plus(pool, &carried);
        arm.joints[p].body = body.plus(pool, &mass);
    }
}
