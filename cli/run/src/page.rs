//! `index.html`: the page of the robot with its experiments, results and figures.

use std::path::Path;

use armgen_description::source::Source;
use armgen_experiments::campaign::{groups, Job};
use armgen_experiments::draw::{self, OutputFile};
use armgen_experiments::model::{Record, Robot};
use armgen_page::{Figure, Log, Run, Verdict};

use armgen_terminal::output::write;
use armgen_terminal::{self as terminal, DONE, UNREADABLE};

/// The experiments, and the figures of their groups.
pub(super) fn of_jobs(jobs: &[Job<'_>]) -> Vec<Run> {
    let verdict = |line: armgen_experiments::judge::Line| Verdict {
        what: line.what,
        name: line.name,
        meaning: line.meaning.to_owned(),
        found: format!("{} {}", line.found, line.unit).trim_end().to_owned(),
        expected: line.expected,
        met: line.met,
    };
    let of = |job: &Job<'_>| Run {
        name: job.experiment().name.clone(),
        title: job.experiment().title.clone(),
        log: log(job.record()),
        verdicts: job.lines().into_iter().map(verdict).collect(),
        figures: job.figures().iter().cloned().map(figure).collect(),
    };
    let group = |file: OutputFile| Run {
        name: file.name.trim_end_matches(".svg").to_owned(),
        title: "the members of the group side by side".into(),
        figures: vec![figure(file)],
        ..Run::default()
    };
    jobs.iter().map(of).chain(groups(jobs).into_iter().map(group)).collect()
}

/// The motion of a robot without experiments.
pub(super) fn of_demonstration(record: &Record, robot: &Robot) -> Run {
    Run {
        name: "demonstration".into(),
        title: "from posture to posture within the limits".into(),
        log: log(record),
        figures: vec![Figure { title: "demonstration.svg".into(), svg: draw::demonstration(record, robot) }],
        ..Run::default()
    }
}

/// A figure titled with its file name.
fn figure(file: OutputFile) -> Figure {
    Figure { title: file.name, svg: file.text }
}

/// The log with the units of its channels; `None` for a record without samples.
fn log(record: &Record) -> Option<Log> {
    let unit = |name: &str| {
        let channel = record.channels().iter().find(|channel| channel.name == name);
        channel.map_or_else(String::new, |channel| channel.unit.symbol().to_owned())
    };
    Log::read(&record.csv(), unit).ok().filter(|_| !record.log().is_empty())
}

/// Writes the page and reports it.
pub(super) fn write_index(out: &Path, description: &Source, runs: &[Run]) -> u8 {
    let file = out.join("index.html");
    let page = armgen_page::page(description, runs).ok().and_then(|(page, _)| page);
    let Some(page) = page else {
        terminal::error(&format!(
            "cannot write {}: {} is not the description that was built",
            file.display(),
            description.name()
        ));
        return UNREADABLE;
    };
    match write(&file, &page) {
        Ok(()) => {
            terminal::note(&format!("look at it all in a browser: {}", file.display()));
            DONE
        }
        Err(error) => {
            terminal::error(&format!("cannot write {}: {error}", file.display()));
            UNREADABLE
        }
    }
}
