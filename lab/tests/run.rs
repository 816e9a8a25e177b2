//! `lab run` from its users' side: the table, the files, the exit codes.
//!
//! The tests generate experiments for the robot of the program, whose expectations hold for any robot. They still run after an edit of
//! robot.yaml. `tests/experiments` tests the experiments of the repository.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use armgen_experiments::model::Robot;
use armgen_experiments::run::Arm;

fn run(folder: &Path, files: &[&Path]) -> Output {
    let out = folder.join("out");
    let _ = fs::remove_dir_all(&out);
    Command::new(env!("CARGO_BIN_EXE_lab")).arg("run").args(files).arg("--out").arg(&out).output().expect("the program runs")
}

/// The robot of the program.
fn robot() -> Robot {
    armgen_experiments::instance!(armgen_generated).robot().clone()
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

/// An experiment file for this robot, with the expectation w >= `w`.
fn experiment(folder: &Path, name: &str, robot: &str, w: f64) -> PathBuf {
    let arm = self::robot();
    let q = vec!["0.3"; arm.dof()].join(", ");
    let text = format!(
        "robot: {robot}\ntitle: A posture\npostures:\n  - {{name: bent, q: [{q}]}}\ngrid: {{first: [0, 1], second: [0, 1]}}\nexpect:\n  \
         - {{quantity: bent.w, at_least: {w}}}\n  - {{quantity: bent.velocity_1, at_least: 0}}\n"
    );
    let file = folder.join(name);
    fs::write(&file, text).expect("a file");
    file
}

fn for_the_built_robot(folder: &Path, name: &str, w: f64) -> PathBuf {
    experiment(folder, name, &robot().name, w)
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn an_experiment_without_expectations_is_drawn_and_not_judged() {
    let folder = folder("run_without_expectations");
    let file = for_the_built_robot(&folder, "posture.yaml", 0.0);
    let text = fs::read_to_string(&file).expect("the file");
    fs::write(&file, text.split_once("expect:").expect("expectations").0).expect("a file");
    let output = run(&folder, &[&file]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = out(&output);
    assert!(said.contains("without `expect`, drawn and not judged: posture") && !said.contains("as expected"), "{said}");
}

#[test]
fn results_as_expected_give_a_table_figures_logs_and_code_0() {
    let folder = folder("run_as_expected");
    let output = run(&folder, &[&for_the_built_robot(&folder, "posture.yaml", 0.0)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(out(&output).contains("2 of 2 results as expected"), "{}", out(&output));
    assert!(err(&output).contains("2 figures and 1 log in"), "{}", err(&output));
    for file in ["posture.csv", "posture_postures.svg", "posture_workspace.svg"] {
        let text = fs::read_to_string(folder.join("out").join(file)).expect("it was written");
        assert!(
            !file.ends_with("svg") || (text.starts_with("<svg") && text.contains("fill=\"#ffffff\"") && !text.contains("NaN"))
        );
    }
}

#[test]
fn results_outside_and_faulty_files_give_code_1() {
    let folder = folder("run_outside");
    let outside = for_the_built_robot(&folder, "outside.yaml", 1e9);
    let output = run(&folder, &[&outside]);
    assert_eq!(output.status.code(), Some(1));
    assert!(out(&output).contains("OUTSIDE") && out(&output).contains("1 of 2 results as expected"), "{output:?}");
    let faulty = folder.join("faulty.yaml");
    let text = fs::read_to_string(outside).expect("the file").replacen("title:", "titel:", 1);
    fs::write(&faulty, text).expect("a file");
    let output = run(&folder, &[&faulty]);
    assert_eq!(output.status.code(), Some(1));
    assert!(err(&output).contains("faulty.yaml:2:1") && err(&output).contains("did you mean `title`?"), "{}", err(&output));
}

/// `robots/NAME.yaml` beside the experiments is the robot of their expectations. Comments of it do not count.
#[test]
fn expectations_of_another_robot_of_the_same_name_do_not_judge() {
    let folder = folder("run_edited");
    for inner in ["experiments", "robots"] {
        fs::create_dir(folder.join(inner)).expect("a folder");
    }
    let outside = for_the_built_robot(&folder.join("experiments"), "outside.yaml", 1e9);
    let known = folder.join("robots").join(format!("{}.yaml", robot().name));
    let described = include_str!("../../robot.yaml");
    for (text, code) in [(format!("# The same.\n{described}\n# Its end.\n"), 1), (format!("{described}allow: [dust]\n"), 0)] {
        fs::write(&known, text).expect("a file");
        let output = run(&folder, &[&outside]);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
        assert_eq!(err(&output).contains("the expectations belong to another robot"), code == 0, "{}", err(&output));
    }
}

#[test]
fn a_file_that_is_not_there_gives_code_2() {
    assert_eq!(run(&folder("run_absent"), &[Path::new("experiments/absent.yaml")]).status.code(), Some(2));
}

/// The message describes the fault of a path's text, even if the read limit cuts a multi-byte character.
#[test]
fn a_path_that_is_too_long_or_no_text_is_said_to_be_that() {
    let folder = folder("run_path");
    let arm = robot();
    let robot = &arm.name;
    let expect = "expect:\n  - {quantity: stops, at_most: 1}\n";
    let file = folder.join("path.yaml");
    fs::write(&file, format!("robot: {robot}\ntitle: A path\npath: way.txt\nsampling: 0.01\n{expect}")).expect("a file");
    let said = |way: &[u8]| {
        fs::write(folder.join("way.txt"), way).expect("a file");
        let output = run(&folder, &[&file]);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        err(&output)
    };
    let most = armgen_experiments::read::MAX_TEXT;
    for character in ["\u{e4}", "\u{20ac}", "\u{1f9be}"] {
        let long = said(&["#".repeat(most), character.repeat(9)].concat().into_bytes());
        assert!(long.contains("error[too-large]") && long.contains("more than the"), "{long}");
    }
    let latin = said(b"start: [0, 0, 0]\n# \xe4\n");
    assert!(latin.contains("cannot be read: it is not UTF-8: line 2 holds a byte"), "{latin}");
}

#[test]
fn an_experiment_for_another_robot_is_skipped_and_said_to_be() {
    let folder = folder("run_another");
    let other = experiment(&folder, "other.yaml", "someone_else", 0.0);
    let own = for_the_built_robot(&folder, "own.yaml", 0.0);
    let output = run(&folder, &[&other, &own]);
    assert_eq!(output.status.code(), Some(0));
    assert!(err(&output).contains("1 experiment skipped: for the robot `someone_else`"), "{}", err(&output));
    assert!(out(&output).contains("2 of 2 results as expected"), "{}", out(&output));
    // Without its own experiments, the arm runs its demonstration.
    let output = run(&folder, &[&other]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(out(&output).contains("demonstration.svg"), "{}", out(&output));
}

/// The help's example passes all files of a folder, including paths.
#[test]
fn a_path_is_no_experiment_and_no_file_that_is_read_is_written_over() {
    let folder = folder("run_with_path");
    let own = for_the_built_robot(&folder, "own.yaml", 0.0);
    let path = folder.join("path.yaml");
    fs::write(&path, "start: [0, 0, 0]\nsegments:\n  - {line: [0.1, 0, 0], duration: 1}\n").expect("a file");
    let output = run(&folder, &[&own, &path]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(err(&output).contains("path.yaml skipped: a path, which experiments name"), "{}", err(&output));
    let output = run(&folder, &[&path]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(err(&output).contains("path.yaml is a path, not an experiment"), "{}", err(&output));
    let second = folder.join("second.yaml");
    fs::copy(&path, &second).expect("a file");
    let output = run(&folder, &[&path, &second]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(err(&output).contains("path.yaml and 1 more are paths, not experiments"), "{}", err(&output));
    // A figure of `own` has the name of this input file, which must not be overwritten.
    let out = folder.join("again");
    fs::create_dir_all(&out).expect("a folder");
    let input = for_the_built_robot(&out, "own_postures.svg", 0.0);
    let before = fs::read(&input).expect("the file");
    let mut program = Command::new(env!("CARGO_BIN_EXE_lab"));
    let output = program.arg("run").args([&own, &input]).arg("--out").arg(&out).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(err(&output).contains("own_postures.svg is not written"), "{}", err(&output));
    assert_eq!(fs::read(&input).expect("still there"), before);
}

#[test]
fn no_experiment_writes_over_the_files_of_another() {
    let folder = folder("run_twins");
    fs::create_dir_all(folder.join("twin")).expect("a folder");
    let first = for_the_built_robot(&folder, "posture.yaml", 0.0);
    let twin = for_the_built_robot(&folder, "twin/posture.yaml", 0.0);
    let output = run(&folder, &[&first, &twin]);
    assert_eq!(output.status.code(), Some(1));
    assert!(err(&output).contains("twin/posture.yaml is not run") && err(&output).contains("rename it"), "{}", err(&output));
    assert!(out(&output).contains("2 of 2 results as expected"), "{output:?}");
}

#[test]
fn the_built_robot_moves_and_leaves_figures_and_logs() {
    let folder = folder("run_demonstration");
    let output = Command::new(env!("CARGO_BIN_EXE_lab")).args(["run", "--out"]).arg(&folder).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = out(&output);
    assert!(text.contains("spectral radius"), "{text}");
    let written = |extension: &str| -> Vec<String> {
        let names = text.lines().map(str::trim).filter(|line| line.ends_with(extension));
        names.map(|name| fs::read_to_string(name).expect("it is written")).collect()
    };
    let (figures, logs) = (written(".svg"), written(".csv"));
    assert!(!figures.is_empty() && figures.len() == logs.len(), "{text}");
    for figure in figures {
        assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
        assert!(!figure.contains("NaN"));
    }
    for log in logs {
        let mut lines = log.lines();
        let columns = lines.next().expect("a header").split(',').count();
        assert!(lines.clone().count() > 100);
        assert!(lines.all(|line| line.split(',').filter(|cell| cell.parse::<f64>().is_ok_and(f64::is_finite)).count() == columns));
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    let file = folder("unwritable").join("file");
    fs::write(&file, "").expect("a file");
    let output = Command::new(env!("CARGO_BIN_EXE_lab")).args(["run", "--out"]).arg(&file).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(err(&output).contains("cannot write"), "{}", err(&output));
}
