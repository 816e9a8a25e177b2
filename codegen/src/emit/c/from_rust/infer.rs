//! The types of all expressions of a function whose sizes are known, in the order in which Rust finds them.

use std::collections::{BTreeMap, HashMap};

use super::program::{guarded, last, names, sizes_of, Function, Program};
use super::types::{Length, Sizes, Type, Unknowns};

/// A closure of the function: how it is called.
#[derive(Clone, Debug)]
pub(super) struct Signature {
    pub(super) inputs: Vec<Type>,
    pub(super) output: Type,
}

/// A call of a function of the program.
#[derive(Clone, Debug)]
pub(super) struct Call {
    pub(super) path: String,
    pub(super) sizes: Vec<(String, Length)>,
}

/// Types inferred so far in a function. Addresses identify expressions and patterns; they are stable as long as the program lives.
pub(super) struct Inference<'a, 'p> {
    pub(super) program: &'p Program<'a>,
    pub(super) unknowns: Unknowns,
    /// The closures of all functions so far, ending with the closures of this function.
    pub(super) closures: &'p mut Vec<Signature>,
    pub(super) sizes: Sizes,
    pub(super) scopes: Vec<HashMap<String, Type>>,
    pub(super) types: HashMap<usize, Type>,
    pub(super) calls: HashMap<usize, Call>,
    pub(super) of: Option<Type>,
    returns: Vec<Type>,
}

/// The inferred types of a function.
pub(super) struct Inferred {
    types: HashMap<usize, Type>,
    /// The functions that are called, with their sizes.
    pub(super) calls: HashMap<usize, (String, Vec<(String, usize)>)>,
    pub(super) sizes: BTreeMap<String, usize>,
}

impl Inferred {
    /// The type of an expression or of a name in a pattern, by its address.
    pub(super) fn ty(&self, address: usize) -> Found<&Type> {
        self.types.get(&address).ok_or_else(|| "an expression without a type".into())
    }
}

/// The address of a node of the syntax tree.
pub(super) fn address<T>(node: &T) -> usize {
    std::ptr::from_ref(node).addr()
}

type Found<T> = Result<T, String>;

impl<'a, 'p> Inference<'a, 'p> {
    /// Infers a function with these sizes. `given` lists its function arguments by position.
    pub(super) fn of(
        program: &'p Program<'a>,
        closures: &'p mut Vec<Signature>,
        function: Function<'a>,
        sizes: Sizes,
        given: &[(usize, Type)],
    ) -> Found<Self> {
        let mut this = Inference::bare(program, closures, sizes, None);
        if let Some(of) = function.of {
            this.of = Some(this.ty(&of.self_ty)?);
        }
        for (place, argument) in function.signature.inputs.iter().enumerate() {
            match argument {
                syn::FnArg::Receiver(receiver) => {
                    let of = this.of.clone().ok_or("`self` outside of a method")?;
                    let ty = match &receiver.kind {
                        syn::ReceiverKind::Reference(_, _, mutable) => Type::to(of, mutable.is_some()),
                        _ => of,
                    };
                    this.bind("self", ty);
                }
                syn::FnArg::Typed(argument) => {
                    let known = given.iter().find(|(at, _)| *at == place);
                    let ty = match known {
                        Some((_, ty)) => ty.clone(),
                        None => this.ty(&argument.ty)?,
                    };
                    this.pattern(&argument.pat, &ty, false)?;
                }
            }
        }
        let output = this.output(function.signature)?;
        this.returns.push(output.clone());
        let found = this.block(function.block, Some(&output))?;
        this.unify(&found, &output)?;
        Ok(this)
    }

    /// Resolves written types for known sizes, outside of any function.
    pub(super) fn bare(program: &'p Program<'a>, closures: &'p mut Vec<Signature>, sizes: Sizes, of: Option<Type>) -> Self {
        Inference {
            program,
            unknowns: Unknowns::default(),
            closures,
            sizes,
            scopes: vec![HashMap::new()],
            types: HashMap::new(),
            calls: HashMap::new(),
            of,
            returns: Vec::new(),
        }
    }

    /// What was found, with nothing left open; `first`: the number of the first closure of this function.
    pub(super) fn finished(self, first: usize) -> Found<Inferred> {
        let Inference { unknowns, closures, types, calls, sizes, .. } = self;
        for signature in closures.iter_mut().skip(first) {
            let inputs = signature.inputs.iter().map(|ty| unknowns.settled(ty)).collect();
            *signature = Signature { inputs, output: unknowns.settled(&signature.output) };
        }
        let known = |length: &Length| match unknowns.length(*length) {
            Length::Known(size) => Ok(size),
            Length::Open(_) => Err("a size is open".to_owned()),
        };
        let mut known_calls = HashMap::new();
        for (at, call) in &calls {
            let sizes = call.sizes.iter().map(|(name, length)| Ok((name.clone(), known(length)?))).collect::<Found<_>>()?;
            known_calls.insert(*at, (call.path.clone(), sizes));
        }
        let sizes = sizes.iter().map(|(name, length)| Ok((name.clone(), known(length)?))).collect::<Found<_>>()?;
        let types = types.into_iter().map(|(at, ty)| (at, unknowns.settled(&ty))).collect();
        Ok(Inferred { types, calls: known_calls, sizes })
    }

    /// Return type of a function.
    pub(super) fn output(&mut self, signature: &'a syn::Signature) -> Found<Type> {
        match &signature.output {
            syn::ReturnType::Default => Ok(Type::Unit),
            syn::ReturnType::Type(_, ty) => self.ty(ty),
        }
    }

    pub(super) fn unify(&mut self, x: &Type, y: &Type) -> Found<()> {
        self.unknowns.unify(x, y)
    }

    pub(super) fn size(&self, length: Length) -> Found<usize> {
        match self.unknowns.length(length) {
            Length::Known(size) => Ok(size),
            Length::Open(_) => Err("a size is open".into()),
        }
    }

    pub(super) fn bind(&mut self, name: &str, ty: Type) {
        if let Some(scope) = self.scopes.last_mut() {
            scope.insert(name.into(), ty);
        }
    }

    pub(super) fn lookup(&self, name: &str) -> Option<&Type> {
        self.scopes.iter().rev().find_map(|scope| scope.get(name))
    }

    /// A type as it is written.
    pub(super) fn ty(&mut self, ty: &syn::Type) -> Found<Type> {
        Ok(match ty {
            syn::Type::Path(path) => self.type_of_path(&path.path)?,
            syn::Type::Reference(to) => Type::to(self.ty(&to.elem)?, to.mutability.is_some()),
            syn::Type::Array(array) => {
                let of = self.ty(&array.elem)?;
                Type::array(of, self.length(&array.len)?)
            }
            syn::Type::Slice(slice) => Type::Slice(Box::new(self.ty(&slice.elem)?)),
            syn::Type::Tuple(tuple) if tuple.elems.is_empty() => Type::Unit,
            syn::Type::Tuple(tuple) => Type::Tuple(tuple.elems.iter().map(|ty| self.ty(ty)).collect::<Found<_>>()?),
            syn::Type::Infer(_) => self.unknowns.open(),
            syn::Type::Paren(ty) => self.ty(&ty.elem)?,
            syn::Type::ImplTrait(bounds) => {
                let item = bounds.bounds.iter().find_map(item_of_iterator).ok_or("`impl` of no iterator")?;
                Type::Iterator(Box::new(self.ty(item)?))
            }
            _ => return Err("a type of another kind".into()),
        })
    }

    pub(super) fn type_of_path(&mut self, path: &syn::Path) -> Found<Type> {
        let name = last(path);
        match name.as_str() {
            "Real" => return Ok(Type::Real),
            "bool" => return Ok(Type::Bool),
            "str" => return Ok(Type::Text),
            "Self" => return self.of.clone().ok_or_else(|| "`Self` outside of a type".into()),
            _ => {}
        }
        if let Some(integer) = Type::integer(&name) {
            return Ok(integer);
        }
        let arguments: Vec<&syn::GenericArgument> = match path.segments.last().map(|segment| &segment.arguments) {
            Some(syn::PathArguments::AngleBracketed(arguments)) => arguments.args.iter().collect(),
            _ => Vec::new(),
        };
        if name == "Option" {
            let Some(syn::GenericArgument::Type(of)) = arguments.first() else { return Err("`Option` of nothing".into()) };
            return Ok(Type::Option(Box::new(self.ty(of)?)));
        }
        if let Some(alias) = self.program.aliases.get(&name) {
            return self.ty(alias);
        }
        let Some(item) = self.program.structs.get(&name) else {
            let known = self.program.enums.contains_key(&name);
            return if known { Ok(Type::Named(name, Vec::new())) } else { Err(format!("`{name}` is no type")) };
        };
        let mut sizes = Vec::new();
        for argument in arguments {
            match argument {
                syn::GenericArgument::Lifetime(_) => {}
                syn::GenericArgument::Const(value) => sizes.push(self.length(value)?),
                syn::GenericArgument::Type(syn::Type::Path(path)) => {
                    sizes.push(self.named_length(&last(&path.path))?);
                }
                _ => return Err(format!("`{name}` of something else than a size")),
            }
        }
        for _ in sizes.len()..sizes_of(&item.generics).len() {
            sizes.push(self.unknowns.open_length());
        }
        Ok(Type::Named(name, sizes))
    }

    pub(super) fn named_length(&mut self, name: &str) -> Found<Length> {
        if let Some(length) = self.sizes.get(name) {
            return Ok(*length);
        }
        let constant = self.program.constants.get(name).ok_or_else(|| format!("`{name}` is no size"))?;
        self.length(&constant.expr)
    }

    pub(super) fn length(&mut self, value: &syn::Expr) -> Found<Length> {
        match value {
            syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(value), .. }) => {
                value.base10_parse().map(Length::Known).map_err(|error| error.to_string())
            }
            syn::Expr::Path(path) => self.named_length(&last(&path.path)),
            syn::Expr::Block(block) => match block.block.stmts.as_slice() {
                [syn::Stmt::Expr(value, None)] => self.length(value),
                _ => Err("a size that is computed".into()),
            },
            _ => Err("a size that is computed".into()),
        }
    }

    pub(super) fn block(&mut self, block: &'a syn::Block, expected: Option<&Type>) -> Found<Type> {
        self.scopes.push(HashMap::new());
        let mut found = Type::Unit;
        let count = block.stmts.len();
        for (i, statement) in block.stmts.iter().enumerate() {
            match statement {
                syn::Stmt::Local(local) => self.local(local)?,
                syn::Stmt::Item(_) => {}
                syn::Stmt::Expr(value, None) if i + 1 == count => found = self.expression(value, expected)?,
                syn::Stmt::Expr(value, _) => {
                    self.expression(value, None)?;
                    if i + 1 == count && matches!(value, syn::Expr::Return(_) | syn::Expr::Continue(_) | syn::Expr::Break(_)) {
                        found = self.unknowns.open();
                    }
                }
                syn::Stmt::Macro(_) => return Err("a macro".into()),
            }
        }
        self.scopes.pop();
        Ok(found)
    }

    fn local(&mut self, local: &'a syn::Local) -> Found<()> {
        let (pattern, written) = match &local.pat {
            syn::Pat::Type(typed) => (&*typed.pat, Some(self.ty(&typed.ty)?)),
            pattern => (pattern, None),
        };
        let init = local.init.as_ref().ok_or("a variable without a value")?;
        let found = self.expression(&init.expr, written.as_ref())?;
        if let Some(written) = &written {
            self.unify(written, &found)?;
        }
        if let Some((_, otherwise)) = &init.diverge {
            self.expression(otherwise, None)?;
        }
        // The written type may be a slice where the value is an array.
        self.pattern(pattern, &written.unwrap_or(found), false)
    }

    pub(super) fn expression(&mut self, value: &'a syn::Expr, expected: Option<&Type>) -> Found<Type> {
        let found = self.expression_of(value, expected)?;
        self.types.insert(address(value), found.clone());
        Ok(found)
    }

    pub(super) fn all(&mut self, values: impl IntoIterator<Item = &'a syn::Expr>) -> Found<Vec<Type>> {
        values.into_iter().map(|value| self.expression(value, None)).collect()
    }

    fn expression_of(&mut self, value: &'a syn::Expr, expected: Option<&Type>) -> Found<Type> {
        use syn::Expr;
        Ok(match value {
            Expr::Lit(literal) => self.literal(&literal.lit)?,
            Expr::Paren(inner) => self.expression(&inner.expr, expected)?,
            Expr::Group(inner) => self.expression(&inner.expr, expected)?,
            Expr::Path(path) => self.path(&path.path)?,
            Expr::Unary(unary) => self.unary(unary)?,
            Expr::Reference(reference) => {
                let found = self.expression(&reference.expr, None)?;
                match found {
                    // Closures are handed on as they are.
                    Type::Closure(_) => found,
                    found => Type::to(found, reference.mutability.is_some()),
                }
            }
            Expr::Binary(binary) => self.binary(binary)?,
            Expr::Assign(assign) => {
                let left = self.expression(&assign.left, None)?;
                let right = self.expression(&assign.right, Some(&left))?;
                self.unify(&left, &right)?;
                Type::Unit
            }
            Expr::Infer(_) => self.unknowns.open(),
            Expr::Cast(cast) => {
                self.expression(&cast.expr, None)?;
                self.ty(&cast.ty)?
            }
            Expr::Field(field) => self.field(field)?,
            Expr::Index(index) => self.index(index)?,
            Expr::Tuple(tuple) if tuple.elems.is_empty() => Type::Unit,
            Expr::Tuple(tuple) => Type::Tuple(self.all(&tuple.elems)?),
            Expr::Array(array) => {
                let of = self.unknowns.open();
                for ty in self.all(&array.elems)? {
                    self.unify(&of, &ty)?;
                }
                Type::array(of, Length::Known(array.elems.len()))
            }
            Expr::Repeat(repeat) => {
                let of = self.expression(&repeat.expr, None)?;
                Type::array(of, self.length(&repeat.len)?)
            }
            Expr::Struct(of) => self.structure(of)?,
            Expr::Range(range) => {
                let of = self.unknowns.open();
                for end in [&range.start, &range.end].into_iter().flatten() {
                    let found = self.expression(end, None)?;
                    self.unify(&of, &found)?;
                }
                Type::Iterator(Box::new(of))
            }
            Expr::If(choice) => self.choice(choice, expected)?,
            Expr::Let(test) => {
                let found = self.expression(&test.expr, None)?;
                self.pattern(&test.pat, &found, false)?;
                Type::Bool
            }
            Expr::Match(choice) => self.matched(choice, expected)?,
            Expr::Block(block) => self.block(&block.block, expected)?,
            Expr::ForLoop(each) => self.for_each(each)?,
            Expr::While(each) => {
                self.expression(&each.cond, None)?;
                self.block(&each.body, None)?;
                Type::Unit
            }
            Expr::Return(found) => {
                if let (Some(value), Some(wanted)) = (&found.expr, self.returns.last().cloned()) {
                    let ty = self.expression(value, Some(&wanted))?;
                    self.unify(&wanted, &ty)?;
                }
                self.unknowns.open()
            }
            Expr::Continue(_) | Expr::Break(_) => self.unknowns.open(),
            Expr::Closure(closure) => self.closure(closure, None)?,
            Expr::Call(call) => self.call(value, call)?,
            Expr::MethodCall(call) => self.method(value, call)?,
            Expr::Macro(call) => {
                let value = *self.program.macros.get(&address(call)).ok_or("a macro")?;
                self.expression(value, expected)?
            }
            _ => return Err("an expression of another kind".into()),
        })
    }

    fn literal(&mut self, literal: &syn::Lit) -> Found<Type> {
        Ok(match literal {
            syn::Lit::Float(_) => Type::Real,
            syn::Lit::Bool(_) => Type::Bool,
            syn::Lit::Str(_) => Type::to(Type::Text, false),
            syn::Lit::Int(value) => Type::integer(value.suffix()).unwrap_or_else(|| self.unknowns.open()),
            _ => return Err("a literal of another kind".into()),
        })
    }

    fn unary(&mut self, unary: &'a syn::ExprUnary) -> Found<Type> {
        let found = self.expression(&unary.expr, None)?;
        Ok(match (&unary.op, self.unknowns.resolve(&found)) {
            (syn::UnOp::Deref(_), Type::Reference(to, _)) => *to,
            (_, other) => other.behind().clone(),
        })
    }

    fn structure(&mut self, of: &'a syn::ExprStruct) -> Found<Type> {
        let ty = if names(&of.path).len() == 2 {
            Type::Named(names(&of.path)[0].clone(), Vec::new())
        } else {
            self.type_of_path(&of.path)?
        };
        let fields = self.fields(&of.path, &ty)?;
        for field in &of.fields {
            let wanted = field_type(&fields, &member(&field.member))?;
            let found = self.expression(&field.expr, Some(&wanted))?;
            self.unify(&wanted, &found)?;
        }
        if let Some(rest) = &of.rest {
            let found = self.expression(rest, Some(&ty))?;
            self.unify(&ty, &found)?;
        }
        Ok(ty)
    }

    fn for_each(&mut self, each: &'a syn::ExprForLoop) -> Found<Type> {
        let found = self.expression(&each.expr, None)?;
        let item = self.item(&found)?;
        self.scopes.push(HashMap::new());
        self.pattern(&each.pat, &item, false)?;
        self.block(&each.body, None)?;
        self.scopes.pop();
        Ok(Type::Unit)
    }

    fn path(&mut self, path: &syn::Path) -> Found<Type> {
        let all = names(path);
        match &all[..] {
            [name] => {
                if let Some(ty) = self.lookup(name) {
                    return Ok(ty.clone());
                }
                if self.sizes.contains_key(name) {
                    return Ok(Type::USIZE);
                }
                if let Some(constant) = self.program.constants.get(name) {
                    return self.ty(&constant.ty);
                }
                match name.as_str() {
                    "None" => Ok(Type::Option(Box::new(self.unknowns.open()))),
                    _ if self.program.functions.contains_key(name) => Ok(Type::Function(name.clone())),
                    _ => Err(format!("`{name}` is not known")),
                }
            }
            [of, _] if of == "Real" => Ok(Type::Real),
            [of, _] if self.program.enums.contains_key(of) => Ok(Type::Named(of.clone(), Vec::new())),
            _ => Err(format!("`{}` is not known", all.join("::"))),
        }
    }

    fn binary(&mut self, binary: &'a syn::ExprBinary) -> Found<Type> {
        use syn::BinOp::*;
        let left = self.expression(&binary.left, None)?;
        let right = self.expression(&binary.right, None)?;
        let (left, right) = (self.unknowns.resolve(&left).behind().clone(), self.unknowns.resolve(&right).behind().clone());
        let shift = matches!(binary.op, Shl(_) | Shr(_) | ShlAssign(_) | ShrAssign(_));
        if !shift {
            self.unify(&left, &right)?;
        }
        Ok(match binary.op {
            And(_) | Or(_) | Eq(_) | Ne(_) | Lt(_) | Le(_) | Gt(_) | Ge(_) => Type::Bool,
            Add(_) | Sub(_) | Mul(_) | Div(_) | Rem(_) | BitAnd(_) | BitOr(_) | BitXor(_) | Shl(_) | Shr(_) => left,
            _ => Type::Unit,
        })
    }

    fn field(&mut self, field: &'a syn::ExprField) -> Found<Type> {
        let base = self.expression(&field.base, None)?;
        let base = self.unknowns.resolve(&base);
        match (&field.member, base.behind()) {
            (syn::Member::Unnamed(index), Type::Tuple(all)) => {
                all.get(index.index as usize).cloned().ok_or_else(|| "a tuple is too short".into())
            }
            (syn::Member::Named(name), of @ Type::Named(..)) => {
                let fields = self.fields_of(of)?;
                field_type(&fields, &name.to_string())
            }
            (_, other) => Err(format!("{other:?} has no fields")),
        }
    }

    fn index(&mut self, index: &'a syn::ExprIndex) -> Found<Type> {
        let base = self.expression(&index.expr, None)?;
        let at = self.expression(&index.index, None)?;
        let base = self.unknowns.resolve(&base);
        let (Type::Array(of, _) | Type::Slice(of)) = base.behind() else { return Err(format!("{base:?} has no elements")) };
        if let Type::Iterator(at) = self.unknowns.resolve(&at) {
            self.unify(&at, &Type::USIZE)?;
            return Ok(Type::Slice(of.clone()));
        }
        self.unify(&at, &Type::USIZE)?;
        Ok((**of).clone())
    }

    fn choice(&mut self, choice: &'a syn::ExprIf, expected: Option<&Type>) -> Found<Type> {
        self.scopes.push(HashMap::new());
        self.expression(&choice.cond, None)?;
        let found = self.block(&choice.then_branch, expected)?;
        self.scopes.pop();
        if let Some((_, otherwise)) = &choice.else_branch {
            let other = self.expression(otherwise, expected)?;
            self.unify(&found, &other)?;
        }
        Ok(found)
    }

    fn matched(&mut self, choice: &'a syn::ExprMatch, expected: Option<&Type>) -> Found<Type> {
        let subject = self.expression(&choice.expr, None)?;
        let found = self.unknowns.open();
        for arm in &choice.arms {
            self.scopes.push(HashMap::new());
            let (pattern, guard) = guarded(&arm.pat);
            self.pattern(pattern, &subject, false)?;
            if let Some(guard) = guard {
                self.expression(guard, None)?;
            }
            let one = self.expression(&arm.body, expected)?;
            self.unify(&found, &one)?;
            self.scopes.pop();
        }
        Ok(found)
    }

    /// A closure, whose arguments are `given` where it is known what calls it.
    pub(super) fn closure(&mut self, closure: &'a syn::ExprClosure, given: Option<&[Type]>) -> Found<Type> {
        self.scopes.push(HashMap::new());
        let mut inputs = Vec::new();
        for (i, pattern) in closure.inputs.iter().enumerate() {
            let ty = given.and_then(|given| given.get(i).cloned()).unwrap_or_else(|| self.unknowns.open());
            self.pattern(pattern, &ty, false)?;
            inputs.push(ty);
        }
        let output = match &closure.output {
            syn::ReturnType::Default => self.unknowns.open(),
            syn::ReturnType::Type(_, ty) => self.ty(ty)?,
        };
        self.returns.push(output.clone());
        let found = self.expression(&closure.body, None)?;
        self.unify(&output, &found)?;
        self.returns.pop();
        self.scopes.pop();
        self.closures.push(Signature { inputs, output });
        let ty = Type::Closure(self.closures.len() - 1);
        self.types.insert(address(closure), ty.clone());
        Ok(ty)
    }

    /// What an iterator, or what can be made one, runs over.
    pub(super) fn item(&mut self, ty: &Type) -> Found<Type> {
        let ty = self.unknowns.resolve(ty);
        Ok(match &ty {
            Type::Iterator(of) => (**of).clone(),
            Type::Array(of, _) => (**of).clone(),
            Type::Reference(to, mutable) => match &**to {
                Type::Array(of, _) | Type::Slice(of) => Type::to((**of).clone(), *mutable),
                inner => self.item(&inner.clone())?,
            },
            _ => return Err(format!("{ty:?} is no iterator")),
        })
    }
}

fn item_of_iterator(bound: &syn::TypeParamBound) -> Option<&syn::Type> {
    let syn::TypeParamBound::Trait(bound) = bound else { return None };
    let segment = bound.path.segments.last()?;
    let syn::PathArguments::AngleBracketed(arguments) = &segment.arguments else { return None };
    arguments.args.iter().find_map(|argument| match argument {
        syn::GenericArgument::AssocType(item) => Some(&item.ty),
        _ => None,
    })
}

/// The name of a field.
pub(super) fn member(member: &syn::Member) -> String {
    match member {
        syn::Member::Named(name) => name.to_string(),
        syn::Member::Unnamed(index) => index.index.to_string(),
    }
}

pub(super) fn field_type(fields: &[(String, Type)], name: &str) -> Found<Type> {
    fields.iter().find(|(known, _)| known == name).map(|(_, ty)| ty.clone()).ok_or_else(|| format!("there is no field `{name}`"))
}
