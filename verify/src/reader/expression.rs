//! From the body of a function to its steps.

use std::collections::BTreeMap;

use syn::{BinOp, Block, Expr, ItemFn, Lit, Member, Pat, Stmt, UnOp};

use super::nesting::MOST_TOKENS;
use super::{constant, signature, text};
use crate::enclosure::Float;
use crate::program::{Angle, Argument, Literal, Output, Program, Step};

/// A value while reading: a step, or several.
#[derive(Clone, Debug)]
enum Value {
    /// An entry.
    Step(usize),
    /// A whole argument.
    Argument(Argument),
    /// An array or a tuple, by its opening bracket.
    List(char, Vec<Value>),
    /// A struct.
    Struct(Vec<(String, Value)>),
}

type Scope = BTreeMap<String, Value>;

impl Value {
    /// How many values are in it, and how deep: numbers are alone.
    fn size(&self) -> (usize, usize) {
        let around = |(sum, deep): (usize, usize), value: &Value| {
            let (size, depth) = value.size();
            (sum + size, deep.max(depth + 1))
        };
        match self {
            Value::Step(_) | Value::Argument(_) => (1, 0),
            Value::List(_, values) => values.iter().fold((1, 1), around),
            Value::Struct(fields) => fields.iter().map(|(_, value)| value).fold((1, 1), around),
        }
    }
}

struct Compiler<'a> {
    private: &'a BTreeMap<String, &'a ItemFn>,
    real: Float,
    steps: Vec<Step>,
    literals: Vec<Literal>,
    turns: Vec<usize>,
    calls: Vec<String>,
    /// Expressions around the one that is read, through all calls.
    depth: usize,
    /// What was read and copied so far in the whole module, in expressions, values, steps and bytes of text.
    work: &'a mut usize,
}

/// For a module; that of 32 joints takes a third of it.
const MOST_WORK: usize = 1 << 25;
/// What a step counts as.
const WORK_OF_STEP: usize = 8;
/// What a call counts as.
const WORK_OF_CALL: usize = 256;
/// Lists in lists; what is returned is two deep.
const MOST_LISTS: usize = 8;
/// Terms and signs under a sine: a sum has a term for each joint and perhaps a constant.
const MOST_ANGLES: usize = 256;

/// Reads a public function.
pub(super) fn compile(
    function: &ItemFn,
    arguments: &[(String, String)],
    private: &BTreeMap<String, &ItemFn>,
    real: Float,
    work: &mut usize,
) -> Result<Program, String> {
    let mut compiler =
        Compiler { private, real, steps: Vec::new(), literals: Vec::new(), turns: Vec::new(), calls: Vec::new(), depth: 0, work };
    let mut scope = Scope::new();
    let mut known = Vec::new();
    for (name, _) in arguments {
        let argument = Argument::named(name).ok_or(format!("argument `{name}` is not one that emitted functions have"))?;
        known.push(argument);
        scope.insert(name.clone(), Value::Argument(argument));
    }
    let result = compiler.block(&function.block, scope)?;
    let mut outputs = Vec::new();
    flatten(&result, String::new(), &mut outputs)?;
    let name = function.sig.ident.to_string();
    Ok(Program { name, arguments: known, steps: compiler.steps, literals: compiler.literals, turns: compiler.turns, outputs })
}

fn flatten(value: &Value, place: String, outputs: &mut Vec<Output>) -> Result<(), String> {
    match value {
        Value::Step(step) => outputs.push(Output { place, step: *step }),
        Value::Argument(_) => return Err("an argument is returned whole".into()),
        Value::List('(', values) => {
            for (i, value) in values.iter().enumerate() {
                flatten(value, format!("{place}.{i}"), outputs)?;
            }
        }
        Value::List(_, values) => {
            for (i, value) in values.iter().enumerate() {
                flatten(value, format!("{place}[{i}]"), outputs)?;
            }
        }
        Value::Struct(fields) => {
            for (name, value) in fields {
                flatten(value, format!("{place}.{name}"), outputs)?;
            }
        }
    }
    Ok(())
}

impl Compiler<'_> {
    fn push(&mut self, step: Step) -> Result<Value, String> {
        self.worked(WORK_OF_STEP)?;
        self.steps.push(step);
        Ok(Value::Step(self.steps.len() - 1))
    }

    fn worked(&mut self, work: usize) -> Result<(), String> {
        *self.work += work;
        if *self.work > MOST_WORK {
            return Err("the module takes more work to read than that of any arm".into());
        }
        Ok(())
    }

    fn block(&mut self, block: &Block, mut scope: Scope) -> Result<Value, String> {
        let written = text(block);
        self.worked(written.len())?;
        // On an element of an array or a tuple `cfg` takes it away.
        if written.contains('#') {
            return Err("an attribute inside of a body".into());
        }
        let Some((last, lines)) = block.stmts.split_last() else { return Err("an empty body".into()) };
        for line in lines {
            let Stmt::Local(local) = line else { return Err(format!("`{}` is not a `let`", shortened(line))) };
            let Some(init) = &local.init else { return Err(format!("`{}` has no value", shortened(line))) };
            if init.diverge.is_some() {
                return Err(format!("`{}` has an else", shortened(line)));
            }
            let value = self.expression(&init.expr, &scope)?;
            bind(&local.pat, value, &mut scope)?;
        }
        match last {
            Stmt::Expr(expression, None) => self.expression(expression, &scope),
            other => Err(format!("the body ends in `{}`, not in a value", shortened(other))),
        }
    }

    fn step(&mut self, expression: &Expr, scope: &Scope) -> Result<usize, String> {
        match self.expression(expression, scope)? {
            Value::Step(step) => Ok(step),
            _ => Err(format!("`{}` is not a number", shortened(expression))),
        }
    }

    fn expression(&mut self, expression: &Expr, scope: &Scope) -> Result<Value, String> {
        self.depth += 1;
        if self.depth > MOST_TOKENS {
            return Err("expressions and calls nest too deeply".into());
        }
        let value = self.value(expression, scope)?;
        self.depth -= 1;
        let (size, depth) = value.size();
        if depth > MOST_LISTS {
            return Err(format!("lists in more than {MOST_LISTS} others"));
        }
        self.worked(size)?;
        Ok(value)
    }

    fn value(&mut self, expression: &Expr, scope: &Scope) -> Result<Value, String> {
        match expression {
            Expr::Paren(inner) if inner.attrs.is_empty() => self.expression(&inner.expr, scope),
            Expr::Group(inner) => self.expression(&inner.expr, scope),
            Expr::Reference(inner) if inner.mutability.is_none() => self.expression(&inner.expr, scope),
            Expr::Path(path) => {
                let name = text(path);
                scope.get(&name).cloned().ok_or_else(|| format!("`{name}` is not a name that stands before"))
            }
            Expr::Lit(literal) => match &literal.lit {
                Lit::Float(float) => {
                    let literal = constant::float(float, self.real)?;
                    self.literals.push(literal);
                    self.push(Step::Literal(self.literals.len() - 1))
                }
                other => Err(format!("`{}` where a decimal number can stand", text(other))),
            },
            Expr::Index(index) => {
                let base = self.expression(&index.expr, scope)?;
                let position = integer(&index.index)?;
                match base {
                    Value::Argument(argument) => self.push(Step::Input(argument, position)),
                    Value::List('[', values) => {
                        values.get(position).cloned().ok_or_else(|| format!("`{}` is beyond the end", text(index)))
                    }
                    _ => Err(format!("`{}` is not an array", shortened(&index.expr))),
                }
            }
            Expr::Field(field) => {
                let found = match (self.expression(&field.base, scope)?, &field.member) {
                    (Value::List('(', values), Member::Unnamed(index)) => values.get(index.index as usize).cloned(),
                    (Value::Struct(fields), Member::Named(name)) => {
                        fields.into_iter().find(|(field, _)| name == field).map(|(_, value)| value)
                    }
                    _ => None,
                };
                found.ok_or_else(|| format!("`{}` has no such field", text(field)))
            }
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => {
                let inner = self.step(&unary.expr, scope)?;
                self.push(Step::Negate(inner))
            }
            Expr::Binary(binary) => {
                let (a, b) = (self.step(&binary.left, scope)?, self.step(&binary.right, scope)?);
                self.push(match binary.op {
                    BinOp::Add(_) => Step::Add(a, b),
                    BinOp::Sub(_) => Step::Subtract(a, b),
                    BinOp::Mul(_) => Step::Multiply(a, b),
                    BinOp::Div(_) => Step::Divide(a, b),
                    other => return Err(format!("operator `{}`", text(&other))),
                })
            }
            Expr::Array(array) => {
                let values: Result<_, _> = array.elems.iter().map(|e| self.expression(e, scope)).collect();
                Ok(Value::List('[', values?))
            }
            Expr::Tuple(tuple) => {
                let values: Result<_, _> = tuple.elems.iter().map(|e| self.expression(e, scope)).collect();
                Ok(Value::List('(', values?))
            }
            Expr::Struct(structure) if text(&structure.path) == "EquationsOfMotion" && structure.rest.is_none() => {
                let mut fields = Vec::new();
                for field in &structure.fields {
                    fields.push((text(&field.member), self.expression(&field.expr, scope)?));
                }
                // The order of the declaration, whatever the order here.
                let rank = |name: &str| ["inertia", "coriolis", "gravity"].iter().position(|n| *n == name);
                fields.sort_by_key(|(name, _)| rank(name));
                Ok(Value::Struct(fields))
            }
            Expr::Call(call) => {
                let name = text(&call.func);
                if name == "sin_cos_four" || name == "sin_cos_eight" {
                    return self.sines_and_cosines(&name, call, scope);
                }
                let arguments: Result<Vec<Value>, String> = call.args.iter().map(|a| self.expression(a, scope)).collect();
                self.call(&name, arguments?)
            }
            other => Err(format!("`{}` is not a step that emitted functions have", shortened(other))),
        }
    }

    /// Sines, then cosines, of the first so many of four or eight angles. Those of the others are no numbers: a processor without vectors leaves
    /// them out, so that nothing may use them.
    fn sines_and_cosines(&mut self, name: &str, call: &syn::ExprCall, scope: &Scope) -> Result<Value, String> {
        if !self.private.contains_key(name) {
            return Err(format!("call of `{name}`"));
        }
        let lanes = if name == "sin_cos_four" { 4 } else { 8 };
        let mut arguments = call.args.iter();
        let count = arguments.next().map(integer).transpose()?;
        let angles = arguments.map(|angle| self.expression(angle, scope)).collect::<Result<Vec<Value>, String>>()?;
        let Some(count) = count.filter(|&count| count <= lanes && angles.len() == lanes) else {
            return Err(format!("`{name}` does not take these arguments"));
        };
        let nothing = Value::List('(', Vec::new());
        let (mut sines, mut cosines) = (vec![nothing.clone(); lanes], vec![nothing; lanes]);
        for (lane, angle) in angles.into_iter().enumerate().take(count) {
            let Value::Step(step) = angle else { return Err("sine of what is no number".into()) };
            let angle = self.angle(step)?;
            sines[lane] = self.push(Step::Sine(angle.clone()))?;
            cosines[lane] = self.push(Step::Cosine(angle))?;
        }
        Ok(Value::List('(', vec![Value::List('[', sines), Value::List('[', cosines)]))
    }

    fn call(&mut self, name: &str, arguments: Vec<Value>) -> Result<Value, String> {
        let Some(function) = self.private.get(name) else { return Err(format!("call of `{name}`")) };
        match (name, arguments.as_slice()) {
            ("sin_cos" | "sin_cos_one", [Value::Step(angle)]) => {
                let angle = self.angle(*angle)?;
                let (sine, cosine) = (self.push(Step::Sine(angle.clone()))?, self.push(Step::Cosine(angle))?);
                return Ok(Value::List('(', vec![sine, cosine]));
            }
            ("sign", [Value::Step(rate)]) => {
                return match self.steps[*rate] {
                    Step::Input(Argument::Dq, joint) => self.push(Step::Sign(joint)),
                    _ => Err("sign of something that is not a joint rate".into()),
                }
            }
            (name, _) if super::LEAVES.contains(&name) => return Err(format!("`{name}` does not take these arguments")),
            _ => {}
        }
        if self.calls.iter().any(|caller| caller == name) {
            return Err(format!("`{name}` calls itself"));
        }
        self.worked(WORK_OF_CALL)?;
        let (parameters, _) = signature(function).map_err(|e| format!("`{name}`: {e}"))?;
        if parameters.len() != arguments.len() {
            return Err(format!("`{name}` takes {} arguments", parameters.len()));
        }
        let scope = parameters.into_iter().map(|(name, _)| name).zip(arguments).collect();
        self.calls.push(name.to_string());
        let value = self.block(&function.block, scope).map_err(|e| {
            // The innermost function says enough.
            if e.starts_with("in `") {
                e
            } else {
                format!("in `{name}`: {e}")
            }
        })?;
        self.calls.pop();
        Ok(value)
    }

    /// A step as an integer combination of joint variables and at most one constant.
    fn angle(&mut self, step: usize) -> Result<Angle, String> {
        let mut sum = BTreeMap::new();
        let mut constant = None;
        // Steps still to add, and with which sign: what is added twice is counted twice.
        let mut waiting = vec![(step, 1i64)];
        for _ in 0..MOST_ANGLES {
            let Some((step, sign)) = waiting.pop() else { break };
            match self.steps[step] {
                Step::Input(Argument::Q, joint) => *sum.entry(joint).or_default() += sign,
                Step::Literal(literal) if constant.is_none() => constant = Some((literal, sign < 0)),
                Step::Negate(a) => waiting.push((a, -sign)),
                Step::Add(a, b) => waiting.extend([(a, sign), (b, sign)]),
                Step::Subtract(a, b) => waiting.extend([(a, sign), (b, -sign)]),
                _ => return Err("sine of something that is not a sum of joint variables and a constant".into()),
            }
        }
        if !waiting.is_empty() {
            return Err(format!("sine of a sum of more than {MOST_ANGLES} terms and signs"));
        }
        let terms: Vec<(usize, i64)> = sum.into_iter().filter(|&(_, factor)| factor != 0).collect();
        if terms.is_empty() {
            return Err("sine of something without a joint variable".into());
        }
        let turn = constant.map(|(literal, minus)| {
            let known = self.turns.iter().position(|&turn| turn == literal);
            let index = known.unwrap_or_else(|| {
                self.turns.push(literal);
                self.turns.len() - 1
            });
            (index, minus)
        });
        Ok(Angle { terms, turn })
    }
}

fn bind(pattern: &Pat, value: Value, scope: &mut Scope) -> Result<(), String> {
    match (pattern, value) {
        (Pat::Wild(_), _) => Ok(()),
        (Pat::Ident(name), value) if name.by_ref.is_none() && name.mutability.is_none() && name.subpat.is_none() => {
            scope.insert(name.ident.to_string(), value);
            Ok(())
        }
        (Pat::Tuple(patterns), Value::List('(', values)) if patterns.elems.len() == values.len() => {
            patterns.elems.iter().zip(values).try_for_each(|(pattern, value)| bind(pattern, value, scope))
        }
        (Pat::Slice(patterns), Value::List('[', values)) if patterns.elems.len() == values.len() => {
            patterns.elems.iter().zip(values).try_for_each(|(pattern, value)| bind(pattern, value, scope))
        }
        (pattern, _) => Err(format!("`let {}` does not fit its value", text(pattern))),
    }
}

fn integer(expression: &Expr) -> Result<usize, String> {
    match expression {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Int(i) if i.suffix().is_empty() => i.base10_parse().map_err(|e| format!("index `{i}`: {e}")),
            other => Err(format!("index `{}`", text(other))),
        },
        other => Err(format!("index `{}` is not a constant", shortened(other))),
    }
}

fn shortened(tokens: &impl quote::ToTokens) -> String {
    let all = text(tokens);
    if all.chars().count() <= 60 {
        return all;
    }
    all.chars().take(57).chain("...".chars()).collect()
}
