//! Any text as a URDF: import it; what comes out is a description that reads without a fault.
#![no_main]

use armgen_codegen::{description::RobotDescription, diagnostic::Colour, source::Source};
use armgen_import::{import, Options};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let source = Source::new("robot.urdf", String::from_utf8_lossy(data));
    for snap in [0.0, Options::SNAP] {
        let (imported, diagnostics) = import(&source, &Options { snap, massless: data.len() % 2 == 0, ..Options::default() });
        assert_eq!(imported.is_some(), !diagnostics.has_errors());
        armgen_fuzz::check_diagnostics(&source, &diagnostics);
        let Some(imported) = imported else { continue };
        let yaml = Source::new("robot.yaml", imported.yaml);
        let (description, faults) = RobotDescription::parse(&yaml);
        assert!(description.is_some() && !faults.has_errors(), "{}", faults.render(&yaml, Colour::Never));
    }
});
