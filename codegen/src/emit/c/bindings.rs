//! The wrappers: the one emitted text with `unsafe` in it, because Rust cannot check the pointers that C passes. Each reads all its arguments
//! before it writes its result, so that a result may overwrite an argument.

use std::fmt::Write;

use proc_macro2::TokenStream;

use super::{prefix, returns_a_number};
use crate::catalogue::{Length, Quantity};
use crate::emit::rust::{self, written};
use crate::emit::Origin;
use crate::program::{Function, Module};

/// An output of a function: its name in C, what Rust writes after the result to have it, and its dimensions, outermost first.
struct Out {
    name: &'static str,
    access: String,
    lengths: &'static [Length],
}

/// The outputs that a function writes; none where it returns a number.
fn outs(quantity: &Quantity) -> Vec<Out> {
    if returns_a_number(quantity) {
        return Vec::new();
    }
    let parts = quantity.result.iter().zip(rust::accesses(quantity));
    let out = |access: TokenStream| access.to_string().replace(' ', "");
    parts.map(|(part, access)| Out { name: part.name, access: out(access), lengths: part.lengths }).collect()
}

pub(super) fn wrappers(module: &Module, origin: &Origin) -> String {
    let mut text = rust::head(origin, &[]);
    text += "// For C. Each wrapper believes what its declaration in the header says: that its pointers lead to arrays of these lengths.\n";
    for function in &module.functions {
        text += "\n";
        text += &wrapper(module, function);
    }
    text
}

fn wrapper(module: &Module, function: &Function) -> String {
    let (robot, name) = (prefix(module), function.name());
    let arguments: Vec<(&str, String)> = function.arguments.iter().map(|&a| (a.name(), a.length().constant())).collect();
    let outs = outs(function.quantity);
    let shape =
        |out: &Out| out.lengths.iter().rev().fold("Real".to_string(), |of, length| format!("[{of}; {}]", length.constant()));
    let mut parameters: Vec<String> = arguments.iter().map(|(name, length)| format!("{name}: *const [Real; {length}]")).collect();
    parameters.extend(outs.iter().map(|out| format!("{}: *mut {}", out.name, shape(out))));
    let list = |sign: &str| arguments.iter().map(|(name, _)| format!("{sign}{name}")).collect::<Vec<_>>().join(", ");
    let call = format!("{name}({})", list("&*"));
    let readable =
        "SAFETY: the caller promises that each argument points to an array of this length; nothing is written meanwhile.";
    let mut text = String::new();
    let _ = writeln!(text, "/// [`{name}`] for C.\n///\n/// # Safety");
    let _ = writeln!(
        text,
        "/// Each pointer leads to an array of the length in its type, aligned for `Real`. A result may lie where arguments do, but not where\n\
         /// another result does."
    );
    let _ = writeln!(text, "#[unsafe(no_mangle)]");
    let returns = if outs.is_empty() { " -> Real" } else { "" };
    let line = format!("pub unsafe extern \"C\" fn {robot}_{name}({}){returns} {{", parameters.join(", "));
    if line.len() <= 100 {
        let _ = writeln!(text, "{line}");
    } else {
        let _ = writeln!(text, "pub unsafe extern \"C\" fn {robot}_{name}(");
        for parameter in &parameters {
            let _ = writeln!(text, "    {parameter},");
        }
        let _ = writeln!(text, "){returns} {{");
    }
    let _ = writeln!(text, "    // {readable}");
    match outs.as_slice() {
        [] => {
            let _ = writeln!(text, "    unsafe {{ {call} }}");
        }
        outs if written::is_written(function, &module.sizes()) => {
            let _ = match arguments.as_slice() {
                [(name, _)] => writeln!(text, "    let {name} = unsafe {{ *{name} }};"),
                _ => writeln!(text, "    let ({}) = unsafe {{ ({}) }};", list(""), list("*")),
            };
            let _ = writeln!(
                text,
                "    // SAFETY: as the caller promises, each result points to an array of this shape, apart from the others; what C holds there is some number, \
                 and written before it is read; the arguments are copies."
            );
            let results: Vec<String> = outs.iter().map(|out| format!("&mut *{}", out.name)).collect();
            let _ = writeln!(text, "    unsafe {{ {}({}, {}) }}", written::name_into(function), list("&"), results.join(", "));
        }
        outs => {
            let _ = writeln!(text, "    let value = unsafe {{ {call} }};");
            let _ = writeln!(text, "    // SAFETY: the caller promises that each result points to an array of this shape; no reference to an argument is left.");
            let write = |out: &Out| format!("{}.write(value{});", out.name, out.access);
            let _ = writeln!(text, "    unsafe {{");
            for out in outs {
                let _ = writeln!(text, "        {}", write(out));
            }
            let _ = writeln!(text, "    }}");
        }
    }
    let _ = writeln!(text, "}}");
    text
}
