//! Numbers as literals: the shortest decimal that reads back as the float nearest to the exact value.

use std::str::FromStr;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::exact::Number;
use crate::kinds::Scalar;
use crate::program::listing::decimal;

/// A literal, with a minus sign in front where the value is negative.
pub(super) fn literal(value: &Number, scalar: Scalar) -> TokenStream {
    let text = decimal(value, scalar);
    let (negative, digits) = text.strip_prefix('-').map_or((false, text.as_str()), |digits| (true, digits));
    let literal =
        Literal::from_str(digits).expect("a finite float prints as a literal: its range was checked before a module was formed");
    if negative {
        quote!(-#literal)
    } else {
        quote!(#literal)
    }
}
