//! Inverse kinematics of arms with fewer joints than a pose has rows: certified if correct, and refused after a change.

use super::{description, fault_of, module, verify};

/// Arms of one to five joints for a whole pose: name, number of solutions at the pose of a random posture if counted, description.
fn few() -> Vec<(&'static str, usize, String)> {
    let (o, q, minus) = ("0", "pi/2", "-pi/2");
    let arm = |name, solutions, rows: &[[&str; 5]]| (name, solutions, description("", rows));
    vec![
        arm("1R", 1, &[["R", "0.5", q, "0.1", o]]),
        arm("1P", 1, &[["P", "0.5", q, "0.1", o]]),
        arm("2R", 1, &[["R", "0.5", q, "0.1", o], ["R", "0.3", q, "0.2", o]]),
        arm("2R parallel", 1, &[["R", "0.5", o, "0.1", o], ["R", "0.3", q, "0.2", o]]),
        arm("1P 1R", 1, &[["P", "0.5", q, "0.1", o], ["R", "0.3", q, "0.2", o]]),
        arm("3R", 1, &[["R", "0.2", q, "0.1", o], ["R", "0.4", minus, "0.1", o], ["R", "0.3", q, "0.2", o]]),
        arm("3R elbow", 1, &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, o, o], ["R", "0.3", o, o, o]]),
        arm("3R planar", 2, &[["R", "0.5", o, o, o], ["R", "0.4", o, o, o], ["R", "0.2", o, o, o]]),
        arm("3R wrist", 2, &[["R", o, q, "0.3", o], ["R", o, minus, o, o], ["R", o, o, "0.1", o]]),
        arm("2R 1P", 1, &[["R", "0.2", q, "0.1", o], ["R", "0.4", minus, "0.1", o], ["P", "0.3", q, "0.2", o]]),
        arm("3P", 1, &[["P", o, q, "0.1", q], ["P", o, q, "0.1", q], ["P", "0.3", q, "0.2", o]]),
        arm(
            "4R",
            1,
            &[["R", "0.15", q, "0.3", o], ["R", "0.4", minus, "0.1", o], ["R", "0.35", q, "0.05", o], ["R", "0.12", o, "0.1", o]],
        ),
        arm(
            "4R elbow",
            1,
            &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, "0.1", o], ["R", "0.35", q, "0.05", o], ["R", "0.12", o, "0.1", o]],
        ),
        arm(
            "3R 1P",
            2,
            &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, "0.1", o], ["R", "0.35", q, "0.05", o], ["P", "0.12", o, "0.1", o]],
        ),
        arm(
            "5R",
            1,
            &[
                ["R", "0.15", q, "0.3", o],
                ["R", "0.4", minus, "0.1", o],
                ["R", "0.35", q, "0.05", o],
                ["R", "0.12", minus, "0.1", o],
                ["R", "0.07", q, "0.2", o],
            ],
        ),
        arm(
            "5R parallel",
            4,
            &[
                ["R", "0.03", q, "0.15", o],
                ["R", "0.16", o, o, q],
                ["R", "0.13", o, o, o],
                ["R", o, q, o, q],
                ["R", o, o, "0.2", o],
            ],
        ),
    ]
}

/// Every pose of a random posture has as many solutions as branches with the virtual joints at 0. At rational poses, and next to them, the
/// module finds all solutions.
#[test]
fn arms_with_few_joints_are_verified() {
    let mut wrong = Vec::new();
    for (name, solutions, text) in few() {
        let (source, text) = module(&text);
        let now = std::time::Instant::now();
        let report = verify(&source, &text, 16);
        println!("{name}: {report}\n{:?}", now.elapsed());
        // Three prismatic joints reach every position.
        let least = if name == "3P" { 0 } else { 2 };
        let right = report.passed()
            && report.generic.as_ref().is_some_and(|generic| generic.0 == solutions)
            && report.uncounted.is_none()
            && report.equal >= 10
            && report.unreachable >= least;
        if !right {
            wrong.push(format!("{name}: {report}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Ignored rows, another tolerance, another arm, virtual joints at other places.
#[test]
fn other_texts_of_few_joints_are_refused() {
    let (_, _, arm) = few().remove(6);
    let (source, text) = module(&arm);
    let fault = |old: &str, new: &str| fault_of(&source, &text, [old, new]);
    assert!(fault("&ARM,", "&LOOP,").contains("should stand where"));
    assert!(fault("LENGTH, ROUNDING)", "LENGTH, GENERAL_ROWS)").contains("should stand where"));
    assert!(fault("if met.residual <= most {", "if true {").contains("is not the tested one"));
    assert!(fault("let starts = if turned[0] == J { 1 } else { 17 };", "let starts = 1;").contains("is not the tested one"));
    // In the arm's own loop.
    let (_, own) = text.split_once("const ARM: ").expect("the arm's own loop");
    let spoilt = |old: &str, new: &str| fault_of(&source, &text, [own, &own.replacen(old, new, 1)]);
    assert!(spoilt("order: [0, 1,", "order: [1, 0,").contains("not the loop of the arm's own joints"));
    assert!(spoilt("0.4", "0.41").contains("is not the float nearest"));
    assert!(spoilt("open: 5", "open: 4").contains("not the loop of the arm's own joints"));
}
