//! Every fault of a log: its code, line and column.

use armgen_codegen::diagnostic::Severity;
use armgen_identify::arm::Arm;
use armgen_identify::finding::{Code, Findings};
use armgen_identify::identify::{identify, Input};
use armgen_identify::log::{read, Format};
use armgen_identify::options::{Gains, Options};
use armgen_identify::suspect;

use crate::arms::{arm, csv, format, motion, Motion, Random, ELBOW};

const HEADER: &str = "t,q_base,q_shoulder,q_elbow,dq_base,dq_shoulder,dq_elbow,tau_base,tau_shoulder,tau_elbow\n";

#[track_caller]
fn check(findings: &Findings, code: Code, severity: Severity, line: usize, column: &str) {
    let found = findings
        .iter()
        .any(|finding| finding.code == code && finding.severity == severity && finding.line == line && finding.column == column);
    assert!(found, "{code} at {line}, {column}:\n{}", findings.render());
}

fn rows(bad: &str) -> String {
    let good = |k: usize| format!("{},1,2,3,4,5,6,7,8,9\n", 0.01 * k as f64);
    format!("{HEADER}{}{bad}{}", good(0), good(2))
}

fn of_text(text: &str, change: impl Fn(&mut Format)) -> Findings {
    let mut wanted = format(&arm(ELBOW));
    change(&mut wanted);
    read("log.csv", text.as_bytes(), &wanted).1
}

#[test]
fn faults_of_fields_and_lines_have_their_places() {
    use Severity::{Error, Warning};
    let plain = |_: &mut Format| {};
    check(&of_text(&rows("0.01,1,2,x,4,5,6,7,8,9\n"), plain), Code::BadNumber, Error, 3, "q_elbow");
    check(&of_text(&rows("0.01,1,2,,4,5,6,7,8,9\n"), plain), Code::BadNumber, Error, 3, "q_elbow");
    let findings = of_text(&rows("0.01,1,2,3,4,nan,6,7,8,9\n"), plain);
    check(&findings, Code::NotFinite, Error, 3, "dq_shoulder");
    assert_eq!(findings.iter().next().expect("one").at, 14);
    check(&of_text(&rows("0.01,1,5,2,3,4,5,6,7,8,9\n"), plain), Code::WrongLength, Error, 3, "");
    check(&of_text(&rows("0.01,1,2,3\n"), plain), Code::TruncatedLine, Error, 3, "");
    check(&of_text(&(rows("") + "0.03,1,2"), plain), Code::TruncatedLine, Warning, 4, "");
    let skipping = |format: &mut Format| format.skip_bad = true;
    check(&of_text(&rows("0.01,1,2,x,4,5,6,7,8,9\n"), skipping), Code::BadNumber, Warning, 3, "q_elbow");
    check(&of_text(&rows("0,1,2,3,4,5,6,7,8,9\n"), plain), Code::TimeNotIncreasing, Error, 3, "t");
    // A repeated stamp is a faulty row; a clock that starts again is not a fault of a row.
    check(&of_text(&rows("0,1,2,3,4,5,6,7,8,9\n"), skipping), Code::TimeNotIncreasing, Warning, 3, "t");
    let twice = rows("0,1,2,3,4,5,6,7,8,9\n0.01,1,2,3,4,5,6,7,8,9\n0.01,7,2,3,4,5,6,7,8,9\n");
    let mut wanted = format(&arm(ELBOW));
    wanted.skip_bad = true;
    let (log, findings) = read("log.csv", twice.as_bytes(), &wanted);
    assert!(!findings.has_errors() && findings.iter().count() == 2, "{}", findings.render());
    assert_eq!((log.t.as_slice(), log.lines.as_slice(), log.q[0][1]), ([0.0, 0.01, 0.02].as_slice(), [2, 4, 6].as_slice(), 1.0));
    let restarted = rows("0.5,1,2,3,4,5,6,7,8,9\n");
    check(&of_text(&restarted, skipping), Code::TimeNotIncreasing, Error, 4, "t");
    check(&of_text("", plain), Code::EmptyLog, Error, 0, "");
    check(&of_text(HEADER, plain), Code::EmptyLog, Error, 0, "");
    check(&of_text(&HEADER.replace("tau_elbow", "tau_elbw"), plain), Code::MissingColumn, Error, 1, "tau_elbow");
    check(&of_text(&HEADER.replace("tau_elbow", "tau_elbw"), plain), Code::UnknownJoint, Error, 1, "tau_elbw");
    check(&of_text(&HEADER.replace("q_elbow", "q_base"), plain), Code::DuplicateColumn, Error, 1, "q_base");
    // Semicolons, comments, other columns, other names, other units.
    let text = rows("0.01,1,2,3,4,5,6,7,8,9\n").replace(',', ";").replace("t;q_base", "# a comment\n\nstamp;q_base");
    let renamed = |format: &mut Format| {
        format.columns.insert("stamp".into(), "t".into());
        format.scales.angle = 2.0;
    };
    let mut wanted = format(&arm(ELBOW));
    renamed(&mut wanted);
    let (log, findings) = read("log.csv", text.as_bytes(), &wanted);
    assert_eq!(findings.iter().count(), 0, "{}", findings.render());
    assert_eq!((log.t.len(), log.q[1][0], log.effort[2][1], log.lines[0]), (3, 4.0, 9.0, 4));
}

#[test]
fn random_bytes_and_cut_logs_panic_nowhere() {
    let arm = arm(ELBOW);
    let whole = csv(&arm, &motion(ELBOW, 1, 0.5, 100.0), 4);
    let mut random = Random(5);
    for _ in 0..200 {
        let cut = (random.unit() * whole.len() as f64) as usize;
        let mut bytes = whole.as_bytes()[..cut].to_vec();
        for _ in 0..3 {
            if !bytes.is_empty() {
                let at = (random.unit() * bytes.len() as f64) as usize;
                bytes[at] = (random.unit() * 256.0) as u8;
            }
        }
        let (log, mut findings) = read("log.csv", &bytes[..], &format(&arm));
        if !findings.has_errors() {
            identify(&arm, &[Input { log, ..Input::default() }], &Options::default(), &mut findings);
        }
    }
}

/// A log of the elbow that `change` has spoilt, column by column: 0 is the stamp.
fn spoilt(arm: &Arm, change: impl Fn(&mut Motion)) -> (Input, Findings) {
    let mut motion = motion(ELBOW, 4, 12.0, 100.0);
    change(&mut motion);
    let (log, findings) = read("log.csv", csv(arm, &motion, 6).as_bytes(), &format(arm));
    (Input { log, ..Input::default() }, findings)
}

#[test]
fn signals_that_are_not_what_they_seem_are_named() {
    use Severity::{Error, Warning};
    let arm = arm(ELBOW);
    let signals = |change: &dyn Fn(&mut Motion)| {
        let (input, mut findings) = spoilt(&arm, change);
        assert!(!findings.has_errors(), "{}", findings.render());
        suspect::signals(&arm, &input.log, &[], &mut findings);
        findings
    };
    assert_eq!(signals(&|_| {}).iter().count(), 0, "{}", signals(&|_| {}).render());
    let gap = signals(&|m| m.t[500..].iter_mut().for_each(|t| *t += 1.0));
    check(&gap, Code::TimeGap, Warning, 502, "t");
    let whole = motion(ELBOW, 4, 12.0, 100.0);
    let shoulder = |k: usize| whole.tau[3 * k + 1];
    let limit = 0.97 * (0..whole.t.len()).map(shoulder).fold(0.0, f64::max);
    let line = 2 + (0..whole.t.len()).find(|&k| shoulder(k) >= limit).expect("it is reached");
    let clipped = signals(&|m| (0..m.t.len()).for_each(|k| m.tau[3 * k + 1] = m.tau[3 * k + 1].min(limit)));
    check(&clipped, Code::ClippedTorque, Warning, line, "tau_shoulder");
    let hard = signals(&|m| m.tau.iter_mut().for_each(|x| *x = x.clamp(-0.05, 0.05)));
    check(&hard, Code::ClippedTorque, Error, 2, "tau_base");
    let stuck = signals(&|m| (300..500).for_each(|k| m.tau[3 * k + 2] = m.tau[3 * 300 + 2]));
    check(&stuck, Code::StuckSignal, Error, 302, "tau_elbow");
    let stuck = signals(&|m| (300..500).for_each(|k| m.q[3 * k] = m.q[900]));
    check(&stuck, Code::StuckSignal, Error, 302, "q_base");
    let degrees = signals(&|m| m.q.iter_mut().for_each(|x| *x = x.to_degrees()));
    check(&degrees, Code::DegreesSuspected, Error, 2, "q_base");
    let degrees = signals(&|m| m.dq.iter_mut().for_each(|x| *x = x.to_degrees()));
    check(&degrees, Code::DegreesSuspected, Error, 2, "dq_base");
    let slow = signals(&|m| m.t.iter_mut().for_each(|t| *t *= 1000.0));
    check(&slow, Code::MillisecondsSuspected, Error, 2, "t");
    let random = signals(&|m| {
        let mut random = Random(1);
        (0..m.t.len()).for_each(|k| m.dq[3 * k + 1] = random.normal());
    });
    check(&random, Code::RateMismatch, Error, 2, "dq_shoulder");
    let turned = signals(&|m| (0..m.t.len()).for_each(|k| m.dq[3 * k + 1] *= -1.0));
    check(&turned, Code::SignSuspected, Error, 2, "dq_shoulder");
    let swapped = signals(&|m| (0..m.t.len()).for_each(|k| m.dq.swap(3 * k, 3 * k + 2)));
    check(&swapped, Code::JointOrder, Error, 2, "dq_base");
    let still = signals(&|m| (0..m.t.len()).for_each(|k| (m.q[3 * k + 2], m.dq[3 * k + 2]) = (0.1, 0.0)));
    check(&still, Code::UnexcitedJoint, Error, 0, "q_elbow");
}

#[test]
fn torques_under_other_names_and_signs_are_named() {
    use Severity::{Error, Warning};
    let arm = arm(ELBOW);
    let of = |options: &Options, change: &dyn Fn(&mut Motion)| {
        let (input, mut findings) = spoilt(&arm, change);
        identify(&arm, &[input], options, &mut findings);
        findings
    };
    let plain = Options::default();
    let swapped = of(&plain, &|m| (0..m.t.len()).for_each(|k| m.tau.swap(3 * k, 3 * k + 1)));
    check(&swapped, Code::JointOrder, Error, 0, "tau_base");
    let turned = of(&plain, &|m| (0..m.t.len()).for_each(|k| m.tau[3 * k + 1] *= -1.0));
    check(&turned, Code::SignSuspected, Error, 0, "tau_shoulder");
    let turned = of(&plain, &|m| m.tau.iter_mut().for_each(|x| *x *= -1.0));
    check(&turned, Code::SignSuspected, Error, 0, "");
    let noise = of(&plain, &|m| {
        let mut random = Random(2);
        let mut slow = 0.0;
        (0..m.t.len()).for_each(|k| {
            slow = 0.97 * slow + random.normal();
            m.tau[3 * k + 2] = 5.0 * slow;
        });
    });
    check(&noise, Code::PoorFit, Warning, 0, "tau_elbow");
    // Torques that come 60 ms later than their positions.
    let late = of(&plain, &|m| (6..m.t.len()).rev().for_each(|k| m.tau[3 * k + 2] = m.tau[3 * (k - 6) + 2]));
    check(&late, Code::DelayAtLimit, Warning, 0, "tau_elbow");
    // Columns of currents are named as they are in the log.
    let (mut input, mut findings) = spoilt(&arm, |m| (0..m.t.len()).for_each(|k| m.tau.swap(3 * k, 3 * k + 1)));
    input.log.is_current = true;
    for (joint, effort) in arm.joints.iter().zip(&mut input.log.effort) {
        effort.iter_mut().for_each(|x| *x /= joint.gain.unwrap_or(1.0));
    }
    identify(&arm, &[input], &plain, &mut findings);
    check(&findings, Code::JointOrder, Error, 0, "current_base");
    let options = Options { keep: vec!["elbw.friction.offset".into()], delay: Some(vec![0.0; 2]), ..Options::default() };
    let unfit = of(&options, &|_| {});
    check(&unfit, Code::BadOptions, Error, 0, "");
    assert_eq!(unfit.iter().filter(|finding| finding.code == Code::BadOptions).count(), 2);
    check(&of(&plain, &|_| {}), Code::ShortLog, Warning, 0, "");
    let short = of(&plain, &|m| {
        m.t.truncate(110);
    });
    check(&short, Code::NoMotion, Error, 0, "");
    let currents = |gains: Gains, text: &str| {
        let arm = crate::arms::arm(text);
        let text = csv(&arm, &motion(ELBOW, 4, 12.0, 100.0), 6).replace(",tau_", ",current_");
        let (log, mut findings) = read("log.csv", text.as_bytes(), &format(&arm));
        identify(&arm, &[Input { log, ..Input::default() }], &Options { gains, ..Options::default() }, &mut findings);
        findings
    };
    check(&currents(Gains::Identify, ELBOW), Code::GainScale, Error, 0, "");
    check(&currents(Gains::File, &ELBOW.replace(", gain: 9", "")), Code::NoGain, Error, 0, "current_elbow");
}
