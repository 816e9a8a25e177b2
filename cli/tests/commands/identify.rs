//! `armgen excite`, `armgen identify` and `armgen verify` one after the other: a planned motion of a simulated arm, its log, its numbers, their proof.

use std::fs;
use std::path::Path;

use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};
use serde_json::Value;

use super::{armgen, check, err, folder, out};

const ARM: &str = "name: two
convention: standard
gravity: [0, -9.81, 0]
joints:
  - {name: shoulder, type: revolute, a: 0.4, alpha: 0, d: 0, theta: 0,
     limits: {position: [-2, 2], velocity: 2, acceleration: 8, effort: 90},
     link: {mass: 4, com: [-0.2, 0.01, 0], inertia: {xx: 0.01, yy: 0.06, zz: 0.07}},
     motor: {ratio: 50, inertia: 2e-4}, friction: {viscous: 1.5, coulomb: 2}}
  - {name: elbow, type: revolute, a: 0.3, alpha: 0, d: 0, theta: 0,
     limits: {position: [-2, 2], velocity: 2, acceleration: 8, effort: 30},
     link: {mass: 1.5, com: [-0.1, 0.005, 0], inertia: {xx: 0.003, yy: 0.02, zz: 0.02}},
     motor: {ratio: 50, inertia: 1e-4}, friction: {viscous: 0.8, coulomb: 0.6}}
";

/// The log of an arm that follows a file of samples exactly, with noise of the torques.
fn log(arm: &str, samples: &str) -> String {
    let (manipulator, _) = validate::read(&Source::new("arm", arm)).0.expect("a valid arm");
    let functions = Selection::named(["inverse_dynamics"]).expect("its name");
    let module = schedule::module(&Model::new(manipulator), &Options { functions, ..Options::default() });
    let program = armgen_evaluate::programs::<f64>(&module).remove(0);
    let mut text = String::from("t,q_shoulder,q_elbow,dq_shoulder,dq_elbow,tau_shoulder,tau_elbow\n");
    let mut state: u64 = 1;
    for line in samples.lines().skip(1) {
        let x: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        let mut tau = [0.0; 2];
        program.run(&[&x[1..3], &x[3..5], &x[5..7]], &mut tau, &mut program.workspace()).expect("a state");
        let noisy = tau.map(|tau| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            tau + 0.1 * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
        });
        text += &format!("{},{},{},{},{},{:.5},{:.5}\n", x[0], x[1], x[2], x[3], x[4], noisy[0], noisy[1]);
    }
    text
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a UTF-8 path")
}

#[test]
fn a_planned_motion_identifies_an_arm_and_its_numbers_are_verified() {
    let folder = folder("identify");
    let [guess, motion, run, identified] =
        ["robot.yaml", "motion.csv", "log.csv", "identified.yaml"].map(|name| folder.join(name));
    fs::write(&guess, ARM.replace("mass: 1.5", "mass: 1").replace("viscous: 1.5", "viscous: 1")).expect("a file");
    let planned = check(&["excite", text(&guess), "--out", text(&motion), "--duration", "20"], 0);
    assert!(out(&planned).contains("proved for all times") && out(&planned).lines().all(|line| line.chars().count() <= 100));
    let proof: Value = serde_json::from_str(&fs::read_to_string(folder.join("motion.cert.json")).expect("a file")).expect("JSON");
    let margins = proof["motion"]["margins"].as_array().expect("a list");
    assert!(margins.len() == 8 && margins.iter().all(|of| of["margin"].as_f64().is_some_and(|margin| margin >= 0.0)), "{proof}");
    let coefficients = fs::read_to_string(folder.join("motion.yaml")).expect("a file");
    for key in ["robot: ", "duration: 20.0 ", "w: ", "q0:", "a:", "b:", "lead_in:", "log_det_per_parameter: ", "condition: "] {
        assert!(coefficients.lines().any(|line| line.starts_with(key)), "{key}\n{coefficients}");
    }
    fs::write(&run, log(ARM, &fs::read_to_string(&motion).expect("samples"))).expect("a file");
    check(&["identify", text(&guess), text(&run), "--out", text(&identified)], 0);
    // Without a report the certificate is beside the file.
    let certificate = folder.join("identified.cert.json");
    let verified = check(&["verify", text(&identified), text(&certificate)], 0);
    assert!(out(&verified).contains("all 2 bodies are positive definite") && out(&verified).ends_with("verified\n"));
    let report = folder.join("report");
    check(&["identify", text(&guess), text(&run), "--out", text(&identified), "--report", text(&report)], 0);
    let again = fs::read_to_string(report.join("certificate.json")).expect("a file");
    assert_eq!(again, fs::read_to_string(&certificate).expect("a file"));
    // One page without requests: six figures for each joint.
    let page = fs::read_to_string(report.join("report.html")).expect("a file");
    assert!(["http", "src=", "href=", "@import", "url("].iter().all(|word| !page.contains(word)));
    assert_eq!((page.matches("<svg").count(), page.matches("</svg>").count()), (12, 12));
    assert!(page.contains("optimal") || page.contains("no other bodies"), "the proof is told");
    assert!(!page.contains("NaN") && !page.contains("inf"));
    // A digit of the file, or of the certificate.
    let written = fs::read_to_string(&identified).expect("a file");
    let at = written.find("viscous: ").expect("a number") + 9;
    let digit = char::from(b'1' + (written.as_bytes()[at] - b'0' + 1) % 9);
    let changed = folder.join("changed.yaml");
    fs::write(&changed, format!("{}{digit}{}", &written[..at], &written[at + 1..])).expect("a file");
    let refused = check(&["verify", text(&changed), text(&certificate)], 1);
    assert!(err(&refused).contains("identified.cert.json"), "{}", err(&refused));
    fs::write(&certificate, again.replacen("\"gap\": \"", "\"gap\": \"1", 1)).expect("a file");
    check(&["verify", text(&identified), text(&certificate)], 1);
}

#[test]
fn a_motion_that_is_not_there_has_its_reason() {
    let folder = folder("excite");
    let [arm, options] = ["robot.yaml", "excite.yaml"].map(|name| folder.join(name));
    fs::write(&arm, ARM.replace("velocity: 2, ", "")).expect("a file");
    let refused = check(&["excite", text(&arm)], 1);
    assert!(err(&refused).contains("error[missing-limit]: joint `shoulder` has no limit of velocity"), "{}", err(&refused));
    fs::write(&arm, ARM).expect("a file");
    fs::write(&options, "boxx: {z: [0, 1]}\n").expect("a file");
    let refused = check(&["excite", text(&arm), "--options", text(&options)], 1);
    assert!(err(&refused).contains("excite.yaml:1:1") && err(&refused).contains("box"), "{}", err(&refused));
    // Files beside the samples are no inputs either.
    let output = armgen(&["excite", text(&arm), "--out", text(&folder.join("robot.csv")), "--harmonics", "2"]);
    assert_eq!(output.status.code(), Some(2), "{}", err(&output));
    assert!(err(&output).contains("read by this command") && !folder.join("robot.csv").exists());
}
