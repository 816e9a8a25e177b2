//! The kinds of faults specific to experiments; [`armgen_codegen::diagnostic::Code`] has those of keys, numbers and YAML.

armgen_codegen::codes! {
    /// Kinds of faults of experiments and paths.
    pub enum Code {
        /// The file describes a robot, or is an experiment in place of a path.
        WrongFile Error "wrong-file",
        /// The path file cannot be read.
        UnreadablePath Error "unreadable-path",
        /// A key without meaning in combination with the others.
        OutOfPlace Error "out-of-place",
        /// Two mutually exclusive keys.
        Ambiguous Error "ambiguous",
        /// A word outside the allowed set.
        UnknownWord Error "unknown-word",
        /// A number below 0.
        Negative Error "negative",
        /// A number that is 0 or below.
        NotPositive Error "not-positive",
        /// An interval that ends before it begins, or that contains nothing.
        EmptyInterval Error "empty-interval",
        /// Keys that define no time law.
        TimeLaw Error "time-law",
        /// A segment or a turn that cannot be planned.
        Infeasible Error "infeasible",
        /// A quantity that this run does not record.
        UnknownQuantity Error "unknown-quantity",
        /// A time beyond the end of the run.
        AfterTheEnd Error "after-the-end",
        /// An expectation without a value or a bound, or with several.
        NoTarget Error "no-target",
    }
}

/// The shared codes that the reader of experiments itself reports; YAML and expressions have further codes.
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
