//! An arm is the same in rows of every convention.

use crate::common;

use armgen_codegen::description::Convention::{self, Modified, Standard, Urdf};
use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use armgen_codegen::{schedule, Model};
use armgen_import::{convert, Converted};
use common::{arms, assert_same, assert_same_joints, valid};

#[track_caller]
fn converted(yaml: &str, to: Convention) -> Converted {
    let source = Source::new("robot.yaml", yaml);
    let (converted, diagnostics) = convert(&source, to);
    converted.unwrap_or_else(|| panic!("{}\n{yaml}", diagnostics.render(&source, Colour::Never)))
}

#[test]
fn every_arm_in_every_convention() {
    for (name, yaml) in arms() {
        let arm = valid(&yaml);
        for to in [Standard, Modified, Urdf] {
            let once = converted(&yaml, to);
            assert_same(&format!("{name} {to:?}"), &arm, &valid(&once.yaml));
            assert_same_joints(&format!("{name} {to:?}"), &arm, &valid(&once.yaml));
            if name.contains("robots/") && !name.contains("general") {
                for back in [Standard, Modified, Urdf] {
                    let twice = converted(&once.yaml, back);
                    assert_same(&format!("{name} {to:?} {back:?}"), &arm, &valid(&twice.yaml));
                }
            }
        }
    }
}

/// Lines of a joint that hold its row.
fn rows(yaml: &str) -> Vec<&str> {
    let keys = ["a:", "alpha:", "d:", "theta:"];
    yaml.lines().map(str::trim).filter(|line| keys.iter().any(|key| line.starts_with(key))).collect()
}

#[test]
fn rows_of_known_arms_are_decimals_and_right_angles() {
    for (name, yaml) in arms().iter().filter(|(name, _)| ["panda7", "ur5", "puma560"].iter().any(|known| name.contains(known))) {
        for to in [Standard, Modified] {
            let Converted { yaml, lines } = converted(&converted(yaml, Urdf).yaml, to);
            assert!(!lines.iter().any(|line| line.contains("rounded")), "{name}: {lines:?}");
            let plain = |line: &&str| !line.contains("sqrt") && line.split(": ").nth(1).is_some_and(|x| x.len() < 10);
            assert!(rows(&yaml).iter().all(plain), "{name}\n{yaml}");
        }
    }
}

/// Operations of the functions whose cost must not depend on the convention.
fn operations(yaml: &str) -> Vec<(String, usize)> {
    const FUNCTIONS: [&str; 5] = ["inverse_dynamics", "inertia_matrix", "gravity", "geometric_jacobian", "direct_kinematics"];
    let module = schedule::module(&Model::new(valid(yaml)), &schedule::Options::default());
    let cost = |name: &&str| module.functions.iter().find(|f| f.name() == *name).map(|f| ((*name).to_owned(), f.steps.len()));
    FUNCTIONS.iter().filter_map(cost).collect()
}

#[test]
#[ignore = "wide"]
fn no_convention_costs_more() {
    for (name, yaml) in arms().iter().filter(|(name, _)| ["panda7", "ur5", "puma560"].iter().any(|known| name.contains(known))) {
        let own = operations(yaml);
        let there = converted(yaml, Urdf).yaml;
        for to in [Standard, Modified] {
            let back = converted(&there, to).yaml;
            assert_eq!(own, operations(&back), "{name} {to:?}\n{back}");
        }
    }
}

/// An arm of two joints, the second one at a pose, with the tip at another.
fn two(second: &str, kind: &str, tool: &str) -> String {
    let link = "{mass: 1, com: [0.1, 0.2, 0.3], inertia: {xx: 1, yy: 2, zz: 2.5}}";
    format!(
        "name: two\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n  - {{name: one, type: revolute, origin: {{xyz: [0.1, 0.2, 0.3]}}, axis: [0, 0, 1], link: {link}}}\n  - {{name: two, type: {kind}, origin: {second}, axis: [0, 0, 1], link: {link}}}\ntool: {tool}\n"
    )
}

/// Skew, meeting, parallel, antiparallel and coincident lines, and slides in all these places.
#[test]
#[ignore = "wide"]
fn every_place_of_two_lines() {
    let places = [
        "{xyz: [0.3, 0.1, 0.2], rpy: [pi/2, 0, 0]}",
        "{xyz: [0.3, 0.1, 0.2], rpy: [0.4, pi/3, 0]}",
        "{xyz: [0, 0, 0.2], rpy: [pi/2, 0, pi/3]}",
        "{xyz: [0, 0, 0.2], rpy: [-pi/2, 0, pi]}",
        "{rpy: [0, 0.3, 0]}",
        "{xyz: [0.3, 0.1, 0.2]}",
        "{xyz: [0.3, 0.4, 0.2], rpy: [pi, 0, 0.1]}",
        "{xyz: [0, 0, 0.2], rpy: [0, 0, pi/3]}",
        "{xyz: [0, 0, 0.2], rpy: [0, pi, 0]}",
        "{}",
    ];
    for second in places {
        for kind in ["revolute", "prismatic"] {
            for tool in places {
                let yaml = two(second, kind, tool);
                for to in [Standard, Modified] {
                    assert_same(&format!("{second} {kind} {tool} {to:?}"), &valid(&yaml), &valid(&converted(&yaml, to).yaml));
                }
            }
        }
    }
}

#[test]
fn rows_are_those_of_the_rules() {
    let of = |second: &str, to| rows(&converted(&two(second, "revolute", "{}"), to).yaml).join(" ");
    // The base's z axis is not the first one: `base` and row 1 share what lies between. Coincident lines: everything is 0.
    assert!(of("{}", Modified).ends_with("a: 0 alpha: 0 d: 0 theta: 0"));
    // Parallel at (0.3, 0.4): 0.5 apart.
    assert!(of("{xyz: [0.3, 0.4, 0.2]}", Standard).starts_with("a: 0.5 alpha: 0 "));
    assert!(of("{xyz: [0.3, 0.4, 0.2], rpy: [pi, 0, 0]}", Standard).starts_with("a: 0.5 alpha: pi "));
    // Meeting 0.2 above the joint, which is 0.3 above the base: no length, the angle of the row within a quarter turn.
    assert!(of("{xyz: [0, 0, 0.2], rpy: [pi/2, 0, 0]}", Standard).starts_with("a: 0 alpha: pi/2 d: 0.5 "));
    let nearly = converted(&two("{xyz: [0.3, 0, 0], rpy: [0.0005, 0, 0]}", "revolute", "{}"), Standard);
    assert!(nearly.lines.iter().any(|line| line.starts_with("nearly-parallel")), "{:?}", nearly.lines);
}

/// The choices for inverse kinematics are names, so they stay. A report names the parameters of the geometry that values replace.
#[test]
fn what_inverse_kinematics_is_asked_for_stays() {
    let (_, panda) = arms().into_iter().find(|(name, _)| name.contains("panda7")).expect("a robot");
    let joint = valid(&panda).joints[2].name.clone();
    for asked in [format!("{{target: \"pose\", given: {joint}}}"), "{given: swivel}".to_owned(), "{target: position}".to_owned()]
    {
        let yaml = format!("{panda}\ninverse_kinematics: {asked}\n");
        for to in [Standard, Modified, Urdf] {
            let after = converted(&yaml, to).yaml;
            assert_eq!(valid(&yaml).inverse_kinematics, valid(&after).inverse_kinematics, "{asked} {to:?}\n{after}");
        }
    }
}

/// With axes 3 and 4 parallel every point of axis 4 is as near to axis 3: the elbow is where the rows say.
#[test]
fn a_swivel_angle_from_another_point_is_said() {
    let arm = |alpha: &str| {
        let row = |k: usize, a: &str, alpha: &str, d: &str| {
            format!("  - {{name: j{k}, type: revolute, a: {a}, alpha: {alpha}, d: {d}, theta: 0, link: {{mass: 0}}}}\n")
        };
        let rows = [
            row(1, "0", "pi/2", "0"),
            row(2, "0", "pi/2", "0"),
            row(3, "0.3", alpha, "0.2"),
            row(4, "0.25", "pi/2", "0.15"),
            row(5, "0", "pi/2", "0"),
            row(6, "0", "pi/2", "0"),
            row(7, "0", "0", "0.1"),
        ];
        format!(
            "name: a\nconvention: standard\ngravity: [0, 0, -9.81]\ninverse_kinematics: {{given: swivel}}\njoints:\n{}",
            rows.concat()
        )
    };
    let said = |alpha: &str, to| converted(&arm(alpha), to).lines.iter().any(|line| line.contains("swivel angle"));
    assert!(said("0", Modified) && said("pi", Urdf));
    assert!(!said("0", Standard) && !said("pi/2", Modified) && !said("pi/2", Urdf));
}

#[test]
fn parameters_whose_values_are_written_are_named() {
    let yaml = "name: named\nconvention: standard\ngravity: [0, 0, -9.81]\n\
        parameters: {m: 2, l1: 0.5, turn: pi/2, h: 0.1, r: 0.2, t: 0.3}\n\
        joints:\n  - {name: one, type: revolute, a: l1, alpha: turn, d: 0, theta: 0, link: {mass: m, com: [-l1, 0, 0], attached: [{origin: {xyz: [h, 0, 0]}, mass: 1}]}}\n  \
        - {name: two, type: revolute, a: 0.3, alpha: 0, d: 0, theta: 0, link: {mass: m}, motor: {ratio: 2, inertia: 0.1, mass: 1, position: [r, 0, 0]}}\n\
        tool: {xyz: [0, 0, t]}\n";
    let said = |to| converted(yaml, to).lines.into_iter().find(|line| line.contains("parameters their values are written"));
    let of = |to| said(to).and_then(|line| line.split_once(": ").map(|(_, names)| names.to_owned()));
    assert_eq!(of(Standard), None);
    assert_eq!(of(Modified).as_deref(), Some("`l1`, `turn`, `r`, `t`"));
    // Poses keep their names; the place of a rotor is evaluated, through the row before it.
    assert_eq!(of(Urdf).as_deref(), Some("`l1`, `turn`, `r`"));
    let urdf = converted(yaml, Urdf).yaml;
    assert!(urdf.contains("origin: [{xyz: [l1, 0, 0], rpy: [turn, 0, 0]}, {xyz: [h, 0, 0]}]"), "{urdf}");
    for to in [Standard, Modified, Urdf] {
        assert_same("named", &valid(yaml), &valid(&converted(yaml, to).yaml));
        assert_same_joints("named", &valid(yaml), &valid(&converted(yaml, to).yaml));
    }
}

/// These notes are messages; the head of the file has the others.
#[test]
fn comments_that_are_left_out_are_named() {
    let arm = "name: a\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n  - {name: a, type: revolute, axis: [0, 0, 1], link: {mass: 1, inertia: {xx: 1, yy: 1, zz: 1}}}\n";
    let said = |yaml: &str| {
        let Converted { yaml, lines } = converted(yaml, Standard);
        assert!(!yaml.contains("comments"), "{yaml}");
        lines.iter().any(|line| line.contains("comments"))
    };
    assert!(!said(arm));
    assert!(said(&format!("# of my hands\n{arm}")));
    assert!(said(&arm.replace("name: a\n", "name: a # of my hands\n")));
    let attached = "link: {mass: 1, attached: [{name: \"cam #2\", mass: 1}], ";
    assert!(!said(&arm.replace("link: {mass: 1, ", attached)), "a `#` in quotes");
}

/// Couplings stay in rows of every convention. A pin stays where the frames of both links do, and else is named as left out.
#[test]
fn pins_of_loops_stay_or_are_named() {
    let yaml = crate::export::LOOP;
    let arm = valid(yaml);
    let variables = |arm: &armgen_codegen::manipulator::Manipulator| {
        let coupling = arm.coupling.as_ref().expect("coupled joints");
        coupling.variables.iter().map(|of| (of.factors.clone(), of.offset.clone())).collect::<Vec<_>>()
    };
    for to in [Standard, Modified, Urdf] {
        let Converted { yaml: rows, lines } = converted(yaml, to);
        let other = valid(&rows);
        assert_same_joints(&format!("{to:?}"), &arm, &other);
        assert_eq!(variables(&arm), variables(&other), "{to:?}");
        let named = lines.iter().any(|line| line.starts_with("left out: `closes`, since with rounded numbers"));
        assert_ne!(named, rows.contains("closes:"), "{to:?}: {lines:?}\n{rows}");
        assert_eq!(named, to != Urdf, "{to:?}: {rows}");
    }
    // Without a rounded number it stays; where a link frame is another, the point is named.
    let exact = yaml
        .replace("mount: {xyz: [-0.2, 0.1, 0]}", "mount: {xyz: [-0.2, 0, 0]}")
        .replace("at: [0.2, -0.1, 0]", "at: [0.2, 0, 0]");
    for (to, stays) in [(Modified, true), (Standard, true)] {
        let Converted { yaml: rows, lines } = converted(&exact, to);
        let arm = valid(&rows);
        assert_eq!((rows.contains("closes:"), variables(&arm)), (stays, variables(&valid(&exact))), "{to:?}: {lines:?}\n{rows}");
    }
    let moved = exact.replace(
        "joint: coupler, at: [0.2, 0, 0], with: lower, there: [0.5, 0, 0]",
        "joint: crank, at: [0.5, 0, 0], with: coupler",
    );
    assert_ne!(moved, exact);
    let Converted { yaml: rows, lines } = converted(&moved, Standard);
    let named = lines.iter().any(|line| line == "left out: points of `closes` on links whose frames are others");
    assert!(named && !rows.contains("closes:"), "{lines:?}\n{rows}");
}
