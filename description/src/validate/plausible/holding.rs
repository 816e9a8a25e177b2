//! Efforts that do not hold the arm: what gravity asks of each joint, in floating point, at postures within the limits.
//!
//! ```text
//! g_i = -Σ_k m_k g0' (z_i × (p_k - o_i))   or   -Σ_k m_k g0' z_i    over the masses that joint i moves (Siciliano et al., Eq. 7.39)
//! ```

use super::{short, written};
use crate::description::RobotDescription;
use crate::diagnostic::Code;
use crate::exact::Polynomial;
use crate::kinds::JointKind;
use crate::manipulator::{Manipulator, Placement};
use crate::validate::{call, Context};

/// Postures that are looked at.
const POSTURES: u32 = 24;
/// A joint may fail to hold the arm where it reaches farthest; twice that is no margin.
const MARGIN: f64 = 2.0;

/// Warns of an effort limit below half of what gravity asks for somewhere, where no spring helps.
pub(in crate::validate) fn check_holding(description: &RobotDescription, arm: &Manipulator, context: &mut Context<'_>) {
    let joints = description.joints.as_ref().map_or(&[][..], |joints| &joints.value);
    // A coupled joint holds others up, too.
    if arm.coupling.is_some() {
        return;
    }
    // Another doubtful number, such as a length in mm, would be the reason: it has its own warning.
    if !context.diagnostics.is_empty() || joints.iter().all(|joint| joint.limits.effort.is_none()) {
        return;
    }
    let most = most_asked(arm);
    for (i, (joint, described)) in arm.joints.iter().zip(joints).enumerate() {
        let (Some(effort), Some(expression)) = (&joint.limits.effort, &described.limits.effort) else { continue };
        let effort = effort.to_f64();
        if joint.spring.is_some() || most[i] <= MARGIN * effort {
            continue;
        }
        let unit = if joint.kind == JointKind::Revolute { "N m" } else { "N" };
        let carried = if !arm.loads().is_empty() { "the arm with its payload" } else { "the arm" };
        let message = format!(
            "joint {} cannot hold {carried}: gravity asks up to {} {unit} of it, and its effort limit is {} {unit}",
            call(i, described),
            short(most[i]),
            short(effort)
        );
        let help = "efforts count at the joint, behind the gear, in N m or N: a motor's torque is to be multiplied by `ratio`, one in kN m by 1000";
        context.report(Code::WeakEffort, written(expression, context), message, "too little to stand still", help);
    }
}

type Vector = [f64; 3];
type Matrix = [Vector; 3];

/// A frame in another.
#[derive(Clone, Copy)]
struct Frame {
    turn: Matrix,
    at: Vector,
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Frame {
    const BASE: Frame = Frame { turn: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], at: [0.0; 3] };

    fn of(arm: &Manipulator, placement: &Placement) -> Frame {
        Frame {
            turn: placement.rotation.each_ref().map(|row| row.each_ref().map(|entry| entry.to_f64())),
            at: placement.translation.each_ref().map(|x| value(arm, x)),
        }
    }

    fn direction(&self, v: &Vector) -> Vector {
        self.turn.each_ref().map(|row| dot(row, v))
    }

    fn point(&self, p: &Vector) -> Vector {
        let turned = self.direction(p);
        std::array::from_fn(|k| self.at[k] + turned[k])
    }

    fn then(&self, next: &Frame) -> Frame {
        let column = |j: usize| self.direction(&[next.turn[0][j], next.turn[1][j], next.turn[2][j]]);
        let columns = [column(0), column(1), column(2)];
        Frame { turn: std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i])), at: self.point(&next.at) }
    }
}

fn value(arm: &Manipulator, polynomial: &Polynomial) -> f64 {
    polynomial.evaluate(&|id| arm.parameters[id.0 as usize].nominal.clone()).to_f64()
}

/// The motion by q about or along a unit axis.
fn motion(kind: JointKind, u: &Vector, q: f64) -> Frame {
    match kind {
        JointKind::Prismatic => Frame { at: u.map(|x| x * q), ..Frame::BASE },
        JointKind::Revolute => {
            let (s, c) = q.sin_cos();
            // c 1 + s [u] + (1 - c) u u'
            let skew = [[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]];
            let turn = |i: usize, j: usize| f64::from(u8::from(i == j)) * c + s * skew[i][j] + (1.0 - c) * u[i] * u[j];
            Frame { turn: std::array::from_fn(|i| std::array::from_fn(|j| turn(i, j))), at: [0.0; 3] }
        }
    }
}

/// The largest size of each joint's gravity torque, N m or N.
fn most_asked(arm: &Manipulator) -> Vec<f64> {
    let g0 = arm.gravity.each_ref().map(|g| value(arm, g));
    let steps: Vec<(Frame, Vector, Frame)> = arm
        .joints
        .iter()
        .map(|joint| {
            let axis = joint.row.axis.each_ref().map(|x| x.to_f64());
            (Frame::of(arm, &joint.row.before.frame), axis, Frame::of(arm, &joint.row.after.frame))
        })
        .collect();
    // The load of each link, in its frame: bodies, and the rotors of the joints after it; payloads on those of their end effectors.
    let mut carried: Vec<Vec<(f64, Vector)>> = arm
        .joints
        .iter()
        .map(|joint| {
            joint.link.iter().map(|part| (value(arm, &part.body.mass), part.body.com.each_ref().map(|x| value(arm, x)))).collect()
        })
        .collect();
    for motor in arm.joints.iter().filter_map(|joint| joint.motor.as_ref()) {
        if let Some(carrier) = motor.carrier {
            carried[carrier.index()].push((value(arm, &motor.mass), motor.position.each_ref().map(|x| value(arm, x))));
        }
    }
    for load in arm.loads() {
        let tool = Frame::of(arm, &load.tool.frame);
        let com = tool.point(&load.body.body.com.each_ref().map(|x| value(arm, x)));
        carried[load.link].push((value(arm, &load.body.body.mass), com));
    }
    let limits: Vec<[f64; 2]> = arm
        .joints
        .iter()
        .map(|joint| match (&joint.limits.position, joint.kind) {
            (Some(limits), _) => limits.each_ref().map(|limit| limit.to_f64()),
            (None, JointKind::Revolute) => [-std::f64::consts::PI, std::f64::consts::PI],
            (None, JointKind::Prismatic) => [0.0, 0.0],
        })
        .collect();
    let mut most = vec![0.0f64; arm.joints.len()];
    for k in 0..POSTURES {
        // Multiples of the golden ratio spread evenly.
        let part = |i: usize| (0.5 + 0.618_033_988_749_895 * f64::from(k) * (i + 1) as f64).fract();
        let (mut links, mut axes) = (Vec::<Frame>::new(), Vec::new());
        for (i, joint) in arm.joints.iter().enumerate() {
            let (before, axis, after) = &steps[i];
            let before = joint.parent.map_or(Frame::BASE, |link| links[link.index()]).then(before);
            axes.push((before.direction(axis), before.at));
            let q = limits[i][0] + part(i) * (limits[i][1] - limits[i][0]);
            links.push(before.then(&motion(joint.kind, axis, q)).then(after));
        }
        for (i, joint) in arm.joints.iter().enumerate() {
            let (direction, point) = &axes[i];
            let mut torque = 0.0;
            for link in (i..arm.joints.len()).filter(|&link| is_moved_by(arm, link, i)) {
                for (mass, com) in &carried[link] {
                    let p = links[link].point(com);
                    let lever = std::array::from_fn(|k| p[k] - point[k]);
                    let along = if joint.kind == JointKind::Revolute { cross(direction, &lever) } else { *direction };
                    torque -= mass * dot(&g0, &along);
                }
            }
            most[i] = most[i].max(torque.abs());
        }
    }
    most
}

/// Whether joint `i` moves `link`.
fn is_moved_by(arm: &Manipulator, link: usize, i: usize) -> bool {
    std::iter::successors(Some(link), |&link| arm.joints[link].parent.map(|parent| parent.index())).any(|link| link == i)
}
