//! Pages in a real browser, opened from disk: every message on the console and every request but the file fails the test.
//!
//! Where there is no browser a line says so, and the tests pass.

#[path = "browser/driver.rs"]
mod driver;
#[path = "browser/rust.rs"]
mod rust;

use std::path::{Path, PathBuf};

use armgen_codegen::source::Source;
use driver::{Browser, Tab};
use rust::State;
use serde_json::Value;

/// All descriptions of the project, sorted.
fn robots() -> Vec<Source> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let folders = ["robots", "tests/robots"].map(|folder| format!("{root}/{folder}"));
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("a folder of robots"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    paths.sort();
    let source = |path: PathBuf| {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        Source::new(name, std::fs::read_to_string(path).expect("a description"))
    };
    paths.into_iter().map(source).collect()
}

fn robot(name: &str) -> Source {
    robots().into_iter().find(|source| source.name() == format!("{name}.yaml")).expect("a robot of the project")
}

/// Writes the page of a robot.
fn written(folder: &Path, source: &Source) -> PathBuf {
    let file = folder.join(Path::new(source.name()).with_extension("html"));
    let (page, diagnostics) = armgen_page::page(source);
    std::fs::write(&file, page.unwrap_or_else(|| panic!("{diagnostics:?}"))).expect("the page is written");
    file
}

/// Moves the sliders to places of their ranges, types rates and accelerations, and gives what the document then holds.
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
fn shown_numbers_have_the_bits_of_rust() {
    let Some(program) = driver::program() else { return };
    let folder = driver::folder("bits");
    let mut browser = Browser::start(&program, &folder.join("browser"));
    let mut shown = Vec::new();
    let robots: Vec<(Source, Vec<State>)> = robots()
        .into_iter()
        .map(|source| {
            let file = written(&folder, &source);
            let mut tab = browser.open(&file, 1600, "light");
            let results: Vec<Value> = (1..=3).map(|k| tab.run(&format!("{MOVE}({k})"))).collect();
            tab.close(&file);
            let states = results.iter().map(|result| [0, 1, 2].map(|i| numbers(&result["state"][i]))).collect();
            shown.push(results);
            (source, states)
        })
        .collect();
    let expected = rust::results(&folder, &robots);
    let mut compared = 0;
    for (((source, _), shown), expected) in robots.iter().zip(&shown).zip(&expected) {
        for (shown, expected) in shown.iter().zip(expected) {
            for (name, values) in expected {
                let place = format!("{}: {name}", source.name());
                if name == "link_frames" {
                    check_frames(&place, &shown["frames"], values);
                    continue;
                }
                let texts = &shown["quantities"][name];
                assert!(texts.is_array(), "{place} is not shown");
                for (k, (ours, theirs)) in numbers(texts).iter().zip(values).enumerate() {
                    assert_eq!(ours.to_bits(), theirs.to_bits(), "{place}: entry {k} is {ours:e}, in Rust {theirs:e}");
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} numbers of {} robots have the bits of Rust", robots.len());
    assert!(compared > 1000);
}

/// The frames of the picture stand at the origins of the link frames.
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

/// The widest and the narrowest window, both themes, print: nothing is said, nothing overflows.
#[test]
fn pages_fit_windows_themes_and_paper() {
    let Some(program) = driver::program() else { return };
    let folder = driver::folder("windows");
    let mut browser = Browser::start(&program, &folder.join("browser"));
    for source in [robot("scara"), robot("panda7"), robot("everything")] {
        let file = written(&folder, &source);
        for (width, theme) in [(360, "dark"), (1600, "light"), (800, "light")] {
            let mut tab = browser.open(&file, width, theme);
            let overflow = tab.run("document.documentElement.scrollWidth - innerWidth");
            assert!(overflow.as_f64().is_some_and(|by| by <= 0.0), "{}: {width} px: {overflow} px too wide", source.name());
            keep(&folder, &format!("{}-{width}-{theme}.png.base64", source.name()), &mut tab);
            assert!(tab.print() > 10_000);
            tab.close(&file);
        }
    }
}

/// A picture to be looked at, where somebody asks for them.
fn keep(folder: &Path, name: &str, tab: &mut Tab<'_>) {
    if std::env::var_os("ARMGEN_PICTURES").is_some() {
        std::fs::write(folder.join(name), tab.picture()).expect("a picture is written");
    }
}

/// A row in focus is drawn as on a sheet; limits that are left are marked; keys turn the arm.
#[test]
fn rows_are_drawn_and_limits_marked() {
    let Some(program) = driver::program() else { return };
    let folder = driver::folder("rows");
    let mut browser = Browser::start(&program, &folder.join("browser"));
    let text = robot("scara").text().replacen("    type: revolute\n", "    type: revolute\n    limits: {position: [-1, 1]}\n", 1);
    let source = Source::new("limited.yaml", text);
    let file = written(&folder, &source);
    let mut tab = browser.open(&file, 1600, "light");
    let texts = "document.querySelector('#sheet tr[data-row=\"1\"]').focus(); \
                 [...document.querySelectorAll('#arm g[data-dimension=\"1\"] text')].map((text) => text.textContent)";
    assert_eq!(tab.run(texts), serde_json::json!(["θ = 0 rad", "d = 1 m", "a = 0.5 m"]));
    assert_eq!(tab.run("document.activeElement.blur(); document.querySelectorAll('#arm g[data-dimension]').length"), 0);
    let warned = "document.querySelectorAll('#sheet tr[data-row=\"1\"] [data-warning=\"triangle-inequality\"]').length";
    assert_eq!(tab.run(warned), 1);
    let typed = "const q = document.getElementById('q1-value'); q.value = '1.5'; q.dispatchEvent(new Event('input')); \
                 document.getElementById('q1-outside').hidden";
    assert_eq!(tab.run(typed), false);
    let degrees = "document.getElementById('angle-unit').click(); \
                   [document.getElementById('q1-value').value, document.querySelector('#sheet tr[data-row=\"2\"]').innerText.includes('180°')]";
    assert_eq!(tab.run(degrees), serde_json::json!(["85.94366926962348", true]));
    let turned = "(() => { const at = () => document.querySelector('#arm g[data-frame=\"e\"] line').getAttribute('x1'); const before = at(); \
                  document.getElementById('arm').dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft' })); return before !== at(); })()";
    assert_eq!(tab.run(turned), true);
    assert_eq!(tab.run("Object.isFrozen(globalThis.robot) && robot.NAME"), "scara");
    tab.close(&file);
}

/// Every section of equations opens, with numbers and with names, and never holds more nodes than a browser lays out at once.
#[test]
fn equations_are_set_when_they_are_opened() {
    let Some(program) = driver::program() else { return };
    let folder = driver::folder("equations");
    let mut browser = Browser::start(&program, &folder.join("browser"));
    for name in ["scara", "ur5", "everything"] {
        let source = robot(name);
        let file = written(&folder, &source);
        let mut tab = browser.open(&file, 1600, "light");
        let opened = tab.run(OPEN);
        let opened = opened.as_array().expect("sections");
        assert!(opened.len() > 25, "{name}");
        for section in opened {
            let nodes = section[1].as_u64().expect("a number");
            assert!((1..20_000).contains(&nodes), "{name}: {section}");
        }
        if name == "scara" {
            let entry = "document.querySelector('details[data-equation=\"inertia_matrix\"] [data-entry=\"1,2\"]')";
            assert_eq!(tab.run(&format!("{entry}.textContent")), "5cosq2+8.766");
            assert_eq!(tab.run(&choose("digits", "exact", &format!("{entry}.querySelectorAll('mfrac').length"))), 1);
            assert_eq!(tab.run(&choose("form", "symbolic", &format!("{entry}.textContent.includes('ml2')"))), true);
            let near = "[...document.querySelectorAll('.near')].map((e) => e.textContent).filter((text) => text).join()";
            assert_eq!(tab.run(near), "near zero: zero at q2 = 0 mod π", "the arm is stretched at q = 0");
        }
        tab.close(&file);
    }
}

const OPEN: &str = r#"(async () => {
    const all = [];
    for (const details of document.querySelectorAll("details[data-equation]")) {
        details.open = true;
        while (!details.querySelector("math")) await new Promise((done) => setTimeout(done, 1));
        all.push([details.dataset.equation, details.querySelectorAll("math *").length]);
        if (details.dataset.equation !== "inertia_matrix") details.open = false;
    }
    return all;
})()"#;

/// Chooses one of the forms of equations, waits, and evaluates.
fn choose(name: &str, value: &str, then: &str) -> String {
    format!(
        "(async () => {{ document.querySelector('input[name=\"{name}\"][value=\"{value}\"]').click(); \
         await new Promise((done) => setTimeout(done, 100)); return {then}; }})()"
    )
}

/// Poses of the true arm on the page of a description with one wrong value: the first suspect is the row, and a ghost can be drawn of it.
#[test]
fn a_planted_mistake_is_the_first_suspect() {
    let Some(program) = driver::program() else { return };
    let folder = driver::folder("suspects");
    let mut browser = Browser::start(&program, &folder.join("browser"));
    let truth = robot("ur5");
    let file = written(&folder, &truth);
    let mut tab = browser.open(&file, 1600, "light");
    let poses = tab.run(&format!(
        "{MOVE}(1); document.getElementById('measured-add').click(); {MOVE}(2); document.getElementById('measured-add').click(); \
         document.getElementById('measured').value"
    ));
    assert_eq!(tab.run("document.querySelectorAll('#suspects li').length"), 0, "the true arm agrees");
    tab.close(&file);
    let wrong = truth.text().replacen("alpha: pi/2", "alpha: -pi/2", 1);
    assert_ne!(wrong, truth.text());
    let file = written(&folder, &Source::new("wrong.yaml", wrong));
    let mut tab = browser.open(&file, 1600, "light");
    let first = tab.run(&format!(
        "(() => {{ const field = document.getElementById('measured'); field.value = {poses}; field.dispatchEvent(new Event('input')); \
         const first = document.querySelector('#suspects li'); first.querySelector('button').click(); \
         return [first.dataset.row, first.dataset.fault, Number(first.dataset.difference) < 1e-6, \
                 document.querySelectorAll('#arm .ghosts .solid').length > 10]; }})()"
    ));
    assert_eq!(first, serde_json::json!(["5", "alpha-sign", true, true]));
    let drawn = tab.run(
        "(async () => { for (const id of ['show-points', 'show-velocity', 'show-force', 'show-bodies']) document.getElementById(id).click(); \
         for (const id of ['reach', 'w-map']) document.getElementById(id).open = true; await new Promise((done) => setTimeout(done, 300)); \
         return [document.querySelectorAll('#arm .ellipsoids ellipse').length, document.querySelectorAll('#reach svg').length, \
                 document.getElementById('w-said').textContent.includes('det J changes its sign')]; })()",
    );
    assert_eq!(drawn, serde_json::json!([2, 2, true]));
    tab.close(&file);
}
