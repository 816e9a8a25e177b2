//! Measures rounding errors of robots and compares the worst, recomputed with 256 bits, with both bounds. The output is CSV; the exit
//! code is 1 if an error exceeds a bound. This command writes a file for each robot and scalar:
//! `cargo run --release -p armgen-verify --example error_bounds -- 1000000 both --out FOLDER robots/*.yaml`.
//! Without `--out` it prints the tables. Function names after the files restrict the measurement to these functions.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_verify::floats::bounds::two_digits;
use armgen_verify::floats::errors::{Run, Seen, Subject};
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::Module;
use armgen_verify::values::float::LANES;

/// Number of batches between progress messages.
const PART: u64 = 1_250;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let states: Option<u64> = arguments.next().and_then(|text| text.parse().ok());
    let scalars = match arguments.next().as_deref() {
        Some("f64") => Some(&[Scalar::F64][..]),
        Some("f32") => Some(&[Scalar::F32][..]),
        Some("both") => Some(&[Scalar::F64, Scalar::F32][..]),
        _ => None,
    };
    let (Some(states), Some(scalars)) = (states, scalars) else {
        eprintln!("usage: error_bounds STATES f64|f32|both [--out FOLDER] ROBOT.yaml... [FUNCTION...]");
        return ExitCode::from(2);
    };
    let mut rest: Vec<String> = arguments.collect();
    let folder = (rest.first().is_some_and(|word| word == "--out") && rest.len() > 1).then(|| rest.drain(..2).nth(1)).flatten();
    let (paths, functions): (Vec<String>, Vec<String>) = rest.into_iter().partition(|argument| argument.ends_with(".yaml"));
    if folder.is_some() && !functions.is_empty() {
        eprintln!("error_bounds: --out writes whole tables; leave it out to measure single functions");
        return ExitCode::from(2);
    }
    let mut all_hold = true;
    for path in paths {
        for &scalar in scalars {
            match table(&path, scalar, states, &functions)
                .and_then(|table| table.map_or(Ok(true), |table| table.put(folder.as_deref())))
            {
                Ok(holds) => all_hold &= holds,
                Err(reason) => {
                    eprintln!("{path}: {reason}");
                    return ExitCode::from(2);
                }
            }
        }
    }
    ExitCode::from(u8::from(!all_hold))
}

/// The table of a robot.
struct Table {
    file: String,
    text: String,
    holds: bool,
}

impl Table {
    /// Writes the table to a folder, or prints it; returns whether all bounds hold.
    fn put(self, folder: Option<&str>) -> Result<bool, String> {
        match folder {
            Some(folder) => {
                std::fs::write(Path::new(folder).join(&self.file), &self.text).map_err(|e| format!("{}: {e}", self.file))?
            }
            None => println!("{}", self.text),
        }
        Ok(self.holds)
    }
}

/// Measures the errors of a robot; `None` if this scalar cannot represent its description.
fn table(path: &str, scalar: Scalar, states: u64, functions: &[String]) -> Result<Option<Table>, String> {
    let source = Source::new(path, std::fs::read_to_string(path).map_err(|e| e.to_string())?);
    #[allow(clippy::needless_update)]
    let options = Options { scalar, ..Options::default() };
    let Some(generated) = armgen_codegen::generate(&source, &options).0 else {
        eprintln!("{path}, {scalar:?}: refused");
        return Ok(None);
    };
    let (manipulator, _) = validate::read_for(&source, scalar).0.ok_or("not a valid description")?;
    let module = Module::read(&generated.module)?;
    let mut subjects = Subject::all(&manipulator, &module, &Claims::from_numbers(&generated.constants)?)?;
    subjects.retain(|subject| functions.is_empty() || functions.contains(&subject.program.name));
    let workers = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let batches = states.div_ceil(workers * LANES as u64);
    let work = |worker: u64| -> Result<Vec<Seen>, String> {
        let mut run = Run::new(&manipulator, &module, subjects.clone(), worker + 1);
        let mut done = 0;
        while done < batches {
            let now = PART.min(batches - done);
            run.go_on(now)?;
            done += now;
            let seen = run.seen.first().map_or(0, |seen| seen.states);
            eprintln!("{}, worker {worker}: {seen} of {} states", manipulator.name, batches * LANES as u64);
        }
        Ok(run.seen)
    };
    let parts: Vec<Result<Vec<Seen>, String>> = std::thread::scope(|scope| {
        let running: Vec<_> = (0..workers).map(|worker| scope.spawn(move || work(worker))).collect();
        running.into_iter().map(|worker| worker.join().expect("a worker that ends")).collect()
    });
    let mut seen: Vec<Seen> = Vec::new();
    for part in parts {
        let part = part?;
        if seen.is_empty() {
            seen = part;
        } else {
            seen.iter_mut().zip(&part).for_each(|(all, part)| all.join(part));
        }
    }
    let done = batches * workers * LANES as u64;
    let word = format!("{scalar:?}").to_lowercase();
    let beyond_residual: u64 = seen.iter().filter_map(|s| Some(s.residual.as_ref()?.beyond)).sum();
    let beyond: u64 = beyond_residual + seen.iter().map(|s| s.beyond_running + s.beyond_a_priori).sum::<u64>();
    let outside: u64 = seen.iter().map(|s| s.outside).sum();
    let mut text = format!(
        "# {}, {word}, {done} states; bounds exceeded: {beyond}; states with a divisor too small for the a-priori bound: {outside}\n\
         function,largest value,worst error,largest running bound,times the error,a-priori bound,singular,torques a,torques b,\
         worst torque,of its bound\n",
        manipulator.name
    );
    for s in &seen {
        let ratio = s.ratio().map_or("exact".into(), |ratio| format!("{ratio:.1}"));
        let (running, a_priori) = (two_digits(s.running), two_digits(s.a_priori));
        let torques = s.residual.as_ref().map_or(",,,".into(), |torques| {
            let (a, b) = (two_digits(torques.bound.constant), two_digits(torques.bound.factor));
            format!("{a},{b},{:.1e},{:.3}", torques.largest, torques.part)
        });
        let _ =
            writeln!(text, "{},{:.1e},{:.1e},{running},{ratio},{a_priori},{},{torques}", s.name, s.value, s.error, s.singular);
    }
    let stem = Path::new(path).file_stem().map_or("robot".into(), |stem| stem.to_string_lossy());
    Ok(Some(Table { file: format!("{stem}-{word}.csv"), text, holds: beyond == 0 }))
}
