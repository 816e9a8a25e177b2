//! Modules that somebody would write who wants a wrong one verified, or one that runs code: each is refused, and for the reason that it was
//! written against. What an emitted module may hold stands in docs/certificate.md.

use crate::common;

use std::collections::BTreeMap;

use armgen_certify::{certify, document_bounds, verify};
use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::certificate::Certificate;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::{Module, ModuleText};
use armgen_verify::verify_with;

struct Given {
    source: Source,
    module: String,
    claims: Claims,
    certificate: Certificate,
}

impl Given {
    fn new(name: &str, trig: Trig) -> Given {
        Given::of(common::source(name), trig)
    }

    fn of(source: Source, trig: Trig) -> Given {
        let mut generated = match trig {
            Trig::Libm => common::generate(&source, Scalar::F64),
            trig => common::generate_with(&source, &Options { trig, ..Options::default() }),
        };
        document_bounds(&source, &mut generated).expect("bounds");
        let report = certify(&source, &generated);
        assert!(report.passed(), "{report}");
        let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
        Given { source, module: generated.module, claims, certificate: Certificate::of(&report) }
    }

    /// A module with one place changed is refused, for this reason.
    #[track_caller]
    fn refused(&self, old: &str, new: &str, why: &str) {
        assert!(self.module.contains(old), "`{old}` is not in the module");
        self.refused_text(&self.module.replacen(old, new, 1), why);
    }

    #[track_caller]
    fn refused_text(&self, text: &str, why: &str) {
        assert_ne!(text, self.module);
        let report = verify_with(&self.source, text, self.claims.clone(), Effort::default());
        let Some(fault) = report.first_fault() else { panic!("accepted, instead of: {why}") };
        assert!(fault.contains(why), "{fault}, instead of: {why}");
    }
}

fn scara() -> Given {
    Given::new("scara", Trig::Libm)
}

/// Where steps stand that can be changed: the inertia matrix.
const T1: &str = "    let t1 = 5.0 * c2 + 8.766;\n";
const RUNS: &str =
    "#[used] #[link_section=\".init_array\"] static I: extern \"C\" fn() = r; extern \"C\" fn r(){ std::println!(\"x\"); }";
const NO_ITEM: &str = "begins no item of an emitted module";

#[test]
fn text_that_nothing_needs_is_refused() {
    let given = scara();
    let module = &given.module;
    let appended = |text: &str, why: &str| given.refused_text(&format!("{module}\n{text}\n"), why);
    appended(&format!("fn table() -> Real {{ {RUNS} 0.0 }}"), "`table` is not a private item");
    appended("fn unused() -> Real { mod a { #[path = \"b.rs\"] mod b; } 0.0 }", "`unused` is not a private item");
    appended("fn sign(x: Real) -> Real {\n    if x > 0.0 { 1.0 } else if x < 0.0 { -1.0 } else { x }\n}", "`fn` where");
    appended("use core::f64;", NO_ITEM);
    appended("mod a {}", NO_ITEM);
    appended("pub mod a {}", NO_ITEM);
    appended("macro_rules! sin_cos { () => {} }", NO_ITEM);
    appended("std::thread_local! { static A: u8 = 0; }", NO_ITEM);
    appended("static A: u8 = 0;", NO_ITEM);
    appended("extern crate std;", NO_ITEM);
    appended("extern \"C\" { fn r(); }", NO_ITEM);
    appended("impl Drop for EquationsOfMotion { fn drop(&mut self) { panic!() } }", NO_ITEM);
    appended("unsafe impl Send for EquationsOfMotion {}", NO_ITEM);
    appended("trait Neg {}", NO_ITEM);
    appended("enum Name { A }", NO_ITEM);
    appended("union Name { a: u8 }", NO_ITEM);
    appended("type F = f64;", NO_ITEM);
    appended(";", NO_ITEM);
    appended("#[allow(dead_code)]\npub type Other = f64;", "`Other` where an emitted module has `Real`");
    appended("#[allow(dead_code)]\npub type Real = f64;", "`Real` stands twice");
    appended("pub struct Other { }", "`pub` where an emitted module has `#`");
    appended("pub const OTHER: usize = 4;", "`OTHER` is not a constant that an emitted module has");
    appended("const OTHER: usize = 4;", "`OTHER` is not a private item");
    appended("#[allow(dead_code)]\npub const DOF: usize = 4;", "constant `DOF` stands twice");
    appended("pub fn other(q: &[Real; DOF]) -> Real { q[0] }", "`other` is not a function that an emitted module has");
    appended(
        "/// Part 1 of `gravity`.\n#[allow(dead_code, clippy::all)]\n#[inline(never)]\nfn gravity_part_1(values: [Real; 0]) -> [Real; 0] { let [] = values; [] }",
        "`gravity_part_1` is needed by no function",
    );
    let gravity = &module[module.find("#[allow(dead_code, clippy::all)]\npub fn gravity(").expect("it is there")..];
    appended(&gravity[..gravity.find("\n}").expect("an end") + 2], "function `gravity` stands twice");
}

#[test]
fn what_is_not_written_as_armgen_writes_it_is_refused() {
    let given = scara();
    let refused = |old: &str, new: &str, why: &str| given.refused(old, new, why);
    // Attributes: what runs, hides, includes, derives or links.
    let has = "where an emitted module has";
    refused("/// Name of the robot.", "#[doc = include_str!(\"Cargo.toml\")]\n/// Name of the robot.", NO_ITEM);
    refused("/// Name of the robot.\n", "#[doc = \"Name of the robot.\"]\n", "`doc` where an emitted module has `allow`");
    refused("#[derive(Clone, Copy, Debug, PartialEq)]", "#[derive(Clone, Copy, Debug, PartialEq, evil::Evil)]", has);
    refused("#[derive(Clone, Copy, Debug, PartialEq)]", "#[derive(Debug, PartialEq)]", has);
    refused("#[derive(Clone, Copy, Debug, PartialEq)]", "#[repr(packed)]\n#[derive(Clone, Copy, Debug, PartialEq)]", has);
    refused("#[allow(dead_code)]\npub const NAME", "#[cfg(any())]\npub const NAME", has);
    refused("#[allow(dead_code)]\npub const NAME", "#[allow(dead_code, unsafe_code)]\npub const NAME", has);
    refused("#[allow(dead_code)]\npub const NAME", "#[allow(dead_code)]\n#[no_mangle]\npub const NAME", has);
    refused("#[allow(dead_code)]\npub const NAME", "#[evil::attribute]\n#[allow(dead_code)]\npub const NAME", has);
    refused("#[inline]\nfn sin_cos", "#[no_mangle]\nfn sin_cos", has);
    refused("#[inline]\nfn sin_cos", "#[inline]\n#[export_name = \"sin\"]\nfn sin_cos", has);
    refused("// @generated", "#![feature(custom_inner_attributes)]\n// @generated", NO_ITEM);
    refused("// @generated", "#!/bin/sh\n// @generated", NO_ITEM);
    // Visibility, kinds of functions, types.
    refused("pub fn gravity(", "pub unsafe fn gravity(", "`unsafe` begins no item");
    refused("pub fn gravity(", "pub const fn gravity(", "`gravity` where an emitted module has `parameter_index`");
    refused("pub fn gravity(", "pub async fn gravity(", "`async` begins no item");
    refused("pub fn gravity(", "pub extern \"C\" fn gravity(", "`extern` begins no item");
    refused("pub fn gravity(", "pub(crate) fn gravity(", "`(` begins no item");
    refused("pub fn gravity(", "fn gravity(", "`gravity` is not a private item");
    refused("pub fn gravity(", "pub fn gravity<const N: usize>(", "`<` where the signature");
    refused("pub fn gravity(q: &[Real; DOF])", "pub fn gravity(q: [Real; DOF])", "`[` where the signature");
    refused("pub fn gravity(q: &[Real; DOF])", "pub fn gravity(q: &mut [Real; DOF])", "`mut` where the signature");
    refused("pub fn gravity(q: &[Real; DOF])", "pub fn gravity(q: &[Real; 4])", "`4` where the signature");
    refused("pub fn gravity(q: &[Real; DOF])", "pub fn gravity(q: &[Real; { DOF }])", "`{` where the signature");
    refused("pub fn gravity(q: &[Real; DOF])", "pub fn gravity(#[cfg(all())] q: &[Real; DOF])", "`#` where the signature");
    refused("pub fn gravity(q: &[Real; DOF]) -> [Real; DOF] {", "pub fn gravity(q: &[Real; DOF]) -> [Real; DOF] where {", has);
    refused(
        "pub fn coriolis_matrix(q: &[Real; DOF], dq",
        "pub fn coriolis_matrix(dq: &[Real; DOF], q",
        "`dq` where the signature",
    );
    refused("pub const NOMINAL_PARAMETERS", "const NOMINAL_PARAMETERS", "is not a private item");
    refused("    pub inertia:", "    inertia:", has);
    refused("    pub inertia:", "    pub(crate) inertia:", has);
    refused("    pub inertia: [[Real; DOF]; DOF],\n", "", has);
    refused("pub struct EquationsOfMotion {", "pub struct EquationsOfMotion<const N: usize = 1> {", has);
    refused("pub struct EquationsOfMotion {", &format!("pub struct EquationsOfMotion where [u8; {{ {RUNS} 1 }}]: Sized {{"), has);
    refused("pub type Real = f64;", &format!("pub type Real<const N: usize = {{ {RUNS} 1 }}> = f64;"), has);
    refused("pub type Real = f64;", "pub type Real = <u8 as A>::B;", "neither f64 nor f32");
    refused("pub type Real = f64;", "pub type Real = std::f64;", "neither f64 nor f32");
    refused("pub const DOF: usize = 4;", "pub const DOF: u8 = 4;", has);
    refused("pub const DOF: usize = 4;", "pub const DOF: usize = 2 + 2;", has);
    refused("pub const DOF: usize = 4;", "pub const DOF: usize = 0x4;", "`0x4` where an index or a count can stand");
    refused("pub const DOF: usize = 4;", "pub const DOF: usize = TASK_ROWS;", "`TASK_ROWS` where an index or a count can stand");
    refused("pub const NAME: &str = \"scara\";", "pub const NAME: &str = \"\\x73cara\";", "an escape in");
    refused("pub const NAME: &str = \"scara\";", "pub const NAME: &str = \"\\u{73}cara\";", "is none that is written so");
    refused(
        "pub const NAME: &str = \"scara\";",
        "pub const NAME: &str = concat!(\"scara\");",
        "where a value of the type `&str`",
    );
    // Sines.
    refused("libm::sincos(x)", "libm::sincosf(x)", has);
    refused("libm::sincos(x)", "crate::libm::sincos(x)", has);
    refused("libm::sincos(x)", "let (s, c) = libm::sincos(x); (c, s)", has);
}

#[test]
#[ignore = "wide"]
fn two_readings_of_one_text_are_refused() {
    let given = scara();
    let module = &given.module;
    // One name by normalisation: the compiler's reading has e, and an accent, twice.
    let accents = format!("{T1}    let \u{e9} = 5.0 * c2 + 8.766;\n    let e\u{301} = 77.0 * \u{e9};\n");
    given.refused(T1, &accents, "the character U+00E9 outside of comments");
    given.refused(T1, &T1.replace("t1", "r#t1"), "`r#` begins a raw name");
    given.refused_text(&format!("\u{feff}{module}"), "the character U+FEFF outside of comments");
    given.refused_text(&module.replace('\n', "\r\n"), "a carriage return");
    for blank in ['\t', '\u{b}', '\u{c}', '\u{85}', '\u{200e}', '\u{2028}', '\0'] {
        given.refused(T1, &T1.replace(" + ", &format!("{blank}+{blank}")), "outside of comments");
    }
    given.refused(T1, &T1.replace(" + 8", " /* /* */ + 1.0 */ + 8"), "a comment between /* and */");
    given.refused(T1, &T1.replace(";\n", "; // t1\n"), "`// t1`");
    given.refused(T1, &T1.replace(";\n", "; // \u{202e}\n"), "the character U+202E, which cannot be seen");
    given.refused("// Conventions:", "// \u{2066}Conventions:", "the character U+2066, which cannot be seen");
    given.refused("// Conventions:", "//! Conventions:", "begins no comment of an emitted module");
    given.refused("/// Name of the robot.", "//// Name of the robot.", "begins no comment of an emitted module");
    given.refused("/// Name of the robot.", "/** Name of the robot. */", "a comment between /* and */");
    // Names.
    for name in ["DOF", "Real", "sin_cos", "Some", "q", "c2", "_t1", "T1", "t", "x", "self", "gravity", "s2x\u{430}"] {
        let why = if name.is_ascii() { "" } else { "the character U+0430" };
        given.refused(T1, &format!("{T1}    let {name} = 5.0 * c2;\n"), why);
    }
    for pattern in ["mut t9", "ref t9", "t9: Real", "t9 @ _", "&t9", "(t9)", "t9 | t9", "Some(t9)", "[t9]", "..", "0.0..=9.0"] {
        given.refused(T1, &format!("{T1}    let {pattern} = 5.0 * c2;\n"), "");
    }
    // Numbers.
    for number in [
        "5.0f64", "5_0.0e-1", "5.", "5", "0x5", "5.00", "05.0", "5e0", "50e-1", "5.0_", "5E0", "5.0e+0", "1e999", "1e-999", "'5'",
    ] {
        let why = if number.starts_with('\'') { "the character `'`" } else { "" };
        given.refused(T1, &T1.replace("5.0", number), why);
    }
    // The decimal is right over the reals, and the float is off by 4.
    given.refused(
        T1,
        &T1.replace("8.766", "(8.766 - 4.0) + (100000000000000004.0 - 1e17)"),
        "is not the shortest decimal of a float",
    );
}

#[test]
#[ignore = "wide"]
fn steps_that_no_emitted_body_has_are_refused() {
    let given = scara();
    let value = |text: &str, why: &str| given.refused(T1, &T1.replace("5.0 * c2 + 8.766", text), why);
    let line = |text: &str, why: &str| given.refused(T1, &format!("{T1}    {text}\n"), why);
    for (text, why) in [
        ("c2.abs()", "`.` where an emitted module has `;`"),
        ("(c2).mul_add(5.0, 8.766)", "`.` where an emitted module has `;`"),
        ("f64::mul_add(5.0, c2, 8.766)", "`f64` is not a value that is given before"),
        ("{ 5.0 * c2 + 8.766 }", "`{` where a number, a name or a bracket can stand"),
        ("unsafe { 5.0 }", "`unsafe` is not a value"),
        ("if true { 5.0 } else { 6.0 }", "`if` is not a value"),
        ("loop { break 5.0 }", "`loop` is not a value"),
        ("match c2 { x => x }", "`match` is not a value"),
        ("(|x: Real| x)(c2)", "`|` where a number"),
        ("5.0 as Real", "`as` where an emitted module has `;`"),
        ("include!(\"x\")", "`include` is not a value"),
        ("5.0 % c2", "`%` where an emitted module has `;`"),
        ("--c2", "`-` where a number"),
        ("-(-(-c2)) * - -5.0", "`-` where a number"),
        ("!c2", "`!` where a number"),
        ("*c2", "`*` where a number"),
        ("&c2", "`&` where a number"),
        ("(c2, c2).0", "`,` where an emitted module has `)`"),
        ("[c2][0]", "`[` where a number"),
        ("q[DOF - 1]", "`DOF` where an index"),
        ("q[0usize]", "`0usize` where an index"),
        ("q[00]", "`00` where an index"),
        ("q[4]", "index 4 is beyond the end"),
        ("q[18446744073709551616]", "where an index"),
        ("(*q)[0]", "`*` where a number"),
        ("q.0", "`.` where an emitted module has `[`"),
        ("q", "`;` where an emitted module has `[`"),
        ("dq[0]", "`dq` is not an argument of the function"),
        ("sign(q[0])", "`sign` is called, and the module does not have it"),
        ("sin_cos(q[0])", "`sin_cos` is not a value"),
        ("t2", "`t2` is not a value that is given before"),
        ("Real::INFINITY", "`INFINITY` where an emitted module has `mul_add`"),
        ("Real::mul_add(5.0, c2)", "`Real::mul_add` takes two factors and what is added to their product"),
        ("c2 as f32 as f64", "`as` where"),
        ("c2 > 5.0", "`>` where"),
        ("return 5.0", "`return` is not a value"),
        ("#[cfg(any())] c2", "`#` where a number"),
        ("NOMINAL_PARAMETERS[0]", "`NOMINAL_PARAMETERS` is not a value"),
    ] {
        value(text, why);
    }
    for (text, why) in [
        ("let t2;", "`;` where an emitted module has `=`"),
        ("let t2 = 5.0 else { panic!() };", "`else` where"),
        ("let t1 = 5.0 * c2;", "`t1` is given twice"),
        ("let (_, c2) = sin_cos(q[1]);", "`c2` is given twice"),
        ("let _ = c2;", "`c2` is not an argument"),
        ("let _ = std::process::exit(1);", "`std` is not an argument"),
        ("let _ = (q, gravity(q));", "`gravity` is not an argument"),
        ("#[cfg(any())] let t2 = 5.0;", "`#` where a number"),
        ("t1 = 5.0;", "`=` where an emitted module has `}`"),
        ("t1;", "`;` where an emitted module has `}`"),
        ("const DOF: usize = 3;", "`const` is not a value"),
        ("fn sin_cos(x: Real) -> (Real, Real) { (x, x) }", "`fn` is not a value"),
        ("use libm as q;", "`use` is not a value"),
        ("impl Drop for EquationsOfMotion { fn drop(&mut self) {} }", "`impl` is not a value"),
        ("std::process::exit(1);", "`std` is not a value"),
        (";", "`;` where a number"),
        ("let (s9, c9) = sin_cos_one(q[1]);", "`sin_cos_one` is no function that gives"),
        ("let (s9, c9) = libm::sincos(q[1]);", "`libm` is no function that gives"),
        ("let (s9, c9) = (q[0], q[1]);", "`(` is no function that gives"),
        ("let (s9,) = sin_cos(q[1]);", "a sine and a cosine have two names"),
        ("let (s9, c9) = sin_cos(q[1] * 1.0);", "`*` where an emitted module has `)`"),
        ("let (s9, c9) = sin_cos(-q[1]);", "`-` is not an argument"),
        ("let (s9, c9) = sin_cos(0.5 + q[1]);", "`+` where an emitted module has `*`"),
        ("let (s9, c9) = sin_cos(0.5 * q[1]);", "a sum that is no joint variable of the description"),
        ("let (s9, c9) = sin_cos(q[1] + q[1]);", "an angle is a sum of joint variables in their order"),
        ("let (s9, c9) = sin_cos(q[1] + q[0]);", "an angle is a sum of joint variables in their order"),
        ("let (s9, c9) = sin_cos(q[1] - q[2] + q[3]);", "an angle is a sum of joint variables in their order"),
        ("let (s9, c9) = sin_cos(q[1] + 0.5 + 0.5);", "`+` where an emitted module has `)`"),
        ("let (s9, c9) = sin_cos(q[9]);", "index 9 is beyond the end of"),
        ("let [t9] = inertia_matrix_part_1([c2]);", "only part `inertia_matrix_part_1` can be called"),
        ("let [t9] = values;", "only part `inertia_matrix_part_1` can be called"),
    ] {
        line(text, why);
    }
    // What is returned.
    let whole = "EquationsOfMotion {\n        inertia: ";
    given.refused(whole, "EquationsOfMotion {\n        ..x, inertia: ", "`..` where an emitted module has `inertia`");
    given.refused(whole, "Self { inertia: ", "`Self` is not a value");
    given.refused(whole, "EquationsOfMotion { gravity: [0.0; 4], inertia: ", "`gravity` where an emitted module has `inertia`");
    given.refused("[10.0 * c2 + 21.526, t1, -0.25, -1.02]", "[10.0 * c2 + 21.526; 4]", "`;` where an emitted module has `]`");
    given.refused("[10.0 * c2 + 21.526, t1, -0.25, -1.02]", "[10.0 * c2 + 21.526, t1, -0.25]", "16 entries");
}

/// The fast sines have a `sin_cos` of their own, which is right near 0 alone.
#[test]
#[ignore = "wide"]
fn sines_of_several_angles_are_asked_for_as_armgen_asks() {
    let given = Given::new("scara", Trig::Fast);
    let line = "let c2 = cos_one(q[1]);";
    given.refused(line, "let (_, c2) = sin_cos(q[1]);", "`sin_cos` is no function that gives");
    given.refused(line, "let (_, c2) = sin_cos_beyond(q[1]);", "`sin_cos_beyond` is no function that gives");
    given.refused(line, "let c2 = sin_alone(q[1]);", "`sin_alone` is not a value");
    given.refused(line, "let c2 = sin_one(q[1]);", "inertia_matrix[0][0]: differs from the equations");
    given.refused(line, "let c2 = cos_one(q[2]);", "inertia_matrix[0][0]: differs from the equations");
    given.refused(line, "let c2 = cos_one(q[1], q[2]);", "`q` where an emitted module has `)`");
    given.refused(line, "let c2 = cos_one(q[1]) + 0.5;", "`+` where an emitted module has `;`");
    given.refused(line, "let c2 = 0.5 + cos_one(q[1]);", "`cos_one` is not a value");
    given.refused(line, "let ([_, _, _, _], [c2, _, _, _]) = sin_cos_four(1, q[1]);", "takes 4 angles");
    given.refused(line, "let ([_, _, _, _], [c2, _, _, _]) = sin_cos_four(0, q[1], q[1], q[1], q[1]);", "does not take 0 angles");
    given.refused(
        line,
        "let ([_, _, _, _], [_, c2, _, _]) = sin_cos_four(1, q[1], q[1], q[1], q[1]);",
        "none of the first 1 angles",
    );
    given.refused("any(target_feature = \"sse2\"", "any(windows, target_feature = \"sse2\"", "where an emitted module has");
    given.refused("0.1666666666666663", "0.1666666666666664", "where an emitted module has");
    given.refused("#[inline(always)]\nfn sin_cos", "#[inline]\nfn sin_cos", "where an emitted module has");
    // A constant's brackets hold what is there, and nothing else.
    given.refused(
        "const SIN_COS_QUADRANTS: [[f64; 2]; 4]",
        "const SIN_COS_QUADRANTS: [[f64; 2]; 4 + 0]",
        "where an emitted module has",
    );
    given.refused("[-0.0, -1.0],", "[-0.0, { std::process::exit(1); -1.0 }],", "where an emitted module has");
    // Each private item is called or needed by one that is called, and an item that nothing needs is refused.
    let items = fast_sines(&given.module);
    assert!(items.len() > 12);
    for text in items.values() {
        given.refused_text(&given.module.replacen(text.as_str(), "", 1), "the module does not have");
    }
    let of_eight = fast_sines(&Given::new("ur5", Trig::Fast).module);
    let others = of_eight.into_iter().filter(|(name, _)| !items.contains_key(name));
    let others: Vec<(String, String)> = others.collect();
    assert!(others.iter().any(|(name, _)| name == "sin_cos_eight"));
    for (name, text) in others {
        given.refused_text(&format!("{}\n{text}", given.module), &format!("`{name}` is needed by no function"));
    }
}

/// The fast sines of a module by their names, each with its documentation.
fn fast_sines(module: &str) -> BTreeMap<String, String> {
    let items = module.split("\n\n").filter_map(|item| {
        let rest = item.lines().find_map(|line| line.strip_prefix("fn ").or(line.strip_prefix("const ")))?;
        Some((rest.split(['(', ':']).next()?.to_owned(), item.to_owned()))
    });
    items.filter(|(name, _)| ["sin_", "cos_", "SIN_COS"].iter().any(|begins| name.starts_with(begins))).collect()
}

/// A sine alone is a function of the fast sines, and of f64.
#[test]
fn a_sine_alone_belongs_to_the_fast_sines() {
    let line = "let (_, c2) = sin_cos(q[1]);";
    let libm = Given::new("scara", Trig::Libm);
    libm.refused(line, "let c2 = cos_one(q[1]);", "`cos_one` is a function of modules with fast sines");
    let fast = fast_sines(&Given::new("scara", Trig::Fast).module);
    let why = "`sin_alone` is one of the fast sines, which the module does not have";
    libm.refused_text(&format!("{}\n{}", libm.module, fast["sin_alone"]), why);
    #[allow(clippy::needless_update)]
    let options = Options { scalar: Scalar::F32, trig: Trig::Fast, ..Options::default() };
    let module = common::generate_with(&common::source("scara"), &options).module;
    let fault = Module::read(format!("{module}\n{}", fast["sin_alone"]).as_str()).map(drop).expect_err("an item of f64");
    assert!(fault.to_string().contains("`sin_alone` is none of the fast sines of this scalar"), "{fault}");
}

/// `cargo test` runs what documentation holds.
#[test]
fn documentation_that_runs_is_refused() {
    let given = scara();
    let text = "/// Name of the robot.";
    let doc = |lines: &str, why: &str| given.refused(text, &format!("{text}\n{lines}"), why);
    doc("/// ```\n/// std::process::exit(1)\n/// ```", "can begin or end a block of code");
    doc("/// ```no_run\n/// std::process::exit(1)\n/// ```", "can begin or end a block of code");
    doc("/// ~~~\n/// std::process::exit(1)\n/// ~~~", "can begin or end a block of code");
    doc("///\n///     std::process::exit(1)", "two blanks in a row");
    doc("/// <!--\n/// ```text\n/// -->\n///\n///     std::process::exit(1)\n/// ```", "a tag of HTML can hold code");
    doc("/// ```text", "ends inside of a block");
    given.refused(
        "    /// Gravity term g(q)",
        "    /// ```\n    /// exit()\n    /// ```\n    /// Gravity term g(q)",
        "can begin or end a block",
    );
}

/// A function that writes the result of another: each entry once, of values that are given before, and nothing else.
#[test]
fn results_are_written_as_they_are_returned() {
    let given = scara();
    let entry = "result[3][10] = 400.0 * dq[3];";
    for (old, new, why) in [
        ("[[0.0; BASE_PARAMETERS]; DOF]", "[[1.0; BASE_PARAMETERS]; DOF]", "`1.0` where an emitted module has `0.0`"),
        (
            "base_regressor_into(q, dq, ddq, &mut",
            "regressor_into(q, dq, ddq, &mut",
            "an emitted module has `base_regressor_into`",
        ),
        ("&mut result.1", "&mut result.0", "where an emitted module has"),
        (
            "\nfn forward_dynamics_derivatives_into(",
            "\npub fn forward_dynamics_derivatives_into(",
            "`pub` where an emitted module has `fn`",
        ),
        ("pub fn base_regressor_into(", "fn base_regressor_into(", "`fn` where an emitted module has `pub`"),
        (entry, "", "does not have the 44 entries"),
        (entry, "result[3][11] = 400.0 * dq[3];", "does not have the 44 entries"),
        (entry, "result[3] = 400.0 * dq[3];", "`=` where an emitted module has `[`"),
        (entry, "result[3][10][0] = 400.0 * dq[3];", "`[` where an emitted module has `=`"),
        (entry, "result[3][10] = 400.0 * dq[3] + result[3][9];", "`result` is not a value that is given before"),
        (entry, "by_q[3][10] = 400.0 * dq[3];", "`by_q` is no line and no part of the result"),
        ("result[0][0] = ddq[0];", "result[0][0] = t1;", "`t1` is not a value that is given before"),
        ("barrier();", "barrier(0);", "`0` where an emitted module has `)`"),
        ("core::sync::atomic::compiler_fence(", "crate::compiler_fence(", "`crate` where an emitted module has `core`"),
        ("fn barrier()", "fn barriers()", "`barriers` is not a private item"),
    ] {
        given.refused(old, new, why);
    }
    let number = "\n#[allow(dead_code, clippy::all)]\npub fn kinetic_energy_into(q: &[Real; DOF]) {}\n";
    let why = "`kinetic_energy_into` is not a function that an emitted module has";
    given.refused_text(&(given.module.clone() + number), why);
}

/// A wrist's torque beside those of the whole arm, and torques at rest beside those at full speed.
#[test]
fn digits_lost_in_small_torques_are_seen() {
    let puma = Given::new("puma560", Trig::Libm);
    puma.refused(
        "result[5] = t24;",
        "result[5] = t24 + 33554432.0 - 33554432.0;",
        "inverse_dynamics: rounding can make an error of",
    );
    let description = "name: arm\nconvention: standard\ngravity: [0, -9.81, 0]\njoints:\n  - {name: a, type: revolute, a: 0.5, alpha: 0, d: 0, theta: 0, \
        limits: {velocity: 59}, link: {mass: 3, com: [-0.25, 0, 0], inertia: {xx: 0.01, yy: 0.1, zz: 0.1}}}\n  - {name: b, type: revolute, \
        a: 0.4, alpha: 0, d: 0, theta: 0, limits: {velocity: 59}, link: {mass: 2, com: [-0.2, 0, 0], inertia: {xx: 0.01, yy: 0.05, zz: 0.05}}}\n";
    let given = Given::of(Source::new("arm.yaml", description), Trig::Libm);
    let (head, body) = given.module.split_once("pub fn inverse_dynamics(").expect("a function");
    let slow = body.replacen("17.1675 * c1", "(17.1675 * c1 + 2097152.0 - 2097152.0)", 1);
    given.refused_text(&format!("{head}pub fn inverse_dynamics({slow}"), "rounding can make an error of");
}

/// A module that is right and says of itself what is not so.
#[test]
#[ignore = "wide"]
fn what_a_module_says_of_itself_is_judged() {
    let given = scara();
    let bound = |name: &str| {
        let at = given.module.find(&format!("pub fn {name}(")).expect("a function");
        let at = given.module[..at].rfind("/// Rounding error: ").expect("its bound");
        given.module[at..].lines().next().expect("a line").to_string()
    };
    let gravity = bound("gravity");
    let says = "gravity: the documentation says `Rounding error: ";
    given.refused(&gravity, "/// Rounding error: at most 9.3e-95 in any entry, over the box in the head of this file.", says);
    given.refused(&gravity, &format!("{gravity} Also none."), says);
    given.refused(&gravity, &format!("{gravity}\n///\n/// Rounding error: none."), says);
    given.refused(&gravity, "///", "gravity: the documentation does not say `Rounding error: ");
    given.refused("/// Cost: 2 multiplications", "/// Cost: 1 multiplication", "the documentation says `Cost: 1 multiplication");
    let head = |old: &str, new: &str, why: &str| given.refused(old, new, &format!("the head of the file: {why}"));
    let hash = given.module.split("(input ").nth(1).expect("a hash").split(')').next().expect("its end").to_string();
    head(&hash, "0123456789abcdef", "`@generated by armgen");
    head("// @generated by armgen", "// Written by hand and by armgen", "`Written by hand");
    head("pi rad or 1 m to either side", "1e-9 rad or 1 m to either side", "`Box of the rounding errors");
    let again = "// Box of the rounding errors: every q.\n\n/// The scalar of all";
    head("\n/// The scalar of all", again, "`Box of the rounding errors: every q.` stands there twice");
    head("by armgen 0", "by armgen 9 certified by somebody from 0", "`@generated by armgen 9 certified");
    head(" (input ", " (input 00) (input ", "`@generated by armgen");
    let elsewhere = "is stated where no function is documented";
    given.refused("/// Name of the robot.", "/// Name of the robot.\n///\n/// Rounding error: none.", elsewhere);
    given.refused("\n/// The scalar of all", "// Cost: none.\n\n/// The scalar of all", elsewhere);
}

/// Prose of another version of armgen is no fault: all words but those of facts are others here.
#[test]
fn prose_is_not_certified() {
    let given = scara();
    let word = |line: &str| line.starts_with("//") && !line.contains("```") && !line.contains("@generated");
    let is_fact = |line: &str| ["Cost: ", "Rounding error: "].iter().any(|fact| line.contains(fact));
    let is_of_box =
        |line: &str| ["Box of", "VELOCITY_LIMITS (4", "NOMINAL_PARAMETERS; arguments"].iter().any(|words| line.contains(words));
    let other = |line: &str| match line.split_once(' ') {
        Some((slashes, _)) if word(line.trim_start()) && !is_of_box(line) && !is_fact(line) => format!("{slashes} Other words."),
        _ => line.replace("Derived by recursion", "Derived by another way"),
    };
    // In front of a formula the slashes of documentation are indented with its field.
    let indented = |line: &str| {
        let rest = line.trim_start();
        line[..line.len() - rest.len()].to_string() + &other(rest)
    };
    let text: String = given.module.lines().map(|line| indented(line) + "\n").collect();
    assert!(text.matches("Other words.").count() > 200);
    let report = verify_with(&given.source, &text, given.claims.clone(), Effort::default());
    assert!(report.passed(), "{report}");
}

/// What is wrong with a right module's certificate that was changed as a value, or as text.
#[track_caller]
fn misjudged(given: &Given, change: impl Fn(&mut Certificate), why: &str) {
    let mut certificate = given.certificate.clone();
    change(&mut certificate);
    assert_ne!(certificate, given.certificate, "nothing was changed");
    let text = certificate.to_json();
    let fault = match Certificate::from_json(&text) {
        Err(fault) => fault,
        Ok(read) => verify(&given.source, &given.module, Some(&read)).first_fault().unwrap_or_else(|| panic!("accepted: {why}")),
    };
    assert!(fault.contains(why), "{fault}, instead of: {why}");
}

#[test]
#[ignore = "wide"]
fn certificates_are_compared_with_what_is_found() {
    let given = scara();
    assert!(verify(&given.source, &given.module, Some(&given.certificate)).passed());
    let of = |change: &dyn Fn(&mut Certificate), why: &str| misjudged(&given, change, why);
    of(&|c| c.verified = false, "the certificate says verified: false, the checker finds true");
    of(&|c| c.faults.push("all is lost".into()), "the certificate says faults: [\"all is lost\"], the checker finds []");
    of(&|c| c.rounding_box.clear(), "the certificate says rounding_box: {}");
    of(&|c| c.robot = "another".into(), "the certificate says robot: \"another\", the checker finds \"scara\"");
    of(&|c| c.made_by = "armgen 9".into(), "the certificate says made_by: \"armgen 9\"");
    of(&|c| c.options.clear(), "the certificate says options: {}");
    of(
        &|c| c.functions[0].error_bound = "1e-300".into(),
        "functions[direct_kinematics].error_bound: \"1e-300\", the checker finds",
    );
    of(&|c| c.functions[0].verdict = "DIFFERENT".into(), "functions[direct_kinematics].verdict: \"DIFFERENT\"");
    of(&|c| c.functions[0].points += 1, "functions[direct_kinematics].points: ");
    of(&|c| c.functions[0].odds_of_a_miss = "2^-9999".into(), "functions[direct_kinematics].odds_of_a_miss: \"2^-9999\"");
    of(&|c| c.functions[0].smallest_divisor = Some("1".into()), "the certificate says functions[direct_kinematics]: ");
    of(&|c| c.constants[1].verdict.clear(), "constants[DOF].verdict: \"\"");
    of(&|c| c.constants.clear(), "the certificate says constants: []");
    of(&|c| c.identities.truncate(1), "the certificate says identities: ");
    of(&|c| c.definitions.push((0, "pi".into())), "the certificate says ");
    of(&|c| c.input.sha256.replace_range(..1, "x"), "the certificate is of another description");
    of(&|c| c.output.sha256.replace_range(..1, "x"), "the certificate is of another module");
    of(&|c| c.functions.swap(0, 1), "lists other functions or literals");
    of(&|c| c.functions.truncate(20), "lists other functions or literals");
    of(&|c| c.functions[0].literals.push(("1.0".into(), "1".into())), "lists other functions or literals");
    of(&|c| c.functions[0].literals[0].0 = "0.5".into(), "lists other functions or literals");
    of(&|c| c.certificate = 2, "the certificate has format 2");
    // Values of literals: none but those that armgen would write, and none that costs more than one of a robot.
    let value = |new: &str, why: &str| {
        of(
            &|c| {
                let entry = c.functions.iter_mut().find(|entry| entry.name == "inertia_matrix").expect("it is there");
                entry.literals.iter_mut().find(|(literal, _)| literal == "5.0").expect("a literal").1 = new.into();
            },
            why,
        );
    };
    value("10/2", "the certificate says functions[inertia_matrix].literals[0][1]: \"10/2\", the checker finds \"5\"");
    value("6", "the literal 5.0 is not the float nearest to 6");
    value("5 + 1/10^20*sqrt(2)", "inertia_matrix[0][1]: differs from the equations");
    value("sqrt(25)*sin(1", "expected `)`");
    value("(((9^400)^400)^400)", "a power of about ");
    value("((((1 + sqrt(2))^400)^400)^400)^400", "a power of about ");
    value(&format!("5 + {}0", "1e400*".repeat(30_000)), "the formulas cost more than the constants of any robot");
    let sum: String = (2..12_000).map(|n| format!(" + atan(1/{n})")).collect();
    value(&format!("5{sum}"), "is not the float nearest to");
    // Equal to the boundary between two floats, which no enclosure shows.
    value(
        "(5 + 1/2251799813685248)*sqrt(2 + sqrt(3))*sqrt(2 - sqrt(3))",
        "1024 bits do not tell whether 5.0 is the float nearest to",
    );
}

/// The text of a certificate has one form: nothing beside, nothing twice.
#[test]
fn certificates_are_written_as_armgen_writes_them() {
    let given = scara();
    let text = given.certificate.to_json();
    for (old, new, why) in [
        ("\n", "\r\n", "is not as armgen writes it"),
        ("  \"verified\": true", "  \"verified\": false,\n  \"verified\": true", "duplicate field"),
        ("    \"scalar\": \"f64\"", "    \"scalar\": \"f32\",\n    \"scalar\": \"f64\"", "is not as armgen writes it"),
        ("  \"verified\": true", "  \"remark\": \"\",\n  \"verified\": true", "unknown field `remark`"),
        ("\"scara\"", "\"\\u0073cara\"", "is not as armgen writes it"),
    ] {
        assert!(text.contains(old), "{old}");
        let fault = Certificate::from_json(&text.replacen(old, new, 1)).expect_err(new);
        assert!(fault.contains(why), "{fault}");
    }
    assert!(Certificate::from_json(&format!("{text} ")).is_err());
    assert!(Certificate::from_json(&" ".repeat(40 << 20)).expect_err("too long").contains("32 MiB"));
}

#[test]
fn run_time_parameters_may_be_anything() {
    let scara = scara();
    // 0/0 at a mass of 0, which is no pole of the equations.
    scara.refused("let t2 = 1.0 / (t1 + pi[2]);", "let t2 = pi[0] / ((t1 + pi[2]) * pi[0]);", "it divides by what is no pivot");
    let load = "[0.0, 0.0, -9.81 * pi[2], 0.0]";
    // A parameter that is 0 in the description is 5 at run time.
    let text = scara.source.text().replacen("m_l3: 10 ", "m_l3: 0  ", 1);
    assert_ne!(text, scara.source.text());
    let without = Given::of(Source::new("scara.yaml", text), Trig::Libm);
    let lost = "[0.0, 0.0, -9.81 * pi[2] + 1e17 * pi[2] - 1e17 * pi[2], 0.0]";
    without.refused(load, lost, "gravity_with: rounding can make an error of");
}

/// A line of the function that is changed, as it stands, and another one.
const FRICTION: &str = "[5e-5 * dq[0], 5e-5 * dq[1], 25.0 * dq[2], 2.0 * dq[3]]";
const TORQUES: &str = "[t10 + 12.76 * ddq[0], t7 + 5e-5 * t8 - t9, t3, 0.38 * t1 - 1.4 * t2 + 2.0 * dq[3]]";

/// Powers and angles that cancel are judged by what they lose.
#[test]
fn powers_and_angles_that_cancel_lose_digits() {
    let scara = scara();
    let lost = "rounding can make an error of";
    let friction = |dq_1: &str| scara.refused(FRICTION, &FRICTION.replace("5e-5 * dq[1]", dq_1), lost);
    friction("5e-5 * dq[1] + 1000000.0 * dq[0] - 1000000.0 * dq[0]");
    friction("5e-5 * dq[1] + 1000000.0 * dq[1] * dq[1] - 1000000.0 * dq[1] * dq[1]");
    scara.refused(TORQUES, &TORQUES.replace("12.76 * ddq[0]", "12.76 * ddq[0] + 100000000.0 * q[0] - 100000000.0 * q[0]"), lost);
    // A peak where all angles are 0, and nothing beside it.
    let mut peak = "    let (_, c2) = sin_cos(q[1]);\n    let t1 = c2 * c2;\n".to_string();
    (2..8).for_each(|k| peak += &format!("    let t{k} = t{0} * t{0};\n", k - 1));
    let at = scara.module.find("pub fn gravity(").expect("the function");
    let changed = scara.module[at..].replacen("    let _ = q;\n", &peak, 1);
    let changed = changed.replacen("-98.1", "1000000.0 * t7 - 98.1 - 1000000.0 * t7", 1);
    scara.refused_text(&format!("{}{changed}", &scara.module[..at]), "gravity: rounding can make an error of");
}

/// An entry that is small beside the others, and as exact as they are.
#[test]
fn each_entry_has_digits_of_its_own() {
    let scara = scara();
    let single = {
        let source = common::source("scara");
        let generated = common::generate(&source, Scalar::F32);
        let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
        let certificate = scara.certificate.clone();
        Given { source, module: generated.module, claims, certificate }
    };
    for given in [&scara, &single] {
        given.refused("[5e-5 * dq[0], ", "[5e-5 * dq[0] + 1000000.0 - 1000000.0, ", "friction: rounding can make an error of");
    }
    let rows = "[-t3, -(t2 + t3), 0.0, 0.0],\n        [t2, ";
    let lost = "[-t3, -(t2 + t3), 0.0, 0.0],\n        [t2 + 1000000.0 * dq[0] - 1000000.0 * dq[0], ";
    scara.refused(rows, lost, "coriolis_matrix: rounding can make an error of");
}

/// One array may be argument and result; names are told apart by 63 characters.
#[test]
fn what_a_compiler_of_c_may_do_is_refused() {
    let given = scara();
    let generated = common::generate(&given.source, Scalar::F64);
    let text = generated.in_language(Language::C);
    let fault = |old: &str, new: &str| {
        let at = text.find("scara_momentum(").expect("the function");
        assert!(text[at..].contains(old), "{old}");
        let text = text[..at].to_string() + &text[at..].replacen(old, new, 1);
        let report = verify_with(
            &given.source,
            ModuleText { language: Language::C, text: &text },
            given.claims.clone(),
            Effort::default(),
        );
        report.first_fault().expect("a fault")
    };
    let aliased = fault("    result[2] = r3;", "    result[2] = 22.5 * dq[2] - 0.25 * t2;");
    assert!(aliased.contains("an argument is read after an entry of the result is written"), "{aliased}");
    let long = fault("_real t1 = ", &format!("_real t1{} = ", "a".repeat(62)));
    assert!(long.contains("where an emitted module has"), "{long}");
}

/// What is no difference is not said to be one.
#[test]
fn what_has_no_value_is_not_said_to_differ() {
    let scara = scara();
    let squares: String = (901..961).map(|k| format!("let t{k} = t{0} * t{0}; ", k - 1)).collect();
    let changed = format!("{T1}    let t900 = 0.5 * c2; {squares}\n");
    let text = scara.module.replacen(T1, &changed, 1).replacen("[10.0 * c2 + 21.526,", "[10.0 * c2 + 21.526 + t960 - t960,", 1);
    scara.refused_text(&text, "inertia_matrix[0][0]: has exact values of more than 2^20 bits");
    let none = "[10.0 * c2 + 21.526 + (c2 - c2) / (c2 - c2),";
    scara.refused("[10.0 * c2 + 21.526,", none, "inertia_matrix[0][0]: divides by 0 at point 1");
}

/// Over the reals the two are one sign; in floats one of the products is 0 where the angle is small, and the other is not.
#[test]
#[ignore = "wide"]
fn signs_are_those_of_loads() {
    let underflow = "sign(t900 * t900 * 1e24) - sign(t900 * 1e24 * t900)";
    for (name, joint) in [("load_friction", 3), ("dry_friction", 1)] {
        let angles = format!("    let t900 = 1e-170 * s{joint};\n");
        let given = Given::new(name, Trig::Libm);
        let waves = format!("    let (s{joint}, c{joint}) = sin_cos(");
        for function in ["pub fn gravity(", "pub fn load_friction("] {
            let Some(at) = given.module.find(function) else { continue };
            let (before, function) = given.module.split_at(at);
            let line = function.find(&waves).expect("a sine");
            let line = line + function[line..].find('\n').expect("its end") + 1;
            let mut changed = format!("{}{angles}{}", &function[..line], &function[line..]);
            let entries = changed.find("    [\n").expect("the result") + 6;
            let entry = entries + changed[entries..].find(",\n").expect("an entry");
            changed.insert_str(entry, &format!(" + 12.0 * ({underflow})"));
            given.refused_text(&format!("{before}{changed}"), "it takes the sign of what is no gravity torque");
        }
    }
}

/// The torque itself, once more and otherwise: what is beside it has a sign where it is 0.
#[test]
fn a_load_has_one_sign() {
    let given = Given::new("load_friction", Trig::Libm);
    let (before, function) = given.module.split_at(given.module.find("pub fn load_friction(").expect("the function"));
    let torque = "(sign(t3) * t3)";
    assert!(function.contains(torque));
    for (other, why) in [
        ("(44.145 * c3 + s3 - s3 - 25.48712763337603 * s3)", "it takes the sign of one torque in two forms"),
        ("(25.48712763337603 * s3 - 44.145 * c3)", "it takes the sign of one torque in two forms"),
        ("(s3 + c3)", "it takes the sign of what is no gravity torque"),
    ] {
        let changed = function.replacen(torque, &format!("(sign(t3) * t3 + sign({other}) - sign({other}))"), 1);
        given.refused_text(&format!("{before}{changed}"), why);
    }
    // The same step, and its negative, are one.
    let changed = function.replacen(torque, "(-sign(-t3) * t3)", 1);
    let report = verify_with(&given.source, format!("{before}{changed}").as_str(), given.claims.clone(), Effort::default());
    assert_eq!(report.first_fault(), None);
}
