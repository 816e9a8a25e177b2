//! The types of calls: of functions of the program, of closures, and of what Rust's library has.

use std::collections::HashMap;

use super::infer::{address, Call, Inference, Signature};
use super::program::{last, names, sizes_of, Function};
use super::types::{Length, Type};

type Found<T> = Result<T, String>;

impl<'a> Inference<'a, '_> {
    pub(super) fn call(&mut self, whole: &'a syn::Expr, call: &'a syn::ExprCall) -> Found<Type> {
        let syn::Expr::Path(path) = &*call.func else { return Err("a call of an expression".into()) };
        let all = names(&path.path);
        if let [name] = &all[..] {
            if let Some(ty) = self.lookup(name).cloned() {
                return self.call_of_closure(&ty, call);
            }
            if name == "Some" {
                let mut of = self.all(&call.args)?;
                return Ok(Type::Option(Box::new(of.pop().ok_or("`Some` of nothing")?)));
            }
        }
        if let [of, name] = &all[..] {
            match (of.as_str(), name.as_str()) {
                ("Real", "from_bits") => {
                    self.all(&call.args)?;
                    return Ok(Type::Real);
                }
                ("libm", "sincos" | "sincosf") => {
                    self.all(&call.args)?;
                    return Ok(Type::Tuple(vec![Type::Real, Type::Real]));
                }
                ("libm", _) => {
                    self.all(&call.args)?;
                    return Ok(Type::Real);
                }
                (of, "from") => {
                    if let Some(integer) = Type::integer(of) {
                        self.all(&call.args)?;
                        return Ok(integer);
                    }
                }
                _ => {}
            }
        }
        let path_of = match &all[..] {
            [of, name] if of == "Self" => match &self.of {
                Some(Type::Named(of, _)) => format!("{of}::{name}"),
                _ => return Err("`Self` outside of a type".into()),
            },
            // Functions belong to the type behind another name.
            [of, name] => match self.program.aliases.get(of) {
                Some(syn::Type::Path(behind)) => format!("{}::{name}", last(&behind.path)),
                _ => format!("{of}::{name}"),
            },
            _ => all.join("::"),
        };
        let written = path.path.segments.last().map(|segment| &segment.arguments);
        let receiver = None;
        self.call_of_function(address(whole), path_of, receiver, call.args.iter().collect(), written)
    }

    fn call_of_closure(&mut self, ty: &Type, call: &'a syn::ExprCall) -> Found<Type> {
        match self.unknowns.resolve(ty).behind().clone() {
            Type::Closure(id) => {
                let Signature { inputs, output } = self.closures[id].clone();
                for (argument, wanted) in call.args.iter().zip(&inputs) {
                    let found = self.expression(argument, Some(wanted))?;
                    self.unify(wanted, &found)?;
                }
                Ok(output)
            }
            Type::Function(name) => self.call_of_function(address(call), name, None, call.args.iter().collect(), None),
            other => Err(format!("{other:?} cannot be called")),
        }
    }

    /// A call of a function of the program, or of a method by its path.
    pub(super) fn call_of_function(
        &mut self,
        at: usize,
        path: String,
        receiver: Option<Type>,
        arguments: Vec<&'a syn::Expr>,
        written: Option<&syn::PathArguments>,
    ) -> Found<Type> {
        let function = *self.program.functions.get(&path).ok_or_else(|| format!("`{path}` is not known"))?;
        let mut own: Vec<String> = function.of.map_or(Vec::new(), |of| sizes_of(&of.generics));
        own.extend(sizes_of(&function.signature.generics));
        let mut sizes: Vec<(String, Length)> = own.into_iter().map(|name| (name, self.unknowns.open_length())).collect();
        if let Some(syn::PathArguments::AngleBracketed(written)) = written {
            let first = sizes.len() - written.args.len();
            for (i, argument) in written.args.iter().enumerate() {
                sizes[first + i].1 = match argument {
                    syn::GenericArgument::Const(value) => self.length(value)?,
                    syn::GenericArgument::Type(syn::Type::Path(path)) => self.named_length(&last(&path.path))?,
                    _ => return Err("a size that is computed".into()),
                };
            }
        }
        let outer = std::mem::replace(&mut self.sizes, sizes.iter().cloned().collect());
        let of = match function.of {
            Some(of) => Some(self.ty(&of.self_ty)?),
            None => None,
        };
        let outer_of = std::mem::replace(&mut self.of, of.clone());
        if let (Some(receiver), Some(of)) = (&receiver, &of) {
            self.unify(receiver.behind(), of)?;
        }
        // First the expected types, in the scope of the callee; then the arguments, in the scope of the caller.
        let mut wanted = Vec::new();
        for argument in &function.signature.inputs {
            if let syn::FnArg::Typed(argument) = argument {
                wanted.push(match self.callable(&argument.ty)? {
                    Some(signature) => Wanted::Callable(signature),
                    None => Wanted::Type(self.ty(&argument.ty)?),
                });
            }
        }
        let output = self.output(function.signature)?;
        self.sizes = outer;
        self.of = outer_of;
        for (argument, wanted) in arguments.into_iter().zip(&wanted) {
            self.argument(argument, wanted)?;
        }
        if let Type::Iterator(_) = output {
            self.inlined(function)?;
        }
        self.calls.insert(at, Call { path, sizes });
        Ok(output)
    }

    fn argument(&mut self, argument: &'a syn::Expr, wanted: &Wanted) -> Found<()> {
        match wanted {
            Wanted::Type(wanted) => {
                let found = self.expression(argument, Some(wanted))?;
                self.unify(wanted, &found)
            }
            Wanted::Callable(signature) => {
                let inner = match argument {
                    syn::Expr::Reference(reference) => &*reference.expr,
                    other => other,
                };
                let found = match inner {
                    syn::Expr::Closure(closure) => {
                        let found = self.closure(closure, Some(&signature.inputs))?;
                        self.types.insert(address(inner), found.clone());
                        self.types.insert(address(argument), found.clone());
                        found
                    }
                    _ => self.expression(argument, None)?,
                };
                if let Type::Closure(id) = found.behind() {
                    let Signature { inputs, output } = self.closures[*id].clone();
                    for (x, y) in inputs.iter().zip(&signature.inputs) {
                        self.unify(x, y)?;
                    }
                    self.unify(&output, &signature.output)?;
                }
                Ok(())
            }
        }
    }

    /// How an argument that is a function is called.
    fn callable(&mut self, ty: &syn::Type) -> Found<Option<Signature>> {
        let Some(bounds) = callable_bounds(ty) else { return Ok(None) };
        let inputs = bounds.inputs.iter().map(|input| self.ty(&input.ty)).collect::<Found<_>>()?;
        let output = match &bounds.output {
            syn::ReturnType::Default => Type::Unit,
            syn::ReturnType::Type(_, ty) => self.ty(ty)?,
        };
        Ok(Some(Signature { inputs, output }))
    }

    /// A function that returns an iterator is inlined at its call.
    fn inlined(&mut self, function: Function<'a>) -> Found<()> {
        self.scopes.push(HashMap::new());
        for argument in &function.signature.inputs {
            if let syn::FnArg::Typed(argument) = argument {
                let ty = self.ty(&argument.ty)?;
                self.pattern(&argument.pat, &ty, false)?;
            }
        }
        self.block(function.block, None)?;
        self.scopes.pop();
        Ok(())
    }
}

/// Expected type of an argument.
enum Wanted {
    Type(Type),
    Callable(Signature),
}

/// `Fn(A, B) -> C` of an argument's type, through references.
pub(super) fn callable_bounds(ty: &syn::Type) -> Option<&syn::ParenthesizedGenericArguments> {
    match ty {
        syn::Type::Reference(to) => callable_bounds(&to.elem),
        syn::Type::ImplTrait(bounds) => bounds.bounds.iter().find_map(|bound| match bound {
            syn::TypeParamBound::Trait(bound) => match &bound.path.segments.last()?.arguments {
                syn::PathArguments::Parenthesized(arguments) => Some(arguments),
                _ => None,
            },
            _ => None,
        }),
        _ => None,
    }
}
