// One way round the loop that an arm and a pose close.
//
// T = C0 J1 C1 ... Jn Cn is the loop J1 L1 J2 L2 ... Jn Ln = 1 with Li = Ci for i < n and Ln = Cn T⁻¹ C0. It may be read from any joint on, and
// backwards, since Rz(-q) = F Rz(q) F and Tz(-q) = F Tz(q) F with the half turn F about x: then the links are F Li⁻¹ F.
// A constant link between two revolute joints is Rz(theta) Tz(d) Tx(a) Rx(alpha) Rz(theta') Tz(d'); its turns are added to the joints' angles, its slide d'
// goes into the next link, and what is left is the form Tz(d) Tx(a) Rx(alpha) that the blocks ask for.

/// An arrangement of an arm's loop: its constants, the pose left open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrangement<const J: usize> {
    /// The number of each joint in the arm, from 0, in the order in which the loop meets them.
    pub order: [usize; J],
    /// Their kinds, in the loop's order.
    pub prismatic: [bool; J],
    /// L1 to LJ in the loop's order; that of place `open` is not read.
    pub links: [Frame; J],
    /// The place of the link that depends on the pose.
    pub open: usize,
    /// It is `before` X `after`, where X is T⁻¹, or T if the loop is read `backward`.
    pub before: Frame,
    /// See `before`.
    pub after: Frame,
    /// Read against the arm's direction.
    pub backward: bool,
    /// What the loop's joint values have more than the arm's: (cos theta, sin theta), or (d, 0).
    pub offsets: [[Real; 2]; J],
}

impl<const J: usize> Arrangement<J> {
    /// The links for a pose.
    #[inline]
    pub fn links_at(&self, t: &Frame) -> [Frame; J] {
        let x = if self.backward { *t } else { inverse(t) };
        let mut links = self.links;
        if let Some(open) = links.get_mut(self.open) {
            *open = compose_constant(&self.before, &constant_then(&x, &self.after));
        }
        links
    }

    /// A solution of the loop as one of the arm: joint values and the bits of `free` in the arm's order.
    #[inline]
    pub fn of_arm(&self, branch: &Branch<J>) -> Branch<J> {
        // Most offsets are those of no turn.
        let turned = |x: Real, y: Real, co: Real, so: Real| plus_product(plus_product(-0.0, co, x), so, y);
        let mut result = *branch;
        result.free = 0;
        for (i, (place, ([c, s], prismatic))) in self.order.iter().zip(branch.joints.iter().zip(self.prismatic)).enumerate() {
            let [co, so] = self.offsets.get(i).copied().unwrap_or([1.0, 0.0]);
            if let Some(value) = result.joints.get_mut(*place) {
                *value = if prismatic { [c - co, 0.0] } else { [turned(*c, *s, co, so), turned(*s, *c, co, -so)] };
                result.free |= (branch.free >> i & 1) << place;
            }
        }
        result
    }
}
