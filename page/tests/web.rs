//! Runs the tests of the files in `page/web` with Node, and checks their types with TypeScript. If a program is missing, a line
//! reports it and the test passes (`tests/src/installed.rs`).

use crate::installed;

use std::process::Command;

#[test]
#[ignore = "wide"]
fn the_files_of_the_script_pass_their_own_tests() {
    // The playground around the page is of the same kind.
    let folders = ["/web/tests", "/../wasm/web/tests"].map(|folder| format!("{}{folder}", env!("CARGO_MANIFEST_DIR")));
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("the tests"));
    let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    if !installed::there("node", "nodejs") {
        return;
    }
    let output = Command::new("node").arg("--test").args(files).output().expect("node runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
#[ignore = "wide"]
fn the_types_that_the_files_of_the_script_say_are_theirs() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/web");
    // "Version 5.9.3"; older versions support fewer JSDoc types.
    let said = Command::new("tsc").arg("--version").output().map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let major = said.ok().and_then(|said| said.split([' ', '.']).nth(1)?.parse::<u32>().ok());
    if major.is_none_or(|major| major < 5) {
        installed::left_out("no `tsc` of TypeScript 5 or later here (npm: typescript)");
        return;
    }
    let options = "--strict false --allowJs --checkJs --noEmit --strictNullChecks --skipLibCheck --target es2023 --module es2022 --lib dom,dom.iterable,es2023";
    let playground = concat!(env!("CARGO_MANIFEST_DIR"), "/../wasm/web");
    for (folder, files) in [(folder, ["globals.d.ts", "main.mjs"]), (playground, ["playground.mjs", "worker.mjs"])] {
        let output = Command::new("tsc").current_dir(folder).args(options.split(' ')).args(files).output().expect("tsc runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
