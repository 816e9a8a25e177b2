//! The pages of five minutes and the tutorial of identification: their files are written, their commands run in order, and print the text below them.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::installed;
use crate::languages::folder;

/// Blocks of a page: the name of the file in the line before, if there is such a line, the language, and the text.
fn blocks(page: &str) -> Vec<(Option<String>, String, String)> {
    let mut blocks = Vec::new();
    let (mut before, mut open) = (None, None::<(Option<String>, String, String)>);
    for line in page.lines() {
        match (open.as_mut(), line.strip_prefix("```")) {
            (None, Some(language)) => open = Some((before.take(), language.to_owned(), String::new())),
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some((_, _, text)), None) => *text += &format!("{line}\n"),
            (None, None) if line.is_empty() => {}
            (None, None) => before = line.strip_prefix('`').and_then(|rest| rest.strip_suffix("`:")).map(str::to_owned),
        }
    }
    blocks
}

/// Runs a page of docs in a folder that has the robots of the repository.
#[track_caller]
fn follow(name: &str, tools: &[(&str, &str)]) {
    if !tools.iter().all(|(tool, package)| installed::there(tool, package)) {
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the repository");
    let folder = folder(&name.replace('/', "_"));
    fs::create_dir(folder.join("robots")).expect("a folder");
    for robot in ["ur5", "scara"] {
        let robot = format!("robots/{robot}.yaml");
        fs::copy(root.join(&robot), folder.join(&robot)).expect("a description");
    }
    let programs = Path::new(env!("CARGO_BIN_EXE_armgen")).parent().expect("a folder");
    let path = std::env::join_paths(
        std::iter::once(programs.to_path_buf()).chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
    );
    let path = path.expect("a path");
    let page = fs::read_to_string(root.join(format!("docs/{name}.md"))).expect("the page");
    let (mut printed, mut compared) = (String::new(), 0);
    for (file, language, text) in blocks(&page) {
        match (file, language.as_str()) {
            // The folder of tests is within this workspace.
            (Some(file), "toml") => {
                let text = text.replace("../armgen/", &format!("{}/", root.display()));
                fs::write(folder.join(file), text + "\n[workspace]\n").expect("a file");
            }
            (Some(file), _) => fs::write(folder.join(file), text).expect("a file"),
            (None, "sh") => {
                let output =
                    Command::new("sh").args(["-ec", &text]).current_dir(&folder).env("PATH", &path).output().expect("a shell");
                let said = String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success(), "docs/{name}.md:\n{text}\n{said}");
                printed = String::from_utf8_lossy(&output.stdout).into_owned();
            }
            (None, "text") => {
                assert_eq!(printed, text, "docs/{name}.md");
                compared += 1;
            }
            (None, language) => panic!("docs/{name}.md: a block of {language} without the name of a file before it"),
        }
    }
    assert!(compared > 0, "docs/{name}.md has no output to compare");
}

#[test]
#[ignore = "wide"]
fn five_minutes_in_c() {
    follow("start/c", &[("cc", "gcc")]);
}

#[test]
#[ignore = "wide"]
fn five_minutes_in_rust() {
    follow("start/rust", &[]);
}

#[test]
#[ignore = "wide"]
fn five_minutes_in_a_browser() {
    follow("start/browser", &[("node", "nodejs")]);
}

#[test]
#[ignore = "wide"]
fn five_minutes_in_octave() {
    follow("start/matlab", &[("octave-cli", "octave")]);
}

#[test]
#[ignore = "wide"]
fn from_a_urdf_to_hand_guiding() {
    follow("hand-guiding", &[("cc", "gcc")]);
}

#[test]
#[ignore = "wide"]
fn from_a_moving_arm_to_a_certified_model() {
    follow("identification-tutorial", &[]);
}
