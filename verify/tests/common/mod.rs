//! The robots of the project.

use std::path::PathBuf;

use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::Generated;

/// All descriptions of the project, sorted.
pub(crate) fn paths() -> Vec<PathBuf> {
    in_folders(&["robots", "tests/robots"])
}

fn in_folders(folders: &[&str]) -> Vec<PathBuf> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let mut paths: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(format!("{root}/{folder}")).expect("a folder of robots"))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        .collect();
    paths.sort();
    paths
}

/// Descriptions designed to stress armgen.
pub(crate) fn hostile_paths() -> Vec<PathBuf> {
    in_folders(&["tests/robots/hostile"])
}

/// A description of the project by name.
pub(crate) fn source(name: &str) -> Source {
    let path = paths()
        .into_iter()
        .chain(hostile_paths())
        .find(|p| p.file_stem().is_some_and(|stem| stem == name))
        .expect("a robot of the project");
    Source::new(format!("{name}.yaml"), std::fs::read_to_string(path).expect("a description"))
}

/// The generated module of a description.
pub(crate) fn generate(source: &Source, scalar: Scalar) -> Generated {
    #[allow(clippy::needless_update)]
    generate_with(source, &Options { scalar, ..Options::default() })
}

/// The generated module with these options.
pub(crate) fn generate_with(source: &Source, options: &Options) -> Generated {
    let (generated, diagnostics) = armgen_codegen::generate(source, options);
    generated.unwrap_or_else(|| panic!("{diagnostics:?}"))
}
