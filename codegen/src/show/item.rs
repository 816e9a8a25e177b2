//! Items that `armgen show` knows by name.

use crate::catalogue::{self, Quantity};
use crate::manipulator::Tip;

/// An item that `armgen show` knows by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    /// A function of the emitted module.
    Plain(&'static Quantity),
    /// Its form with the parameters as arguments.
    With(&'static Quantity),
    /// One matrix, by index, of a function that returns a list of matrices: the frame of a link.
    Element(&'static Quantity, usize),
    /// The determinant of the task Jacobian.
    Determinant,
}

/// The name of the determinant of the task Jacobian, which is no emitted function.
pub(super) const DETERMINANT: &str = "determinant";

impl Item {
    /// The default selection of a robot with these named end effectors: the determinant and every function except those that only gather
    /// others.
    pub fn all(tips: &[Tip]) -> Vec<Item> {
        let functions = catalogue::quantities_of(tips).filter(|quantity| quantity.gathers.is_empty()).map(Item::Plain);
        functions.chain([Item::Determinant]).collect()
    }

    /// Whether its absence is reported even if it was not requested.
    pub(super) fn said_missing(self) -> bool {
        match self {
            Item::Plain(quantity) | Item::Element(quantity, _) | Item::With(quantity) => quantity.documentation.said_missing,
            Item::Determinant => true,
        }
    }

    /// The items of a name; empty if an arm with `dof` joints and these named end effectors has no quantity of this name.
    pub fn named(name: &str, dof: usize, tips: &[Tip]) -> Vec<Item> {
        if name == DETERMINANT {
            return vec![Item::Determinant];
        }
        let element = |quantity: &'static Quantity| {
            let number = name.strip_prefix(element_of(quantity)?.name)?.strip_prefix('_')?.parse::<usize>().ok()?;
            (1..=dof).contains(&number).then(|| Item::Element(quantity, number - 1))
        };
        if let Some(item) = catalogue::quantities().find_map(element) {
            return vec![item];
        }
        let named = catalogue::functions_of(tips).find(|(quantity, with)| quantity.function_name(*with) == name);
        let Some((quantity, with)) = named else { return Vec::new() };
        let parts = if quantity.gathers.is_empty() { &[quantity][..] } else { quantity.gathers };
        parts.iter().map(|&quantity| if with { Item::With(quantity) } else { Item::Plain(quantity) }).collect()
    }

    /// Every name that [`Item::named`] knows, except names of single matrices of a list.
    pub fn names(tips: &[Tip]) -> Vec<String> {
        let forms =
            [false, true].into_iter().flat_map(|with| catalogue::functions_of(tips).filter(move |(_, form)| *form == with));
        forms.map(|(quantity, with)| quantity.function_name(with)).chain([DETERMINANT.to_string()]).collect()
    }

    /// Prefixes of the names of single matrices of a list; an underscore and the number of a joint, from 1, follow.
    pub fn lists() -> Vec<&'static str> {
        catalogue::quantities().filter_map(element_of).map(|element| element.name).collect()
    }

    pub(super) fn name(self) -> String {
        match self {
            Item::Plain(quantity) => quantity.name.into(),
            Item::With(quantity) => quantity.function_name(true),
            Item::Element(quantity, i) => format!("{}_{}", element_of(quantity).map_or(quantity.name, |of| of.name), i + 1),
            Item::Determinant => DETERMINANT.into(),
        }
    }
}

/// One matrix of a function that returns a list of them.
fn element_of(quantity: &Quantity) -> Option<catalogue::Element> {
    quantity.result.iter().find_map(|part| part.element)
}
