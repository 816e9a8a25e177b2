//! The users' test file, run from the users' side: in a separate project.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::kinds::Scalar;
use armgen_codegen::source::Source;
use armgen_verify::test_kit;

/// A user's project: the module next to its crate root, the test file in `tests`.
fn project(name: &str, module: &str, tests: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("test-kit").join(name);
    std::fs::create_dir_all(folder.join("src")).expect("a folder");
    std::fs::create_dir_all(folder.join("tests")).expect("a folder");
    let manifest = format!(
        "[package]\nname = \"user-{name}\"\nversion = \"0.1.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n"
    );
    std::fs::write(folder.join("Cargo.toml"), manifest).expect("written");
    std::fs::write(folder.join("src/lib.rs"), "pub mod robot;\n").expect("written");
    std::fs::write(folder.join("src/robot.rs"), module).expect("written");
    std::fs::write(folder.join("tests/robot.rs"), tests).expect("written");
    folder
}

/// The output of `cargo test` in it, and whether it passed.
fn run(folder: &Path) -> (bool, String) {
    let output = Command::new(env!("CARGO"))
        .args(["test", "--offline", "--quiet"])
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("test-kit/target"))
        .env("RUSTFLAGS", "-D warnings")
        .output()
        .expect("cargo runs");
    let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    (output.status.success(), text)
}

fn check(name: &str, scalar: Scalar) {
    check_source(name, &common::source(name), scalar);
}

fn check_source(name: &str, source: &Source, scalar: Scalar) {
    let module = common::generate(source, scalar).module;
    let word = format!("{scalar:?}").to_lowercase();
    let crate_name = format!("{}-{word}", name.replace('_', "-"));
    let import = format!("use user_{}::robot;", crate_name.replace('-', "_"));
    let tests = test_kit(source, &module, &import).expect("a test file");
    let (passed, text) = run(&project(&crate_name, &module, &tests));
    assert!(passed, "{name} {scalar:?}:\n{text}");
}

#[test]
#[ignore = "wide"]
fn the_test_file_passes_in_a_project_of_its_own() {
    for name in ["scara", "panda7", "everything", "base_set"] {
        check(name, Scalar::F64);
    }
    check("scara", Scalar::F32);
    check("panda7", Scalar::F32);
    let mounted = Source::new("mounted.yaml", include_str!("../../tests/data/mounted.yaml"));
    check_source("mounted", &mounted, Scalar::F64);
}

#[test]
#[ignore = "wide"]
fn the_test_file_finds_a_planted_error() {
    let source = common::source("scara4");
    let module = common::generate(&source, Scalar::F64).module;
    let tests = test_kit(&source, &module, "use user_planted::robot;").expect("a test file");
    for (function, good, bad) in [("gravity", "98.1", "98.2"), ("forward_dynamics_derivatives", " + ", " - ")] {
        let at = module.find(&format!("pub fn {function}(")).expect("a function");
        let broken = module[..at].to_string() + &module[at..].replacen(good, bad, 1);
        assert_ne!(broken, module);
        let (passed, text) = run(&project("planted", &broken, &tests));
        assert!(!passed && text.contains(&format!("{function} at state 0")), "{text}");
    }
}
