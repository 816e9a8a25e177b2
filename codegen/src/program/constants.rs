//! The exact constants of a module, for those who check its text: a literal is only the float nearest to one of them.

use std::collections::BTreeMap;

use super::listing::{angles, Angle, Listing};
use super::{Function, Module};
use crate::exact::Number;
use crate::parallel::parallel_map;

impl Module {
    /// The constants of each function by its name: one for each literal in the order of the text, without its sign. So a literal is traced to
    /// its exact constant even if two constants round to the same float. `NOMINAL_PARAMETERS` holds the nominal parameters.
    pub fn constants(&self) -> BTreeMap<String, Vec<Number>> {
        let of_function = |function: &Function| {
            // Angles come first.
            let angles = angles(&function.symbols(), &function.computed);
            let turn = self.turn.as_ref();
            let of_angle =
                |angle: &Angle| angle.factors().into_iter().flatten().chain(angle.constant(turn).cloned()).collect::<Vec<_>>();
            let turns: Vec<Number> = angles.iter().flat_map(of_angle).collect();
            let listing = Listing::of(function);
            let size = |value: &Number| if value.is_negative() { -value } else { value.clone() };
            (function.name(), turns.iter().chain(listing.constants()).map(size).collect())
        };
        let mut constants: BTreeMap<String, Vec<Number>> = parallel_map(&self.functions, of_function).into_iter().collect();
        let nominal = self.parameters.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_PARAMETERS".into(), nominal.collect());
        let nominal = self.base_set.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_BASE_PARAMETERS".into(), nominal.collect());
        constants
    }
}
