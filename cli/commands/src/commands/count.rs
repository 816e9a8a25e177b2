//! `armgen count`: operations of every emitted function.

use std::path::Path;

use armgen_codegen::pass::Pass;
use armgen_codegen::program::Cost;
use armgen_codegen::schedule::Options;
use serde_json::{json, Map, Value};

use crate::table::{Align, Table};
use crate::{input, terminal, CountFormat, FAULTY, UNREADABLE};

pub(crate) fn run(file: &Path, format: CountFormat, functions: &[String], without: Vec<Pass>) -> u8 {
    let Some(functions) = input::selection(functions) else { return UNREADABLE };
    let model = match input::model(file) {
        Ok(model) => model,
        Err(code) => return code,
    };
    let module = armgen_codegen::schedule::module(
        &model,
        &Options { functions: functions.clone(), without: without.into_iter().collect(), ..Options::default() },
    );
    if !input::all_there(&module.name, &module.absent, &functions) {
        return FAULTY;
    }
    let costs: Vec<(String, Cost, &str)> =
        module.functions.iter().map(|function| (function.name(), Cost::of(function), function.method)).collect();
    terminal::print(&match format {
        CountFormat::Text => text(&module.name, &costs),
        CountFormat::Json => json(&module.name, &costs),
    })
}

fn text(robot: &str, costs: &[(String, Cost, &str)]) -> String {
    use Align::{Left, Right};
    let mut table = Table::new([
        ("function", Left),
        ("mul", Right),
        ("add", Right),
        ("div", Right),
        ("neg", Right),
        ("sincos", Right),
        ("exp", Right),
        ("derived by", Left),
    ]);
    for (name, cost, method) in costs {
        let counts = [cost.mul, cost.add, cost.div, cost.neg, cost.sincos, cost.exp].map(|n| n.to_string());
        let [mul, add, div, neg, sincos, exp] = counts;
        table.row([name.clone(), mul, add, div, neg, sincos, exp, (*method).to_string()]);
    }
    format!("{robot}: operations of the emitted functions\n\n{}", table.text())
}

fn json(robot: &str, costs: &[(String, Cost, &str)]) -> String {
    let of = |c: &Cost| json!({"mul": c.mul, "add": c.add, "div": c.div, "neg": c.neg, "sincos": c.sincos, "exp": c.exp});
    let functions: Map<String, Value> = costs.iter().map(|(name, cost, _)| (name.clone(), of(cost))).collect();
    let text = serde_json::to_string_pretty(&json!({"robot": robot, "functions": functions}));
    text.expect("strings and numbers always have a JSON form") + "\n"
}
