//! What may be used at most, and what was.

use crate::{
    image::Image,
    printed::{instructions, Printed},
};
use serde::Deserialize;
use std::collections::BTreeMap;

/// What a function, or a step, costs or may cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Cost {
    /// Instructions of the dearest call.
    pub(crate) instructions: u64,
    /// Bytes of code, without functions that it calls.
    #[serde(default)]
    pub(crate) text: u64,
    /// Bytes of stack at the deepest, with all that it calls.
    pub(crate) stack: u64,
}

/// The whole program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Program {
    /// Bytes of code.
    pub(crate) text: u64,
    /// Bytes in flash.
    pub(crate) flash: u64,
    /// Largest difference of desired and actual joint variables, 1e-9 rad or m.
    pub(crate) error: u64,
}

/// The file of budgets; measurements have the same shape.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Budgets {
    pub(crate) program: Program,
    /// A control step: trajectory, inverse kinematics, controller.
    pub(crate) control_step: Cost,
    /// Each emitted function.
    pub(crate) functions: BTreeMap<String, Cost>,
}

/// What was measured.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Measured {
    pub(crate) costs: Budgets,
    /// Instructions of trajectory, inverse kinematics, controller and arm in the dearest step of each.
    pub(crate) parts: [u64; 4],
    /// The same, mean over the run.
    pub(crate) means: [u64; 4],
    /// Stack frames of the emitted functions themselves.
    pub(crate) frames: BTreeMap<String, u64>,
    /// Bytes in memory besides the stack.
    pub(crate) data: u64,
}

impl Measured {
    pub(crate) fn of(image: &Image, printed: &Printed) -> Result<Measured, String> {
        let [nothing, _] = printed.functions.get("(nothing)").copied().ok_or("the firmware did not measure an empty call")?;
        let cost = |name: &str, [ticks, stack]: [u64; 2]| {
            let text = image.functions.get(name).copied().ok_or(format!("the firmware holds no function `{name}`"))?;
            Ok::<_, String>(Cost { instructions: instructions(ticks.saturating_sub(nothing)), text, stack })
        };
        let mut functions = BTreeMap::new();
        for (name, measured) in
            printed.functions.iter().filter(|(name, _)| !["(nothing)", "control_step"].contains(&name.as_str()))
        {
            functions.insert(name.clone(), cost(name, *measured)?);
        }
        let [_, stack] = printed.functions.get("control_step").copied().ok_or("the firmware did not measure a control step")?;
        let most = |of: &dyn Fn(&[u64; 4]) -> u64| printed.ticks.iter().map(of).max().map_or(0, instructions);
        let mean = |part: usize| {
            let total: u64 = printed.ticks.iter().map(|ticks| ticks[part]).sum();
            instructions(total.checked_div(printed.ticks.len() as u64).unwrap_or(0))
        };
        let dearest = most(&|ticks| ticks[..3].iter().sum());
        Ok(Measured {
            costs: Budgets {
                program: Program { text: image.text, flash: image.flash, error: printed.error },
                control_step: Cost { instructions: dearest, text: 0, stack },
                functions,
            },
            parts: std::array::from_fn(|part| most(&|ticks| ticks[part])),
            means: std::array::from_fn(mean),
            frames: image.frames.clone(),
            data: image.data,
        })
    }
}

impl Budgets {
    /// Every budget that does not hold, every function without one, and every budget of nothing.
    pub(crate) fn exceeded(&self, measured: &Measured) -> Vec<String> {
        let mut faults = Vec::new();
        let mut check = |what: String, unit: &str, measured: u64, budget: u64| {
            if measured > budget {
                faults.push(format!("{what}: {measured} {unit}, the budget is {budget}"));
            }
        };
        let (program, costs) = (&self.program, &measured.costs);
        check("code".into(), "bytes", costs.program.text, program.text);
        check("flash".into(), "bytes", costs.program.flash, program.flash);
        check("joint error".into(), "1e-9 rad or m", costs.program.error, program.error);
        let step = [("control_step", &costs.control_step, Some(&self.control_step))].into_iter();
        let functions = costs.functions.iter().map(|(name, cost)| (name.as_str(), cost, self.functions.get(name)));
        let mut missing = Vec::new();
        for (name, cost, budget) in step.chain(functions) {
            let Some(budget) = budget else {
                missing.push(format!("`{name}` has no budget"));
                continue;
            };
            check(format!("`{name}`"), "instructions", cost.instructions, budget.instructions);
            check(format!("code of `{name}`"), "bytes", cost.text, budget.text);
            check(format!("stack of `{name}`"), "bytes", cost.stack, budget.stack);
        }
        faults.extend(missing);
        let unknown = self.functions.keys().filter(|name| !costs.functions.contains_key(*name));
        faults.extend(unknown.map(|name| format!("there is a budget for `{name}`, which is no emitted function")));
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured() -> Measured {
        let image = Image { text: 100, flash: 120, data: 4, functions: [("gravity".into(), 30)].into(), ..Image::default() };
        let printed = Printed {
            ticks: vec![[16, 32, 48, 64], [32, 16, 16, 16]],
            functions: [("(nothing)".into(), [16, 8]), ("gravity".into(), [48, 40]), ("control_step".into(), [0, 500])].into(),
            error: 7,
            ..Printed::default()
        };
        Measured::of(&image, &printed).unwrap()
    }

    const EXACT: &str = "
        program = { text = 100, flash = 120, error = 7 }
        control_step = { instructions = 60, stack = 500 }
        functions.gravity = { instructions = 20, text = 30, stack = 40 }";

    #[track_caller]
    fn check(budgets: &str, expected: &[&str]) {
        let budgets: Budgets = toml::from_str(budgets).unwrap();
        assert_eq!(budgets.exceeded(&measured()), expected);
    }

    #[test]
    fn exact_budgets_hold() {
        check(EXACT, &[]);
    }

    #[test]
    fn one_unit_too_much_is_a_fault() {
        check(&EXACT.replace("text = 100", "text = 99"), &["code: 100 bytes, the budget is 99"]);
        check(&EXACT.replace("= 120", "= 119"), &["flash: 120 bytes, the budget is 119"]);
        check(&EXACT.replace("= 7", "= 6"), &["joint error: 7 1e-9 rad or m, the budget is 6"]);
        check(&EXACT.replace("= 60", "= 59"), &["`control_step`: 60 instructions, the budget is 59"]);
        check(&EXACT.replace("= 500", "= 499"), &["stack of `control_step`: 500 bytes, the budget is 499"]);
        check(&EXACT.replace("= 20", "= 19"), &["`gravity`: 20 instructions, the budget is 19"]);
        check(&EXACT.replace("= 30", "= 29"), &["code of `gravity`: 30 bytes, the budget is 29"]);
        check(&EXACT.replace("= 40", "= 39"), &["stack of `gravity`: 40 bytes, the budget is 39"]);
    }

    #[test]
    fn functions_and_budgets_belong_together() {
        let renamed = EXACT.replace("gravity", "levity");
        check(&renamed, &["`gravity` has no budget", "there is a budget for `levity`, which is no emitted function"]);
    }
}
