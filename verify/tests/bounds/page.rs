//! Whether docs/error-bounds.md and benches/results/error-bounds describe the current modules. The errors take an hour to measure, so this runs
//! manually; the bounds in the same tables follow from a module's text alone. A module with other bounds has changed since its measurement; even
//! with the same bounds it may have changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use armgen_codegen::kinds::Scalar;
use armgen_verify::floats::bounds::{of, two_digits};

use super::{common, robot};

const PAGE: &str = include_str!("../../../docs/error-bounds.md");
const COLUMNS: usize = 11;

/// The measured table of a robot: the first line of its file, and the rows by function name.
struct Table {
    summary: String,
    rows: BTreeMap<String, Vec<String>>,
}

/// The f64 tables by robot name.
fn tables() -> BTreeMap<String, Table> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/results/error-bounds");
    let files = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    files
        .filter_map(|path| Some((path.file_name()?.to_string_lossy().strip_suffix("-f64.csv")?.to_owned(), path)))
        .map(|(name, path)| {
            let text = std::fs::read_to_string(path).expect("a text");
            let mut lines = text.lines();
            let summary = lines.next().expect("a summary").to_owned();
            let rows = lines.skip(1).map(|line| line.split(',').map(str::to_owned).collect::<Vec<String>>());
            let rows = rows.inspect(|cells| assert_eq!(cells.len(), COLUMNS, "{name}: {cells:?}"));
            let rows = rows.map(|cells| (cells[0].clone(), cells)).collect();
            (name, Table { summary, rows })
        })
        .collect()
}

/// The cells of each row in a table of the page, by the first cell.
fn on_the_page(head: &str) -> BTreeMap<&'static str, Vec<&'static str>> {
    let table = PAGE.split(head).nth(1).expect("a table");
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|line| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<&str>>())
        .map(|cells| (cells[0], cells))
        .collect()
}

#[test]
fn every_robot_has_a_section() {
    let robots: BTreeSet<String> =
        common::paths().iter().map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned()).collect();
    let tables = tables();
    assert_eq!(tables.keys().cloned().collect::<BTreeSet<String>>(), robots);
    for (name, table) in &tables {
        assert!(table.summary.contains("; bounds exceeded: 0; "), "{name}: {}", table.summary);
    }
}

#[test]
#[ignore = "wide"]
fn each_function_has_the_bounds_of_now() {
    let mut stale = Vec::new();
    let mut of_torques = BTreeMap::new();
    for (name, table) in tables() {
        let (_, module, claims, manipulator) = robot(&name, Scalar::F64);
        let bounds = of(&manipulator, &module, &claims);
        for (function, bound) in &bounds {
            let torques = bound.residual.map(|torques| [two_digits(torques.constant), two_digits(torques.factor)]);
            let [a, b] = torques.clone().unwrap_or_default();
            let now = [two_digits(bound.largest()), a, b];
            let then = table.rows.get(function).map(|cells| [5, 7, 8].map(|column| cells[column].clone()));
            if then.as_ref() != Some(&now) {
                stale.push(format!("{name}, `{function}`: {then:?}, now {now:?}"));
            }
            if let (Some(torques), "forward_dynamics") = (torques, function.as_str()) {
                of_torques.insert(name.clone(), torques);
            }
        }
        stale.extend(table.rows.keys().filter(|row| !bounds.contains_key(*row)).map(|row| format!("{name} has no `{row}`")));
    }
    let table = on_the_page("| robot | a, N m or N |");
    let table: BTreeMap<String, [String; 2]> =
        table.iter().map(|(name, c)| ((*name).into(), [c[1].into(), c[2].into()])).collect();
    if table != of_torques {
        stale.push(format!("bounds of torques: {table:?}, now {of_torques:?}"));
    }
    assert!(stale.is_empty(), "to be measured anew by the command of the page:\n{}", stale.join("\n"));
}

/// The summary on the page repeats the tables of all robots.
#[test]
fn the_table_of_errors_seen_is_that_of_the_tables() {
    let seen = on_the_page("| robot | `inverse_dynamics`: worst error |");
    let tables = tables();
    assert_eq!(seen.len(), tables.len());
    for (name, Table { rows, .. }) in &tables {
        let ratio = |cells: &Vec<String>| cells[4].parse::<f64>().unwrap_or(0.0);
        let worst = rows.iter().max_by(|a, b| ratio(a.1).total_cmp(&ratio(b.1))).expect("functions");
        let (inverse, forward) = (&rows["inverse_dynamics"], &rows["forward_dynamics"]);
        let largest = format!("{} (`{}`)", worst.1[4], worst.0);
        assert_eq!(seen[name.as_str()], [name, &inverse[2], &inverse[4], &forward[2], &forward[4], &largest]);
    }
}
