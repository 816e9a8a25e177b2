//! Reads any bytes as a log of the repository's arm, and identifies from logs without faults.

use std::sync::OnceLock;

use armgen_codegen::{source::Source, validate};
use armgen_identify::{
    arm::Arm,
    identify::{identify, Input},
    log::{self, Format},
    options::Options,
};

/// Samples that are identified from, for the sake of speed.
const SAMPLES: usize = 400;

/// An arm whose joints have the names of the seeds.
const ARM: &str = include_str!("../arm.yaml");

fn arm() -> &'static Arm {
    static ONCE: OnceLock<Arm> = OnceLock::new();
    ONCE.get_or_init(|| {
        let (valid, _) = validate::read(&Source::new("arm.yaml", ARM));
        Arm::new(&valid.expect("a valid arm").0, false).expect("it has mass")
    })
}

/// The target.
///
/// # Panics
/// Where the reader is wrong.
pub fn run(data: &[u8]) {
    let arm = arm();
    let joints = arm.joints.iter().map(|joint| (joint.name.clone(), joint.slides)).collect();
    for skip_bad in [false, true] {
        let (log, mut findings) =
            log::read("log.csv", data, &Format { joints: Vec::clone(&joints), skip_bad, ..Format::default() });
        let lines = data.split(|byte| *byte == b'\n').count();
        for finding in findings.iter() {
            assert!(finding.line <= lines, "{finding}");
        }
        assert_eq!(log.lines.len(), log.t.len());
        assert!(log.t.windows(2).all(|pair| pair[0] < pair[1]));
        if !findings.has_errors() && log.t.len() <= SAMPLES {
            let found = identify(arm, &[Input { log, ..Input::default() }], &Options::default(), &mut findings);
            assert!(found.is_some() || findings.has_errors(), "{}", findings.render());
        }
    }
}
