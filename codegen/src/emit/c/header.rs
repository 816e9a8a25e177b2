//! The header.

use std::fmt::Write;

use super::{prefix, returns_a_number};
use crate::catalogue::{Absent, Length};
use crate::emit::documentation::{self, Block, Described, DescribedParameters, Link};
use crate::emit::parameters::INDEX;
use crate::emit::plain::of_robot;
use crate::emit::{head, Origin};
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::listing::decimal;
use crate::program::{Function, Joint, Module};

/// A dimension: the macro of the header that holds it, or the number.
pub(super) fn macro_of(prefix: &str, length: Length) -> String {
    match length {
        Length::Fixed(value) => value.to_string(),
        named => format!("{prefix}_{}", named.constant()),
    }
}

/// Prefix of the macros of a robot: its name with upper and lower case exchanged. So names that differ only in case have different macros.
pub(super) fn macros_of(name: &str) -> String {
    let turned = |c: char| if c.is_ascii_lowercase() { c.to_ascii_uppercase() } else { c.to_ascii_lowercase() };
    name.chars().map(turned).collect()
}

/// How the documentation of a robot's functions names them, their arguments and its macros.
pub(super) fn link<'a>(name: &'a str, upper: &'a str) -> impl Fn(Link<'_>) -> String + 'a {
    move |link| match link {
        Link::Function(function) => format!("`{name}_{function}`"),
        Link::Argument(argument) => format!("`{argument}`"),
        Link::Constant(constant) => format!("`{upper}_{constant}`"),
    }
}

/// The beginning of both headers: the lines of the head, missing functions, and the guard.
pub(super) fn opening(mut head: Vec<String>, absent: &[Absent], upper: &str) -> String {
    head.extend(absent.iter().map(|absent| format!("There is no `{}`: {}.", absent.function, absent.reason)));
    let head = comment(&[Block::Verbatim(head)], &|_| String::new());
    let guard = format!("ARMGEN_{upper}_H");
    format!("{head}#ifndef {guard}\n#define {guard}\n\n")
}

pub(super) fn header(module: &Module, origin: &Origin) -> String {
    let name = prefix(module);
    let upper = macros_of(&name);
    let mut text = opening(head::lines(origin, &[]), &[], &upper);
    text += &of_robot(OF_RUST, &name, &upper);
    text += "#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n";
    text += &macros(module);
    text += POINTERS;
    for function in &module.functions {
        text += "\n";
        text += &function_comment(&documentation::described(function, module), None, &name);
        text += &format!("{};\n", signature(module, function));
    }
    text += "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
    text
}

/// For the header of the functions in Rust.
const OF_RUST: &str = "/*\n * The functions are those of the module in Rust, with its bits, whatever the C compiler. No header is included, as with \
     ROBOT_NO_MATH_H\n * where the header holds the functions itself: INFINITY, where a limit below is infinite, is in math.h.\n */\n\
     #define ROBOT_SAME_BITS 1\n\n";

/// Documentation of all functions.
pub(super) const POINTERS: &str =
    "\n/* Arrays are by rows. A result may lie where arguments do, but not where another result does. */\n";

/// Documentation of the rows of a task.
const TASK: &str =
    "Rows of the geometric Jacobian in the operational space: 0 1 2 velocity along, 3 4 5 angular velocity about x y z.";

/// The name, the scalar and the other macros.
pub(super) fn macros(module: &Module) -> String {
    let name = prefix(module);
    let upper = macros_of(&name);
    let real = match module.scalar {
        Scalar::F64 => "double",
        Scalar::F32 => "float",
    };
    let mut text = String::new();
    let described = DescribedParameters::of(module);
    let braces = |entries: Vec<String>| format!("{{{}}}", entries.join(", "));
    let number = |value: &Option<Number>, infinite: &str| match value {
        Some(value) => constant(value, module.scalar),
        None => infinite.into(),
    };
    let joint = |joint: &Joint| format!("\"{}\"", joint.name);
    let limits =
        |of: fn(&Joint) -> &Option<Number>| braces(module.joints.iter().map(|joint| number(of(joint), "INFINITY")).collect());
    let position = |joint: &Joint| {
        let [low, high] = &joint.position;
        braces(vec![number(low, "-INFINITY"), number(high, "INFINITY")])
    };
    let positions = module.joints.iter().map(position);
    let revolute = module.joints.iter().map(|joint| if joint.is_revolute { "1" } else { "0" }.to_string());
    let _ = write!(
        text,
        "/* Name of the robot, and whether each joint turns (q in rad) or slides (q in m). */\n\
         #define {upper}_NAME \"{}\"\n#define {upper}_JOINT_IS_REVOLUTE {}\n\n\
         /* The scalar of all functions. */\ntypedef {real} {name}_real;\n\n\
         /* Number of joints, of parameters{}. */\n\
         #define {upper}_DOF {}\n#define {upper}_PARAMETERS {}\n",
        module.name,
        braces(revolute.collect()),
        if module.tips.is_empty() { ", and of rows of the operational space" } else { "" },
        module.joints.len(),
        module.parameters.len(),
    );
    let counted = |all: &[usize]| braces(all.iter().map(ToString::to_string).collect());
    if module.tips.is_empty() {
        let _ = writeln!(text, "#define {upper}_TASK_ROWS {}\n", module.task.len());
        if !module.task.is_empty() {
            let _ = writeln!(text, "/* {TASK} */\n#define {upper}_TASK {}\n", counted(&module.task));
        }
    } else {
        let names = module.tips.iter().map(|tip| format!("\"{}\"", tip.name)).collect();
        let _ = writeln!(text, "\n/* Names of the end effectors. */\n#define {upper}_TIPS {}\n", braces(names));
        let _ = writeln!(text, "/* Of each end effector the number of rows of its operational space, and the joints that move it, from 0.\n * {TASK} */");
        for tip in &module.tips {
            let [rows, task, coordinates] = ["TASK_ROWS", "TASK", "COORDINATES"].map(|name| tip.constant(name));
            let _ = writeln!(text, "#define {upper}_{rows} {}\n#define {upper}_{task} {}", tip.task.len(), counted(&tip.task));
            let _ = writeln!(text, "#define {upper}_{coordinates} {}", counted(&tip.coordinates));
        }
        text += "\n";
    }
    text += "/* Initialisers of arrays. Limits are rad or m, per s, s² and s³, N m or N; infinite (math.h) where the description gives none. */\n";
    let _ = writeln!(text, "#define {upper}_JOINT_NAMES {}", braces(module.joints.iter().map(joint).collect()));
    let _ = writeln!(text, "#define {upper}_POSITION_LIMITS {}", braces(positions.collect()));
    let _ = writeln!(text, "#define {upper}_VELOCITY_LIMITS {}", limits(|joint| &joint.velocity));
    let _ = writeln!(text, "#define {upper}_EFFORT_LIMITS {}", limits(|joint| &joint.effort));
    let _ = writeln!(text, "#define {upper}_ACCELERATION_LIMITS {}", limits(|joint| &joint.acceleration));
    let _ = writeln!(text, "#define {upper}_JERK_LIMITS {}", limits(|joint| &joint.jerk));
    if let Some(coupling) = &module.coupling {
        let names = coupling.names.iter().map(|name| format!("\"{name}\"")).collect();
        let numbers = |row: &[Number]| braces(row.iter().map(|value| constant(value, module.scalar)).collect());
        let rows = coupling.factors.iter().map(|row| numbers(row)).collect();
        text += "\n/* The variables of all joints, those that follow others included, are S q + c: S is COUPLING, a row for each joint, c COUPLING_OFFSET. */\n";
        let _ =
            writeln!(text, "#define {upper}_JOINTS {}\n#define {upper}_ALL_JOINT_NAMES {}", coupling.names.len(), braces(names));
        let _ = writeln!(text, "#define {upper}_COUPLING {}", braces(rows));
        let _ = writeln!(text, "#define {upper}_COUPLING_OFFSET {}\n", numbers(&coupling.offsets));
    }
    if let Some(motors) = &module.motors {
        let rows = motors.rates.iter().map(|row| braces(row.iter().map(|value| constant(value, module.scalar)).collect()));
        let joints = motors.joints.join(", ");
        let _ = writeln!(text, "\n/* N of the rotor speeds N dq beside the links that carry the rotors, a row for each motor, of the joints {joints}. */");
        let _ = writeln!(text, "#define {upper}_MOTORS {}", motors.joints.len());
        let _ = writeln!(text, "#define {upper}_MOTOR_RATES {}\n", braces(rows.collect()));
    }
    if !module.parameters.is_empty() {
        let names = module.parameters.iter().map(|parameter| format!("\"{}\"", parameter.name)).collect();
        let nominal = module.parameters.iter().map(|parameter| constant(&parameter.nominal, module.scalar)).collect();
        let _ = writeln!(text, "#define {upper}_PARAMETER_NAMES {}", braces(names));
        let _ = writeln!(text, "#define {upper}_NOMINAL_PARAMETERS {}", braces(nominal));
        text += "\n";
        text += &parameters_comment(&described);
        let places: Vec<String> =
            module.parameters.iter().map(|parameter| format!("{upper}_PARAMETER_INDEX_{}", parameter.name)).collect();
        let _ = writeln!(text, "\n/* {INDEX} */\nenum {};", braces(places));
    }
    if module.gravity_is_argument {
        let nominal = module.gravity.iter().map(|component| constant(component, module.scalar)).collect();
        text += "\n/* Acceleration of free fall in the description, in the base frame, m/s². */\n";
        let _ = writeln!(text, "#define {upper}_NOMINAL_GRAVITY {}", braces(nominal));
    }
    if !module.base_set.is_empty() {
        let names = module.base_set.iter().map(|parameter| format!("\"{}\"", parameter.name)).collect();
        let nominal = module.base_set.iter().map(|parameter| constant(&parameter.nominal, module.scalar)).collect();
        let _ = writeln!(text, "\n#define {upper}_BASE_PARAMETERS {}", module.base_set.len());
        let _ = writeln!(text, "#define {upper}_BASE_PARAMETER_NAMES {}", braces(names));
        let _ = writeln!(text, "#define {upper}_NOMINAL_BASE_PARAMETERS {}", braces(nominal));
        text += "\n";
        text += &base_parameters_comment(&described, &name);
    }
    text
}

/// Meaning of the names of parameters.
pub fn parameters_comment(described: &DescribedParameters) -> String {
    let title = Block::text("The parameters, in the order of the columns of the regressor:");
    comment(&[title, Block::Table(described.parameters.clone())], &|_| String::new())
}

/// Meaning of the names of base parameters; `name`: prefix of the functions of the robot.
pub fn base_parameters_comment(described: &DescribedParameters, name: &str) -> String {
    let title = Block::text(format!("The base parameters, in the order of the columns of {name}_base_regressor:"));
    let blocks: Vec<Block> = [title].into_iter().chain(described.base_meanings()).collect();
    comment(&blocks, &|_| String::new())
}

/// The comment of a function; `note` ends it; `name`: prefix of the functions of the robot.
pub fn function_comment(described: &Described<'_>, note: Option<&str>, name: &str) -> String {
    comment(&described.blocks(false, note), &link(name, &macros_of(name)))
}

/// The declaration of a function, up to its end.
pub(super) fn signature(module: &Module, function: &Function) -> String {
    let name = prefix(module);
    let upper = macros_of(&name);
    let mut arguments: Vec<String> =
        function.arguments.iter().map(|&a| format!("const {name}_real {}[{}]", a.name(), macro_of(&upper, a.length()))).collect();
    let returned = returns_a_number(function.quantity);
    if !returned {
        arguments.extend(function.quantity.result.iter().map(|part| {
            let shape: String = part.lengths.iter().map(|&length| format!("[{}]", macro_of(&upper, length))).collect();
            format!("{name}_real {}{shape}", part.name)
        }));
    }
    let returns = if returned { format!("{name}_real") } else { "void".into() };
    format!("{returns} {name}_{}(\n    {})", function.name(), arguments.join(",\n    "))
}

/// A block comment.
pub(super) fn comment(blocks: &[Block], link: &dyn Fn(Link<'_>) -> String) -> String {
    let mut text = String::new();
    for line in documentation::plain(blocks, link) {
        let line = line.replace("*/", "* /");
        text += if text.is_empty() { "/*" } else { " *" };
        text += if line.is_empty() { "" } else { " " };
        text += &line;
        text += "\n";
    }
    text + " */\n"
}

/// A number as C reads it back to the same float.
pub(super) fn constant(value: &Number, scalar: Scalar) -> String {
    let digits = decimal(value, scalar);
    match scalar {
        Scalar::F64 => digits,
        Scalar::F32 => format!("{digits}f"),
    }
}

#[cfg(test)]
mod tests {
    use super::macros_of;

    #[test]
    fn robots_whose_names_differ_in_case_have_other_macros() {
        assert_eq!(macros_of("scara"), "SCARA");
        let names = ["fn_1", "Fn_1", "fN_1", "FN_1"];
        let macros: std::collections::BTreeSet<String> = names.iter().map(|name| macros_of(name)).collect();
        assert_eq!(macros.len(), names.len());
    }
}
