//! Emitted inverse kinematics, compiled in a project of its own and judged there: every robot that has a class, and reference poses.

#[path = "inverse_kinematics/arms.rs"]
mod arms;
#[path = "inverse_kinematics/in_c.rs"]
mod in_c;
#[path = "../../tests/src/installed.rs"]
pub(crate) mod installed;
#[path = "inverse_kinematics/project.rs"]
mod project;

use armgen_codegen::inverse_kinematics::InverseKinematics;
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Scalar};
use arms::{coupled, description, few, made_up, robots, P, R};
use project::Project;

fn classified(name: &str, text: &str) -> Result<InverseKinematics, String> {
    let (valid, diagnostics) = validate::read(&Source::new(name, text));
    let (manipulator, _) = valid.unwrap_or_else(|| panic!("{name}: {diagnostics:?}"));
    armgen_codegen::inverse_kinematics::of(&manipulator)
}

#[test]
fn classes_of_robots() {
    let class = |name: &str| {
        let (_, text) = robots().into_iter().find(|(robot, _)| robot == name).expect("a robot");
        classified(name, &text).map(|found| (found.class, found.most))
    };
    let of = |class: &str, most: usize| Ok((class.to_owned(), most));
    assert_eq!(class("puma560"), of("spherical triple (axes 4 5 6 through one point), axes 2 and 3 are parallel", 8));
    assert_eq!(class("ur5"), of("three parallel axes (joints 2 3 4), axes 5 and 6 intersect or are parallel", 8));
    assert_eq!(class("scara4"), of("all revolute axes parallel (joints 1 2 4)", 2));
    assert_eq!(class("scara"), of("all revolute axes parallel (joints 1 2 4)", 2));
    assert_eq!(class("panda7"), of("spherical triple (axes 1 2 3 through one point), axes 6 and 5 intersect; q7 is given", 8));
    assert_eq!(class("base_set"), of("position of three joints, axes 2 and 3 are parallel; q4 is given", 4));
    assert_eq!(class("load_friction"), of("position of three joints, joints 1 and 4 slide; q3 is given", 2));
    let one = "1 joint and 5 virtual joints that have to come out 0, three prismatic joints";
    assert!(class("single_joint").is_ok_and(|(class, most)| class.starts_with(one) && most == 2));
    // Why there is no function, and what would be one.
    for (name, why) in [
        ("counterbalance", "parallel to its axis, here z of the base; `task: [x, y, z]` asks for the position alone"),
        ("everything", "the rows of the task make no target"),
    ] {
        let reason = class(name).expect_err("no class");
        assert!(reason.contains(why), "{name}: {reason}");
    }
    // Three joints of a plane reach no position outside of it.
    let (_, _, _, text) = made_up().into_iter().find(|(name, ..)| *name == "position4r_j2").expect("an arm");
    let reason = classified("plane", &text.replace("given: j2", "given: j1")).expect_err("no class");
    assert!(reason.contains("with q1 given the joints move the end effector in fewer directions"), "{reason}");
    for (name, class, most, text) in made_up() {
        let found = classified(name, &text).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        assert!(found.class.starts_with(class) && found.most == most, "{name}: {} {}", found.class, found.most);
        // The steps name every joint of the arm, and no other but a virtual one.
        let (shown, joints) = (found.text(), text.matches("type: ").count());
        println!("{shown}");
        assert!((1..=joints).all(|joint| names(&shown, joint)), "{shown}");
        assert!(!shown.contains(&format!("q{}", joints + 2)), "{shown}");
    }
}

/// Coupled joints have the class of their chain, and a last step for the coordinates; where whole turns differ, there is none.
#[test]
fn classes_of_coupled_arms() {
    for (name, class, most, text) in coupled() {
        let found = classified(name, &text).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        assert!(found.class.starts_with(class) && found.most == most, "{name}: {} {}", found.class, found.most);
        assert!(found.text().contains("coordinates of the joint variables: "), "{name}");
    }
    let text_of = |arm: &str| coupled().into_iter().find(|(name, ..)| *name == arm).expect("an arm").3;
    let steps = |arm: &str| classified(arm, &text_of(arm)).expect("a class").text();
    let sums = "j1 = q1, j2 = q2, j3 = q2 + q3 - 1/2*pi, j4 = q4, j5 = q4 + q5, j6 = -q4 - 2*q5 + q6 - 3/10";
    assert!(steps("coupled_6r").contains(sums), "{}", steps("coupled_6r"));
    assert!(steps("coupled_bars").contains("variables: lower = q1, crank = q1 + q2"), "{}", steps("coupled_bars"));
    let reason = |arm: &str, old: &str, new: &str| {
        let text = text_of(arm);
        assert!(text.contains(old), "{old}");
        classified(arm, &text.replacen(old, new, 1)).expect_err("no class")
    };
    let turns = "whole turn";
    for (arm, old, new, why) in [
        ("coupled_6r", "adds: {j2: -1}", "adds: {j2: 1/2}", turns),
        ("coupled_6r", "adds: {j4: -1}", "follows: {j4: -1}", "coupled joints: use its Jacobian, with damping"),
        // Half a turn of the crank, or two, for a whole one of the forearm.
        ("coupled_bars", "follows: {crank: 1, lower: -1}", "follows: {crank: 2, lower: -1}", turns),
        ("coupled_bars", "follows: {crank: 1, lower: -1}", "follows: {lower: -1}", "some joints do not move the end effector"),
        (
            "coupled_bars",
            "tip: forearm",
            "tip: forearm\ninverse_kinematics: {given: rod}",
            "the joint that is given does not move",
        ),
    ] {
        let found = reason(arm, old, new);
        assert!(found.contains(why), "{arm}: {found}");
    }
}

/// Rows of a position that the joints do not affect: a plane, a sphere, a given joint. The suggested task has a construction.
#[test]
fn positions_of_too_many_rows_are_refused() {
    let q = "pi/2";
    let reason = |task: &str, rows: &[_]| classified("position", &description("position", task, rows));
    let slide_first = [(P, "0.1", q, "0.2", "0"), (R, "0.4", "0", "0.1", "0"), (R, "0.3", "0", "0", "0")];
    let slide_between = [(R, "0.1", q, "0.2", "0"), (P, "0.3", "-pi/2", "0.1", "0"), (R, "0.3", "0", "0", "0")];
    let turns = [(R, "0.5", "0", "0", "0"), (R, "0.4", "0", "0.1", "0"), (R, "0.3", "0", "0", "0")];
    for (row, task, rows) in
        [("y", "task: [x, z]", &slide_first), ("z", "task: [x, y]", &slide_between), ("z", "task: [x, y]", &turns)]
    {
        let refused = reason("task: [x, y, z]", rows).expect_err("no class");
        let wanted =
            format!("no joint moves the end effector along {row} of the base, a row of the task; `{task}` leaves it out");
        assert_eq!(refused, wanted);
        assert!(reason(task, rows).is_ok(), "{:?}", reason(task, rows));
    }
    let sphere = [(R, "0", q, "0.3", "0"), (R, "0", "-pi/2", "0", "0"), (R, "0.2", "0", "0.1", "0")];
    let refused = reason("task: [x, y, z]", &sphere).expect_err("no class");
    assert!(refused.starts_with("at every posture the joints move the end effector in fewer directions"), "{refused}");
    let scara = [(R, "0.3", "0", "0.2", "0"), (R, "0.2", "pi", "0", "0"), (P, "0", "0", "0", "0"), (R, "0.1", "0", "0.1", "0")];
    let given = |joint: &str| reason(&format!("task: [x, y, z]\ninverse_kinematics: {{given: {joint}}}"), &scara);
    let refused = given("j3").expect_err("no class");
    assert!(refused.starts_with("with q3 given the joints move the end effector in fewer directions"), "{refused}");
    assert!(given("j4").is_ok() && given("j1").is_ok());
}

/// Whether a text has a joint, by its number or its variable.
fn names(text: &str, joint: usize) -> bool {
    let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
    words.any(|word| word.trim_start_matches('q') == joint.to_string())
}

/// Slides that stay parallel move the end effector along one line: no posture is isolated.
#[test]
fn parallel_slides_have_no_construction() {
    let rows = |alpha| {
        [
            (P, "0.1", alpha, "0.2", "0.3"),
            (P, "0.1", "pi/2", "0.1", "0"),
            (R, "0.3", "1.1", "0.2", "0"),
            (R, "0.1", "pi/2", "0.1", "0.3"),
            (R, "0.05", "-pi/2", "0.35", "0"),
            (R, "0.02", "0", "0.1", "0"),
        ]
    };
    let class = |alpha| classified("slides", &description("slides", "", &rows(alpha)));
    assert!(class("0.01").expect("a class").class.starts_with("two prismatic joints (joints 1 2)"));
    let refused = class("0").expect_err("no class");
    assert_eq!(refused, "at every pose some joints can move while the end effector stays");
}

/// 1e-9 is not 0: an arm with a wrist whose axes miss by that much is a general one.
#[test]
fn nearly_zero_is_not_zero() {
    let puma = |a4: &str| {
        let rows = [
            (R, "0", "pi/2", "0.67183", "0"),
            (R, "0.4318", "0", "0", "0"),
            (R, "0.0203", "-pi/2", "0.15005", "0"),
            (R, a4, "pi/2", "0.4318", "0"),
            (R, "0", "-pi/2", "0", "0"),
            (R, "0", "0", "0", "0"),
        ];
        classified("puma", &description("puma", "", &rows)).expect("a class").class
    };
    assert!(puma("0").starts_with("spherical triple"));
    assert!(puma("1e-9").starts_with("general"), "{}", puma("1e-9"));
    // Other ways to write 0: one that reduction sees, and one that it does not.
    assert!(puma("sqrt(2)*sqrt(3) - sqrt(6)").starts_with("spherical triple"));
    let nested = puma("sqrt(3 - 2*sqrt(2)) + 1 - sqrt(2)");
    assert!(nested.starts_with("spherical triple"), "{nested}");
}

/// Compiles the emitted modules and runs the judge, which computes the postures of thousands of poses with every module.
#[test]
#[ignore = "wide"]
fn emitted_modules_find_every_posture() {
    let mut project = Project::new("inverse_kinematics");
    let mut all = robots();
    all.extend(made_up().into_iter().map(|(name, _, _, text)| (name.to_owned(), text)));
    for (name, text) in all {
        project.add(&name, &text, Scalar::F64);
        if ["puma560", "scara4", "parallel", "general", "position3r"].contains(&name.as_str()) {
            project.add(&name, &text, Scalar::F32);
        }
    }
    assert_eq!(project.run().matches("reference poses").count(), 8);
}

/// Errors in the blocks for slides: a branch that is lost, a sign, a degenerate case that is dropped.
#[test]
#[ignore = "wide"]
fn planted_errors_are_seen() {
    let errors = [
        ("gantry", ["turns.turns.iter().enumerate().take(turns.count)", "turns.turns.iter().enumerate().take(1)"]),
        ("gantry", ["[-chain[0][3], -chain[1][3], -chain[2][3]]", "[chain[0][3], -chain[1][3], -chain[2][3]]"]),
        ("gantry", ["if turns.free { turns_bits } else { 0 }", "0"]),
        ("table", ["for (w, f) in [(w, plus), (-w, minus)] {", "for (w, f) in [(w, plus)] {"]),
        ("table", ["a: turned.a + r[3]", "a: turned.a - r[3]"]),
        ("table", ["take(roots.shallow_count)", "take(0)"]),
        ("slides_apart", ["self.a * y.a + self.b * y.b * square", "self.a * y.a - self.b * y.b * square"]),
        ("few_rrr_elbow", ["for number in 0..starts {", "for number in 1..starts {"]),
        ("few_rrr_wrist", ["if met.residual <= most {", "if met.residual <= 1.0 {"]),
    ];
    let arms = made_up();
    let fewer: Vec<_> = few().into_iter().collect();
    let mut project = Project::new("inverse_kinematics_planted");
    for (number, (name, error)) in errors.iter().enumerate() {
        let text = arms.iter().map(|(arm, .., text)| (*arm, text)).chain(fewer.iter().map(|(arm, text)| (arm.as_str(), text)));
        let (_, text) = text.into_iter().find(|(arm, _)| arm == name).expect("an arm");
        project.add_spoilt(&format!("{name}_{number}"), text, *error);
    }
    assert_eq!(project.run().matches("seen: ").count(), errors.len());
}

/// Arms of one to five joints given a whole pose.
#[test]
#[ignore = "wide"]
fn fewer_joints_than_rows() {
    let mut project = Project::new("inverse_kinematics_few");
    for (name, text) in few() {
        let found = classified(&name, &text).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        println!("{name}: {}", found.class);
        let (shown, joints) = (found.text(), text.matches("type: ").count());
        assert!((1..=joints).all(|joint| names(&shown, joint)), "{shown}");
        project.add(&name, &text, Scalar::F64);
        let closed = ["few_rrr_elbow", "few_rrr_wrist", "few_rrp", "few_4r", "few_4r_palletizer"];
        let five = ["few_5r", "few_5r_pick", "few_5r_wrist", "few_5r_parallel"];
        if closed.iter().chain(&five).any(|arm| *arm == name) {
            project.add(&name, &text, Scalar::F32);
        }
    }
    project.run();
}

/// Joints that move the end effector alike at every pose: no posture is isolated.
#[test]
fn joints_that_can_always_move_are_told() {
    let rows = [(R, "0.5", "0", "0", "0"), (R, "0.4", "0", "0", "0"), (R, "0.2", "0", "0", "0"), (R, "0.2", "0", "0", "0")];
    // Slides of joints 3 and 4 are parallel.
    let six = [
        (R, "0", "pi/2", "0.149", "0"),
        (R, "0.25", "pi/2", "0", "0"),
        (P, "0.449", "0", "0", "pi/2"),
        (P, "0.1", "pi", "0", "0"),
        (R, "0", "pi/2", "0.301", "pi/2"),
        (P, "0.1", "0", "0", "0"),
    ];
    let slides = [(P, "0", "0", "0", "0"), (P, "0", "0", "0", "0")];
    let turns = [(R, "0", "0", "0", "0"), (R, "0", "0", "0", "0")];
    for rows in [&rows[..], &six, &slides, &turns] {
        let refused = classified("idle", &description("idle", "", rows)).expect_err("no class");
        assert_eq!(refused, "at every pose some joints can move while the end effector stays");
    }
}
