//! `show --format latex` prints valid LaTeX: a LaTeX parser reads every formula, and the text between formulas is allowed there.

use std::path::Path;

use armgen_codegen::show::{Item, Reading, Sheet};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::Model;
use pulldown_latex::{Parser, Storage};

/// The formulas of a document, those in lines of their own and those within text; what lies between them must be text.
fn formulas(document: &str) -> Result<Vec<&str>, String> {
    let mut found = Vec::new();
    let mut rest = document;
    while let Some(at) = rest.find("\\[").into_iter().chain(rest.find('$')).min() {
        is_text(&rest[..at])?;
        let (open, close) = if rest[at..].starts_with('$') { (1, "$") } else { (2, "\\]") };
        let body = &rest[at + open..];
        let end = body.find(close).ok_or_else(|| format!("a formula does not end: {}", &body[..body.len().min(80)]))?;
        found.push(&body[..end]);
        rest = &body[end + close.len()..];
    }
    is_text(rest)?;
    Ok(found)
}

/// Comments, and words with no other command than `\noindent`.
fn is_text(text: &str) -> Result<(), String> {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with('%'));
    for line in lines {
        if line.replace("\\noindent", "").contains(['\\', '_', '^', '&', '{', '}', '#']) {
            return Err(format!("not text: {line}"));
        }
    }
    Ok(())
}

/// Parses a formula; returns its fault, if any.
fn read(formula: &str) -> Result<(), String> {
    let storage = Storage::new();
    let fault = Parser::new(formula, &storage).find_map(Result::err).map(|error| format!("{error} in {formula}"));
    fault.map_or(Ok(()), Err)
}

fn sheet(path: &str, reading: Reading) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let (valid, _) = validate::read(&Source::new(path, text));
    let (manipulator, _) = valid.expect("a valid description");
    Sheet::new(&Model::new(manipulator), &Item::all(&[]), reading).latex()
}

#[test]
fn every_formula_is_latex() {
    for (path, reading, least) in [
        ("../robots/scara.yaml", Reading::Nominal, 30),
        ("../robots/scara.yaml", Reading::Symbolic, 30),
        ("../robots/ur5.yaml", Reading::Nominal, 200),
        ("robots/everything.yaml", Reading::Symbolic, 60),
        ("robots/single_joint.yaml", Reading::Symbolic, 20),
        ("robots/modified_prismatic.yaml", Reading::Nominal, 30),
    ] {
        let document = sheet(path, reading);
        let formulas = formulas(&document).unwrap_or_else(|fault| panic!("{path}: {fault}"));
        assert!(formulas.len() >= least, "{path}: {} formulas", formulas.len());
        let faults: Vec<String> = formulas.iter().filter_map(|formula| read(formula).err()).collect();
        assert!(faults.is_empty(), "{path}: {} faults, the first: {}", faults.len(), faults[0]);
    }
}

#[test]
fn the_reader_sees_what_it_is_to_see() {
    for good in ["a", "\\frac{1}{2}\\,\\cos q_{1}", "\\begin{bmatrix} 1 & 2 \\\\ 3 & 4 \\end{bmatrix}", "\\dot q_r"] {
        assert_eq!(read(good), Ok(()));
    }
    for bad in ["\\frac{1}", "\\sinn q", "\\left(q", "\\begin{bmatrix} 1", "q_{1", "a & b", "q_1_2"] {
        assert!(read(bad).is_err(), "{bad} is taken");
    }
    assert!(formulas("\\[ q").is_err() && formulas("q_{1}: \\[ q \\]").is_err());
    assert_eq!(formulas("% q_{1}\n\\noindent $a$:\n\\[ b \\]\n"), Ok(vec!["a", " b "]));
}
