//! Output for small arms, in each notation.

use super::*;
use crate::catalogue::Absent;
use crate::ring::Symbol;
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
    let items: Vec<Item> = names.iter().flat_map(|name| Item::named(name, model.manipulator.dof(), &[])).collect();
    assert!(names.is_empty() || !items.is_empty());
    Sheet::new(&model, if names.is_empty() { Item::all(&[]) } else { items }.as_slice(), reading)
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
fn load_friction_is_shown_by_the_size_of_gravity() {
    let text = PENDULUM.replace("    link:", "    friction: {coulomb: 1/4, load: 1/20}\n    link:");
    for (name, expected) in [
        ("load_friction", "load_friction: F_l(q, dq)\n  fl = 1/20*sign(dq1)*abs(g1)"),
        (
            "inverse_dynamics",
            "inverse_dynamics: tau(q, dq, ddq)\n  tau = 981/100*cos(q1) + 51/100*ddq1 + sign(dq1)*(1/4 + 1/20*abs(g1))",
        ),
    ] {
        assert_eq!(sheet(&text, &[name], Reading::Nominal).text().trim_end(), expected);
    }
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
    // Seven joints: the frame's entries t11..t44 next to more than eleven steps.
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
        let printer = Printer {
            notation: Notation::Latex,
            parameters: &shown.parameters,
            velocities: &shown.velocities,
            computed: None,
            digits: None,
        };
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
    assert!(text.contains("\\frac{1}{100} + m"), "{text}");
}

#[test]
fn sums_break_at_their_outermost_signs() {
    let broken = |formula, width| lines::broken(formula, Notation::Text, width);
    assert_eq!(broken("a + (b + c)*d - e", 12), ["a", "+ (b + c)*d", "- e"]);
    assert_eq!(broken("a + b", 80), ["a + b"]);
    // Where no outermost sign is near enough: between factors, then within parentheses, however deep.
    assert_eq!(broken("aaaa*bbbb*cccc + d", 9), ["aaaa*bbbb", "*cccc + d"]);
    assert_eq!(broken("a*(bbbb + cc*(dddd + eeee))", 9), ["a*(bbbb", "+ cc", "*(dddd", "+ eeee))"]);
    let latex = |formula, width| lines::broken(formula, Notation::Latex, width);
    // Braces are one thing, and \\left is not parted from \\right.
    assert_eq!(latex("\\frac{a + b}{c} + d", 20), ["\\frac{a + b}{c}", "+ d"]);
    assert_eq!(latex("aaa\\,\\left(b + c\\right)", 22), ["aaa", "\\cdot \\bigl(b", "+ c\\bigr)"]);
}

#[test]
fn a_determinant_that_does_not_exist_says_why() {
    let sheet = sheet(PENDULUM, &["determinant"], Reading::Nominal);
    assert!(sheet.quantities.is_empty());
    assert_eq!(
        sheet.absent,
        [Absent {
            function: "determinant".into(),
            reason: "the task has 6 rows and the arm 1 joint: its Jacobian never has as many independent rows; name fewer rows under `task`"
                .into()
        }]
    );
    assert!(sheet.text().starts_with("determinant: the task has 6 rows"), "{}", sheet.text());
}

const TWO_LINKS: &str = "
name: two_links
convention: standard
gravity: [0, -9.81, 0]
task: [x, y]
joints:
  - {name: j1, type: revolute, a: 1/2, alpha: 0, d: 0, theta: 0, link: {mass: 3, com: [-1/4, 0, 0], inertia: {zz: 0.01}}}
  - {name: j2, type: revolute, a: 1/3, alpha: 0, d: 0, theta: 0, link: {mass: 2, com: [-1/7, 0, 0], inertia: {zz: 0.01}}}
";

fn in_style(text: &str, name: &str, style: Style) -> Shown {
    let model = Model::new(validate::read(&Source::new("test.yaml", text)).0.expect("valid").0);
    Sheet::in_style(&model, &Item::named(name, model.manipulator.dof(), &[]), Reading::Nominal, style).quantities.remove(0)
}

#[test]
fn the_shortest_form_is_no_longer_than_the_others() {
    let mut kinds = BTreeSet::new();
    for item in Item::all(&[]).into_iter().filter(|item| item.said_missing()) {
        let name = item.name();
        let of = |form| in_style(TWO_LINKS, &name, Style { form, digits: None });
        let (shortest, closed, steps) = (of(Form::Shortest), of(Form::Closed), of(Form::Steps));
        match closed.is_table() {
            true => assert!(shortest.is_closed(), "{name}"),
            false => assert_eq!(shortest.length(), closed.length().min(steps.length()), "{name}"),
        }
        assert!(!steps.is_closed(), "{name}");
        kinds.insert((closed.is_closed(), shortest.is_closed()));
    }
    // Closed forms that are the shortest, those that are not, and functions without one.
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), [(false, false), (true, false), (true, true)]);
}

#[test]
fn constants_have_as_many_digits_as_asked_for() {
    let text = |digits| {
        in_style(TWO_LINKS, "gravity", Style { form: Form::Closed, digits: Some(digits) }).formulas(Notation::Text).entries
    };
    assert_eq!(text(3), ["3.74*cos(q1 + q2) + 17.2*cos(q1)", "3.74*cos(q1 + q2)"]);
    assert_eq!(text(6)[1], "3.73714*cos(q1 + q2)");
    let printer = |notation| Printer { notation, parameters: &[], velocities: &[], computed: None, digits: Some(3) };
    let shown = |notation, numerator: i64, denominator: i64| {
        let number =
            crate::exact::Number::from(crate::exact::Rational::from(numerator) / crate::exact::Rational::from(denominator));
        printer(notation).number(&number)
    };
    for (numerator, denominator, text, latex) in [
        (1, 1, "1", "1"),
        (-2, 3, "-0.667", "-0.667"),
        (99_999, 100, "1000", "1000"),
        (1, 30_000, "3.33e-5", "3.33 \\cdot 10^{-5}"),
        (1, 1_000_000, "1e-6", "10^{-6}"),
        (123_456_789, 1, "1.23e8", "1.23 \\cdot 10^{8}"),
        (123_456, 1, "123000", "123000"),
    ] {
        assert_eq!(
            (shown(Notation::Text, numerator, denominator), shown(Notation::Latex, numerator, denominator)),
            (text.into(), latex.into())
        );
    }
}

#[test]
fn a_determinant_begins_with_its_factors() {
    let shown = in_style(TWO_LINKS, "determinant", Style::default());
    assert_eq!(
        shown.text(),
        "determinant: det J(q), the product of\n  factor  1/6*sin(q2)\n          zero at q2 = 0 mod pi\nmultiplied out\n  det J = 1/6*sin(q2)\n"
    );
}

/// A planar arm of three links whose task is a position.
const THREE_LINKS: &str = "
name: three_links
convention: standard
gravity: [0, -9.81, 0]
parameters: {l1: 2, l2: 3, l3: 1}
task: [x, y]
joints:
  - {name: j1, type: revolute, a: l1, alpha: 0, d: 0, theta: 0, link: {mass: 1, inertia: {zz: 1}}}
  - {name: j2, type: revolute, a: l2, alpha: 0, d: 0, theta: 0, link: {mass: 1, inertia: {zz: 1}}}
  - {name: j3, type: revolute, a: l3, alpha: 0, d: 0, theta: 0, link: {mass: 1, inertia: {zz: 1}}}
";

#[test]
fn minors_of_a_planar_arm_are_those_of_the_textbook() {
    assert_eq!(
        sheet(THREE_LINKS, &["determinant"], Reading::Symbolic).text(),
        "determinant: det(J J') = d1^2 + ... + d3^2, dk the determinant of J without column k\n\
         J loses rank where all of the following are zero together\n  d1 = sin(q3)*l2*l3\n  \
         d2 = sin(q2 + q3)*l1*l3 + sin(q3)*l2*l3\n  d3 = sin(q2 + q3)*l1*l3 + sin(q2)*l1*l2\n"
    );
}

#[test]
fn minors_of_shoulder_elbow_and_wrist_share_the_sine_of_the_elbow() {
    let iiwa = sheet(include_str!("../../../tests/data/iiwa14.yaml"), &["determinant"], Reading::Nominal);
    let text = iiwa.text();
    assert!(text.contains("dk times the product of\n  factor  21/25000*sin(q4)\n          zero at q4 = 0 mod pi\n"), "{text}");
    // Without joint 4 the wrist stays as far from the shoulder as it is.
    assert!(text.contains("\n  d1 = -80*cos(q3)*sin(q4)*sin(q6)\n") && text.ends_with("\n  d4 = 0\n"), "{text}");
    let latex = iiwa.latex();
    for part in ["$\\det(J J^T) = D_1^2 + \\dots + D_{7}^2$", "\\sin q_{4}", "d_{4} &= 0\n"] {
        assert!(latex.contains(part), "{latex}");
    }
    let json = serde_json::to_value(&iiwa.quantities[0]).expect("JSON");
    assert_eq!(json["common_factors"], serde_json::json!(["21/25000*sin(q4)"]));
    assert_eq!(json["singular"], serde_json::json!(["q4 = 0 mod pi"]));
    assert_eq!(json["entries"][5], serde_json::json!(["84*sin(q2)*sin(q4)*sin(q5)*sin(q6)"]));
}

/// sin q q̇ would read as the sine of a product.
#[test]
fn typeset_functions_stand_behind_other_factors() {
    let scara = include_str!("../../../robots/scara.yaml");
    let latex = sheet(scara, &["coriolis_matrix"], Reading::Nominal).latex();
    assert!(latex.contains("-5\\,\\dot q_{2}\\,\\sin q_{2} & -5\\,(\\dot q_{1} + \\dot q_{2})\\,\\sin q_{2} &"), "{latex}");
}

#[test]
fn equal_minors_are_shown_once_and_what_is_never_zero_is_said() {
    // Two slides about one line, and one across: without the third nothing is left.
    let slide = |alpha: &str| format!("type: prismatic, a: 0, alpha: {alpha}, d: 0, theta: 0, link: {{mass: 1}}}}");
    let text = format!(
        "name: gantry\nconvention: standard\ngravity: [0, 0, -9.81]\ntask: [y, z]\njoints:\n  - {{name: a, {}\n  - {{name: b, {}\n  - {{name: c, {}\n",
        slide("0"),
        slide("pi/2"),
        slide("0")
    );
    let text = sheet(&text, &["determinant"], Reading::Nominal).text();
    assert!(text.contains("J never loses rank\n  d1 = d2 = 1\n  d3      = 0\n"), "{text}");
}

#[test]
fn minors_that_are_too_long_or_too_many_say_where_to_look() {
    let ask = "`armgen page ROBOT.yaml --out robot.html` shows w = sqrt(det(J J')) at any posture, 0 where J loses rank";
    for (text, reason) in [
        (THREE_LINKS.replace("[x, y]", "[x]"), "the task has 1 row and the arm 3 joints: its Jacobian is not square"),
        (
            THREE_LINKS.replace("theta: 0", "theta: 0.7"),
            "the task has 2 rows and the arm 3 joints: the minors of its Jacobian are too long",
        ),
    ] {
        assert_eq!(sheet(&text, &["determinant"], Reading::Nominal).absent[0].reason, format!("{reason}; {ask}"));
    }
}
