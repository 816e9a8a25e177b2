//! The text of robot.yaml: readable, and always the same for the same file.

use std::fmt::Write;

use armgen_codegen::source::{Source, Span};

use crate::body::{Body, ELEMENTS};
use crate::chain::{Arm, End, Follows, Row};
use crate::pose::{Pose, Turn};
use crate::report::Report;
use crate::written::Written;

/// The reason that a description gives for accepting tensors as written.
const IMPOSSIBLE: &str = "B(q) may not be positive definite: for kinematics and a look, not for control";

/// The description of an arm.
pub(crate) fn text(source: &Source, arm: &Arm, report: &Report) -> String {
    let mut text = String::new();
    let mut line = |words: &str| writeln!(text, "{words}").expect("a text takes it");
    let file = source.name().rsplit(['/', '\\']).next().unwrap_or_default();
    line(&format!("# From {}, robot {}.", plain(file), plain(&arm.robot)));
    for words in report.lines() {
        line(&format!("# {}", plain(&capital(words))));
    }
    line(&format!("name: {}", arm.name));
    line("convention: urdf");
    line(&format!("gravity: [{}]", arm.gravity.join(", ")));
    // Who asks for every digit is not asked whether pi/2 is meant.
    let every_digit = arm.snap.tolerance == 0.0 && !arm.snap.near.is_empty();
    match (arm.impossible.is_empty(), every_digit) {
        (true, false) => {}
        (true, true) => line("allow: [rounded-angle]  # every digit is meant"),
        (false, false) => line(&format!("allow: [impossible-inertia]  # {IMPOSSIBLE}")),
        (false, true) => line(&format!("allow: [impossible-inertia, rounded-angle]  # {IMPOSSIBLE}; every digit is meant")),
    }
    line("joints:");
    for (k, row) in arm.rows.iter().enumerate() {
        joint(&mut line, source, arm, k, row);
    }
    for End { row, .. } in arm.ends.iter().filter(|end| end.name.is_none() && end.row + 1 != arm.rows.len()) {
        line(&format!("tip: {}", arm.rows[*row].name));
    }
    for End { tool, .. } in arm.ends.iter().filter(|end| end.name.is_none() && !is_identity(&end.tool)) {
        line(&format!("tool: {}{}", poses(tool), snapped(source, arm, &spans_of(tool))));
    }
    if arm.ends.iter().any(|end| end.name.is_some()) {
        line("tips:");
    }
    for End { name, link, row, tool } in &arm.ends {
        let Some(name) = name else { continue };
        line(&format!("  - name: {name}  # link {}", plain(link)));
        line(&format!("    joint: {}", arm.rows[*row].name));
        if !is_identity(tool) {
            line(&format!("    tool: {}{}", poses(tool), snapped(source, arm, &spans_of(tool))));
        }
    }
    text
}

/// A text without line breaks, for a comment.
fn plain(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() || matches!(c, '\u{85}' | '\u{2028}' | '\u{2029}' | '\u{feff}') { ' ' } else { c })
        .collect()
}

fn capital(words: &str) -> String {
    let mut chars = words.chars();
    let first = chars.next().map_or_else(String::new, |c| c.to_uppercase().collect());
    format!("{first}{}.", chars.as_str())
}

fn joint(line: &mut impl FnMut(&str), source: &Source, arm: &Arm, k: usize, row: &Row) {
    let at = source.place(row.span.start).line;
    line(&format!("  - name: {}  # joint {}, link {}, line {at}", row.name, plain(&row.joint), plain(&row.link)));
    line(&format!("    type: {}", if row.prismatic { "prismatic" } else { "revolute" }));
    if row.parent != k.checked_sub(1) {
        line(&format!("    parent: {}", row.parent.map_or("base", |parent| arm.rows[parent].name.as_str())));
    }
    if !is_identity(&row.origin) {
        line(&format!("    origin: {}{}", poses(&row.origin), snapped(source, arm, &spans_of(&row.origin))));
    }
    line(&format!("    axis: {}{}", vector(&row.motion.axis), note_of_axis(source, arm, row)));
    if let Some(Follows { leader, factor, offset, .. }) = &row.follows {
        line(&format!("    follows: {{{}: {}}}", arm.rows[*leader].name, factor.text));
        if !offset.is_zero() {
            line(&format!("    offset: {}", offset.text));
        }
    }
    let mut limits = Vec::new();
    if let Some([low, high]) = &row.motion.position {
        limits.push(format!("position: [{}, {}]", low.text, high.text));
    }
    let motion = &row.motion;
    let sizes = [
        ("velocity", &motion.velocity),
        ("acceleration", &motion.acceleration),
        ("jerk", &motion.jerk),
        ("effort", &motion.effort),
    ];
    limits.extend(sizes.into_iter().filter_map(|(key, size)| Some(format!("{key}: {}", size.as_ref()?.text))));
    if !limits.is_empty() {
        line(&format!("    limits: {{{}}}", limits.join(", ")));
    }
    line("    link:");
    match &row.body {
        Some(body) => mass_distribution(line, "      ", body, source, arm),
        None => line("      mass: 0"),
    }
    if !row.attached.is_empty() {
        line("      attached:");
    }
    for other in &row.attached {
        let at = source.place(other.span.start).line;
        line(&format!("        - name: {}  # line {at}", quoted(&other.name)));
        if !is_identity(&other.origin) {
            line(&format!("          origin: {}{}", poses(&other.origin), snapped(source, arm, &spans_of(&other.origin))));
        }
        mass_distribution(line, "          ", &other.body, source, arm);
    }
    let mut friction = Vec::new();
    friction.extend(row.motion.viscous.iter().map(|v| format!("viscous: {}", v.text)));
    friction.extend(row.motion.coulomb.iter().map(|c| format!("coulomb: {}", c.text)));
    if !friction.is_empty() {
        line(&format!("    friction: {{{}}}", friction.join(", ")));
    }
    if let Some((stiffness, rest)) = &row.motion.spring {
        let rest = rest.as_ref().map_or(String::new(), |rest| format!(", rest: {}", rest.text));
        line(&format!("    spring: {{stiffness: {}{rest}}}", stiffness.text));
    }
    if let Some(armature) = &row.motion.armature {
        line(&format!("    armature: {}", armature.text));
    }
}

fn mass_distribution(line: &mut impl FnMut(&str), indent: &str, body: &Body, source: &Source, arm: &Arm) {
    line(&format!("{indent}mass: {}", body.mass.text));
    // A centre that was taken for 0 stands there, with what was written.
    if !body.mass.is_zero() && body.com.iter().any(|x| !x.is_zero() || x.offset > 0.0) {
        line(&format!("{indent}com: {}{}", vector(&body.com), snapped(source, arm, &body.com.each_ref().map(|x| x.span))));
    }
    let mut elements: Vec<String> = ELEMENTS
        .iter()
        .zip(&body.inertia)
        .filter(|(_, element)| !element.is_zero())
        .map(|(key, element)| format!("{key}: {}", element.text))
        .collect();
    if elements.is_empty() {
        return;
    }
    elements.extend(rotation(&body.turn));
    let spans: Vec<Span> = body.inertia.iter().chain(body.turn.numbers()).map(|x| x.span).collect();
    line(&format!("{indent}inertia: {{{}}}{}", elements.join(", "), snapped(source, arm, &spans)));
}

fn vector(numbers: &[Written]) -> String {
    format!("[{}]", numbers.iter().map(|x| x.text.as_str()).collect::<Vec<_>>().join(", "))
}

/// A rotation as keys of a mapping; `None` without a rotation.
fn rotation(turn: &Turn) -> Option<String> {
    match turn {
        turn if turn.is_none() => None,
        Turn::Rpy(rpy) => Some(format!("rpy: {}", vector(rpy))),
        Turn::AxisAngle(turn) => Some(format!("axis: {}, angle: {}", vector(&turn.axis), turn.angle.text)),
        Turn::Quat(quat, _) => Some(format!("quat: {}", vector(quat))),
        Turn::XyAxes(axes, _) => Some(format!("xyaxes: {}", vector(axes))),
    }
}

/// Whether nothing of the poses is left to write.
fn is_identity(list: &[Pose]) -> bool {
    list.iter().all(Pose::is_identity)
}

/// One pose, or a list.
fn poses(list: &[Pose]) -> String {
    let one = |pose: &Pose| {
        let mut parts = Vec::new();
        if pose.xyz.iter().any(|x| !x.is_zero()) {
            parts.push(format!("xyz: {}", vector(&pose.xyz)));
        }
        parts.extend(rotation(&pose.turn));
        format!("{{{}}}", parts.join(", "))
    };
    let all: Vec<String> = list.iter().filter(|pose| !pose.is_identity()).map(one).collect();
    match &all[..] {
        [only] => only.clone(),
        all => format!("[{}]", all.join(", ")),
    }
}

/// A name of the file as a scalar of YAML.
pub(crate) fn quoted(name: &str) -> String {
    let simple = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
        && !matches!(name.to_ascii_lowercase().as_str(), "null" | "true" | "false" | "yes" | "no" | "on" | "off" | "y" | "n");
    if simple {
        return name.to_owned();
    }
    format!("'{}'", plain(name).replace('\'', "''"))
}

/// Places of the numbers of poses.
fn spans_of(list: &[Pose]) -> Vec<Span> {
    let mut spans = Vec::new();
    for pose in list {
        spans.extend(pose.xyz.iter().chain(pose.turn.numbers()).map(|x| x.span));
    }
    spans
}

/// A comment with what was written where something else is taken.
fn snapped(source: &Source, arm: &Arm, spans: &[Span]) -> String {
    let mut notes: Vec<String> = Vec::new();
    for s in arm.snap.snapped.iter().filter(|s| spans.contains(&s.span)) {
        let note = format!("{} in line {}", s.written, source.place(s.span.start).line);
        if !notes.contains(&note) {
            notes.push(note);
        }
    }
    match notes.len() {
        0 => String::new(),
        1..=3 => format!("  # {}", notes.join(", ")),
        more => format!("  # {}, {} more", notes[..2].join(", "), more - 2),
    }
}

fn note_of_axis(source: &Source, arm: &Arm, row: &Row) -> String {
    if row.motion.axis_offset == 0.0 {
        return String::new();
    }
    snapped(source, arm, &row.motion.axis.each_ref().map(|x| x.span))
}
