//! Validates any text as `robot.yaml`, and generates from a valid one.

use armgen_codegen::{kinds::Scalar, program::Trig, schedule::Options, source::Source, validate};

/// For speed, arms with more joints are validated but not generated: their emitted text differs only in length.
const JOINTS: usize = 3;

/// The target.
///
/// # Panics
/// Where the reader is wrong.
pub fn run(data: &[u8]) {
    let source = Source::new("robot.yaml", String::from_utf8_lossy(data));
    let (valid, diagnostics) = validate::read(&source);
    assert_eq!(valid.is_some(), !diagnostics.has_errors());
    super::check_diagnostics(&source, &diagnostics);
    let Some((manipulator, _)) = valid.filter(|(manipulator, _)| manipulator.joints.len() <= JOINTS) else { return };
    // One of the six kinds of module, by the length of the text.
    let scalar = [Scalar::F64, Scalar::F32][data.len() % 2];
    let trig = [Trig::Libm, Trig::Std, Trig::Fast][data.len() / 2 % 3];
    let (generated, diagnostics) = armgen_codegen::generate(&source, &Options { scalar, trig, ..Options::default() });
    super::check_diagnostics(&source, &diagnostics);
    match generated {
        Some(generated) => {
            let file = syn::parse_file(&generated.module).expect("an emitted module is a Rust file");
            assert!(file.items.len() > manipulator.joints.len());
            syn::parse_file(&generated.runtime).expect("the trait implementation is a Rust file");
        }
        // A product of valid numbers that does not fit the scalar, or a number that does not fit f32.
        None => assert!(diagnostics.has_errors()),
    }
}
