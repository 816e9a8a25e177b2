//! `armgen run --robot FILE`: the logs of an executed robot are those of the compiled one, and other arms move, too.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::installed;
use crate::languages::{check, folder};

/// Runs of each kind, short ones.
const RUNS: [&str; 5] = ["branch_pick_and_place", "clik_inverse", "manipulability", "robust_reported", "adaptive_a"];

#[test]
#[ignore = "wide"]
fn an_executed_robot_writes_the_logs_of_the_compiled_one() {
    let folder = folder("any_arm");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let [robot, runs] = ["robot.yaml", "experiments"].map(|name| root.join(name).display().to_string());
    let files = RUNS.map(|name| format!("{runs}/{name}.yaml"));
    let with = |before: &[&str], out: &str| -> Vec<String> {
        let all = before.iter().copied().chain(files.iter().map(String::as_str)).chain(["--out", out]);
        all.map(str::to_owned).collect()
    };
    let executed = with(&["run", "--robot", &robot], "executed");
    check(&folder, &executed.iter().map(String::as_str).collect::<Vec<_>>(), 0);
    let lab = Path::new(env!("CARGO_BIN_EXE_armgen")).with_file_name("lab");
    if !lab.is_file() {
        return installed::left_out("no lab beside the program (cargo build -p armgen-lab)");
    }
    let status = Command::new(lab).current_dir(&folder).args(with(&["run"], "compiled")).output().expect("it runs").status;
    assert!(status.success());
    let mut logs = 0;
    for entry in fs::read_dir(folder.join("compiled")).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            let name = path.file_name().expect("a name");
            let [compiled, executed] = ["compiled", "executed"].map(|out| fs::read(folder.join(out).join(name)).expect("a log"));
            assert!(compiled == executed, "{name:?}");
            logs += 1;
        }
    }
    assert!(logs >= RUNS.len() - 1, "{logs}");
}

#[test]
#[ignore = "wide"]
fn an_arm_that_nobody_compiled_moves() {
    let folder = folder("any_arm_moves");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for name in ["ur5", "panda7"] {
        let robot = root.join(format!("robots/{name}.yaml")).display().to_string();
        check(&folder, &["run", "--robot", &robot, "--out", name], 0);
        assert!(folder.join(name).join("index.html").is_file(), "{name}");
    }
    let text = fs::read_to_string(root.join("robots/ur5.yaml")).expect("a robot");
    fs::write(folder.join("position.yaml"), format!("{text}\ntask: [x, y, z]\n")).expect("a file");
    let said = check(&folder, &["run", "--robot", "position.yaml"], 1);
    assert!(said.contains("compiled for a `task` of 6 rows, not of 3"), "{said}");
}
