//! Generates every robot of `robots/` and `tests/robots/` into `OUT_DIR`, some of them in single precision as well, and a list of them
//! for `src/emitted.rs` to take in.
//!
//! One robot needs one line, `Robot::new("robot.yaml").generate()`; the rest here is the list.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use signatures::{listed, of_module, of_robot};

use armgen_codegen::build_script::{Robot, Scalar, Trig};

#[allow(unreachable_pub)]
#[path = "src/signatures.rs"]
mod signatures;

/// The robots that are emitted in single precision too.
const NARROW: [&str; 4] = ["everything", "puma560", "scara", "scara4"];

/// The robots that are emitted with functions for many states.
const BATCHES: [(&str, &str, Trig, Scalar, usize); 8] = [
    // Functions for one state call `sin_cos_one` alone, those for many `sin_cos`, too.
    ("robots/single_joint.yaml", "single_joint_batch", Trig::Fast, Scalar::F64, 4),
    ("../robots/scara4.yaml", "scara4_batch", Trig::Fast, Scalar::F64, 8),
    ("../robots/scara4.yaml", "scara4_batch_f32", Trig::Fast, Scalar::F32, 16),
    // Dry friction, a general angle, and blocks that no vector divides.
    ("robots/everything.yaml", "everything_batch_f32", Trig::Fast, Scalar::F32, 12),
    ("../robots/scara4.yaml", "scara4_batch_std", Trig::Std, Scalar::F64, 3),
    ("../robots/ur5.yaml", "ur5_batch", Trig::Libm, Scalar::F64, 4),
    // Angles that functions compute.
    ("data/trees/helix.yaml", "helix_batch", Trig::Fast, Scalar::F64, 4),
    ("data/trees/helix.yaml", "helix_batch_f32", Trig::Fast, Scalar::F32, 8),
];

/// The robots that are emitted with inverse kinematics.
const POSTURES: [(&str, Scalar); 6] = [
    ("../robots/scara4.yaml", Scalar::F64),
    ("../robots/scara4.yaml", Scalar::F32),
    ("../robots/puma560.yaml", Scalar::F64),
    ("../robots/ur5.yaml", Scalar::F64),
    ("../robots/panda7.yaml", Scalar::F64),
    ("data/iiwa14.yaml", Scalar::F64),
];

fn main() {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("a build script has it"));
    let mut modules = String::new();
    let mut list = String::new();
    for folder in ["../robots", "robots"] {
        println!("cargo::rerun-if-changed={folder}");
        for path in descriptions(Path::new(folder)) {
            let stem = path.file_stem().expect("a file's name").to_string_lossy().into_owned();
            let mut add = |module: &str| {
                let path = path.display();
                write!(modules, "/// From `{path}`.\npub mod {module} {{\n").expect("text");
                for file in [format!("{module}.rs"), format!("{module}_runtime.rs")] {
                    writeln!(modules, "    include!(concat!(env!(\"OUT_DIR\"), \"/{file}\"));").expect("text");
                }
                write!(modules, "}}\nflat!({module});\n").expect("text");
                let text = |file: String| std::fs::read_to_string(out.join(file)).expect("it was just written");
                let functions = listed(&of_module(&text(format!("{module}.rs"))));
                let [nominal, with] =
                    ["Nominal", "WithParameters"].map(|robot| listed(&of_robot(&text(format!("{module}_runtime.rs")), robot)));
                writeln!(list, "    emitted!({module}, \"{path}\"; [{functions}] [{nominal}] [{with}]),").expect("text");
            };
            Robot::new(&path).generate();
            add(&stem);
            if NARROW.contains(&stem.as_str()) {
                let module = format!("{stem}_f32");
                Robot::new(&path).scalar(Scalar::F32).file_stem(&module).generate();
                add(&module);
            }
        }
    }
    // An arm without mass, for `tests/kinematics_alone.rs`.
    Robot::new("data/kinematics_alone.yaml").generate();
    // An arm with gravity as an argument, for `tests/gravity.rs`.
    Robot::new("data/mounted.yaml").generate();
    // An arm with several end effectors, for `tests/tips.rs`.
    Robot::new("data/trees/two_hands.yaml").generate();
    // An arm with a finger that follows another one, for `tests/coupled.rs`.
    Robot::new("data/trees/gripper_arm.yaml").generate();
    // With inverse kinematics, for `tests/postures.rs`.
    for (robot, scalar) in POSTURES {
        let stem = Path::new(robot).file_stem().expect("a file's name").to_string_lossy();
        let stem = format!("postures_{stem}_{}", if scalar == Scalar::F64 { "f64" } else { "f32" });
        Robot::new(robot).scalar(scalar).file_stem(stem).inverse_kinematics().generate();
    }
    // With functions for many states, for `tests/batches.rs`.
    let mut batches = String::new();
    for (robot, module, trig, scalar, lanes) in BATCHES {
        Robot::new(robot).trig(trig).scalar(scalar).batch(lanes).file_stem(module).generate();
        let text = std::fs::read_to_string(out.join(format!("{module}.rs"))).expect("it was just written");
        writeln!(batches, "check!({module}: {});", listed(&of_module(&text))).expect("text");
    }
    std::fs::write(out.join("batches.rs"), batches).expect("OUT_DIR can be written");
    let text =
        format!("{modules}\n/// Every emitted module, in the order of the files.\npub static ALL: &[Emitted] = &[\n{list}];\n");
    std::fs::write(out.join("emitted.rs"), text).expect("OUT_DIR can be written");
}

/// The descriptions in a folder, sorted.
fn descriptions(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    paths.sort();
    paths
}
