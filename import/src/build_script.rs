//! The face for a build script: a URDF instead of a description.
//!
//! ```no_run
//! // build.rs
//! let description = armgen_import::build_script::description("robot.urdf", &armgen_import::Options::default());
//! armgen_codegen::build_script::Robot::new(description).generate();
//! ```
//!
//! The script reruns when the URDF changes. A file that cannot be imported fails the build with every fault and its place; warnings become
//! warnings of the build.

use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;

use crate::{import, Options};

/// Imports the URDF in `path`, relative to the folder of the crate that is built, and gives the path of the description, which is written into
/// `OUT_DIR` under the URDF's name; or ends the build with the reason.
pub fn description(path: impl AsRef<Path>, options: &Options) -> PathBuf {
    try_description(path, options).unwrap_or_else(|error| {
        eprintln!("{error}");
        std::process::exit(1);
    })
}

/// The same for a build script that goes on.
///
/// # Errors
/// Why there is no description: every fault of the file with its place, or the file that cannot be read or written.
pub fn try_description(path: impl AsRef<Path>, options: &Options) -> Result<PathBuf, String> {
    let path = path.as_ref();
    let name = path.display();
    println!("cargo:rerun-if-changed={name}");
    let text = std::fs::read_to_string(path).map_err(|e| format!("error: cannot read {name}: {e}"))?;
    let source = Source::new(name.to_string(), text);
    let (imported, diagnostics) = import(&source, options);
    let imported = imported.ok_or_else(|| diagnostics.render(&source, Colour::Never))?;
    for warning in diagnostics.iter() {
        let place = source.place(warning.span().start);
        println!("cargo:warning={name}:{}:{}: {}", place.line, place.column, warning.message);
    }
    let out = std::env::var_os("OUT_DIR").map(PathBuf::from).ok_or("error: OUT_DIR is not set: this is for build scripts")?;
    let file = out.join(path.file_stem().unwrap_or("robot".as_ref())).with_extension("yaml");
    std::fs::write(&file, imported.yaml).map_err(|e| format!("error: cannot write {}: {e}", file.display()))?;
    Ok(file)
}
