//! `armgen count`: operations of every emitted function.

use std::path::Path;

use armgen_codegen::pass::Pass;
use armgen_codegen::program::Cost;
use armgen_codegen::schedule::Options;
use serde_json::{json, Map, Value};

use crate::table::{Align, Table};
use crate::{input, terminal, CountFormat, FAULTY, UNREADABLE};

pub(crate) fn run(file: &Path, format: CountFormat, functions: &[String], without: Vec<Pass>, fuse: bool) -> u8 {
    let Some(functions) = input::selection(functions) else { return UNREADABLE };
    let model = match input::model(file) {
        Ok(model) => model,
        Err(code) => return code,
    };
    let module = armgen_codegen::schedule::module(
        &model,
        &Options { functions: functions.clone(), without: without.into_iter().collect(), fuse, ..Options::default() },
    );
    if !input::all_there(&module.name, &module.absent, &functions) {
        return FAULTY;
    }
    let costs: Vec<(String, Cost, &str)> =
        module.functions.iter().map(|function| (function.name(), Cost::of(function), function.method)).collect();
    terminal::print(&match format {
        CountFormat::Text => text(&module.name, &costs, fuse),
        CountFormat::Json => json(&module.name, &costs, fuse),
    })
}

/// The counts of a function by name; fused operations only with `--fma`.
fn counts(cost: &Cost, fuse: bool) -> impl Iterator<Item = (&'static str, usize)> {
    let Cost { mul, add, fused, div, neg, sincos, exp } = *cost;
    let all = [("mul", mul), ("add", add), ("fused", fused), ("div", div), ("neg", neg), ("sincos", sincos), ("exp", exp)];
    all.into_iter().filter(move |(name, _)| fuse || *name != "fused")
}

fn text(robot: &str, costs: &[(String, Cost, &str)], fuse: bool) -> String {
    let names = counts(&Cost::default(), fuse).map(|(name, _)| (name, Align::Right));
    let mut table = Table::new([("function", Align::Left)].into_iter().chain(names).chain([("derived by", Align::Left)]));
    for (name, cost, method) in costs {
        let counts = counts(cost, fuse).map(|(_, count)| count.to_string());
        table.row([name.clone()].into_iter().chain(counts).chain([(*method).to_string()]));
    }
    format!("{robot}: operations of the emitted functions\n\n{}", table.text())
}

fn json(robot: &str, costs: &[(String, Cost, &str)], fuse: bool) -> String {
    let of =
        |cost: &Cost| counts(cost, fuse).map(|(name, count)| (name.to_string(), json!(count))).collect::<Map<String, Value>>();
    let functions: Map<String, Value> = costs.iter().map(|(name, cost, _)| (name.clone(), Value::Object(of(cost)))).collect();
    let text = serde_json::to_string_pretty(&json!({"robot": robot, "functions": functions}));
    text.expect("strings and numbers always have a JSON form") + "\n"
}
