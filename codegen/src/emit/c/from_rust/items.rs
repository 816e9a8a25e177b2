//! Patterns (their bindings and conditions) and options.

use syn::Expr;

use super::infer::{address, member};
use super::program::{guarded, last, names};
use super::scopes::{Bound, Lower};
use super::translator::{c_name, has_fields, Found};
use super::types::{Length, Type};
use super::values::{sum, Binding, Count, Item, Kind, Value, View};

impl<'a> Lower<'a, '_> {
    /// What an expression is, as far as patterns look into it.
    pub(super) fn item(&mut self, value: &'a syn::Expr) -> Found<Item> {
        match value {
            Expr::Paren(inner) => return self.item(&inner.expr),
            Expr::Tuple(tuple) => {
                return Ok(Item::Tuple(tuple.elems.iter().map(|value| self.item(value)).collect::<Found<_>>()?))
            }
            Expr::Path(path) => {
                if let Some(Bound::View(view)) = self.lookup(&last(&path.path))? {
                    return Ok(Item::View(view));
                }
            }
            _ => {}
        }
        let ty = self.ty(value)?;
        if let Type::Option(_) = ty {
            return self.option(value);
        }
        let found = self.expression(value)?;
        Ok(Item::Value(found, ty))
    }

    /// Binds the names of a pattern.
    pub(super) fn bind(&mut self, pattern: &'a syn::Pat, item: Item) -> Found<()> {
        match (pattern, item) {
            (syn::Pat::Wild(_) | syn::Pat::Lit(_) | syn::Pat::Rest(_) | syn::Pat::Path(_), _) => Ok(()),
            (syn::Pat::Type(typed), item) => self.bind(&typed.pat, item),
            (syn::Pat::Paren(inner), item) => self.bind(&inner.pat, item),
            (syn::Pat::Guard(inner), item) => self.bind(&inner.pat, item),
            (syn::Pat::Reference(inner), item) => self.bind(&inner.pat, item),
            (syn::Pat::Ident(ident), _) if self.is_value(ident) => Ok(()),
            (syn::Pat::Ident(ident), item) => self.bind_ident(ident, item),
            (syn::Pat::Tuple(tuple), Item::Tuple(items)) => {
                tuple.elems.iter().zip(items).try_for_each(|(pattern, item)| self.bind(pattern, item))
            }
            (syn::Pat::Tuple(tuple), Item::Value(value, ty)) => {
                let Type::Tuple(types) = ty.behind().clone() else { return Err(format!("{ty:?} is no tuple")) };
                let value = self.placed(value, &ty, "pair")?;
                for (i, (pattern, ty)) in tuple.elems.iter().zip(types).enumerate() {
                    let part = value.member(&format!("part_{i}"));
                    let part = if matches!(ty, Type::Reference(..)) { Value::behind(part.text) } else { part };
                    self.bind(pattern, Item::Value(part, ty))?;
                }
                Ok(())
            }
            (syn::Pat::Slice(slice), Item::View(view)) => {
                for (i, pattern) in slice.elems.iter().enumerate() {
                    self.bind(pattern, Item::Value(view.element(&i.to_string()), view.of.clone()))?;
                }
                Ok(())
            }
            (syn::Pat::Slice(slice), Item::Value(value, ty)) => self.bind_elements(slice, value, &ty),
            (syn::Pat::Struct(of), Item::Value(value, ty)) => {
                let value = self.placed(value, &ty, "result")?;
                for field in &of.fields {
                    let name = member(&field.member);
                    // Names know their own types.
                    self.bind(&field.pat, Item::Value(value.member(&c_name(&name)), Type::Unit))?;
                }
                Ok(())
            }
            (syn::Pat::TupleStruct(some), Item::Option(_, inner)) => {
                some.elems.first().map_or(Ok(()), |pattern| self.bind(pattern, *inner))
            }
            (_, item) => Err(format!("a pattern that does not fit {item:?}")),
        }
    }

    fn bind_elements(&mut self, slice: &'a syn::PatSlice, value: Value, ty: &Type) -> Found<()> {
        let Type::Array(of, length) = ty.behind().clone() else { return Err(format!("{ty:?} is no array")) };
        let Length::Known(size) = length else { return Err("a size is open".into()) };
        let value = self.placed(value, ty, "array")?;
        for (i, pattern) in slice.elems.iter().enumerate() {
            if let syn::Pat::Ident(syn::PatIdent { ident, subpat: Some(_), .. }) = pattern {
                let view = View {
                    pointer: value.member("at").text,
                    offset: Some(i.to_string()),
                    count: Count::Known(size + 1 - slice.elems.len()),
                    of: (*of).clone(),
                    within: None,
                };
                self.bind_name(&ident.to_string(), Bound::View(view));
            } else {
                self.bind(pattern, Item::Value(value.element(&i.to_string()), (*of).clone()))?;
            }
        }
        Ok(())
    }

    fn is_value(&self, ident: &syn::PatIdent) -> bool {
        let name = ident.ident.to_string();
        name == "None" || self.tr.program.constants.contains_key(&name)
    }

    fn bind_ident(&mut self, ident: &'a syn::PatIdent, item: Item) -> Found<()> {
        let name = ident.ident.to_string();
        match item {
            Item::View(view) => self.bind_name(&name, Bound::View(view)),
            Item::Value(value, _) => {
                let ty = self.ty(ident)?;
                let mutable = ident.mutability.is_some();
                match &ty {
                    // A reference is another name for its target.
                    Type::Reference(to, changes) if !matches!(**to, Type::Slice(_)) => {
                        let value = self.placed(value, &ty, &name)?;
                        self.bind_name(&name, Bound::Value(value, ty.clone(), *changes));
                    }
                    // So is the variable of a loop.
                    _ if !mutable
                        && value.kind == Kind::Value
                        && super::values::is_word(&value.text)
                        && !value.text.is_empty()
                        && value.text.starts_with(|c: char| c.is_ascii_lowercase())
                        && !matches!(value.text.as_str(), "true" | "false") =>
                    {
                        self.bind_name(&name, Bound::Value(value, ty, false));
                    }
                    _ => {
                        let variable = self.variable(&name);
                        let declaration = self.tr.declarator(&ty, &variable)?;
                        let constant = if mutable { "" } else { "const " };
                        self.line(&format!("{constant}{declaration} = {};", value.text()));
                        self.bind_name(&name, Bound::Value(Value::place(variable), ty, mutable));
                    }
                }
            }
            Item::Tuple(_) | Item::Option(..) => return Err(format!("`{name}` would be several values")),
        }
        Ok(())
    }

    /// The conditions under which a pattern matches.
    pub(super) fn conditions_of(&mut self, pattern: &'a syn::Pat, item: &Item, all: &mut Vec<String>) -> Found<()> {
        match (pattern, item) {
            (syn::Pat::Wild(_) | syn::Pat::Rest(_) | syn::Pat::Slice(_), _) => {}
            (syn::Pat::Paren(inner), item) => self.conditions_of(&inner.pat, item, all)?,
            (syn::Pat::Guard(inner), item) => self.conditions_of(&inner.pat, item, all)?,
            (syn::Pat::Lit(literal), Item::Value(value, ty)) => match (&literal.lit, ty) {
                (syn::Lit::Bool(wanted), _) if wanted.value => all.push(value.within(Binding::Comparison)),
                (syn::Lit::Bool(_), _) => all.push(format!("!{}", value.within(Binding::Primary))),
                (syn::Lit::Int(wanted), _) => all.push(format!("{} == {}", value.within(Binding::Sum), wanted.base10_digits())),
                _ => return Err("a literal of another kind".into()),
            },
            (syn::Pat::Ident(ident), item) if self.is_value(ident) => match item {
                Item::Option(condition, _) => all.push(format!("!({condition})")),
                _ => return Err("`None` of no option".into()),
            },
            (syn::Pat::Ident(_), _) => {}
            (syn::Pat::Tuple(tuple), Item::Tuple(items)) => {
                for (pattern, item) in tuple.elems.iter().zip(items) {
                    self.conditions_of(pattern, item, all)?;
                }
            }
            (syn::Pat::Tuple(_), Item::Value(..)) => {}
            (syn::Pat::TupleStruct(_), Item::Option(condition, _)) => {
                if condition != "true" {
                    all.push(condition.clone());
                }
            }
            (syn::Pat::Path(path), Item::Value(value, _)) => all.push(self.is_variant(&path.path, value)?),
            (syn::Pat::Struct(of), Item::Value(value, _)) if names(&of.path).len() == 2 => {
                all.push(self.is_variant(&of.path, value)?);
            }
            (syn::Pat::Struct(_), _) => {}
            _ => return Err("a pattern of another kind".into()),
        }
        Ok(())
    }

    fn is_variant(&mut self, path: &syn::Path, value: &Value) -> Found<String> {
        let all = names(path);
        let [of, variant] = &all[..] else { return Err("a variant of nothing".into()) };
        let item = *self.tr.program.enums.get(of).ok_or("no such enum")?;
        let number = self.tr.variant(of, variant);
        let value = if has_fields(item) { value.member("variant").text } else { value.within(Binding::Sum) };
        Ok(format!("{value} == {number}"))
    }

    /// The condition under which an arm is taken, without its guard; none where it always is.
    pub(super) fn arm(&mut self, pattern: &'a syn::Pat, item: &Item) -> Found<Vec<String>> {
        let (pattern, _) = guarded(pattern);
        let mut all = Vec::new();
        self.conditions_of(pattern, item, &mut all)?;
        Ok(all)
    }

    /// An option: its condition and its content.
    pub(super) fn option(&mut self, value: &'a syn::Expr) -> Found<Item> {
        match value {
            Expr::Paren(inner) => self.option(&inner.expr),
            Expr::Call(call) => {
                if !matches!(&*call.func, Expr::Path(path) if last(&path.path) == "Some") {
                    return Err("an option that a function gives".into());
                }
                let inner = call.args.first().ok_or("`Some` of nothing")?;
                Ok(Item::Option("true".into(), Box::new(self.item(inner)?)))
            }
            Expr::MethodCall(call) => match call.method.to_string().as_str() {
                "get" | "get_mut" => {
                    let argument = call.args.first().ok_or("an argument is missing")?;
                    let view = self.view(&call.receiver)?;
                    let at = self.stable(argument)?;
                    let condition = match (&view.count, at.parse::<usize>()) {
                        (Count::Known(count), Ok(at)) if at < *count => "true".into(),
                        (count, _) => format!("{at} < {}", count.text()),
                    };
                    let ty = Type::to(view.of.clone(), call.method == "get_mut");
                    Ok(Item::Option(condition, Box::new(Item::Value(view.element(&at), ty))))
                }
                "next" => self.next(call),
                "copied" => {
                    let Item::Option(condition, inner) = self.option(&call.receiver)? else { return Err("no option".into()) };
                    let Item::Value(value, ty) = *inner else { return Err("a copy of several values".into()) };
                    Ok(Item::Option(condition, Box::new(Item::Value(value, ty.behind().clone()))))
                }
                other => Err(format!("an option from `{other}`")),
            },
            _ => Err("an option of another kind".into()),
        }
    }

    /// The next item of a stored iterator.
    fn next(&mut self, call: &'a syn::ExprMethodCall) -> Found<Item> {
        let Expr::Path(path) = &*call.receiver else { return Err("`next` of an expression".into()) };
        let name = last(&path.path);
        let Some(Bound::Iterator(of, Some(counter))) = self.lookup(&name)? else {
            return Err(format!("`{name}` is no iterator"));
        };
        let at = self.variable("taken");
        self.line(&format!("const size_t {at} = {counter}++;"));
        let conditions = self.limits(&of, &at)?;
        let item = self.element(&of, &at)?;
        Ok(Item::Option(conditions.join(" && "), Box::new(item)))
    }

    /// `x.get(..n).unwrap_or(x)` and other options with a default.
    pub(super) fn unwrapped(&mut self, call: &'a syn::ExprMethodCall, whole: &'a syn::Expr) -> Found<Value> {
        let default = call.args.first().ok_or("an argument is missing")?;
        let ty = self.ty(whole)?;
        if let Expr::MethodCall(get) = &*call.receiver {
            if let Some(Expr::Range(range)) = get.args.first() {
                let end = range.end.as_ref().ok_or("a range without an end")?;
                let view = self.view(&get.receiver)?;
                let at = self.stable(end)?;
                let all = view.count.text();
                let variable = self.variable("part");
                let ty = Type::to(Type::Slice(Box::new(view.of.clone())), false);
                let declaration = self.tr.declarator(&ty, &variable)?;
                self.line(&format!("const {declaration} = {{{}, {at} <= {all} ? {at} : {all}}};", view.start()));
                return Ok(Value::place(variable));
            }
        }
        let Item::Option(condition, inner) = self.option(&call.receiver)? else { return Err("no option".into()) };
        let Item::Value(value, _) = *inner else { return Err("an option of several values".into()) };
        if matches!(ty, Type::Real | Type::Integer(_) | Type::Bool) {
            let default = self.expression(default)?;
            let text = format!("{condition} ? {} : {}", value.within(Binding::Or), default.within(Binding::Or));
            return Ok(Value::new(text, Binding::Choice));
        }
        let variable = self.variable("known");
        let declaration = self.tr.declarator(&ty, &variable)?;
        self.line(&format!("{declaration};"));
        self.open(&format!("if ({condition})"));
        self.line(&format!("{variable} = {};", value.text()));
        self.otherwise("else");
        self.into(&Value::place(variable.clone()), default)?;
        self.close();
        Ok(Value::place(variable))
    }

    /// The part of a view that starts at an index.
    pub(super) fn shifted(view: &View, by: &str, count: Count) -> View {
        View { offset: Some(sum(view.offset.as_deref(), by)), count, ..view.clone() }
    }

    /// The closure expression of an argument.
    pub(super) fn closure_of(value: &'a syn::Expr) -> Found<&'a syn::ExprClosure> {
        match value {
            Expr::Closure(closure) => Ok(closure),
            Expr::Reference(inner) => Self::closure_of(&inner.expr),
            Expr::Paren(inner) => Self::closure_of(&inner.expr),
            other => Err(format!("no closure at {}", address(other))),
        }
    }
}
