//! The test file in other languages than Rust: the reference values in the notation of the language, then the part common to all robots.

use std::fmt::Write;

use armgen_description::{language::Language, origin::Origin};

use super::{list, Kit, Value};
use crate::read::marked::{marked, LOAD, PAYLOAD};
use crate::read::reader::{camel, in_the_name_of};
use crate::values::contract::Length;
use crate::values::enclosure::Float;
use crate::values::float::Arguments;
use crate::values::program::Argument;

/// The template of a language, after its line BEGIN; `sign` begins a comment.
fn template(text: &'static str, sign: &str, kit: &Kit) -> String {
    let template = text.split_once("BEGIN").and_then(|(_, rest)| rest.split_once('\n')).map_or("", |(_, rest)| rest);
    let template = marked(template, sign, &[(LOAD, kit.loaded), (PAYLOAD, kit.carries)]);
    match sign {
        "//" => kit.with_gravity(template, &|name| format!("robot.{}(", camel(name)), "[1.5, -2.25, 9.5]"),
        "#" => kit.with_gravity(template, &|name| format!("robot.{name}("), "np.array([1.5, -2.25, 9.5])"),
        "%" => kit.with_gravity(template, &|name| format!("robot.{}(", camel(name)), "[1.5; -2.25; 9.5]"),
        _ => kit.with_gravity(template, &|name| format!("robot_{name}("), "free_fall"),
    }
}

/// Arguments by name.
fn named(state: &Arguments<f64>) -> Vec<(&'static str, &[f64])> {
    let Arguments { q, dq, ddq, dqr, ddqr, tau, pi, g0 } = state;
    let all: [(_, &[f64]); 8] =
        [("q", q), ("dq", dq), ("ddq", ddq), ("dqr", dqr), ("ddqr", ddqr), ("tau", tau), ("pi", pi), ("g0", g0)];
    all.into_iter().filter(|(name, entries)| *name != "g0" || !entries.is_empty()).collect()
}

/// The test file; `module` is the name of the imported file, module or package.
pub(super) fn print(kit: &Kit, language: Language, module: &str, origin: &Origin) -> String {
    let mark = match language {
        Language::C | Language::Cuda | Language::JavaScript | Language::Rust => "//",
        Language::Python => "#",
        Language::Matlab => "%",
    };
    let said = [
        format!(
            "Tests of the robot `{}` on your machine: reference values, computed from its equations in 256 bits, and the",
            kit.robot
        ),
        format!("identities of its dynamics. Written by {}.", origin.made_by()),
    ];
    let commented: String = said.iter().map(|line| format!("{mark} {line}\n")).collect();
    match language {
        Language::Rust => String::new(),
        Language::C | Language::Cuda => format!("/*\n * {}\n */\n{}", said.join("\n * "), c(kit, module)),
        Language::JavaScript => commented + &javascript(kit, module),
        Language::Python => commented + &python(kit, module),
        Language::Matlab => matlab(kit, module, &commented),
    }
}

/// The arguments of a call, each written by `of_state`.
fn arguments(kit: &Kit, value: &Value, of_state: &dyn Fn(&str) -> String) -> String {
    let arguments = value.promise.arguments_of(value.with, kit.sizes.gravity);
    arguments.into_iter().map(|argument| of_state(argument.name())).collect::<Vec<_>>().join(", ")
}

fn javascript(kit: &Kit, module: &str) -> String {
    let mut text = format!(
        "\nimport assert from \"node:assert/strict\";\nimport test from \"node:test\";\n\nimport * as robot from {:?};\n\n\
         /** States at which values are known. */\nconst STATES = [\n",
        format!("./{module}")
    );
    for state in &kit.states {
        let fields: Vec<String> =
            named(state).iter().map(|(name, values)| format!("{name}: [{}]", list(values, kit.real))).collect();
        let _ = writeln!(text, "    {{ {} }},", fields.join(", "));
    }
    text +=
        "];\n\n/** Function, number of the state, value on this machine, value from the equations. */\nconst values = () => [\n";
    for value in &kit.values {
        let (name, state) = (camel(&value.name), value.state);
        let call = format!("robot.{name}({})", arguments(kit, value, &|name| format!("STATES[{state}].{name}")));
        let _ = writeln!(text, "    [\"{name}\", {state}, {call}, [{}]],", list(&value.entries, kit.real));
    }
    text + "];\n\n" + &template(include_str!("template.mjs"), "//", kit)
}

fn python(kit: &Kit, module: &str) -> String {
    let identifier =
        module.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && !module.starts_with(|c: char| c.is_ascii_digit());
    let import = match identifier {
        true => format!("import {module} as robot"),
        false => format!("import importlib\n\nrobot = importlib.import_module({module:?})"),
    };
    let mut text = format!("\n{import}\n\n# States at which values are known.\nSTATES = [\n");
    for state in &kit.states {
        let fields: Vec<String> =
            named(state).iter().map(|(name, values)| format!("\"{name}\": [{}]", list(values, kit.real))).collect();
        let _ = writeln!(text, "    {{{}}},", fields.join(", "));
    }
    text += "]\n\n\ndef values():\n    \"\"\"Function, number of the state, value on this machine, value from the equations.\"\"\"\n    return [\n";
    for value in &kit.values {
        let (name, state) = (&value.name, value.state);
        let call = format!("robot.{name}({})", arguments(kit, value, &|name| format!("STATES[{state}][\"{name}\"]")));
        let _ = writeln!(text, "        (\"{name}\", {state}, {call}, [{}]),", list(&value.entries, kit.real));
    }
    text + "    ]\n\n\n" + &template(include_str!("template.py"), "#", kit)
}

fn matlab(kit: &Kit, module: &str, comment: &str) -> String {
    let column = |values: &[f64]| list(values, kit.real).replace(", ", "; ");
    let mut text = format!("function {module}Test()\n{comment}");
    for (name, _) in named(&kit.states[0]) {
        let columns: Vec<String> = kit
            .states
            .iter()
            .filter_map(|state| named(state).into_iter().find(|(other, _)| *other == name))
            .map(|(_, values)| format!("[{}]", column(values)))
            .collect();
        let _ = writeln!(text, "    states.{name} = [{}];", columns.join(", "));
    }
    for value in &kit.values {
        let (name, state) = (camel(&value.name), value.state + 1);
        let call = format!("{module}.{name}({})", arguments(kit, value, &|name| format!("states.{name}(:, {state})")));
        let results: Vec<String> = (1..=value.promise.returned.named().len()).map(|k| format!("r{k}")).collect();
        let found: Vec<String> = results.iter().map(|result| format!("byRows({result})")).collect();
        let _ = writeln!(text, "    [{}] = {call};", results.join(", "));
        let _ = writeln!(text, "    compare('{name}', {state}, [{}], [{}]);", found.join("; "), column(&value.entries));
    }
    text + &template(include_str!("template.m"), "%", kit).replace("robot.", &format!("{module}."))
}

fn c(kit: &Kit, module: &str) -> String {
    let suffix = if kit.real == Float::F32 { "f" } else { "" };
    let numbers = |values: &[f64]| {
        let all: Vec<String> = list(values, kit.real).split(", ").map(|number| format!("{number}{suffix}")).collect();
        all.join(", ")
    };
    let epsilon = if kit.real == Float::F32 { "FLT_EPSILON" } else { "DBL_EPSILON" };
    let mut text = format!("#include <float.h>\n#include <stdio.h>\n\n#include {module:?}\n\n#define EPSILON {epsilon}\n\n/* States at which values are known. */\n");
    // Base parameters are omitted, because the functions without them are tested.
    let with = kit.values.iter().any(|value| value.with);
    for (name, _) in named(&kit.states[0]).into_iter().filter(|(name, _)| with || *name != "pi") {
        let length = of_macro(Argument::named(name).map_or(Length::Dof, Argument::length), kit);
        let rows = kit.states.iter().filter_map(|state| named(state).into_iter().find(|(other, _)| *other == name));
        let rows: Vec<String> = rows.map(|(_, values)| format!("{{{}}}", numbers(values))).collect();
        let _ = writeln!(text, "static const robot_real state_{name}[{}][{length}] = {{{}}};", kit.states.len(), rows.join(", "));
    }
    if kit.sizes.gravity {
        let _ = writeln!(text, "static const robot_real free_fall[3] = {{{}}};", numbers(&[1.5, -2.25, 9.5]));
    }
    text += "\nstatic void values(void);\n\n";
    let template = template(include_str!("template.c"), "/*", kit);
    let (before_main, main) = template.split_once("int main(void)").unwrap_or_default();
    text += before_main;
    text += "/* Values on this machine and from the equations. */\nstatic void values(void)\n{\n";
    for (state, _) in kit.states.iter().enumerate() {
        let _ = writeln!(text, "    at(state_q[{state}], state_dq[{state}], state_ddq[{state}], state_tau[{state}]);");
    }
    for value in &kit.values {
        let (name, state) = (&value.name, value.state);
        let mut call = arguments(kit, value, &|name| format!("state_{name}[{state}]"));
        let parts = value.promise.returned.named();
        let number = parts.len() == 1 && parts[0].1.is_empty();
        let mut at = 0;
        for (_, lengths) in parts.iter().filter(|_| !number) {
            let inner: String = lengths.iter().skip(1).map(|&length| format!("[{}]", of_macro(length, kit))).collect();
            let place = if at == 0 { "found".to_string() } else { format!("found + {at}") };
            let _ = if inner.is_empty() { write!(call, ", {place}") } else { write!(call, ", (robot_real (*){inner})({place})") };
            at += lengths.iter().map(|length| length.of(&kit.sizes)).product::<usize>();
        }
        let call = format!("{}robot_{name}({call});", if number { "found[0] = " } else { "" });
        // An inverse loses accuracy in proportion to the condition number of its matrix.
        let inverse = name == "operational_inertia" || name.starts_with("forward_dynamics");
        let lost = if inverse { "256 * ROUNDING" } else { "ROUNDING" };
        let entries = value.entries.len();
        let _ = writeln!(text, "    {{\n        static const robot_real expected[{entries}] = {{{}}};", numbers(&value.entries));
        let _ = writeln!(text, "        static robot_real found[{entries}];\n        {call}");
        let _ = writeln!(text, "        agree(\"{name} at state {state}\", {entries}, found, expected, {lost});\n    }}");
    }
    text += "}\n\nint main(void)";
    text += main;
    in_the_name_of(&kit.robot, &text)
}

fn of_macro(length: Length, kit: &Kit) -> String {
    match length.in_module(&kit.sizes) {
        Length::Of(value) => value.to_string(),
        named => format!("ROBOT_{}", named.rust()),
    }
}
