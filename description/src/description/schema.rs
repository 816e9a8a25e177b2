//! The JSON Schema of a description (draft 7), for editors: made from the tables of `keys.rs`, which the reader of files uses, too.
//!
//! The schema accepts every file that armgen accepts. It knows keys, kinds of values, words, lengths of lists and the grammar of
//! expressions. Names, signs and sums are left to [`validate`](crate::validate).

use std::borrow::Borrow;

use serde_json::{json, Map, Value};

use super::keys::{Entry, Shape, CONVENTIONS, GRAVITY, JOINT, MOST_POSES, POSE, REGRESSORS, ROBOT, ROTATIONS, TIP, URDF_JOINT};
use super::units::KEYS;
use super::Convention;
use crate::diagnostic::{Code, Severity};
use crate::document::reader::Key;
use crate::document::MAX_EXPRESSION;
use crate::kinds::{TaskRow, MAX_JOINTS, MAX_TIPS};

/// The characters of ASCII that no identifier begins with.
const NO_START: &str = r"\u0000-@\[-\^`{-\u007f";
/// The characters of ASCII that no identifier contains.
const NO_PART: &str = r"\u0000-/:-@\[-\^`{-\u007f";
/// Signs beyond ASCII that are neither letters nor digits, among them those that texts are pasted with: ° × ÷ − √.
const SIGNS: &str = r"\u0080-\u00a9\u00ab-\u00b1\u00b4\u00b6-\u00b8\u00bb\u00bf\u00d7\u00f7\u2000-\u206f\u2200-\u22ff";

/// The schema as a text.
pub fn text() -> String {
    serde_json::to_string_pretty(&schema()).expect("a tree of texts and numbers") + "\n"
}

/// The schema.
pub fn schema() -> Value {
    let mut definitions = Map::new();
    let mut rules = Vec::new();
    for (name, rows, of_urdf) in [("row", JOINT, false), ("frame", URDF_JOINT, true)] {
        let conventions = CONVENTIONS.iter().filter(|(_, convention)| (*convention == Convention::Urdf) == of_urdf);
        let words: Vec<&str> = conventions.map(|(word, _)| *word).collect();
        let mut joint = mapping(rows, &mut definitions);
        joint["not"] = json!({ "required": ["follows", "adds"] });
        let of_rates = ["load", "stribeck", "smooth"].map(|key| json!({ "required": [key] }));
        joint["dependencies"] = json!({
            "offset": { "anyOf": [{ "required": ["follows"] }, { "required": ["adds"] }] },
            "follows": { "properties": { "friction": { "not": { "anyOf": of_rates } } } },
        });
        definitions.insert(name.into(), joint);
        rules.push(json!({
            "if": { "properties": { "convention": { "enum": words } }, "required": ["convention"] },
            "then": { "properties": { "joints": { "items": { "$ref": reference(name) } } } },
        }));
    }
    let mut root = mapping(ROBOT, &mut definitions);
    definitions["motor"]["dependencies"] = json!({ "on": ["axis"] });
    let pose = mapping(POSE, &mut definitions);
    definitions.insert("pose".into(), pose);
    definitions.insert(
        "poses".into(),
        json!({ "anyOf": [
            { "$ref": reference("pose") },
            { "type": "array", "items": { "$ref": reference("pose") }, "maxItems": MOST_POSES },
        ] }),
    );
    definitions.insert(
        "expression".into(),
        json!({ "anyOf": [
            { "type": "number", "minimum": f64::MIN, "maximum": f64::MAX },
            { "type": "string", "maxLength": MAX_EXPRESSION, "pattern": expression() },
        ] }),
    );
    definitions.insert("name".into(), json!({ "type": "string", "pattern": format!("^[^{NO_START}][^{NO_PART}]*$") }));
    // A named end effector has the keys of the single one.
    let of_tip = ["tip", "tool", "payload", "task", "inverse_kinematics"];
    let beside = of_tip.map(|key| json!({ "required": ["tips", key] }));
    let about = [
        ("not", json!({ "anyOf": beside })),
        ("$schema", json!("http://json-schema.org/draft-07/schema#")),
        ("title", json!("robot.yaml of armgen")),
        ("description", json!("A robot arm: joints, links, drives.")),
        ("allOf", json!(rules)),
        ("definitions", json!(definitions)),
    ];
    for (key, value) in about {
        root[key] = value;
    }
    root
}

fn reference(definition: &str) -> String {
    format!("#/definitions/{definition}")
}

/// The regular expression of the grammar of `document::expression`, parentheses without their pairs.
fn expression() -> String {
    let name = format!("[^{NO_START}{SIGNS}][^{NO_PART}{SIGNS}]*");
    let blanks = r"[\s\u0085]*";
    let before = format!(r"(?:[-+(]{blanks}|(?:deg|sqrt){blanks}\({blanks})*");
    let atom = format!(r"(?:(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|{name})");
    let behind = format!(r"(?:{blanks}\))*");
    let operand = format!("{before}{atom}{behind}");
    format!("^{blanks}{operand}(?:{blanks}[-+*/]{blanks}{operand})*{blanks}$")
}

/// A mapping of these keys and no others.
fn mapping(entries: &[Entry], definitions: &mut Map<String, Value>) -> Value {
    let key = |entry: &Entry| -> Key { *entry.borrow() };
    let mut properties = Map::new();
    for entry in entries {
        properties.insert(key(entry).name.into(), property(entry, definitions));
    }
    let required: Vec<&str> = entries.iter().map(key).filter(|key| key.required).map(|key| key.name).collect();
    let mut object = json!({ "type": "object", "additionalProperties": false, "properties": properties });
    if !required.is_empty() {
        object["required"] = json!(required);
    }
    if ROTATIONS.iter().all(|name| entries.iter().any(|entry| key(entry).name == *name)) {
        let pairs = ROTATIONS.iter().enumerate().flat_map(|(i, first)| ROTATIONS[..i].iter().map(move |second| [second, first]));
        let two: Vec<Value> = pairs.map(|pair| json!({ "required": pair })).collect();
        object["not"] = json!({ "anyOf": two });
        object["dependencies"] = json!({ "axis": ["angle"], "angle": ["axis"] });
    }
    object
}

fn property(entry: &Entry, definitions: &mut Map<String, Value>) -> Value {
    let mut unit = "";
    let number = json!({ "$ref": reference("expression") });
    let name = json!({ "$ref": reference("name") });
    let mut define = |name: &str, keys: &'static [Entry]| {
        if !definitions.contains_key(name) {
            let object = mapping(keys, definitions);
            definitions.insert(name.into(), object);
        }
        json!({ "$ref": reference(name) })
    };
    let mut value = match entry.shape {
        Shape::Name => name,
        Shape::RobotName => json!({ "anyOf": [name, { "type": "boolean" }] }),
        Shape::Text => json!({ "type": ["string", "number", "boolean"] }),
        Shape::Word(words) => json!({ "enum": words }),
        Shape::Expression(of) => {
            unit = of;
            number
        }
        Shape::Vector(length, of) => {
            unit = of;
            json!({ "type": "array", "items": number, "minItems": length, "maxItems": length })
        }
        Shape::Gravity => {
            unit = "m/s²";
            let vector = json!({ "type": "array", "items": number, "minItems": 3, "maxItems": 3 });
            json!({ "anyOf": [vector, define("gravity", GRAVITY)] })
        }
        Shape::Mapping(name, keys) => define(name, keys),
        Shape::List(name, keys) => json!({ "type": "array", "items": define(name, keys) }),
        Shape::Pose => json!({ "$ref": reference("poses") }),
        Shape::Parameters => json!({ "type": "object", "propertyNames": name, "additionalProperties": number }),
        Shape::Factors => {
            let factor = json!({ "allOf": [number], "not": { "const": 0 } });
            json!({ "type": "object", "minProperties": 1, "propertyNames": name, "additionalProperties": factor })
        }
        Shape::Units => {
            let unit = |examples: &str, si: &str| json!({ "type": "string", "description": format!("Units: {examples}. Without it: {si}.") });
            let keys = KEYS.iter().map(|key| (key.name.to_owned(), unit(key.examples, key.si))).collect::<Map<_, _>>();
            json!({ "type": "object", "additionalProperties": false, "properties": keys })
        }
        Shape::Joints => json!({ "type": "array", "minItems": 1, "maxItems": MAX_JOINTS, "items": { "type": "object" } }),
        Shape::Tips => json!({ "type": "array", "minItems": 1, "maxItems": MAX_TIPS, "items": define("tip", TIP) }),
        Shape::Task => {
            let rows = TaskRow::ALL.map(TaskRow::name);
            json!({ "type": "array", "minItems": 1, "uniqueItems": true, "items": { "enum": rows } })
        }
        Shape::Regressor => json!({ "anyOf": [
            { "enum": REGRESSORS },
            { "type": "array", "minItems": 1, "uniqueItems": true, "items": name },
        ] }),
        Shape::Warnings => {
            let warnings =
                Code::ALL.iter().filter(|code| code.severity() == Severity::Warning || **code == Code::ImpossibleInertia);
            json!({ "type": "array", "items": { "enum": warnings.map(|code| code.name()).collect::<Vec<_>>() } })
        }
    };
    let stated = if unit.is_empty() { entry.about.to_owned() } else { format!("{} Unit: {unit}.", entry.about) };
    value["description"] = json!(stated);
    value
}

#[cfg(test)]
mod tests;
