//! Reads any text as an experiment and as a path; runs valid short experiments.

use armgen_codegen::source::Source;
use armgen_experiments::{
    campaign::Job,
    model::{Body, Experiment, Sampling},
    read::{self, Parsed},
    run::Arm,
};
use std::{path::Path, time::Duration};

/// Samples of a run, for the sake of speed.
const SAMPLES: u128 = 40;

/// The one path there is: an experiment opens nothing else.
const PATH: &str = include_str!("../../../experiments/paths/ghost.yaml");

fn is_short(sampling: &Sampling) -> bool {
    sampling.duration.as_nanos() / sampling.period.as_nanos() <= SAMPLES
}

fn simulate(experiment: &Experiment, arm: &dyn Arm) {
    let short = match &experiment.body {
        Body::Postures(_) => true,
        Body::Path(sampling) => is_short(sampling),
        Body::Clik(run) => is_short(&run.sampling),
        Body::Branch(run) => is_short(&run.sampling),
        Body::Control(run) => is_short(&run.sampling) && run.substeps <= 8,
    };
    if short {
        let mut job = Job::new(experiment, arm);
        job.run();
        assert!(!job.log().text.is_empty());
        assert!(job.lines().len() >= experiment.expect.len());
    }
}

/// The target.
///
/// # Panics
/// Where the reader is wrong.
pub fn run(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    if let Ok(motion) = read::motion(&Source::new("path.yaml", text.clone())) {
        let duration = motion.trajectory.duration();
        for i in 0..=8 {
            let _ = motion.trajectory.sample(duration / 8 * i + Duration::from_nanos(u64::from(i)));
        }
    }
    let arm = armgen_experiments::instance!(armgen_generated);
    match read::experiment(Path::new("fuzzed.yaml"), &Source::new("fuzzed.yaml", text), arm.robot(), &|_| Ok(PATH.to_owned())) {
        Parsed::Experiment(experiment) => simulate(&experiment, &arm),
        Parsed::OtherRobot(_) | Parsed::Path => {}
        Parsed::Faulty(faulty) => {
            assert!(!faulty.is_empty());
            for (source, diagnostics) in &faulty {
                assert!(diagnostics.has_errors());
                super::check_diagnostics(source, diagnostics);
            }
        }
    }
}
