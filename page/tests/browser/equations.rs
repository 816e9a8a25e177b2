//! Equations: the page sets them when their section opens, with their numbers, and all of them when printing.

use super::pages::{opened, robot};

/// Every section of equations opens, with numbers and with names, and never has more nodes than the limit for a layout.
#[test]
#[ignore = "wide"]
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
            // An entry appears before its steps, which are fewer than all steps; no named step is missing.
            let chosen = tab.run(CHOOSE_ENTRY);
            assert_eq!(chosen, serde_json::json!(["1,2", true, [], true, true]));
            assert_eq!(tab.run(KEEP_ENTRY), serde_json::json!(["b12", "1,2", true, true]));
            // Operators are centred between their operands, also where a line may break.
            assert_eq!(tab.run(OPERATORS), serde_json::json!([true, true]));
        }
        // The page offers names where parameters have them.
        let offered = tab.run("(() => { const names = document.querySelector('input[value=symbolic]'); return [names.disabled, names.parentElement.title !== '']; })()");
        assert_eq!(
            offered,
            if name == "ur5" { serde_json::json!([true, true]) } else { serde_json::json!([false, false]) },
            "{name}"
        );
        tab.close();
    }
}

/// In print, an open section shows all lines, including those behind a button; afterwards its earlier state returns.
#[test]
#[ignore = "wide"]
fn all_lines_of_an_open_section_are_printed() {
    let Some(mut tab) = opened(&robot("panda7"), 1600, "light") else { return };
    let before = tab.run(
        "(async () => { const details = document.querySelector('[data-equation=inertia_matrix]'); details.open = true; \
         globalThis.lines = () => details.querySelectorAll('.lines > div').length; \
         do await new Promise((done) => setTimeout(done, 20)); while (!lines() || details.querySelector('[aria-busy=true]')); \
         addEventListener('beforeprint', () => { globalThis.printed = [lines(), [...details.querySelectorAll('[data-number]')].every((number) => number.textContent)]; }); \
         return [lines(), details.querySelector('.lines + .controls button').textContent]; })()",
    );
    let all: usize =
        before[1].as_str().and_then(|text| text.split(' ').nth(4)).expect("a number of lines").parse().expect("a number");
    assert!(before[0].as_u64().is_some_and(|lines| (lines as usize) < all), "{before}");
    assert!(tab.print() > 10_000);
    assert_eq!(tab.run("printed"), serde_json::json!([all, true]));
    assert_eq!(tab.run("lines()"), before[0]);
    tab.close();
}

/// In every posture, an entry in an open section shows the same number as the table. The picture reports a singular posture,
/// and the buttons next to the factors move the arm there.
#[test]
#[ignore = "wide"]
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

/// Chooses a form of the equations, waits, and evaluates an expression.
fn choose(name: &str, value: &str, then: &str) -> String {
    format!(
        "(async () => {{ document.querySelector('input[name=\"{name}\"][value=\"{value}\"]').click(); \
         await new Promise((done) => setTimeout(done, 100)); return {then}; }})()"
    )
}

/// A chosen entry survives a change of the form.
const KEEP_ENTRY: &str = r#"(async () => {
    const details = document.querySelector("details[data-equation=inertia_matrix]");
    const ready = async () => {
        do await new Promise((done) => setTimeout(done, 50)); while (!details.querySelector("select") || details.querySelector("[aria-busy=true]"));
    };
    const select = () => details.querySelector("select");
    const lines = () => details.querySelectorAll(".lines > div").length;
    await ready();
    const all = lines();
    select().value = "1,2";
    select().dispatchEvent(new Event("change"));
    await ready();
    document.querySelector("input[value=exact]").click();
    await ready();
    const seen = [select().selectedOptions[0].textContent, details.querySelector(".lines > div").dataset.entry, lines() < all];
    document.querySelector("input[value=decimal]").click();
    await ready();
    seen.push(select().value === "1,2");
    return seen;
})()"#;

/// The spaces around operators at the start of a line's part, in em: nearly equal, and both positive.
const OPERATORS: &str = r#"(() => {
    const signs = [...document.querySelectorAll(".lines > div > math + math > mrow > mo:first-child")].filter((sign) => sign.getClientRects().length > 0);
    const box = (element) => element.getBoundingClientRect();
    const gaps = signs.flatMap((sign) => {
        const [before, after] = [sign.closest("math").previousElementSibling, sign.nextElementSibling];
        if (box(before).top > box(sign).bottom || box(before).right > box(sign).left + 1) return [];
        const size = parseFloat(getComputedStyle(sign).fontSize);
        // The box of an operator has its spaces.
        const text = document.createRange();
        text.selectNodeContents(sign);
        const ink = text.getBoundingClientRect();
        return [[(ink.left - box(before).right) / size, (box(after).left - ink.right) / size]];
    });
    return [gaps.length > 5, gaps.every(([before, after]) => before > 0.15 && after > 0.15 && Math.abs(before - after) < 0.1)];
})()"#;

/// Chooses an entry of the inertia matrix, and then all entries again.
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
