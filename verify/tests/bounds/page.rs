//! Whether docs/error-bounds.md is of the modules of now. Errors are measured by hand, for an hour; the bounds beside them follow from the text of a
//! module alone: a module with other bounds has been changed since it was measured. That one with the same bounds has not is not shown.

use std::collections::{BTreeMap, BTreeSet};

use armgen_codegen::kinds::Scalar;
use armgen_verify::bounds::{of, two_digits};

use super::{common, robot};

const PAGE: &str = include_str!("../../../docs/error-bounds.md");

/// The cells of a row.
fn cells(line: &str) -> Vec<&str> {
    line.trim_matches('|').split('|').map(str::trim).collect()
}

/// Name of a robot and what the page has of it.
fn sections() -> impl Iterator<Item = (&'static str, &'static str)> {
    PAGE.split("\n### ").skip(1).map(|section| (section.split(',').next().expect("a name"), section))
}

/// The rows of a section by the names of their functions.
fn rows(section: &'static str) -> BTreeMap<&'static str, Vec<&'static str>> {
    let rows = section.lines().filter(|line| line.starts_with("| `")).map(cells);
    rows.map(|cells| (cells[0].trim_matches('`'), cells)).collect()
}

#[test]
fn every_robot_has_a_section() {
    let robots: BTreeSet<String> =
        common::paths().iter().map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned()).collect();
    let measured: BTreeSet<String> = sections().map(|(name, _)| name.to_owned()).collect();
    assert_eq!(measured, robots);
}

#[test]
#[ignore = "wide"]
fn each_function_has_the_bounds_of_now() {
    let mut stale = Vec::new();
    let mut of_torques = BTreeMap::new();
    for (name, section) in sections() {
        let (_, module, claims, manipulator) = robot(name, Scalar::F64);
        let bounds = of(&manipulator, &module, &claims);
        let rows = rows(section);
        for (function, bound) in &bounds {
            let (now, then) = (two_digits(bound.largest()), rows.get(function.as_str()).map(|cells| cells[5]));
            if then != Some(&now) {
                stale.push(format!("{name}, `{function}`: {then:?}, now {now}"));
            }
            if let Some(torques) = bound.residual {
                let now = [two_digits(torques.constant), two_digits(torques.factor)];
                let said = format!("`{function}` is that of torques off by at most {} + {} max ddq;", now[0], now[1]);
                if !section.contains(&said) {
                    stale.push(format!("{name}, now {said}"));
                }
                if function == "forward_dynamics" {
                    of_torques.insert(name, now);
                }
            }
        }
        stale.extend(rows.keys().filter(|row| !bounds.contains_key(**row)).map(|row| format!("{name} has no `{row}`")));
    }
    let table = PAGE.split("| robot | a, N m or N |").nth(1).expect("a table of torques");
    let table = table.lines().skip(2).take_while(|line| line.starts_with('|')).map(cells);
    let table: BTreeMap<&str, [String; 2]> = table.map(|c| (c[0], [c[1].to_owned(), c[2].to_owned()])).collect();
    if table != of_torques {
        stale.push(format!("bounds of torques: {table:?}, now {of_torques:?}"));
    }
    assert!(stale.is_empty(), "to be measured anew by the command of the page:\n{}", stale.join("\n"));
}

/// What the page says of all robots is what their tables have.
#[test]
fn the_table_of_errors_seen_is_that_of_the_tables() {
    let table = PAGE.split("\n## Errors seen\n").nth(1).expect("a table").split("\n### ").next().expect("its end");
    let table: BTreeMap<&str, Vec<&str>> =
        table.lines().filter(|line| line.starts_with("| ")).skip(1).map(cells).map(|cells| (cells[0], cells)).collect();
    assert_eq!(table.len(), sections().count());
    for (name, section) in sections() {
        let rows = rows(section);
        let ratio = |cells: &Vec<&str>| cells[4].parse::<f64>().unwrap_or(0.0);
        let worst = rows.iter().max_by(|a, b| ratio(a.1).total_cmp(&ratio(b.1))).expect("functions");
        let (inverse, forward) = (&rows["inverse_dynamics"], &rows["forward_dynamics"]);
        let largest = format!("{} (`{}`)", worst.1[4], worst.0);
        assert_eq!(table[name], [name, inverse[2], inverse[4], forward[2], forward[4], largest.as_str()]);
        assert!(section.contains(&format!("Bounds exceeded: 0 times. Largest ratio: {}.", worst.1[4])), "{name}");
    }
}
