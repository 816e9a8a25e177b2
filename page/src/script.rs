//! The script of a page: ES modules, a file per concept, joined into a single text.
//!
//! Each file becomes a function that runs once and returns the file's exports. An import reads the result of an earlier function.
//! Tests run the unmodified files; the build script removes comments and indentation alone. Imports and exports have a single form each:
//!
//! ```text
//! import { name, name } from "./file.mjs";
//! export function name    export async function name    export class name    export const name
//! ```

use std::fmt::Write;

use crate::brief::brief;

/// A file of `web/` as the build script shortens it.
macro_rules! web {
    ($name:literal) => {
        include_str!(concat!(env!("OUT_DIR"), "/", $name))
    };
}

/// The files, each after the files it imports.
const FILES: &[(&str, &str)] = &[
    ("vector", web!("vector.mjs")),
    ("format", web!("format.mjs")),
    ("dom", web!("dom.mjs")),
    ("formula", web!("formula.mjs")),
    ("mathml", web!("mathml.mjs")),
    ("unpack", web!("unpack.mjs")),
    ("linear", web!("linear.mjs")),
    ("noise", web!("noise.mjs")),
    ("equations", web!("equations.mjs")),
    ("kinematics", web!("kinematics.mjs")),
    ("view", web!("view.mjs")),
    ("labels", web!("labels.mjs")),
    ("solids", web!("solids.mjs")),
    ("bodies", web!("bodies.mjs")),
    ("scene", web!("scene.mjs")),
    ("dimension", web!("dimension.mjs")),
    ("state", web!("state.mjs")),
    ("sliders", web!("sliders.mjs")),
    ("sticky_picture", web!("sticky_picture.mjs")),
    ("picture", web!("picture.mjs")),
    ("free_fall", web!("free_fall.mjs")),
    ("sheet", web!("sheet.mjs")),
    ("dependent_axes", web!("dependent_axes.mjs")),
    ("lost_motion", web!("lost_motion.mjs")),
    ("search", web!("search.mjs")),
    ("singular", web!("singular.mjs")),
    ("numbers", web!("numbers.mjs")),
    ("suspects", web!("suspects.mjs")),
    ("check", web!("check.mjs")),
    ("reach", web!("reach.mjs")),
    ("workspace", web!("workspace.mjs")),
    ("postures", web!("postures.mjs")),
    ("logs", web!("logs.mjs")),
    ("cost", web!("cost.mjs")),
    ("settings", web!("settings.mjs")),
    ("main", web!("main.mjs")),
];

/// Replaces the file that plays logs if the page has no logs.
const WITHOUT_LOGS: &str = "export function logs() {}\n";

/// The plotting library and its licence, only in pages with logs.
const PLOTS: &str = include_str!("../vendor/uPlot-1.6.32/uPlot.iife.min.js");
const PLOTS_LICENCE: &str = include_str!("../vendor/uPlot-1.6.32/LICENSE");

/// The script of a page: the emitted module and the files.
pub(crate) fn script(module: &str, with_plots: bool) -> String {
    let mut text = String::new();
    if with_plots {
        let _ = writeln!(text, "/*\n{PLOTS_LICENCE}*/\n{PLOTS}");
    }
    text += "globalThis.robot = ";
    text += &closed(&brief(module));
    for (name, file) in FILES {
        let file = if *name == "logs" && !with_plots { WITHOUT_LOGS } else { file };
        let _ = write!(text, "const {} = ", variable(name));
        text += &closed(file);
    }
    inert(&text)
}

/// The variable with the exports of a file.
fn variable(file: &str) -> String {
    format!("{file}_mjs")
}

/// Wraps a file in a function that runs once and returns its frozen exports.
fn closed(file: &str) -> String {
    let mut exports: Vec<&str> = Vec::new();
    let mut text = String::from("(() => {\n");
    let mut lines = file.lines();
    while let Some(line) = lines.next() {
        if line.starts_with("import ") {
            let mut import = line.to_owned();
            while !import.ends_with(';') {
                import += lines.next().expect("an import ends with a semicolon");
            }
            let (names, from) =
                import.trim_start_matches("import ").split_once(" from \"./").expect("import { .. } from \"./..\"");
            let from = from.strip_suffix(".mjs\";").expect("imports are of files of this folder");
            let _ = writeln!(text, "const {names} = {};", variable(from));
        } else if let Some(rest) = line.strip_prefix("export ") {
            let rest = rest.trim();
            let mut words = rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !["", "async"].contains(word));
            let kind = words.next().expect("an export says what it is");
            assert!(["function", "class", "const"].contains(&kind), "an export of another form: {line}");
            exports.push(words.next().expect("an export has a name"));
            text += rest;
            text.push('\n');
        } else {
            text += line;
            text.push('\n');
        }
    }
    let _ = write!(text, "return Object.freeze({{ {} }});\n}})();\n", exports.join(", "));
    text
}

/// The same script without sequences that HTML reads as an end tag or a comment; they occur only in strings and comments.
fn inert(script: &str) -> String {
    let mut text = String::with_capacity(script.len());
    let mut rest = script;
    while let Some(at) = rest.find('<') {
        text.push_str(&rest[..=at]);
        rest = &rest[at + 1..];
        let starts = |with: &str| rest.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
        if starts("!--") || starts("/script") || starts("script") {
            text.push('\\');
        }
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_import_what_earlier_ones_export() {
        let mut known: Vec<(String, Vec<String>)> = Vec::new();
        for (name, file) in FILES {
            let text = closed(file);
            assert!(!text.contains("\nimport ") && !text.contains("\nexport "), "{name}");
            for line in text.lines().filter(|line| line.ends_with("_mjs;")) {
                let (names, from) = line.trim_start_matches("const {").split_once("} = ").expect("an import");
                let from = from.trim_end_matches("_mjs;");
                let (_, exports) = known.iter().find(|(file, _)| file == from).unwrap_or_else(|| panic!("{name} before {from}"));
                for import in names.split(',').map(str::trim).filter(|import| !import.is_empty()) {
                    assert!(exports.iter().any(|export| export == import), "{name}: {from} has no {import}");
                }
            }
            let (_, returned) = text.rsplit_once("return Object.freeze({ ").expect("exports");
            let exports = returned.split_once(" }").expect("exports").0.split(", ").map(str::to_owned).collect();
            known.push(((*name).to_owned(), exports));
        }
    }

    #[test]
    fn lines_of_comments_alone_and_indentation_are_left_out() {
        let file = "/** Of a file.\n *\n * More. */\nconst a = 1; // one\n    // two\n    /** three */\n    /** @type {X} */ (a).b();\n/**\n * four\n */\nc();\n";
        assert_eq!(brief(file), "const a = 1; // one\n/** @type {X} */ (a).b();\nc();\n");
        for (name, file) in FILES {
            let broken = file.lines().find(|line| line.matches('`').count() % 2 == 1);
            assert_eq!(broken, None, "{name}: a text goes on over lines, whose indentation is left out");
        }
    }

    #[test]
    fn a_script_holds_no_end_of_script() {
        assert_eq!(inert("// <!-- </SCRIPT <script a < b"), "// <\\!-- <\\/SCRIPT <\\script a < b");
    }

    #[test]
    #[should_panic(expected = "an export of another form")]
    fn other_exports_are_refused() {
        closed("export default 1;\n");
    }
}
