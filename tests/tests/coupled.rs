//! Coupled joints: values of other programs, the checker in every language, base parameters, limits, and what is refused.

use armgen_codegen::derive::base;
use armgen_codegen::description::Convention;
use armgen_codegen::diagnostic::{Colour, Severity};
use armgen_codegen::emit::Language;
use armgen_codegen::exact::Number;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::show::{Form, Item, Reading, Sheet, Style};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::{Generated, Model, Scalar};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::robot::{Dynamics, Kinematics, LinkJacobians};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{deviation, REFERENCE};
use armgen_tests::random::Random;
use armgen_verify::certificate::report::Report;
use armgen_verify::certificate::report::Verdict::Equal;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::ModuleText;
use armgen_verify::verify_with;
use serde_json::Value;

#[allow(unreachable_pub, clippy::all, clippy::pedantic)]
mod gripper {
    include!(concat!(env!("OUT_DIR"), "/gripper_arm.rs"));
    include!(concat!(env!("OUT_DIR"), "/gripper_arm_runtime.rs"));
}
use gripper::{Hand, LeftPad, COUPLING, DOF, JOINTS};

/// Five bars with both drives at the base (Siciliano et al., Sect. 7.3.3).
const PARALLELOGRAM: &str = include_str!("../data/trees/parallelogram.yaml");
/// A finger that mirrors another one, on a branch of its own.
const GRIPPER: &str = include_str!("../data/trees/gripper_arm.yaml");
/// The third coordinate is counted from the horizontal.
const LINKED: &str = include_str!("../data/trees/linked_3.yaml");
/// A slide that follows a turn, by a factor with pi, and a turn that follows it by 0.785.
const SCREW: &str = include_str!("../data/trees/screw.yaml");
/// A slide and a turn lead a turn.
const HELIX: &str = include_str!("../data/trees/helix.yaml");
/// A finger whose outer links bend with the inner one.
const FINGER: &str = include_str!("../data/trees/finger.yaml");
const ALL: [(&str, &str); 4] =
    [("parallelogram", PARALLELOGRAM), ("gripper_arm", GRIPPER), ("linked_3", LINKED), ("screw", SCREW)];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[test]
fn coupled_arms_have_the_values_of_other_programs() {
    let all: Value = serde_json::from_str(include_str!("../data/trees/coupled.json")).expect("JSON");
    for (name, text) in ALL {
        let robot = Interpreted::new(text).unwrap_or_else(|fault| panic!("{fault}"));
        for state in all[name]["states"].as_array().expect("states") {
            let [q, dq, ddq, tau] = ["q", "dq", "ddq", "inverse_dynamics"].map(|key| numbers(&state[key]));
            let arguments = Arguments { q, dq, ddq: ddq.clone(), tau, ..Arguments::default() };
            let agrees = |function: &str, expected: &[f64]| {
                let off = deviation(&robot.call(function, &arguments), expected);
                assert!(off < REFERENCE, "{name}: {function}: {off:e}");
            };
            for function in [
                "joint_variables",
                "inertia_matrix",
                "coriolis_matrix",
                "gravity",
                "friction",
                "inverse_dynamics",
                "kinetic_energy",
            ] {
                agrees(function, &numbers(&state[function]));
            }
            agrees("forward_dynamics", &ddq);
            for (tip, own) in state["tips"].as_object().expect("end effectors") {
                for function in ["direct_kinematics", "geometric_jacobian", "geometric_jacobian_dot"] {
                    agrees(&format!("{tip}_{function}"), &numbers(&own[function]));
                }
            }
        }
    }
}

pub(crate) fn generated(text: &str) -> (Source, Generated) {
    chosen(text, Selection::default())
}

fn chosen(text: &str, functions: Selection) -> (Source, Generated) {
    let source = Source::new("robot.yaml", text);
    let (generated, faults) = armgen_codegen::generate(&source, &Options { trig: Trig::Fast, functions, ..Options::default() });
    let generated = generated.unwrap_or_else(|| panic!("{}", faults.render(&source, Colour::Never)));
    (source, generated)
}

pub(crate) fn judged(source: &Source, generated: &Generated, language: Language, text: &str) -> Report {
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    verify_with(source, ModuleText { language, text }, claims, Effort { points: 2, exact_points: 1, seed: 1 })
}

#[test]
#[ignore = "wide"]
fn the_checker_proves_coupled_arms_in_every_language() {
    for text in [PARALLELOGRAM, GRIPPER, SCREW] {
        let (source, generated) = generated(text);
        for language in Language::ALL {
            let report = judged(&source, &generated, language, &generated.in_language(language));
            assert!(report.passed(), "{}: {}", language.title(), report.first_fault().unwrap_or_default());
            assert!(report.functions.iter().any(|function| function.name == "joint_variables"), "{}", language.title());
        }
    }
    let (source, generated) = generated(LINKED);
    let report = judged(&source, &generated, Language::Rust, &generated.module);
    assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
}

/// A slide and a turn lead a turn, in single precision; and the angle is written out for people.
#[test]
fn computed_angles_are_proved_in_single_precision() {
    let source = Source::new("robot.yaml", HELIX);
    let options = Options { trig: Trig::Fast, scalar: Scalar::F32, ..Options::default() };
    let generated = armgen_codegen::generate(&source, &options).0.expect("a module");
    for language in [Language::Rust, Language::C] {
        let report = judged(&source, &generated, language, &generated.in_language(language));
        assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
    }
    assert!(generated.module.contains("12.5 * q[0] - 0.785 * q[1] + 0.1"), "{}", generated.module);
    let model = Model::new(validate::read(&source).0.expect("valid").0);
    let items = Item::named("gravity", 4, &model.manipulator.tips);
    let text = Sheet::in_style(&model, &items, Reading::Nominal, Style { form: Form::Shortest, digits: None }).text();
    assert!(text.contains("(25/2*q1 - 157/200*q2 + 1/10)"), "{text}");
}

/// Closed forms in the rates of links exist where terms of fingers that mirror each other cancel: a count of operations without friction.
#[test]
fn fingers_cost_what_their_closed_form_costs() {
    let lines = GRIPPER.lines().filter(|line| !line.starts_with("    friction:"));
    let text = lines.map(|line| format!("{line}\n")).collect::<String>();
    let (arm, _) = validate::read(&Source::new("robot.yaml", text)).0.expect("valid");
    let functions = Selection::named(["inverse_dynamics"]).expect("a function");
    let module = armgen_codegen::schedule::module(&Model::new(arm), &Options { functions, ..Options::default() });
    let cost = armgen_codegen::program::Cost::of(&module.functions[0]);
    assert!(cost.mul <= 27 && cost.add <= 20, "{cost:?}");
}

/// Tests for users have reference values of robots that have more joints than coordinates, too.
#[test]
fn tests_of_coupled_arms_are_written() {
    let (source, generated) = generated(FINGER);
    let tests = armgen_verify::test_kit(&source, &generated.module, "mod robot;").expect("tests");
    assert!(tests.contains("inertia_matrix("), "{tests}");
}

/// A factor of the other sign, or a follower left out, is another robot: every function that it moves is refused.
#[test]
fn a_module_of_another_coupling_is_refused() {
    let (source, right) = generated(PARALLELOGRAM);
    for (of, by, wrong) in [
        ("follows: {crank: 1, lower: -1}", "follows: {crank: 1, lower: 1}", "inertia_matrix"),
        ("follows: {lower: 1, crank: -1}", "follows: {lower: 1}", "coriolis_matrix"),
    ] {
        let other = PARALLELOGRAM.replacen(of, by, 1);
        assert_ne!(other, PARALLELOGRAM);
        let (_, other) = generated(&other);
        let report = judged(&source, &other, Language::Rust, &other.module);
        assert!(!report.passed());
        let refused: Vec<&str> = report.functions.iter().filter(|f| f.verdict != Equal).map(|f| f.name.as_str()).collect();
        assert!(refused.contains(&wrong) && refused.contains(&"joint_variables"), "{refused:?}");
    }
    let swapped = right.module.replacen(
        "pub const COUPLING_OFFSET: [Real; JOINTS] = [0.0,",
        "pub const COUPLING_OFFSET: [Real; JOINTS] = [0.5,",
        1,
    );
    assert_ne!(swapped, right.module);
    let report = judged(&source, &right, Language::Rust, &swapped);
    assert!(report.first_fault().is_some_and(|fault| fault.contains("COUPLING_OFFSET")));
}

/// How many of the parameters of links a motion tells, without drives and friction (ranks in a field and singular values of two other programs).
#[test]
fn base_parameters_of_coupled_arms_are_counted_exactly() {
    for ((name, text), expected) in ALL.into_iter().zip([8, 10, 36, 20]) {
        let lines = text.lines().filter(|line| !line.starts_with("    motor:") && !line.starts_with("    friction:"));
        let text = lines.map(|line| format!("{line}\n")).collect::<String>();
        let (arm, _) = validate::read(&Source::new("robot.yaml", text)).0.expect("valid");
        let model = Model::new(arm);
        let (vector, _) = base::base_combinations(&model.manipulator, &model.field).expect("short combinations");
        assert_eq!(vector.entries.len(), expected, "{name}");
    }
}

/// The links of a finger stand at q, 5/3 q and 2.19 q + 0.1 about one direction: functions take sines of these, not of the angles between links.
#[test]
fn sums_about_parallel_axes_are_one_angle() {
    let turned = FINGER.replacen(
        "    axis: [0, 1, 0]\n    follows: {middle: 0.785}",
        "    axis: [0, -1, 0]\n    follows: {middle: -0.785}",
        1,
    );
    let turned = turned.replacen("offset: 0.1", "offset: -0.1", 1);
    assert_ne!(turned, FINGER);
    let of = |text: &str| {
        chosen(text, Selection::named(["direct_kinematics", "inertia_matrix", "inverse_dynamics"]).expect("functions"))
    };
    let (source, finger) = of(FINGER);
    let passes = |source: &Source, generated: &Generated, text: &str| judged(source, generated, Language::Rust, text).passed();
    assert!(passes(&source, &finger, &finger.module));
    assert!(finger.module.contains("2.19 * q[1] + 0.1"), "{}", finger.module);
    let robot = Interpreted::new(FINGER).expect("valid");
    let kinematics = robot.module.functions.iter().find(|function| function.name() == "direct_kinematics").expect("emitted");
    let mut factors: Vec<String> = kinematics.computed.values().map(|angle| angle.factors[0].1.to_string()).collect();
    factors.sort();
    assert_eq!(factors, ["219/100", "5/3"]);
    for (of, by) in
        [("2.19 * q[1] + 0.1", "2.19 * q[1]"), ("2.19 * q[1]", "2.18 * q[1]"), ("1.6666666666666667", "1.6666666666666665")]
    {
        let wrong = finger.module.replace(of, by);
        assert_ne!(wrong, finger.module, "{of}");
        assert!(!passes(&source, &finger, &wrong), "{by}");
    }
    let (source, other) = of(&turned);
    assert!(passes(&source, &other, &other.module));
}

/// More coordinates and computed angles together than an arm has joints at most.
#[test]
fn many_joints_may_each_add_another_one() {
    let mut text = String::from("name: snake\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n");
    for i in 0..18 {
        let (axis, adds) =
            (["[0, 0, 1]", "[0, 1, 0]"][i % 2], if i == 0 { String::new() } else { format!("    adds: {{j{}: 1/2}}\n", i - 1) });
        text += &format!("  - name: j{i}\n    type: revolute\n    origin: {{xyz: [0.1, 0, 0]}}\n    axis: {axis}\n{adds}    link: {{mass: 1, com: [0.05, 0, 0], inertia: {{xx: 0.01, yy: 0.01, zz: 0.01}}}}\n");
    }
    let (source, generated) = chosen(&text, Selection::named(["gravity"]).expect("a function"));
    let report = judged(&source, &generated, Language::Rust, &generated.module);
    assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
}

/// A pin that closes is proved and changes no function; with a sign of a factor wrong the loop is open.
#[test]
fn closed_loops_are_proved() {
    const PIN: &str =
        "closes:\n  - {name: pin of the rod, joint: rod, at: [0.5, 0, 0], with: forearm, there: [-0.2, 0, 0]}\ntips:";
    let codes = |text: &str| -> Vec<String> {
        let (_, diagnostics) = validate::read(&Source::new("robot.yaml", text));
        diagnostics.iter().filter(|d| d.code.severity() == Severity::Error).map(|d| d.code.name().to_owned()).collect()
    };
    let closed = PARALLELOGRAM.replacen("tips:", PIN, 1);
    assert_eq!(codes(&closed), [""; 0]);
    let kinematics = Selection::named(["inertia_matrix"]).expect("a function");
    let body = |text: &str| chosen(text, kinematics.clone()).1.module.lines().skip(1).map(String::from).collect::<Vec<_>>();
    assert_eq!(body(&closed), body(PARALLELOGRAM));
    for (of, by) in [
        ("follows: {crank: 1, lower: -1}", "follows: {crank: 1, lower: 1}"),
        ("follows: {lower: 1, crank: -1}", "follows: {lower: 1}"),
        ("at: [0.5, 0, 0]", "at: [0.5, 0, 1e-30]"),
    ] {
        let open = closed.replacen(of, by, 1);
        assert_ne!(open, closed);
        assert_eq!(codes(&open), ["open-loop"], "{by}");
    }
    assert_eq!(codes(&closed.replacen("with: forearm", "with: forarm", 1)), ["unknown-tip-joint"]);
    // A pin where one link carries the other closes whatever the factor; a link that turns leaves the base.
    let pins = "closes:\n  - {joint: middle, with: inner, there: [0.045, 0, 0]}\n  - {joint: inner, with: base}\ntool:";
    assert_eq!(codes(&FINGER.replacen("tool:", pins, 1)), ["open-loop"]);
}

/// Factors with another digit, without a sign or with another constant: the argument of the sine is another one.
#[test]
#[ignore = "wide"]
fn a_module_of_another_computed_angle_is_refused() {
    const FUNCTIONS: [&str; 4] = ["end_direct_kinematics", "inertia_matrix", "gravity", "joint_variables"];
    let of = |text: &str| chosen(text, Selection::named(FUNCTIONS).expect("functions"));
    let (source, right) = of(SCREW);
    assert!(judged(&source, &right, Language::Rust, &right.module).passed());
    for (of_joint, by) in [
        ("follows: {nut: 0.785}", "follows: {nut: 0.786}"),
        ("follows: {nut: 0.785}", "follows: {nut: -0.785}"),
        ("offset: 0.1", "offset: 0.11"),
    ] {
        let other = SCREW.replacen(of_joint, by, 1);
        assert_ne!(other, SCREW);
        let (_, other) = of(&other);
        let report = judged(&source, &other, Language::Rust, &other.module);
        let refused: Vec<&str> = report.functions.iter().filter(|f| f.verdict != Equal).map(|f| f.name.as_str()).collect();
        assert!(FUNCTIONS.iter().all(|function| refused.contains(function)), "{by}: {refused:?}");
    }
    for (of, by) in [
        ("0.785 * q[1] + 0.1", "0.7850000000000001 * q[1] + 0.1"),
        ("0.785 * q[1] + 0.1", "0.785 * q[0] + 0.1"),
        ("0.785 * q[1] + 0.1", "0.785 * q[1] - 0.1"),
        ("0.785 * q[1] + 0.1", "0.785 * q[1]"),
    ] {
        let wrong = right.module.replace(of, by);
        assert_ne!(wrong, right.module, "{of}");
        assert!(!judged(&source, &right, Language::Rust, &wrong).passed(), "{by}");
    }
}

/// A wrist that turns, a slide, and four joints that follow them or each other by numbers of every kind; the same with all joints free; and S and
/// c of q = S p + c.
fn hand(random: &mut Random) -> (String, String, Vec<[f64; 2]>, Vec<f64>) {
    const FACTORS: [(&str, f64); 12] = [
        ("2/3", 2.0 / 3.0),
        ("1/3", 1.0 / 3.0),
        ("0.785", 0.785),
        ("-1.0585", -1.0585),
        ("1.1232", 1.1232),
        ("-0.5", -0.5),
        ("sqrt(2)", std::f64::consts::SQRT_2),
        ("2/pi", std::f64::consts::FRAC_2_PI),
        ("-17", -17.0),
        ("0.02/(2*pi)", 0.01 / std::f64::consts::PI),
        ("-1", -1.0),
        ("1.234567890123456", 1.234_567_890_123_456),
    ];
    const OFFSETS: [(&str, f64); 4] = [("0", 0.0), ("0.1", 0.1), ("pi/2", std::f64::consts::FRAC_PI_2), ("-0.3", -0.3)];
    let mut coupled = String::from("name: hand\nconvention: urdf\ngravity: [1, 2, -9.81]\njoints:\n");
    let mut free = coupled.clone();
    let (mut rows, mut offsets) = (vec![[1.0, 0.0], [0.0, 1.0]], vec![0.0; 2]);
    for i in 0..6 {
        let kind = if i != 1 && (i != 4 || random.chance(50)) { "revolute" } else { "prismatic" };
        let axis = random.one_of(&["[0, 0, 1]", "[0, 1, 0]", "[1, 2, -2]", "[0, 0, -1]"]);
        let parent = if i == 0 { String::new() } else { format!("    parent: j{}\n", random.whole(0, i - 1)) };
        let mut row =
            format!("  - name: j{i}\n    type: {kind}\n{parent}    origin: {{xyz: [0.1, 0.0{i}, 0.2]}}\n    axis: {axis}\n");
        row += &format!(
            "    link: {{mass: 1.{i}, com: [0.01, 0.02, 0.0{i}], inertia: {{xx: 0.02, yy: 0.03, zz: 0.025, xy: 0.001}}}}\n"
        );
        row += "    friction: {viscous: 0.3}\n    spring: {stiffness: 2, rest: 0.1}\n    armature: 0.01\n";
        free += &row;
        coupled += &row;
        if i < 2 {
            continue;
        }
        let leaders = [random.whole(0, i - 1), random.whole(0, i - 1)];
        let leaders = if leaders[0] == leaders[1] { &leaders[..1] } else { &leaders[..] };
        let (offset, mut constant) = OFFSETS[random.whole(0, 3) as usize];
        let mut sum = [0.0; 2];
        let mut text = Vec::new();
        for &leader in leaders {
            let (factor, by) = FACTORS[random.whole(0, 11) as usize];
            text.push(format!("j{leader}: {factor}"));
            (0..2).for_each(|a| sum[a] += by * rows[leader as usize][a]);
            constant += by * offsets[leader as usize];
        }
        coupled += &format!("    follows: {{{}}}\n    offset: {offset}\n", text.join(", "));
        rows.push(sum);
        offsets.push(constant);
    }
    (coupled, free, rows, offsets)
}

/// q = S p + c of the free hand, multiplied by S' where there are forces, for factors of every kind.
#[test]
#[ignore = "wide"]
fn hands_with_factors_of_every_kind_are_free_hands_projected() {
    let mut random = Random::new(11);
    let mut computed = 0;
    for draw in 0..6 {
        let (text, free, rows, offsets) = hand(&mut random);
        let (coupled, free) =
            (Interpreted::new(&text).unwrap_or_else(|fault| panic!("{fault}\n{text}")), Interpreted::new(&free).expect("valid"));
        computed += coupled.module.functions.iter().filter(|function| !function.computed.is_empty()).count();
        let [p, dp, ddp, dpr, ddpr] = [(); 5].map(|()| [random.real(-1.0, 1.0), random.real(-1.0, 1.0)]);
        let spread = |x: [f64; 2]| rows.iter().map(|row| row[0] * x[0] + row[1] * x[1]).collect::<Vec<f64>>();
        let q: Vec<f64> = spread(p).iter().zip(&offsets).map(|(q, c)| q + c).collect();
        let all = Arguments {
            q: q.clone(),
            dq: spread(dp),
            ddq: spread(ddp),
            dqr: spread(dpr),
            ddqr: spread(ddpr),
            ..Arguments::default()
        };
        let own = Arguments {
            q: p.to_vec(),
            dq: dp.to_vec(),
            ddq: ddp.to_vec(),
            dqr: dpr.to_vec(),
            ddqr: ddpr.to_vec(),
            ..Arguments::default()
        };
        // Along a dimension of six: S' of the entries.
        let contract = |entries: &[f64], inner: usize| -> Vec<f64> {
            let outer = entries.len() / (6 * inner);
            let sum = |o: usize, a: usize, k: usize| (0..6).map(|j| rows[j][a] * entries[(o * 6 + j) * inner + k]).sum::<f64>();
            let (rows, sum) = (0..outer, &sum);
            rows.flat_map(|o| (0..2).flat_map(move |a| (0..inner).map(move |k| sum(o, a, k)))).collect()
        };
        let check = |function: &str, expected: &[f64]| {
            let off = deviation(&coupled.call(function, &own), expected);
            assert!(off < REFERENCE, "{draw} {function}: {off:e}\n{text}");
        };
        check("joint_variables", &q);
        for function in ["gravity", "friction", "inverse_dynamics", "momentum"] {
            check(function, &contract(&free.call(function, &all), 1));
        }
        for function in ["inertia_matrix", "coriolis_matrix", "inverse_dynamics_derivatives"] {
            check(function, &contract(&contract(&free.call(function, &all), 6), 1));
        }
        for function in ["geometric_jacobian", "geometric_jacobian_dot", "link_jacobians"] {
            check(function, &contract(&free.call(function, &all), 1));
        }
        for function in ["direct_kinematics", "link_frames", "kinetic_energy", "potential_energy", "center_of_mass"] {
            check(function, &free.call(function, &all));
        }
        let tau = coupled.call("inverse_dynamics", &own);
        let forwards = Arguments { tau, ..own.clone() };
        let off = deviation(&coupled.call("forward_dynamics", &forwards), &ddp);
        assert!(off < 1e3 * REFERENCE, "{draw}: {off:e}");
    }
    assert!(computed > 50, "{computed} functions compute angles");
}

/// Angles of one unit: their base parameters are fewer than with independent angles, which the checker proves, none of them being redundant.
#[test]
fn the_checker_proves_base_parameters_of_related_angles() {
    let joint = |i: usize, more: &str| {
        format!("  - name: j{i}\n    type: revolute\n    origin: {{xyz: [0.{i}, 0, 0]}}\n    axis: [0, 0, 1]\n    link: {{mass: 1.{i}, com: [0.1, 0.0{i}, 0], inertia: {{xx: 0.1, yy: 0.2, zz: 0.25}}}}\n{more}")
    };
    let text = |factors: [&str; 2]| {
        let follows = factors.map(|factor| format!("    follows: {{j1: {factor}}}\n"));
        let joints = [joint(1, ""), joint(2, &follows[0]), joint(3, &follows[1])].concat();
        format!("name: bars\nconvention: urdf\ngravity: [0, -9.81, 0]\nregressor: base\njoints:\n{joints}")
    };
    let mut counts = Vec::new();
    for factors in [["1/3", "-1/3"], ["1/2", "-3/2"], ["0.785", "1.1232"], ["0.333333333333333333", "0.785"]] {
        let (source, generated) = generated(&text(factors));
        let report = judged(&source, &generated, Language::Rust, &generated.module);
        assert!(report.passed(), "{factors:?}: {}", report.first_fault().unwrap_or_default());
        let (arm, _) = validate::read(&source).0.expect("valid");
        let model = Model::new(arm);
        counts.push(base::base_combinations(&model.manipulator, &model.field).expect("short combinations").0.entries.len());
    }
    // With 1/2 and -3/2 the last bar keeps its direction. Seven of independent angles.
    assert_eq!(counts, [7, 5, 7, 7]);
}

/// With base parameters at run time, and with gravity as an argument.
#[test]
fn the_checker_proves_regressors_of_coupled_arms() {
    for (of, by) in [("tips:", "regressor: base\ntips:"), ("gravity: [0, -9.81, 0]", "gravity: {argument: [0, -9.81, 0]}")] {
        for text in [PARALLELOGRAM, GRIPPER] {
            let text = text.replacen(of, by, 1);
            let (source, generated) = generated(&text);
            let report = judged(&source, &generated, Language::Rust, &generated.module);
            assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
        }
    }
}

/// b_12 is (m_forearm 0.5 0.2 - m_rod 0.2 0.25) cos(q1 - q2): with a rod of 12 kg B is constant and C is 0 (Siciliano et al., Sect. 7.3.3).
#[test]
fn a_parallelogram_has_the_closed_form_of_the_book() {
    let show = |text: &str, name: &str| {
        let (arm, _) = validate::read(&Source::new("robot.yaml", text)).0.expect("valid");
        let model = Model::new(arm);
        let items = Item::named(name, 4, &model.manipulator.tips);
        Sheet::in_style(&model, &items, Reading::Nominal, Style { form: Form::Shortest, digits: None }).text()
    };
    let text = show(PARALLELOGRAM, "inertia_matrix");
    assert!(text.contains("21/40*cos(q1 - q2)"), "{text}");
    let balanced = PARALLELOGRAM.replacen("mass: 1.5", "mass: 12", 1);
    assert_ne!(balanced, PARALLELOGRAM);
    assert!(!show(&balanced, "inertia_matrix").contains("cos"));
    let robot = Interpreted::new(&balanced).expect("valid");
    let c = robot.module.functions.iter().find(|function| function.name() == "coriolis_matrix").expect("it has mass");
    assert!(c.steps.is_empty(), "{:?}", c.steps);
    let arguments = Arguments { q: vec![0.3, 0.9], dq: vec![1.0, -2.0], ..Arguments::default() };
    assert_eq!(robot.call("coriolis_matrix", &arguments), [0.0; 4]);
}

/// The limits of a coordinate are the meet of its own and of those of joints that move with it alone.
#[test]
fn limits_of_followers_limit_their_leader() {
    let text = GRIPPER
        .replacen(
            "    axis: [0, 1, 0]\n",
            "    axis: [0, 1, 0]\n    limits: {position: [0, 0.04], velocity: 0.2, effort: 30}\n",
            1,
        )
        .replacen(
            "    follows: {finger: 1}\n",
            "    follows: {finger: -2}\n    offset: 0.05\n    limits: {position: [0, 0.05], velocity: 0.2}\n",
            1,
        );
    let robot = Interpreted::new(&text).unwrap_or_else(|fault| panic!("{fault}"));
    let finger = &robot.module.joints[2];
    let number = |value: &Option<Number>| value.as_ref().map(Number::to_f64);
    assert_eq!(finger.position.each_ref().map(number), [Some(0.0), Some(0.025)]);
    assert_eq!([number(&finger.velocity), number(&finger.effort)], [Some(0.1), Some(30.0)]);
    let coupling = robot.module.coupling.as_ref().expect("a follower");
    assert_eq!(coupling.offsets[3].to_f64(), 0.05);
    assert_eq!(coupling.factors[3].iter().map(Number::to_f64).collect::<Vec<_>>(), [0.0, 0.0, -2.0]);
    let arguments = Arguments { q: vec![0.1, 0.2, 0.01], ..Arguments::default() };
    let variables = robot.call("joint_variables", &arguments);
    assert!(deviation(&variables, &[0.1, 0.2, 0.01, 0.03]) < REFERENCE, "{variables:?}");
}

/// A line of joints that slide, each coupled to the one before it in this way.
fn line(joints: usize, coupling: impl Fn(usize) -> String) -> String {
    let mut text = String::from("name: line\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n");
    for i in 0..joints {
        text +=
            &format!("  - name: j{i}\n    type: prismatic\n    axis: [{}, 1, 1]\n    link: {{mass: 1}}\n{}", i % 3, coupling(i));
    }
    text
}

/// Rings, long lines, factors of many digits: an answer, and no panic.
#[test]
fn hostile_couplings_get_an_answer() {
    let codes = |text: &str| -> Vec<String> {
        let (_, diagnostics) = validate::read(&Source::new("robot.yaml", text));
        diagnostics.iter().filter(|d| d.code.severity() == Severity::Error).map(|d| d.code.name().to_owned()).collect()
    };
    let follows = |of: usize, factor: &str| format!("    follows: {{j{}: {factor}}}\n", of % 32);
    assert_eq!(codes(&line(32, |i| follows(i + 1, "1"))), ["ring-of-followers"]);
    assert_eq!(codes(&line(2, |i| if i == 1 { follows(1, "1") } else { String::new() })), ["ring-of-followers"]);
    let after = |factor: &'static str| line(32, move |i| if i == 0 { String::new() } else { follows(i - 1, factor) });
    assert_eq!(codes(&after("0.5")), [""; 0]);
    assert_eq!(codes(&after("-1")), [""; 0]);
    let digits = format!("0.{}", "123456789".repeat(2_000));
    let long = line(32, |i| if i == 0 { String::new() } else { follows(i - 1, &digits) });
    assert!(!codes(&long).is_empty());
    let roots = line(32, |i| if i == 0 { String::new() } else { follows(i - 1, "sqrt(2) + sqrt(3) + pi") });
    assert_eq!(codes(&roots), ["too-complex"]);
    // Point masses on the axes: some joints move no inertia.
    for factor in ["2", "2/3", "0.785", "sqrt(2)", "1/7", &digits] {
        let codes =
            codes(&line(32, |i| if i == 0 { String::new() } else { follows(i - 1, factor) }).replace("prismatic", "revolute"));
        assert!(codes.iter().all(|code| ["too-complex", "too-large", "singular-inertia"].contains(&code.as_str())), "{codes:?}");
    }
    assert!(codes(&after("1e300")).contains(&"too-complex".to_owned()));
}

/// Traits of the runtime have coordinates for joints: an element for each joint that has one.
#[test]
fn controllers_see_coordinates() {
    assert_eq!((DOF, JOINTS), (3, 4));
    assert_eq!(COUPLING[3], [0.0, 0.0, 1.0]);
    let q = SVector::from([0.3, -0.4, 0.02]);
    let all = gripper::link_frames(&[0.3, -0.4, 0.02]);
    let frames = Hand.link_frames(&q);
    assert_eq!(frames.len(), DOF);
    assert_eq!(frames[2][(1, 3)], all[2][1][3]);
    assert_eq!(Hand.link_jacobians(&q).len(), DOF);
    assert_eq!(gripper::joint_variables(&[0.3, -0.4, 0.02]), [0.3, -0.4, 0.02, 0.02]);
    // The pads move apart, and the hand does not move with them.
    assert_eq!(Hand.geometric_jacobian(&q).column(2).norm(), 0.0);
    assert!((LeftPad.geometric_jacobian(&q).column(2).norm() - 1.0).abs() < 1e-15);
    let torque = Dynamics::gravity(&LeftPad, &q);
    assert_eq!(torque, Dynamics::gravity(&Hand, &q));
}

/// Rows of every convention keep the coupling, and a URDF has it as `mimic` where it can.
#[test]
fn conversion_and_export_keep_couplings() {
    for (name, text) in ALL {
        let robot = Interpreted::new(text).expect("valid");
        let q: Vec<f64> = [0.3, -0.2, 0.5, 0.7, -0.4, 0.1][..robot.dof()].to_vec();
        let arguments = Arguments { dq: q.clone(), ddq: q.clone(), q, ..Arguments::default() };
        for to in [Convention::Standard, Convention::Modified] {
            let source = Source::new("robot.yaml", text);
            let (converted, faults) = armgen_import::convert(&source, to);
            let yaml = converted.unwrap_or_else(|| panic!("{}", faults.render(&source, Colour::Never))).yaml;
            let other = Interpreted::new(&yaml).unwrap_or_else(|faults| panic!("{faults}\n{yaml}"));
            for function in ["joint_variables", "inertia_matrix", "coriolis_matrix", "inverse_dynamics"] {
                let off = deviation(&other.call(function, &arguments), &robot.call(function, &arguments));
                assert!(off < REFERENCE, "{name} {to:?} {function}: {off:e}\n{yaml}");
            }
        }
    }
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", GRIPPER));
    let exported = exported.expect("valid");
    assert!(exported.urdf.contains("<mimic joint=\"finger\" multiplier=\"1\" offset=\"0\"/>"), "{}", exported.urdf);
    let (exported, _) = armgen_import::export(&Source::new("robot.yaml", PARALLELOGRAM));
    let lines = exported.expect("valid").lines;
    assert!(lines.iter().any(|line| line.contains("coupling of joints with several others")), "{lines:?}");
}
