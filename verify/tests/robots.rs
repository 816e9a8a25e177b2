//! Every robot of the project, in both scalars.

use armgen_codegen::program::{Options, Scalar};
use armgen_codegen::source::Source;
use armgen_verify::checker::Effort;
use armgen_verify::claims::Claims;

#[test]
fn all_robots_are_verified() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let mut paths: Vec<std::path::PathBuf> = ["robots", "tests/robots"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(format!("{root}/{folder}")).expect("a folder of robots"))
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("a description");
        for scalar in [Scalar::F64, Scalar::F32] {
            let source = Source::new(path.display().to_string(), text.clone());
            let start = std::time::Instant::now();
            let (generated, diagnostics) = armgen_codegen::generate(&source, &Options { scalar, ..Options::default() });
            let generated = generated.unwrap_or_else(|| panic!("{diagnostics:?}"));
            let generation = start.elapsed();
            let report =
                armgen_verify::verify(&source, &generated.module, Claims::from_numbers(&generated.constants), Effort::default());
            println!("generated in {generation:?}, all in {:?}", start.elapsed());
            println!("{report}");
            assert!(report.passed(), "{}", report.first_fault().unwrap_or_default());
        }
    }
}
