//! Pages in a real browser, opened from disk. Any console message and any request besides the file fails the test.
//!
//! Without a browser, the tests print a line and pass (`tests/src/installed.rs`).

#[path = "browser/budgets.rs"]
mod budgets;
#[path = "browser/check.rs"]
mod check;
#[path = "browser/driver.rs"]
mod driver;
#[path = "browser/equations.rs"]
mod equations;
#[path = "browser/figures.rs"]
mod figures;
#[path = "browser/logs.rs"]
mod logs;
#[path = "browser/pages.rs"]
mod pages;
#[path = "browser/reader.rs"]
mod reader;
#[path = "browser/rust.rs"]
mod rust;
#[path = "browser/sheet.rs"]
mod sheet;
#[path = "browser/windows.rs"]
mod windows;

use armgen_codegen::source::Source;
use armgen_page::{Figure, Log, Run, Verdict};
use driver::Tab;
use pages::{long, opened, robot, robots, written};
use rust::State;
use serde_json::Value;

/// Moves the sliders within their ranges, types rates and accelerations, and returns the numbers of the document.
const MOVE: &str = r##"((k) => {
    const put = (id, value) => {
        const input = document.getElementById(id);
        input.value = String(value);
        input.dispatchEvent(new Event("input", { bubbles: true }));
    };
    const n = robot.DOF;
    for (let i = 1; i <= n; i++) {
        const range = document.getElementById(`q${i}`);
        const part = (0.37 * i + 0.29 * k) % 1;
        put(`q${i}`, Number(range.min) + part * (Number(range.max) - Number(range.min)));
        put(`dq${i}`, (0.7 * i + 1.3 * k) % 3 - 1.5);
        put(`ddq${i}`, (1.7 * i + 0.3 * k) % 4 - 2);
    }
    const held = (kind) => Array.from({ length: n }, (_, i) => document.getElementById(kind(i + 1)).value);
    const quantities = {};
    for (const entry of document.querySelectorAll("[data-quantity]")) {
        (quantities[entry.dataset.quantity] ??= []).push(entry.dataset.value);
    }
    const frames = [...document.querySelectorAll("#arm g[data-frame]")].map((frame) => [frame.dataset.frame, frame.dataset.origin]);
    return { state: [held((i) => `q${i}-value`), held((i) => `dq${i}`), held((i) => `ddq${i}`)], quantities, frames };
})"##;

fn numbers(texts: &Value) -> Vec<f64> {
    let all = texts.as_array().expect("a list");
    all.iter().map(|text| text.as_str().expect("a text").parse().expect("a number")).collect()
}

#[test]
#[ignore = "wide"]
fn shown_numbers_have_the_bits_of_rust() {
    let mut shown = Vec::new();
    let mut moved: Vec<(Source, Vec<State>)> = Vec::new();
    for source in robots() {
        let Some(mut tab) = opened(&source, 1600, "light") else { return };
        let results: Vec<Value> = (1..=3).map(|k| tab.run(&format!("{MOVE}({k})"))).collect();
        tab.close();
        moved.push((source, results.iter().map(|result| [0, 1, 2].map(|i| numbers(&result["state"][i]))).collect()));
        shown.push(results);
    }
    let expected = rust::results(&driver::folder("bits"), &moved);
    assert_eq!(expected.len(), moved.len(), "the program in Rust has results of all robots");
    let mut compared = 0;
    for (((source, _), shown), expected) in moved.iter().zip(&shown).zip(&expected) {
        assert_eq!(expected.len(), shown.len(), "{}: as many states", source.name());
        for (shown, expected) in shown.iter().zip(expected) {
            assert!(expected.len() >= 2, "{}: functions in Rust", source.name());
            for (name, values) in expected {
                let place = format!("{}: {name}", source.name());
                if name == "link_frames" {
                    check_frames(&place, &shown["frames"], values);
                    continue;
                }
                let texts = &shown["quantities"][name];
                assert!(texts.is_array(), "{place} is not shown");
                let numbers = numbers(texts);
                assert_eq!(numbers.len(), values.len(), "{place}: as many entries");
                for (k, (ours, theirs)) in numbers.iter().zip(values).enumerate() {
                    assert_eq!(ours.to_bits(), theirs.to_bits(), "{place}: entry {k} is {ours:e}, in Rust {theirs:e}");
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} numbers of {} robots have the bits of Rust", moved.len());
    assert!(compared > 1000);
}

/// The picture draws each frame at the origin of the link frame.
fn check_frames(place: &str, frames: &Value, values: &[f64]) {
    let frames = frames.as_array().expect("frames");
    assert_eq!(frames.len(), values.len() / 16 + 2, "{place}");
    assert_eq!((&frames[0][0], &frames[0][1]), (&"0".into(), &"0 0 0".into()));
    for (i, frame) in values.chunks(16).enumerate() {
        assert_eq!(frames[i + 1][0], (i + 1).to_string());
        let at: Vec<f64> = frames[i + 1][1].as_str().expect("an origin").split(' ').map(|x| x.parse().expect("m")).collect();
        let origin: Vec<f64> = frame.chunks(4).take(3).map(|row| row[3]).collect();
        assert_eq!(at, origin, "{place}");
    }
}

/// Five bars with two coordinates: the picture has all joints, and the cut pin is at one place, which the bars' frames give.
#[test]
#[ignore = "wide"]
fn coupled_joints_are_drawn_and_closed() {
    let source = Source::new("parallelogram.yaml", include_str!("../../tests/data/trees/parallelogram.yaml"));
    let Some(mut tab) = opened(&source, 1600, "light") else { return };
    let result = tab.run(&format!("{MOVE}(1)"));
    tab.close();
    let q = numbers(&result["state"][0]);
    let (lower, crank) = (q[0], q[1]);
    let expected = [lower, crank, crank - lower, lower - crank];
    let variables = numbers(&result["quantities"]["joint_variables"]);
    assert!(variables.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{variables:?}");
    let frames = result["frames"].as_array().expect("frames");
    let names: Vec<&str> = frames.iter().map(|frame| frame[0].as_str().expect("a name")).collect();
    assert_eq!(names, ["0", "1", "2", "3", "4", "e", "rod_end", "forearm_back"]);
    let at = |k: usize| -> Vec<f64> {
        let text = frames[k][1].as_str().expect("an origin");
        text.split(' ').map(|x| x.parse().expect("m")).collect()
    };
    let near = |found: Vec<f64>, x: f64, y: f64| assert!((found[0] - x).hypot(found[1] - y) < 1e-15, "{found:?}");
    near(at(3), 0.5 * lower.cos(), 0.5 * lower.sin());
    near(at(4), -0.2 * crank.cos(), -0.2 * crank.sin());
    // The rod turns as the lower arm does, the forearm as the crank.
    near(at(5), 0.5 * lower.cos() + 0.6 * crank.cos(), 0.5 * lower.sin() + 0.6 * crank.sin());
    // The loop is closed where both end effectors are drawn.
    near(at(6), at(7)[0], at(7)[1]);
}

/// An arm without masses shows its frames and its Jacobian, but no dynamics.
#[test]
#[ignore = "wide"]
fn an_arm_without_mass_has_its_kinematics() {
    let row = |name: &str| format!("  - {{name: {name}, type: revolute, a: 0.4, alpha: 0, d: 0, theta: 0, link: {{mass: 0}}}}\n");
    let text = format!("name: light\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n{}{}", row("one"), row("two"));
    let Some(mut tab) = opened(&Source::new("light.yaml", text), 1600, "light") else { return };
    let count = |quantity: &str| format!("document.querySelectorAll('[data-quantity={quantity}]').length");
    let shown =
        tab.run(&format!("[{}, {}, {}]", count("direct_kinematics"), count("geometric_jacobian"), count("inertia_matrix")));
    assert_eq!(shown, serde_json::json!([16, 12, 0]));
    tab.close();
}

/// Markup in texts of files appears as text and never runs, even without the content security policy.
#[test]
#[ignore = "wide"]
fn hostile_texts_are_inert() {
    if driver::program().is_none() {
        return;
    }
    let folder = driver::folder("hostile");
    let hostile = "</script><script>hacked=1</script><img src=x onerror=hacked=1>\"'\u{2028}<!--<script>";
    let csv = format!("t,x,{hostile}\n0,1,2\n1,2,3\n");
    let log = Log::read(&csv, |_| hostile.to_owned()).expect("a log");
    let figure =
        String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><script>hacked=1</script></svg>");
    let [what, name, meaning, found, expected] = [hostile; 5].map(str::to_owned);
    let verdict = Verdict { what, name, meaning, found, expected, met: false };
    let run = Run {
        name: hostile.into(),
        title: hostile.into(),
        log: Some(log),
        verdicts: vec![verdict],
        figures: vec![Figure { title: hostile.into(), svg: figure }],
    };
    let source = Source::new(format!("{hostile}.yaml"), format!("# {hostile}\n{}", robot("scara").text()));
    let (page, _) = armgen_page::page(&source, &[run]).expect("a log without joints goes with any arm");
    let page = page.expect("a page");
    let start = page.find("<meta http-equiv").expect("a policy");
    let end = start + page[start..].find('>').expect("its end") + 1;
    let without = format!("{}{}", &page[..start], &page[end..]);
    for (name, text) in [("with", page), ("without", without)] {
        let file = folder.join(format!("{name}.html"));
        std::fs::write(&file, text).expect("written");
        let Some(mut tab) = Tab::open(&file, 1600, "light") else { return };
        let found = tab.run(
            "(async () => { const log = document.querySelector('[data-log]'); log.open = true; \
             while (!log.querySelector('.uplot canvas')) await new Promise((done) => setTimeout(done, 5)); \
             await new Promise((done) => setTimeout(done, 100)); \
             return [typeof globalThis.hacked, document.scripts.length, document.querySelectorAll('img:not(.figures img)').length, \
                     log.dataset.log.startsWith('</script>'), log.querySelector('td').textContent.startsWith('</script>'), \
                     [...log.querySelectorAll('.u-label')].some((label) => label.textContent.startsWith('</script>'))]; })()",
        );
        assert_eq!(found, serde_json::json!(["undefined", 2, 0, true, true, true]), "{name}");
        tab.close();
    }
}

/// Arms of 1, 12 and 32 joints, the first prismatic, with modified DH rows and limits.
#[test]
#[ignore = "wide"]
fn short_and_long_arms_have_pages() {
    let size = |source: &Source| std::fs::metadata(written(source)).expect("a file").len();
    for (name, most) in [("scara", 250_000), ("panda7", 1_000_000)] {
        assert!(size(&robot(name)) < most, "{name}: {} bytes", size(&robot(name)));
    }
    for joints in [1, 12, 32] {
        let source = long(joints);
        assert!(size(&source) < 1_500_000, "{joints} joints: {} bytes", size(&source));
        let Some(mut tab) = opened(&source, 1600, "dark") else { return };
        let shown = tab.run(
            "[document.querySelectorAll('#sliders input[type=range]').length, document.getElementById('q1-value').value, \
              document.querySelectorAll('[data-quantity=inertia_matrix]').length, document.querySelectorAll('[data-quantity=inverse_dynamics]').length]",
        );
        assert_eq!(shown, serde_json::json!([joints, "0.6", joints * joints, joints]));
        tab.close();
    }
}
