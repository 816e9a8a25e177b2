//! A build script takes a URDF or a MuJoCo model. One test: `OUT_DIR` is of the whole process.

use std::path::Path;

use armgen_import::build_script::Robot;

#[test]
fn a_build_script_generates_from_a_file_of_another_format() {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let urdf = Robot::new(files.join("urdf/everything.urdf")).base("base").tip("tip").lock("finger", "0.04").name("arm");
    std::env::remove_var("OUT_DIR");
    let refused = urdf.try_description().expect_err("no OUT_DIR");
    assert!(refused.contains("OUT_DIR"), "{refused}");

    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("import-build-script");
    std::fs::create_dir_all(&out).expect("a folder");
    std::env::set_var("OUT_DIR", &out);
    for robot in [urdf, Robot::new(files.join("mjcf/everything.xml")).tip("tcp").snap(0.0)] {
        let written = robot.imported().functions(["gravity"]).try_generate().unwrap_or_else(|error| panic!("{error}"));
        let module = std::fs::read_to_string(&written[0]).expect("the module");
        assert!(module.contains("pub fn gravity("), "{module}");
    }
    assert!(out.join("everything.yaml").is_file());

    let coupled = || Robot::new(files.join("bad/follower-limits.urdf"));
    for (robot, function) in
        [(coupled().all(), "three_direct_kinematics"), (coupled().named_tip("hand", "two"), "hand_direct_kinematics")]
    {
        let written =
            robot.imported().functions([function, "joint_variables"]).try_generate().unwrap_or_else(|error| panic!("{error}"));
        assert!(std::fs::read_to_string(&written[0]).expect("the module").contains(&format!("pub fn {function}(")));
    }

    let faulty = Robot::new(files.join("bad/zero-axis.urdf")).try_description().expect_err("a faulty file");
    assert!(faulty.contains("error[zero-axis]") && faulty.contains("zero-axis.urdf:"), "{faulty}");
    let missing = Robot::new("no such.urdf").try_description().expect_err("no file");
    assert!(missing.contains("cannot read"), "{missing}");
}
