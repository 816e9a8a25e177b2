//! Allowed dependencies between modules. ARCHITECTURE.md describes the layers of every crate; this test lists them and compares
//! them with the sources.
//!
//! A file is a module. Every path in it that leads to another module of its crate is an arrow, imports that are handed on (`use`) being
//! followed to where the name is declared. Two rules hold:
//!
//! - between the top modules of a crate there are the arrows of [`LAYERS`] and no others;
//! - at every level, sibling modules form an order: no two of them depend on each other, directly or through others. Seen from
//!   outside, a module and the files of its folder are one module.
//!
//! Tests (`#[cfg(test)]`) may name whatever they like.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use syn::visit::Visit;

/// A module by its path from the root of the crate; the root itself is empty.
type Module = Vec<String>;

/// Allowed dependencies of the modules of a crate, lowest first: a module may only name modules listed above it.
type Layers = &'static [(&'static str, &'static [&'static str])];

/// Exact numbers, expressions, their rewriting; no robot.
const ALGEBRA: Layers =
    &[("scramble", &[]), ("exact", &["scramble"]), ("ring", &["exact", "scramble"]), ("optimise", &["ring", "scramble"])];

/// From the text of a description to an arm; no equations.
const DESCRIPTION: Layers = &[
    ("kinds", &[]),
    ("parallel", &[]),
    ("source", &[]),
    ("suggest", &[]),
    ("language", &["kinds"]),
    ("origin", &["source"]),
    ("diagnostic", &["source"]),
    ("document", &["diagnostic", "source", "suggest"]),
    ("description", &["diagnostic", "document", "kinds", "source"]),
    ("manipulator", &["kinds"]),
    ("validate", &["description", "diagnostic", "document", "kinds", "manipulator", "source", "suggest"]),
];

/// From an arm to the text of a module; see the table of stages in ARCHITECTURE.md. The first lines are the modules of the description.
const CODEGEN: Layers = &[
    ("diagnostic", &[]),
    ("kinds", &[]),
    ("manipulator", &[]),
    ("parallel", &[]),
    ("source", &[]),
    ("suggest", &[]),
    ("pass", &[]),
    ("derive", &["kinds", "manipulator", "pass"]),
    ("equations", &["derive", "diagnostic", "kinds", "manipulator", "source"]),
    ("inverse_kinematics", &["derive", "kinds", "manipulator"]),
    ("catalogue", &["derive", "manipulator"]),
    ("program", &["catalogue", "kinds", "parallel"]),
    ("schedule", &["catalogue", "derive", "kinds", "manipulator", "parallel", "pass", "program", "suggest"]),
    ("emit", &["catalogue", "inverse_kinematics", "kinds", "manipulator", "parallel", "program"]),
    ("show", &["catalogue", "derive", "manipulator", "parallel"]),
    ("build_script", &["catalogue", "diagnostic", "kinds", "pass", "program", "schedule", "source"]),
];

const RUNTIME: Layers = &[
    ("linalg", &[]),
    ("message", &[]),
    ("settings", &[]),
    ("robot", &[]),
    ("scalar", &["linalg"]),
    ("orientation", &["linalg", "scalar"]),
    ("reference", &["linalg", "robot"]),
    ("inverse_kinematics", &["linalg", "reference", "robot"]),
    ("task", &["orientation", "reference"]),
    ("manipulability", &["linalg", "robot", "task"]),
    ("trajectory", &["linalg", "orientation", "reference", "scalar"]),
    ("clik", &["linalg", "manipulability", "settings", "reference", "robot", "task"]),
    ("timing", &["linalg", "reference", "robot", "scalar", "settings", "trajectory"]),
    ("control", &["clik", "linalg", "orientation", "settings", "reference", "robot", "task"]),
    ("contact", &["control", "linalg", "reference", "robot", "settings"]),
    ("payload", &["control", "linalg", "reference", "robot", "settings"]),
    ("simulation", &["linalg", "reference", "robot"]),
    ("stability", &["control", "linalg", "reference", "robot", "simulation"]),
];

/// From a model of another format to a description, and back: numbers as they are written, then poses and bodies, then trees and arms.
const IMPORT: Layers = &[
    ("code", &[]),
    ("options", &[]),
    ("xml", &[]),
    ("xacro", &["xml"]),
    ("include", &["xml"]),
    ("number", &["xml"]),
    ("written", &["number"]),
    ("pose", &["written"]),
    ("snap", &["number", "pose", "written"]),
    ("values", &["number", "pose", "snap", "written", "xml"]),
    ("body", &["number", "pose", "values", "written"]),
    ("tree", &["xml"]),
    ("unread", &["xml"]),
    ("format", &["body", "number", "pose", "tree", "values", "written"]),
    ("urdf", &["body", "format", "number", "pose", "tree", "unread", "values", "written", "xacro", "xml"]),
    ("mjcf", &["body", "format", "number", "pose", "tree", "unread", "values", "written", "xml"]),
    ("chain", &["body", "format", "number", "pose", "snap", "tree", "values", "xml"]),
    ("bound", &["body", "chain", "pose", "written"]),
    ("report", &["body", "bound", "chain", "format", "snap"]),
    ("yaml", &["body", "chain", "pose", "report", "written"]),
    ("convert", &["number", "yaml"]),
    ("export", &["number", "pose", "written"]),
    ("build_script", &[]),
];

/// What reads, what judges and what draws know of each other only what an experiment is.
const EXPERIMENTS: Layers = &[
    ("model", &[]),
    ("read", &["model"]),
    ("run", &["model"]),
    ("judge", &["model"]),
    ("draw", &["model"]),
    ("campaign", &["draw", "judge", "model", "run"]),
];

/// Rows and bodies are numbers, documents are text; the script knows neither.
const PAGE: Layers = &[
    ("html", &[]),
    ("brief", &[]),
    ("script", &["brief"]),
    ("rows", &[]),
    ("bodies", &["rows"]),
    ("cost", &["html"]),
    ("drives", &["html"]),
    ("words", &[]),
    ("equations", &["html", "words"]),
    ("logs", &["html", "rows"]),
    ("warnings", &["html"]),
    ("sheet", &["html", "rows", "warnings"]),
    ("document", &["bodies", "html", "rows", "sheet", "warnings"]),
];

/// A function is data; its program is executed without it.
const NUMBERS: Layers = &[
    ("scalar", &[]),
    ("function", &[]),
    ("program", &["function", "scalar"]),
    ("execute", &["function", "program", "scalar"]),
    ("arithmetic", &["function", "program", "scalar"]),
    ("postures", &["scalar"]),
];

/// Logs and signals know no arm; what estimates knows no report.
const IDENTIFY: Layers = &[
    ("finding", &[]),
    ("signal", &[]),
    ("body", &[]),
    ("fit", &["signal"]),
    ("arm", &["body"]),
    ("log", &["finding"]),
    ("baseline", &["arm", "finding"]),
    ("prepare", &["arm", "log", "signal"]),
    ("options", &["log", "prepare"]),
    ("estimate", &["arm", "fit", "options", "prepare", "signal"]),
    ("suspect", &["arm", "estimate", "finding", "fit", "log", "prepare", "signal"]),
    ("judge", &["arm", "log", "prepare", "signal"]),
    ("identify", &["arm", "body", "estimate", "finding", "fit", "judge", "log", "options", "prepare", "signal", "suspect"]),
    ("excite", &["arm", "prepare"]),
    ("consistent", &["arm", "body", "fit", "identify"]),
    ("written", &["arm", "baseline", "body", "consistent", "identify", "prepare"]),
    ("exact", &[]),
    ("certificate", &["arm", "consistent", "exact", "identify", "prepare", "written"]),
    ("report", &["arm", "body", "finding", "identify", "judge", "written"]),
    ("page", &["arm", "finding", "identify", "judge", "signal", "written"]),
];

const COMMANDS: Layers =
    &[("input", &[]), ("companions", &[]), ("file_names", &[]), ("commands", &["companions", "file_names", "input"])];

/// What the program writes about an arm.
const TEXTS: Layers = &[("json", &[]), ("module", &[]), ("rows", &[]), ("shown", &[]), ("summary", &["rows"])];

/// From a text and a description to a verdict; `docs/certificate.md` explains each step.
const VERIFY: Layers = &[
    ("values", &[]),
    ("textbook", &["values"]),
    ("read", &["textbook", "values"]),
    ("floats", &["read", "textbook", "values"]),
    ("certificate", &["floats", "read", "values"]),
    ("judge", &["certificate", "floats", "read", "textbook", "values"]),
    ("inverse_kinematics", &["judge", "read", "textbook", "values"]),
    ("test_kit", &["judge", "read", "textbook", "values"]),
    ("timing", &["textbook", "values"]),
];

/// Contents of a file: modules that it declares, names that it brings into scope, paths that it uses.
#[derive(Default)]
struct File {
    children: BTreeSet<String>,
    /// Name in this module, and the path that it denotes, as written.
    imports: BTreeMap<String, Vec<String>>,
    paths: Vec<Vec<String>>,
    /// How deep in modules within the file the visitor is.
    inline: usize,
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

impl File {
    fn tree(&mut self, tree: &syn::UseTree, prefix: &[String]) {
        let with = |name: &syn::Ident| [prefix, &[name.to_string()]].concat();
        match tree {
            syn::UseTree::Path(path) => self.tree(&path.tree, &with(&path.ident)),
            syn::UseTree::Name(name) if name.ident == "self" => {
                self.imports.insert(prefix.last().cloned().unwrap_or_default(), prefix.to_vec());
            }
            syn::UseTree::Name(name) => {
                self.imports.insert(name.ident.to_string(), with(&name.ident));
            }
            syn::UseTree::Rename(rename) => {
                self.imports.insert(rename.rename.to_string(), with(&rename.ident));
            }
            syn::UseTree::Glob(_) => self.paths.push(prefix.to_vec()),
            syn::UseTree::Group(group) => group.items.iter().for_each(|item| self.tree(item, prefix)),
        }
    }
}

impl<'ast> Visit<'ast> for File {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if is_test(&item.attrs) {
            return;
        }
        if item.content.is_none() {
            self.children.insert(item.ident.to_string());
        } else {
            self.inline += 1;
            syn::visit::visit_item_mod(self, item);
            self.inline -= 1;
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        assert_eq!(self.inline, 0, "an import in a module within a file: the arrows of its imports are not followed");
        if !is_test(&item.attrs) {
            self.tree(&item.tree, &[]);
        }
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_test(&item.attrs) {
            syn::visit::visit_item_fn(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        if !is_test(&item.attrs) {
            syn::visit::visit_item_impl(self, item);
        }
    }

    /// The arguments of a macro are tokens; finds paths from the root of the crate among them.
    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        let text = item.tokens.to_string().replace(' ', "");
        for (start, _) in text.match_indices("crate::") {
            let path = text[start..].split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).next().unwrap_or_default();
            self.paths.push(path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect());
        }
        syn::visit::visit_macro(self, item);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.paths.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        syn::visit::visit_path(self, path);
    }
}

/// The modules of a crate and the arrows between them.
struct Crate {
    files: BTreeMap<Module, File>,
}

impl Crate {
    fn read(source: &Path) -> Self {
        let mut files = BTreeMap::new();
        let root = ["lib.rs", "main.rs"].map(|name| source.join(name)).into_iter().find(|path| path.exists());
        let mut open = vec![(Module::new(), root.expect("a crate"), source.to_path_buf())];
        while let Some((module, path, folder)) = open.pop() {
            let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let mut file = File::default();
            file.visit_file(&syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display())));
            for child in &file.children {
                let name = child.trim_start_matches("r#").to_owned();
                let next = [module.as_slice(), std::slice::from_ref(child)].concat();
                open.push((next, folder.join(format!("{name}.rs")), folder.join(name)));
            }
            files.insert(module, file);
        }
        Self { files }
    }

    /// The module that declares the item of a path; `None` for items of other crates.
    fn target(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let (mut at, rest) = match path.first()?.as_str() {
            "crate" => (Module::new(), &path[1..]),
            "self" => (from.clone(), &path[1..]),
            "super" => (from[..from.len().checked_sub(1)?].to_vec(), &path[1..]),
            name if self.files[from].children.contains(name) => (from.clone(), path),
            name if depth > 0 || path.len() > 1 || self.files[from].imports.contains_key(name) => {
                let import = self.files[from].imports.get(name)?;
                if import[0] == *name {
                    return None; // a crate, or a child found above
                }
                let whole: Vec<String> = import.iter().chain(&path[1..]).cloned().collect();
                return (depth < 8).then(|| self.target(from, &whole, depth + 1)).flatten();
            }
            _ => return None,
        };
        let mut rest = rest;
        while let [name, tail @ ..] = rest {
            if name == "super" {
                at.pop();
            } else if self.files[&at].children.contains(name) {
                at.push(name.clone());
            } else {
                let handed_on = self.files[&at].imports.get(name).filter(|import| import.last() != Some(&String::from("self")));
                return match handed_on {
                    Some(import) if depth < 8 => {
                        let whole: Vec<String> = import.iter().chain(tail).cloned().collect();
                        self.target(&at, &whole, depth + 1).or(Some(at))
                    }
                    _ => Some(at),
                };
            }
            rest = tail;
        }
        Some(at)
    }

    /// Whether a name at the root is a module of the description that the crate hands on.
    fn is_handed_on(&self, name: &str) -> bool {
        let is_of =
            |import: &Vec<String>| matches!(import.as_slice(), [from, module] if from == "armgen_description" && module == name);
        self.files[&Module::new()].imports.get(name).is_some_and(is_of)
    }

    /// The arrows to the modules that are named, by their own paths; what these hand on is theirs.
    fn named_arrows(&self) -> BTreeSet<(Module, Module)> {
        let mut arrows = BTreeSet::new();
        for (module, file) in &self.files {
            for path in file.paths.iter().chain(file.imports.values()) {
                let mut at = match path[0].as_str() {
                    "crate" => Module::new(),
                    "super" => module[..module.len() - 1].to_vec(),
                    _ => continue,
                };
                for name in &path[1..] {
                    if name == "super" {
                        at.pop();
                    } else if self.files[&at].children.contains(name) {
                        at.push(name.clone());
                    } else {
                        if at.is_empty() && self.is_handed_on(name) {
                            at.push(name.clone());
                        }
                        break;
                    }
                }
                arrows.insert((module.clone(), at));
            }
        }
        arrows
    }

    /// All arrows between files, to where the names are declared.
    fn arrows(&self) -> BTreeSet<(Module, Module)> {
        let mut arrows = BTreeSet::new();
        for (module, file) in &self.files {
            for path in file.paths.iter().chain(file.imports.values()) {
                if let Some(target) = self.target(module, path, 0) {
                    arrows.insert((module.clone(), target));
                }
            }
        }
        arrows
    }
}

/// The arrows between the modules directly within `parent`.
fn between_children(arrows: &BTreeSet<(Module, Module)>, parent: &[String]) -> BTreeSet<(String, String)> {
    let child = |module: &Module| module.strip_prefix(parent).and_then(|rest| rest.first()).cloned();
    let pairs = arrows.iter().filter_map(|(from, to)| Some((child(from)?, child(to)?)));
    pairs.filter(|(from, to)| from != to).collect()
}

/// A circle among arrows, as a chain of names whose last leads back to the first.
fn circle(arrows: &BTreeSet<(String, String)>) -> Option<Vec<String>> {
    let mut left: BTreeSet<(String, String)> = arrows.clone();
    loop {
        // Whoever names nobody is in no circle.
        let naming: BTreeSet<String> = left.iter().map(|(from, _)| from.clone()).collect();
        let kept: BTreeSet<_> = left.iter().filter(|(_, to)| naming.contains(to)).cloned().collect();
        if kept.len() == left.len() {
            break;
        }
        left = kept;
    }
    let mut chain = vec![left.first()?.0.clone()];
    loop {
        let next = &left.iter().find(|(from, _)| from == chain.last().expect("begun"))?.1;
        if let Some(first) = chain.iter().position(|name| name == next) {
            return Some(chain.split_off(first));
        }
        chain.push(next.clone());
    }
}

/// Faults of the dependencies of a crate: forbidden ones, allowed but unused ones, and cycles.
fn faults(read: &Crate, layers: Option<Layers>) -> Vec<String> {
    let mut faults = Vec::new();
    if let Some(layers) = layers {
        for (i, (module, may)) in layers.iter().enumerate() {
            let above = |name: &&str| layers[..i].iter().any(|(upper, _)| upper == name);
            faults.extend(
                may.iter()
                    .filter(|name| !above(name))
                    .map(|name| format!("the layer of `{name}` is not above that of `{module}`")),
            );
        }
        let allowed = |from: &str| layers.iter().find(|(module, _)| *module == from).map(|(_, may)| *may);
        let named = read.named_arrows();
        let there = between_children(&named, &[]);
        for (from, to) in &there {
            if !allowed(from).is_some_and(|may| may.contains(&to.as_str())) {
                let files = named.iter().filter(|(a, b)| a.first() == Some(from) && b.first() == Some(to));
                let files: Vec<String> = files.map(|(a, _)| a.join("/")).collect();
                faults.push(format!("`{from}` may not name `{to}`, and does in {}", files.join(", ")));
            }
        }
        for (from, may) in layers {
            let idle = may.iter().filter(|to| !there.contains(&((*from).to_owned(), (**to).to_owned())));
            faults.extend(idle.map(|to| format!("`{from}` may name `{to}` and does not")));
        }
    }
    let arrows = read.arrows();
    for parent in read.files.keys() {
        if let Some(circle) = circle(&between_children(&arrows, parent)) {
            faults.push(format!("in `{}`: {} and back", parent.join("/"), circle.join(" -> ")));
        }
    }
    faults
}

fn read(name: &str) -> Crate {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("in the workspace");
    Crate::read(&root.join(name).join("src"))
}

const CRATES: [(&str, Layers); 12] = [
    ("algebra", ALGEBRA),
    ("description", DESCRIPTION),
    ("codegen", CODEGEN),
    ("runtime", RUNTIME),
    ("experiments", EXPERIMENTS),
    ("identify", IDENTIFY),
    ("import", IMPORT),
    ("page", PAGE),
    ("cli", COMMANDS),
    ("texts", TEXTS),
    ("verify", VERIFY),
    ("numbers", NUMBERS),
];

/// Crates whose modules have no layers: crates of one file, the judges, and the building blocks of inverse kinematics, which are
/// many files of one module. `inverse-kinematics/tests/texts.rs` checks the declared needs of these blocks.
const OTHERS: [&str; 11] = [
    "certify",
    "cli/run",
    "cli/terminal",
    "elementary",
    "evaluate",
    "generated",
    "inverse-kinematics",
    "lab",
    "tests",
    "tests/calls",
    "tests/experiments",
];

#[test]
fn modules_name_those_of_lower_layers_alone() {
    for (name, layers) in CRATES {
        assert_eq!(faults(&read(name), Some(layers)), Vec::<String>::new(), "{name}");
    }
    for name in OTHERS {
        assert_eq!(faults(&read(name), None), Vec::<String>::new(), "{name}");
    }
}

/// The dependencies of a crate and its build script, itself included.
fn tree(package: &str) -> String {
    let cargo = std::process::Command::new(env!("CARGO"))
        .args(["tree", "--offline", "--package", package, "--edges", "normal,build", "--prefix", "none"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(cargo.status.success(), "{}", String::from_utf8_lossy(&cargo.stderr));
    String::from_utf8(cargo.stdout).expect("names of crates")
}

/// The checker shares no code with the generator but the description and the numbers under both.
#[test]
fn the_checker_does_not_depend_on_the_generator() {
    assert!(!tree("armgen-verify").contains("armgen-codegen"));
    assert!(!tree("armgen-description").contains("armgen-codegen"));
    assert!(tree("armgen-certify").contains("armgen-codegen"), "who has both");
}

/// What executes programs knows neither who makes them nor who checks them.
#[test]
fn what_executes_programs_depends_on_no_robot() {
    for above in ["armgen-codegen", "armgen-verify", "armgen-description"] {
        assert!(!tree("armgen-numbers").contains(above), "armgen-numbers depends on {above}");
    }
    assert!(tree("armgen-evaluate").contains("armgen-codegen"), "who has both");
}

/// The program builds while robot.yaml is faulty: nothing that it is made of holds the robot of robot.yaml.
#[test]
fn the_program_has_no_robot_inside() {
    let of_a_robot = ["armgen-generated", "armgen-lab"];
    for name in of_a_robot {
        assert!(!tree("armgen").contains(name), "armgen depends on {name}");
        assert!(tree("armgen-lab").contains(name), "the lab depends on {name}");
    }
}

#[test]
fn every_crate_of_the_workspace_is_looked_at() {
    let workspace = include_str!("../../Cargo.toml");
    let members = workspace.split("members = [").nth(1).and_then(|rest| rest.split(']').next()).expect("a list");
    let members: BTreeSet<&str> = members.split(", ").map(|name| name.trim_matches('"')).collect();
    let looked_at = CRATES.iter().map(|(name, _)| *name).chain(OTHERS);
    assert_eq!(members, looked_at.collect());
}

/// The printers know no mathematics, and no derivation knows a language: these dependencies are forbidden, whatever the table allows.
#[test]
fn what_is_absent_by_design_is_absent() {
    let may = |from: &str, to: &str| CODEGEN.iter().any(|(module, may)| *module == from && may.contains(&to));
    for (from, to) in [("program", "manipulator"), ("emit", "derive"), ("derive", "emit"), ("derive", "diagnostic")] {
        assert!(!may(from, to), "{from} -> {to}");
    }
}

#[test]
fn a_forbidden_arrow_and_a_circle_are_seen() {
    let crate_of = |files: &[(&str, &str)]| Crate {
        files: files
            .iter()
            .map(|(module, text)| {
                let mut file = File::default();
                file.visit_file(&syn::parse_file(text).expect("Rust"));
                (module.split('/').filter(|name| !name.is_empty()).map(str::to_owned).collect(), file)
            })
            .collect(),
    };
    const LAYERS: Layers = &[("a", &[]), ("b", &["a"])];
    let root = ("", "mod a; mod b;");
    let of = |a: &str, b: &str| faults(&crate_of(&[root, ("a", a), ("b", b)]), Some(LAYERS));
    assert_eq!(of("pub struct A;", "use crate::a::A;"), Vec::<String>::new());
    assert_eq!(of("pub fn f() { crate::b::g() }", "use super::a;")[0], "`a` may not name `b`, and does in a");
    assert_eq!(of("fn f() { println!(\"{}\", crate::b::X) }", "use crate::a;").len(), 2, "within a macro");
    assert_eq!(of("#[cfg(test)] mod tests { use crate::b::B; }", "use crate::a::A;"), Vec::<String>::new());
    assert_eq!(of("", "")[0], "`b` may name `a` and does not");
    // A name that the parent hands on leads to where it is declared.
    let files = [
        ("", "mod p;"),
        ("p", "mod x; mod y; pub use x::X;"),
        ("p/x", "use super::y::Y; pub struct X;"),
        ("p/y", "use crate::p::X;"),
    ];
    assert_eq!(faults(&crate_of(&files), None), ["in `p`: x -> y and back"]);
}
