//! The page about the run, and its summary for a terminal.

use crate::{
    budgets::{Budgets, Cost, Measured},
    printed::Printed,
};
use std::fmt::Write;

const PREFACE: &str = include_str!("preface.md");
const PARTS: [&str; 4] =
    ["trajectory", "inverse kinematics, second order", "adaptive controller", "the arm itself, one step of its simulation"];

/// One line for each thing that matters.
pub(crate) fn summary(measured: &Measured, printed: &Printed) -> String {
    let (costs, steps) = (&measured.costs, printed.torques.len());
    format!(
        "bare metal: torques of {steps} steps printed, largest joint error {:.1e} rad or m\n\
         bare metal: control step {} instructions, {} bytes of stack; code {} bytes, flash {} bytes\n",
        costs.program.error as f64 * 1e-9,
        costs.control_step.instructions,
        costs.control_step.stack,
        costs.program.text,
        costs.program.flash,
    )
}

/// The page.
pub(crate) fn page(measured: &Measured, budgets: &Budgets, printed: &Printed) -> String {
    let mut page = PREFACE.to_string();
    let costs = &measured.costs;
    let _ = write!(
        page,
        "\n## Torques\n\n\
         {} steps: the torques and the estimated mass are the same on both machines, bit by bit.\n\
         The last line of each reads:\n\n```text\n{}\n```\n\n\
         The largest difference between a desired and an actual joint variable is {:.2e} rad or m.\n",
        printed.torques.len(),
        printed.torques.last().map_or("", String::as_str),
        costs.program.error as f64 * 1e-9,
    );
    let _ = write!(
        page,
        "\n## Postures\n\n\
         All postures of the SCARA and of the Puma 560 ([inverse kinematics](inverse-kinematics.md)), each at {} poses: {} postures, the same on both \
         machines, bit by bit.\n",
        armgen_bare_control::postures::POSES,
        printed.postures.len(),
    );
    let _ = write!(
        page,
        "\n## Instructions per control step\n\n| part | dearest step | mean |\n|---|---:|---:|\n\
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
         \n## Memory\n\n| | bytes | budget |\n|---|---:|---:|\n| `.text` | {} | {} |\n| flash in all | {} | {} |\n\
         | stack of a control step, at the deepest | {} | {} |\n| static memory | {} | |\n",
        costs.program.text,
        budgets.program.text,
        costs.program.flash,
        budgets.program.flash,
        costs.control_step.stack,
        budgets.control_step.stack,
        measured.data,
    );
    page += "\n## Emitted functions\n\n\
             Budgets in parentheses.\n\n\
             | function | instructions | `.text`, bytes | peak stack, bytes | its own frame, bytes |\n|---|---:|---:|---:|---:|\n";
    for (name, Cost { instructions, text, stack }) in &costs.functions {
        let budget = budgets.functions.get(name).copied().unwrap_or_default();
        let frame = measured.frames.get(name).map_or("-".into(), u64::to_string);
        let _ = writeln!(
            page,
            "| `{name}` | {instructions} ({}) | {text} ({}) | {stack} ({}) | {frame} |",
            budget.instructions, budget.text, budget.stack
        );
    }
    page
}
