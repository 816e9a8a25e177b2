//! Calls: functions of the program, closures, and what Rust's library has that C has not.

use super::infer::address;
use super::lower::is_callable;
use super::program::{last, names};
use super::scopes::{Bound, Lower};
use super::translator::Found;
use super::types::{Length, Type};
use super::values::{Binding, Count, Item, Value};

impl<'a> Lower<'a, '_> {
    /// An argument for a function that asks for this type; none where nothing is handed over.
    fn argument(&mut self, value: &'a syn::Expr, wanted: &Type) -> Found<Option<String>> {
        Ok(match wanted {
            Type::Reference(to, _) if matches!(**to, Type::Slice(_)) => Some(self.slice(value, wanted)?),
            Type::Reference(to, _) => {
                let found = self.expression(value)?;
                Some(self.placed(found, to, "value")?.pointer())
            }
            Type::Closure(_) | Type::Function(_) => None,
            _ => Some(self.expression(value)?.text()),
        })
    }

    pub(super) fn call(&mut self, call: &'a syn::ExprCall, whole: &'a syn::Expr) -> Found<Value> {
        let syn::Expr::Path(path) = &*call.func else { return Err("a call of an expression".into()) };
        let all = names(&path.path);
        if let [name] = &all[..] {
            match self.lookup(name)? {
                Some(Bound::Closure(id, captured)) => return self.call_of_closure(id, captured, call),
                Some(Bound::Function(_)) => return self.call_of_function(address(call), None, call.args.iter().collect()),
                Some(_) => return Err(format!("`{name}` cannot be called")),
                None => {}
            }
        }
        if let [of, name] = &all[..] {
            if let Some(found) = self.call_of_library(of, name, call, whole)? {
                return Ok(found);
            }
        }
        self.call_of_function(address(whole), None, call.args.iter().collect())
    }

    fn call_of_library(&mut self, of: &str, name: &str, call: &'a syn::ExprCall, whole: &'a syn::Expr) -> Found<Option<Value>> {
        let robot = self.tr.name.clone();
        let first = call.args.first();
        Ok(match (of, name, first) {
            ("libm", "sincos" | "sincosf", Some(angle)) => {
                let angle = self.expression(angle)?.text();
                let ty = self.ty(whole)?;
                let variable = self.variable("wave");
                let declaration = self.tr.declarator(&ty, &variable)?;
                self.line(&format!("{declaration};"));
                self.line(&format!("{robot}_libm_sin_cos({angle}, &{variable}.part_0, &{variable}.part_1);"));
                Some(Value::place(variable))
            }
            ("libm", name, _) => {
                let name = name.strip_suffix('f').filter(|_| self.tr.program.is_single()).unwrap_or(name);
                let values = call.args.iter().map(|value| self.expression(value)).collect::<Found<Vec<_>>>()?;
                let values: Vec<String> = values.iter().map(Value::text).collect();
                Some(Value::primary(format!("{robot}_libm_{name}({})", values.join(", "))))
            }
            ("Real", "from_bits", Some(bits)) => {
                let bits = self.expression(bits)?.text();
                Some(Value::primary(format!("{robot}_from_bits({bits})")))
            }
            (of, "from", Some(value)) if Type::integer(of).is_some() => {
                let found = self.expression(value)?;
                let to = self.ty(whole)?;
                Some(self.cast(&to, &found)?)
            }
            _ => None,
        })
    }

    fn call_of_closure(&mut self, id: usize, captured: Option<String>, call: &'a syn::ExprCall) -> Found<Value> {
        let callable = self.tr.callables.get(&id).cloned().ok_or("a closure that is not known")?;
        let inputs = self.tr.closures[id].inputs.clone();
        let mut arguments: Vec<String> = captured.into_iter().collect();
        for (value, wanted) in call.args.iter().zip(&inputs) {
            arguments.extend(self.argument(value, wanted)?);
        }
        Ok(Value::primary(format!("{}({})", callable.function, arguments.join(", "))))
    }

    /// A call of a function of the program, known by the address of the call.
    fn call_of_function(&mut self, at: usize, receiver: Option<&'a syn::Expr>, arguments: Vec<&'a syn::Expr>) -> Found<Value> {
        let (path, sizes) = self.inferred.calls.get(&at).cloned().ok_or("a call of an unknown function")?;
        let function = *self.tr.program.functions.get(&path).ok_or("a call of an unknown function")?;
        let values: Vec<&'a syn::Expr> = receiver.into_iter().chain(arguments).collect();
        // Functions passed as arguments are part of the callee's identity: each combination is translated separately.
        let mut given = Vec::new();
        let mut handed = Vec::new();
        for (place, (input, value)) in function.signature.inputs.iter().zip(&values).enumerate() {
            if !is_callable(input) {
                handed.push(None);
                continue;
            }
            let hint = match input {
                syn::FnArg::Typed(argument) => match &*argument.pat {
                    syn::Pat::Ident(ident) => ident.ident.to_string(),
                    _ => "function".into(),
                },
                syn::FnArg::Receiver(_) => "function".into(),
            };
            match self.callable(value, &hint)? {
                Bound::Closure(id, captured) => {
                    given.push((place, Type::Closure(id)));
                    handed.push(Some(captured));
                }
                Bound::Function(path) => {
                    given.push((place, Type::Function(path)));
                    handed.push(Some(None));
                }
                _ => return Err("an argument that cannot be called".into()),
            }
        }
        let instance = self.tr.instance(&path, sizes, given)?;
        let mut texts = Vec::new();
        for ((value, wanted), handed) in values.iter().zip(&instance.inputs).zip(handed) {
            match handed {
                Some(captured) => texts.extend(captured),
                None => texts.extend(self.argument(value, wanted)?),
            }
        }
        Ok(Value::primary(format!("{}({})", instance.name, texts.join(", "))))
    }

    /// A function that is handed to another.
    fn callable(&mut self, value: &'a syn::Expr, hint: &str) -> Found<Bound<'a>> {
        match value {
            syn::Expr::Reference(inner) => self.callable(&inner.expr, hint),
            syn::Expr::Paren(inner) => self.callable(&inner.expr, hint),
            syn::Expr::Closure(closure) => self.lifted(closure, hint),
            syn::Expr::Path(path) => {
                let name = last(&path.path);
                Ok(match self.lookup(&name)? {
                    Some(bound) => bound,
                    None => Bound::Function(name),
                })
            }
            _ => Err("a function of another kind".into()),
        }
    }

    pub(super) fn method(&mut self, call: &'a syn::ExprMethodCall, whole: &'a syn::Expr) -> Found<Value> {
        let receiver = self.ty(&*call.receiver)?;
        match receiver.behind() {
            Type::Named(..) => self.call_of_function(address(whole), Some(&call.receiver), call.args.iter().collect()),
            Type::Real | Type::Integer(_) => self.of_number(call),
            Type::Option(_) => self.of_option(call, whole),
            Type::Iterator(_) => self.of_iterator(call, whole),
            Type::Array(..) | Type::Slice(_) => self.of_array(call, whole),
            other => Err(format!("a method of {other:?}")),
        }
    }

    fn of_number(&mut self, call: &'a syn::ExprMethodCall) -> Found<Value> {
        let found = self.expression(&call.receiver)?;
        let name = call.method.to_string();
        let mut arguments = Vec::new();
        for value in &call.args {
            arguments.push(self.expression(value)?);
        }
        if let ("wrapping_sub" | "wrapping_add", [other]) = (name.as_str(), &arguments[..]) {
            let sign = if name == "wrapping_sub" { "-" } else { "+" };
            let text = format!("{} {sign} {}", found.within(Binding::Sum), other.within(Binding::Product));
            return Ok(Value::new(text, Binding::Sum));
        }
        let robot = &self.tr.name;
        let name = if name == "to_bits" { "bits" } else { &name };
        let all: Vec<String> = std::iter::once(&found).chain(&arguments).map(Value::text).collect();
        Ok(Value::primary(format!("{robot}_{name}({})", all.join(", "))))
    }

    fn of_option(&mut self, call: &'a syn::ExprMethodCall, whole: &'a syn::Expr) -> Found<Value> {
        match call.method.to_string().as_str() {
            "unwrap_or" => self.unwrapped(call, whole),
            "map_or" => {
                let (Some(default), Some(closure)) = (call.args.first(), call.args.last()) else {
                    return Err("no default".into());
                };
                let Item::Option(condition, inner) = self.option(&call.receiver)? else { return Err("no option".into()) };
                let default = self.expression(default)?;
                let found = self.applied(Self::closure_of(closure)?, vec![*inner])?;
                let text = format!("{condition} ? {} : {}", found.within(Binding::Or), default.within(Binding::Or));
                Ok(Value::new(text, Binding::Choice))
            }
            "is_some_and" => self.found_and(call),
            other => Err(format!("an option's `{other}`")),
        }
    }

    /// `iterator.find(p).is_some_and(f)`.
    fn found_and(&mut self, call: &'a syn::ExprMethodCall) -> Found<Value> {
        let syn::Expr::MethodCall(find) = &*call.receiver else { return Err("an option of another kind".into()) };
        let (Some(wanted), Some(then)) = (find.args.first(), call.args.first()) else {
            return Err("an argument is missing".into());
        };
        let (wanted, then) = (Self::closure_of(wanted)?, Self::closure_of(then)?);
        let of = self.iterator(&find.receiver)?;
        let variable = self.variable("holds");
        self.line(&format!("bool {variable} = false;"));
        self.each(&of, "i", &mut |this, item| {
            let met = this.applied(wanted, vec![item.clone()])?;
            this.open(&format!("if ({})", met.text()));
            let holds = this.applied(then, vec![item])?;
            this.line(&format!("{variable} = {};", holds.text()));
            this.line("break;");
            this.close();
            Ok(())
        })?;
        Ok(Value::primary(variable))
    }

    fn of_iterator(&mut self, call: &'a syn::ExprMethodCall, whole: &'a syn::Expr) -> Found<Value> {
        let of = self.iterator(&call.receiver)?;
        match (call.method.to_string().as_str(), call.args.first()) {
            ("fold", Some(start)) => {
                let ty = self.ty(whole)?;
                let closure = Self::closure_of(call.args.last().ok_or("an argument is missing")?)?;
                let variable = self.declared("sum", &ty, true, start)?;
                self.each(&of, "i", &mut |this, item| {
                    let so_far = Item::Value(Value::primary(variable.clone()), ty.clone());
                    let found = this.applied(closure, vec![so_far, item])?;
                    this.line(&format!("{variable} = {};", found.text()));
                    Ok(())
                })?;
                Ok(Value::primary(variable))
            }
            (name @ ("any" | "all"), Some(closure)) => {
                let closure = Self::closure_of(closure)?;
                let any = name == "any";
                let variable = self.variable(name);
                self.line(&format!("bool {variable} = {};", !any));
                self.each(&of, "i", &mut |this, item| {
                    let found = this.applied(closure, vec![item])?;
                    let test = if any { found.text() } else { format!("!{}", found.within(Binding::Primary)) };
                    this.open(&format!("if ({test})"));
                    this.line(&format!("{variable} = {any};"));
                    this.line("break;");
                    this.close();
                    Ok(())
                })?;
                Ok(Value::primary(variable))
            }
            ("count", None) => {
                let variable = self.variable("number");
                self.line(&format!("size_t {variable} = 0;"));
                self.each(&of, "i", &mut |this, _| {
                    this.line(&format!("{variable} += 1;"));
                    Ok(())
                })?;
                Ok(Value::primary(variable))
            }
            (other, _) => Err(format!("an iterator's `{other}`")),
        }
    }

    fn of_array(&mut self, call: &'a syn::ExprMethodCall, whole: &'a syn::Expr) -> Found<Value> {
        let name = call.method.to_string();
        let nothing = Value::primary("");
        match (name.as_str(), &call.args.iter().collect::<Vec<_>>()[..]) {
            ("map", _) => {
                let ty = self.ty(whole)?;
                Ok(Value::place(self.declared("mapped", &ty, false, whole)?))
            }
            ("len", _) => Ok(Value::primary(self.view(&call.receiver)?.count.text())),
            ("swap", [x, y]) => {
                let view = self.view(&call.receiver)?;
                let (x, y) = (self.expression(x)?.text(), self.expression(y)?.text());
                let (x, y) = (view.element(&x).text, view.element(&y).text);
                let variable = self.variable("swapped");
                let declaration = self.tr.declarator(&view.of, &variable)?;
                self.line(&format!("const {declaration} = {x};"));
                self.line(&format!("{x} = {y};"));
                self.line(&format!("{y} = {variable};"));
                Ok(nothing)
            }
            ("copy_from_slice", [from]) => {
                let (to, from) = (self.view(&call.receiver)?, self.view(from)?);
                self.open_names();
                let at = self.variable("i");
                self.open(&format!("for (size_t {at} = 0; {at} < {}; ++{at})", to.count.text()));
                self.line(&format!("{} = {};", to.element(&at).text, from.element(&at).text));
                self.close();
                self.close_names();
                Ok(nothing)
            }
            ("rotate_right", [by]) => {
                let by = self.expression(by)?.text();
                let found = self.expression(&call.receiver)?;
                let ty = self.ty(&*call.receiver)?.behind().clone();
                let Type::Array(_, Length::Known(size)) = ty else { return Err("a slice that is turned".into()) };
                let variable = self.variable("before");
                let declaration = self.tr.declarator(&ty, &variable)?;
                self.line(&format!("const {declaration} = {};", found.text()));
                self.open_names();
                let at = self.variable("i");
                self.open(&format!("for (size_t {at} = 0; {at} < {size}; ++{at})"));
                let to = found.element(&format!("({at} + {by}) % {size}"));
                self.line(&format!("{} = {};", to.text, Value::place(variable).element(&at).text));
                self.close();
                self.close_names();
                Ok(nothing)
            }
            ("contains", [wanted]) => {
                let view = self.view(&call.receiver)?;
                let wanted = self.expression(wanted)?;
                let Count::Known(size) = view.count else { return Err("a slice that is searched".into()) };
                let one = |i: usize| format!("{} == {}", view.element(&i.to_string()).text, wanted.within(Binding::Sum));
                let all: Vec<String> = (0..size).map(one).collect();
                Ok(Value::new(all.join(" || "), Binding::Or))
            }
            (other, _) => Err(format!("an array's `{other}`")),
        }
    }
}
