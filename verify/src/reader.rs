//! Reads an emitted module back: constants as values, functions as straight-line programs.
//!
//! The reader knows a small part of Rust and names everything else as an error: `let` with a name, `_` or a tuple; names, `x[3]`, decimal
//! literals, `+ - * /`, a minus sign, tuples, arrays, one struct; calls of `sin_cos`, of `sin_cos_four` and
//! `sin_cos_eight` for several angles, of `sign` and of the module's own private functions, which are taken in where they are called. No `cfg`, no macro, no loop, no `use`, no block that could hide a step.

mod constant;
mod expression;
mod nesting;

use std::collections::BTreeMap;

use proc_macro2::TokenStream;
use quote::ToTokens;
use syn::{Attribute, FnArg, Item, ItemFn, ReturnType, Visibility};

use crate::enclosure::Float;
use crate::program::Program;
pub use constant::Constant;

/// What was read.
#[derive(Clone, Debug)]
pub struct Module {
    /// The scalar behind `Real`.
    pub real: Float,
    /// Where sines and cosines come from, if any are asked for: `libm`, `std` or `fast`.
    pub trig: Option<&'static str>,
    /// Constants by name, with their types as text without blanks.
    pub constants: BTreeMap<String, (String, Constant)>,
    /// Public functions in the order of the text, each with the types of its arguments and of its result, or what is wrong with it.
    pub functions: Vec<(String, Result<Function, String>)>,
}

/// A public function.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Arguments and result as text without blanks: `(q:&[Real;DOF])->[Real;DOF]`.
    pub signature: String,
    /// What it does.
    pub program: Program,
}

/// Text of tokens without blanks.
fn text(tokens: &impl ToTokens) -> String {
    let spaced = tokens.to_token_stream().to_string();
    let mut text = String::with_capacity(spaced.len());
    let mut words = spaced.split_whitespace().peekable();
    while let Some(word) = words.next() {
        text += word;
        let joins = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        if joins(word.chars().last()) && words.peek().is_some_and(|next| joins(next.chars().next())) {
            text.push(' ');
        }
    }
    text
}

/// Attributes that change nothing: documentation and lint levels, derives and inlining.
fn harmless(attributes: &[Attribute]) -> Result<(), String> {
    for attribute in attributes {
        let path = text(attribute.path());
        let known = ["doc", "allow", "derive", "inline", "cold", "must_use", "rustfmt::skip"].contains(&path.as_str());
        if !known {
            return Err(format!("attribute `{}` is not one that an emitted module has", text(attribute)));
        }
    }
    Ok(())
}

fn not_rust(error: impl std::fmt::Display) -> String {
    format!("the text is not Rust, perhaps it is cut off: {error}")
}

/// The struct of the emitted module, with its fields as text without blanks.
const EQUATIONS_OF_MOTION: &str = "inertia:[[Real;DOF];DOF],coriolis:[[Real;DOF];DOF],gravity:[Real;DOF]";

/// Accepted texts of the private block, without blanks: name, scalar, function.
const PRIVATE: [(&str, Option<Float>, &str); 5] = [
    ("sin_cos", Some(Float::F64), "fn sin_cos(x:Real)->(Real,Real){libm::sincos(x)}"),
    ("sin_cos", Some(Float::F32), "fn sin_cos(x:Real)->(Real,Real){libm::sincosf(x)}"),
    ("sin_cos", None, "fn sin_cos(x:Real)->(Real,Real){x.sin_cos()}"),
    ("sin_cos", None, "fn sin_cos(x:Real)->(Real,Real){Real::sin_cos(x)}"),
    ("sign", None, "fn sign(x:Real)->Real{if x>0.0{1.0}else if x<0.0{-1.0}else{x}}"),
];

/// The private functions that are accepted by their text alone.
const LEAVES: [&str; 8] = [
    "sin_cos",
    "sin_cos_one",
    "sin_cos_beyond",
    "sin_cos_four",
    "sin_cos_each_of_four",
    "sin_cos_eight",
    "sin_cos_each_of_eight",
    "sign",
];

/// Accepted items of the private block that answers for several angles at once, by the SHA-256 of their texts without blanks: name, scalar, hash.
const TOGETHER: [(&str, Float, &str); 18] = [
    ("SIN_COS_RANGE", Float::F64, "1b1d904a5bf4f2b907d0f5f3c8e747d577099c0d45c88129a46191582bb857bd"),
    ("SIN_COS_VECTORS", Float::F64, "58b089d92156784f5c1e1103d0c52d01932d7910d0e33879af2ee02344e2b83c"),
    ("sin_cos", Float::F64, "c3a464d0942e1e27be5b08a992ed5cdf2bd84effd79bc74aa74e0195df00c63c"),
    ("sin_cos_one", Float::F64, "a84e8321b11c4e25bcab5f40f8549a7c03d4f55bad0a0d0ff9ad5a3de07ebaf0"),
    ("sin_cos_beyond", Float::F64, "ebcd279734b400d8fdee9bc980ca395acd75f28019990fbd55474fe834171b0b"),
    ("sin_cos_four", Float::F64, "6a6737ad28070d7b0bd0fd9e46611132bb11cef21427913107893dc721eebf0d"),
    ("sin_cos_each_of_four", Float::F64, "5a1cc06a9ce6647e77478a07987e9e64c3dd118693245e955757f1a77f1ac64e"),
    ("sin_cos_eight", Float::F64, "8a77237e41135304eb4efbd9e6f1d4b40f003baf2eb82f583d60e2eacf6b02e9"),
    ("sin_cos_each_of_eight", Float::F64, "dd99be907e78348b1ad62a00c5bf22c9140ec5a087656d08c0eb43d465c80985"),
    ("SIN_COS_RANGE", Float::F32, "20698ad98ba01987199d4794215fcb537e1ca0794a3ac967f936e96473726608"),
    ("SIN_COS_VECTORS", Float::F32, "58b089d92156784f5c1e1103d0c52d01932d7910d0e33879af2ee02344e2b83c"),
    ("sin_cos", Float::F32, "dfafcf1df1ddaaa3b3290c9defc89af2d5d43e2ab0f7d4787227254c2750b61f"),
    ("sin_cos_one", Float::F32, "621c647067ad90b8fd7e19bf6286fc98ffb9900cef71e8572ed861bfded458e3"),
    ("sin_cos_beyond", Float::F32, "c68eebfff99b50ce6e91a1946ffc32a85d3e91dbc584ccf8d5d9c13b8fb78515"),
    ("sin_cos_four", Float::F32, "bb0c04029156d2beb99e65878a7070df7bf9aaf74505e8d12012a08bc21cc593"),
    ("sin_cos_each_of_four", Float::F32, "158dd5a49afcbf6db016a6586c5ba26dcacca608997534b7563d60c2b0c4034f"),
    ("sin_cos_eight", Float::F32, "18bef8bb8aab0ac1aee71d98d48b7b90d0d180d6b3ec98dc4b73f6df8eb9bb00"),
    ("sin_cos_each_of_eight", Float::F32, "964d174ba34c33557dc4151ff39eeecd53b8c1d15c8129bd92cf7e7018b4fa82"),
];

/// The constants of that block: the largest angle, and whether the lanes that are left are computed too.
const SETTINGS: [&str; 2] = ["SIN_COS_RANGE", "SIN_COS_VECTORS"];

/// Whether an item of the block for all angles together is the one that is known to be right.
fn known_together(name: &str, real: Float, text: &str) -> Result<(), String> {
    let hash = crate::hash(text);
    match TOGETHER.iter().any(|(n, scalar, known)| *n == name && *scalar == real && *known == hash) {
        true => Ok(()),
        false => Err(format!("private item `{name}` is not one that is known to be right (SHA-256 {hash})")),
    }
}

impl Module {
    /// Reads the text of a module.
    pub fn read(source: &str) -> Result<Module, String> {
        nesting::check(source)?;
        let reading = std::thread::Builder::new().stack_size(nesting::STACK);
        std::thread::scope(|scope| {
            let reading =
                reading.spawn_scoped(scope, || Module::read_nested(source)).map_err(|e| format!("no thread to read in: {e}"))?;
            reading.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    }

    /// The same, on a stack that is large enough.
    fn read_nested(source: &str) -> Result<Module, String> {
        let file = syn::parse_file(source).map_err(not_rust)?;
        if let Some(attribute) = file.attrs.first() {
            return Err(format!("inner attribute `{}`", text(attribute)));
        }
        let mut real = None;
        let mut constants = Vec::new();
        let mut public = Vec::new();
        let mut private: BTreeMap<String, &ItemFn> = BTreeMap::new();
        for item in &file.items {
            match item {
                Item::Type(alias) if alias.ident == "Real" && real.is_none() => {
                    harmless(&alias.attrs)?;
                    real = Some(match text(&alias.ty).as_str() {
                        "f64" => Float::F64,
                        "f32" => Float::F32,
                        other => return Err(format!("`Real` is `{other}`, neither f64 nor f32")),
                    });
                }
                Item::Const(constant) => {
                    harmless(&constant.attrs)?;
                    constants.push(constant);
                }
                Item::Struct(structure) => {
                    harmless(&structure.attrs)?;
                    check_struct(structure)?;
                }
                Item::Fn(function) => {
                    harmless(&function.attrs)?;
                    let name = function.sig.ident.to_string();
                    let seen = public.iter().any(|f: &&ItemFn| f.sig.ident == function.sig.ident);
                    if seen || private.contains_key(&name) {
                        return Err(format!("function `{name}` stands twice"));
                    }
                    match function.vis {
                        Visibility::Public(_) => public.push(function),
                        _ => {
                            private.insert(name, function);
                        }
                    }
                }
                other => {
                    let mut tokens = other.to_token_stream().into_iter().peekable();
                    // Past the attributes, documentation among them.
                    while tokens.next_if(|token| token.to_string() == "#").is_some() {
                        tokens.next();
                    }
                    let start: String = text(&tokens.collect::<TokenStream>()).chars().take(60).collect();
                    return Err(format!("`{start}` is not an item of an emitted module for one state"));
                }
            }
        }
        let real = real.ok_or("the module has no type `Real`")?;
        let mut values = BTreeMap::new();
        for constant in constants {
            let name = constant.ident.to_string();
            if SETTINGS.contains(&name.as_str()) && matches!(constant.vis, Visibility::Inherited) {
                let mut bare = constant.clone();
                bare.attrs.clear();
                known_together(&name, real, &text(&bare))?;
                continue;
            }
            let value = Constant::read(&constant.expr, real).map_err(|e| format!("constant `{name}`: {e}"))?;
            if values.insert(name.clone(), (text(&constant.ty), value)).is_some() {
                return Err(format!("constant `{name}` stands twice"));
            }
        }
        let trig = check_leaves(&private, real)?;
        if !matches!(values.get("DOF"), Some((_, Constant::Integer(_)))) {
            return Err("the module has no number of joints `DOF`".into());
        }
        let mut work = 0;
        let functions = public.iter().map(|f| (f.sig.ident.to_string(), read_function(f, &private, real, &mut work))).collect();
        Ok(Module { real, trig, constants: values, functions })
    }

    /// The programs of all functions that could be read, by name.
    pub fn programs(&self) -> impl Iterator<Item = (&str, &Program)> {
        self.functions.iter().filter_map(|(name, function)| Some((name.as_str(), &function.as_ref().ok()?.program)))
    }

    /// A function's program, if it could be read.
    pub fn program(&self, name: &str) -> Option<&Program> {
        self.functions.iter().find(|(n, _)| n == name)?.1.as_ref().ok().map(|f| &f.program)
    }
}

fn check_struct(structure: &syn::ItemStruct) -> Result<(), String> {
    let name = structure.ident.to_string();
    let mut fields = Vec::new();
    for field in &structure.fields {
        harmless(&field.attrs)?;
        let ident = field.ident.as_ref().map(ToString::to_string).unwrap_or_default();
        fields.push(format!("{ident}:{}", text(&field.ty)));
    }
    if name != "EquationsOfMotion" || fields.join(",") != EQUATIONS_OF_MOTION {
        return Err(format!("struct `{name}` is not the one of an emitted module"));
    }
    Ok(())
}

/// Sine, cosine and sign are what the equations take as inputs: their functions are accepted by their text alone.
/// Gives the name of the one that answers.
fn check_leaves(private: &BTreeMap<String, &ItemFn>, real: Float) -> Result<Option<&'static str>, String> {
    let mut trig = None;
    let together = private.contains_key("sin_cos_one");
    for name in LEAVES {
        let Some(function) = private.get(name) else { continue };
        let mut bare = (*function).clone();
        bare.attrs.clear();
        let body = text(&bare);
        if together && name != "sign" {
            known_together(name, real, &body)?;
            trig = Some("fast");
            continue;
        }
        let known = PRIVATE.iter().any(|(n, scalar, text)| *n == name && scalar.is_none_or(|s| s == real) && *text == body);
        if !known {
            return Err(format!("private function `{name}` is not one that is known to be right: `{body}`"));
        }
        if name == "sin_cos" {
            trig = Some(if body.contains("libm") { "libm" } else { "std" });
        }
    }
    Ok(trig)
}

fn signature(function: &ItemFn) -> Result<(Vec<(String, String)>, String), String> {
    let sig = &function.sig;
    let plain = sig.constness.is_none() && sig.asyncness.is_none() && sig.abi.is_none() && sig.variadic.is_none();
    if !plain || !sig.generics.params.is_empty() || sig.generics.where_clause.is_some() {
        return Err("a plain function without generics is expected".into());
    }
    let mut arguments = Vec::new();
    for argument in &sig.inputs {
        let FnArg::Typed(typed) = argument else { return Err("a free function takes no self".into()) };
        harmless(&typed.attrs)?;
        arguments.push((text(&typed.pat), text(&typed.ty)));
    }
    let result = match &sig.output {
        ReturnType::Type(_, ty) => text(ty),
        ReturnType::Default => return Err("a function returns a value".into()),
    };
    Ok((arguments, result))
}

fn read_function(
    function: &ItemFn,
    private: &BTreeMap<String, &ItemFn>,
    real: Float,
    work: &mut usize,
) -> Result<Function, String> {
    let (arguments, result) = signature(function)?;
    let listed: Vec<String> = arguments.iter().map(|(name, ty)| format!("{name}:{ty}")).collect();
    let program = expression::compile(function, &arguments, private, real, work)?;
    Ok(Function { signature: format!("({})->{result}", listed.join(",")), program })
}
