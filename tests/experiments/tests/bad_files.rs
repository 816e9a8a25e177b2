//! Every kind of fault of experiments has a file that gets it, and what its reader sees is a snapshot.
//!
//! The name of a file in `tests/bad/experiments` is the code of its diagnostic, perhaps with a further word:
//! `missing-key-law.yaml`. The folder `paths` holds the faulty paths that these files name.

use crate::common;

use std::collections::BTreeSet;
use std::path::PathBuf;

use armgen_codegen::diagnostic::AnyCode;
use armgen_experiments::model::{AlgorithmKind, ControlLawKind};
use armgen_experiments::read::{Code, Parsed, SHARED};
use common::{files, parse, root, said, text_of};

fn folder() -> PathBuf {
    root().join("tests/bad/experiments")
}

fn stems() -> Vec<String> {
    files(&folder()).iter().map(|name| name.trim_end_matches(".yaml").to_owned()).collect()
}

/// Every code that a reader of experiments reports itself.
fn codes() -> Vec<AnyCode> {
    Code::ALL.iter().map(|code| (*code).into()).chain(SHARED.map(AnyCode::from)).collect()
}

/// The code that a file is named for.
fn code_of(stem: &str) -> Option<AnyCode> {
    let fits = |code: &AnyCode| stem.strip_prefix(code.name()).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'));
    codes().into_iter().filter(fits).max_by_key(|code| code.name().len())
}

#[test]
fn every_bad_file_is_told_what_is_wrong() {
    let arm = armgen_experiment_tests::scara();
    for stem in stems() {
        let name = format!("{stem}.yaml");
        let parsed = parse(&folder(), &name, &text_of(&folder(), &name), arm.robot());
        let rendered = said(&parsed);
        let Parsed::Faulty(faulty) = &parsed else { panic!("{name} is {rendered}") };
        let code = code_of(&stem).unwrap_or_else(|| panic!("no code is called as {name} is"));
        let all = || faulty.iter().flat_map(|(_, diagnostics)| diagnostics.iter());
        assert!(all().any(|d| d.code == code), "{name} does not get {}:\n{rendered}", code.name());
        for (source, diagnostics) in faulty {
            for diagnostic in diagnostics.iter() {
                let place = source.place(diagnostic.span().start);
                assert!(rendered.contains(&format!("--> {}:{place}\n", source.name())), "{rendered}");
                assert!(!diagnostic.help.is_empty() && !diagnostic.message.is_empty(), "{rendered}");
            }
        }
        insta::with_settings!({ omit_expression => true, prepend_module_to_snapshot => false, snapshot_path => "../../bad/experiments/snapshots" }, {
            insta::assert_snapshot!(stem.as_str(), rendered);
        });
    }
}

#[test]
fn every_code_has_a_bad_file() {
    let with_file: BTreeSet<AnyCode> = stems().iter().filter_map(|stem| code_of(stem)).collect();
    let without: Vec<&str> = codes().iter().filter(|code| !with_file.contains(code)).map(|code| code.name()).collect();
    assert!(without.is_empty(), "no bad file for {without:?}");
    let names: BTreeSet<&str> = codes().iter().map(|code| code.name()).collect();
    assert_eq!(names.len(), codes().len(), "names of codes differ");
}

#[test]
fn an_experiment_for_another_robot_and_a_path_are_left_alone() {
    let arm = armgen_experiment_tests::scara();
    let parse = |text: &str| parse(&folder(), "a.yaml", text, arm.robot());
    let other = parse("robot: someone_else\nanything: 1\n");
    assert!(matches!(&other, Parsed::OtherRobot(robot) if robot == "someone_else"), "{}", said(&other));
    assert!(matches!(parse(&text_of(&folder(), "paths/line.yaml")), Parsed::Path));
    assert!(said(&parse("robot: scara\nsegments: []\n")).contains("`segments`"));
    assert!(said(&parse("robot: [\n")).contains("error[yaml-syntax]"));
}

/// The page lists every code, every law and every algorithm, with their keys.
#[test]
fn the_page_names_every_code_and_every_key_of_a_law() {
    let page = text_of(&root(), "docs/experiments.md");
    let laws = ControlLawKind::ALL.into_iter().flat_map(|kind| {
        let gains = kind.gains().iter().map(|gain| gain.key);
        [kind.name()].into_iter().chain(gains).chain(kind.optional().iter().copied())
    });
    let algorithms = AlgorithmKind::ALL.into_iter().flat_map(|kind| [kind.name()].into_iter().chain(kind.keys().iter().copied()));
    let codes = codes();
    let words = codes.iter().map(|code| code.name()).chain(laws).chain(algorithms);
    let missing: Vec<&str> = words.filter(|word| !page.contains(&format!("`{word}`"))).collect();
    assert!(missing.is_empty(), "docs/experiments.md does not name {missing:?}");
}
