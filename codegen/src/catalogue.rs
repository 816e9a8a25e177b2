//! The catalogue: every function that can be emitted, in the order of the module. Each function is defined with its derivation,
//! in [`mod@quantities`].

pub use crate::derive::derivation::METHODS;
pub use crate::derive::model::Sizes;
pub use crate::derive::parameters::Parameter;
pub use crate::derive::quantities;
pub use crate::derive::quantity::{
    Absent, Argument, DerivationInput, Documentation, Element, Length, Of, Quantity, Recursion, ResultPart, Structure, Typeset,
};

use crate::manipulator::Tip;
use quantities::DECLARED;

/// All quantities.
pub fn quantities() -> impl Iterator<Item = &'static Quantity> + Clone {
    DECLARED.iter().flat_map(|declared| declared.iter().copied())
}

/// All functions: each quantity, and whether it is the form with parameters at run time.
pub fn functions() -> impl Iterator<Item = (&'static Quantity, bool)> + Clone {
    quantities().flat_map(|quantity| quantity.forms().iter().map(move |&with| (quantity, with)))
}

/// All quantities of a robot with these named end effectors, none where its end effector has no name.
pub fn quantities_of(tips: &[Tip]) -> impl Iterator<Item = &'static Quantity> + Clone + use<'_> {
    quantities().flat_map(move |quantity| {
        let named = quantity.recursion.of == Of::EndEffector && !tips.is_empty();
        let once = (!named).then_some(quantity);
        let of_tips = tips.iter().enumerate().filter(move |_| named).map(move |(number, tip)| quantity.of_tip(number, tip));
        once.into_iter().chain(of_tips)
    })
}

/// All functions of a robot with these named end effectors: each quantity, and whether it is the form with parameters at run time.
pub fn functions_of(tips: &[Tip]) -> impl Iterator<Item = (&'static Quantity, bool)> + Clone + use<'_> {
    quantities_of(tips).flat_map(|quantity| quantity.forms().iter().map(move |&with| (quantity, with)))
}

/// Whether a name can be that of a function of a named end effector.
pub fn can_be_of_a_tip(name: &str) -> bool {
    let ends = |quantity: &Quantity| name.strip_suffix(quantity.name).is_some_and(|tip| tip.len() > 1 && tip.ends_with('_'));
    quantities().any(|quantity| quantity.recursion.of == Of::EndEffector && ends(quantity))
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
