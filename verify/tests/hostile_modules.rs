//! Whatever text is given for a module, the checker ends, on a small stack too, and says what is wrong.

use armgen_codegen::program::Options;
use armgen_codegen::source::Source;

const ROBOT: &str = include_str!("../../tests/robots/single_joint.yaml");

fn source() -> Source {
    Source::new("robot.yaml", ROBOT)
}

fn module() -> String {
    armgen_codegen::generate(&source(), &Options::default()).0.expect("a module").module
}

/// What is wrong first, of the module with a text for another in it; `None` if it is right.
#[track_caller]
fn fault(old: &str, new: &str) -> Option<String> {
    let module = module();
    assert!(module.contains(old), "{old} is not in the module");
    armgen_verify::verify(&source(), &module.replacen(old, new, 1), None).first_fault()
}

const GRAVITY: &str = "pub fn gravity(q: &[Real; DOF]) -> [Real; DOF] {";

/// With steps before those of the gravity torque.
#[track_caller]
fn with_steps(steps: &str) -> Option<String> {
    fault(GRAVITY, &format!("{GRAVITY} let s0 = q[0]; {steps}"))
}

/// With functions before it, the first of which it calls.
#[track_caller]
fn with_functions(functions: &str) -> Option<String> {
    fault(GRAVITY, &format!("{functions}\n{GRAVITY} let s = f0(q[0]);"))
}

#[track_caller]
fn check(fault: Option<String>, why: &str) {
    let fault = fault.unwrap_or_else(|| panic!("nothing is wrong, instead of: {why}"));
    assert!(fault.contains(why), "{fault}");
}

fn chain(count: usize, step: impl Fn(usize) -> String) -> String {
    (0..count).map(step).collect()
}

#[test]
fn deep_expressions_are_refused_and_others_read() {
    let literal = "= q[0];";
    let around = |open: &str, close: &str, count: usize| {
        with_steps(&format!("let _ {}", literal.replace("q[0]", &format!("{}q[0]{}", open.repeat(count), close.repeat(count)))))
    };
    for (open, close) in [("(", ")"), ("[", "]"), ("{", "}")] {
        check(around(open, close, 100_000), "nests too deeply");
    }
    check(around("-", "", 8000), "nests too deeply");
    check(around("", " + q[0]", 8000), "nests too deeply");
    check(around("if true {0.0} else ", "", 3000), "nests too deeply");
    check(with_steps(&format!("let _ = {}1.0;", "|a, b|".repeat(200_000))), "nests too deeply");
    check(with_steps(&format!("let _: {}Real;", "A<B, ".repeat(200_000))), "nests too deeply");
    check(with_steps(&format!("let _ = {}q;", "for P {} in ".repeat(200_000))), "nests too deeply");
    assert_eq!(around("(", ")", 50), None);
    assert_eq!(around("-", "", 3000), None);
    assert_eq!(around("", " + q[0]", 900), None);
}

#[test]
fn steps_that_grow_without_end_are_refused() {
    check(
        with_steps(&(chain(60, |i| format!("let s{} = s{i} + s{i};", i + 1)) + "let _ = sin_cos(s60);")),
        "sine of a sum of more than 256 terms",
    );
    check(with_steps(&chain(60, |i| format!("let s{} = (s{i}, s{i});", i + 1))), "lists in more than 8 others");
    check(with_steps(&chain(7, |i| format!("let s{} = [{}];", i + 1, format!("s{i},").repeat(100)))), "more work to read");
    // Right, but of numbers that no machine holds.
    let squares = chain(60, |i| format!("let s{} = s{i} * s{i};", i + 1));
    check(with_steps(&squares), "differs from the equations at rational point 1");
    // The degree doubles where no number grows.
    let powers = chain(70, |i| format!("let s{} = s{i} * s{i};", i + 1));
    let fault = fault(
        "pub fn kinetic_energy(q: &[Real; DOF], dq: &[Real; DOF]) -> Real {",
        &format!("pub fn kinetic_energy(q: &[Real; DOF], dq: &[Real; DOF]) -> Real {{ let s0 = 1.0 / q[0]; {powers}"),
    );
    assert!(fault.is_some_and(|fault| fault.starts_with("kinetic_energy")), "a degree that no odds follow from");
}

#[test]
fn calls_that_grow_without_end_are_refused() {
    let twice = chain(60, |i| format!("fn f{i}(x: Real) -> Real {{ let _ = f{0}(x); f{0}(x) }}\n", i + 1));
    check(with_functions(&(twice + "fn f60(x: Real) -> Real { x }")), "more work to read");
    let deep = chain(20_000, |i| format!("fn f{i}(x: Real) -> Real {{ f{}(x) }}\n", i + 1));
    check(with_functions(&(deep + "fn f20000(x: Real) -> Real { x }")), "nest too deeply");
    check(with_functions("fn f0(x: Real) -> Real { f0(x) }"), "`f0` calls itself");
}

#[test]
fn what_is_no_module_is_told_apart() {
    let of = |text: &str| armgen_verify::verify(&source(), text, None).first_fault().expect("a fault");
    assert!(of("").contains("no type `Real`"), "{}", of(""));
    assert!(of("pub fn f() {").contains("perhaps it is cut off"), "{}", of("pub fn f() {"));
    let batch = Options { batch: Some(8), ..Options::default() };
    let batch = armgen_codegen::generate(&source(), &batch).0.expect("a module").module;
    assert!(of(&batch).contains("is not an item of an emitted module for one state"), "{}", of(&batch));
    check(fault("pub const NOMINAL_PARAMETERS:", "pub const OTHER_PARAMETERS:"), "NOMINAL_PARAMETERS");
    check(fault("NAME: &str = \"", "NAME: &str = \"another_"), "NAME: the module is of the robot `another_");
}
