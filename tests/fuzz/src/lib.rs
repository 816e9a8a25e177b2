//! Targets for libFuzzer, and for a test of the workspace (tests/tests/fuzzed.rs) that takes in this file.

pub mod experiment;
pub mod expression;
pub mod log;
pub mod module;
pub mod poses;
pub mod robot;

use armgen_codegen::{
    description::RobotDescription,
    diagnostic::{Colour, Diagnostics},
    source::Source,
};
use armgen_import::{import, Options};

/// Checks that diagnostics can be shown: places lie inside the text, help is not empty, and a rendering exists exactly if there
/// are diagnostics.
///
/// # Panics
/// If not.
pub fn check_diagnostics(source: &Source, diagnostics: &Diagnostics) {
    let rendered = diagnostics.render(source, Colour::Never);
    assert_eq!(rendered.is_empty(), diagnostics.is_empty());
    for diagnostic in diagnostics.iter() {
        assert!(!diagnostic.help.is_empty(), "{diagnostic:?}");
        for label in &diagnostic.labels {
            let range = label.span.range();
            assert!(source.text().get(range).is_some(), "{diagnostic:?}");
        }
    }
}

/// Imports a text, digit by digit and snapped to the meant values; a result must be a valid description.
///
/// # Panics
/// If not.
pub fn check_import(name: &str, data: &[u8]) {
    let source = Source::new(name, String::from_utf8_lossy(data));
    for snap in [0.0, Options::SNAP] {
        let (imported, diagnostics) =
            import(&source, &Options { snap, massless: data.len().is_multiple_of(2), ..Options::default() });
        assert_eq!(imported.is_some(), !diagnostics.has_errors());
        check_diagnostics(&source, &diagnostics);
        let Some(imported) = imported else { continue };
        let yaml = Source::new("robot.yaml", imported.yaml);
        let (description, faults) = RobotDescription::parse(&yaml);
        assert!(description.is_some() && !faults.has_errors(), "{}", faults.render(&yaml, Colour::Never));
    }
}
