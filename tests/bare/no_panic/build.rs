//! Generates every robot, some in both scalars and with each trigonometry that needs no `std`, with a call of each function; some
//! robots also have functions for many states. Links the C library, which starts the program.

use armgen_codegen::build_script::{Robot, Scalar, Trig};
use std::{env, fs, path::PathBuf};

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let mut modules = String::new();
    let mut calls = String::new();
    // That a planted index is seen is shown by the robots that main() names: the whole program need not be built twice.
    let planted = env::var_os("CARGO_FEATURE_DELIBERATE_INDEX").is_some();
    let named = |path: &PathBuf| path.file_stem().is_some_and(|name| name == "scara" || name == "panda7");
    let wanted = |path: &PathBuf| path.extension().is_some_and(|e| e == "yaml") && (named(path) || !planted);
    // Sines are a function of their own, whatever the robot: each scalar has a kind of them, and two robots have all four. Arms that users
    // have are there in both scalars, arms of the tests in turn.
    let usual = |scalar, trig| (scalar == Scalar::F64) == (trig == Trig::Libm);
    for folder in ["../../../robots", "../../robots"] {
        let mut files: Vec<PathBuf> =
            fs::read_dir(folder).expect("the folder of robots").flatten().map(|entry| entry.path()).collect();
        files.sort();
        for (number, path) in files.iter().filter(|path| wanted(path)).enumerate() {
            let robot = path.file_stem().expect("a file has a name").to_string_lossy();
            let all = [
                (Scalar::F64, Trig::Libm, "f64"),
                (Scalar::F32, Trig::Libm, "f32"),
                (Scalar::F32, Trig::Fast, "f32_fast"),
                (Scalar::F64, Trig::Fast, "f64_fast"),
            ];
            let in_turn = |scalar| folder == "../../../robots" || (scalar == Scalar::F64) == (number % 2 == 0);
            let kinds = all.into_iter().filter(|&(scalar, trig, _)| named(path) || usual(scalar, trig) && in_turn(scalar));
            for (scalar, trig, ending) in kinds {
                let name = format!("{robot}_{ending}");
                Robot::new(path).scalar(scalar).trig(trig).file_stem(&name).inverse_kinematics().generate();
                let module = fs::read_to_string(out.join(format!("{name}.rs"))).expect("the module was just written");
                let runtime = fs::read_to_string(out.join(format!("{name}_runtime.rs"))).expect("it was written with it");
                let texts = armgen_bare_calls::calls(&module) + &armgen_bare_calls::method_calls(&runtime);
                fs::write(out.join(format!("{name}_calls.rs")), texts).expect("OUT_DIR can be written");
                let postures = fs::read_to_string(out.join(format!("{name}_ik.rs"))).expect("it was written with it");
                // Inverse kinematics has its own sines.
                let has_postures = usual(scalar, trig) && postures.contains("pub fn inverse_kinematics(");
                let files = [name.clone(), format!("{name}_runtime"), format!("{name}_calls")].map(include).concat();
                modules += &module_of(&name, &files);
                if postures.contains("pub fn inverse_kinematics(") {
                    modules += &module_of(&format!("{name}_ik"), &include(format!("{name}_ik")));
                }
                if has_postures {
                    if postures.contains("redundancy: Real") {
                        calls += &format!(
                            "    runtime::every_redundant_posture(&{name}::Nominal);\n    postures!({name}_ik, inverse_kinematics_redundancy);\n"
                        );
                    } else {
                        calls += &format!("    runtime::every_posture(&{name}::Nominal);\n    postures!({name}_ik);\n");
                    }
                }
                calls += &format!(
                    "    let (v, p) = (core::hint::black_box([0.5; {name}::DOF]), core::hint::black_box([0.5; {name}::PARAMETERS]));\n    \
                     let arguments = {name}::Arguments {{ q: v, dq: v, ddq: v, dqr: v, ddqr: v, tau: v, pi: p }};\n    \
                     {name}::each_function(&arguments, &mut |_, call| call());\n    {name}::each_method(&arguments);\n    {name}::each_helper(\"mass\", v[0]);\n"
                );
            }
        }
    }
    // Every function for many states is the body for one state within the same loops. Three robots cover the loops: both scalars,
    // both kinds of sines, and friction that grows with the load.
    let many: [(&str, Scalar, Trig, usize); 3] = [
        ("../../../robots/scara.yaml", Scalar::F64, Trig::Libm, 4),
        ("../../robots/load_friction.yaml", Scalar::F64, Trig::Fast, 8),
        ("../../robots/modified_prismatic.yaml", Scalar::F32, Trig::Fast, 16),
    ];
    for (path, scalar, trig, lanes) in many.into_iter().filter(|_| !planted) {
        let robot = PathBuf::from(path);
        let name = format!("{}_many", robot.file_stem().expect("a file has a name").to_string_lossy());
        Robot::new(path).scalar(scalar).trig(trig).batch(lanes).file_stem(&name).generate();
        let module = fs::read_to_string(out.join(format!("{name}.rs"))).expect("the module was just written");
        fs::write(out.join(format!("{name}_calls.rs")), armgen_bare_calls::calls_of_many_states(&module))
            .expect("OUT_DIR can be written");
        modules += &module_of(&name, &[name.clone(), format!("{name}_calls")].map(include).concat());
        calls += &format!("    {name}::each_function_of_many_states();\n");
    }
    let text = format!("{modules}\nfn every_emitted_function() {{\n{calls}}}\n");
    fs::write(out.join("robots.rs"), text).expect("OUT_DIR can be written");
    println!("cargo::rerun-if-changed=../../../robots");
    println!("cargo::rerun-if-changed=../../robots");
    println!("cargo::rustc-link-lib=c");
}

/// The line that takes in a file of this build.
fn include(file: String) -> String {
    format!("    include!(concat!(env!(\"OUT_DIR\"), \"/{file}.rs\"));\n")
}

/// A module of these lines.
fn module_of(name: &str, lines: &str) -> String {
    format!("#[allow(dead_code, missing_docs, unreachable_pub, clippy::all)]\nmod {name} {{\n{lines}}}\n")
}
