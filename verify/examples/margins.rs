//! Margins between the emitted functions of robots and the checker's limits on rounding. For each criterion, it prints the largest used
//! fraction over all entries: `cargo run -p armgen-verify --example margins -- robots/*.yaml`.

use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_verify::claims::Claims;
use armgen_verify::rounding::{Criterion, Trial};
use armgen_verify::{bounds, checker::Effort, prepare};

fn main() {
    let mut largest: [(f64, String); 5] = Default::default();
    for path in std::env::args().skip(1) {
        let source = Source::new(path.clone(), std::fs::read_to_string(&path).expect("the file can be read"));
        for (scalar, trig) in [(Scalar::F64, Trig::Libm), (Scalar::F32, Trig::Fast)] {
            #[allow(clippy::needless_update)]
            let options = Options { scalar, trig, ..Options::default() };
            let Some(generated) = armgen_codegen::generate(&source, &options).0 else { continue };
            let Some((manipulator, _)) = armgen_codegen::validate::read_for(&source, scalar).0 else { continue };
            let claims = Claims::from_numbers(&generated.constants);
            let effort = Effort { points: 1, exact_points: 0, seed: 1 };
            let prepared = match prepare(manipulator, &generated.module, claims.clone(), effort) {
                Ok(prepared) => prepared,
                Err(fault) => {
                    println!("{path}: {fault}");
                    continue;
                }
            };
            let module = &prepared.module;
            for report in prepared.checker.functions(module) {
                if report.verdict != armgen_verify::report::Verdict::Equal {
                    println!("{path} {scalar:?}: {}: {:?}", report.name, report.verdict);
                }
            }
            let domain = bounds::domain_of(prepared.checker.manipulator(), module);
            let trial = Trial::new(module, &domain, &prepared.checker);
            let mut own = [0.0f64; 5];
            for (name, program) in module.programs() {
                let values = claims.resolve(name, &program.literals, module.real).values;
                if let Some(unfit) = trial.fault(program, &values) {
                    println!("{path} {scalar:?}: {name}: {unfit}");
                }
                for compared in trial.compared(program, &values) {
                    let k = match compared.criterion {
                        Criterion::Intervals => 0,
                        Criterion::Box => 1,
                        Criterion::States => 2,
                        Criterion::Divided => 3,
                        Criterion::Measured => 4,
                    };
                    own[k] = own[k].max(compared.part());
                    if compared.part() > largest[k].0 {
                        largest[k] = (compared.part(), format!("{path} {scalar:?} {name}{}", compared.place));
                    }
                }
            }
            println!("{path} {scalar:?}: {}", own.map(|part| format!("{part:.1e}")).join(" "));
        }
    }
    for (criterion, (part, place)) in ["intervals", "box", "states", "divided", "measured"].iter().zip(largest) {
        println!("{criterion}: {part:.3} in {place}");
    }
}
