//! The table of `armgen count`: the operations of every function, and the method that derived it.

use std::fmt::Write;

use armgen_codegen::program::{Cost, Module};

use crate::html::escape;

pub(crate) fn table(module: &Module) -> String {
    let mut text = format!("<p class=\"small\">Operations of the functions that <code>armgen generate</code> writes<span class=\"keys\">; a column is sorted by a click</span>. Functions that end in <code>_with</code> take the parameters as an argument. The weight counts a multiplication or an addition 1, a division {}, a sine with its cosine or an exponential {}, a change of sign 0.</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Operations\"><table class=\"costs\">\n<thead><tr>",
        Cost { div: 1, ..Cost::default() }.weight(),
        Cost { sincos: 1, ..Cost::default() }.weight(),
    );
    for column in ["function", "mul", "add", "div", "neg", "sincos", "exp", "derived by"] {
        let _ = write!(text, "<th scope=\"col\"><button type=\"button\">{column}</button></th>");
    }
    text += "<th scope=\"col\"><button type=\"button\">weight</button></th></tr></thead>\n<tbody>\n";
    for function in &module.functions {
        let cost = Cost::of(function);
        let _ = write!(text, "<tr><th scope=\"row\">{}</th>", escape(&function.name()).replace('_', "_<wbr>"));
        for count in [cost.mul, cost.add, cost.div, cost.neg, cost.sincos, cost.exp] {
            let _ = write!(text, "<td>{count}</td>");
        }
        let _ = writeln!(
            text,
            "<td>{}</td><td data-value=\"{weight}\">{weight} <span class=\"bar\"></span></td></tr>",
            escape(function.method),
            weight = cost.weight(),
        );
    }
    text + "</tbody>\n</table></div>\n"
}
