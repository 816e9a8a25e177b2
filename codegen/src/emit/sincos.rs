//! Sine and cosine in the emitted module: where the functions ask for them, and the private block that answers.
//!
//! `libm` and `std` answer angle by angle. `fast` answers for a whole array: the text in `sincos/fast_f64.rs` and `sincos/fast_f32.rs`, real Rust
//! files that are taken in as they stand. A function then hands over the shortest piece of `q` that holds its angles, so that they are loaded as
//! vectors: a copy of chosen ones, written number by number and read back as a vector, costs more than the sines do.

use std::collections::BTreeMap;

use proc_macro2::TokenStream;
use quote::{format_ident, quote, ToTokens};
use syn::Item;

use super::rust::usize_literal;
use crate::program::{Module, Scalar, Trig};
use crate::ring::Symbol;

const FAST_F64: &str = include_str!("sincos/fast_f64.rs");
const FAST_F32: &str = include_str!("sincos/fast_f32.rs");

/// Fewer joints than this are a few: the loop over them is called, not taken in.
const FEW: usize = 6;

/// Which of sine and cosine a function uses, angle by angle.
fn angles(symbols: &[Symbol]) -> BTreeMap<usize, (bool, bool)> {
    let mut angles: BTreeMap<usize, (bool, bool)> = BTreeMap::new();
    for symbol in symbols {
        match symbol {
            Symbol::Sine(i) => angles.entry(usize::from(*i)).or_default().0 = true,
            Symbol::Cosine(i) => angles.entry(usize::from(*i)).or_default().1 = true,
            _ => {}
        }
    }
    angles
}

/// The lines that give `s1`, `c1` and so on for the angles among the symbols of a function.
pub(super) fn lines(module: &Module, symbols: &[Symbol]) -> Vec<TokenStream> {
    let angles = angles(symbols);
    match module.trig {
        Trig::Libm | Trig::Std => {
            let line = |(&i, &(sine, cosine)): (&usize, &(bool, bool))| {
                let (s, c, index) = (name("s", i, sine), name("c", i, cosine), usize_literal(i));
                quote!(let (#s, #c) = sin_cos(q[#index]);)
            };
            angles.iter().map(line).collect()
        }
        Trig::Fast => together(&angles, module.joints.len()),
    }
}

fn name(letter: &str, angle: usize, used: bool) -> TokenStream {
    if used {
        format_ident!("{letter}{}", angle + 1).to_token_stream()
    } else {
        quote!(_)
    }
}

/// `let ([s1, s2], [c1, c2]) = sin_cos_all(q);`, of a piece of `q` where the function does not use its ends.
fn together(angles: &BTreeMap<usize, (bool, bool)>, dof: usize) -> Vec<TokenStream> {
    let Some((first, last)) = piece(angles, dof) else { return Vec::new() };
    let all = first..=last;
    let names = |letter: &str, used: fn(&(bool, bool)) -> bool| {
        let names = all.clone().map(|i| name(letter, i, angles.get(&i).is_some_and(used)));
        quote!([#(#names),*])
    };
    let (sines, cosines) = (names("s", |u| u.0), names("c", |u| u.1));
    let call = format_ident!("{}", if last - first + 1 < FEW { "sin_cos_few" } else { "sin_cos_all" });
    if (first, last) == (0, dof - 1) {
        return vec![quote!(let (#sines, #cosines) = #call(q);)];
    }
    let (before, after) = (vec![quote!(_,); first], vec![quote!(, _); dof - 1 - last]);
    vec![quote!(let [#(#before)* angles @ .. #(#after)*] = q;), quote!(let (#sines, #cosines) = #call(angles);)]
}

/// The first and the last joint of the piece of `q` to hand over: three or more joints in an even number where there are further ones, because
/// vectors are even.
fn piece(angles: &BTreeMap<usize, (bool, bool)>, dof: usize) -> Option<(usize, usize)> {
    let (&first, &last) = (angles.keys().next()?, angles.keys().next_back()?);
    let count = last - first + 1;
    Some(match count >= 3 && count % 2 == 1 {
        true if last + 1 < dof => (first, last + 1),
        true if first > 0 => (first - 1, last),
        _ => (first, last),
    })
}

/// Whether a function asks for a few angles only.
fn asks_for_few(symbols: &[Symbol], dof: usize) -> bool {
    piece(&angles(symbols), dof).is_some_and(|(first, last)| last - first + 1 < FEW)
}

/// The lines that give `s1`, `c1` and so on as arrays of lanes, and those in the loop over lanes `k` that give the numbers.
pub(super) fn lines_of_lanes(symbols: &[Symbol]) -> (Vec<TokenStream>, Vec<TokenStream>) {
    let (mut before, mut inside) = (Vec::new(), Vec::new());
    for (i, (sine, cosine)) in angles(symbols) {
        let (s, c, index) = (name("s", i, sine), name("c", i, cosine), usize_literal(i));
        before.push(quote!(let (#s, #c) = sin_cos_lanes(&q[#index]);));
        inside.extend([(s, sine), (c, cosine)].iter().filter(|(_, used)| *used).map(|(name, _)| quote!(let #name = #name[k];)));
    }
    (before, inside)
}

/// The private function behind those lines.
pub(super) fn of_lanes(module: &Module) -> TokenStream {
    let body = match module.trig {
        Trig::Fast => quote!(sin_cos_all(x)),
        Trig::Libm | Trig::Std => quote! {
            let (mut sines, mut cosines) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                (sines[k], cosines[k]) = sin_cos(x[k]);
            }
            (sines, cosines)
        },
    };
    quote! {
        /// Sines and cosines of the angles of one joint, rad.
        #[allow(clippy::all)]
        #[inline(never)]
        fn sin_cos_lanes(x: &Lanes) -> (Lanes, Lanes) {
            #body
        }
    }
}

/// The private functions behind the lines, for the symbols of each function.
pub(super) fn functions(module: &Module, functions: &[Vec<Symbol>]) -> TokenStream {
    let call = match (module.trig, module.scalar) {
        (Trig::Fast, scalar) => {
            let mut file = syn::parse_file(if scalar == Scalar::F64 { FAST_F64 } else { FAST_F32 })
                .expect("the text to take in is a Rust file");
            if !functions.iter().any(|symbols| asks_for_few(symbols, module.joints.len())) {
                file.items.retain(|item| !matches!(item, Item::Fn(function) if function.sig.ident == "sin_cos_few"));
            }
            return file.into_token_stream();
        }
        (Trig::Std, _) => quote!(x.sin_cos()),
        (Trig::Libm, Scalar::F64) => quote!(libm::sincos(x)),
        (Trig::Libm, Scalar::F32) => quote!(libm::sincosf(x)),
    };
    quote! {
        /// Sine and cosine of an angle in rad.
        #[inline]
        fn sin_cos(x: Real) -> (Real, Real) {
            #call
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(symbols: &[Symbol], dof: usize, expected: &[&str]) {
        let lines = together(&angles(symbols), dof);
        let lines: Vec<String> = lines.iter().map(|line| line.to_string().replace(' ', "")).collect();
        let expected: Vec<String> = expected.iter().map(|line| line.replace(' ', "")).collect();
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_function_without_angles_asks_for_none() {
        check(&[Symbol::Position(0)], 1, &[]);
    }

    #[test]
    fn angles_of_all_joints_are_one_array() {
        let symbols = [Symbol::Sine(0), Symbol::Cosine(0), Symbol::Cosine(1), Symbol::Sine(3)];
        check(&symbols, 4, &["let ([s1, _, _, s4], [c1, c2, _, _]) = sin_cos_few(q);"]);
    }

    #[test]
    fn a_piece_of_the_joints_is_handed_over_in_even_numbers() {
        let two = [Symbol::Sine(1), Symbol::Cosine(2)];
        check(&two, 4, &["let [_, angles @ .., _] = q;", "let ([s2, _], [_, c3]) = sin_cos_few(angles);"]);
        let three = [Symbol::Sine(1), Symbol::Cosine(3)];
        check(&three, 5, &["let [_, angles @ ..] = q;", "let ([s2, _, _, _], [_, _, c4, _]) = sin_cos_few(angles);"]);
        check(&three, 4, &["let ([_, s2, _, _], [_, _, _, c4]) = sin_cos_few(q);"]);
        check(&[Symbol::Sine(0), Symbol::Sine(2)], 3, &["let ([s1, _, s3], [_, _, _]) = sin_cos_few(q);"]);
    }

    #[test]
    fn many_angles_are_taken_in_where_they_are_asked_for() {
        let seven: Vec<Symbol> = (0..7).map(Symbol::Sine).collect();
        check(&seven, 7, &["let ([s1, s2, s3, s4, s5, s6, s7], [_, _, _, _, _, _, _]) = sin_cos_all(q);"]);
        check(
            &seven[1..6],
            7,
            &["let [_, angles @ ..] = q;", "let ([s2, s3, s4, s5, s6, _], [_, _, _, _, _, _]) = sin_cos_all(angles);"],
        );
    }

    #[test]
    fn the_text_to_take_in_is_rust() {
        for text in [FAST_F64, FAST_F32] {
            assert!(syn::parse_file(text).is_ok_and(|file| file.items.len() == 5));
        }
    }
}
