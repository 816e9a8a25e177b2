//! Time a state of a function: `cargo run --release -p armgen-evaluate --example nanoseconds robots/panda7.yaml inverse_dynamics`.

use std::time::Instant;

use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model, Trig};
use armgen_evaluate::{program, Program};

/// The number of rounds. The shortest counts.
const ROUNDS: usize = 500;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or_else(|| "robots/panda7.yaml".into());
    let function = arguments.next().unwrap_or_else(|| "inverse_dynamics".into());
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let (manipulator, _) = validate::read(&Source::new(&path, text)).0.expect("a valid description");
    let model = Model::new(manipulator);
    let functions = Selection::named([function.as_str()]).expect("a function of the catalogue");
    let options = Options { trig: Trig::Fast, functions, ..Options::default() };
    let start = Instant::now();
    let module = schedule::module(&model, &options);
    let derived = start.elapsed();
    let program: Program<f64> = program(&module, module.functions.first().expect("a function of this arm"));
    println!("{path}, {function}: derived in {derived:.1?}");
    for states in [1, 8, 64, 1000] {
        // So few states a round that hardly any other program comes between.
        let calls = (200 / states).max(1);
        let given: Vec<Vec<f64>> = program
            .arguments()
            .iter()
            .zip(1..)
            .map(|(argument, k)| (0..states * argument.length).map(|i| ((i * k * 37) % 601) as f64 / 100.0 - 3.0).collect())
            .collect();
        let given: Vec<&[f64]> = given.iter().map(Vec::as_slice).collect();
        let (mut result, mut workspace) = (vec![0.0; states * program.outputs()], program.workspace());
        let round = || {
            let start = Instant::now();
            for _ in 0..calls {
                program.run(&given, std::hint::black_box(&mut result), &mut workspace).expect("lengths that fit");
            }
            start.elapsed().as_nanos() as f64 / calls as f64
        };
        let least = std::iter::repeat_with(round).take(ROUNDS).fold(f64::INFINITY, f64::min);
        println!("{states:5} states a call: {least:9.0} ns a call, {:6.1} ns a state", least / states as f64);
    }
}
