//! The types of names in patterns, and of the fields of structs and variants.

use super::infer::{address, field_type, member, Inference};
use super::program::{last, names, sizes_of};
use super::types::{Length, Type};

type Found<T> = Result<T, String>;

impl<'a> Inference<'a, '_> {
    /// Gives the names of a pattern their types. `through`: it is matched through a reference (to what may be changed).
    pub(super) fn pattern(&mut self, pattern: &'a syn::Pat, ty: &Type, through: impl Into<Through>) -> Found<()> {
        let through = through.into();
        let ty = self.unknowns.resolve(ty);
        let (inner, inside) = match &ty {
            Type::Reference(to, mutable) => (self.unknowns.resolve(to), Through(Some(*mutable))),
            _ => (ty.clone(), through),
        };
        match pattern {
            syn::Pat::Wild(_) | syn::Pat::Lit(_) | syn::Pat::Rest(_) => {}
            syn::Pat::Ident(ident) if self.is_value(&ident.ident.to_string()) => {}
            syn::Pat::Ident(ident) => {
                let ty = match through.0 {
                    Some(mutable) => Type::to(ty, mutable),
                    None => ty,
                };
                self.types.insert(address(ident), ty.clone());
                self.bind(&ident.ident.to_string(), ty.clone());
                if let Some((_, inner)) = &ident.subpat {
                    self.pattern(inner, &ty, Through(None))?;
                }
            }
            syn::Pat::Type(typed) => {
                let written = self.ty(&typed.ty)?;
                self.unify(&written, &ty)?;
                self.pattern(&typed.pat, &written, through)?;
            }
            syn::Pat::Paren(inner) => self.pattern(&inner.pat, &ty, through)?,
            syn::Pat::Reference(inner) => self.pattern(&inner.pat, ty.behind(), Through(None))?,
            syn::Pat::Tuple(tuple) => {
                if let Type::Open(_) = inner {
                    let open = Type::Tuple(tuple.elems.iter().map(|_| self.unknowns.open()).collect());
                    self.unify(&inner, &open)?;
                }
                let Type::Tuple(types) = self.unknowns.resolve(&inner) else { return Err(format!("{inner:?} is no tuple")) };
                for (pattern, ty) in tuple.elems.iter().zip(&types) {
                    self.pattern(pattern, ty, inside)?;
                }
            }
            syn::Pat::Slice(slice) => {
                if let Type::Open(_) = inner {
                    let open = Type::array(self.unknowns.open(), Length::Known(slice.elems.len()));
                    self.unify(&inner, &open)?;
                }
                let (of, length) = match self.unknowns.resolve(&inner) {
                    Type::Array(of, length) => (of, Some(length)),
                    Type::Slice(of) => (of, None),
                    other => return Err(format!("{other:?} is no array")),
                };
                for pattern in &slice.elems {
                    match pattern {
                        syn::Pat::Ident(syn::PatIdent { ident, subpat: Some((_, rest)), .. })
                            if matches!(**rest, syn::Pat::Rest(_)) =>
                        {
                            let length = length.ok_or("the rest of a slice")?;
                            let rest = Length::Known(self.size(length)? + 1 - slice.elems.len());
                            let ty = Type::to(Type::array((*of).clone(), rest), false);
                            self.bind(&ident.to_string(), ty);
                        }
                        pattern => self.pattern(pattern, &of, inside)?,
                    }
                }
            }
            syn::Pat::Struct(of) => {
                let fields = self.fields(&of.path, &inner)?;
                for field in &of.fields {
                    let ty = field_type(&fields, &member(&field.member))?;
                    self.pattern(&field.pat, &ty, inside)?;
                }
            }
            syn::Pat::TupleStruct(some) if last(&some.path) == "Some" => {
                let of = self.unknowns.open();
                self.unify(&inner, &Type::Option(Box::new(of.clone())))?;
                let [pattern] = some.elems.iter().collect::<Vec<_>>()[..] else { return Err("`Some` of several".into()) };
                self.pattern(pattern, &of, inside)?;
            }
            syn::Pat::Path(_) => {}
            _ => return Err("a pattern of another kind".into()),
        }
        Ok(())
    }

    /// Whether a name alone in a pattern is a value, not a new name.
    pub(super) fn is_value(&self, name: &str) -> bool {
        name == "None" || self.program.constants.contains_key(name)
    }

    /// The fields of a struct, or of a variant of an enum, with their types; `ty`, an instance of it, gives the sizes.
    pub(super) fn fields(&mut self, path: &syn::Path, ty: &Type) -> Found<Vec<(String, Type)>> {
        let all = names(path);
        if let [of, variant] = &all[..] {
            if let Some(item) = self.program.enums.get(of) {
                let variant = item.variants.iter().find(|v| v.ident == variant).ok_or("no such variant")?;
                self.unify(ty, &Type::Named(of.clone(), Vec::new()))?;
                let mut fields = Vec::new();
                for field in &variant.fields {
                    let name = field.ident.as_ref().ok_or("a field without a name")?;
                    fields.push((name.to_string(), self.ty(&field.ty)?));
                }
                return Ok(fields);
            }
        }
        let found = self.type_of_path(path)?;
        self.unify(ty, &found)?;
        self.fields_of(&found)
    }

    /// The fields of a type.
    pub(super) fn fields_of(&mut self, ty: &Type) -> Found<Vec<(String, Type)>> {
        let Type::Named(name, sizes) = self.unknowns.resolve(ty.behind()) else { return Err(format!("{ty:?} has no fields")) };
        let item = *self.program.structs.get(&name).ok_or_else(|| format!("`{name}` has no fields"))?;
        let outer = self.sizes.clone();
        self.sizes = sizes_of(&item.generics).into_iter().zip(sizes).collect();
        let mut fields = Vec::new();
        for field in &item.fields {
            let name = field.ident.as_ref().ok_or("a field without a name")?;
            fields.push((name.to_string(), self.ty(&field.ty)?));
        }
        self.sizes = outer;
        Ok(fields)
    }
}

/// Whether a pattern is matched through a reference, and whether that lets it be changed.
#[derive(Clone, Copy)]
pub(super) struct Through(Option<bool>);

impl From<bool> for Through {
    fn from(_: bool) -> Self {
        Through(None)
    }
}
