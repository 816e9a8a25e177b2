//! Types of the restricted Rust, with those that are still open, and what makes two of them one.

use std::collections::BTreeMap;

/// A type; references record whether their target is mutable.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Type {
    Real,
    Integer(Integer),
    Bool,
    Text,
    Unit,
    Array(Box<Type>, Length),
    Slice(Box<Type>),
    Tuple(Vec<Type>),
    /// A struct or an enum with its sizes.
    Named(String, Vec<Length>),
    Reference(Box<Type>, bool),
    Option(Box<Type>),
    Iterator(Box<Type>),
    /// A closure by its number.
    Closure(usize),
    /// A function by its name.
    Function(String),
    /// Not known so far.
    Open(usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Integer {
    Usize,
    U16,
    U32,
    U64,
    I32,
}

/// The length of an array, or another size that a type depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Length {
    Known(usize),
    Open(usize),
}

/// Sizes by their names.
pub(super) type Sizes = BTreeMap<String, Length>;

impl Type {
    pub(super) const USIZE: Type = Type::Integer(Integer::Usize);

    pub(super) fn array(of: Type, length: Length) -> Type {
        Type::Array(Box::new(of), length)
    }

    pub(super) fn to(of: Type, mutable: bool) -> Type {
        Type::Reference(Box::new(of), mutable)
    }

    /// What references lead to.
    pub(super) fn behind(&self) -> &Type {
        match self {
            Type::Reference(to, _) => to.behind(),
            other => other,
        }
    }

    pub(super) fn integer(name: &str) -> Option<Type> {
        Some(Type::Integer(match name {
            "usize" => Integer::Usize,
            "u16" => Integer::U16,
            "u32" => Integer::U32,
            "u64" => Integer::U64,
            "i32" => Integer::I32,
            _ => return None,
        }))
    }
}

/// Solutions found so far for the unknown types and lengths of one function.
#[derive(Default)]
pub(super) struct Unknowns {
    types: Vec<Option<Type>>,
    lengths: Vec<Option<Length>>,
}

impl Unknowns {
    pub(super) fn open(&mut self) -> Type {
        self.types.push(None);
        Type::Open(self.types.len() - 1)
    }

    pub(super) fn open_length(&mut self) -> Length {
        self.lengths.push(None);
        Length::Open(self.lengths.len() - 1)
    }

    pub(super) fn length(&self, length: Length) -> Length {
        match length {
            Length::Open(i) => self.lengths[i].map_or(length, |length| self.length(length)),
            known => known,
        }
    }

    /// A type as far as it is known.
    pub(super) fn resolve(&self, ty: &Type) -> Type {
        let boxed = |ty: &Type| Box::new(self.resolve(ty));
        match ty {
            Type::Open(i) => self.types[*i].as_ref().map_or(ty.clone(), |ty| self.resolve(ty)),
            Type::Array(of, length) => Type::Array(boxed(of), self.length(*length)),
            Type::Slice(of) => Type::Slice(boxed(of)),
            Type::Tuple(all) => Type::Tuple(all.iter().map(|ty| self.resolve(ty)).collect()),
            Type::Named(name, sizes) => Type::Named(name.clone(), sizes.iter().map(|l| self.length(*l)).collect()),
            Type::Reference(to, mutable) => Type::Reference(boxed(to), *mutable),
            Type::Option(of) => Type::Option(boxed(of)),
            Type::Iterator(of) => Type::Iterator(boxed(of)),
            other => other.clone(),
        }
    }

    /// The same, where an otherwise unknown integer is an i32.
    pub(super) fn settled(&self, ty: &Type) -> Type {
        let boxed = |ty: &Type| Box::new(self.settled(ty));
        match self.resolve(ty) {
            Type::Open(_) => Type::Integer(Integer::I32),
            Type::Array(of, length) => Type::Array(boxed(&of), length),
            Type::Slice(of) => Type::Slice(boxed(&of)),
            Type::Tuple(all) => Type::Tuple(all.iter().map(|ty| self.settled(ty)).collect()),
            Type::Reference(to, mutable) => Type::Reference(boxed(&to), mutable),
            Type::Option(of) => Type::Option(boxed(&of)),
            Type::Iterator(of) => Type::Iterator(boxed(&of)),
            other => other,
        }
    }

    fn unify_lengths(&mut self, x: Length, y: Length) -> bool {
        match (self.length(x), self.length(y)) {
            (Length::Known(x), Length::Known(y)) => x == y,
            (Length::Open(i), Length::Open(j)) if i == j => true,
            (Length::Open(i), known) | (known, Length::Open(i)) => {
                self.lengths[i] = Some(known);
                true
            }
        }
    }

    /// Makes two types one; a reference on one side alone is looked through, as Rust does where it borrows or copies by itself.
    pub(super) fn unify(&mut self, x: &Type, y: &Type) -> Result<(), String> {
        let (x, y) = (self.resolve(x), self.resolve(y));
        let all = |this: &mut Self, x: &[Type], y: &[Type]| x.iter().zip(y).try_for_each(|(x, y)| this.unify(x, y));
        match (&x, &y) {
            _ if x == y => Ok(()),
            (Type::Open(i), _) => {
                self.types[*i] = Some(y.clone());
                Ok(())
            }
            (_, Type::Open(i)) => {
                self.types[*i] = Some(x.clone());
                Ok(())
            }
            (Type::Array(x, n), Type::Array(y, m)) if self.unify_lengths(*n, *m) => self.unify(x, y),
            (Type::Slice(x), Type::Slice(y) | Type::Array(y, _)) | (Type::Array(x, _), Type::Slice(y)) => self.unify(x, y),
            (Type::Tuple(x), Type::Tuple(y)) if x.len() == y.len() => all(self, x, y),
            (Type::Named(a, n), Type::Named(b, m)) if a == b && n.iter().zip(m).all(|(n, m)| self.unify_lengths(*n, *m)) => {
                Ok(())
            }
            (Type::Reference(x, _), Type::Reference(y, _)) | (Type::Option(x), Type::Option(y)) => self.unify(x, y),
            (Type::Iterator(x), Type::Iterator(y)) => self.unify(x, y),
            (Type::Reference(x, _), y) | (y, Type::Reference(x, _)) => self.unify(x, y),
            _ => Err(format!("{x:?} is not {y:?}")),
        }
    }
}
