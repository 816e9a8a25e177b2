//! The text of robot.yaml: what a person likes to read, the same for the same file.

use std::fmt::Write;

use armgen_codegen::source::{Source, Span};

use crate::chain::{Arm, Body, Pose, Row, Turn, ELEMENTS};
use crate::report::Report;
use crate::snap::Written;

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
    line("joints:");
    for row in &arm.rows {
        joint(&mut line, source, arm, row);
    }
    if !is_identity(&arm.tool) {
        line(&format!("tool: {}{}", poses(&arm.tool), snapped(source, arm, &spans_of(&arm.tool))));
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

fn joint(line: &mut impl FnMut(&str), source: &Source, arm: &Arm, row: &Row) {
    let at = source.place(row.span.start).line;
    line(&format!("  - name: {}  # joint {}, link {}, line {at}", row.name, plain(&row.joint), plain(&row.link)));
    line(&format!("    type: {}", if row.prismatic { "prismatic" } else { "revolute" }));
    if !is_identity(&row.origin) {
        line(&format!("    origin: {}{}", poses(&row.origin), snapped(source, arm, &spans_of(&row.origin))));
    }
    line(&format!("    axis: {}{}", vector(&row.axis), note_of_axis(source, arm, row)));
    let mut limits = Vec::new();
    if let Some([low, high]) = &row.position {
        limits.push(format!("position: [{}, {}]", low.text, high.text));
    }
    limits.extend(row.velocity.iter().map(|v| format!("velocity: {}", v.text)));
    limits.extend(row.effort.iter().map(|e| format!("effort: {}", e.text)));
    if !limits.is_empty() {
        line(&format!("    limits: {{{}}}", limits.join(", ")));
    }
    line("    link:");
    match &row.body {
        Some(body) => mass_distribution(line, "      ", body),
        None => line("      mass: 0"),
    }
    if !row.attached.is_empty() {
        line("      attached:");
    }
    for other in &row.attached {
        let at = source.place(other.span.start).line;
        line(&format!("        - name: {}  # line {at}", quoted(&other.link)));
        if !is_identity(&other.origin) {
            line(&format!("          origin: {}{}", poses(&other.origin), snapped(source, arm, &spans_of(&other.origin))));
        }
        mass_distribution(line, "          ", &other.body);
    }
    let mut friction = Vec::new();
    friction.extend(row.viscous.iter().map(|v| format!("viscous: {}", v.text)));
    friction.extend(row.coulomb.iter().map(|c| format!("coulomb: {}", c.text)));
    if !friction.is_empty() {
        line(&format!("    friction: {{{}}}", friction.join(", ")));
    }
}

fn mass_distribution(line: &mut impl FnMut(&str), indent: &str, body: &Body) {
    line(&format!("{indent}mass: {}", body.mass.text));
    if !body.mass.is_zero() && body.com.iter().any(|x| !x.is_zero()) {
        line(&format!("{indent}com: {}", vector(&body.com)));
    }
    let mut elements: Vec<String> = ELEMENTS
        .iter()
        .zip(&body.inertia)
        .filter(|(_, element)| !element.is_zero())
        .map(|((_, key), element)| format!("{key}: {}", element.text))
        .collect();
    if elements.is_empty() {
        return;
    }
    if body.rpy.iter().any(|x| !x.is_zero()) {
        elements.push(format!("rpy: {}", vector(&body.rpy)));
    }
    line(&format!("{indent}inertia: {{{}}}", elements.join(", ")));
}

fn vector(three: &[Written; 3]) -> String {
    format!("[{}]", three.each_ref().map(|x| x.text.as_str()).join(", "))
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
        match &pose.turn {
            Turn::Rpy(rpy) if rpy.iter().any(|x| !x.is_zero()) => parts.push(format!("rpy: {}", vector(rpy))),
            Turn::Rpy(_) => {}
            Turn::AxisAngle(turn) => parts.push(format!("axis: {}, angle: {}", vector(&turn.axis), turn.angle)),
        }
        format!("{{{}}}", parts.join(", "))
    };
    let all: Vec<String> = list.iter().filter(|pose| !pose.is_identity()).map(one).collect();
    match &all[..] {
        [only] => only.clone(),
        all => format!("[{}]", all.join(", ")),
    }
}

/// A name of the file as a scalar of YAML.
fn quoted(name: &str) -> String {
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
        spans.extend(pose.xyz.iter().map(|x| x.span));
        if let Turn::Rpy(rpy) = &pose.turn {
            spans.extend(rpy.iter().map(|x| x.span));
        }
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
    if row.axis_offset == 0.0 {
        return String::new();
    }
    snapped(source, arm, &row.axis.each_ref().map(|x| x.span))
}
