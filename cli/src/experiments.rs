//! Experiments as data: files in YAML, run on the robot that this program was built with.
//!
//! ```text
//! file.rs         text -> Experiment, every fault with its place     motion.rs: path files    reader.rs: keys, numbers, words
//! expectation.rs  a quantity, the number taken of it, what it should be
//! record.rs       what a run leaves behind
//! manipulability.rs, motion_check.rs, clik.rs, control.rs             one kind of run each
//! ```
//!
//! The order of a run: read all files; linearise every sampled loop and say which are unstable; only then move; draw; judge.

mod clik;
mod control;
mod expectation;
mod fault;
mod file;
mod manipulability;
mod motion;
mod motion_check;
mod reader;
mod record;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;
use std::time::Instant;

use armgen_generated::NAME;
use indicatif::{ProgressBar, ProgressStyle};

use crate::table::{Align, Table};
use crate::{figures, input, terminal, DONE, FAULTY};
use expectation::Line;
use file::Parsed;

pub(crate) use file::{task_rows, Body, ControlRun, Experiment, Joints, Postures};
pub(crate) use manipulability::{ellipses, plane_name};
pub(crate) use motion::Motion;
pub(crate) use record::Record;

/// What came of the experiments.
pub(crate) enum Outcome {
    /// They were run: the exit code.
    Ran(u8),
    /// None of them is for the robot that this program was built with.
    NoneForThisRobot,
}

/// One experiment and what is known of it.
struct Job {
    experiment: Experiment,
    prepared: Option<Result<control::Prepared, String>>,
    record: Record,
    trouble: Option<String>,
    figures: usize,
}

/// Runs the experiments of `files`, all of `experiments/` if there are none; figures and logs go to `out`.
pub(crate) fn run(files: &[PathBuf], out: &Path) -> Outcome {
    let files = match named(files) {
        Ok(files) => files,
        Err(code) => return Outcome::Ran(code),
    };
    let begun = Instant::now();
    let (mut jobs, mut code) = (Vec::new(), DONE);
    let mut others: Vec<(String, usize)> = Vec::new();
    let mut read: Vec<(String, PathBuf)> = Vec::new();
    for file in &files {
        let source = match input::source(file) {
            Ok(source) => source,
            Err(unreadable) => {
                code = code.max(unreadable);
                continue;
            }
        };
        match file::parse(file, &source, terminal::colour(&std::io::stderr())) {
            Parsed::Experiment(experiment) => match read.iter().find(|(name, _)| *name == experiment.name) {
                Some((name, first)) => {
                    let (first, second) = (first.display(), file.display());
                    terminal::error(&format!(
                        "{second} is not run: its figures and logs would be those of {first}, `{name}` as well; rename it, or run it by itself with another --out"
                    ));
                    code = code.max(FAULTY);
                }
                None => {
                    read.push((experiment.name.clone(), file.clone()));
                    jobs.push(Job::new(*experiment));
                }
            },
            Parsed::OtherRobot(robot) => match others.iter_mut().find(|(known, _)| *known == robot) {
                Some((_, count)) => *count += 1,
                None => others.push((robot, 1)),
            },
            Parsed::Faulty(text, count) => {
                terminal::diagnose(&text);
                terminal::error(&format!("{}: {}", source.name(), input::counted(count, "error")));
                code = code.max(FAULTY);
            }
        }
    }
    for (robot, count) in &others {
        let what = input::counted(*count, "experiment");
        terminal::note(&format!("{what} skipped: for the robot `{robot}`, and this program was built with `{NAME}`"));
    }
    if jobs.is_empty() {
        // A file that is faulty or absent is the answer; without any there is nothing to run.
        return if code == DONE { Outcome::NoneForThisRobot } else { Outcome::Ran(code) };
    }
    if let Err(error) = std::fs::create_dir_all(out) {
        terminal::error(&format!("cannot create {}: {error}", out.display()));
        return Outcome::Ran(crate::UNREADABLE);
    }
    let bar = progress(jobs.len() as u64 * 2);
    in_parallel(&mut jobs, |job| {
        job.prepare();
        bar.inc(1);
    });
    for job in &jobs {
        if let Some(warning) = job.warning() {
            bar.suspend(|| terminal::warning(&format!("{}: {warning}", job.experiment.name)));
        }
    }
    in_parallel(&mut jobs, |job| {
        job.run(out);
        bar.inc(1);
    });
    bar.finish_and_clear();
    let mut drawn: usize = jobs.iter().map(|job| job.figures).sum();
    let all: Vec<(&Experiment, &Record)> = jobs.iter().map(|job| (&job.experiment, &job.record)).collect();
    match figures::groups(&all, out) {
        Ok(count) => drawn += count,
        Err(error) => {
            terminal::error(&error);
            code = code.max(FAULTY);
        }
    }
    let (text, met) = report(&jobs);
    code = code.max(terminal::print(&text));
    let (simulated, took) = jobs.iter().fold((0.0, 0.0), |sum, job| (sum.0 + job.record.speed.0, sum.1 + job.record.speed.1));
    let speed = if took > 0.0 {
        format!(", {simulated:.0} s of motion simulated {:.0} times faster than real time", simulated / took)
    } else {
        String::new()
    };
    let seconds = begun.elapsed().as_secs_f64();
    terminal::note(&format!(
        "{} and {} in {}; {seconds:.1} s{speed}",
        input::counted(drawn, "figure"),
        input::counted(jobs.len(), "log"),
        out.display()
    ));
    Outcome::Ran(if met { code } else { code.max(FAULTY) })
}

/// The files to run: those named, or the experiments of the working directory, in the order of their names.
fn named(files: &[PathBuf]) -> Result<Vec<PathBuf>, u8> {
    if !files.is_empty() {
        return Ok(files.to_vec());
    }
    let Ok(entries) = std::fs::read_dir("experiments") else { return Ok(Vec::new()) };
    let yaml = |path: &PathBuf| path.is_file() && path.extension().is_some_and(|ending| ending == "yaml");
    let mut found: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(yaml).collect();
    found.sort();
    Ok(found)
}

fn progress(steps: u64) -> ProgressBar {
    // Drawn on a terminal only.
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("  [{bar:30}] {pos}/{len} {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// Does `work` on every job, on all processors; the longest first.
fn in_parallel(jobs: &mut [Job], work: impl Fn(&mut Job) + Sync) {
    let mut queue: Vec<&mut Job> = jobs.iter_mut().collect();
    queue.sort_by_key(|job| std::cmp::Reverse(job.effort()));
    let queue: Vec<Mutex<&mut Job>> = queue.into_iter().map(Mutex::new).collect();
    let next = AtomicUsize::new(0);
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(queue.len());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(job) = queue.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if let Ok(mut job) = job.lock() {
                        work(&mut job);
                    }
                }
            });
        }
    });
}

impl Job {
    fn new(experiment: Experiment) -> Job {
        Job { experiment, prepared: None, record: Record::default(), trouble: None, figures: 0 }
    }

    /// Roughly how long it takes, in steps.
    fn effort(&self) -> u64 {
        match &self.experiment.body {
            Body::Postures(_) => 0,
            Body::Path(_) => 1,
            Body::Clik(_) => 2,
            Body::Control(run) => 10 * u64::from(run.substeps),
        }
    }

    fn prepare(&mut self) {
        if let Body::Control(run) = &self.experiment.body {
            let delayed = self.experiment.expect.iter().any(|e| e.quantity.value == "radius_delayed");
            self.prepared = Some(control::prepare(run, delayed));
        }
    }

    fn warning(&self) -> Option<String> {
        match (&self.experiment.body, &self.prepared) {
            (Body::Control(run), Some(Ok(prepared))) => prepared.warning(run),
            _ => None,
        }
    }

    fn run(&mut self, out: &Path) {
        self.record = match (&self.experiment.body, &self.prepared) {
            (Body::Postures(postures), _) => manipulability::run(postures),
            (Body::Path(sampling), _) => motion_check::run(sampling),
            (Body::Clik(run), _) => clik::run(run),
            (Body::Control(run), Some(Ok(prepared))) => control::run(run, prepared),
            (Body::Control(_), Some(Err(error))) => Record { ended: Some(error.clone()), ..Record::default() },
            (Body::Control(_), None) => Record::default(),
        };
        let csv = out.join(format!("{}.csv", self.experiment.name));
        let written = std::fs::write(&csv, self.record.csv()).map_err(|error| format!("cannot write {}: {error}", csv.display()));
        match written.and_then(|()| figures::draw(&self.experiment, &self.record, out)) {
            Ok(count) => self.figures = count,
            Err(error) => self.trouble = Some(error),
        }
    }

    /// The lines of the table; an early end that nothing accounts for is one of them.
    fn lines(&self) -> Vec<Line> {
        let Experiment { expect, .. } = &self.experiment;
        let mut lines: Vec<Line> = expect.iter().map(|e| e.judge(&self.record.log, &self.record.singles)).collect();
        let accounted = expect.iter().any(|e| e.quantity.value == "lost_at");
        if let Some(ended) = self.record.ended.as_ref().filter(|_| !accounted) {
            lines.push(Line {
                what: "runs to the end".into(),
                found: ended.clone(),
                unit: "",
                expected: "yes".into(),
                met: false,
            });
        }
        if let Some(trouble) = &self.trouble {
            lines.push(Line { what: "files".into(), found: trouble.clone(), unit: "", expected: "written".into(), met: false });
        }
        lines
    }
}

/// The table of results, and whether all expectations are met.
fn report(jobs: &[Job]) -> (String, bool) {
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
    for job in jobs {
        for (i, line) in job.lines().into_iter().enumerate() {
            total += 1;
            met += usize::from(line.met);
            let name = if i == 0 { job.experiment.name.clone() } else { String::new() };
            let verdict = if line.met { "ok" } else { "OUTSIDE" };
            table.row([name, line.what, line.found, line.unit.into(), line.expected, verdict.into()]);
        }
    }
    (format!("{}\n{met} of {total} results as expected\n", table.text()), met == total)
}

#[cfg(test)]
mod tests;
