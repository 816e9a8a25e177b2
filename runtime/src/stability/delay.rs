//! The time from a measurement to the torque that follows from it.

/// How many samples after its measurement a torque acts; each adds `N` states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Delay(usize);

impl Delay {
    /// The torque acts at the sample from whose measurement it was computed.
    pub const NONE: Delay = Delay(0);

    /// The torque acts this many samples later.
    #[must_use]
    pub const fn samples(samples: usize) -> Self {
        Delay(samples)
    }

    /// How many samples.
    pub(super) const fn count(self) -> usize {
        self.0
    }
}
