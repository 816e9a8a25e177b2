//! Whatever text is given for a module, the checker ends, on a small stack too, and says what is wrong and where.

use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::reader::{Module, LONGEST};

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
    fault(GRAVITY, &format!("{GRAVITY} let t100 = q[0]; {steps}"))
}

#[track_caller]
fn check(fault: Option<String>, why: &str) {
    let fault = fault.unwrap_or_else(|| panic!("nothing is wrong, instead of: {why}"));
    assert!(fault.contains(why), "{fault}");
}

fn chain(count: usize, step: impl Fn(usize) -> String) -> String {
    (100..100 + count).map(step).collect()
}

#[test]
fn deep_expressions_are_refused_and_long_ones_read() {
    let around = |open: &str, close: &str, count: usize| {
        with_steps(&format!("let t1 = {}q[0]{};", open.repeat(count), close.repeat(count)))
    };
    check(around("(", ")", 100_000), "brackets in more than 16 others");
    check(around("[", "]", 100_000), "`[` where a number, a name or a bracket can stand");
    check(around("{", "}", 100_000), "`{` where a number, a name or a bracket can stand");
    check(around("-", "", 8000), "`-` where a number, a name or a bracket can stand");
    check(around("if true {0.0} else ", "", 3000), "`if` is not a value that is given before");
    check(
        fault("    [0.0]", &format!("    {}0.0{}", "[".repeat(100_000), "]".repeat(100_000))),
        "brackets in more than 16 others",
    );
    check(with_steps(&format!("let t1 = {}1.0;", "|a, b|".repeat(200_000))), "`|` where a number");
    check(with_steps(&format!("let _: {}Real;", "A<B, ".repeat(200_000))), "`:` where an emitted module has `=`");
    check(fault(GRAVITY, &format!("fn sign() {}", "{".repeat(1_000_000))), "the text is cut off");
    assert_eq!(around("(", ")", 16), None);
    // It was read, and costs more than the documentation says.
    check(around("", " + q[0]", 100_000), "gravity: the documentation says `Cost: none");
}

#[test]
fn steps_that_grow_without_end_are_refused() {
    // Right, but of numbers that no machine holds.
    let squares = chain(60, |i| format!("let t{} = t{i} * t{i};", i + 1));
    check(
        with_steps(&squares),
        "has exact values of more than 2^20 bits, or 2^32 together, which no robot's has, at rational point 1",
    );
    // The degree doubles where no number grows.
    let powers = chain(70, |i| format!("let t{} = t{i} * t{i};", i + 1));
    let fault = fault(
        "pub fn kinetic_energy(q: &[Real; DOF], dq: &[Real; DOF]) -> Real {",
        &format!("pub fn kinetic_energy(q: &[Real; DOF], dq: &[Real; DOF]) -> Real {{ let t100 = 1.0 / q[0]; {powers}"),
    );
    assert!(fault.is_some_and(|fault| fault.starts_with("kinetic_energy")), "a degree that no odds follow from");
}

#[test]
fn texts_beyond_every_module_are_refused() {
    let of = |text: String| match Module::read(&text) {
        Err(fault) => fault.to_string(),
        Ok(module) => module.functions.iter().find_map(|(_, function)| function.clone().err()).expect("a fault"),
    };
    let steps = of(module().replacen(GRAVITY, &format!("{GRAVITY} let t1 = {}q[0];", "q[0]+".repeat(2_000_000)), 1));
    check(Some(steps), "functions of more than 4000000 steps");
    check(Some(of(" ".repeat(LONGEST + 1))), "the text is longer than 32 MiB");
    check(Some(of("// a\n".repeat(100_000))), "more than 64 lines of comments in front of all items");
    check(Some(of("/// a\n".repeat(100_000))), "documentation of more than 2048 lines");
    check(
        Some(of(module().replacen("[true]", &format!("[{}]", "true,".repeat(100_000)), 1))),
        "a constant of more than 1024 entries",
    );
    check(Some(of("const a1: u8 = 1;".repeat(1_000_000))), "line 1: `a1` is not a private item");
}

#[test]
fn what_is_no_module_is_told_apart() {
    let of = |text: &str| armgen_verify::verify(&source(), text, None).first_fault().expect("a fault");
    assert!(of("").contains("no type `Real`"), "{}", of(""));
    assert!(of("pub fn f() {").contains("line 1: `f` is not a function"), "{}", of("pub fn f() {"));
    let cut = module();
    assert!(of(&cut[..cut.len() - 3]).contains("the text is cut off"), "{}", of(&cut[..cut.len() - 3]));
    let batch = Options { batch: Some(8), ..Options::default() };
    let batch = armgen_codegen::generate(&source(), &batch).0.expect("a module").module;
    assert!(of(&batch).contains("begins no item of an emitted module for one state"), "{}", of(&batch));
    check(fault("pub const NOMINAL_PARAMETERS:", "pub const OTHER_PARAMETERS:"), "OTHER_PARAMETERS");
    check(fault("NAME: &str = \"", "NAME: &str = \"another_"), "NAME: the module is of the robot `another_");
}
