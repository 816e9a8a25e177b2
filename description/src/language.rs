//! The languages that modules are printed in.

use crate::kinds::Scalar;

/// A language.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Language {
    /// Rust: the module with all its companion files.
    #[default]
    Rust,
    /// C99 and C++11: one header.
    C,
    /// CUDA and HIP: the header of C, and a kernel for each function.
    Cuda,
    /// JavaScript: an ES module.
    JavaScript,
    /// Python: functions over arrays of NumPy, torch, jax and others.
    Python,
    /// MATLAB and Octave: a package, a folder with a file for each function.
    Matlab,
}

impl Language {
    /// All of them.
    pub const ALL: [Language; 6] =
        [Language::Rust, Language::C, Language::Cuda, Language::JavaScript, Language::Python, Language::Matlab];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Language::Rust => "rust",
            Language::C => "c",
            Language::Cuda => "cuda",
            Language::JavaScript => "javascript",
            Language::Python => "python",
            Language::Matlab => "matlab",
        }
    }

    /// Its name in a sentence.
    pub fn title(self) -> &'static str {
        match self {
            Language::Rust => "Rust",
            Language::C => "C",
            Language::Cuda => "CUDA",
            Language::JavaScript => "JavaScript",
            Language::Python => "Python",
            Language::Matlab => "MATLAB",
        }
    }

    /// The extensions of its files, the usual one first.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Language::Rust => &["rs"],
            Language::C => &["h"],
            Language::Cuda => &["cuh"],
            Language::JavaScript => &["mjs", "js"],
            Language::Python => &["py"],
            Language::Matlab => &["m"],
        }
    }

    /// The language of the files with an extension.
    pub fn of_extension(extension: &str) -> Option<Language> {
        Language::ALL.into_iter().find(|language| language.extensions().contains(&extension))
    }

    /// Whether its module is the header of C, alone or with more.
    pub fn is_c(self) -> bool {
        matches!(self, Language::C | Language::Cuda)
    }

    /// The scalars that it has.
    pub fn scalars(self) -> &'static [Scalar] {
        match self {
            Language::Rust | Language::C | Language::Cuda | Language::Python => &[Scalar::F64, Scalar::F32],
            Language::JavaScript | Language::Matlab => &[Scalar::F64],
        }
    }
}
