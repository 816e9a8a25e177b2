//! The files of `page/web` under the tests that stand beside them, by Node; without it a line says so, and the test passes.

use std::process::Command;

#[test]
fn the_files_of_the_script_pass_their_own_tests() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/web/tests");
    let mut files: Vec<_> = std::fs::read_dir(folder).expect("the tests").map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    if !Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("skipped: no `node` here (Debian: nodejs)");
        return;
    }
    let output = Command::new("node").arg("--test").args(files).output().expect("node runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
