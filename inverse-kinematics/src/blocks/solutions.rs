// Postures of the arm of an emitted module.
// The module says before: DOF, MAX_SOLUTIONS, PRISMATIC: [bool; DOF], POSITION_LIMITS: [[Real; 2]; DOF] (lower and upper; infinite where there is none),
// LENGTH: the arm's, m.

/// One posture of the arm.
pub type Solution = Posture<DOF>;

/// All postures of the arm at a pose.
pub type Solutions = Postures<DOF, MAX_SOLUTIONS>;

impl Solutions {
    /// The postures within `POSITION_LIMITS`, angles moved by whole turns into them: by none if that does, else by as few as possible.
    /// Rounding of the pose can move a joint variable by the root of the unit roundoff (rad; of a slide times `LENGTH`), and a pose that is no
    /// rotation by 4096 times `miss` more: so far beyond a limit it counts as within, and is put at the limit. The verdict stays what it was.
    pub fn within_limits(&self) -> Solutions {
        self.within(POSITION_LIMITS, PRISMATIC, LENGTH)
    }

    /// The posture whose largest difference from `q` is smallest, angles modulo whole turns; the first of equals. None if there is none.
    pub fn nearest_to(&self, q: &[Real; DOF]) -> Option<&Solution> {
        self.nearest(q, PRISMATIC)
    }
}
