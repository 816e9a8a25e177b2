//! Certificates, written and verified again.

use std::fs;

use serde_json::Value;

use super::{check, err, file, folder, out};

#[test]
fn a_certificate_is_written_and_verified_again() {
    // Friction of this arm does not grow with its load, and no joint of it is coupled.
    let is_there = |name: &str| !["load_friction", "joint_variables"].contains(&name);
    let functions = armgen_codegen::catalogue::functions().filter(|(quantity, _)| is_there(quantity.name)).count();
    for scalar in ["f64", "f32"] {
        let (folder, yaml) = (folder(&format!("verify_{scalar}")), file("robots/scara.yaml"));
        let (module, certificate) = (folder.join("robot.rs"), folder.join("robot.cert.json"));
        let path = module.to_str().expect("UTF-8");
        let output = check(&["generate", &yaml, "--scalar", scalar, "--out", path, "--verify"], 0);
        assert!(
            err(&output).contains(&format!("{functions} functions and 17 constants equal the equations")),
            "{}",
            err(&output)
        );
        let written: Value = serde_json::from_slice(&fs::read(&certificate).expect("it is written")).expect("JSON");
        assert_eq!((&written["verified"], &written["options"]["scalar"]), (&true.into(), &scalar.into()));
        assert_eq!(written["options"]["trig"], "libm");

        let text = out(&check(&["verify", &yaml, path], 0));
        assert!(text.contains("inertia_matrix") && text.contains("2^-") && text.contains("certificate: "), "{text}");
        assert!(text.contains("\nverified\n"), "{text}");

        // With another module the certificate does not fit; without one the module is judged all the same.
        let right = fs::read_to_string(&module).expect("the module");
        let at = right.find("pub fn gravity(").expect("a function");
        fs::write(&module, format!("{}{}", &right[..at], right[at..].replacen("98.1", "98.2", 1))).expect("a file");
        let output = check(&["verify", &yaml, path], 1);
        assert!(out(&output).contains("FAULT: the certificate is of another module"), "{}", out(&output));
        let line = right[..at].lines().count() + 1;
        assert!(err(&output).contains(&format!("robot.rs:{line}: gravity[2]: ")), "{}", err(&output));
        assert!(err(&output).contains("differs from the equations"), "{}", err(&output));
        assert!(err(&output).contains("] the module says -9.82"), "{}", err(&output));
        // The command that mends it writes a module of the same scalar.
        assert!(err(&output).contains("robot.rs was edited"), "{}", err(&output));
        assert_eq!(err(&output).contains(" --scalar f32 --out "), scalar == "f32", "{}", err(&output));
        // Generating without --verify leaves no doubt about the certificate that is still there.
        let output = check(&["generate", &yaml, "--scalar", scalar, "--out", path], 0);
        assert!(err(&output).contains("robot.cert.json was not written again"), "{}", err(&output));
        fs::write(&certificate, "{").expect("a file");
        let output = check(&["verify", &yaml, path], 1);
        assert!(err(&output).contains("robot.cert.json: the certificate cannot be read: "), "{}", err(&output));
        fs::remove_file(&certificate).expect("it is there");
        check(&["verify", &yaml, path], 0);
        // The text of the module is judged, and this is not all of it.
        let text = fs::read_to_string(&module).expect("the module");
        fs::write(&module, format!("\u{feff}{text}")).expect("a file");
        let output = check(&["verify", &yaml, path], 1);
        assert!(err(&output).contains("begins with a byte order mark"), "{}", err(&output));
    }
}

#[test]
fn verify_tells_what_it_cannot_read() {
    let (yaml, module) = (file("robots/scara.yaml"), folder("verify_unreadable").join("robot.rs"));
    let path = module.to_str().expect("UTF-8");
    let output = check(&["verify", &yaml, &file("robots/none.rs")], 2);
    assert!(err(&output).contains("none.rs"), "{}", err(&output));
    check(&["verify", &file("robots/none.yaml"), &yaml], 2);
    fs::write(&module, "fn main() { loop {} }").expect("a file");
    let output = check(&["verify", &yaml, path], 1);
    assert!(err(&output).contains("robot.rs:1: `main` is not"), "{}", err(&output));
    let output = check(&["verify", &file("tests/bad/many-faults.yaml"), path], 1);
    assert!(err(&output).contains("many-faults.yaml:"), "{}", err(&output));
}
