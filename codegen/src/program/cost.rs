//! Cost of a function, counted in operations.

use std::collections::BTreeSet;

use super::{Function, Operand, Operation};
use crate::ring::count::{DIVISION_COST, SINE_COSINE_COST};
use crate::ring::field::computed::ComputedAngle;

/// Operations of a function: one per binary `*`, `+` or `-`, `/`; sign changes and sines apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Multiplications.
    pub mul: usize,
    /// Additions and subtractions.
    pub add: usize,
    /// Multiplications among them that are one operation with an addition.
    pub fused: usize,
    /// Divisions.
    pub div: usize,
    /// Sign changes.
    pub neg: usize,
    /// Sine and cosine pairs.
    pub sincos: usize,
    /// Exponentials.
    pub exp: usize,
}

impl Cost {
    /// The cost of a function.
    pub fn of(function: &Function) -> Cost {
        let mut cost = Cost::default();
        let mut angles = BTreeSet::new();
        for step in &function.steps {
            match step.operation {
                Operation::Add | Operation::Subtract => cost.add += 1,
                Operation::Multiply => cost.mul += 1,
                Operation::Divide => cost.div += 1,
                Operation::Sign | Operation::OppositeSign => {}
            }
        }
        let operands = function.steps.iter().flat_map(|step| [&step.left, &step.right]);
        for operand in operands.chain(function.outputs.iter().map(|output| &output.operand)) {
            if let Operand::Input(symbol) = operand {
                angles.extend(symbol.angle());
            }
        }
        cost.fused = function.products_in_sums().into_iter().filter(|&fused| fused).count();
        cost.sincos = angles.len();
        cost.exp = function.stribeck.len();
        cost.add += angles.iter().map(|angle| angle.additions()).sum::<usize>();
        for (mul, add) in function.computed.values().map(ComputedAngle::operations) {
            cost.mul += mul;
            cost.add += add;
        }
        cost.neg = function.outputs.iter().filter(|output| output.negated).count();
        cost
    }

    /// A single figure to compare derivations by: a sine and cosine pair or a division counts like some additions, a sign change not at all.
    pub fn weight(&self) -> usize {
        self.mul + self.add + DIVISION_COST * self.div + SINE_COSINE_COST * (self.sincos + self.exp)
    }
}
