//! Iterators as loops over indices.

use super::infer::address;
use super::program::last;
use super::scopes::{Bound, Lower};
use super::translator::Found;
use super::types::Type;
use super::values::{sum, Binding, Count, Item, Iter, Value, View};

impl<'a> Lower<'a, '_> {
    /// The iterator that an expression is, or is made by a loop.
    pub(super) fn iterator(&mut self, value: &'a syn::Expr) -> Found<Iter<'a>> {
        use syn::Expr;
        match value {
            Expr::Paren(inner) => self.iterator(&inner.expr),
            Expr::Range(range) => {
                let (Some(start), Some(end)) = (&range.start, &range.end) else { return Err("a range without ends".into()) };
                let ty = match self.ty(value)? {
                    Type::Iterator(of) => *of,
                    _ => return Err("a range of nothing".into()),
                };
                let start = self.expression(start)?.within(Binding::Sum);
                let end = self.stable(end)?;
                Ok(Iter::Range(start, end, matches!(range.limits, syn::RangeLimits::Closed(_)), ty))
            }
            Expr::Path(path) => {
                if let Some(Bound::Iterator(of, _)) = self.lookup(&last(&path.path))? {
                    return Ok(of);
                }
                self.elements(value)
            }
            Expr::MethodCall(call) if matches!(self.ty(value)?, Type::Iterator(_)) => self.adapted(call),
            Expr::Call(call) if matches!(self.ty(value)?, Type::Iterator(_)) => self.inlined(call, value),
            _ => self.elements(value),
        }
    }

    /// All elements of an array, by reference where the expression is a reference.
    fn elements(&mut self, value: &'a syn::Expr) -> Found<Iter<'a>> {
        let by_reference = matches!(self.ty(value)?, Type::Reference(..));
        Ok(Iter::View(self.view(value)?, !by_reference))
    }

    fn adapted(&mut self, call: &'a syn::ExprMethodCall) -> Found<Iter<'a>> {
        let name = call.method.to_string();
        let inner = |this: &mut Self| this.iterator(&call.receiver).map(Box::new);
        let argument = call.args.first();
        Ok(match (name.as_str(), argument) {
            ("iter" | "iter_mut", _) => Iter::View(self.view(&call.receiver)?, false),
            ("into_iter", _) => self.iterator(&call.receiver)?,
            ("chunks_exact_mut", Some(size)) => {
                let size = self.expression(size)?.text.parse().map_err(|_| "parts of a length that is not known")?;
                Iter::Chunks(self.view(&call.receiver)?, size)
            }
            ("zip", Some(other)) => {
                let inner = inner(self)?;
                Iter::Zip(inner, Box::new(self.iterator(other)?))
            }
            ("enumerate", _) => Iter::Enumerate(inner(self)?),
            ("rev", _) => Iter::Rev(inner(self)?),
            ("copied", _) => inner(self).map(|of| *of)?,
            ("flatten", _) => Iter::Flatten(inner(self)?),
            ("skip", Some(count)) => {
                let inner = inner(self)?;
                Iter::Skip(inner, self.stable(count)?)
            }
            ("take", Some(count)) => {
                let inner = inner(self)?;
                Iter::Take(inner, self.stable(count)?)
            }
            ("map", Some(closure)) => Iter::Map(inner(self)?, Self::closure_of(closure)?),
            ("filter", Some(closure)) => Iter::Filter(inner(self)?, Self::closure_of(closure)?),
            (other, _) => return Err(format!("an iterator from `{other}`")),
        })
    }

    /// The body of a function that returns an iterator, where it is called.
    fn inlined(&mut self, call: &'a syn::ExprCall, whole: &'a syn::Expr) -> Found<Iter<'a>> {
        let (path, _) = self.inferred.calls.get(&address(whole)).ok_or("an iterator from an unknown function")?.clone();
        let function = *self.tr.program.functions.get(&path).ok_or("an iterator from an unknown function")?;
        self.open_scope();
        for (argument, value) in function.signature.inputs.iter().zip(&call.args) {
            let syn::FnArg::Typed(argument) = argument else { return Err("an iterator from a method".into()) };
            let item = self.item(value)?;
            self.bind(&argument.pat, item)?;
        }
        let [syn::Stmt::Expr(value, None)] = function.block.stmts.as_slice() else {
            return Err("an iterator from statements".into());
        };
        let found = self.iterator(value)?;
        self.close_scope();
        Ok(found)
    }

    /// The conditions under which there is an element at an index.
    pub(super) fn limits(&mut self, of: &Iter<'a>, at: &str) -> Found<Vec<String>> {
        let mut known = None;
        let mut all = Vec::new();
        limits(of, at, 0, &mut known, &mut all)?;
        if let Some(known) = known {
            all.push(format!("{at} < {known}"));
        }
        Ok(all)
    }

    /// The element at an index.
    pub(super) fn element(&mut self, of: &Iter<'a>, at: &str) -> Found<Item> {
        Ok(match of {
            Iter::View(view, by_value) => {
                let ty = if *by_value { view.of.clone() } else { Type::to(view.of.clone(), true) };
                Item::Value(view.element(at), ty)
            }
            Iter::Range(start, _, _, ty) => Item::Value(Value::new(sum(Some(start), at), Binding::Sum), ty.clone()),
            Iter::Zip(x, y) => Item::Tuple(vec![self.element(x, at)?, self.element(y, at)?]),
            Iter::Enumerate(inner) => {
                let binding = if super::values::is_word(at) { Binding::Primary } else { Binding::Sum };
                Item::Tuple(vec![Item::Value(Value::new(at, binding), Type::USIZE), self.element(inner, at)?])
            }
            Iter::Skip(inner, by) => self.element(inner, &sum(Some(by), at))?,
            Iter::Take(inner, _) => self.element(inner, at)?,
            Iter::Rev(inner) => {
                let count = count(inner)?;
                self.element(inner, &format!("{count} - 1 - {at}"))?
            }
            Iter::Map(inner, closure) => {
                let item = self.element(inner, at)?;
                self.open_scope();
                self.bind_inputs(closure, vec![item])?;
                let item = self.item(&closure.body)?;
                self.close_scope();
                item
            }
            Iter::Chunks(view, size) => Item::View(Self::shifted(view, &format!("{size} * {at}"), Count::Known(*size))),
            Iter::Filter(..) | Iter::Flatten(_) => return Err("an element of what is filtered".into()),
        })
    }

    /// Binds the arguments of a closure that is inlined at its call.
    pub(super) fn bind_inputs(&mut self, closure: &'a syn::ExprClosure, items: Vec<Item>) -> Found<()> {
        closure.inputs.iter().zip(items).try_for_each(|(pattern, item)| self.bind(pattern, item))
    }

    /// A closure where it is called.
    pub(super) fn applied(&mut self, closure: &'a syn::ExprClosure, items: Vec<Item>) -> Found<Value> {
        self.open_scope();
        self.bind_inputs(closure, items)?;
        let found = self.expression(&closure.body)?;
        self.close_scope();
        Ok(found)
    }

    /// A loop; `hint`: what its variable is called.
    pub(super) fn each(&mut self, of: &Iter<'a>, hint: &str, body: &mut dyn FnMut(&mut Self, Item) -> Found<()>) -> Found<()> {
        match of {
            Iter::Filter(inner, closure) => {
                return self.each(inner, hint, &mut |this, item| {
                    let holds = this.applied(closure, vec![item.clone()])?;
                    this.open(&format!("if (!{})", holds.within(Binding::Primary)));
                    this.line("continue;");
                    this.close();
                    body(this, item)
                });
            }
            Iter::Flatten(inner) => {
                return self.each(inner, "i", &mut |this, item| {
                    let Item::Value(value, ty) = item else { return Err("several values, flattened".into()) };
                    let Type::Array(of, super::types::Length::Known(size)) = ty.behind().clone() else {
                        return Err("what is flattened is no array".into());
                    };
                    let view =
                        View { pointer: value.member("at").text, offset: None, count: Count::Known(size), of: *of, within: None };
                    this.each(&Iter::View(view, false), "j", body)
                });
            }
            Iter::Zip(x, y) if matches!(**x, Iter::Filter(..)) => {
                let counter = self.variable("met");
                self.line(&format!("size_t {counter} = 0;"));
                return self.each(x, hint, &mut |this, item| {
                    let at = this.variable("at");
                    this.line(&format!("const size_t {at} = {counter}++;"));
                    let limits = this.limits(y, &at)?;
                    this.open(&format!("if (!({}))", limits.join(" && ")));
                    this.line("break;");
                    this.close();
                    let other = this.element(y, &at)?;
                    body(this, Item::Tuple(vec![item, other]))
                });
            }
            _ => {}
        }
        let (head, inner, at, plain) = self.head(of, hint)?;
        self.open(&head);
        self.reserve(&at);
        self.open_scope();
        let item = match plain {
            Some(ty) => Item::Value(Value::primary(at), ty),
            None => self.element(inner, &at)?,
        };
        body(self, item)?;
        self.close_scope();
        self.close();
        Ok(())
    }

    /// The head of a loop, the iterator that its variable indexes, and the variable. For a range the variable is the value
    /// itself, with this type.
    #[allow(clippy::type_complexity)]
    fn head<'i>(&mut self, of: &'i Iter<'a>, hint: &str) -> Found<(String, &'i Iter<'a>, String, Option<Type>)> {
        // A name of its own inside of the block that is about to be opened.
        self.open_names();
        let at = self.variable(hint);
        self.close_names();
        Ok(match of {
            Iter::Range(start, end, closed, ty) => {
                let c = self.tr.c_type(ty)?;
                let sign = if *closed { "<=" } else { "<" };
                (format!("for ({c} {at} = {start}; {at} {sign} {end}; ++{at})"), of, at, Some(ty.clone()))
            }
            Iter::Rev(inner) => match &**inner {
                Iter::Range(start, end, false, ty) => {
                    let c = self.tr.c_type(ty)?;
                    (format!("for ({c} {at} = {end}; {at}-- > {start};)"), of, at, Some(ty.clone()))
                }
                inner => (format!("for (size_t {at} = {}; {at}-- > 0;)", count(inner)?), inner, at, None),
            },
            Iter::Skip(inner, by) => {
                let limits = self.limits(inner, &at)?.join(" && ");
                (format!("for (size_t {at} = {by}; {limits}; ++{at})"), inner, at, None)
            }
            _ => {
                let limits = self.limits(of, &at)?.join(" && ");
                (format!("for (size_t {at} = 0; {limits}; ++{at})"), of, at, None)
            }
        })
    }
}

/// The number of elements, where it is one number.
fn count(of: &Iter<'_>) -> Found<String> {
    Ok(match of {
        Iter::View(view, _) => view.count.text(),
        Iter::Enumerate(inner) | Iter::Map(inner, _) | Iter::Rev(inner) => count(inner)?,
        Iter::Zip(x, y) => {
            let (x, y) = (count(x)?, count(y)?);
            match (x.parse::<usize>(), y.parse::<usize>()) {
                (Ok(x), Ok(y)) => x.min(y).to_string(),
                _ if x == y => x,
                _ => return Err("pairs whose number is not known".into()),
            }
        }
        _ => return Err("an iterator whose length is not known".into()),
    })
}

fn limits(of: &Iter<'_>, at: &str, shift: usize, known: &mut Option<usize>, all: &mut Vec<String>) -> Found<()> {
    let mut less = |limit: usize| *known = Some(known.map_or(limit, |known| known.min(limit)));
    match of {
        Iter::View(view, _) => match &view.count {
            Count::Known(count) => less(count.saturating_sub(shift)),
            Count::Text(count) => all.push(format!("{} < {count}", shifted(at, shift))),
        },
        Iter::Range(start, end, closed, _) => {
            let sign = if *closed { "<=" } else { "<" };
            all.push(format!("{} {sign} {end}", sum(Some(start), &shifted(at, shift))));
        }
        Iter::Chunks(view, size) => match &view.count {
            Count::Known(count) => less((count / size).saturating_sub(shift)),
            Count::Text(_) => return Err("parts of an array whose length is not known".into()),
        },
        Iter::Zip(x, y) => {
            limits(x, at, shift, known, all)?;
            limits(y, at, shift, known, all)?;
        }
        Iter::Enumerate(inner) | Iter::Map(inner, _) | Iter::Rev(inner) => limits(inner, at, shift, known, all)?,
        Iter::Take(inner, count) => {
            match count.parse::<usize>() {
                Ok(count) => less(count.saturating_sub(shift)),
                Err(_) => all.push(format!("{} < {count}", shifted(at, shift))),
            }
            limits(inner, at, shift, known, all)?;
        }
        Iter::Skip(inner, by) => match by.parse::<usize>() {
            Ok(by) => limits(inner, at, shift + by, known, all)?,
            Err(_) => {
                let mut inside = None;
                let at = sum(Some(by), at);
                limits(inner, &at, shift, &mut inside, all)?;
                if let Some(inside) = inside {
                    all.push(format!("{at} < {inside}"));
                }
            }
        },
        Iter::Filter(..) | Iter::Flatten(_) => return Err("the length of what is filtered".into()),
    }
    Ok(())
}

fn shifted(at: &str, shift: usize) -> String {
    sum(Some(&shift.to_string()), at)
}
