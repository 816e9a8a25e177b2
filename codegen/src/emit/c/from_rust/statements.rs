//! Statements, and values that choices give.

use super::program::guarded;
use super::scopes::{Bound, Lower};
use super::translator::Found;
use super::types::{Integer, Type};
use super::values::{Binding, Item, Iter, Value};

/// Where the value of a block goes.
#[derive(Clone)]
enum Goal {
    /// Nowhere.
    Nothing,
    /// Into a place.
    Place(Value),
    /// To the caller, as this type.
    Return(Type),
}

impl<'a> Lower<'a, '_> {
    pub(super) fn returned_block(&mut self, block: &'a syn::Block, output: &Type) -> Found<()> {
        self.block(block, &Goal::Return(output.clone()))
    }

    pub(super) fn returned(&mut self, value: &'a syn::Expr, output: &Type) -> Found<()> {
        self.goal(value, &Goal::Return(output.clone()))
    }

    /// Writes a value into a place that nothing of it reads.
    pub(super) fn into(&mut self, place: &Value, value: &'a syn::Expr) -> Found<()> {
        self.goal(value, &Goal::Place(place.clone()))
    }

    fn block(&mut self, block: &'a syn::Block, goal: &Goal) -> Found<()> {
        self.open_scope();
        let count = block.stmts.len();
        for (i, statement) in block.stmts.iter().enumerate() {
            match statement {
                syn::Stmt::Local(local) => self.local(local)?,
                syn::Stmt::Item(_) => {}
                syn::Stmt::Expr(value, None) if i + 1 == count => self.goal(value, goal)?,
                syn::Stmt::Expr(value, _) => self.goal(value, &Goal::Nothing)?,
                syn::Stmt::Macro(_) => return Err("a macro".into()),
            }
        }
        self.close_scope();
        Ok(())
    }

    fn goal(&mut self, value: &'a syn::Expr, goal: &Goal) -> Found<()> {
        use syn::Expr;
        match (value, goal) {
            (Expr::Paren(inner), _) => self.goal(&inner.expr, goal),
            (Expr::Block(block), _) => self.block(&block.block, goal),
            (Expr::If(choice), _) => match self.ternary(value)? {
                Some(found) if !matches!(goal, Goal::Nothing) => self.given(found, goal),
                _ => self.branches(choice, goal),
            },
            (Expr::Match(choice), _) => self.arms(choice, goal),
            (Expr::ForLoop(each), _) => self.for_loop(each),
            (Expr::While(each), _) => self.while_loop(each),
            (Expr::Continue(_), _) => {
                self.line("continue;");
                Ok(())
            }
            (Expr::Break(_), _) => {
                self.line("break;");
                Ok(())
            }
            (Expr::Return(found), _) => match &found.expr {
                None => {
                    self.line("return;");
                    Ok(())
                }
                Some(value) => {
                    let ty = self.ty(&**value)?;
                    self.goal(value, &Goal::Return(ty))
                }
            },
            (Expr::Assign(assign), _) => self.assign(assign),
            (Expr::Binary(binary), Goal::Nothing) => self.assign_operation(binary),
            (Expr::Tuple(tuple), Goal::Nothing) if tuple.elems.is_empty() => Ok(()),
            (_, Goal::Place(place)) if self.is_put_together(value)? => self.put_together(place, value),
            _ => {
                if let Goal::Return(Type::Reference(to, _)) = goal {
                    if matches!(**to, Type::Slice(_)) {
                        let ty = Type::Reference(to.clone(), false);
                        let text = self.slice(value, &ty)?;
                        self.line(&format!("return {text};"));
                        return Ok(());
                    }
                }
                let found = self.expression(value)?;
                self.given(found, goal)
            }
        }
    }

    fn given(&mut self, found: Value, goal: &Goal) -> Found<()> {
        match goal {
            Goal::Nothing | Goal::Return(Type::Unit) => {
                if !found.text.is_empty() {
                    self.line(&format!("{};", found.text()));
                }
            }
            Goal::Place(place) => self.line(&format!("{} = {};", place.text(), found.text())),
            Goal::Return(ty) => {
                let text = match ty {
                    Type::Reference(..) => found.pointer(),
                    _ => found.text(),
                };
                self.line(&format!("return {text};"));
            }
        }
        Ok(())
    }

    fn local(&mut self, local: &'a syn::Local) -> Found<()> {
        let pattern = match &local.pat {
            syn::Pat::Type(typed) => &*typed.pat,
            pattern => pattern,
        };
        let init = local.init.as_ref().ok_or("a variable without a value")?;
        if let Some((_, otherwise)) = &init.diverge {
            let item = self.item(&init.expr)?;
            let conditions = self.arm(pattern, &item)?;
            if !conditions.is_empty() {
                self.open(&format!("if (!({}))", conditions.join(" && ")));
                self.goal(otherwise, &Goal::Nothing)?;
                self.close();
            }
            return self.bind(pattern, item);
        }
        self.let_be(pattern, &init.expr)
    }

    /// `let pattern = value`.
    fn let_be(&mut self, pattern: &'a syn::Pat, value: &'a syn::Expr) -> Found<()> {
        match (pattern, value) {
            (syn::Pat::Ident(ident), _) => {
                let bound = self.bound(ident, value)?;
                self.bind_name(&ident.ident.to_string(), bound);
                Ok(())
            }
            (syn::Pat::Tuple(pattern), syn::Expr::Tuple(values)) => {
                // All values before any name.
                let mut names = Vec::new();
                for (pattern, value) in pattern.elems.iter().zip(&values.elems) {
                    match pattern {
                        syn::Pat::Ident(ident) => {
                            let bound = self.bound(ident, value)?;
                            names.push((ident.ident.to_string(), bound));
                        }
                        _ => self.let_be(pattern, value)?,
                    }
                }
                for (name, bound) in names {
                    self.bind_name(&name, bound);
                }
                Ok(())
            }
            _ => {
                let item = self.item(value)?;
                self.bind(pattern, item)
            }
        }
    }

    /// The binding of a name.
    fn bound(&mut self, ident: &'a syn::PatIdent, value: &'a syn::Expr) -> Found<Bound<'a>> {
        let ty = self.ty(ident)?;
        let name = ident.ident.to_string();
        let mutable = ident.mutability.is_some();
        match &ty {
            Type::Closure(_) => self.lifted(Self::closure_of(value)?, &name),
            Type::Iterator(_) => {
                let of = self.iterator(value)?;
                let counter = if mutable {
                    let counter = self.variable(&format!("{name}_taken"));
                    self.line(&format!("size_t {counter} = 0;"));
                    Some(counter)
                } else {
                    None
                };
                Ok(Bound::Iterator(of, counter))
            }
            Type::Reference(to, _) if matches!(**to, Type::Slice(_)) => Ok(Bound::View(self.view(value)?)),
            Type::Reference(_, changes) if !mutable => {
                let found = self.expression(value)?;
                let found = self.placed(found, &ty, &name)?;
                Ok(Bound::Value(found, ty.clone(), *changes))
            }
            _ => {
                let variable = self.declared(&name, &ty, mutable, value)?;
                Ok(Bound::Value(Value::place(variable), ty, mutable))
            }
        }
    }

    /// A new variable with a value.
    pub(super) fn declared(&mut self, hint: &str, ty: &Type, mutable: bool, value: &'a syn::Expr) -> Found<String> {
        let value = bare(value);
        if let Some(found) = self.ternary(value)? {
            return self.with_value(hint, ty, mutable, &found.text());
        }
        if self.is_literal(value) {
            let text = self.initialiser(value)?;
            return self.with_value(hint, ty, mutable, &text);
        }
        if matches!(value, syn::Expr::If(_) | syn::Expr::Match(_) | syn::Expr::Block(_)) || self.is_put_together(value)? {
            let variable = self.variable(hint);
            let declaration = self.tr.declarator(ty, &variable)?;
            self.line(&format!("{declaration};"));
            self.into(&Value::place(variable.clone()), value)?;
            return Ok(variable);
        }
        let found = self.expression(value)?.text();
        self.with_value(hint, ty, mutable, &found)
    }

    fn with_value(&mut self, hint: &str, ty: &Type, mutable: bool, text: &str) -> Found<String> {
        let variable = self.variable(hint);
        let declaration = self.tr.declarator(ty, &variable)?;
        let constant = if mutable || declaration.contains('*') { "" } else { "const " };
        self.line(&format!("{constant}{declaration} = {text};"));
        Ok(variable)
    }

    /// `c ? x : y` for numbers, where neither needs statements.
    fn ternary(&mut self, value: &'a syn::Expr) -> Found<Option<Value>> {
        let syn::Expr::If(choice) = bare(value) else { return Ok(None) };
        let (Some((_, otherwise)), Ok(ty)) = (&choice.else_branch, self.ty(bare(value))) else { return Ok(None) };
        if !matches!(ty, Type::Real | Type::Integer(_) | Type::Bool) || matches!(&*choice.cond, syn::Expr::Let(_)) {
            return Ok(None);
        }
        let (Some(first), Some(second)) = (only(&choice.then_branch), only_of(otherwise)) else { return Ok(None) };
        let condition = self.expression(&choice.cond)?;
        let mut sides = Vec::new();
        for side in [first, second] {
            let (statements, found) = self
                .apart(|this| match this.ternary(side)? {
                    Some(found) => Ok(found),
                    None if matches!(bare(side), syn::Expr::If(_) | syn::Expr::Match(_)) => Err(String::new()),
                    None => this.expression(side),
                })
                .or_else(|error| if error.is_empty() { Ok(("no".into(), Value::primary(""))) } else { Err(error) })?;
            if !statements.is_empty() {
                return Ok(None);
            }
            sides.push(found);
        }
        let condition = condition.within(Binding::Or);
        let text = format!("{condition} ? {} : {}", sides[0].within(Binding::Or), sides[1].within(Binding::Or));
        let found = Value::new(text, Binding::Choice);
        Ok(Some(if ty == Type::Integer(Integer::U16) { self.cast(&ty, &found)? } else { found }))
    }

    /// The value of a choice or a block.
    pub(super) fn chosen(&mut self, value: &'a syn::Expr) -> Found<Value> {
        if let Some(found) = self.ternary(value)? {
            return Ok(found);
        }
        let ty = self.ty(value)?;
        if ty == Type::Unit {
            self.goal(value, &Goal::Nothing)?;
            return Ok(Value::primary(""));
        }
        Ok(Value::place(self.declared("chosen", &ty, false, value)?))
    }

    fn branches(&mut self, choice: &'a syn::ExprIf, goal: &Goal) -> Found<()> {
        self.open_scope();
        let (conditions, bound) = match &*choice.cond {
            syn::Expr::Let(test) => {
                let item = self.item(&test.expr)?;
                (self.arm(&test.pat, &item)?, Some((&*test.pat, item)))
            }
            condition => {
                let found = self.expression(condition)?;
                (vec![found.text()], None)
            }
        };
        let condition = if conditions.is_empty() { "true".into() } else { conditions.join(" && ") };
        self.open(&format!("if ({condition})"));
        if let Some((pattern, item)) = bound {
            self.bind(pattern, item)?;
        }
        self.block(&choice.then_branch, goal)?;
        self.close_scope();
        if let Some((_, otherwise)) = &choice.else_branch {
            self.alternative(otherwise, goal)?;
        }
        self.close();
        Ok(())
    }

    /// The `else` branch; `else if` where its condition needs no statements.
    fn alternative(&mut self, otherwise: &'a syn::Expr, goal: &Goal) -> Found<()> {
        if let syn::Expr::If(choice) = otherwise {
            if !matches!(&*choice.cond, syn::Expr::Let(_)) {
                let (statements, condition) = self.apart(|this| this.expression(&choice.cond))?;
                if statements.is_empty() {
                    self.otherwise(&format!("else if ({})", condition.text()));
                    self.block(&choice.then_branch, goal)?;
                    if let Some((_, otherwise)) = &choice.else_branch {
                        self.alternative(otherwise, goal)?;
                    }
                    return Ok(());
                }
            }
        }
        self.otherwise("else");
        self.goal(otherwise, goal)
    }

    fn arms(&mut self, choice: &'a syn::ExprMatch, goal: &Goal) -> Found<()> {
        let item = match self.item(&choice.expr)? {
            Item::Value(value, ty) => Item::Value(self.placed(value, &ty, "found")?, ty),
            other => other,
        };
        let count = choice.arms.len();
        let mut open = false;
        for (i, arm) in choice.arms.iter().enumerate() {
            let mut conditions = self.arm(&arm.pat, &item)?;
            let (_, guard) = guarded(&arm.pat);
            if let Some(guard) = guard {
                let (statements, holds) = self.apart(|this| this.expression(guard))?;
                if !statements.is_empty() {
                    return Err("a guard that needs statements".into());
                }
                conditions.push(holds.within(Binding::Comparison));
            }
            // The last arm is taken whatever is left.
            let last = i + 1 == count && guard.is_none();
            let nothing = matches!(&*arm.body, syn::Expr::Block(block) if block.block.stmts.is_empty());
            if last && nothing && open {
                break;
            }
            let condition = conditions.join(" && ");
            match (open, last || condition.is_empty()) {
                (false, true) => self.open(""),
                (false, false) => self.open(&format!("if ({condition})")),
                (true, true) => self.otherwise("else"),
                (true, false) => self.otherwise(&format!("else if ({condition})")),
            }
            open = true;
            self.open_scope();
            self.bind(&arm.pat, item.clone())?;
            self.goal(&arm.body, goal)?;
            self.close_scope();
        }
        if open {
            self.close();
        }
        Ok(())
    }

    fn for_loop(&mut self, each: &'a syn::ExprForLoop) -> Found<()> {
        // A scope of its own hides the variables of the iterator.
        self.open_scope();
        let of = self.iterator(&each.expr)?;
        let hint = hint(&each.pat, &of);
        self.each(&of, &hint, &mut |this, item| {
            this.bind(&each.pat, item)?;
            this.block(&each.body, &Goal::Nothing)
        })?;
        self.close_scope();
        Ok(())
    }

    fn while_loop(&mut self, each: &'a syn::ExprWhile) -> Found<()> {
        let (statements, condition) = self.apart(|this| this.expression(&each.cond))?;
        if statements.is_empty() {
            self.open(&format!("while ({})", condition.text()));
        } else {
            self.open("for (;;)");
            let condition = self.expression(&each.cond)?;
            self.open(&format!("if (!{})", condition.within(Binding::Primary)));
            self.line("break;");
            self.close();
        }
        self.block(&each.body, &Goal::Nothing)?;
        self.close();
        Ok(())
    }

    fn assign(&mut self, assign: &'a syn::ExprAssign) -> Found<()> {
        if let (syn::Expr::Tuple(left), right) = (&*assign.left, &*assign.right) {
            return self.assign_all(left, right);
        }
        let ty = self.ty(&*assign.left)?;
        if let (Type::Option(_), syn::Expr::Call(call)) = (&ty, &*assign.right) {
            let found = self.expression(call.args.first().ok_or("`Some` of nothing")?)?;
            let left = self.expression(&assign.left)?;
            self.line(&format!("{} = {};", left.text(), found.pointer()));
            return Ok(());
        }
        let left = self.expression(&assign.left)?;
        // An aggregate may read the value that it replaces, so it is built first.
        let right = if self.is_put_together(&assign.right)? {
            Value::place(self.declared("value", &ty, false, &assign.right)?)
        } else {
            self.expression(&assign.right)?
        };
        self.line(&format!("{} = {};", left.text(), right.text()));
        Ok(())
    }

    /// `(a, b) = (x, y)`: all values before any is assigned.
    fn assign_all(&mut self, left: &'a syn::ExprTuple, right: &'a syn::Expr) -> Found<()> {
        let mut values = Vec::new();
        match bare(right) {
            syn::Expr::Tuple(right) => {
                for (left, value) in left.elems.iter().zip(&right.elems) {
                    if let (Type::Option(_), syn::Expr::Call(call)) = (self.ty(left)?, value) {
                        let found = self.expression(call.args.first().ok_or("`Some` of nothing")?)?;
                        values.push(Value::primary(found.pointer()));
                        continue;
                    }
                    let ty = self.ty(value)?;
                    let literal = matches!(value, syn::Expr::Lit(_));
                    values.push(match literal {
                        true => self.expression(value)?,
                        false => Value::place(self.declared("next", &ty, false, value)?),
                    });
                }
            }
            right => {
                let ty = self.ty(right)?;
                let found = self.expression(right)?;
                let found = self.placed(found, &ty, "result")?;
                values.extend((0..left.elems.len()).map(|i| found.member(&format!("part_{i}"))));
            }
        }
        for (left, value) in left.elems.iter().zip(values) {
            if matches!(left, syn::Expr::Infer(_)) {
                continue;
            }
            let left = self.expression(left)?;
            self.line(&format!("{} = {};", left.text(), value.text()));
        }
        Ok(())
    }

    fn assign_operation(&mut self, binary: &'a syn::ExprBinary) -> Found<()> {
        use syn::BinOp::*;
        let ty = self.ty(&*binary.left)?.behind().clone();
        let right = self.expression(&binary.right)?;
        let left = self.expression(&binary.left)?;
        let sign = match binary.op {
            AddAssign(_) => "+",
            SubAssign(_) => "-",
            MulAssign(_) => "*",
            DivAssign(_) => "/",
            BitAndAssign(_) => "&",
            BitOrAssign(_) => "|",
            ShlAssign(_) => "<<",
            ShrAssign(_) => ">>",
            _ => return Err("an operator of another kind".into()),
        };
        let left = left.text();
        match (ty, sign) {
            (Type::Bool, "|") => self.line(&format!("{left} = {} || {left};", right.within(Binding::Comparison))),
            (Type::Bool, _) => self.line(&format!("{left} = {} && {left};", right.within(Binding::Comparison))),
            (ty @ Type::Integer(Integer::U16), _) => {
                let found = Value::new(format!("{left} {sign} {}", right.within(Binding::Unary)), Binding::Bits);
                let found = self.cast(&ty, &found)?;
                self.line(&format!("{left} = {};", found.text()));
            }
            _ if right.text == "1" && sign == "+" => self.line(&format!("{left} += 1;")),
            _ => self.line(&format!("{left} {sign}= {};", right.text())),
        }
        Ok(())
    }
}

/// An expression without brackets.
pub(super) fn bare(value: &syn::Expr) -> &syn::Expr {
    match value {
        syn::Expr::Paren(inner) => bare(&inner.expr),
        syn::Expr::Group(inner) => bare(&inner.expr),
        other => other,
    }
}

/// The value of a block of nothing else.
fn only(block: &syn::Block) -> Option<&syn::Expr> {
    match block.stmts.as_slice() {
        [syn::Stmt::Expr(value, None)] => Some(value),
        _ => None,
    }
}

fn only_of(value: &syn::Expr) -> Option<&syn::Expr> {
    match value {
        syn::Expr::Block(block) => only(&block.block),
        other => Some(other),
    }
}

/// Name of the variable of a loop.
fn hint(pattern: &syn::Pat, of: &Iter<'_>) -> String {
    let ident = |pattern: &syn::Pat| match pattern {
        syn::Pat::Ident(ident) => Some(ident.ident.to_string()),
        _ => None,
    };
    let found = match (of, pattern) {
        (Iter::Range(..), pattern) => ident(pattern),
        (Iter::Rev(inner) | Iter::Skip(inner, _) | Iter::Take(inner, _) | Iter::Filter(inner, _), pattern) => {
            Some(hint(pattern, inner))
        }
        (Iter::Enumerate(_), syn::Pat::Tuple(tuple)) => tuple.elems.first().and_then(ident),
        _ => None,
    };
    found.unwrap_or_else(|| "i".into())
}
