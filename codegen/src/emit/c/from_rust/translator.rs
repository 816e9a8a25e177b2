//! What all functions share: names, and types with their declarations.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::infer::{Inference, Signature};
use super::program::{names, Program};
use super::types::{Integer, Length, Sizes, Type};

pub(super) type Found<T> = Result<T, String>;

/// A function of C: its name and the types of its arguments.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub(super) name: String,
    pub(super) inputs: Vec<Type>,
}

/// A closure as a function of C: its name, and the struct of its captures, if any.
#[derive(Clone, Debug, Default)]
pub(super) struct Callable {
    pub(super) function: String,
    pub(super) captured: Option<String>,
}

pub(super) type Key = (String, Vec<(String, usize)>, Vec<(usize, Type)>);

pub(super) struct Translator<'a> {
    pub(super) program: &'a Program<'a>,
    /// What names and macros begin with.
    pub(super) name: String,
    pub(super) upper: String,
    pub(super) closures: Vec<Signature>,
    pub(super) callables: BTreeMap<usize, Callable>,
    pub(super) macros: String,
    pub(super) typedefs: String,
    pub(super) tables: String,
    pub(super) functions: String,
    pub(super) declared: BTreeSet<String>,
    pub(super) instances: BTreeMap<Key, Instance>,
    taken: BTreeSet<String>,
}

impl<'a> Translator<'a> {
    pub(super) fn new(program: &'a Program<'a>, name: &str, upper: &str) -> Self {
        Translator {
            program,
            name: name.into(),
            upper: upper.into(),
            closures: Vec::new(),
            callables: BTreeMap::new(),
            macros: String::new(),
            typedefs: String::new(),
            tables: String::new(),
            functions: String::new(),
            declared: BTreeSet::new(),
            instances: BTreeMap::new(),
            taken: BTreeSet::new(),
        }
    }

    /// A name for a function or a type that no other has.
    pub(super) fn fresh(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while !self.taken.insert(name.clone()) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        name
    }

    /// A type as it is written, for known sizes.
    pub(super) fn written(&mut self, ty: &'a syn::Type, sizes: &BTreeMap<String, usize>) -> Found<Type> {
        let sizes: Sizes = sizes.iter().map(|(name, size)| (name.clone(), Length::Known(*size))).collect();
        let mut bare = Inference::bare(self.program, &mut self.closures, sizes, None);
        let found = bare.ty(ty)?;
        Ok(bare.unknowns.settled(&found))
    }

    /// The fields of a struct.
    pub(super) fn fields(&mut self, ty: &Type) -> Found<Vec<(String, Type)>> {
        let mut bare = Inference::bare(self.program, &mut self.closures, Sizes::new(), None);
        let fields = bare.fields_of(ty)?;
        Ok(fields.into_iter().map(|(name, ty)| (name, bare.unknowns.settled(&ty))).collect())
    }

    /// Name of a type, as a part of other names.
    fn called(&self, ty: &Type) -> Found<String> {
        let size = |length: &Length| match length {
            Length::Known(size) => Ok(*size),
            Length::Open(_) => Err("a size is open".to_owned()),
        };
        Ok(match ty {
            Type::Real => "real".into(),
            Type::Bool => "bool".into(),
            Type::Integer(Integer::Usize) => "size".into(),
            Type::Integer(Integer::U16) => "u16".into(),
            Type::Integer(Integer::U32) => "u32".into(),
            Type::Integer(Integer::U64) => "u64".into(),
            Type::Integer(Integer::I32) => "i32".into(),
            Type::Array(of, length) => {
                let inner = self.called(of)?;
                match &**of {
                    Type::Array(..) => {
                        // Rows by columns.
                        let (base, sizes) = inner.rsplit_once('_').ok_or("an array of nothing")?;
                        format!("{base}_{}x{sizes}", size(length)?)
                    }
                    _ => format!("{inner}_{}", size(length)?),
                }
            }
            Type::Slice(of) => format!("{}_slice", self.called(of)?),
            Type::Reference(to, _) => format!("to_{}", self.called(to)?),
            Type::Tuple(all) => {
                let all = all.iter().map(|ty| self.called(ty)).collect::<Found<Vec<_>>>()?;
                format!("{}_tuple", all.join("_and_"))
            }
            Type::Named(name, sizes) => {
                let mut text = snake(name);
                for length in sizes {
                    let _ = write!(text, "_{}", size(length)?);
                }
                text
            }
            other => return Err(format!("{other:?} has no name in C")),
        })
    }

    /// A type in C, declared if it is not yet.
    pub(super) fn c_type(&mut self, ty: &Type) -> Found<String> {
        let name = self.name.clone();
        Ok(match ty {
            Type::Unit => "void".into(),
            Type::Real => format!("{name}_real"),
            Type::Bool => "bool".into(),
            Type::Integer(integer) => match integer {
                Integer::Usize => "size_t",
                Integer::U16 => "uint16_t",
                Integer::U32 => "uint32_t",
                Integer::U64 => "uint64_t",
                Integer::I32 => "int32_t",
            }
            .into(),
            Type::Reference(to, _) if matches!(**to, Type::Slice(_)) => self.c_type(to)?,
            Type::Option(of) if matches!(**of, Type::Reference(..)) => self.c_type(of)?,
            Type::Reference(to, mutable) => {
                let to = self.c_type(to)?;
                let constant = if *mutable { "" } else { "const " };
                format!("{constant}{to} *")
            }
            Type::Closure(id) => {
                let captured = self.callables.get(id).and_then(|callable| callable.captured.clone());
                format!("const {} *", captured.ok_or("a closure that captures nothing has no type")?)
            }
            _ => {
                let text = format!("{name}_{}_type", self.called(ty)?);
                if self.declared.insert(text.clone()) {
                    let declaration = self.declaration(ty, &text)?;
                    self.typedefs += &declaration;
                }
                text
            }
        })
    }

    /// A declaration of a variable, argument or field.
    pub(super) fn declarator(&mut self, ty: &Type, name: &str) -> Found<String> {
        let ty = self.c_type(ty)?;
        Ok(if ty.ends_with('*') { format!("{ty}{name}") } else { format!("{ty} {name}") })
    }

    fn declaration(&mut self, ty: &Type, name: &str) -> Found<String> {
        let mut text = String::new();
        match ty {
            Type::Array(of, Length::Known(size)) => {
                let of = self.c_type(of)?;
                let _ = write!(text, "\ntypedef struct {{\n    {of} at[{size}];\n}} {name};\n");
            }
            Type::Slice(of) => {
                let of = self.c_type(of)?;
                let _ = write!(text, "\ntypedef struct {{\n    const {of} *at;\n    size_t count;\n}} {name};\n");
            }
            Type::Tuple(all) => {
                text += "\ntypedef struct {\n";
                for (i, ty) in all.iter().enumerate() {
                    let _ = writeln!(text, "    {};", self.declarator(ty, &format!("part_{i}"))?);
                }
                let _ = writeln!(text, "}} {name};");
            }
            Type::Named(of, _) => match self.program.enums.get(of) {
                Some(item) => text += &self.enumeration(item, name)?,
                None => {
                    let item = *self.program.structs.get(of).ok_or_else(|| format!("`{of}` is no type"))?;
                    text += "\n";
                    text += &comment(&item.attrs, "");
                    text += "typedef struct {\n";
                    let fields = self.fields(ty)?;
                    for ((field, ty), item) in fields.iter().zip(&item.fields) {
                        text += &comment(&item.attrs, "    ");
                        let _ = writeln!(text, "    {};", self.declarator(ty, &c_name(field))?);
                    }
                    let _ = writeln!(text, "}} {name};");
                }
            },
            other => return Err(format!("{other:?} has no declaration")),
        }
        Ok(text)
    }

    /// An enum: numbers, and with the fields of its variants if it has any.
    fn enumeration(&mut self, item: &'a syn::ItemEnum, name: &str) -> Found<String> {
        let variants: Vec<String> = item
            .variants
            .iter()
            .map(|variant| format!("    {}", self.variant(&item.ident.to_string(), &variant.ident.to_string())))
            .collect();
        let variants = variants.join(",\n");
        let said = comment(&item.attrs, "");
        if !has_fields(item) {
            return Ok(format!("\n{said}typedef enum {{\n{variants}\n}} {name};\n"));
        }
        // The enum is declared outside of the struct: C++ finds names declared in a struct only in its scope.
        let number = format!("{}_variant_type", name.strip_suffix("_type").unwrap_or(name));
        let mut text = format!("\ntypedef enum {{\n{variants}\n}} {number};\n\n{said}typedef struct {{\n    {number} variant;\n");
        for field in item.variants.iter().flat_map(|variant| &variant.fields) {
            let ty = self.written(&field.ty, &BTreeMap::new())?;
            let field = field.ident.as_ref().ok_or("a field without a name")?;
            let _ = writeln!(text, "    {};", self.declarator(&ty, &c_name(&field.to_string()))?);
        }
        Ok(text + &format!("}} {name};\n"))
    }

    pub(super) fn variant(&self, of: &str, variant: &str) -> String {
        format!("{}_{}_{}", self.upper, snake(of).to_ascii_uppercase(), snake(variant).to_ascii_uppercase())
    }
}

/// Whether variants of an enum have fields.
pub(super) fn has_fields(item: &syn::ItemEnum) -> bool {
    item.variants.iter().any(|variant| !variant.fields.is_empty())
}

/// `CircleRoots` as `circle_roots`.
pub(super) fn snake(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        if c.is_ascii_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.push(c.to_ascii_lowercase());
    }
    text
}

/// Appends an underscore to a name that C or C++ reserves, or that system headers define as a macro.
pub(super) fn c_name(name: &str) -> String {
    const TAKEN: &[&str] = &[
        "double",
        "float",
        "long",
        "short",
        "int",
        "char",
        "signed",
        "unsigned",
        "register",
        "auto",
        "default",
        "switch",
        "case",
        "do",
        "goto",
        "union",
        "volatile",
        "void",
        "sizeof",
        "new",
        "delete",
        "class",
        "this",
        "template",
        "typename",
        "operator",
        "private",
        "public",
        "protected",
        "namespace",
        "using",
        "virtual",
        "friend",
        "throw",
        "catch",
        "export",
        "and",
        "or",
        "not",
        "xor",
        "near",
        "far",
        "small",
        "bool",
        "inline",
        "static",
        "extern",
        "real",
    ];
    if TAKEN.contains(&name) {
        format!("{name}_")
    } else {
        name.trim_start_matches("r#").to_owned()
    }
}

/// The documentation of an item as a comment.
pub(super) fn comment(attributes: &[syn::Attribute], indent: &str) -> String {
    let mut lines = Vec::new();
    for attribute in attributes {
        let syn::Meta::NameValue(value) = &attribute.meta else { continue };
        let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) = &value.value else { continue };
        if names(&value.path) == ["doc"] {
            let text = text.value().replace("[`", "`").replace("`]", "`").replace("*/", "* /");
            lines.push(text.strip_prefix(' ').unwrap_or(&text).to_owned());
        }
    }
    match &lines[..] {
        [] => String::new(),
        [line] => format!("{indent}/* {line} */\n"),
        lines => {
            let mut text = format!("{indent}/*\n");
            for line in lines {
                text += format!("{indent} * {line}").trim_end();
                text += "\n";
            }
            text + &format!("{indent} */\n")
        }
    }
}
