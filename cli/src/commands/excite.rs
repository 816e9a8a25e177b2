//! `armgen excite`: a motion that shows the parameters of an arm, within its limits at all times.

use std::path::{Path, PathBuf};

use armgen_codegen::kinds::Scalar;
use armgen_identify::arm::Arm;
use armgen_identify::excite::options::{self, Options};
use armgen_identify::excite::{excite, Excitation, Kind, Proof, PARTS};

use super::verify::{with_bar, with_spinner};
use crate::table::{Align, Table};
use crate::{input, number, output, terminal, DONE, FAULTY, UNREADABLE};

/// What is asked for.
#[derive(Debug, clap::Args)]
pub(crate) struct Asked {
    /// File of samples to write: t, and q, dq, ddq of each joint; motion.yaml and motion.cert.json come beside it
    #[arg(long, value_name = "MOTION.csv", value_hint = clap::ValueHint::FilePath)]
    out: Option<PathBuf>,
    /// Options: start, box, frames, seed
    #[arg(long, value_name = "EXCITE.yaml", value_hint = clap::ValueHint::FilePath)]
    options: Option<PathBuf>,
    /// Duration of the motion without its lead-in, s
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = positive)]
    duration: f64,
    /// Harmonics of the motion
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(2..=20))]
    harmonics: u16,
    /// Samples a second
    #[arg(long, value_name = "HZ", default_value = "100", value_parser = positive)]
    rate: f64,
    /// Description of a simulated arm; its log of the motion, MOTION.log.csv, comes beside the samples
    #[arg(long, value_name = "ARM.yaml", value_hint = clap::ValueHint::FilePath, requires = "out")]
    simulate: Option<PathBuf>,
    /// Noise of the simulated log, per cent of the torques
    #[arg(long, value_name = "PER_CENT", default_value = "2", value_parser = noise, requires = "simulate")]
    noise: f64,
}

fn noise(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=100.0).contains(&x) => Ok(x),
        _ => Err("a number from 0 to 100 is needed".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e5 => Ok(x),
        _ => Err("a number above 0, at most 1e5, is needed".to_owned()),
    }
}

/// Samples of a file at most.
const SAMPLES: f64 = 1e6;

pub(crate) fn run(file: &Path, asked: &Asked) -> u8 {
    run_or_exit_code(file, asked).unwrap_or_else(|code| code)
}

fn run_or_exit_code(file: &Path, asked: &Asked) -> Result<u8, u8> {
    let source = input::description(file)?;
    let (manipulator, _) = input::manipulator(&source, Scalar::F64, input::Warnings::Counted)?;
    input::without_coupling(&source, &manipulator, "excite")?;
    let options = options_of(asked)?;
    let arm = with_spinner("deriving", || Arm::new(&manipulator, false)).ok_or_else(|| {
        terminal::error(&format!("{}: nothing of this arm has mass, so no motion shows parameters", file.display()));
        FAULTY
    })?;
    let simulated = match &asked.simulate {
        None => None,
        Some(path) => Some(input::manipulator(&input::description(path)?, Scalar::F64, input::Warnings::Counted)?.0),
    };
    let planned = with_bar("planning", PARTS, |done| excite(&manipulator, &arm, &options, done));
    let found = planned.map_err(|faults| {
        faults.iter().for_each(|fault| terminal::diagnose(&format!("{}: {fault}", file.display())));
        FAULTY
    })?;
    if asked.out.is_some() && (found.lead_in.duration + options.duration) * options.rate > SAMPLES {
        terminal::error(&format!("the motion has more than {SAMPLES:e} samples: choose a lower `--rate`"));
        return Err(UNREADABLE);
    }
    let log = match simulated.map(|of| found.simulated(&of, options.rate, asked.noise, options.seed)) {
        None => None,
        Some(Ok(log)) => Some(log),
        Some(Err(fault)) => {
            terminal::diagnose(&fault.to_string());
            return Err(FAULTY);
        }
    };
    let code = terminal::print(&table(&found));
    let Some(out) = &asked.out else { return Ok(code) };
    let texts = [
        ("csv", Some(found.csv(options.rate))),
        ("yaml", Some(found.yaml())),
        ("cert.json", Some(found.certificate())),
        ("log.csv", log),
    ];
    let named = |extension: &str| if extension == "csv" { out.clone() } else { out.with_extension(extension) };
    let files: Vec<(PathBuf, String)> = texts.into_iter().filter_map(|(end, text)| Some((named(end), text?))).collect();
    let read = || [Some(file), asked.options.as_deref(), asked.simulate.as_deref()].into_iter().flatten();
    // Before anything is written.
    if let Some((path, _)) = files.iter().find(|(path, _)| read().any(|read| output::same_file(read, path))) {
        terminal::error(&format!("{} is read by this command: it would be overwritten; name another `--out`", path.display()));
        return Err(UNREADABLE);
    }
    for (path, text) in &files {
        let wrote = output::write_other(read().map(|path| (path, "read by this command")), path, text);
        if wrote != DONE {
            return Err(wrote);
        }
    }
    Ok(code)
}

fn options_of(asked: &Asked) -> Result<Options, u8> {
    let mut options = Options::default();
    if let Some(path) = &asked.options {
        let source = input::source(path)?;
        options = input::accepted(&source, options::read(&source))?;
    }
    (options.duration, options.harmonics, options.rate) = (asked.duration, usize::from(asked.harmonics), asked.rate);
    Ok(options)
}

fn table(found: &Excitation) -> String {
    use Align::{Left, Point};
    let short = |x: f64| number::short(x, 4);
    let period = short(found.motion.w.recip() * std::f64::consts::TAU);
    let mut text = format!(
        "{}: {} joints, {} harmonics, {period} s after {} s from the start\n\n  log det per parameter  {}  of {} columns\n  condition              {}  of the scaled columns\n\n",
        found.robot,
        found.joints.len(),
        found.motion.harmonics(),
        short(found.lead_in.duration),
        short(found.log_det_per_parameter),
        found.unknowns,
        short(found.condition),
    );
    // Of both motions: the largest share of each limit that is proved.
    let share = |wanted: &Kind| -> String {
        let of = |proof: &Proof| proof.margins.iter().find(|margin| margin.kind == *wanted).map(|margin| 1.0 - margin.margin);
        let largest = [of(&found.proof), of(&found.of_lead_in)].into_iter().flatten().fold(f64::NAN, f64::max);
        if largest.is_nan() {
            String::new()
        } else {
            format!("{:.1} %", 100.0 * largest)
        }
    };
    let mut joints =
        Table::new([("joint", Left), ("position", Point), ("velocity", Point), ("acceleration", Point), ("effort", Point)]);
    for (k, name) in found.joints.iter().enumerate() {
        let kinds = [Kind::Position(k), Kind::Velocity(k), Kind::Acceleration(k), Kind::Effort(k)];
        joints.row(std::iter::once(name.clone()).chain(kinds.iter().map(share)));
    }
    text += "At most of each limit, proved for all times:\n\n";
    text += &joints.text();
    if !found.bounds.is_empty() {
        let mut frames = Table::new([("frame", Left), ("axis", Left), ("of the box", Point)]);
        for (k, (frame, axis)) in found.bounds.iter().enumerate() {
            frames.row([frame.clone(), axis.clone(), share(&Kind::Box(k))]);
        }
        text += &format!("\n{}", frames.text());
    }
    text + &format!("\n{} pieces of time\n", found.proof.pieces + found.of_lead_in.pieces)
}
