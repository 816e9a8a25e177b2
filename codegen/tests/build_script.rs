//! The interface for build scripts: its output, and its errors.
//!
//! One test, since a build script learns its folder from the environment.

use std::path::{Path, PathBuf};

use armgen_codegen::build_script::{Pass, Robot, Scalar, Trig};
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;

fn robot(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// A file that was written: its name and its text.
fn read(file: &Path) -> (String, String) {
    let name = file.file_name().expect("a name").to_string_lossy().into_owned();
    (name, std::fs::read_to_string(file).expect("it was written"))
}

#[test]
fn a_build_script_gets_what_it_asks_for_or_the_reason() {
    let scara = robot("robots/scara.yaml");
    std::env::remove_var("OUT_DIR");
    let error = Robot::new(&scara).try_generate().expect_err("there is no folder").to_string();
    assert!(error.contains("OUT_DIR is not set"), "{error}");

    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("build_script");
    let _ = std::fs::remove_dir_all(&out);
    std::fs::create_dir_all(&out).expect("a folder");
    std::env::set_var("OUT_DIR", &out);

    // Everything chosen at once gives the text that the same options give.
    let names = ["gravity", "inertia_matrix_with"];
    let build =
        Robot::new(&scara).scalar(Scalar::F32).trig(Trig::Fast).without(Pass::Grouping).without(Pass::OriginAlongAxis).batch(4);
    let build = build.fused_multiply_add().functions(names).c_abi().file_stem("chosen");
    let written: Vec<(String, String)> =
        build.try_generate().expect("a valid description").iter().map(|file| read(file)).collect();
    let files: Vec<&str> = written.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(files, ["chosen.rs", "chosen_runtime.rs", "chosen.h", "chosen_c.rs"]);
    let source = Source::new(scara.display().to_string(), std::fs::read_to_string(&scara).expect("the robot"));
    let options = Options {
        scalar: Scalar::F32,
        trig: Trig::Fast,
        without: [Pass::Grouping, Pass::OriginAlongAxis].into_iter().collect(),
        batch: Some(4),
        functions: Selection::named(names.map(String::from)).expect("names of functions"),
        fuse: true,
    };
    let (generated, _) = armgen_codegen::generate(&source, &options);
    let generated = generated.expect("a valid description");
    let texts: Vec<&str> = written.iter().map(|(_, text)| text.as_str()).collect();
    assert_eq!(texts, [&generated.module, &generated.runtime, &generated.c.header, &generated.c.wrappers]);
    let module = texts[0];
    let public: Vec<&str> = module.lines().filter_map(|line| line.strip_prefix("pub fn ")?.split('(').next()).collect();
    assert_eq!(public.len(), 2, "{public:?}");
    assert!(
        public.iter().all(|name| names.contains(name))
            && module.contains("pub type Real = f32;")
            && module.contains("pub mod batch")
            && module.contains("Real::mul_add(")
    );

    // By default, named after its description, without the C interface.
    let written = Robot::new(&scara).try_generate().expect("a valid description");
    let files: Vec<String> = written.iter().map(|file| read(file).0).collect();
    assert_eq!(files, ["scara.rs", "scara_runtime.rs"]);

    for (build, reason) in [
        (Robot::new(robot("robots/none.yaml")), "cannot read"),
        (Robot::new(robot("tests/bad/negative-mass.yaml")), "error[negative-mass]"),
        (Robot::new(&scara).functions(["gravitas"]), "gravity"),
        // Seven joints and six rows that are not all independent, or no rows at all: whatever the reason, it is given.
        (
            Robot::new(robot("tests/robots/single_joint.yaml")).functions(["operational_inertia"]),
            "has no `operational_inertia`: ",
        ),
    ] {
        let error = build.try_generate().expect_err(reason).to_string();
        assert!(error.contains(reason), "{error}");
    }
}
