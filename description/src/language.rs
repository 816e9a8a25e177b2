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
    /// JavaScript: an ES module.
    JavaScript,
    /// Python: functions over arrays of NumPy, torch, jax and others.
    Python,
    /// MATLAB and Octave: a package, a folder with a file for each function.
    Matlab,
}

impl Language {
    /// All of them.
    pub const ALL: [Language; 5] = [Language::Rust, Language::C, Language::JavaScript, Language::Python, Language::Matlab];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Language::Rust => "rust",
            Language::C => "c",
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
            Language::JavaScript => &["mjs", "js"],
            Language::Python => &["py"],
            Language::Matlab => &["m"],
        }
    }

    /// The language of the files with an extension.
    pub fn of_extension(extension: &str) -> Option<Language> {
        Language::ALL.into_iter().find(|language| language.extensions().contains(&extension))
    }

    /// The scalars that it has.
    pub fn scalars(self) -> &'static [Scalar] {
        match self {
            Language::Rust | Language::C | Language::Python => &[Scalar::F64, Scalar::F32],
            Language::JavaScript | Language::Matlab => &[Scalar::F64],
        }
    }
}
