//! The kinds of faults that only experiments have; those of keys, numbers and YAML are [`armgen_codegen::diagnostic::Code`].

armgen_codegen::codes! {
    /// Kinds of faults of experiments and paths.
    pub enum Code {
        /// The file describes a robot, or is an experiment where a path is asked for.
        WrongFile Error "wrong-file",
        /// The file with the path cannot be read.
        UnreadablePath Error "unreadable-path",
        /// A key that has no meaning beside the others.
        OutOfPlace Error "out-of-place",
        /// Keys of two kinds where one must be chosen.
        Ambiguous Error "ambiguous",
        /// A word that is none of those that may stand there.
        UnknownWord Error "unknown-word",
        /// A number below 0.
        Negative Error "negative",
        /// A number that is 0 or below.
        NotPositive Error "not-positive",
        /// An interval that ends before it begins, or in which nothing can be.
        EmptyInterval Error "empty-interval",
        /// Keys that make no time law.
        TimeLaw Error "time-law",
        /// A segment or a turn that cannot be planned.
        Infeasible Error "infeasible",
        /// A quantity that the run does not give.
        UnknownQuantity Error "unknown-quantity",
        /// A time beyond the end of the run.
        AfterTheEnd Error "after-the-end",
        /// An expectation without a value or a bound, or with several.
        NoTarget Error "no-target",
    }
}

/// The other codes that a reader of experiments reports itself; those of YAML and of expressions come on top.
pub const SHARED: [armgen_codegen::diagnostic::Code; 14] = {
    use armgen_codegen::diagnostic::Code;
    [
        Code::EmptyFile,
        Code::UnknownKey,
        Code::MissingKey,
        Code::DuplicateKey,
        Code::WrongKind,
        Code::WrongLength,
        Code::EmptyList,
        Code::UnknownName,
        Code::BadName,
        Code::DuplicateName,
        Code::NotFinite,
        Code::OutOfRange,
        Code::DuplicateTaskRow,
        Code::UnknownParameter,
    ]
};
