//! The exact constants of a module, for those who check its text: a literal is only the float nearest to one of them.

use std::collections::BTreeMap;

use super::listing::{angles, Listing};
use super::{Function, Module};
use crate::exact::Number;
use crate::parallel::parallel_map;

impl Module {
    /// The constants of each function by its name: one for each literal in the order of the text, without its sign. So a literal is traced to
    /// its exact constant even if two constants round to the same float. `NOMINAL_PARAMETERS` holds the nominal parameters.
    pub fn constants(&self) -> BTreeMap<String, Vec<Number>> {
        let of_function = |function: &Function| {
            // Angles come first.
            let angles = angles(&function.symbols());
            let turns = angles.iter().filter(|angle| angle.turned).filter_map(|_| self.turn.as_ref());
            let listing = Listing::of(function);
            let size = |value: &Number| if value.is_negative() { -value } else { value.clone() };
            (function.name(), turns.chain(listing.constants()).map(size).collect())
        };
        let mut constants: BTreeMap<String, Vec<Number>> = parallel_map(&self.functions, of_function).into_iter().collect();
        let nominal = self.parameters.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_PARAMETERS".into(), nominal.collect());
        let nominal = self.base_set.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_BASE_PARAMETERS".into(), nominal.collect());
        constants
    }
}
