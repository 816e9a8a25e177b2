//! `armgen import`: a URDF to a robot.yaml.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::{Diagnostics, Severity};
use armgen_codegen::inverse_kinematics::{self, Construction, InverseKinematics};
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::source::Source;
use armgen_import::{Imported, Options};
use armgen_terminal::input::LONGEST;
use armgen_texts::rows;
use clap::{Args, ValueHint};

use super::convert::To;
use crate::output::{same_file, write};
use crate::{input, terminal, DONE, FAULTY, UNREADABLE};

/// Which arm of the file, and how it is read.
#[derive(Debug, Args)]
pub(crate) struct Choices {
    /// The link that does not move; the root of the file if not given
    #[arg(long, value_name = "LINK")]
    base: Option<String>,
    /// The link whose frame is the end effector's; needed where several may be. Several times, or with a name, for several end effectors
    #[arg(long, value_name = "[NAME=]LINK")]
    tip: Vec<String>,
    /// Every joint below the base, and an end effector on each link that ends a branch
    #[arg(long, conflicts_with = "tip")]
    all: bool,
    /// A joint that stands still, and where: an expression such as 0.04 or pi/4
    #[arg(long, value_name = "JOINT=VALUE", value_parser = lock, allow_hyphen_values = true)]
    lock: Vec<(String, String)>,
    /// The robot's name; the file's if not given
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Angles within so many rad of a multiple of pi/12 are that multiple; 0 takes every digit
    #[arg(long, value_name = "TOL", default_value_t = Options::SNAP, value_parser = tolerance)]
    snap: f64,
    /// Links without a mass distribution have mass 0
    #[arg(long)]
    massless: bool,
    /// Tensors that no body has are taken as written, with a warning; B(q) may not be positive definite
    #[arg(long)]
    inertia_as_written: bool,
    /// What the rows of the description are
    #[arg(long, value_enum, default_value = "urdf")]
    convention: To,
}

fn lock(text: &str) -> Result<(String, String), String> {
    let (joint, value) = text.rsplit_once('=').ok_or("write JOINT=VALUE")?;
    Ok((joint.to_owned(), value.to_owned()))
}

/// The link of the only end effector, or the links of several with their names.
fn tips_of(given: Vec<String>) -> (Option<String>, Vec<(Option<String>, String)>) {
    match &given[..] {
        [] => (None, Vec::new()),
        [only] if !only.contains('=') => (Some(only.clone()), Vec::new()),
        several => {
            let named = several.iter().map(|tip| match tip.split_once('=') {
                Some((name, link)) => (Some(name.to_owned()), link.to_owned()),
                None => (None, tip.clone()),
            });
            (None, named.collect())
        }
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    match (0.0..=Options::LARGEST_SNAP).contains(&value) {
        true => Ok(value),
        false => Err(format!("from 0 to {} rad", Options::LARGEST_SNAP)),
    }
}

/// Where the results go.
#[derive(Debug, Args)]
pub(crate) struct Results {
    /// File to write; standard output if not given
    #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
    out: Option<PathBuf>,
    /// What was taken, changed and left out, as JSON
    #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
    report: Option<PathBuf>,
}

/// The most bodies besides the links for which import reports faults of the equations.
const MOST_BODIES: usize = 30;

/// The name of standard input.
const STANDARD_INPUT: &str = "-";

/// The text of a file, or of standard input, with the files that a MuJoCo model includes.
fn source_of(file: &Path) -> Result<Source, u8> {
    let piped = file == Path::new(STANDARD_INPUT);
    let source = if piped { piped_in()? } else { input::source(file)? };
    let beside = |path: &str| match piped {
        true => Err("standard input is in no folder: name the file of the model".to_owned()),
        false => armgen_import::build_script::beside(file.parent().unwrap_or(Path::new("")), path),
    };
    armgen_import::included(&source, &beside).map_err(|fault| {
        let mut faults = Diagnostics::new();
        faults.push(*fault);
        terminal::diagnose(&faults.render(&source, terminal::colour(&std::io::stderr())));
        terminal::error(&input::verdict(&source, &faults));
        FAULTY
    })
}

/// The text of standard input.
fn piped_in() -> Result<Source, u8> {
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take(LONGEST as u64 + 1).read_to_end(&mut bytes);
    let text = match read {
        Err(error) => Err(format!("cannot read standard input: {error}")),
        Ok(_) if bytes.len() > LONGEST => Err(format!("standard input is longer than {} MiB", LONGEST >> 20)),
        Ok(_) => String::from_utf8(bytes).map_err(|_| "standard input is not UTF-8".to_owned()),
    };
    text.map(|text| Source::new("standard input", text)).map_err(|reason| {
        terminal::error(&reason);
        UNREADABLE
    })
}

pub(crate) fn run(file: &Path, choices: Choices, results: &Results) -> u8 {
    let source = match source_of(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    if choices.name.as_ref().is_some_and(|name| !armgen_codegen::validate::is_rust_name(name)) {
        terminal::error("--name takes letters, digits and `_`, a letter first");
        return UNREADABLE;
    }
    let Choices { base, tip, all, lock, name, snap, massless, inertia_as_written, convention } = choices;
    let (tip, tips) = tips_of(tip);
    let convention = convention.into();
    let options = Options { base, tip, tips, all, lock, name, snap, massless, inertia_as_written, convention };
    let (imported, diagnostics) = armgen_import::import(&source, &options);
    let imported = match input::report_or_exit_code(&source, imported, &diagnostics, input::Warnings::Shown) {
        Ok(imported) => imported,
        Err(code) => return code,
    };
    for out in [&results.out, &results.report].into_iter().flatten() {
        if same_file(file, out) {
            terminal::error(&format!("{} is the file to import: it would be overwritten; name another file", out.display()));
            return UNREADABLE;
        }
    }
    if results.out.as_ref().zip(results.report.as_ref()).is_some_and(|(out, report)| same_file(out, report)) {
        terminal::error("--out and --report name one file");
        return UNREADABLE;
    }
    for line in imported.report.short_lines() {
        terminal::note(line);
    }
    // Faults that only the description shows, such as a last link without inertia about its axis. For a humanoid with its many bodies
    // this takes seconds, and `armgen check` reports them for every description.
    if imported.report.attached() <= MOST_BODIES {
        note_faults(&source, &options, &imported, results);
    } else if let Some(joint) = imported.report.idle().first() {
        terminal::note(&format!(
            "{} is refused as it stands: nothing that joint `{joint}` moves has mass or inertia; let it stand still by `--lock {joint}=0`, or give its link mass and inertia",
            called(results)
        ));
    }
    let json = imported.report.to_json();
    for (path, text) in [(&results.report, &json), (&results.out, &imported.yaml)] {
        let Some(path) = path else { continue };
        if let Err(error) = write(path, text) {
            terminal::error(&format!("cannot write {}: {error}", path.display()));
            return UNREADABLE;
        }
    }
    match results.out {
        Some(_) => DONE,
        None => terminal::print(&imported.yaml),
    }
}

/// How notes call the description.
fn called(results: &Results) -> String {
    results.out.as_deref().map_or_else(|| "the description".to_owned(), |out| out.display().to_string())
}

/// Faults of the description that only its equations show, the kinds of its warnings, and what becomes of inverse kinematics.
fn note_faults(source: &Source, options: &Options, imported: &Imported, results: &Results) {
    let called = called(results);
    let as_description = Source::new(called.as_str(), imported.yaml.clone());
    let (valid, of_description) = armgen_codegen::validate::read(&as_description);
    let of = |severity| of_description.iter().filter(move |diagnostic| diagnostic.code.severity() == severity);
    for refused in of(Severity::Error) {
        terminal::note(&format!("{called} is refused as it stands: {}; {}", refused.message, refused.help));
    }
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    of(Severity::Warning).for_each(|warning| *kinds.entry(warning.code.name()).or_default() += 1);
    if !kinds.is_empty() {
        let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        terminal::note(&format!("{called} has warnings, which `armgen check` shows: {}", kinds.join(", ")));
    }
    // Digits that stand for pi/2 and are taken as written leave axes that meet nearly.
    let has_one = |arm: &Manipulator| imported.report.near() > 0 && arm.tips.is_empty();
    if let Some((manipulator, _)) = valid.filter(|(arm, _)| has_one(arm)) {
        note_inverse_kinematics(source, options, &as_description, &inverse_kinematics::of(&manipulator));
    }
}

/// Tolerances that may restore what digits were rounded from, rad.
const SNAPS: [f64; 2] = [1e-3, 2e-3];

/// A note about the inverse kinematics of an arm with rounded angles: the `--snap` that gives it a closed form, and its cost.
fn note_inverse_kinematics(source: &Source, options: &Options, description: &Source, found: &Result<InverseKinematics, String>) {
    let is_closed = |found: &InverseKinematics| !matches!(found.construction, Construction::General(_));
    if found.as_ref().is_ok_and(is_closed) {
        return;
    }
    let snapped = SNAPS.into_iter().filter(|&snap| snap > options.snap).find_map(|snap| {
        let imported = armgen_import::import(source, &Options { snap, ..options.clone() }).0?;
        let snapped = Source::new("robot.yaml", imported.yaml);
        let (manipulator, _) = armgen_codegen::validate::read(&snapped).0?;
        let found = inverse_kinematics::of(&manipulator).ok().filter(is_closed)?;
        Some(format!(
            "`--snap {snap:e}` gives inverse kinematics a closed form, {}: the end effector then moves by at most {:.1e} m, within the limits",
            found.class,
            imported.report.moved()
        ))
    });
    if let Some(line) = snapped {
        terminal::note(&line);
    }
    let Err(reason) = found else { return };
    match rows::solved(description, None) {
        Some(found) => terminal::note(&format!(
            "inverse kinematics are those of its rows, of 17 digits: import it with `--convention standard`: {}",
            found.class
        )),
        None => terminal::note(&format!("there is no inverse kinematics: {reason}")),
    }
}
