//! Files that `armgen generate` writes next to a module: their names, their origin, and how they differ from a module.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use armgen_codegen::emit::{Language, Origin};
use armgen_codegen::source::Source;

/// A companion of a module: the texts before and after a common name in its own file name, and in that of its module.
struct Companion {
    language: Language,
    file: [&'static str; 2],
    with: [&'static str; 2],
    /// The option that requests it; empty if it is always written.
    flag: &'static str,
}

const fn of(language: Language, file: [&'static str; 2], with: [&'static str; 2], flag: &'static str) -> Companion {
    Companion { language, file, with, flag }
}

/// The longest names first, where one ends like another.
const COMPANIONS: [Companion; 22] = [
    of(Language::Rust, ["", "_ik_c.rs"], ["", "_ik.rs"], "--c-abi --ik"),
    of(Language::Rust, ["", "_ik.h"], ["", "_ik.rs"], "--c-abi --ik"),
    of(Language::Rust, ["", "_ik.rs"], ["", ".rs"], "--ik"),
    of(Language::Rust, ["", "_bounds.rs"], ["", ".rs"], "--bounds"),
    of(Language::Rust, ["", "_runtime.rs"], ["", ".rs"], "--runtime"),
    of(Language::Rust, ["", "_test.rs"], ["", ".rs"], "--tests"),
    of(Language::Rust, ["", "_laws_c.rs"], ["", ".rs"], "--c-abi --runtime"),
    of(Language::Rust, ["", "_laws.h"], ["", ".rs"], "--c-abi --runtime"),
    of(Language::Rust, ["", "_c.rs"], ["", ".rs"], "--c-abi"),
    of(Language::Rust, ["", ".h"], ["", ".rs"], "--c-abi"),
    of(Language::C, ["", "_ik_test.c"], ["", "_ik.h"], "--tests --ik"),
    of(Language::C, ["", "_test.c"], ["", ".h"], "--tests"),
    of(Language::C, ["", "_ik.h"], ["", ".h"], "--ik"),
    of(Language::Cuda, ["", "_ik.h"], ["", ".cuh"], "--ik"),
    of(Language::JavaScript, ["", ".test.mjs"], ["", ".mjs"], "--tests"),
    of(Language::JavaScript, ["", ".test.js"], ["", ".js"], "--tests"),
    of(Language::JavaScript, ["", ".d.mts"], ["", ".mjs"], ""),
    of(Language::JavaScript, ["", ".d.ts"], ["", ".js"], ""),
    of(Language::Python, ["", "_native.py"], ["", ".py"], "--native"),
    of(Language::Python, ["", "_native.c"], ["", ".py"], "--native"),
    of(Language::Python, ["test_", ".py"], ["", ".py"], "--tests"),
    of(Language::Matlab, ["", "Test.m"], ["+", ""], "--tests"),
];

/// Signs of a text that is not a module: bounds, traits, calls from C, calls of a library, declarations, tests.
const NO_MODULE: [&str; 7] = [
    "\n// Running error bounds of the functions of a robot: ",
    "impl armgen_runtime::",
    "extern \"C\" ",
    "\n\"\"\"The functions as a library of C, ",
    "\nexport declare const ",
    " Tests of the robot `",
    "at the poses of random postures the posture itself is found",
];

/// The part of a file name between two texts.
fn between<'n>(name: &'n str, [before, behind]: [&str; 2]) -> Option<&'n str> {
    name.strip_prefix(before)?.strip_suffix(behind).filter(|name| !name.is_empty())
}

fn name_of(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// The module of a companion, by the names of both, or `a module` if the names do not show it. `None` for a module, also of inverse
/// kinematics.
pub(crate) fn goes_with(file: &Path, text: &str) -> Option<String> {
    let name = name_of(file);
    let is_none = NO_MODULE.iter().any(|mark| text.contains(mark));
    let with = COMPANIONS.iter().find_map(|Companion { file: own, with: [before, behind], .. }| {
        let with = file.with_file_name(format!("{before}{}{behind}", between(name, *own)?));
        // A library of C is a module in C but for its name, and for the module beside it.
        (is_none || (own[1] == "_native.c" && with.exists())).then(|| with.display().to_string())
    });
    with.or_else(|| is_none.then(|| "a module".to_owned()))
}

/// The possible companions of a module, each with its option. Of named end effectors, whose names an earlier description gave, those that exist.
pub(crate) fn beside(module: &Path, language: Language) -> Vec<(PathBuf, &'static str)> {
    let name = name_of(module);
    // Companions of inverse kinematics are companions of the module, too.
    let stem_of = |companion: &Companion| {
        let [before, behind] = companion.with;
        between(name, [before, behind.trim_start_matches("_ik")])
    };
    let folder = module.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut there: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    there.sort();
    // `robot_left_ik.rs` of the module robot.rs, unless there is a module robot_left.rs.
    let of_tips = |companion: &Companion, stem: &str| -> Vec<String> {
        let ([before, behind], [_, extension]) = (companion.file, companion.with.map(|text| text.trim_start_matches("_ik")));
        let is_of_tip = |file: &&String| {
            let tip = between(file, [&format!("{before}{stem}_"), behind]);
            tip.is_some_and(|tip| !there.contains(&format!("{stem}_{tip}{extension}")))
        };
        there.iter().filter(is_of_tip).filter(|_| behind.starts_with("_ik")).cloned().collect()
    };
    let all = COMPANIONS.iter().filter(|companion| companion.language == language);
    all.filter_map(|companion| Some((companion, stem_of(companion)?)))
        .flat_map(|(companion, stem)| {
            let [before, behind] = companion.file;
            let own = std::iter::once(format!("{before}{stem}{behind}")).chain(of_tips(companion, stem));
            own.map(|file| (module.with_file_name(file), companion.flag)).collect::<Vec<_>>()
        })
        .collect()
}

/// The file and the hash that a text says it was made from.
pub(crate) fn made_from(text: &str) -> Option<(&str, &str)> {
    let line = text.lines().take(4).find(|line| line.contains("by armgen ") && line.contains(" (input "))?;
    let (before, behind) = line.rsplit_once(" (input ")?;
    // Behind the version, since the file's name may hold any words.
    let (_, file) = before.split_once("by armgen ")?.1.split_once(" from ")?;
    Some((file, behind.split(')').next()?))
}

/// Why a text is not what armgen writes now from a description, as its head shows it: the end of a sentence that begins with the file.
pub(crate) fn why_different(text: &str, description: &Source) -> String {
    let (own, name) = (Origin::of(description), description.name());
    let version = |made_by: &str| made_by.split(' ').next().unwrap_or_default().to_owned();
    let now = own.made_by().strip_prefix("armgen ").map(version);
    let then = text.lines().take(4).find_map(|line| line.split_once("by armgen ")).map(|(_, made_by)| version(made_by));
    match made_from(text) {
        None => "differs, and its head names no description".to_owned(),
        Some((_, input)) if input != own.hash => {
            format!("is stale: it was made from another text of {name} (input {input}, now {})", own.hash)
        }
        Some(_) if then != now => {
            format!("was made by armgen {}, and this is {}", then.unwrap_or_default(), now.unwrap_or_default())
        }
        Some(_) => {
            format!("was edited, or made with other options: its head names this text of {name} and this version of armgen")
        }
    }
}

/// Whether a file exists that armgen made for a module of a language, but from another description than that of `hash`, or without naming
/// it. A header that declares functions of a library belongs to a module in Rust. Any other header is a module in C by itself.
pub(crate) fn is_of_another(file: &Path, language: Language, hash: &str) -> bool {
    let mut head = Vec::new();
    let read = File::open(file).and_then(|file| file.take(2048).read_to_end(&mut head));
    let head = String::from_utf8_lossy(&head);
    read.is_ok()
        && match made_from(&head) {
            Some((_, input)) => input != hash,
            None => head.contains("generated by armgen ") || head.contains("Written by armgen "),
        }
        && (file.extension().is_none_or(|extension| extension != "h") || calls_rust(file) == (language == Language::Rust))
}

/// Whether a header declares functions of a library, and does not define them.
fn calls_rust(header: &Path) -> bool {
    std::fs::read_to_string(header).is_ok_and(|text| text.contains("extern \"C\" {"))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use armgen_codegen::emit::{Language, Origin};
    use armgen_codegen::source::Source;

    use super::{beside, goes_with, made_from, why_different};

    #[test]
    fn a_head_shows_why_a_file_differs() {
        let source = Source::new("a/arm.yaml", "name: arm\n");
        let made_by = Origin::of(&source).made_by();
        let version = made_by.split(' ').nth(1).expect("a version");
        let why = |made_by: &str| why_different(&format!("// @generated by {made_by}. Do not edit.\n"), &source);
        assert!(why(&made_by).starts_with("was edited, or made with other options"));
        assert!(why(&made_by.replace("(input ", "(input 0")).starts_with("is stale: it was made from another text of a/arm.yaml"));
        let older = why(&made_by.replacen(version, "0.0.1", 1));
        assert_eq!(older, format!("was made by armgen 0.0.1, and this is {version}"));
        assert!(why_different("{}", &source).contains("names no description"));
    }

    #[test]
    fn names_beside_a_module_and_back() {
        let names = |module: &str, language| -> Vec<String> {
            beside(Path::new(module), language).into_iter().map(|(path, _)| path.display().to_string()).collect()
        };
        assert_eq!(
            names("a/arm.rs", Language::Rust),
            [
                "a/arm_ik_c.rs",
                "a/arm_ik.h",
                "a/arm_ik.rs",
                "a/arm_bounds.rs",
                "a/arm_runtime.rs",
                "a/arm_test.rs",
                "a/arm_laws_c.rs",
                "a/arm_laws.h",
                "a/arm_c.rs",
                "a/arm.h"
            ]
        );
        assert_eq!(names("arm.h", Language::C), ["arm_ik_test.c", "arm_test.c", "arm_ik.h"]);
        assert_eq!(names("arm.mjs", Language::JavaScript), ["arm.test.mjs", "arm.d.mts"]);
        assert_eq!(names("arm.py", Language::Python), ["arm_native.py", "arm_native.c", "test_arm.py"]);
        assert_eq!(names("a/+arm", Language::Matlab), ["a/armTest.m"]);
        let with = |file: &str, text: &str| goes_with(Path::new(file), text);
        assert_eq!(
            with("a/arm_bounds.rs", "//\n// Running error bounds of the functions of a robot: how").as_deref(),
            Some("a/arm.rs")
        );
        assert_eq!(with("test_arm.py", "# Tests of the robot `scara`").as_deref(), Some("arm.py"));
        assert_eq!(with("arm_ik.h", "extern \"C\" {").as_deref(), Some("arm_ik.rs"));
        assert_eq!(with("arm_native.py", "\n\n\"\"\"The functions as a library of C, for").as_deref(), Some("arm.py"));
        assert_eq!(with("arm.d.mts", "\n */\nexport declare const NAME: string;").as_deref(), Some("arm.mjs"));
        assert_eq!(with("other.rs", "impl armgen_runtime::robot::Kinematics").as_deref(), Some("a module"));
        // A module may be called as a companion is.
        assert_eq!(with("arm_c.rs", "pub fn gravity("), None);
        assert_eq!(with("x_native.py", "def gravity("), None);
        assert_eq!(with("x_native.c", "static inline void arm_gravity("), None);
    }

    #[test]
    fn a_head_says_what_a_file_was_made_from() {
        let from = |text| made_from(text);
        assert_eq!(
            from("/* @generated by armgen 0.1.0 from my arm.yaml (input 12ab). Do not edit.\n"),
            Some(("my arm.yaml", "12ab"))
        );
        assert_eq!(from("// Tests\n// dynamics. Written by armgen 0.1.0 from a.yaml (input 3c).\n"), Some(("a.yaml", "3c")));
        assert_eq!(
            from("// @generated by armgen 0.1.0 from arm from cad by armgen 2.yaml (input 3c). Do not edit.\n"),
            Some(("arm from cad by armgen 2.yaml", "3c"))
        );
        assert_eq!(from("// @generated by armgen 0.1.0. Do not edit.\n"), None);
    }
}
