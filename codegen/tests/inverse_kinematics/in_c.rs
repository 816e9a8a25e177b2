//! Compares inverse kinematics in C with Rust: the same verdicts, branches and bits.

use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::Scalar;

use super::arms::{coupled, few, generated, made_up, robots, workspace};

const WARNINGS: [&str; 6] = ["-Wall", "-Wextra", "-pedantic", "-Wconversion", "-Wshadow", "-Werror"];

/// Runs a command; what went wrong if it failed or warned.
#[track_caller]
fn succeed(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && !err.contains("warning"), "{command:?}: {}\n{out}{err}", output.status);
    out.into_owned()
}

fn there(compiler: &str) -> bool {
    super::installed::there(compiler, "gcc, g++, clang")
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("src")).expect("a folder can be made");
    folder
}

/// An arm with fewer joints than rows, in closed form.
const FEW: &str = "few_5r_parallel";

/// A robot, a scalar, and the modules in both languages.
struct Arm {
    name: String,
    suffix: &'static str,
    robot: String,
    ik: String,
    c: String,
}

/// The arms that have a construction, in both scalars.
fn arms(wanted: impl Fn(&str) -> bool) -> Vec<Arm> {
    let mut all = robots();
    all.extend(made_up().into_iter().map(|(name, _, _, text)| (name.to_owned(), text)));
    all.extend(few());
    all.extend(coupled().into_iter().map(|(name, _, _, text)| (name.to_owned(), text)));
    let mut arms = Vec::new();
    for (name, text) in all.into_iter().filter(|(name, _)| wanted(name)) {
        for (scalar, suffix) in [(Scalar::F64, "f64"), (Scalar::F32, "f32")] {
            let generated = generated(&name, &text, scalar);
            let c = generated.inverse_kinematics_in_c().unwrap_or_else(|reason| panic!("{name}: {reason}"));
            if c.contains("_nearest_to(") {
                let (robot, ik) = (generated.module.clone(), generated.inverse_kinematics());
                arms.push(Arm { name: name.clone(), suffix, robot, ik, c });
            }
        }
    }
    arms
}

/// Compiles both and compares their solutions at this many poses: random, on folds, out of reach, not finite.
fn compare(folder: &Path, arms: &[Arm], compilers: &[(&str, &[&str])], poses: usize) {
    let write = |path: &str, text: &str| std::fs::write(folder.join(path), text).expect("a file can be written");
    write("Cargo.lock", &std::fs::read_to_string(workspace().join("Cargo.lock")).expect("the lock file"));
    write(
        "Cargo.toml",
        "[package]\nname = \"judge\"\nversion = \"1.0.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n\n\
         [profile.dev]\nopt-level = 1\ndebug = false\nincremental = false\n",
    );
    let mut main = concat!(include_str!("compare.rs"), "\n", include_str!("random.rs")).to_owned();
    let mut checks = String::new();
    for Arm { name, suffix, robot, ik, c } in arms {
        let module = format!("{name}_{suffix}");
        write(&format!("src/{module}.rs"), robot);
        write(&format!("src/{module}_ik.rs"), ik);
        write(&format!("{module}_ik.h"), c);
        let robot = c.lines().find_map(|line| line.strip_suffix("_nearest_to(")?.rsplit(' ').next()).expect("a name");
        let (real, redundancy) =
            (if *suffix == "f64" { "double" } else { "float" }, if c.contains("_redundancy(") { "r, " } else { "" });
        write(
            &format!("{module}.c"),
            &format!(
                "#include \"{module}_ik.h\"\n#include \"{module}_ik.h\"\nvoid all_{module}(const {real} t[4][4], {real} r, {robot}_solutions *found);\n\
                 void within_{module}(const {robot}_solutions *from, {robot}_solutions *within);\n\
                 int32_t nearest_{module}(const {robot}_solutions *from, const {real} *q);\n\
                 void all_{module}(const {real} t[4][4], {real} r, {robot}_solutions *found)\n{{\n    (void)r;\n    \
                 {robot}_inverse_kinematics(t, {redundancy}found);\n}}\n\
                 void within_{module}(const {robot}_solutions *from, {robot}_solutions *within)\n{{\n    {robot}_within_limits(from, within);\n}}\n\
                 int32_t nearest_{module}(const {robot}_solutions *from, const {real} *q)\n{{\n    return {robot}_nearest_to(from, q);\n}}\n"
            ),
        );
        main += &format!("#[allow(dead_code)]\nmod {module};\n#[allow(dead_code)]\nmod {module}_ik;\n");
        let argument = if redundancy.is_empty() { "" } else { ", r" };
        checks += &format!(
            "    compare!({module}, {module}_ik, all_{module}, within_{module}, nearest_{module}, {poses}, |t: &_, r| {{\n        \
             let _ = r;\n        {module}_ik::inverse_kinematics(t{argument})\n    }});\n"
        );
    }
    main += &format!("\nfn main() {{\n{checks}}}\n");
    write("src/main.rs", &main);
    for (compiler, flags) in compilers.iter().filter(|(compiler, _)| there(compiler)) {
        let mut flagged = "-D warnings".to_owned();
        for Arm { name, suffix, .. } in arms {
            let object = folder.join(format!("{name}_{suffix}.o"));
            succeed(
                Command::new(compiler)
                    .args(["-std=c99", "-c"])
                    .args(WARNINGS)
                    .args(*flags)
                    .arg("-o")
                    .arg(&object)
                    .arg(folder.join(format!("{name}_{suffix}.c"))),
            );
            flagged += &format!(" -Clink-arg={}", object.display());
        }
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command.args(["run", "--quiet", "--offline"]).current_dir(folder).env("CARGO_TARGET_DIR", folder.join("target"));
        // The objects are others with the same names.
        let main = folder.join("src/main.rs");
        std::fs::write(&main, format!("// {compiler} {flags:?}\n{}", std::fs::read_to_string(&main).expect("the judge")))
            .expect("written");
        println!("{compiler} {flags:?}\n{}", succeed(command.env("RUSTFLAGS", flagged + " -Clink-arg=-lm")));
    }
}

/// Every class has its module in C, whether or not the next test compiles it; of arms with few joints one, which have its blocks.
#[test]
fn every_class_is_translated() {
    let one = |name: &str| !name.starts_with("few_") || name == FEW;
    let names: std::collections::BTreeSet<String> = arms(one).into_iter().map(|arm| arm.name).collect();
    assert!(made_up().iter().chain(&coupled()).all(|(name, ..)| names.contains(*name)) && names.contains(FEW), "{names:?}");
}

/// What comments say is there: the constants of the loop under the name that they have, and of `t` what is read of it.
#[test]
fn comments_speak_of_what_c_has() {
    let chosen = ["ur5", "panda7", "iiwa", "position3r", "planar3r", FEW];
    let arms = arms(|name| chosen.contains(&name));
    assert_eq!(arms.len(), 2 * chosen.len());
    for Arm { name, c, .. } in arms {
        assert!(!c.contains("`LOOP`"), "{name}");
        for word in c.split("the `offsets` of `").skip(1).filter_map(|rest| rest.split('`').next()) {
            assert!(c.contains(&format!(" {word} = {{")) && c.contains(" offsets;\n"), "{name}: {word}");
        }
        let about = c.split("/* All joint variables that take the end effector to the ").nth(1);
        let about =
            about.and_then(|about| about.split("*/").next()).unwrap_or_else(|| panic!("{name}: the function has no comment"));
        let position = name == "position3r";
        assert_eq!(about.starts_with("position of t.\n * t: a pose"), position, "{name}: {about}");
        assert_eq!(c.contains("/* All postures that reach a position. */"), position, "{name}");
        assert_eq!(c.contains(" 4 /* an entry of t is not finite */"), position, "{name}");
        assert_eq!(name == "iiwa", about.contains("x is k × e normalised"), "{name}: {about}");
    }
}

/// A robot `arm` with inverse kinematics, next to a robot `arm_ik`, which has the name of the first one's header.
#[test]
fn no_guard_is_that_of_another_robot() {
    if !there("gcc") {
        return;
    }
    let folder = folder("inverse_kinematics_guards");
    let (_, text) = robots().into_iter().find(|(name, _)| name == "ur5").expect("the UR5");
    let named = |name: &str| generated(name, &text.replacen("name: ur5", &format!("name: {name}"), 1), Scalar::F64);
    let (one, other) = (named("arm"), named("arm_ik"));
    let write = |path: &str, text: &str| std::fs::write(folder.join(path), text).expect("a file can be written");
    let c = armgen_codegen::emit::Language::C;
    write("arm.h", &one.in_language(c));
    write("arm_ik.h", &one.inverse_kinematics_in_c().expect("a construction"));
    write("other.h", &other.in_language(c));
    write("main.c", "#include \"arm.h\"\n#include \"arm_ik.h\"\n#include \"other.h\"\nint main(void)\n{\n    \
        double q[6] = {0}, t[4][4], u[4][4];\n    arm_solutions found;\n    arm_direct_kinematics(q, t);\n    arm_ik_direct_kinematics(q, u);\n    \
        arm_inverse_kinematics((const double (*)[4])t, &found);\n    return 0;\n}\n");
    succeed(Command::new("gcc").args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]).arg(folder.join("main.c")));
}

/// Two classes, a joint that is given, a position that is polished and an arm with few joints, by one compiler. Some 20 s of a processor.
#[test]
#[ignore = "wide"]
fn modules_in_c_have_the_bits_of_rust() {
    let folder = folder("inverse_kinematics_in_c");
    let chosen = ["puma560", "panda7", "position3r", "general_angles", "coupled_6r", "coupled_swivel", "coupled_bars", FEW];
    compare(&folder, &arms(|name| chosen.contains(&name)), &[("gcc", &["-O1"])], 2000);
}

/// Every class, every compiler, C++, flags that fuse multiplications where allowed, and compilers with fast-math.
///
/// `cargo test --release -p armgen-codegen --test all -- --ignored --nocapture every_class_in_c_has_the_bits_of_rust`.
#[test]
#[ignore = "full: takes minutes"]
fn every_class_in_c_has_the_bits_of_rust() {
    let folder = folder("every_inverse_kinematics_in_c");
    let arms = arms(|_| true);
    let fused: &[&str] = &["-O3", "-march=native"];
    compare(&folder, &arms, &[("gcc", &["-O2"]), ("gcc", fused), ("clang", &["-O2"]), ("clang", fused)], 2000);
    for Arm { name, suffix, .. } in &arms {
        let header = folder.join(format!("{name}_{suffix}_ik.h"));
        let text = format!("#include \"{0}\"\n#include \"{0}\"\nint main() {{ return 0; }}\n", header.display());
        std::fs::write(folder.join("header.cpp"), text).expect("a file can be written");
        for compiler in ["g++", "clang++"].into_iter().filter(|compiler| there(compiler)) {
            let file = folder.join("header.cpp");
            succeed(Command::new(compiler).args(["-std=c++11", "-fsyntax-only"]).args(WARNINGS).arg(&file));
            for (flag, told) in [
                ("-ffast-math", "this file computes nonsense under -ffast-math"),
                ("-ffinite-math-only", "this file takes what is no number for one"),
            ] {
                let refused = Command::new(compiler).args([flag, "-fsyntax-only"]).arg(&file).output().expect("it starts");
                assert!(String::from_utf8_lossy(&refused.stderr).contains(told), "{compiler} {flag}");
            }
        }
    }
}

/// The program in the documentation prints the documented output, and the test emitted with a module passes.
#[test]
#[ignore = "wide"]
fn the_caller_of_the_documentation_runs() {
    let page = include_str!("../../../docs/inverse-kinematics.md");
    let section = page.split("\n## In C\n").nth(1).expect("a section");
    let block = |kind: &str| {
        let block = section.split(&format!("```{kind}\n")).nth(1).expect("a block");
        block.split("```").next().expect("its end").to_owned()
    };
    if !there("cc") {
        return;
    }
    let folder = folder("inverse_kinematics_caller");
    let (name, text) = robots().into_iter().find(|(name, _)| name == "scara").expect("the SCARA");
    let generated = generated(&name, &text, Scalar::F64);
    let write = |path: &str, text: &str| std::fs::write(folder.join(path), text).expect("a file can be written");
    write("scara.h", &generated.in_language(armgen_codegen::emit::Language::C));
    write("scara_ik.h", &generated.inverse_kinematics_in_c().expect("a construction"));
    write("caller.c", &block("c"));
    write(
        "scara_ik_test.c",
        &generated.solvers().next().expect("an end effector").test_in_c("scara.h", "scara_ik.h").expect("a construction"),
    );
    let compiled = |name: &str| {
        let program = folder.join(name);
        let file = folder.join(format!("{name}.c"));
        succeed(Command::new("cc").args(["-std=c99", "-O1"]).args(WARNINGS).arg(file).arg("-o").arg(&program).arg("-lm"));
        succeed(&mut Command::new(program))
    };
    assert_eq!(compiled("caller"), block("text"));
    println!("{}", compiled("scara_ik_test"));
}
