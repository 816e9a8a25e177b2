use super::*;
use crate::diagnostic::Colour;
use crate::exact::{Number, Rational};
use crate::kinds::{JointKind, ParameterId, TaskRow};
use crate::manipulator::{Joint, LinkId, Placement, RegressorChoice};

/// The arm with the faults that need no equations.
fn read(source: &Source) -> (Option<(Manipulator, Places)>, Diagnostics) {
    structure(source, Scalar::F64).finish()
}

/// A one-joint arm; `edits` replace parts of it, and an edit without a match is appended.
fn arm(edits: &[(&str, &str)]) -> String {
    let mut text = "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\nparameters: {}\njoints:\n  - name: shoulder\n    \
                    type: revolute\n    a: 0.5\n    alpha: pi/2\n    d: 0.25\n    theta: 0\n    link: {mass: 2}\n"
        .to_owned();
    for (old, new) in edits {
        match old.is_empty() {
            true => text += new,
            false => {
                assert!(text.contains(old), "{old} in {text}");
                text = text.replacen(old, new, 1);
            }
        }
    }
    text
}

#[track_caller]
fn valid(text: &str) -> (Manipulator, Places) {
    let source = Source::new("robot.yaml", text);
    let (read, diagnostics) = read(&source);
    read.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never)))
}

/// Expects these codes, in the order of the text, and an arm just where none is an error.
#[track_caller]
fn check(text: &str, codes: &[Code]) {
    let source = Source::new("robot.yaml", text);
    let (read, diagnostics) = read(&source);
    // The numbers of these texts are not those of arms.
    let of_values = |code: &Code| *code >= Code::ImplausibleReach;
    let found: Vec<_> =
        diagnostics.iter().map(|d| d.code).filter(|c| !Code::ALL.iter().any(|v| *c == *v && of_values(v))).collect();
    assert_eq!(found, codes, "{}", diagnostics.render(&source, Colour::Never));
    assert_eq!(read.is_some(), !diagnostics.has_errors());
}

fn only(text: &str) -> Joint {
    valid(text).0.joints.remove(0)
}

fn n(numerator: i64, denominator: i64) -> Number {
    Number::from(Rational::from(numerator) / Rational::from(denominator))
}

fn matrix(rows: [[i64; 3]; 3]) -> [[Number; 3]; 3] {
    rows.map(|row| row.map(Number::from))
}

fn position(placement: &Placement) -> [Number; 3] {
    placement.translation.each_ref().map(|t| t.as_number().expect("a number"))
}

#[test]
fn a_standard_row_turns_before_the_joint_and_twists_after_it() {
    let joint = only(&arm(&[("theta: 0", "theta: pi/2")]));
    assert_eq!(joint.placement.rotation, matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]]));
    assert_eq!(position(&joint.placement), [n(0, 1), n(0, 1), n(1, 4)]);
    assert_eq!(joint.link_frame.rotation, matrix([[1, 0, 0], [0, 0, -1], [0, 1, 0]]));
    assert_eq!(position(&joint.link_frame), [n(1, 2), n(0, 1), n(0, 1)]);
}

#[test]
fn a_modified_row_stands_wholly_before_the_joint() {
    let joint = only(&arm(&[("standard", "modified"), ("{mass: 2}", "{mass: 2, com: [1, 0, 0]}")]));
    // Rx(pi/2) Tx(1/2) Tz(1/4): z of the joint frame is -y of the base, so the offset goes there.
    assert_eq!(joint.placement.rotation, matrix([[1, 0, 0], [0, 0, -1], [0, 1, 0]]));
    assert_eq!(position(&joint.placement), [n(1, 2), n(-1, 4), n(0, 1)]);
    assert_eq!(joint.link_frame, Placement::identity());
}

#[test]
fn the_second_joint_stands_in_the_first_ones_joint_frame() {
    let second = "  - {name: elbow, type: prismatic, a: 0, alpha: 0, d: 1, theta: 0, link: {mass: 1}}\n";
    let (arm, _) = valid(&arm(&[("", second)]));
    let joint = &arm.joints[1];
    // Tx(1/2) Rx(pi/2) Tz(1)
    assert_eq!(position(&joint.placement), [n(1, 2), n(-1, 1), n(0, 1)]);
    assert_eq!(joint.placement.rotation, matrix([[1, 0, 0], [0, 0, -1], [0, 1, 0]]));
    assert_eq!((joint.parent, joint.kind, arm.tip), (Some(LinkId(0)), JointKind::Prismatic, LinkId(1)));
}

#[test]
fn three_ways_to_write_a_right_angle_are_one() {
    let turns = ["pi/2", "deg(90)", "90*pi/180", "pi - pi/2", "\"deg(45)*2\""];
    let arms = turns.map(|t| only(&arm(&[("alpha: pi/2", &format!("alpha: {t}"))])).link_frame);
    assert!(arms.iter().all(|frame| *frame == arms[0]));
}

#[test]
fn what_is_not_given_has_the_value_of_the_format() {
    let (arm, places) = valid(&arm(&[("link:", "motor: {}\n    link:")]));
    assert_eq!(arm.task, TaskRow::ALL);
    assert_eq!(arm.regressor, RegressorChoice::Standard);
    assert_eq!(arm.tool.frame, Placement::identity());
    assert!(arm.payload.is_none() && arm.parameters.is_empty());
    assert_eq!((places.tasks, places.regressor), (vec![None], None));
    let joint = &arm.joints[0];
    assert!(joint.viscous.is_none() && joint.coulomb.is_none() && joint.limits.position.is_none());
    assert!(joint.link[0].body.com.iter().chain(&joint.link[0].body.inertia).all(Polynomial::is_zero));
    let motor = joint.motor.as_ref().expect("a motor");
    assert_eq!(motor.ratio.as_number(), Some(Number::one()));
    assert!(motor.inertia.is_none() && motor.viscous.is_none() && motor.mass.is_zero());
    assert_eq!(motor.axis, [0, 0, 1].map(Number::from));
}

#[test]
fn the_axis_of_a_motor_is_the_joint_axis_or_the_normalised_direction() {
    let motor = |edits: &[(&str, &str)]| only(&arm(edits)).motor.expect("a motor").axis;
    let link = ("link:", "motor: {inertia: 1}\n    link:");
    assert_eq!(motor(&[link, ("standard", "modified")]), [0, -1, 0].map(Number::from));
    let half = n(1, 2);
    let root = &n(3, 1).sqrt().expect("positive") * &half;
    assert_eq!(motor(&[link, ("standard", "modified"), ("alpha: pi/2", "alpha: pi/6")]), [n(0, 1), -&half, root]);
    let axis = motor(&[("link:", "motor: {inertia: 1, axis: [1, 0, -2]}\n    link:")]);
    let fifth = n(1, 5).sqrt().expect("positive");
    assert_eq!(axis, [fifth.clone(), n(0, 1), -&(&fifth * &n(2, 1))]);
}

#[test]
fn the_tool_turns_about_fixed_axes_x_y_z_in_turn() {
    let tool = |rpy: &str| valid(&arm(&[("", &format!("tool: {{xyz: [1, 2, 3], rpy: {rpy}}}\n"))])).0.tool;
    let turned = tool("[pi/2, 0, pi/2]");
    // Rz(pi/2) Rx(pi/2)
    assert_eq!(turned.frame.rotation, matrix([[0, 0, 1], [1, 0, 0], [0, 1, 0]]));
    assert_eq!(position(&turned.frame), [1, 2, 3].map(Number::from));
    assert_eq!(tool("[0, pi/2, 0]").frame.rotation, matrix([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]));
}

#[test]
fn an_empty_payload_is_a_load_of_zero() {
    let payload = valid(&arm(&[("", "payload: {}\n")])).0.payload.expect("a payload");
    assert!(payload.body.mass.is_zero() && payload.body.com.iter().chain(&payload.body.inertia).all(Polynomial::is_zero));
}

#[test]
fn inertia_stands_in_the_order_xx_xy_yy_xz_yz_zz() {
    let text = arm(&[("{mass: 2}", "{mass: 2, inertia: {xx: 11, yy: 12, zz: 13, xy: 1, xz: 2, yz: 3}}")]);
    let inertia = only(&text).link[0].body.inertia.clone().map(|p| p.as_number().expect("a number"));
    assert_eq!(inertia, [11, 1, 12, 2, 3, 13].map(Number::from));
}

#[test]
fn names_stay_symbols_where_they_enter_as_polynomials() {
    let text = arm(&[("parameters: {}", "parameters: {m: 4, l: 1, n: 3}"), ("a: 0.5", "a: l/2"), ("mass: 2", "mass: m*n - n")]);
    let (arm, places) = valid(&text);
    let names: Vec<&str> = arm.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["m", "l", "n"]);
    let mass = &arm.joints[0].link[0].body.mass;
    assert_eq!(mass.variables().into_iter().collect::<Vec<_>>(), [ParameterId(0), ParameterId(2)]);
    assert_eq!(mass.evaluate(&|id| arm.parameters[id.0 as usize].nominal.clone()), n(9, 1));
    assert_eq!(places.uses[2].len(), 2);
    assert_eq!(places.uses[1][0].role, Role::Length);
    let source = Source::new("robot.yaml", text);
    assert_eq!(source.slice(places.uses[1][0].span), "l");
    assert_eq!(source.slice(places.joints[0].mass), "m*n - n");
}

#[test]
fn a_divisor_a_root_and_an_angle_make_numbers_of_their_names() {
    let text = arm(&[
        ("parameters: {}", "parameters: {m: 4, k: 2, r: 9, t: 0.3, h: 2*k, s: m + 1}"),
        ("a: 0.5", "a: m/h + sqrt(r)"),
        ("alpha: pi/2", "alpha: t"),
        ("mass: 2", "mass: k*m + r + t + s"),
    ]);
    let (arm, _) = valid(&text);
    // h abbreviates 2 k and s abbreviates m + 1; k, r and t are numbers.
    let names: Vec<&str> = arm.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["m"]);
    let m = Polynomial::variable(ParameterId(0));
    let constant = |v: Number| Polynomial::from(v);
    assert_eq!(arm.joints[0].link[0].body.mass, &(&m * &constant(n(3, 1))) + &constant(n(103, 10)));
    assert_eq!(arm.joints[0].link_frame.translation[0], &(&m * &constant(n(1, 4))) + &constant(n(3, 1)));
}

#[test]
fn a_listed_name_is_independent_of_the_names_in_its_value() {
    let text = arm(&[("parameters: {}", "parameters: {m: 4, h: m/2}"), ("mass: 2", "mass: h + m"), ("", "regressor: [h]\n")]);
    let (arm, _) = valid(&text);
    assert_eq!(arm.regressor, RegressorChoice::Names(vec![ParameterId(1)]));
    assert_eq!(arm.parameters[1].nominal, n(2, 1));
    assert_eq!(arm.joints[0].link[0].body.mass.variables().len(), 2);
    let text = text.replace("regressor: [h]", "regressor: [m]");
    assert_eq!(valid(&text).0.joints[0].link[0].body.mass.variables().len(), 1);
}

#[test]
fn numbers_that_a_float_cannot_hold_are_errors() {
    for (mass, codes) in [
        ("1e308", &[][..]),
        ("1e309", &[Code::OutOfRange]),
        ("1e-323", &[]),
        ("1e-324", &[Code::OutOfRange]),
        ("1e400*1e-400", &[]),
        ("0*1e400", &[]),
        ("sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2)", &[]),
        ("1e999999999", &[Code::OutOfRange]),
    ] {
        check(&arm(&[("mass: 2", &format!("mass: {mass}, inertia: {{xx: 1, yy: 1, zz: 1}}"))]), codes);
    }
    let source = Source::new("robot.yaml", arm(&[("mass: 2", "mass: 1e39")]));
    assert!(structure(&source, Scalar::F64).finish().0.is_some());
    assert!(structure(&source, Scalar::F32).finish().0.is_none());
}

#[test]
fn angles_near_a_multiple_of_a_twelfth_of_pi_are_doubted() {
    let warned = |alpha: &str| {
        let source = Source::new("robot.yaml", arm(&[("alpha: pi/2", &format!("alpha: {alpha}"))]));
        let (_, diagnostics) = read(&source);
        diagnostics.iter().map(|d| d.code).collect::<Vec<_>>()
    };
    for near in ["1.5708", "1.57", "-1.57", "3.14159", "0.2618", "1.5727", "3.1416/2", "6.2832", "1.5707963267948966"] {
        assert_eq!(warned(near), [Code::RoundedAngle], "{near}");
    }
    for far in ["0", "0.001", "-0.0019", "1.5729", "1.5687", "0.7", "pi/2", "deg(90)", "1.57*pi/pi + 0.1", "deg(1.5708)"] {
        assert_eq!(warned(far), [] as [Code; 0], "{far}");
    }
    for degrees in ["90", "-90", "45", "6.3"] {
        assert_eq!(warned(degrees), [Code::DegreesSuspected], "{degrees}");
    }
    assert_eq!(warned("4*pi"), [] as [Code; 0]);
    assert_eq!(warned("1000001"), [Code::OutOfRange]);
}

#[test]
fn inertia_is_judged_exactly() {
    let with = |inertia: &str| arm(&[("{mass: 2}", &format!("{{mass: 2, inertia: {{{inertia}}}}}"))]);
    check(&with("xx: 1, yy: 1, zz: 2"), &[]);
    check(&with("xx: 1, yy: 1, zz: 2.0000000000000000000000001"), &[Code::TriangleInequality]);
    check(&with("zz: 4"), &[Code::TriangleInequality]);
    check(&with("xx: 2, yy: 3, zz: 3, xy: sqrt(6)"), &[Code::TriangleInequality]);
    check(&with("xx: 2, yy: 3, zz: 5, xy: sqrt(6)"), &[]);
    check(&with("xx: 2, yy: 3, zz: 5, xy: sqrt(6) + 1e-30"), &[Code::ImpossibleInertia]);
    check(&with("xy: 1"), &[Code::ImpossibleInertia]);
    check(&with("xx: 1, yy: 1, zz: 1, xy: 0.9, yz: 0.9, xz: -0.9"), &[Code::ImpossibleInertia]);
    check(&with("xx: -1"), &[Code::ImpossibleInertia]);
    check(&with("xx: a*"), &[Code::BadExpression]);
}

#[test]
fn growth_is_bounded() {
    let mut parameters = String::from("parameters:\n  x0: 2*sqrt(3) + pi\n");
    let mut symbols = String::from("parameters:\n  a: 1\n  b: 2\n  x0: a + b\n");
    for i in 1..100 {
        parameters += &format!("  x{i}: x{}*x{}\n", i - 1, i - 1);
        symbols += &format!("  x{i}: x{}*x{}\n", i - 1, i - 1);
    }
    check(&arm(&[("parameters: {}\n", &parameters), ("mass: 2", "mass: x99")]), &[Code::TooComplex]);
    check(&arm(&[("parameters: {}\n", &symbols), ("mass: 2", "mass: x99")]), &[Code::OutOfRange]);
    check(&arm(&[("mass: 2", "mass: sqrt(sqrt(sqrt(sqrt(sqrt(sqrt(sqrt(2 + pi)))))))")]), &[Code::TooComplex]);
    check(&arm(&[("mass: 2", "mass: 1/(1 + 1/(2 + 1/(3 + 1/(4 + pi))))")]), &[Code::TooComplex]);
    check(&arm(&[("mass: 2", "mass: sqrt(2 + sqrt(2 + sqrt(2)))")]), &[]);
    let chain: String = (1..1000).map(|i| format!("  x{i}: x{}\n", i - 1)).collect();
    let (arm, _) = valid(&arm(&[("parameters: {}\n", &format!("parameters:\n  x0: 2\n{chain}")), ("a: 0.5", "a: 1/x999")]));
    assert!(arm.parameters.is_empty());
}

#[test]
fn a_zero_that_no_reduction_sees_stands_in_no_ones_way() {
    // sqrt(3 - 2 sqrt(2)) is sqrt(2) - 1, so that each of these has a conjugate that is 0.
    check(&arm(&[("mass: 2", "mass: 1/(sqrt(3 - 2*sqrt(2)) + 1 + sqrt(2))")]), &[]);
    let motor = "    motor: {inertia: 1, axis: [sqrt(sqrt(3-2*sqrt(2))), 1, sqrt(sqrt(2))]}\n";
    let motor = only(&arm(&[("", motor)])).motor.expect("a motor");
    let length: f64 = motor.axis.iter().map(|x| x.to_f64() * x.to_f64()).sum();
    assert!((length - 1.0).abs() < 1e-15);
    check(&arm(&[("mass: 2", "mass: 1/(sqrt(3 - 2*sqrt(2)) + 1 - sqrt(2))")]), &[Code::DivisionByZero]);
    let axis = |x: &str| arm(&[("", &format!("    motor: {{inertia: 1, axis: [{x}]}}\n"))]);
    check(&axis("sqrt(3 - 2*sqrt(2)) + 1 - sqrt(2), 0, 0"), &[Code::ZeroAxis]);
    let long = "1+sqrt(2)+sqrt(3)+sqrt(5)+sqrt(7)+sqrt(11)+sqrt(13)";
    check(&axis(&format!("{long}, 1, ({long})*pi")), &[Code::TooComplex]);
}

#[test]
fn many_unknown_names_are_reported_but_not_all_guessed_at() {
    let sum = |n: usize| (0..n).map(|i| format!("gear{i}")).collect::<Vec<_>>().join("+");
    let parameters = "parameters:\n  gear: 2\n";
    let edits = [("parameters: {}\n", parameters), ("a: 0.5", "a: gear"), ("d: 0.25", &format!("d: {}", sum(100)))];
    let source = Source::new("robot.yaml", arm(&edits));
    let (_, diagnostics) = read(&source);
    assert_eq!(diagnostics.errors(), 100);
    assert_eq!(diagnostics.iter().filter(|d| d.help.starts_with("did you mean")).count(), 50);
    let regressor = format!("regressor: [{}]\n", sum(100).replace('+', ", "));
    let source = Source::new("robot.yaml", arm(&[("parameters: {}\n", parameters), ("a: 0.5", "a: gear"), ("", &regressor)]));
    let (_, diagnostics) = read(&source);
    assert_eq!(diagnostics.errors(), 100);
    assert_eq!(diagnostics.iter().filter(|d| d.help.starts_with("did you mean")).count(), 50);
}

#[test]
fn names_are_counted() {
    let parameters = |n: usize| format!("parameters:\n{}", (0..n).map(|i| format!("  p{i}: 1\n")).collect::<String>());
    check(&arm(&[("parameters: {}\n", &parameters(MAX_PARAMETERS))]), &[Code::UnusedParameter; MAX_PARAMETERS]);
    check(&arm(&[("parameters: {}\n", &parameters(MAX_PARAMETERS + 1))]), &[Code::TooLarge]);
}

#[test]
fn terms_are_counted_over_all_values() {
    let names = |letter: &str, n: usize| (0..n).map(|i| format!("{letter}{i}")).collect::<Vec<_>>();
    let mut parameters = String::from("parameters:\n");
    names("a", 100).iter().for_each(|name| parameters += &format!("  {name}: 1\n"));
    parameters += &format!("  s: {}\n", names("a", 100).join("+"));
    let body = "{mass: s, com: [s, s, s], inertia: {xx: s, yy: s, zz: s}}";
    check(&arm(&[("parameters: {}\n", &parameters), ("{mass: 2}", body)]), &[]);
    // Each of them has as many terms as the sum.
    (0..MAX_PARAMETERS - 101).for_each(|i| parameters += &format!("  t{i}: s + {i}\n"));
    let last = format!("t{}", MAX_PARAMETERS - 102);
    let text = arm(&[("parameters: {}\n", &parameters), ("mass: 2", &format!("mass: {last}"))]);
    let (_, diagnostics) = structure(&Source::new("robot.yaml", text), Scalar::F64).finish();
    assert_eq!(diagnostics.iter().filter(|d| d.code == Code::TooComplex).count(), 1);
}

#[test]
fn the_longest_expressions_need_little_stack() {
    let sum = |operators: usize| vec!["1"; operators + 1].join(if operators.is_multiple_of(2) { "+" } else { "*" });
    let nested = |operators: usize| "(".repeat(31) + &sum(operators) + &")".repeat(31);
    for (text, codes) in
        [(sum(128), &[][..]), (nested(128), &[]), (sum(129), &[Code::TooComplex]), (sum(999), &[Code::TooComplex])]
    {
        let text = arm(&[("mass: 2", &format!("mass: {text}"))]);
        let read = move || check(&text, codes);
        std::thread::Builder::new().stack_size(512 << 10).spawn(read).expect("a thread").join().expect("no overflow");
    }
}

#[test]
fn a_name_that_is_used_above_its_definition_is_not_called_unused() {
    let text = arm(&[("parameters: {}", "parameters: {a: b, b: 2, c: 1}"), ("a: 0.5", "a: a")]);
    check(&text, &[Code::UnknownName, Code::UnusedParameter]);
}

/// No doubt about arms as their makers publish them; where what is published is absurd, it is found.
#[test]
fn published_arms_are_plausible() {
    let warned = |file: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
        let source = Source::new(file, std::fs::read_to_string(path).unwrap());
        let (valid, diagnostics) = read(&source);
        assert!(valid.is_some(), "{}", diagnostics.render(&source, Colour::Never));
        diagnostics.iter().map(|d| d.code.name()).filter(|name| *name != Code::TriangleInequality.name()).collect::<Vec<_>>()
    };
    for folder in ["robots", "tests/robots"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
        for entry in std::fs::read_dir(path).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if name.ends_with(".yaml") {
                assert_eq!(warned(&format!("{folder}/{name}")), [] as [&str; 0], "{name}");
            }
        }
    }
    assert_eq!(warned("tests/data/iiwa14.yaml"), [] as [&str; 0]);
    assert_eq!(warned("tests/experiments/robots/ur10.yaml"), [] as [&str; 0]);
    assert_eq!(warned("tests/data/stanford.yaml"), [Code::ImplausibleCom.name(); 3]);
}

/// Warnings of the values of an arm of three joints 0.05 m apart, whose links weigh 2, 1 and `last` kg.
#[track_caller]
fn check_values(last: &str, codes: &[Code]) {
    let joint = |name: &str, link: &str| {
        format!("  - {{name: {name}, type: revolute, a: 0, alpha: pi/2, d: 0.05, theta: 0, limits: {{velocity: 52.4}}, link: {link}}}\n")
    };
    let ball = |mass: u8| format!("{{mass: {mass}, inertia: {{xx: 0.01, yy: 0.01, zz: 0.01}}}}");
    let joints = [joint("j1", &ball(2)), joint("j2", &ball(1)), joint("j3", last)].concat();
    let source =
        Source::new("robot.yaml", format!("name: torso\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n{joints}"));
    let (_, diagnostics) = read(&source);
    let found: Vec<_> = diagnostics.iter().map(|d| d.code.name()).collect();
    assert_eq!(found, codes.iter().map(|code| code.name()).collect::<Vec<_>>(), "{}", diagnostics.render(&source, Colour::Never));
}

/// A torso above its hips: most of the mass, beyond the last frame, and with the inertia of what it is. The same mass without that is a
/// slip, of a point or of a unit.
#[test]
fn a_heavy_last_link_is_doubted_where_its_inertia_or_its_size_does_not_bear_it() {
    let torso = |mass: u32, far: f64, moment: f64| {
        format!("{{mass: {mass}, com: [0, 0, {far}], inertia: {{xx: {moment}, yy: {moment}, zz: {moment}}}}}")
    };
    check_values(&torso(17, 0.15, 0.3), &[]);
    check_values(&torso(17, 0.15, 0.03), &[Code::OutlyingMass]);
    check_values("{mass: 17, com: [0, 0, 0.15], inertia: {}}", &[Code::OutlyingMass]);
    check_values(&torso(17000, 0.15, 300.0), &[Code::ImplausibleMass]);
    check_values(&torso(17, 0.01, 0.3), &[Code::ImplausibleMass]);
}

/// The first message about an arm.
fn said_first(text: &str) -> String {
    let source = Source::new("robot.yaml", text);
    read(&source).1.render(&source, Colour::Never).split("\n\n").next().unwrap_or_default().to_owned()
}

#[test]
fn a_defined_name_is_meant_before_a_joint_variable() {
    let slide = ("type: revolute", "type: prismatic");
    for (edits, meant) in [
        (vec![("parameters: {}", "parameters: {theta_1: 0.3}"), ("theta: 0", "theta: theta1 + theta_1")], "`theta_1`"),
        (vec![slide, ("parameters: {}", "parameters: {d_2: 0.3}"), ("d: 0.25", "d: d2 + d_2")], "`d_2`"),
        (vec![slide, ("parameters: {}", "parameters: {D2: 0.3}"), ("d: 0.25", "d: d2 + D2")], "`D2`"),
    ] {
        let said = said_first(&arm(&edits));
        assert!(said.contains(&format!("did you mean {meant}?")), "{said}");
    }
    let said = said_first(&arm(&[("parameters: {}", "parameters: {theta_2: 0.3}"), ("theta: 0", "theta: theta1 + theta_2")]));
    assert!(said.contains("is added to `theta` by itself"), "{said}");
}

/// 2 kg of link carry 5 kg only with their motor of 1 kg, or where nothing weighs.
#[test]
fn a_payload_counts_against_links_and_motors_under_gravity() {
    let with = |edits: &[(&str, &str)]| {
        said_first(&arm(&[edits, &[("", "payload: {mass: 5, com: [0, 0, 0], inertia: {xx: 0.1, yy: 0.1, zz: 0.1}}\n")]].concat()))
    };
    assert!(with(&[]).contains("implausible-mass"), "{}", with(&[]));
    let (motor, space) = (("link:", "motor: {ratio: 50, mass: 1}\n    link:"), ("[0, 0, -9.81]", "[0, 0, 0]"));
    assert!(!with(&[motor]).contains("implausible-mass"), "{}", with(&[motor]));
    assert!(!with(&[space]).contains("implausible-mass"), "{}", with(&[space]));
}

#[test]
fn a_slide_by_the_radius_of_a_pinion_is_no_angle() {
    let said = |low: &str| {
        said_first(&arm(&[
            ("type: revolute", "type: prismatic"),
            ("parameters: {}", "parameters: {r: 0.02, turn: deg(30)}"),
            ("theta: 0", &format!("theta: 0\n    limits: {{position: [{low}, 2], velocity: r*turn}}")),
        ]))
    };
    for angle in ["-deg(180)", "-2*deg(90)", "deg(-180)*2", "-deg(180)/2", "-turn"] {
        assert!(said(angle).contains("degrees-suspected"), "{angle}: {}", said(angle));
    }
    for length in ["-r*deg(180)", "-0.02*deg(180)", "-deg(180)*r/2", "-1"] {
        assert!(!said(length).contains("degrees-suspected"), "{length}: {}", said(length));
    }
}

#[test]
fn the_longest_length_may_be_that_of_the_tool() {
    let said = said_first(&arm(&[("", "tool: {xyz: [0, 0, 29.9]}\n")]));
    assert!(said.contains("add up to 30.65 m") && said.contains("robot.yaml:13:1"), "{said}");
    let said = said_first(&arm(&[("a: 0.5", "a: 20"), ("", "tool: {xyz: [0, 0, 15]}\n")]));
    assert!(said.contains("add up to 35.25 m") && said.contains("robot.yaml:8:"), "{said}");
}

#[test]
fn names_have_no_blanks_that_are_none_of_yaml() {
    for blank in ['\u{a0}', '\u{1680}', '\u{2003}', '\u{202f}', '\u{205f}', '\u{3000}'] {
        let said = said_first(&arm(&[("name: arm", &format!("name: a{blank}b"))]));
        assert!(said.contains(&format!("U+{:04X}, which cannot be seen", u32::from(blank))), "{said}");
    }
}

#[test]
fn warnings_can_be_allowed() {
    let text = arm(&[("gravity: [0, 0, -9.81]", "gravity: [0, 0, -981]")]);
    let count = |text: &str| read(&Source::new("robot.yaml", text)).1.warnings();
    assert_eq!(count(&text), 1);
    assert_eq!(count(&format!("{text}\nallow: [implausible-gravity]\n")), 0);
    assert_eq!(count(&format!("{text}\nallow: [dust]\n")), 1);
}

/// Every key with a unit, in units and in SI: the same arm, to the last digit. The value 7 is drawn out by another factor at each key.
#[test]
fn values_in_units_are_those_in_si_exactly() {
    let arm = |units: &str, [length, angle, mass, inertia, rotor, rate, torque, speed, force]: [&str; 9], sign: &str| {
        let body = |com: &str| {
            format!(
                "{{mass: {mass}, com: [{com}, 0, 0], inertia: {{xx: {inertia}, yy: {inertia}, zz: {inertia}, xy: {sign}{inertia}/9, rpy: [{angle}, 0, 0]}}}}"
            )
        };
        format!(
            "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\n{units}base: {{xyz: [{length}, 0, 0], rpy: [0, {angle}, 0]}}\njoints:\n  \
             - {{name: j, type: revolute, a: {length}, alpha: {angle}, d: {length}, theta: {angle}, link: {j}, armature: {rotor}, \
             limits: {{position: [-{angle}, {angle}], velocity: {rate}, effort: {torque}}}, \
             motor: {{ratio: 7, inertia: {rotor}, mass: {mass}, position: [{length}, 0, 0], axis: [0, 7, 0], viscous: {torque}}}, \
             friction: {{viscous: {torque}, coulomb: {torque}, offset: {torque}, cubic: {torque}, load: 7, stribeck: {{torque: {torque}, velocity: {rate}}}}}, \
             spring: {{stiffness: {torque}, rest: {angle}}}}}\n  \
             - {{name: s, type: prismatic, a: 0, alpha: 0, d: 0, theta: 0, link: {j}, armature: {mass}, \
             limits: {{position: [-{length}, {length}], velocity: {speed}, effort: {force}}}, \
             friction: {{viscous: {force}, coulomb: {force}, stribeck: {{torque: {force}, velocity: {speed}}}}}, \
             spring: {{stiffness: {force}, rest: {length}}}}}\n\
             tool: {{xyz: [0, {length}, 0], axis: [0, 1, 0], angle: {angle}}}\npayload: {j}\n",
            j = body(length)
        )
    };
    let shown = |text: &str| format!("{:?}", valid(text).0);
    let units = "units: {length: mm, angle: deg, mass: lb, inertia: g mm^2, rotor_inertia: kg cm², angular_velocity: rpm, torque: lbf in, \
                 velocity: cm/s, force: mN}\n";
    let si = ["0.007", "deg(7)", "(7*0.45359237)", "(7*1e-9)", "0.0007", "deg(42)", "(7*0.1129848290276167)", "0.07", "0.007"];
    assert_eq!(shown(&arm(units, ["7"; 9], "")), shown(&arm("", si, "")));
    // Rates follow lengths and angles; integrals have the other sign.
    let of_lengths = ["0.007", "deg(7)", "7", "7", "7", "deg(7)", "7", "0.007", "7"];
    assert_eq!(shown(&arm("units: {length: mm, angle: deg}\n", ["7"; 9], "")), shown(&arm("", of_lengths, "")));
    assert_eq!(shown(&arm("products: integral\n", ["7"; 9], "")), shown(&arm("", ["7"; 9], "-")));
    assert_eq!(shown(&arm("products: tensor\n", ["7"; 9], "")), shown(&arm("", ["7"; 9], "")));
}

/// An expression is in the unit as a whole; angles that say radians keep them, and no sum has both.
#[test]
fn expressions_are_in_the_unit_as_a_whole() {
    let with = |edits: &[(&str, &str)]| {
        let units = [("parameters: {}", "units: {length: mm, angle: deg}\nparameters: {l: 200, t: pi/2, w: 90}")];
        arm(&[&units, edits].concat())
    };
    let joint = only(&with(&[
        ("a: 0.5", "a: 300/2 + l"),
        ("d: 0.25", "d: sqrt(2)"),
        ("theta: 0", "theta: w"),
        ("alpha: pi/2", "alpha: -t"),
    ]));
    let si = only(&arm(&[
        ("a: 0.5", "a: 0.35"),
        ("d: 0.25", "d: sqrt(2)/1000"),
        ("theta: 0", "theta: pi/2"),
        ("alpha: pi/2", "alpha: -pi/2"),
    ]));
    assert_eq!(format!("{:?}", joint.link_frame.rotation), format!("{:?}", si.link_frame.rotation));
    assert_eq!(format!("{:?}", joint.placement.rotation), format!("{:?}", si.placement.rotation));
    assert_eq!(joint.placement.translation[2].as_number(), si.placement.translation[2].as_number());
    for alpha in ["w + t", "90 - pi/2", "deg(5) + 5", "(t + 1)*2"] {
        check(
            &with(&[("alpha: pi/2", &format!("alpha: {alpha}")), ("theta: 0", "theta: w + 0*l"), ("a: 0.5", "a: l")]),
            &[Code::MixedUnits],
        );
    }
    check(&with(&[("alpha: pi/2", "alpha: t + 0"), ("theta: 0", "theta: deg(w)"), ("a: 0.5", "a: l")]), &[]);
}

/// A suggestion has every digit.
#[test]
fn suggestions_lose_no_digit() {
    let helps = |text: &str| {
        let (_, diagnostics) = structure(&Source::new("robot.yaml", text), Scalar::F64).finish();
        diagnostics.iter().map(|d| d.help.clone()).collect::<Vec<_>>().join("\n")
    };
    assert!(helps(&arm(&[("a: 0.5", "a: 169.77123456789")])).contains("write 0.16977123456789"));
    assert!(helps(&arm(&[("parameters: {}", "parameters: {l: 222.63}"), ("a: 0.5", "a: -l")])).contains("write 0.22263"));
    assert!(helps(&arm(&[("a: 0.5", "a: 100 + 22.5")])).contains("write (100 + 22.5)/1000"));
    let slipped = "{mass: 1.559, com: [0, -0.03, 0], inertia: {xx: 2661.9e-6, yy: 2302.5e-6, zz: 1676359e-6, xy: -31.029e-6, xz: 9.34e-6, yz: 151.466e-6}}";
    assert!(helps(&arm(&[("{mass: 2}", slipped), ("a: 0.5", "a: 0.2")])).contains("write `zz: 0.001676359`"));
    // Mass and tensor contradict each other: no single number is to blame.
    let either = "{mass: 0.007, inertia: {xx: 0.00152112, yy: 0.00138626, zz: 0.00031152}}";
    let said = helps(&arm(&[("{mass: 2}", either), ("a: 0.5", "a: 0.1"), ("d: 0.25", "d: 0")]));
    assert!(said.contains("check this tensor and the mass") && !said.contains("write"), "{said}");
}

/// Few whole turns of joints that turn are told from angles that functions compute, and long fractions are warned of.
#[test]
fn angles_that_are_no_whole_turns_are_computed() {
    let text = |follows: &str| {
        let joint = |name: &str, kind: &str, more: &str| {
            format!("  - {{name: {name}, type: {kind}, axis: [0, 0, 1], {more}link: {{mass: 1, com: [0, 0, 0], inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n")
        };
        let follows = format!("follows: {{{follows}}}, offset: 0.1, ");
        let joints = [
            joint("a", "revolute", ""),
            joint("b", "revolute", &follows),
            joint("c", "revolute", ""),
            joint("d", "prismatic", ""),
        ];
        format!("name: r\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n{}", joints.concat())
    };
    for (follows, factors, is_warned) in [
        ("a: 8, c: -8", None, false),
        ("a: 9, c: -8", Some(vec!["9", "-8"]), false),
        ("a: -0.5", Some(vec!["1/2"]), false),
        ("a: -2, d: 3", Some(vec!["2", "-3"]), false),
        ("a: -2, c: 0.5", Some(vec!["2", "-1/2"]), false),
        ("d: 1", Some(vec!["1"]), false),
        ("a: sqrt(2), c: 1/pi", Some(vec!["sqrt(2)", "pi^(-1)"]), false),
        ("a: 0.1234567890123", Some(vec!["1234567890123/10000000000000"]), true),
    ] {
        let (arm, diagnostics) = read(&Source::new("robot.yaml", text(follows)));
        let coupling = arm.and_then(|(arm, _)| arm.coupling).unwrap_or_else(|| panic!("{follows}: {diagnostics:?}"));
        let variable = &coupling.variables[1];
        let computed = variable.computed().map(|(angle, _)| angle);
        let found = computed.as_ref().map(|angle| angle.factors.iter().map(|(_, factor)| factor.to_string()).collect::<Vec<_>>());
        assert_eq!(
            (found, variable.is_whole),
            (factors.as_ref().map(|all| all.iter().map(ToString::to_string).collect()), factors.is_none()),
            "{follows}"
        );
        assert_eq!(coupling.computed(), Vec::from_iter(computed), "{follows}");
        assert_eq!(diagnostics.iter().any(|fault| fault.code == Code::UnrelatedFactor), is_warned, "{follows}");
    }
}

/// Sums of the variables of joints about parallel axes, of which one is a computed angle.
#[test]
fn sums_about_parallel_axes_are_found() {
    let joint = |name: &str, axis: &str, more: &str| {
        format!("  - {{name: {name}, type: revolute, origin: {{xyz: [0.1, 0, 0]}}, axis: {axis}, {more}link: {{mass: 1}}}}\n")
    };
    let joints = [
        joint("a", "[0, 0, 1]", ""),
        joint("b", "[0, 1, 0]", ""),
        joint("c", "[0, 1, 0]", "follows: {b: 2/3}, "),
        joint("d", "[0, -1, 0]", "follows: {b: 1/3}, offset: 0.1, "),
    ];
    let text = format!("name: arm\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n{}", joints.concat());
    let (arm, diagnostics) = read(&Source::new("robot.yaml", text));
    let coupling = arm.and_then(|(arm, _)| arm.coupling).unwrap_or_else(|| panic!("{diagnostics:?}"));
    let found = coupling.sums.iter().map(|sum| {
        let factors: Vec<String> = sum.variable.factors.iter().map(|(_, factor)| factor.to_string()).collect();
        (sum.joints.plus, sum.joints.minus, factors.join(", "), sum.variable.offset.to_string(), sum.variable.is_whole)
    });
    let expected =
        [(0b110, 0, "5/3", "0", false), (0b1000, 0b100, "-1/3", "1/10", false), (0b1000, 0b110, "-4/3", "1/10", false)];
    assert_eq!(
        found.collect::<Vec<_>>(),
        expected.map(|(a, b, factor, offset, whole)| (a, b, factor.to_owned(), offset.to_owned(), whole))
    );
}
