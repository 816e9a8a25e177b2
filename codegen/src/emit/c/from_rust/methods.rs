//! The types of method calls: methods of the program, and methods of Rust's library that the blocks use.

use super::infer::{address, Inference};
use super::types::{Integer, Type};

type Found<T> = Result<T, String>;

impl<'a> Inference<'a, '_> {
    pub(super) fn method(&mut self, whole: &'a syn::Expr, call: &'a syn::ExprMethodCall) -> Found<Type> {
        let found = self.expression(&call.receiver, None)?;
        let receiver = self.unknowns.resolve(&found);
        let name = call.method.to_string();
        if let Type::Named(of, _) = receiver.behind() {
            let path = format!("{of}::{name}");
            let written = call.turbofish.clone().map(syn::PathArguments::AngleBracketed);
            let arguments = call.args.iter().collect();
            return self.call_of_function(address(whole), path, Some(receiver), arguments, written.as_ref());
        }
        match receiver.behind().clone() {
            Type::Real | Type::Integer(_) => self.of_number(call, receiver.behind()),
            Type::Option(of) => self.of_option(call, &of),
            Type::Array(of, length) if name == "map" => {
                let output = self.applied(call, 0, &[*of])?;
                Ok(Type::array(output, length))
            }
            Type::Array(of, _) | Type::Slice(of) => self.of_array(call, &receiver, *of),
            Type::Iterator(of) => self.of_iterator(call, *of),
            other => Err(format!("{other:?} has no method `{name}`")),
        }
    }

    /// The output type of a closure argument for these inputs.
    fn applied(&mut self, call: &'a syn::ExprMethodCall, place: usize, inputs: &[Type]) -> Found<Type> {
        let argument = call.args.iter().nth(place).ok_or("an argument is missing")?;
        let ty = match argument {
            syn::Expr::Closure(closure) => self.closure(closure, Some(inputs))?,
            _ => return Err("a function as an argument of an iterator".into()),
        };
        match ty {
            Type::Closure(id) => Ok(self.closures[id].output.clone()),
            other => Err(format!("{other:?} cannot be called")),
        }
    }

    fn with_arguments(&mut self, call: &'a syn::ExprMethodCall, wanted: Option<&Type>) -> Found<()> {
        for argument in &call.args {
            let found = self.expression(argument, wanted)?;
            if let Some(wanted) = wanted {
                self.unknowns.unify(&found, wanted)?;
            }
        }
        Ok(())
    }

    fn of_number(&mut self, call: &'a syn::ExprMethodCall, of: &Type) -> Found<Type> {
        self.with_arguments(call, Some(of))?;
        Ok(match call.method.to_string().as_str() {
            "is_finite" | "is_nan" | "is_sign_negative" => Type::Bool,
            "to_bits" if self.program.is_single() => Type::Integer(Integer::U32),
            "to_bits" => Type::Integer(Integer::U64),
            "abs" | "max" | "min" | "clamp" | "wrapping_sub" | "wrapping_add" | "copysign" => of.clone(),
            other => return Err(format!("a number has no method `{other}`")),
        })
    }

    fn of_option(&mut self, call: &'a syn::ExprMethodCall, of: &Type) -> Found<Type> {
        Ok(match call.method.to_string().as_str() {
            "copied" => Type::Option(Box::new(self.unknowns.resolve(of).behind().clone())),
            "unwrap_or" => {
                self.with_arguments(call, Some(of))?;
                of.clone()
            }
            "map_or" => {
                let default = call.args.first().ok_or("an argument is missing")?;
                let first = self.expression(default, None)?;
                let second = self.applied(call, 1, std::slice::from_ref(of))?;
                self.unknowns.unify(&first, &second)?;
                first
            }
            "is_some_and" => {
                self.applied(call, 0, std::slice::from_ref(of))?;
                Type::Bool
            }
            other => return Err(format!("an option has no method `{other}`")),
        })
    }

    fn of_array(&mut self, call: &'a syn::ExprMethodCall, receiver: &Type, of: Type) -> Found<Type> {
        let name = call.method.to_string();
        let iterator = |of: Type| Type::Iterator(Box::new(of));
        Ok(match name.as_str() {
            "iter" => iterator(Type::to(of, false)),
            "iter_mut" => iterator(Type::to(of, true)),
            "into_iter" => iterator(self.item(receiver)?),
            "chunks_exact_mut" => {
                self.with_arguments(call, Some(&Type::USIZE))?;
                iterator(Type::to(Type::Slice(Box::new(of)), true))
            }
            "get" | "get_mut" => {
                let argument = call.args.first().ok_or("an argument is missing")?;
                let found = self.expression(argument, None)?;
                let found = self.unknowns.resolve(&found);
                let (at, of) = match found {
                    Type::Iterator(at) => (*at, Type::Slice(Box::new(of))),
                    at => (at, of),
                };
                self.unknowns.unify(&at, &Type::USIZE)?;
                Type::Option(Box::new(Type::to(of, name == "get_mut")))
            }
            "as_flattened" | "as_flattened_mut" => {
                let Type::Array(inner, _) = self.unknowns.resolve(&of) else {
                    return Err("what is flattened is no array".into());
                };
                Type::to(Type::Slice(inner), name == "as_flattened_mut")
            }
            "len" => Type::USIZE,
            "swap" | "rotate_right" => {
                self.with_arguments(call, Some(&Type::USIZE))?;
                Type::Unit
            }
            "contains" => {
                self.with_arguments(call, Some(&of))?;
                Type::Bool
            }
            "copy_from_slice" => {
                self.with_arguments(call, Some(&Type::Slice(Box::new(of))))?;
                Type::Unit
            }
            other => return Err(format!("an array has no method `{other}`")),
        })
    }

    fn of_iterator(&mut self, call: &'a syn::ExprMethodCall, of: Type) -> Found<Type> {
        let iterator = |of: Type| Type::Iterator(Box::new(of));
        Ok(match call.method.to_string().as_str() {
            "into_iter" | "rev" => iterator(of),
            "copied" => iterator(self.unknowns.resolve(&of).behind().clone()),
            "enumerate" => iterator(Type::Tuple(vec![Type::USIZE, of])),
            "skip" | "take" => {
                self.with_arguments(call, Some(&Type::USIZE))?;
                iterator(of)
            }
            "zip" => {
                let other = call.args.first().ok_or("an argument is missing")?;
                let found = self.expression(other, None)?;
                let item = self.item(&found)?;
                iterator(Type::Tuple(vec![of, item]))
            }
            "map" => iterator(self.applied(call, 0, &[of])?),
            "filter" => {
                self.applied(call, 0, &[Type::to(of.clone(), false)])?;
                iterator(of)
            }
            "flatten" => iterator(self.item(&of)?),
            "any" | "all" => {
                self.applied(call, 0, &[of])?;
                Type::Bool
            }
            "find" => {
                self.applied(call, 0, &[Type::to(of.clone(), false)])?;
                Type::Option(Box::new(of))
            }
            "next" => Type::Option(Box::new(of)),
            "count" => Type::USIZE,
            "fold" => {
                let start = call.args.first().ok_or("an argument is missing")?;
                let start = self.expression(start, None)?;
                let found = self.applied(call, 1, &[start.clone(), of])?;
                self.unknowns.unify(&start, &found)?;
                start
            }
            other => return Err(format!("an iterator has no method `{other}`")),
        })
    }
}
