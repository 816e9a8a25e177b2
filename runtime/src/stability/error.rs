//! Why stability could not be judged.

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StabilityError {
    /// The controller's law is singular at this posture (counted from 0).
    Singular {
        /// Index of the posture.
        posture: usize,
    },
    /// The inertia matrix of the plant is not positive definite at this posture (counted from 0).
    Inertia {
        /// Index of the posture.
        posture: usize,
    },
    /// The eigenvalues were not found: gains or model are beyond the range of the scalar.
    Eigenvalues,
    /// The sampling period is not positive and finite.
    Period,
    /// There is no posture.
    NoPosture,
    /// The controller's law is singular at this sample of a motion (counted from 0).
    SingularAtSample {
        /// Index of the sample.
        sample: usize,
    },
    /// The motion has no sample.
    NoSample,
    /// The law has no reference for this sample of the motion (counted from 0).
    NoReference {
        /// Index of the sample.
        sample: usize,
    },
}

messages! { StabilityError,
    StabilityError::Singular { posture } => "the controller's law is singular at posture {} (from 0)", posture;
    StabilityError::Inertia { posture } => "the inertia matrix of the plant is not positive definite at posture {} (from 0)", posture;
    StabilityError::Eigenvalues => "the eigenvalues were not found: gains or model are beyond the range of the scalar";
    StabilityError::Period => "the sampling period is not positive and finite";
    StabilityError::NoPosture => "there is no posture";
    StabilityError::SingularAtSample { sample } => "the controller's law is singular at sample {} (from 0) of the motion", sample;
    StabilityError::NoSample => "the motion has no sample";
    StabilityError::NoReference { sample } => "the law has no reference for sample {} (from 0) of the motion", sample;
}
