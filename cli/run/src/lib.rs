//! The command `run`: experiments on a robot, or a demonstration.
//!
//! The order: read all files; linearise every sampled loop and report unstable loops; then run, draw, and compare with expectations.

#[cfg(feature = "any-arm")]
mod any_arm;
mod page;

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

use armgen_description::source::Source;
use armgen_experiments::campaign::{self, in_parallel, Job};
use armgen_experiments::draw::{self, OutputFile};
use armgen_experiments::model::{number, Channel, Experiment, JointQuantity, Quantity, Record, Robot, Unit};
use armgen_experiments::read::{self, Parsed};
use armgen_experiments::run::Arm;
use indicatif::{ProgressBar, ProgressStyle};

use armgen_terminal::output::place;
use armgen_terminal::table::{Align, Table};
use armgen_terminal::{self as terminal, input, DONE, FAULTY, UNREADABLE};

#[cfg(feature = "any-arm")]
pub use any_arm::any_arm;

/// Runs the experiments for this robot, or a demonstration if there are no experiments.
pub fn run(files: &[PathBuf], out: &Path, arm: &dyn Arm, description: &Source) -> u8 {
    let named = named(files);
    let Files { experiments, others, paths, read, code } = read_all(&named, arm.robot());
    let built = &arm.robot().name;
    for (robot, count) in &others {
        let what = input::counted(*count, "experiment");
        terminal::note(&format!("{what} skipped: for the robot `{robot}`, and the arm here is `{built}`"));
    }
    match paths.as_slice() {
        [] => {}
        [path, more @ ..] if experiments.is_empty() && others.is_empty() && code == DONE => {
            let said = match more.len() {
                0 => "is a path, not an experiment: name the experiment that follows it".to_owned(),
                more => format!("and {more} more are paths, not experiments: name the experiments that follow them"),
            };
            terminal::error(&format!("{} {said}", path.display()));
            return FAULTY;
        }
        [first, more @ ..] => {
            let and = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
            terminal::note(&format!("{}{and} skipped: a path, which experiments name", first.display()));
        }
    }
    match (experiments.as_slice(), code) {
        // The error of a faulty or missing file is the result; otherwise there is nothing to run.
        ([], DONE) => demonstrate(arm, out, description),
        ([], code) => code,
        (experiments, code) => {
            let other = described_otherwise(&named, &arm.robot().name, description);
            code.max(run_all(experiments, &read, arm, out, description, other.as_deref()))
        }
    }
}

/// The description `robots/NAME.yaml` beside the folder of an experiment, if the arm at hand has its name and another description: the expectations
/// then belong to another robot.
fn described_otherwise(files: &[PathBuf], name: &str, description: &Source) -> Option<PathBuf> {
    let beside = |file: &PathBuf| Some(file.parent()?.parent()?.join("robots").join(format!("{name}.yaml")));
    let known: BTreeSet<PathBuf> = files.iter().filter_map(beside).collect();
    known.into_iter().find(|known| text_of(known).is_ok_and(|text| content(&text) != content(description.text())))
}

/// The lines of a description without comments.
fn content(text: &str) -> Vec<&str> {
    let lines = text.lines().map(|line| match line.split_once(" #") {
        Some((before, _)) => before.trim_end(),
        None => line.trim_end(),
    });
    lines.filter(|line| !line.is_empty() && !line.starts_with('#')).collect()
}

/// The files to run: the named files, or the experiments of the working directory, sorted by name.
fn named(files: &[PathBuf]) -> Vec<PathBuf> {
    if !files.is_empty() {
        return files.to_vec();
    }
    let Ok(entries) = std::fs::read_dir("experiments") else { return Vec::new() };
    let yaml = |path: &PathBuf| path.is_file() && path.extension().is_some_and(|ending| ending == "yaml");
    let mut found: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(yaml).collect();
    found.sort();
    found
}

/// The results of reading the files.
struct Files {
    experiments: Vec<Experiment>,
    /// Other robots with the number of their files.
    others: Vec<(String, usize)>,
    /// The files that are paths.
    paths: Vec<PathBuf>,
    /// The locations of all files read, including paths of experiments.
    read: BTreeSet<PathBuf>,
    code: u8,
}

/// Reads all files; reports their faults on standard error.
fn read_all(files: &[PathBuf], robot: &Robot) -> Files {
    let mut all = Files { experiments: Vec::new(), others: Vec::new(), paths: Vec::new(), read: BTreeSet::new(), code: DONE };
    let mut read: Vec<&PathBuf> = Vec::new();
    let opened = RefCell::new(BTreeSet::new());
    let open = |path: &Path| {
        opened.borrow_mut().insert(place(path));
        text_of(path)
    };
    for file in files {
        let source = match input::source(file) {
            Ok(source) => source,
            Err(unreadable) => {
                all.code = all.code.max(unreadable);
                continue;
            }
        };
        match read::experiment(file, &source, robot, &open) {
            Parsed::Experiment(experiment) => match all.experiments.iter().position(|known| known.name == experiment.name) {
                Some(first) => {
                    let (name, first, second) = (&experiment.name, read[first].display(), file.display());
                    terminal::error(&format!(
                        "{second} is not run: its figures and logs would be those of {first}, `{name}` as well; rename it, or run it by itself with another --out"
                    ));
                    all.code = all.code.max(FAULTY);
                }
                None => {
                    read.push(file);
                    all.experiments.push(*experiment);
                }
            },
            Parsed::OtherRobot(robot) => match all.others.iter_mut().find(|(known, _)| *known == robot) {
                Some((_, count)) => *count += 1,
                None => all.others.push((robot, 1)),
            },
            Parsed::Path => all.paths.push(file.clone()),
            Parsed::Faulty(faulty) => {
                let colour = terminal::colour(&std::io::stderr());
                for (source, diagnostics) in &faulty {
                    terminal::diagnose(&diagnostics.render(source, colour));
                }
                let count = faulty.iter().map(|(_, diagnostics)| diagnostics.errors()).sum();
                terminal::error(&format!("{}: {}", source.name(), input::counted(count, "error")));
                all.code = all.code.max(FAULTY);
            }
        }
    }
    all.read = opened.into_inner();
    all.read.extend(files.iter().map(|file| place(file)));
    all
}

/// The text of a file that an experiment names. It reads at most a byte more than the limit, so the reader can report the excess and
/// an endless file does not block.
fn text_of(path: &Path) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(read::MAX_TEXT as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > read::MAX_TEXT {
        // The cut may split a character. Its replacement is no shorter, so the text is still too long.
        return Ok(String::from_utf8_lossy(&bytes).into_owned());
    }
    input::decoded(bytes).map_err(|fault| std::io::Error::new(std::io::ErrorKind::InvalidData, format!("it {fault}")))
}

/// Runs, draws and judges. `other`: the description of another robot, to which the expectations belong.
fn run_all(
    experiments: &[Experiment],
    read: &BTreeSet<PathBuf>,
    arm: &dyn Arm,
    out: &Path,
    description: &Source,
    other: Option<&Path>,
) -> u8 {
    if let Err(error) = std::fs::create_dir_all(out) {
        terminal::error(&format!("cannot create {}: {error}", out.display()));
        return UNREADABLE;
    }
    let begun = Instant::now();
    let mut jobs: Vec<Job<'_>> = experiments.iter().map(|experiment| Job::new(experiment, arm)).collect();
    let bar = progress(jobs.len() as u64 * 2);
    in_parallel(&mut jobs, |job| {
        job.prepare();
        bar.inc(1);
    });
    for job in &jobs {
        for warning in job.implausible_settings().into_iter().chain(job.warning()) {
            bar.suspend(|| terminal::warning(&format!("{}: {warning}", job.experiment().name)));
        }
    }
    in_parallel(&mut jobs, |job| {
        job.run();
        bar.inc(1);
    });
    bar.finish_and_clear();
    let groups = campaign::groups(&jobs);
    let drawn = groups.len() + jobs.iter().map(|job| job.figures().len()).sum::<usize>();
    let (mut code, mut written) = (DONE, 0);
    let mut taken = BTreeSet::from(["index.html".to_owned()]);
    for OutputFile { name, text } in jobs.iter().map(Job::log).chain(jobs.iter().flat_map(Job::figures).cloned()).chain(groups) {
        // Figures of different experiments can have the same name: `a_trace`, and the trace of `a`.
        if !taken.insert(name.clone()) || read.contains(&place(&out.join(&name))) {
            let path = out.join(name);
            terminal::error(&format!(
                "{} is not written: it would be written over another figure, or over a file that was read; rename the experiment, or run it by itself with another --out",
                path.display()
            ));
            code = code.max(FAULTY);
            continue;
        }
        match std::fs::write(out.join(&name), text) {
            Ok(()) => written += 1,
            Err(error) => {
                terminal::error(&format!("cannot write {}: {error}", out.join(name).display()));
                code = UNREADABLE;
            }
        }
    }
    let (text, met) = report(&jobs);
    code = code.max(terminal::print(&(peaks(&jobs, arm.robot()) + &text)));
    let (simulated, took) = jobs
        .iter()
        .map(|job| job.record().speed)
        .fold((0.0, 0.0), |(simulated, took), speed| (simulated + speed.simulated, took + speed.took));
    let speed = if took > 0.0 {
        format!(", {simulated:.0} s of motion simulated {:.0} times faster than real time", simulated / took)
    } else {
        String::new()
    };
    let seconds = begun.elapsed().as_secs_f64();
    if written == drawn + jobs.len() {
        let (figures, logs) = (input::counted(drawn, "figure"), input::counted(jobs.len(), "log"));
        terminal::note(&format!("{figures} and {logs} in {}; {seconds:.1} s{speed}", out.display()));
    }
    let runs = page::of_jobs(&jobs);
    code = code.max(page::write_index(out, description, &runs));
    match other {
        _ if met => code,
        Some(known) => {
            let (name, known) = (&arm.robot().name, known.display());
            terminal::note(&format!(
                "the expectations belong to another robot: {known} describes another `{name}` than the arm here; give yours a `name` of its own"
            ));
            code
        }
        None => code.max(FAULTY),
    }
}

fn progress(steps: u64) -> ProgressBar {
    // Visible only on a terminal.
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("  [{bar:30}] {pos}/{len} {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// Peak rates and efforts of the joints with limits; marks exceeded limits.
fn peaks(jobs: &[Job<'_>], robot: &Robot) -> String {
    use Align::{Left, Right};
    let mut table = Table::new([
        ("experiment", Left),
        ("joint", Left),
        ("largest rate", Right),
        ("limit", Right),
        ("", Left),
        ("largest effort", Right),
        ("limit", Right),
        ("", Left),
    ]);
    let mut rows = 0;
    for job in jobs {
        let mut name = job.experiment().name.clone();
        for (joint, peak) in robot.joints.iter().zip(&job.record().peaks) {
            if joint.velocity.is_infinite() && joint.effort.is_infinite() {
                continue;
            }
            let beside = |found: f64, limit: f64, unit: Unit| match limit.is_finite() {
                true => [
                    format!("{found:.3} {unit}"),
                    format!("{} {unit}", number(limit)),
                    if found > limit { "BEYOND".to_owned() } else { String::new() },
                ],
                false => [format!("{found:.3} {unit}"), String::new(), String::new()],
            };
            let [rate, most, fast] = beside(peak.rate, joint.velocity, joint.rate_unit());
            let [effort, strongest, hard] = beside(peak.effort, joint.effort, joint.effort_unit());
            table.row([std::mem::take(&mut name), joint.name.clone(), rate, most, fast, effort, strongest, hard]);
            rows += 1;
        }
    }
    if rows == 0 {
        String::new()
    } else {
        table.text() + "\n"
    }
}

/// The table of results, and whether all results are as expected.
fn report(jobs: &[Job<'_>]) -> (String, bool) {
    let columns = [
        ("experiment", Align::Left),
        ("quantity", Align::Left),
        ("found", Align::Right),
        ("unit", Align::Left),
        ("expected", Align::Left),
        ("", Align::Left),
    ];
    let mut table = Table::new(columns);
    let (mut total, mut met) = (0, 0);
    let mut unjudged = Vec::new();
    for job in jobs {
        let lines = job.lines();
        if lines.is_empty() {
            unjudged.push(job.experiment().name.as_str());
        }
        for (i, line) in lines.into_iter().enumerate() {
            total += 1;
            met += usize::from(line.met);
            let name = if i == 0 { job.experiment().name.clone() } else { String::new() };
            let verdict = if line.met { "ok" } else { "OUTSIDE" };
            table.row([name, line.what, line.found, line.unit.to_string(), line.expected, verdict.into()]);
        }
    }
    let judged = format!("{}\n{met} of {total} results as expected\n", table.text());
    let mut text = if total == 0 { String::new() } else { judged };
    if !unjudged.is_empty() {
        text += &format!("without `expect`, drawn and not judged: {}\n", unjudged.join(", "));
    }
    (text, met == total)
}

fn demonstrate(arm: &dyn Arm, out: &Path, description: &Source) -> u8 {
    let robot = arm.robot();
    let demonstration = match arm.demonstrate() {
        Ok(demonstration) => demonstration,
        Err(reason) => {
            terminal::error(&reason);
            return FAULTY;
        }
    };
    let title = format!("{}: a demonstration of the arm", robot.name);
    let title = terminal::bold(&title, &std::io::stdout());
    let summary: String = demonstration.summary.iter().map(|line| format!("  {line}\n")).collect();
    let joints = input::counted(robot.dof(), "joint");
    let mut text = format!("{title} ({joints})\n\n{summary}\n{}", joint_table(&demonstration.record, robot));
    let mut csv = String::new();
    demonstration.record.log().write_csv(&mut csv).expect("writing to a string");
    let mut code = DONE;
    for (name, content) in [("demonstration.svg", draw::demonstration(&demonstration.record, robot)), ("demonstration.csv", csv)]
    {
        let file = out.join(name);
        match std::fs::create_dir_all(out).and_then(|()| std::fs::write(&file, content)) {
            Ok(()) => text += &format!("\n  {}", file.display()),
            Err(reason) => {
                terminal::error(&format!("cannot write {}: {reason}", file.display()));
                code = UNREADABLE;
            }
        }
    }
    text += "\n";
    code = code.max(terminal::print(&text));
    code = code.max(page::write_index(out, description, &[page::of_demonstration(&demonstration.record, robot)]));
    if let Some(fault) = demonstration.fault {
        terminal::error(&fault);
        code = code.max(FAULTY);
    }
    code
}

/// A table of each joint's range, errors, peak rate and peak effort.
fn joint_table(record: &Record, robot: &Robot) -> String {
    use Align::{Left, Right};
    let mut table = Table::new([
        ("joint", Left),
        ("from", Right),
        ("to", Right),
        ("largest error", Right),
        ("error at end", Right),
        ("largest rate", Right),
        ("largest effort", Right),
    ]);
    for (i, joint) in robot.joints.iter().enumerate() {
        let of = |of: JointQuantity| Channel::new(Quantity::Joint(of, i), robot);
        let peak = |channel: &Channel| record.log().peak(&channel.name, |_| true).unwrap_or(f64::NAN);
        let [q, e, dq, tau] = [JointQuantity::Position, JointQuantity::Error, JointQuantity::Rate, JointQuantity::Effort].map(of);
        let low = record.log().lowest(&q.name, |_| true).unwrap_or(f64::NAN);
        let high = record.log().highest(&q.name, |_| true).unwrap_or(f64::NAN);
        let last = record.values(e.quantity).last().copied().unwrap_or(f64::NAN).abs();
        table.row([
            format!("{} {}", i + 1, joint.name),
            format!("{low:.4} {}", q.unit),
            format!("{high:.4} {}", q.unit),
            format!("{:.2e} {}", peak(&e), e.unit),
            format!("{last:.2e} {}", e.unit),
            format!("{:.4} {}", peak(&dq), dq.unit),
            format!("{:.3} {}", peak(&tau), tau.unit),
        ]);
    }
    table.text()
}
