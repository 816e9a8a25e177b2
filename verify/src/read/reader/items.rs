//! The items of a module. Private items are compared with texts in `sines`; all other items must have the forms in this file, token by token.
//! The bodies of public functions are read by [`body`](super::body).

use std::collections::BTreeMap;

use super::constant::{integer, Constant};
use super::lexer::{Fault, Kind, Lexer, Token};
use super::parameters::{has_payload, RUST_INDEX, RUST_PAYLOAD};
use super::parser::Parser;
use super::sines::{self, Private};
use crate::textbook::reference::BASE_REGRESSOR;
use crate::values::check::Check;
use crate::values::contract::{of_module, Promise};
use crate::values::enclosure::Float;
use crate::values::program::{Argument, JOINTS, MOTORS, NOMINAL_GRAVITY, TIPS};

const LINTS: &str = "#[allow(dead_code)]";
/// For items with numbers of a robot, among which clippy recognises pi and e.
const ALL_LINTS: &str = "#[allow(dead_code, clippy::all)]";

/// Name suffix of a function that writes its result into memory of the caller.
pub(super) const INTO: &str = "_into";

/// The permitted constants, with their types.
const CONSTANTS: [(&str, &str); 24] = [
    ("NAME", "&str"),
    ("DOF", "usize"),
    ("JOINT_NAMES", "[&str; DOF]"),
    ("JOINT_IS_REVOLUTE", "[bool; DOF]"),
    ("POSITION_LIMITS", "[[Real; 2]; DOF]"),
    ("VELOCITY_LIMITS", "[Real; DOF]"),
    ("EFFORT_LIMITS", "[Real; DOF]"),
    ("ACCELERATION_LIMITS", "[Real; DOF]"),
    ("JERK_LIMITS", "[Real; DOF]"),
    ("TASK_ROWS", "usize"),
    ("TASK", "[usize; TASK_ROWS]"),
    ("PARAMETERS", "usize"),
    ("PARAMETER_NAMES", "[&str; PARAMETERS]"),
    ("NOMINAL_PARAMETERS", "[Real; PARAMETERS]"),
    (NOMINAL_GRAVITY, "[Real; 3]"),
    (JOINTS, "usize"),
    ("ALL_JOINT_NAMES", "[&str; JOINTS]"),
    ("COUPLING", "[[Real; DOF]; JOINTS]"),
    ("COUPLING_OFFSET", "[Real; JOINTS]"),
    (MOTORS, "usize"),
    ("MOTOR_RATES", "[[Real; DOF]; MOTORS]"),
    ("BASE_PARAMETERS", "usize"),
    ("BASE_PARAMETER_NAMES", "[&str; BASE_PARAMETERS]"),
    ("NOMINAL_BASE_PARAMETERS", "[Real; BASE_PARAMETERS]"),
];

/// The struct and its fields, after their documentation.
const STRUCT: &str = "#[allow(dead_code)]\n#[derive(Clone, Copy, Debug, PartialEq)]\npub struct EquationsOfMotion {";
const FIELDS: [&str; 3] = ["pub inertia: [[Real; DOF]; DOF],", "pub coriolis: [[Real; DOF]; DOF],", "pub gravity: [Real; DOF],"];

/// The functions over parameters that are the same in all modules.
const INDEX: &str = "parameter_index";
const PAYLOAD: &str = "payload_parameters";

/// A public function.
#[derive(Clone, Debug)]
pub(super) struct Public<'a> {
    pub(super) name: &'a str,
    pub(super) arguments: Vec<Argument>,
    /// Its documentation, line by line.
    pub(super) documentation: Vec<&'a str>,
    /// The parser at the opening brace.
    pub(super) body: Parser<'a>,
}

/// A part of a long public function: `NAME_part_K`.
#[derive(Clone, Debug)]
pub(super) struct Part<'a> {
    pub(super) arguments: Vec<Argument>,
    /// Numbers of values that it takes and returns.
    pub(super) counts: [usize; 2],
    /// The parser at the opening brace.
    pub(super) body: Parser<'a>,
    /// The parser at its name.
    pub(super) place: Parser<'a>,
}

/// The items of the text, in its order where the order matters.
#[derive(Clone, Debug, Default)]
pub(super) struct Items<'a> {
    /// The comments before all items.
    pub(super) head: Vec<&'a str>,
    pub(super) real: Option<Float>,
    /// Whether the acceleration of free fall is an argument.
    gravity: bool,
    /// Whether joints are coupled.
    pub(super) is_coupled: bool,
    /// Type and position of each constant's value.
    pub(super) constants: BTreeMap<&'a str, (String, Parser<'a>)>,
    /// The position of the struct's documentation.
    pub(super) structure: Option<Parser<'a>>,
    pub(super) public: Vec<Public<'a>>,
    /// The functions over parameters that are the same in all modules, by name.
    of_parameters: BTreeMap<&'static str, usize>,
    /// The bodies of the functions that write into memory of the caller, by the names of the functions that return the same result.
    pub(super) written: BTreeMap<&'a str, Parser<'a>>,
    pub(super) parts: BTreeMap<&'a str, Part<'a>>,
    pub(super) private: Private<'a>,
}

/// Maximum number of comment lines before all items.
pub(super) const MOST_HEAD: usize = 64;

/// Takes the argument and result types of a public function, which must follow its name; a comma may follow the last argument.
fn signature(parser: &mut Parser<'_>, signature: &str) -> Result<(), Fault> {
    let mut wanted = Lexer::new(signature);
    loop {
        let want = wanted.next()?;
        if want.kind == Kind::End {
            return Ok(());
        }
        if want.is(")") {
            parser.eat(",")?;
        }
        let found = parser.peek();
        if (found.text != want.text || found.kind != want.kind) && Check::Signatures.is_made() {
            let shown = found.shown();
            return Err(found.fault(format!("{shown} where the signature `{signature}` has `{}`", want.text)));
        }
        parser.take()?;
    }
}

impl<'a> Items<'a> {
    /// Reads all items.
    pub(super) fn read(text: &'a str) -> Result<Items<'a>, Fault> {
        let mut parser = Parser::new(text)?;
        // Functions may stand before the constants.
        let gravity = text.contains(&format!("pub const {NOMINAL_GRAVITY}: "));
        let is_coupled = text.contains(&format!("pub const {JOINTS}: "));
        let mut items = Items { gravity, is_coupled, ..Items::default() };
        while parser.peek().kind == Kind::Comment {
            let line = parser.take()?;
            if items.head.len() == MOST_HEAD {
                return Err(line.fault(format!("more than {MOST_HEAD} lines of comments in front of all items")));
            }
            items.head.push(line.text);
        }
        while parser.peek().kind != Kind::End {
            items.item(&mut parser)?;
        }
        if gravity != items.constants.contains_key(NOMINAL_GRAVITY) {
            return Err(parser.peek().fault(format!("`{NOMINAL_GRAVITY}` stands where it is no constant")));
        }
        if is_coupled != items.constants.contains_key(JOINTS) {
            return Err(parser.peek().fault(format!("`{JOINTS}` stands where it is no constant")));
        }
        Ok(items)
    }

    /// The struct and the constants of base parameters occur exactly with the functions that need them, and functions over parameters
    /// exactly with these.
    pub(super) fn check_companions(&self, constants: &BTreeMap<String, Constant>) -> Result<(), Fault> {
        if !Check::Companions.is_made() {
            return Ok(());
        }
        let parameters = constants.get("PARAMETERS").is_some_and(|count| *count != Constant::Integer(0));
        for (name, wanted) in [(INDEX, parameters), (PAYLOAD, has_payload(constants))] {
            match self.of_parameters.get(name) {
                Some(&line) if !wanted => {
                    return Err(Fault { line, reason: format!("`{name}` of parameters that the module does not have") });
                }
                None if wanted => return Err(Fault { line: 1, reason: format!("the module does not have `{name}`") }),
                _ => {}
            }
        }
        let has = |name: &str| self.public.iter().any(|function| function.name == name);
        if self.structure.is_some() != (has("equations_of_motion") || has("equations_of_motion_with")) {
            let place = self.structure.map_or(1, |place| place.peek().line);
            return Err(Fault {
                line: place,
                reason: "the struct `EquationsOfMotion` and functions that return it come together".into(),
            });
        }
        if let Some((name, body)) = self.written.iter().find(|(name, _)| !has(name)) {
            let reason = format!("`{name}{INTO}` without the function `{name}`");
            return Err(Fault { line: body.peek().line, reason });
        }
        let of_base = |name: &&&str| name.contains("BASE_");
        match (has(BASE_REGRESSOR), self.constants.keys().find(of_base)) {
            (false, Some(name)) => {
                let line = self.constants[name].1.peek().line;
                Err(Fault { line, reason: format!("`{name}` without the function `base_regressor`") })
            }
            _ => Ok(()),
        }
    }

    fn item(&mut self, parser: &mut Parser<'a>) -> Result<(), Fault> {
        let documentation = parser.documentation()?;
        let beginning = *parser;
        while parser.eat("#")? {
            // Any attribute here; the item decides which attributes must precede it.
            if parser.is("[") {
                parser.skip("[", "]")?;
            }
        }
        let first = parser.peek();
        let public = parser.eat("pub")?;
        let keyword = parser.take()?;
        let named = *parser;
        let name = parser.peek();
        let writes = keyword.is("fn") && name.text.ends_with(INTO);
        let is_private = !public && matches!(keyword.text, "fn" | "const") && !name.text.contains("_part_") && !writes;
        if !is_private {
            *parser = beginning;
        }
        let head = Head { beginning, keyword, name, documentation };
        match (public, keyword.text) {
            (true, "type") => self.scalar(parser),
            (true, "const") if name.is("fn") => self.of_parameters(parser, &head, INDEX, RUST_INDEX),
            (true, "const") => self.constant(parser, head),
            (true, "struct") => self.structure(parser, &head),
            (_, "fn") if writes => self.written(parser, &head),
            (true, "fn") if name.is(PAYLOAD) => self.of_parameters(parser, &head, PAYLOAD, RUST_PAYLOAD),
            (true, "fn") => self.function(parser, head),
            (false, "fn") if !is_private => {
                parser.expect(&format!("{ALL_LINTS} #[inline(never)] fn"))?;
                let part = part(parser, named)?;
                if self.parts.insert(name.text, part).is_some() && Check::Once.is_made() {
                    return Err(name.fault(format!("function `{}` stands twice", name.text)));
                }
                Ok(())
            }
            (false, "fn" | "const") if is_private && name.kind == Kind::Word => self.private_item(parser, &head),
            _ => {
                let wrong = if public { keyword } else { first };
                Err(wrong.fault(format!("{} begins no item of an emitted module for one state", wrong.shown())))
            }
        }
    }

    /// `pub type Real = f64;`
    fn scalar(&mut self, parser: &mut Parser<'a>) -> Result<(), Fault> {
        parser.expect(&format!("{LINTS} pub type Real ="))?;
        let real = [Float::F64, Float::F32].into_iter().zip(["f64", "f32"]).find(|(_, word)| parser.is(word));
        let word = parser.take()?;
        let (real, _) = real.ok_or_else(|| word.fault(format!("`Real` is {}, neither f64 nor f32", word.shown())))?;
        if self.real.replace(real).is_some() && Check::Once.is_made() {
            return Err(word.fault("`Real` stands twice"));
        }
        parser.expect(";")
    }

    /// A public constant; its value is read once `Real` is known.
    fn constant(&mut self, parser: &mut Parser<'a>, head: Head<'a>) -> Result<(), Fault> {
        let name = head.name;
        let known = name.text;
        let ty = match type_of(known) {
            Some(ty) => ty,
            // As many as there are end effectors, or joints that move one.
            None if known == TIPS || is_of_tip(known, "COORDINATES") => {
                let entry = if known == TIPS { "&str" } else { "usize" };
                let mut ahead = *parser;
                ahead.expect(&format!("{LINTS} pub const {known}: [{entry};"))?;
                format!("[{entry}; {}]", integer(&ahead.peek())?)
            }
            None => return Err(name.fault(format!("{} is not a constant that an emitted module has", name.shown()))),
        };
        let lints = if ty.contains("Real") { ALL_LINTS } else { LINTS };
        parser.expect(&format!("{lints} pub const {known}: {ty} ="))?;
        if self.constants.insert(name.text, (ty, *parser)).is_some() && Check::Once.is_made() {
            return Err(name.fault(format!("constant `{known}` stands twice")));
        }
        while !parser.is(";") && parser.peek().kind != Kind::End {
            parser.take()?;
        }
        parser.expect(";")
    }

    /// The result type of `equations_of_motion`.
    fn structure(&mut self, parser: &mut Parser<'a>, head: &Head<'a>) -> Result<(), Fault> {
        parser.expect(STRUCT)?;
        for field in FIELDS {
            parser.documentation()?;
            parser.expect(field)?;
        }
        parser.expect("}")?;
        match self.structure.replace(head.beginning) {
            Some(_) if Check::Once.is_made() => Err(head.name.fault("the struct stands twice")),
            _ => Ok(()),
        }
    }

    /// A function over parameters, which has the same text in all modules.
    fn of_parameters(&mut self, parser: &mut Parser<'a>, head: &Head<'a>, name: &'static str, text: &str) -> Result<(), Fault> {
        parser.expect(text)?;
        match self.of_parameters.insert(name, head.name.line) {
            Some(_) if Check::Once.is_made() => Err(head.name.fault(format!("function `{name}` stands twice"))),
            _ => Ok(()),
        }
    }

    /// A public function with its signature; the body is read once all items are known.
    fn function(&mut self, parser: &mut Parser<'a>, head: Head<'a>) -> Result<(), Fault> {
        let name = head.name;
        let (promise, with) = Promise::of(name.text)
            .ok_or_else(|| name.fault(format!("{} is not a function that an emitted module has", name.shown())))?;
        parser.expect(&format!("{ALL_LINTS} pub fn {}", name.text))?;
        if self.public.iter().any(|other| other.name == name.text) && Check::Once.is_made() {
            return Err(name.fault(format!("function `{}` stands twice", name.text)));
        }
        let arguments = promise.arguments_of(with, self.gravity);
        let returned = of_module(name.text, self.is_coupled, &promise.returned.rust());
        signature(parser, &format!("({})->{returned}", Promise::typed(&arguments).join(",")))?;
        let body = *parser;
        self.public.push(Public { name: name.text, arguments, documentation: head.documentation, body });
        parser.expect("{")?;
        *parser = body;
        parser.skip("{", "}")
    }

    /// A function that writes the result of another into memory of the caller; its body is read with that function.
    fn written(&mut self, parser: &mut Parser<'a>, head: &Head<'a>) -> Result<(), Fault> {
        let name = head.name;
        let whole = name.text.strip_suffix(INTO).and_then(|whole| Some((whole, Promise::of(whole)?)));
        let found = whole.and_then(|(whole, (promise, with))| Some((whole, promise, with, promise.written()?)));
        let (whole, promise, with, results) =
            found.ok_or_else(|| name.fault(format!("{} is not a function that an emitted module has", name.shown())))?;
        let public = if promise.has_form_into() { "pub " } else { "" };
        parser.expect(&format!("{ALL_LINTS} {public}fn {}", name.text))?;
        let results = results.into_iter().map(|(name, of)| format!("{name}:&mut{}", of_module(whole, self.is_coupled, &of)));
        let all: Vec<String> = Promise::typed(&promise.arguments_of(with, self.gravity)).into_iter().chain(results).collect();
        signature(parser, &format!("({})", all.join(",")))?;
        let body = *parser;
        parser.expect("{")?;
        *parser = body;
        if self.written.insert(whole, body).is_some() && Check::Once.is_made() {
            return Err(name.fault(format!("function `{}` stands twice", name.text)));
        }
        parser.skip("{", "}")
    }

    /// A private function or constant; its tokens are compared as a whole once `Real` is known.
    fn private_item(&mut self, parser: &mut Parser<'a>, head: &Head<'a>) -> Result<(), Fault> {
        let name = head.name;
        if !sines::NAMES.contains(&name.text) && Check::PrivateNames.is_made() {
            return Err(name.fault(format!("{} is not a private item of an emitted module", name.shown())));
        }
        if self.private.insert(name.text, head.beginning).is_some() && Check::Once.is_made() {
            return Err(name.fault(format!("`{}` stands twice", name.text)));
        }
        let last = if head.keyword.is("fn") { "{" } else { ";" };
        while !parser.is(last) && parser.peek().kind != Kind::End {
            // The type of an array contains a `;`.
            if parser.is("[") {
                parser.skip("[", "]")?;
            } else {
                parser.take()?;
            }
        }
        if head.keyword.is("fn") {
            parser.skip("{", "}")
        } else {
            parser.expect(";")
        }
    }
}

/// The type of a constant whose name tells it.
fn type_of(name: &str) -> Option<String> {
    let known = CONSTANTS.into_iter().find(|(known, _)| *known == name).map(|(_, ty)| ty.to_owned());
    known
        .or_else(|| is_of_tip(name, "TASK_ROWS").then(|| "usize".into()))
        .or_else(|| is_of_tip(name, "TASK").then(|| format!("[usize; {name}_ROWS]")))
}

/// Whether a name is that of a constant of an end effector.
fn is_of_tip(name: &str, constant: &str) -> bool {
    name.strip_suffix(constant).is_some_and(|tip| tip.len() > 1 && tip.ends_with('_'))
}

/// The first tokens of an item.
struct Head<'a> {
    /// Its first token, after the documentation.
    beginning: Parser<'a>,
    keyword: Token<'a>,
    name: Token<'a>,
    /// Lines of its documentation.
    documentation: Vec<&'a str>,
}

/// After `fn`: `gravity_part_1(q: &[Real; DOF], values: [Real; 3]) -> [Real; 5] { ... }`.
fn part<'a>(parser: &mut Parser<'a>, place: Parser<'a>) -> Result<Part<'a>, Fault> {
    parser.take()?;
    let mut arguments = Vec::new();
    parser.expect("(")?;
    while !parser.is("values") {
        let token = parser.take()?;
        let argument = Argument::named(token.text).filter(|argument| !arguments.contains(argument));
        let argument = argument.ok_or_else(|| token.fault(format!("{} is not an argument that a part has", token.shown())))?;
        arguments.push(argument);
        parser.expect(&format!(": &[Real; {}],", argument.length().rust()))?;
    }
    parser.expect("values: [Real;")?;
    let taken = integer(&parser.take()?)?;
    parser.expect("]")?;
    parser.eat(",")?;
    parser.expect(") -> [Real;")?;
    let given = integer(&parser.take()?)?;
    parser.expect("]")?;
    let body = *parser;
    parser.expect("{")?;
    *parser = body;
    parser.skip("{", "}")?;
    Ok(Part { arguments, counts: [taken, given], body, place })
}
