//! Calls of the functions for many states, of the modules `lanes` and `batch`.

use quote::{quote, ToTokens};
use syn::{Fields, FnArg, Item, ItemFn, ItemMod, ItemStruct, Type};

use crate::public;

/// Rust text to be included next to the emitted module `module`: `each_function_of_many_states`, which calls every public function of `lanes`
/// and `batch`. Arguments are zeros and results are memory, both opaque to the optimiser. Slices are longer than two blocks by one state.
pub fn calls_of_many_states(module: &str) -> String {
    let file = syn::parse_file(module).expect("an emitted module is a Rust file");
    let (lanes, batch) = (items_of(&file.items, "lanes"), items_of(&file.items, "batch"));
    let zeros =
        structs(&file.items).map(|item| zero(item, quote!())).chain(structs(lanes).map(|item| zero(item, quote!(lanes::))));
    let calls = public(lanes).map(|item| call(item, quote!(lanes))).chain(public(batch).map(|item| call(item, quote!(batch))));
    let tokens = quote! {
        /// A value to begin with.
        trait Zero: Copy {
            const ZERO: Self;
        }
        impl Zero for Real {
            const ZERO: Self = 0.0;
        }
        impl<T: Zero, const N: usize> Zero for [T; N] {
            const ZERO: Self = [T::ZERO; N];
        }
        impl<A: Zero, B: Zero> Zero for (A, B) {
            const ZERO: Self = (A::ZERO, B::ZERO);
        }
        impl<A: Zero, B: Zero, C: Zero> Zero for (A, B, C) {
            const ZERO: Self = (A::ZERO, B::ZERO, C::ZERO);
        }
        #(#zeros)*
        /// Calls each function for many states.
        pub fn each_function_of_many_states() {
            #(#calls)*
        }
    };
    prettyplease::unparse(&syn::parse2(tokens).expect("calls are a Rust file"))
}

fn items_of<'a>(items: &'a [Item], module: &str) -> &'a [Item] {
    let content = |item: &'a ItemMod| item.content.as_ref().map(|(_, items)| items.as_slice());
    let found = items.iter().find_map(|item| match item {
        Item::Mod(item) if item.ident == module => content(item),
        _ => None,
    });
    found.unwrap_or_else(|| panic!("the module was generated without `{module}`"))
}

fn structs(items: &[Item]) -> impl Iterator<Item = &ItemStruct> {
    items.iter().filter_map(|item| match item {
        Item::Struct(item) if matches!(item.fields, Fields::Named(_)) => Some(item),
        _ => None,
    })
}

/// Zeros in all fields.
fn zero(item: &ItemStruct, path: impl ToTokens) -> impl ToTokens {
    let (name, fields) = (&item.ident, item.fields.iter().map(|field| &field.ident));
    quote! {
        impl Zero for #path #name {
            const ZERO: Self = Self { #(#fields: Zero::ZERO),* };
        }
    }
}

fn call(function: &ItemFn, module: impl ToTokens) -> impl ToTokens {
    let values = function.sig.inputs.iter().map(|input| {
        let FnArg::Typed(input) = input else { unreachable!("emitted functions are free") };
        let Type::Reference(reference) = &*input.ty else { unreachable!("arguments of many states are references") };
        let slice = matches!(*reference.elem, Type::Slice(_));
        match (slice, reference.mutability.is_some()) {
            (true, true) => quote!(core::hint::black_box::<&mut [_]>(&mut [Zero::ZERO; 2 * lanes::LANES + 1])),
            (true, false) => quote!(core::hint::black_box::<&[_]>(&[Zero::ZERO; 2 * lanes::LANES + 1])),
            (false, true) => quote!(core::hint::black_box(&mut { Zero::ZERO })),
            (false, false) => quote!(core::hint::black_box(&Zero::ZERO)),
        }
    });
    let name = &function.sig.ident;
    quote!(#module::#name(#(#values),*);)
}
