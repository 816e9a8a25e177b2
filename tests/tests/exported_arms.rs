//! Arms with the numbers of real files: each has a module that equals its equations, or a diagnostic that names its remedy.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_tests::exported_arms::{arm, Before};
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::verify_with;

/// Less than any thread has: how deep calls go must not follow from numbers.
const STACK: usize = 1 << 20;

fn answered(seeds: std::ops::Range<u64>, joints: (i64, i64), before: Before) {
    let work = move || {
        for seed in seeds {
            println!("seed {seed}, {before:?}");
            let source = Source::new("robot.yaml", arm(seed, joints, before));
            let (generated, said) = armgen_codegen::generate(&source, &Options::default());
            let said = said.render(&source, Colour::Never);
            assert!(generated.is_some() || said.contains("error[") && said.contains("help:"), "seed {seed}:\n{said}");
        }
    };
    std::thread::Builder::new().stack_size(STACK).spawn(work).expect("a thread").join().expect("an answer to each");
}

#[test]
fn arms_with_numbers_of_real_files_have_an_answer() {
    answered(0..6, (2, 3), Before::Nothing);
    answered(0..2, (2, 2), Before::Mobile);
}

/// A module of a text that equals its equations.
fn verified(text: String, scalar: Scalar) {
    let source = Source::new("robot.yaml", text);
    let generated = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() }).0.expect("a module");
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    let report = verify_with(&source, &generated.module, claims, Effort { points: 2, exact_points: 1, seed: 1 });
    assert!(report.passed(), "{}\n{}", report.first_fault().unwrap_or_default(), source.text());
}

/// A link whose origin lies next to the axis before it, and not on it: its torque comes from a lever arm of micrometres, whose digits no sum with
/// a longer one may take.
#[test]
fn short_lever_arms_keep_their_digits() {
    for (dust, lever, turn) in [("1.7e-06", "0.132", "1.33"), ("-3.3e-09", "-0.4", "0.2"), ("1e-05", "0.25", "2.214")] {
        let text = format!(
            "name: short\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n  \
             - {{name: yaw, type: revolute, axis: [0, 0, 1], link: {{mass: 30, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n  \
             - {{name: shoulder, type: revolute, origin: {{xyz: [0, {dust}, -0.3], rpy: [-1.5708, 1.5708, {turn}]}}, axis: [0, 0, -1],\n     \
                link: {{mass: 1, inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}\n  \
             - {{name: elbow, type: revolute, origin: {{xyz: [-3.0e-06, {dust}, {lever}], rpy: [pi/2, 3.141593, -pi/3]}}, axis: [0, 0, 1],\n     \
                link: {{mass: 8, com: [0, -0.47, 0], inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}\n"
        );
        verified(text, Scalar::F64);
    }
    // The next axis passes the joint's own within a micrometre, and is nearly parallel to it: the foot of their common normal is 8 cm away.
    for (dust, turn) in [("-8.1107e-07", "0.782907"), ("2e-06", "0.7829"), ("-1e-08", "0.78")] {
        let text = format!(
            "name: short\nconvention: urdf\ngravity: [0, 0, -9.81]\njoints:\n  \
             - {{name: rail, type: prismatic, axis: [1, 0, 0], link: {{mass: 30, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n  \
             - {{name: shoulder, type: revolute, origin: {{xyz: [0.1524, 0, 0], rpy: [3.1415927, -1.570797, 0.7854]}},\n     \
                axis: [0.286, -0.758, -0.457], link: {{mass: 1, inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}\n  \
             - {{name: elbow, type: revolute, origin: {{xyz: [{dust}, 0, -9.7e-09], rpy: [-1.844319, -3.141893, {turn}]}},\n     \
                axis: [-0.441, 0.285, 0.416], link: {{mass: 1, com: [0.333, 0, 0], inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}\n"
        );
        verified(text, Scalar::F64);
    }
}

/// A centre of mass beside its joint axis by dust: where the mixed second moment would vanish lies kilometres away, and no digit comes back.
#[test]
fn dust_in_a_center_of_mass_moves_no_origin_away() {
    for dust in ["2.84822e-08", "-1e-09", "3e-07", "1e-16"] {
        let text = format!(
            "name: dusty\nconvention: modified\ngravity: [0, 0, -9.81]\njoints:\n  \
             - {{name: yaw, type: revolute, a: 0.08, alpha: 0, d: -0.373, theta: 0,\n     \
                link: {{mass: 2.5, com: [{dust}, -0.5, 0.0033], inertia: {{xx: 0.119, yy: 0.108, zz: 0.109}}}}}}\n  \
             - {{name: shoulder, type: revolute, a: 0, alpha: -pi/3, d: 3e-05, theta: -2.479,\n     \
                link: {{mass: 1, com: [0.58, 0, 0], inertia: {{xx: 0.1, yy: 0.11, zz: 0.11, xy: -0.006, xz: 0.0017, yz: -0.009}}}}}}\n  \
             - {{name: elbow, type: revolute, a: 0.4178, alpha: pi/2, d: -1e-09, theta: -1.653,\n     \
                link: {{mass: 1, com: [-0.31, -0.031, 0], inertia: {{xx: 0.1, yy: 0.11, zz: 0.11}}}}}}\n"
        );
        verified(text, Scalar::F32);
    }
}

/// Forty arms, on the ground, on a rail and on a mobile base, every third in single precision. `ARMGEN_FIRST_ARM` is the first seed.
#[test]
#[ignore = "wide"]
fn many_arms_with_numbers_of_real_files_equal_their_equations() {
    let first: u64 = std::env::var("ARMGEN_FIRST_ARM").map_or(100, |text| text.parse().expect("a number"));
    let mut refused = 0;
    for (count, joints, before) in [(28, (2, 4), Before::Nothing), (6, (2, 3), Before::Rail), (6, (2, 3), Before::Mobile)] {
        answered(first..first + count, joints, before);
        for seed in first..first + count {
            let source = Source::new("robot.yaml", arm(seed, joints, before));
            let scalar = if seed.is_multiple_of(3) { Scalar::F32 } else { Scalar::F64 };
            let Some(generated) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() }).0 else {
                refused += 1;
                continue;
            };
            let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
            let report = verify_with(&source, &generated.module, claims, Effort { points: 2, exact_points: 1, seed });
            let fault = report.first_fault().unwrap_or_default();
            assert!(report.passed(), "seed {seed}, {before:?}, {scalar:?}: {fault}\n{}", source.text());
        }
    }
    // A value that leaves the scalar; few arms have any.
    assert!(refused <= 2, "{refused} of 40 are refused");
}
