//! The emitted text: its cost, its contents, and that it depends on the description alone.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use armgen_codegen::catalogue;
use armgen_codegen::program::Cost;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_tests::count::{count, Operations};
use armgen_tests::emitted::{emitted, ALL};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::oracle::Description;
use armgen_tests::precision::{agree, ORACLE};
use armgen_tests::signatures::INTO;
use armgen_tests::{random, reference};
use quote::ToTokens;
use syn::visit::{self, Visit};

/// The generator's cost of a function equals the operations in the text.
#[test]
#[ignore = "wide"]
fn the_text_costs_what_the_program_says() {
    for robot in ALL.iter().filter(|robot| !robot.narrow) {
        let counted = count(robot.text);
        let program = Interpreted::new(&robot.description()).expect(robot.module);
        for function in &program.module.functions {
            let Cost { mul, add, fused: 0, div, neg, sincos, exp } = Cost::of(function) else {
                panic!("nothing is fused unasked")
            };
            let found = counted[&function.name()];
            // The sign of a product that starts with a number is printed as the number's own.
            assert!(found.neg <= neg, "{} {}: {} sign changes, not {neg}", robot.module, function.name(), found.neg);
            let said = Operations { mul, add, div, neg: found.neg, sincos, exp };
            assert_eq!(found, said, "{} {}", robot.module, function.name());
        }
    }
    // Single precision is another type, not another program.
    for robot in ALL.iter().filter(|robot| robot.narrow) {
        let wide = emitted(robot.module.strip_suffix("_f32").expect("its name ends so"));
        let difference: Vec<_> = count(robot.text).into_iter().zip(count(wide.text)).filter(|(a, b)| a != b).collect();
        assert!(difference.is_empty(), "{}: {difference:?}", robot.module);
    }
}

/// The SCARA's equations stay as short as by hand.
#[test]
fn the_scara_is_cheap() {
    let counted = count(emitted("scara").text);
    let sum = |name: &str| counted[name].mul + counted[name].add;
    assert!(sum("inertia_matrix") <= 4, "B: {:?}", counted["inertia_matrix"]);
    assert!(sum("coriolis_matrix") <= 5, "C: {:?}", counted["coriolis_matrix"]);
    assert_eq!(sum("gravity"), 0, "g: {:?}", counted["gravity"]);
    assert_eq!(counted["equations_of_motion"].sincos, 1);
    for (quantity, with) in catalogue::functions() {
        let name = quantity.function_name(with);
        let basic = quantity.interface.is_some_and(|name| ["Kinematics", "Dynamics", "Regressor"].contains(&name));
        // No basic function except forward dynamics may divide; the SCARA has no friction that grows with the load, which divides.
        let divides = counted.get(&name).is_some_and(|operations| operations.div > 0);
        assert!(!divides || !basic || name.starts_with("forward_dynamics"), "{name} divides and inverts no B");
    }
}

/// The load of `everything.yaml` gives the ten numbers of its parameters, and each parameter has its place.
#[test]
fn a_payload_has_the_parameters_of_its_description() {
    use armgen_tests::emitted::everything::{parameter_index, payload_parameters, NOMINAL_PARAMETERS, PARAMETER_NAMES};
    const FIRST: Option<usize> = parameter_index("mp");
    assert!(PARAMETER_NAMES.iter().enumerate().all(|(place, name)| parameter_index(name) == Some(place)));
    assert_eq!(["", "m", "m10", "mp "].map(parameter_index), [None; 4]);
    let inertia = [[0.01, 0.001, -0.002], [0.001, 0.012, 0.003], [-0.002, 0.003, 0.015]];
    let found = payload_parameters(2.5, &[0.04, 0.01, -0.02], &inertia);
    for (found, described) in found.iter().zip(&NOMINAL_PARAMETERS[FIRST.expect("there is a payload")..]) {
        assert!((found - described).abs() <= 4.0 * f64::EPSILON * described.abs(), "{found}, {described}");
    }
    // It has no meaning without a payload.
    assert!(emitted("everything_f32").text.contains("pub fn payload_parameters("));
    assert!(!emitted("scara").text.contains("payload_parameters"));
}

fn generate(name: &str, text: &str) -> String {
    let source = Source::new(name, text);
    let (generated, diagnostics) = armgen_codegen::generate(&source, &Options::default());
    let generated =
        generated.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, armgen_codegen::diagnostic::Colour::Never)));
    generated.module + &generated.runtime
}

/// Twenty processes in as many folders, with another environment each, and the build script long before: the same bytes.
#[test]
#[ignore = "wide"]
fn generations_are_the_same_to_the_byte() {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("generations");
    for (module, times) in [("scara", 20), ("everything", 6), ("base_set", 4), ("panda7", 1)] {
        let robot = emitted(module);
        let expected = format!("{}{}", robot.text, robot.runtime_text);
        for run in 0..times {
            let folder = root.join(format!("{run}")).join(["a", "of robots", "übrig", "x/y/z"][run % 4]);
            std::fs::create_dir_all(&folder).expect("a folder");
            let file = format!("{module}.yaml");
            std::fs::write(folder.join(&file), robot.description()).expect("a file");
            let path = match run % 3 {
                0 => file,
                1 => format!("./{file}"),
                _ => folder.join(&file).display().to_string(),
            };
            let mut command = Command::new(env!("CARGO_BIN_EXE_generate"));
            command.arg(path).current_dir(&folder);
            if run % 2 == 1 {
                command.env_clear();
            }
            let variables = [
                ("HOME", format!("/home/user{run}")),
                ("LANG", ["C", "de_DE.UTF-8", "tr_TR.UTF-8", "ja_JP"][run % 4].to_owned()),
                ("LC_ALL", ["C", "de_DE.UTF-8"][run % 2].to_owned()),
                ("TZ", format!("UTC+{}", run % 12)),
                ("SOURCE_DATE_EPOCH", format!("{}", 1_000_000 * run)),
                ("CARGO_PKG_VERSION", format!("9.{run}.0")),
                ("CARGO_MANIFEST_DIR", "/elsewhere".to_owned()),
                ("OUT_DIR", format!("/out{run}")),
                ("COLUMNS", format!("{}", 20 + run)),
                ("RUST_BACKTRACE", format!("{}", run % 2)),
            ];
            let output = command.envs(variables).output().expect("the program starts");
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            assert!(output.stdout == expected.as_bytes(), "{module}, run {run}: other bytes");
        }
    }
}

/// Threads have hash seeds of their own, and a description's folder is no part of its name.
#[test]
fn generations_in_threads_are_the_same_to_the_byte() {
    let robot = emitted("modified_prismatic");
    let (text, expected) = (robot.description(), format!("{}{}", robot.text, robot.runtime_text));
    std::thread::scope(|scope| {
        for folder in ["", "/a/b/", "../../", "C:\\robots\\", "./"] {
            let (text, expected) = (&text, &expected);
            scope.spawn(move || assert!(generate(&format!("{folder}modified_prismatic.yaml"), text) == *expected, "{folder}"));
        }
    });
}

/// The text without the line that holds the hash of the description.
fn without_header(text: &str) -> String {
    let (lines, header): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| !line.starts_with("// @generated"));
    assert_eq!(header.len(), 2, "one header for the module, one for the trait implementation");
    lines.join("\n")
}

#[test]
#[ignore = "wide"]
fn an_angle_may_be_spelled_in_any_way() {
    let mut spellings = 0;
    for module in ["puma560", "base_set", "modified_prismatic"] {
        let text = emitted(module).description();
        let expected = without_header(&generate("robot.yaml", &text));
        for (from, to) in [
            ("pi/2", "deg(90)"),
            ("pi/2", "(90*pi/180)"),
            ("pi/2", "(pi - pi/2)"),
            ("pi/2", "(5*pi/2 - 2*pi)"),
            ("pi/3", "deg(60)"),
            ("pi/4", "(45*pi/180)"),
            ("deg(75)", "5*pi/12"),
            (": 0.4\n", ": 2/5\n"),
            (": 0\n", ": 0.0e3 - 0\n"),
        ] {
            let spelled = text.replace(from, to);
            if spelled != text {
                spellings += 1;
                let found = without_header(&generate("robot.yaml", &spelled));
                assert!(found == expected, "{module}: `{from}` and `{to}` differ");
            }
        }
    }
    assert!(spellings >= 15, "{spellings} spellings");
}

/// Every float of a text with its value.
#[derive(Default)]
struct Floats(Vec<(String, f64)>);

impl Visit<'_> for Floats {
    fn visit_lit(&mut self, literal: &syn::Lit) {
        if let syn::Lit::Float(float) = literal {
            self.0.push((float.to_string(), float.base10_parse().expect("a float")));
        }
        visit::visit_lit(self, literal);
    }
}

/// The rounding of an inexact step would show: as 6e-17 where 0 is meant, as 0.49999999999999994 where 0.5 is.
fn spurious(x: f64) -> Option<String> {
    let roots = [1.0, 2.0f64.sqrt(), 3.0f64.sqrt(), 6.0f64.sqrt()];
    let fractions = (1..=12).flat_map(|n| (1..=12).map(move |d| f64::from(n) / f64::from(d)));
    let mut simple: Vec<f64> = fractions.flat_map(|f| roots.map(|r| f * r)).collect();
    // The nearest decimal of five digits: a constant this close to it is meant to be it.
    simple.push(format!("{x:.4e}").parse().expect("a float"));
    let near = simple.into_iter().find(|s| (x - s).abs() <= 1e-12 * s && (x - s).abs() > 2.0 * f64::EPSILON * s);
    match near {
        Some(simple) => Some(format!("nearly {simple}")),
        None if x != 0.0 && x < 1e-9 => Some("nearly 0".to_owned()),
        None => None,
    }
}

#[test]
fn no_constant_is_spurious() {
    for x in [6e-17, 0.49999999999999, 1.00000000000002, 0.70710678118659] {
        assert!(spurious(x).is_some(), "{x}");
    }
    for x in [0.0, 0.5, 1.0, 2.0, 0.1, 0.5f64.sqrt(), 9.81, 1e-5] {
        assert_eq!(spurious(x), None, "{x}");
    }
    for robot in ALL.iter().filter(|robot| !robot.narrow) {
        let mut floats = Floats::default();
        let mut file = syn::parse_file(robot.text).expect("Rust");
        // The constants of private functions come from their source.
        file.items.retain(|item| !matches!(item, syn::Item::Fn(function) if function.sig.ident == "stribeck"));
        floats.visit_file(&file);
        assert!(floats.0.len() > 20, "{}", robot.module);
        for (text, x) in floats.0 {
            assert!(spurious(x).is_none(), "{}: {text} is {}", robot.module, spurious(x).unwrap_or_default());
            // The shortest decimal that reads back as the same float.
            assert_eq!(format!("{x:?}"), text, "{}", robot.module);
        }
    }
}

/// The bodies of the functions and the values of the constants of a module, by name.
fn items(text: &str) -> BTreeMap<String, String> {
    let file = syn::parse_file(text).expect("Rust");
    let plain = |tokens: &str| tokens.split_whitespace().collect::<String>();
    file.items
        .iter()
        .filter_map(|item| match item {
            syn::Item::Fn(f) => Some((f.sig.ident.to_string(), f.block.to_token_stream().to_string())),
            syn::Item::Const(c) => Some((c.ident.to_string(), c.expr.to_token_stream().to_string())),
            _ => None,
        })
        .map(|(name, tokens)| (name, plain(&tokens)))
        .collect()
}

/// One edit of one number in the description, and all that is built on it follows; nothing else moves.
#[test]
fn an_edit_of_a_mass_reaches_all_that_is_built_on_it() {
    let text = reference::description("scara");
    let edited = text.replace("m_l3: 10 ", "m_l3: 15 ");
    assert_ne!(text, edited);
    let (before, after) = (items(&generate("robot.yaml", &text)), items(&generate("robot.yaml", &edited)));
    let changed: BTreeSet<&str> =
        // What another function writes the result of has that one's body.
        before.iter().filter(|(name, body)| after[*name] != **body).map(|(name, _)| name.trim_end_matches(INTO)).collect();
    let s = random::state(4, 15);
    let a = Arguments { q: s.q.clone(), dq: s.dq.clone(), ddq: s.ddq.clone(), ..Arguments::default() };
    // Expected changes: functions whose value changes by the oracle, functions without a formula in the oracle, and parameter values.
    let models = [&text, &edited].map(|text| Description::read(text).and_then(|d| d.model()).expect("valid"));
    let depends = |name: &&str| models[0].value(name, &a) != models[1].value(name, &a);
    let mut expected: BTreeSet<&str> = catalogue::quantities().map(|quantity| quantity.name).filter(depends).collect();
    expected.extend(["forward_dynamics", "forward_dynamics_derivatives", "operational_inertia"]);
    expected.extend(["NOMINAL_PARAMETERS", "NOMINAL_BASE_PARAMETERS"]);
    assert_eq!(changed, expected);

    let robot = Interpreted::new(&edited).expect("valid");
    let model = &models[1];
    let check = |function: &str, expected: &[f64]| agree(function, &robot.call(function, &a), expected, ORACLE);
    check("inertia_matrix", &model.inertia_matrix(&s.q).concat());
    check("coriolis_matrix", &model.coriolis_matrix(&s.q, &s.dq).concat());
    check("gravity", &model.gravity(&s.q));
    check("inverse_dynamics", &model.inverse_dynamics(&s.q, &s.dq, &s.ddq));
}

/// Limits of acceleration and jerk, infinite where a joint has none.
#[test]
fn limits_of_planned_motions_are_constants() {
    let text = emitted("everything").text;
    for (constant, size) in [("ACCELERATION_LIMITS", "12.5"), ("JERK_LIMITS", "250.0")] {
        let begin = format!("pub const {constant}: [Real; DOF] = [");
        let (_, rest) = text.split_once(&begin).expect(constant);
        let (entries, _) = rest.split_once("];").expect(constant);
        let given: Vec<&str> =
            entries.split(',').map(str::trim).filter(|entry| !["", "Real::INFINITY"].contains(entry)).collect();
        assert_eq!(given, [size], "{constant}: {entries}");
    }
}
