// A joint too many, whose value is given.
//
// With T = C0 J1 C1 ... Jn Cn and a given q, T = A G for G = C J(q) C' at the arm's end, or T = G A at its base: the other joints reach A.
// Between two other joints, G is the link from the one to the other.

/// A joint whose value is given, with what is constant before and behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Its number in the arm, from 0.
    pub joint: usize,
    /// Whether it slides.
    pub prismatic: bool,
    /// From the joint before it in the loop, or the base.
    pub before: Frame,
    /// To the joint behind it, or the end effector.
    pub after: Frame,
}

impl Given {
    /// Its value: (cos q, sin q) or (q, 0).
    #[inline]
    pub fn value(&self, q: Real) -> [Real; 2] {
        if self.prismatic {
            [q, 0.0]
        } else {
            let (c, s) = cos_sin(q);
            [c, s]
        }
    }

    /// The link that it moves.
    #[inline]
    pub fn link(&self, value: [Real; 2]) -> Frame {
        compose(&self.before, &joint_then(self.prismatic, value, &self.after))
    }

    /// The pose that the other joints have to reach, where it is the first or the last one.
    #[inline]
    pub fn rest(&self, value: [Real; 2], t: &Frame) -> Frame {
        let back = inverse(&self.link(value));
        if self.joint == 0 {
            compose(&back, t)
        } else {
            compose(t, &back)
        }
    }

    /// Solutions of the other I joints as solutions of all J = I + 1.
    pub fn with<const I: usize, const J: usize, const N: usize>(&self, found: &Branches<I, N>, value: [Real; 2]) -> Branches<J, N> {
        let mut all = Branches { miss: found.miss, near: found.near, continuum: found.continuum, ..Branches::new() };
        for branch in found.found() {
            let mut joints = [value; J];
            for (place, known) in branch.joints.iter().enumerate() {
                if let Some(joint) = joints.get_mut(if place < self.joint { place } else { place + 1 }) {
                    *joint = *known;
                }
            }
            let before = (1 << self.joint) - 1;
            let free = branch.free & before | (branch.free & !before) << 1;
            all.add(Branch { joints, signs: branch.signs, double: branch.double, error: branch.error, free });
        }
        all
    }
}
