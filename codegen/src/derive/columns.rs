//! How the wrench of a column reaches the joints between it and the base.
//!
//! Column j of B is what each ancestor i of joint j feels of ∂x/∂q_j over all that joint j carries: a force f and a moment n about a
//! point, passed from link to link. C passes on the wrench (F, N) of the rate of ∂x/∂q_j and the moment E as well
//! (`coriolis.rs`). With d from o_i to the point that the moments are about,
//!
//! ```text
//! B_ij = z_i · (n + d × f),   C_ij = z_i · (N + d × F),   C_ji = dz_i/dt · n + z_i · E + d(z_i × d)/dt · f      (joint i revolute)
//! B_ij = z_i · f,             C_ij = z_i · F,             C_ji = dz_i/dt · f                                     (prismatic)
//! ```
//!
//! E is kept relative to a rotating frame, E + n × Ω with Ω the angular velocity of the link that E is relative to: relative to link i
//! itself the term dz_i/dt · n is gone. Moved by d it gains d' × f - d × (Ω × f), d' the rate of d in that frame.
//!
//! There are three ways from one link to the next:
//!
//! - way 0 shifts the moments to the new origin in the new axes;
//! - way 1 shifts them in the old axes, before turning, and so need not turn a force that is not used again;
//! - way 2 keeps them about the old point, which saves operations if only one component is used on the way.

use std::collections::BTreeMap;

use super::arm::{Arm, Joint};
use super::plan::{Place, Plan};
use crate::pass::Pass;
use crate::ring::matrix::{Vector, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// The wrenches of a column.
#[derive(Clone, Copy)]
pub(super) struct Column {
    /// f, n.
    pub(super) inertial: (Vector, Vector),
    /// What C needs besides; none where only B is formed.
    pub(super) rate: Option<Rate>,
}

/// What C needs beside f and n.
#[derive(Clone, Copy)]
pub(super) struct Rate {
    /// F, N.
    pub(super) coriolis: (Vector, Vector),
    /// E + n × Ω.
    pub(super) transposed_moment: Vector,
}

/// Entries B_ij, C_ij and C_ji of an ancestor i.
pub(super) struct Entries {
    pub(super) inertia: ExprId,
    pub(super) coriolis: ExprId,
    pub(super) coriolis_transposed: ExprId,
}

impl Column {
    /// B_jj and C_jj of the joint that the column is of.
    pub(super) fn own_entries(&self, pool: &mut Pool, joint: &Joint) -> (ExprId, ExprId) {
        let axis = |(force, moment): (Vector, Vector)| if joint.is_revolute() { moment[2] } else { force[2] };
        let mut own = axis(self.inertial);
        if let Some(rotor) = joint.rotor {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let reflected = pool.mul(coupling, rotor.ratio);
            own = pool.add(own, reflected);
        }
        own = pool.add(own, joint.armature);
        (own, self.rate.map_or(ExprId::ZERO, |rate| axis(rate.coriolis)))
    }
}

/// The wrenches of one column of B (and C) at the link that the recursion towards the base has reached.
pub(super) struct PropagatedColumn {
    column: Column,
    /// The link in whose frame it is.
    link: usize,
    /// Whether it is expressed in the joint frame at theta = 0 (the parent's axes turned by `fixed`), before the rotation of the joint itself.
    before_joint_rotation: bool,
    /// The joint whose origin the moments are about.
    about: usize,
    /// The link that E is relative to; none for the base.
    relative: Option<usize>,
}

/// Vectors between the origins of joint frames, each computed when first needed.
pub(super) struct ColumnPropagator<'a> {
    arm: &'a Arm,
    /// Angular velocities of the joint frames, for C.
    omega: Option<&'a [Vector]>,
    /// o_r - o_i in frame i, its rate, and its rate relative to frame i.
    offsets: BTreeMap<(usize, usize), Offset>,
}

/// A vector between origins, its rate, and its rate relative to the frame that it is in.
#[derive(Clone, Copy)]
struct Offset {
    d: Vector,
    rate: Vector,
    relative: Vector,
}

impl<'a> ColumnPropagator<'a> {
    pub(super) fn new(arm: &'a Arm, omega: Option<&'a [Vector]>) -> ColumnPropagator<'a> {
        ColumnPropagator { arm, omega, offsets: BTreeMap::new() }
    }

    /// A column at its own joint, expressed in the joint frame at theta = 0, E relative to the parent.
    pub(super) fn start(&self, pool: &mut Pool, plan: &mut Plan, mut column: Column, joint: usize) -> PropagatedColumn {
        let mut relative = self.arm.joints[joint].parent;
        if let (Some(moving), Some(p), Some(omega)) = (&mut column.rate, relative, self.omega) {
            if plan.way(Pass::RelativeMoment, Place::Joint(joint), 2) == 1 {
                let turning = pool.transform_back(&self.arm.joints[joint].fixed, &omega[p]);
                let transport = pool.cross(&turning, &column.inertial.1);
                moving.transposed_moment = pool.add_vectors(&moving.transposed_moment, &transport);
                relative = None;
            }
        }
        PropagatedColumn { column, link: joint, before_joint_rotation: true, about: joint, relative }
    }

    /// o_i - o_parent, in the parent's frame.
    fn step(&self, pool: &mut Pool, i: usize) -> Offset {
        let joint = &self.arm.joints[i];
        let (Some(p), Some(omega)) = (joint.parent, self.omega) else {
            return Offset { d: joint.origin, rate: ZERO, relative: ZERO };
        };
        let transport = pool.cross(&omega[p], &joint.origin);
        let relative = origin_rate(pool, self.arm, i);
        Offset { d: joint.origin, rate: pool.add_vectors(&transport, &relative), relative }
    }

    /// o_r - o_i, in frame i.
    fn offset(&mut self, pool: &mut Pool, r: usize, i: usize) -> Offset {
        if r == i {
            return Offset { d: ZERO, rate: ZERO, relative: ZERO };
        }
        if let Some(&known) = self.offsets.get(&(r, i)) {
            return known;
        }
        let mut next = r;
        while self.arm.joints[next].parent != Some(i) {
            next = self.arm.joints[next].parent.expect("i is an ancestor of r");
        }
        let mut beyond = self.offset(pool, r, next);
        let step = self.step(pool, next);
        let joint = &self.arm.joints[next];
        let transport = pool.cross(&[ExprId::ZERO, ExprId::ZERO, joint.frame_rate], &beyond.d);
        beyond.relative = pool.add_vectors(&beyond.relative, &transport);
        let mut sum = |beyond: &Vector, step: &Vector| {
            let turned = to_parent(pool, joint, beyond);
            pool.add_vectors(&turned, step)
        };
        let found = Offset {
            d: sum(&beyond.d, &step.d),
            rate: sum(&beyond.rate, &step.rate),
            relative: sum(&beyond.relative, &step.relative),
        };
        self.offsets.insert((r, i), found);
        found
    }

    /// Transforms the wrenches into the frame of the parent link and gives its index; None at the base. The link before the joint that the
    /// column is of carries that joint's rotor, whose moment enters there.
    pub(super) fn propagate_to_parent(&mut self, pool: &mut Pool, plan: &mut Plan, t: &mut PropagatedColumn) -> Option<usize> {
        let from = t.link;
        let joint = &self.arm.joints[from];
        let parent = joint.parent?;
        let place = Place::Column(from, t.before_joint_rotation);
        // The parent's angular velocity in the axes that the column is in.
        let mut outer = ZERO;
        if let Some(omega) = self.omega {
            let at_zero = pool.transform_back(&joint.fixed, &omega[parent]);
            outer = if t.before_joint_rotation { at_zero } else { joint.about_axis_back(pool, &at_zero) };
        }
        if let (Some(moving), Some(omega)) = (&mut t.column.rate, self.omega) {
            if t.relative == Some(from) {
                let n = t.column.inertial.1;
                let change = if plan.way(Pass::RelativeMoment, Place::Leaving(from), 2) == 0 {
                    t.relative = Some(parent);
                    pool.cross(&n, &[ExprId::ZERO, ExprId::ZERO, -joint.frame_rate])
                } else {
                    t.relative = None;
                    pool.cross(&omega[from], &n)
                };
                moving.transposed_moment = pool.add_vectors(&moving.transposed_moment, &change);
            }
        }
        let way = plan.way(Pass::WrenchFrame, place, 3);
        if way == 1 {
            let mut total = self.offset(pool, t.about, from);
            let step = self.step(pool, from);
            let transport = pool.cross(&[ExprId::ZERO, ExprId::ZERO, joint.frame_rate], &total.d);
            total.relative = pool.add_vectors(&total.relative, &transport);
            let before_joint_rotation = t.before_joint_rotation;
            let mut sum = |beyond: &Vector, step: &Vector| {
                let at_zero = pool.transform_back(&joint.fixed, step);
                let own = if before_joint_rotation { at_zero } else { joint.about_axis_back(pool, &at_zero) };
                pool.add_vectors(beyond, &own)
            };
            let total = Offset {
                d: sum(&total.d, &step.d),
                rate: sum(&total.rate, &step.rate),
                relative: sum(&total.relative, &step.relative),
            };
            t.shift(pool, &total, &outer);
            t.about = parent;
        }
        let before_joint_rotation = t.before_joint_rotation;
        let mut turn =
            |v: &Vector| if before_joint_rotation { pool.transform(&joint.fixed, v) } else { to_parent(pool, joint, v) };
        t.column = Column {
            inertial: (turn(&t.column.inertial.0), turn(&t.column.inertial.1)),
            rate: t.column.rate.map(|rate| Rate {
                coriolis: (turn(&rate.coriolis.0), turn(&rate.coriolis.1)),
                transposed_moment: turn(&rate.transposed_moment),
            }),
        };
        if way == 0 {
            let offset = self.offset(pool, t.about, parent);
            let outer = self.omega.map_or(ZERO, |omega| omega[parent]);
            t.shift(pool, &offset, &outer);
            t.about = parent;
        }
        if let (Some(rotor), true) = (joint.rotor, t.before_joint_rotation) {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let momentum = pool.scale(coupling, &rotor.axis);
            let relative = self.omega.map_or(ZERO, |omega| omega[parent]);
            let mut absolute = relative;
            absolute[2] = pool.add(absolute[2], self.arm.joints[parent].link_rate);
            t.add_moment(pool, &momentum, &absolute, &relative);
        }
        (t.link, t.before_joint_rotation) = (parent, false);
        Some(parent)
    }

    /// The entries of the joint of the link that the column has reached: its wrenches projected on the joint axis.
    pub(super) fn entries(&mut self, pool: &mut Pool, t: &PropagatedColumn) -> Entries {
        let i = t.link;
        let revolute = self.arm.joints[i].is_revolute();
        let Offset { d, rate, .. } = self.offset(pool, t.about, i);
        let (f, n) = t.column.inertial;
        let felt = |pool: &mut Pool, f: &Vector, n: &Vector| {
            if !revolute {
                return f[2];
            }
            let lever = pool.dot(&[d[0], -d[1]], &[f[1], f[0]]);
            pool.add(n[2], lever)
        };
        let inertia = felt(pool, &f, &n);
        let (Some(moving), Some(omega)) = (t.column.rate, self.omega) else {
            return Entries { inertia, coriolis: ExprId::ZERO, coriolis_transposed: ExprId::ZERO };
        };
        let coriolis = felt(pool, &moving.coriolis.0, &moving.coriolis.1);
        // dz/dt = ω × z
        let z_rate = [omega[i][1], -omega[i][0], ExprId::ZERO];
        let coriolis_transposed = if revolute {
            let turned = if t.relative == Some(i) { ExprId::ZERO } else { pool.dot3(&z_rate, &n) };
            let lever = pool.cross(&z_rate, &d);
            let lever = pool.add_vectors(&lever, &[-rate[1], rate[0], ExprId::ZERO]);
            let pushed = pool.dot3(&lever, &f);
            let sum = pool.add(moving.transposed_moment[2], turned);
            pool.add(sum, pushed)
        } else {
            pool.dot3(&z_rate, &f)
        };
        Entries { inertia, coriolis, coriolis_transposed }
    }
}

impl PropagatedColumn {
    /// The wrench (f, n) about the origin of the frame of link `link`, and E + n × Ω relative to that frame: so the column is kept where every
    /// fork of the plan took way 0.
    pub(super) fn in_link_frame(&self) -> (Vector, Vector, Vector) {
        debug_assert!(self.about == self.link && self.relative == Some(self.link), "the plain way");
        let (f, n) = self.column.inertial;
        (f, n, self.column.rate.map_or(ZERO, |rate| rate.transposed_moment))
    }

    /// Adds the moment of a rotor, which is about no point, and its rate ½ ω × `moment`.
    fn add_moment(&mut self, pool: &mut Pool, moment: &Vector, omega: &Vector, frame: &Vector) {
        self.column.inertial.1 = pool.add_vectors(&self.column.inertial.1, moment);
        if let Some(moving) = &mut self.column.rate {
            let half = pool.fraction(1, 2);
            let turning = pool.cross(omega, moment);
            let turning = pool.scale(half, &turning);
            moving.coriolis.1 = pool.add_vectors(&moving.coriolis.1, &turning);
            moving.transposed_moment = pool.add_vectors(&moving.transposed_moment, &turning);
            if self.relative.is_some() {
                let seen = pool.cross(moment, frame);
                moving.transposed_moment = pool.add_vectors(&moving.transposed_moment, &seen);
            }
        }
    }

    /// Moves the reference point of the moments: `offset` leads from the new point to the old one, `outer` is the Ω of the link that E is
    /// relative to.
    fn shift(&mut self, pool: &mut Pool, offset: &Offset, outer: &Vector) {
        let mut moved = |at: &Vector, force: &Vector, moment: &Vector| {
            let lever = pool.cross(at, force);
            pool.add_vectors(moment, &lever)
        };
        let (f, n) = self.column.inertial;
        self.column.inertial.1 = moved(&offset.d, &f, &n);
        if let Some(moving) = &mut self.column.rate {
            moving.coriolis.1 = moved(&offset.d, &moving.coriolis.0, &moving.coriolis.1);
            if self.relative.is_none() {
                moving.transposed_moment = moved(&offset.rate, &f, &moving.transposed_moment);
            } else {
                moving.transposed_moment = moved(&offset.relative, &f, &moving.transposed_moment);
                let lagging = pool.cross(&f, outer);
                let lever = pool.cross(&offset.d, &lagging);
                moving.transposed_moment = pool.add_vectors(&moving.transposed_moment, &lever);
            }
        }
    }
}

fn to_parent(pool: &mut Pool, joint: &Joint, v: &Vector) -> Vector {
    if *v == ZERO {
        ZERO
    } else {
        joint.to_parent(pool, v)
    }
}

/// Velocity of the origin of joint frame i relative to its parent's joint frame.
pub(super) fn origin_rate(pool: &mut Pool, arm: &Arm, i: usize) -> Vector {
    let joint = &arm.joints[i];
    let link_rate = joint.parent.map_or(ExprId::ZERO, |p| arm.joints[p].link_rate);
    let turning = pool.cross(&[ExprId::ZERO, ExprId::ZERO, link_rate], &joint.origin);
    if joint.is_revolute() {
        return turning;
    }
    let rate = pool.symbol(Symbol::Rate(i as u16));
    let sliding = pool.scale(rate, &joint.fixed.map(|row| row[2]));
    pool.add_vectors(&turning, &sliding)
}
