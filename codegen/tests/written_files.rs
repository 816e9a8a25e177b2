//! Files of the project that are generated from the catalogue of emitted functions must match it.
//!
//! A change that is meant is accepted by `INSTA_UPDATE=always cargo test -p armgen-codegen --test all written_files`.

use std::path::Path;

#[track_caller]
fn check(path: &str, expected: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&file, expected).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
    let found = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{path}: {error}"));
    assert!(found == expected, "{path} is not what the catalogue says; see the head of this test");
}

#[test]
fn the_traits_of_one_function_each() {
    check("runtime/src/robot/single.rs", &armgen_codegen::emit::rust::single_traits());
}
