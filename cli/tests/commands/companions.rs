//! Companions of a module: tests, bounds, inverse kinematics, the interface for C.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::{check, err, file, folder, out};

#[test]
fn what_stands_beside_a_module_needs_one() {
    for flag in ["--verify", "--tests", "--bounds", "--runtime", "--c-abi", "--ik"] {
        let output = check(&["generate", &file("robots/scara.yaml"), flag], 2);
        assert!(err(&output).contains(&format!("{flag} writes beside the module")), "{}", err(&output));
        assert_eq!(out(&output), "");
    }
}

#[test]
#[ignore = "wide"]
fn the_test_file_runs_beside_its_module() {
    let folder = folder("test_file");
    fs::create_dir_all(folder.join("src")).expect("a folder");
    let module = folder.join("src/arm.rs");
    let path = module.to_str().expect("UTF-8");
    check(&["generate", &file("robots/scara4.yaml"), "--out", path, "--tests"], 0);
    let manifest = "[package]\nname = \"test-file\"\nversion = \"0.1.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n";
    fs::write(folder.join("Cargo.toml"), manifest).expect("a file");
    fs::write(folder.join("src/lib.rs"), "pub mod arm;\n#[cfg(test)]\nmod arm_test;\n").expect("a file");
    let run = || {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["test", "--offline", "--quiet"]).current_dir(&folder).env("CARGO_TARGET_DIR", folder.join("target"));
        cargo.output().expect("cargo runs")
    };
    let output = run();
    assert!(output.status.success(), "{}{}", out(&output), err(&output));
    let right = fs::read_to_string(&module).expect("the module");
    let at = right.find("pub fn gravity(").expect("a function");
    fs::write(&module, format!("{}{}", &right[..at], right[at..].replacen("98.1", "98.2", 1))).expect("a file");
    let output = run();
    assert!(!output.status.success() && out(&output).contains("gravity at state 0"), "{}{}", out(&output), err(&output));
}

#[test]
fn error_bounds_stand_in_the_documentation_and_in_a_companion() {
    let folder = folder("bounds");
    let module = folder.join("arm.rs");
    let path = module.to_str().expect("UTF-8");
    check(&["generate", &file("robots/scara.yaml"), "--out", path, "--bounds", "--verify"], 0);
    let text = fs::read_to_string(&module).expect("the module");
    // What writes into memory of the caller has the errors of the function that returns the same.
    let functions = text.lines().filter(|line| line.starts_with("pub fn ") && !line.contains("_into(")).count();
    assert_eq!(text.matches("/// Rounding error: ").count(), functions, "{text}");
    assert!(text.contains("// Box of the rounding errors: "), "{text}");
    let companion = fs::read_to_string(folder.join("arm_bounds.rs")).expect("the companion");
    assert!(companion.contains("use super::arm::*;") && companion.contains("pub fn gravity_error_bound("), "{companion}");
    let certificate: Value =
        serde_json::from_slice(&fs::read(folder.join("arm.cert.json")).expect("the certificate")).expect("JSON");
    let gravity = certificate["functions"].as_array().expect("a list").iter().find(|f| f["name"] == "gravity").expect("gravity");
    let bound: f64 = gravity["error_bound"].as_str().expect("a text").parse().expect("a number");
    assert!(bound > 0.0 && bound < 1e-12, "{bound}");
    assert_eq!(certificate["rounding_box"]["q"].as_array().expect("a list").len(), 4);
    check(&["verify", &file("robots/scara.yaml"), path], 0);
}

#[test]
fn inverse_kinematics_is_named_shown_and_written() {
    let scara = file("robots/scara.yaml");
    let text = out(&check(&["check", &scara], 0));
    assert!(text.contains("all revolute axes parallel (joints 1 2 4): at most 2 solutions"), "{text}");
    let text = out(&check(&["show", &scara, "inverse_kinematics"], 0));
    assert!(text.starts_with("inverse_kinematics: all revolute axes parallel (joints 1 2 4), at most 2 solutions\n"), "{text}");
    assert!(text.contains("two links in the plane") && text.contains("singular: elbow stretched"), "{text}");
    let text = out(&check(&["show", &file("robots/panda7.yaml"), "inverse_kinematics"], 0));
    assert!(text.contains("; q7 is given, at most 8 solutions\n  given T = (R p; 0 1) and q7\n"), "{text}");
    check(&["show", &scara, "inverse_kinematics", "--format", "json"], 2);
    // Among everything, and among what is known.
    let all = out(&check(&["show", &scara], 0));
    assert!(all.contains("\ninverse_kinematics: all revolute axes parallel (joints 1 2 4), at most 2 solutions\n"), "{all}");
    let unknown = err(&check(&["show", &scara, "inverse_kinematic"], 2));
    assert!(unknown.contains("did you mean `inverse_kinematics`?"), "{unknown}");
    let module = folder("inverse_kinematics").join("robot.rs");
    check(&["generate", &scara, "--out", module.to_str().expect("UTF-8"), "--ik"], 0);
    let text = fs::read_to_string(module.with_file_name("robot_ik.rs")).expect("inverse kinematics");
    assert!(text.contains("pub fn inverse_kinematics(t: &[[Real; 4]; 4]) -> Solutions {"), "{text}");
}

/// The companions of a module of one robot, and then the module of another.
#[test]
fn companions_of_another_description_are_told() {
    let folder = folder("stale");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let (first, second, module) = (file("robots/scara4.yaml"), file("tests/robots/single_joint.yaml"), path("robot.rs"));
    let beside = ["--ik", "--bounds", "--runtime", "--tests", "--c-abi"];
    let output = check(&[&["generate", &first, "--out", &module][..], &beside].concat(), 0);
    assert!(!err(&output).contains("another description"), "{}", err(&output));
    fs::write(path("robot_ik_c.rs"), "my own").expect("a file");
    let companions =
        ["robot_ik.h", "robot_ik.rs", "robot_bounds.rs", "robot_runtime.rs", "robot_test.rs", "robot_c.rs", "robot.h"];
    let output = check(&["generate", &first, "--out", &module], 0);
    assert!(!err(&output).contains("another description"), "{}", err(&output));
    let output = check(&["generate", &second, "--out", &module, "--bounds"], 0);
    for companion in companions {
        let told = err(&output).contains(&format!("{} was not written again and is of another description", path(companion)));
        assert_eq!(told, companion != "robot_bounds.rs", "{companion}: {}", err(&output));
    }
    assert!(!err(&output).contains("robot_ik_c.rs"), "a file of somebody else: {}", err(&output));
    // None of them is a module to verify, or to be written over by one.
    for companion in companions.into_iter().filter(|name| *name != "robot_ik.rs") {
        let output = check(&["verify", &first, &path(companion)], 1);
        let with = if companion == "robot_ik.h" { path("robot_ik.rs") } else { module.clone() };
        let said = err(&output);
        assert!(said.contains(&format!("goes with {with}: verify that one")) && !said.contains("writes module"), "{said}");
    }
    // A header of the same name may be a module by itself, which no option of the other language renews.
    for (languages, told) in [(["c", "rust"], "--c-abi"), (["rust", "c"], "--ik renews")] {
        let (modules, robots) = (languages.map(|language| if language == "c" { "h" } else { "rs" }), [&first, &second]);
        let beside = folder.join(languages[0]);
        fs::create_dir_all(&beside).expect("a folder");
        for i in 0..2 {
            let module = beside.join(format!("robot.{}", modules[i]));
            let mut arguments =
                vec!["generate", robots[i].as_str(), "--language", languages[i], "--out", module.to_str().expect("UTF-8")];
            arguments.extend(if i == 0 && languages[0] == "rust" { &["--ik", "--c-abi"][..] } else { &[] });
            let said = err(&check(&arguments, 0));
            assert!(!said.contains(told), "{languages:?}: {said}");
        }
    }
    let output = check(&["verify", &second, &path("robot_ik.rs")], 1);
    assert!(err(&output).contains("is of another description: it was made from scara4.yaml (input "), "{}", err(&output));
}

/// Inverse kinematics of end effectors that the description of today does not name.
#[test]
fn inverse_kinematics_of_earlier_end_effectors_is_told() {
    let folder = folder("stale_tips");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let module = path("robot.rs");
    check(&["generate", &file("tests/data/trees/two_hands.yaml"), "--out", &module, "--ik"], 0);
    let told = |name: &str| {
        let output = check(&["generate", &file("robots/scara4.yaml"), "--out", &module], 0);
        err(&output).contains(&format!("{} was not written again and is of another description: --ik renews it", path(name)))
    };
    assert!(told("robot_left_hand_ik.rs") && told("robot_right_hand_ik.rs"));
    // A module of its own name has it.
    check(&["generate", &file("robots/scara4.yaml"), "--out", &path("robot_left_hand.rs")], 0);
    assert!(!told("robot_left_hand_ik.rs") && told("robot_right_hand_ik.rs"));
}

/// An arm whose last joint turns about the axis that `pointing` leaves open, and one whose task is no target.
#[test]
fn an_arm_without_inverse_kinematics_is_told() {
    let folder = folder("without_ik");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let text = fs::read_to_string(file("robots/puma560.yaml")).expect("a description");
    for (asked, language, name, code) in [
        (Some("inverse_kinematics: {target: pointing}\n"), "rust", "arm.rs", 1),
        (Some("inverse_kinematics: {target: pointing}\n"), "c", "arm.h", 1),
        (None, "rust", "arm.rs", 0),
        (None, "c", "arm.h", 0),
    ] {
        let (yaml, module) = (path("arm.yaml"), path(name));
        let text = asked.map_or_else(
            || fs::read_to_string(file("tests/robots/counterbalance.yaml")).expect("a description"),
            |asked| format!("{text}\n{asked}"),
        );
        fs::write(&yaml, text).expect("a file");
        let output = check(&["generate", &yaml, "--language", language, "--out", &module, "--ik"], code);
        assert!(err(&output).contains("there is no") && err(&output).contains(": "), "{}", err(&output));
        assert_eq!(err(&output).contains("nothing is written"), code == 1, "{}", err(&output));
        let remedy = "in a description without that joint `target: pointing` is a target of the other 5";
        assert_eq!(err(&output).contains(remedy), code == 1, "{}", err(&output));
        assert_eq!(Path::new(&module).exists(), code == 0);
    }
}

#[test]
fn the_face_for_c_stands_beside_the_module() {
    let folder = folder("c_abi");
    let module = folder.join("robot.rs");
    check(&["generate", &file("robots/scara.yaml"), "--out", module.to_str().expect("UTF-8"), "--c-abi", "--runtime"], 0);
    let runtime = fs::read_to_string(folder.join("robot_runtime.rs")).expect("the implementation");
    assert!(runtime.contains("impl armgen_runtime::"), "{runtime}");
    let header = fs::read_to_string(folder.join("robot.h")).expect("the header");
    assert!(header.contains("void scara_inertia_matrix("), "{header}");
    let laws = fs::read_to_string(folder.join("robot_laws.h")).expect("the header of the laws");
    assert!(laws.contains("#include \"robot.h\"") && laws.contains("int scara_hand_guiding("), "{laws}");
    let wrappers = fs::read_to_string(folder.join("robot_laws_c.rs")).expect("the wrappers of the laws");
    assert!(wrappers.contains("pub unsafe extern \"C\" fn scara_impedance("), "{wrappers}");
    let wrappers = fs::read_to_string(folder.join("robot_c.rs")).expect("the wrappers");
    assert!(wrappers.contains("pub unsafe extern \"C\" fn scara_inertia_matrix("), "{wrappers}");
}
