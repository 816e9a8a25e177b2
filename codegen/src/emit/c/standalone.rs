//! The header that holds the functions: C99 and C++11, static functions, no allocation, no state.
//!
//! Several optimisations of floats change bits; `unfused.h` forbids each or stops the compiler. Every function reads all
//! arguments before it writes a result, so results may alias arguments.

use std::fmt::Write;

use super::header::{comment, function_comment, macros, macros_of, opening, signature, POINTERS};
use super::syntax::{most_lanes, C};
use super::{batch, kernels, prefix, returns_a_number};
use crate::emit::parameters::{has_payload, payload_blocks, C_PAYLOAD};
use crate::emit::plain::{
    asks_for_exponentials, asks_for_signs, described, expression, of_robot, places, reads_an_argument, waves,
};
use crate::emit::private::filled;
use crate::emit::rust::asks_for_sines;
use crate::emit::{head, Language, Notes, Origin};
use crate::kinds::Scalar;
use crate::program::listing::{BodyPart, Line, Listing, Name};
use crate::program::{Function, Module, Trig};

/// What forbids compilers to change bits.
pub(super) const PROLOGUE: &str = include_str!("unfused.h");
const VECTORS: &str = include_str!("vectors.h");
pub(super) const EPILOGUE: &str = include_str!("epilogue.h");
const STRIBECK: &str = include_str!("stribeck.h");
const SIGN: &str = include_str!("sines/sign.h");
const STD: &str = include_str!("sines/std.h");
const FAST: &str = include_str!("sines/fast.h");
const FUSED: &str = include_str!("fused.h");

/// The lines that define a vector of so many angles. The number of angles in an array is a multiple of each.
fn vector_of(lanes: usize) -> String {
    let entries: Vec<String> = (0..lanes).map(|lane| format!("(from)[{lane}]")).collect();
    format!("#define ROBOT_VECTOR_LANES {lanes}\n#define ROBOT_VECTOR_AT(from) {{{}}}", entries.join(", "))
}

pub(super) fn print(module: &Module, language: Language, origin: &Origin, notes: &Notes) -> String {
    let name = prefix(module);
    let upper = macros_of(&name);
    let c = C { module, name, upper };
    let mut text = opening(head::of_module(module, language, origin, &notes.head), &module.absent, &c.upper);
    if module.batch.is_some() {
        text += "#include <stddef.h>\n\n";
    }
    text += &of_robot(&fused(module), &c.name, &c.upper);
    text += &of_robot(&sine_of_library(module), &c.name, &c.upper);
    text += &of_robot(PROLOGUE, &c.name, &c.upper);
    text += &of_robot(VECTORS, &c.name, &c.upper);
    text += &macros(module);
    text += "\n";
    if asks_for_sines(module) {
        let sines = if module.trig == Trig::Fast { FAST } else { STD };
        text += &c.private(sines);
        text += "\n";
    }
    if asks_for_signs(module) {
        text += &c.private(SIGN);
        text += "\n";
    }
    if asks_for_exponentials(module) {
        text += &c.private(STRIBECK);
        text += "\n";
    }
    if has_payload(module) {
        text += &comment(&payload_blocks(), &|_| String::new());
        text += &of_robot(C_PAYLOAD, &c.name, &c.upper);
        text += "\n";
    }
    text += POINTERS.trim_start();
    for function in &module.functions {
        c.function(&mut text, function, notes);
    }
    if let Some(lanes) = module.batch {
        text += &batch::print(&c, lanes);
    }
    if language == Language::Cuda {
        text += &kernels::print(&c);
    }
    text += "\n";
    text + EPILOGUE
}

/// The header with functions for `lanes` states each, followed by these functions for a library that is loaded by name.
pub(super) fn library(module: &Module, origin: &Origin, lanes: usize) -> String {
    let module = Module { batch: Some(lanes), ..module.clone() };
    let name = prefix(&module);
    let c = C { module: &module, upper: macros_of(&name), name };
    let mut text = print(&module, Language::C, origin, &Notes::default());
    text += "\n#if defined(_WIN32)\n#define EXPORTED __declspec(dllexport)\n#else\n#define EXPORTED __attribute__((visibility(\"default\")))\n#endif\n";
    for function in &module.functions {
        let own = function.name();
        let exported = batch::signature(&c, function, &format!("armgen_{own}"));
        let names = ["states"].into_iter().chain(function.arguments.iter().map(|a| a.name()));
        let names: Vec<&str> = names.chain(function.quantity.result.iter().map(|part| part.name)).collect();
        let _ = writeln!(text, "\nEXPORTED {exported};\n{exported}\n{{\n    {}_batch_{own}({});\n}}", c.name, names.join(", "));
    }
    text
}

/// The fused operation, if any is needed.
fn fused(module: &Module) -> String {
    if !module.is_fused() {
        return String::new();
    }
    let suffix = match module.scalar {
        Scalar::F64 => "",
        Scalar::F32 => "f",
    };
    FUSED.replace("@f@", suffix)
}

/// Where the sines of the C library come from, if any are needed.
fn sine_of_library(module: &Module) -> String {
    if !asks_for_sines(module) {
        return String::new();
    }
    let suffix = match module.scalar {
        Scalar::F64 => "",
        Scalar::F32 => "f",
    };
    let library = format!("#include <math.h>\n#define ROBOT_SIN(x) sin{suffix}(x)\n#define ROBOT_COS(x) cos{suffix}(x)\n");
    if module.trig != Trig::Fast {
        return library + "\n";
    }
    let none = "(((x) - (x)) / ((x) - (x)))";
    format!(
        "/* With ROBOT_NO_MATH_H defined no header is needed: sines of angles beyond the range of the ones below are then not numbers. */\n\
         #ifdef ROBOT_NO_MATH_H\n#define ROBOT_SIN(x) {none}\n#define ROBOT_COS(x) {none}\n#else\n{library}#endif\n\n"
    )
}

impl C<'_> {
    /// A private function from its template.
    fn private(&self, template: &str) -> String {
        let scalar = self.module.scalar;
        let (lanes, mask, suffix) = match scalar {
            Scalar::F64 => (format!("#if defined(__AVX__)\n{}\n#else\n{}\n#endif", vector_of(4), vector_of(2)), "long long", ""),
            Scalar::F32 => (format!("#if defined(__AVX2__)\n{}\n#else\n{}\n#endif", vector_of(8), vector_of(4)), "int", "f"),
        };
        let suffixed = |word: &str| match word.trim_end_matches(')') {
            number if number.contains('.') => format!("{number}{suffix}{}", &word[number.len()..]),
            _ => word.to_string(),
        };
        let value = |text: &str| text.split(' ').map(suffixed).collect::<Vec<_>>().join(" ");
        let text = template.replace("@lanes@", &lanes).replace("@mask@", mask).replace("@f@", suffix);
        of_robot(&filled(&text, scalar, "@adding@", &value), &self.name, &self.upper)
    }

    fn function(&self, text: &mut String, function: &Function, notes: &Notes) {
        let C { module, name, upper } = self;
        let listing = Listing::of(function);
        let parts = listing.parts();
        for (part, number) in parts.iter().zip(1..) {
            self.part(text, function, part, number);
        }
        let (described, note) = described(module, function, notes);
        *text += "\n";
        *text += &function_comment(&described, note, name);
        let _ = writeln!(text, "static inline {}\n{{\n    {upper}_UNFUSED", signature(module, function));
        for argument in function.unused_arguments() {
            let _ = writeln!(text, "    (void){};", argument.name());
        }
        self.sines(text, function);
        if parts.is_empty() {
            self.lines(text, &listing.lines);
        }
        for (part, number) in parts.iter().zip(1..) {
            self.call(text, function, part, number);
        }
        self.result(text, function, &listing);
        *text += "}\n";
    }

    /// `s1`, `c1` and so on, all angles in one loop; arrays are filled up to whole vectors.
    fn sines(&self, text: &mut String, function: &Function) {
        let C { module, name, .. } = self;
        let waves = waves(module, function, self);
        let used = waves.len();
        if used == 0 {
            return;
        }
        let filled = used.next_multiple_of(most_lanes(module.scalar));
        let angles: Vec<&str> = waves.iter().map(|wave| wave.angle.as_str()).collect();
        let _ = writeln!(text, "    const {name}_real angle[{filled}] = {{{}}};", angles.join(", "));
        let _ = writeln!(text, "    {name}_real sine[{filled}], cosine[{filled}];");
        let _ = writeln!(text, "    {name}_sin_cos({used}, angle, sine, cosine);");
        for (i, wave) in waves.iter().enumerate() {
            for (value, from) in [(&wave.sine, "sine"), (&wave.cosine, "cosine")] {
                if let Some(value) = value {
                    self.define(text, value, &format!("{from}[{i}]"));
                }
            }
        }
    }

    fn define(&self, text: &mut String, name: &str, value: &str) {
        let _ = writeln!(text, "    const {}_real {name} = {value};", self.name);
    }

    fn lines(&self, text: &mut String, lines: &[Line]) {
        for line in lines {
            self.define(text, &Name::Step(line.name).text(), &expression(&line.value, self));
        }
    }

    /// The results, written when all arguments are read.
    fn result(&self, text: &mut String, function: &Function, listing: &Listing) {
        let values: Vec<String> = listing.entries.iter().map(|entry| expression(entry, self)).collect();
        if returns_a_number(function.quantity) {
            let _ = writeln!(text, "    return {};", values[0]);
            return;
        }
        let first = listing.entries.iter().any(reads_an_argument);
        if first {
            for (value, i) in values.iter().zip(1..) {
                self.define(text, &format!("r{i}"), value);
            }
        }
        let places = places(function.quantity, &self.module.sizes());
        for (((part, place), value), i) in places.iter().zip(&values).zip(1..) {
            let place: String = place.iter().map(|index| format!("[{index}]")).collect();
            let value = if first { format!("r{i}") } else { value.clone() };
            let _ = writeln!(text, "    {}{place} = {value};", part.name);
        }
    }

    /// A part of a long function.
    fn part(&self, text: &mut String, function: &Function, part: &BodyPart, number: usize) {
        let C { name, upper, .. } = self;
        let mut arguments: Vec<String> = part.arguments.iter().map(|a| format!("const {name}_real *{}", a.name())).collect();
        // A part that takes nothing but arguments has no values to take.
        if !part.taken.is_empty() {
            arguments.push(format!("const {name}_real taken[{}]", part.taken.len()));
        }
        arguments.push(format!("{name}_real given[{}]", part.given.len()));
        let function = function.name();
        let _ = writeln!(text, "\n/* Part {number} of `{name}_{function}`. */");
        let _ = writeln!(text, "static inline void {name}_{function}_part_{number}(\n    {})\n{{", arguments.join(",\n    "));
        let _ = writeln!(text, "    {upper}_UNFUSED");
        for (i, value) in part.taken.iter().enumerate() {
            self.define(text, &value.text(), &format!("taken[{i}]"));
        }
        self.lines(text, &part.lines);
        for (i, value) in part.given.iter().enumerate() {
            let _ = writeln!(text, "    given[{i}] = {};", value.text());
        }
        *text += "}\n";
    }

    /// The lines that call a part.
    fn call(&self, text: &mut String, function: &Function, part: &BodyPart, number: usize) {
        let name = &self.name;
        let mut arguments: Vec<String> = part.arguments.iter().map(|a| a.name().to_string()).collect();
        if !part.taken.is_empty() {
            let taken: Vec<String> = part.taken.iter().map(|value| value.text()).collect();
            let _ = writeln!(text, "    const {name}_real taken_{number}[{}] = {{{}}};", taken.len(), taken.join(", "));
            arguments.push(format!("taken_{number}"));
        }
        let _ = writeln!(text, "    {name}_real given_{number}[{}];", part.given.len());
        arguments.push(format!("given_{number}"));
        let _ = writeln!(text, "    {name}_{}_part_{number}({});", function.name(), arguments.join(", "));
        for (i, value) in part.given.iter().enumerate() {
            self.define(text, &value.text(), &format!("given_{number}[{i}]"));
        }
    }
}
