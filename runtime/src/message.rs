//! The message of an error: a sentence for each of its cases, without an allocation.

/// `Display`, a sentence for each pattern, and `Error`.
macro_rules! messages {
    ($error:ty, $($pattern:pat => $sentence:literal $(, $argument:expr)*;)+) => {
        impl core::fmt::Display for $error {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match self {
                    $($pattern => write!(f, $sentence $(, $argument)*),)+
                }
            }
        }

        impl core::error::Error for $error {}
    };
}
