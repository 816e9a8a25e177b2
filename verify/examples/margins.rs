//! How far the emitted functions of some robots are from what the checker allows them to lose: the largest part of it that any entry takes,
//! in the box and at states, as a power of two with the entry, `cargo run -p armgen-verify --example margins -- robots/*.yaml`.

use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::judge::rounding::Trial;
use armgen_verify::read::claims::Claims;
use armgen_verify::{floats::bounds, judge::checker::Effort, prepare};

fn main() {
    for path in std::env::args().skip(1) {
        let source = Source::new(path.clone(), std::fs::read_to_string(&path).expect("the file can be read"));
        for (scalar, trig) in [(Scalar::F64, Trig::Libm), (Scalar::F32, Trig::Fast)] {
            #[allow(clippy::needless_update)]
            let options = Options { scalar, trig, ..Options::default() };
            let Some(generated) = armgen_codegen::generate(&source, &options).0 else { continue };
            let Some((manipulator, _)) = armgen_codegen::validate::read_for(&source, scalar).0 else { continue };
            let joints = manipulator.joints.len();
            let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
            let effort = Effort { points: 1, exact_points: 0, seed: 1 };
            let prepared = match prepare(manipulator, &generated.module, claims.clone(), effort) {
                Ok(prepared) => prepared,
                Err(fault) => {
                    println!("{path}: {fault}");
                    continue;
                }
            };
            let module = &prepared.module;
            let domain = bounds::domain_of(prepared.checker.manipulator(), module);
            let trial = Trial::new(module, &domain, &prepared.checker);
            let mut largest = [(0.0f64, String::new()), (0.0, String::new())];
            for (name, program) in module.programs() {
                let values = &claims.resolve(name, &program.literals, module.real).values;
                if let Some(unfit) = trial.fault(program, values) {
                    println!("{path} {scalar:?}: {name}: {unfit}");
                }
                let compared = trial.compared(program, values);
                if program.outputs.iter().any(|output| !compared.iter().any(|known| known.place == output.place)) {
                    println!("{path} {scalar:?}: {name}: an entry is never judged");
                }
                for compared in compared {
                    let part = compared.bound / compared.allowed;
                    let largest = &mut largest[usize::from(compared.in_box)];
                    if part > largest.0 || part.is_nan() {
                        *largest = (part, format!("{name}{}", compared.place));
                    }
                }
            }
            let [states, in_box] = largest.map(|(part, place)| format!("{:6.1} {place}", part.log2()));
            println!("{path} {scalar:?}, {joints} joints: at states {states}, in the box {in_box}");
        }
    }
}
