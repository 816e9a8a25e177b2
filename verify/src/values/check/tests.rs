//! Omits each check in turn. One check refuses a trick; without it the next check does; without all of them the trick is accepted. So no
//! check can disappear without a failing test, and the tests document the purpose of each.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::panic::{catch_unwind, AssertUnwindSafe};

use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_description::kinds::Scalar;
use armgen_description::language::Language;
use armgen_description::source::Source;

use super::Check::{self, *};
use crate::certificate::Certificate;
use crate::certify::{certify, document_bounds};
use crate::judge::checker::Effort;
use crate::read::claims::Claims;
use crate::read::reader::ModuleText;
use crate::{verify, verify_with};

thread_local! {
    static LEFT_OUT: RefCell<Vec<Check>> = const { RefCell::new(Vec::new()) };
}

pub(super) fn is_left_out(check: Check) -> bool {
    LEFT_OUT.with_borrow(|left_out| left_out.contains(&check))
}

/// The checks that this thread omits.
pub(super) fn left_out() -> Vec<Check> {
    LEFT_OUT.with_borrow(Vec::clone)
}

/// Makes this thread omit these checks from now on.
pub(super) fn leave_out(checks: &[Check]) {
    LEFT_OUT.set(checks.to_vec());
}

/// A correct module with its companions.
struct Given {
    source: Source,
    module: String,
    claims: Claims,
    certificate: Certificate,
}

fn given(robot: &str, options: &Options) -> Given {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let paths = ["robots", "tests/robots"].map(|folder| format!("{root}/{folder}/{robot}.yaml"));
    let text = paths.iter().find_map(|path| std::fs::read_to_string(path).ok()).expect("a robot of the project");
    let source = Source::new(format!("{robot}.yaml"), text);
    let mut generated = armgen_codegen::generate(&source, options).0.expect("a valid robot");
    document_bounds(&source, &mut generated).expect("bounds");
    let report = certify(&source, &generated);
    assert!(report.passed(), "{report}");
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    Given { source, module: generated.module, claims, certificate: Certificate::of(&report) }
}

/// A check and its reason for refusal.
type Layer = (Check, &'static str);

/// The outcome of a trick without the checks that refuse it.
#[derive(Debug)]
enum Last {
    Accepted,
    /// It cannot be read or run.
    Refused(&'static str),
    /// Trying it would take too long.
    NotTried,
}

/// The results of the tricks so far.
#[derive(Default)]
struct Tally {
    left_out: BTreeSet<Check>,
    /// Tricks with an unexpected outcome.
    wrong: Vec<String>,
}

impl Tally {
    /// The first check refuses a trick for the first reason, the second check without it for the second, and so on, until `last`.
    fn peel(&mut self, trick: &str, layers: &[Layer], last: Last, fault: impl Fn() -> Option<String>) {
        let fault = || {
            let caught = catch_unwind(AssertUnwindSafe(&fault));
            caught.unwrap_or_else(|panic| Some(panic.downcast_ref::<String>().cloned().unwrap_or_default()))
        };
        for (check, why) in layers {
            let found = fault();
            if !found.as_ref().is_some_and(|found| found.contains(why)) {
                let so_far = LEFT_OUT.take();
                return self.wrong.push(format!("{trick}: {found:?}, not {why}, without {so_far:?}"));
            }
            LEFT_OUT.with_borrow_mut(|left_out| left_out.push(*check));
            self.left_out.insert(*check);
        }
        let found = if matches!(last, Last::NotTried) { None } else { fault() };
        let so_far = LEFT_OUT.take();
        let right = match (&last, &found) {
            (Last::Refused(why), Some(found)) => found.contains(why),
            (Last::Refused(_), None) => false,
            (Last::Accepted | Last::NotTried, found) => found.is_none(),
        };
        if !right {
            self.wrong.push(format!("{trick}: {found:?}, not {last:?}, without {so_far:?}"));
        }
    }

    /// The same for a module with a replaced text after a given place.
    fn module(&mut self, given: &Given, from: &str, old: &str, new: &str, layers: &[Layer]) {
        self.text(given, new, &edited(&given.module, from, old, new), layers);
    }

    /// A module that needs no check because the reader cannot read it.
    fn unreadable(&mut self, given: &Given, from: &str, old: &str, new: &str, why: &'static str) {
        let text = edited(&given.module, from, old, new);
        let fault = || verify_with(&given.source, &text, given.claims.clone(), Effort::default()).first_fault();
        self.peel(new, &[], Last::Refused(why), fault);
    }

    fn text(&mut self, given: &Given, trick: &str, text: &str, layers: &[Layer]) {
        let short: String = trick.chars().take(200).collect();
        self.peel(&short, layers, Last::Accepted, || {
            verify_with(&given.source, text, given.claims.clone(), Effort::default()).first_fault()
        });
    }

    /// The same for a certificate.
    fn certificate(&mut self, given: &Given, change: impl Fn(&mut Certificate), layers: &[Layer]) {
        let mut certificate = given.certificate.clone();
        change(&mut certificate);
        self.certificate_text(given, &certificate.to_json(), Last::Accepted, layers);
    }

    fn certificate_text(&mut self, given: &Given, text: &str, last: Last, layers: &[Layer]) {
        self.peel("certificate", layers, last, || match Certificate::from_json(text) {
            Err(fault) => Some(fault),
            Ok(read) => verify(&given.source, &given.module, &read).first_fault(),
        });
    }
}

/// A module with a text replaced at its first occurrence after another text.
fn edited(module: &str, from: &str, old: &str, new: &str) -> String {
    let at = module.find(from).unwrap_or_else(|| panic!("{from} is not in the module"));
    assert!(module[at..].contains(old), "{old} is not in the module behind {from}");
    module[..at].to_string() + &module[at..].replacen(old, new, 1)
}

/// An item of a module with everything that belongs to it.
fn item<'a>(module: &'a str, begins: &str) -> &'a str {
    let at = module.find(begins).unwrap_or_else(|| panic!("{begins} is not in the module"));
    let from = module[..at].rfind("\n\n").expect("a blank line") + 1;
    let to = module[at..].find("\n\n").map_or(module.len(), |length| at + length + 1);
    &module[from..to]
}

const B: &str = "pub fn inertia_matrix(";
const T1: &str = "    let t1 = 5.0 * c2 + 8.766;\n";
const B11: &str = "10.0 * c2 + 21.526";
const NAMED: &str = "/// Name of the robot.";
const STATIC: &str =
    "#[used] #[link_section=\".init_array\"] static I: extern \"C\" fn() = r; extern \"C\" fn r(){ std::println!(\"x\"); }";

#[test]
fn no_check_can_be_left_out() {
    let mut tally = Tally::default();
    let scara = given("scara", &Options::default());
    texts_and_items(&mut tally, &scara);
    unreadable(&mut tally, &scara);
    bodies(&mut tally, &scara);
    bodies_in_c(&mut tally, &scara);
    functions(&mut tally, &scara);
    floats(&mut tally, &scara);
    signs(&mut tally);
    constants(&mut tally, &scara);
    comments(&mut tally, &scara);
    certificates(&mut tally, &scara);
    crate::inverse_kinematics::tests::tricks(&mut |trick, layers, fault| tally.peel(trick, layers, Last::Accepted, fault));
    // Every check has a trick, so a new check requires a new trick.
    let text = include_str!("../check.rs");
    let body = text.split("enum Check {").nth(1).and_then(|rest| rest.split("\n}").next()).expect("the checks");
    for name in body.lines().filter_map(|line| line.trim().strip_suffix(',')) {
        if !tally.left_out.iter().any(|check| format!("{check:?}") == name) {
            tally.wrong.push(format!("no trick shows what {name} is for"));
        }
    }
    assert!(tally.wrong.is_empty(), "{}", tally.wrong.join("\n"));
}

fn texts_and_items(tally: &mut Tally, scara: &Given) {
    let module = &scara.module;
    let appended =
        |tally: &mut Tally, text: &str, layers: &[Layer]| tally.text(scara, text, &format!("{module}\n{text}\n"), layers);
    appended(tally, &"\n".repeat(33 << 20), &[(Length, "the text is longer than 32 MiB")]);
    let documentation = |tally: &mut Tally, new: &str, layers: &[Layer]| tally.module(scara, "", NAMED, new, layers);
    documentation(tally, "/// Name of the robot.\u{202e}", &[(Visible, "U+202E, which cannot be seen")]);
    let runs = "/// Name.\n/// ```\n/// std::process::exit(1)\n/// ```";
    documentation(tally, runs, &[(Fences, "can begin or end a block of code")]);
    documentation(tally, "/// Name.\n///\n///     std::process::exit(1)", &[(Indentation, "two blanks in a row")]);
    let elsewhere = [(Facts, "is stated where no function is documented")];
    documentation(tally, "/// Name of the robot.\n///\n/// Rounding error: none.", &elsewhere);
    tally.module(scara, "", "PartialEq)]", "PartialEq, evil::Evil)]", &[(Tokens, "`,` where an emitted module has `)`")]);
    tally.module(scara, "pub fn gravity(", "q: &[Real; DOF]", "q: &[Real; 4]", &[(Signatures, "`4` where the signature")]);
    appended(
        tally,
        "/// Number of joints.\n#[allow(dead_code)]\npub const DOF: usize = 4;",
        &[(Once, "constant `DOF` stands twice")],
    );
    let without = |begins: &str| module.replace(item(module, begins), "");
    tally.text(scara, "no struct", &without("pub struct EquationsOfMotion"), &[(Companions, "come together")]);
    let no_index = [(Companions, "the module does not have `parameter_index`")];
    tally.text(scara, "no places of parameters", &without("pub const fn parameter_index("), &no_index);
    let payload = include_str!("../../read/reader/parameters.rs");
    let payload = payload.split("RUST_PAYLOAD: &str = r#\"").nth(1).and_then(|rest| rest.split("\"#").next()).expect("its text");
    let foreign = [(Companions, "`payload_parameters` of parameters that the module does not have")];
    tally.text(scara, "a payload of none", &format!("{module}{payload}"), &foreign);
    let names = [(PrivateNames, "is not a private item of an emitted module"), (PrivateNeeded, "is needed by no function")];
    appended(tally, &format!("fn table() -> Real {{ {STATIC} 0.0 }}"), &names);
    appended(tally, "fn unused() -> Real { mod a { #[path = \"b.rs\"] mod b; } 0.0 }", &names);
    tally.text(scara, "no sines", &without("fn sin_cos("), &[(PrivateThere, "is called, and the module does not have it")]);
    let part = "/// Part 1 of `gravity`.\n#[allow(dead_code, clippy::all)]\n#[inline(never)]\n\
                fn gravity_part_1(values: [Real; 0]) -> [Real; 0] { let [] = values; [] }";
    appended(tally, part, &[(PartsNeeded, "`gravity_part_1` is needed by no function")]);
}

/// Texts outside the grammar.
fn unreadable(tally: &mut Tally, scara: &Given) {
    let no_item = "begins no item of an emitted module";
    tally.unreadable(scara, "", NAMED, &format!("#[doc = include_str!(\"Cargo.toml\")]\n{NAMED}"), no_item);
    tally.unreadable(scara, "", "pub fn gravity(", "pub unsafe fn gravity(", no_item);
    tally.unreadable(scara, "", "    pub inertia:", "    inertia:", "`inertia` where an emitted module has `pub`");
    let private = "`NOMINAL_PARAMETERS` is not a private item of an emitted module";
    tally.unreadable(scara, "", "pub const NOMINAL_PARAMETERS", "const NOMINAL_PARAMETERS", private);
    let of_struct = format!("pub struct EquationsOfMotion where [u8; {{ {STATIC} 1 }}]: Sized {{");
    let tokens = "`where` where an emitted module has `{`";
    tally.unreadable(scara, "", "pub struct EquationsOfMotion {", &of_struct, tokens);
    let alias = format!("pub type Real<const N: usize = {{ {STATIC} 1 }}> = f64;");
    tally.unreadable(scara, "", "pub type Real = f64;", &alias, "`<` where an emitted module has `=`");
    let impl_drop = "impl Drop for EquationsOfMotion { fn drop(&mut self) { panic!() } }";
    tally.unreadable(scara, B, T1, &format!("{T1}    {impl_drop}\n"), "`impl` is not a value that is given before");
    let part = "only part `inertia_matrix_part_1` can be called";
    tally.unreadable(scara, B, T1, "    let [t1, _] = help(c2);\n", part);
    let two = "`Real::mul_add` takes two factors and what is added to their product";
    tally.unreadable(scara, B, T1, "    let t1 = Real::mul_add(5.0, c2);\n", two);
    let other = "`exp` where an emitted module has `mul_add` in `Real::mul_add(`";
    tally.unreadable(scara, B, T1, "    let t1 = Real::exp(c2);\n", other);
    let returning = item(&scara.module, "\npub fn base_regressor(");
    let alone = scara.module.replace(returning, "");
    let fault = || verify_with(&scara.source, &alone, scara.claims.clone(), Effort::default()).first_fault();
    let reason = "`base_regressor_into` without the function `base_regressor`";
    tally.peel("a function that writes alone", &[], Last::Refused(reason), fault);
    let accents = format!("{T1}    let \u{e9} = 5.0 * c2 + 8.766;\n    let e\u{301} = 77.0 * \u{e9};\n");
    tally.unreadable(scara, B, T1, &accents, "the character U+00E9 outside of comments");
}

fn bodies(tally: &mut Tally, scara: &Given) {
    let line = |tally: &mut Tally, text: &str, layers: &[Layer]| tally.module(scara, B, T1, &format!("{T1}    {text}\n"), layers);
    line(tally, "let abc = c2;", &[(Names, "where the name of a value can stand")]);
    line(tally, "let t9 = c2; let t9 = t1;", &[(NamesOnce, "`t9` is given twice")]);
    let cost = (Cost, "the documentation says `Cost: ");
    line(tally, "let (s9, c9) = sin_cos(q[1] + q[0]);", &[(Angles, "an angle is a sum of joint variables in their order"), cost]);
    let deep = format!("let t1 = {}5.0 * c2 + 8.766{};\n", "(".repeat(17), ")".repeat(17));
    tally.module(scara, B, T1, &deep, &[(Brackets, "brackets in more than 16 others")]);
    let (first, twice) = ("result[0][0] = ddq[0];", [(WrittenOnce, "an entry of `result` is written twice")]);
    tally.module(scara, "pub fn base_regressor_into(", first, &format!("{first} {first}"), &twice);
    tally.module(scara, B, "5.0 * c2", "5.00 * c2", &[(Shortest, "is not the shortest decimal of a float")]);
    let fast = given("scara", &Options { trig: Trig::Fast, ..Options::default() });
    let lanes = "let ([_, _, _, _], [c2, c9, _, _]) = sin_cos_four(1, q[1], q[1], q[1], q[1]);";
    tally.module(&fast, B, "let c2 = cos_one(q[1]);", lanes, &[(Lanes, "none of the first 1 angles")]);
    let fused = given("scara", &Options { fuse: true, ..Options::default() });
    let b11 = "Real::mul_add(10.0, c2, 21.526)";
    let other = [
        (Modular, "inertia_matrix[0][0]: differs from the equations at point 1 modulo"),
        (Rational, "inertia_matrix[0][0]: differs from the equations at rational point 1"),
        (Identities, "does not hold"),
    ];
    tally.module(&fused, B, b11, "Real::mul_add(-10.0, c2, 21.526)", &other);
    let deep = format!("let t9 = {}c2{};", "Real::mul_add(2.0, ".repeat(17), ", 1.0)".repeat(17));
    line(tally, &deep, &[(Brackets, "brackets in more than 16 others"), cost]);
    // Only the bound shows that the product is rounded anyway.
    let rounded = [cost, (Rounding, "the documentation says `Rounding error: ")];
    tally.module(&fused, B, b11, "10.0 * c2 + 21.526", &rounded);
    let dry = given("dry_friction", &Options::default());
    let known = "pub fn known_torque(";
    let of_rates = [(Signs, "Stribeck friction of something that is not a joint rate")];
    tally.module(&dry, known, "stribeck(dq[1]", "stribeck(q[1]", &of_rates);
    let fades = [(Velocities, "the exponential of the friction of joint 2 decays at 0.03, in the description at 0.02")];
    tally.module(&dry, known, "stribeck(dq[1], 0.02)", "stribeck(dq[1], 0.03)", &fades);
}

/// A C compiler may alias two arguments, and may ignore the characters of a name after the 63rd.
fn bodies_in_c(tally: &mut Tally, scara: &Given) {
    let mut generated = armgen_codegen::generate(&scara.source, &Options::default()).0.expect("a valid robot");
    document_bounds(&scara.source, &mut generated).expect("bounds");
    let text = generated.in_language(Language::C);
    let at = text.find("scara_momentum(").expect("the function");
    let (before, function) = text.split_at(at);
    let mut c = |trick: &str, function: &str, layers: &[Layer]| {
        assert!(text[at..] != *function, "{trick}");
        let text = format!("{before}{function}");
        let module = ModuleText { language: Language::C, text: &text };
        let fault = || verify_with(&scara.source, module, scara.claims.clone(), Effort::default()).first_fault();
        tally.peel(trick, layers, Last::Accepted, fault);
    };
    let sum = "22.5 * dq[2] - 0.25 * t1";
    let local = format!("    const scara_real r3 = {sum};\n");
    let aliased = function.replacen(&local, "", 1).replacen("result[2] = r3;", &format!("result[2] = {sum};"), 1);
    c("an alias", &aliased, &[(Aliases, "an argument is read after an entry of the result is written")]);
    let end = function.find("\n}\n").expect("its end");
    let long = function[..end].replace(" t3 ", &format!(" t3{} ", "a".repeat(62))) + &function[end..];
    c("a long name", &long, &[(Long, "where an emitted module has")]);
    let python = generated.in_language(Language::Python);
    let at = python.find("    \"").expect("a text in a list");
    let value = format!("{}    \"\"\"\"\"\"\n{}", &python[..at], &python[at..]);
    let module = ModuleText { language: Language::Python, text: &value };
    let fault = || verify_with(&scara.source, module, scara.claims.clone(), Effort::default()).first_fault();
    tally.peel("a text in a list", &[(Strings, "a text that is no comment")], Last::Accepted, fault);
}

fn functions(tally: &mut Tally, scara: &Given) {
    let module = &scara.module;
    let without = |begins: &str| module.replace(item(module, begins), "");
    tally.text(scara, "no momentum", &without("pub fn momentum("), &[(Required, "momentum: the module does not have it")]);
    let absent = (Optional, "center_of_mass: the module does not have it");
    tally.text(scara, "no centre of mass", &without("pub fn center_of_mass("), &[absent]);
    let identities = |why: &'static str| (Identities, why);
    // The head names the functions of the module, and one of them fewer or more.
    let names: Vec<&str> = module.lines().filter_map(|line| line.strip_prefix("pub fn ")?.split('(').next()).collect();
    let asking =
        |names: &str| module.replacen(". Do not edit.\n", &format!(". Do not edit.\n// Options: --functions {names}\n"), 1);
    tally.text(
        scara,
        "another function",
        &asking(&names[1..].join(",")),
        &[(Chosen, "its options do not ask for `direct_kinematics`")],
    );
    let chosen = asking(&names.join(","));
    let lacking = chosen.replace(item(module, "pub fn momentum("), "");
    let asked_for = (Required, "momentum: the module does not have it");
    tally.text(scara, "a function that is asked for", &lacking, &[asked_for]);
    let g = "pub fn gravity(";
    let short = [(Places, "gravity: its result does not have the 4 entries"), identities("equations_of_motion = (B, C, g)")];
    tally.module(scara, g, "-98.1, 0.0]", "-98.1]", &short);
    let beyond = module.replacen(T1, &format!("{T1}    let t9 = q[4];\n"), 1);
    let fault = || verify_with(&scara.source, &beyond, scara.claims.clone(), Effort::default()).first_fault();
    tally.peel("q[4]", &[(Indices, "index 4 is beyond the end of its argument")], Last::Refused("index out of bounds"), fault);
    let different = [
        (Modular, "inertia_matrix[0][1]: differs from the equations at point 1 modulo"),
        (Rational, "inertia_matrix[0][1]: differs from the equations at rational point 1"),
        identities("does not hold"),
    ];
    tally.module(scara, B, T1, &T1.replace("5.0", "-5.0"), &different);
    // Its degree is so high that it may vanish at all points; the degree bounds do not see that its base is 0.
    let squares: String = (0..200).map(|k| format!("let t{} = t{1} * t{1}; ", 901 + k, 900 + k)).collect();
    let high = edited(module, B, T1, &format!("{T1}    let t900 = 0.25 * c2 - 0.25 * c2; {squares}\n"));
    let high = edited(&high, B, "t1, -0.25", "t1, t1100 - 0.25");
    let said = "the documentation says `Cost: ";
    let layers = [(Odds, "inertia_matrix: the odds of a miss are"), (Cost, said)];
    tally.text(scara, "a high degree", &high, &layers);
}

fn floats(tally: &mut Tally, scara: &Given) {
    let said = "the documentation says `Cost: ";
    let comments = [(Cost, said), (Rounding, "the documentation says `Rounding error: ")];
    let entry = |tally: &mut Tally, given: &Given, text: &str, layers: &[Layer]| {
        tally.module(given, B, B11, &text.replace("B11", B11), &[layers, &comments].concat());
    };
    let leaves = (Leaves, "inertia_matrix: a value can leave f64 anywhere in the box");
    let (in_box, states) = ((Box, " in the box"), (States, "at a state of the box"));
    let divides = (Divisors, "it divides, which its equations do not ask for");
    entry(tally, scara, "(B11) * ((q[2] - 0.2) / (q[2] - 0.2))", &[divides]);
    let nowhere = (States, "inertia_matrix: a value can leave f64 at a state of the box");
    entry(tally, scara, "B11 + (1e200 * 1e200 - 1e200 * 1e200)", &[leaves, in_box, nowhere]);
    entry(tally, scara, "B11 + 1e300 - 1e300", &[in_box, states]);
    entry(tally, scara, "(B11) * (1e-200 * 1e-200) * 1e200 * 1e200", &[in_box, states]);
    entry(tally, scara, "B11 - 4.0 + (1e17 + 4.0 - 1e17)", &[in_box, states]);
    entry(tally, scara, "B11 + 1000000000.0 - 1000000000.0", &[in_box, states]);
    let shortest = (Shortest, "is not the shortest decimal of a float");
    let rounded = "B11 - 4.0 + (100000000000000004.0 - 100000000000000000.0)";
    entry(tally, scara, rounded, &[shortest, in_box, states]);
    let forward = |tally: &mut Tally, given: &Given, text: &str, layers: &[Layer]| {
        tally.module(given, "pub fn forward_dynamics(", "[t29,", &format!("[{text},"), &[layers, &comments].concat());
    };
    forward(tally, scara, "t29 + 1e17 - 1e17", &[(States, "forward_dynamics: rounding can make an error of")]);
    let reciprocal = |tally: &mut Tally, text: &str, layers: &[Layer]| {
        tally.module(scara, "pub fn forward_dynamics(", "(1.0 / t25)", text, layers);
    };
    let foreign = [(Divisors, "forward_dynamics: it divides by what is no pivot")];
    let scaled = "(9.313225746154785e-10 / (9.313225746154785e-10 * t25))";
    reciprocal(tally, scaled, &[&foreign[..], &comments].concat());
    let single = given("scara", &Options { scalar: Scalar::F32, ..Options::default() });
    let leaves = (States, "forward_dynamics: a value can leave f32 at a state of the box");
    forward(tally, &single, "t29 * 1e25 * 1e25 * 1e-25 * 1e-25", &[leaves]);
    forward(tally, &single, "t29 * 1e-25 * 1e-25 * 1e25 * 1e25", &[(States, "forward_dynamics: rounding can make an error of")]);
}

/// Signs of values that are 0 over the reals, and of a torque in two forms.
fn signs(tally: &mut Tally) {
    let load = given("load_friction", &Options::default());
    let said = "the documentation says `Cost: ";
    let comments = [(Cost, said), (Rounding, "the documentation says `Rounding error: ")];
    let twice = (SignsOnce, "it takes the sign of one torque in two forms");
    let entry = "44.145 * c3 - 25.48712763337603 * s3,";
    let other = [(LoadSigns, "gravity: it takes the sign of what is no gravity torque"), twice];
    let difference = "44.145 * c3 - 25.48712763337603 * s3 + 12.0 * (sign(c3 + c3) - sign(2.0 * c3)),";
    tally.module(&load, "pub fn gravity(", entry, difference, &[&other[..], &[(Cost, said)]].concat());
    let (torque, again) = ("(sign(t1) * t1)", "(sign(t1) * t1) + sign(t1) - sign(44.145 * c3 - 25.48712763337603 * s3)");
    tally.module(&load, "pub fn load_friction(", torque, again, &[&[twice][..], &comments].concat());
}

fn constants(tally: &mut Tally, scara: &Given) {
    let name = [(Robot, "the module is of the robot `other`"), (Constants, "NAME: is \"other\", not \"scara\"")];
    tally.module(scara, "pub const NAME", "scara", "other", &name);
    let module = &scara.module;
    let without = module.replace(item(module, "pub const EFFORT_LIMITS"), "");
    tally.text(scara, "no limits", &without, &[(ConstantsThere, "EFFORT_LIMITS: the module does not have it")]);
    base_parameters(tally, scara);
}

/// A module chooses names and exact values of base parameters within limits.
fn base_parameters(tally: &mut Tally, scara: &Given) {
    let twice = [(Modular, "column `Fm1` is no combination of the torques of"), (BaseNames, "`Fm1` stands there twice")];
    tally.module(scara, "const BASE_PARAMETER_NAMES", "\"Fm2\"", "\"Fm1\"", &twice);
    // Closer to the literal than any float, but not the value.
    let off = |given: &Given, constant: &str, entry: usize| {
        let mut certificate = given.certificate.clone();
        let values = certificate.constants.iter_mut().find(|c| c.name == constant).expect("values");
        values.literals[entry].1 += " + 1/10^30";
        certificate.claims().expect("formulas")
    };
    let claims = off(scara, "NOMINAL_BASE_PARAMETERS", 8);
    let layers = [
        (Modular, "with NOMINAL_BASE_PARAMETERS it does not give the torque, at point 1"),
        (Rational, "with NOMINAL_BASE_PARAMETERS it does not give the torque, at rational point 1"),
        (BaseValues, "is not the standard parameter `Fm2`"),
        (Identities, "Y_b pi_b = tau does not hold"),
    ];
    let fault = || verify_with(&scara.source, &scara.module, claims.clone(), Effort::default()).first_fault();
    tally.peel("a base parameter that is none", &layers, Last::Accepted, fault);
    let base_set = given("base_set", &Options::default());
    let claims = off(&base_set, "NOMINAL_PARAMETERS", 0);
    let layers = [
        (NominalParameters, "is not the combination of standard parameters that its name stands for"),
        (Identities, "Y pi + tau_known = tau does not hold"),
    ];
    let fault = || verify_with(&base_set.source, &base_set.module, claims.clone(), Effort::default()).first_fault();
    tally.peel("a parameter that is no combination", &layers, Last::Accepted, fault);
    let scara4 = given("scara4", &Options::default());
    let claims = off(&scara4, "NOMINAL_PARAMETERS", 0);
    let layers = [
        (NominalParameters, "is not the value that the bodies of the description give"),
        (Identities, "Y pi + tau_known = tau does not hold"),
    ];
    let fault = || verify_with(&scara4.source, &scara4.module, claims.clone(), Effort::default()).first_fault();
    tally.peel("a standard parameter that is not the bodies'", &layers, Last::Accepted, fault);
    // The second column twice, each with half of the value.
    let module = &scara.module;
    let at = module.find("pub fn base_regressor_into(").expect("the function");
    let last = "    result[3][10] = 400.0 * dq[3];\n";
    let column = ["t2 + 0.5 * t5", "t2", "0.0", "0.0"].iter().enumerate();
    let column: String = column.map(|(row, entry)| format!("    result[{row}][11] = {entry};\n")).collect();
    assert!(module[at..].contains(last));
    let text = module[at..].replacen(last, &(last.to_string() + &column), 1);
    let mut text = module[..at].to_string() + &text;
    for (old, new) in [
        ("BASE_PARAMETERS: usize = 11", "BASE_PARAMETERS: usize = 12"),
        ("    \"Fm4\",\n", "    \"Fm4\",\n    \"mcx2R\",\n"),
        ("    10.26,\n    5.0,\n", "    10.26,\n    2.5,\n"),
    ] {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    let text = edited(&text, "const NOMINAL_BASE_PARAMETERS", "    0.005,\n]", "    0.005,\n    2.5,\n]");
    let layers = [
        (Columns, "its column depends on those before it"),
        (BaseNames, "`mcx2R` stands there twice"),
        (Cost, "base_regressor: the documentation says `Cost: "),
    ];
    tally.text(scara, "a column twice", &text, &layers);
}

fn comments(tally: &mut Tally, scara: &Given) {
    let rounding = |why: &'static str| (Rounding, why);
    tally.module(scara, "", "(input ", "(input 0", &[(Head, "the head of the file: `@generated by armgen")]);
    let of_box = [(StatedBox, "the head of the file: `Box of the rounding errors")];
    tally.module(scara, "", "pi rad or 1 m", "1e-9 rad or 1 m", &of_box);
    let at = scara.module.find("pub fn gravity_with(").expect("a function");
    let bound = scara.module[..at].rfind("/// Rounding error: ").expect("its bound");
    let bound = scara.module[bound..].lines().next().expect("a line");
    let false_bound = "/// Rounding error: at most 9.3e-95 in any entry, over the box in the head of this file.";
    tally.module(scara, "", bound, false_bound, &[rounding("the documentation says `Rounding error: at most 9.3e-95")]);
}

fn certificates(tally: &mut Tally, scara: &Given) {
    let differs = |why: &'static str| (Differences, why);
    let of = |tally: &mut Tally, change: &dyn Fn(&mut Certificate), layers: &[Layer]| tally.certificate(scara, change, layers);
    of(tally, &|c| c.verified = false, &[differs("verified: false, the checker finds true")]);
    of(tally, &|c| c.functions[0].error_bound = "1e-300".into(), &[differs("error_bound: \"1e-300\", the checker finds")]);
    let change = |c: &mut Certificate| {
        c.functions[0].verdict = "DIFFERENT".into();
        c.faults.push("all is lost".into());
    };
    of(tally, &change, &[differs("faults: [\"all is lost\"], the checker finds []")]);
    of(tally, &|c| c.rounding_box.clear(), &[differs("rounding_box: {}")]);
    of(tally, &|c| c.certificate = 2, &[(Format, "the certificate has format 2"), differs("certificate: 2")]);
    let another = |place: &'static str, check: Check, why: &'static str| [(check, why), differs(place)];
    of(tally, &|c| c.input.sha256.replace_range(..1, "x"), &another("input.sha256", Input, "is of another description"));
    of(tally, &|c| c.output.sha256.replace_range(..1, "x"), &another("output.sha256", Output, "is of another module"));
    of(tally, &|c| c.functions.swap(0, 1), &another("functions[", Lists, "lists other functions or literals"));
    tally.certificate_text(scara, &(scara.certificate.to_json() + " "), Last::Accepted, &[(Form, "is not as armgen writes it")]);
    // In place of the exact values of 5.0, 8.766 and 10.0.
    let values = |new: [&str; 3]| {
        let mut certificate = scara.certificate.clone();
        let entry = certificate.functions.iter_mut().find(|entry| entry.name == "inertia_matrix").expect("it is there");
        for ((literal, value), new) in entry.literals.iter_mut().zip(new) {
            assert!(["5.0", "8.766", "10.0"].contains(&literal.as_str()));
            *value = new.into();
        }
        certificate.to_json()
    };
    let fits = [(Fits, "the literal 5.0 is not the float nearest to 6"), differs("functions[inertia_matrix].literals[")];
    tally.certificate_text(scara, &values(["6", "4383/500", "10"]), Last::Accepted, &fits);
    let powers = values(["5*(2^400)^50/(2^400)^50", "4383/500", "10"]);
    tally.certificate_text(scara, &powers, Last::NotTried, &[(Powers, "bits is no constant of a robot")]);
    let long = |value: &str| format!("{value}{}", "*1^400".repeat(33_000));
    let work = values([&long("5"), &long("4383/500"), &long("10")]);
    tally.certificate_text(scara, &work, Last::NotTried, &[(Work, "the formulas cost more than the constants of any robot")]);
}
