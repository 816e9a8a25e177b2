//! Reads a C module: the header with the functions.
//!
//! ```text
//! header   = guard [ fused ] [ library ] prologue constants [ sines ] [ sign ] [ stribeck ] { { part } function } [ kernels ] epilogue
//! function = static inline TYPE ROBOT_NAME( ARGUMENTS ) { ROBOT_UNFUSED { (void)ARGUMENT; } [ angles ] { line } { call { line } } result }
//! angles   = const ROBOT_real angle[N] = {ANGLES};  ROBOT_real sine[N], cosine[N];  ROBOT_sin_cos(USED, angle, sine, cosine);
//!            { const ROBOT_real NAME = sine[I]; | const ROBOT_real NAME = cosine[I]; }
//! line     = const ROBOT_real NAME = SUM;
//! result   = return SUM; | { PART[I][J] = SUM; }                   no argument is read once an entry is written: it may be the same array
//! ```

mod kernels;

use std::collections::BTreeMap;

use armgen_description::language::Language;

use super::parameters::{has_payload, names, C_PAYLOAD};
use super::plain::{in_order, promised, sizes, Body, Comments, Constants, Functions, Lines, Syntax};
use super::{Constant, Fault, Function, Module};
use crate::values::check::Check;
use crate::values::contract::{of_module, Array, Length, Returned, Sizes};
use crate::values::enclosure::Float;
use crate::values::program::{Argument, Step, JOINTS, MOTORS, NOMINAL_GRAVITY, TIPS};

pub(super) const COMMENTS: Comments = Comments { line: None, block: Some(("/*", "*/")), behind: "" };

const PROLOGUE: &str = include_str!("c/prologue.h");
const EPILOGUE: &str = include_str!("c/epilogue.h");
/// The fused operation.
const FUSED: &str = include_str!("c/fused.h");
const SIGN: &str = include_str!("c/sign.h");
const STRIBECK: &str = include_str!("c/stribeck.h");
const STD: &str = include_str!("c/std.h");
const FAST_F64: &str = include_str!("c/fast_f64.h");
const FAST_F32: &str = include_str!("c/fast_f32.h");

/// The sines of the C library; they also serve angles beyond the range of the module's own sines.
const LIBRARY: &str = "#include <math.h>\n#define ROBOT_SIN(x) sin(x)\n#define ROBOT_COS(x) cos(x)\n";
const NONE: &str = "#ifdef ROBOT_NO_MATH_H\n#define ROBOT_SIN(x) (((x) - (x)) / ((x) - (x)))\n\
    #define ROBOT_COS(x) (((x) - (x)) / ((x) - (x)))\n#else\n";

/// The prefixes of names and macros, without the underscore.
struct Robot {
    name: String,
    upper: String,
}

/// The robot's name, with letters outside C identifiers spelled out.
fn spelled(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_ascii_alphanumeric() || c == '_' { c.to_string() } else { format!("u{:04x}", c as u32) })
        .collect()
}

fn turned(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_lowercase() { c.to_ascii_uppercase() } else { c.to_ascii_lowercase() }).collect()
}

/// A text for the robot `robot`, renamed to another robot.
pub(crate) fn in_the_name_of(name: &str, text: &str) -> String {
    let name = spelled(name);
    Robot { upper: turned(&name), name }.own(text)
}

impl Robot {
    /// A common text of all modules, renamed to this robot.
    fn own(&self, text: &str) -> String {
        let macros = format!("{}_", self.upper);
        let pieces: Vec<String> = text.split("robot_").map(|piece| piece.replace("ROBOT_", &macros)).collect();
        pieces.join(&format!("{}_", self.name))
    }

    fn length(&self, length: Length, sizes: &Sizes) -> String {
        match length.in_module(sizes) {
            Length::Dof => format!("[{}_DOF]", self.upper),
            Length::Joints => format!("[{}_JOINTS]", self.upper),
            Length::Parameters => format!("[{}_PARAMETERS]", self.upper),
            Length::BaseParameters => format!("[{}_BASE_PARAMETERS]", self.upper),
            Length::Task => format!("[{}_TASK_ROWS]", self.upper),
            Length::Of(value) => format!("[{value}]"),
        }
    }
}

/// A part of a long function: its arguments and values, and the place of its lines.
struct Part<'a> {
    arguments: Vec<&'a str>,
    taken: usize,
    given: usize,
    body: usize,
    used: bool,
}

/// The lines of a comment in the form of other languages, without leading signs.
fn comment(lines: &[&str]) -> Vec<String> {
    let last = lines.iter().rposition(|line| !line.trim().is_empty()).map_or(0, |last| last + 1);
    lines[..last].iter().map(|line| line.strip_prefix(" *").unwrap_or(line).to_string()).collect()
}

/// Reads a header, in CUDA one with kernels.
pub(super) fn read(text: &str, language: Language) -> Result<Module, Fault> {
    let mut lines = Lines::new(text, COMMENTS)?;
    let name = lines.all.iter().find_map(|line| line.text.strip_prefix("#define ")?.split_once("_NAME \""));
    let (upper, rest) = name.ok_or_else(|| lines.fault("the module has no macro of the robot's name"))?;
    let robot = rest.strip_suffix('"').map(spelled).filter(|name| turned(name) == upper);
    let robot = Robot {
        name: robot.ok_or_else(|| lines.fault(format!("`{upper}_NAME` is not of the robot whose name the macro begins with")))?,
        upper: upper.into(),
    };
    let head = lines.all.first().map_or(Vec::new(), |line| comment(&line.comment));
    let fixed = |lines: &mut Lines<'_>, text: &str| lines.expect_all(&robot.own(text), COMMENTS);
    lines.expect(&format!("#ifndef ARMGEN_{upper}_H"))?;
    lines.expect(&format!("#define ARMGEN_{upper}_H"))?;

    let real_at = lines.all.iter().find_map(|line| line.text.strip_prefix("typedef ")?.split(' ').next());
    let (real, word, suffix) = match real_at {
        Some("double") => (Float::F64, "double", ""),
        Some("float") => (Float::F32, "float", "f"),
        _ => return Err(lines.fault("the module has no type of its numbers")),
    };
    let fused = lines.is(&format!("#ifndef {upper}_NO_MATH_H"));
    if fused {
        fixed(&mut lines, &FUSED.replace("@f@", suffix))?;
    }
    let library = LIBRARY.replace("sin(", &format!("sin{suffix}(")).replace("cos(", &format!("cos{suffix}("));
    let trig = if lines.is(&format!("#ifdef {upper}_NO_MATH_H")) {
        fixed(&mut lines, &format!("{NONE}{library}#endif\n"))?;
        Some("fast")
    } else if lines.is("#include <math.h>") {
        fixed(&mut lines, &library)?;
        Some("std")
    } else {
        None
    };
    fixed(&mut lines, PROLOGUE)?;
    let constants = constants(&mut lines, &robot, (real, word, suffix))?;
    let sizes = sizes(&constants)?;
    match (trig, real) {
        (Some("fast"), Float::F64) => fixed(&mut lines, FAST_F64)?,
        (Some("fast"), Float::F32) => fixed(&mut lines, FAST_F32)?,
        (Some(_), _) => fixed(&mut lines, STD)?,
        (None, _) => {}
    }
    let own_sign = robot.own(SIGN);
    let sign = lines.is(Lines::new(&own_sign, COMMENTS)?.peek());
    if sign {
        fixed(&mut lines, SIGN)?;
    }
    let own_stribeck = robot.own(STRIBECK);
    let stribeck = lines.is(Lines::new(&own_stribeck, COMMENTS)?.peek());
    if stribeck {
        fixed(&mut lines, STRIBECK)?;
    }

    if has_payload(&constants) {
        fixed(&mut lines, C_PAYLOAD)?;
    }

    let syntax = Syntax {
        index: ("[", "]"),
        first: 0,
        operators: [" * ", " / "],
        suffix,
        sign: format!("{}_sign(", robot.name),
        stribeck: format!("{}_stribeck(", robot.name),
        fused: fused.then(|| format!("{upper}_FMA(")),
        define: [format!("    const {}_real ", robot.name), " = ".into(), ";".into()],
        list: ("[", "]"),
        angles: ", ",
    };
    // The kernels begin with the same line.
    let own_epilogue = robot.own(EPILOGUE);
    let end = Lines::new(&own_epilogue, COMMENTS)?;
    let mut reader =
        Reader { robot: &robot, syntax: &syntax, real, sizes: sizes.clone(), parts: BTreeMap::new(), steps: 0, asks: [false; 3] };
    let functions = reader.all(&mut lines, end.peek(), [trig.is_some(), sign, stribeck])?;
    if language == Language::Cuda {
        kernels::read(&mut lines, &robot, &sizes, functions.iter().map(|(name, _)| name.as_str()))?;
    }
    lines.expect_all(&robot.own(EPILOGUE), COMMENTS)?;
    if !lines.ended() {
        return Err(lines.fault(format!("{} behind the end of the module", lines.shown())));
    }
    Ok(Module { real, trig, head, constants, functions, ..Module::empty(language) })
}

/// The macros of constants, and the scalar.
fn constants(
    lines: &mut Lines<'_>,
    robot: &Robot,
    (real, word, suffix): (Float, &str, &'static str),
) -> Result<BTreeMap<String, Constant>, Fault> {
    let form =
        Constants { real, suffix, quotes: '"', list: |_, _| ["{", ", ", "}", "{}"], truth: ["0", "1"], infinity: "INFINITY" };
    let mut constants: BTreeMap<String, Constant> = BTreeMap::new();
    // In this order; those after the common ones exist only for arms that need them.
    let order = ["NAME", "JOINT_IS_REVOLUTE", "", "DOF", "PARAMETERS", "TASK_ROWS", "TASK", TIPS, "JOINT_NAMES"]
        .into_iter()
        .chain(["POSITION_LIMITS", "VELOCITY_LIMITS", "EFFORT_LIMITS", "ACCELERATION_LIMITS", "JERK_LIMITS"])
        .chain([
            JOINTS,
            "ALL_JOINT_NAMES",
            "COUPLING",
            "COUPLING_OFFSET",
            MOTORS,
            "MOTOR_RATES",
            "PARAMETER_NAMES",
            "NOMINAL_PARAMETERS",
            "PARAMETER_INDEX",
        ])
        .chain([NOMINAL_GRAVITY, "BASE_PARAMETERS", "BASE_PARAMETER_NAMES", "NOMINAL_BASE_PARAMETERS"]);
    in_order(order, |name| {
        if name.is_empty() {
            lines.expect(&format!("typedef {word} {}_real;", robot.name))?;
            return Ok(None);
        }
        if name == "PARAMETER_INDEX" {
            let names = names(&constants);
            let places: Vec<String> = names.iter().map(|own| format!("{}_{name}_{own}", robot.upper)).collect();
            if !places.is_empty() {
                lines.expect(&format!("enum {{{}}};", places.join(", ")))?;
            }
            return Ok(None);
        }
        let begin = format!("#define {}_{name} ", robot.upper);
        let none = |of: &str| constants.get(of).is_none_or(|count| *count == Constant::Integer(0));
        let left_out = match name {
            "TASK" => none("TASK_ROWS"),
            "PARAMETER_NAMES" | "NOMINAL_PARAMETERS" => none("PARAMETERS"),
            JOINTS | MOTORS | NOMINAL_GRAVITY | "BASE_PARAMETERS" | "TASK_ROWS" | TIPS => !lines.peek().starts_with(&begin),
            "ALL_JOINT_NAMES" | "COUPLING" | "COUPLING_OFFSET" => none(JOINTS),
            "MOTOR_RATES" => none(MOTORS),
            "BASE_PARAMETER_NAMES" | "NOMINAL_BASE_PARAMETERS" => none("BASE_PARAMETERS"),
            _ => false,
        };
        if left_out {
            // C has no arrays of length 0.
            let count = if name == "TASK" { "TASK_ROWS" } else { "PARAMETERS" };
            if ["TASK", "PARAMETER_NAMES", "NOMINAL_PARAMETERS"].contains(&name) && constants.contains_key(count) {
                constants.insert(name.into(), Constant::Array(Vec::new()));
            }
            return Ok(None);
        }
        let number = lines.number();
        let value = lines.between(&begin, "")?;
        let value = form.read(name, value, number)?;
        constants.insert(name.into(), value.clone());
        Ok(Some(value))
    })?;
    Ok(constants)
}

struct Reader<'a, 'r> {
    robot: &'r Robot,
    syntax: &'r Syntax,
    real: Float,
    sizes: Sizes,
    parts: BTreeMap<&'a str, Part<'a>>,
    steps: usize,
    asks: [bool; 3],
}

impl<'a> Functions<'a> for Reader<'a, '_> {
    fn unused(&self) -> Option<&'a str> {
        self.parts.iter().find_map(|(name, part)| (!part.used).then_some(*name))
    }

    fn asks(&self) -> [bool; 3] {
        self.asks
    }

    fn item(&mut self, lines: &mut Lines<'a>) -> Result<Option<(String, Function)>, Fault> {
        let Robot { name: robot, upper } = self.robot;
        let documentation = lines.all.get(lines.at).map_or(Vec::new(), |line| comment(&line.comment));
        let returns = ["void", &format!("{robot}_real")]
            .into_iter()
            .position(|word| lines.peek().starts_with(&format!("static inline {word} {robot}_")));
        let begin = match returns {
            Some(1) => format!("static inline {robot}_real {robot}_"),
            _ => format!("static inline void {robot}_"),
        };
        let line = lines.number();
        let here = |reason: String| Fault { line, reason };
        let name = lines.between(&begin, "(")?;
        if returns == Some(0) && name.contains("_part_") {
            self.part(lines, name)?;
            return Ok(None);
        }
        self.sizes = self.sizes.of_function(name);
        let known = promised(name, &self.sizes);
        let (promise, arguments) = known.ok_or_else(|| here(format!("`{name}` is not a function that an emitted module has")))?;
        let number = promise.returned == Returned::One(&[]);
        if number != (returns == Some(1)) {
            return Err(here(format!("`{name}` returns something else than it should")));
        }
        let of_argument = |argument: &Argument| {
            format!("    const {robot}_real {}{}", argument.name(), self.robot.length(argument.length(), &self.sizes))
        };
        let results = promise.returned.named();
        let of_result = |(part, array): &(String, Array)| {
            let lengths: String = array.iter().map(|length| self.robot.length(*length, &self.sizes)).collect();
            format!("    {robot}_real {part}{lengths}")
        };
        let mut all: Vec<String> = arguments.iter().map(of_argument).collect();
        if !number {
            all.extend(results.iter().map(of_result));
        }
        for (i, argument) in all.iter().enumerate() {
            lines.expect(&format!("{}{}", of_module(name, true, argument), if i + 1 == all.len() { ")" } else { "," }))?;
        }
        lines.expect("{")?;
        lines.expect(&format!("    {upper}_UNFUSED"))?;
        for argument in &arguments {
            lines.eat(&format!("    (void){};", argument.name()));
        }
        let mut body = Body::new(name, arguments, self.syntax, self.real, self.steps);
        self.sines(lines, &mut body)?;
        body.definitions(lines)?;
        let mut calls = 0;
        while self.call(lines, &mut body, name, calls + 1)? {
            calls += 1;
            body.definitions(lines)?;
        }
        let places = promise.returned.places(&self.sizes);
        if number {
            let line = lines.number();
            let value = lines.between("    return ", ";")?;
            body.output(String::new(), value, line)?;
        } else {
            for place in places {
                let (part, indices) = promise.returned.part_of(&place);
                let line = lines.number();
                let value = lines.between(&format!("    {part}{indices} = "), ";")?;
                // A caller may pass the same array as argument and as result.
                let written = (!body.program.outputs.is_empty()).then_some(body.program.steps.len());
                body.output(place, value, line)?;
                let reads = |step: &Step| matches!(step, Step::Input(..) | Step::Sign(_));
                if written.is_some_and(|from| body.program.steps[from..].iter().any(reads)) && Check::Aliases.is_made() {
                    return Err(Fault { line, reason: "an argument is read after an entry of the result is written".into() });
                }
            }
        }
        lines.expect("}")?;
        self.steps = body.steps();
        (0..3).for_each(|k| self.asks[k] |= body.asks[k]);
        Ok(Some((name.into(), Function { documentation, program: body.program })))
    }
}

impl<'a> Reader<'a, '_> {
    /// The sines and cosines of all angles of a function.
    fn sines(&self, lines: &mut Lines<'a>, body: &mut Body<'a, '_>) -> Result<(), Fault> {
        let robot = &self.robot.name;
        let begin = format!("    const {robot}_real angle[");
        if !lines.peek().starts_with(&begin) {
            return Ok(());
        }
        let line = lines.number();
        let text = lines.between(&begin, "};")?;
        let (filled, angles) =
            text.split_once("] = {").ok_or_else(|| Fault { line, reason: "an array of angles has its values".into() })?;
        let waves = body.angles(angles, line)?;
        let used = waves.len();
        // As many as fill the longest vector.
        let wanted = used.next_multiple_of(if self.real == Float::F64 { 4 } else { 8 });
        if filled != wanted.to_string() {
            return Err(Fault { line, reason: format!("an array of {filled} for {used} angles, not of {wanted}") });
        }
        lines.expect(&format!("    {robot}_real sine[{filled}], cosine[{filled}];"))?;
        lines.expect(&format!("    {robot}_sin_cos({used}, angle, sine, cosine);"))?;
        for (i, (sine, cosine)) in waves.into_iter().enumerate() {
            let first = body.element(lines, &format!("sine[{i}]"), sine)?;
            let second = body.element(lines, &format!("cosine[{i}]"), cosine)?;
            if !first && !second {
                return Err(lines.fault(format!("neither the sine nor the cosine of angle {i} has a name")));
            }
        }
        Ok(())
    }

    /// The head of a part; its lines are read at its call.
    fn part(&mut self, lines: &mut Lines<'a>, name: &'a str) -> Result<(), Fault> {
        let robot = &self.robot.name;
        let mut part = Part { arguments: Vec::new(), taken: 0, given: 0, body: 0, used: false };
        let count = |lines: &Lines<'a>, text: &str| {
            let count = text.parse::<usize>().ok().filter(|count| count.to_string() == text && (1..1 << 20).contains(count));
            count.ok_or_else(|| lines.fault(format!("{} where an array has its length", lines.shown())))
        };
        let pointer = format!("    const {robot}_real *");
        while lines.peek().starts_with(&pointer) {
            part.arguments.push(lines.between(&pointer, ",")?);
        }
        let taken = format!("    const {robot}_real taken[");
        if lines.peek().starts_with(&taken) {
            let text = lines.between(&taken, "],")?;
            part.taken = count(lines, text)?;
        }
        let given = lines.between(&format!("    {robot}_real given["), "])")?;
        part.given = count(lines, given)?;
        lines.expect("{")?;
        part.body = lines.at;
        while !lines.is("}") {
            if lines.ended() {
                return Err(lines.fault("the text is cut off"));
            }
            lines.at += 1;
        }
        lines.expect("}")?;
        match self.parts.insert(name, part) {
            Some(_) => Err(lines.fault(format!("`{name}` stands twice"))),
            None => Ok(()),
        }
    }

    /// The call of a part; its lines are read as if they were here.
    fn call(&mut self, lines: &mut Lines<'a>, body: &mut Body<'a, '_>, function: &str, number: usize) -> Result<bool, Fault> {
        let Robot { name: robot, upper } = self.robot;
        let mut taken = Vec::new();
        let array = format!("    const {robot}_real taken_{number}[");
        if lines.peek().starts_with(&array) {
            let line = lines.number();
            let (count, names) = lines.between(&array, "};")?.split_once("] = {").unwrap_or_default();
            taken = names.split(", ").map(|name| body.value(name, line)).collect::<Result<Vec<usize>, Fault>>()?;
            if count != taken.len().to_string() {
                return Err(Fault { line, reason: format!("an array of {count} for {} values", taken.len()) });
            }
        } else if !lines.peek().starts_with(&format!("    {robot}_real given_{number}[")) {
            return Ok(false);
        }
        let name = format!("{function}_part_{number}");
        let part = self.parts.get_mut(name.as_str()).ok_or_else(|| lines.fault(format!("there is no part `{name}`")))?;
        part.used = true;
        lines.expect(&format!("    {robot}_real given_{number}[{}];", part.given))?;
        let mut arguments: Vec<String> = part.arguments.iter().map(ToString::to_string).collect();
        if let Some(wrong) = part.arguments.iter().find(|a| !body.program.arguments.iter().any(|own| own.name() == **a)) {
            return Err(lines.fault(format!("`{wrong}` is not an argument of the function")));
        }
        if part.taken > 0 {
            arguments.push(format!("taken_{number}"));
        }
        arguments.push(format!("given_{number}"));
        lines.expect(&format!("    {robot}_{name}({});", arguments.join(", ")))?;
        if taken.len() != part.taken {
            return Err(lines.fault(format!("`{name}` takes another number of values")));
        }
        let back = std::mem::replace(&mut lines.at, part.body);
        let scope = body.enter();
        // It only knows those arguments of the function that it takes.
        let all = body.program.arguments.clone();
        body.program.arguments.retain(|own| part.arguments.contains(&own.name()));
        lines.expect(&format!("    {upper}_UNFUSED"))?;
        for (i, value) in taken.into_iter().enumerate() {
            if !body.element(lines, &format!("taken[{i}]"), value)? {
                return Err(lines.fault(format!("value {i} that the part takes has no name")));
            }
        }
        body.definitions(lines)?;
        let mut given = Vec::new();
        for i in 0..part.given {
            let line = lines.number();
            given.push(body.value(lines.between(&format!("    given[{i}] = "), ";")?, line)?);
        }
        lines.expect("}")?;
        body.leave(scope);
        body.program.arguments = all;
        lines.at = back;
        for (i, value) in given.into_iter().enumerate() {
            if !body.element(lines, &format!("given_{number}[{i}]"), value)? {
                return Err(lines.fault(format!("value {i} that the part gives has no name")));
            }
        }
        Ok(true)
    }
}
