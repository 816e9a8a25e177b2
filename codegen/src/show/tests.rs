//! What is shown of small arms, in each notation.

use super::*;
use crate::catalogue::Absent;
use crate::source::Source;
use crate::validate;

const PENDULUM: &str = "
name: pendulum
convention: standard
gravity: [0, -9.81, 0]
parameters: {m: 2, l: 1/2}
joints:
  - name: pivot
    type: revolute
    a: l
    alpha: 0
    d: 0
    theta: 0
    link: {mass: m, inertia: {zz: 0.01}}
regressor: [m]
";

fn sheet(text: &str, names: &[&str], reading: Reading) -> Sheet {
    let (valid, diagnostics) = validate::read(&Source::new("test.yaml", text));
    assert!(!diagnostics.has_errors(), "{:?}", diagnostics.iter().map(|d| &d.message).collect::<Vec<_>>());
    let model = Model::new(valid.expect("valid").0);
    let items: Vec<Item> = names.iter().flat_map(|name| Item::named(name, model.manipulator.dof())).collect();
    assert!(names.is_empty() || !items.is_empty());
    Sheet::new(&model, if names.is_empty() { Item::all() } else { items }.as_slice(), reading)
}

#[track_caller]
fn check(names: &[&str], reading: Reading, expected: &str) {
    assert_eq!(sheet(PENDULUM, names, reading).text().trim_end(), expected.trim());
}

#[test]
fn numbers_or_names() {
    check(&["inertia_matrix"], Reading::Nominal, "inertia_matrix: B(q)\n  b = 51/100");
    check(&["inertia_matrix"], Reading::Symbolic, "inertia_matrix: B(q)\n  b = 1/100 + m*l^2");
    check(&["gravity"], Reading::Symbolic, "gravity: g(q)\n  g = 981/100*cos(q1)*m*l");
    check(&["regressor"], Reading::Nominal, "regressor: Y(q, dq, dqr, ddqr)\n  y[1, m] = 981/200*cos(q1) + 1/4*ddqr1");
    check(&["regressor"], Reading::Symbolic, "regressor: Y(q, dq, dqr, ddqr)\n  y[1, m] = 981/100*cos(q1)*l + ddqr1*l^2");
    check(&["known_torque"], Reading::Symbolic, "known_torque: tau_known(q, dq, dqr, ddqr)\n  tau_known = 1/100*ddqr1");
    check(&["gravity_with"], Reading::Nominal, "gravity_with: g(q)\n  g = 981/200*cos(q1)*m");
}

#[test]
fn an_entry_too_long_for_a_closed_form_becomes_steps() {
    let sheet = sheet(PENDULUM, &["forward_dynamics"], Reading::Symbolic);
    assert_eq!(
        sheet.quantities[0].formulas(Notation::Text),
        Formulas { steps: vec![("t1".into(), "m*l".into())], entries: vec!["(tau1 - 981/100*t1*cos(q1))/(1/100 + t1*l)".into()] }
    );
}

#[test]
fn no_name_means_two_things() {
    // Seven joints: the frame's entries t11..t44 beside more than eleven steps.
    let row = "type: revolute, a: 0, alpha: 1, d: 1, theta: 0, link: {mass: 1, inertia: {xx: 1, yy: 1, zz: 1}}";
    let joints: String = (1..=7).map(|i| format!("  - {{name: j{i}, {row}}}\n")).collect();
    let arm = format!("name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n{joints}");
    // And parameters that are called as steps and entries would be.
    let pendulum =
        PENDULUM.replace("m: 2", "g: 2").replace("mass: m", "mass: g").replace("[m]", "[g]").replace("l: 1/2", "t1: 1/2");
    for (text, name) in [(arm, "direct_kinematics"), (pendulum.replace("a: l", "a: t1"), "gravity"), (PENDULUM.into(), "gravity")]
    {
        let sheet = sheet(&text, &[name], Reading::Symbolic);
        let shown = &sheet.quantities[0];
        // In LaTeX an index may belong to the name or follow it.
        let printer = Printer { notation: Notation::Latex, parameters: &shown.parameters };
        let names = (0..shown.parameters.len()).map(|i| printer.symbol(Symbol::Parameter(i as u16)));
        let steps = shown.formulas(Notation::Latex).steps.into_iter().map(|(name, _)| name);
        let entries = (0..shown.rows).flat_map(|i| (0..shown.columns).map(move |j| (i, j)));
        let entries = entries.map(|(i, j)| shown.latex_entry_name(i, j));
        let all: Vec<String> = names.chain(steps).chain(entries).collect();
        let different: BTreeSet<&String> = all.iter().collect();
        assert_eq!(all.len(), different.len(), "{all:?}");
        let steps = shown.formulas(Notation::Text).steps.into_iter().map(|(name, _)| name);
        let entries = (0..shown.rows).flat_map(|i| (0..shown.columns).map(move |j| (i, j))).map(|(i, j)| shown.entry_name(i, j));
        let all: Vec<String> = steps.chain(entries).chain(shown.parameters.iter().cloned()).collect();
        let different: BTreeSet<&String> = all.iter().collect();
        assert_eq!(all.len(), different.len(), "{all:?}");
    }
}

#[test]
fn zeros_of_a_determinant_are_told_as_far_as_one_joint_decides() {
    let zeros = |joints: &[&str], task: &str| {
        let joints: String = joints
            .iter()
            .enumerate()
            .map(|(i, row)| format!("  - {{name: j{i}, {row}, link: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n"))
            .collect();
        let text = format!(
            "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\nparameters: {{l1: 2, l2: 3}}\ntask: {task}\njoints:\n{joints}"
        );
        let sheet = sheet(&text, &["determinant"], Reading::Symbolic);
        let factors = sheet.quantities[0].factors(Notation::Text).expect("factors");
        factors.into_iter().map(|(factor, zeros)| format!("{factor}: {}", zeros.sentence())).collect::<Vec<_>>()
    };
    let planar = ["type: revolute, a: l1, alpha: 0, d: 0, theta: 0", "type: revolute, a: l2, alpha: 0, d: 0, theta: 0"];
    assert_eq!(zeros(&planar, "[x, y]"), ["sin(q2): zero at q2 = 0 mod pi", "l1*l2: zero where its parameters alone make it so"]);
    let spherical = [
        "type: revolute, a: 0, alpha: -pi/2, d: l1, theta: 0",
        "type: revolute, a: 0, alpha: pi/2, d: 0, theta: 0",
        "type: prismatic, a: 0, alpha: 0, d: 1/5, theta: 0",
    ];
    assert_eq!(
        zeros(&spherical, "[x, y, z]"),
        ["-1/25*sin(q2): zero at q2 = 0 mod pi", "1 + 10*q3 + 25*q3^2: zero at q3 = -1/5"]
    );
    let gantry = ["type: prismatic, a: 0, alpha: pi/2, d: 0, theta: 0", "type: prismatic, a: 0, alpha: 0, d: 0, theta: 0"];
    assert_eq!(zeros(&gantry, "[y, z]"), ["1: never zero"]);
}

#[test]
fn latex_names_and_numbers() {
    let text = sheet(PENDULUM, &["gravity", "kinetic_energy"], Reading::Symbolic).latex();
    assert!(text.contains("g(q) = \\frac{981}{100}"), "{text}");
    assert!(text.contains("\\frac{1}{200}"), "{text}");
}

#[test]
fn sums_break_at_their_outermost_signs() {
    let measure = |s: &str| s.chars().count();
    assert_eq!(break_sum("a + (b + c)*d - e", 12, &measure), ["a", "+ (b + c)*d", "- e"]);
    assert_eq!(break_sum("a + b", 80, &measure), ["a + b"]);
}

#[test]
fn a_determinant_that_does_not_exist_says_why() {
    let sheet = sheet(PENDULUM, &["determinant"], Reading::Nominal);
    assert!(sheet.quantities.is_empty());
    assert_eq!(
        sheet.absent,
        [Absent {
            function: "determinant".into(),
            reason: "the task has 6 rows and the arm 1 joints: its Jacobian is not square".into()
        }]
    );
    assert_eq!(sheet.text(), "determinant: the task has 6 rows and the arm 1 joints: its Jacobian is not square\n");
}
