//! The arms that emitted inverse kinematics is tested with.

use std::path::{Path, PathBuf};

use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{Generated, Scalar};

pub(crate) fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("codegen lies in the workspace")
}

pub(crate) fn generated(name: &str, text: &str, scalar: Scalar) -> Generated {
    let functions = Selection::named(["direct_kinematics"]).expect("a function");
    let options = Options { scalar, functions, ..Options::default() };
    let (generated, diagnostics) = armgen_codegen::generate(&Source::new(name, text), &options);
    generated.unwrap_or_else(|| panic!("{name}: {diagnostics:?}"))
}

/// A description from rows (kind, a, alpha, d, theta).
pub(crate) fn description(name: &str, task: &str, rows: &[(&str, &str, &str, &str, &str)]) -> String {
    let joint = |(i, (kind, a, alpha, d, theta)): (usize, &(&str, &str, &str, &str, &str))| {
        format!(
            "  - {{name: j{}, type: {kind}, a: {a}, alpha: {alpha}, d: {d}, theta: {theta}, \
             link: {{mass: 1, com: [0, 0, 0], inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n",
            i + 1
        )
    };
    let joints: String = rows.iter().enumerate().map(joint).collect();
    format!("name: {name}\nconvention: standard\ngravity: [0, 0, -9.81]\n{task}\njoints:\n{joints}")
}

pub(crate) const R: &str = "revolute";
pub(crate) const P: &str = "prismatic";

const POINTING: &str = "inverse_kinematics: {target: pointing}";

/// Made-up arms: name, task, class, at most, rows.
pub(crate) fn made_up() -> Vec<(&'static str, &'static str, usize, String)> {
    let arm = |name: &'static str, task: &str, class, most, rows: &[(&str, &str, &str, &str, &str)]| {
        (name, class, most, description(name, task, rows))
    };
    let (elbow, quarter) = ("0.4", "pi/2");
    vec![
        arm(
            "planar3r",
            "task: [x, y, rz]",
            "all revolute axes parallel (joints 1 2 3)",
            2,
            &[(R, "0.5", "0", "0", "0"), (R, "0.4", "0", "0", "0"), (R, "0.2", "0", "0", "0")],
        ),
        arm(
            "planar2r",
            "task: [x, y]",
            "position of three joints, joint 3 slides, axes 2 and 1 are parallel",
            2,
            &[(R, "0.5", "0", "0", "0"), (R, "0.4", "0", "0.1", "0.3")],
        ),
        arm(
            "elbow3r",
            "task: [x, y, z]",
            "position of three joints, axes 2 and 3 are parallel",
            4,
            &[(R, "0.1", quarter, "0.3", "0.1"), (R, elbow, "0", "0.1", "0"), (R, "0.35", "0.2", "0.05", "0.3")],
        ),
        // Positions without related axes, with angles that are no fractions of a turn; the last has its slide at the end.
        arm(
            "position3r",
            "task: [x, y, z]",
            "position of three joints, axes 1, 2 and 3 neither are parallel nor intersect",
            4,
            &[(R, "0.2", "0.9", "0.3", "0.1"), (R, elbow, "-1.1", "0.1", "0"), (R, "0.35", quarter, "0.05", "0.3")],
        ),
        arm(
            "position_prr",
            "task: [x, y, z]",
            "position of three joints, joint 1 slides",
            4,
            &[(P, "0.2", "0.9", "0.3", "0.1"), (R, elbow, "-1.1", "0.1", "0"), (R, "0.35", quarter, "0.05", "0.3")],
        ),
        arm(
            "position_rpr",
            "task: [x, y, z]",
            "position of three joints, joint 2 slides",
            4,
            &[(R, "0.2", "0.9", "0.3", "0.1"), (P, elbow, "-1.1", "0.1", "0.4"), (R, "0.35", quarter, "0.05", "0.3")],
        ),
        arm(
            "position_rrp",
            "task: [x, y, z]",
            "position of three joints, joint 3 slides",
            4,
            &[(R, "0.2", "0.9", "0.3", "0.1"), (R, elbow, "-1.1", "0.1", "0"), (P, "0.1", quarter, "0.05", "0.3")],
        ),
        // One joint too many for a position: an elbow after a turning base with given joints; unrelated axes.
        arm(
            "position4r",
            "task: [x, y, z]",
            "position of three joints, axes 2 and 3 are parallel; q4 is given",
            4,
            &[
                (R, "0.1", quarter, "0.3", "0.1"),
                (R, elbow, "0", "0.1", "0"),
                (R, "0.35", "0", "0.05", "0.3"),
                (R, "0.1", "0.2", "0.02", "0"),
            ],
        ),
        arm(
            "position4r_j2",
            "task: [x, y, z]\ninverse_kinematics: {given: j2}",
            "position of three joints, axes 3 and 4 are parallel",
            4,
            &[
                (R, "0.1", quarter, "0.3", "0.1"),
                (R, elbow, "0", "0.1", "0"),
                (R, "0.35", "0", "0.05", "0.3"),
                (R, "0.1", "0.2", "0.02", "0"),
            ],
        ),
        arm(
            "position4r_j3",
            "task: [x, y, z]\ninverse_kinematics: {given: j3}",
            "position of three joints, axes 1 and 2 neither",
            4,
            &[
                (R, "0.1", quarter, "0.3", "0.1"),
                (R, elbow, "0", "0.1", "0"),
                (R, "0.35", "0", "0.05", "0.3"),
                (R, "0.1", "0.2", "0.02", "0"),
            ],
        ),
        arm(
            "position4r_general",
            "task: [x, y, z]",
            "position of three joints, axes 1, 2 and 3 neither are parallel nor intersect; q4 is given",
            4,
            &[
                (R, "0.2", "0.9", "0.3", "0.1"),
                (R, elbow, "-1.1", "0.1", "0"),
                (R, "0.35", quarter, "0.05", "0.3"),
                (R, "0.1", "0.2", "0.02", "0"),
            ],
        ),
        arm(
            "position_prpr",
            "task: [x, y, z]",
            "position of three joints, joints 1 and 3 slide; q4 is given",
            2,
            &[
                (P, "0.2", "0.9", "0.3", "0.1"),
                (R, elbow, "-1.1", "0.1", "0"),
                (P, "0.35", quarter, "0.05", "0.3"),
                (R, "0.1", "0.2", "0.02", "0"),
            ],
        ),
        // The same in a plane.
        arm(
            "planar4r",
            "task: [x, y, rz]",
            "all revolute axes parallel (joints 1 2 3); q4 is given",
            2,
            &[(R, "0.5", "0", "0", "0"), (R, "0.4", "0", "0", "0.2"), (R, "0.3", "0", "0", "0"), (R, "0.2", "0", "0", "0")],
        ),
        arm(
            "planar4r_j2",
            "task: [x, y, rz]\ninverse_kinematics: {given: j2}",
            "all revolute axes parallel (joints 1 3 4); q2 is given",
            2,
            &[(R, "0.5", "0", "0", "0"), (R, "0.4", "0", "0", "0.2"), (R, "0.3", "0", "0", "0"), (R, "0.2", "0", "0", "0")],
        ),
        arm(
            "planar3r_xy",
            "task: [x, y]",
            "position of three joints",
            2,
            &[(R, "0.5", "0", "0", "0"), (R, "0.4", "0", "0", "0.2"), (R, "0.3", "0", "0", "0")],
        ),
        // A spherical wrist after three unrelated axes, with angles that are no fractions of a turn.
        arm(
            "pieper",
            "",
            "spherical triple (axes 4 5 6 through one point), axes 1, 2 and 3 neither are parallel nor intersect",
            8,
            &[
                (R, "0.2", "0.9", "0.3", "0.1"),
                (R, elbow, "-1.1", "0.1", "0"),
                (R, "0.1", quarter, "0.05", "0.3"),
                (R, "0", "0.8", "0.35", "0"),
                (R, "0", "-1.2", "0", "0.2"),
                (R, "0.02", "0.3", "0.1", "0"),
            ],
        ),
        // Three parallel axes without a relation between the others.
        arm(
            "parallel",
            "",
            "three parallel axes (joints 2 3 4)",
            8,
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, elbow, "pi", "0.1", "0"),
                (R, "0.35", "0", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", "0"),
                (R, "0.07", "-1.2", "0.2", "0.2"),
                (R, "0.02", "0.3", "0.1", "0"),
            ],
        ),
        // A slide, an elbow, a wrist; modified in nothing else.
        arm(
            "track",
            "",
            "spherical triple (axes 4 5 6 through one point), joint 1 slides at right angles to axis 2",
            8,
            &[
                (P, "0.1", quarter, "0.2", "0"),
                (R, elbow, "0.7", "0.1", "0"),
                (R, "0.1", quarter, "0.05", "0.3"),
                (R, "0", quarter, "0.35", "0"),
                (R, "0", "-pi/2", "0", "0.2"),
                (R, "0", "0", "0.1", "0"),
            ],
        ),
        arm(
            "gantry",
            "",
            "three prismatic joints (joints 1 2 3)",
            2,
            &[
                (P, "0.1", quarter, "0.2", "pi/2"),
                (P, "0", "pi/2", "0.1", "pi/2"),
                (P, "0.1", "0.4", "0.05", "0.3"),
                (R, "0.05", quarter, "0.35", "0"),
                (R, "0.03", "-pi/2", "0.02", "0.2"),
                (R, "0", "0", "0.1", "0"),
            ],
        ),
        arm(
            "slides_apart",
            "",
            "two prismatic joints (joints 2 5)",
            8,
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (P, "0.2", "-1.1", "0.1", "0.4"),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", "0"),
                (P, "0.07", "-1.2", "0.2", "0.2"),
                (R, "0.02", "0.3", "0.1", "0"),
            ],
        ),
        arm(
            "table",
            "",
            "two prismatic joints (joints 1 2)",
            8,
            &[
                (P, "0", quarter, "0.2", quarter),
                (P, "0.1", "0", "0.1", "0"),
                (R, "0.3", quarter, "0.2", "0"),
                (R, "0.1", quarter, "0.1", "0.3"),
                (R, "0.05", "-pi/2", "0.35", "0"),
                (R, "0.02", "0", "0.1", "0"),
            ],
        ),
        // Five joints, position and direction of the z axis.
        arm(
            "pointing5r",
            POINTING,
            "three parallel axes (joints 2 3 4), axes 5 and 6 intersect or are parallel",
            8,
            &[
                (R, "0.1", quarter, "0.3", "0.1"),
                (R, elbow, "0", "0.1", "0"),
                (R, "0.35", "0", "0.05", "0.3"),
                (R, "0.08", quarter, "0.1", "0"),
                (R, "0", "1.1", "0.12", "0.2"),
            ],
        ),
        arm(
            "pointing_general",
            "tool: {xyz: [0.05, 0.02, 0.1], rpy: [0, 0.4, 0.5]}\n\
             inverse_kinematics: {target: pointing}",
            "general",
            16,
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, elbow, "-1.1", "0.1", "0"),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", "0"),
                (R, "0.07", "0.7", "0.2", "0.2"),
            ],
        ),
        // Six joints, one of them given.
        arm(
            "pointing6r",
            "tool: {xyz: [0.05, 0.02, 0.1], rpy: [0, 0.4, 0.5]}\n\
             inverse_kinematics: {target: pointing}",
            "spherical triple (axes 4 5 6 through one point)",
            8,
            &[
                (R, "0.1", quarter, "0.3", "0.1"),
                (R, elbow, "0", "0.1", "0"),
                (R, "0.02", "-pi/2", "0.05", "0"),
                (R, "0", quarter, "0.35", "0"),
                (R, "0", "-pi/2", "0", "0.2"),
                (R, "0", "0", "0.1", "0"),
            ],
        ),
        arm(
            "general",
            "",
            "general",
            16,
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, elbow, "-1.1", "0.1", "0"),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", "0"),
                (R, "0.07", "-1.2", "0.2", "0.2"),
                (R, "0.02", "0.3", "0.1", "0"),
            ],
        ),
        // Arms of industry, the first three with reference poses.
        arm(
            "stanford",
            "",
            "spherical triple (axes 4 5 6 through one point)",
            8,
            &[
                (R, "0", "-pi/2", "0.412", "0"),
                (R, "0", quarter, "0.154", "0"),
                (P, "0", "0", "0.3", "-pi/2"),
                (R, "0", "-pi/2", "0", "0"),
                (R, "0", quarter, "0", "0"),
                (R, "0", "0", "0.263", "0"),
            ],
        ),
        arm(
            "jaco2",
            "",
            "general",
            16,
            &[
                (R, "0", quarter, "0.2755", "0"),
                (R, "0.41", "pi", "0", "0"),
                (R, "0", quarter, "-0.0098", "0"),
                (R, "0", "deg(60)", "-0.2501", "0"),
                (R, "0", "deg(60)", "-0.0856", "0"),
                (R, "0", "pi", "-0.2028", "0"),
            ],
        ),
        arm(
            "general6r",
            "",
            "general",
            16,
            &[
                (R, "0.1", "deg(70)", "0.35", "0"),
                (R, "0.42", "deg(25)", "0.08", "0.3"),
                (R, "0.11", "deg(-80)", "0.07", "0"),
                (R, "0.06", "deg(65)", "0.37", "0"),
                (R, "0.05", "deg(-100)", "0.12", "-0.5"),
                (R, "0.03", "deg(20)", "0.14", "0"),
            ],
        ),
        arm(
            "xarm6",
            "",
            "general",
            16,
            &[
                (R, "0", "-pi/2", "0.267", "0"),
                (R, "0.28949", "0", "0", "-1.3849179"),
                (R, "0.0775", "-pi/2", "0", "1.3849179"),
                (R, "0", quarter, "0.3425", "0"),
                (R, "0.076", "-pi/2", "0", "0"),
                (R, "0", "0", "0.097", "0"),
            ],
        ),
        arm(
            "iiwa",
            "",
            "shoulder, elbow, wrist (axes 1 2 3 through one point, axes 5 6 7 through one point)",
            8,
            &[
                (R, "0", "-pi/2", "0.34", "0"),
                (R, "0", quarter, "0", "0"),
                (R, "0", quarter, "0.4", "0"),
                (R, "0", "-pi/2", "0", "0"),
                (R, "0", "-pi/2", "0.4", "0"),
                (R, "0", quarter, "0", "0"),
                (R, "0", "0", "0.126", "0"),
            ],
        ),
    ]
}

/// Arms with fewer joints than a pose has rows: name, rows.
pub(crate) fn few() -> Vec<(String, String)> {
    let arm = |(name, rows): &(&str, &[(&str, &str, &str, &str, &str)])| {
        let tool = "tool: {xyz: [0.05, 0.02, 0.1], rpy: [0.2, 0.4, 0.5]}";
        ((*name).to_owned(), description(name, tool, rows))
    };
    let (o, q, minus) = ("0", "pi/2", "-pi/2");
    let arms: &[(&str, &[(&str, &str, &str, &str, &str)])] = &[
        ("few_r", &[(R, "0.5", "0.3", "0.1", "0.2")]),
        ("few_p", &[(P, "0.5", "0.3", "0.1", "0.2")]),
        ("few_rr", &[(R, "0.5", "0.9", "0.1", "0.2"), (R, "0.3", "0.4", "0.2", o)]),
        ("few_rr_parallel", &[(R, "0.5", o, "0.1", "0.2"), (R, "0.3", "0.4", "0.2", o)]),
        ("few_rr_crossing", &[(R, o, q, "0.1", o), (R, o, o, o, o)]),
        ("few_rp", &[(R, "0.5", "0.9", "0.1", "0.2"), (P, "0.3", "0.4", "0.2", o)]),
        ("few_rp_along", &[(R, o, o, "0.1", "0.2"), (P, "0.3", "0.4", "0.2", o)]),
        ("few_pr", &[(P, "0.5", "0.9", "0.1", "0.2"), (R, "0.3", "0.4", "0.2", o)]),
        ("few_pp", &[(P, "0.5", "0.9", "0.1", "0.2"), (P, "0.3", "0.4", "0.2", o)]),
        ("few_rrr", &[(R, "0.2", "0.9", "0.1", "0.2"), (R, "0.4", "-1.1", "0.1", o), (R, "0.3", "0.4", "0.2", o)]),
        ("few_rrr_elbow", &[(R, "0.1", q, "0.3", o), (R, "0.4", o, o, o), (R, "0.3", o, o, o)]),
        ("few_rrr_planar", &[(R, "0.5", o, o, o), (R, "0.4", o, o, o), (R, "0.2", o, o, o)]),
        ("few_rrr_wrist", &[(R, o, q, "0.3", o), (R, o, minus, o, o), (R, o, o, "0.1", o)]),
        ("few_rrp", &[(R, "0.2", "0.9", "0.1", "0.2"), (R, "0.4", "-1.1", "0.1", o), (P, "0.3", "0.4", "0.2", o)]),
        ("few_rrp_flat", &[(R, "0.2", o, "0.1", "0.2"), (R, "0.4", o, "0.1", o), (P, "0.3", "0.4", "0.2", o)]),
        ("few_rpr_flat", &[(R, "0.2", q, "0.1", "0.2"), (P, "0.4", minus, "0.1", o), (R, "0.3", "0.4", "0.2", o)]),
        ("few_prr_elbow", &[(P, "0.2", "0.9", "0.1", "0.2"), (R, "0.4", o, "0.1", o), (R, "0.3", "0.4", "0.2", o)]),
        ("few_ppr", &[(P, "0.2", q, "0.1", "0.2"), (P, "0.4", q, "0.1", o), (R, "0.3", "0.4", "0.2", o)]),
        ("few_rpp", &[(R, "0.2", "0.4", "0.1", "0.2"), (P, "0.4", q, "0.1", o), (P, "0.3", "0.4", "0.2", o)]),
        ("few_ppp", &[(P, "0.2", q, "0.1", q), (P, "0.4", q, "0.1", q), (P, "0.3", "0.4", "0.2", o)]),
        (
            "few_4r",
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, "0.4", "-1.1", "0.1", o),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", o),
            ],
        ),
        ("few_4r_palletizer", &[(R, "0.1", q, "0.3", o), (R, "0.4", o, o, o), (R, "0.3", o, o, o), (R, "0.1", q, o, o)]),
        ("few_4r_wrist", &[(R, "0.1", q, "0.3", o), (R, o, q, "0.3", o), (R, o, minus, o, o), (R, o, o, "0.1", o)]),
        (
            "few_3rp",
            &[
                (R, "0.15", q, "0.3", "0.1"),
                (R, "0.4", o, "0.1", o),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (P, "0.12", "1.3", "0.1", o),
            ],
        ),
        (
            "few_p3r",
            &[
                (P, "0.15", "0.9", "0.3", "0.1"),
                (R, "0.4", o, "0.1", o),
                (R, "0.35", o, "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", o),
            ],
        ),
        (
            "few_rrpp",
            &[
                (R, "0.15", o, "0.3", "0.1"),
                (R, "0.4", "0.7", "0.1", o),
                (P, "0.35", "0.8", "0.05", "0.3"),
                (P, "0.12", "1.3", "0.1", o),
            ],
        ),
        (
            "few_5r",
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, "0.4", "-1.1", "0.1", o),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", o),
                (R, "0.07", "0.7", "0.2", "0.2"),
            ],
        ),
        (
            "few_5r_pick",
            &[(R, "0.03", q, "0.15", o), (R, "0.16", o, o, q), (R, "0.13", o, o, o), (R, o, q, o, q), (R, o, o, "0.2", o)],
        ),
        (
            "few_5r_wrist",
            &[(R, "0.1", q, "0.3", o), (R, "0.4", q, o, o), (R, o, q, "0.3", o), (R, o, minus, o, o), (R, o, o, "0.1", o)],
        ),
        (
            "few_5r_parallel",
            &[
                (R, "0.1", "0.7", "0.3", o),
                (R, "0.4", o, "0.1", o),
                (R, "0.3", o, o, o),
                (R, "0.1", "1.2", "0.1", o),
                (R, "0.05", "0.4", "0.1", o),
            ],
        ),
        (
            "few_2rp2r",
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, "0.4", "-1.1", "0.1", o),
                (P, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", o),
                (R, "0.07", "0.7", "0.2", "0.2"),
            ],
        ),
        (
            "few_4rp",
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, "0.4", "-1.1", "0.1", o),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", o),
                (P, "0.07", "0.7", "0.2", "0.2"),
            ],
        ),
        (
            "few_3r2p",
            &[
                (R, "0.15", o, "0.3", "0.1"),
                (P, "0.4", "-1.1", "0.1", o),
                (R, "0.35", o, "0.05", "0.3"),
                (P, "0.12", "1.3", "0.1", o),
                (R, "0.07", "0.7", "0.2", "0.2"),
            ],
        ),
        (
            "few_2r3p",
            &[
                (P, "0.15", "0.9", "0.3", "0.1"),
                (P, "0.4", "-1.1", "0.1", "0.7"),
                (P, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", o),
                (R, "0.07", "0.7", "0.2", "0.2"),
            ],
        ),
    ];
    arms.iter().map(arm).collect()
}

/// The robots of the repository, sorted by name.
pub(crate) fn robots() -> Vec<(String, String)> {
    let mut robots = Vec::new();
    for folder in ["robots", "tests/robots"] {
        let entries = std::fs::read_dir(workspace().join(folder)).expect("a folder of robots");
        let files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
        for file in files.iter().filter(|file| file.extension().is_some_and(|e| e == "yaml")) {
            let name = file.file_stem().expect("a file's name").to_string_lossy().into_owned();
            robots.push((name, std::fs::read_to_string(file).expect("a description")));
        }
    }
    robots.sort();
    robots
}

/// Arms with coupled joints: name, class, at most, description. The joints of the last one are not all between base and end effector.
pub(crate) fn coupled() -> Vec<(&'static str, &'static str, usize, String)> {
    let (o, q, minus) = ("0", "pi/2", "-pi/2");
    let arm =
        |name: &'static str, class, most, task: &str, rows: &[(&str, &str, &str, &str, &str)], couplings: &[(&str, &str)]| {
            let text = couplings.iter().fold(description(name, task, rows), |text, (joint, coupling)| {
                text.replacen(&format!("{{name: {joint}, "), &format!("{{name: {joint}, {coupling}, "), 1)
            });
            (name, class, most, text)
        };
    let elbow =
        [(R, "0.1", q, "0.3", "0.1"), (R, "0.4", o, "0.1", o), (R, "0.35", o, "0.05", "0.3"), (R, "0.1", "0.2", "0.02", o)];
    vec![
        // The third axis is counted from the horizontal, and the wrist has shafts through each other.
        arm(
            "coupled_6r",
            "spherical triple (axes 4 5 6 through one point), axes 2 and 3 are parallel; q1 to q6 are the variables of j1,",
            8,
            "",
            &[
                (R, "0.1", q, "0.3", "0.1"),
                (R, "0.4", o, "0.1", o),
                (R, "0.02", minus, "0.05", o),
                (R, o, q, "0.35", o),
                (R, o, minus, o, "0.2"),
                (R, o, o, "0.1", o),
            ],
            &[
                ("j3", "adds: {j2: -1}, offset: pi/2, limits: {position: [-2, 1]}"),
                ("j5", "adds: {j4: -1}"),
                ("j6", "adds: {j5: 2, j4: 1}, offset: 0.3, limits: {position: [-6, 9]}"),
            ],
        ),
        arm(
            "coupled_general",
            "general",
            16,
            "",
            &[
                (R, "0.15", "0.9", "0.3", "0.1"),
                (R, "0.4", "-1.1", "0.1", o),
                (R, "0.35", "0.8", "0.05", "0.3"),
                (R, "0.12", "1.3", "0.1", o),
                (R, "0.07", "-1.2", "0.2", "0.2"),
                (R, "0.02", "0.3", "0.1", o),
            ],
            &[("j2", "adds: {j1: 1}"), ("j5", "adds: {j2: -1}, offset: 7")],
        ),
        // The value of a joint is given, which is no coordinate.
        arm(
            "coupled_4r",
            "position of three joints, axes 2 and 3 are parallel; q4 is given",
            4,
            "task: [x, y, z]",
            &elbow,
            &[("j4", "adds: {j3: 1}, offset: -1")],
        ),
        arm(
            "coupled_swivel",
            "shoulder, elbow, wrist",
            8,
            "",
            &[
                (R, o, minus, "0.36", o),
                (R, o, q, o, o),
                (R, o, q, "0.42", o),
                (R, o, minus, o, o),
                (R, o, minus, "0.4", o),
                (R, o, q, o, o),
                (R, o, o, "0.126", o),
            ],
            &[("j2", "adds: {j1: 1}"), ("j7", "adds: {j6: -3}")],
        ),
        // Joints turn as a slide moves; the slide itself has another slide before it.
        arm(
            "coupled_slides",
            "position of three joints, joints 1 and 2 slide",
            2,
            "task: [x, y, z]",
            &[(P, "0.2", "0.9", "0.3", "0.1"), (P, "0.4", "-1.1", "0.1", o), (R, "0.35", q, "0.05", "0.3")],
            &[("j2", "adds: {j1: 2/3}"), ("j3", "adds: {j1: 0.5, j2: sqrt(2)}")],
        ),
        // Few joints, with virtual ones behind them.
        arm(
            "coupled_few",
            "3 joints and",
            8,
            "tool: {xyz: [0.05, 0.02, 0.1], rpy: [0.2, 0.4, 0.5]}",
            &[(R, "0.1", q, "0.3", o), (R, "0.4", o, o, o), (R, "0.3", o, o, o)],
            &[("j3", "adds: {j2: 1}")],
        ),
        // Two bars in parallel: a crank beside the lower arm moves the upper one.
        (
            "coupled_bars",
            "position of three joints, joint 3 slides, axes 2 and 1 are parallel; q1 to q2 are the variables of lower, forearm,",
            2,
            BARS.into(),
        ),
    ]
}

const BARS: &str = "name: coupled_bars
convention: urdf
gravity: [0, -9.81, 0]
task: [x, y]
tip: forearm
tool: {xyz: [0.6, 0, 0]}
joints:
  - {name: lower, type: revolute, axis: [0, 0, 1], link: {mass: 8, com: [0.25, 0, 0], inertia: {xx: 0, yy: 0.2, zz: 0.2}}}
  - {name: crank, type: revolute, parent: base, axis: [0, 0, 1], limits: {position: [-1, 2]}, link: {mass: 3, com: [0.1, 0, 0], inertia: {xx: 0, yy: 0.02, zz: 0.02}}}
  - {name: forearm, type: revolute, parent: lower, origin: {xyz: [0.5, 0, 0]}, axis: [0, 0, 1], follows: {crank: 1, lower: -1}, link: {mass: 6, com: [0.2, 0, 0], inertia: {xx: 0, yy: 0.15, zz: 0.15}}}
  - {name: rod, type: revolute, parent: crank, origin: {xyz: [-0.2, 0, 0]}, axis: [0, 0, 1], follows: {lower: 1, crank: -1}, link: {mass: 1.5, com: [0.25, 0, 0], inertia: {xx: 0, yy: 0.03, zz: 0.03}}}
";
