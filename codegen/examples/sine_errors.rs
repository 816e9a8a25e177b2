//! Prints the tables of benches/results/sine-errors.csv: the largest errors of sine and cosine in units in the last place, by range of angles.
//!
//!     cargo run --release -p armgen-codegen --example sine_errors [ARGUMENTS [exhaustive]]
//!
//! `exhaustive` adds every f32, against f64.

#[path = "../tests/sines/arguments.rs"]
mod arguments;
#[path = "../tests/sines/emitted.rs"]
mod emitted;
#[path = "../tests/sines/reference.rs"]
mod reference;

use arguments::ranges;
use reference::{Format, Reference, F32, F64};

type SinCos<'a> = &'a dyn Fn(f64) -> (f64, f64);

fn table(title: &str, format: Format, (smallest, largest): (f64, f64), count: usize, functions: &[(&str, SinCos)]) {
    let reference = Reference::new();
    println!("{title}\n");
    print!("| angles | number |");
    functions.iter().for_each(|(name, _)| print!(" {name}: sin | cos |"));
    println!("\n|---|---|{}", "---|---|".repeat(functions.len()));
    for (name, range) in ranges(smallest, largest) {
        let arguments = range.arguments(count, largest, format);
        let mut worst = vec![(0.0f64, 0.0f64); functions.len()];
        for &x in &arguments {
            let (exact_sine, exact_cosine) = reference.sin_cos(x);
            for (worst, (_, function)) in worst.iter_mut().zip(functions) {
                let (sine, cosine) = function(x);
                worst.0 = worst.0.max(exact_sine.ulps(sine, format));
                worst.1 = worst.1.max(exact_cosine.ulps(cosine, format));
            }
        }
        print!("| {name} | {} |", arguments.len());
        worst.iter().for_each(|(sine, cosine)| print!(" {sine:.4} | {cosine:.4} |"));
        println!();
    }
    println!();
}

/// Every f32, up to the range and beyond, against f64, whose own error does not show in the fourth digit.
fn exhaustive() {
    let (range, largest) = (emitted::f32::RANGE.to_bits(), f32::MAX.to_bits());
    for (first, last) in [(1, range), (range + 1, largest)] {
        let mut worst = (0.0f64, 0.0f64);
        for bits in first..=last {
            let x = f32::from_bits(bits);
            let ((s, c), (sine, cosine)) = (emitted::f32::one(x), libm::sincos(x.into()));
            worst = (worst.0.max(ulps(s, sine)), worst.1.max(ulps(c, cosine)));
        }
        let count = last - first + 1;
        println!(
            "Every f32 from {:e} to {:e}, {count} of them: sine {:.4}, cosine {:.4}.",
            f32::from_bits(first),
            f32::from_bits(last),
            worst.0,
            worst.1
        );
    }
}

fn ulps(computed: f32, exact: f64) -> f64 {
    let exponent = (exact.abs().to_bits() >> 52) as i32 - 1023;
    (f64::from(computed) - exact).abs() * f64::from((23 - exponent).min(149)).exp2()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count = arguments.first().and_then(|a| a.parse().ok()).unwrap_or(1_000_000);
    let fast_single = |x: f64| {
        let (sine, cosine) = emitted::f32::one(x as f32);
        (f64::from(sine), f64::from(cosine))
    };
    let libm_single = |x: f64| {
        let (sine, cosine) = libm::sincosf(x as f32);
        (f64::from(sine), f64::from(cosine))
    };
    let functions: [(&str, SinCos); 3] = [("fast", &emitted::f64::one), ("libm", &libm::sincos), ("std", &f64::sin_cos)];
    table("f64", F64, (-1074.0, emitted::f64::RANGE), count, &functions);
    let functions: [(&str, SinCos); 2] = [("fast", &fast_single), ("libm", &libm_single)];
    table("f32", F32, (-149.0, emitted::f32::RANGE.into()), count, &functions);
    if arguments.get(1).is_some_and(|a| a == "exhaustive") {
        exhaustive();
    }
}
