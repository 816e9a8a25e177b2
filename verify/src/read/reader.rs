//! Reads an emitted module: constants as values, functions as straight-line programs.
//!
//! The reader accepts only a fixed grammar, with its own lexer and parser; it cannot skip unknown text. Except for the bodies of functions, it
//! compares all tokens with the texts of an emitted module (`items`, `sines`, signatures from [`contract`](crate::values::contract)). The grammar of
//! bodies is in `body`, of constants in `constant`, of documentation in `documentation`, and of characters in `lexer`.
//! `docs/certificate.md` has the complete grammar.

mod body;
mod c;
mod constant;
mod documentation;
mod items;
mod javascript;
mod lexer;
pub mod matlab;
pub(crate) mod parameters;
mod parser;
mod plain;
mod python;
mod sines;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::AtomicUsize;

use armgen_description::language::Language;

use crate::values::check::{parallel_map, Check};
use crate::values::contract::Sizes;
use crate::values::enclosure::Float;
use crate::values::program::{Program, JOINTS, NOMINAL_GRAVITY, TIPS};
use body::Shared;
pub(crate) use c::in_the_name_of;
pub use constant::Constant;
use items::Items;
pub use lexer::Fault;
pub(crate) use lexer::{is_hidden, name_of};
pub(crate) use plain::camel;

/// The maximum length of a module, in bytes; that of a chain of 32 joints takes a third.
pub const LONGEST: usize = 32 << 20;

/// The beginning of the line of the head that names options.
const OPTIONS: &str = "Options:";

/// Prefixes of the lines that state a fact about a function.
pub(crate) const FACTS: [&str; 2] = ["Cost: ", "Rounding error: "];

/// Whether a line of a comment states a fact about a function.
pub(crate) fn is_fact(line: &str) -> bool {
    let words = line.trim_start_matches([' ', '/', '*', '%', '#']);
    FACTS.iter().any(|fact| words.starts_with(fact))
}

/// The text of a module with its language; plain text is Rust.
#[derive(Clone, Copy, Debug)]
pub struct ModuleText<'a> {
    /// The language.
    pub language: Language,
    /// The text.
    pub text: &'a str,
}

impl<'a> From<&'a str> for ModuleText<'a> {
    fn from(text: &'a str) -> ModuleText<'a> {
        ModuleText { language: Language::Rust, text }
    }
}

impl<'a> From<&'a String> for ModuleText<'a> {
    fn from(text: &'a String) -> ModuleText<'a> {
        text.as_str().into()
    }
}

/// The content of a module.
#[derive(Clone, Debug)]
pub struct Module {
    /// The language.
    pub language: Language,
    /// The scalar behind `Real`.
    pub real: Float,
    /// The source of sines and cosines, if any are used: `libm`, `std` or `fast`.
    pub trig: Option<&'static str>,
    /// Comments before all items, without the slashes.
    pub head: Vec<String>,
    /// Number of lines that state the cost or the rounding error of a function.
    pub facts: usize,
    /// Constants by name.
    pub constants: BTreeMap<String, Constant>,
    /// Public functions in the order of the text, each with its content or fault.
    pub functions: Vec<(String, Result<Function, String>)>,
}

/// A public function.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Its documentation, line by line, without the slashes.
    pub documentation: Vec<String>,
    /// Its computation.
    pub program: Program,
}

/// The options of `armgen generate` that the head of a text names, even of a text that is no module; empty where it names none.
pub fn options_of(text: &str) -> String {
    stated(text.lines().take(items::MOST_HEAD).map(|line| line.trim_start_matches([' ', '/', '*', '%', '#']).trim_end()))
}

/// The options among lines of a head, which are broken at blanks and behind commas.
fn stated<'a>(lines: impl Iterator<Item = &'a str>) -> String {
    let stated = lines.skip_while(|line| !line.starts_with(OPTIONS)).take_while(|line| !line.is_empty());
    let joined = stated.fold(String::new(), |all, line| match all.is_empty() || all.ends_with(',') {
        true => all + line,
        false => all + " " + line,
    });
    joined.strip_prefix(OPTIONS).unwrap_or_default().trim_start().to_owned()
}

/// The constants of a named end effector.
const OF_TIP: [&str; 3] = ["TASK_ROWS", "TASK", "COORDINATES"];

/// The names of the end effectors in the constants of a module.
fn tips_of(constants: &BTreeMap<String, Constant>) -> Vec<String> {
    let Some(Constant::Array(names)) = constants.get(TIPS) else { return Vec::new() };
    let name = |name: &Constant| match name {
        Constant::Text(name) => Some(name.clone()),
        _ => None,
    };
    names.iter().filter_map(name).collect()
}

/// The name of a constant of an end effector.
fn constant_of(tip: &str, name: &str) -> String {
    format!("{}_{name}", tip.to_ascii_uppercase())
}

impl Module {
    /// Reads the text of a module. In Rust, a fault in a function's body becomes part of the result.
    pub fn read<'a>(text: impl Into<ModuleText<'a>>) -> Result<Module, Fault> {
        let ModuleText { language, text } = text.into();
        let module = match language {
            Language::Rust => Module::read_rust(text),
            Language::C | Language::Cuda => c::read(text, language),
            Language::JavaScript => javascript::read(text),
            Language::Python => python::read(text),
            Language::Matlab => matlab::read(text),
        }?;
        Ok(Module { facts: text.lines().filter(|line| is_fact(line)).count(), ..module })
    }

    /// The options of `armgen generate` that the head names; empty where it names none.
    pub fn options(&self) -> String {
        stated(self.head.iter().map(|line| line.trim()))
    }

    /// The names that an option of the head lists, if it has the option.
    pub fn listed(&self, option: &str) -> Option<Vec<String>> {
        let options = self.options();
        let names = options.split("--").find_map(|words| words.strip_prefix(option)?.strip_prefix(' '))?;
        Some(names.trim_end().split(',').map(String::from).collect())
    }

    /// The functions that were asked for, if the head names some.
    pub fn chosen(&self) -> Option<BTreeSet<String>> {
        Some(self.listed("functions")?.into_iter().collect())
    }

    /// An empty module with 64-bit floats.
    fn empty(language: Language) -> Module {
        Module {
            language,
            real: Float::F64,
            trig: None,
            head: Vec::new(),
            facts: 0,
            constants: BTreeMap::new(),
            functions: Vec::new(),
        }
    }

    fn read_rust(text: &str) -> Result<Module, Fault> {
        if text.len() > LONGEST && Check::Length.is_made() {
            return Err(Fault { line: 1, reason: format!("the text is longer than {} MiB", LONGEST >> 20) });
        }
        let items = Items::read(text)?;
        let missing = |what: &str| Fault { line: 1, reason: format!("the module has no {what}") };
        let real = items.real.ok_or_else(|| missing("type `Real`"))?;
        let mut constants = BTreeMap::new();
        for (name, (ty, place)) in &items.constants {
            let mut parser = *place;
            constants.insert((*name).to_string(), Constant::read(&mut parser, ty, real)?);
            parser.expect(";")?;
        }
        if !constants.contains_key("DOF") {
            return Err(missing("number of joints `DOF`"));
        }
        items.check_companions(&constants)?;
        let trig = sines::check(&items.private, real)?;
        let shared = Shared {
            real,
            parts: &items.parts,
            written: &items.written,
            fast: trig == Some("fast"),
            is_coupled: items.is_coupled,
            steps: AtomicUsize::new(0),
        };
        let compiled = parallel_map(&items.public, |function| body::compile(function, &shared));
        // The order of the threads decides which function exceeds the limit, so the fault names no function.
        if shared.is_too_long() {
            return Err(Fault { line: 1, reason: Shared::too_long() });
        }
        let (mut calls, mut parts_called) = (BTreeSet::new(), BTreeSet::new());
        let mut functions: Vec<(String, Result<Function, String>)> = Vec::with_capacity(compiled.len());
        for (function, compiled) in items.public.iter().zip(compiled) {
            let read = compiled.map(|compiled| {
                calls.extend(compiled.calls);
                parts_called.extend(compiled.parts_called);
                let documentation = function.documentation.iter().map(ToString::to_string).collect();
                Function { documentation, program: compiled.program }
            });
            functions.push((function.name.to_string(), read.map_err(String::from)));
        }
        // The calls of faulty functions are unknown.
        if functions.iter().all(|(_, function)| function.is_ok()) {
            sines::check_calls(&items.private, &calls, real)?;
            let unneeded = items.parts.iter().find(|(name, _)| !parts_called.contains(*name));
            if let Some((name, part)) = unneeded.filter(|_| Check::PartsNeeded.is_made()) {
                return Err(part.place.peek().fault(format!("`{name}` is needed by no function of the module")));
            }
        }
        let head = items.head.iter().map(ToString::to_string).collect();
        Ok(Module { real, trig, head, constants, functions, ..Module::empty(Language::Rust) })
    }

    /// The sizes in its constants.
    pub fn sizes(&self) -> Sizes {
        let of = |name: &str| match self.constants.get(name) {
            Some(Constant::Integer(value)) => *value as usize,
            _ => 0,
        };
        let gravity = self.constants.contains_key(NOMINAL_GRAVITY);
        let tips = tips_of(&self.constants);
        let tips = tips.into_iter().map(|tip| (tip.clone(), of(&constant_of(&tip, "TASK_ROWS")))).collect();
        let joints = self.constants.contains_key(JOINTS).then(|| of(JOINTS));
        Sizes { n: of("DOF"), joints, p: of("PARAMETERS"), b: of("BASE_PARAMETERS"), m: of("TASK_ROWS"), gravity, tips }
    }

    /// The programs of all readable functions, by name.
    pub fn programs(&self) -> impl Iterator<Item = (&str, &Program)> {
        self.functions.iter().filter_map(|(name, function)| Some((name.as_str(), &function.as_ref().ok()?.program)))
    }

    /// The program of a function, if it is readable.
    pub fn program(&self, name: &str) -> Option<&Program> {
        self.functions.iter().find(|(n, _)| n == name)?.1.as_ref().ok().map(|f| &f.program)
    }
}
