//! An arm as a chain of links and joints over a prime field: T = L0 J1 L1 ... Jn Ln.

use armgen_description::kinds::Target;
use armgen_description::manipulator::Manipulator;

use super::modular::{Frame, Modulus};
use crate::textbook::equations::arm::{self, Arm};
use crate::values::arithmetic::prime::{Prime, Residue};
use crate::values::arithmetic::Arithmetic;

/// Whether the target is a position and a direction.
pub(super) fn is_pointing(manipulator: &Manipulator) -> bool {
    manipulator.inverse_kinematics.target == Some(Target::Pointing)
}

/// The joints that move the end effector, from the base on.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) modulus: Modulus,
    pub(super) slides: Vec<bool>,
    /// Unit vectors of the axes.
    pub(super) axes: Vec<[u64; 3]>,
    /// The links, one more than the joints.
    pub(super) links: Vec<Frame>,
}

impl Chain {
    /// The arm of a description with its nominal lengths. If the target is a position and a direction, a final rotation about the z axis of the end
    /// effector follows, which leaves both unchanged.
    pub(super) fn of(manipulator: &Manipulator, field: &Prime) -> Option<Chain> {
        let arm = Arm::nominal(field, manipulator).and_then(|nominal| Arm::new(field, manipulator, &nominal))?;
        let modulus = Modulus::new(field.prime());
        let mut path = vec![arm.tips[0].link];
        while let Some(parent) = arm.joints[path[path.len() - 1]].parent {
            path.push(parent);
        }
        path.reverse();
        let one = field.integer(1);
        let mut link = arm::Frame::identity(&arm.zero, &one);
        let (mut slides, mut axes, mut links) = (Vec::new(), Vec::new(), Vec::new());
        let number = |x: &Residue| modulus.of(x.value());
        let frame = |f: &arm::Frame<Residue>| -> Frame {
            std::array::from_fn(|i| std::array::from_fn(|j| number(if j == 3 { &f.origin[i] } else { &f.rotation[i][j] })))
        };
        for joint in path.iter().map(|joint| &arm.joints[*joint]) {
            links.push(frame(&link.then(&joint.before)));
            slides.push(!joint.revolute);
            axes.push(joint.axis.each_ref().map(number));
            link = joint.after.clone();
        }
        links.push(frame(&link.then(&arm.tips[0].tool)));
        if is_pointing(manipulator) {
            slides.push(false);
            axes.push([0, 0, modulus.one]);
            links.push(modulus.identity());
        }
        Some(Chain { modulus, slides, axes, links })
    }

    /// The chain with a joint fixed at a value.
    pub(super) fn without(&self, joint: usize, value: [u64; 2]) -> Chain {
        let m = self.modulus;
        let mut rest = self.clone();
        let moved = m.joint(self.slides[joint], self.axes[joint], value);
        let behind = rest.links.remove(joint + 1);
        rest.links[joint] = m.compose(&m.compose(&self.links[joint], &moved), &behind);
        rest.slides.remove(joint);
        rest.axes.remove(joint);
        rest
    }

    pub(super) fn joints(&self) -> usize {
        self.slides.len()
    }

    /// The reversed chain, from the end effector to the base.
    pub(super) fn reversed(&self) -> Chain {
        let m = self.modulus;
        Chain {
            modulus: m,
            slides: self.slides.iter().rev().copied().collect(),
            axes: self.axes.iter().rev().map(|axis| axis.map(|x| m.negated(x))).collect(),
            links: self.links.iter().rev().map(|link| m.inverse_frame(link)).collect(),
        }
    }

    /// T for joint values: (cos q, sin q) or (q, 0).
    pub(super) fn pose(&self, values: &[[u64; 2]]) -> Frame {
        let m = self.modulus;
        let joints = self.slides.iter().zip(&self.axes).zip(values).zip(&self.links[1..]);
        joints.fold(self.links[0], |pose, (((slides, axis), value), link)| {
            m.compose(&m.compose(&pose, &m.joint(*slides, *axis, *value)), link)
        })
    }
}
