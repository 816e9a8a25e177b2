//! The files of an emitted module.

use std::path::{Path, PathBuf};

use armgen_codegen::emit::Language;
use armgen_codegen::{Generated, Solver};

/// A file: its path, and its text.
pub type Output = (PathBuf, String);

/// The module in a language, with what always goes with it. `out` is the file, or the folder of a package of MATLAB.
pub fn files(generated: &Generated, language: Language, out: &Path) -> Vec<Output> {
    let mut files = match language {
        Language::Matlab => generated.package().into_iter().map(|file| (out.join(file.name), file.text)).collect(),
        language => vec![(out.to_path_buf(), generated.in_language(language))],
    };
    if language == Language::JavaScript {
        let extension = if out.extension().is_some_and(|extension| extension == "js") { "d.ts" } else { "d.mts" };
        files.push((out.with_extension(extension), generated.declarations()));
    }
    files
}

/// Inverse kinematics of an end effector beside the module `out`: a header for a header, else a module of Rust.
///
/// # Errors
/// A fault of this program.
pub fn inverse_kinematics(solver: &Solver<'_>, language: Language, out: &Path) -> Result<Output, String> {
    let file = |ending: &str| beside(out, &format!("{}_ik.{ending}", solver.infix()));
    Ok(match language.is_c() {
        true => (file("h"), solver.in_c()?),
        false => (file("rs"), solver.text()),
    })
}

/// The name of a file of a language, or of a folder.
pub fn file_of(language: Language, stem: &str) -> String {
    match language {
        Language::Matlab => format!("+{stem}"),
        language => format!("{stem}.{}", language.extensions()[0]),
    }
}

/// A companion of the file `out`, named after it.
pub fn beside(out: &Path, ending: &str) -> PathBuf {
    out.with_file_name(stem(out) + ending)
}

/// The name of a file without its extension.
pub fn stem(out: &Path) -> String {
    out.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
