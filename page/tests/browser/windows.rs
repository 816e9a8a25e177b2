//! Windows of all widths, both themes and print: clipping, visibility and accessibility.

use armgen_page::{Log, Run, Verdict};

use super::driver::{self, Tab};
use super::pages::{opened, robot, written, written_with};
use super::MOVE;

/// In the widest and the narrowest window, both themes, and print there are no messages and nothing overflows.
#[test]
#[ignore = "wide"]
fn pages_fit_windows_themes_and_paper() {
    for source in [robot("scara"), robot("panda7"), robot("everything")] {
        for (width, theme) in [(360, "dark"), (1600, "light"), (1360, "dark"), (810, "dark"), (800, "light")] {
            let Some(mut tab) = opened(&source, width, theme) else { return };
            let overflow = tab.run("document.documentElement.scrollWidth - innerWidth");
            assert!(overflow.as_f64().is_some_and(|by| by <= 0.0), "{}: {width} px: {overflow} px too wide", source.name());
            let cut = "const pane = document.getElementById('arm-pane'); pane.scrollWidth - pane.clientWidth";
            assert_eq!(tab.run(cut), 0, "{}: {width} px: the sliders are cut off", source.name());
            let units = "[...document.querySelectorAll('#sliders .rate .unit')].every((unit) => unit.checkVisibility())";
            assert_eq!(tab.run(units), true, "{}: {width} px: units of rates", source.name());
            // Six digits for seven joints fit if the box is wide enough at all.
            let scrolled = tab.run(&format!("{MOVE}(1); {CUT}"));
            assert_eq!(scrolled, 0, "{}: {width} px: {scrolled} px of B are cut off", source.name());
            // A warning at a row ends before the fading edge.
            let whole = tab.run(
                "[...document.querySelectorAll('#sheet .said .warning')].every((one) => \
                 one.getBoundingClientRect().right <= one.closest('.scroll').getBoundingClientRect().right - 35)",
            );
            assert_eq!(whole, true, "{}: {width} px: a warning fades", source.name());
            keep(&format!("{}-{width}-{theme}.png.base64", source.name()), &mut tab);
            assert!(tab.print() > 10_000);
            tab.close();
        }
    }
    // These formulas are wider than a narrow window.
    for source in [robot("ur5"), robot("puma560")] {
        let Some(mut tab) = opened(&source, 360, "light") else { return };
        let overflow = tab.run("document.scrollingElement.scrollWidth - innerWidth");
        assert!(overflow.as_f64().is_some_and(|by| by <= 0.0), "{}: 360 px: {overflow} px too wide", source.name());
        keep(&format!("{}-360-light.png.base64", source.name()), &mut tab);
        tab.close();
    }
}

/// The clipped width of the inertia matrix, in a box wider than 640 px.
const CUT: &str = "(() => { const box = document.querySelector('#number-inertia_matrix .scroll'); \
                   return box.clientWidth <= 640 ? 0 : box.scrollWidth - box.clientWidth; })()";

/// Opens all folded content of a page.
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

/// In both themes and in a narrow window, every control, picture and table has a name, and every heading of a table has a scope.
/// References have targets, and text has a contrast of at least 4.5 to 1. The Tab key reaches all controls in order, with visible focus.
#[test]
#[ignore = "wide"]
fn everybody_can_read_and_use_a_page() {
    if driver::program().is_none() {
        return;
    }
    let log =
        Log::read("t,q_shoulder,q_elbow,q_quill,q_wrist,other\n0,0,0,0,0,1\n1,1,1,0,0,2\n", |_| "rad".into()).expect("a log");
    let verdict = |met| Verdict {
        what: "w".into(),
        name: "w".into(),
        meaning: "manipulability".into(),
        found: "1".into(),
        expected: "2".into(),
        met,
    };
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
        let found = tab.run(include_str!("audit.js"));
        assert_eq!(found["faults"], serde_json::json!([]), "{}, {theme}", file.display());
        assert!(found["texts"].as_u64().is_some_and(|texts| texts > 300), "{found}");
        println!("{}, {theme}: {} texts, the least contrast is {}", file.display(), found["texts"], found["least"]);
        tab.close();
    }
    let Some(mut tab) = Tab::open(&file, 1600, "light") else { return };
    tab.run(UNFOLD);
    let controls = tab.run(include_str!("keyboard.js")).as_u64().expect("a number");
    for _ in 0..controls {
        tab.press_tab();
    }
    let astray = "visited.filter(([k], i) => k !== i).slice(0, 3).map(([k, seen, text]) => [k, text])";
    assert_eq!(tab.run(astray), serde_json::json!([]), "in the order of the document");
    let missed = "wanted.filter((_, i) => !visited.some(([k, seen]) => k === i && seen)).map((element) => element.outerHTML.slice(0, 100))";
    assert_eq!(tab.run(missed), serde_json::json!([]));
    // A switch hides a curve and shows it again.
    let switched = "(() => { const one = document.querySelector('[role=switch]'), seen = []; \
                    for (let k = 0; k < 2; k++) { one.dispatchEvent(new KeyboardEvent('keydown', { key: ' ', bubbles: true })); \
                    seen.push(one.getAttribute('aria-checked'), one.closest('.u-series').classList.contains('u-off')); } return seen; })()";
    assert_eq!(tab.run(switched), serde_json::json!(["false", true, "true", false]));
    println!("{controls} controls are reached by the keyboard");
    tab.close();
}

/// Keeps a screenshot for inspection, if the environment asks for it.
fn keep(name: &str, tab: &mut Tab) {
    if std::env::var_os("ARMGEN_PICTURES").is_some() {
        std::fs::write(driver::folder("windows").join(name), tab.picture()).expect("a picture is written");
    }
}

/// In a narrow window the picture stays in sight while the reader uses a control farther down that acts on it: a run, a row, or a
/// suspect. It covers neither that control nor the time line, and disappears when the control does.
#[test]
#[ignore = "wide"]
fn the_picture_stays_in_sight_of_what_acts_on_it() {
    if driver::program().is_none() {
        return;
    }
    let log = Log::read("t,q_shoulder,q_elbow,q_quill,q_wrist\n0,0,0.1,0,0\n1,1,1,0,0\n", |_| "rad".into()).expect("a log");
    let run = Run { name: "one".into(), log: Some(log), ..Run::default() };
    let file = written_with("narrow-log", &robot("scara"), &[run]);
    let Some(mut tab) = Tab::open(&file, 360, "light") else { return };
    tab.resize(360, 740, 1.0);
    let seen = tab.run(&format!("{IN_SIGHT} {FOLLOWED}"));
    assert_eq!(seen["followed"], serde_json::json!([true, true, true]), "{seen}");
    assert_eq!(seen["away"], false, "{seen}");
    assert_eq!(seen["row"], serde_json::json!([true, true, false]), "{seen}");
    assert_eq!(seen["suspect"], serde_json::json!([true, true, false]), "{seen}");
    assert_eq!(seen["places"], true, "nothing moves where the picture was: {seen}");
    tab.close();
    // In a wide window, the picture next to the content is always in sight.
    let Some(mut tab) = opened(&robot("scara"), 1600, "light") else { return };
    let wide = "document.querySelector('#sheet tr[data-row=\"2\"]').focus(); document.querySelector('.kept') === null";
    assert_eq!(tab.run(wide), true);
    tab.close();
}

const IN_SIGHT: &str = r##"
    const box = (element) => element.getBoundingClientRect();
    const arm = document.getElementById("arm");
    const inSight = () => box(arm).top >= box(document.querySelector("nav")).bottom - 1 && box(arm).bottom < innerHeight / 2;
    const rest = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50)));
    const below = (element) => box(element).top >= box(document.querySelector(".picture")).bottom - 1;
"##;

const FOLLOWED: &str = r##"(async () => {
    const high = () => document.documentElement.scrollHeight;
    const row = document.querySelector('#sheet tr[data-row="4"]');
    row.scrollIntoView();
    await rest();
    const before = high();
    row.focus();
    await rest();
    const focused = [inSight(), below(row)];
    const places = high() === before;
    row.blur();
    await rest();
    focused.push(inSight());
    const field = document.getElementById("measured");
    // The first joint counts the other way.
    const end = robot.directKinematics([0.1, 0.2, 0.3, 0.4]);
    field.value = `-0.1 0.2 0.3 0.4 ${[0, 1, 2].map((i) => end[i][3]).join(" ")}`;
    field.dispatchEvent(new Event("input"));
    const button = document.querySelector("#suspects button");
    button.scrollIntoView();
    button.focus();
    button.click();
    await rest();
    const suspect = [inSight(), below(button)];
    button.click();
    await rest();
    suspect.push(inSight());
    const log = document.querySelector("[data-log]");
    log.open = true;
    while (!log.querySelector(".uplot canvas")) await rest();
    log.querySelector(".plots").scrollIntoView();
    await rest();
    const followed = [inSight(), below(document.getElementById("playback"))];
    document.getElementById("log-play").click();
    await rest();
    followed.push(inSight());
    document.getElementById("log-play").click();
    document.getElementById("cost").scrollIntoView();
    await rest();
    const away = document.querySelector(".kept") !== null;
    return { row: focused, suspect, followed, away, places };
})()"##;

/// The badge of a singular posture takes a single line in a narrow window and covers no part of the arm.
#[test]
#[ignore = "wide"]
fn the_badge_of_a_narrow_window_leaves_the_arm_free() {
    for name in ["scara", "panda7", "ur5"] {
        let Some(mut tab) = opened(&robot(name), 360, "dark") else { return };
        let free = "(() => { const bottom = document.querySelector('#singular-posture a').getBoundingClientRect().bottom; \
                    const solids = [...document.querySelectorAll('#arm .links .solid')].map((solid) => solid.getBoundingClientRect()); \
                    return [bottom - document.getElementById('arm').getBoundingClientRect().top < 45, Math.min(...solids.filter((box) => box.width > 0).map((box) => box.top)) > bottom + 10]; })()";
        assert_eq!(tab.run(free), serde_json::json!([true, true]), "{name}");
        tab.close();
    }
}

/// A hidden or tiny picture is not drawn, because lengths divided by its size would be infinite.
#[test]
#[ignore = "wide"]
fn a_picture_without_a_size_says_nothing() {
    if driver::program().is_none() {
        return;
    }
    let file = written(&robot("ur5"));
    // The single-column window reserves room for the badge from the size of the picture.
    let Some(mut tab) = Tab::open(&file, 360, "light") else { return };
    let drawn = "document.querySelectorAll('#arm .links .solid').length";
    let before = tab.run(drawn);
    for style in ["display: none", "width: 0; height: 0; overflow: hidden", "width: 20px; height: 16px; overflow: hidden", ""] {
        tab.run(&format!(
            "(async () => {{ document.getElementById('picture-place').style.cssText = '{style}'; \
             for (let k = 0; k < 3; k++) await new Promise((done) => requestAnimationFrame(done)); \
             const q = document.getElementById('q2'); q.value = '0.5'; q.dispatchEvent(new Event('input', {{ bubbles: true }})); }})()"
        ));
        let numbers =
            "[...document.querySelectorAll('#arm [x], #arm [d], #arm [x1]')].every((one) => !/NaN|Infinity/.test(one.outerHTML))";
        assert_eq!((tab.run(drawn), tab.run(numbers)), (before.clone(), true.into()), "{style}");
    }
    tab.close();
}
