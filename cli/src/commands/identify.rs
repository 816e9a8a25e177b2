//! `armgen identify`: from logs to the numbers of an arm.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::Severity;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::source::Source;
use armgen_identify::arm::Arm;
use armgen_identify::baseline::Baseline;
use armgen_identify::certificate::{write_certified, Proved, LARGEST_GAP};
use armgen_identify::consistent::{consistent, rise};
use armgen_identify::finding::{Code, Finding, Findings};
use armgen_identify::identify::{identify, poor_fits, Identified, Input, Interval};
use armgen_identify::judge::{judge, Judgement, Model};
use armgen_identify::log::{self, Format, Log};
use armgen_identify::options::{self, Load, LogOptions, Options};
use armgen_identify::prepare::Friction;
use armgen_identify::written::Written;
use armgen_identify::{page, report};
use serde_json::json;

use super::verify::with_spinner;
use crate::table::{Align, Table};
use crate::{input, number, output, terminal, DONE, FAULTY, UNREADABLE};

/// What is asked for.
pub(crate) struct Asked {
    pub(crate) logs: Vec<PathBuf>,
    pub(crate) options: Option<PathBuf>,
    pub(crate) validate: Vec<PathBuf>,
    pub(crate) load: Option<f64>,
    pub(crate) report: Option<PathBuf>,
    pub(crate) out: Option<PathBuf>,
    pub(crate) skip_bad: bool,
    pub(crate) instruments: bool,
    pub(crate) without: Vec<String>,
    pub(crate) accept_unexcited: bool,
}

pub(crate) fn run(file: &Path, asked: &Asked) -> u8 {
    run_or_exit_code(file, asked).unwrap_or_else(|code| code)
}

fn run_or_exit_code(file: &Path, asked: &Asked) -> Result<u8, u8> {
    let source = input::description(file)?;
    let (manipulator, _) = input::manipulator(&source, Scalar::F64, input::Warnings::Counted)?;
    input::without_coupling(&source, &manipulator, "identify")?;
    let (chosen, folder) = options_of(asked)?;
    let arm = with_spinner("deriving", || Arm::new(&manipulator, chosen.link_side)).ok_or_else(|| {
        terminal::error(&format!("{}: nothing of this arm has mass, so there is nothing to identify", file.display()));
        FAULTY
    })?;
    let format = Format {
        joints: arm.joints.iter().map(|joint| (joint.name.clone(), joint.slides)).collect(),
        columns: chosen.columns.clone(),
        scales: chosen.scales,
        skip_bad: chosen.skip_bad,
        with_reference: chosen.instruments,
        span: [None, None],
    };
    let mut findings = Findings::default();
    let named = if asked.logs.is_empty() { chosen.logs.clone() } else { asked.logs.iter().map(|path| named(path)).collect() };
    let mut inputs: Vec<Input> = Vec::new();
    for (place, of) in named.iter().enumerate() {
        let path = if asked.logs.is_empty() { folder.join(&of.file) } else { PathBuf::from(&of.file) };
        let log = read(&path, &of.file, &Format { span: of.span, ..format.clone() }, &mut findings)?;
        // The load of the command line is that of the last log.
        let load = match asked.load.filter(|_| place + 1 == named.len()) {
            Some(mass) => Load { is_there: true, mass: Some(mass), com: None },
            None => of.load.clone(),
        };
        inputs.push(Input { log, session: of.session.clone(), load });
    }
    let mut held_out: Vec<Log> = Vec::new();
    let validate = asked.validate.iter().cloned().chain(chosen.validate.iter().map(|path| folder.join(path)));
    for path in validate {
        held_out.push(read(
            &path,
            &path.display().to_string(),
            &Format { with_reference: false, ..format.clone() },
            &mut findings,
        )?);
    }
    if findings.has_errors() {
        return Err(refused(&findings));
    }
    if inputs.is_empty() {
        if let Some(out) = &asked.out {
            terminal::error(&format!("{}: without a log to identify from there is nothing to write", out.display()));
            return Err(UNREADABLE);
        }
        return judged(&source, &arm, held_out, asked, &chosen, findings);
    }
    let found = with_spinner("identifying", || identify(&arm, &inputs, &chosen, &mut findings));
    let Some(found) = found.filter(|_| !findings.has_errors()) else { return Err(refused(&findings)) };
    let is_shown = found.unexcited.is_empty() || asked.accept_unexcited;
    let written = match asked.out.as_ref().filter(|_| is_shown) {
        None => None,
        Some(_) => {
            let bodies = consistent(&arm, &found.reduced);
            let certified = || write_certified(&source, chosen.link_side, &arm, &found, &bodies);
            Some(with_spinner("writing", certified).map_err(|reason| {
                terminal::error(&reason);
                FAULTY
            })?)
        }
    };
    let of_written = written.as_ref().map(|(written, ..)| written);
    if let Some(finding) = of_written.and_then(|written| too_far(&arm, &inputs, &found, written)) {
        findings.push(finding);
    }
    let model = model(&arm, &found, of_written);
    let mut validation = Vec::new();
    for log in held_out {
        let log = in_torques(&arm, log, &found.gains)?;
        let judgement = judge(&arm, &log, &model);
        poor_fits(&arm, &log, &judgement, &mut findings);
        validation.push((log.name.clone(), judgement));
    }
    terminal::diagnose(&findings.render());
    let mut code = terminal::print(&table(&arm, &inputs, &found, &validation));
    if let Some(folder) = &asked.report {
        let report = report::json(&arm, &inputs, &found, of_written, &validation, &findings);
        write_report(folder, &report)?;
        let proved = written.as_ref().map(|(written, _, proved)| (written, proofs(proved)));
        let proved = proved.as_ref().map(|(written, proofs)| (*written, proofs.as_str()));
        let html = page::html(&arm, &inputs, &found, proved, &validation, &findings);
        write_to(&folder.join("report.html"), &html)?;
        let own = inputs.iter().map(|input| input.log.name.as_str()).zip(&found.judgements);
        write_torques(folder, &arm, own.chain(validation.iter().map(|(name, of)| (name.as_str(), of))))?;
    }
    if let (Some(out), Some((written, certificate, proved))) = (&asked.out, &written) {
        let read = [Some(file), asked.options.as_deref()].into_iter().flatten().chain(asked.logs.iter().map(PathBuf::as_path));
        let wrote = output::write_other(read.map(|path| (path, "read by this command")), out, &with_mark_of(file, &written.text));
        if wrote != DONE {
            return Err(wrote);
        }
        // Beside the file where there is no folder for it.
        let beside = out.with_extension("cert.json");
        let place = asked.report.as_ref().map_or(beside, |folder| folder.join("certificate.json"));
        write_to(&place, certificate)?;
        written.notes.iter().for_each(|note| terminal::note(note));
        code = code.max(terminal::print(&told(out, written, proved)));
        if proved.gap.as_ref().is_ok_and(|gap| *gap > LARGEST_GAP) {
            terminal::error(&format!(
                "the proved gap is above {LARGEST_GAP:?}: the numbers may be those of no least sum of squares"
            ));
            return Ok(FAULTY);
        }
    }
    if findings.has_errors() {
        return Ok(FAULTY);
    }
    if code == DONE && !is_shown {
        terminal::error("the logs do not show all parameters: with `--accept-unexcited` those keep the values of the file");
        return Ok(FAULTY);
    }
    Ok(code)
}

/// A finding where what exists explains the logs worse than what does not, beyond noise: an error where the sum of squares is more than doubled.
fn too_far(arm: &Arm, inputs: &[Input], found: &Identified, written: &Written) -> Option<Finding> {
    let (rise, joints) = rise(arm, &found.reduced, &written.consistent);
    let largest = joints.iter().copied().fold(0.0, f64::max);
    let where_: Vec<String> = (0..arm.dof())
        .filter(|&j| joints[j] > 0.2 * largest)
        .map(|j| format!("`{}` ({})", arm.joints[j].name, percent(joints[j])))
        .collect();
    let text = format!(
        "the sum of squares of bodies and friction that can exist is above its least value by {rise:.1} times what noise explains, at {}",
        where_.join(", ")
    );
    let help = "look at signs, order and units of the columns of these joints, at their axes in the description, and at loads and springs that it lacks";
    let of = &written.consistent;
    let severity = if of.objective > 2.0 * of.unconstrained { Severity::Error } else { Severity::Warning };
    (rise > 1.0).then(|| Finding::new(Code::PoorFit, &inputs[0].log.name, text, help).as_bad_as(severity))
}

/// The text with the byte order mark that its file begins with.
fn with_mark_of(file: &Path, text: &str) -> String {
    let mut start = [0; 3];
    let has_mark = File::open(file).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == *b"\xef\xbb\xbf";
    format!("{}{text}", if has_mark { "\u{feff}" } else { "" })
}

/// What was written, what is proved of it, and what consistency costs.
fn told(out: &Path, written: &Written, proved: &Proved) -> String {
    let of = &written.consistent;
    format!(
        "\n{}: {} new numbers, of bodies with {} digits\n{}the sum of squares is {} above its least value\n",
        out.display(),
        written.changed,
        written.digits,
        proofs(proved),
        percent(of.objective / of.unconstrained - 1.0),
    )
}

/// What a certificate proves, in lines.
pub(super) fn proofs(proved: &Proved) -> String {
    let optimal = match &proved.gap {
        Ok(gap) => format!("proved: no other bodies and friction are better by more than {gap:?} of the objective"),
        Err(reason) => format!("not proved: that these numbers are optimal ({reason})"),
    };
    format!("proved: all {} bodies are positive definite\n{}", proved.bodies, wrapped("", &optimal))
}

fn named(path: &Path) -> LogOptions {
    LogOptions { file: path.display().to_string(), ..LogOptions::default() }
}

fn refused(findings: &Findings) -> u8 {
    terminal::diagnose(&findings.render());
    FAULTY
}

fn options_of(asked: &Asked) -> Result<(Options, PathBuf), u8> {
    let (mut chosen, folder) = match &asked.options {
        None => (Options::default(), PathBuf::new()),
        Some(path) => {
            let source = input::source(path)?;
            let chosen = input::accepted(&source, options::read(&source))?;
            (chosen, path.parent().map(Path::to_path_buf).unwrap_or_default())
        }
    };
    chosen.skip_bad |= asked.skip_bad;
    chosen.instruments |= asked.instruments;
    chosen.without.extend(asked.without.iter().cloned());
    Ok((chosen, folder))
}

fn read(path: &Path, name: &str, format: &Format, findings: &mut Findings) -> Result<Log, u8> {
    let file = File::open(path).map_err(|error| {
        terminal::error(&format!("cannot read {}: {error}", path.display()));
        UNREADABLE
    })?;
    let (log, found) = log::read(name, BufReader::with_capacity(1 << 20, file), format);
    findings.extend(found);
    Ok(log)
}

/// A log of currents in torques.
fn in_torques(arm: &Arm, mut log: Log, gains: &[Interval]) -> Result<Log, u8> {
    if !log.is_current {
        return Ok(log);
    }
    for (j, column) in log.effort.iter_mut().enumerate() {
        let Some(gain) = gains.get(j).map(|gain| gain.value).or(arm.joints[j].gain) else {
            let text = format!("the log holds currents, and the motor of joint `{}` has no gain", arm.joints[j].name);
            let finding = Finding::new(Code::NoGain, &log.name, text, "give `gain: ...` (N m/A) under `motor`");
            terminal::diagnose(&finding.to_string());
            return Err(FAULTY);
        };
        column.iter_mut().for_each(|x| *x *= gain);
    }
    Ok(log)
}

/// The arm without load, with the friction of the last session; as it is written, where it is.
fn model(arm: &Arm, found: &Identified, written: Option<&Written>) -> Model {
    let mut friction = vec![[0.0; 6]; arm.dof()];
    for of in found.friction.iter().filter(|of| of.session + 1 == found.sessions.len()) {
        friction[of.joint][of.term as usize] = of.value.value;
    }
    Model {
        pi: match written {
            Some(written) => written.consistent.base(arm).as_slice().to_vec(),
            None => found.base.iter().map(|base| base.value).collect(),
        },
        friction: written.map_or(friction, |written| written.friction.clone()),
        velocities: written.map_or_else(|| found.velocities.clone(), |written| written.velocities.clone()),
        delays: Some(found.delays.iter().map(|delay| delay.value).collect()),
        spreads: Some(found.spreads.clone()),
        covariance: Some(found.covariance.clone()),
    }
}

/// Judges the numbers of a description, identifies nothing.
fn judged(source: &Source, arm: &Arm, logs: Vec<Log>, asked: &Asked, chosen: &Options, mut findings: Findings) -> Result<u8, u8> {
    if logs.is_empty() {
        terminal::error("no log is given: name one to identify from, or one to judge by, `--validate LOG.csv`");
        return Err(UNREADABLE);
    }
    let baseline = Baseline::read(source, arm).map_err(|finding| {
        terminal::diagnose(&finding.to_string());
        FAULTY
    })?;
    if baseline.is_none() {
        terminal::note(&format!(
            "{} has no delays and residuals of an identification: each log gives its own, so a contact that lasts hides itself",
            source.name()
        ));
    }
    let (delays, spreads) = baseline.map(|of| (of.delays, of.spreads)).unzip();
    let model = Model {
        pi: (&arm.combination * arm.nominal()).as_slice().to_vec(),
        friction: arm.joints.iter().map(|joint| joint.friction.map(Option::unwrap_or_default)).collect(),
        velocities: arm.joints.iter().map(|joint| joint.stribeck_velocity).collect(),
        delays: chosen
            .delay
            .as_ref()
            .map(|given| (0..arm.dof()).map(|j| given.get(j).or(given.first()).copied().unwrap_or(0.0)).collect())
            .or(delays),
        spreads,
        covariance: None,
    };
    let mut validation = Vec::new();
    for log in logs {
        let log = in_torques(arm, log, &[])?;
        let judgement = judge(arm, &log, &model);
        poor_fits(arm, &log, &judgement, &mut findings);
        validation.push((log.name.clone(), judgement));
    }
    terminal::diagnose(&findings.render());
    let code = terminal::print(&residuals(arm, "validation", validation.iter().map(|(name, of)| (name.as_str(), of))));
    if let Some(folder) = &asked.report {
        let of: Vec<_> = validation.iter().map(|(file, of)| report::judgement(arm, file, of)).collect();
        write_report(folder, &json!({"robot": arm.name, "validation": of, "diagnostics": report::findings(&findings)}))?;
        write_to(&folder.join("report.html"), &page::of_validation(arm, &validation, &findings))?;
        write_torques(folder, arm, validation.iter().map(|(name, of)| (name.as_str(), of)))?;
    }
    Ok(code)
}

fn write_report(folder: &Path, report: &serde_json::Value) -> Result<(), u8> {
    let text = serde_json::to_string_pretty(report).expect("strings and numbers always have a JSON form") + "\n";
    write_to(&folder.join("report.json"), &text)
}

/// Measured and predicted torques of each log, for the page of the arm.
fn write_torques<'j>(folder: &Path, arm: &Arm, all: impl Iterator<Item = (&'j str, &'j Judgement)>) -> Result<(), u8> {
    let mut names: Vec<String> = Vec::new();
    for (log, of) in all {
        let stem = Path::new(log).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        // Logs of two folders may have one name.
        let twins = names.iter().filter(|name| **name == stem).count();
        let end = if twins == 0 { String::new() } else { format!("-{}", twins + 1) };
        write_to(&folder.join(format!("{stem}{end}.torques.csv")), &of.csv(arm))?;
        names.push(stem);
    }
    Ok(())
}

fn write_to(path: &Path, text: &str) -> Result<(), u8> {
    output::write(path, text).map_err(|error| {
        terminal::error(&format!("cannot write {}: {error}", path.display()));
        UNREADABLE
    })
}

fn short(x: f64) -> String {
    number::short(x, 4)
}

fn percent(x: f64) -> String {
    format!("{:.2} %", 100.0 * x)
}

/// In ms, to a hundredth.
fn milliseconds(seconds: f64) -> String {
    // No zero has a sign.
    format!("{:.2}", (1e5 * seconds).round() / 100.0 + 0.0)
}

fn range(of: &Interval) -> [String; 2] {
    let range = if of.excited && of.sigma > 0.0 { format!("{} to {}", short(of.low), short(of.high)) } else { "kept".into() };
    [short(of.value), range]
}

fn table(arm: &Arm, inputs: &[Input], found: &Identified, validation: &[(String, Judgement)]) -> String {
    use Align::{Left, Point};
    let mut text = format!(
        "{}: {} samples used, cutoff {} Hz, condition {}, {} stretches of time\n\n",
        arm.name,
        found.used,
        short(found.cutoff),
        short(found.condition),
        found.blocks
    );
    let mut base = Table::new([("base parameter", Left), ("value", Point), ("3 sigma", Left)]);
    for (parameter, value) in arm.base.iter().zip(&found.base) {
        let [value, range] = range(value);
        base.row([parameter.name.clone(), value, range]);
    }
    text += &format!("{}\n", base.text());
    for parameter in &arm.base {
        text += &wrapped(&format!("  {} = ", parameter.name), &parameter.meaning);
    }
    let mut friction = Table::new([("joint", Left), ("friction", Left), ("value", Point), ("3 sigma", Left), ("session", Left)]);
    for of in &found.friction {
        let [value, range] = range(&of.value);
        let joint = arm.joints[of.joint].name.clone();
        friction.row([joint, of.term.key().to_owned(), value, range, found.sessions[of.session].clone()]);
        if of.term == Friction::Stribeck {
            let velocity = short(found.velocities[of.joint]);
            friction.row([arm.joints[of.joint].name.clone(), "stribeck velocity".into(), velocity, String::new(), String::new()]);
        }
    }
    text += &format!("\n{}", friction.text());
    if !found.gains.is_empty() {
        let mut gains = Table::new([("joint", Left), ("gain", Point), ("3 sigma", Left)]);
        for (joint, value) in arm.joints.iter().zip(&found.gains) {
            let [value, range] = range(value);
            gains.row([joint.name.clone(), value, range]);
        }
        text += &format!("\n{}", gains.text());
    }
    let mut delays = Table::new([("joint", Left), ("delay", Point), ("3 sigma", Left)]);
    for (joint, delay) in arm.joints.iter().zip(&found.delays) {
        let range = match (delay.excited, delay.sigma > 0.0) {
            (false, _) => "not determined".to_owned(),
            (true, false) => "given".to_owned(),
            (true, true) => format!("{} to {}", milliseconds(delay.low), milliseconds(delay.high)),
        };
        delays.row([joint.name.clone(), format!("{} ms", milliseconds(delay.value)), range]);
    }
    text += &format!("\n{}", delays.text());
    for (log, ten) in &found.loads {
        let mut load = Table::new([("load", Left), ("value", Point), ("3 sigma", Left)]);
        for (name, value) in armgen_identify::body::NAMES.iter().zip(ten) {
            if let Some(value) = value {
                let [value, range] = range(value);
                load.row([(*name).to_owned(), value, range]);
            }
        }
        text += &format!("\n{}\n{}", inputs[*log].log.name, load.text());
    }
    let own = inputs.iter().map(|input| input.log.name.as_str()).zip(&found.judgements);
    text += &format!("\n{}", residuals(arm, "log", own));
    if !validation.is_empty() {
        text += &format!("\n{}", residuals(arm, "validation", validation.iter().map(|(name, of)| (name.as_str(), of))));
    }
    for words in &found.inseparable {
        text += &format!("\n{}", wrapped("", words));
    }
    for (_, words) in &found.unexcited {
        text += &format!("\n{}", wrapped("not shown by the logs: ", words));
    }
    text
}

/// Text after a title, in lines of the terminal's width, split between words.
fn wrapped(title: &str, text: &str) -> String {
    let mut lines = vec![title.to_owned()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("the first");
        if line.chars().count() + word.chars().count() < terminal::width() || line.trim().is_empty() {
            *line += word;
            *line += " ";
        } else {
            lines.push(format!("    {word} "));
        }
    }
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// Residuals of logs by joint, each log below its name.
fn residuals<'j>(arm: &Arm, kind: &str, all: impl Iterator<Item = (&'j str, &'j Judgement)>) -> String {
    use Align::{Left, Point};
    let mut text = String::new();
    let mut delays: Vec<&[f64]> = Vec::new();
    for (name, of) in all {
        let delays_are_new = delays.last() != Some(&of.delays.as_slice());
        delays.push(&of.delays);
        let mut table = Table::new([
            ("joint", Left),
            ("residual", Point),
            ("", Left),
            ("of torque", Point),
            ("moving", Point),
            ("delay", Point),
        ]);
        for (j, joint) in arm.joints.iter().enumerate() {
            let unit = if joint.slides { "N" } else { "N m" };
            let delay = if delays_are_new { format!("{} ms", milliseconds(of.delays[j])) } else { String::new() };
            let [residual, whole, moving] = [short(of.rms[j]), percent(of.relative[j]), percent(of.moving[j])];
            table.row([joint.name.clone(), residual, unit.to_owned(), whole, moving, delay]);
        }
        let mean = |x: &[f64]| percent(x.iter().sum::<f64>() / x.len() as f64);
        table.row(["mean".into(), String::new(), String::new(), mean(&of.relative), mean(&of.moving), String::new()]);
        text += &format!("{}{kind} {name}\n{}", if text.is_empty() { "" } else { "\n" }, table.text());
        for contact in of.contacts.iter().filter(|_| kind == "validation") {
            let joints: Vec<&str> = contact.joints.iter().map(|&j| arm.joints[j].name.as_str()).collect();
            text += &format!("  contact from {:.2} s to {:.2} s at {}\n", contact.from, contact.to, joints.join(", "));
        }
    }
    text
}
