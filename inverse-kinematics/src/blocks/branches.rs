// Solutions on their way: what a construction hands to the next.

/// One solution of some joints of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<const J: usize> {
    /// Each joint's value: (cos q, sin q) of a revolute joint, (q, 0) of a prismatic one.
    pub joints: [[Real; 2]; J],
    /// Which way was taken where there were several: a bit or two for each block, in the order in which they were solved; 0 is its first solution.
    pub signs: u16,
    /// Two solutions meet here as far as rounding lets one tell: this one stands for both, or the other one is listed, too, as `double`.
    pub double: bool,
    /// How far rounding may have moved the angles, rad; roughly, and largest near places where solutions meet.
    pub error: Real,
    /// Bit i: joint i can move while everything that is asked for stays met; a value of it is given.
    pub free: u32,
}

/// All solutions of some joints of an arm, at most N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches<const J: usize, const N: usize> {
    /// How many of `all` count.
    pub count: usize,
    /// The solutions, in the order in which they were found.
    pub all: [Branch<J>; N],
    /// The least by which a way without solutions missed; infinite if none did.
    pub miss: Real,
    /// A change by rounding could add or take away solutions that are not in `all`.
    pub near: bool,
    /// There are solutions with joints that can move while everything stays met, beyond those in `all`.
    pub continuum: bool,
}

impl<const J: usize, const N: usize> Branches<J, N> {
    /// No solutions so far.
    #[inline]
    pub fn new() -> Self {
        let none = Branch { joints: [[1.0, 0.0]; J], signs: 0, double: false, error: 0.0, free: 0 };
        Branches { count: 0, all: [none; N], miss: Real::INFINITY, near: false, continuum: false }
    }

    /// Adds a solution, if there is room.
    #[inline]
    pub fn add(&mut self, branch: Branch<J>) {
        match self.all.get_mut(self.count) {
            Some(slot) => {
                *slot = branch;
                self.count += 1;
            }
            None => self.near = true,
        }
    }

    /// The solutions.
    #[inline]
    pub fn found(&self) -> &[Branch<J>] {
        self.all.get(..self.count).unwrap_or(&self.all)
    }

    /// Some way ended without a solution, missing by this much; 0 says that it did not.
    #[inline]
    pub fn missed(&mut self, by: Real) {
        if by > 0.0 && by < self.miss {
            self.miss = by;
        }
    }
}

impl<const J: usize, const N: usize> Default for Branches<J, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The points of [`line_and_circle`], with their number.
#[inline]
fn points(line: &LineAndCircle) -> impl Iterator<Item = (u16, [Real; 2])> + '_ {
    line.points.iter().take(line.count).enumerate().map(|(i, point)| (i as u16, *point))
}
