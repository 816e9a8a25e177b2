//! Snapshots of each robot: a difference shows whether the form, the cost or the meaning has changed.
//!
//! - `ROBOT.cost`: operations of every emitted function, and the derivation that was chosen: the *cost*;
//! - `ROBOT.meaning`: fingerprints of all entries of every quantity, which no rearrangement changes: the *meaning*;
//! - `scara.forms`: `show`'s text of the quantities that have a closed form: the *form* for people;
//! - `ROBOT.module`, of the two SCARAs: the emitted module: the *form* for machines;
//! - `scara.LANGUAGE`: the module of the SCARA in that language.
//!
//! A change that is meant is accepted by `INSTA_UPDATE=always cargo test -p armgen-tests --test all snapshots` and goes with its cause.

use std::fmt::Write;

use armgen_codegen::catalogue;
use armgen_codegen::derive::parameters::View;
use armgen_codegen::emit::Language;
use armgen_codegen::generate;
use armgen_codegen::program::{Cost, Trig};
use armgen_codegen::ring::field::Element;
use armgen_codegen::schedule::{module, Options};
use armgen_codegen::show::{Form, Item, Reading, Sheet, Style};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::Model;
use armgen_tests::emitted::{emitted, Emitted, ALL};

fn robots() -> impl Iterator<Item = &'static Emitted> {
    ALL.iter().filter(|robot| !robot.narrow)
}

/// The robots whose formulas are short enough for a person to read a difference; cost and meaning cover the others.
const READABLE: [&str; 2] = ["scara", "scara4"];

fn readable_robots() -> impl Iterator<Item = &'static Emitted> {
    READABLE.into_iter().map(emitted)
}

fn model(robot: &Emitted) -> Model {
    let (valid, _) = validate::read(&Source::new(robot.path, robot.description()));
    Model::new(valid.expect("every robot here is valid").0)
}

#[track_caller]
fn snapshot(robot: &Emitted, what: &str, text: &str) {
    let name = format!("{}.{what}", robot.module);
    insta::with_settings!({ omit_expression => true, prepend_module_to_snapshot => false, snapshot_path => "../snapshots" }, {
        insta::assert_snapshot!(name, text);
    });
}

#[test]
fn costs() {
    for robot in robots() {
        let mut table = format!("{:32}{:>6}{:>6}{:>6}{:>6}{:>8}  derived by\n", "", "mul", "add", "div", "neg", "sincos");
        for function in module(&model(robot), &Options::default()).functions {
            let Cost { mul, add, div, neg, sincos, .. } = Cost::of(&function);
            let (name, method) = (function.name(), function.method);
            writeln!(table, "{name:32}{mul:6}{add:6}{div:6}{neg:6}{sincos:8}  {method}").expect("text");
        }
        snapshot(robot, "cost", &table);
    }
}

#[test]
fn meanings() {
    for robot in robots() {
        let model = model(robot);
        let field = &model.field;
        let mut text = format!("in the field of {} elements; the halves of the first value in one, by rows\n", field.prime());
        // Half the digits suffice; both halves enter, because a small number has an empty half.
        let hex = |[first, _]: [Element; 2]| match field.to_u64(first) {
            0 => "0".to_owned(),
            value => format!("{:08x}", (value >> 32) ^ (value & 0xffff_ffff)),
        };
        let sizes = model.sizes();
        for (quantity, with) in catalogue::functions().filter(|(quantity, with)| quantity.absence(&model, *with).is_none()) {
            let view = if with { View::Vector(&model.parameters) } else { View::Nominal };
            let derivation = quantity.by_recursion(&model, view);
            writeln!(text, "\n{}", quantity.function_name(with)).expect("text");
            let mut entries = derivation.entries.as_slice();
            for part in quantity.result {
                let (own, rest) = entries.split_at(part.len(&sizes));
                entries = rest;
                // A vector is printed as a row.
                let columns = if part.lengths.len() == 1 { part.rows() } else { part.columns() };
                for row in own.chunks(columns.of(&sizes).max(1)) {
                    let row: Vec<String> = row.iter().map(|&entry| hex(derivation.pool.fingerprint(entry))).collect();
                    writeln!(text, "  {}", row.join(" ")).expect("text");
                }
            }
        }
        snapshot(robot, "meaning", &text);
    }
}

#[test]
fn closed_forms() {
    let robot = emitted("scara");
    let model = model(robot);
    let mut text = String::new();
    for reading in [Reading::Nominal, Reading::Symbolic] {
        writeln!(text, "---- {reading:?} ----\n").expect("text");
        let mut sheet = Sheet::in_style(&model, &Item::all(&[]), reading, Style { form: Form::Closed, digits: None });
        let (closed, programs) = std::mem::take(&mut sheet.quantities).into_iter().partition(|shown| shown.is_closed());
        sheet.quantities = closed;
        text += &sheet.text();
        for shown in Vec::from_iter::<Vec<armgen_codegen::show::Shown>>(programs) {
            writeln!(text, "\n{}: too long for a closed form", shown.name).expect("text");
        }
    }
    snapshot(robot, "forms", &text);
}

#[test]
fn modules() {
    for robot in readable_robots() {
        snapshot(robot, "module", robot.text);
    }
}

#[test]
fn modules_in_other_languages() {
    let scara = emitted("scara");
    let source = Source::new("scara.yaml", scara.description());
    let generated = generate(&source, &Options { trig: Trig::Fast, ..Options::default() }).0.expect("a valid robot");
    for language in Language::ALL.into_iter().filter(|language| *language != Language::Rust) {
        let text = generated.in_language(language);
        // Before its kernels the module in CUDA is the header of C.
        let own = if language == Language::Cuda { text.find("\n/*\n * On a GPU").expect("kernels") + 1 } else { 0 };
        snapshot(scara, &language.title().to_lowercase(), &text[own..]);
    }
}
