//! The minors of a task Jacobian with one column more than rows: their common factors, then the rest of each, equal ones once.
//!
//! ```text
//! D_k = f_1 f_2 ... d_k
//! ```

use std::rc::Rc;

use super::lines::is_sum;
use super::Shown;
use crate::derive::determinant::minors::Product;
use crate::ring::normal_form::NormalForm;
use crate::ring::print::{Notation, Printer};

/// A product as a formula.
pub(super) fn formula(product: &Product, printer: &Printer<'_>) -> String {
    let mut factors: Vec<(Rc<str>, i32)> = Vec::new();
    let mut counted: Vec<(&NormalForm, i32)> = Vec::new();
    for form in &product.factors {
        match counted.iter_mut().find(|(own, _)| *own == form) {
            Some((_, power)) => *power += 1,
            None => counted.push((form, 1)),
        }
    }
    let alone = counted.len() == 1 && product.coefficient.is_one() && counted[0].1 == 1;
    for (form, power) in counted {
        let text = printer.form(form);
        // In LaTeX a power brings its own parentheses.
        let bare = alone || !is_sum(&text, printer.notation) || (power > 1 && printer.notation == Notation::Latex);
        let text = match printer.notation {
            _ if bare => text,
            Notation::Text => format!("({text})"),
            Notation::Latex => format!("\\left({text}\\right)"),
        };
        factors.push((text.into(), power));
    }
    printer.sum_of_products([(&product.coefficient, &factors[..])])
}

/// The minors of one quantity in words, by notation.
pub(super) struct Words {
    /// Introduces the minors, before their common factors, or before the minors if they share none.
    pub(super) head: String,
    /// Where J loses rank; comes before the minors without their common factors.
    pub(super) where_lost: String,
}

impl Shown {
    /// Text about the minors.
    pub(super) fn words(&self, left: &[Product], notation: Notation) -> Words {
        let shared = self.factors.is_some();
        let math = |text: &str, latex: &str| match notation {
            Notation::Text => text.to_owned(),
            Notation::Latex => format!("${latex}$"),
        };
        let n = left.len();
        let rest = self.entry_letter();
        let letter = if shared { "D" } else { &rest };
        let between = if n > 2 { ["... + ", "\\dots + "] } else { [""; 2] };
        let sum = math(
            &format!("det(J J') = {letter}1^2 + {}{letter}{n}^2", between[0]),
            &format!("\\det(J J^T) = {letter}_1^2 + {}{letter}_{{{n}}}^2", between[1]),
        );
        let minor = |letter: &str| math(&format!("{letter}k"), &format!("{letter}_k"));
        let (j, k) = (math("J", "J"), math("k", "k"));
        let what = format!("{sum}, {} the determinant of {j} without column {k}", minor(letter));
        let head = if shared { format!("{what}: {} times the product of", minor(&rest)) } else { what };
        let constant = left.iter().any(Product::is_never_zero);
        let where_lost = match (shared, constant) {
            (true, true) => "loses rank where one of these factors is zero, and nowhere else",
            (true, false) => "loses rank where one of these factors is zero, and where all of the following are zero together",
            (false, true) => "never loses rank",
            (false, false) => "loses rank where all of the following are zero together",
        };
        Words { head, where_lost: format!("{j} {where_lost}") }
    }

    /// The minors without their common factors, by name. Equal minors share a formula, each with its sign; zeros come last.
    pub(super) fn equal_minors(&self, left: &[Product], name: impl Fn(usize) -> String) -> Vec<(String, usize)> {
        let mut groups: Vec<(String, usize)> = Vec::new();
        for (k, product) in left.iter().enumerate() {
            let same = |first: &usize| {
                let first = &left[*first];
                (first == product).then_some("").or((*first == product.negated()).then_some("-"))
            };
            match groups.iter_mut().find_map(|(names, first)| same(first).map(|sign| (names, sign))) {
                Some((names, sign)) => *names += &format!(" = {sign}{}", name(k)),
                None => groups.push((name(k), k)),
            }
        }
        groups.sort_by_key(|(_, first)| left[*first].coefficient.is_zero());
        groups
    }
}
