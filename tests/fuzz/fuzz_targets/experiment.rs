//! Any text as an experiment and as a path; what is valid and short is run.
#![no_main]

use armgen_codegen::{diagnostic::Colour, source::Source};
use libfuzzer_sys::fuzz_target;
use std::{path::Path, time::Duration};

/// The program's own reader: its files as they are.
#[allow(dead_code, unused_imports)]
#[path = "../../../cli/src/experiments"]
mod experiments {
    pub(crate) mod clik;
    pub(crate) mod control;
    pub(crate) mod expectation;
    pub(crate) mod fault;
    pub(crate) mod file;
    pub(crate) mod manipulability;
    pub(crate) mod motion;
    pub(crate) mod motion_check;
    pub(crate) mod reader;
    pub(crate) mod record;
}

use experiments::{clik, control, file, file::Body, manipulability, motion, motion_check};

/// Samples of a run, for the sake of speed.
const SAMPLES: u128 = 40;

/// Whether the text could make the reader of a path wait for a device; what it opens is the caller's choice, as with every program.
fn opens_a_device(text: &str) -> bool {
    ["dev", "proc", "sys", "run", "tmp", ".."].iter().any(|folder| text.contains(&format!("/{folder}")))
}

fn is_short(sampling: &file::Sampling) -> bool {
    sampling.duration.as_nanos() / sampling.period.as_nanos() <= SAMPLES
}

fn run(body: &Body) {
    let record = match body {
        Body::Postures(postures) => manipulability::run(postures),
        Body::Path(sampling) if is_short(sampling) => motion_check::run(sampling),
        Body::Clik(run) if is_short(&run.sampling) => clik::run(run),
        Body::Control(run) if is_short(&run.sampling) && run.substeps <= 8 && run.continuous.unwrap_or(0) <= 8 => {
            match control::prepare(run, true) {
                Ok(prepared) => control::run(run, &prepared),
                Err(_) => return,
            }
        }
        _ => return,
    };
    assert!(!record.csv().is_empty());
}

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    if let Ok(motion) = motion::parse(Source::new("path.yaml", text.clone())) {
        let duration = motion.trajectory.duration();
        for i in 0..=8 {
            let _ = motion.trajectory.sample(duration / 8 * i + Duration::from_nanos(u64::from(i)));
        }
    }
    if opens_a_device(&text) {
        return;
    }
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../experiments/fuzzed.yaml"));
    match file::parse(file, &Source::new("fuzzed.yaml", text), Colour::Never) {
        file::Parsed::Experiment(experiment) => run(&experiment.body),
        file::Parsed::OtherRobot(_) => {}
        file::Parsed::Faulty(said, faults) => assert!(faults > 0 && !said.is_empty()),
    }
});
