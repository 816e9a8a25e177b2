//! `armgen verify`: whether a module equals the equations of its description, identified numbers are those that a certificate proves,
//! or a timing keeps its limits and its bound.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{channel, RecvTimeoutError};
use std::time::Duration;

use armgen_codegen::emit::{camel, Language, Origin};
use armgen_codegen::source::Source;
use armgen_identify::certificate as identification;
use armgen_verify::certificate::report::Report;
use armgen_verify::certificate::Certificate;
use armgen_verify::inverse_kinematics;
use armgen_verify::read::reader::{matlab, options_of, ModuleText};
use armgen_verify::timing;
use indicatif::{ProgressBar, ProgressStyle};

use crate::{companions, input, terminal, FAULTY};

/// The path of the certificate of a module: `robot.cert.json` for `robot.rs`; `robot.h.cert.json` for `robot.h`, since a folder may hold
/// both, and so on.
pub(crate) fn certificate_beside(module: &Path) -> PathBuf {
    match module.extension().and_then(OsStr::to_str) {
        None | Some("rs") => module.with_extension("cert.json"),
        Some(other) => module.with_extension(format!("{other}.cert.json")),
    }
}

pub(crate) fn run(description: &Path, module: &Path, language: Option<Language>) -> u8 {
    match verified(description, module, language) {
        Ok(code) | Err(code) => code,
    }
}

fn verified(description: &Path, module: &Path, language: Option<Language>) -> Result<u8, u8> {
    let source = input::description(description)?;
    // `.` has no name that a certificate could stand beside.
    let named = module.file_name().is_none().then(|| module.canonicalize().ok()).flatten();
    let module = named.as_deref().unwrap_or(module);
    let text = if module.is_dir() { input::package(module) } else { input::written(module) }?;
    if identification::is_one(text.text()) {
        return identified(&source, module, text.text());
    }
    if timing::is_one(text.text()) {
        return timed(&source, module, text.text());
    }
    if let Some(with) = companions::goes_with(module, text.text()) {
        terminal::error(&format!("{} goes with {with}: verify that one", module.display()));
        return Err(FAULTY);
    }
    let language = language_of(module, language).map_err(|fault| {
        terminal::error(&fault);
        FAULTY
    })?;
    if inverse_kinematics::is_one(text.text()) {
        return postures(&source, module, text.text());
    }
    let beside = certificate_beside(module);
    let certificate = match beside.exists() {
        true => Some(Certificate::from_json(input::written(&beside)?.text()).map_err(|error| {
            terminal::error(&format!("{}: {error}", beside.display()));
            FAULTY
        })?),
        false => None,
    };
    // Faults of the description are reported first, as by every command.
    input::manipulator(&source, armgen_codegen::kinds::Scalar::F64, input::Warnings::Counted)?;
    let report = with_spinner("verifying", || {
        let module = ModuleText { language, text: text.text() };
        armgen_certify::verify(&source, module, certificate.as_ref())
    });
    let mut printed = format!("{report}\n");
    if certificate.is_some() {
        printed += &format!("certificate: {}\n", beside.display());
    }
    let code = terminal::print(&printed);
    if report.passed() {
        return Ok(code);
    }
    let (line, fault) =
        placed(text.text(), language, &report.first_fault().unwrap_or_else(|| "the module has no functions".into()));
    let place = match line {
        // The lines of a package are those of its files.
        Some(line) if language == Language::Matlab => {
            let (file, line) = matlab::file_of(text.text(), line).unwrap_or(("", line));
            format!("{}:{line}", module.join(file).display())
        }
        Some(line) => format!("{}:{line}", text.name()),
        None => text.name().to_string(),
    };
    terminal::error(&format!("{place}: {fault}"));
    let why = companions::why_different(text.text(), &source);
    let mut options = if language == Language::Rust { String::new() } else { format!(" --language {}", language.name()) };
    let named = options_of(text.text());
    if !named.is_empty() {
        options += &format!(" {named}");
    }
    let (description, module) = (description.display(), module.display());
    terminal::note(&format!(
        "{module} {why}; `armgen generate {description}{options} --out {module} --verify` writes module and certificate again"
    ));
    Err(FAULTY)
}

/// A certificate of identified numbers.
fn identified(source: &Source, certificate: &Path, text: &str) -> Result<u8, u8> {
    input::manipulator(source, armgen_codegen::kinds::Scalar::F64, input::Warnings::Counted)?;
    match with_spinner("verifying", || identification::check(source, text)) {
        Ok(proved) => Ok(terminal::print(&format!("{}verified\n", super::identify::proofs(&proved)))),
        Err(fault) => {
            terminal::error(&format!("{}: {fault}", certificate.display()));
            Err(FAULTY)
        }
    }
}

/// A timing of a path.
fn timed(source: &Source, file: &Path, text: &str) -> Result<u8, u8> {
    input::manipulator(source, armgen_codegen::kinds::Scalar::F64, input::Warnings::Counted)?;
    match with_spinner("verifying", || armgen_verify::verify_timing(source, text)) {
        Ok(proved) => Ok(terminal::print(&format!(
            "{} segments: every limit is kept on all of the path in {} s; no motion on it takes less than {} s\nverified\n",
            proved.segments, proved.duration, proved.lower_bound
        ))),
        Err(fault) => {
            terminal::error(&format!("{}: {fault}", file.display()));
            Err(FAULTY)
        }
    }
}

/// The given language, or the language of the extension. Without either there is an error: advice about a guess would mislead.
fn language_of(module: &Path, asked: Option<Language>) -> Result<Language, String> {
    if module.is_dir() {
        return Ok(Language::Matlab);
    }
    let by_extension = module.extension().and_then(OsStr::to_str).and_then(Language::of_extension);
    asked.or(by_extension).ok_or_else(|| {
        let languages: Vec<&str> = Language::ALL.into_iter().map(Language::name).collect();
        format!(
            "{} does not say in its extension what language it is in: write `--language {}`",
            module.display(),
            languages.join("|")
        )
    })
}

/// A module of inverse kinematics.
fn postures(source: &Source, module: &Path, text: &str) -> Result<u8, u8> {
    input::manipulator(source, armgen_codegen::kinds::Scalar::F64, input::Warnings::Counted)?;
    let own = Origin::of(source);
    if let Some((file, input)) = companions::made_from(text).filter(|(_, input)| *input != own.hash) {
        let (module, description) = (module.display(), source.name());
        terminal::error(&format!(
            "{module} is of another description: it was made from {file} (input {input}), and {description} is (input {})",
            own.hash
        ));
        terminal::note("`armgen generate` with --ik writes it again, beside its module");
        return Err(FAULTY);
    }
    let mut report =
        with_spinner("verifying", || armgen_certify::verify_inverse_kinematics(source, text, inverse_kinematics::POSES));
    let beside = certificate_beside(module);
    let mut certificate = String::new();
    if beside.exists() {
        if input::written(&beside)?.text() != report.to_json() {
            report.faults.push(format!("{} says otherwise than what is found now, of these texts", beside.display()));
        }
        certificate = format!("certificate: {}\n", beside.display());
    }
    let code = terminal::print(&format!("{report}\n{certificate}"));
    match report.faults.first() {
        None => Ok(code),
        Some(fault) => {
            let (line, fault) = placed(text, Language::Rust, fault);
            let line = line.map_or(String::new(), |line| format!(":{line}"));
            terminal::error(&format!("{}{line}: {fault}", module.display()));
            Err(FAULTY)
        }
    }
}

/// The line that a fault is of, and the fault without it: the line that the reader gives, or where the function or constant begins.
fn placed(module: &str, language: Language, fault: &str) -> (Option<usize>, String) {
    if let Some((name, (line, reason))) = fault
        .split_once("line ")
        .filter(|(name, _)| {
            name.is_empty() || name.strip_suffix(": ").is_some_and(|name| line_of(module, name, language).is_some())
        })
        .and_then(|(name, rest)| Some((name, rest.split_once(": ")?)))
    {
        if let Ok(line) = line.parse() {
            return (Some(line), format!("{name}{reason}"));
        }
    }
    (line_of(module, fault, language), fault.to_string())
}

/// The line where the function or constant begins that a fault is of, counted from 1.
fn line_of(module: &str, fault: &str, language: Language) -> Option<usize> {
    if fault.starts_with("the head of the file") {
        return module.lines().position(|line| line.contains("@generated by armgen ")).map(|line| line + 1);
    }
    let name = fault.split(|c: char| c != '_' && !c.is_alphanumeric()).next()?;
    let is_constant = name.starts_with(|c: char| c.is_ascii_uppercase());
    let name = match language {
        Language::JavaScript if !is_constant => camel(name),
        Language::Matlab => camel(&name.to_ascii_lowercase()),
        _ => name.to_string(),
    };
    let (words, before): (&[&str], &str) = match language {
        Language::Rust => (&["pub fn ", "pub const "], ""),
        Language::C | Language::Cuda => (&["static inline ", "#define "], "_"),
        Language::JavaScript => (&["export function ", "export const "], ""),
        Language::Python => (&[if is_constant { "" } else { "def " }], ""),
        Language::Matlab => (&["function ", "    m."], ""),
    };
    // In C and in MATLAB a type or a result stands in between.
    let stands = |line: &str| match language {
        Language::C | Language::Cuda | Language::Matlab => line.find(&format!("{before}{name}")),
        _ => Some(0),
    };
    let begins = |line: &str| {
        let mut rest = words.iter().filter_map(|word| line.strip_prefix(word));
        rest.any(|rest| {
            let found = stands(rest).and_then(|at| rest[at..].strip_prefix(before)?.strip_prefix(name.as_str()));
            found.is_some_and(|behind| behind.starts_with(['(', ':', ' ']))
        })
    };
    module.lines().position(begins).map(|line| line + 1)
}

/// A report that passed, in a line.
pub(crate) fn summary(report: &Report) -> String {
    let worst = report.functions.iter().map(|f| f.log2_odds).fold(f64::NEG_INFINITY, f64::max);
    let functions = input::counted(report.functions.len(), "function");
    format!(
        "{functions} and {} equal the equations, odds of a miss below 2^{:.0}",
        input::counted(report.constants.len(), "constant"),
        worst.ceil()
    )
}

/// Work shorter than this shows no spinner.
const SPINNER_DELAY: Duration = Duration::from_secs(2);

/// Does `work`; a terminal shows a spinner with the elapsed time once it takes longer than [`SPINNER_DELAY`].
pub(crate) fn with_spinner<T>(what: &'static str, work: impl FnOnce() -> T) -> T {
    let (done, waiting) = channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            if waiting.recv_timeout(SPINNER_DELAY) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            // Drawn on a terminal only.
            let bar = ProgressBar::new_spinner();
            if let Ok(style) = ProgressStyle::with_template("  {spinner} {msg} {elapsed}") {
                bar.set_style(style);
            }
            bar.set_message(what);
            bar.enable_steady_tick(Duration::from_millis(120));
            let _ = waiting.recv();
            bar.finish_and_clear();
        });
        let value = work();
        drop(done);
        value
    })
}

/// Does `work` of so many parts, each of which calls its argument; a terminal shows a bar.
pub(crate) fn with_bar<T>(what: &'static str, parts: usize, work: impl FnOnce(&(dyn Fn() + Sync)) -> T) -> T {
    // Drawn on a terminal only.
    let bar = ProgressBar::new(parts as u64);
    if let Ok(style) = ProgressStyle::with_template("  {msg} [{bar:40}] {elapsed}") {
        bar.set_style(style);
    }
    bar.set_message(what);
    let value = work(&|| bar.inc(1));
    bar.finish_and_clear();
    value
}
