//! The targets of tests/fuzz on their seeds, and on random changes of these. libFuzzer, which looks for new paths, needs another compilation
//! of everything: run it by hand.

use std::fs;
use std::path::{Path, PathBuf};

use armgen_tests::random::Random;

// A crate of its own in tests/fuzz.
#[allow(unreachable_pub)]
#[path = "../fuzz/src/lib.rs"]
pub(crate) mod fuzz;

/// The longest input, as in tests/fuzz/run.
const LONGEST: usize = 8192;

/// Files of folders within tests/fuzz, sorted.
fn seeds(folders: &[&str]) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let files = folders.iter().flat_map(|folder| fs::read_dir(root.join(folder)).expect("a folder of seeds").flatten());
    let mut paths: Vec<PathBuf> = files.map(|file| file.path()).filter(|path| path.is_file()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("a seed")).filter(|seed| seed.len() <= LONGEST).collect()
}

/// Words of the formats, for changes.
fn words() -> Vec<Vec<u8>> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/words.dict")).expect("a list of words");
    let words = text.lines().filter_map(|line| line.strip_prefix('"')?.strip_suffix('"'));
    words.map(|word| word.replace("\\\"", "\"").replace("\\\\", "\\").into_bytes()).collect()
}

/// Up to four changes: a byte, a removed or repeated part, a word, or a part of another seed.
fn changed(seeds: &[Vec<u8>], words: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut below = |bound: usize| random.whole(0, bound.max(1) as i64 - 1) as usize;
    let mut input = seeds[below(seeds.len())].clone();
    for _ in 0..=below(4) {
        let at = below(input.len() + 1);
        let part = |bytes: &[u8], from: usize, most: usize| bytes[from..(from + most).min(bytes.len())].to_vec();
        match below(6) {
            0 if at < input.len() => input[at] = below(256) as u8,
            1 if at < input.len() => input[at] ^= 1 << below(8),
            2 => drop(input.drain(at..(at + 1 + below(40)).min(input.len()).max(at))),
            3 => {
                let part = part(&input, at, 1 + below(200));
                input.splice(at..at, part);
            }
            4 => drop(input.splice(at..at, words[below(words.len())].clone())),
            _ => {
                let other = &seeds[below(seeds.len())];
                let part = part(other, below(other.len() + 1), 1 + below(200));
                let to = (at + below(part.len() + 1)).min(input.len());
                input.splice(at..to, part);
            }
        }
    }
    input.truncate(LONGEST);
    input
}

/// Runs a target on its seeds and on `count` changes of them. Of an input that fails, the test prints the text.
fn fuzz(run: fn(&[u8]), folders: &[&str], count: usize) {
    let (seeds, words, mut random) = (seeds(folders), words(), Random::new(1));
    let inputs = seeds.iter().cloned().chain((0..count).map(|_| changed(&seeds, &words, &mut random)));
    for (number, input) in inputs.enumerate() {
        if std::panic::catch_unwind(|| run(&input)).is_err() {
            panic!("input {number}:\n{}", String::from_utf8_lossy(&input));
        }
    }
}

#[test]
#[ignore = "wide"]
fn robots() {
    fuzz(fuzz::robot::run, &["corpus/robot", "../../robots", "../robots", "../bad"], 1500);
}

#[test]
#[ignore = "wide"]
fn experiments() {
    let folders =
        ["corpus/experiment", "../../experiments", "../../experiments/paths", "../bad/experiments", "../bad/experiments/paths"];
    fuzz(fuzz::experiment::run, &folders, 4000);
}

#[test]
fn expressions() {
    fuzz(fuzz::expression::run, &["corpus/expression"], 1000);
}

#[test]
#[ignore = "wide"]
fn modules() {
    fuzz(fuzz::module::run, &["corpus/module"], 800);
}

#[test]
#[ignore = "wide"]
fn urdf_files() {
    let folders = ["corpus/urdf", "../../import/tests/bad", "../../import/tests/urdf"];
    fuzz(|data| fuzz::check_import("robot.urdf", data), &folders, 4000);
}

#[test]
#[ignore = "wide"]
fn mjcf_files() {
    let folders = ["corpus/mjcf", "../../import/tests/bad", "../../import/tests/mjcf"];
    fuzz(|data| fuzz::check_import("robot.xml", data), &folders, 4000);
}

#[test]
#[ignore = "wide"]
fn logs() {
    fuzz(fuzz::log::run, &["corpus/log"], 3000);
}

#[test]
fn poses() {
    fuzz(fuzz::poses::run, &["corpus/poses"], 3000);
}
