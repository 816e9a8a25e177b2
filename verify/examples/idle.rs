//! Lists steps without influence on results: `cargo run --release -p armgen-verify --example idle -- robots/*.yaml`.

use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::claims::Claims;
use armgen_verify::{checker::Effort, influence, prepare};

fn main() {
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path).expect("the file can be read");
        let source = Source::new(path.clone(), text);
        let (generated, _) = armgen_codegen::generate(&source, &Options::default());
        let (read, _) = armgen_codegen::validate::read(&source);
        let (Some(generated), Some((manipulator, _))) = (generated, read) else { continue };
        let claims = Claims::from_numbers(&generated.constants);
        let effort = Effort { points: 1, exact_points: 0, seed: 1 };
        let mut prepared = prepare(manipulator, &generated.module, claims.clone(), effort).expect("a module");
        for (name, function) in &prepared.module.functions {
            let program = &function.as_ref().expect("a function that can be read").program;
            let values = claims.resolve(name, &program.literals, prepared.module.real).values;
            let idle = influence::idle_steps(program, &mut prepared.checker.points_mut()[0], &values).unwrap_or_default();
            println!("{path} {name}: {} of {}", idle.len(), program.steps.len());
        }
    }
}
