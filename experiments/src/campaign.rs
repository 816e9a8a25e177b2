//! Many experiments at once. First, all sampled loops are analysed: each is linearised, and simulated once along its motion without
//! noise. Then all experiments run, on all processors.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

use crate::draw::{self, OutputFile};
use crate::judge::{judge, Line};
use crate::model::{Body, Ended, Experiment, Record};
use crate::run::{Arm, Run};

/// An experiment with its preparation and results.
pub struct Job<'a> {
    experiment: &'a Experiment,
    arm: &'a dyn Arm,
    prepared: Option<Result<Box<dyn Run + 'a>, String>>,
    record: Record,
    figures: Vec<OutputFile>,
}

impl std::fmt::Debug for Job<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Job").field("experiment", &self.experiment.name).field("record", &self.record).finish_non_exhaustive()
    }
}

impl<'a> Job<'a> {
    /// An experiment to run on this arm.
    pub fn new(experiment: &'a Experiment, arm: &'a dyn Arm) -> Job<'a> {
        Job { experiment, arm, prepared: None, record: Record::default(), figures: Vec::new() }
    }

    /// The experiment.
    pub fn experiment(&self) -> &'a Experiment {
        self.experiment
    }

    /// The record of the run; empty before it.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Analyses the stability of the sampled loop, at rest and along its motion without noise. It records nothing.
    pub fn prepare(&mut self) {
        self.prepared = Some(self.arm.prepare(self.experiment));
    }

    /// Warnings about settings that are valid but probably mistakes, before the run.
    pub fn implausible_settings(&self) -> Vec<String> {
        self.arm.implausible_settings(self.experiment)
    }

    /// The warning about an unstable loop, after `prepare`.
    pub fn warning(&self) -> Option<String> {
        self.prepared.as_ref()?.as_ref().ok()?.warning()
    }

    /// Runs the experiment and draws its figures; prepares it first if necessary.
    pub fn run(&mut self) {
        let prepared = self.prepared.take().unwrap_or_else(|| self.arm.prepare(self.experiment));
        self.record = match prepared {
            Ok(run) => run.run(),
            Err(reason) => Record::without_samples(reason),
        };
        self.figures = draw::experiment(self.experiment, &self.record, self.arm.robot());
    }

    /// Its figures.
    pub fn figures(&self) -> &[OutputFile] {
        &self.figures
    }

    /// Its log as comma-separated values.
    pub fn log(&self) -> OutputFile {
        OutputFile { name: format!("{}.csv", self.experiment.name), text: self.record.csv() }
    }

    /// The rows of the table. An early end adds a row, unless an expectation concerns the quantity that reports this end.
    pub fn lines(&self) -> Vec<Line> {
        let expect = &self.experiment.expect;
        let mut lines: Vec<Line> = expect.iter().map(|expectation| judge(expectation, &self.record)).collect();
        let expected = |end: &Ended| expect.iter().any(|e| end.told_by == Some(e.channel.quantity));
        if let Some(ended) = self.record.ended.as_ref().filter(|end| !expected(end)) {
            lines.push(Line::unmet("runs to the end", ended.why.clone(), "yes"));
        }
        lines
    }

    /// Relative duration of the run.
    fn effort(&self) -> u64 {
        match &self.experiment.body {
            Body::Postures(_) => 0,
            Body::Path(_) | Body::Branch(_) => 1,
            Body::Clik(_) => 2,
            Body::Control(run) => 10 * u64::from(run.substeps),
        }
    }
}

/// The figures of the groups of these experiments.
pub fn groups(jobs: &[Job<'_>]) -> Vec<OutputFile> {
    let Some(arm) = jobs.first().map(|job| job.arm) else { return Vec::new() };
    let all: Vec<(&Experiment, &Record)> = jobs.iter().map(|job| (job.experiment, &job.record)).collect();
    draw::groups(&all, arm.robot())
}

/// Calls `work` for every job on all processors, the longest jobs first.
pub fn in_parallel<'a>(jobs: &mut [Job<'a>], work: impl Fn(&mut Job<'a>) + Sync) {
    let mut queue: Vec<&mut Job<'a>> = jobs.iter_mut().collect();
    queue.sort_by_key(|job| std::cmp::Reverse(job.effort()));
    let queue: Vec<Mutex<&mut Job<'a>>> = queue.into_iter().map(Mutex::new).collect();
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
