//! Requests and their answers. `name` and `text` are a file's, `about` says what is asked for:
//!
//! | `about` | beside `name` and `text` | answer |
//! |---|---|---|
//! | `check` | | a file as `armgen check --format json` has it |
//! | `import` | `tip`, `all`, `lock` (pairs of joint and value), `massless`, `inertia_as_written` | `yaml`, `report`, `lines`, `diagnostics` |
//! | `summary` | | `text` of `armgen check` |
//! | `picture` | `nonce` | `page`, the first step |
//! | `rest` | | `rest`, its second step |
//! | `functions` | | `functions`: names with titles and, of those that the arm lacks, reasons |
//! | `show` | `quantity`, `symbolic` | `text`, `latex` |
//! | `code` | `language`, `functions` | `files`: pairs of name and text; `note` |
//!
//! A request that is none has the answer `fault`. A faulty description has no other answers than `check`'s.

use std::cell::RefCell;
use std::path::Path;

use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::{Module, Trig};
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::show::{Reading, Sheet, Style};
use armgen_codegen::source::Source;
use armgen_codegen::validate::Places;
use armgen_codegen::{catalogue, validate, Generated, Model};
use armgen_texts::{json, module, shown, summary};
use serde_json::{json, Value};

/// The answer to a request.
pub(crate) fn of(request: &[u8]) -> Value {
    let request: Value = match serde_json::from_slice(request) {
        Ok(request) => request,
        Err(fault) => return json!({ "fault": fault.to_string() }),
    };
    let source = Source::new(word(&request, "name"), word(&request, "text"));
    answer(&request, &source).unwrap_or_else(|fault| json!({ "fault": fault }))
}

/// A text of a request; empty if it has none.
fn word<'r>(request: &'r Value, key: &str) -> &'r str {
    request[key].as_str().unwrap_or_default()
}

fn answer(request: &Value, source: &Source) -> Result<Value, String> {
    Ok(match word(request, "about") {
        "check" => {
            let (valid, diagnostics) = validate::read_for(source, Scalar::F64);
            json::of_file(source, valid.as_ref().map(|(manipulator, _)| manipulator), &diagnostics)
        }
        "import" => import(request, source),
        "summary" => json!({ "text": summary::of(source, &[], false) }),
        "picture" => {
            let (page, diagnostics) = armgen_page::picture(source, word(request, "nonce"));
            json!({ "page": page, "file": json::of_file(source, None, &diagnostics) })
        }
        "rest" => of_arm(source, |arm| {
            let whole = arm.whole()?.clone();
            Ok(json!({ "rest": armgen_page::rest(&arm.model, &whole) }))
        })?,
        "functions" => of_arm(source, |arm| Ok(json!({ "functions": functions(&arm.model) })))?,
        "show" => of_arm(source, |arm| show(request, &arm.model))?,
        "code" => of_arm(source, |arm| code(request, arm))?,
        other => return Err(format!("there is no request `{other}`")),
    })
}

fn faulty() -> String {
    "the description is faulty".to_owned()
}

fn import(request: &Value, source: &Source) -> Value {
    let pair = |pair: &Value| Some((pair[0].as_str()?.to_owned(), pair[1].as_str()?.to_owned()));
    let options = armgen_import::Options {
        lock: request["lock"].as_array().into_iter().flatten().filter_map(pair).collect(),
        tip: request["tip"].as_str().map(str::to_owned),
        all: request["all"] == true,
        massless: request["massless"] == true,
        inertia_as_written: request["inertia_as_written"] == true,
        ..armgen_import::Options::default()
    };
    let alone = |_: &str| Err("the playground reads one file alone: import the model with the program".to_owned());
    let (imported, diagnostics) = match armgen_import::included(source, &alone) {
        Ok(whole) => armgen_import::import(&whole, &options),
        Err(fault) => {
            let mut faults = Diagnostics::new();
            faults.push(*fault);
            (None, faults)
        }
    };
    let report = imported.as_ref().map(|imported| &imported.report);
    json!({
        "yaml": imported.as_ref().map(|imported| &imported.yaml),
        "report": report.map(armgen_import::Report::to_json),
        "lines": report.map(armgen_import::Report::short_lines),
        "file": json::of_file(source, None, &diagnostics),
    })
}

/// The functions of the catalogue, and what `armgen show` has besides.
fn functions(model: &Model) -> Vec<Value> {
    catalogue::functions_of(&model.manipulator.tips)
        .map(|(quantity, with)| {
            let missing = quantity.absence(model, with);
            json!({ "name": quantity.function_name(with), "title": quantity.documentation.title, "missing": missing })
        })
        .collect()
}

/// A quantity as `armgen show` writes it.
fn show(request: &Value, model: &Model) -> Result<Value, String> {
    let name = word(request, "quantity");
    if let Some(steps) = shown::steps_of(model, name) {
        return Ok(json!({ "text": steps, "latex": null }));
    }
    let reading = if request["symbolic"] == true { Reading::Symbolic } else { Reading::Nominal };
    let style = Style { form: shown::usual_form(model), digits: None };
    let sheet = Sheet::in_style(model, &shown::items(model, &[name.to_owned()])?, reading, style);
    Ok(json!({ "text": sheet.text(), "latex": sheet.latex() }))
}

/// How many modules of an arm are kept: those of all languages, and the last choices of single functions.
const KEPT: usize = 8;

/// A valid arm, with what was derived of it: panes and languages share it.
struct Arm {
    source: Source,
    model: Model,
    places: Places,
    /// The programs of all functions.
    whole: Option<Module>,
    /// The last [`KEPT`] modules by what they were made with: where sines come from, and the names of their functions.
    made: Vec<((Trig, Vec<String>), Generated)>,
}

thread_local! {
    /// The arm of the last description.
    static LAST: RefCell<Option<Arm>> = const { RefCell::new(None) };
}

/// What is made of the arm of a description, which is read where it is not that of the last request.
fn of_arm(source: &Source, make: impl FnOnce(&mut Arm) -> Result<Value, String>) -> Result<Value, String> {
    LAST.with_borrow_mut(|last| {
        let same = |arm: &Arm| (arm.source.name(), arm.source.text()) == (source.name(), source.text());
        if !last.as_ref().is_some_and(same) {
            let (manipulator, places) = validate::read_for(source, Scalar::F64).0.ok_or_else(faulty)?;
            let model = Model::new(manipulator);
            *last = Some(Arm { source: source.clone(), model, places, whole: None, made: Vec::new() });
        }
        make(last.as_mut().expect("it was read"))
    })
}

impl Arm {
    fn programs(&self, functions: Selection) -> Result<Module, String> {
        let options = Options { trig: Trig::Fast, functions, ..Options::default() };
        armgen_codegen::programs(&self.model, &self.places, &options)
            .map_err(|fault| format!("{}; {}", fault.message, fault.help))
    }

    fn whole(&mut self) -> Result<&Module, String> {
        if self.whole.is_none() {
            self.whole = Some(self.programs(Selection::ALL)?);
        }
        Ok(self.whole.as_ref().expect("it was derived"))
    }

    /// The module of functions, all if there are no names. Programs are the same wherever sines come from.
    fn generated(&mut self, trig: Trig, names: Vec<String>) -> Result<&Generated, String> {
        let choice = (trig, names);
        let at = match self.made.iter().position(|(with, _)| *with == choice) {
            Some(at) => at,
            None => {
                let programs = match choice.1.as_slice() {
                    [] => self.whole()?.clone(),
                    names => self.programs(Selection::named(names).map_err(|unknown| unknown.to_string())?)?,
                };
                let module = Module { trig, ..programs };
                let mut generated = armgen_codegen::printed(&self.source, self.model.manipulator.clone(), module);
                // Without them the documentation is shorter.
                let _ = armgen_certify::document_bounds(&self.source, &mut generated);
                if self.made.len() == KEPT {
                    self.made.remove(0);
                }
                self.made.push((choice, generated));
                self.made.len() - 1
            }
        };
        Ok(&self.made[at].1)
    }
}

/// The files of a module, those of `armgen generate --ik` where the language has inverse kinematics.
fn code(request: &Value, arm: &mut Arm) -> Result<Value, String> {
    let language = Language::ALL.into_iter().find(|language| language.name() == word(request, "language"));
    let language = language.ok_or_else(|| format!("there is no language `{}`", word(request, "language")))?;
    let names = request["functions"].as_array().into_iter().flatten().filter_map(Value::as_str);
    files(arm.generated(Trig::of_language(language), names.map(str::to_owned).collect())?, language)
}

fn files(generated: &Generated, language: Language) -> Result<Value, String> {
    let out = module::file_of(language, "robot");
    let mut files = module::files(generated, language, Path::new(&out));
    let mut note = None;
    if language.is_c() || language == Language::Rust {
        for solver in generated.solvers() {
            match &solver.solved().found {
                Ok(_) => files.push(module::inverse_kinematics(&solver, language, Path::new(&out))?),
                Err(reason) => note = Some(format!("there is no inverse kinematics{}: {reason}", solver.solved().of_it())),
            }
        }
    }
    let files: Vec<Value> = files.into_iter().map(|(path, text)| json!([path.display().to_string(), text])).collect();
    Ok(json!({ "files": files, "note": note }))
}
