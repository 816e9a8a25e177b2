//! Sine and cosine in the emitted module: where the functions ask for them, and the private block that answers.
//!
//! `libm` and `std` answer angle by angle. `fast` answers for four or eight angles at once: the text in `sincos/fast_f64.rs` and
//! `sincos/fast_f32.rs`, real Rust files that are taken in as they stand. Its angles are arguments one by one, which travel in registers:
//! a processor that reads a vector from numbers that were just written one by one waits for all the writes, longer than the sines take.
//! One or two angles gain nothing from vectors and are asked for alone.

use std::collections::BTreeMap;

use proc_macro2::TokenStream;
use quote::{format_ident, quote, ToTokens};
use syn::Item;

use super::rust::usize_literal;
use crate::program::{Module, Scalar, Trig};
use crate::ring::Symbol;

const FAST_F64: &str = include_str!("sincos/fast_f64.rs");
const FAST_F32: &str = include_str!("sincos/fast_f32.rs");

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
        Trig::Fast => together(&angles),
    }
}

fn name(letter: &str, angle: usize, used: bool) -> TokenStream {
    if used {
        format_ident!("{letter}{}", angle + 1).to_token_stream()
    } else {
        quote!(_)
    }
}

/// `let ([s1, s2, s3, _], [c1, c2, c3, _]) = sin_cos_four(3, q[0], q[1], q[2], q[2]);` and so on: the lanes that are left repeat the last angle.
fn together(angles: &BTreeMap<usize, (bool, bool)>) -> Vec<TokenStream> {
    let angles: Vec<(usize, (bool, bool))> = angles.iter().map(|(&i, &used)| (i, used)).collect();
    let mut lines = Vec::new();
    for group in angles.chunks(8) {
        let (lanes, function) = match group.len() {
            1 | 2 => {
                lines.extend(group.iter().map(|&(i, (sine, cosine))| {
                    let (s, c, index) = (name("s", i, sine), name("c", i, cosine), usize_literal(i));
                    quote!(let (#s, #c) = sin_cos_one(q[#index]);)
                }));
                continue;
            }
            3 | 4 => (4, "sin_cos_four"),
            _ => (8, "sin_cos_eight"),
        };
        let (function, count) = (format_ident!("{function}"), usize_literal(group.len()));
        let names = |letter: &str, used: fn(&(bool, bool)) -> bool| {
            let names = (0..lanes).map(|lane| group.get(lane).map_or(quote!(_), |(i, u)| name(letter, *i, used(u))));
            quote!([#(#names),*])
        };
        let (sines, cosines) = (names("s", |u| u.0), names("c", |u| u.1));
        let arguments = (0..lanes).map(|lane| usize_literal(group[lane.min(group.len() - 1)].0));
        lines.push(quote!(let (#sines, #cosines) = #function(#count, #(q[#arguments]),*);));
    }
    lines
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
        Trig::Fast => quote! {
            let mut inside = true;
            for k in 0..LANES {
                (sines[k], cosines[k]) = sin_cos(x[k]);
                inside &= x[k].abs() <= SIN_COS_RANGE;
            }
            if !inside {
                for k in 0..LANES {
                    (sines[k], cosines[k]) = sin_cos_one(x[k]);
                }
            }
        },
        Trig::Libm | Trig::Std => quote! {
            for k in 0..LANES {
                (sines[k], cosines[k]) = sin_cos(x[k]);
            }
        },
    };
    quote! {
        /// Sines and cosines of the angles of one joint, rad.
        #[allow(clippy::all)]
        #[inline(never)]
        fn sin_cos_lanes(x: &Lanes) -> (Lanes, Lanes) {
            let (mut sines, mut cosines) = ([0.0; LANES], [0.0; LANES]);
            #body
            (sines, cosines)
        }
    }
}

/// The private functions behind the lines, for the symbols of each function.
pub(super) fn functions(module: &Module, functions: &[Vec<Symbol>]) -> TokenStream {
    let call = match (module.trig, module.scalar) {
        (Trig::Fast, scalar) => return fast(scalar, functions),
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

/// The items of the text for `fast` that these functions need.
fn fast(scalar: Scalar, functions: &[Vec<Symbol>]) -> TokenStream {
    let mut file =
        syn::parse_file(if scalar == Scalar::F64 { FAST_F64 } else { FAST_F32 }).expect("the text to take in is a Rust file");
    let calls: String = functions.iter().flat_map(|symbols| together(&angles(symbols))).map(|line| line.to_string()).collect();
    let unused: Vec<&str> = ["four", "eight"].into_iter().filter(|lanes| !calls.contains(&format!("sin_cos_{lanes}"))).collect();
    file.items.retain(|item| match item {
        Item::Fn(function) => !unused.iter().any(|lanes| function.sig.ident.to_string().ends_with(lanes)),
        Item::Const(constant) => constant.ident != "SIN_COS_VECTORS" || unused.len() < 2,
        _ => true,
    });
    file.into_token_stream()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(symbols: &[Symbol], expected: &[&str]) {
        let lines = together(&angles(symbols));
        let lines: Vec<String> = lines.iter().map(|line| line.to_string().replace(' ', "")).collect();
        let expected: Vec<String> = expected.iter().map(|line| line.replace(' ', "")).collect();
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_function_without_angles_asks_for_none() {
        check(&[Symbol::Position(0)], &[]);
    }

    #[test]
    fn one_or_two_angles_are_asked_for_alone() {
        let two = [Symbol::Sine(1), Symbol::Cosine(3), Symbol::Sine(3)];
        check(&two, &["let (s2, _) = sin_cos_one(q[1]);", "let (s4, c4) = sin_cos_one(q[3]);"]);
    }

    #[test]
    fn lanes_that_are_left_repeat_the_last_angle() {
        let three = [Symbol::Sine(0), Symbol::Cosine(0), Symbol::Cosine(1), Symbol::Sine(3)];
        check(&three, &["let ([s1, _, s4, _], [c1, c2, _, _]) = sin_cos_four(3, q[0], q[1], q[3], q[3]);"]);
        let five: Vec<Symbol> = (0..5).map(Symbol::Sine).collect();
        check(
            &five,
            &["let ([s1, s2, s3, s4, s5, _, _, _], [_, _, _, _, _, _, _, _]) = sin_cos_eight(5, q[0], q[1], q[2], q[3], q[4], q[4], q[4], q[4]);"],
        );
    }

    #[test]
    fn more_than_eight_angles_come_in_groups() {
        let nine: Vec<Symbol> = (0..9).map(Symbol::Cosine).collect();
        let eight = "let ([_, _, _, _, _, _, _, _], [c1, c2, c3, c4, c5, c6, c7, c8]) = sin_cos_eight(8, q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7]);";
        check(&nine, &[eight, "let (_, c9) = sin_cos_one(q[8]);"]);
    }

    #[test]
    fn only_what_is_called_is_taken_in() {
        let texts = |count: u8| fast(Scalar::F64, &[(0..count).map(|i| Symbol::Sine(i.into())).collect()]).to_string();
        for (count, four, eight) in [(2, false, false), (3, true, false), (8, false, true), (11, true, true)] {
            let text = texts(count);
            assert_eq!(
                (text.contains("_four"), text.contains("_eight"), text.contains("VECTORS")),
                (four, eight, four || eight),
                "{count}"
            );
        }
    }
}
