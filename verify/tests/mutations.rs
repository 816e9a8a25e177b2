//! The checker finds changes of an emitted module, with the function and the entry they affect.
//!
//! A change that alters no bit of any entry at many states does not count. Neither does a change whose effect cancels before the result: both
//! functions then agree to 40 digits everywhere, and the changed one is equally correct. `ARMGEN_CHANGES` is how many are drawn of every robot in
//! both scalars, 40 if it is not set. More of them run with
//! `ARMGEN_CHANGES=200 cargo test --release -p armgen-verify --test all -- --ignored --nocapture many_changes_are_found`.

use crate::common;
#[path = "common/mutation.rs"]
mod mutation;

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::validate;
use armgen_verify::certificate::report::Verdict;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::{Constant, Module};
use armgen_verify::values::arithmetic::wide::{Wide, WideArguments};
use armgen_verify::values::contract::Promise;
use armgen_verify::values::element::Element;
use armgen_verify::values::enclosure::Float;
use armgen_verify::values::float::Arguments;
use armgen_verify::values::program::Program;
use armgen_verify::values::stream::Stream;
use armgen_verify::{judge::constants, prepare, verify_with};

use mutation::Mutable;

/// Random arguments of typical size for a robot, with positive parameters.
fn arguments(stream: &mut Stream, n: usize, p: usize) -> Arguments<f64> {
    let mut many = |count: usize, low: f64, high: f64| -> Vec<f64> {
        (0..count).map(|_| low + (high - low) * (stream.bits() >> 11) as f64 / (1u64 << 53) as f64).collect()
    };
    let pi = many(p, 0.1, 3.0);
    let [q, dq, ddq, dqr, ddqr, tau] = [3.0, 2.0, 5.0, 2.0, 5.0, 20.0].map(|size| many(n, -size, size));
    Arguments { pi, q, dq, ddq, dqr, ddqr, tau, g0: many(3, -10.0, 10.0) }
}

/// Entries whose bits differ at some state.
fn changed_entries(a: &Program, b: &Program, real: Float, states: &[Arguments<f64>]) -> Vec<String> {
    let mut changed = vec![false; a.outputs.len()];
    for state in states {
        let (a, b) = (a.run_float(state, real), b.run_float(state, real));
        for (changed, (a, b)) in changed.iter_mut().zip(a.iter().zip(&b)) {
            // 0 and -0 differ here; all NaNs are equal.
            *changed |= a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan());
        }
    }
    a.outputs.iter().zip(changed).filter(|(_, changed)| *changed).map(|(output, _)| output.place.clone()).collect()
}

/// Whether two constants have the same value, in any notation.
fn same_bits(a: &Constant, b: &Constant) -> bool {
    match (a, b) {
        (Constant::Array(a), Constant::Array(b)) => a.iter().zip(b).all(|(a, b)| same_bits(a, b)),
        (Constant::Number(p, a), Constant::Number(q, b)) => p == q && a.value == b.value,
        (a, b) => a == b,
    }
}

/// Entries that differ in 40 digits at some states; otherwise only rounding differs.
fn different_entries(a: &Program, b: &Program, states: &[Arguments<f64>]) -> Vec<String> {
    let values = |p: &Program, state: &WideArguments| -> Vec<Option<Wide>> {
        p.run(state, &p.literals_as_floats().expect("angles of moderate size"))
    };
    let mut different = vec![false; a.outputs.len()];
    for state in states.iter().take(6) {
        let state = WideArguments::new(state).expect("angles of moderate size");
        for (different, pair) in different.iter_mut().zip(values(a, &state).iter().zip(values(b, &state))) {
            *different |= match pair {
                (Some(a), Some(b)) => a.minus(&b).to_f64().abs() > 1e-40 * (1.0 + a.to_f64().abs()),
                _ => true,
            };
        }
    }
    a.outputs.iter().zip(different).filter(|(_, different)| *different).map(|(output, _)| output.place.clone()).collect()
}

/// Makes changes until `wanted` of them count, each of which must be found. Returns the kinds of changes found.
fn check(name: &str, options: &Options, wanted: usize) -> BTreeSet<mutation::Kind> {
    let start = std::time::Instant::now();
    let (source, scalar) = (common::source(name), options.scalar);
    let generated = common::generate_with(&source, options);
    let (read, _) = validate::read_for(&source, scalar);
    let (manipulator, _) = read.expect("a valid description");
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    // A fixed seed: the same changes in every run.
    let effort = Effort { points: 2, exact_points: 0, seed: 7 };
    let prepared = prepare(manipulator, &generated.module, claims, effort).expect("a module that can be read");
    let (module, checker) = (&prepared.module, &prepared.checker);
    let nominal = constants::nominal_parameters(checker.manipulator(), checker.vector(), checker.claims(), module);
    let nominal = nominal.expect("nominal parameters");
    let (n, p) = (checker.manipulator().joints.len(), checker.parameters());

    // Other changes for each scalar.
    let mut stream = Stream::new(match scalar {
        Scalar::F64 => 2024,
        Scalar::F32 => 2025,
    });
    let states: Vec<Arguments<f64>> = (0..24).map(|_| arguments(&mut stream, n, p)).collect();
    let mutable = Mutable::new(&generated.module);
    let places = mutable.places();
    let mut found: BTreeMap<mutation::Kind, usize> = BTreeMap::new();
    let (mut counted, mut idle, mut tried) = (0, 0, 0);
    let (mut survivors, mut rounding) = (Vec::new(), 0);
    while counted < wanted && tried < 20 * wanted {
        tried += 1;
        // Every function is equally likely, and every place of it.
        let (item, count) = places[stream.below(places.len() as u64) as usize];
        let (place, choice) = (stream.below(count as u64) as usize, stream.bits());
        let Some((text, change)) = mutable.change(item, place, choice) else { continue };
        let changed = Module::read(&text).expect("a changed module still is one");
        let is_constant = module.constants.contains_key(&change.name);
        let verdict = if is_constant {
            if same_bits(&changed.constants[&change.name], &module.constants[&change.name]) {
                idle += 1;
                continue;
            }
            let reports = constants::check(checker, &changed, &nominal);
            reports.into_iter().find(|r| r.name == change.name).expect("a report on it").verdict
        } else {
            let of = |m: &Module| m.functions.iter().find(|(f, _)| *f == change.name).expect("it stands there").1.clone();
            let (before, after) = (of(module).expect("it was read"), of(&changed));
            let entries = match &after {
                Ok(after) => changed_entries(&before.program, &after.program, module.real, &states),
                Err(_) => vec![String::new()],
            };
            if entries.is_empty() {
                idle += 1;
                continue;
            }
            let verdict = checker.function(&change.name, &after, module.real).verdict;
            if let (Verdict::Equal, Ok(after)) = (&verdict, &after) {
                // The effect of the change cancels: the function is as correct as before.
                if different_entries(&before.program, &after.program, &states).is_empty() {
                    rounding += 1;
                    continue;
                }
            }
            if let (Verdict::Different { entry, .. }, Ok(after)) = (&verdict, &after) {
                // An entry may be wrong although its bits are the same.
                let mut entries = changed_entries(&before.program, &after.program, Float::F64, &states);
                entries.extend(different_entries(&before.program, &after.program, &states));
                // For `base_regressor`, a row is named if several of its entries may be the wrong ones.
                let named = |e: &String| e == entry || change.name == "base_regressor" && e.starts_with(entry.as_str());
                assert!(entries.iter().any(named), "{name}: {change:?}: {entry} is named, the changed ones are {entries:?}");
            }
            verdict
        };
        counted += 1;
        if verdict == Verdict::Equal {
            survivors.push(change);
        } else {
            *found.entry(change.kind).or_default() += 1;
        }
    }
    println!(
        "{name} {scalar:?}: {counted} changes, {found:?}, {idle} that change no bit, {rounding} that change rounding alone; {:?}",
        start.elapsed()
    );
    assert!(survivors.is_empty(), "{name}: not found: {survivors:#?}");
    assert_eq!(counted, wanted, "{name}: too few places to change");
    assert!(Promise::required(&[String::new()]).iter().all(|f| module.program(f).is_some()));
    found.into_keys().collect()
}

#[test]
#[ignore = "wide"]
fn some_changes_are_found() {
    // Of a small arm few operands can be swapped, so that a sample may lack a kind of change.
    let mut kinds = BTreeSet::new();
    for name in ["scara4", "scara", "modified_prismatic", "load_friction"] {
        kinds.extend(check(name, &Options::default(), 120));
    }
    kinds.extend(check("base_set", &Options { scalar: Scalar::F32, ..Options::default() }, 120));
    kinds.extend(check("scara4", &Options { fuse: true, ..Options::default() }, 120));
    assert_eq!(kinds.len(), 5, "every kind of change occurs");
}

/// A value that is not |g| of its joint is not one of the equations.
#[test]
#[ignore = "wide"]
fn the_size_of_another_value_is_found() {
    let source = common::source("load_friction");
    let generated = common::generate(&source, Scalar::F64);
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    let begins = "pub fn load_friction(";
    let at = generated.module.find(begins).expect("the function");
    let (before, function) = generated.module.split_at(at);
    for changed in
        ["sign(t2) * t3", "sign(t3) * t2", "t3", "sign(dq[3]) * t3", "sign(-t3) * t3", "sign(t3 + 0.5) * t3", "sign(t3)"]
    {
        let function = function.replacen("sign(t3) * t3", changed, 1);
        let report = verify_with(&source, format!("{before}{function}").as_str(), claims.clone(), Effort::default());
        let of_function = report.functions.iter().find(|report| report.name == "load_friction").expect("a report on it");
        match &of_function.verdict {
            Verdict::Different { entry, .. } => assert_eq!(entry, "[2]", "{changed}"),
            other => panic!("{changed}: {other:?}"),
        }
    }
}

#[test]
#[ignore = "wide"]
fn many_changes_are_found() {
    let count = std::env::var("ARMGEN_CHANGES").map_or(40, |text| text.parse().expect("a number"));
    let mut kinds = BTreeSet::new();
    for path in common::paths() {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        for scalar in [Scalar::F64, Scalar::F32] {
            kinds.extend(check(&name, &Options { scalar, ..Options::default() }, count));
        }
    }
    assert_eq!(kinds.len(), 5, "every kind of change occurs");
}
