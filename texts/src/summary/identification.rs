//! The parameters that a motion can identify.
//!
//! Torques measured along a motion determine pi only through Y pi. A column of Y that is a combination of others, Y_d = Σ k_i Y_i for every
//! state, adds nothing. Only the sums pi_i + Σ k_i pi_d act on the torques, so no motion identifies more (Siciliano et al., Sect. 7.2.2
//! and 7.4).

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::derive::base::{base_parameters, dependence, rank, regressor_of, Dependence};
use armgen_codegen::derive::parameters::{ParameterKind, ParameterVector};
use armgen_codegen::exact::Number;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::Model;

use super::decimal;
use armgen_terminal::input::counted;
use armgen_terminal::table::{Align, Table};

/// A line of this length or less.
const WIDTH: usize = 100;

/// The report for the regressor that the description chooses, and for `base_regressor`, which the module of every arm with dynamics has.
pub(super) fn report(model: &Model) -> String {
    if model.manipulator.is_massless() {
        return "  Nothing in the arm has mass or inertia: its module holds frames, Jacobians and their rates.\n".into();
    }
    let base = base_parameters(&model.manipulator, &model.field);
    let rank = rank_of(model);
    let directions = if model.manipulator.gravity_is_argument { of_directions(&model.manipulator, rank) } else { String::new() };
    let has_all = matches!(model.parameters.kind, ParameterKind::Base(_));
    let chosen = of_regressor(model, rank, base.is_some());
    let base_regressor = match base {
        Some(base) => of_base_regressor(model, base.len(), rank, has_all),
        None => "\n  The base parameters are not listed, and the module has no `base_regressor`:\n  \
                 exact combinations of its general angles are too long to be formed.\n"
            .into(),
    };
    chosen + &directions + &base_regressor
}

/// How many combinations of all parameters a motion can identify.
fn rank_of(model: &Model) -> usize {
    let (pool, y) = regressor_of(&model.manipulator, &model.field, &ParameterVector::standard(&model.manipulator));
    rank(&pool, &y)
}

/// What the nominal gravity alone would leave of the `rank` combinations that gravity in all directions shows.
fn of_directions(manipulator: &Manipulator, rank: usize) -> String {
    let alone = rank_of(&Model::new(Manipulator { gravity_is_argument: false, ..manipulator.clone() }));
    format!("\n  The {rank} are those under gravity in all directions; under the nominal gravity alone they would be {alone}.\n")
}

/// A line about `base_regressor` if it has fewer columns than the `rank` that a motion can identify. `all` counts all base parameters; it
/// is larger than the rank if they keep friction apart. `has_all`: whether the description chose the regressor with all of them.
fn of_base_regressor(model: &Model, all: usize, rank: usize, has_all: bool) -> String {
    let own = model.base_count();
    if own >= rank {
        return String::new();
    }
    let (are, they) = if all - own == 1 { ("is", "it") } else { ("are", "them") };
    let where_all = match has_all {
        true => format!("`regressor` has all {all}."),
        false => format!("To identify an arm take `regressor: base`, whose `regressor` has all {all}."),
    };
    format!(
        "\n  The module's `base_regressor` has {} of these {all}:\n  \
         the other {} {are} 0 at the values of this file, and it leaves {they} out.\n  {where_all}\n",
        counted(own, "column"),
        all - own
    )
}

/// The regressor that the description chooses; `rank` is that of all parameters, `listed`: whether base parameters can be listed.
fn of_regressor(model: &Model, rank: usize, listed: bool) -> String {
    let vector = &model.parameters;
    if vector.is_empty() {
        return "  The regressor has no parameters: nothing of this arm acts on the torques.\n".into();
    }
    let names: Vec<&str> = vector.entries.iter().map(|entry| entry.name.as_str()).collect();
    match &vector.kind {
        ParameterKind::Base(_) => {
            let mut table = Table::new([("base parameter", Align::Left), ("value", Align::Right), ("combination", Align::Left)]);
            for entry in &vector.entries {
                let mut lines = broken(&entry.meaning).into_iter();
                table.row([entry.name.clone(), decimal(&entry.nominal), lines.next().unwrap_or_default()]);
                lines.for_each(|line| table.row([String::new(), String::new(), line]));
            }
            let title = if rank == vector.len() {
                format!("The minimal parameter set: a motion can identify each of these, {rank} in all.")
            } else {
                format!(
                    "The minimal parameter set that keeps friction apart, {} in all: a motion can identify {rank} combinations of these.\n  \
                     The weight on a slide and the offset of its friction are both constant: the weight must be known from elsewhere.",
                    vector.len()
                )
            };
            format!("  {title}\n\n{}", table.text())
        }
        ParameterKind::Standard(_) => {
            format!(
                "  The regressor has {} and rank {rank}: a motion can identify {} of them.\n",
                counted(vector.len(), "parameter"),
                counted(rank, "combination")
            ) + if listed { "  With `regressor: base` this program lists them.\n" } else { "" }
        }
        ParameterKind::Names(_) => {
            let (pool, y) = regressor_of(&model.manipulator, &model.field, vector);
            of_names(&names, &dependence(&pool, &y))
        }
    }
}

fn of_names(names: &[&str], dependence: &Dependence) -> String {
    let rank = dependence.independent.len();
    let mut sums: BTreeMap<usize, Vec<(usize, &Number)>> = BTreeMap::new();
    for (column, combination) in &dependence.dependent {
        for (independent, coefficient) in combination {
            sums.entry(*independent).or_default().push((*column, coefficient));
        }
    }
    let silent: BTreeSet<usize> = dependence.dependent.iter().filter(|(_, c)| c.is_empty()).map(|(column, _)| *column).collect();
    let alone: Vec<&str> = dependence.independent.iter().filter(|c| !sums.contains_key(c)).map(|&c| names[c]).collect();

    let mut text = format!("  The regressor has {} and rank {rank}: ", counted(names.len(), "parameter"));
    if rank == names.len() {
        text += "a motion can identify each of them.\n";
        return text;
    }
    text += &format!("a motion can identify {rank} of {}.\n\n", names.len());
    if !alone.is_empty() {
        text += &list("identifiable alone: ", &alone, ", ");
    }
    for (&independent, others) in &sums {
        let mut sum = vec![names[independent].to_string()];
        for (column, coefficient) in others {
            let negative = coefficient.leads_negative();
            let size = if negative { -*coefficient } else { (*coefficient).clone() };
            let sign = if negative { "-" } else { "+" };
            sum.push(match (size.is_one(), size.terms().count()) {
                (true, _) => format!("{sign} {}", names[*column]),
                (false, 1) => format!("{sign} {size}*{}", names[*column]),
                (false, _) => format!("{sign} ({size})*{}", names[*column]),
            });
        }
        text += &list("only as a sum:      ", &sum.iter().map(String::as_str).collect::<Vec<_>>(), " ");
    }
    if !silent.is_empty() {
        text += &list("not at all:         ", &silent.iter().map(|&c| names[c]).collect::<Vec<_>>(), ", ");
    }
    text
}

/// A sum in lines that leave room for the columns before it.
fn broken(sum: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in sum.split_inclusive(' ') {
        let last = lines.last_mut().expect("there is one");
        match last.chars().count() + word.chars().count() > WIDTH - 25 && word.starts_with(['+', '-']) {
            true => lines.push(word.to_owned()),
            false => *last += word,
        }
    }
    lines
}

/// Words after a title, broken into lines with a hanging indent.
fn list(title: &str, words: &[&str], separator: &str) -> String {
    let indent = title.len() + 2;
    let mut text = format!("  {title}");
    let mut column = indent;
    for (i, word) in words.iter().enumerate() {
        let last = i + 1 == words.len();
        let length = word.chars().count() + if last { 0 } else { separator.len() };
        if i > 0 && column + length > WIDTH {
            text = text.trim_end().to_string() + &format!("\n{:indent$}", "");
            column = indent;
        }
        text += word;
        text += if last { "" } else { separator };
        column += length;
    }
    text + "\n"
}
