//! A function of Rust as one of C: its arguments, what closures capture, and expressions.
//!
//! What C has no expression for is written into statements before it; their values are variables with names of their own.

use super::infer::{address, member, Inferred};
use super::program::{last, names, Function};
use super::scopes::{Bound, Lower};
use super::translator::{c_name, comment, has_fields, Callable, Found, Translator};
use super::typed_calls::callable_bounds;
use super::types::{Integer, Length, Type};
use super::values::{is_word, Binding, Item, Kind, Value};

impl<'a, 't> Lower<'a, 't> {
    fn new(tr: &'t mut Translator<'a>, inferred: &'t Inferred, owner: &str) -> Self {
        let mut this = Lower { tr, inferred, text: String::new(), indent: 1, frames: Vec::new(), owner: owner.into() };
        this.open_frame();
        this
    }

    /// The value of a constant.
    pub(super) fn constant(tr: &'t mut Translator<'a>, inferred: &'t Inferred, value: &'a syn::Expr) -> Found<String> {
        let mut this = Lower::new(tr, inferred, "");
        let text =
            if this.is_literal(value) { this.initialiser(value)? } else { this.expression(value)?.within(Binding::Primary) };
        if this.text.is_empty() {
            Ok(text)
        } else {
            Err("a constant that needs statements".into())
        }
    }

    /// Writes a function after the previous ones.
    pub(super) fn function(
        tr: &'t mut Translator<'a>,
        inferred: &'t Inferred,
        function: Function<'a>,
        name: &str,
        inputs: &[Type],
        output: &Type,
    ) -> Found<()> {
        let mut this = Lower::new(tr, inferred, name);
        let patterns: Vec<Option<&'a syn::Pat>> = function
            .signature
            .inputs
            .iter()
            .map(|argument| match argument {
                syn::FnArg::Receiver(_) => None,
                syn::FnArg::Typed(argument) => Some(&*argument.pat),
            })
            .collect();
        let parameters = this.parameters(&patterns, inputs)?;
        this.returned_block(function.block, output)?;
        let said = comment(function.attributes, "");
        this.define(name, parameters, output, &said)
    }

    /// Binds arguments, and gives their declarations.
    fn parameters(&mut self, patterns: &[Option<&'a syn::Pat>], inputs: &[Type]) -> Found<Vec<(String, String)>> {
        let mut parameters = Vec::new();
        let mut destructured = Vec::new();
        for (pattern, ty) in patterns.iter().zip(inputs) {
            let pattern = match pattern {
                Some(syn::Pat::Type(typed)) => Some(&*typed.pat),
                other => *other,
            };
            let (name, mutable) = match pattern {
                None => ("self".to_owned(), false),
                Some(syn::Pat::Ident(ident)) => (ident.ident.to_string(), ident.mutability.is_some()),
                Some(syn::Pat::Wild(_)) => ("unused".into(), false),
                Some(_) => ("given".into(), false),
            };
            let variable = self.variable(&name);
            let bound = match ty {
                Type::Closure(id) => {
                    let captured = self.tr.callables.get(id).is_some_and(|callable| callable.captured.is_some());
                    Bound::Closure(*id, captured.then(|| variable.clone()))
                }
                Type::Function(path) => Bound::Function(path.clone()),
                Type::Reference(to, mutable) if !matches!(**to, Type::Slice(_)) => {
                    Bound::Value(Value::behind(variable.clone()), ty.clone(), *mutable)
                }
                _ => Bound::Value(Value::place(variable.clone()), ty.clone(), mutable),
            };
            if !matches!(bound, Bound::Closure(_, None) | Bound::Function(_)) {
                parameters.push((variable.clone(), self.tr.declarator(ty, &variable)?));
            }
            match (pattern, bound) {
                (None | Some(syn::Pat::Ident(_)), bound) => self.bind_name(&name, bound),
                (Some(pattern), Bound::Value(value, ty, _)) => destructured.push((pattern, Item::Value(value, ty))),
                _ => return Err("a function that is taken apart".into()),
            }
        }
        for (pattern, item) in destructured {
            self.bind(pattern, item)?;
        }
        Ok(parameters)
    }

    /// The definition of the function whose body has been written.
    fn define(&mut self, name: &str, parameters: Vec<(String, String)>, output: &Type, said: &str) -> Found<()> {
        let body = counted(std::mem::take(&mut self.text));
        let unused: String = parameters
            .iter()
            .filter(|(name, _)| !mentions(&body, name))
            .map(|(name, _)| format!("    (void){name};\n"))
            .collect();
        let declarations: Vec<String> = parameters.into_iter().map(|(_, declaration)| declaration).collect();
        let list = if declarations.is_empty() { "void".into() } else { declarations.join(", ") };
        let list = if list.len() > 100 { format!("\n    {}", declarations.join(",\n    ")) } else { list };
        let head = self.tr.declarator(output, name)?;
        let upper = &self.tr.upper;
        let text = format!("\n{said}static inline {head}({list})\n{{\n    {upper}_UNFUSED\n{unused}{body}}}\n");
        self.tr.functions += &text;
        Ok(())
    }

    /// A closure as a function of its own, with a variable for its captures.
    pub(super) fn lifted(&mut self, closure: &'a syn::ExprClosure, hint: &str) -> Found<Bound<'a>> {
        let Type::Closure(id) = *self.inferred.ty(address(closure))? else { return Err("no closure".into()) };
        let signature = self.tr.closures[id].clone();
        let wanted = format!("{}_{hint}", self.owner);
        let name = self.tr.fresh(&wanted);
        let outer = (std::mem::take(&mut self.text), std::mem::replace(&mut self.indent, 1));
        self.open_frame();
        let mine = self.variable("captured");
        let patterns: Vec<Option<&'a syn::Pat>> = closure.inputs.iter().map(Some).collect();
        let mut parameters = self.parameters(&patterns, &signature.inputs)?;
        self.returned(&closure.body, &signature.output)?;
        let frame = self.frames.pop().ok_or("no frame")?;
        let captured = (!frame.fields.is_empty()).then(|| format!("{name}_captured"));
        if let Some(captured) = &captured {
            let fields: String = frame.fields.iter().map(|(field, _)| format!("    {field};\n")).collect();
            self.tr.typedefs += &format!("\n/* What `{name}` has captured. */\ntypedef struct {{\n{fields}}} {captured};\n");
            parameters.insert(0, (mine.clone(), format!("const {captured} *{mine}")));
        }
        self.define(&name, parameters, &signature.output, "")?;
        (self.text, self.indent) = outer;
        self.tr.callables.insert(id, Callable { function: name, captured: captured.clone() });
        let Some(captured) = captured else { return Ok(Bound::Closure(id, None)) };
        let variable = self.variable(hint);
        let values: Vec<String> = frame.fields.into_iter().map(|(_, value)| value).collect();
        self.line(&format!("const {captured} {variable} = {{{}}};", values.join(", ")));
        Ok(Bound::Closure(id, Some(format!("&{variable}"))))
    }

    pub(super) fn ty<T>(&self, node: &T) -> Found<Type> {
        self.inferred.ty(address(node)).cloned()
    }

    /// A value with a place: a variable with this name, if it has no place yet.
    pub(super) fn placed(&mut self, value: Value, ty: &Type, hint: &str) -> Found<Value> {
        if value.kind != Kind::Value {
            return Ok(value);
        }
        let variable = self.variable(hint);
        let declaration = self.tr.declarator(ty.behind(), &variable)?;
        self.line(&format!("const {declaration} = {};", value.text()));
        Ok(Value::place(variable))
    }

    /// An index that does not change while a place is used.
    pub(super) fn stable(&mut self, value: &'a syn::Expr) -> Found<String> {
        let found = self.expression(value)?;
        if found.text.bytes().all(|b| b.is_ascii_digit()) || (found.kind == Kind::Value && is_word(&found.text)) {
            return Ok(found.text);
        }
        if let syn::Expr::Path(path) = value {
            if let Some(Bound::Value(_, _, false)) = self.lookup(&last(&path.path))? {
                return Ok(found.text());
            }
        }
        let variable = self.variable("at");
        self.line(&format!("const size_t {variable} = {};", found.text()));
        Ok(variable)
    }

    /// The statements that `write` would emit, without emitting them, and its result.
    pub(super) fn apart<T>(&mut self, write: impl FnOnce(&mut Self) -> Found<T>) -> Found<(String, T)> {
        let outer = std::mem::take(&mut self.text);
        let blocks = self.frames.last().map(|frame| frame.blocks.clone()).unwrap_or_default();
        let result = write(self);
        let text = std::mem::replace(&mut self.text, outer);
        if !text.is_empty() {
            // They are written once more elsewhere, or not at all.
            if let Some(frame) = self.frames.last_mut() {
                frame.blocks = blocks;
            }
        }
        Ok((text, result?))
    }

    pub(super) fn expression(&mut self, value: &'a syn::Expr) -> Found<Value> {
        use syn::Expr;
        match value {
            Expr::Lit(literal) => self.literal(literal, value),
            Expr::Paren(inner) => self.expression(&inner.expr),
            Expr::Group(inner) => self.expression(&inner.expr),
            Expr::Path(path) => self.path(&path.path, value),
            Expr::Unary(unary) => self.unary(unary),
            Expr::Reference(reference) => {
                let found = self.expression(&reference.expr)?;
                let ty = self.ty(&*reference.expr)?;
                self.placed(found, &ty, "value")
            }
            Expr::Binary(binary) => self.binary(binary, value),
            Expr::Cast(cast) => {
                let found = self.expression(&cast.expr)?;
                let to = self.ty(value)?;
                self.cast(&to, &found)
            }
            Expr::Field(field) => {
                let base = self.expression(&field.base)?;
                let ty = self.ty(&*field.base)?;
                let base = self.placed(base, &ty, "result")?;
                let name = match &field.member {
                    syn::Member::Named(_) => c_name(&member(&field.member)),
                    syn::Member::Unnamed(index) => format!("part_{}", index.index),
                };
                let found = base.member(&name);
                Ok(match self.ty(value)? {
                    Type::Reference(..) => Value::behind(found.text),
                    _ => found,
                })
            }
            Expr::Index(index) => {
                let at = self.expression(&index.index)?.text();
                if let Expr::Path(path) = &*index.expr {
                    if let Some(Bound::View(view)) = self.lookup(&last(&path.path))? {
                        return Ok(view.element(&at));
                    }
                }
                let base = self.expression(&index.expr)?;
                let ty = self.ty(&*index.expr)?;
                Ok(self.placed(base, &ty, "array")?.element(&at))
            }
            Expr::If(_) | Expr::Match(_) | Expr::Block(_) => self.chosen(value),
            Expr::Array(_) | Expr::Repeat(_) | Expr::Tuple(_) | Expr::Struct(_) => {
                let ty = self.ty(value)?;
                Ok(Value::place(self.declared("value", &ty, false, value)?))
            }
            Expr::Call(call) => self.call(call, value),
            Expr::MethodCall(call) => self.method(call, value),
            Expr::Macro(call) => {
                let value = *self.tr.program.macros.get(&address(call)).ok_or("a macro")?;
                self.expression(value)
            }
            _ => Err("an expression that has no value in C".into()),
        }
    }

    fn literal(&mut self, literal: &syn::ExprLit, value: &syn::Expr) -> Found<Value> {
        Ok(match &literal.lit {
            syn::Lit::Float(number) => Value::primary(self.real(number.base10_digits())),
            syn::Lit::Bool(value) => Value::primary(value.value.to_string()),
            syn::Lit::Int(number) => {
                let digits = number.base10_digits();
                Value::primary(match self.ty(value)? {
                    Type::Integer(Integer::U32) => format!("{digits}u"),
                    Type::Integer(Integer::U64) => format!("UINT64_C({digits})"),
                    _ => digits.to_owned(),
                })
            }
            _ => return Err("a literal of another kind".into()),
        })
    }

    pub(super) fn real(&self, digits: &str) -> String {
        if self.tr.program.is_single() {
            format!("{digits}f")
        } else {
            digits.to_owned()
        }
    }

    fn path(&mut self, path: &syn::Path, value: &syn::Expr) -> Found<Value> {
        let all = names(path);
        match &all[..] {
            [name] => {
                if let Some(bound) = self.lookup(name)? {
                    return match bound {
                        Bound::Value(value, ..) => Ok(value),
                        _ => Err(format!("`{name}` is no value")),
                    };
                }
                if let Some(size) = self.inferred.sizes.get(name) {
                    return Ok(Value::primary(size.to_string()));
                }
                if name == "None" {
                    return Ok(Value::primary("NULL"));
                }
                let (text, ty) = self.tr.constant(name)?;
                Ok(match ty {
                    Type::Real | Type::Integer(_) | Type::Bool => Value::primary(text),
                    _ => Value::place(text),
                })
            }
            [of, name] if of == "Real" => {
                let kind = if self.tr.program.is_single() { "FLT" } else { "DBL" };
                Ok(match name.as_str() {
                    "INFINITY" | "NAN" => Value::primary(name.clone()),
                    "NEG_INFINITY" => Value::new("-INFINITY", Binding::Unary),
                    "MAX" => Value::primary(format!("{kind}_MAX")),
                    "MIN_POSITIVE" => Value::primary(format!("{kind}_MIN")),
                    "EPSILON" => Value::primary(format!("{kind}_EPSILON")),
                    _ => return Err(format!("`Real::{name}` is not known")),
                })
            }
            [of, variant] => {
                let item = *self.tr.program.enums.get(of).ok_or_else(|| format!("`{of}` is not known"))?;
                let ty = self.ty(value)?;
                self.tr.c_type(&ty)?;
                let number = self.tr.variant(of, variant);
                if !has_fields(item) {
                    return Ok(Value::primary(number));
                }
                let variable = self.variable("kind");
                let declaration = self.tr.declarator(&ty, &variable)?;
                let nothing: String = item.variants.iter().flat_map(|variant| &variant.fields).map(|_| ", 0").collect();
                self.line(&format!("const {declaration} = {{{}::{number}{nothing}}};", "").replace("::", ""));
                Ok(Value::place(variable))
            }
            _ => Err("a path of another kind".into()),
        }
    }

    fn unary(&mut self, unary: &'a syn::ExprUnary) -> Found<Value> {
        let found = self.expression(&unary.expr)?;
        let inner = found.within(Binding::Primary);
        Ok(match &unary.op {
            syn::UnOp::Deref(_) => found,
            syn::UnOp::Neg(_) => Value::new(format!("-{inner}"), Binding::Unary),
            _ => match self.ty(&*unary.expr)?.behind() {
                Type::Bool => Value::new(format!("!{inner}"), Binding::Unary),
                ty @ Type::Integer(Integer::U16) => self.cast(&ty.clone(), &Value::new(format!("~{inner}"), Binding::Unary))?,
                _ => Value::new(format!("~{inner}"), Binding::Unary),
            },
        })
    }

    pub(super) fn cast(&mut self, to: &Type, value: &Value) -> Found<Value> {
        let to = self.tr.c_type(to)?;
        Ok(Value::new(format!("({to}){}", value.within(Binding::Primary)), Binding::Unary))
    }

    fn binary(&mut self, binary: &'a syn::ExprBinary, whole: &'a syn::Expr) -> Found<Value> {
        use syn::BinOp::*;
        let of = self.ty(&*binary.left)?.behind().clone();
        if let Type::Array(_, length) = &of {
            return self.compared(binary, *length);
        }
        let left = self.expression(&binary.left)?;
        // Rust evaluates the right side only if the left side does not decide; so its statements run under the same condition.
        let (statements, right) = self.apart(|this| this.expression(&binary.right))?;
        if !statements.is_empty() {
            if matches!(binary.op, And(_) | Or(_)) {
                let variable = self.variable("holds");
                self.line(&format!("bool {variable} = {};", left.text()));
                let test = if matches!(binary.op, And(_)) { variable.clone() } else { format!("!{variable}") };
                self.open(&format!("if ({test})"));
                let right = self.expression(&binary.right)?;
                self.line(&format!("{variable} = {};", right.text()));
                self.close();
                return Ok(Value::primary(variable));
            }
            let right = self.expression(&binary.right)?;
            return self.operation(&binary.op, &of, left, right, whole);
        }
        self.operation(&binary.op, &of, left, right, whole)
    }

    fn operation(&mut self, op: &syn::BinOp, of: &Type, left: Value, right: Value, whole: &syn::Expr) -> Found<Value> {
        use syn::BinOp::*;
        let (sign, binding) = match op {
            Add(_) => ("+", Binding::Sum),
            Sub(_) => ("-", Binding::Sum),
            Mul(_) => ("*", Binding::Product),
            Div(_) => ("/", Binding::Product),
            Rem(_) => ("%", Binding::Product),
            And(_) => ("&&", Binding::And),
            Or(_) => ("||", Binding::Or),
            BitAnd(_) if *of == Type::Bool => ("&&", Binding::And),
            BitOr(_) if *of == Type::Bool => ("||", Binding::Or),
            BitAnd(_) => ("&", Binding::Bits),
            BitOr(_) => ("|", Binding::Bits),
            BitXor(_) => ("^", Binding::Bits),
            Shl(_) => ("<<", Binding::Bits),
            Shr(_) => (">>", Binding::Bits),
            Eq(_) => ("==", Binding::Comparison),
            Ne(_) => ("!=", Binding::Comparison),
            Lt(_) => ("<", Binding::Comparison),
            Le(_) => ("<=", Binding::Comparison),
            Gt(_) => (">", Binding::Comparison),
            Ge(_) => (">=", Binding::Comparison),
            _ => return Err("an operator of another kind".into()),
        };
        // Brackets where compilers ask for them: sums keep their order, the rest is in brackets unless it is a product in a sum.
        let (least, after) = match binding {
            Binding::Sum => (Binding::Sum, Binding::Product),
            Binding::Product => (Binding::Product, Binding::Unary),
            Binding::Comparison => (Binding::Sum, Binding::Sum),
            Binding::And | Binding::Or => {
                let same = if binding == Binding::And { Binding::And } else { Binding::Or };
                (same, Binding::Comparison)
            }
            _ => (Binding::Unary, Binding::Unary),
        };
        let mixed =
            |value: &Value| if value.binding == Binding::And && binding == Binding::Or { Binding::Primary } else { least };
        let (mut l, r) = (left.within(mixed(&left)), right.within(after));
        let result = self.ty(whole).unwrap_or(Type::Bool);
        if matches!(op, Shl(_)) && l.bytes().all(|b| b.is_ascii_digit()) {
            l = self.cast(of, &Value::primary(l))?.text;
        }
        let value = Value::new(format!("{l} {sign} {r}"), binding);
        Ok(match result {
            Type::Integer(Integer::U16) => self.cast(&result, &value)?,
            _ => value,
        })
    }

    /// Arrays are equal where all their elements are.
    fn compared(&mut self, binary: &'a syn::ExprBinary, length: Length) -> Found<Value> {
        let equal = matches!(binary.op, syn::BinOp::Eq(_));
        let Length::Known(size) = length else { return Err("a size is open".into()) };
        let mut sides = Vec::new();
        for side in [&*binary.left, &*binary.right] {
            let (found, ty) = (self.expression(side)?, self.ty(side)?);
            sides.push(self.placed(found, &ty, "side")?);
        }
        let (sign, between, binding) = if equal { ("==", " && ", Binding::And) } else { ("!=", " || ", Binding::Or) };
        let all: Vec<String> = (0..size)
            .map(|i| format!("{} {sign} {}", sides[0].element(&i.to_string()).text, sides[1].element(&i.to_string()).text))
            .collect();
        Ok(Value::new(all.join(between), binding))
    }
}

/// A body without counters of iterators from which nothing is taken one by one.
fn counted(body: String) -> String {
    let unused = |line: &str| {
        let counter = line.trim_start().strip_prefix("size_t ").and_then(|line| line.strip_suffix("_taken = 0;"));
        counter.is_some_and(|counter| body.matches(&format!("{counter}_taken")).count() == 1)
    };
    if body.lines().any(unused) {
        body.lines().filter(|line| !unused(line)).map(|line| format!("{line}\n")).collect()
    } else {
        body
    }
}

/// Whether a text has a word.
fn mentions(text: &str, word: &str) -> bool {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices(word).any(|(at, _)| {
        !text[..at].chars().next_back().is_some_and(part) && !text[at + word.len()..].chars().next().is_some_and(part)
    })
}

/// Whether an argument of a function is a function itself.
pub(super) fn is_callable(argument: &syn::FnArg) -> bool {
    matches!(argument, syn::FnArg::Typed(argument) if callable_bounds(&argument.ty).is_some())
}
