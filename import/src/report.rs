//! The report of an import: as JSON for programs, and in a few lines for people.

use std::collections::BTreeMap;

use armgen_codegen::kinds::MAX_JOINTS;
use armgen_codegen::source::{Source, Span};
use serde_json::{json, Map, Value};

use crate::body::Body;
use crate::bound::Bound;
use crate::chain::{Arm, Attached, End, Follows, Row};
use crate::format::Format;
use crate::snap::Snapped;

/// The parts that were taken, changed and left out.
#[derive(Clone, Debug)]
pub struct Report {
    json: Value,
    lines: Vec<String>,
    short: Vec<String>,
    attached: usize,
    near: usize,
    moved: f64,
    idle: Vec<String>,
}

/// The most names of a list on a terminal: a humanoid has a hundred joints besides an arm.
const NAMED: usize = 12;

impl Report {
    /// As JSON: `robot`, `format`, `base`, `tip`, `joints`, `snapped`, `rounded`, `locked`, `lumped`, `left_out`, `bound`.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(&self.json).unwrap_or_default();
        text.push('\n');
        text
    }

    /// In words, a line for each kind of change.
    pub fn lines(&self) -> &[String] {
        &self.lines
    }

    /// The same with the first names of long lists and how many more there are.
    pub fn short_lines(&self) -> &[String] {
        &self.short
    }

    /// The same report with more lines.
    pub(crate) fn and(mut self, more: Vec<String>) -> Report {
        self.lines.extend(more.iter().cloned());
        self.short.extend(more);
        self
    }

    /// How many angles are nearly, but not, multiples of pi/12, and taken as written.
    pub fn near(&self) -> usize {
        self.near
    }

    /// By how much the origin of the end effector moves at most for what was taken for what it means, m.
    pub fn moved(&self) -> f64 {
        self.moved
    }

    /// Joints with coordinates that move no mass and no inertia, by their names in the description: with them B(q) is singular.
    pub fn idle(&self) -> &[String] {
        &self.idle
    }

    /// How many bodies are fixed to the links, which reading the description multiplies out.
    pub fn attached(&self) -> usize {
        self.attached
    }
}

/// The report of an arm.
pub(crate) fn of(source: &Source, format: &dyn Format, arm: &Arm, bound: Bound) -> Report {
    let at = |span: Span| {
        let place = source.place(span.start);
        (place.line, place.column)
    };
    let placed = |span: Span, entries: Vec<(&str, Value)>| {
        let (line, column) = at(span);
        let mut map = Map::new();
        entries.into_iter().for_each(|(key, value)| _ = map.insert(key.to_owned(), value));
        map.insert("line".into(), json!(line));
        map.insert("column".into(), json!(column));
        Value::Object(map)
    };
    let snapped =
        |s: &Snapped| placed(s.span, vec![("written", json!(s.written)), ("taken", json!(s.taken)), ("offset", json!(s.offset))]);
    let bodies = arm.rows.iter().flat_map(|row| lumped(row).map(move |other| (row, other)));
    let lumped: Vec<Value> =
        bodies.map(|(row, other)| placed(other.span, vec![("link", json!(other.link)), ("into", json!(row.name))])).collect();
    let locked: Vec<Value> = arm
        .locked
        .iter()
        .map(|lock| placed(lock.span, vec![("joint", json!(lock.joint)), ("value", json!(lock.text))]))
        .collect();
    let joint = |row: &Row| {
        let mut entries = vec![("name", json!(row.name)), ("source", json!(row.joint))];
        if let Some(Follows { leader, factor, offset, .. }) = &row.follows {
            let follows = json!({ "joint": arm.rows[*leader].name, "multiplier": factor.text, "offset": offset.text });
            entries.push(("follows", follows));
        }
        placed(row.span, entries)
    };
    let joints: Vec<Value> = arm.rows.iter().map(joint).collect();
    let rounded: Vec<Value> = if arm.gravity_rounded { vec![json!({"what": "gravity", "digits": 17})] } else { Vec::new() };
    let mut left_out = format.left_out();
    for (what, count) in [
        ("position limits beyond any arm", arm.boundless),
        ("effort limits of 0", arm.unknown_efforts),
        ("effort limits of joints that follow others", arm.led_efforts),
    ] {
        if count > 0 {
            left_out.insert(what.to_owned(), count);
        }
    }
    let mut json = json!({
        "robot": arm.name,
        "format": format.name(),
        "base": arm.base,
        "tip": arm.ends.first().map(|end| end.link.as_str()),
        "joints": joints,
        "snapped": arm.snap.snapped.iter().map(snapped).collect::<Vec<_>>(),
        "rounded": rounded,
        "locked": locked,
        "lumped": lumped,
        "left_out": left_out,
        "bound": {
            "flange": bound.flange,
            "orientation": bound.orientation,
            "torque": bound.torque,
            "joint": arm.rows.get(bound.joint).map(|row| row.name.as_str()),
        },
    });
    if arm.ends.iter().any(|end| end.name.is_some()) {
        let end = |end: &End| json!({ "name": end.name, "link": end.link, "joint": arm.rows[end.row].name });
        json["tips"] = arm.ends.iter().map(end).collect();
    }
    let words = |most| words(source, arm, bound, &left_out, most);
    let attached = arm.rows.iter().map(|row| row.attached.len()).sum();
    Report {
        lines: words(usize::MAX),
        short: words(NAMED),
        json,
        attached,
        near: arm.snap.near.len(),
        moved: bound.flange,
        idle: idle(arm),
    }
}

/// The joints with coordinates that move nothing with mass or inertia. An arm without any is one of kinematics alone.
fn idle(arm: &Arm) -> Vec<String> {
    let is_felt = |body: &Body| !body.mass.is_zero() || body.inertia.iter().any(|element| !element.is_zero());
    let has_bodies = |row: &Row| row.body.iter().chain(row.attached.iter().map(|other| &other.body)).any(is_felt);
    let leads = |i: usize, led: usize| chain(led, |k| Some(arm.rows[k].follows.as_ref()?.leader)).any(|row| row == i);
    let moves = |i: usize| {
        let driven: Vec<usize> = (0..arm.rows.len()).filter(|&led| leads(i, led)).collect();
        let mut carried =
            arm.rows.iter().enumerate().filter(|(k, _)| chain(*k, |k| arm.rows[k].parent).any(|row| driven.contains(&row)));
        driven.iter().any(|&row| arm.rows[row].motion.armature.is_some()) || carried.any(|(_, row)| has_bodies(row))
    };
    let own = (0..arm.rows.len()).filter(|&i| arm.rows[i].follows.is_none());
    let idle: Vec<String> = own.filter(|&i| !moves(i)).map(|i| arm.rows[i].name.clone()).collect();
    if arm.rows.iter().any(has_bodies) {
        idle
    } else {
        Vec::new()
    }
}

/// A row and those that `next` leads to; no more than an arm has, should the file lead in a ring.
fn chain(row: usize, next: impl Fn(usize) -> Option<usize>) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(row), move |&row| next(row)).take(MAX_JOINTS)
}

fn words(source: &Source, arm: &Arm, bound: Bound, left_out: &BTreeMap<String, usize>, most: usize) -> Vec<String> {
    let mut lines = arm.notes.clone();
    let list = |all: Vec<String>| match all.len().saturating_sub(most) {
        0 => all.join(", "),
        more => format!("{} and {more} more", all[..most].join(", ")),
    };
    let names = |names: Vec<&str>| list(names.iter().map(|name| format!("`{name}`")).collect());
    let ends: Vec<String> = arm.ends.iter().map(|end| format!("`{}`", end.link)).collect();
    lines.push(format!("`{}` to {}: {}", arm.base, ends.join(", "), counted(arm.rows.len(), "moving joint")));
    let renamed: Vec<String> =
        arm.rows.iter().filter(|row| row.name != row.joint).map(|row| format!("`{}` is `{}`", row.joint, row.name)).collect();
    if !renamed.is_empty() {
        lines.push(format!("renamed: {}", list(renamed)));
    }
    let led = arm.rows.iter().filter_map(|row| Some((row, row.follows.as_ref()?)));
    let led: Vec<String> =
        led.map(|(row, follows)| format!("`{}` = {}", row.name, follows.formula(&arm.rows[follows.leader].name))).collect();
    if !led.is_empty() {
        lines.push(format!("joints that follow others: {}", list(led)));
    }
    if !arm.snap.snapped.is_empty() {
        let (name, unit) =
            arm.rows.get(bound.joint).map_or(("", "N m"), |row| (&row.name, if row.prismatic { "N" } else { "N m" }));
        lines.push(format!(
            "{} taken for what {}: within the limits, at accelerations up to 10 rad/s² or m/s², the end effector moves by at most {} m and {} rad, and a torque changes by at most {} {unit} (the largest bound, that of `{name}`)",
            counted(arm.snap.snapped.len(), "number"),
            if arm.snap.snapped.len() == 1 { "it means" } else { "they mean" },
            rounded_up(bound.flange),
            rounded_up(bound.orientation),
            rounded_up(bound.torque)
        ));
    }
    let every_digit = arm.snap.tolerance == 0.0;
    if let Some((span, text)) = arm.snap.near.first() {
        let place = source.place(span.start);
        lines.push(format!(
            "{}{} within 0.002 rad of a multiple of pi/12 and taken as written, the first one {text} in line {}{}",
            if every_digit { "every digit is taken, nothing is snapped: " } else { "" },
            counted(arm.snap.near.len(), "angle"),
            place.line,
            if every_digit { "" } else { "; `--snap` takes more for what they mean" }
        ));
    } else if every_digit {
        lines.push("every digit is taken, nothing is snapped".into());
    }
    let lumped: Vec<&str> = arm.rows.iter().flat_map(lumped).map(|other| other.link.as_str()).collect();
    if !lumped.is_empty() {
        lines.push(format!("fixed to the links that carry them: {}", names(lumped)));
    }
    let locked: Vec<String> = arm.locked.iter().map(|lock| format!("`{}` at {}", lock.joint, lock.text)).collect();
    if !locked.is_empty() {
        lines.push(format!("joints that stand still: {}", list(locked)));
    }
    if !arm.massless.is_empty() {
        lines.push(format!("links without mass: {}", names(arm.massless.iter().map(String::as_str).collect())));
    }
    if !arm.computed.is_empty() {
        lines.push(format!(
            "mass distributions computed from geometries: {}",
            names(arm.computed.iter().map(String::as_str).collect())
        ));
    }
    if !arm.impossible.is_empty() {
        lines.push(format!("inertias that no body has, taken as written: those of {}", arm.impossible.join(", ")));
    }
    lines.extend(arm.assumed.iter().cloned());
    if arm.left_out_branches > 0 {
        lines.push(format!("{} of the base left out: they do not move with the arm", counted(arm.left_out_branches, "branch")));
    }
    if arm.gravity_rounded {
        lines.push("gravity in the axes of the base link is rounded to 17 digits".into());
    }
    if !left_out.is_empty() {
        let all: Vec<String> = left_out.iter().map(|(name, count)| format!("{count} {name}")).collect();
        lines.push(format!("left out: {}", all.join(", ")));
    }
    lines
}

/// The bodies of a link that are not its own.
fn lumped(row: &Row) -> impl Iterator<Item = &Attached> {
    row.attached.iter().filter(|other| other.link != row.link)
}

/// A bound in two digits, not below it.
fn rounded_up(bound: f64) -> String {
    let nearest = format!("{bound:.1e}");
    if nearest.parse::<f64>().is_ok_and(|rounded| rounded >= bound) {
        return plain(&nearest);
    }
    // Half a unit of the last digit more.
    let power = nearest.split_once('e').map_or("0", |(_, power)| power);
    let half: f64 = format!("0.05e{power}").parse().unwrap_or_default();
    plain(&format!("{:.1e}", bound + half))
}

/// Two digits as people write them: with a power of ten only where that is shorter.
fn plain(digits: &str) -> String {
    let (_, power) = digits.split_once('e').unwrap_or_default();
    match (digits.parse::<f64>(), power.parse()) {
        (Ok(value), Ok(-2..=1)) => format!("{value}"),
        _ => digits.to_owned(),
    }
}

/// `1 number`, `2 numbers`.
fn counted(count: usize, word: &str) -> String {
    match (count, word.strip_suffix("ch")) {
        (1, _) => format!("1 {word}"),
        (_, Some(start)) => format!("{count} {start}ches"),
        _ => format!("{count} {word}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_is_never_rounded_below_itself() {
        for (bound, text) in [
            (0.0, "0"),
            (4.1e-6, "4.1e-6"),
            (4.1001e-6, "4.2e-6"),
            (9.96e-3, "0.01"),
            (9.91e2, "1.0e3"),
            (1.04, "1.1"),
            (52.0, "52"),
            (52.1, "53"),
        ] {
            assert_eq!(rounded_up(bound), text, "{bound}");
        }
    }
}
