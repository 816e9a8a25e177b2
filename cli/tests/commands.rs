//! The program as its users run it: exit codes, streams, the forms of output.

#[path = "commands/check.rs"]
mod check;
#[path = "commands/companions.rs"]
mod companions;
#[path = "commands/identify.rs"]
mod identify;
#[path = "commands/import.rs"]
mod import;
#[path = "commands/show.rs"]
mod show;
#[path = "commands/time.rs"]
mod time;
#[path = "commands/verify.rs"]
mod verify;
#[path = "commands/written.rs"]
mod written;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A file of the repository.
fn file(path: &str) -> String {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the repository exists");
    root.join(path).to_str().expect("a UTF-8 path").to_string()
}

/// An empty folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

fn armgen(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armgen"))
        .args(arguments)
        .env_remove("COLUMNS")
        .stdin(Stdio::null())
        .output()
        .expect("the program runs")
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("the output is UTF-8")
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("the messages are UTF-8")
}

#[track_caller]
fn check(arguments: &[&str], code: i32) -> Output {
    let output = armgen(arguments);
    assert_eq!(output.status.code(), Some(code), "armgen {arguments:?}\n{}", err(&output));
    output
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_slice(&check(arguments, 0).stdout).expect("the output is JSON")
}

#[cfg(not(feature = "run"))]
#[test]
fn a_robot_moves_in_the_lab() {
    let output = check(&["run", "experiments/adaptive_a.yaml", "--out", "out"], 2);
    for command in ["`cargo run --release -- run`", "`cargo install --path cli --features run`"] {
        assert!(err(&output).contains(command), "{}", err(&output));
    }
}

#[test]
fn no_colour_where_nobody_sees_it() {
    for arguments in
        [vec!["--help"], vec!["check", &file("robots/scara.yaml")], vec!["check", &file("tests/bad/many-faults.yaml")]]
    {
        let output = armgen(&arguments);
        assert!(!out(&output).contains('\u{1b}') && !err(&output).contains('\u{1b}'), "armgen {arguments:?}");
    }
}

#[test]
fn a_closed_pipe_is_no_fault() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_armgen"))
        .args(["show", &file("robots/ur5.yaml")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert_eq!(err(&output), "");
}

#[test]
fn completions_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert!(out(&check(&["completions", shell], 0)).contains("symbolic"));
    }
}

#[test]
fn the_manual_has_a_page_for_every_command() {
    let folder = folder("manual");
    check(&["manual", "--out", folder.to_str().expect("UTF-8")], 0);
    let help = out(&check(&["--help"], 0));
    let (_, commands) = help.split_once("Commands:\n").expect("a list of commands");
    let commands: Vec<&str> = commands.lines().map_while(|line| line.split_whitespace().next()).collect();
    assert!(commands.contains(&"check") && commands.len() > 10, "{commands:?}");
    let page = |name: &str| fs::read_to_string(folder.join(name)).expect(name);
    for command in commands.iter().filter(|command| **command != "help") {
        let text = page(&format!("armgen-{command}.1"));
        assert!(text.contains("Examples:") && text.contains(".SH OPTIONS"), "{command}: {text}");
        assert!(page("armgen.1").contains(&format!("armgen\\-{command}(1)")), "armgen.1 does not name {command}");
    }
    assert_eq!(
        fs::read_dir(&folder).expect("a folder").count(),
        commands.len(),
        "a page for each command but `help`, and its own"
    );
}

#[test]
fn help_has_examples() {
    for command in [
        "",
        "check",
        "show",
        "generate",
        "import",
        "convert",
        "export",
        "verify",
        "time",
        "count",
        "page",
        "schema",
        "completions",
        "manual",
    ] {
        let arguments: Vec<&str> = [command, "--help"].into_iter().filter(|a| !a.is_empty()).collect();
        let text = out(&check(&arguments, 0));
        assert!(text.contains("Examples:\n"), "armgen {arguments:?}");
        let name = format!("commands__help {command}").trim().replace(' ', "_");
        insta::with_settings!({ prepend_module_to_snapshot => false }, {
            insta::assert_snapshot!(name.as_str(), text);
        });
    }
}

/// The first commands of docs/import.md, on an arm of the tests.
#[test]
fn a_urdf_becomes_a_description_that_is_valid_and_verified() {
    let folder = folder("import");
    let path = |name: &str| folder.join(name).to_str().expect("a UTF-8 path").to_string();
    let urdf = file("import/tests/urdf/everything.urdf");
    let (yaml, report, module) = (path("robot.yaml"), path("report.json"), path("robot.rs"));
    let chain = ["import", &urdf, "--base", "base", "--tip", "tip"];
    let output = check(&[&chain[..], &["--lock", "finger=0.04", "--out", &yaml, "--report", &report]].concat(), 0);
    assert!(err(&output).contains("moves by at most"), "{}", err(&output));
    let report: Value = serde_json::from_str(&fs::read_to_string(&report).expect("a report")).expect("the report is JSON");
    assert_eq!(report["joints"].as_array().map(Vec::len), Some(3));
    check(&["check", &yaml], 0);
    check(&["generate", &yaml, "--out", &module, "--verify"], 0);
    // And back to a URDF, which is the same arm.
    let (back, again) = (path("back.urdf"), path("again.yaml"));
    check(&["export", &yaml, "--format", "urdf", "--out", &back], 0);
    check(&["import", &back, "--tip", "tool", "--out", &again], 0);
    check(&["export", &yaml, "--format", "urdf", "--out", &yaml], 2);
    // And in rows of Denavit and Hartenberg.
    check(&["convert", &yaml, "--convention", "modified", "--out", &again], 0);
    check(&["check", &again], 0);
    // Without --tip two fingers and the tip may be meant.
    let refused = check(&["import", &urdf, "--base", "base"], 1);
    assert!(err(&refused).contains("error[several-tips]"), "{}", err(&refused));
    check(&[&chain[..], &["--lock", "finger=0.04", "--convention", "standard", "--out", &again]].concat(), 0);
    check(&["check", &again], 0);
    check(&["import", &urdf, "--lock", "finger"], 2);
    check(&["import", &urdf, "--snap", "1"], 2);
}
