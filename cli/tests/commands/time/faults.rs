//! Every fault of `armgen time` with its code and its place.

use std::fs;

use super::{file, timed, CRANE, PENDULUM, PLANAR, SLIDE};

/// Code, robot, path, options, and texts that the message has.
fn faults() -> Vec<(&'static str, String, String, Vec<&'static str>, Vec<&'static str>)> {
    let knots = "knots: [0, 1, 2], coefficients";
    let of = |robot: &str, path: &str| (robot.to_owned(), path.to_owned());
    let crane = "points: [[0, 0], [1, 1], [2, 0]]\n";
    let cases = [
        ("missing-path", of(SLIDE, "curve: spline\n"), "", vec!["path.yaml:1:1", "`points: ["]),
        ("unknown-word", of(SLIDE, "points: [[0], [1]]\ncurve: splines\n"), "", vec!["path.yaml:2:8", "did you mean `spline`"]),
        (
            "unknown-joint",
            of(SLIDE, "points: [[0], [1]]\nlimits: {velocity: {slid: 2}}\n"),
            "",
            vec!["2:21", "did you mean `slide`"],
        ),
        ("limit-not-positive", of(SLIDE, "points: [[0], [1]]\nlimits: {effort: [0]}\n"), "", vec!["path.yaml:2:19"]),
        ("negative-speed", of(SLIDE, "points: [[0], [1]]\nends: {speed: [-1, 0]}\n"), "", vec!["path.yaml:2:15"]),
        ("knot-order", of(SLIDE, "pieces: {knots: [1, 1], coefficients: [[[0, 1]]]}\n"), "", vec!["knot 2 is not above knot 1"]),
        (
            "jump",
            of(SLIDE, &format!("pieces: {{{knots}: [[[0, 1]], [[1.1, 1]]]}}\n")),
            "",
            vec!["at s = 1, piece 2: joint `slide` jumps by 0.1 m", "path.yaml:1:"],
        ),
        ("corner", of(CRANE, &format!("{crane}curve: lines\n")), "", vec!["path.yaml:1:18", "point 2", "90 deg", "blend: 0.05"]),
        ("zero-length", of(SLIDE, "points: [[0], [1], [1]]\n"), "", vec!["points 2 and 3 are equal"]),
        (
            "turning-back",
            of(SLIDE, "pieces: {knots: [0, 1], coefficients: [[[0, -1, 1]]]}\n"),
            "",
            vec!["at s = 0.5, piece 1", "end the path here"],
        ),
        (
            "outside-limits",
            of(SLIDE, "points: [[0], [6]]\n"),
            "",
            vec!["at s = 6, point 2: joint `slide` is at 6, 1 m beyond its range", "s = 5 to 6", "path.yaml:1:16"],
        ),
        (
            "missing-limit",
            of(&CRANE.replace(", limits: {velocity: 2}", ""), crane),
            "",
            vec!["`boom` moves and has neither", "limits: {velocity: {boom: 2}}"],
        ),
        (
            "infeasible-point",
            of(CRANE, "points: [[0, 0], [1, 1]]\nlimits: {effort: [15, 1]}\nends: {hold: false}\n"),
            "",
            vec!["at s = 0, point 1", "19.62 N", "proved"],
        ),
        (
            "infeasible-speed",
            of(PENDULUM, "points: [[0], [3]]\nlimits: {effort: [6]}\nends: {hold: false}\n"),
            "",
            vec!["between points 1 and 2", "joint `pivot`", "6 N m", "this is proved"],
        ),
        (
            "end-not-held",
            of(PENDULUM, "points: [[0], [2]]\nlimits: {effort: [8]}\n"),
            "",
            vec!["at s = 2, point 2", "needs 8.92", "hold: false"],
        ),
        ("too-coarse", of(PENDULUM, "points: [[0], [20]]\n"), "--segments=5", vec!["try `--segments "]),
        ("start-not-held", of(PENDULUM, "points: [[pi/2], [0]]\nlimits: {effort: [8]}\n"), "", vec!["needs 9.81 N m"]),
        ("gap", of(PENDULUM, "points: [[0], [2]]\n"), "--segments=20 --gap=1e-9", vec![" segments leave a gap of"]),
        (
            "slow-point",
            of(CRANE, "points: [[0, 0], [1, 1], [2, 0]]\ncurve: lines\nblend: 1e-6\nlimits: {acceleration: [5, 5]}\n"),
            "--segments=3000",
            vec!["the corner of point 2: the motion slows down to"],
        ),
        ("other-robot", of(SLIDE, "robot: panda\npoints: [[0], [1]]\n"), "", vec!["`panda`", "path.yaml:1:8"]),
        // Of the tip.
        (
            "singular",
            of(PLANAR, "tip: {points: [[1, 0.5, 0], [2, 0, 0]], start: [-0.5, 2]}\n"),
            "",
            vec!["at s = 1.11803, point 2", "least singular value of J", "path.yaml:1:"],
        ),
        (
            "unreachable",
            of(PLANAR, "tip: {points: [[1, 0, 0], [3.2, 0, 0]], start: [-1, 2]}\n"),
            "",
            vec!["at s = 1, between points 1 and 2", "1.2 m and 0 rad"],
        ),
        (
            "tolerance",
            of(PLANAR, "tip: {points: [[1, 0, 0], [1, 1, 0]], start: [-1, 2], tolerance: 1e-18}\n"),
            "",
            vec!["between points 1 and 2", "raise `tolerance`"],
        ),
        // Of points that are passed in another way.
        (
            "limit-not-positive",
            of(SLIDE, "points: [[0], {q: [1], speed: 1.5}, [2]]\n"),
            "",
            vec!["the speed of point 2 is no share", "path.yaml:1:31", "`speed: 0.2`"],
        ),
        (
            "missing-limit",
            of(&SLIDE.replace("velocity: 3, ", ""), "points: [[0], {q: [1], speed: 0.5}, [2]]\n"),
            "",
            vec!["point 2 has a share of the limits of speed, and there are none", "path.yaml:1:19"],
        ),
        (
            "unknown-word",
            of(SLIDE, "points: [{q: [0], stop: true}, [1]]\n"),
            "",
            vec!["a path stops between its first and its last point", "path.yaml:1:19", "leave it out"],
        ),
        (
            "unknown-key",
            of(SLIDE, "points: [[0], {q: [1], sped: 0.5}, [2]]\n"),
            "",
            vec!["did you mean `speed`", "path.yaml:1:24"],
        ),
        (
            "limit-not-positive",
            of(SLIDE, "points: [[0], [1]]\nlimits: {tool: {speed: 0}}\n"),
            "",
            vec!["`speed` of the tool is not above zero", "path.yaml:2:24"],
        ),
        (
            "infeasible-speed",
            of(SLIDE, "points: [[0], [1]]\nlimits: {tool: {speed: 1}}\nends: {speed: [2, 0]}\n"),
            "",
            vec!["at s = 0, point 1", "the end effector is limited in its speed, at most 1 m/s", "proved"],
        ),
        // Of arcs.
        (
            "no-circle",
            of(PLANAR, "tip: {points: [[1, 0, 0], {via: [1, 0.2, 0], to: [1, 0.5, 0]}], start: [-1, 2]}\ncurve: lines\n"),
            "",
            vec!["no circle passes point 1, `via` and point 2", "path.yaml:1:50"],
        ),
        (
            "corner",
            of(
                PLANAR,
                "tip: {points: [[1, -0.2, 0], [1, 0, 0], {via: [1.1, 0.1, 0], to: [1, 0.2, 0]}], start: [-1, 2]}\n\
                 curve: lines\nblend: 0.05\n",
            ),
            "",
            vec!["point 2: the path has a corner of 90 deg", "move `via`", "path.yaml:1:30"],
        ),
        (
            "unknown-word",
            of(PLANAR, "tip: {points: [[1, 0, 0], {via: [1.1, 0.2, 0], to: [1, 0.5, 0]}], start: [-1, 2]}\n"),
            "",
            vec!["only `curve: lines` has arcs", "path.yaml:1:27"],
        ),
        (
            "missing-path",
            of(PLANAR, "tip: {points: [{via: [1.1, 0.2, 0], to: [1, 0.5, 0]}, [1, 0.6, 0]], start: [-1, 2]}\ncurve: lines\n"),
            "",
            vec!["a path begins with a point", "path.yaml:1:16"],
        ),
        (
            "wrong-length",
            of(PLANAR, "tip: {points: [[1, 0, 0], {via: [1, 2], to: [1, 0.5, 0]}], start: [-1, 2]}\ncurve: lines\n"),
            "",
            vec!["via has 2 numbers, not 3", "path.yaml:1:33"],
        ),
        // Of a description.
        (
            "smooth-friction",
            of(&SLIDE.replace("coulomb: 2", "coulomb: 2, smooth: 0.1"), "points: [[0], [1]]\n"),
            "",
            vec!["joint `slide` has smooth friction", "leave out `smooth`"],
        ),
        // Shared with other files.
        (
            "not-finite",
            of(SLIDE, "points: [[0], [1e308]]\nlimits: {velocity: [1]}\n"),
            "",
            vec!["between points 1 and 2", "write smaller numbers"],
        ),
        ("wrong-length", of(SLIDE, "points: [[0], [1, 2]]\n"), "", vec!["path.yaml:1:15", "point 2 has 2 numbers, not 1"]),
        ("unknown-key", of(SLIDE, "points: [[0], [1]]\nspeed: 3\n"), "", vec!["path.yaml:2:1"]),
        ("wrong-kind", of(SLIDE, "points: 3\n"), "", vec!["path.yaml:1:9"]),
    ];
    cases
        .into_iter()
        .map(|(code, (robot, path), options, texts)| (code, robot, path, options.split_whitespace().collect(), texts))
        .collect()
}

#[test]
fn every_fault_has_its_code_and_its_place() {
    for (code, robot, path, options, texts) in faults() {
        let is_warning = ["start-not-held", "gap", "slow-point", "other-robot"].contains(&code);
        let (_, error, _) = timed(code, &robot, &path, &options, i32::from(!is_warning));
        assert!(error.contains(code), "{code}: {error}");
        for text in texts {
            assert!(error.contains(text), "{code} lacks `{text}`: {error}");
        }
        let count = error.lines().filter(|line| line.starts_with("error[") || line.starts_with("warning[")).count();
        assert_eq!(count, usize::from(code != "smooth-friction"), "{code}: {error}");
    }
}

/// All faults of a file in one go.
#[test]
fn faults_come_together() {
    let path = "points: [[0], [x]]\ncurve: round\nlimits: {velocity: [-1]}\n";
    let (_, error, _) = timed("together", SLIDE, path, &[], 1);
    for code in ["unknown-name", "unknown-word", "limit-not-positive"] {
        assert!(error.contains(code), "{error}");
    }
    // Corners and ranges, too.
    let path = "points: [[0, 0], [1, 1], [2, 0], [3, 1]]\ncurve: lines\n";
    let robot = CRANE.replace("velocity: 2, effort: 100", "velocity: 2, effort: 100, position: [0, 2.5]");
    let (_, error, _) = timed("together-path", &robot, path, &[], 1);
    assert_eq!(error.matches("error[corner]").count(), 2, "{error}");
    assert!(error.contains("error[outside-limits]"), "{error}");
}

/// The page has every code, and a test has.
#[test]
fn every_code_is_on_the_page_and_tested() {
    let declared = fs::read_to_string(file("cli/src/commands/time/code.rs")).expect("codes");
    let names: Vec<&str> = declared.lines().filter_map(|line| line.trim().strip_suffix("\",")?.split('"').nth(1)).collect();
    assert!(names.len() > 15, "{names:?}");
    let page = fs::read_to_string(file("docs/timing.md")).expect("a page");
    let tested: Vec<&str> = faults().iter().map(|fault| fault.0).collect();
    for name in names {
        assert!(page.contains(&format!("`{name}`")), "{name} is not on the page");
        assert!(tested.contains(&name), "{name} has no test");
    }
}
