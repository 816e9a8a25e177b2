//! Inverse kinematics of arms with fewer joints than a pose has rows: certified, and refused where something is not what it has to be.

use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_verify::inverse_kinematics::verify;

fn module(text: &str) -> (Source, String) {
    let source = Source::new("robot.yaml", text);
    let functions = Selection::named(["direct_kinematics"]).expect("a function");
    let (generated, _) = armgen_codegen::generate(&source, &Options { functions, ..Options::default() });
    let ik = generated.expect("a valid robot").inverse_kinematics();
    (source, ik)
}

/// A description from rows (kind, a, alpha, d, theta).
fn description(rows: &[[&str; 5]]) -> String {
    let joint = |(i, [kind, a, alpha, d, theta]): (usize, &[&str; 5])| {
        format!(
            "  - {{name: j{}, type: {}, a: {a}, alpha: {alpha}, d: {d}, theta: {theta}, \
             link: {{mass: 1, com: [0, 0, 0], inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n",
            i + 1,
            if *kind == "P" { "prismatic" } else { "revolute" }
        )
    };
    let joints: String = rows.iter().enumerate().map(joint).collect();
    format!("name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n{joints}")
}

/// One to five joints given a whole pose: name, solutions at the pose of a random posture where they are counted, description.
fn few() -> Vec<(&'static str, usize, String)> {
    let (o, q, minus) = ("0", "pi/2", "-pi/2");
    let arm = |name, solutions, rows: &[[&str; 5]]| (name, solutions, description(rows));
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

/// Every pose of a random posture has as many solutions as branches with the virtual joints at 0; at rational poses, and beside them, the module
/// finds as many as there are.
#[test]
fn arms_with_few_joints_are_verified() {
    let mut wrong = Vec::new();
    for (name, solutions, text) in few() {
        let (source, text) = module(&text);
        let now = std::time::Instant::now();
        let report = verify(&source, &text, 16);
        println!("{name}: {report}\n{:?}", now.elapsed());
        // Slides alone are not counted: no axis turns that could be eliminated.
        let counted = name.contains('R');
        let generic = report.generic.as_ref().map(|generic| generic.0);
        let right = report.passed()
            && generic == counted.then_some(solutions)
            && report.uncounted.is_none() == counted
            && (!counted || report.equal >= 10 && report.unreachable >= 2);
        if !right {
            wrong.push(format!("{name}: {report}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Rows that are not judged, another tolerance, another arm, virtual joints that are elsewhere.
#[test]
fn other_texts_of_few_joints_are_refused() {
    let (_, _, arm) = few().remove(6);
    let (source, text) = module(&arm);
    let fault = |old: &str, new: &str| {
        assert!(text.contains(old), "{old}");
        verify(&source, &text.replacen(old, new, 1), 0).faults.pop().unwrap_or_default()
    };
    assert!(fault("&ARM,", "&LOOP,").contains("should stand where"));
    let (call, rest) = text.split_once("&ARM,").expect("the call");
    let looser = format!("{call}&ARM,{}", rest.replacen("ROUNDING", "GENERAL_ROWS", 1));
    assert!(verify(&source, &looser, 0).faults.pop().is_some_and(|fault| fault.contains("should stand where")));
    assert!(fault("if met.residual <= most {", "if true {").contains("is not the tested one"));
    assert!(fault("let starts = if turned[0] == J { 1 } else { 17 };", "let starts = 1;").contains("is not the tested one"));
    let (head, own) = text.split_once("const ARM: ").expect("the arm's own loop");
    let spoilt = |old: &str, new: &str| {
        assert!(own.contains(old), "{old}");
        let text = format!("{head}const ARM: {}", own.replacen(old, new, 1));
        verify(&source, &text, 0).faults.pop().unwrap_or_default()
    };
    assert!(spoilt("order: [0, 1,", "order: [1, 0,").contains("not the loop of the arm's own joints"));
    assert!(spoilt("0.4", "0.41").contains("is not the float nearest"));
    assert!(spoilt("open: 5", "open: 4").contains("not the loop of the arm's own joints"));
}
