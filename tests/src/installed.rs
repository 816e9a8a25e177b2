//! Programs of this machine that a test may need, and the record of checks skipped without them.
//!
//! A line reports each skipped check. The file that `ARMGEN_SKIPPED` names collects these lines, and `.ci/run` prints it at its
//! end. Where `ARMGEN_REQUIRE_TOOLS` is set, a missing program is a failure, unless `ARMGEN_WITHOUT` lists it.
//! Tests of other crates include this file by its path; scripts have `tests/skip.sh`.
#![allow(dead_code, missing_docs, unreachable_pub)]

use std::io::Write;
use std::process::Command;

/// Whether a program runs with these arguments and succeeds.
pub fn runs(program: &str, arguments: &[&str]) -> bool {
    Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
}

/// Whether a program is installed. If not, reports the skipped check and the Debian package of the program.
#[track_caller]
pub fn there(program: &str, package: &str) -> bool {
    let found = runs(program, &["--version"]);
    if !found {
        left_out(&format!("no `{program}` here (Debian: {package})"));
    }
    found
}

/// Reports a skipped check and its reason.
///
/// # Panics
///
/// Where `ARMGEN_REQUIRE_TOOLS` asks for everything, and no word of `ARMGEN_WITHOUT` is in the reason.
#[track_caller]
pub fn left_out(why: &str) {
    let wanted = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    println!("skipped: {why}");
    if let Some(path) = wanted("ARMGEN_SKIPPED") {
        let mut file = std::fs::File::options().append(true).create(true).open(&path).expect("ARMGEN_SKIPPED names a file");
        // The name of a test's thread is that of the test.
        let test = std::thread::current().name().unwrap_or("a test").to_owned();
        file.write_all(format!("{test}: {why}\n").as_bytes()).expect("ARMGEN_SKIPPED can be written");
    }
    let without = wanted("ARMGEN_WITHOUT").unwrap_or_default();
    let excepted = without.to_string_lossy().split_whitespace().any(|word| why.contains(word));
    assert!(excepted || wanted("ARMGEN_REQUIRE_TOOLS").is_none(), "ARMGEN_REQUIRE_TOOLS is set, and there is {why}");
}
