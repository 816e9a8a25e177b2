//! The kinds of faults specific to paths and trajectories; [`armgen_codegen::diagnostic::Code`] has those of keys, numbers and YAML.

armgen_codegen::codes! {
    /// Kinds of faults of paths and trajectories.
    pub(crate) enum Code {
        /// Neither points nor pieces, or both.
        MissingPath Error "missing-path",
        /// A word outside the allowed set.
        UnknownWord Error "unknown-word",
        /// A limit for a joint that the description does not have.
        UnknownJoint Error "unknown-joint",
        /// A limit or a distance that is not above zero.
        NotPositive Error "limit-not-positive",
        /// A speed at an end of the path that is negative.
        NegativeSpeed Error "negative-speed",
        /// A knot that is not above the one before it.
        KnotOrder Error "knot-order",
        /// Joint values that are not continuous at a knot.
        Jump Error "jump",
        /// A direction that is not continuous at a knot.
        Corner Error "corner",
        /// Two equal points, or a piece in which nothing moves.
        ZeroLength Error "zero-length",
        /// An arc through three positions on a line.
        NoCircle Error "no-circle",
        /// All joints come to rest inside the path.
        TurningBack Error "turning-back",
        /// A joint leaves its range.
        OutsideLimits Error "outside-limits",
        /// A joint moves that has neither a limit of speed nor one of torque.
        MissingLimit Error "missing-limit",
        /// At some place no motion keeps the limits.
        InfeasiblePoint Error "infeasible-point",
        /// The path cannot be got through from the speed at its start.
        InfeasibleSpeed Error "infeasible-speed",
        /// The torque that holds the arm at the end is beyond its limit.
        EndNotHeld Error "end-not-held",
        /// No motion was found, and none was proved to be impossible.
        TooCoarse Error "too-coarse",
        /// The torque that holds the arm at the start is beyond its limit.
        StartNotHeld Warning "start-not-held",
        /// On the path of the tip J has no inverse.
        Singular Error "singular",
        /// No joint values on this branch reach the tip's path.
        Unreachable Error "unreachable",
        /// No joint spline comes as near to the tip's path as wished.
        Tolerance Error "tolerance",
        /// The segments are used up before the gap is as small as wished.
        Gap Warning "gap",
        /// A place that the motion passes far more slowly than those around it.
        SlowPoint Warning "slow-point",
        /// The path names another robot.
        OtherRobot Warning "other-robot",
    }
}
