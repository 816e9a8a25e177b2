//! How far snapping can move the flange and the torques: the triangle inequality, joint after joint.
//!
//! Two arms may differ by angles D_j in the origin of row j and η_j in the direction of its axis. Then, for all states of the box,
//!
//! ```text
//! |R - R'| ≤ Σ_j (D_j + 2 η_j)                                                                      (rad)
//! |p - p'| ≤ Σ_j (D_j + 2 η_j) ρ_j + Σ_slides η_j Q_j + Σ dust     ρ_j: length of the rest of the chain   (m)
//! ```
//!
//! where Q is the largest |q| of a slide. For the torques one number after another is replaced. Between the arm before and the arm after,
//! a Newton-Euler recursion runs outwards over magnitudes of angular velocity, angular acceleration and acceleration and over their
//! differences, then inwards over forces and moments. Products differ by |ab - a'b'| ≤ Δa |b| + |a'| Δb. There are two bounds, and the
//! smaller counts. One compares vectors in the axes of each link, so a turn acts once on all later links. The other compares them in the
//! axes of the base, where a turn of the last link moves its mass a little and turns no force. A turn of the whole arm about the direction
//! of gravity changes no torque and is left out.
//!
//! The box: q within its limits (none: ±pi rad, ±1 m), |dq| up to the velocity limit (none: 4 rad/s, 1 m/s), |ddq| ≤ 10.
//! A joint that follows another one moves by its factor times that, and its torque counts at the joint with the coordinate.
//! Sums are floats, rounded up at the end.

use crate::body::Body;
use crate::chain::{Arm, Row};
use crate::pose::{Pose, Turn};
use crate::written::Written;

/// Largest |ddq| of a coordinate.
const ACCELERATION: f64 = 10.0;
/// The factor of a bound: more than all roundings here.
const UP: f64 = 1.0 + 1e-9;

/// How far the arm of robot.yaml and the one of the file are apart at most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bound {
    /// The bound for the origin of the end effector, m.
    pub(crate) flange: f64,
    /// The bound for its axes, rad.
    pub(crate) orientation: f64,
    /// The bound for any joint's torque, N m or N.
    pub(crate) torque: f64,
    /// The joint whose torque that is.
    pub(crate) joint: usize,
}

/// Length of poses, their turn as an angle, and their displacement as a length.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    length: f64,
    turned: f64,
    moved: f64,
}

fn norm(v: &[Written; 3]) -> f64 {
    v.iter().map(|x| x.value * x.value).sum::<f64>().sqrt()
}

fn offsets(v: &[Written; 3]) -> f64 {
    v.iter().map(|x| x.offset).sum()
}

/// Poses one after another: what turns the first one moves all that follow.
fn way(poses: &[Pose]) -> Way {
    let mut way = Way::default();
    for pose in poses {
        let step = norm(&pose.xyz);
        way.moved += way.turned * step + offsets(&pose.xyz);
        way.length += step;
        way.turned += pose.turned();
    }
    way
}

/// Largest |q| and |dq| of the box.
fn box_of(row: &Row) -> (f64, f64) {
    let otherwise = if row.prismatic { (1.0, 1.0) } else { (std::f64::consts::PI, 4.0) };
    let q = row.motion.position.as_ref().map_or(otherwise.0, |[low, high]| low.value.abs().max(high.value.abs()));
    (q, row.motion.velocity.as_ref().map_or(otherwise.1, |v| v.value))
}

/// The joint with the coordinate that a joint moves with, and sizes of factor and offset.
struct Coordinate {
    row: usize,
    factor: f64,
    offset: f64,
}

fn coordinate(arm: &Arm, row: usize) -> Coordinate {
    let mut found = Coordinate { row, factor: 1.0, offset: 0.0 };
    while let Some(follows) = &arm.rows[found.row].follows {
        found.offset += found.factor * follows.offset.value.abs();
        found.factor *= follows.factor.value.abs();
        found.row = follows.leader;
    }
    found
}

/// A quantity of both arms: its largest size, and how far the two can be apart.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    size: f64,
    apart: f64,
}

impl Pair {
    fn new(size: f64, apart: f64) -> Pair {
        Pair { size, apart }
    }

    fn plus(self, other: Pair) -> Pair {
        Pair::new(self.size + other.size, self.apart + other.apart)
    }

    fn times(self, other: Pair) -> Pair {
        Pair::new(self.size * other.size, self.apart * other.size + self.size * other.apart)
    }

    /// The same in axes that are turned by this angle against the other arm.
    fn turned(self, by: f64) -> Pair {
        Pair::new(self.size, self.apart + by * self.size)
    }
}

/// A body in its link's frame: mass, centre of mass, inertia about it.
struct Mass {
    m: f64,
    com: Pair,
    inertia: Pair,
}

fn mass(body: &Body, at: Way) -> Mass {
    let com = Pair::new(at.length + norm(&body.com), at.moved + at.turned * norm(&body.com) + offsets(&body.com));
    let entries = [0, 1, 2, 3, 3, 4, 4, 5, 5].map(|k| &body.inertia[k]);
    let size = entries.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
    let dust: f64 = entries.iter().map(|x| x.offset).sum();
    // R I R' with R off by an angle: twice that times |I|.
    Mass { m: body.mass.value, com, inertia: Pair::new(size, 2.0 * (at.turned + body.turn.turned()) * size + dust) }
}

/// The bounds of an arm; all are 0 where nothing was taken for something else.
pub(crate) fn of(arm: &Arm) -> Bound {
    if arm.snap.snapped.is_empty() {
        return Bound::default();
    }
    let ways: Vec<Way> = arm.rows.iter().map(|row| way(&row.origin)).collect();
    let coordinates: Vec<Coordinate> = (0..arm.rows.len()).map(|row| coordinate(arm, row)).collect();
    let of_row = |Coordinate { row, factor, offset }: &Coordinate| {
        let (q, dq) = box_of(&arm.rows[*row]);
        [factor * q + offset, factor * dq, factor * ACCELERATION]
    };
    let boxes: Vec<[f64; 3]> = coordinates.iter().map(of_row).collect();
    let slide = |j: usize| if arm.rows[j].prismatic { boxes[j][0] } else { 0.0 };
    let (mut farthest, mut most_turned) = (0.0f64, 0.0f64);
    for end in &arm.ends {
        let tool = way(&end.tool);
        let (mut flange, mut orientation, mut rest) = (tool.moved, tool.turned, tool.length);
        for j in std::iter::successors(Some(end.row), |&j| arm.rows[j].parent) {
            let eta = arm.rows[j].motion.axis_offset;
            // A slide along an axis that points elsewhere turns nothing.
            let turned = ways[j].turned + if arm.rows[j].prismatic { 0.0 } else { 2.0 * eta };
            flange += ways[j].turned * slide(j) + turned * rest + eta * slide(j) + ways[j].moved;
            orientation += turned;
            rest += ways[j].length + slide(j);
        }
        (farthest, most_turned) = (farthest.max(flange), most_turned.max(orientation));
    }
    let (joint, torque) = torque(arm, &ways, &boxes, &coordinates);
    Bound { flange: farthest * UP, orientation: most_turned * UP, torque: torque * UP, joint }
}

/// By how much of its angle snapping turned the whole arm about z of the base alone, along which gravity points.
fn about_gravity(arm: &Arm) -> f64 {
    if arm.gravity[..2].iter().any(|component| component != "0") || arm.gravity_offset != 0.0 {
        return 0.0;
    }
    let mut yaw = 0.0;
    for pose in arm.rows.first().into_iter().flat_map(|row| &row.origin) {
        // The last of the three turns is about z of the frame before.
        let Turn::Rpy([roll, pitch, about_z]) = &pose.turn else { break };
        yaw += about_z.offset;
        if [roll, pitch].iter().any(|angle| !angle.is_zero() || angle.offset != 0.0) {
            break;
        }
    }
    yaw
}

/// The replacement of one number.
#[derive(Clone, Copy, PartialEq)]
enum Step {
    /// The origin of a joint.
    Origin(usize),
    /// The axis of a joint.
    Axis(usize),
    /// Bodies in their links, and gravity.
    Bodies,
}

/// In whose axes the vectors of both arms are compared.
#[derive(Clone, Copy, PartialEq)]
enum Axes {
    Link,
    Base,
}

/// The joint whose torque can change most, and by how much.
fn torque(arm: &Arm, ways: &[Way], boxes: &[[f64; 3]], coordinates: &[Coordinate]) -> (usize, f64) {
    let rows = 0..arm.rows.len();
    let steps = rows.clone().flat_map(|j| [Step::Origin(j), Step::Axis(j)]).chain([Step::Bodies]);
    let mut sums = vec![0.0; arm.rows.len()];
    for step in steps {
        let [link, base] = [Axes::Link, Axes::Base].map(|axes| differences(arm, ways, boxes, step, axes));
        rows.clone().for_each(|j| sums[coordinates[j].row] += coordinates[j].factor * link[j].min(base[j]));
    }
    sums.into_iter().enumerate().fold((0, 0.0), |worst, (j, sum)| if sum > worst.1 { (j, sum) } else { worst })
}

/// Newton-Euler over magnitudes: by how much each torque changes at one step.
fn differences(arm: &Arm, ways: &[Way], boxes: &[[f64; 3]], step: Step, axes: Axes) -> Vec<f64> {
    let n = arm.rows.len();
    let when = |now: bool, offset: f64| if now { offset } else { 0.0 };
    let gravity_turned = when(step == Step::Bodies, arm.gravity_offset);
    let falling = Pair::new(arm.gravity_size, arm.gravity_size * gravity_turned);
    let (mut forces, mut moments) = (vec![Pair::default(); n], vec![Pair::default(); n]);
    // Of each link its rates, its acceleration, and by how much the axes in which vectors are written see it turned: those of the link itself
    // do not.
    let mut links: Vec<(Pair, Pair, Pair, f64)> = Vec::new();
    // By how much link j - 1 sees link j turned, its lever, and by how much the axis of joint j is turned.
    let mut passed = Vec::new();
    for (j, row) in arm.rows.iter().enumerate() {
        let base = (Pair::default(), Pair::default(), falling, 0.0);
        let (mut w, mut dw, mut a, mut link) = row.parent.map_or(base, |parent| links[parent]);
        let ([q, dq, ddq], eta) = (boxes[j], when(step == Step::Axis(j), row.motion.axis_offset));
        let origin = step == Step::Origin(j);
        let turned = when(origin, ways[j].turned);
        let mut lever = Pair::new(ways[j].length, when(origin, ways[j].moved)).turned(link);
        if row.prismatic {
            lever = lever.plus(Pair::new(q, (link + turned + eta) * q));
        }
        a = a.plus(dw.times(lever)).plus(w.times(w).times(lever));
        let onwards = turned + if row.prismatic { 0.0 } else { 2.0 * eta };
        let (seen, axis) = match axes {
            Axes::Link => (onwards, eta),
            Axes::Base => (0.0, link + turned + eta),
        };
        if axes == Axes::Base {
            link += onwards;
        }
        passed.push((seen, lever, axis));
        let felt = if j == 0 && origin { (seen - about_gravity(arm)).max(0.0) } else { seen };
        a = a.turned(felt);
        (w, dw) = (w.turned(seen), dw.turned(seen));
        let (rate, change) = (Pair::new(dq, axis * dq), Pair::new(ddq, axis * ddq));
        if row.prismatic {
            a = a.plus(change).plus(Pair::new(2.0, 0.0).times(w).times(rate));
        } else {
            dw = dw.plus(change).plus(w.times(rate));
            w = w.plus(rate);
        }
        links.push((w, dw, a, link));
        let attached = row.attached.iter().map(|other| mass(&other.body, way(&other.origin)));
        for Mass { m, com, inertia } in row.body.iter().map(|body| mass(body, Way::default())).chain(attached) {
            let in_link = |of: Pair| Pair::new(of.size, when(step == Step::Bodies, of.apart));
            // R I R' with R off by an angle: twice that times |I|.
            let (com, inertia) = (in_link(com).turned(link), in_link(inertia).turned(2.0 * link));
            let at = a.plus(dw.times(com)).plus(w.times(w).times(com));
            let force = Pair::new(m, 0.0).times(at);
            forces[j] = forces[j].plus(force);
            moments[j] = moments[j].plus(inertia.times(dw)).plus(w.times(inertia).times(w)).plus(com.times(force));
        }
    }
    let mut changes = vec![0.0; n];
    for j in (0..n).rev() {
        let (seen, lever, axis) = passed[j];
        let felt = if arm.rows[j].prismatic { forces[j] } else { moments[j] };
        changes[j] = felt.apart + axis * felt.size;
        if let Some(parent) = arm.rows[j].parent {
            let force = forces[j].turned(seen);
            forces[parent] = forces[parent].plus(force);
            moments[parent] = moments[parent].plus(moments[j].turned(seen)).plus(lever.times(force));
        }
    }
    changes
}
