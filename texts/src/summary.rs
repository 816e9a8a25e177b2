//! The summary of an arm, which `armgen check` prints: its rows, its bodies and what can be done with it.

mod bodies;
mod identification;
mod joints;
mod posture;
mod reach;

use armgen_codegen::description::{Convention, Products, RobotDescription};
use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::inverse_kinematics::Solved;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::manipulator::{Manipulator, RegressorChoice};
use armgen_codegen::source::Source;
use armgen_codegen::{derive, validate, Model};
use armgen_terminal as terminal;
use armgen_terminal::input::counted;
use armgen_terminal::number::without_zeros;
use armgen_terminal::table::{Align, Table};

use crate::rows;

/// The summary of a valid description, without marks for a terminal; `None` if it is faulty.
pub fn of(source: &Source, allow: &[String], full: bool) -> Option<String> {
    let (valid, mut diagnostics) = validate::read_for(source, Scalar::F64);
    diagnostics.allow(allow);
    Some(of_arm(source, &Model::new(valid?.0), &diagnostics, full))
}

/// The comparison that is left to the reader.
const ADVICE: &str =
    "  A valid file may still be wrong: compare the posture at q = 0 with a drawing,\n  or with the arm itself by `armgen page`.\n";

/// The tables that the short summary leaves out.
const MORE: &str = "  `--full` adds limits, drives, inertias as boxes, frames, and what a motion can identify.\n";

/// The summary of the arm of a description, with the number of its warnings.
pub fn of_arm(source: &Source, model: &Model, diagnostics: &Diagnostics, full: bool) -> String {
    let description = &RobotDescription::parse(source).0.unwrap_or_default();
    let manipulator = &model.manipulator;
    let verdict = match diagnostics.warnings() {
        0 => "valid".to_string(),
        warnings => format!("valid, with {}", counted(warnings, "warning")),
    };
    let title = format!("{}: {verdict}", source.name());
    let distances = posture::distances(manipulator);
    let parts = match full {
        true => vec![
            Some(arm(source, description, manipulator)),
            Some(joints::rows(source, description, manipulator)),
            joints::limits(manipulator),
            joints::drives(manipulator),
            Some(bodies::masses(manipulator, &distances)),
            bodies::inertias(manipulator),
            Some(posture::frames(manipulator)),
            Some(posture::carried(manipulator)),
            Some(identification::report(model)),
            Some(ADVICE.into()),
        ],
        false => vec![
            Some(arm(source, description, manipulator)),
            Some(joints::rows(source, description, manipulator)),
            Some(bodies::masses(manipulator, &distances)),
            Some(posture::carried(manipulator)),
            Some(ADVICE.to_owned() + MORE),
        ],
    };
    [title + "\n"].into_iter().chain(parts.into_iter().flatten()).collect::<Vec<_>>().join("\n")
}

/// The arm as a whole.
fn arm(source: &Source, description: &RobotDescription, manipulator: &Manipulator) -> String {
    let mut table = Table::new([("", Align::Left), ("", Align::Left)]);
    // Beside the longest of the names.
    let width = terminal::width() - "  mass of links and rotors  ".len();
    let mut row = |name: &str, text: String| {
        for (k, line) in wrapped(&text, width).into_iter().enumerate() {
            table.row([if k == 0 { name.to_string() } else { String::new() }, line]);
        }
    };
    row("robot", manipulator.name.clone());
    row("joints", manipulator.joints.len().to_string());
    if manipulator.coupling.is_some() {
        row("coordinates", manipulator.coordinates().iter().map(|of| of.joint.name.clone()).collect::<Vec<_>>().join(", "));
        joints::couplings(manipulator).into_iter().for_each(|sentence| row("coupling", sentence));
    }
    joints::closures(description).into_iter().for_each(|sentence| row("closed loop", sentence));
    joints::motors(manipulator).into_iter().for_each(|sentence| row("motor", sentence));
    let convention = match description.convention.as_ref().map(|c| c.value) {
        Some(Convention::Urdf) => "urdf: origin, then the motion about or along axis",
        Some(Convention::Modified) => "modified Denavit-Hartenberg: Rx(alpha) Tx(a) Rz(theta) Tz(d)",
        _ => "standard Denavit-Hartenberg: Rz(theta) Tz(d) Tx(a) Rx(alpha)",
    };
    row("convention", convention.into());
    if !description.units.is_empty() {
        let named = description.units.iter().map(|named| format!("{} {}", named.key, named.text.value));
        row("units of the file", format!("{}; here in SI", named.collect::<Vec<_>>().join(", ")));
    }
    if let Some(products) = &description.products {
        row(
            "products of inertia",
            match products.value {
                Products::Tensor => "elements of the tensor, -∫xy dm".into(),
                Products::Integral => "integrals ∫xy dm in the file, -∫xy dm here".into(),
            },
        );
    }
    let at_nominal = |p: &Polynomial| derive::parameters::nominal(manipulator, p);
    let gravity: Vec<String> = manipulator.gravity.iter().map(|g| decimal(&at_nominal(g))).collect();
    let up = bodies::up(manipulator.gravity.each_ref().map(|g| at_nominal(g).to_f64()));
    let argument = if manipulator.gravity_is_argument { "; an argument of the functions, nominal here" } else { "" };
    row("gravity", format!("({}) m/s²: {up}{argument}", gravity.join(", ")));
    let rotors = manipulator.joints.iter().filter_map(|j| j.motor.as_ref()).map(|m| &m.mass);
    let links = manipulator.joints.iter().flat_map(|j| &j.link).map(|part| &part.body.mass);
    let total = links.chain(rotors).fold(Number::zero(), |sum, mass| &sum + &at_nominal(mass));
    let loads = manipulator.loads();
    let without = if !loads.is_empty() { ", the payload not counted" } else { "" };
    row("mass of links and rotors", format!("{} kg{without}", decimal(&total)));
    for load in &loads {
        let of = load.of.map_or(String::new(), |tip| format!(" on {tip}"));
        row("payload", format!("{} kg{of}", decimal(&at_nominal(&load.body.body.mass))));
    }
    row("reach", reach::in_words(manipulator));
    for tip in &manipulator.tips {
        let joint = &manipulator.joints[tip.joint.index()].name;
        let (moved, rows) = (manipulator.coordinates_of(tip.joint.index()).len(), tip.task.iter().map(|row| row.name()));
        let rows = rows.collect::<Vec<_>>().join(", ");
        row("end effector", format!("{} on {joint}, moved by {}; task {rows}", tip.name, counted(moved, "joint")));
    }
    let rows: Vec<&str> = manipulator.task.iter().map(|row| row.name()).collect();
    let of_end_effector = manipulator.coordinates_of(manipulator.tip.index()).len();
    let (m, n) = (rows.len(), of_end_effector);
    let against = match m.cmp(&n) {
        std::cmp::Ordering::Equal => "as many rows as joints".to_string(),
        std::cmp::Ordering::Less => format!("{} to spare", counted(n - m, "joint")),
        std::cmp::Ordering::Greater => format!("{m} rows for {}: not all can be followed", counted(n, "joint")),
    };
    let of = if n < manipulator.dof() { format!("; {} move the end effector", counted(n, "joint")) } else { String::new() };
    if manipulator.tips.is_empty() {
        row("task", format!("{} ({against}{of})", rows.join(", ")));
    }
    for solved in Solved::all(manipulator) {
        let found = match &solved.found {
            Ok(found) => format!("{}: at most {}", found.class, counted(found.most, "solution")),
            // Two lines always have a common normal, which a row of 17 digits holds where no short number does.
            Err(reason) => match rows::solved(source, solved.tip.as_deref()) {
                Some(found) => format!(
                    "of the rows that `armgen convert --convention standard` writes: {}, at most {}",
                    found.class,
                    counted(found.most, "solution")
                ),
                None => format!("none: {reason}"),
            },
        };
        row("inverse kinematics", solved.tip.as_ref().map_or(found.clone(), |tip| format!("{tip}, {found}")));
    }
    let names = manipulator.parameters.len();
    row("named parameters", names.to_string());
    let regressor = match &manipulator.regressor {
        RegressorChoice::Standard => "standard",
        RegressorChoice::Base => "base",
        RegressorChoice::Names(_) if manipulator.is_massless() => "none: the arm has no dynamics",
        RegressorChoice::Names(_) => "names of the file",
    };
    row("regressor", regressor.into());
    table.text()
}

/// The meaning of columns, each after its name and a colon, in lines below their table; empty parts are left out.
fn legend(parts: &[&str]) -> String {
    let text = parts.iter().copied().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ");
    wrapped(&text, terminal::width() - 2).iter().map(|line| format!("  {line}\n")).collect()
}

/// A text in lines of at most so many characters, but for a word that is longer.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.last_mut().expect("there is one");
        match last.is_empty() {
            true => last.push_str(word),
            false if last.chars().count() + 1 + word.chars().count() <= width => *last += &format!(" {word}"),
            false => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A number for people: six digits at most.
fn decimal(number: &Number) -> String {
    digits(number.to_f64())
}

/// As [`decimal`].
fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    // Exact numbers and what is formed of them may be larger than any float.
    if !value.is_finite() {
        let largest = if value < 0.0 { "below -1.8e308" } else { "above 1.8e308" };
        return if value.is_nan() { "unknown".into() } else { largest.into() };
    }
    if !(1e-4..1e6).contains(&size) {
        let text = format!("{value:.5e}");
        let (digits, exponent) = text.split_once('e').expect("the exponent was asked for");
        return format!("{}e{exponent}", without_zeros(digits));
    }
    let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
    without_zeros(&format!("{value:.decimals$}")).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use armgen_codegen::exact::Rational;

    #[test]
    fn legends_are_no_wider_than_a_line() {
        assert_eq!(legend(&["a: b", "", "c: d e"]), "  a: b; c: d e\n");
        let long = legend(&["word"; 40]);
        assert!(long.lines().all(|line| line.starts_with("  ") && line.chars().count() <= terminal::width()), "{long}");
        assert_eq!(long.matches("word").count(), 40);
    }

    #[test]
    fn numbers_that_no_float_holds_have_a_text() {
        let texts = [f64::INFINITY, f64::NEG_INFINITY, f64::NAN].map(digits);
        assert_eq!(texts, ["above 1.8e308", "below -1.8e308", "unknown"]);
    }

    #[test]
    fn numbers_have_six_digits_at_most() {
        let check = |numerator: i64, denominator: i64, expected: &str| {
            let number = Number::from(Rational::from(numerator) / Rational::from(denominator));
            assert_eq!(decimal(&number), expected);
        };
        check(0, 1, "0");
        check(20, 1, "20");
        check(-981, 100, "-9.81");
        check(1, 3, "0.333333");
        check(1, 20000, "5e-5");
        check(123_456_789, 1, "1.23457e8");
        check(100_000, 1, "100000");
    }
}
