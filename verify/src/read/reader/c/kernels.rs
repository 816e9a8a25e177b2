//! Reads the kernels of a module in CUDA: their texts follow from the signatures of the functions.

use super::{Lines, Robot, COMMENTS};
use crate::read::reader::lexer::Fault;
use crate::read::reader::plain::promised;
use crate::values::contract::{of_module, Array, Length, Returned, Sizes};

const KERNELS: &str = include_str!("kernels.h");

/// Takes the kernels of these functions.
pub(super) fn read<'n>(
    lines: &mut Lines<'_>,
    robot: &Robot,
    sizes: &Sizes,
    functions: impl Iterator<Item = &'n str>,
) -> Result<(), Fault> {
    lines.expect_all(&robot.own(KERNELS), COMMENTS)?;
    for name in functions {
        if let Some(text) = kernel(robot, sizes, name) {
            lines.expect_all(&of_module(name, true, &text), COMMENTS)?;
        }
    }
    lines.expect("#endif")
}

/// The kernel of a function and its launch; nothing where an array has no entries.
fn kernel(robot: &Robot, sizes: &Sizes, name: &str) -> Option<String> {
    let sizes = &sizes.of_function(name);
    let (promise, arguments) = promised(name, sizes)?;
    let results = promise.returned.named();
    let entries = |array: Array| array.iter().map(|length| length.of(sizes)).product::<usize>();
    if arguments.iter().any(|argument| argument.length().of(sizes) == 0) || results.iter().any(|(_, array)| entries(array) == 0) {
        return None;
    }
    let number = promise.returned == Returned::One(&[]);
    let in_brackets = |length: Length| robot.length(length, sizes);
    let bare = |length: Length| in_brackets(length).trim_matches(['[', ']']).to_owned();
    let Robot { name: robot_name, upper } = robot;
    let real = format!("{robot_name}_real");

    let pointers = |restrict: &str| -> Vec<String> {
        let read = arguments.iter().map(|argument| format!("    const {real} *{restrict}{}", argument.name()));
        read.chain(results.iter().map(|(part, _)| format!("    {real} *{restrict}{part}"))).collect()
    };
    let names: Vec<&str> =
        arguments.iter().map(|argument| argument.name()).chain(results.iter().map(|(part, _)| part.as_str())).collect();
    let mut text = vec![
        "template <int threads>".to_owned(),
        format!("__global__ void __launch_bounds__(threads) {robot_name}_kernel_{name}("),
        "    size_t states,".into(),
        "    size_t leading,".into(),
        format!("{})", pointers("__restrict__ ").join(",\n")),
        "{".into(),
        "    size_t state;".into(),
        format!("    for (state = {upper}_FIRST_STATE; state < states; state += {upper}_ALL_THREADS) {{"),
    ];
    for argument in &arguments {
        text.push(format!("        {real} one_{}{};", argument.name(), in_brackets(argument.length())));
    }
    for (part, array) in &results {
        let shape: String = array.iter().map(|length| in_brackets(*length)).collect();
        text.push(format!("        {real} one_{part}{};", if number { "[1]" } else { &shape }));
    }
    for argument in &arguments {
        let length = bare(argument.length());
        text.push(format!("        {robot_name}_take({length}, state, leading, {0}, one_{0});", argument.name()));
    }
    let one = |names: &[&str]| names.iter().map(|name| format!("one_{name}")).collect::<Vec<_>>().join(", ");
    text.push(match number {
        true => format!("        one_result[0] = {robot_name}_{name}({});", one(&names[..arguments.len()])),
        false => format!("        {robot_name}_{name}({});", one(&names)),
    });
    for (part, array) in &results {
        let first = if number { "[0]".to_owned() } else { "[0]".repeat(array.len()) };
        text.push(format!("        {robot_name}_give({}, state, leading, &one_{part}{first}, {part});", entries(array)));
    }
    text.extend(["    }".into(), "}".into(), "template <int threads = 64>".into()]);
    text.push(format!("{robot_name}_status {robot_name}_launch_{name}("));
    text.extend(["    size_t states,".into(), "    size_t leading,".into(), format!("{},", pointers("").join(",\n"))]);
    text.extend([format!("    {robot_name}_stream stream)"), "{".into(), "    if (states > 0) {".into()]);
    text.push(format!("        {robot_name}_kernel_{name}<threads>"));
    text.push(format!(
        "            <<<{robot_name}_blocks(states, threads), threads, 0, stream>>>(states, leading, {});",
        names.join(", ")
    ));
    text.extend(["    }".into(), format!("    return {upper}_LAST_ERROR();"), "}".into()]);
    Some(text.join("\n") + "\n")
}
