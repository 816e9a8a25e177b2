//! The generator as a program, for a test that starts it repeatedly. Prints the module and the trait implementation of the
//! description in a file.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;

fn main() {
    let path = std::env::args().nth(1).expect("the path of a description");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let source = Source::new(path, text);
    match armgen_codegen::generate(&source, &Default::default()) {
        (Some(generated), _) => print!("{}{}", generated.module, generated.runtime),
        (None, diagnostics) => panic!("{}", diagnostics.render(&source, Colour::Never)),
    }
}
