//! Modules in other languages: verified after reading, refused after a change, and run next to the Rust module with the same bits.
//!
//! A line reports each missing compiler or interpreter with its Debian package, and tests that need it are skipped. This command runs all robots
//! at 10000 states with all compilers:
//! `cargo test --release -p armgen-verify --test all -- --ignored --nocapture all_robots_have_the_bits_of_rust`.

use crate::common;
#[path = "languages/arrays.rs"]
mod arrays;
#[path = "../../tests/src/installed.rs"]
mod installed;
#[path = "languages/mutation.rs"]
mod mutation;
#[path = "languages/page.rs"]
mod page;
#[path = "languages/programs.rs"]
mod programs;
#[path = "languages/run.rs"]
mod run;
#[path = "languages/tools.rs"]
mod tools;

use std::collections::BTreeMap;

use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::Generated;
use armgen_verify::read::reader::{Module, ModuleText};

fn generated(source: &Source, scalar: Scalar, trig: Trig) -> Generated {
    #[allow(clippy::needless_update)]
    common::generate_with(source, &Options { scalar, trig, ..Options::default() })
}

fn others() -> impl Iterator<Item = Language> {
    Language::ALL.into_iter().filter(|language| *language != Language::Rust)
}

/// Reading a module in another language gives the same result as reading the Rust module, including rounding.
#[track_caller]
fn check_read(name: &str, scalar: Scalar) {
    let source = common::source(name);
    for trig in [Trig::Fast, Trig::Std] {
        check_same(name, &generated(&source, scalar, trig), scalar);
    }
}

#[track_caller]
fn check_same(name: &str, generated: &Generated, scalar: Scalar) {
    check_same_in(others(), name, generated, scalar);
}

#[track_caller]
fn check_same_in(languages: impl Iterator<Item = Language>, name: &str, generated: &Generated, scalar: Scalar) {
    let rust = Module::read(&generated.module).expect("the module in Rust");
    for language in languages.filter(|language| language.scalars().contains(&scalar)) {
        let text = generated.in_language(language);
        let read = Module::read(ModuleText { language, text: &text });
        let read = read.unwrap_or_else(|fault| panic!("{name} in {}: {fault}", language.title()));
        assert_eq!((read.real, read.trig, &read.constants), (rust.real, rust.trig, &rust.constants), "{name} {language:?}");
        assert_eq!(read.functions.len(), rust.functions.len(), "{name} {language:?}");
        for ((own, function), (other, of_rust)) in read.functions.iter().zip(&rust.functions) {
            let (function, of_rust) = (function.as_ref().expect("read"), of_rust.as_ref().expect("read"));
            assert_eq!(own, other);
            assert!(
                mutation::same_operations(&function.program, &of_rust.program),
                "{name} {language:?}: {own} does other operations than in Rust"
            );
        }
    }
}

#[test]
#[ignore = "wide"]
fn other_languages_do_the_operations_of_rust_in_its_order() {
    for name in ["scara", "scara4", "modified_prismatic", "single_joint", "dry_friction", "load_friction"] {
        check_read(name, Scalar::F64);
    }
    check_read("base_set", Scalar::F32);
}

/// The kernels of CUDA follow from the functions, so each change of theirs is refused, and so is a header without them.
#[test]
#[ignore = "wide"]
fn changed_kernels_are_refused() {
    let generated = generated(&common::source("scara4"), Scalar::F64, Trig::Fast);
    let read = |language, text: &str| Module::read(ModuleText { language, text }).map(|module| module.functions.len());
    let text = generated.in_language(Language::Cuda);
    let functions = read(Language::C, &generated.in_language(Language::C)).expect("the header");
    assert_eq!(read(Language::Cuda, &text).expect("header and kernels"), functions);
    assert_eq!(text.matches("_status scara4_launch_").count(), functions);
    for (from, to) in [
        ("scara4_take(SCARA4_DOF, state, leading, dq, one_dq)", "scara4_take(SCARA4_DOF, state, leading, q, one_dq)"),
        ("scara4_gravity(one_q, one_result)", "scara4_viscous_friction(one_q, one_result)"),
        ("one_result[0] = scara4_kinetic_energy(", "one_result[0] = -scara4_kinetic_energy("),
        ("scara4_give(16, state", "scara4_give(15, state"),
        ("to[i] = from[first + (size_t)i * step]", "to[i] = from[first + (size_t)i]"),
        ("state < states;", "state <= states;"),
        ("threads, 0, stream>>>(states, leading, q, result)", "threads, 0, stream>>>(states, states, q, result)"),
    ] {
        assert!(text.contains(from), "{from}");
        assert!(read(Language::Cuda, &text.replacen(from, to, 1)).is_err(), "{to}");
    }
    let at = text.find("template <int threads>").expect("a kernel");
    let next = at + 1 + text[at + 1..].find("template <int threads>").expect("another");
    assert!(read(Language::Cuda, &(text[..at].to_owned() + &text[next..])).is_err(), "a kernel is missing");
    assert!(read(Language::Cuda, &generated.in_language(Language::C)).is_err());
    assert!(read(Language::C, &text).is_err());
}

fn fused(name: &str, scalar: Scalar) -> Generated {
    common::generate_with(&common::source(name), &Options { scalar, trig: Trig::Fast, fuse: true, ..Options::default() })
}

/// C has the fused operations of Rust; the other languages print the same module as without fusion.
#[test]
#[ignore = "wide"]
fn fused_operations_are_those_of_rust() {
    for scalar in [Scalar::F64, Scalar::F32] {
        let fused = fused("scara4", scalar);
        check_same_in([Language::C].into_iter(), "scara4", &fused, scalar);
        let report = armgen_certify::certify_in(&common::source("scara4"), &fused, Language::C);
        assert_eq!(report.first_fault(), None);
        let plain = generated(&common::source("scara4"), scalar, Trig::Fast);
        for language in others().filter(|language| !language.is_c() && language.scalars().contains(&scalar)) {
            assert_eq!(fused.in_language(language), plain.in_language(language));
        }
        assert_eq!([fused.native().c, fused.native().python], [plain.native().c, plain.native().python]);
    }
}

/// A chain of this number of revolute joints.
fn chain(joints: usize) -> Source {
    let joint = |i: usize| {
        let alpha = ["pi/2", "-pi/2"][i % 2];
        format!(
            "  - {{name: j{i}, type: revolute, a: 0.{}, alpha: {alpha}, d: 0.{}, theta: 0, link: {{mass: {}, com: [0.1, 0.02, 0.03], \
             inertia: {{xx: 0.3, yy: 0.35, zz: 0.32, xy: 0.01, xz: 0.02, yz: 0.03}}}}}}\n",
            i + 11,
            i + 21,
            i + 2
        )
    };
    let joints: String = (1..=joints).map(joint).collect();
    let text = format!("name: chain\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n{joints}regressor: standard\n");
    Source::new("chain.yaml", text)
}

fn some(functions: &[&str]) -> Options {
    let names: Vec<String> = functions.iter().map(ToString::to_string).collect();
    let functions = Selection::named(&names).expect("functions of the catalogue");
    Options { trig: Trig::Fast, functions, ..Options::default() }
}

/// A function of thousands of lines is printed in parts, in every language.
#[test]
#[ignore = "wide"]
fn parts_of_long_functions_are_put_together() {
    let generated = common::generate_with(&chain(24), &some(&["inverse_dynamics_derivatives"]));
    check_same("chain", &generated, Scalar::F64);
}

#[test]
fn a_module_in_another_language_is_certified() {
    let source = common::source("scara4");
    for generated in [generated(&source, Scalar::F64, Trig::Fast), common::generate(&source, Scalar::F64)] {
        for language in others() {
            let report = armgen_certify::certify_in(&source, &generated, language);
            assert_eq!(report.first_fault(), None, "{language:?}");
        }
    }
}

#[test]
#[ignore = "wide"]
fn changes_are_found_in_every_language() {
    for language in others() {
        mutation::check("scara", language, false, 200);
    }
    mutation::check("scara", Language::C, true, 200);
}

/// Facts in comments are checked in every language, other words are not; a Python comment is refused where it would be a value.
/// A fact of each kind.
#[test]
fn facts_in_comments_are_judged() {
    judge_comments(1);
}

/// All of them.
#[test]
#[ignore = "wide"]
fn all_facts_in_comments_are_judged() {
    judge_comments(usize::MAX);
}

/// Changes at most `of_each` facts of each kind in each language.
fn judge_comments(of_each: usize) {
    let source = common::source("single_joint");
    let mut generated = generated(&source, Scalar::F64, Trig::Fast);
    armgen_certify::document_bounds(&source, &mut generated).expect("bounds");
    for language in others() {
        let text = generated.in_language(language);
        let verdict = |text: &str| armgen_certify::verify(&source, ModuleText { language, text }, None).first_fault();
        assert_eq!(verdict(&text), None, "{language:?}");
        let lines: Vec<&str> = text.lines().collect();
        let with = |at: usize, line: &str| [&lines[..at], &[line], &lines[at + 1..]].concat().join("\n") + "\n";
        let mut changed = BTreeMap::from([("bound", 0), ("cost", 0), ("input", 0), ("box", 0), ("words", 0)]);
        for (at, line) in lines.iter().enumerate() {
            let cost = line.split_once("Cost: ").filter(|(_, cost)| cost.starts_with(|c: char| c.is_ascii_digit()));
            let (kind, new) = if let Some((before, digits)) = line.split_once("Rounding error: at most ") {
                ("bound", format!("{before}Rounding error: at most 1{digits}"))
            } else if let Some((before, digits)) = cost {
                ("cost", format!("{before}Cost: 1{digits}"))
            } else if at == 0 && line.contains("@generated") {
                ("input", line.replacen("(input ", "(input 0", 1))
            } else if line.contains("Box of the rounding errors") {
                ("box", line.replacen("pi rad", "9 rad", 1))
            } else if line.contains("joint variables, rad") {
                ("words", line.replacen("joint variables, rad", "angles of joints", 1))
            } else {
                continue;
            };
            let so_far = changed.get_mut(kind).expect("a kind");
            *so_far += 1;
            if *so_far <= of_each {
                assert_eq!(verdict(&with(at, &new)).is_none(), kind == "words", "{language:?}: {new}");
            }
        }
        // A package of MATLAB begins with another line.
        let is_there = |kind: &str, count: usize| count > 0 || (kind, language) == ("input", Language::Matlab);
        assert!(changed.iter().all(|(kind, count)| is_there(kind, *count)), "{language:?}: {changed:?}");
    }
    let text = generated.in_language(Language::Python);
    let at = text.find("    \"").expect("a text in a list");
    let value = format!("{}    \"\"\"x\"\"\"\n{}", &text[..at], &text[at..]);
    let module = ModuleText { language: Language::Python, text: &value };
    let fault = armgen_certify::verify(&source, module, None).first_fault();
    assert!(fault.as_ref().is_some_and(|fault| fault.contains("a text that is no comment")), "{fault:?}");
}

#[test]
#[ignore = "wide"]
fn all_languages_have_the_bits_of_rust() {
    for name in ["scara", "modified_prismatic", "dry_friction", "load_friction"] {
        run::check(name, Scalar::F64, 500, run::Effort::Short);
    }
    for name in ["scara4", "dry_friction", "load_friction"] {
        run::check(name, Scalar::F32, 500, run::Effort::Short);
    }
}

#[test]
#[ignore = "wide"]
fn fused_operations_have_the_bits_of_rust() {
    for (name, scalar) in [("scara4", Scalar::F64), ("load_friction", Scalar::F64), ("scara4", Scalar::F32)] {
        let options = Options { scalar, trig: Trig::Fast, fuse: true, ..Options::default() };
        run::check_with(&format!("fused_{name}"), &common::source(name), &options, 500, run::Effort::Short);
    }
}

#[test]
#[ignore = "wide"]
fn callers_of_the_page_print_what_it_says() {
    page::check_page();
}

#[test]
#[ignore = "wide"]
fn a_package_is_called_as_its_help_says() {
    page::check_package();
}

#[test]
#[ignore = "wide"]
fn arrays_need_the_array_api_and_no_more() {
    arrays::check_array_api();
}

#[test]
#[ignore = "wide"]
fn entries_of_another_type_are_told_what_is_taken() {
    arrays::check_other_types();
}

#[test]
#[ignore = "wide"]
fn torch_has_the_bits_of_numpy_and_its_derivatives() {
    arrays::check_torch();
}

#[test]
#[ignore = "wide"]
fn torch_compiles_functions_whole() {
    arrays::check_torch_compile();
}

#[test]
#[ignore = "wide"]
fn jax_compiles_and_differentiates_functions() {
    arrays::check_jax_jit();
}

#[test]
#[ignore = "wide"]
fn functions_by_joint_have_the_bits_of_numpy() {
    arrays::check_by_joint();
}

#[test]
#[ignore = "wide"]
fn the_test_file_of_each_language_passes_and_finds_a_planted_error() {
    for language in others() {
        page::check_tests("scara", Scalar::F64, language);
    }
    page::check_tests("scara4", Scalar::F32, Language::C);
    page::check_tests("base_set", Scalar::F64, Language::C);
    page::check_tests("scara4", Scalar::F32, Language::Python);
}

#[test]
#[ignore = "wide"]
fn declarations_are_those_that_tsc_takes() {
    page::check_declarations();
}

#[test]
#[ignore = "wide"]
fn fast_math_is_refused() {
    page::check_fast_math();
}

#[test]
#[ignore = "full: many minutes: all robots, 10000 states each, with all compilers and their flags"]
fn all_robots_have_the_bits_of_rust() {
    for path in common::paths() {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        for scalar in [Scalar::F64, Scalar::F32] {
            run::check(&name, scalar, 10_000, run::Effort::Full);
        }
    }
}

#[test]
#[ignore = "full: minutes: functions of thousands of lines in all languages"]
fn one_joint_and_thirty_two_have_the_bits_of_rust() {
    #[allow(clippy::needless_update)]
    let all = Options { trig: Trig::Fast, ..Options::default() };
    run::check_with("chain_1", &chain(1), &all, 10_000, run::Effort::Short);
    let functions = ["link_frames", "gravity", "inertia_matrix", "inverse_dynamics", "forward_dynamics"];
    run::check_with("chain_32", &chain(32), &some(&functions), 1_000, run::Effort::Short);
}

#[test]
#[ignore = "wide"]
fn functions_with_gravity_as_an_argument_have_the_bits_of_rust() {
    let source = Source::new("mounted.yaml", include_str!("../../tests/data/mounted.yaml"));
    for scalar in [Scalar::F64, Scalar::F32] {
        #[allow(clippy::needless_update)]
        let options = Options { scalar, trig: Trig::Fast, ..Options::default() };
        run::check_with("mounted", &source, &options, 200, run::Effort::Short);
    }
}

#[test]
#[ignore = "wide"]
fn functions_of_several_end_effectors_have_the_bits_of_rust() {
    let tips = "tips:\n  - {name: left_hand, joint: left_3, tool: {xyz: [0, 0, -0.25]}, task: [x, y, z]}\n  \
                - {name: Camera, joint: torso, tool: {rpy: [0, 0.3, 0]}, task: [rz]}\n  \
                - {name: right_hand, joint: right_3, payload: {mass: 2, com: [0, 0, -0.1]}}\n";
    let robot = include_str!("../../tests/data/trees/two_arms.yaml");
    let lines = robot.lines().filter(|line| !line.starts_with("tool:"));
    let text = lines.map(|line| format!("{line}\n")).collect::<String>() + tips;
    let source = Source::new("two_arms.yaml", text);
    for scalar in [Scalar::F64, Scalar::F32] {
        #[allow(clippy::needless_update)]
        let options = Options { scalar, trig: Trig::Fast, ..Options::default() };
        run::check_with("two_arms", &source, &options, 100, run::Effort::Short);
    }
}

/// Joints that follow others by no whole numbers: the argument of a sine is a sum that the function computes. Beyond the range of the module's own
/// sines, which a large factor leaves sooner, each language has those of its library.
#[test]
#[ignore = "wide"]
fn computed_angles_have_the_bits_of_rust() {
    let robots = [
        ("screw", include_str!("../../tests/data/trees/screw.yaml")),
        ("finger", include_str!("../../tests/data/trees/finger.yaml")),
    ];
    for (name, text) in robots {
        let source = Source::new("robot.yaml", text);
        for scalar in [Scalar::F64, Scalar::F32] {
            for trig in [Trig::Fast, Trig::Std] {
                #[allow(clippy::needless_update)]
                let options = Options { scalar, trig, ..Options::default() };
                check_same(name, &common::generate_with(&source, &options), scalar);
            }
            #[allow(clippy::needless_update)]
            let options = Options { scalar, trig: Trig::Fast, ..Options::default() };
            run::check_with(name, &source, &options, 200, run::Effort::Short);
        }
    }
}
