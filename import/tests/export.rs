//! Export and import give the same arm, and from then on the same text.

use crate::common;

use std::path::Path;

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use armgen_import::{export, import, Exported, Options};
use common::{arms, assert_same, valid};

#[track_caller]
fn exported(yaml: &str) -> Exported {
    let source = Source::new("robot.yaml", yaml);
    let (exported, diagnostics) = export(&source);
    exported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never)))
}

#[track_caller]
fn imported(urdf: &str) -> String {
    let source = Source::new("robot.urdf", urdf);
    let (imported, diagnostics) = import(&source, &Options { tip: Some("tool".into()), ..Options::default() });
    imported.unwrap_or_else(|| panic!("{}\n{urdf}", diagnostics.render(&source, Colour::Never))).yaml
}

#[test]
fn the_arm_stays_the_same() {
    for (name, yaml) in arms() {
        assert_same(&name, &valid(&yaml), &valid(&imported(&exported(&yaml).urdf)));
    }
}

#[test]
fn the_text_stays_the_same() {
    for (name, yaml) in arms() {
        let first = exported(&yaml).urdf;
        let normal = imported(&first);
        let second = exported(&normal).urdf;
        assert_eq!(first, second, "{name}");
        assert_eq!(normal, imported(&second), "{name}");
    }
}

#[test]
fn what_a_urdf_cannot_hold_is_named() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/robots/everything.yaml");
    let lines = exported(&std::fs::read_to_string(&path).expect("a readable file")).lines.join("\n");
    for what in ["rotors", "payload", "gravity", "`task`", "parameters", "velocity", "jerk", "rounded"] {
        assert!(lines.contains(what), "{what}:\n{lines}");
    }
    let text = std::fs::read_to_string(path.with_file_name("../../robots/panda7.yaml")).expect("a readable file");
    let lines = exported(&format!("{text}\ninverse_kinematics: {{target: pose}}\nallow: [implausible-reach]\n")).lines.join("\n");
    assert!(lines.contains("left out: `inverse_kinematics`") && lines.contains("left out: `allow`"), "{lines}");
    assert!(exported("name: a\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n  - {name: a, type: revolute, axis: [0, 0, 1], link: {mass: 1, inertia: {xx: 1, yy: 1, zz: 1}}}\n").lines.is_empty());
}

/// They need URDF 1.2, which older programs refuse: only a file with such limits follows it. They come back through an import.
#[test]
fn limits_of_acceleration_and_jerk_are_kept() {
    let arm = |limits: &str| {
        format!(
            "name: a\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n  - {{name: a, type: revolute, axis: [0, 0, 1], \
             limits: {{{limits}}}, link: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n"
        )
    };
    let both = exported(&arm("velocity: 1.5, effort: 20, acceleration: 12.50, jerk: 300"));
    let limit = "<limit effort=\"20\" velocity=\"1.5\" acceleration=\"12.50\" deceleration=\"12.50\" jerk=\"300\"/>";
    assert!(both.urdf.contains("version=\"1.2\"") && both.urdf.contains(limit), "{}", both.urdf);
    assert!(both.lines.join("\n").contains("URDF 1.2"), "{:?}", both.lines);
    let back = imported(&both.urdf);
    assert!(back.contains("acceleration: 12.50") && back.contains("jerk: 300"), "{back}");
    let neither = exported(&arm("velocity: 1.5, effort: 20"));
    assert!(!neither.urdf.contains("version=\"1.2\""), "{}", neither.urdf);
}

/// A joint feels what its motor's bearings take ratio² times: 0.5 + 121² · 1e-5, and 50² · 1/3 in floats.
#[test]
fn the_friction_of_rotors_is_part_of_damping_and_their_masses_are_named() {
    let arm = |motor: &str, friction: &str| {
        exported(&format!(
            "name: a\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n  - {{name: a, type: revolute, axis: [0, 0, 1], \
             link: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: 1}}}}, motor: {{{motor}}}, friction: {{{friction}}}}}\n"
        ))
    };
    let both = arm("ratio: 121, inertia: 2e-5, viscous: 1e-5, mass: 2.5", "viscous: 0.5, coulomb: 2.1");
    assert!(both.urdf.contains("<dynamics damping=\"0.64641\" friction=\"2.1\"/>"), "{}", both.urdf);
    let lines = both.lines.join("\n");
    assert!(lines.contains("ratio², is part of `damping` at: `a`") && lines.contains("2.5 kg in all"), "{lines}");
    let rotor = arm("ratio: -50, inertia: 2e-5, viscous: 1/3", "coulomb: 0");
    assert!(rotor.urdf.contains("damping=\"833.3333333333334\""), "{}", rotor.urdf);
    let none = arm("ratio: 50, inertia: 2e-5", "viscous: 0.50");
    assert!(none.urdf.contains("damping=\"0.50\"") && !none.lines.join("\n").contains("damping"), "{}", none.urdf);
}

/// Masses add up exactly, and zeros are kept.
#[test]
fn what_is_nothing_is_not_named_as_left_out() {
    let lines = |joints: &[&str]| {
        let joint = |(i, more): (usize, &&str)| {
            format!(
                "  - {{name: j{i}, type: revolute, axis: [0, 0, 1], link: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: 1}}}}, {more}}}\n"
            )
        };
        let joints: String = joints.iter().enumerate().map(joint).collect();
        exported(&format!("name: a\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n{joints}")).lines.join("\n")
    };
    let masses = lines(&["motor: {mass: 0.1}", "motor: {mass: 0.2}", "motor: {mass: 0, inertia: 1e-4}"]);
    assert!(masses.contains("rotors, 0.3 kg in all, are not in the masses of the URDF: `j0`, `j1`"), "{masses}");
    assert!(!masses.contains("of the URDF: `j0`, `j1`, `j2`"), "{masses}");
    let zeros = "motor: {viscous: 0}, armature: 0, friction: {offset: 0, cubic: 0, load: 0}";
    assert_eq!(lines(&[zeros]), "");
}

#[test]
fn a_faulty_description_is_refused() {
    let (exported, diagnostics) = export(&Source::new("robot.yaml", "name: 3"));
    assert!(exported.is_none() && diagnostics.has_errors());
}

/// Two bars in parallel and a coupler: a loop with one pin left out, each joint with one leader.
pub(crate) const LOOP: &str = "name: bars
convention: urdf
gravity: [0, -9.81, 0]
joints:
  - {name: lower, type: revolute, axis: [0, 0, 1], link: {mass: 8, com: [0.25, 0, 0], inertia: {xx: 0.01, yy: 0.2, zz: 0.2}}}
  - {name: crank, type: revolute, parent: base, mount: {xyz: [-0.2, 0.1, 0]}, axis: [0, 0, 1], follows: {lower: 1}, link: {mass: 3, com: [0.1, 0, 0], inertia: {xx: 0.01, yy: 0.02, zz: 0.02}}}
  - {name: coupler, type: revolute, parent: crank, origin: {xyz: [0.5, 0, 0]}, axis: [0, 0, 1], follows: {crank: -1}, offset: 0, link: {mass: 1.5, com: [0.1, 0, 0], inertia: {xx: 0.01, yy: 0.03, zz: 0.03}}}
closes:
  - {name: pin, joint: coupler, at: [0.2, -0.1, 0], with: lower, there: [0.5, 0, 0]}
";

/// A URDF has no loops: the pins are named as left out, the couplings stay, and with the pins written again the loop is proved closed.
#[test]
fn loops_are_named_and_their_couplings_are_kept() {
    let Exported { urdf, lines } = exported(LOOP);
    let said = lines.join("\n");
    assert!(said.contains("left out: `closes`, for a URDF has no loops: these stay closed where"), "{said}");
    assert!(!said.contains("move freely"), "{said}");
    for mimic in ["<mimic joint=\"lower\"", "<mimic joint=\"crank\" multiplier=\"-1\""] {
        assert!(urdf.contains(mimic), "{mimic}:\n{urdf}");
    }
    let source = Source::new("robot.urdf", urdf);
    let all = Options { all: true, ..Options::default() };
    let (back, diagnostics) = import(&source, &all);
    let yaml = back.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never))).yaml;
    let (first, second) = (valid(LOOP), valid(&yaml));
    let variables = |arm: &armgen_codegen::manipulator::Manipulator| {
        let coupling = arm.coupling.as_ref().expect("coupled joints");
        let own = |variable: &armgen_codegen::manipulator::JointVariable| (variable.factors.clone(), variable.offset.clone());
        let mut all: Vec<_> = arm.joints.iter().map(|joint| joint.name.clone()).zip(coupling.variables.iter().map(own)).collect();
        all.sort_by(|x, y| x.0.cmp(&y.0));
        all
    };
    assert_eq!(variables(&first), variables(&second), "{yaml}");
    let pins = LOOP.split_once("closes:").expect("pins").1;
    valid(&format!("{yaml}closes:{pins}"));
    let wrong = format!("{yaml}closes:{pins}").replacen("[0.5, 0, 0]}", "[0.51, 0, 0]}", 1);
    let (_, diagnostics) = armgen_codegen::validate::read(&Source::new("robot.yaml", wrong));
    assert!(diagnostics.has_errors());
    // A joint that follows several others has no `mimic`, and that is said, with where its variable is to be had.
    let several = "    follows: {lower: 1, crank: -1}";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/trees/parallelogram.yaml");
    let text = std::fs::read_to_string(path).expect("a readable file");
    assert!(text.contains(several));
    let pin = "closes:\n  - {joint: rod, at: [0.5, 0, 0], with: forearm, there: [-0.2, 0, 0]}\n";
    let Exported { urdf, lines } = exported(&format!("{text}{pin}"));
    let said = lines.join("\n");
    assert!(!urdf.contains("<mimic"), "{urdf}");
    assert!(said.contains("these joints move freely; `joint_variables`") && said.contains("left out: `closes`"), "{said}");
}
