//! What may be used at most, and what was.

use crate::{
    image::Image,
    printed::{instructions, Printed},
};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The name of an empty call, whose cost is taken off.
const NOTHING: &str = "(nothing)";

/// Cost, or budget, of a function or a step.
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

/// The control step by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Size {
    /// Bytes of code.
    pub(crate) text: u64,
    /// Bytes in flash.
    pub(crate) flash: u64,
}

/// Functions by name, by module.
pub(crate) type Modules = BTreeMap<String, BTreeMap<String, Cost>>;

/// The ending of the modules that compute sines themselves.
const FAST: &str = "_fast";
/// The ending of the modules that call `libm` for sines; their cost has no budget.
const LIBM: &str = "_libm";

/// The file of budgets; measurements have the same shape.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Budgets {
    pub(crate) program: Program,
    /// The program that holds a control step and nothing else.
    pub(crate) control_program: Size,
    /// A control step: trajectory, inverse kinematics, controller.
    pub(crate) control_step: Cost,
    /// Each function of each emitted module with sines in f32.
    pub(crate) functions: Modules,
}

/// What was measured.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Measured {
    pub(crate) costs: Budgets,
    /// Instructions of trajectory, inverse kinematics, controller and arm in the dearest step of each.
    pub(crate) parts: [u64; 4],
    /// The same, mean over the run.
    pub(crate) means: [u64; 4],
    /// Bytes in memory besides the stack.
    pub(crate) data: u64,
}

/// What each function cost, by module.
pub(crate) fn functions(image: &Image, printed: &Printed) -> Result<Modules, String> {
    let mut modules = Modules::new();
    for (path, [ticks, stack]) in &printed.functions {
        let (module, name) = path.split_once("::").ok_or(format!("`{path}` is no function of a module"))?;
        if name == NOTHING {
            continue;
        }
        let [nothing, _] =
            printed.functions.get(&format!("{module}::{NOTHING}")).ok_or("the firmware did not measure an empty call")?;
        // The linker merges functions with the same code. So a function without sines may only exist under the name of the other module.
        let twin = match module.strip_suffix(LIBM) {
            Some(robot) => format!("{robot}{FAST}::{name}"),
            None => format!("{}{LIBM}::{name}", module.trim_end_matches(FAST)),
        };
        let text = [path, &twin].into_iter().find_map(|path| image.functions.get(path));
        let text = *text.ok_or(format!("the firmware holds no function `{path}`"))?;
        // With the code of the function that writes its result, which it calls.
        let written = [path, &twin].into_iter().find_map(|path| image.functions.get(&format!("{path}_into")));
        let text = text + written.copied().unwrap_or_default();
        let cost = Cost { instructions: instructions(ticks.saturating_sub(*nothing)), text, stack: *stack };
        modules.entry(module.into()).or_default().insert(name.into(), cost);
    }
    Ok(modules)
}

impl Measured {
    /// Measurements of the program that only controls an arm, of the program that measures it, and of the functions measured alone.
    pub(crate) fn of(control: &Image, image: &Image, printed: &Printed, functions: Modules) -> Result<Measured, String> {
        let [_, stack] =
            printed.functions.get("control::control_step").copied().ok_or("the firmware did not measure a control step")?;
        let most = |of: &dyn Fn(&[u64; 4]) -> u64| printed.ticks.iter().map(of).max().map_or(0, instructions);
        let mean = |part: usize| {
            let total: u64 = printed.ticks.iter().map(|ticks| ticks[part]).sum();
            instructions(total.checked_div(printed.ticks.len() as u64).unwrap_or(0))
        };
        let dearest = most(&|ticks| ticks[..3].iter().sum());
        Ok(Measured {
            costs: Budgets {
                program: Program { text: image.text, flash: image.flash, error: printed.error },
                control_program: Size { text: control.text, flash: control.flash },
                control_step: Cost { instructions: dearest, text: 0, stack },
                functions,
            },
            parts: std::array::from_fn(|part| most(&|ticks| ticks[part])),
            means: std::array::from_fn(mean),
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
        check("code of the control program".into(), "bytes", costs.control_program.text, self.control_program.text);
        check("flash of the control program".into(), "bytes", costs.control_program.flash, self.control_program.flash);
        check("joint error".into(), "1e-9 rad or m", costs.program.error, program.error);
        let step = [("control_step".into(), costs.control_step, Some(self.control_step))].into_iter();
        let budget = |module: &str, name: &str| self.functions.get(module).and_then(|functions| functions.get(name)).copied();
        let functions = all(&costs.functions)
            .filter(|(module, ..)| !module.ends_with(LIBM))
            .map(|(module, name, cost)| (format!("{module}::{name}"), cost, budget(module, name)));
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
        let unknown = all(&self.functions)
            .filter(|(module, name, _)| !costs.functions.get(*module).is_some_and(|functions| functions.contains_key(*name)));
        faults.extend(
            unknown.map(|(module, name, _)| format!("there is a budget for `{module}::{name}`, which is no emitted function")),
        );
        faults
    }
}

/// Module, name and cost of all functions.
fn all(modules: &Modules) -> impl Iterator<Item = (&str, &str, Cost)> {
    modules
        .iter()
        .flat_map(|(module, functions)| functions.iter().map(move |(name, cost)| (module.as_str(), name.as_str(), *cost)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured() -> Measured {
        let image = Image { text: 100, flash: 120, data: 4, ..Image::default() };
        let printed = Printed {
            ticks: vec![[16, 32, 48, 64], [32, 16, 16, 16]],
            functions: [("control::control_step".into(), [0, 500])].into(),
            error: 7,
            ..Printed::default()
        };
        let modules =
            Image { functions: [("a_fast::gravity".into(), 30), ("a_libm::gravity".into(), 31)].into(), ..Image::default() };
        let calls = ["a_fast", "a_libm"].map(|module| {
            [("(nothing)", [16, 8]), ("gravity", [48, 40])].map(|(name, cost)| (format!("{module}::{name}"), cost))
        });
        let calls = Printed { functions: calls.into_iter().flatten().collect(), ..Printed::default() };
        let control = Image { text: 80, flash: 90, ..Image::default() };
        Measured::of(&control, &image, &printed, functions(&modules, &calls).unwrap()).unwrap()
    }

    const EXACT: &str = "
        program = { text = 100, flash = 120, error = 7 }
        control_program = { text = 80, flash = 90 }
        control_step = { instructions = 60, stack = 500 }
        functions.a_fast.gravity = { instructions = 20, text = 30, stack = 40 }";

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
        check(&EXACT.replace("= 80", "= 79"), &["code of the control program: 80 bytes, the budget is 79"]);
        check(&EXACT.replace("= 90", "= 89"), &["flash of the control program: 90 bytes, the budget is 89"]);
        check(&EXACT.replace("= 7", "= 6"), &["joint error: 7 1e-9 rad or m, the budget is 6"]);
        check(&EXACT.replace("= 60", "= 59"), &["`control_step`: 60 instructions, the budget is 59"]);
        check(&EXACT.replace("= 500", "= 499"), &["stack of `control_step`: 500 bytes, the budget is 499"]);
        check(&EXACT.replace("= 20", "= 19"), &["`a_fast::gravity`: 20 instructions, the budget is 19"]);
        check(&EXACT.replace("= 30", "= 29"), &["code of `a_fast::gravity`: 30 bytes, the budget is 29"]);
        check(&EXACT.replace("= 40", "= 39"), &["stack of `a_fast::gravity`: 40 bytes, the budget is 39"]);
    }

    #[test]
    fn functions_and_budgets_belong_together() {
        let renamed = EXACT.replace("gravity", "levity");
        check(
            &renamed,
            &["`a_fast::gravity` has no budget", "there is a budget for `a_fast::levity`, which is no emitted function"],
        );
    }
}
