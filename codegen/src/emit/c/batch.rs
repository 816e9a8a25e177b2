//! The functions for many states, as Rust's `lanes` and `batch`: a loop over lanes around the lines of the function for one state, which the
//! compiler turns into vector instructions. Each state has the bits that the function for one state gives it.

use std::fmt::Write;

use super::syntax::{most_lanes, C};
use super::{macro_of, returns_a_number};
use crate::catalogue::{Argument, Sizes};
use crate::emit::plain::{expression, of_robot, waves, Syntax};
use crate::exact::Number;
use crate::program::listing::{Listing, Name};
use crate::program::Function;

const BLOCKS: &str = include_str!("blocks.h");

/// As in the function for one state, except that the arguments belong to a lane.
struct Lanes<'a>(&'a C<'a>);

impl Syntax for Lanes<'_> {
    fn number(&self, value: &Number) -> String {
        self.0.number(value)
    }

    fn sign(&self, entry: &str) -> String {
        self.0.sign(entry)
    }

    fn stribeck(&self, entry: &str, velocity: &str) -> String {
        self.0.stribeck(entry, velocity)
    }

    fn fused(&self, parts: [String; 3]) -> String {
        self.0.fused(parts)
    }

    fn entry(&self, argument: Argument, index: usize) -> String {
        format!("lanes_{}[{index}][lane]", argument.name())
    }
}

/// All functions, for blocks of `lanes` states.
pub(super) fn print(c: &C<'_>, lanes: usize) -> String {
    let mut text = of_robot(BLOCKS, &c.name, &c.upper).replace("@", &lanes.to_string());
    for function in &c.module.functions {
        c.batch(&mut text, function);
    }
    text
}

/// The signature of a function for many states.
pub(super) fn signature(c: &C<'_>, function: &Function, name: &str) -> String {
    let real = format!("{}_real", c.name);
    let arguments = function.arguments.iter().map(|a| format!("const {real} *{}", a.name()));
    let results = function.quantity.result.iter().map(|part| format!("{real} *{}", part.name));
    let all: Vec<String> = ["size_t states".to_string()].into_iter().chain(arguments).chain(results).collect();
    format!("void {name}(\n    {})", all.join(",\n    "))
}

impl C<'_> {
    fn batch(&self, text: &mut String, function: &Function) {
        let C { module, name, upper } = self;
        let sizes = module.sizes();
        let own = function.name();
        let _ =
            writeln!(text, "\n/* `{name}_{own}` for so many states: arguments and results flat, by rows, state after state. */");
        let _ = writeln!(text, "static inline {}\n{{", signature(self, function, &format!("{name}_batch_{own}")));
        let listing = Listing::of(function);
        if !listing.parts().is_empty() || function.quantity.result.iter().all(|part| part.len(&sizes) == 0) {
            self.one_by_one(text, function, &sizes);
            *text += "}\n";
            return;
        }
        let _ = writeln!(text, "    {upper}_UNFUSED");
        let _ = writeln!(text, "    size_t start;\n    for (start = 0; start < states; start += {upper}_LANES) {{");
        let _ = writeln!(text, "        const size_t count = states - start < {upper}_LANES ? states - start : {upper}_LANES;");
        let waves = waves(module, function, &Lanes(self));
        let unused = function.unused_arguments();
        for argument in function.arguments.iter().filter(|argument| !unused.contains(argument)) {
            let _ = writeln!(
                text,
                "        {name}_real lanes_{}[{}][{upper}_LANES];",
                argument.name(),
                macro_of(upper, argument.length())
            );
        }
        if !waves.is_empty() {
            // Filled up to whole vectors; zeros where the lanes of an angle are no whole vectors.
            let vector = most_lanes(module.scalar);
            let fits = |n: &usize| vector.is_multiple_of(*n) && module.batch.is_some_and(|lanes| lanes % n == 0);
            let step = vector / (1..=vector).rev().find(fits).unwrap_or(1);
            let shape = format!("[{}][{upper}_LANES]", waves.len().next_multiple_of(step));
            let zeros = if step > 1 { " = {{0}}" } else { "" };
            let _ = writeln!(text, "        {name}_real angle{shape}{zeros}, sine{shape}, cosine{shape};");
        }
        for part in function.quantity.result {
            let _ = writeln!(text, "        {name}_real lanes_{}[{}][{upper}_LANES];", part.name, part.len(&sizes));
        }
        *text += "        int lane;\n";
        for argument in &unused {
            let _ = writeln!(text, "        (void){};", argument.name());
        }
        for argument in function.arguments.iter().filter(|argument| !unused.contains(argument)) {
            let (argument, length) = (argument.name(), macro_of(upper, argument.length()));
            let _ =
                writeln!(text, "        {name}_load({length}, count, {argument} + start * {length}, &lanes_{argument}[0][0]);");
        }
        let begin = format!("        for (lane = 0; lane < {upper}_LANES; ++lane) {{\n");
        if !waves.is_empty() {
            *text += &begin;
            for (i, wave) in waves.iter().enumerate() {
                let _ = writeln!(text, "            angle[{i}][lane] = {};", wave.angle);
            }
            let _ = writeln!(
                text,
                "        }}\n        {name}_sin_cos({} * {upper}_LANES, &angle[0][0], &sine[0][0], &cosine[0][0]);",
                waves.len()
            );
        }
        *text += &begin;
        let define = |text: &mut String, value: &str, is: &str| {
            let _ = writeln!(text, "            const {name}_real {value} = {is};");
        };
        for (i, wave) in waves.iter().enumerate() {
            for (value, from) in [(&wave.sine, "sine"), (&wave.cosine, "cosine")] {
                if let Some(value) = value {
                    define(text, value, &format!("{from}[{i}][lane]"));
                }
            }
        }
        for line in &listing.lines {
            define(text, &Name::Step(line.name).text(), &expression(&line.value, &Lanes(self)));
        }
        let mut entries = listing.entries.iter();
        for part in function.quantity.result {
            for (i, entry) in entries.by_ref().take(part.len(&sizes)).enumerate() {
                let _ = writeln!(text, "            lanes_{}[{i}][lane] = {};", part.name, expression(entry, &Lanes(self)));
            }
        }
        *text += "        }\n";
        for part in function.quantity.result {
            let (part, entries) = (part.name, part.len(&sizes));
            let _ = writeln!(text, "        {name}_store({entries}, count, &lanes_{part}[0][0], {part} + start * {entries});");
        }
        *text += "    }\n}\n";
    }

    /// A function of many lines, state after state.
    fn one_by_one(&self, text: &mut String, function: &Function, sizes: &Sizes) {
        let C { name, upper, .. } = self;
        let arguments = function.arguments.iter().map(|a| format!("{0} + state * {1}", a.name(), macro_of(upper, a.length())));
        let mut all: Vec<String> = arguments.collect();
        let call = format!("{name}_{}", function.name());
        let _ = writeln!(text, "    size_t state;\n    for (state = 0; state < states; ++state) {{");
        if returns_a_number(function.quantity) {
            let _ = writeln!(text, "        {}[state] = {call}({});", function.quantity.result[0].name, all.join(", "));
        } else {
            all.extend(function.quantity.result.iter().map(|part| {
                let inner: String = part.lengths.iter().skip(1).map(|&length| format!("[{}]", macro_of(upper, length))).collect();
                let place = format!("{} + state * {}", part.name, part.len(sizes));
                if inner.is_empty() {
                    place
                } else {
                    format!("({name}_real (*){inner})({place})")
                }
            }));
            let _ = writeln!(text, "        {call}({});", all.join(", "));
        }
        *text += "    }\n";
    }
}
