//! Generates every robot of `robots/` and `tests/robots/` into `OUT_DIR`, some of them in single precision as well, and a list of them
//! for `src/emitted.rs` to take in.
//!
//! One robot needs one line, `Robot::new("robot.yaml").generate()`; the rest here is the list.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use armgen_codegen::build_script::{Robot, Scalar, Trig};

/// The robots that are emitted in single precision too.
const NARROW: [&str; 4] = ["everything", "puma560", "scara", "scara4"];

/// The robots that are emitted with functions for many states.
const BATCHES: [(&str, &str, Trig, Scalar, usize); 4] = [
    ("../robots/scara4.yaml", "scara4_batch", Trig::Fast, Scalar::F64, 8),
    ("../robots/scara4.yaml", "scara4_batch_f32", Trig::Fast, Scalar::F32, 16),
    ("../robots/scara4.yaml", "scara4_batch_std", Trig::Std, Scalar::F64, 3),
    ("../robots/ur5.yaml", "ur5_batch", Trig::Libm, Scalar::F64, 4),
];

fn main() {
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
                modules.push_str("}\n");
                let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("a build script has it"));
                let text = std::fs::read_to_string(out.join(format!("{module}.rs"))).expect("it was just written");
                let optional = if text.contains("pub fn operational_inertia(") { ", operational_inertia" } else { "" };
                writeln!(list, "    emitted!({module}, \"{path}\"{optional}),").expect("text");
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
    // With functions for many states, for `tests/batches.rs`.
    for (robot, module, trig, scalar, lanes) in BATCHES {
        Robot::new(robot).trig(trig).scalar(scalar).batch(lanes).file_stem(module).generate();
    }
    let text =
        format!("{modules}\n/// Every emitted module, in the order of the files.\npub static ALL: &[Emitted] = &[\n{list}];\n");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("a build script has it"));
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
