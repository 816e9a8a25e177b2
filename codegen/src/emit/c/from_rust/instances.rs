//! Constants and functions, each written once for each of its sizes.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::infer::Inference;
use super::program::Function;
use super::scopes::Lower;
use super::translator::{comment, snake, Found, Instance, Translator};
use super::types::{Length, Sizes, Type};

impl<'a> Translator<'a> {
    /// A constant: a macro for a number, else a table.
    pub(super) fn constant(&mut self, name: &str) -> Found<(String, Type)> {
        let item = *self.program.constants.get(name).ok_or_else(|| format!("`{name}` is not known"))?;
        let ty = self.written(&item.ty, &BTreeMap::new())?;
        let number = matches!(ty, Type::Real | Type::Integer(_) | Type::Bool);
        let text = if number { format!("{}_{name}", self.upper) } else { format!("{}_{}", self.name, name.to_lowercase()) };
        if self.declared.insert(text.clone()) {
            let mut bare = Inference::bare(self.program, &mut self.closures, Sizes::new(), None);
            let found = bare.expression(&item.expr, Some(&ty))?;
            bare.unknowns.unify(&ty, &found)?;
            let inferred = bare.finished(0)?;
            let value = Lower::constant(self, &inferred, &item.expr)?;
            let said = comment(&item.attrs, "");
            if number {
                let _ = write!(self.macros, "\n{said}#define {text} {value}\n");
            } else {
                let of = self.c_type(&ty)?;
                let _ = write!(self.tables, "\n{said}{}_TABLE {of} {text} = {value};\n", self.upper);
            }
        }
        Ok((text, ty))
    }

    /// A function for these sizes and functions as arguments, written if it is not yet.
    pub(super) fn instance(&mut self, path: &str, sizes: Vec<(String, usize)>, given: Vec<(usize, Type)>) -> Found<Instance> {
        let key = (path.to_owned(), sizes, given);
        if let Some(instance) = self.instances.get(&key) {
            return Ok(instance.clone());
        }
        let function = *self.program.functions.get(path).ok_or_else(|| format!("`{path}` is not known"))?;
        let mut wanted = format!("{}_{}", self.name, path.split("::").map(snake).collect::<Vec<_>>().join("_"));
        for (_, size) in &key.1 {
            let _ = write!(wanted, "_{size}");
        }
        let name = self.fresh(&wanted);
        let known: Sizes = key.1.iter().map(|(name, size)| (name.clone(), Length::Known(*size))).collect();
        let first = self.closures.len();
        let inference = Inference::of(self.program, &mut self.closures, function, known.clone(), &key.2)
            .map_err(|error| format!("{path}: {error}"))?;
        let inferred = inference.finished(first).map_err(|error| format!("{path}: {error}"))?;
        let (inputs, output) = self.signature(function, known, &key.2)?;
        Lower::function(self, &inferred, function, &name, &inputs, &output).map_err(|error| format!("{path}: {error}"))?;
        let instance = Instance { name, inputs };
        self.instances.insert(key, instance.clone());
        Ok(instance)
    }

    /// The types of a function's arguments, `self` first, and of its result.
    fn signature(&mut self, function: Function<'a>, sizes: Sizes, given: &[(usize, Type)]) -> Found<(Vec<Type>, Type)> {
        let mut bare = Inference::bare(self.program, &mut self.closures, sizes.clone(), None);
        let of = match function.of {
            Some(of) => Some(bare.ty(&of.self_ty)?),
            None => None,
        };
        let mut bare = Inference::bare(self.program, &mut self.closures, sizes, of.clone());
        let mut inputs = Vec::new();
        for (place, argument) in function.signature.inputs.iter().enumerate() {
            let ty = match argument {
                syn::FnArg::Receiver(receiver) => {
                    let of = of.clone().ok_or("`self` outside of a method")?;
                    match &receiver.kind {
                        syn::ReceiverKind::Reference(_, _, mutable) => Type::to(of, mutable.is_some()),
                        _ => of,
                    }
                }
                syn::FnArg::Typed(argument) => match given.iter().find(|(at, _)| *at == place) {
                    Some((_, ty)) => ty.clone(),
                    None => bare.ty(&argument.ty)?,
                },
            };
            inputs.push(bare.unknowns.settled(&ty));
        }
        let output = bare.output(function.signature)?;
        let output = bare.unknowns.settled(&output);
        Ok((inputs, output))
    }
}
