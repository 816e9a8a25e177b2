//! The functions for many states on a GPU: a kernel around each function for one state, and its launch.

use std::fmt::Write;

use super::syntax::C;
use super::{macro_of, returns_a_number};
use crate::emit::plain::of_robot;
use crate::program::Function;

const KERNELS: &str = include_str!("kernels.h");

/// All kernels. They are templates, so that a program compiles those that it launches.
pub(super) fn print(c: &C<'_>) -> String {
    let mut text = "\n".to_string() + &of_robot(KERNELS, &c.name, &c.upper);
    for function in &c.module.functions {
        c.kernel(&mut text, function);
    }
    text + "#endif\n"
}

impl C<'_> {
    fn kernel(&self, text: &mut String, function: &Function) {
        let C { module, name, upper } = self;
        let (own, sizes) = (function.name(), module.sizes());
        let results = function.quantity.result;
        let arguments: Vec<(&str, String)> =
            function.arguments.iter().map(|argument| (argument.name(), macro_of(upper, argument.length()))).collect();
        // C has no arrays without entries.
        if results.iter().any(|part| part.len(&sizes) == 0) || function.arguments.iter().any(|a| a.length().of(&sizes) == 0) {
            return;
        }
        let pointers = |restrict: &str| {
            let arguments = arguments.iter().map(|(argument, _)| format!("const {name}_real *{restrict}{argument}"));
            arguments
                .chain(results.iter().map(|part| format!("{name}_real *{restrict}{}", part.name)))
                .collect::<Vec<_>>()
                .join(",\n    ")
        };
        let names: Vec<&str> =
            arguments.iter().map(|(argument, _)| *argument).chain(results.iter().map(|part| part.name)).collect();
        let names = names.join(", ");
        let _ = writeln!(
            text,
            "\n/* `{name}_{own}` for many states. */\ntemplate <int threads>\n__global__ void __launch_bounds__(threads) \
             {name}_kernel_{own}(\n    size_t states,\n    size_t leading,\n    {})\n{{\n    size_t state;\n    \
             for (state = {upper}_FIRST_STATE; state < states; state += {upper}_ALL_THREADS) {{",
            pointers("__restrict__ ")
        );
        for (argument, length) in &arguments {
            let _ = writeln!(text, "        {name}_real one_{argument}[{length}];");
        }
        for part in results {
            let shape: String = part.lengths.iter().map(|&length| format!("[{}]", macro_of(upper, length))).collect();
            let _ = writeln!(text, "        {name}_real one_{}{};", part.name, if shape.is_empty() { "[1]" } else { &shape });
        }
        for (argument, length) in &arguments {
            let _ = writeln!(text, "        {name}_take({length}, state, leading, {argument}, one_{argument});");
        }
        let mut passed: Vec<String> = arguments.iter().map(|(argument, _)| format!("one_{argument}")).collect();
        if returns_a_number(function.quantity) {
            let _ = writeln!(text, "        one_{}[0] = {name}_{own}({});", results[0].name, passed.join(", "));
        } else {
            passed.extend(results.iter().map(|part| format!("one_{}", part.name)));
            let _ = writeln!(text, "        {name}_{own}({});", passed.join(", "));
        }
        for part in results {
            let first = "[0]".repeat(part.lengths.len().max(1));
            let _ = writeln!(
                text,
                "        {name}_give({}, state, leading, &one_{}{first}, {});",
                part.len(&sizes),
                part.name,
                part.name
            );
        }
        let _ = writeln!(
            text,
            "    }}\n}}\n\ntemplate <int threads = 64>\n{name}_status {name}_launch_{own}(\n    size_t states,\n    size_t leading,\n    {},\n    \
             {name}_stream stream)\n{{\n    if (states > 0) {{\n        {name}_kernel_{own}<threads>\n            \
             <<<{name}_blocks(states, threads), threads, 0, stream>>>(states, leading, {names});\n    }}\n    return {upper}_LAST_ERROR();\n}}",
            pointers("")
        );
    }
}
