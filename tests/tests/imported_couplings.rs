//! A URDF with `mimic`: its equations are those of the same file with all joints free, at q = S p + c, multiplied by S'.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use armgen_import::{import, Imported, Options};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{deviation, REFERENCE};
use armgen_tests::random::Random;

/// A wrist, two bars that turn against each other and twice as far, and two fingers on the second bar; followers of followers, and one
/// before its leader.
const FILE: [(&str, &str, &str, &str); 5] = [
    ("wrist", "revolute", "base", ""),
    ("bar", "revolute", "wrist", "<mimic joint='wrist' multiplier='-1' offset='0.3'/>"),
    ("twice", "revolute", "bar", "<mimic joint='bar' multiplier='-2'/>"),
    ("right", "prismatic", "twice", "<mimic joint='left' multiplier='-1.5' offset='0.01'/>"),
    ("left", "prismatic", "twice", ""),
];
/// S and c of q = S p + c, by hand, joints in the order of the description.
const COUPLING: [(&str, [f64; 2], f64); 5] = [
    ("wrist", [1.0, 0.0], 0.0),
    ("bar", [-1.0, 0.0], 0.3),
    ("twice", [2.0, 0.0], -0.6),
    ("right", [0.0, -1.5], 0.01),
    ("left", [0.0, 1.0], 0.0),
];

/// The same with multipliers of followers that are no whole numbers, of which one slides.
const FRACTIONS: [&str; 5] = [
    "",
    "<mimic joint='wrist' multiplier='-0.785' offset='0.3'/>",
    "<mimic joint='left' multiplier='12.5' offset='0.1'/>",
    "<mimic joint='bar' multiplier='0.02'/>",
    "",
];
const BY_FRACTIONS: Coupling =
    [([1.0, 0.0], 0.0), ([-0.785, 0.0], 0.3), ([0.0, 12.5], 0.1), ([-0.0157, 0.0], 0.006), ([0.0, 1.0], 0.0)];
type Coupling = [([f64; 2], f64); 5];

fn file(angle: &str) -> String {
    let joints = FILE.iter().enumerate().map(|(k, (name, kind, parent, mimic))| {
        let (mass, at) = (1.0 + 0.3 * k as f64, 0.05 * (k + 1) as f64);
        format!(
            "<link name='{name}'><inertial><origin xyz='{at} 0.02 -0.03'/><mass value='{mass}'/>\
             <inertia ixx='0.02' iyy='0.03' izz='0.025' ixy='0.001' ixz='0' iyz='0.002'/></inertial></link>\
             <joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{name}'/><origin xyz='{at} 0 0.1' rpy='{angle} 0 0'/>\
             <axis xyz='0 1 0'/><limit lower='-1' upper='1' velocity='1' effort='1'/><dynamics damping='0.5' friction='0.2'/>{mimic}</joint>"
        )
    });
    format!("<robot name='r'><link name='base'/>{}</robot>", joints.collect::<String>())
}

#[track_caller]
fn imported(text: &str, snap: f64) -> Imported {
    let source = Source::new("robot.urdf", text);
    let (imported, diagnostics) = import(&source, &Options { all: true, snap, ..Options::default() });
    imported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never)))
}

#[track_caller]
fn robot(yaml: &str) -> Interpreted {
    Interpreted::new(yaml).unwrap_or_else(|fault| panic!("{fault}\n{yaml}"))
}

fn random(random: &mut Random, count: usize) -> Vec<f64> {
    (0..count).map(|_| random.real(-1.0, 1.0)).collect()
}

/// S p.
fn led(by: &Coupling, p: &[f64]) -> Vec<f64> {
    by.iter().map(|(row, _)| row[0] * p[0] + row[1] * p[1]).collect()
}

/// S' f.
fn projected(by: &Coupling, forces: &[f64]) -> Vec<f64> {
    (0..2).map(|a| by.iter().zip(forces).map(|((row, _), force)| row[a] * force).sum()).collect()
}

/// S' M S.
fn projected_matrix(by: &Coupling, matrix: &[f64]) -> Vec<f64> {
    let columns = [[1.0, 0.0], [0.0, 1.0]].map(|p| {
        let column: Vec<f64> = matrix.chunks(5).map(|row| row.iter().zip(led(by, &p)).map(|(m, s)| m * s).sum()).collect();
        projected(by, &column)
    });
    vec![columns[0][0], columns[1][0], columns[0][1], columns[1][1]]
}

#[test]
fn equations_are_those_of_the_free_file_projected() {
    let whole = file("1.5708");
    check(&whole, &COUPLING.map(|(_, row, offset)| (row, offset)));
    let mut fractions = whole;
    for ((.., mimic), by) in FILE.iter().zip(FRACTIONS).filter(|((.., mimic), _)| !mimic.is_empty()) {
        fractions = fractions.replace(mimic, by);
    }
    check(&fractions, &BY_FRACTIONS);
}

#[track_caller]
fn check(text: &str, by: &Coupling) {
    let coupled = imported(text, Options::SNAP).yaml;
    let mut without = text.to_owned();
    FILE.iter().map(|(.., mimic)| *mimic).chain(FRACTIONS).for_each(|mimic| without = without.replace(mimic, ""));
    let free = imported(&without, Options::SNAP).yaml;
    let names = COUPLING.map(|(name, ..)| format!("  - name: {name}  # joint"));
    for yaml in [&coupled, &free] {
        let found: Vec<&str> = yaml.lines().filter(|line| names.iter().any(|name| line.starts_with(name))).collect();
        assert!(found.len() == 5 && found.iter().zip(&names).all(|(line, name)| line.starts_with(name)), "{yaml}");
    }
    let (coupled, free) = (robot(&coupled), robot(&free));
    let mut numbers = Random::new(3);
    for _ in 0..10 {
        let [p, dp, ddp] = [(); 3].map(|()| random(&mut numbers, 2));
        let q = led(by, &p).iter().zip(by).map(|(q, (_, offset))| q + offset).collect();
        let all = Arguments { q, dq: led(by, &dp), ddq: led(by, &ddp), ..Arguments::default() };
        let own = Arguments { q: p, dq: dp, ddq: ddp, ..Arguments::default() };
        for function in ["gravity", "friction", "inverse_dynamics"] {
            let off = deviation(&coupled.call(function, &own), &projected(by, &free.call(function, &all)));
            assert!(off < REFERENCE, "{function}: {off:e}");
        }
        for function in ["inertia_matrix", "coriolis_matrix"] {
            let off = deviation(&coupled.call(function, &own), &projected_matrix(by, &free.call(function, &all)));
            assert!(off < REFERENCE, "{function}: {off:e}");
        }
    }
}

/// A slide of 5 kg follows a light joint by 20 m a radian: snapping turns the slide's axis, which the light joint feels 20 times.
#[test]
fn the_bound_of_snapping_counts_followers_at_their_leaders() {
    let joint = |name: &str, kind: &str, mass: &str, inside: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='{mass}'/><inertia ixx='1e-3' iyy='1e-3' izz='1e-3' ixy='0' ixz='0' iyz='0'/></inertial></link>\
             <joint name='{name}' type='{kind}'><parent link='base'/><child link='{name}'/><axis xyz='0 0 1'/>\
             <limit lower='-1' upper='1' velocity='1' effort='1'/>{inside}</joint>"
        )
    };
    let angle = "1.57080";
    let follower = format!("<origin xyz='0 0 0' rpy='{angle} 0 0'/><mimic joint='light' multiplier='20'/>");
    let joints = [joint("light", "revolute", "0.001", ""), joint("slide", "prismatic", "5", &follower)].concat();
    let text = format!("<robot name='r'><link name='base'/>{joints}</robot>");
    let (snapped, exact) = (imported(&text, Options::SNAP), imported(&text, 0.0));
    let report: serde_json::Value = serde_json::from_str(&snapped.report.to_json()).expect("JSON");
    let bound = report["bound"]["torque"].as_f64().expect("a bound");
    let state = Arguments { q: vec![0.0], dq: vec![0.5], ddq: vec![3.0], ..Arguments::default() };
    let [a, b] = [snapped, exact].map(|arm| robot(&arm.yaml).call("inverse_dynamics", &state)[0]);
    let moved = (a - b).abs();
    // 20 · 5 kg · 9.81 m/s² · (1.5708 - pi/2)
    let turned = angle.parse::<f64>().expect("a number") - std::f64::consts::FRAC_PI_2;
    assert!((moved - 100.0 * 9.81 * turned).abs() < 1e-9, "{moved:e}");
    assert!(moved <= bound && bound < 10.0 * moved, "{moved:e}, bound {bound:e}");
}
