//! Random arms through the generator. Every emitted text exactly equals the equations and keeps every identity. Cargo compiles
//! some as a user's own crate, which the oracle judges.
//!
//! | variable | what | unless given |
//! |---|---|---:|
//! | `ARMGEN_RANDOM_ARMS` | arms that are certified | 32 |
//! | `ARMGEN_COMPILED_ARMS` | arms that are compiled, every other one of poses | 8 |
//! | `ARMGEN_FIRST_ARM` | seed of the first of them: a later run goes on where an earlier one stopped | 0 |
//!
//! A failure names its seed, which makes the same arm everywhere; arms are texts, so that a shrinking of values would shrink nothing that a
//! reader needs smaller.

use std::collections::BTreeMap;
use std::fmt;
use std::panic::AssertUnwindSafe;
use std::path::Path;

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::kinds::JointKind;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_tests::compiled::Compiled;
use armgen_tests::functions::expected;
use armgen_tests::judge::{judge, Tolerance};
use armgen_tests::precision::{FORWARD_RESIDUAL, ORACLE};
use armgen_tests::random::{self, Random};
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::verify_with;

const ARMS: u64 = 32;
const COMPILED: u64 = 8;
const IN_A_CRATE: u64 = 20;
/// Percent of the arms with 1, 2, .. 8 joints: an arm of eight costs as much as a hundred of one.
const PERCENT: [i64; 8] = [36, 28, 12, 8, 5, 4, 4, 3];
/// Points in prime fields, each of its own prime.
const POINTS: usize = 2;
/// Interval of the arms that also run at a rational point, and their largest number of joints.
const EXACT: (u64, usize) = (16, 4);

fn asked(variable: &str, otherwise: u64) -> u64 {
    std::env::var(variable).map_or(otherwise, |text| text.parse().unwrap_or_else(|_| panic!("{variable} is a number")))
}

/// Processor time of this process so far in seconds, all its threads together, where the system reports it.
fn processor_time() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The 14th and 15th word, in hundredths; the name, second, may have blanks and ends with the last parenthesis.
    let words = text.rsplit(')').next().unwrap_or_default().split_whitespace();
    words.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// What occurred among the arms.
#[derive(Debug, Default)]
struct Seen {
    what: BTreeMap<String, u64>,
    /// By number of joints: arms, processor seconds of generating and of certifying.
    cost: BTreeMap<usize, (u64, f64, f64)>,
    /// log2 of the odds with which the worst function of all could pass although it differs.
    log2_odds: Option<f64>,
}

impl Seen {
    fn add(&mut self, what: impl Into<String>) {
        *self.what.entry(what.into()).or_default() += 1;
    }
}

impl fmt::Display for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (what, arms) in &self.what {
            writeln!(f, "{arms:7}  {what}")?;
        }
        writeln!(f, "odds of a miss: at most 2^{:.0} a function", self.log2_odds.unwrap_or(0.0).ceil())?;
        let mut all = (0, 0.0, 0.0);
        writeln!(f, "joints   arms  generating  certifying (s of processor time an arm)")?;
        let line = |f: &mut fmt::Formatter<'_>, joints: &str, (arms, generating, certifying): (u64, f64, f64)| {
            let each = arms.max(1) as f64;
            writeln!(f, "{joints:>6}{arms:7}{:12.3}{:12.3}", generating / each, certifying / each)
        };
        for (joints, cost) in &self.cost {
            all = (all.0 + cost.0, all.1 + cost.1, all.2 + cost.2);
            line(f, &joints.to_string(), *cost)?;
        }
        line(f, "all", all)
    }
}

#[test]
#[ignore = "wide"]
fn random_arms_equal_their_equations_and_keep_every_identity_exactly() {
    let arms = asked("ARMGEN_RANDOM_ARMS", ARMS);
    let first = asked("ARMGEN_FIRST_ARM", 0);
    let (mut seen, mut failed) = (Seen::default(), Vec::new());
    for (done, seed) in (first..first + arms).enumerate() {
        if std::panic::catch_unwind(AssertUnwindSafe(|| certify(seed, &mut seen))).is_err() {
            failed.push(seed);
        }
        if (done + 1).is_multiple_of(100) {
            eprintln!("seeds {first} to {seed}, failed {failed:?}\n{seen}");
        }
    }
    assert!(failed.is_empty(), "the arms of seeds {failed:?} fail: each stands above");
    let never: Vec<&String> = seen.what.iter().filter(|(_, arms)| **arms == 0).map(|(what, _)| what).collect();
    assert!(arms < ARMS || never.is_empty(), "among {arms} arms none has {never:?}");
    println!("{arms} arms from seed {first} on: each arm equals its equations and keeps every identity\n{seen}");
}

/// Seeds of arms that earlier versions failed to generate, or judged wrong. Constants had reciprocals that grew with every pivot,
/// a centre of mass lay on the bisector of two axes, or pairs of factors were shared and split for ever.
#[test]
fn arms_that_took_a_mend_stay_mended() {
    for seed in [575, 630, 2723, 4951, 5350] {
        certify(seed, &mut Seen::default());
    }
}

/// Arms with branches of 2 to 5 joints.
#[test]
fn trees_equal_their_equations_and_keep_every_identity_exactly() {
    (0..4).for_each(certify_tree);
}

#[test]
#[ignore = "wide"]
fn more_trees_equal_their_equations_and_keep_every_identity_exactly() {
    (4..32).for_each(certify_tree);
}

/// The same with motors on any link, which spin with any joints.
#[test]
fn trees_with_coupled_motors_equal_their_equations_and_keep_every_identity_exactly() {
    (0..4).for_each(certify_motors);
}

#[test]
#[ignore = "wide"]
fn more_trees_with_coupled_motors_equal_their_equations_and_keep_every_identity_exactly() {
    (4..48).for_each(certify_motors);
}

fn certify_motors(seed: u64) {
    let joints = 2 + (seed % 4) as usize;
    let text = random::tree_with_motors(&format!("motors_{seed}"), joints, &mut Random::new(seed));
    certify_arm(seed, joints, &text, &mut Seen::default());
}

fn certify_tree(seed: u64) {
    let joints = 2 + (seed % 4) as usize;
    let text = random::tree(&format!("tree_{seed}"), joints, &mut Random::new(seed));
    certify_arm(seed, joints, &text, &mut Seen::default());
}

/// Products of rotations by general angles have no short form: a seed for each number of joints.
#[test]
#[ignore = "wide"]
fn arms_with_general_angles_alone_equal_their_equations() {
    for (seed, joints) in [(1, 4), (2, 5), (3, 6), (4, 7), (5, 9)] {
        let text = random::arm_with_general_angles(&format!("general_{joints}"), joints, &mut Random::new(seed));
        certify_arm(seed, joints, &text, &mut Seen::default());
    }
}

/// Slides in directions without a zero: all that their functions divide by are constants, each pivot made of those before it.
#[test]
#[ignore = "wide"]
fn chains_of_slides_equal_their_equations() {
    for joints in [1, 2, 3, 5, 8, 12] {
        println!("{joints} slides");
        let seed = 100 + joints as u64;
        let text = random::slides(&format!("slides_{joints}"), joints, &mut Random::new(seed));
        certify_arm(seed, joints, &text, &mut Seen::default());
    }
}

/// Names the arm in any panic.
struct Named<'a>(u64, &'a str);

impl Drop for Named<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            println!("the arm of seed {}:\n{}", self.0, self.1);
        }
    }
}

/// The arm of a seed.
fn arm(seed: u64) -> (usize, String) {
    let mut random = Random::new(seed);
    let drawn = random.whole(1, 100);
    let mut below = 0;
    let reached = |percent: &i64| {
        below += percent;
        drawn <= below
    };
    let joints = 1 + PERCENT.iter().position(reached).expect("they add up to 100");
    (joints, random::arm_with(&format!("arm_{seed}"), joints, &mut random))
}

fn certify(seed: u64, seen: &mut Seen) {
    let (joints, text) = arm(seed);
    certify_arm(seed, joints, &text, seen);
}

fn certify_arm(seed: u64, joints: usize, text: &str, seen: &mut Seen) {
    let _named = Named(seed, text);
    let source = Source::new("robot.yaml", text);
    let scalar = if seed.is_multiple_of(4) { Scalar::F32 } else { Scalar::F64 };
    let start = processor_time();
    let (generated, said) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() });
    let generated = generated.unwrap_or_else(|| panic!("seed {seed}:\n{}\n{text}", said.render(&source, Colour::Never)));
    let generating = processor_time() - start;
    let exact_points = usize::from(seed.is_multiple_of(EXACT.0) && joints <= EXACT.1);
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    let report = verify_with(&source, &generated.module, claims, Effort { points: POINTS, exact_points, seed });
    let certifying = processor_time() - start - generating;
    assert!(report.passed(), "seed {seed}: {}\n{text}", report.first_fault().unwrap_or_default());
    let certified: Vec<&str> = report.functions.iter().map(|function| function.name.as_str()).collect();
    let absent: Vec<String> = generated.absent.iter().map(|absent| absent.function.clone()).collect();
    assert_eq!(certified, expected(&absent, text), "seed {seed}");
    let untried: Vec<_> = report.identities.iter().filter_map(|i| i.holds.as_ref().err().map(|why| (&i.name, why))).collect();
    let (manipulator, _) = validate::read(&source).0.expect("it was generated from");
    assert_eq!(manipulator.dof(), joints, "seed {seed}");
    let cost = seen.cost.entry(joints).or_default();
    *cost = (cost.0 + 1, cost.1 + generating, cost.2 + certifying);
    let odds = report.functions.iter().map(|function| function.log2_odds).fold(f64::NEG_INFINITY, f64::max);
    seen.log2_odds = Some(seen.log2_odds.map_or(odds, |worst| worst.max(odds)));
    for (name, why) in untried {
        seen.add(format!("identity not tried: {name}: {why}"));
    }
    seen.add(format!("identities {}", report.identities.len()));
    seen.add(format!("joints {}", manipulator.joints.len()));
    for (what, holds) in [
        ("a prismatic joint", manipulator.joints.iter().any(|joint| joint.kind == JointKind::Prismatic)),
        ("a revolute joint", manipulator.joints.iter().any(|joint| joint.kind == JointKind::Revolute)),
        ("a motor", text.contains("    motor:")),
        ("a tool", text.contains("\ntool:")),
        ("a payload", text.contains("\npayload:")),
        ("standard convention", text.contains("convention: standard")),
        ("modified convention", text.contains("convention: modified")),
        ("named parameters", text.contains("\nparameters:")),
        ("an operational inertia", absent.is_empty()),
        ("f32", scalar == Scalar::F32),
    ] {
        *seen.what.entry(what.to_owned()).or_default() += u64::from(holds);
    }
}

#[test]
#[ignore = "wide"]
fn random_arms_compile_and_agree_with_the_oracle() {
    let (from, arms) = (asked("ARMGEN_FIRST_ARM", 0), asked("ARMGEN_COMPILED_ARMS", COMPILED));
    for first in (from..from + arms).step_by(IN_A_CRATE as usize) {
        let seeds: Vec<u64> = (first..(from + arms).min(first + IN_A_CRATE)).collect();
        let text = |seed: u64| if seed.is_multiple_of(2) { arm(seed).1 } else { random::posed_arm(seed) };
        let texts: Vec<String> = seeds.iter().map(|seed| text(*seed)).collect();
        let modules: Vec<String> = texts
            .iter()
            .map(|text| {
                let (generated, _) = armgen_codegen::generate(&Source::new("robot.yaml", text.clone()), &Options::default());
                generated.unwrap_or_else(|| panic!("not valid:\n{text}")).module
            })
            .collect();
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("random-arms");
        for ((robot, text), seed) in Compiled::all(&root, &modules).iter().zip(&texts).zip(&seeds) {
            judge(&format!("compiled arm {seed}"), robot, text, *seed, Tolerance { values: ORACLE, residual: FORWARD_RESIDUAL });
        }
        eprintln!("{} arms compiled and judged", first - from + seeds.len() as u64);
    }
}
