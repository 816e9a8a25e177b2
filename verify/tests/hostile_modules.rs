//! For any text as a module, the checker terminates, also on a small stack, and reports the fault and its place.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::emit::Language;
use armgen_codegen::pass::{Pass, Passes};
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::{matlab, Module, ModuleText, LONGEST};
use armgen_verify::verify_with;

const ROBOT: &str = include_str!("../../tests/robots/single_joint.yaml");

fn source() -> Source {
    Source::new("robot.yaml", ROBOT)
}

fn module() -> String {
    armgen_codegen::generate(&source(), &Options::default()).0.expect("a module").module
}

/// The first fault of the module after a replacement; `None` if it is correct.
#[track_caller]
fn fault(old: &str, new: &str) -> Option<String> {
    let module = module();
    assert!(module.contains(old), "{old} is not in the module");
    armgen_certify::verify(&source(), &module.replacen(old, new, 1), None).first_fault()
}

const GRAVITY: &str = "pub fn gravity(q: &[Real; DOF]) -> [Real; DOF] {";

/// The fault with these steps before those of the gravity torque.
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
    check(around("sign(", ")", 100_000), "brackets in more than 16 others");
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
    // It is readable, and costs more than the documentation states.
    check(around("", " + q[0]", 100_000), "gravity: the documentation says `Cost: none");
}

#[test]
fn steps_that_grow_without_end_are_refused() {
    // Correct, but with numbers that exceed any memory. No entry needs them, so they are neither evaluated nor a loss, only operations.
    let squares = chain(60, |i| format!("let t{} = t{i} * t{i};", i + 1));
    check(with_steps(&squares), "gravity: the documentation says `Cost: none");
    // The degree doubles without growing numbers.
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
    let of = |text: &str| armgen_certify::verify(&source(), text, None).first_fault().expect("a fault");
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

const LOADED: &str = include_str!("../../tests/robots/load_friction.yaml");

/// The same in other languages, with the notation for the sign of a rate in each.
#[test]
fn deep_signs_are_refused_in_every_language() {
    let generated = armgen_codegen::generate(&Source::new("robot.yaml", LOADED), &Options::default()).0.expect("a module");
    for (language, sign) in [
        (Language::C, "load_friction_sign("),
        (Language::JavaScript, "sign("),
        (Language::Python, "_sign(xp, "),
        (Language::Matlab, "signOf("),
    ] {
        let rate = format!("{sign}dq{}", if language == Language::Matlab { '(' } else { '[' });
        let text = generated.in_language(language);
        assert!(text.contains(&rate), "{language:?}");
        let deep = text.replacen(&rate, &format!("{}{rate}", sign.repeat(100_000)), 1);
        let fault = Module::read(ModuleText { language, text: &deep }).expect_err("too deep").to_string();
        check(Some(fault), "brackets are in more than 16 others");
    }
}

/// No empty line and no comment may interrupt a continued statement.
#[test]
fn statements_that_go_on_are_not_cut() {
    let generated = armgen_codegen::generate(&Source::new("robot.yaml", LOADED), &Options::default()).0.expect("a module");
    let mut cut = 0;
    for (language, end, comment) in [(Language::Matlab, "...\n", "% a\n"), (Language::C, "\\\n", "/* a */\n")] {
        let text = generated.in_language(language);
        for between in ["\n", comment] {
            for (at, _) in text.match_indices(end) {
                let mut text = text.clone();
                text.insert_str(at + end.len(), between);
                let fault = Module::read(ModuleText { language, text: &text }).expect_err("a cut").to_string();
                check(Some(fault), "which ends a statement");
                cut += 1;
            }
        }
    }
    assert!(cut > 2);
}

/// Files of a package that would become another number of files in a folder.
#[test]
fn files_of_a_package_stay_files() {
    let file = |name: &str, text: &str| (name.to_string(), text.to_string());
    let joined = |files: Vec<(String, String)>| matlab::joined(files).map_err(|(name, reason)| format!("{name} {reason}"));
    assert_eq!(joined(vec![file("b.m", "x\n"), file("a.m", "y\n")]), Ok("%%% a.m\ny\n%%% b.m\nx\n".into()));
    for (name, text, why) in [
        ("a.m", "y\n%%% b.m\nx\n", "a.m has a line that begins with `%%%`"),
        ("a.m", "%%% b.m\nx\n", "a.m has a line that begins with `%%%`"),
        ("a.m", "y", "a.m does not end with a line break"),
        ("a.m\n%%% b.m", "y\n", "has a line break in its name"),
    ] {
        let fault = joined(vec![file(name, text)]).expect_err(why);
        assert!(fault.contains(why), "{fault}");
    }
}

/// The description's name in the first line cannot end that line's comment.
#[test]
fn the_first_line_is_a_comment() {
    let generated = armgen_codegen::generate(&source(), &Options::default()).0.expect("a module");
    for language in Language::ALL {
        let text = generated.in_language(language);
        assert!(text.contains("from robot.yaml (input "), "{language:?}");
        for name in ["a */ #define else /*", "a /* b", "a\\", "a??/", "coding: latin-1", "a.yaml (input 0) b", "a\u{115f}"] {
            let text = text.replacen("from robot.yaml (input ", &format!("from {name} (input "), 1);
            let fault = armgen_certify::verify(&source(), ModuleText { language, text: &text }, None).first_fault();
            assert!(fault.is_some(), "{language:?}: {name}");
        }
    }
    // The head replaces characters of such file names.
    for name in ["a */ #define else /*.yaml", "a (input b.yaml", "r\u{e4}der (2).yaml", "a\u{115f}.yaml", "coding: x.yaml"] {
        let source = Source::new(name, ROBOT);
        let generated = armgen_codegen::generate(&source, &Options::default()).0.expect("a module");
        for language in Language::ALL {
            let text = generated.in_language(language);
            assert_eq!(armgen_certify::verify(&source, ModuleText { language, text: &text }, None).first_fault(), None, "{name}");
        }
    }
}

/// A module made without a pass is correct without its certificate, too: its constants are those of the generator without that pass.
#[test]
#[ignore = "wide"]
fn modules_made_without_a_pass_are_right() {
    let source = Source::new("robot.yaml", include_str!("../../tests/robots/dry_friction.yaml"));
    let mut others = 0;
    for pass in Pass::ALL {
        let mut without = Passes::default();
        without.insert(pass);
        let module = armgen_codegen::generate(&source, &Options { without, ..Options::default() }).0.expect("a module").module;
        others += usize::from(module != armgen_codegen::generate(&source, &Options::default()).0.expect("a module").module);
        assert_eq!(armgen_certify::verify(&source, &module, None).first_fault(), None, "without {pass:?}");
    }
    assert!(others > 5);
}

/// Lengths of a centimetre, and remainders of parallel axes after calibration: operands of quotients are larger than torques there.
#[test]
#[ignore = "wide"]
fn short_links_are_no_loss() {
    for (length, twist) in [("0.01", "0"), ("0.5", "0.001"), ("1e-5", "0.3")] {
        let joint = |name: &str| {
            format!(
                "  - {{name: {name}, type: revolute, a: {length}, alpha: {twist}, d: 0.1, theta: 0, link: {{mass: 3, com: [-0.2, 0.01, 0.02], \
                 inertia: {{xx: 0.1, yy: 0.2, zz: 0.2, xy: 0.01}}}}}}\n"
            )
        };
        let text = format!(
            "name: two\nconvention: standard\ngravity: [0, -9.81, 0]\njoints:\n{}{}regressor: standard\n",
            joint("a"),
            joint("b")
        );
        let source = Source::new("two.yaml", text);
        let module = armgen_codegen::generate(&source, &Options::default()).0.expect("a module").module;
        assert_eq!(armgen_certify::verify(&source, &module, None).first_fault(), None, "{length} {twist}");
    }
}

/// Unneeded steps have no exact evaluation, and long needed values stay within a cost limit.
#[test]
fn long_exact_values_are_bounded() {
    let squares = chain(14, |i| format!("let t{} = t{i} * t{i};", i + 1));
    let sums =
        |count: usize| (500..500 + count).map(|i| format!("let t{i} = t{} + t{};", i - 1, 110 + i % 4)).collect::<String>();
    let begin = "let t100 = q[0] * 0.1; ";
    let start = std::time::Instant::now();
    let unneeded = format!("{begin}{squares} let t499 = t114; {}", sums(20_000));
    check(fault(GRAVITY, &format!("{GRAVITY} {unneeded}")), "gravity: the documentation says `Cost: none");
    println!("{:?}", start.elapsed());
}

/// The reader skips a million comments in a time proportional to their length.
#[test]
fn comments_cost_as_much_as_they_are_long() {
    let generated = armgen_codegen::generate(&source(), &Options::default()).0.expect("a module");
    for (language, comment) in [
        (Language::C, "/* a */\n"),
        (Language::JavaScript, "/** a */\n"),
        (Language::Python, "# a\n\n"),
        (Language::Matlab, "% a\n\n"),
    ] {
        let text = generated.in_language(language) + &comment.repeat(1_000_000);
        let start = std::time::Instant::now();
        assert!(Module::read(ModuleText { language, text: &text }).is_ok(), "{language:?}");
        println!("{language:?}: {:?}", start.elapsed());
    }
}

/// Faults of a description that only equations reveal. The checker does not use the generator, so it sees such arms. It terminates, and accepts no
/// module that was made for a similar arm.
#[test]
fn arms_whose_equations_are_faulty_have_no_module() {
    let without_parameters = "regressor: [k, r, phi, m]";
    for (text, fault, valid) in [
        (include_str!("../../tests/bad/singular-inertia.yaml"), "link: {mass: 0}", "link: {mass: 1}"),
        (include_str!("../../tests/bad/nonlinear-parameter.yaml"), without_parameters, "regressor: [m]"),
        (include_str!("../../tests/bad/nonlinear-parameter-product.yaml"), "regressor:", "#"),
        (include_str!("../../tests/bad/nonlinear-parameter-length.yaml"), "regressor:", "#"),
        (include_str!("../../tests/bad/immovable-task.yaml"), "task: [z, rx]", "task: [x]"),
    ] {
        assert!(text.contains(fault), "{text}");
        let beside = Source::new("robot.yaml", text.replacen(fault, valid, 1));
        let (generated, diagnostics) = armgen_codegen::generate(&beside, &Options::default());
        let generated = generated.unwrap_or_else(|| panic!("{}", diagnostics.render(&beside, Colour::Never)));
        let faulty = Source::new("robot.yaml", text);
        assert!(armgen_codegen::generate(&faulty, &Options::default()).0.is_none(), "{text}");
        let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
        let report = verify_with(&faulty, &generated.module, claims, Effort::default());
        println!("{:?}", report.first_fault());
        assert!(!report.passed(), "{text}");
    }
}
