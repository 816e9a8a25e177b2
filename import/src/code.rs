//! Kinds of faults of a file to import.

use armgen_codegen::codes;

codes! {
    /// Kinds of faults of a file to import.
    pub enum Code {
        /// Not well-formed, with a document type definition, or not the root element of a robot.
        XmlSyntax Error "xml-syntax",
        /// More than an arm's file may hold.
        TooLarge Error "too-large",
        /// A macro of xacro that was not written out.
        Xacro Error "xacro",
        /// A model in the format SDF.
        Sdf Error "sdf",
        /// A part of MJCF that a description of a serial arm does not hold.
        MjcfFeature Error "mjcf-feature",
        /// A part of a URDF that is not read.
        UrdfFeature Error "urdf-feature",
        /// A class of defaults that does not exist.
        UnknownClass Error "unknown-class",
        /// An attribute that must be there is not.
        MissingAttribute Error "missing-attribute",
        /// An element that must be there is not.
        MissingElement Error "missing-element",
        /// Not a number.
        BadNumber Error "bad-number",
        /// Too few or too many numbers.
        WrongLength Error "wrong-length",
        /// NaN or an infinity.
        NotFinite Error "not-finite",
        /// A number that no float can hold.
        OutOfRange Error "out-of-range",
        /// A name given to two things of one kind.
        DuplicateName Error "duplicate-name",
        /// A link that does not exist.
        UnknownLink Error "unknown-link",
        /// A joint that does not exist.
        UnknownJoint Error "unknown-joint",
        /// Links that hang on each other in a loop.
        ClosedChain Error "closed-chain",
        /// A link that hangs on two joints.
        TwoParents Error "two-parents",
        /// No link that everything hangs on.
        NoRoot Error "no-root",
        /// Several links that hang on nothing.
        SeveralRoots Error "several-roots",
        /// The tip is not below the base.
        NotBelow Error "not-below",
        /// Nothing moves between base and tip.
        NoJoints Error "no-joints",
        /// More moving joints than can be generated.
        TooManyJoints Error "too-many-joints",
        /// Several links may be the tip.
        SeveralTips Error "several-tips",
        /// A joint that neither turns nor slides about one axis.
        UnsupportedJoint Error "unsupported-joint",
        /// A joint that follows another one as no joint of an arm can.
        Mimic Error "mimic",
        /// An axis without direction.
        ZeroAxis Error "zero-axis",
        /// A moving link without a mass distribution.
        MissingInertial Error "missing-inertial",
        /// A mass below 0.
        NegativeMass Error "negative-mass",
        /// A tensor with a negative principal moment.
        ImpossibleInertia Error "impossible-inertia",
        /// A friction coefficient below 0.
        NegativeFriction Error "negative-friction",
        /// An inertia of a joint below 0.
        NegativeArmature Error "negative-armature",
        /// Position limits that hold no interval.
        EmptyLimits Error "empty-limits",
        /// An arm that has no equations, or whose common normals are too complex: no rows of Denavit and Hartenberg.
        NoRows Error "no-rows",
        /// A value of `--lock` that is no expression.
        BadLock Error "bad-lock",

        /// A tensor element that the file does not give.
        MissingElementOfInertia Warning "incomplete-inertia",
        /// A tensor that no body has, taken as written.
        InertiaAsWritten Warning "inertia-as-written",
        /// A limit of 0, which is taken as unknown.
        ZeroLimit Warning "zero-limit",
        /// A velocity limit of 100, 1000 and so on, which is taken as unknown, or position limits beyond any arm, which are taken as none.
        PlaceholderLimit Warning "placeholder-limit",
        /// Limits of a joint that follows another one, which are narrower than those of that one, or allow it no motion.
        FollowerLimits Warning "follower-limits",
        /// A decimal that is nearly a multiple of pi/12, and taken as written.
        RoundedAngle Warning "rounded-angle",
        /// A link that is taken to have no mass.
        NoMass Warning "no-mass",
        /// A joint that is locked outside of its limits.
        LockOutside Warning "lock-outside-limits",
        /// An element that is none of the format, and nearly one.
        MisspeltElement Warning "misspelt-element",
        /// An attribute that is none of its element, and nearly one that is not there.
        MisspeltAttribute Warning "misspelt-attribute",
        /// An attribute that nothing reads, of an element that says how the arm is made.
        UnreadAttribute Warning "unread-attribute",
        /// An element that stands a second time where the first one holds.
        RepeatedElement Warning "repeated-element",
        /// A last joint that seems to open a gripper.
        FingerAsTip Warning "finger-as-tip",
        /// An arm that ends before its fingers, which rest.
        FingersAtRest Warning "fingers-at-rest",
        /// An omitted part that would change the motion.
        ChangesMotion Warning "changes-motion",
    }
}
