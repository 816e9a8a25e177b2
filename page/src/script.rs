//! The script of a page: ES modules, a file per concept, joined into a single text.
//!
//! Each file becomes a function that runs once and returns the file's exports. An import reads the result of an earlier function.
//! So there is no build step, and tests run the unmodified files. Imports and exports have a single form each:
//!
//! ```text
//! import { name, name } from "./file.mjs";
//! export function name    export async function name    export class name    export const name
//! ```

use std::fmt::Write;

/// The files, each after the files it imports.
const FILES: &[(&str, &str)] = &[
    ("vector", include_str!("../web/vector.mjs")),
    ("format", include_str!("../web/format.mjs")),
    ("dom", include_str!("../web/dom.mjs")),
    ("formula", include_str!("../web/formula.mjs")),
    ("mathml", include_str!("../web/mathml.mjs")),
    ("unpack", include_str!("../web/unpack.mjs")),
    ("linear", include_str!("../web/linear.mjs")),
    ("noise", include_str!("../web/noise.mjs")),
    ("equations", include_str!("../web/equations.mjs")),
    ("kinematics", include_str!("../web/kinematics.mjs")),
    ("view", include_str!("../web/view.mjs")),
    ("labels", include_str!("../web/labels.mjs")),
    ("solids", include_str!("../web/solids.mjs")),
    ("bodies", include_str!("../web/bodies.mjs")),
    ("scene", include_str!("../web/scene.mjs")),
    ("dimension", include_str!("../web/dimension.mjs")),
    ("state", include_str!("../web/state.mjs")),
    ("sliders", include_str!("../web/sliders.mjs")),
    ("sticky_picture", include_str!("../web/sticky_picture.mjs")),
    ("picture", include_str!("../web/picture.mjs")),
    ("free_fall", include_str!("../web/free_fall.mjs")),
    ("sheet", include_str!("../web/sheet.mjs")),
    ("dependent_axes", include_str!("../web/dependent_axes.mjs")),
    ("lost_motion", include_str!("../web/lost_motion.mjs")),
    ("search", include_str!("../web/search.mjs")),
    ("singular", include_str!("../web/singular.mjs")),
    ("numbers", include_str!("../web/numbers.mjs")),
    ("suspects", include_str!("../web/suspects.mjs")),
    ("check", include_str!("../web/check.mjs")),
    ("reach", include_str!("../web/reach.mjs")),
    ("workspace", include_str!("../web/workspace.mjs")),
    ("postures", include_str!("../web/postures.mjs")),
    ("logs", include_str!("../web/logs.mjs")),
    ("cost", include_str!("../web/cost.mjs")),
    ("settings", include_str!("../web/settings.mjs")),
    ("main", include_str!("../web/main.mjs")),
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
        text += &closed(&brief(file));
    }
    inert(&text)
}

/// Removes comment lines (a fifth of a file), indentation (an eighth) and empty lines, which only readers of `page/web` need.
/// Comments take half of the module that `armgen generate` writes. No string literal spans several lines, so none contains indentation.
fn brief(file: &str) -> String {
    let mut text = String::with_capacity(file.len());
    let mut within = false;
    for line in file.lines() {
        let words = line.trim();
        let begins = within || words.starts_with("/**");
        let ends = words.ends_with("*/");
        // Code may follow a comment on the same line.
        let comment = within || words.starts_with("//") || (begins && (ends || !words.contains("*/")));
        within = comment && begins && !ends;
        if !comment && !words.is_empty() {
            text.push_str(line.trim_start());
            text.push('\n');
        }
    }
    text
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
