//! Rounding errors of some robots against 256-bit evaluation, beside both bounds, as tables in Markdown; exit code 1 if a bound is exceeded:
//! `cargo run --release -p armgen-verify --example error_bounds -- 1000000 f64 robots/*.yaml`.

use std::process::ExitCode;

use armgen_codegen::manipulator::{self, Scalar};
use armgen_codegen::program::Options;
use armgen_codegen::source::Source;
use armgen_verify::bounds::two_digits;
use armgen_verify::claims::Claims;
use armgen_verify::errors::{measure, Seen, Subject};
use armgen_verify::reader::Module;

/// States after which the log tells how far it is.
const BATCH: u64 = 5_000;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let states: Option<u64> = arguments.next().and_then(|text| text.parse().ok());
    let scalar = match arguments.next().as_deref() {
        Some("f64") => Some(Scalar::F64),
        Some("f32") => Some(Scalar::F32),
        _ => None,
    };
    let (Some(states), Some(scalar)) = (states, scalar) else {
        eprintln!("usage: error_bounds STATES f64|f32 ROBOT.yaml...");
        return ExitCode::from(2);
    };
    let mut all_hold = true;
    for path in arguments {
        match table(&path, scalar, states) {
            Ok(holds) => all_hold &= holds,
            Err(reason) => {
                eprintln!("{path}: {reason}");
                return ExitCode::from(2);
            }
        }
    }
    ExitCode::from(u8::from(!all_hold))
}

fn table(path: &str, scalar: Scalar, states: u64) -> Result<bool, String> {
    let source = Source::new(path, std::fs::read_to_string(path).map_err(|e| e.to_string())?);
    #[allow(clippy::needless_update)]
    let options = Options { scalar, ..Options::default() };
    let generated = armgen_codegen::generate(&source, &options).0.ok_or("not a valid description")?;
    let (manipulator, _) = manipulator::read_for(&source, scalar).0.ok_or("not a valid description")?;
    let module = Module::read(&generated.module)?;
    let subjects = Subject::all(&manipulator, &module, &Claims::from_numbers(&generated.constants))?;
    let workers = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let mut seen: Vec<Seen> = measure(&manipulator, &module, &subjects, 0, 0);
    let mut done = 0;
    while done < states {
        let batch = BATCH.min(states - done).div_ceil(workers);
        let parts: Vec<Vec<Seen>> = std::thread::scope(|scope| {
            let work = |worker: u64| {
                let (manipulator, module, subjects) = (&manipulator, &module, &subjects);
                scope.spawn(move || measure(manipulator, module, subjects, batch, done * 64 + worker + 1))
            };
            let running: Vec<_> = (0..workers).map(work).collect();
            running.into_iter().map(|worker| worker.join().expect("a worker that ends")).collect()
        });
        for part in parts {
            seen.iter_mut().zip(&part).for_each(|(all, part)| all.join(part));
        }
        done += batch * workers;
        eprintln!("{}: {done} of {states} states", manipulator.name);
    }
    let word = format!("{scalar:?}").to_lowercase();
    println!("## {}, {word}, {done} states\n", manipulator.name);
    println!("| function | largest value | worst error | largest running bound | times the error | a-priori bound |");
    println!("|---|---|---|---|---|---|");
    for s in &seen {
        let ratio = s.ratio().map_or("exact".into(), |ratio| format!("{ratio:.1}"));
        let (error, running) = (format!("{:.1e}", s.error), two_digits(s.running));
        println!("| `{}` | {:.1e} | {error} | {running} | {ratio} | {} |", s.name, s.value, two_digits(s.a_priori));
    }
    let beyond: u64 = seen.iter().map(|s| s.beyond_running + s.beyond_a_priori).sum();
    let outside: u64 = seen.iter().map(|s| s.outside).sum();
    let widest = seen.iter().filter_map(Seen::ratio).fold(0.0, f64::max);
    println!("\nBounds exceeded: {beyond} times. Largest ratio: {widest:.1}. States with a divisor too small for the a-priori bound: {outside}.\n");
    Ok(beyond == 0)
}
