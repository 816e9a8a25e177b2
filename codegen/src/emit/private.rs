//! Common part of the private functions of all languages, whose texts are templates: numbers and polynomials of the sines, and
//! their documentation.
//!
//! `@NAME@` in a template is a number or a polynomial; a comment line that ends in `@NAME@` is a paragraph.

use crate::kinds::Scalar;

/// Documentation of the sign of a rate.
pub(super) const SIGN: &str = "Sign of a rate: 0 at rest, not a number for what is not a number.";

const SINES: [&str; 5] = [
    REDUCTION[0],
    REDUCTION[1],
    REDUCTION[2],
    "|r| <= pi/4 (Remez). h is n/2 rounded to the nearest integer, halves to the even one: n - 2h and h modulo 2 say which of the two is the sine,",
    "and the signs.",
];

const SINES_OF_ARRAYS: [&str; 5] = [
    REDUCTION[0],
    REDUCTION[1],
    REDUCTION[2],
    "|r| <= pi/4 (Remez). b is at first -n modulo 4, from -2 to 2, then minus the sine of n pi/2, of which a is the cosine: the theorems of addition",
    "are exact, as a product with 1 and a sum with 0 are, and s is 0 for x = 0 alone.",
];

const REDUCTION: [&str; 3] = [
    "n is the integer nearest to 2x/pi: @rounding@.",
    "x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have @bits@ bits. Their products",
    "with n are exact, and so is x less the first; e holds the third product less what r rounds away. p and q are minimax on",
];

const STRIBECK: [&str; 4] = [
    "exp(-|rate| / velocity), what is left of Stribeck friction at a rate, within 2 units of roundoff; 0 where it is below 1e-17, not a number for",
    "what is not a number. x = |rate| / velocity = n ln 2 + r with n the integer nearest to x / ln 2, after Cody and Waite (1980): the first part of",
    "ln 2 has 16 bits, so that its product with n is exact, and so is x less that. 2^-n is a product of powers of two; exp(-r) its series up to",
    "r^13 / 13!, which leaves out less than 2^-57.",
];

/// The numbers of the sines of a scalar.
const NUMBERS: [(&str, [&str; 2]); 11] = [
    ("limit", ["65536", "128"]),
    ("square", ["4294967296.0", "16384.0"]),
    ("bits", ["37", "17"]),
    ("adding", ["adding 3/2 2^52 rounds", "adding 3/2 2^23 rounds"]),
    ("round", ["6755399441055744.0", "12582912.0"]),
    ("two_over_pi", ["0.6366197723675814", "0.63661977"]),
    ("first", ["1.5707963267923333", "1.5707855"]),
    ("second", ["2.5633441515839558e-12", "1.0804273e-5"]),
    ("third", ["1.0562999066987428e-23", "6.0771005e-11"]),
    (
        "sine",
        [
            "(0.1666666666666663 + z * -0.008333333333322035) \
             + zz * ((0.00019841269829660063 + z * -2.7557313668040543e-6) + zz * (2.5050756282937577e-8 + z * -1.5896732662311403e-10))",
            "0.16666655 - z * (0.008332204 + z * -0.00019520518)",
        ],
    ),
    (
        "cosine",
        [
            "(0.0416666666666666 + z * -0.0013888888888873453) \
             + zz * ((2.4801587287964484e-5 + z * -2.7557313594775254e-7) + zz * (2.087558805713208e-9 + z * -1.1351822784169523e-11))",
            "(0.041666646 + z * -0.0013887332) + zz * 2.443618e-5",
        ],
    ),
];

/// A template filled in for a scalar; `rounding`: expression that rounds n; `value`: text of a number or a polynomial.
pub(super) fn filled(template: &str, scalar: Scalar, rounding: &str, value: &dyn Fn(&str) -> String) -> String {
    let mut text = String::new();
    for line in template.lines() {
        let paragraphs: [(&str, &[&str]); 3] =
            [("@sines@", &SINES), ("@sines_of_arrays@", &SINES_OF_ARRAYS), ("@stribeck@", &STRIBECK)];
        let paragraph = paragraphs.into_iter().find_map(|(name, lines)| Some((line.strip_suffix(name)?, lines)));
        match paragraph {
            Some((sign, lines)) => lines.iter().for_each(|line| text += &format!("{sign}{line}\n")),
            None => text += &format!("{line}\n"),
        }
    }
    let column = match scalar {
        Scalar::F64 => 0,
        Scalar::F32 => 1,
    };
    text = text.replace("@sign@", SIGN).replace("@rounding@", rounding);
    NUMBERS.iter().fold(text, |text, (name, values)| text.replace(&format!("@{name}@"), &value(values[column])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of a text, without signs: those with a point.
    fn numbers(text: &str) -> Vec<String> {
        let of = text.split(|c: char| !(c.is_ascii_digit() || ".e-".contains(c))).map(|word| word.trim_start_matches('-'));
        of.filter(|word| word.contains('.') && word.starts_with(|c: char| c.is_ascii_digit())).map(str::to_owned).collect()
    }

    /// Rust has its own text, the others these numbers: the same ones.
    #[test]
    fn the_numbers_are_those_of_the_text_in_rust() {
        for (k, text) in [include_str!("rust/sincos/fast_f64.rs"), include_str!("rust/sincos/fast_f32.rs")].iter().enumerate() {
            let code: String =
                text.lines().filter(|line| !line.trim_start().starts_with("//")).flat_map(|line| [line, "\n"]).collect();
            let of_rust = numbers(&code);
            for (name, values) in NUMBERS.iter().filter(|(name, _)| !["limit", "square", "bits", "adding"].contains(name)) {
                for number in numbers(values[k]) {
                    assert!(of_rust.contains(&number), "{name}: {number}");
                }
            }
        }
    }
}
