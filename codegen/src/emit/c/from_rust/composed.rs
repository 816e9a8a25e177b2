//! Arrays, tuples and structs: short ones as initialisers, others put together part by part in a variable.

use super::program::names;
use super::scopes::Lower;
use super::statements::bare;
use super::translator::{c_name, has_fields, Found};
use super::types::{Length, Type};
use super::values::{Item, Iter, Value};

impl<'a> Lower<'a, '_> {
    /// Whether a value is put together from parts, and not as an initialiser.
    pub(super) fn is_put_together(&self, value: &syn::Expr) -> Found<bool> {
        Ok(match bare(value) {
            syn::Expr::Array(_) | syn::Expr::Repeat(_) | syn::Expr::Tuple(_) => true,
            syn::Expr::Struct(of) => names(&of.path).len() == 1,
            syn::Expr::MethodCall(call) if call.method == "map" => !matches!(self.ty(&*call.receiver)?, Type::Iterator(_)),
            _ => false,
        })
    }

    pub(super) fn put_together(&mut self, place: &Value, value: &'a syn::Expr) -> Found<()> {
        match bare(value) {
            syn::Expr::Array(array) => {
                for (i, value) in array.elems.iter().enumerate() {
                    self.into(&place.element(&i.to_string()), value)?;
                }
            }
            syn::Expr::Tuple(tuple) => {
                for (i, value) in tuple.elems.iter().enumerate() {
                    self.into(&place.member(&format!("part_{i}")), value)?;
                }
            }
            syn::Expr::Repeat(repeat) => {
                let Type::Array(_, Length::Known(size)) = self.ty(bare(value))? else {
                    return Err("an array of open size".into());
                };
                self.open_names();
                let at = self.variable("i");
                self.open(&format!("for (size_t {at} = 0; {at} < {size}; ++{at})"));
                self.into(&place.element(&at), &repeat.expr)?;
                self.close();
                self.close_names();
            }
            syn::Expr::Struct(of) => {
                if let Some(rest) = &of.rest {
                    self.into(place, rest)?;
                }
                for field in &of.fields {
                    let name = c_name(&super::infer::member(&field.member));
                    let to = place.member(&name);
                    if let Type::Reference(..) = self.ty(&field.expr)? {
                        let found = self.expression(&field.expr)?;
                        self.line(&format!("{} = {};", to.text(), found.pointer()));
                    } else {
                        self.into(&to, &field.expr)?;
                    }
                }
            }
            syn::Expr::MethodCall(call) => {
                let closure = Self::closure_of(call.args.first().ok_or("an argument is missing")?)?;
                let of = self.iterator(&call.receiver)?;
                let of = match of {
                    Iter::View(view, _) => view,
                    _ => return Err("the map of something else than an array".into()),
                };
                self.open_names();
                let at = self.variable("i");
                let count = of.count.text();
                self.open(&format!("for (size_t {at} = 0; {at} < {count}; ++{at})"));
                self.open_scope();
                self.bind_inputs(closure, vec![Item::Value(of.element(&at), of.of.clone())])?;
                self.into(&place.element(&at), &closure.body)?;
                self.close_scope();
                self.close();
                self.close_names();
            }
            _ => return Err("a value of another kind".into()),
        }
        Ok(())
    }

    /// Whether a value is written as an initialiser: arrays, tuples and structs that are short.
    pub(super) fn is_literal(&self, value: &syn::Expr) -> bool {
        fn parts(lower: &Lower<'_, '_>, value: &syn::Expr) -> Option<usize> {
            let all =
                |values: &mut dyn Iterator<Item = &syn::Expr>| values.map(|value| parts(lower, value)).sum::<Option<usize>>();
            match bare(value) {
                syn::Expr::Array(array) if array.elems.is_empty() => None,
                syn::Expr::Array(array) => all(&mut array.elems.iter()),
                syn::Expr::Tuple(tuple) => all(&mut tuple.elems.iter()),
                syn::Expr::Struct(of) if of.rest.is_none() => {
                    let all = all(&mut of.fields.iter().map(|field| &field.expr))?;
                    Some(all)
                }
                syn::Expr::Struct(_) => None,
                syn::Expr::Repeat(repeat) => match lower.ty(bare(value)) {
                    Ok(Type::Array(_, Length::Known(size))) => Some(parts(lower, &repeat.expr)? * size),
                    _ => None,
                },
                syn::Expr::MethodCall(call) if call.method == "map" => None,
                _ => Some(1),
            }
        }
        let value = bare(value);
        let literal = matches!(value, syn::Expr::Array(_) | syn::Expr::Tuple(_) | syn::Expr::Struct(_) | syn::Expr::Repeat(_));
        let most = if matches!(value, syn::Expr::Repeat(_)) { 6 } else { 20 };
        literal && parts(self, value).is_some_and(|parts| parts <= most || self.is_constant_text(value))
    }

    /// Whether a value is a table: nothing but literals.
    fn is_constant_text(&self, value: &syn::Expr) -> bool {
        match bare(value) {
            syn::Expr::Array(array) => array.elems.iter().all(|value| self.is_constant_text(value)),
            syn::Expr::Struct(of) => of.rest.is_none() && of.fields.iter().all(|field| self.is_constant_text(&field.expr)),
            syn::Expr::Lit(_) => true,
            syn::Expr::Path(path) => names(&path.path).len() == 2,
            syn::Expr::Unary(unary) => self.is_constant_text(&unary.expr),
            _ => false,
        }
    }

    pub(super) fn initialiser(&mut self, value: &'a syn::Expr) -> Found<String> {
        let listed = |this: &mut Self, values: Vec<&'a syn::Expr>| {
            values.into_iter().map(|value| this.initialiser(value)).collect::<Found<Vec<_>>>().map(|all| all.join(", "))
        };
        Ok(match bare(value) {
            syn::Expr::Array(array) => format!("{{{{{}}}}}", listed(self, array.elems.iter().collect())?),
            syn::Expr::Tuple(tuple) => format!("{{{}}}", listed(self, tuple.elems.iter().collect())?),
            syn::Expr::Repeat(repeat) => {
                let Type::Array(_, Length::Known(size)) = self.ty(bare(value))? else {
                    return Err("an array of open size".into());
                };
                let one = self.initialiser(&repeat.expr)?;
                format!("{{{{{}}}}}", vec![one; size].join(", "))
            }
            syn::Expr::Struct(of) => self.initialised(of, bare(value))?,
            other => match (self.ty(other)?, self.expression(other)?) {
                (Type::Reference(..), found) => found.pointer(),
                (_, found) => found.text(),
            },
        })
    }

    /// A struct, or a variant with fields, in the order of its fields.
    fn initialised(&mut self, of: &'a syn::ExprStruct, whole: &syn::Expr) -> Found<String> {
        let path = names(&of.path);
        let mut values = Vec::new();
        let fields: Vec<String> = match &path[..] {
            [name, variant] => {
                let item = *self.tr.program.enums.get(name).ok_or("no such enum")?;
                if !has_fields(item) {
                    return Err("a variant without fields".into());
                }
                let ty = self.ty(whole)?;
                self.tr.c_type(&ty)?;
                values.push(self.tr.variant(name, variant));
                item.variants
                    .iter()
                    .flat_map(|v| &v.fields)
                    .filter_map(|field| field.ident.as_ref())
                    .map(ToString::to_string)
                    .collect()
            }
            _ => {
                let ty = self.ty(whole)?;
                self.tr.fields(&ty)?.into_iter().map(|(name, _)| name).collect()
            }
        };
        for field in fields {
            let given = of.fields.iter().find(|given| super::infer::member(&given.member) == field);
            values.push(match given {
                Some(given) => self.initialiser(&given.expr)?,
                None => "0".into(),
            });
        }
        Ok(format!("{{{}}}", values.join(", ")))
    }
}
