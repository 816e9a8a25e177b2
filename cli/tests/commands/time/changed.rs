//! Files of paths with random changes.

use std::fs;

use super::{armgen, err, own_folder, CRANE, PENDULUM, PLANAR, SLIDE};

/// Numbers, then words, that a change writes into a file.
const WORDS: [&str; 2] = [
    ".nan|.inf|-.inf|1e308|-1e308|5e-324|1e-160|1e160|-0|0|1|-1|1e-9|1e9|pi/2|deg(30)|1/0",
    "[]|{}|~|null|true|points|pieces|tip|curve|lines|through|limits|ends|speed|hold|tool|stop|q|\n  - [1, 2]\n|, ",
];

/// One or two changes of a text: a digit, a strange number, a part less, a part twice, a word, a byte.
fn changed(seed: &str, random: &mut impl FnMut(usize) -> usize) -> Vec<u8> {
    let mut text = seed.as_bytes().to_vec();
    let words: Vec<&str> = WORDS.iter().flat_map(|words| words.split('|')).collect();
    for _ in 0..=random(2) {
        let at = random(text.len());
        let end = (at + 1 + random(12)).min(text.len());
        let digits: Vec<usize> = (0..text.len()).filter(|at| text[*at].is_ascii_digit()).collect();
        match (random(7), digits.get(random(digits.len()))) {
            (0 | 1, Some(&digit)) => text[digit] = b'0' + random(10) as u8,
            (2, Some(&digit)) => drop(text.splice(digit..=digit, words[random(17)].bytes())),
            (3, _) => drop(text.drain(at.min(end)..end)),
            (4, _) => {
                let part = text[at.min(end)..end].to_vec();
                drop(text.splice(at..at, part));
            }
            (5, _) => drop(text.splice(at.min(end)..end, words[random(words.len())].bytes())),
            _ if at < text.len() => text[at] = random(256) as u8,
            _ => {}
        }
    }
    text
}

/// Each ends with a motion that the second proof does not refute, or with a message.
#[test]
#[ignore = "wide"]
fn changed_paths_are_timed_or_refused() {
    let seeds = [
        (SLIDE, "points: [[0], [2]]\nlimits: {velocity: [2], effort: [9]}\n"),
        (SLIDE, "pieces: {knots: [0, 1, 2], coefficients: [[[0, 1]], [[1, 1, 0.1]]]}\n"),
        (PENDULUM, "points: [[0], [1], [2]]\ncurve: through\nends: {speed: [0, 1], hold: false}\n"),
        (CRANE, "points: [[0, 0], [1, 1], [2, 0]]\ncurve: lines\nblend: 0.05\nlimits: {effort: {lift: [-10, 50]}}\n"),
        (PLANAR, "tip: {points: [[1.5, 0.8, 0], {via: [1.3, 1.02, 0], to: [1, 1.2, 0]}], start: [0, 1], tolerance: 1e-3}\ncurve: lines\n"),
        (CRANE, "points: [[0, 0], {q: [1, 1], stop: true}, {q: [2, 0], speed: 0.3}, [1, 1]]\ncurve: lines\nblend: 0.1\nlimits: {tool: {speed: 1.5}}\n"),
    ];
    let mut state = 7u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let folder = own_folder("changed");
    let [arm, path, json] = ["robot.yaml", "path.yaml", "timing.json"].map(|file| folder.join(file));
    let [arm_at, path_at, json_at] = [&arm, &path, &json].map(|path| path.to_str().expect("a UTF-8 path"));
    let (mut timed, count) = (0, 500);
    for number in 0..count {
        let (robot, seed) = seeds[number % seeds.len()];
        let text = changed(seed, &mut random);
        let shown = String::from_utf8_lossy(&text).into_owned();
        fs::write(&arm, robot).expect("a file");
        fs::write(&path, &text).expect("a file");
        let output = armgen(&["time", arm_at, path_at, "--json", json_at, "--segments", "200", "--gap", "0.02"]);
        let code = output.status.code();
        let message = err(&output);
        assert!(matches!(code, Some(0..=2)) && !message.contains("panicked"), "{number}: {code:?}\n{shown}\n{message}");
        assert!(code == Some(0) || message.contains("error"), "{number}: nothing is wrong with\n{shown}\n{message}");
        if code != Some(0) {
            continue;
        }
        timed += 1;
        let manipulator = armgen_codegen::validate::read(&armgen_codegen::source::Source::new("robot", robot)).0;
        let given = fs::read_to_string(&json).expect("a timing");
        let proved = armgen_verify::timing::check(&manipulator.expect("a valid arm").0, &given);
        assert!(proved.is_ok(), "{number}: {}\n{shown}", proved.err().unwrap_or_default());
    }
    println!("{timed} of {count} are timed");
    assert!(timed > count / 20, "{timed}");
}
