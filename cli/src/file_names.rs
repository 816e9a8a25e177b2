//! Valid names for the file of a module. In its language the file names the module, and not every name is valid.

use std::path::Path;

use armgen_codegen::emit::Language;
use armgen_texts::module::file_of;

/// Words of Python, which `import` takes for no name.
const PYTHON: [&str; 35] = [
    "False", "None", "True", "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else",
    "except", "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise",
    "return", "try", "while", "with", "yield",
];
/// Names that the module, its test, its library and the arrays of its callers import: Python would find a file of this name first.
const IMPORTED: [&str; 18] = [
    "ctypes",
    "cupy",
    "hashlib",
    "importlib",
    "jax",
    "math",
    "numpy",
    "os",
    "pathlib",
    "platform",
    "pytest",
    "shlex",
    "shutil",
    "subprocess",
    "sys",
    "tempfile",
    "torch",
    "typing",
];
/// Words of MATLAB and of Octave.
const MATLAB: [&str; 41] = [
    "__FILE__",
    "__LINE__",
    "break",
    "case",
    "catch",
    "classdef",
    "continue",
    "do",
    "else",
    "elseif",
    "end",
    "end_try_catch",
    "end_unwind_protect",
    "endarguments",
    "endclassdef",
    "endenumeration",
    "endevents",
    "endfor",
    "endfunction",
    "endif",
    "endmethods",
    "endparfor",
    "endproperties",
    "endspmd",
    "endswitch",
    "endwhile",
    "for",
    "function",
    "global",
    "if",
    "otherwise",
    "parfor",
    "persistent",
    "return",
    "spmd",
    "switch",
    "try",
    "until",
    "unwind_protect",
    "unwind_protect_cleanup",
    "while",
];
/// Headers of the C library that a header includes.
const INCLUDED: [&str; 6] = ["float", "math", "stdbool", "stddef", "stdint", "string"];
/// MATLAB reads so many characters of a name.
const LONGEST: usize = 63;

/// Why no module of a language can be called so, and what to write instead.
pub(crate) fn unfit(language: Language, out: &Path) -> Option<String> {
    let title = language.title();
    let shown = out.display();
    let name = out.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = out.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let instead = |stem: &str| format!("write `--out {}`", file_of(language, stem));
    if let Some(extension) = out.extension().and_then(|extension| extension.to_str()) {
        if let Some(other) = Language::of_extension(extension).filter(|other| *other != language) {
            return Some(format!(
                "{shown} is a file of {}, and the module is in {title}: write `--language {}` or `--out {}`",
                other.title(),
                other.name(),
                file_of(language, "robot")
            ));
        }
        let taken = match language {
            // A text to be included may be called as its reader likes.
            Language::Rust | Language::C | Language::Cuda | Language::Matlab => None,
            Language::JavaScript => Some("Node takes a module with `export` from .mjs, or .js"),
            Language::Python => Some("`import` looks for .py"),
        };
        if let Some(why) = taken.filter(|_| !language.extensions().contains(&extension)) {
            return Some(format!("{shown} could not be imported, since {why}: {}", instead(&stem)));
        }
    }
    match language {
        Language::Rust | Language::Cuda | Language::JavaScript => None,
        Language::C => (INCLUDED.contains(&stem.as_str()) && name == format!("{stem}.h"))
            .then(|| format!("{shown} would be found in place of <{stem}.h> of the C library: {}", instead("robot"))),
        Language::Python if PYTHON.contains(&stem.as_str()) => {
            Some(format!("`{stem}` is a word of Python, and no module can be imported by it: {}", instead(&format!("{stem}_"))))
        }
        Language::Python => IMPORTED
            .contains(&stem.as_str())
            .then(|| format!("{shown} would be imported in place of the library `{stem}`: {}", instead("robot"))),
        Language::Matlab => {
            let package = name.strip_prefix('+').unwrap_or_default();
            let fits = package.starts_with(|c: char| c.is_ascii_alphabetic())
                && package.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
                && package.len() <= LONGEST;
            if !fits {
                return Some(format!(
                    "`{name}` is no package of MATLAB, a folder whose name is `+` and a name of at most {LONGEST} letters, digits and `_`, a \
                     letter first: {}",
                    instead("robot")
                ));
            }
            MATLAB.contains(&package).then(|| {
                format!(
                    "`{package}` is a word of MATLAB or Octave, and no package can be called by it: {}",
                    instead(&format!("{package}_"))
                )
            })
        }
    }
}
