//! Options: every key of the page, and what becomes of slips.

use armgen_codegen::diagnostic::Code;
use armgen_codegen::source::Source;
use armgen_identify::options::{read, Gains};
use armgen_identify::prepare::Friction;

/// The block of options of `armgen identify` on the page of the documentation.
fn of_the_page() -> String {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/identification.md")).expect("the page");
    let blocks = page.split("```yaml\n").skip(1).filter_map(|rest| Some(rest.split_once("```")?.0));
    blocks.into_iter().find(|block| block.contains("logs:")).expect("a block with logs").to_owned()
}

#[test]
fn the_options_of_the_page_are_read() {
    let (options, diagnostics) = read(&Source::new("identify.yaml", of_the_page()));
    assert!(diagnostics.is_empty(), "{:?}", diagnostics.iter().collect::<Vec<_>>());
    assert_eq!(options.logs[0].span, [Some(6.35), Some(35.1)]);
    assert_eq!(options.logs[0].session, "monday");
    assert_eq!(options.logs[1].load.mass, Some(2.805));
    assert_eq!(options.columns["actual_q_0"], "q_shoulder");
    assert_eq!([options.scales.time, options.scales.angle, options.scales.torque], [1e-3, 1f64.to_radians(), 1e-3]);
    assert_eq!((options.gains, options.friction, options.cutoff), (Gains::File, None, None));
    let (options, diagnostics) =
        read(&Source::new("o", "friction: [viscous, load]\ncutoff: 5\ndelay: [1, 2]\ngains: identify\n"));
    assert!(diagnostics.is_empty());
    assert_eq!(options.friction, Some(vec![Friction::Viscous, Friction::Load]));
    assert_eq!((options.cutoff, options.delay, options.gains), (Some(5.0), Some(vec![1e-3, 2e-3]), Gains::Identify));
}

/// Loads are in the units of the file, as bodies are in those of a description.
#[test]
fn loads_have_units() {
    let text = "logs: [{file: a.csv, load: {mass: 7.5, com: [0, 1, 10/4]}}]\nunits: {mass: lb, length: in}\n";
    let (options, diagnostics) = read(&Source::new("o", text));
    assert!(diagnostics.is_empty(), "{:?}", diagnostics.iter().collect::<Vec<_>>());
    assert_eq!(options.logs[0].load.mass, Some(7.5 * 0.45359237));
    assert_eq!(options.logs[0].load.com, Some([0.0, 0.0254, 2.5 * 0.0254]));
    let (options, _) = read(&Source::new("o", "units: {mass: g}\nlogs: [{file: a.csv, load: {mass: 3500}}]\n"));
    assert_eq!(options.logs[0].load.mass, Some(3.5));
}

#[test]
fn slips_are_refused_with_the_word_that_was_meant() {
    let check = |text: &str, code: Code, word: &str| {
        let (_, diagnostics) = read(&Source::new("o", text));
        let found = diagnostics.iter().any(|one| one.code == code && format!("{one:?}").contains(word));
        assert!(found, "{text}: {:?}", diagnostics.iter().collect::<Vec<_>>());
    };
    check("cutof: 5\n", Code::UnknownKey, "cutoff");
    check("friction: [viscos]\n", Code::WrongKind, "viscous");
    check("units: {angle: mm}\n", Code::UnknownUnit, "angle");
    check("units: {mass: N}\n", Code::UnknownUnit, "mass");
    check("cutoff: -1\n", Code::NonPositiveLimit, "cutoff");
    check("torque: joint\n", Code::WrongKind, "motor");
    check("logs: [{from: 1}]\n", Code::MissingKey, "file");
}
