//! The pose of an arm: frames of joints, links and end effector in the base frame, and the columns of Jacobians.

use super::arm::{Arm, Frame};
use super::state::State;
use super::vector::{add, apply, cross, product, scale, sub, transpose, Vector};
use crate::values::element::Element;

/// Frames relative to the base frame at a state.
#[derive(Clone, Debug)]
pub struct Pose<E> {
    /// The frames after each joint's motion, with their origin on the axis.
    pub joints: Vec<Frame<E>>,
    /// Directions of the joint axes.
    pub axes: Vec<Vector<E>>,
    /// The frames for base parameters.
    pub chosen: Vec<Frame<E>>,
    /// The link frames of the description.
    pub links: Vec<Frame<E>>,
    /// The end effectors.
    pub tools: Vec<Frame<E>>,
    /// For each link the joints that move it, from its own joint to the base.
    pub ancestors: Vec<Vec<usize>>,
    /// For each link the coordinates that move it.
    pub moving: Vec<Vec<usize>>,
    /// The coordinates that move each joint, with their factors, if joints are coupled.
    rows: Option<Vec<Vec<(usize, E)>>>,
    dof: usize,
    revolute: Vec<bool>,
    zero: E,
}

impl<E: Element> Frame<E> {
    /// The composition with `inner`, which is given in this frame.
    pub fn then(&self, inner: &Frame<E>) -> Frame<E> {
        Frame { rotation: product(&self.rotation, &inner.rotation), origin: self.point(&inner.origin) }
    }

    /// The coordinates of a point of this frame in the outer frame.
    pub fn point(&self, point: &Vector<E>) -> Vector<E> {
        add(&apply(&self.rotation, point), &self.origin)
    }

    /// The coordinates of a direction of this frame in the outer frame.
    pub fn direction(&self, direction: &Vector<E>) -> Vector<E> {
        apply(&self.rotation, direction)
    }

    /// The coordinates of a direction of the outer frame in this frame.
    pub fn into_frame(&self, direction: &Vector<E>) -> Vector<E> {
        apply(&transpose(&self.rotation), direction)
    }

    /// The identity.
    pub fn identity(zero: &E, one: &E) -> Frame<E> {
        let rotation = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { one.clone() } else { zero.clone() }));
        Frame { rotation, origin: [0; 3].map(|_| zero.clone()) }
    }

    /// The inverse transform.
    pub fn inverse(&self) -> Frame<E> {
        let rotation = transpose(&self.rotation);
        let origin = apply(&rotation, &self.origin).map(|x| x.negated());
        Frame { rotation, origin }
    }
}

impl<E: Element> Pose<E> {
    /// The pose at a state.
    pub fn new(arm: &Arm<E>, state: &State<E>) -> Pose<E> {
        let (zero, one) = (&arm.zero, &arm.one);
        let state = &*arm.state_of_joints(state);
        let mut joints: Vec<Frame<E>> = Vec::new();
        let mut ancestors: Vec<Vec<usize>> = Vec::new();
        let mut links: Vec<Frame<E>> = Vec::new();
        let mut axes = Vec::new();
        for (i, joint) in arm.joints.iter().enumerate() {
            let u = &joint.axis;
            let motion = if joint.revolute {
                // c 1 + s [u] + (1 - c) u u' (Rodrigues; the book, eq. 2.25)
                let (s, c) = &state.angles[i];
                let rest = one.minus(c);
                let entry = |a: usize, b: usize| {
                    let dyad = rest.times(&u[a]).times(&u[b]);
                    match (b + 3 - a) % 3 {
                        0 => dyad.plus(c),
                        1 => dyad.minus(&s.times(&u[3 - a - b])),
                        _ => dyad.plus(&s.times(&u[3 - a - b])),
                    }
                };
                Frame { rotation: [0, 1, 2].map(|a| [0, 1, 2].map(|b| entry(a, b))), origin: arm.nothing() }
            } else {
                Frame { origin: scale(&state.q[i], u), ..Frame::identity(zero, one) }
            };
            let moved = joint.before.then(&motion);
            let (frame, mut path) = match joint.parent {
                Some(parent) => (links[parent].then(&moved), ancestors[parent].clone()),
                None => (moved, Vec::new()),
            };
            axes.push(frame.direction(u));
            links.push(frame.then(&joint.after));
            joints.push(frame);
            path.insert(0, i);
            ancestors.push(path);
        }
        let chosen = links.iter().zip(&arm.joints).map(|(frame, joint)| frame.then(&joint.chosen)).collect();
        let tools = arm.tips.iter().map(|tip| links[tip.link].then(&tip.tool)).collect();
        let revolute = arm.joints.iter().map(|j| j.revolute).collect();
        let rows = arm.coupling.is_some().then(|| (0..arm.joints.len()).map(|i| arm.row(i)).collect::<Vec<_>>());
        let moving = match &rows {
            None => ancestors.clone(),
            Some(rows) => {
                let moves = |path: &Vec<usize>, a: &usize| path.iter().any(|&i| rows[i].iter().any(|(of, _)| of == a));
                ancestors.iter().map(|path| (0..arm.dof()).filter(|a| moves(path, a)).collect()).collect()
            }
        };
        let dof = arm.dof();
        Pose { joints, axes, chosen, links, tools, ancestors, moving, rows, dof, revolute, zero: zero.clone() }
    }

    /// The same pose with the links in the frames for base parameters.
    pub fn with_links_in_joint_frames(mut self) -> Pose<E> {
        self.links.clone_from(&self.chosen);
        self
    }

    /// Linear and angular velocity per unit of each coordinate's rate, for a point fixed in `link` (`None`: in the base).
    pub fn jacobian(&self, link: Option<usize>, point: &Vector<E>) -> Vec<(Vector<E>, Vector<E>)> {
        let nothing = || [0; 3].map(|_| self.zero.clone());
        let mut columns = vec![(nothing(), nothing()); self.dof];
        for &j in link.map_or(&[][..], |link| &self.ancestors[link]) {
            let z = self.axes[j].clone();
            let own = if self.revolute[j] { (cross(&z, &sub(point, &self.joints[j].origin)), z) } else { (z, nothing()) };
            let Some(rows) = &self.rows else {
                columns[j] = own;
                continue;
            };
            for (a, factor) in &rows[j] {
                let (linear, angular) = &columns[*a];
                columns[*a] = (add(linear, &scale(factor, &own.0)), add(angular, &scale(factor, &own.1)));
            }
        }
        columns
    }

    /// The geometric Jacobian of the end effector of this number, on this link, row by row: linear, then angular.
    pub fn geometric_jacobian(&self, tip: usize, link: usize) -> Vec<E> {
        let columns = self.jacobian(Some(link), &self.tools[tip].origin);
        let linear = (0..3).flat_map(|row| columns.iter().map(move |(v, _)| v[row].clone()));
        let angular = (0..3).flat_map(|row| columns.iter().map(move |(_, w)| w[row].clone()));
        linear.chain(angular).collect()
    }

    /// A frame as a 4 x 4 matrix, row by row.
    pub fn homogeneous(&self, frame: &Frame<E>, one: &E) -> Vec<E> {
        let mut entries: Vec<E> =
            (0..3).flat_map(|row| frame.rotation[row].iter().chain([&frame.origin[row]]).cloned().collect::<Vec<_>>()).collect();
        entries.extend([self.zero.clone(), self.zero.clone(), self.zero.clone(), one.clone()]);
        entries
    }
}
