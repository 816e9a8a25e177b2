//! An arm as a chain of joints and common normals, and the ways round the loop that it closes with a pose.
//!
//! T = C0 J1 N1 J2 N2 ... Jn Cn with J = Rz(theta + q) Tz(d) or Rz(theta) Tz(d + q) and common normals N = Tx(a) Rx(alpha), in both conventions.
//! Backwards, between half turns F about x, it is the same joints, F N⁻¹ F = Tx(-a)... = Rx(-alpha) Tx(-a) again a common normal, and links with
//! the pose exchanged for its inverse. Constant turns of revolute and slides of prismatic joints are offsets of their variables.
//! The other constants of a joint belong to the link after it.

use super::frame::{
    between_axes, compose, half_turn_about_x, identity, inverse, is_parallel, is_zero, slide_along_z, sum_of_angles,
    turn_about_z, Frame,
};
use super::is_prismatic;
use crate::derive::parameters::nominal;
use crate::exact::Number;
use crate::manipulator::{LinkId, Manipulator, Placement};

/// A joint with its constants.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    pub(super) prismatic: bool,
    /// (cos theta, sin theta).
    pub(super) theta: [Number; 2],
    pub(super) d: Number,
}

/// A common normal Tx(a) Rx(alpha), with (cos alpha, sin alpha).
#[derive(Clone, Debug)]
pub(super) struct Normal {
    pub(super) a: Number,
    pub(super) alpha: [Number; 2],
}

/// A serial arm.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    /// From the base frame to axis 1.
    pub(super) base: Frame,
    pub(super) joints: Vec<Joint>,
    /// Between neighbouring axes.
    pub(super) normals: Vec<Normal>,
    /// From axis n to the end effector.
    pub(super) tool: Frame,
    /// The number in the arm of the joint that is left out, from 0, since its value is given.
    pub(super) left_out: Option<usize>,
    /// That joint and the normal after it, if it is between two other joints; `normals` has the normal before it.
    pub(super) between: Option<(Joint, Normal)>,
    /// The number of last joints that are virtual and stay at 0.
    pub(super) still: usize,
}

/// A virtual joint. Rz(turn) Tz(d) Tx(a) Rx(alpha) leads from the joint before it to its own axis z.
#[derive(Clone)]
pub(super) struct Virtual {
    pub(super) prismatic: bool,
    /// (cos, sin) of the angle.
    pub(super) turn: [Number; 2],
    /// Where on the axis before it, seen from the foot of the common normal of that and the one before; none: where that joint's frame is.
    pub(super) d: Option<Number>,
    pub(super) a: Number,
    /// (cos, sin) of the angle.
    pub(super) alpha: [Number; 2],
}

/// A joint whose value is given. Documented with the block `given`.
#[derive(Clone, Debug)]
pub struct Given {
    /// Its number in the arm, from 0.
    pub joint: usize,
    /// The place in the loop of the link that it moves, if it is between two other joints; else it is at an end of the arm.
    pub place: Option<usize>,
    /// Whether it slides.
    pub prismatic: bool,
    /// From the joint before it, or the base, in the direction of the loop.
    pub before: Frame,
    /// To the joint after it, or the end effector.
    pub after: Frame,
}

/// One way round the loop: its constants, the pose left open. Documented with the block `arrangement`.
#[derive(Clone, Debug)]
pub struct Arrangement {
    /// The number of each joint in the arm, from 0, in the order in which the loop meets them.
    pub order: Vec<usize>,
    /// Their kinds, in the loop's order.
    pub prismatic: Vec<bool>,
    /// The link after each joint. At place `open` it is the identity.
    pub links: Vec<Frame>,
    /// The place of the link that depends on the pose.
    pub open: usize,
    /// It is `before` X `after`, X = T⁻¹, or T if the loop is read `backward`.
    pub before: Frame,
    /// See `before`.
    pub after: Frame,
    /// Read against the arm's direction.
    pub backward: bool,
    /// The loop's joint values minus the arm's: (cos theta, sin theta) of the angle, or (d, 0).
    pub offsets: Vec<[Number; 2]>,
    /// The number in the arm of the joint that is left out, from 0.
    pub(super) left_out: Option<usize>,
    /// The number of the arm's last joints that are virtual and stay at 0.
    pub(super) still: usize,
    /// The joint between two others whose value is given, with the place of the link that it moves: that of `links` is the identity.
    pub(super) given: Option<Given>,
}

fn frame(manipulator: &Manipulator, placement: &Placement) -> Frame {
    let entry = |i: usize, j: usize| match j {
        3 => nominal(manipulator, &placement.translation[i]),
        _ => placement.rotation[i][j].clone(),
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn no_turn() -> [Number; 2] {
    [Number::one(), Number::zero()]
}

/// Why an arm has no inverse kinematics if some of its joints move only other links.
pub(super) const BESIDE: &str = "some joints do not move the end effector; a name for it under `tips` leaves them out";

/// Why an arm has none whose links are given by frames.
const NO_ROW: &str = "two of its axes have no common normal in exact numbers: use its Jacobian, with damping";

impl Chain {
    /// The joints from the base to the end effector.
    pub(super) fn of(manipulator: &Manipulator) -> Result<Chain, String> {
        let joint = |id: LinkId| &manipulator.joints[id.index()];
        let mut path = vec![manipulator.tip];
        while let Some(parent) = joint(path[path.len() - 1]).parent {
            path.push(parent);
        }
        path.reverse();
        if path.len() < manipulator.dof() {
            return Err(BESIDE.into());
        }
        let (mut base, mut joints, mut normals) = (identity(), Vec::new(), Vec::new());
        for (i, id) in path.iter().enumerate() {
            let (joint, placed) = (joint(*id), frame(manipulator, &joint(*id).placement));
            let prismatic = is_prismatic(joint.kind);
            if i == 0 {
                base = placed;
                joints.push(Joint { prismatic, theta: no_turn(), d: Number::zero() });
            } else {
                let (normal, theta, d) = normal_and_joint(&placed).ok_or(NO_ROW)?;
                normals.push(normal);
                joints.push(Joint { prismatic, theta, d });
            }
        }
        let tool = compose(&frame(manipulator, &joint(manipulator.tip).link_frame), &frame(manipulator, &manipulator.tool.frame));
        Ok(Chain { base, joints, normals, tool, left_out: None, between: None, still: 0 })
    }

    /// The arm without a joint, whose value is given; and that joint, if it is the first or the last one.
    pub(super) fn without(&self, joint: usize) -> (Chain, Option<Given>) {
        let mut rest = self.clone();
        rest.left_out = Some(joint);
        let left_out = rest.joints.remove(joint);
        let given = |before: &Frame, after: Frame| {
            Some(Given { joint, place: None, prismatic: left_out.prismatic, before: compose(before, &left_out.own()), after })
        };
        if joint == 0 {
            let normal = rest.normals.remove(0).frame(false);
            rest.base = identity();
            (rest, given(&self.base, normal))
        } else if joint == rest.joints.len() {
            let normal = rest.normals.pop().map_or(identity(), |normal| normal.frame(false));
            rest.tool = identity();
            (rest, given(&normal, self.tool.clone()))
        } else {
            let behind = rest.normals.remove(joint);
            rest.between = Some((left_out, behind));
            (rest, None)
        }
    }

    /// A prismatic joint beyond the last, along its axis.
    pub(super) fn slide_at_the_end(&mut self) {
        self.normals.push(Normal { a: Number::zero(), alpha: no_turn() });
        self.joints.push(Joint { prismatic: true, theta: no_turn(), d: Number::zero() });
    }

    /// Adds a revolute joint after the last, about the z axis of the end effector. Errors: the reason why that is impossible.
    pub(super) fn turn_at_the_end(&mut self) -> Result<(), String> {
        let (Some(between), Some(last)) = (between_axes(&self.tool), self.joints.last_mut()) else {
            return Err("the last axis and the z axis of the end effector have no common normal in numbers".into());
        };
        if !last.prismatic && is_parallel(&self.tool) && is_zero(&between.normal.0) {
            // One joint more than the five that a position and a direction ask for can be spared.
            let rest = match self.joints.len() - 1 {
                5 => "`target: pointing` is a target of the other 5".to_owned(),
                others => format!("the other {others} reach a position, one of them given"),
            };
            return Err(format!(
                "the last joint turns about the z axis of the end effector, which position and direction leave open; \
                 `target: pose` gives the postures at which all six rows are met, and in a description without that joint {rest}"
            ));
        }
        let (turn, d) = between.before;
        (last.theta, last.d) = (sum_of_angles(&last.theta, &turn), &last.d + &d);
        let (a, alpha) = between.normal;
        self.normals.push(Normal { a, alpha });
        let (theta, d) = between.after;
        self.joints.push(Joint { prismatic: false, theta, d });
        self.tool = identity();
        Ok(())
    }

    /// Adds a virtual joint after the last. At its value 0 the end effector stays where it was.
    pub(super) fn virtual_at_the_end(&mut self, joint: &Virtual) {
        let Some(last) = self.joints.last_mut() else { return };
        let by = joint.d.as_ref().map_or_else(Number::zero, |d| d - &last.d);
        (last.theta, last.d) = (sum_of_angles(&last.theta, &joint.turn), &last.d + &by);
        let normal = Normal { a: joint.a.clone(), alpha: joint.alpha.clone() };
        let moved = compose(&compose(&turn_about_z(&joint.turn), &slide_along_z(&by)), &normal.frame(false));
        self.tool = compose(&inverse(&moved), &self.tool);
        self.normals.push(normal);
        self.joints.push(Joint { prismatic: joint.prismatic, theta: no_turn(), d: Number::zero() });
        self.still += 1;
    }

    /// Every length in it, with signs.
    pub(super) fn lengths(&self) -> Vec<Number> {
        let mut lengths: Vec<Number> = self.normals.iter().map(|n| n.a.clone()).collect();
        lengths.extend(self.joints.iter().map(|j| j.d.clone()));
        lengths.extend(self.between.iter().flat_map(|(joint, behind)| [joint.d.clone(), behind.a.clone()]));
        lengths.extend([&self.base, &self.tool].into_iter().flat_map(|f| f.iter().map(|row| row[3].clone())));
        lengths
    }

    /// Whether all revolute axes are parallel to an axis of the base frame.
    pub(super) fn turns_about(&self, axis: usize) -> bool {
        let mut at = self.base.clone();
        for (i, joint) in self.joints.iter().enumerate() {
            let along = (0..3).all(|k| k == axis || is_zero(&at[k][2]));
            if !joint.prismatic && !along {
                return false;
            }
            // A revolute joint about the axis does not change directions of later axes relative to the axis, so q = 0 serves.
            at = compose(&at, &turn_about_z(&joint.theta));
            if let Some(normal) = self.normals.get(i) {
                at = compose(&at, &normal.frame(false));
            }
        }
        true
    }

    /// The loop from joint `start` on.
    pub(super) fn arranged(&self, start: usize, backward: bool) -> Arrangement {
        let n = self.joints.len();
        let order: Vec<usize> = (0..n).map(|i| if backward { (start + n - i) % n } else { (start + i) % n }).collect();
        let last = if backward { 0 } else { n - 1 };
        let open = order.iter().position(|joint| *joint == last).unwrap_or(n - 1);
        let left = |joint: &Joint| if joint.prismatic { turn_about_z(&joint.theta) } else { slide_along_z(&joint.d) };
        let normal = |joint: usize| if backward { joint - 1 } else { joint };
        // The given joint is between the remaining joints `left_out` - 1 and `left_out`.
        let between = self.between.as_ref().zip(self.left_out);
        let place = between
            .and_then(|(_, given)| order.iter().enumerate().position(|(p, joint)| p != open && normal(*joint) + 1 == given));
        let link = |(place, &joint): (usize, &usize)| {
            if place == open {
                return identity();
            }
            compose(&left(&self.joints[joint]), &self.normals[normal(joint)].frame(backward))
        };
        let mut links: Vec<Frame> = order.iter().enumerate().map(link).collect();
        let given = place.zip(between).map(|(place, ((given, behind), joint))| {
            let here = &self.joints[order[place]];
            let (first, second) = if backward { (behind, &self.normals[joint - 1]) } else { (&self.normals[joint - 1], behind) };
            let before = compose(&compose(&left(here), &first.frame(backward)), &given.own());
            links[place] = identity();
            Given { joint, place: Some(place), prismatic: given.prismatic, before, after: second.frame(backward) }
        });
        let (before, after) = if backward {
            let flip = half_turn_about_x();
            (compose(&flip, &inverse(&self.base)), compose(&inverse(&self.tool), &flip))
        } else {
            (self.tool.clone(), self.base.clone())
        };
        let offset = |joint: &Joint| match joint.prismatic {
            true => [joint.d.clone(), Number::zero()],
            false => joint.theta.clone(),
        };
        Arrangement {
            prismatic: order.iter().map(|joint| self.joints[*joint].prismatic).collect(),
            links,
            open,
            before: compose(&left(&self.joints[last]), &before),
            after,
            backward,
            offsets: order.iter().map(|joint| offset(&self.joints[*joint])).collect(),
            order,
            left_out: self.left_out,
            still: self.still,
            given,
        }
    }

    /// Every way round the loop: by start, forwards before backwards.
    pub(super) fn arrangements(&self) -> impl Iterator<Item = Arrangement> + '_ {
        (0..self.joints.len()).flat_map(|start| [false, true].map(|backward| self.arranged(start, backward)))
    }
}

impl Joint {
    /// Rz(theta) Tz(d).
    fn own(&self) -> Frame {
        compose(&turn_about_z(&self.theta), &slide_along_z(&self.d))
    }
}

impl Arrangement {
    /// The number in the arm, from 1, of one of the joints that are left.
    pub(super) fn number(&self, joint: usize) -> usize {
        joint + 1 + usize::from(self.left_out.is_some_and(|left_out| joint >= left_out))
    }

    /// Whether the link at a place is a constant: it depends neither on the pose nor on the joint that is given.
    pub(super) fn is_constant(&self, place: usize) -> bool {
        place != self.open && self.given.as_ref().is_none_or(|given| given.place != Some(place))
    }
}

impl Normal {
    /// Tx(a) Rx(alpha), or as the loop run backwards meets it.
    fn frame(&self, backward: bool) -> Frame {
        let ([c, s], mut frame) = (&self.alpha, identity());
        let (a, s) = if backward { (-&self.a, -s) } else { (self.a.clone(), s.clone()) };
        frame[0][3] = a;
        (frame[1][1], frame[1][2], frame[2][1], frame[2][2]) = (c.clone(), -&s, s, c.clone());
        frame
    }
}

/// Tx(a) Rx(alpha) Rz(theta) Tz(d), taken apart.
fn normal_and_joint(f: &Frame) -> Option<(Normal, [Number; 2], Number)> {
    let (sine, cosine) = (-&f[1][2], f[2][2].clone());
    let d = &(&cosine * &f[2][3]) + &(&sine * &-&f[1][3]);
    let left = [f[0][2].clone(), &f[1][3] + &(&sine * &d), &f[2][3] - &(&cosine * &d)];
    let fits = left.iter().all(is_zero);
    let normal = Normal { a: f[0][3].clone(), alpha: [cosine, sine] };
    fits.then(|| (normal, [f[0][0].clone(), -&f[0][1]], d))
}
