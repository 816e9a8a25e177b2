//! The exact constants of a module, for those who check its text: a literal is only the float nearest to one of them.

use std::collections::BTreeMap;

use super::{Module, Operand};
use crate::exact::Number;
use crate::ring::Symbol;

impl Module {
    /// The constants of each function by its name, each once in the order of the steps, and the nominal parameters as `NOMINAL_PARAMETERS`.
    pub fn constants(&self) -> BTreeMap<String, Vec<Number>> {
        let mut constants: BTreeMap<String, Vec<Number>> = BTreeMap::new();
        for function in &self.functions {
            let steps = function.steps.iter().flat_map(|step| [&step.left, &step.right]);
            let mut list: Vec<Number> = Vec::new();
            for operand in steps.chain(function.outputs.iter().map(|output| &output.operand)) {
                let value = match operand {
                    Operand::Constant(value) => Some(value),
                    Operand::Input(Symbol::SineOf(sum) | Symbol::CosineOf(sum)) if sum.turned => self.turn.as_ref(),
                    _ => None,
                };
                if let Some(value) = value.filter(|value| !list.contains(value)) {
                    list.push(value.clone());
                }
            }
            constants.insert(function.name(), list);
        }
        let nominal = self.parameters.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_PARAMETERS".into(), nominal.collect());
        let nominal = self.base_set.iter().map(|parameter| parameter.nominal.clone());
        constants.insert("NOMINAL_BASE_PARAMETERS".into(), nominal.collect());
        constants
    }
}
