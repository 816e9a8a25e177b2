//! The names of all that makes the emitted functions cheaper, so that each can be switched off; `docs/passes.md` explains every one.

use armgen_algebra::optimise::Rewrite;

/// A named step that makes the emitted functions cheaper and leaves their values as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Pass {
    /// Treat parallel axes in one orientation.
    ParallelAxes,
    /// Measure lengths in one of the arm's lengths.
    UnitOfLength,
    /// Choose the origins of joint frames along the joint axes.
    OriginAlongAxis,
    /// Choose the frame in which a wrench, or gravity, is projected on a joint axis.
    WrenchFrame,
    /// Keep the moment that C' needs relative to the link that it is at.
    RelativeMoment,
    /// Regroup inertial parameters that do not affect a joint with the parameters of its parent link.
    Grouping,
    /// Choose how much of each such parameter is regrouped.
    GroupingAmount,
    /// Rotate the axes of the last link towards its centre of mass.
    LastLinkRotation,
    /// Try the closed form in addition to the recursion.
    ClosedForm,
    /// Ask for the sines and cosines of sums of angles as such.
    AngleSums,
    /// Leave out what cancels in every output.
    Cancellation,
    /// Take common factors out of sums, and share partial sums and products.
    Sharing,
    /// Form a sum from another one that holds much of it.
    Sums,
    /// Compute a node from two others that are there anyway.
    Resubstitution,
}

impl Pass {
    /// All of them.
    pub const ALL: [Pass; 14] = [
        Pass::ParallelAxes,
        Pass::UnitOfLength,
        Pass::OriginAlongAxis,
        Pass::WrenchFrame,
        Pass::RelativeMoment,
        Pass::Grouping,
        Pass::GroupingAmount,
        Pass::LastLinkRotation,
        Pass::ClosedForm,
        Pass::AngleSums,
        Pass::Cancellation,
        Pass::Sharing,
        Pass::Sums,
        Pass::Resubstitution,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Pass::ParallelAxes => "parallel-axes",
            Pass::UnitOfLength => "unit-of-length",
            Pass::OriginAlongAxis => "origin-along-axis",
            Pass::WrenchFrame => "wrench-frame",
            Pass::RelativeMoment => "relative-moment",
            Pass::Grouping => "grouping",
            Pass::GroupingAmount => "grouping-amount",
            Pass::LastLinkRotation => "last-link-rotation",
            Pass::ClosedForm => "closed-form",
            Pass::AngleSums => "angle-sums",
            Pass::Cancellation => "cancellation",
            Pass::Sharing => "sharing",
            Pass::Sums => "sums",
            Pass::Resubstitution => "resubstitution",
        }
    }

    /// The pass of a name.
    pub fn named(name: &str) -> Option<Pass> {
        Pass::ALL.into_iter().find(|pass| pass.name() == name)
    }
}

/// A set of passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passes(u32);

impl Passes {
    /// No pass.
    pub const NONE: Passes = Passes(0);

    /// All passes.
    pub fn all() -> Passes {
        Pass::ALL.into_iter().collect()
    }

    /// Whether the set holds a pass.
    pub fn contains(self, pass: Pass) -> bool {
        self.0 >> pass as u32 & 1 == 1
    }

    /// Those of its passes that rewrite finished expressions.
    pub fn rewrites(self) -> Vec<Rewrite> {
        let all = [
            (Pass::AngleSums, Rewrite::AngleSums),
            (Pass::Cancellation, Rewrite::Cancellation),
            (Pass::Sharing, Rewrite::Sharing),
            (Pass::Sums, Rewrite::Sums),
            (Pass::Resubstitution, Rewrite::Resubstitution),
        ];
        all.into_iter().filter(|(pass, _)| self.contains(*pass)).map(|(_, rewrite)| rewrite).collect()
    }

    /// Adds a pass.
    pub fn insert(&mut self, pass: Pass) {
        self.0 |= 1 << pass as u32;
    }
}

impl FromIterator<Pass> for Passes {
    fn from_iter<I: IntoIterator<Item = Pass>>(passes: I) -> Passes {
        Passes(passes.into_iter().fold(0, |set, pass| set | 1 << pass as u32))
    }
}
