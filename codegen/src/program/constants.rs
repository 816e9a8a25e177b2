//! The exact constants of a module, for those who check its text: a literal is only the float nearest to one of them.

use std::collections::BTreeMap;

use super::listing::{angles, Listing};
use super::Module;
use crate::exact::Number;

impl Module {
    /// The constants of each function by its name, one for each literal in the order of the text and without its sign, so that it is known
    /// which of two that round to one float a literal stands for; and the nominal parameters as `NOMINAL_PARAMETERS`.
    pub fn constants(&self) -> BTreeMap<String, Vec<Number>> {
        let mut constants: BTreeMap<String, Vec<Number>> = BTreeMap::new();
        let mut sizes: BTreeMap<Number, Number> = BTreeMap::new();
        for function in &self.functions {
            // Angles stand in front.
            let angles = angles(&function.symbols());
            let turns = angles.iter().filter(|angle| angle.turned).filter_map(|_| self.turn.as_ref());
            let listing = Listing::of(function);
            let mut size = |value: &Number| {
                let size = || if value.is_negative() { -value } else { value.clone() };
                sizes.entry(value.clone()).or_insert_with(size).clone()
            };
            constants.insert(function.name(), turns.chain(listing.constants()).map(&mut size).collect());
        }
        let nominal = self.parameters.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_PARAMETERS".into(), nominal.collect());
        let nominal = self.base_set.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_BASE_PARAMETERS".into(), nominal.collect());
        constants
    }
}
