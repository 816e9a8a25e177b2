//! `armgen run` as its users run it: the table, the files, the exit codes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn run(folder: &Path, file: &Path) -> Output {
    run_all(folder, &[file])
}

fn run_all(folder: &Path, files: &[&Path]) -> Output {
    let out = folder.join("out");
    let _ = fs::remove_dir_all(&out);
    let command =
        Command::new(env!("CARGO_BIN_EXE_armgen")).arg("run").args(files).arg("--out").arg(&out).current_dir(root()).output();
    command.expect("the program runs")
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

/// Whether the program was built with another robot: then there is nothing to compare.
fn skipped(output: &Output) -> bool {
    String::from_utf8_lossy(&output.stderr).contains("skipped: for the robot")
}

#[test]
fn what_is_as_expected_gives_a_table_figures_logs_and_code_0() {
    let folder = folder("run_as_expected");
    let output = run(&folder, Path::new("experiments/manipulability.yaml"));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    if skipped(&output) {
        return;
    }
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("33 of 33 results as expected"), "{text}");
    for file in ["manipulability.csv", "manipulability_postures.svg", "manipulability_workspace.svg"] {
        let text = fs::read_to_string(folder.join("out").join(file)).expect("it was written");
        assert!(
            !file.ends_with("svg") || (text.starts_with("<svg") && text.contains("fill=\"#ffffff\"") && !text.contains("NaN"))
        );
    }
}

#[test]
fn what_is_not_as_expected_or_faulty_gives_code_1() {
    let folder = folder("run_outside");
    let text = fs::read_to_string(root().join("experiments/manipulability.yaml")).expect("the experiment");
    let wrong = folder.join("wrong.yaml");
    fs::write(&wrong, text.replacen("value: 0.25, tolerance", "value: 0.2501, tolerance", 1)).expect("a file");
    let output = run(&folder, &wrong);
    if skipped(&output) {
        return;
    }
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("OUTSIDE"), "{output:?}");
    let faulty = folder.join("faulty.yaml");
    fs::write(&faulty, text.replacen("title:", "titel:", 1)).expect("a file");
    let output = run(&folder, &faulty);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("faulty.yaml:3:1") && message.contains("did you mean `title`?"), "{message}");
}

#[test]
fn a_file_that_is_not_there_gives_code_2() {
    assert_eq!(run(&folder("run_absent"), Path::new("experiments/absent.yaml")).status.code(), Some(2));
}

#[test]
fn no_experiment_writes_over_the_files_of_another() {
    let folder = folder("run_twins");
    let (first, twin) = (Path::new("experiments/manipulability.yaml"), folder.join("manipulability.yaml"));
    fs::copy(root().join(first), &twin).expect("a copy");
    let output = run_all(&folder, &[first, &twin]);
    if skipped(&output) {
        return;
    }
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("run_twins/manipulability.yaml is not run") && message.contains("rename it"), "{message}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("33 of 33 results as expected"), "{output:?}");
}
