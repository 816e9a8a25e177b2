//! docs/certificate.md is correct: each production has a module that violates it, and the checker refuses each with the documented message.

use crate::common;

use armgen_codegen::kinds::Scalar;
use armgen_verify::read::reader::Module;

fn page() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/certificate.md")).expect("the page")
}

/// Rows of the table: production, replaced text, replacement, message.
fn rows(page: &str) -> Vec<[String; 4]> {
    let cell = |text: &str| text.trim().to_string();
    let code = |text: &str| text.trim().strip_prefix('`').and_then(|text| text.strip_suffix('`')).expect("code").to_string();
    page.lines()
        .skip_while(|line| !line.starts_with("| production "))
        .skip(2)
        .map_while(|line| line.strip_prefix("| ")?.strip_suffix(" |"))
        .map(|line| match line.split(" | ").collect::<Vec<&str>>()[..] {
            [production, old, new, said] => [cell(production), code(old), code(new), cell(said)],
            _ => panic!("four cells: {line}"),
        })
        .collect()
}

#[test]
fn modules_that_leave_a_production_are_refused_as_the_page_says() {
    let source = common::source("scara");
    let module = common::generate(&source, Scalar::F64).module;
    assert!(Module::read(&module).is_ok_and(|module| module.functions.iter().all(|(_, function)| function.is_ok())));
    for [production, old, new, said] in rows(&page()) {
        // The page's example step belongs to the inertia matrix.
        let from = if old.contains("t1") || old.contains("c2") {
            module.find("pub fn inertia_matrix(").expect("it is there")
        } else {
            0
        };
        assert!(module[from..].contains(&old), "{production}: `{old}` is not in the module");
        let changed = format!("{}{}", &module[..from], module[from..].replacen(&old, &new, 1));
        let fault = match Module::read(&changed) {
            Err(fault) => fault.to_string(),
            Ok(module) => module.functions.into_iter().find_map(|(_, function)| function.err()).unwrap_or_default(),
        };
        assert!(fault.starts_with("line ") && fault.contains(&said), "{production}: `{fault}`, not `{said}`");
    }
}

#[test]
fn each_production_has_a_module_that_leaves_it() {
    let page = page();
    let grammar = page.split("```text\nmodule ").nth(1).and_then(|rest| rest.split("\n```").next()).expect("the grammar");
    let productions =
        grammar.lines().filter_map(|line| line.split_once(" = ")).map(|(name, _)| name.trim()).filter(|name| !name.contains(' '));
    let rows = rows(&page);
    for production in ["module"].into_iter().chain(productions.filter(|name| !name.is_empty())) {
        let listed = ["item", "documentation"].contains(&production) || rows.iter().any(|[name, ..]| name == production);
        assert!(listed, "{production}");
    }
    assert!(rows.len() > 20);
}
