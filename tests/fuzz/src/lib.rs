//! What every fuzz target demands of a reader of text.

use armgen_codegen::{
    diagnostic::{Colour, Diagnostics},
    source::Source,
};

/// Checks that what is said about a source can be shown: places inside the text, help that is not empty, a rendering that is there exactly
/// if there is something to say.
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
