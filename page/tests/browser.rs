//! Pages in a real browser, opened from disk: every message on the console and every request but the file fails the test.
//!
//! Where there is no browser a line says so, and the tests pass.

#[path = "browser/budgets.rs"]
mod budgets;
#[path = "browser/driver.rs"]
mod driver;
#[path = "browser/figures.rs"]
mod figures;
#[path = "browser/pages.rs"]
mod pages;
#[path = "browser/reader.rs"]
mod reader;
#[path = "browser/rust.rs"]
mod rust;

use armgen_codegen::source::Source;
use armgen_page::{Figure, Log, Run, Verdict};
use driver::Tab;
use pages::{long, opened, robot, robots, written, written_with};
use rust::State;
use serde_json::Value;

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
    let mut compared = 0;
    for (((source, _), shown), expected) in moved.iter().zip(&shown).zip(&expected) {
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
    println!("{compared} numbers of {} robots have the bits of Rust", moved.len());
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
    for source in [robot("scara"), robot("panda7"), robot("everything")] {
        for (width, theme) in [(360, "dark"), (1600, "light"), (1360, "dark"), (810, "dark"), (800, "light")] {
            let Some(mut tab) = opened(&source, width, theme) else { return };
            let overflow = tab.run("document.documentElement.scrollWidth - innerWidth");
            assert!(overflow.as_f64().is_some_and(|by| by <= 0.0), "{}: {width} px: {overflow} px too wide", source.name());
            let cut = "const pane = document.getElementById('arm-pane'); pane.scrollWidth - pane.clientWidth";
            assert_eq!(tab.run(cut), 0, "{}: {width} px: the sliders are cut off", source.name());
            keep(&format!("{}-{width}-{theme}.png.base64", source.name()), &mut tab);
            assert!(tab.print() > 10_000);
            tab.close();
        }
    }
}

/// Opens what is folded away, where a page has it.
const UNFOLD: &str = r#"(async () => {
    const until = async (there) => {
        while (!there()) await new Promise((done) => setTimeout(done, 20));
    };
    // The log first: it moves the arm, and the postures are those of where it stands then.
    const log = document.querySelector("details[data-log]");
    if (log) {
        log.open = true;
        await until(() => log.querySelector(".uplot canvas"));
    }
    for (const selector of ["[id=postures]", "[id=reach]", "[id=w-map]", "[data-equation=inertia_matrix]", "[data-equation=determinant]"]) {
        const details = document.querySelector(`details${selector}`);
        if (details) details.open = true;
    }
    await new Promise((done) => setTimeout(done, 500));
    const set = (details) => details.querySelector(".copies") && !details.querySelector("[aria-busy=true]");
    await until(() => document.getElementById("postures-said").textContent && [...document.querySelectorAll("[data-equation][open]")].every(set));
})()"#;

/// In both themes and in a narrow window every control, picture and table has a name, headings of tables say what they head, references lead
/// somewhere, and every text has a contrast of 4.5 to 1; the key of tabulators reaches all controls in their order, and the focus is seen.
#[test]
fn everybody_can_read_and_use_a_page() {
    let log =
        Log::read("t,q_shoulder,q_elbow,q_quill,q_wrist,other\n0,0,0,0,0,1\n1,1,1,0,0,2\n", |_| "rad".into()).expect("a log");
    let verdict = |met| Verdict { what: "w".into(), found: "1".into(), expected: "2".into(), met };
    let named = |name: &str| Run {
        name: name.into(),
        log: Some(log.clone()),
        verdicts: vec![verdict(true), verdict(false)],
        ..Run::default()
    };
    let file = written_with("two-logs", &robot("scara"), &[named("one"), named("two")]);
    for (file, width, theme) in [(&file, 1600, "light"), (&file, 360, "dark"), (&written(&robot("panda7")), 1600, "dark")] {
        let Some(mut tab) = Tab::open(file, width, theme) else { return };
        tab.run(UNFOLD);
        let found = tab.run(include_str!("browser/audit.js"));
        assert_eq!(found["faults"], serde_json::json!([]), "{}, {theme}", file.display());
        assert!(found["texts"].as_u64().is_some_and(|texts| texts > 300), "{found}");
        println!("{}, {theme}: {} texts, the least contrast is {}", file.display(), found["texts"], found["least"]);
        tab.close();
    }
    let Some(mut tab) = Tab::open(&file, 1600, "light") else { return };
    tab.run(UNFOLD);
    let controls = tab.run(include_str!("browser/keyboard.js")).as_u64().expect("a number");
    for _ in 0..controls {
        tab.press_tab();
    }
    let astray = "visited.filter(([k], i) => k !== i).slice(0, 3).map(([k, seen, text]) => [k, text])";
    assert_eq!(tab.run(astray), serde_json::json!([]), "in the order of the document");
    let missed = "wanted.filter((_, i) => !visited.some(([k, seen]) => k === i && seen)).map((element) => element.outerHTML.slice(0, 100))";
    assert_eq!(tab.run(missed), serde_json::json!([]));
    // A curve is taken away by its switch, and brought back.
    let switched = "(() => { const one = document.querySelector('[role=switch]'), seen = []; \
                    for (let k = 0; k < 2; k++) { one.dispatchEvent(new KeyboardEvent('keydown', { key: ' ', bubbles: true })); \
                    seen.push(one.getAttribute('aria-checked'), one.closest('.u-series').classList.contains('u-off')); } return seen; })()";
    assert_eq!(tab.run(switched), serde_json::json!(["false", true, "true", false]));
    println!("{controls} controls are reached by the keyboard");
    tab.close();
}

/// A picture to be looked at, where somebody asks for them.
fn keep(name: &str, tab: &mut Tab) {
    if std::env::var_os("ARMGEN_PICTURES").is_some() {
        std::fs::write(driver::folder("windows").join(name), tab.picture()).expect("a picture is written");
    }
}

/// A row in focus is drawn as on a sheet; limits that are left are marked; keys turn the arm.
#[test]
fn rows_are_drawn_and_limits_marked() {
    let text = robot("scara").text().replacen("    type: revolute\n", "    type: revolute\n    limits: {position: [-1, 1]}\n", 1);
    let source = Source::new("limited.yaml", text);
    let Some(mut tab) = opened(&source, 1600, "light") else { return };
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
    tab.close();
}

/// The fields of joints take expressions, show six digits of all those that they hold, and say what is no number instead of forgetting it, even
/// when another joint moves.
#[test]
fn fields_take_expressions() {
    let Some(mut tab) = opened(&robot("scara"), 500, "light") else { return };
    let seen = tab.run(
        "(() => { const field = document.getElementById('q1-value'), fault = document.getElementById('q1-fault'), seen = []; \
         const put = (text) => { field.value = text; for (const kind of ['input', 'change']) field.dispatchEvent(new Event(kind, { bubbles: true })); \
             seen.push([field.value, field.parentElement.dataset.short, document.getElementById('q1').valueAsNumber.toFixed(3), \
                        fault.hidden, field.getAttribute('aria-invalid') === 'true']); }; \
         for (const text of ['-pi/4', '2*(pi - 1)/3', '1e-3', 'pie', '0x10', '1.25']) put(text); \
         document.getElementById('angle-unit').click(); put('-pi/4'); put('-68.754935'); put(''); \
         field.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowUp' })); seen.push(Number(field.value).toFixed(6)); \
         put('1.5x'); const slide = (id) => { document.getElementById(id).value = 0.3; \
             document.getElementById(id).dispatchEvent(new Event('input', { bubbles: true })); seen.push([field.value, fault.hidden]); }; \
         slide('q2'); slide('q1'); return seen; })()",
    );
    let expected = serde_json::json!([
        ["-0.7853981633974483", "−0.785398", "-0.785", true, false],
        ["1.4277284357265287", "1.42773", "1.428", true, false],
        ["0.001", "0.001", "0.001", true, false],
        ["pie", "0.001", "0.001", false, true],
        ["0x10", "0.001", "0.001", false, true],
        ["1.25", "1.25", "1.250", true, false],
        ["-45", "−45", "-0.785", true, false],
        ["-68.754935", "−68.7549", "-1.200", true, false],
        ["-68.754935", "−68.7549", "-1.200", true, false],
        "-67.754935",
        ["1.5x", "−67.7549", "-1.183", false, true],
        ["1.5x", false],
        ["17.188733853924695", true]
    ]);
    assert_eq!(seen, expected);
    let shown = "[...document.querySelectorAll('#sliders .rate .unit')].every((unit) => unit.checkVisibility())";
    assert_eq!(tab.run(shown), true, "units of rates are seen in a narrow window");
    tab.close();
}

/// Entries say their units where some joints turn and some slide; bodies their tensors and what the linter says of them; a tick in the list of
/// layers moves no slider, the tables of frames fit, and the wheel scrolls a narrow window.
#[test]
fn tables_say_units_and_doubts() {
    let Some(mut tab) = opened(&robot("scara"), 1600, "light") else { return };
    let seen = tab.run(
        "(() => { const row = document.querySelector('[data-quantity=gravity][data-row=\"3\"]').parentElement.firstChild.textContent; \
         const unit = (i, j) => document.querySelector(`[data-quantity=inertia_matrix][data-row=\"${i}\"][data-column=\"${j}\"]`).title; \
         const top = () => document.getElementById('q4').getBoundingClientRect().top, before = top(); document.getElementById('show-velocity').click(); \
         const drives = document.getElementById('drives').rows, parameters = document.getElementById('parameters').rows; \
         return [row, unit(1, 2), unit(1, 3), unit(3, 3), top() === before, document.getElementById('ellipsoid-axes').textContent !== '', \
                 [...drives[3].cells].map((cell) => cell.textContent), [...parameters[1].cells].map((cell) => cell.textContent)]; })()",
    );
    let drives = ["3 quill", "50 50 rad/m", "I_m3 0.005 kg m²", "F_m3 0.01 N m s"];
    assert_eq!(seen, serde_json::json!(["3 quill, N", "kg m²", "kg m", "kg", true, true, drives, ["m_l1", "20"]]));
    tab.close();
    let Some(mut tab) = opened(&robot("everything"), 1600, "light") else { return };
    let wide = "[...document.querySelectorAll('#frames .scroll, #bodies .scroll')].filter((table) => table.scrollWidth > table.clientWidth).length";
    for unit in ["m", "mm"] {
        assert_eq!(tab.run(&format!("{MOVE}(2); {wide}")), 0, "a table is cut off, in {unit}");
        tab.run("document.getElementById('length-unit').click()");
    }
    tab.close();
    let link = |name: &str, link: &str| {
        format!("  - {{name: {name}, type: revolute, a: 0.5, alpha: 0, d: 0, theta: 0, link: {{com: [0, 0, 0], {link}}}}}\n")
    };
    let text = format!(
        "name: bodies\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n{}{}{}",
        link("large", "mass: 1e-4, inertia: {xx: 1, yy: 1, zz: 1}"),
        link("massless", "mass: 0, inertia: {zz: 2}"),
        link("planar", "mass: 1, inertia: {zz: 0.01}")
    );
    let Some(mut tab) = opened(&Source::new("bodies.yaml", text), 500, "light") else { return };
    let bodies = tab.run("[...document.querySelectorAll('.bodies tbody tr')].map((row) => row.innerText)");
    let bodies: Vec<&str> = bodies.as_array().expect("rows").iter().filter_map(Value::as_str).collect();
    let [large, doubt, massless, said, planar] = bodies[..] else { panic!("{bodies:?}") };
    assert!(large.contains("xx 1") && large.contains("6.804·10⁻¹²") && large.ends_with("doubtful: lighter than foam"), "{large}");
    assert!(doubt.contains("radius of gyration of 100 m"), "{doubt}");
    assert!(massless.contains("zz 2") && massless.ends_with("no mass"), "{massless}");
    assert!(said.contains("one moment of inertia alone belongs to no solid body"), "{said}");
    assert!(planar.ends_with("planar: one moment alone"), "{planar}");
    let wheel = "(() => { const arm = document.getElementById('arm'); const turn = (ctrlKey) => { \
                 const event = new WheelEvent('wheel', { deltaY: 50, ctrlKey, cancelable: true }); arm.dispatchEvent(event); return event.defaultPrevented; }; \
                 const seen = [turn(false), turn(true)]; arm.focus(); seen.push(turn(false)); return seen; })()";
    assert_eq!(tab.run(wheel), serde_json::json!([false, true, true]));
    let lines = "[document.querySelector('#sheet caption').textContent.includes('Lines are those of bodies.yaml'), \
                 document.querySelector('#sheet .warning').textContent.includes(' of bodies.yaml)')]";
    assert_eq!(tab.run(lines), serde_json::json!([true, true]));
    tab.close();
}

/// Every section of equations opens, with numbers and with names, and never holds more nodes than a browser lays out at once.
#[test]
fn equations_are_set_when_they_are_opened() {
    for name in ["scara", "ur5", "everything"] {
        let source = robot(name);
        let Some(mut tab) = opened(&source, 1600, "light") else { return };
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
            let near = "[...document.querySelectorAll('strong.near')].map((e) => e.textContent).filter((text) => text).join()";
            assert_eq!(tab.run(near), "⚠ zero: singular", "the arm is stretched at q = 0");
        }
        if name == "everything" {
            // One entry is shown before the steps that it needs, and they are fewer than all; no step that is named is missing.
            let chosen = tab.run(CHOOSE_ENTRY);
            assert_eq!(chosen, serde_json::json!(["1,2", true, [], true, true]));
        }
        tab.close();
    }
}

/// An entry of an open section has its number beside it, that of the table at every posture; a singular posture is told at the picture, and
/// the buttons beside the factors lead to it.
#[test]
fn entries_have_numbers_and_singular_postures_a_badge() {
    let Some(mut tab) = opened(&robot("scara"), 1600, "light") else { return };
    let seen = tab.run(
        "(async () => { for (const name of ['inertia_matrix', 'determinant']) { const details = document.querySelector(`details[data-equation=${name}]`); \
         details.open = true; while (!details.querySelector('.copies')) await new Promise((done) => setTimeout(done, 5)); } \
         const b12 = () => { const beside = document.querySelector('[data-equation=inertia_matrix] [data-number=\"1,2\"]'); \
             const shown = document.querySelector('[data-quantity=inertia_matrix][data-row=\"1\"][data-column=\"2\"]'); \
             return [beside.textContent, beside.dataset.value === shown.dataset.value]; }; \
         const factor = () => document.querySelector('[data-number=factor_1]').dataset.value; \
         const badge = () => document.getElementById('singular-posture').textContent; \
         const q2 = document.getElementById('q2-value'); \
         const turn = (to) => { q2.value = to; q2.dispatchEvent(new Event('input', { bubbles: true })); }; \
         const seen = [[...b12(), factor(), badge()]]; turn('1'); seen.push([...b12(), badge()]); \
         const set = [...document.querySelectorAll('#singular button')].find((button) => button.textContent === 'set q₂ = 0'); \
         set.click(); seen.push([q2.value, badge() !== '']); turn('3'); set.click(); seen.push([q2.value, badge() !== '']); \
         const link = document.querySelector('#singular-posture a').hash; \
         const there = document.querySelector(`[data-equation=inertia_matrix] a[href=\"#number-inertia_matrix\"]`) !== null; \
         seen.push([document.querySelector(link).querySelector('h3').textContent, there]); \
         const lost = () => [document.getElementById('lost-motion').textContent, document.querySelector('#arm .lost text')?.textContent ?? '']; \
         seen.push(lost()); turn('0.01'); seen.push([lost()[0].split(',')[0], lost()[1], badge().split(':')[0]]); turn('1'); seen.push(lost()); return seen; })()",
    );
    let told = "⚠ singular posture: factor 1, 1/4 sin(q₂), of det J is zero";
    let expected = serde_json::json!([
        ["= 13.766", true, "0", told],
        ["= 11.4675", true, ""],
        ["0", true],
        ["3.141592653589793", true],
        ["Singular postures", true],
        ["Lost: whatever the rates, vx = 0.", "no motion along this line"],
        ["Nearly lost: vx + 0.005 vy + 0.0008333 ωz", "hardly any motion along this line", "⚠ nearly singular posture"],
        ["", ""]
    ]);
    assert_eq!(seen, expected);
    tab.close();
}

const OPEN: &str = r#"(async () => {
    const all = [];
    for (const details of document.querySelectorAll("details[data-equation]")) {
        details.open = true;
        while (!details.querySelector("math") || details.querySelector("[aria-busy=true]")) await new Promise((done) => setTimeout(done, 1));
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
    let truth = robot("ur5");
    let Some(mut tab) = opened(&truth, 1600, "light") else { return };
    let poses = tab.run(&format!(
        "{MOVE}(1); document.getElementById('measured-add').click(); {MOVE}(2); document.getElementById('measured-add').click(); \
         document.getElementById('measured').value"
    ));
    assert_eq!(tab.run("document.querySelectorAll('#suspects li').length"), 0, "the true arm agrees");
    tab.close();
    let wrong = truth.text().replacen("alpha: pi/2", "alpha: -pi/2", 1);
    assert_ne!(wrong, truth.text());
    let Some(mut tab) = opened(&Source::new("wrong.yaml", wrong), 1600, "light") else { return };
    let first = tab.run(&format!(
        "(() => {{ const field = document.getElementById('measured'); field.value = {poses}; field.dispatchEvent(new Event('input')); \
         const first = document.querySelector('#suspects li'); first.querySelector('button').click(); \
         return [first.dataset.row, first.dataset.fault, Number(first.dataset.difference) < 1e-6, \
                 document.querySelectorAll('#arm .ghosts .solid').length > 10, first.querySelector('strong').textContent, \
                 document.getElementById('q2-value').value === field.value.split(' ')[1], \
                 [...document.querySelectorAll('#arm .marks text')].map((text) => text.textContent)]; }})()"
    ));
    let words =
        "row 5 (joint5): alpha is -pi/2, should be pi/2 (the other sign, or 180° more, which is the same); remaining difference ";
    assert!(first[4].as_str().is_some_and(|text| text.starts_with(words)), "{first}");
    let marks = serde_json::json!(["measured, pose 1", "the arm with this mistake mended"]);
    assert_eq!(first, serde_json::json!(["5", "alpha-sign", true, true, first[4], true, marks]));
    assert_eq!(tab.run("document.getElementById('measured-said').lastChild.textContent"), "This one explains them:");
    // Of one position without orientation several mistakes come equally near, and it is said what would tell them apart.
    let alone = tab.run(
        "(() => { const field = document.getElementById('measured'); \
         field.value = field.value.split('\\n')[0].split(' ').slice(0, 9).join(' '); field.dispatchEvent(new Event('input')); \
         return [document.querySelectorAll('#suspects li strong').length > 1, \
                 document.getElementById('measured-said').textContent.includes('Positions alone'), \
                 document.querySelectorAll('#arm .marks text').length]; })()",
    );
    assert_eq!(alone, serde_json::json!([true, true, 0]));
    // With the wrist stretched the arm is singular whatever the other joints do, and the map says so instead of drawing noise.
    let drawn = tab.run(
        "(async () => { document.getElementById('zero').click(); const map = document.getElementById('w-map'), said = () => document.getElementById('w-said').textContent; \
         map.open = true; await new Promise((done) => setTimeout(done, 100)); const named = said().startsWith('Across: q3') && !map.querySelector('.map').hidden; \
         const across = document.getElementById('w-first'); across.value = '1'; document.getElementById('w-second').value = '2'; across.dispatchEvent(new Event('input')); \
         const stretched = named && said().includes('singular whatever') && map.querySelector('.map').hidden; map.open = false; \
         const q5 = document.getElementById('q5'); q5.value = '1'; q5.dispatchEvent(new Event('input', { bubbles: true })); \
         for (const id of ['show-points', 'show-velocity', 'show-force', 'show-bodies']) document.getElementById(id).click(); \
         for (const id of ['reach', 'w-map']) document.getElementById(id).open = true; await new Promise((done) => setTimeout(done, 300)); \
         return [document.querySelectorAll('#arm .ellipsoids ellipse').length, document.querySelectorAll('#reach svg').length, \
                 said().includes('a factor of det J changes its sign'), stretched, document.getElementById('w-across').textContent, \
                 document.querySelector('#reach text').textContent.startsWith('distance: to ')]; })()",
    );
    assert_eq!(drawn, serde_json::json!([2, 2, true, true, "−3.14159q2 joint2, rad3.14159", true]));
    tab.close();
}

/// The other postures of a pose are listed, drawn as ghosts, and taken by their buttons; the joint of a redundant arm is held.
#[test]
fn other_postures_at_a_pose_are_ghosts() {
    // The number of postures, how many ghosts beside the arm, how far the end effector moves when the second posture is taken, and the joint
    // that is held then.
    for (name, postures) in [("scara", 2), ("puma560", 8), ("panda7", 4)] {
        let Some(mut tab) = opened(&robot(name), 1600, "light") else { return };
        let found = tab.run(&format!(
            "(async () => {{ {MOVE}(1); const details = document.getElementById('postures'); details.open = true; \
             while (!document.getElementById('postures-said').textContent) await new Promise((done) => setTimeout(done, 20)); \
             const arm = document.querySelectorAll('#arm .links .solid').length; \
             const end = () => document.querySelector('#arm g[data-frame=\"e\"]').dataset.origin.split(' ').map(Number); \
             const joints = () => Array.from({{ length: robot.DOF }}, (_, i) => Number(document.getElementById(`q${{i + 1}}-value`).value)); \
             const list = () => [...details.querySelectorAll('tr[data-posture]')]; \
             const [p, q] = [end(), joints()]; const ghosts = document.querySelectorAll('#arm .ghosts .solid').length / arm; \
             list()[1].querySelector('button').click(); \
             const moved = Math.hypot(...end().map((x, i) => x - p[i])); \
             const turned = joints().filter((x, i) => Math.abs(x - q[i]) > 0.01).length > 1; \
             return [list().length, ghosts, moved < 1e-9, turned, list()[1].textContent.includes('shown'), \
                     document.getElementById('postures-held-label').hidden]; }})()"
        ));
        let listed = found[0].as_u64().expect("a number");
        assert!(if name == "panda7" { listed >= postures } else { listed == postures }, "{name}: {found}");
        assert_eq!(found, serde_json::json!([listed, listed - 1, true, true, true, name != "panda7"]), "{name}");
        tab.close();
    }
}

/// A log is played: the arm follows the time line, the tip leaves its trail, plots and figures are there.
#[test]
fn a_log_is_played_on_the_arm() {
    let rows: String = (0..=100)
        .map(|k| {
            let t = f64::from(k) / 10.0;
            format!("{t},{},{},0.1,0,0.01,0,0\n", 0.05 * t, -0.1 * t)
        })
        .collect();
    let csv = format!("t,q_shoulder,q_elbow,q_quill,q_wrist,e_x,e_y,e_z\n{rows}");
    let log = Log::read(&csv, |name| match name {
        "t" => "s".into(),
        name if name.starts_with("q_") => "rad, m".into(),
        _ => "m".into(),
    })
    .expect("a log");
    let run = Run { name: "small".into(), log: Some(log.clone()), ..Run::default() };
    let large = Run { name: "large".into(), log: Some(log), ..Run::default() };
    let file = written_with("logs", &robot("scara"), &[run.clone(), large]);
    let Some(mut tab) = Tab::open(&file, 1600, "light") else { return };
    let played = tab.run(
        "(async () => { const log = document.querySelector('[data-log=\"small\"]'); log.open = true; \
         while (!log.querySelector('.uplot canvas')) await new Promise((done) => setTimeout(done, 5)); \
         const time = document.getElementById('time'); time.value = '5'; time.dispatchEvent(new Event('input')); \
         return [document.getElementById('q2-value').value, document.querySelectorAll('#arm .trail path').length, \
                 [...log.querySelectorAll('.u-title')].map((title) => title.textContent), time.max]; })()",
    );
    // Joints that turn and those that slide have axes of their own.
    let titles = ["joint variables, rad", "joint variables, m", "errors of the end effector, m"];
    assert_eq!(played, serde_json::json!(["-0.5", 2, titles, "10"]));
    // The other run lies over it: two curves more in the plot of the joints, and its trail; taken away again, they are gone.
    let laid = tab.run(
        "(async () => { const log = document.querySelector('[data-log=\"small\"]'), select = log.querySelector('.lay-over select'); \
         const seen = () => [log.querySelectorAll('.uplot .u-series').length, document.querySelectorAll('#arm .trail path').length]; \
         const lay = async (name) => { select.value = name; select.dispatchEvent(new Event('change')); \
             await new Promise((done) => setTimeout(done, 600)); return seen(); }; \
         return [seen(), await lay('large'), await lay('')]; })()",
    );
    assert_eq!(laid, serde_json::json!([[10, 2], [17, 4], [10, 2]]));
    // Meanwhile neither the page nor the time moves, and the arm of the other run stands beside as a ghost while it is laid over.
    let stays = tab.run(
        "(async () => { const log = document.querySelector('[data-log=\"small\"]'), select = log.querySelector('.lay-over select'); \
         select.scrollIntoView({ block: 'center' }); const top = () => select.getBoundingClientRect().top, before = top(); \
         const ghosts = () => document.querySelectorAll('#arm .ghosts .solid').length > 5; const seen = []; \
         for (const name of ['large', '']) { select.value = name; select.dispatchEvent(new Event('change')); \
             await new Promise((done) => setTimeout(done, 600)); \
             seen.push(document.getElementById('time').value, document.getElementById('q2-value').value, ghosts(), Math.abs(top() - before) < 2); } \
         return seen; })()",
    );
    assert_eq!(stays, serde_json::json!(["5", "-0.5", true, true, "5", "-0.5", false, true]));
    tab.close();
    let other = robot("ur5");
    let misfit = armgen_page::page(&other, &[run]).expect_err("other joints");
    assert!(misfit.reason.contains("shoulder, elbow") && misfit.reason.contains("the arm's are joint1"), "{misfit:?}");
}

/// An arm without mass has its frames, its Jacobian and nothing of the dynamics.
#[test]
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

/// Texts of files that would be markup are texts, and nothing of them runs, with the policy removed as well.
#[test]
fn hostile_texts_are_inert() {
    let folder = driver::folder("hostile");
    let hostile = "</script><script>hacked=1</script><img src=x onerror=hacked=1>\"'\u{2028}<!--<script>";
    let csv = format!("t,x,{hostile}\n0,1,2\n1,2,3\n");
    let log = Log::read(&csv, |_| hostile.to_owned()).expect("a log");
    let figure =
        String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><script>hacked=1</script></svg>");
    let verdict = Verdict { what: hostile.into(), found: hostile.into(), expected: hostile.into(), met: false };
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

/// Arms of one, twelve and thirty-two joints, the first of them prismatic, in modified rows, with limits.
#[test]
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

/// Chooses an entry of the inertia matrix, and all of them again.
const CHOOSE_ENTRY: &str = r#"(async () => {
    const details = document.querySelector("details[data-equation=inertia_matrix]");
    details.open = true;
    while (!details.querySelector("select")) await new Promise((done) => setTimeout(done, 5));
    const select = details.querySelector("select");
    const lines = async () => {
        do await new Promise((done) => setTimeout(done, 50)); while (details.querySelector("[aria-busy=true]"));
        return [...details.querySelectorAll(".lines > div")];
    };
    const before = (await lines()).length;
    select.value = [...select.options].find((option) => option.textContent === "b12").value;
    select.dispatchEvent(new Event("change"));
    const [first, ...steps] = await lines();
    const named = new Set([...details.querySelectorAll("[data-step]")].map((step) => step.dataset.step));
    const there = new Set(steps.map((line) => line.querySelector("[data-step]").dataset.step));
    select.value = "";
    select.dispatchEvent(new Event("change"));
    const missing = [...named].filter((step) => !there.has(step));
    const number = document.querySelector('[data-quantity=inertia_matrix][data-row="1"][data-column="2"]').dataset.value;
    const beside = first.querySelector("[data-number]").dataset.value === number;
    return [first.dataset.entry, steps.length + 1 < before, missing, (await lines()).length === before, beside];
})()"#;
