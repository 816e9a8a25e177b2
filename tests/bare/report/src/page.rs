//! The page about the run, and its summary for a terminal.

use crate::{
    budgets::{Budgets, Cost, Measured, Modules},
    printed::Printed,
};
use std::fmt::Write;

const PREFACE: &str = include_str!("preface.md");
const FUNCTIONS: &str = include_str!("functions.md");
/// The module of inverse kinematics, that of steps of the runtime, and that of motion at the limit.
const POSTURES: &str = "postures";
const STEPS: &str = "steps";
const LAWS: &str = "laws";
const PARTS: [&str; 4] =
    ["trajectory", "inverse kinematics, second order", "adaptive controller", "the arm itself, one step of its simulation"];

/// One line for each thing that matters.
pub(crate) fn summary(measured: &Measured, printed: &Printed) -> String {
    let (costs, steps) = (&measured.costs, printed.torques.len());
    format!(
        "bare metal: torques of {steps} steps printed, largest joint error {:.1e} rad or m\n\
         bare metal: control step {} instructions, {} bytes of stack; code {} bytes, flash {} bytes, of which the \
         control step by itself {}\n",
        costs.program.error as f64 * 1e-9,
        costs.control_step.instructions,
        costs.control_step.stack,
        costs.program.text,
        costs.program.flash,
        costs.control_program.flash,
    )
}

/// The page; `m7`: cost of the functions on the other processor, `postures`: number of compared postures.
pub(crate) fn page(measured: &Measured, m7: &Modules, budgets: &Budgets, printed: &Printed, postures: usize) -> String {
    let mut page = PREFACE.to_string();
    let costs = &measured.costs;
    let _ = write!(
        page,
        "\n## Torques\n\n\
         {} steps: the torques and the estimated mass are the same on both machines, bit by bit.\n\
         The last line of each is:\n\n```text\n{}\n```\n\n\
         The largest difference between a desired and an actual joint variable is {:.2e} rad or m.\n",
        printed.torques.len(),
        printed.torques.last().map_or("", String::as_str),
        costs.program.error as f64 * 1e-9,
    );
    let _ = write!(
        page,
        "\n## Instructions per control step\n\n| part | most expensive step | mean |\n|---|---:|---:|\n\
         | **control step** | **{}** (budget {}) | {} |\n",
        costs.control_step.instructions,
        budgets.control_step.instructions,
        measured.means[..3].iter().sum::<u64>(),
    );
    for (part, (most, mean)) in PARTS.iter().zip(measured.parts.iter().zip(measured.means)) {
        let _ = writeln!(page, "| {part} | {most} | {mean} |");
    }
    let per_mille = costs.control_step.instructions as f64 / 1e3;
    let _ = write!(
        page,
        "\nAt 1 kHz the control step takes {per_mille:.1} million instructions per second.\n\
         \n## Memory\n\n| | bytes | budget |\n|---|---:|---:|\n\
         | **flash of the control step**: trajectory, inverse kinematics, controller, start of the program | **{}** | {} |\n\
         | of that `.text` | {} | {} |\n\
         | flash of the program that also simulates the arm, measures and prints | {} | {} |\n| of that `.text` | {} | {} |\n\
         | stack of a control step, at the deepest | {} | {} |\n| static memory | {} | |\n",
        costs.control_program.flash,
        budgets.control_program.flash,
        costs.control_program.text,
        budgets.control_program.text,
        costs.program.flash,
        budgets.program.flash,
        costs.program.text,
        budgets.program.text,
        costs.control_step.stack,
        budgets.control_step.stack,
        measured.data,
    );
    page += FUNCTIONS;
    page += &inverse_kinematics(&costs.functions, m7, budgets, postures);
    page += "\n## Load and contacts\n\n\
        Steps of the Panda in f32, with the emitted functions that they call. `payload_step` contains `payload_regressors`.\n\
        `payload_body` takes Newton steps, at most twelve, and runs when a body is wanted.\n";
    page += &functions_of(STEPS, &costs.functions, m7, budgets);
    page += &laws(&costs.functions, m7, budgets);
    page
}

/// Every function of both robots, with either source of sines, as CSV.
pub(crate) fn table(measured: &Measured, m7: &Modules, budgets: &Budgets) -> String {
    let mut table = String::from(
        "robot,function,M4F fast,M4F libm,M7 fast,M7 libm,text fast,text libm,stack fast,stack libm,budget M4F fast,budget text fast,budget stack fast\n",
    );
    let m4f = &measured.costs.functions;
    for robot in ["scara", "panda7"] {
        let [fast, libm] = ["fast", "libm"].map(|ending| format!("{robot}_{ending}"));
        for name in m4f.get(&fast).into_iter().flat_map(|functions| functions.keys()) {
            let (a, b, budget) = (cost(m4f, &fast, name), cost(m4f, &libm, name), cost(&budgets.functions, &fast, name));
            let [a7, b7] = [&fast, &libm].map(|module| cost(m7, module, name).instructions);
            let _ = writeln!(
                table,
                "{robot},{name},{},{},{a7},{b7},{},{},{},{},{},{},{}",
                a.instructions, b.instructions, a.text, b.text, a.stack, b.stack, budget.instructions, budget.text, budget.stack,
            );
        }
    }
    table
}

fn inverse_kinematics(m4f: &Modules, m7: &Modules, budgets: &Budgets, postures: usize) -> String {
    let mut text = format!(
        "\n## Postures\n\n\
         All [postures](inverse-kinematics.md) of the SCARA and the Puma 560, each at {} poses: {postures} postures, the same on both \
         processors and the host, bit by bit.\nBudgets are in parentheses.\n",
        armgen_bare_functions::postures::POSES,
    );
    text += &functions_of(POSTURES, m4f, m7, budgets);
    text
}

fn laws(m4f: &Modules, m7: &Modules, budgets: &Budgets) -> String {
    use armgen_bare_functions::laws::{SAMPLES, SEGMENTS};
    let mut text = format!(
        "\n## Motion at the limit\n\n\
         `timing` finds the [fastest motion](timing.md) of the SCARA on a line with {SEGMENTS} segments.\n\
         `governor_step` leads it at 250 Hz, with another command every 40 of {SAMPLES} samples.\n\
         `rate_program` is a quadratic program of 7 unknowns and 14 bounds. The other rows are steps of the Panda:\n\
         impedance, guiding by hand, torques within limits (`control::Limited`) and joint rates within limits (`clik::Limited`).\n\
         Durations, laws, references, torques and rates are the same on both processors and the host, bit by bit.\n",
    );
    text += &functions_of(LAWS, m4f, m7, budgets);
    text
}

/// A table of the functions of a module.
fn functions_of(module: &str, m4f: &Modules, m7: &Modules, budgets: &Budgets) -> String {
    let mut text = String::from("\n| function | M4F | M7 | `.text` | stack |\n|---|---:|---:|---:|---:|\n");
    for (name, measured) in m4f.get(module).into_iter().flatten() {
        let (budget, m7) = (cost(&budgets.functions, module, name), cost(m7, module, name).instructions);
        let _ = writeln!(
            text,
            "| `{name}` | {} ({}) | {m7} | {} ({}) | {} ({}) |",
            measured.instructions, budget.instructions, measured.text, budget.text, measured.stack, budget.stack,
        );
    }
    text
}

fn cost(modules: &Modules, module: &str, name: &str) -> Cost {
    modules.get(module).and_then(|functions| functions.get(name)).copied().unwrap_or_default()
}
