//! The public functions of a crate and the functions that a file names, for holding one against the other.

use std::{collections::BTreeSet, fs, path::Path};
use syn::{visit::Visit, Attribute, ImplItem, Item, TraitItem, Visibility};

/// Public functions of the crate with this `src/lib.rs`: a free one by its name, the rest as `Type::method` or `Trait::method`.
///
/// A module under a `cfg` is left out: it only exists with an operating system, or in tests.
///
/// # Panics
/// Where a module is not a readable Rust file: a test cannot go on without it.
pub fn public_functions(lib: &Path) -> BTreeSet<String> {
    let mut functions = BTreeSet::new();
    module(lib, lib.parent().expect("a file is in a folder"), &mut functions);
    functions
}

/// Functions of this Rust text that are named by a path, in the notation of [`public_functions`]; of `module::function` the last name.
///
/// # Panics
/// Where the text is not Rust.
pub fn named_functions(text: &str) -> BTreeSet<String> {
    struct Paths(BTreeSet<String>);
    impl<'a> Visit<'a> for Paths {
        fn visit_expr_path(&mut self, path: &'a syn::ExprPath) {
            let names: Vec<String> = path.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            let is_type = |name: &String| name.starts_with(|first: char| first.is_uppercase());
            match names.as_slice() {
                [.., of, name] if is_type(of) => self.0.insert(format!("{of}::{name}")),
                [.., name] => self.0.insert(name.clone()),
                [] => false,
            };
        }
    }
    let mut paths = Paths(BTreeSet::new());
    paths.visit_file(&syn::parse_file(text).expect("the file is Rust"));
    paths.0
}

fn has_cfg(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident("cfg"))
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Adds the functions of `file`, whose modules are files in `folder`.
fn module(file: &Path, folder: &Path, functions: &mut BTreeSet<String>) {
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    for item in parsed.items {
        match item {
            Item::Mod(item) if !has_cfg(&item.attrs) => {
                let name = item.ident.to_string();
                assert!(item.content.is_none(), "{}: the inline module {name} is not read", file.display());
                module(&folder.join(format!("{name}.rs")), &folder.join(name), functions);
            }
            Item::Fn(item) if is_public(&item.vis) => {
                functions.insert(item.sig.ident.to_string());
            }
            Item::Trait(item) if is_public(&item.vis) => {
                for method in &item.items {
                    if let TraitItem::Fn(method) = method {
                        functions.insert(format!("{}::{}", item.ident, method.sig.ident));
                    }
                }
            }
            Item::Impl(item) if item.trait_.is_none() => {
                let syn::Type::Path(of) = &*item.self_ty else { continue };
                let of = &of.path.segments.last().expect("a path has a name").ident;
                for method in &item.items {
                    match method {
                        ImplItem::Fn(method) if is_public(&method.vis) && !has_cfg(&method.attrs) => {
                            functions.insert(format!("{of}::{}", method.sig.ident));
                        }
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
}
