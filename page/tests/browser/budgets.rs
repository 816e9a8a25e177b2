//! Costs of a page: sizes, and times in a browser.

use super::driver::Tab;
use super::pages::{long, robot, written};

/// The table of benches/results/page.csv: `cargo test -p armgen-page --test all -- --ignored --nocapture table_of_budgets`.
#[test]
#[ignore = "full: measures times: alone, on a machine that does nothing else"]
fn table_of_budgets() {
    println!("| robot | page, kB | drawn after, ms | slider, ms | slowest section of equations, ms | longest standstill, ms |\n|---|---|---|---|---|---|");
    let named = ["scara", "puma560", "ur5", "panda7", "everything"].map(robot);
    for source in named.into_iter().chain([long(32)]) {
        let name = source.name().trim_end_matches(".yaml");
        let file = written(&source);
        let size = std::fs::metadata(&file).expect("a file").len() / 1000;
        let mut ready: Vec<f64> = Vec::new();
        let (mut slider, mut section) = (0.0, String::new());
        for k in 0..5 {
            let Some(mut tab) = Tab::open(&file, 1600, "light") else { return };
            let text = tab.run("document.documentElement.dataset.ready");
            ready.push(text.as_str().expect("a text").parse().expect("ms"));
            if k == 4 {
                slider = tab.run(SLIDE).as_f64().expect("ms");
                section = tab.run(SLOWEST).as_str().expect("a text").to_owned();
            }
            tab.close();
        }
        ready.sort_by(f64::total_cmp);
        println!("| {name} | {size} | {:.0} | {slider:.1} | {section} |", ready[2]);
    }
}

/// The median script time per slider movement.
const SLIDE: &str = r#"(() => {
    const times = [];
    for (let k = 0; k < 41; k++) {
        const q = document.getElementById("q1");
        q.value = String(Number(q.min) + (k / 41) * (Number(q.max) - Number(q.min)));
        const begin = performance.now();
        q.dispatchEvent(new Event("input"));
        times.push(performance.now() - begin);
    }
    return times.sort((a, b) => a - b)[20];
})()"#;

/// The longest time from opening a section of equations to the layout of its first lines;
/// and the longest gap between two frames while the page sets a section.
const SLOWEST: &str = r#"(async () => {
    let [slowest, name, still, which] = [0, "", 0, ""];
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    for (const details of document.querySelectorAll("details[data-equation]")) {
        await frame();
        let begin = performance.now();
        details.open = true;
        while (!details.querySelector("math")) await new Promise((done) => setTimeout(done, 0));
        details.getBoundingClientRect();
        const time = performance.now() - begin;
        if (time > slowest) [slowest, name] = [time, details.dataset.equation];
        do {
            await frame();
            const gap = performance.now() - begin;
            if (gap > still) [still, which] = [gap, details.dataset.equation];
            begin = performance.now();
        } while (details.querySelector("[aria-busy=true]"));
        details.open = false;
        details.querySelector("div").replaceChildren();
    }
    return `${Math.round(slowest)} (${name}) | ${Math.round(still)} (${which})`;
})()"#;
