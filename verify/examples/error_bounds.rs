//! Rounding errors of some robots, the worst against 256 bits, beside both bounds, as tables in Markdown; exit code 1 if a bound is exceeded:
//! `cargo run --release -p armgen-verify --example error_bounds -- 1000000 both robots/*.yaml`, of some functions alone where their names follow.

use std::process::ExitCode;

use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_verify::bounds::two_digits;
use armgen_verify::claims::Claims;
use armgen_verify::errors::{Run, Seen, Subject};
use armgen_verify::float::LANES;
use armgen_verify::reader::Module;

/// Batches after which the log tells how far it is.
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
        eprintln!("usage: error_bounds STATES f64|f32|both ROBOT.yaml... [FUNCTION...]");
        return ExitCode::from(2);
    };
    let (paths, functions): (Vec<String>, Vec<String>) = arguments.partition(|argument| argument.ends_with(".yaml"));
    let mut all_hold = true;
    for path in paths {
        for &scalar in scalars {
            match table(&path, scalar, states, &functions) {
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

fn table(path: &str, scalar: Scalar, states: u64, functions: &[String]) -> Result<bool, String> {
    let source = Source::new(path, std::fs::read_to_string(path).map_err(|e| e.to_string())?);
    #[allow(clippy::needless_update)]
    let options = Options { scalar, ..Options::default() };
    let Some(generated) = armgen_codegen::generate(&source, &options).0 else {
        println!("## {path}, {scalar:?}: refused\n");
        return Ok(true);
    };
    let (manipulator, _) = validate::read_for(&source, scalar).0.ok_or("not a valid description")?;
    let module = Module::read(&generated.module)?;
    let mut subjects = Subject::all(&manipulator, &module, &Claims::from_numbers(&generated.constants))?;
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
    println!("## {}, {word}, {done} states\n", manipulator.name);
    println!("| function | largest value | worst error | largest running bound | times the error | a-priori bound | singular |");
    println!("|---|---|---|---|---|---|---|");
    for s in &seen {
        let ratio = s.ratio().map_or("exact".into(), |ratio| format!("{ratio:.1}"));
        let (error, running) = (format!("{:.1e}", s.error), two_digits(s.running));
        let a_priori = two_digits(s.a_priori);
        println!("| `{}` | {:.1e} | {error} | {running} | {ratio} | {a_priori} | {} |", s.name, s.value, s.singular);
    }
    for s in &seen {
        let Some(torques) = &s.residual else { continue };
        let (constant, factor) = (two_digits(torques.bound.constant), two_digits(torques.bound.factor));
        println!(
            "\n`{}` is that of torques off by at most {constant} + {factor} max ddq; worst seen {:.1e}, {:.3} of its bound.",
            s.name, torques.largest, torques.part
        );
    }
    let beyond_residual: u64 = seen.iter().filter_map(|s| Some(s.residual.as_ref()?.beyond)).sum();
    let beyond: u64 = beyond_residual + seen.iter().map(|s| s.beyond_running + s.beyond_a_priori).sum::<u64>();
    let outside: u64 = seen.iter().map(|s| s.outside).sum();
    let widest = seen.iter().filter_map(Seen::ratio).fold(0.0, f64::max);
    println!("\nBounds exceeded: {beyond} times. Largest ratio: {widest:.1}. States with a divisor too small for the a-priori bound: {outside}.\n");
    Ok(beyond == 0)
}
