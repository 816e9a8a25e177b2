//! Many experiments at once: all sampled loops are analysed first, each linearised and followed once along its motion without noise, then
//! everything moves, on all processors.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

use crate::draw::{self, OutputFile};
use crate::judge::{judge, Line};
use crate::model::{Body, Ended, Experiment, Record};
use crate::run::{Arm, Run};

/// One experiment and what is known of it.
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
    /// An experiment that is to be run on this arm.
    pub fn new(experiment: &'a Experiment, arm: &'a dyn Arm) -> Job<'a> {
        Job { experiment, arm, prepared: None, record: Record::default(), figures: Vec::new() }
    }

    /// The experiment.
    pub fn experiment(&self) -> &'a Experiment {
        self.experiment
    }

    /// What the run left behind; nothing before it.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Analyses the stability of the sampled loop, at rest and along its motion without noise; nothing is recorded yet.
    pub fn prepare(&mut self) {
        self.prepared = Some(self.arm.prepare(self.experiment));
    }

    /// Warnings of settings that are possible and probably mistakes, before anything moves.
    pub fn implausible_settings(&self) -> Vec<String> {
        self.arm.implausible_settings(self.experiment)
    }

    /// What has to be said of its loop before anything moves.
    pub fn warning(&self) -> Option<String> {
        self.prepared.as_ref()?.as_ref().ok()?.warning()
    }

    /// Runs and draws it, prepared or not.
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

    /// The lines of the table; a run that ended early is one of them, unless an expectation is about the number that tells of this end.
    pub fn lines(&self) -> Vec<Line> {
        let expect = &self.experiment.expect;
        let mut lines: Vec<Line> = expect.iter().map(|expectation| judge(expectation, &self.record)).collect();
        let expected = |end: &Ended| expect.iter().any(|e| end.told_by == Some(e.channel.quantity));
        if let Some(ended) = self.record.ended.as_ref().filter(|end| !expected(end)) {
            lines.push(Line::unmet("runs to the end", ended.why.clone(), "yes"));
        }
        lines
    }

    /// Roughly how long it takes, in steps.
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

/// Does `work` on every job, on all processors; the longest first.
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
