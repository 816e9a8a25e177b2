//! Shortens the files of the script, so that the program and the playground hold a third less text.

use std::path::Path;
use std::{env, fs};

#[path = "src/brief.rs"]
mod brief;

fn main() {
    println!("cargo:rerun-if-changed=web");
    let out = env::var_os("OUT_DIR").expect("cargo sets it");
    for entry in fs::read_dir("web").expect("the files of the script").map(|entry| entry.expect("an entry").path()) {
        if entry.extension().is_some_and(|extension| extension == "mjs") {
            let text = fs::read_to_string(&entry).expect("a text");
            let name = entry.file_name().expect("a file");
            fs::write(Path::new(&out).join(name), brief::brief(&text)).expect("a shorter file");
        }
    }
}
