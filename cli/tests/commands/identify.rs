//! `armgen excite`, `armgen identify` and `armgen verify` one after the other: a planned motion of a simulated arm, its log, its numbers, their proof.

use std::fs;
use std::path::Path;

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

fn text(path: &Path) -> &str {
    path.to_str().expect("a UTF-8 path")
}

#[test]
fn a_planned_motion_identifies_an_arm_and_its_numbers_are_verified() {
    let folder = folder("identify");
    let [arm, guess, motion, run, identified] =
        ["arm.yaml", "robot.yaml", "motion.csv", "motion.log.csv", "identified.yaml"].map(|name| folder.join(name));
    fs::write(&arm, ARM).expect("a file");
    fs::write(&guess, ARM.replace("mass: 1.5", "mass: 1").replace("viscous: 1.5", "viscous: 1")).expect("a file");
    let simulate = ["--duration", "20", "--simulate", text(&arm), "--noise", "1"];
    let planned = check(&[&["excite", text(&guess), "--out", text(&motion)][..], &simulate].concat(), 0);
    assert!(!out(&planned).contains("NaN"), "{}", out(&planned));
    assert!(out(&planned).contains("proved for all times") && out(&planned).lines().all(|line| line.chars().count() <= 100));
    let proof: Value = serde_json::from_str(&fs::read_to_string(folder.join("motion.cert.json")).expect("a file")).expect("JSON");
    let margins = proof["motion"]["margins"].as_array().expect("a list");
    assert!(margins.len() == 8 && margins.iter().all(|of| of["margin"].as_f64().is_some_and(|margin| margin >= 0.0)), "{proof}");
    let coefficients = fs::read_to_string(folder.join("motion.yaml")).expect("a file");
    for key in ["robot: ", "duration: 20.0 ", "w: ", "q0:", "a:", "b:", "lead_in:", "log_det_per_parameter: ", "condition: "] {
        assert!(coefficients.lines().any(|line| line.starts_with(key)), "{key}\n{coefficients}");
    }
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
    // The page of the arm draws what was measured and what the model predicts.
    let torques = report.join("motion.log.torques.csv");
    let columns = fs::read_to_string(&torques).expect("a file");
    let names = "t,q_shoulder,q_elbow,dq_shoulder,dq_elbow,measured_shoulder,measured_elbow,predicted_shoulder,predicted_elbow";
    assert_eq!(columns.lines().next(), Some(names));
    for line in columns.lines().skip(1) {
        let x: Vec<f64> = line.split(',').map(|x| x.parse().expect("a number")).collect();
        assert!(x.len() == 9 && (x[5] - x[7]).abs() < 3.0 && (x[6] - x[8]).abs() < 1.5, "{line}");
    }
    let drawn = folder.join("two.html");
    check(&["page", text(&identified), "--out", text(&drawn), "--log", text(&torques)], 0);
    assert!(fs::read_to_string(&drawn).expect("a page").contains("data-log=\"motion.log.torques\""));
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

/// A log with a column changed by a function of the stamp and the value, and with its torques later by some samples.
fn changed(log: &str, column: &str, later: usize, change: impl Fn(f64, f64) -> f64) -> String {
    let rows: Vec<Vec<&str>> = log.lines().map(|line| line.split(',').collect()).collect();
    let place = rows[0].iter().position(|name| *name == column);
    let mut text = rows[0].join(",") + "\n";
    for (k, row) in rows.iter().enumerate().skip(1) {
        let cell = |(i, cell): (usize, &&str)| match rows[0][i].starts_with("tau_") {
            true => {
                let value: f64 = rows[k.saturating_sub(later).max(1)][i].parse().expect("a number");
                format!("{:.7}", if Some(i) == place { change(row[0].parse().expect("a number"), value) } else { value })
            }
            false => (*cell).to_owned(),
        };
        text += &(row.iter().enumerate().map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

/// A contact that lasts longer than the rest of its log, and a late clock, are seen against what the file keeps of its identification.
#[test]
fn a_file_alone_judges_a_log_by_what_it_keeps() {
    let folder = folder("judged");
    let [arm, motion, run, identified, log, report] =
        ["arm.yaml", "motion.csv", "motion.log.csv", "identified.yaml", "log.csv", "report"].map(|name| folder.join(name));
    fs::write(&arm, ARM).expect("a file");
    check(&["excite", text(&arm), "--out", text(&motion), "--duration", "20", "--simulate", text(&arm), "--noise", "1"], 0);
    check(&["identify", text(&arm), text(&run), "--out", text(&identified)], 0);
    let judged = |file: &Path, content: &str| -> (Value, String) {
        fs::write(&log, content).expect("a file");
        let output = check(&["identify", text(file), "--validate", text(&log), "--report", text(&report)], 0);
        let read = fs::read_to_string(report.join("report.json")).expect("a report");
        (serde_json::from_str::<Value>(&read).expect("JSON")["validation"][0].clone(), err(&output).to_owned())
    };
    let free = fs::read_to_string(&run).expect("a log");
    let (own, said) = judged(&identified, &free);
    assert!(own["contacts"] == serde_json::json!([]) && said.is_empty(), "{own} {said}");
    let pushed = changed(&free, "tau_shoulder", 0, |t, tau| if (4.0..16.0).contains(&t) { tau + 6.0 } else { tau });
    let (of, _) = judged(&identified, &pushed);
    let contacts = of["contacts"].as_array().expect("a list");
    let end = |key: &str| contacts[0][key].as_f64().expect("a number");
    assert!(contacts.len() == 1 && (end("from") - 4.0).abs() < 0.2 && (end("to") - 16.0).abs() < 0.2, "{contacts:?}");
    assert_eq!((&of["delay"], &contacts[0]["joints"]), (&own["delay"], &serde_json::json!(["shoulder"])));
    let (late, _) = judged(&identified, &changed(&free, "", 2, |_, tau| tau));
    assert_eq!(late["delay"], own["delay"]);
    assert!(late["moving"][0].as_f64() > own["moving"][0].as_f64().map(|x| 1.5 * x), "{late} {own}");
    // A file without these lines takes both from the log, and says so.
    let (of, said) = judged(&arm, &pushed);
    assert!(said.contains("note: ") && said.contains("no delays and residuals of an identification"), "{said}");
    assert_ne!(of["contacts"].as_array().map(Vec::len), Some(1));
    let faulty = folder.join("faulty.yaml");
    fs::write(&faulty, fs::read_to_string(&identified).expect("a file").replace(" ms, residual ", " ms residual "))
        .expect("a file");
    let refused = check(&["identify", text(&faulty), "--validate", text(&log)], 1);
    let line = 1 + ARM.lines().count();
    assert!(err(&refused).contains("error[bad-baseline]: `delay"), "{}", err(&refused));
    assert!(err(&refused).contains(&format!("faulty.yaml:{line}:30")), "{}", err(&refused));
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
