//! The schema against armgen itself: on the descriptions of the repository, on mutants of them, and on expressions drawn at random.
//!
//! Python's `jsonschema` judges: an implementation that editors' own agree with. The crates for it bring an engine of regular
//! expressions, which takes longer to compile than all of these tests.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::{json, Map, Value};

use crate::diagnostic::Diagnostics;
use crate::document::yaml::{self, Kind, Node, Scalar};
use crate::source::Source;
use crate::validate;

#[path = "../../../../tests/src/installed.rs"]
mod installed;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn the_stored_schema_is_the_printed_one() {
    let path = root().join("docs/robot.schema.json");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        fs::write(&path, super::text()).expect("the schema is written");
    }
    let stored = fs::read_to_string(&path).unwrap_or_default();
    assert!(stored == super::text(), "the schema has changed: armgen schema > docs/robot.schema.json");
}

/// Every property of the schema has a meaning, and every definition that it names exists.
#[test]
fn every_key_has_a_meaning() {
    fn walk(value: &Value, schema: &Value) {
        if let Some(reference) = value.get("$ref").and_then(Value::as_str) {
            assert!(schema.pointer(&reference[1..]).is_some(), "{reference}");
        }
        for (name, property) in value.get("properties").and_then(Value::as_object).into_iter().flatten() {
            let conditional = property.get("enum").is_some() && property.get("description").is_none() && name == "convention";
            // A rule on what another key holds; that has its meaning where it is declared.
            let refined = property.get("not").is_some() && property.get("description").is_none() && name == "friction";
            let about = property["description"].as_str().unwrap_or_default();
            assert!(conditional || refined || property.get("items").is_some() || about.ends_with('.'), "{name}: {property}");
        }
        match value {
            Value::Object(entries) => entries.values().for_each(|value| walk(value, schema)),
            Value::Array(items) => items.iter().for_each(|value| walk(value, schema)),
            _ => {}
        }
    }
    let schema = super::schema();
    walk(&schema, &schema);
}

/// The verdicts of the schema; `None` without Python's `jsonschema`.
fn verdicts(instances: &[Value]) -> Option<Vec<bool>> {
    const SCRIPT: &str = "import json, sys
from jsonschema import Draft7Validator
given = json.load(sys.stdin)
Draft7Validator.check_schema(given['schema'])
schema = Draft7Validator(given['schema'])
json.dump([schema.is_valid(instance) for instance in given['instances']], sys.stdout)";
    if !installed::runs("python3", &["-c", "import jsonschema"]) {
        installed::left_out("no Python with `jsonschema` here (Debian: python3-jsonschema)");
        return None;
    }
    let mut python =
        Command::new("python3").args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("python3 runs");
    let given = json!({ "schema": super::schema(), "instances": instances }).to_string();
    python.stdin.take().expect("a pipe").write_all(given.as_bytes()).expect("python3 reads all");
    let output = python.wait_with_output().expect("python3 ends");
    let found: Vec<bool> = serde_json::from_slice(&output.stdout).expect("a list of verdicts");
    assert_eq!(found.len(), instances.len());
    Some(found)
}

/// A scalar as editors read it: the core schema of YAML 1.2. Infinities and NaN, which JSON does not have, become null.
fn scalar(scalar: &Scalar) -> Value {
    let text = scalar.text.as_str();
    if !scalar.plain {
        return json!(text);
    }
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let begins = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
    let is_number = begins(unsigned) || unsigned.strip_prefix('.').is_some_and(begins);
    match text {
        _ if scalar.is_nothing() => Value::Null,
        "true" | "True" | "TRUE" => json!(true),
        "false" | "False" | "FALSE" => json!(false),
        _ if matches!(unsigned.to_ascii_lowercase().as_str(), ".inf" | ".nan") => Value::Null,
        _ => match text.parse::<f64>() {
            Ok(number) if is_number => json!(number),
            _ => json!(text),
        },
    }
}

fn instance(node: &Node) -> Value {
    match &node.kind {
        Kind::Scalar(text) => scalar(text),
        Kind::List(items) => items.iter().map(instance).collect(),
        Kind::Mapping(entries) => {
            Value::Object(entries.iter().map(|(key, value)| (key.value.clone(), instance(value))).collect::<Map<_, _>>())
        }
    }
}

/// A text, whether armgen accepts it, and the instance that the schema judges, unless the text is no YAML.
struct Case {
    text: String,
    accepted: bool,
    instance: Option<Value>,
}

impl Case {
    fn of(text: String) -> Case {
        let source = Source::new("robot.yaml", text.clone());
        let tree = yaml::read(&source, &mut Diagnostics::new());
        let (arm, diagnostics) = validate::structure(&source, crate::kinds::Scalar::F64).finish();
        let accepted = arm.is_some() && !diagnostics.has_errors();
        Case { text, accepted, instance: tree.as_ref().map(instance) }
    }
}

/// No false alarm; the share of the faulty texts that the schema refuses.
#[track_caller]
fn compared(cases: &[Case]) -> Option<(usize, usize)> {
    let judged: Vec<&Case> = cases.iter().filter(|case| case.instance.is_some()).collect();
    let found = verdicts(&judged.iter().filter_map(|case| case.instance.clone()).collect::<Vec<_>>())?;
    for (case, valid) in judged.iter().zip(&found) {
        assert!(*valid || !case.accepted, "a false alarm:\n{}", case.text);
    }
    let faulty = judged.iter().zip(&found).filter(|(case, _)| !case.accepted);
    Some((faulty.clone().filter(|(_, valid)| !**valid).count(), faulty.count()))
}

fn files(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(root().join(folder)).expect("a folder of the repository");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    paths.sort();
    paths.iter().map(|path| fs::read_to_string(path).expect("a description")).collect()
}

fn robots() -> Vec<String> {
    let mut texts = vec![fs::read_to_string(root().join("robot.yaml")).expect("a description")];
    ["robots", "tests/robots", "tests/robots/hostile", "tests/data"].iter().for_each(|folder| texts.extend(files(folder)));
    texts
}

#[test]
fn files_of_the_repository() {
    let cases: Vec<Case> = robots().into_iter().chain(files("tests/bad")).map(Case::of).collect();
    assert!(cases.iter().filter(|case| case.accepted).count() >= 50);
    let Some((refused, faulty)) = compared(&cases) else { return };
    println!("of {faulty} faulty files the schema refuses {refused}");
    assert!(2 * refused >= faulty, "{refused} of {faulty}");
}

/// The generator SplitMix64 of Steele, Lea and Flood (2014).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n as u64) as usize
    }

    fn of<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.below(choices.len())]
    }
}

/// The tree as YAML in one line.
fn written(node: &Node) -> String {
    match &node.kind {
        Kind::Scalar(scalar) => {
            let plain = |c: char| c.is_ascii_alphanumeric() || "_.+-~".contains(c);
            match scalar.plain && scalar.text.chars().all(plain) {
                true => scalar.text.clone(),
                false => json!(scalar.text).to_string(),
            }
        }
        Kind::List(items) => format!("[{}]", items.iter().map(written).collect::<Vec<_>>().join(", ")),
        Kind::Mapping(entries) => {
            let entry =
                |(key, value): &(crate::source::Spanned<String>, Node)| format!("{}: {}", json!(key.value), written(value));
            format!("{{{}}}", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
        }
    }
}

/// Every node below this one, itself included.
fn nodes<'n>(node: &'n mut Node, at: &mut usize, change: &mut dyn FnMut(&'n mut Node)) -> bool {
    if *at == 0 {
        change(node);
        return true;
    }
    *at -= 1;
    match &mut node.kind {
        Kind::Scalar(_) => false,
        Kind::List(items) => items.iter_mut().any(|item| nodes(item, at, change)),
        Kind::Mapping(entries) => entries.iter_mut().any(|(_, value)| nodes(value, at, change)),
    }
}

fn count(node: &Node) -> usize {
    1 + match &node.kind {
        Kind::Scalar(_) => 0,
        Kind::List(items) => items.iter().map(count).sum(),
        Kind::Mapping(entries) => entries.iter().map(|(_, value)| count(value)).sum(),
    }
}

fn plain(text: &str) -> Kind {
    Kind::Scalar(Scalar { text: text.into(), plain: true, verbatim: None })
}

/// One slip of a hand: a lost, misspelt or repeated key or element, or a value of another kind.
fn slip(node: &mut Node, random: &mut Random) {
    let other = |random: &mut Random| match random.below(4) {
        0 => Kind::List(vec![Node { span: crate::source::Span::default(), alias: None, kind: plain("1") }]),
        1 => Kind::Mapping(Vec::new()),
        2 => plain("~"),
        _ => plain(random.of(&["true", "on", "0.1.2", "1,5", "5 mm", "2^3", "2 pi", "3*", "-", "(1", "1e400", ".nan", "word"])),
    };
    node.kind = match std::mem::replace(&mut node.kind, plain("")) {
        Kind::Mapping(mut entries) if !entries.is_empty() && random.below(6) > 0 => {
            let at = random.below(entries.len());
            match random.below(3) {
                0 => drop(entries.remove(at)),
                1 => drop(entries[at].0.value.pop()),
                _ => {
                    entries[at].0.value =
                        random.of(&["mass", "axis", "angle", "a", "origin", "quat", "limits", "note", "name"]).into()
                }
            }
            Kind::Mapping(entries)
        }
        Kind::List(mut items) if !items.is_empty() && random.below(6) > 0 => {
            let at = random.below(items.len());
            match random.below(2) {
                0 => drop(items.remove(at)),
                _ => items.insert(at, items[at].clone()),
            }
            Kind::List(items)
        }
        Kind::Scalar(scalar) if random.below(3) == 0 => plain(&format!("-{}", scalar.text)),
        _ => other(random),
    };
}

/// 400 descriptions with a slip.
fn mutated() -> Vec<Case> {
    let mut random = Random(42);
    let robots = robots();
    let mut cases = Vec::new();
    while cases.len() < 400 {
        let text = &robots[random.below(robots.len())];
        let Some(mut tree) = yaml::read(&Source::new("robot.yaml", text.clone()), &mut Diagnostics::new()) else { continue };
        let mut at = random.below(count(&tree));
        nodes(&mut tree, &mut at, &mut |node| slip(node, &mut random));
        cases.push(Case::of(written(&tree)));
    }
    let accepted = cases.iter().filter(|case| case.accepted).count();
    assert!((20..300).contains(&accepted), "{accepted}");
    cases
}

/// Whatever armgen accepts of 400 mutants the schema accepts, and it refuses at least half of the faulty ones.
#[test]
fn mutants() {
    let Some((refused, faulty)) = compared(&mutated()) else { return };
    println!("of {faulty} faulty mutants the schema refuses {refused}");
    assert!(2 * refused >= faulty, "{refused} of {faulty}");
}

/// The same in an editor, and every description of the repository: yaml-language-server marks nothing that armgen accepts.
#[test]
#[ignore = "wide"]
fn mutants_in_an_editor() {
    if !installed::there("node", "nodejs") {
        return;
    }
    if !installed::runs("sh", &["-c", "command -v yaml-language-server"]) {
        return installed::left_out("no `yaml-language-server` here (npm install --global yaml-language-server)");
    }
    let cases: Vec<Case> = mutated().into_iter().chain(robots().into_iter().map(Case::of)).collect();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/src/description/schema/editor.mjs");
    let mut node = Command::new("node").arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("node runs");
    let texts: Vec<&str> = cases.iter().map(|case| case.text.as_str()).collect();
    let given = json!({ "schema": super::schema(), "texts": texts }).to_string();
    node.stdin.take().expect("a pipe").write_all(given.as_bytes()).expect("node reads all");
    let output = node.wait_with_output().expect("node ends");
    let marked: Vec<bool> = serde_json::from_slice(&output.stdout).expect("a list of verdicts");
    assert_eq!(marked.len(), cases.len());
    for (case, marked) in cases.iter().zip(&marked) {
        assert!(!marked || !case.accepted, "a false alarm in the editor:\n{}", case.text);
    }
    let faulty: Vec<bool> = cases.iter().zip(&marked).filter(|(case, _)| !case.accepted).map(|(_, marked)| *marked).collect();
    let seen = faulty.iter().filter(|marked| **marked).count();
    println!("of {} faulty texts the editor marks {seen}", faulty.len());
    assert!(2 * seen >= faulty.len(), "{seen} of {}", faulty.len());
}

/// Texts of the grammar, one in two of them with a character changed: each that armgen reads fits the pattern.
#[test]
fn expressions() {
    let mut random = Random(7);
    let parts = [
        "pi", "deg(", "sqrt (", "(", ")", ")", "+", "-", "*", "/", "1", ".5", "2.", "1e-3", " ", "\t", "l", "m_1", "\u{e4}",
        "\u{a0}",
    ];
    let mut read = 0;
    let mut cases = Vec::new();
    for _ in 0..1000 {
        let text: String = (0..1 + random.below(7)).map(|_| random.of(&parts)).collect();
        let robot = format!(
            "{{name: a, convention: standard, gravity: [0, 0, -9.81], parameters: {{l: 1, m_1: 1, \u{e4}: 1}}, joints: [{{name: j, type: revolute, a: {}, alpha: 0, d: 0, theta: 0, link: {{mass: 1}}}}]}}",
            json!(text)
        );
        let node = Scalar { text, plain: false, verbatim: None };
        let Ok(_) = crate::document::parse_expression(&node, crate::source::Span::default()) else {
            cases.push(Case::of(robot));
            continue;
        };
        read += 1;
        // A value that is refused for its size or sign is an expression all the same.
        cases.push(Case { accepted: true, ..Case::of(robot) });
    }
    assert!(read > 50, "{read}");
    let Some((refused, faulty)) = compared(&cases) else { return };
    println!("of {faulty} texts that are no expressions the schema refuses {refused}; {read} are expressions");
    assert!(10 * refused >= 8 * faulty, "{refused} of {faulty}");
}
