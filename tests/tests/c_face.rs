//! The C interface in a project of its own: a static library of its own without `std`, and a C program that links it and checks values.

use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::{generate, source::Source, Generated};
use armgen_tests::signatures::of_module;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const CARGO_TOML: &str = r#"
[package]
name = "robot"
edition = "2021"

[lib]
crate-type = ["staticlib"]

[dependencies]
libm = "0.2"

[profile.release]
panic = "abort"
lto = true

[workspace]
"#;

const LIB_RS: &str = r#"
#![no_std]

mod robot {
    include!("robot.rs");
    include!("robot_c.rs");
}

mod robot_ik {
    include!("robot_ik.rs");
    include!("robot_ik_c.rs");
}

mod redundant_ik {
    include!("redundant_ik.rs");
    include!("redundant_ik_c.rs");
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
"#;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn generate_of(robot: &str, scalar: Scalar, functions: Selection) -> Generated {
    let path = root().join("robots").join(robot);
    let source = Source::new(robot.to_string(), fs::read_to_string(path).unwrap());
    generate(&source, &Options { scalar, functions, ..Options::default() }).0.unwrap()
}

/// Runs a command; panics with its output if it failed or warned.
#[track_caller]
fn run(command: &mut Command) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && !err.contains("warning"), "{command:?}: {}\n{out}{err}", output.status);
}

/// Names of the functions that a header declares.
fn declared(header: &str) -> Vec<&str> {
    let starts = header.lines().filter(|line| line.ends_with('(') && !line.starts_with(' '));
    starts.map(|line| line.trim_end_matches('(').rsplit(' ').next().unwrap()).collect()
}

/// Builds the library in a folder of its own, and runs the programs of tests/c against it.
#[track_caller]
fn check(robot: &str, scalar: Scalar, folder: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("src")).unwrap();
    let generated = generate_of(robot, scalar, Selection::default());
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("Cargo.toml", CARGO_TOML);
    write("src/lib.rs", LIB_RS);
    write("src/robot.rs", &generated.module);
    write("src/robot_c.rs", &generated.c.wrappers);
    write("robot.h", &generated.c.header);
    let inverse_kinematics = generated.solvers().next().expect("an end effector").for_c().expect("the SCARA has a construction");
    write("src/robot_ik.rs", &generated.inverse_kinematics());
    write("src/robot_ik_c.rs", &inverse_kinematics.wrappers);
    write("robot_ik.h", &inverse_kinematics.header);
    let panda7 = generate_of("panda7.yaml", scalar, Selection::named(["direct_kinematics"]).expect("a function"));
    let redundant = panda7.solvers().next().expect("an end effector").for_c().expect("the Panda has a construction");
    write("src/redundant_ik.rs", &panda7.inverse_kinematics());
    write("src/redundant_ik_c.rs", &redundant.wrappers);
    write("redundant_ik.h", &redundant.header);
    // Every function that the header declares has to be there to be linked, whether check.c calls it or not.
    let functions = declared(&generated.c.header);
    assert_eq!(functions.len(), of_module(&generated.module).len());
    let table: String = functions.iter().map(|name| format!("    (any){name},\n")).collect();
    write("all.c", &format!("#include \"robot.h\"\ntypedef void (*any)(void);\nextern any all[];\nany all[] = {{\n{table}}};\n"));
    run(Command::new(env!("CARGO"))
        .args(["build", "--release", "--offline", "--quiet"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env_remove("RUSTFLAGS"));
    run(Command::new("cc")
        .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-I.", "-o", "check", "all.c"])
        .arg(root().join("tests/c/check.c").canonicalize().unwrap())
        .args(["target/release/librobot.a", "-lm"])
        .current_dir(&folder));
    run(&mut Command::new(folder.join("check")));
    run(Command::new("cc")
        .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-I.", "-o", "check_ik"])
        .arg(root().join("tests/c/check_ik.c").canonicalize().unwrap())
        .args(["target/release/librobot.a", "-lm"])
        .current_dir(&folder));
    run(&mut Command::new(folder.join("check_ik")));
    run(Command::new("cc")
        .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-I.", "-o", "check_redundant"])
        .arg(root().join("tests/c/check_redundant.c").canonicalize().unwrap())
        .args(["target/release/librobot.a", "-lm"])
        .current_dir(&folder));
    run(&mut Command::new(folder.join("check_redundant")));
    // C++ reads the same header.
    if armgen_tests::installed::there("c++", "g++") {
        write("header.cpp", "#include \"robot.h\"\n#include \"robot_ik.h\"\n");
        run(Command::new("c++").args(["-Wall", "-Wextra", "-Werror", "-fsyntax-only", "header.cpp"]).current_dir(&folder));
    }
}

#[test]
#[ignore = "wide"]
fn a_c_program_links_and_finds_the_values_of_the_scara() {
    check("scara.yaml", Scalar::F64, "c_face_f64");
    check("scara.yaml", Scalar::F32, "c_face_f32");
}

/// The program that prints what C should, and the library that C links. Without `std` there is no allocator, and a panic that can be reached
/// would need a function that is nowhere.
const LAWS_TOML: &str = r#"
[package]
name = "laws"
edition = "2021"
KIND

[dependencies]
armgen-runtime = { path = "RUNTIME" }
libm = "0.2"
nalgebra = { version = "0.35", default-features = false }

[profile.release]
panic = "abort"
lto = true
codegen-units = 1

[workspace]
"#;

const LAWS_RS: &str = r#"
#![no_std]

#[allow(dead_code)]
mod robot {
    include!("robot.rs");
    include!("robot_runtime.rs");
    include!("robot_laws_c.rs");
}

extern "C" {
    fn a_panic_can_be_reached() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe { a_panic_can_be_reached() }
}
"#;

/// Torques and anchors of hand guiding and impedance, all their parts, and faults.
#[test]
#[ignore = "wide"]
fn laws_in_c_have_the_bits_of_the_runtime() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c_laws");
    let _ = fs::remove_dir_all(&folder);
    let generated = generate_of("scara.yaml", Scalar::F64, Selection::default());
    let laws = generated.laws_for_c("robot.h").expect("an arm with dynamics and one end effector");
    let runtime = root().join("runtime").canonicalize().unwrap();
    for (package, kind, main) in [
        ("library", "[lib]\ncrate-type = [\"staticlib\"]", ("lib.rs", LAWS_RS.to_owned())),
        ("expected", "", ("main.rs", fs::read_to_string(root().join("tests/c/laws.rs")).unwrap())),
    ] {
        let package = folder.join(package);
        fs::create_dir_all(package.join("src")).unwrap();
        let write = |name: &str, text: &str| fs::write(package.join(name), text).unwrap();
        let toml = LAWS_TOML.replace("KIND", kind).replace("RUNTIME", runtime.to_str().unwrap());
        write("Cargo.toml", &toml);
        fs::copy(root().join("Cargo.lock"), package.join("Cargo.lock")).unwrap();
        write("src/robot.rs", &generated.module);
        write("src/robot_runtime.rs", &generated.runtime);
        write("src/robot_laws_c.rs", &laws.wrappers);
        write(&format!("src/{}", main.0), &main.1);
        run(Command::new(env!("CARGO"))
            .args(["build", "--release", "--offline", "--quiet"])
            .current_dir(&package)
            .env("CARGO_TARGET_DIR", folder.join("target"))
            .env_remove("RUSTFLAGS"));
    }
    fs::write(folder.join("robot.h"), &generated.c.header).unwrap();
    fs::write(folder.join("robot_laws.h"), &laws.header).unwrap();
    run(Command::new("cc")
        .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-I.", "-o", "check"])
        .arg(root().join("tests/c/laws.c").canonicalize().unwrap())
        .args(["target/release/liblaws.a", "-lm"])
        .current_dir(&folder));
    let printed = |program: PathBuf| {
        let output = Command::new(&program).output().unwrap_or_else(|error| panic!("{program:?}: {error}"));
        assert!(output.status.success(), "{program:?}: {}", output.status);
        String::from_utf8(output.stdout).unwrap()
    };
    let expected = printed(folder.join("target/release/laws"));
    assert_eq!(expected.lines().count(), 34);
    assert_eq!(printed(folder.join("check")), expected);
    if armgen_tests::installed::there("c++", "g++") {
        fs::write(folder.join("header.cpp"), "#include \"robot_laws.h\"\n").unwrap();
        run(Command::new("c++").args(["-Wall", "-Wextra", "-Werror", "-fsyntax-only", "header.cpp"]).current_dir(&folder));
    }
}

/// The macros of a header that callers see, each once, with their values; `SAME_BITS` has two.
fn macros(header: &str, own: &str) -> BTreeMap<String, String> {
    const INNER: [&str; 8] = ["UNFUSED", "INLINE", "SIN(x)", "COS(x)", "VECTOR_LANES", "VECTOR_AT(from)", "SAME_BITS", "LANES"];
    let defined = header.lines().filter_map(|line| line.strip_prefix(&format!("#define {own}_")));
    let defined = defined.map(|line| line.split_once(' ').unwrap_or((line, "")));
    let seen = defined.filter(|(name, _)| !INNER.contains(name) && !name.starts_with("IK_"));
    seen.map(|(name, value)| (name.to_string(), value.to_string())).collect()
}

/// A caller can go from the header with the functions themselves to that of the module in Rust, and back.
#[test]
fn both_headers_have_the_same_macros_and_declarations() {
    for (robot, own) in [("scara.yaml", "SCARA"), ("panda7.yaml", "PANDA7")] {
        let generated = generate_of(robot, Scalar::F64, Selection::default());
        let inverse_kinematics = generated.solvers().next().expect("an end effector").for_c().expect("a construction").header;
        let standalone = [generated.in_language(Language::C), generated.inverse_kinematics_in_c().expect("a construction")];
        let of_rust = [generated.c.header, inverse_kinematics];
        for (k, (standalone, of_rust)) in standalone.iter().zip(&of_rust).enumerate() {
            assert_eq!(macros(standalone, own), macros(of_rust, own), "{robot} {k}");
            assert!(k == 1 || [standalone, of_rust].iter().all(|text| text.contains(&format!("#define {own}_SAME_BITS 1\n"))));
            let defined = standalone.replace("static inline ", "").replace("\n{", ";");
            let declared = of_rust.split(";\n").filter_map(|piece| piece.rsplit("*/\n").next());
            let declared: Vec<&str> = declared.filter(|declared| declared.contains('(')).collect();
            assert!(declared.len() > [20, 2][k], "{robot}: {declared:?}");
            for declared in declared {
                assert!(defined.contains(&format!("{declared};")), "{robot}: {declared}");
            }
        }
    }
}

/// The wrappers are the only emitted text with `unsafe`, and each block of it gives its reason.
#[test]
fn unsafe_is_confined_and_explained() {
    for robot in ["scara.yaml", "ur5.yaml"] {
        let generated = generate_of(robot, Scalar::F64, Selection::default());
        assert!(!generated.module.contains("unsafe") && !generated.runtime.contains("unsafe"));
        assert!(!generated.inverse_kinematics().contains("unsafe"));
        let laws = generated.laws_for_c("robot.h").expect("an arm with dynamics").wrappers;
        let wrappers = generated.c.wrappers.clone()
            + &laws
            + &generated.solvers().next().expect("an end effector").for_c().expect("a construction").wrappers;
        let lines: Vec<&str> = wrappers.lines().collect();
        let blocks = lines.iter().enumerate().filter(|(_, line)| line.contains("unsafe {"));
        for (at, line) in blocks {
            assert!(lines[at - 1].trim_start().starts_with("// SAFETY: "), "line {}: {line}", at + 1);
        }
        assert!(lines.iter().filter(|line| line.contains("unsafe extern")).count() > 20);
    }
}
