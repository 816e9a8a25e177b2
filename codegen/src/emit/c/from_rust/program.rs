//! The items of a text, by their names.

use std::collections::BTreeMap;

use syn::visit::Visit;

/// A function, or a method of a type with the sizes of its `impl`.
#[derive(Clone, Copy)]
pub(super) struct Function<'a> {
    pub(super) of: Option<&'a syn::ItemImpl>,
    pub(super) attributes: &'a [syn::Attribute],
    pub(super) signature: &'a syn::Signature,
    pub(super) block: &'a syn::Block,
}

/// All items, and the macros that expand to expressions.
#[derive(Default)]
pub(super) struct Program<'a> {
    pub(super) aliases: BTreeMap<String, &'a syn::Type>,
    pub(super) structs: BTreeMap<String, &'a syn::ItemStruct>,
    pub(super) enums: BTreeMap<String, &'a syn::ItemEnum>,
    /// Those inside of functions as well.
    pub(super) constants: BTreeMap<String, &'a syn::ItemConst>,
    /// By their names, methods as `Type::method`.
    pub(super) functions: BTreeMap<String, Function<'a>>,
    /// Expansions of macros, by the addresses of their tokens.
    pub(super) macros: BTreeMap<usize, &'a syn::Expr>,
}

/// Expansions of the macros of a text, by the addresses of their expressions.
pub(super) fn expanded(items: &[syn::Item]) -> Result<Vec<(usize, syn::Expr)>, String> {
    struct Expansion(Result<Vec<(usize, syn::Expr)>, String>);
    impl Visit<'_> for Expansion {
        fn visit_expr_macro(&mut self, call: &syn::ExprMacro) {
            let parser = |input: syn::parse::ParseStream<'_>| {
                let subject: syn::Expr = input.parse()?;
                input.parse::<syn::Token![,]>()?;
                Ok((subject, syn::Pat::parse_multi(input)?))
            };
            let found = if call.mac.path.is_ident("matches") {
                syn::parse::Parser::parse2(parser, call.mac.tokens.clone()).map_err(|error| error.to_string())
            } else {
                Err("a macro".into())
            };
            if let Ok(all) = &mut self.0 {
                match found {
                    Ok((subject, pattern)) => {
                        let value = syn::parse_quote!(match #subject { #pattern => true, _ => false });
                        all.push((std::ptr::from_ref(call).addr(), value));
                    }
                    Err(error) => self.0 = Err(error),
                }
            }
        }
    }
    let mut expansion = Expansion(Ok(Vec::new()));
    for item in items {
        expansion.visit_item(item);
    }
    expansion.0
}

impl<'a> Program<'a> {
    pub(super) fn of(items: &'a [syn::Item], expanded: &'a [(usize, syn::Expr)]) -> Result<Self, String> {
        let macros = expanded.iter().map(|(at, value)| (*at, value)).collect();
        let mut program = Program { macros, ..Program::default() };
        for item in items {
            program.visit_item(item);
        }
        for item in items {
            match item {
                syn::Item::Type(item) => {
                    program.aliases.insert(item.ident.to_string(), &item.ty);
                }
                syn::Item::Struct(item) => {
                    program.structs.insert(item.ident.to_string(), item);
                }
                syn::Item::Enum(item) => {
                    program.enums.insert(item.ident.to_string(), item);
                }
                syn::Item::Fn(item) => {
                    let function = Function { of: None, attributes: &item.attrs, signature: &item.sig, block: &item.block };
                    program.functions.insert(item.sig.ident.to_string(), function);
                }
                syn::Item::Impl(item) if item.trait_.is_none() => {
                    let syn::Type::Path(of) = &*item.self_ty else { continue };
                    let of = last(&of.path);
                    for method in &item.items {
                        let syn::ImplItem::Fn(method) = method else { continue };
                        let function =
                            Function { of: Some(item), attributes: &method.attrs, signature: &method.sig, block: &method.block };
                        program.functions.insert(format!("{of}::{}", method.sig.ident), function);
                    }
                }
                syn::Item::Const(_) | syn::Item::Impl(_) => {}
                _ => return Err("an item of another kind".into()),
            }
        }
        Ok(program)
    }
}

impl<'a> Visit<'a> for Program<'a> {
    fn visit_item_const(&mut self, item: &'a syn::ItemConst) {
        self.constants.insert(item.ident.to_string(), item);
        syn::visit::visit_item_const(self, item);
    }
}

impl Program<'_> {
    /// Whether the scalar is of single precision.
    pub(super) fn is_single(&self) -> bool {
        self.aliases.get("Real").is_some_and(|ty| matches!(ty, syn::Type::Path(path) if path.path.is_ident("f32")))
    }
}

/// The last name of a path.
pub(super) fn last(path: &syn::Path) -> String {
    path.segments.last().map(|segment| segment.ident.to_string()).unwrap_or_default()
}

/// The names of a path.
pub(super) fn names(path: &syn::Path) -> Vec<String> {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect()
}

/// The names of the sizes among generics.
pub(super) fn sizes_of(generics: &syn::Generics) -> Vec<String> {
    generics.const_params().map(|parameter| parameter.ident.to_string()).collect()
}

/// The pattern of an arm and its guard.
pub(super) fn guarded(pattern: &syn::Pat) -> (&syn::Pat, Option<&syn::Expr>) {
    match pattern {
        syn::Pat::Guard(guarded) => (&guarded.pat, Some(&guarded.guard)),
        other => (other, None),
    }
}
