//! Regrouping of inertial parameters towards the base, with its two choices: how much of each parameter moves, and where on its axis a joint frame
//! has its origin.
//!
//! A mass on the axis of a revolute joint, its moment and second moment along the axis, look the same to the parent whatever the
//! joint angle, and the joint does not feel them (Gautier and Khalil 1990, "Direct calculation of minimum set of inertial
//! parameters of serial robots", in second-moment form). Any amount may move: the plain way moves all, so that m, hz and Szz of the link
//! vanish; another way moves as much as makes an entry of the parent vanish. A prismatic joint never turns the second moments of
//! its link: all six move.
//!
//! The origin of a joint frame is free along the joint axis: at the foot of either common normal, or where Sxz or Syz vanishes.
//! For frames it can also be next to the end effector.
//!
//! Both choices divide by entries that may be dust of an exporter. A shift of kilometres is exact, and no floating-point number that goes through
//! it keeps its digits: ways far larger than the arm are refused.

use super::super::arm::{Arm, Body};
use super::super::plan::{Place, Plan};
use crate::pass::Pass;
use crate::ring::{ExprId, Pool};

/// The mass (kg) and the extent (m) of an arm.
struct Size {
    mass: f64,
    length: f64,
}

impl Size {
    /// The sums of its masses, and of the coordinates of its origins and the radii of gyration of its bodies. `None` in a pool without values.
    fn of(pool: &Pool, arm: &Arm) -> Option<Size> {
        let value = |entry: ExprId| pool.as_constant(entry).map_or(0.0, |number| number.to_f64().abs());
        let gyration = |body: &Body| {
            let [xx, _, yy, _, _, zz] = body.second.map(value);
            Some(((xx + yy + zz) / value(body.mass)).sqrt()).filter(|radius| radius.is_finite())
        };
        pool.knows_values().then(|| Size {
            mass: arm.joints.iter().map(|joint| value(joint.body.mass)).sum(),
            length: arm.joints.iter().flat_map(|joint| joint.origin).chain(arm.tool.origin).map(value).sum::<f64>()
                + arm.joints.iter().filter_map(|joint| gyration(&joint.body)).sum::<f64>(),
        })
    }

    /// Whether a constant in kg^mass m^length is beyond the arm's own.
    fn is_below(&self, pool: &Pool, constant: ExprId, mass: i32, length: i32) -> bool {
        pool.as_constant(constant).is_some_and(|number| number.to_f64().abs() > self.mass.powi(mass) * self.length.powi(length))
    }
}

/// Regroups the parameters of all links towards the base.
pub(super) fn group(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan) {
    let size = Size::of(pool, arm);
    for i in (0..arm.dof()).rev() {
        choose_origin(pool, arm, plan, size.as_ref(), i, false);
        if !plan.has(Pass::Grouping) {
            continue;
        }
        if arm.joints[i].is_revolute() {
            for (k, unit) in [unit_mass(), unit_moment(), unit_second_moment()].iter().enumerate() {
                regroup(pool, arm, plan, size.as_ref(), i, k, unit);
            }
        } else {
            arm.move_second_moments_to_parent(pool, i);
        }
    }
}

/// Chooses the origins alone, for functions that the end effector may enter.
pub(super) fn choose_origins(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan) {
    let size = Size::of(pool, arm);
    for i in (0..arm.dof()).rev() {
        choose_origin(pool, arm, plan, size.as_ref(), i, true);
    }
}

fn unit_mass() -> Body {
    Body { mass: ExprId::ONE, ..Body::EMPTY }
}

fn unit_moment() -> Body {
    let mut body = Body::EMPTY;
    body.first[2] = ExprId::ONE;
    body
}

fn unit_second_moment() -> Body {
    let mut body = Body::EMPTY;
    body.second[5] = ExprId::ONE;
    body
}

fn entries(body: &Body) -> Vec<ExprId> {
    std::iter::once(body.mass).chain(body.first).chain(body.second).collect()
}

/// Moves a part of a body that joint i does not feel to the parent.
fn regroup(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan, size: Option<&Size>, i: usize, kind: usize, unit: &Body) {
    let joint = arm.joints[i];
    let own = [joint.body.mass, joint.body.first[2], joint.body.second[5]][kind];
    let mut amount = own;
    let moved = arm.fixed_outward(pool, i, unit);
    if let Some(p) = joint.parent {
        // An entry of the parent vanishes if as much moves as it lacks.
        let there: Vec<(ExprId, ExprId)> = entries(&arm.joints[p].body)
            .into_iter()
            .zip(entries(&moved))
            .skip(1)
            .filter(|&(_, gain)| gain != ExprId::ZERO)
            .collect();
        let way = plan.way(Pass::GroupingAmount, Place::Parameter(i, kind), there.len() + 1);
        if way > 0 {
            let (entry, gain) = there[way - 1];
            let inverse = pool.reciprocal(gain);
            let lacking = -pool.mul(entry, inverse);
            if size.is_some_and(|size| size.is_below(pool, lacking, 1, kind as i32)) {
                plan.refuse(Pass::GroupingAmount, Place::Parameter(i, kind), way);
            } else {
                amount = lacking;
            }
        }
    }
    let scaled = |pool: &mut Pool, body: &Body, by: ExprId| Body {
        mass: pool.mul(by, body.mass),
        first: pool.scale(by, &body.first),
        second: body.second.map(|x| pool.mul(by, x)),
    };
    let taken = scaled(pool, unit, -amount);
    arm.joints[i].body = arm.joints[i].body.plus(pool, &taken);
    if let Some(p) = joint.parent {
        let given = scaled(pool, &moved, amount);
        arm.joints[p].body = arm.joints[p].body.plus(pool, &given);
    }
}

/// Moves the origin of joint frame i along its axis, to the foot of the end effector too where that counts.
fn choose_origin(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan, size: Option<&Size>, i: usize, end_effector_counts: bool) {
    if !plan.has(Pass::OriginAlongAxis) {
        return;
    }
    let joint = arm.joints[i];
    let child = (0..arm.dof()).find(|&c| arm.joints[c].parent == Some(i));
    let axis = joint.fixed.map(|row| row[2]);
    let mut shifts = Vec::new();
    let along = pool.dot3(&joint.origin, &axis);
    if joint.is_revolute() {
        shifts.push(-along);
    }
    if let Some(c) = child {
        shifts.push(arm.joints[c].origin[2]);
    }
    let [h, s] = [joint.body.first, [joint.body.second[3], joint.body.second[4], ExprId::ZERO]];
    for k in 0..2 {
        if pool.is_constant(h[k]) && h[k] != ExprId::ZERO {
            let inverse = pool.reciprocal(h[k]);
            shifts.push(pool.mul(s[k], inverse));
        }
    }
    // Data sheets differ in whether the last link or the tool reaches to the flange.
    if end_effector_counts && arm.tool.link == i {
        shifts.push(arm.tool.origin[2]);
    }
    let mut ways: Vec<ExprId> = Vec::new();
    for shift in shifts {
        if shift != ExprId::ZERO && pool.is_constant(shift) && !ways.contains(&shift) {
            ways.push(shift);
        }
    }
    let way = plan.way(Pass::OriginAlongAxis, Place::Joint(i), ways.len() + 1);
    if way > 0 {
        let shift = ways[way - 1];
        if size.is_some_and(|size| size.is_below(pool, shift, 0, 1)) {
            plan.refuse(Pass::OriginAlongAxis, Place::Joint(i), way);
        } else {
            arm.slide(pool, i, shift);
        }
    }
}
