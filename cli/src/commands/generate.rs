//! `armgen generate`: the module as a file or on standard output, and its companion files on request.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use armgen_codegen::catalogue::Absent;
use armgen_codegen::diagnostic::Colour;
use armgen_codegen::emit::{Language, Origin};
use armgen_codegen::kinds::Scalar;
use armgen_codegen::pass::Pass;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_codegen::{Generated, Solver};
use armgen_texts::module::{self, Output};
use armgen_texts::rows;
use armgen_verify::certificate::Certificate;
use armgen_verify::read::reader::ModuleText;

use super::package::{Manifest, Package};
use super::verify::{certificate_beside, with_spinner};
use crate::output::{place, same_file, write};
use crate::{companions, file_names, input, terminal, ScalarName, TrigName, DONE, FAULTY, UNREADABLE};

/// What the module is to be.
#[derive(Debug, clap::Args)]
pub(crate) struct Choices {
    /// The language of the module (docs/languages.md)
    #[arg(long, default_value = Language::Rust.name(), value_parser = crate::language_parser())]
    language: Language,
    /// The floating-point type of the module
    #[arg(long, value_enum, default_value_t = ScalarName::F64)]
    scalar: ScalarName,
    /// Where the sines and cosines come from: libm unless chosen, in other languages than Rust fast
    #[arg(long, value_enum)]
    trig: Option<TrigName>,
    /// Passes to leave out, of those that make the functions cheaper (docs/passes.md), separated by commas
    #[arg(long, value_name = "PASSES", value_delimiter = ',', value_parser = crate::pass_parser())]
    without: Vec<Pass>,
    /// Add functions for many states, so many at a time: 8 suit f64, 16 suit f32 (docs/performance.md); not with --verify, --tests
    /// or --bounds, which are of functions for one state
    #[arg(long, value_name = "LANES", value_parser = clap::value_parser!(u16).range(1..=1024))]
    batch: Option<u16>,
    /// Fuse a multiplication with the addition that alone takes its product, which then rounds once: for processors that have
    /// the operation, in Rust and C (docs/performance.md)
    #[arg(long)]
    fma: bool,
    /// Functions of the module, separated by commas; all if none is named (`armgen count FILE` lists them); not with --tests,
    /// which are of the whole module
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    functions: Vec<String>,
}

/// Files beside the module.
#[derive(Debug, clap::Args)]
pub(crate) struct Beside {
    /// Verify the module and write the certificate beside it: robot.cert.json for robot.rs
    #[arg(long, conflicts_with = "batch")]
    verify: bool,
    /// Write a test file beside it, robot_test.rs: identities and reference values, run on your machine; robot_test.c,
    /// robot.test.mjs, test_robot.py, robotTest.m in other languages
    #[arg(long, conflicts_with_all = ["batch", "functions"])]
    tests: bool,
    /// Write a companion beside it, robot_bounds.rs: how far rounding can have taken each function's entries at a state; with
    /// --ik also how far an exact solution is from joint variables
    #[arg(long, conflicts_with = "batch")]
    bounds: bool,
    /// Write the implementation of the runtime's traits beside it, robot_runtime.rs, to be included where robot.rs is; with
    /// --ik that of InverseKinematics too, which looks for the module robot_ik beside the module robot
    #[arg(long)]
    runtime: bool,
    /// Write the C interface beside it: robot.h, and robot_c.rs to be included where robot.rs is; with --ik robot_ik.h and
    /// robot_ik_c.rs too
    #[arg(long)]
    c_abi: bool,
    /// Write a library of C and its module beside robot.py: robot_native.c and robot_native.py, for arrays of NumPy
    #[arg(long)]
    native: bool,
    /// Write inverse kinematics beside it, robot_ik.rs: all joint variables that reach a pose, in a module of its own; with
    /// --language c robot_ik.h, with --tests robot_ik_test.c too; of a named end effector robot_left_ik.rs
    #[arg(long)]
    ik: bool,
    /// Write nothing: compare the files with what would be written, and fail where one is missing or differs
    #[arg(long, requires = "out")]
    check: bool,
}

impl Choices {
    /// As the generator takes them; an error names functions that do not exist.
    fn options(&self) -> Result<Options, String> {
        let functions = match self.functions.as_slice() {
            [] => Selection::ALL,
            names => Selection::named(names).map_err(|unknown| unknown.to_string())?,
        };
        let scalar = match self.scalar {
            ScalarName::F64 => Scalar::F64,
            ScalarName::F32 => Scalar::F32,
        };
        let trig = match self.trig {
            None => Trig::of_language(self.language),
            Some(TrigName::Libm) => Trig::Libm,
            Some(TrigName::Std) => Trig::Std,
            Some(TrigName::Fast) => Trig::Fast,
        };
        let (without, batch) = (self.without.iter().copied().collect(), self.batch.map(usize::from));
        Ok(Options { scalar, trig, without, batch, functions, fuse: self.fma })
    }
}

impl Beside {
    /// The given options that need a file for the module.
    fn flags(&self) -> Vec<&'static str> {
        let all = [
            (self.verify, "--verify"),
            (self.tests, "--tests"),
            (self.bounds, "--bounds"),
            (self.runtime, "--runtime"),
            (self.c_abi, "--c-abi"),
            (self.native, "--native"),
            (self.ik, "--ik"),
        ];
        all.iter().filter(|(wanted, _)| *wanted).map(|(_, flag)| *flag).collect()
    }
}

pub(crate) fn run(file: &Path, out: Option<&Path>, choices: &Choices, beside: &Beside, manifest: &Manifest) -> u8 {
    let options = match choices.options() {
        Ok(options) => options,
        Err(unknown) => {
            terminal::error(&unknown);
            return UNREADABLE;
        }
    };
    let (language, scalar, trig, functions) = (choices.language, options.scalar, options.trig, &options.functions);
    if manifest.package && language != Language::C {
        terminal::error("--package goes with `--language c`: it is a package of the header for CMake and ROS 2");
        return UNREADABLE;
    }
    // A package is a folder, in which the header has a name of its own.
    let named = out.filter(|_| !manifest.package);
    if let Some(reason) = unfit(language, scalar, trig, named, choices, beside) {
        terminal::error(&reason);
        return UNREADABLE;
    }
    if let (None, Language::Matlab) = (out, language) {
        terminal::error("a package of MATLAB is a folder of files: say where it goes, with `--out +robot`");
        return UNREADABLE;
    }
    if out.is_none() && manifest.package {
        terminal::error("--package writes a folder: name it, with `--out robot_package`");
        return UNREADABLE;
    }
    if let (None, [first, ..]) = (out, beside.flags().as_slice()) {
        terminal::error(&format!(
            "{first} writes beside the module: say where that goes, with `--out {}`",
            module::file_of(language, "robot")
        ));
        return UNREADABLE;
    }
    let source = match input::description(file) {
        Ok(source) => source,
        Err(code) => return code,
    };
    let (generated, diagnostics) = armgen_codegen::generate(&source, &options);
    let mut generated = match input::report_or_exit_code(&source, generated, &diagnostics, input::Warnings::Counted) {
        Ok(generated) => generated,
        Err(code) => return code,
    };
    if !input::all_there(source.name(), &generated.absent, functions) {
        return FAULTY;
    }
    for solver in generated.solvers().filter(|_| beside.ik) {
        let solved = solver.solved();
        let Err(reason) = &solved.found else { continue };
        let of_it = solved.of_it();
        if solved.is_asked_for() {
            terminal::error(&format!(
                "nothing is written: the description asks for `inverse_kinematics`{of_it}, and there is none: {reason}"
            ));
            return FAULTY;
        }
        let remedy = match rows::solved(&source, solved.tip.as_deref()) {
            Some(_) => format!("; the rows that `armgen convert {} --convention standard` writes have one", source.name()),
            None => String::new(),
        };
        terminal::warning(&format!("there is no inverse kinematics{of_it}: {reason}{remedy}"));
    }
    // The bounds are those of one state at a time.
    if choices.batch.is_none() {
        if let Err(reason) = armgen_certify::document_bounds(&source, &mut generated) {
            terminal::warning(&format!("the documentation states no error bounds: {reason}"));
        }
    }
    let Some(out) = out else { return terminal::print(&generated.in_language(language)) };
    if same_file(file, out) {
        terminal::error(&format!("{} is the description: it would be overwritten; name another file", out.display()));
        return UNREADABLE;
    }
    let package = manifest.package.then(|| Package::new(out, armgen_codegen::emit::c::spelled(generated.name())));
    if let Some(reason) = package.as_ref().and_then(Package::blocked) {
        terminal::error(&reason);
        return UNREADABLE;
    }
    let header = package.as_ref().map(Package::header);
    let out = header.as_deref().unwrap_or(out);
    let mut files = match files(&Requested { source: &source, generated: &generated, language, scalar, out, beside }) {
        Ok(files) => files,
        Err(error) => {
            terminal::error(&error);
            return FAULTY;
        }
    };
    if let Some(package) = &package {
        package.complete(&mut files, &source, manifest);
        manifest.note().iter().for_each(|note| terminal::note(note));
    }
    if beside.check {
        return compared(&files, &source);
    }
    if let Err(error) = write_all(&files, file, (language == Language::Matlab).then_some(out)) {
        terminal::error(&error);
        return UNREADABLE;
    }
    if language == Language::Matlab {
        warn_of_others(out, &files);
    }
    warn_of_stale(&source, language, out, beside, &files);
    DONE
}

/// The files of a module, by their names; or why there are none.
pub(crate) fn in_memory(
    source: &Source,
    out: &Path,
    choices: &Choices,
    beside: &Beside,
    manifest: &Manifest,
) -> Result<Vec<(String, String)>, String> {
    if manifest.package || beside.check {
        return Err("--package and --check are of files on a disk".to_owned());
    }
    let options = choices.options()?;
    if let Some(reason) = unfit(choices.language, options.scalar, options.trig, Some(out), choices, beside) {
        return Err(reason);
    }
    let (generated, diagnostics) = armgen_codegen::generate(source, &options);
    let mut generated = generated.ok_or_else(|| diagnostics.render(source, Colour::Never))?;
    let absent = generated.absent.first().filter(|_| !options.functions.is_all());
    if let Some(Absent { function, reason }) = absent {
        return Err(format!("there is no `{function}` of this arm: {reason}"));
    }
    for solver in generated.solvers().filter(|_| beside.ik) {
        if let Err(reason) = &solver.solved().found {
            return Err(format!("there is no inverse kinematics{}: {reason}", solver.solved().of_it()));
        }
    }
    if choices.batch.is_none() {
        // Without them the documentation is shorter.
        let _ = armgen_certify::document_bounds(source, &mut generated);
    }
    let scalar = options.scalar;
    let made = files(&Requested { source, generated: &generated, language: choices.language, scalar, out, beside })?;
    let name = |path: PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(made.into_iter().map(|(path, text)| (name(path), text)).collect())
}

/// Compares files with what would be written, and names those that differ.
fn compared(files: &[Output], source: &Source) -> u8 {
    let mut code = DONE;
    for (path, text) in files {
        let why = match std::fs::read(path) {
            Ok(found) if found == text.as_bytes() => continue,
            Ok(found) => companions::why_different(&String::from_utf8_lossy(&found), source),
            Err(error) if error.kind() == ErrorKind::NotFound => "is missing".to_owned(),
            Err(error) => format!("cannot be read: {error}"),
        };
        terminal::error(&format!("{} {why}", path.display()));
        code = FAULTY;
    }
    terminal::note(&match code {
        DONE => format!("{} as the description gives them", input::counted(files.len(), "file")),
        _ => "the same command without `--check` writes all of its files again".to_owned(),
    });
    code
}

/// Warns of companion files that remain from an earlier module.
fn warn_of_stale(source: &Source, language: Language, out: &Path, beside: &Beside, files: &[Output]) {
    let certificate = certificate_beside(out);
    if !beside.verify && certificate.exists() {
        terminal::warning(&format!(
            "{} was not written again and may be of another module: --verify renews it",
            certificate.display()
        ));
    }
    let hash = Origin::of(source).hash;
    let others = companions::beside(out, language).into_iter().filter(|(path, _)| files.iter().all(|(own, _)| own != path));
    for (path, flag) in others.filter(|(path, _)| companions::is_of_another(path, language, &hash)) {
        terminal::warning(&format!(
            "{} was not written again and is of another description: {flag} renews it, or remove it",
            path.display()
        ));
    }
}

/// Writes files to different places, never over the description; creates `folder` if absent.
fn write_all(files: &[Output], description: &Path, folder: Option<&Path>) -> Result<(), String> {
    let mut taken = BTreeSet::from([place(description)]);
    for (path, _) in files {
        if !taken.insert(place(path)) {
            let path = path.display();
            return Err(format!(
                "two of the files to write would both be {path}, or it is the description: choose another name for --out"
            ));
        }
    }
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        std::fs::create_dir(folder).map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
    }
    files
        .iter()
        .try_for_each(|(path, text)| write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display())))
}

/// Warns of files in the folder of a package that do not belong to it: they could hide a function.
fn warn_of_others(folder: &Path, files: &[Output]) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut others: Vec<PathBuf> = entries.filter(|path| files.iter().all(|(own, _)| own != path)).collect();
    others.sort();
    for path in others {
        terminal::warning(&format!(
            "{} is not of this module: remove it, or it is taken for one of its functions",
            path.display()
        ));
    }
}

/// Why a module cannot be generated in a language as asked, and what to do instead.
fn unfit(
    language: Language,
    scalar: Scalar,
    trig: Trig,
    out: Option<&Path>,
    choices: &Choices,
    beside: &Beside,
) -> Option<String> {
    let title = language.title();
    if let Some(reason) = out.and_then(|out| file_names::unfit(language, out)) {
        return Some(reason);
    }
    if beside.native && language != Language::Python {
        return Some("--native goes with `--language python`: it is a library that Python loads".into());
    }
    if language == Language::Rust {
        return None;
    }
    let only_rust = [
        (beside.bounds, "--bounds", "its companion is Rust"),
        (beside.runtime, "--runtime", "the runtime is Rust"),
        (beside.c_abi, "--c-abi", "it is the face for C of a module in Rust"),
        (beside.ik && !language.is_c(), "--ik", "inverse kinematics is written in Rust and in C"),
        (beside.tests && language == Language::Cuda, "--tests", "a test needs no GPU: `--language c` writes the same functions with one"),
        (
            choices.batch.is_some() && language != Language::C,
            "--batch",
            "functions for many states are written for Rust and C; JavaScript calls one after the other, CUDA has kernels, the others take arrays of states",
        ),
        (choices.fma && !language.is_c(), "--fma", "a fused operation is written in Rust and C"),
        (trig == Trig::Libm, "--trig libm", "the crate libm is Rust's: take `--trig fast` or `--trig std`"),
    ];
    if let Some((_, flag, why)) = only_rust.iter().find(|(asked, ..)| *asked) {
        return Some(format!("{flag} does not go with `--language {}`: {why}", language.name()));
    }
    match language.scalars().contains(&scalar) {
        true => None,
        false => Some(format!("{title} has no single precision: leave `--scalar f32` out")),
    }
}

/// A module and its requested companions.
struct Requested<'a> {
    source: &'a Source,
    generated: &'a Generated,
    language: Language,
    scalar: Scalar,
    /// The file, or folder, of the module.
    out: &'a Path,
    beside: &'a Beside,
}

/// All files to write, the module first; or why none is written.
fn files(requested: &Requested) -> Result<Vec<Output>, String> {
    let Requested { generated, language, out, beside, .. } = requested;
    let mut files = module::files(generated, *language, out);
    if beside.verify {
        files.push(requested.certificate()?);
    }
    if beside.tests {
        files.extend(requested.tests()?);
    }
    if beside.ik {
        files.extend(requested.inverse_kinematics()?);
    }
    if beside.bounds {
        files.push(requested.bounds()?);
    }
    if beside.runtime {
        files.push(requested.runtime());
    }
    if beside.c_abi {
        files.extend(requested.c_abi());
    }
    if beside.native {
        let native = generated.native();
        files.push(requested.file("_native.py", native.python));
        files.push(requested.file("_native.c", native.c));
    }
    Ok(files)
}

impl Requested<'_> {
    /// The name of the module's file without its extension.
    fn stem(&self) -> String {
        module::stem(self.out)
    }

    /// A companion file, named after the module.
    fn file(&self, ending: &str, text: String) -> Output {
        (module::beside(self.out, ending), text)
    }

    /// The certificate of the module, without which nothing is written.
    fn certificate(&self) -> Result<Output, String> {
        let report = with_spinner("verifying", || armgen_certify::certify_in(self.source, self.generated, self.language));
        if let Some(function) = report.beyond_the_scalar() {
            let diagnostics = armgen_certify::beyond_the_scalar(self.source, function, self.scalar);
            return Err(format!(
                "nothing is written: its errors have no bound\n{}",
                diagnostics.render(self.source, Colour::Never).trim_end()
            ));
        }
        if let Some(fault) = report.first_fault() {
            return Err(format!(
                "nothing is written: the module does not equal the equations, {fault}; this is a fault of armgen"
            ));
        }
        let certificate = certificate_beside(self.out);
        terminal::note(&format!("{}; {}", super::verify::summary(&report), certificate.display()));
        Ok((certificate, Certificate::of(&report).to_json()))
    }

    /// Tests of the module at reference values, and of postures.
    fn tests(&self) -> Result<Vec<Output>, String> {
        let Requested { source, generated, language, out, beside, .. } = self;
        let stem = self.stem();
        let name = out.file_name().unwrap_or_default().to_string_lossy();
        let extension = out.extension().unwrap_or_default().to_string_lossy();
        let package = stem.trim_start_matches('+');
        let (file, taken_in) = match language {
            Language::Rust => (format!("{stem}_test.rs"), format!("#[path = {name:?}]\nmod robot;")),
            Language::C | Language::Cuda => (format!("{stem}_test.c"), name.to_string()),
            Language::JavaScript => (format!("{stem}.test.{extension}"), name.to_string()),
            Language::Python => (format!("test_{stem}.py"), stem.clone()),
            Language::Matlab => (format!("{package}Test.m"), package.to_owned()),
        };
        let mut tests = with_spinner("computing reference values", || match *language {
            Language::Rust => armgen_verify::test_kit(source, &generated.module, &taken_in),
            language => {
                let text = generated.in_language(language);
                armgen_verify::test_kit_in(source, ModuleText { language, text: &text }, &taken_in)
            }
        })?;
        let mut files = Vec::new();
        match language {
            Language::Rust if beside.ik => {
                generated.solvers().for_each(|solver| tests += &solver.test(&format!("{stem}_ik.rs")));
            }
            Language::C if beside.ik => {
                for solver in generated.solvers() {
                    let test = solver.test_in_c(&name, &format!("{stem}_ik.h"));
                    files.extend(test.map(|test| self.file("_ik_test.c", test)));
                }
            }
            _ => {}
        }
        files.push((out.with_file_name(file), tests));
        Ok(files)
    }

    /// The modules of inverse kinematics, one for each end effector, and their certificates on request.
    fn inverse_kinematics(&self) -> Result<Vec<Output>, String> {
        let mut files = Vec::new();
        for solver in self.generated.solvers() {
            let (file, text) = module::inverse_kinematics(&solver, self.language, self.out)?;
            if self.beside.verify {
                let poses = armgen_verify::inverse_kinematics::POSES;
                let report = with_spinner("verifying", || armgen_certify::verify_inverse_kinematics(self.source, &text, poses));
                if let Some(fault) = report.faults.first() {
                    return Err(format!(
                        "nothing is written: the module of inverse kinematics is not verified, {fault}; this is a fault of armgen"
                    ));
                }
                let certificate = certificate_beside(&file);
                terminal::note(&format!("{}; {}", report.summary(), certificate.display()));
                files.push((certificate, report.to_json()));
            }
            files.push((file, text));
        }
        Ok(files)
    }

    /// The error bounds at a state.
    fn bounds(&self) -> Result<Output, String> {
        let module = format!("use super::{}::*;", validate::module_name(&self.stem()));
        let mut companion = armgen_certify::companion(self.generated, &module)?;
        let is_of_pose_alone = |solver: Solver<'_>| solver.solved().found.as_ref().is_ok_and(|found| found.redundancy.is_none());
        if self.beside.ik && self.generated.solvers().any(is_of_pose_alone) {
            companion += &armgen_certify::companion_of_inverse_kinematics(self.generated)?;
        }
        Ok(self.file("_bounds.rs", companion))
    }

    /// The traits of the runtime.
    fn runtime(&self) -> Output {
        let text = match self.beside.ik {
            true => self.generated.runtime_with_inverse_kinematics(&validate::module_name(&format!("{}_ik", self.stem()))),
            false => self.generated.runtime.clone(),
        };
        self.file("_runtime.rs", text)
    }

    /// Header and wrappers for calls from C into the module in Rust.
    fn c_abi(&self) -> Vec<Output> {
        let mut files = vec![
            (self.out.with_extension("h"), self.generated.c.header.clone()),
            self.file("_c.rs", self.generated.c.wrappers.clone()),
        ];
        let header = format!("{}.h", self.stem());
        if let Some(face) = self.beside.runtime.then(|| self.generated.laws_for_c(&header)).flatten() {
            files.push(self.file("_laws.h", face.header));
            files.push(self.file("_laws_c.rs", face.wrappers));
        }
        for solver in self.generated.solvers().filter(|_| self.beside.ik) {
            let Some(face) = solver.for_c() else { continue };
            files.push(self.file(&format!("{}_ik.h", solver.infix()), face.header));
            files.push(self.file(&format!("{}_ik_c.rs", solver.infix()), face.wrappers));
        }
        files
    }
}
