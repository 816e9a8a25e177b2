//! Sine and cosine in the emitted module: where the functions ask for them, and the private block that answers.
//!
//! `libm` and `std` take a single angle. `fast` takes four or eight angles at once: `fast_f64.rs` and `fast_f32.rs` of the crate
//! `armgen-elementary`, real Rust files that are included verbatim. Its angles are separate arguments, which travel in
//! registers. A processor that loads a vector just after its numbers were stored one by one waits for all the stores, longer than
//! the sines take. A single angle, and in f32 each of two, gains nothing from vectors and is computed by itself; in f64 an unused
//! sine or cosine is left out.

use std::collections::{BTreeMap, BTreeSet};

use armgen_elementary::texts::{FAST_F32, FAST_F64};
use proc_macro2::{TokenStream, TokenTree};
use quote::{format_ident, quote, ToTokens};
use syn::Item;

use super::literal::literal;
use super::signature::{self, usize_literal};
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::listing::{angles, Angle, Name};
use crate::program::{Function, Module, Trig};
use crate::ring::field::computed::ComputedAngle;
use crate::ring::Symbol;

/// An angle that a function asks for, and the names of its sine and cosine.
struct Asked {
    angle: Angle,
    /// The literal that it adds, with its sign.
    turn: Option<TokenStream>,
    /// The literals that its joint variables are multiplied by.
    factors: Vec<Option<TokenStream>>,
    sine: TokenStream,
    cosine: TokenStream,
}

/// The angles that a function asks for. `turn` is what turned sums add.
fn asked(symbols: &[Symbol], computed: &BTreeMap<u16, ComputedAngle>, turn: Option<&Number>, scalar: Scalar) -> Vec<Asked> {
    let name = |name: Option<Name>| name.map_or(quote!(_), |name| signature::name(name).into_token_stream());
    let one = |angle: Angle| Asked {
        turn: angle.constant(turn).map(|turn| literal(turn, scalar)),
        factors: angle.factors().iter().map(|factor| factor.as_ref().map(|factor| literal(factor, scalar))).collect(),
        sine: name(angle.sine),
        cosine: name(angle.cosine),
        angle,
    };
    angles(symbols, computed).into_iter().map(one).collect()
}

impl Asked {
    /// `+ q[2]`, `- 0.3 * q[3]`, `+ 0.7`: what follows the first joint variable; `entry` writes a joint variable.
    fn more(&self, entry: impl Fn(u16) -> TokenStream) -> Vec<(bool, TokenStream)> {
        let joints =
            self.angle.terms.iter().zip(&self.factors).skip(1).map(|(&(i, minus), factor)| (minus, scaled(factor, entry(i))));
        let turn = self.turn.iter().map(|literal| {
            let mut tokens = literal.clone().into_iter().peekable();
            let minus = tokens.next_if(|token| token.to_string() == "-").is_some();
            (minus, tokens.collect())
        });
        joints.chain(turn).collect()
    }

    /// `q[1] + q[2]`
    fn text(&self) -> TokenStream {
        let mut text = scaled(&self.factors[0], self.first());
        for (minus, term) in self.more(entry) {
            text.extend(if minus { quote!(- #term) } else { quote!(+ #term) });
        }
        text
    }

    /// `let (s2, c2) = sin_cos_one(q[1]);`, or one of the two. In f32 polynomials are so short that to choose one takes as many operations as both.
    fn alone(&self, scalar: Scalar) -> TokenStream {
        let (angle, sine, cosine) = (self.text(), &self.sine, &self.cosine);
        match (scalar, self.angle.sine, self.angle.cosine) {
            (Scalar::F64, Some(_), None) => quote!(let #sine = sin_one(#angle);),
            (Scalar::F64, None, Some(_)) => quote!(let #cosine = cos_one(#angle);),
            _ => quote!(let (#sine, #cosine) = sin_cos_one(#angle);),
        }
    }

    /// `q[1]`
    fn first(&self) -> TokenStream {
        entry(self.angle.terms[0].0)
    }
}

/// `q[1]`, `0.785 * q[1]`
fn scaled(factor: &Option<TokenStream>, entry: TokenStream) -> TokenStream {
    match factor {
        Some(factor) => quote!(#factor * #entry),
        None => entry,
    }
}

fn entry(i: u16) -> TokenStream {
    let index = usize_literal(usize::from(i));
    quote!(q[#index])
}

/// The angles that a function of a module asks for.
fn asked_of(module: &Module, function: &Function) -> Vec<Asked> {
    asked(&function.symbols(), &function.computed, module.turn.as_ref(), module.scalar)
}

/// The lines that give `s1`, `c1` and so on for the angles among the symbols of a function.
pub(super) fn lines(module: &Module, function: &Function) -> Vec<TokenStream> {
    let asked = asked_of(module, function);
    match module.trig {
        Trig::Libm | Trig::Std => {
            let line = |asked: &Asked| {
                let (angle, sine, cosine) = (asked.text(), &asked.sine, &asked.cosine);
                quote!(let (#sine, #cosine) = sin_cos(#angle);)
            };
            asked.iter().map(line).collect()
        }
        Trig::Fast => together(&asked, module.scalar),
    }
}

/// `let ([s1, s2, s3, _], [c1, c2, c3, _]) = sin_cos_four(3, q[0], q[1], q[2], q[2]);` and so on: the lanes that are left repeat the last angle, or the
/// first joint variable of the last sum. Two angles are a vector of f64, and in f32 less than one.
fn together(asked: &[Asked], scalar: Scalar) -> Vec<TokenStream> {
    let mut lines = Vec::new();
    for group in asked.chunks(8) {
        let (lanes, function) = match (group.len(), scalar) {
            (1, _) | (2, Scalar::F32) => {
                lines.extend(group.iter().map(|asked| asked.alone(scalar)));
                continue;
            }
            (2..=4, _) => (4, "sin_cos_four"),
            _ => (8, "sin_cos_eight"),
        };
        let (function, count) = (format_ident!("{function}"), usize_literal(group.len()));
        let names = |of: fn(&Asked) -> &TokenStream| {
            let names = (0..lanes).map(|lane| group.get(lane).map_or(quote!(_), |asked| of(asked).clone()));
            quote!([#(#names),*])
        };
        let (sines, cosines) = (names(|asked| &asked.sine), names(|asked| &asked.cosine));
        let last = &group[group.len() - 1];
        let arguments = (0..lanes).map(|lane| group.get(lane).map_or_else(|| last.first(), Asked::text));
        lines.push(quote!(let (#sines, #cosines) = #function(#count, #(#arguments),*);));
    }
    lines
}

/// The lines that give the sines and cosines of all angles as arrays of lanes, and those in the loop over lanes `k` that name them `s1`, `c1` and so on.
pub(super) fn lines_of_lanes(module: &Module, function: &Function) -> (Vec<TokenStream>, Vec<TokenStream>) {
    let asked = asked_of(module, function);
    if asked.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let (mut added, mut inside) = (Vec::new(), Vec::new());
    for (at, asked) in asked.iter().enumerate() {
        let at = usize_literal(at);
        if let Some(factor) = &asked.factors[0] {
            added.push(quote!(angles[#at][k] *= #factor;));
        }
        let lane = |i: u16| {
            let entry = entry(i);
            quote!(#entry[k])
        };
        for (minus, term) in asked.more(lane) {
            added.push(if minus { quote!(angles[#at][k] -= #term;) } else { quote!(angles[#at][k] += #term;) });
        }
        for (name, from) in [(&asked.sine, quote!(sines)), (&asked.cosine, quote!(cosines))] {
            if name.to_string() != "_" {
                inside.push(quote!(let #name = #from[#at][k];));
            }
        }
    }
    let (first, count) = (asked.iter().map(Asked::first), usize_literal(asked.len()));
    let mut before = if added.is_empty() {
        vec![quote!(let angles = [#(#first),*];)]
    } else {
        vec![quote!(let mut angles = [#(#first),*];), quote!(for k in 0..LANES { #(#added)* })]
    };
    before.push(quote!(let mut waves = Aligned([[[0.0; LANES]; #count]; 2]);));
    before.push(quote!(let [sines, cosines] = &mut waves.0;));
    before.push(quote!(sin_cos_lanes(&angles, sines, cosines);));
    (before, inside)
}

/// The private function that those lines call. It takes all angles of a function, so that the processor computes those of one while it waits for
/// another's. Results by reference save a copy, and the range is tested apart, since a test for each angle would be a step of each sine.
pub(super) fn of_lanes(module: &Module) -> TokenStream {
    let each = |function: &TokenStream| {
        quote! {
            for ((x, sines), cosines) in x.iter().zip(sines.iter_mut()).zip(cosines.iter_mut()) {
                for k in 0..LANES {
                    (sines[k], cosines[k]) = #function(x[k]);
                }
            }
        }
    };
    let all = each(&quote!(sin_cos));
    let beyond = (module.trig == Trig::Fast).then(|| {
        let one = each(&quote!(sin_cos_one));
        // As wide as the scalar: comparisons in vectors are.
        let bits = match module.scalar {
            Scalar::F64 => quote!(u64),
            Scalar::F32 => quote!(u32),
        };
        quote! {
            let beyond = |x: &Real| #bits::from(!(x.abs() <= SIN_COS_RANGE));
            if x.as_flattened().iter().fold(0, |any, x| any | beyond(x)) != 0 {
                #one
            }
        }
    });
    quote! {
        /// Begins with a line of the cache, as does then the stack of a function that holds it: no vector there lies in two lines.
        #[repr(align(64))]
        struct Aligned<T>(T);

        /// Sines and cosines of angles of each state, rad.
        #[allow(clippy::all)]
        #[inline(never)]
        fn sin_cos_lanes(x: &[Lanes], sines: &mut [Lanes], cosines: &mut [Lanes]) {
            #all
            #beyond
        }
    }
}

/// The private functions that the lines of all functions call.
pub(super) fn functions(module: &Module) -> TokenStream {
    let call = match (module.trig, module.scalar) {
        (Trig::Fast, scalar) => {
            let lines = module.functions.iter().flat_map(|function| lines(module, function));
            let of_lanes = module.batch.map(|_| of_lanes(module));
            return fast(scalar, quote!(#(#lines)* #of_lanes));
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

/// The items of the text for `fast` that these lines name, and those that such items name themselves.
fn fast(scalar: Scalar, lines: TokenStream) -> TokenStream {
    let mut file =
        syn::parse_file(if scalar == Scalar::F64 { FAST_F64 } else { FAST_F32 }).expect("the text to take in is a Rust file");
    let (mut needed, mut new) = (BTreeSet::new(), names(lines));
    while !new.is_empty() {
        needed.append(&mut new);
        let items = file.items.iter().filter(|item| needed.contains(&name(item)));
        new = items.flat_map(|item| names(item.to_token_stream())).filter(|name| !needed.contains(name)).collect();
    }
    file.items.retain(|item| needed.contains(&name(item)));
    file.into_token_stream()
}

/// The name of a function or a constant.
fn name(item: &Item) -> String {
    match item {
        Item::Fn(function) => function.sig.ident.to_string(),
        Item::Const(constant) => constant.ident.to_string(),
        _ => unreachable!("the texts have functions and constants alone"),
    }
}

/// All names in a text.
fn names(text: TokenStream) -> BTreeSet<String> {
    let of_token = |token| match token {
        TokenTree::Ident(name) => BTreeSet::from([name.to_string()]),
        TokenTree::Group(group) => names(group.stream()),
        _ => BTreeSet::new(),
    };
    text.into_iter().flat_map(of_token).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Rational;
    use crate::ring::AngleSum;

    #[track_caller]
    fn check(symbols: &[Symbol], expected: &[&str]) {
        check_in(Scalar::F64, symbols, expected);
    }

    #[track_caller]
    fn check_in(scalar: Scalar, symbols: &[Symbol], expected: &[&str]) {
        let turn = Number::from(Rational::from_parts((-1).into(), 2u8.into()));
        let lines = together(&asked(symbols, &BTreeMap::new(), Some(&turn), scalar), scalar);
        let lines: Vec<String> = lines.iter().map(|line| line.to_string().replace(' ', "")).collect();
        let expected: Vec<String> = expected.iter().map(|line| line.replace(' ', "")).collect();
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_function_without_angles_asks_for_none() {
        check(&[Symbol::Position(0)], &[]);
    }

    #[test]
    fn one_angle_is_asked_for_alone_and_in_single_precision_two_are() {
        check(&[Symbol::Sine(1), Symbol::Cosine(1)], &["let (s2, c2) = sin_cos_one(q[1]);"]);
        let two = [Symbol::Sine(1), Symbol::Cosine(3), Symbol::Sine(3)];
        check(&two, &["let ([s2, s4, _, _], [_, c4, _, _]) = sin_cos_four(2, q[1], q[3], q[3], q[3]);"]);
        check_in(Scalar::F32, &two, &["let (s2, _) = sin_cos_one(q[1]);", "let (s4, c4) = sin_cos_one(q[3]);"]);
    }

    #[test]
    fn of_one_angle_in_double_precision_what_is_not_needed_is_not_asked_for() {
        check(&[Symbol::Sine(1)], &["let s2 = sin_one(q[1]);"]);
        check(&[Symbol::Cosine(1)], &["let c2 = cos_one(q[1]);"]);
        check_in(Scalar::F32, &[Symbol::Sine(1)], &["let (s2, _) = sin_cos_one(q[1]);"]);
        check_in(Scalar::F32, &[Symbol::Cosine(1)], &["let (_, c2) = sin_cos_one(q[1]);"]);
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
        check(&nine, &[eight, "let c9 = cos_one(q[8]);"]);
    }

    #[test]
    fn sums_of_angles_come_first_and_are_added_up_once() {
        let sum = AngleSum { plus: 0b110, minus: 0, turned: false };
        let less = AngleSum { plus: 0b1, minus: 0b1000, turned: false };
        check(
            &[Symbol::SineOf(sum), Symbol::Cosine(4)],
            &["let ([s2_3, _, _, _], [_, c5, _, _]) = sin_cos_four(2, q[1] + q[2], q[4], q[4], q[4]);"],
        );
        let three = AngleSum { plus: 0b111, minus: 0, turned: false };
        check(
            &[Symbol::SineOf(sum), Symbol::CosineOf(less), Symbol::SineOf(three)],
            &["let ([_, s2_3, s1_2_3, _], [c1_less_4, _, _, _]) = sin_cos_four(3, q[0] - q[3], q[1] + q[2], q[0] + q[1] + q[2], q[0]);"],
        );
    }

    #[test]
    fn a_turned_sum_adds_a_constant() {
        let turned = AngleSum { turned: true, ..AngleSum::of(6) };
        let pair = [Symbol::SineOf(turned), Symbol::CosineOf(turned)];
        check(&pair, &["let (s7_turned, c7_turned) = sin_cos_one(q[6] - 0.5);"]);
        let with_another = AngleSum { turned: true, plus: 0b110, minus: 0 };
        check(&[Symbol::SineOf(with_another)], &["let s2_3_turned = sin_one(q[1] + q[2] - 0.5);"]);
    }

    #[test]
    fn only_what_is_called_is_taken_in() {
        let items = |scalar, count: u8, of: fn(u8) -> Vec<Symbol>| {
            let symbols: Vec<Symbol> = (0..count).flat_map(of).collect();
            let lines = together(&asked(&symbols, &BTreeMap::new(), None, scalar), scalar);
            let file: syn::File = syn::parse2(fast(scalar, quote!(#(#lines)*))).expect("a file");
            file.items.iter().map(name).collect::<Vec<_>>()
        };
        let sine = |i: u8| vec![Symbol::Sine(i.into())];
        let both = |i: u8| vec![Symbol::Sine(i.into()), Symbol::Cosine(i.into())];
        let alone = [
            "SIN_COS_RANGE",
            "sin_cos_quadrant",
            "SIN_COS_POLYNOMIALS",
            "sin_cos_polynomial",
            "SIN_COS_QUADRANTS",
            "sin_one",
            "sin_alone",
            "sin_cos_beyond",
        ];
        assert_eq!(items(Scalar::F64, 1, sine), alone);
        let pair = [
            "SIN_COS_RANGE",
            "sin_cos_quadrant",
            "SIN_COS_POLYNOMIALS",
            "sin_cos_polynomial",
            "sin_cos_of_rest",
            "SIN_COS_QUADRANTS",
            "sin_cos_one",
            "sin_cos_beyond",
        ];
        assert_eq!(items(Scalar::F64, 1, both), pair);
        let of_f32 = ["SIN_COS_RANGE", "sin_cos", "sin_cos_reduced", "sin_cos_one", "sin_cos_beyond"];
        assert_eq!(items(Scalar::F32, 1, sine), of_f32);
        for (count, four, eight) in [(2, true, false), (8, false, true), (11, true, true)] {
            let items = items(Scalar::F64, count, sine);
            let has = |name: &str| items.iter().any(|item| item == name);
            assert_eq!((has("sin_cos_four"), has("sin_cos_each_of_four"), has("sin_cos_eight")), (four, four, eight), "{count}");
            assert!(has("sin_cos") && has("sin_cos_one") && has("SIN_COS_VECTORS") && !has("sin_one"));
        }
    }
}
