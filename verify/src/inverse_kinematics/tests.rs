//! Correct modules, and faulty modules.

use armgen_codegen::schedule::{Options, Selection};

use super::*;
use crate::certify::{proposal, verify_inverse_kinematics as verify};

mod few_joints;

fn module(text: &str) -> (Source, String) {
    let source = Source::new("robot.yaml", text);
    let functions = Selection::named(["direct_kinematics"]).expect("a function");
    let (generated, _) = armgen_codegen::generate(&source, &Options { functions, ..Options::default() });
    let ik = generated.expect("a valid robot").inverse_kinematics();
    (source, ik)
}

fn robot(name: &str) -> (Source, String) {
    let path = format!("{}/../robots/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    module(&std::fs::read_to_string(path).expect("a robot of the project"))
}

/// The fault of a text after a replacement at the first occurrence.
fn fault_of(source: &Source, text: &str, [old, new]: [&str; 2]) -> String {
    assert!(text.contains(old), "{old}");
    verify(source, &text.replacen(old, new, 1), 0).faults.pop().unwrap_or_default()
}

#[test]
fn robots_are_verified() {
    for (name, solutions) in [("scara", 2), ("scara4", 2), ("puma560", 8), ("ur5", 8), ("panda7", 8)] {
        let (source, text) = robot(name);
        let now = std::time::Instant::now();
        let report = verify(&source, &text, 16);
        println!("{report}\n{:?}", now.elapsed());
        assert!(report.passed(), "{report}");
        assert_eq!(report.generic.as_ref().map(|generic| generic.0), Some(solutions), "{report}");
        assert_eq!(report.sound, Some(solutions), "{report}");
        assert!(report.uncounted.is_none() && report.equal >= 8 && report.unreachable >= 2, "{report}");
    }
}

/// A description with rows (kind, a, alpha, d, theta).
fn description(task: &str, rows: &[[&str; 5]]) -> String {
    let joint = |(i, [kind, a, alpha, d, theta]): (usize, &[&str; 5])| {
        format!(
            "  - {{name: j{}, type: {}, a: {a}, alpha: {alpha}, d: {d}, theta: {theta}, \
             link: {{mass: 1, com: [0, 0, 0], inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n",
            i + 1,
            if *kind == "P" { "prismatic" } else { "revolute" }
        )
    };
    let joints: String = rows.iter().enumerate().map(joint).collect();
    format!("name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\n{task}\njoints:\n{joints}")
}

const POINTING: &str = "inverse_kinematics: {target: pointing}";

/// An arm of each class, with rational constants where possible.
fn made_up() -> Vec<(&'static str, usize, String)> {
    let (o, q, minus) = ("0", "pi/2", "-pi/2");
    let arm = |name, solutions, task: &str, rows: &[[&str; 5]]| (name, solutions, description(task, rows));
    vec![
        arm("planar", 2, "task: [x, y, rz]", &[["R", "0.5", o, o, o], ["R", "0.4", o, o, o], ["R", "0.2", o, o, o]]),
        arm("planar position", 2, "task: [x, y]", &[["R", "0.5", o, o, o], ["R", "0.4", o, "0.1", o]]),
        arm(
            "position",
            4,
            "task: [x, y, z]",
            &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, "0.1", o], ["R", "0.35", o, "0.05", o]],
        ),
        arm(
            "position, axes unrelated",
            4,
            "task: [x, y, z]",
            &[["R", "0.2", q, "0.3", o], ["R", "0.4", minus, "0.1", o], ["R", "0.35", q, "0.05", o]],
        ),
        arm(
            "position, slide first",
            4,
            "task: [x, y, z]",
            &[["P", "0.1", o, "0.3", o], ["R", "0.4", minus, "0.1", o], ["R", "0.35", q, "0.05", o]],
        ),
        arm(
            "position, slide between",
            4,
            "task: [x, y, z]",
            &[["R", "0.1", "pi/4", "0.3", o], ["P", "0.4", "pi/4", "0.1", q], ["R", "0.35", q, "0.05", o]],
        ),
        arm(
            "position, slide last",
            4,
            "task: [x, y, z]",
            &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, "0.1", o], ["P", "0.1", q, "0.05", o]],
        ),
        arm(
            "position and q4",
            4,
            "task: [x, y, z]",
            &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, "0.1", o], ["R", "0.35", o, "0.05", o], ["R", "0.2", q, "0.02", o]],
        ),
        arm(
            "position and q2",
            4,
            "task: [x, y, z]\ninverse_kinematics: {given: j2}",
            &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, "0.1", o], ["R", "0.35", o, "0.05", o], ["R", "0.2", q, "0.02", o]],
        ),
        arm(
            "position and q3",
            4,
            "task: [x, y, z]\ninverse_kinematics: {given: j3}",
            &[["R", "0.1", q, "0.3", o], ["R", "0.4", o, "0.1", o], ["R", "0.35", o, "0.05", o], ["R", "0.2", q, "0.02", o]],
        ),
        arm(
            "position and a boom",
            2,
            "task: [x, y, z]\ninverse_kinematics: {given: j3}",
            &[["P", "0.1", o, "0.2", o], ["R", o, q, "0.2", o], ["R", "0.1", minus, "0.1", o], ["P", o, o, o, o]],
        ),
        arm(
            "planar and q4",
            2,
            "task: [x, y, rz]",
            &[["R", "0.5", o, o, o], ["R", "0.4", o, o, o], ["R", "0.3", o, o, o], ["R", "0.2", o, o, o]],
        ),
        arm(
            "planar and q2",
            2,
            "task: [x, y, rz]\ninverse_kinematics: {given: j2}",
            &[["R", "0.5", o, o, o], ["R", "0.4", o, o, o], ["R", "0.3", o, o, o], ["R", "0.2", o, o, o]],
        ),
        arm(
            "offset shoulder",
            8,
            "",
            &[
                ["R", "0.1", q, "0.3", o],
                ["R", "0.4", o, "0.1", o],
                ["R", "0.02", minus, "0.1", o],
                ["R", o, q, "0.4", o],
                ["R", o, minus, o, o],
                ["R", o, o, "0.1", o],
            ],
        ),
        arm(
            "three axes unrelated",
            8,
            "",
            &[
                ["R", "0.2", q, "0.3", o],
                ["R", "0.4", minus, "0.1", o],
                ["R", "0.1", q, "0.05", o],
                ["R", o, q, "0.35", o],
                ["R", o, minus, o, o],
                ["R", "0.02", o, "0.1", o],
            ],
        ),
        arm(
            "parallel",
            8,
            "",
            &[
                ["R", "0.15", q, "0.3", o],
                ["R", "0.4", "pi", "0.1", o],
                ["R", "0.35", o, "0.05", o],
                ["R", "0.12", q, "0.1", o],
                ["R", "0.07", minus, "0.2", o],
                ["R", "0.02", o, "0.1", o],
            ],
        ),
        arm(
            "track",
            8,
            "",
            &[
                ["P", "0.1", q, "0.2", o],
                ["R", "0.4", q, "0.1", o],
                ["R", "0.1", q, "0.05", o],
                ["R", o, q, "0.35", o],
                ["R", o, minus, o, o],
                ["R", o, o, "0.1", o],
            ],
        ),
        arm(
            "gantry",
            2,
            "",
            &[
                ["P", "0.1", q, "0.2", q],
                ["P", o, q, "0.1", q],
                ["P", "0.1", q, "0.05", o],
                ["R", "0.05", q, "0.35", o],
                ["R", "0.03", minus, "0.02", o],
                ["R", o, o, "0.1", o],
            ],
        ),
        arm(
            "two slides",
            8,
            "",
            &[
                ["P", "0", q, "0.2", q],
                ["P", "0.1", o, "0.1", o],
                ["R", "0.3", q, "0.2", o],
                ["R", "0.1", q, "0.1", o],
                ["R", "0.05", minus, "0.35", o],
                ["R", "0.02", o, "0.1", o],
            ],
        ),
        arm(
            "pointing",
            8,
            POINTING,
            &[
                ["R", "0.1", q, "0.3", o],
                ["R", "0.4", o, "0.1", o],
                ["R", "0.35", o, "0.05", o],
                ["R", "0.08", q, "0.1", o],
                ["R", o, q, "0.12", o],
            ],
        ),
        arm(
            "pointing, general",
            16,
            POINTING,
            &[
                ["R", "0.15", q, "0.3", o],
                ["R", "0.4", minus, "0.1", o],
                ["R", "0.35", q, "0.05", o],
                ["R", "0.12", minus, "0.1", o],
                ["R", "0.07", q, "0.2", o],
            ],
        ),
        arm(
            "general",
            16,
            "",
            &[
                ["R", "0.15", q, "0.3", o],
                ["R", "0.4", minus, "0.1", o],
                ["R", "0.35", q, "0.05", o],
                ["R", "0.12", minus, "0.1", o],
                ["R", "0.07", q, "0.2", o],
                ["R", "0.02", o, "0.1", o],
            ],
        ),
    ]
}

/// Arms with coupled joints: name, number of solutions, description.
fn coupled() -> Vec<(&'static str, usize, String)> {
    let arm = |name: &'static str, of: &str, couplings: &[(&str, &str)]| {
        let (_, solutions, text) = made_up().into_iter().find(|(arm, ..)| *arm == of).expect("an arm");
        let text = couplings.iter().fold(text, |text, (joint, coupling)| {
            text.replacen(&format!("{{name: {joint}, "), &format!("{{name: {joint}, {coupling}, "), 1)
        });
        (name, solutions, text)
    };
    vec![
        arm(
            "coupled wrist",
            "offset shoulder",
            &[
                ("j3", "adds: {j2: 1}, limits: {position: [-2, 1]}"),
                ("j5", "adds: {j4: -1}"),
                ("j6", "adds: {j5: 2}, offset: 0.3"),
            ],
        ),
        arm("coupled plane", "planar", &[("j3", "adds: {j1: -1, j2: -1}, offset: 1/2")]),
        arm("coupled and q4", "position and q4", &[("j4", "adds: {j3: 1}, offset: -1")]),
        arm("coupled slide", "track", &[("j2", "adds: {j1: 1/2}")]),
    ]
}

/// The chain is verified as an arm of its own, and the numbers that turn its solutions into coordinates against the coupling.
#[test]
fn coupled_arms_are_verified() {
    for (name, solutions, text) in coupled() {
        let (source, text) = module(&text);
        let report = verify(&source, &text, 8);
        assert!(report.passed(), "{name}: {report}");
        assert_eq!(report.generic.as_ref().map(|generic| generic.0), Some(solutions), "{name}: {report}");
        let fault = |old: &str, new: &str| fault_of(&source, &text, [old, new]);
        assert!(fault("const JOINT_SLIDES", "const JOINTS_SLIDE").contains("should stand where"), "{name}");
        let fault = fault_of(
            &source,
            &text,
            ["joints, COORDINATES, COORDINATE_OFFSET, PRISMATIC", "joints, COORDINATES, [0.0; DOF], PRISMATIC"],
        );
        assert!(fault.contains("should stand where"), "{name}: {fault}");
    }
    // The module of the chain alone is not that of the arm, nor the other way round.
    let (_, _, text) = coupled().remove(1);
    let alone = text.replacen("adds: {j1: -1, j2: -1}, offset: 1/2, ", "", 1);
    assert_ne!(alone, text);
    for (of, by) in [(&text, &alone), (&alone, &text)] {
        let (source, module_text) = (Source::new("robot.yaml", of.as_str()), module(by).1);
        let fault = verify(&source, &module_text, 0).faults.pop().unwrap_or_default();
        assert!(fault.contains("an arm has them if its joints are coupled"), "{fault}");
    }
}

/// Arms of seven joints with a given joint: between two others, in the loop read forwards and backwards; the last joint; and a shoulder and a
/// wrist with an offset at the elbow.
fn redundant() -> Vec<(&'static str, usize, String)> {
    let (o, q, minus) = ("0", "pi/2", "-pi/2");
    let rows = |offset, back| {
        [
            ["R", o, minus, "0.36", o],
            ["R", o, q, o, o],
            ["R", offset, q, "0.42", o],
            ["R", back, minus, o, o],
            ["R", o, minus, "0.4", o],
            ["R", o, q, o, o],
            ["R", o, o, "0.126", o],
        ]
    };
    let given = |name| format!("inverse_kinematics: {{given: {name}}}");
    let mut arms: Vec<_> =
        ["j3", "j5", "j7"].map(|name| (name, 8, description(&given(name), &rows("0.08", "-0.05")))).into_iter().collect();
    arms.push(("j3, no offset", 8, description(&given("j3"), &rows(o, o))));
    arms
}

fn made_up_arm(name: &str) -> String {
    let found = made_up().into_iter().find(|(arm, ..)| *arm == name);
    found.expect("an arm").2
}

/// For a swivel angle the certificate covers the text, its numbers, the loop and the class.
#[test]
fn a_swivel_angle_is_verified_and_not_counted() {
    let (_, _, text) = redundant().remove(0);
    for given in ["inverse_kinematics: {given: swivel}", ""] {
        let text = text.replace("inverse_kinematics: {given: j3}", given);
        let (source, text) = module(&text);
        assert!(text.contains("swivel_angle(&LOOP, q)"), "{text}");
        let report = verify(&source, &text, 8);
        assert!(report.passed() && report.numbers > 100 && report.sound == Some(8), "{report}");
        assert_eq!(report.to_json(), verify(&source, &text, 8).to_json());
        assert!(report.to_json().contains("\"sound_branches\": 8"));
        assert_eq!(report.uncounted.as_deref(), Some("the swivel angle is given"));
        let fault = |old: &str, new: &str| fault_of(&source, &text, [old, new]);
        assert!(fault("order: [0, 1, 2,", "order: [0, 2, 1,").contains("not the loop of this arm"));
        assert!(fault("0.08", "0.09").contains("is not the float nearest"));
        assert!(fault("swivel_angle(&LOOP, q)", "q[0]").contains("should stand where"));
    }
}

/// A duplicate axis represents a joint that the others make redundant.
#[test]
fn axes_that_are_dependent_are_seen() {
    let m = modular::Modulus::new((1 << 61) - 1);
    let shifted = |x: i64| {
        let mut link = m.identity();
        link[0][3] = m.integer(x);
        link
    };
    let still = Loop { modulus: m, links: vec![], before: m.identity(), after: m.identity(), offsets: vec![] };
    let regular = |links: &[modular::Frame]| still.is_regular(&vec![false; links.len()], links, &vec![[m.one, 0]; links.len()]);
    assert!(regular(&[shifted(1), shifted(2)]) && !regular(&[shifted(0), shifted(2)]));
    // Four parallel axes.
    assert!(!regular(&[shifted(1), shifted(2), shifted(3), shifted(1)]));
}

#[test]
fn arms_of_each_class_are_verified() {
    for (name, solutions, text) in made_up().into_iter().chain(redundant()) {
        let (source, text) = module(&text);
        let now = std::time::Instant::now();
        let report = verify(&source, &text, 8);
        println!("{name}: {report}\n{:?}", now.elapsed());
        assert!(report.passed(), "{name}: {report}");
        if let Some((found, _)) = &report.generic {
            assert_eq!(*found, solutions, "{name}: {report}");
        }
        // Every branch of a closed-form construction: no Newton's method, no determinants, no polynomials.
        let packed: String = text.split_whitespace().collect();
        let others = ["polish(&mutfound,", "pubfngeneral_arm(", "pubfntwo_slides("];
        let closed = !others.iter().any(|other| packed.contains(other));
        assert_eq!(report.sound, closed.then_some(solutions), "{name}: {report}");
    }
}

/// Constants with roots and angles: the number of solutions at random poses is still known.
#[test]
fn arms_with_any_angles_are_verified() {
    let rows = [
        ["R", "0.15", "pi/3", "0.3", "0.1"],
        ["R", "0.4", "-1.1", "0.1", "0"],
        ["R", "0.35", "0.8", "0.05", "0.3"],
        ["R", "0", "pi/4", "0.1", "0"],
        ["R", "0", "-1.2", "0", "0.2"],
        ["R", "0.02", "0.3", "0.1", "0"],
    ];
    let (source, text) = module(&description("", &rows));
    let report = verify(&source, &text, 8);
    assert!(report.passed() && report.uncounted.is_some(), "{report}");
    assert_eq!(report.generic.as_ref().map(|generic| generic.0), Some(8), "{report}");
}

/// Unreadable texts: blocks that differ from the tested ones, and additional text.
#[test]
fn other_texts_are_refused() {
    let (source, text) = robot("puma560");
    let fault = |old: &str, new: &str| fault_of(&source, &text, [old, new]);
    // A changed sign, a lost branch, a dropped degenerate case.
    let why = "is not the tested one";
    assert!(fault("x * along - y * w, y * along + x * w", "x * along + y * w, y * along + x * w").contains(why));
    assert!(fault("found.count = 2;", "found.count = 1;").contains(why));
    assert!(fault("found.free = true;", "").contains(why));
    assert!(fault("conclude(&found, PRISMATIC, false)", "conclude(&found, PRISMATIC, true)").contains("should stand where"));
    assert!(fault(".of_rotation(&[x, y, z])\n}", "\n}").contains("should stand where"));
    assert!(fault("    if !is_pose(t) {", "    if false {").contains("should stand where"));
    assert!(fault("    backward: false", "    backward: true").contains("not the loop of this arm"));
    assert!(fault("\nmod all_solutions {", "\nmod others {").contains("should stand where"));
    // No depth of brackets exhausts the stack.
    let names = "pub const BRANCHES: [&str; 8] = [";
    assert!(fault(names, &(names.to_owned() + &"[".repeat(1 << 20))).contains("nested more than"));
}

/// The same for prismatic joints: a lost branch, a sign, a degenerate case, a wrong class.
#[test]
fn other_texts_of_slides_are_refused() {
    let why = "is not the tested one";
    let places = ("&LOOP.links_at(&t), [", "&LOOP.links_at(&t), [0, ");
    let errors = [
        ("gantry", "take(turns.count)", "take(1)", why),
        ("gantry", "[-chain[0][3], -chain[1][3]", "[chain[0][3], -chain[1][3]", why),
        ("gantry", "if turns.free { turns_bits } else { 0 }", "0", why),
        ("gantry", "three_prismatic(&links, [", "three_prismatic(&links, [0, ", "the joints that turn are others"),
        ("two slides", "[(w, plus), (-w, minus)]", "[(w, plus)]", why),
        ("two slides", "a: turned.a + r[3]", "a: turned.a - r[3]", why),
        ("two slides", "take(roots.shallow_count)", "take(0)", why),
        ("two slides", places.0, places.1, "the joints that slide are others"),
    ];
    for (name, old, new, says) in errors {
        let (source, text) = module(&made_up_arm(name));
        let fault = fault_of(&source, &text, [old, new]);
        assert!(fault.contains(says), "{name}, {new}: {fault}");
    }
}

/// The same for positions with Newton's method: a lost branch, a sign, the point, a missing Newton step, a wrong class.
#[test]
fn other_texts_of_positions_are_refused() {
    let why = "is not the tested one";
    let errors = [
        ("position, axes unrelated", "self.target[k] - t[k]", "self.target[k] + t[k]", why),
        ("position, axes unrelated", "take(roots.count) {", "take(1) {", why),
        ("position, axes unrelated", "J == 3 && closed.double", "false", why),
        ("position, axes unrelated", "displaced(from)]", "b]", "should stand where"),
        ("position, axes unrelated", "target: to", "target: from", "should stand where"),
        ("position, axes unrelated", "regional_general(&a", "regional_slide(&a", "`regional_slide` does not hold"),
        ("position, slide first", "regional_slide(&a", "regional_general(&a", "`regional_general` does not hold"),
        ("position, slide between", "regional_mid_slide(&a", "regional_mid_slide_across(&a", "the class is wrong"),
        ("position, slide last", "backward: true", "backward: false", "should stand where"),
        // A given joint: the point it moves, the link, the joint, the capacity for solutions, the class.
        ("position and q4", "transform(&LOOP.before, tip)", "transform(&LOOP.before, position)", "should stand where"),
        ("position and q4", "column(&GIVEN.link(value), 3)", "column(&GIVEN.link(value), 2)", "should stand where"),
        ("position and q4", "q[3]", "q[2]", "should stand where"),
        ("position and q4", " = regional_elbow(", " = regional_crossing(", "`regional_crossing` does not hold"),
        ("position and q2", "links[0] = ", "links[1] = ", "not the loop of this arm"),
        ("position and q3", "GIVEN.with::<3, DOF, 4>", "GIVEN.with::<3, DOF, 8>", "should stand where"),
        ("planar and q4", "GIVEN.with::<4, 5, 4>", "GIVEN.with::<4, DOF, 4>", "should stand where"),
        ("planar and q4", "|| !redundancy.is_finite()", "", "should stand where"),
    ];
    for (name, old, new, says) in errors {
        let (source, text) = module(&made_up_arm(name));
        let fault = fault_of(&source, &text, [old, new]);
        assert!(fault.contains(says), "{name}, {new}: {fault}");
    }
}

/// Code within a text of several lines, in documentation that is run, and in the module's description of itself.
#[test]
fn what_is_not_armgens_is_refused() {
    let (source, text) = robot("scara4");
    let fault = |old: &str, new: &str| fault_of(&source, &text, [old, new]);
    let writes = "where armgen writes";
    let code = "[\"elbow up\n// \", \"elbow down\"]; mod libm {} pub const X: [&str; 2] = [\"\n\", \"elbow down\"]";
    assert!(fault("[\"elbow up\", \"elbow down\"]", code).contains(writes));
    let escaped = "[\"elbow up\\\", \", stringify!(elbow down)]; mod libm {} //\"]";
    assert!(fault("[\"elbow up\", \"elbow down\"]", escaped).contains(writes));
    assert!(fault("[\"elbow up\", \"elbow down\"]", "[\"elbow down\", \"elbow up\"]").contains(writes));
    assert!(fault("/// The construction", "/// ```\n/// std::process::exit(1)\n/// ```\n/// The construction").contains(writes));
    assert!(fault("at most 2 solutions", "at most 4 solutions").contains(writes));
    assert!(fault("(input ", "(input 0").contains("line 1: "));
    assert!(fault("elbow up", "elbow\u{1b}[2Kup").contains("the character U+001B, which cannot be seen"));
    // The file name may differ, but must not change the poses.
    let renamed = text.replacen(" from robot.yaml", " from arm.yaml", 1);
    let [one, other] = [&text, &renamed].map(|text| verify(&source, text, 8));
    assert!(one.passed() && other.passed() && one.to_string() == other.to_string(), "{one}\n{other}");
    // An arm without a construction.
    let (source, text) = module(&description("", &[["P", "0", "0", "0", "0"]; 2]));
    let absent = verify(&source, &text, 0);
    assert!(absent.passed() && absent.absent, "{absent}\n{text}");
    assert!(!verify(&source, &(text + "pub static X: u8 = 0;\n"), 0).passed());
}

/// C modules: checked through the Rust module, and refused wherever they are not its translation.
#[test]
fn modules_in_c_are_verified() {
    let shoulder = made_up_arm("offset shoulder");
    let source = Source::new("robot.yaml", shoulder.as_str());
    let functions = Selection::named(["direct_kinematics"]).expect("a function");
    for scalar in [Scalar::F64, Scalar::F32] {
        let options = Options { scalar, functions: functions.clone(), ..Options::default() };
        let generated = armgen_codegen::generate(&source, &options).0.expect("a valid robot");
        let text = generated.inverse_kinematics_in_c().expect("a construction");
        assert!(is_one(&text));
        let report = verify(&source, &text, 2);
        assert!(report.passed() && report.translated && report.numbers > 100 && report.sound == Some(8), "{report}");
        let fault = |old: &str, new: &str| fault_of(&source, &text, [old, new]);
        let writes = "where armgen writes";
        assert!(fault("x * along - y * w", "x * along + y * w").contains(writes));
        assert!(fault("found.count = 2;", "found.count = 1;").contains(writes));
        assert!(fault("0.4", "0.41").contains(writes));
        assert!(fault(" < 4; ++i", " < 3; ++i").contains(writes));
        assert!(fault("UNFUSED", "FUSED").contains(writes));
    }
    let source = Source::new("robot.yaml", description("", &[["P", "0", "0", "0", "0"]; 2]));
    let options = Options { functions, ..Options::default() };
    let generated = armgen_codegen::generate(&source, &options).0.expect("a valid robot");
    let report = verify(&source, &generated.inverse_kinematics_in_c().expect("a comment"), 0);
    assert!(report.passed() && report.absent, "{report}");
}

/// Changes of a character of code or of a whole line in C, each of which is refused.
#[test]
fn changes_of_modules_in_c_are_refused() {
    let (mut changed, mut stream) = (0, Stream::new(4711));
    for name in ["puma560", "scara4"] {
        let (source, _) = robot(name);
        let manipulator = crate::arm(&source).expect("a valid robot");
        let options = Options { functions: Selection::named(["direct_kinematics"]).expect("a function"), ..Options::default() };
        let generated = armgen_codegen::generate(&source, &options).0.expect("a valid robot");
        let text = generated.inverse_kinematics_in_c().expect("a construction");
        let proposal = proposal(&source, &manipulator, &text).expect("an end effector");
        assert_eq!(difference(&proposal, &source, &text), None);
        let lines: Vec<&str> = text.lines().collect();
        let before = changed;
        while changed < before + 100 {
            // The file name in the first line may differ.
            let at = 1 + stream.below(lines.len() as u64 - 1) as usize;
            let places: Vec<usize> = lines[at].char_indices().filter(|(_, c)| c.is_ascii_graphic()).map(|(at, _)| at).collect();
            let Some(&place) = places.get(stream.below(places.len().max(1) as u64) as usize) else { continue };
            let old = lines[at].as_bytes()[place];
            let others: &[u8] = match old {
                b'0'..=b'9' => b"0123456789",
                b'+' | b'-' | b'*' | b'/' => b"+-*/",
                b'<' | b'>' | b'=' | b'!' => b"<>=!",
                b'a'..=b'z' => b"abcdeijknqrstxyz",
                _ => b"()[]{},;",
            };
            let new = others[stream.below(others.len() as u64) as usize];
            let mut spoilt = lines.clone();
            let line = format!("{}{}{}", &lines[at][..place], new as char, &lines[at][place + 1..]);
            match stream.below(4) {
                0 => drop(spoilt.remove(at)),
                1 => spoilt.insert(at, lines[at]),
                _ if new == old => continue,
                _ => spoilt[at] = &line,
            }
            let spoilt = spoilt.join("\n") + "\n";
            assert!(difference(&proposal, &source, &spoilt).is_some(), "{name}: `{}` for `{}`", line.trim(), lines[at].trim());
            // A change that is refused alone is also refused in the complete verification.
            assert!(changed % 50 != 0 || !verify(&source, &spoilt, 0).passed(), "{name}: {line}");
            changed += 1;
        }
    }
    assert_eq!(changed, 200);
}

type Fault<'a> = &'a dyn Fn() -> Option<String>;

/// The purpose of each check; `peel` omits the checks that refuse a trick, in turn.
pub(crate) fn tricks(peel: &mut dyn FnMut(&str, &[(Check, &'static str)], Fault<'_>)) {
    use Check::{
        Branches, Class, Coordinates, Counts, Limits, Loop, LoopNumbers, Meeting, MostSolutions, Reached, Sound, WholeText,
        WholeTurns,
    };
    let shoulder = made_up_arm("offset shoulder");
    let (source, text) = module(&shoulder);
    let mut edited = |old: &str, new: &str, layers: &[(Check, &'static str)]| {
        assert!(text.contains(old), "{old}");
        let trick = text.replacen(old, new, 1);
        // The comparison with armgen's text finally refuses any other text.
        let layers = [layers, &[(WholeText, "where armgen writes")]].concat();
        peel(new, &layers, &|| verify(&source, &trick, 0).faults.pop());
    };
    edited("[Real::NEG_INFINITY, Real::INFINITY]", "[Real::NEG_INFINITY, 3.0]", &[(Limits, "POSITION_LIMITS: 3.0 is not what")]);
    edited("0.4]", "0.41]", &[(LoopNumbers, "0.41 is not the float nearest to 2/5")]);
    edited("order: [0, 1, 2,", "order: [0, 2, 1,", &[(Loop, "not the loop of this arm")]);
    edited(
        "], regional_elbow",
        "], regional_crossing",
        &[(Class, "`regional_crossing` does not hold"), (Sound, "does not close the loop")],
    );
    edited(
        "MAX_SOLUTIONS: usize = 8",
        "MAX_SOLUTIONS: usize = 9",
        &[(MostSolutions, "MAX_SOLUTIONS: 9 where the construction has 8")],
    );
    let labels = &text[text.find("pub const BRANCHES").expect("branches")..];
    let label = format!("\"{}\"", labels.split('"').nth(1).expect("a label"));
    edited(&label, "\"\"", &[(Branches, "BRANCHES: 7 of them, and there are 8")]);
    let (_, _, whole) = coupled().remove(0);
    let (source, text) = module(&whole);
    let row = "[0.0, -1.0, 1.0, 0.0, 0.0, 0.0]";
    assert!(text.contains(row), "{text}");
    let trick = text.replacen(row, "[0.0, -1.5, 1.0, 0.0, 0.0, 0.0]", 1);
    let layers = [(Coordinates, "COORDINATES: -1.5 is not the float nearest to -1"), (WholeText, "where armgen writes")];
    peel("one and a half of a joint", &layers, &|| verify(&source, &trick, 0).faults.pop());
    // A joint that turns by half of another one beside its coordinate, with numbers that are right.
    let half = Source::new("robot.yaml", whole.replacen("adds: {j2: 1}", "adds: {j2: 1/2}", 1));
    let [of_whole, of_half] = [&source, &half].map(|source| crate::hash(source.text())[..16].to_owned());
    let trick = text.replace(&of_whole, &of_half).replacen(row, &row.replace("-1.0", "-0.5"), 1);
    let mut right = proposal(&source, &crate::arm(&source).expect("a valid arm"), &text).expect("an end effector");
    let values = right.values.as_mut().expect("a construction");
    let minus_half = -&(Number::one().checked_div(&Number::from(2)).expect("a fraction"));
    values.coordinates.as_mut().expect("it is coupled").0[2][1] = minus_half;
    right.rust.clone_from(&trick);
    let layers = [(WholeTurns, "whole turns of joints and of coordinates are not the same")];
    peel("half turns", &layers, &|| super::verify(&half, &trick, &right, 0).faults.pop());
    // Solutions off the pose; a count off by one; an ignored double solution.
    let roots = |real, multiple| Count::Finite(super::sturm::Roots { distinct: 8, real, multiple });
    let eight = run::Outcome { verdict: Verdict::Complete, solutions: vec![vec![]; 8] };
    let missed = |count, miss| judge(&mut Report::default(), count, &eight, &[miss; 8]).err();
    let judged = |count| missed(count, 0.0);
    assert_eq!(judged(roots(8, 0)), None);
    peel("0.001 m beside", &[(Reached, "a solution does not reach it")], &|| missed(roots(8, 0), 0.001));
    peel("7 for 8", &[(Counts, "there are 7 solutions, and the module returns 8")], &|| judged(roots(7, 0)));
    peel("two have met", &[(Meeting, "and the module says Complete")], &|| judged(roots(7, 1)));
}
