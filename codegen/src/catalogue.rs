//! The catalogue: every function that can be emitted, in the order of the module. Each function is defined with its derivation,
//! in [`mod@quantities`].

pub use crate::derive::derivation::METHODS;
pub use crate::derive::model::Sizes;
pub use crate::derive::parameters::Parameter;
pub use crate::derive::quantities;
pub use crate::derive::quantity::{
    Absent, Argument, DerivationInput, Documentation, Element, Length, Quantity, Recursion, ResultPart, Structure, Typeset,
};

use quantities::DECLARED;

/// All quantities.
pub fn quantities() -> impl Iterator<Item = &'static Quantity> + Clone {
    DECLARED.iter().flat_map(|declared| declared.iter().copied())
}

/// All functions: each quantity, and whether it is the form with parameters at run time.
pub fn functions() -> impl Iterator<Item = (&'static Quantity, bool)> + Clone {
    quantities().flat_map(|quantity| quantity.forms().iter().map(move |&with| (quantity, with)))
}

/// The function of a name.
pub fn named(name: &str) -> Option<(&'static Quantity, bool)> {
    functions().find(|(quantity, with)| quantity.function_name(*with) == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_are_whole() {
        let names: Vec<String> = functions().map(|(quantity, with)| quantity.function_name(with)).collect();
        for (i, name) in names.iter().enumerate() {
            assert!(!names[..i].contains(name), "{name} is declared twice");
            let (quantity, with) = named(name).expect("it is in the catalogue");
            assert_eq!(quantity.function_name(with), *name);
        }
        for quantity in quantities() {
            let Quantity { name, arguments, result, structure, documentation, .. } = quantity;
            assert!(!arguments.is_empty() && !arguments.contains(&Argument::Pi), "{name}");
            assert!(documentation.title.ends_with('.') && documentation.result.ends_with('.'), "{name}");
            match result {
                [] => panic!("{name} returns nothing"),
                [one] => assert!(one.name == ResultPart::RESULT && structure.is_none(), "{name}"),
                parts => {
                    assert!(parts.iter().all(|part| part.name != ResultPart::RESULT && !part.meaning[0].is_empty()), "{name}")
                }
            }
            for part in *result {
                assert!(!part.unit.is_empty(), "{name}");
                assert!(part.lengths.len() <= 3 && part.element.is_some() == (part.lengths.len() == 3), "{name}");
            }
        }
    }
}
