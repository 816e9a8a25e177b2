//! Logs: playback on the arm, and comparison of two runs.

use armgen_page::{Log, Run};

use super::driver::{self, Tab};
use super::pages::{robot, written_with};

/// During playback the arm follows the time line, the tip leaves its trail, and plots and figures appear.
#[test]
#[ignore = "wide"]
fn a_log_is_played_on_the_arm() {
    if driver::program().is_none() {
        return;
    }
    let run = |name: &str, rate: f64| {
        let row = |k| {
            let t = f64::from(k) / 10.0;
            format!("{t},{},{},0.1,0,0.01,0,0\n", rate * t, -0.1 * t)
        };
        let csv = format!("t,q_shoulder,q_elbow,q_quill,q_wrist,e_x,e_y,e_z\n{}", (0..=100).map(row).collect::<String>());
        let unit = |name: &str| match name {
            "t" => "s".into(),
            name if name.starts_with("q_") => "rad, m".into(),
            _ => "m".into(),
        };
        Run { name: name.into(), log: Some(Log::read(&csv, unit).expect("a log")), ..Run::default() }
    };
    let (small, large, same) = (run("small", 0.05), run("large", 0.07), run("same", 0.05));
    let file = written_with("logs", &robot("scara"), &[small.clone(), large, same]);
    let Some(mut tab) = Tab::open(&file, 1600, "light") else { return };
    let played = tab.run(
        "(async () => { const log = document.querySelector('[data-log=\"small\"]'), play = document.getElementById('log-play'); \
         const seen = [play.disabled]; log.open = true; \
         while (!log.querySelector('.uplot canvas')) await new Promise((done) => setTimeout(done, 5)); \
         const time = document.getElementById('time'); time.value = '5'; time.dispatchEvent(new Event('input')); \
         for (const key of ['ArrowRight', 'ArrowLeft', 'ArrowLeft']) { \
             seen.push(time.dispatchEvent(new KeyboardEvent('keydown', { key, cancelable: true })), document.getElementById('time-value').value); } \
         time.value = '5'; time.dispatchEvent(new Event('input')); \
         seen.push(play.disabled, document.getElementById('followed').textContent); \
         return [seen, document.getElementById('q2-value').value, document.querySelectorAll('#arm .trail path').length, \
                 [...log.querySelectorAll('.u-title')].map((title) => title.textContent), time.max]; })()",
    );
    // Revolute and prismatic joints have separate axes.
    let titles = ["joint variables, rad", "joint variables, m", "errors of the end effector, desired − actual, m"];
    let rates = "Rates are not in the log of small: q̇ and q̈ are those of the fields here, 0 unless others were typed, and C, τ and T are not the run's.";
    let seen = serde_json::json!([true, false, "5.1", false, "5", false, "4.9", false, rates]);
    assert_eq!(played, serde_json::json!([seen, "-0.5", 2, titles, "10"]));
    // The other run adds two curves to the plot of the joints, and its trail; its removal removes them.
    let laid = tab.run(
        "(async () => { const log = document.querySelector('[data-log=\"small\"]'), select = log.querySelector('.lay-over select'); \
         const seen = () => [log.querySelectorAll('.uplot .u-series').length, document.querySelectorAll('#arm .trail path').length]; \
         const lay = async (name) => { select.value = name; select.dispatchEvent(new Event('change')); \
             await new Promise((done) => setTimeout(done, 600)); return seen(); }; \
         return [seen(), await lay('large'), await lay('')]; })()",
    );
    assert_eq!(laid, serde_json::json!([[10, 2], [17, 4], [10, 2]]));
    // Meanwhile neither the page nor the time moves, and the other run's arm appears as a ghost.
    let stays = tab.run(
        "(async () => { const log = document.querySelector('[data-log=\"small\"]'), select = log.querySelector('.lay-over select'); \
         select.scrollIntoView({ block: 'center' }); const top = () => select.getBoundingClientRect().top, before = top(); \
         const ghosts = () => document.querySelectorAll('#arm .ghosts .solid').length > 5; const seen = []; \
         for (const name of ['large', '']) { select.value = name; select.dispatchEvent(new Event('change')); \
             await new Promise((done) => setTimeout(done, 600)); \
             seen.push(document.getElementById('time').value, document.getElementById('q2-value').value, ghosts(), Math.abs(top() - before) < 2); } \
         return seen; })()",
    );
    // Arm and trail of the other run have other colours than those of this run, with enough contrast to the picture.
    let contrast = tab.run(
        "(async () => { const select = document.querySelector('.lay-over select'), seen = []; select.value = 'large'; \
         select.dispatchEvent(new Event('change')); await new Promise((done) => setTimeout(done, 600)); \
         const light = (colour) => colour.match(/[\\d.]+/g).slice(0, 3).map((c) => Number(c) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)) \
             .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0); \
         const stroke = (selector) => getComputedStyle(document.querySelector(selector)).stroke; \
         for (let theme = 0; theme < 2; theme++) { const ground = light(getComputedStyle(document.getElementById('arm')).backgroundColor); \
             for (const selector of ['#arm .ghost.other.body, #arm .ghost.other > .body', '#arm .trail .other']) { \
                 const [a, b] = [light(stroke(selector)), ground].sort((a, b) => b - a); \
                 seen.push((a + 0.05) / (b + 0.05) > 4.5 && stroke(selector) !== stroke('#arm .trail .actual:not(.other)')); } \
             document.getElementById('theme').click(); } \
         select.value = ''; select.dispatchEvent(new Event('change')); return seen; })()",
    );
    assert_eq!(contrast, serde_json::json!([true, true, true, true]));
    assert_eq!(stays, serde_json::json!(["5", "-0.5", true, true, "5", "-0.5", false, true]));
    // A ghost in the same posture would only change the colours of this arm.
    let hidden = "(async () => { const select = document.querySelector('.lay-over select'), seen = []; \
                  for (const name of ['same', 'large', '']) { select.value = name; select.dispatchEvent(new Event('change')); \
                      await new Promise((done) => setTimeout(done, 600)); seen.push(document.querySelectorAll('#arm .ghosts .solid').length > 5); } return seen; })()";
    assert_eq!(tab.run(hidden), serde_json::json!([false, true, false]));
    // Between two samples the whole page shows the earlier sample. Legend and cursor follow a later change of the theme.
    // The time line names its run, and a link's target appears below it.
    let one = tab.run(
        "(async () => { const log = document.querySelector('[data-log=\"small\"]'), time = document.getElementById('time'); \
         time.value = '4.2938'; time.dispatchEvent(new Event('input')); await new Promise((done) => setTimeout(done, 100)); \
         const times = [...log.querySelectorAll('.u-legend .u-series:first-child .u-value'), document.getElementById('time-value')].map((one) => one.value ? `${one.value} s` : one.textContent); \
         const colours = () => [log.querySelector('.u-cursor-pt'), log.querySelectorAll('.u-marker')[1]].map((one) => getComputedStyle(one).borderTopColor); \
         const before = colours(); document.getElementById('theme').click(); const after = colours(); document.getElementById('theme').click(); \
         const lines = [...log.querySelectorAll('.u-cursor-y')].filter((line) => line.checkVisibility()).length; \
         const summary = log.querySelector('summary'); summary.scrollIntoView(); await new Promise((done) => setTimeout(done, 50)); \
         const below = summary.getBoundingClientRect().top >= document.getElementById('playback').getBoundingClientRect().bottom - 1; \
         return [[...new Set(times)], before.every((colour, k) => colour !== after[k]), new Set([...before, ...after]).size, lines, below, \
                 document.getElementById('time-of').textContent, document.getElementById('q2-value').value]; })()",
    );
    assert_eq!(one, serde_json::json!([["4.2 s"], true, 2, 0, true, "small, time", "-0.42"]));
    // A click into a plot jumps to its time and stays there, also during playback.
    let state = "[document.getElementById('log-play').textContent, document.getElementById('time-value').value, document.getElementById('q2-value').value]";
    let playing = tab.run(
        "(async () => { const time = document.getElementById('time'), play = document.getElementById('log-play'); time.value = '0'; time.dispatchEvent(new Event('input')); \
         play.click(); await new Promise((done) => setTimeout(done, 200)); return [play.textContent, Number(time.value) > 0]; })()",
    );
    assert_eq!(playing, serde_json::json!(["pause", true]));
    tab.click_for("[data-log=small] .u-over", 200);
    assert_eq!(tab.run(state), serde_json::json!(["play", "5", "-0.5"]));
    // A typed time is clamped to the run; any other text is discarded.
    let typed = tab.run(
        "(() => { const value = document.getElementById('time-value'), q2 = document.getElementById('q2-value'); \
         return ['3', '99', 'x'].map((text) => { value.value = text; value.dispatchEvent(new Event('change')); return [value.value, q2.value]; }); })()",
    );
    assert_eq!(typed, serde_json::json!([["3", "-0.3"], ["10", "-1"], ["10", "-1"]]));
    tab.close();
    let other = robot("ur5");
    let misfit = armgen_page::page(&other, &[small]).expect_err("other joints");
    assert!(misfit.reason.contains("shoulder, elbow") && misfit.reason.contains("the arm's are joint1"), "{misfit:?}");
}
