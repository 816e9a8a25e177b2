//! Reads an emitted module back: constants as values, functions as straight-line programs.
//!
//! The reader knows a small part of Rust and names everything else as an error: `let` with a name, `_` or a tuple; names, `x[3]`, decimal
//! literals, `+ - * /`, a minus sign, tuples, arrays, one struct; calls of `sin_cos`, of `sin_cos_all` for several angles, of `sign` and of
//! the module's own private functions, which are taken in where they are called. No `cfg`, no macro, no loop, no `use`, no block that could hide a step.

mod constant;
mod expression;

use std::collections::BTreeMap;

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

/// Accepted items of the private block that answers for all angles together, by the SHA-256 of their texts without blanks: name, scalar, hash.
const TOGETHER: [(&str, Float, &str); 10] = [
    ("SIN_COS_RANGE", Float::F64, "1b1d904a5bf4f2b907d0f5f3c8e747d577099c0d45c88129a46191582bb857bd"),
    ("sin_cos", Float::F64, "c3a464d0942e1e27be5b08a992ed5cdf2bd84effd79bc74aa74e0195df00c63c"),
    ("sin_cos_all", Float::F64, "fb26be38e2497a379a62a91dcc50b5ada821a807bc42bf2d013713a7a6b9eb27"),
    ("sin_cos_few", Float::F64, "47efd60c6c274be70fc0791726b6ec04770a1c3d074bca9877855476019a6239"),
    ("sin_cos_beyond", Float::F64, "fafd2792aad41e7524a7180750020b7db7bc5be4e448af98d948fc40fb227425"),
    ("SIN_COS_RANGE", Float::F32, "20698ad98ba01987199d4794215fcb537e1ca0794a3ac967f936e96473726608"),
    ("sin_cos", Float::F32, "dfafcf1df1ddaaa3b3290c9defc89af2d5d43e2ab0f7d4787227254c2750b61f"),
    ("sin_cos_all", Float::F32, "42a4eedef962b6e7d07ff5a0c982e8a938523b12ca8eb60d7c73ed8fa411bb16"),
    ("sin_cos_few", Float::F32, "b1cdcf1fd0b81537b8a207a07e23e44e988e47d3a5d07f0ded0921709f1fe060"),
    ("sin_cos_beyond", Float::F32, "b481d6bc3791e07f5d87dbee07791201b4ed8c1178418a228344f382e3a107ff"),
];

/// The largest angle of that block.
const RANGE: &str = "SIN_COS_RANGE";

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
        let file = syn::parse_file(source).map_err(|e| format!("the text is not Rust: {e}"))?;
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
                    let start: String = text(other).chars().take(60).collect();
                    return Err(format!("`{start}` is not an item that an emitted module has"));
                }
            }
        }
        let real = real.ok_or("the module has no type `Real`")?;
        let mut values = BTreeMap::new();
        for constant in constants {
            let name = constant.ident.to_string();
            if name == RANGE && matches!(constant.vis, Visibility::Inherited) {
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
        let joints = match values.get("DOF") {
            Some((_, Constant::Integer(dof))) => *dof as usize,
            _ => return Err("the module has no number of joints `DOF`".into()),
        };
        let functions = public.iter().map(|f| (f.sig.ident.to_string(), read_function(f, &private, real, joints))).collect();
        Ok(Module { real, trig, constants: values, functions })
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
    let together = private.contains_key("sin_cos_all");
    for name in ["sin_cos", "sin_cos_all", "sin_cos_few", "sin_cos_beyond", "sign"] {
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

fn read_function(function: &ItemFn, private: &BTreeMap<String, &ItemFn>, real: Float, joints: usize) -> Result<Function, String> {
    let (arguments, result) = signature(function)?;
    let listed: Vec<String> = arguments.iter().map(|(name, ty)| format!("{name}:{ty}")).collect();
    let program = expression::compile(function, &arguments, private, real, joints)?;
    Ok(Function { signature: format!("({})->{result}", listed.join(",")), program })
}
