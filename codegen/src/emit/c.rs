//! The C face of a module: a header, and `extern "C"` wrappers in Rust that stand beside the module's functions.
//!
//! A C caller sees `ROBOT_function`, arrays by rows as in the module, constant where they are arguments, and the result as the last
//! argument; a single number is returned. This is the one emitted text with `unsafe` in it: a pointer that C passes can only be
//! believed. Each wrapper reads all its arguments before it writes its result, so that a result may overwrite an argument.

use std::fmt::Write;

use proc_macro2::TokenStream;

use super::rust::{accesses, head, Origin};
use super::{documentation, literal::literal};
use crate::catalogue::{Length, Quantity};
use crate::exact::Number;
use crate::program::{Function, Module, Scalar};

/// The two texts of the C face.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CFace {
    /// The header: `robot.h` for a module in `robot.rs`.
    pub header: String,
    /// The wrappers: `robot_c.rs`, to be included beside the functions of the module.
    pub wrappers: String,
}

/// The C face of a module.
pub fn print(module: &Module, origin: &Origin) -> CFace {
    CFace { header: header(module, origin), wrappers: wrappers(module, origin) }
}

/// An output of a function: its name in C, what Rust writes after the result to have it, and its dimensions, outermost first.
struct Out {
    name: &'static str,
    access: String,
    lengths: &'static [Length],
}

/// The outputs that a function writes; none where it returns a number.
fn outs(quantity: &Quantity) -> Vec<Out> {
    if quantity.result.iter().all(|part| part.lengths.is_empty()) && quantity.result.len() == 1 {
        return Vec::new();
    }
    let parts = quantity.result.iter().zip(accesses(quantity));
    let out = |access: TokenStream| access.to_string().replace(' ', "");
    parts.map(|(part, access)| Out { name: part.name, access: out(access), lengths: part.lengths }).collect()
}

/// The functions that C can have: it has no arrays of length zero, as a robot without parameters would need.
fn functions(module: &Module) -> impl Iterator<Item = &Function> {
    let without = module.parameters.is_empty();
    module.functions.iter().filter(move |f| !(without && (f.with_parameters || f.quantity.has_length(Length::Parameters))))
}

/// The robot's name as the beginning of C's names: letters that C may not have are spelled out.
fn prefix(module: &Module) -> String {
    let spelled = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c.to_string() } else { format!("u{:04x}", u32::from(c)) };
    module.name.chars().map(spelled).collect()
}

/// A dimension: the macro of the header that holds it, or the number.
fn macro_of(prefix: &str, length: Length) -> String {
    match length {
        Length::Fixed(value) => value.to_string(),
        named => format!("{prefix}_{}", named.constant()),
    }
}

fn header(module: &Module, origin: &Origin) -> String {
    let name = prefix(module);
    let upper = name.to_uppercase();
    let real = match module.scalar {
        Scalar::F64 => "double",
        Scalar::F32 => "float",
    };
    let mut text = String::new();
    let lines: Vec<String> = head(origin, &[]).lines().map(|line| line.trim_start_matches('/').trim().to_string()).collect();
    text += &comment("", lines);
    let braces = |entries: Vec<String>| format!("{{{}}}", entries.join(", "));
    let number = |value: &Option<Number>, infinite: &str| match value {
        Some(value) => constant(value, module.scalar),
        None => infinite.into(),
    };
    let joint = |name: &(String, bool)| format!("\"{}\"", name.0);
    let limit = |index: usize| braces(module.limits.iter().map(|limits| number(&limits[index], "INFINITY")).collect());
    let positions = module.limits.iter().map(|[low, high, ..]| braces(vec![number(low, "-INFINITY"), number(high, "INFINITY")]));
    let guard = format!("ARMGEN_{upper}_H");
    let _ = write!(
        text,
        "#ifndef {guard}\n#define {guard}\n\n\
         #ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n\
         /* The scalar of all functions. */\ntypedef {real} {name}_real;\n\n\
         /* Number of joints, of parameters, and of rows of the operational space. */\n\
         #define {upper}_DOF {}\n#define {upper}_PARAMETERS {}\n#define {upper}_TASK_ROWS {}\n\n",
        module.joints.len(),
        module.parameters.len(),
        module.task.len(),
    );
    if !module.task.is_empty() {
        let rows = module.task.iter().map(ToString::to_string).collect();
        let _ = writeln!(
            text,
            "/* Rows of the geometric Jacobian in the operational space: 0 1 2 velocity along, 3 4 5 angular velocity about x y z. */\n\
             #define {upper}_TASK {}\n",
            braces(rows)
        );
    }
    text += "/* Initialisers of arrays. Limits are rad or m, per s, N m or N; infinite (math.h) where the description gives none. */\n";
    let _ = writeln!(text, "#define {upper}_JOINT_NAMES {}", braces(module.joints.iter().map(joint).collect()));
    let _ = writeln!(text, "#define {upper}_POSITION_LIMITS {}", braces(positions.collect()));
    let _ = writeln!(text, "#define {upper}_VELOCITY_LIMITS {}", limit(2));
    let _ = writeln!(text, "#define {upper}_EFFORT_LIMITS {}", limit(3));
    if !module.parameters.is_empty() {
        let names = module.parameters.iter().map(|(name, ..)| format!("\"{name}\"")).collect();
        let nominal = module.parameters.iter().map(|(_, value, _)| constant(value, module.scalar)).collect();
        let _ = writeln!(text, "#define {upper}_PARAMETER_NAMES {}", braces(names));
        let _ = writeln!(text, "#define {upper}_NOMINAL_PARAMETERS {}", braces(nominal));
        text += "\n";
        text += &meanings("The parameters, in the order of the columns of the regressor:", Vec::new(), &module.parameters);
    }
    if !module.base_set.is_empty() {
        let names = module.base_set.iter().map(|(name, ..)| format!("\"{name}\"")).collect();
        let nominal = module.base_set.iter().map(|(_, value, _)| constant(value, module.scalar)).collect();
        let _ = writeln!(text, "\n#define {upper}_BASE_PARAMETERS {}", module.base_set.len());
        let _ = writeln!(text, "#define {upper}_BASE_PARAMETER_NAMES {}", braces(names));
        let _ = writeln!(text, "#define {upper}_NOMINAL_BASE_PARAMETERS {}", braces(nominal));
        text += "\n";
        let title = format!("The base parameters, in the order of the columns of {name}_base_regressor:");
        text += &meanings(&title, super::rust::own_base_note(module), &module.base_set);
    }
    text += "\n/* Arrays are by rows; arguments and results point to distinct or to the same memory, as the caller likes. */\n";
    for function in functions(module) {
        text += "\n";
        text += &comment(
            "",
            documentation::function(function, &module.gravity)
                .into_iter()
                .filter(|line| !line.contains("```"))
                .map(|line| names_of_c(module, &line, &name, &upper))
                .collect(),
        );
        let mut arguments: Vec<String> = function
            .arguments
            .iter()
            .map(|&a| format!("const {name}_real {}[{}]", a.name(), macro_of(&upper, a.length())))
            .collect();
        let outs = outs(function.quantity);
        arguments.extend(outs.iter().map(|out| {
            let shape: String = out.lengths.iter().map(|&length| format!("[{}]", macro_of(&upper, length))).collect();
            format!("{name}_real {}{shape}", out.name)
        }));
        let returns = if outs.is_empty() { format!("{name}_real") } else { "void".into() };
        let _ = writeln!(text, "{returns} {name}_{}(\n    {});", function.name(), arguments.join(",\n    "));
    }
    text += "\n#ifdef __cplusplus\n}\n#endif\n\n";
    let _ = writeln!(text, "#endif");
    text
}

/// What parameters mean, one a line below a title and notes.
fn meanings(title: &str, notes: Vec<String>, parameters: &[(String, Number, String)]) -> String {
    let width = parameters.iter().map(|(name, ..)| name.len()).max().unwrap_or(0);
    let listed = parameters.iter().map(|(name, _, meaning)| format!("{name:width$}  {meaning}"));
    comment("", [title.to_string(), String::new()].into_iter().chain(notes).chain(listed).collect())
}

/// A line of documentation with the names that things have in C.
fn names_of_c(module: &Module, line: &str, name: &str, upper: &str) -> String {
    let constants = ["PARAMETER_NAMES", "NOMINAL_PARAMETERS", "BASE_PARAMETER_NAMES", "NOMINAL_BASE_PARAMETERS", "TASK"];
    let line = constants
        .iter()
        .fold(line.to_string(), |line, constant| line.replace(&format!("`{constant}`"), &format!("`{upper}_{constant}`")));
    module
        .functions
        .iter()
        .map(Function::name)
        .fold(line, |line, function| line.replace(&format!("`{function}`"), &format!("`{name}_{function}`")))
}

/// A block comment; runs of blank lines become one.
fn comment(indent: &str, lines: Vec<String>) -> String {
    let mut text = String::new();
    let mut blank = true;
    let mut open = false;
    for line in lines {
        let line = line.trim_end().replace("*/", "* /");
        let line = line.strip_prefix(' ').unwrap_or(&line);
        if line.is_empty() {
            blank = true;
            continue;
        }
        if !open {
            let _ = writeln!(text, "{indent}/* {line}");
            open = true;
        } else {
            if blank {
                let _ = writeln!(text, "{indent} *");
            }
            let _ = writeln!(text, "{indent} * {line}");
        }
        blank = false;
    }
    if open {
        let _ = writeln!(text, "{indent} */");
    }
    text
}

/// A number as C reads it back to the same float.
fn constant(value: &Number, scalar: Scalar) -> String {
    let tokens: TokenStream = literal(value, scalar);
    let digits = tokens.to_string().replace(' ', "");
    match scalar {
        Scalar::F64 => digits,
        Scalar::F32 => format!("{digits}f"),
    }
}

fn wrappers(module: &Module, origin: &Origin) -> String {
    let mut text = head(origin, &[]);
    text += "// For C. Each wrapper believes what its declaration in the header says: that its pointers lead to arrays of these lengths.\n";
    for function in functions(module) {
        text += "\n";
        text += &wrapper(&prefix(module), function);
    }
    text
}

fn wrapper(robot: &str, function: &Function) -> String {
    let name = function.name();
    let arguments: Vec<(&str, String)> = function.arguments.iter().map(|&a| (a.name(), a.length().constant())).collect();
    let outs = outs(function.quantity);
    let shape =
        |out: &Out| out.lengths.iter().rev().fold("Real".to_string(), |of, length| format!("[{of}; {}]", length.constant()));
    let mut parameters: Vec<String> = arguments.iter().map(|(name, length)| format!("{name}: *const [Real; {length}]")).collect();
    parameters.extend(outs.iter().map(|out| format!("{}: *mut {}", out.name, shape(out))));
    let references: Vec<String> = arguments.iter().map(|(name, _)| format!("&*{name}")).collect();
    let call = format!("{name}({})", references.join(", "));
    let readable =
        "SAFETY: the caller promises that each argument points to an array of this length; nothing is written meanwhile.";
    let mut text = String::new();
    let _ = writeln!(text, "/// [`{name}`] for C.\n///\n/// # Safety");
    let _ = writeln!(
        text,
        "/// Each pointer leads to an array of the length in its type, aligned for `Real`. They may lead to the same one."
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
