//! The figures of docs/page.md: `cargo test -p armgen-page --test all -- --ignored figures_of_the_documentation`.

use super::pages::{opened, robot};

/// Row 2 of the SCARA in focus.
const SCARA: &str = r##"(() => {
    for (const [id, value] of [["q1", 0.4], ["q2", 0.9]]) {
        const field = document.getElementById(`${id}-value`);
        field.value = String(value);
        field.dispatchEvent(new Event("input", { bubbles: true }));
    }
    document.querySelector('#sheet tr[data-row="2"]').focus();
})()"##;

/// An entry of the inertia matrix of the Panda, and the ellipsoid at its tip.
const PANDA: &str = r##"(async () => {
    for (const [id, value] of [["q2", -0.6], ["q4", -2.2], ["q6", 1.6]]) {
        const field = document.getElementById(`${id}-value`);
        field.value = String(value);
        field.dispatchEvent(new Event("input", { bubbles: true }));
    }
    document.getElementById("show-velocity").click();
    const details = document.querySelector("details[data-equation=inertia_matrix]");
    details.open = true;
    while (!details.querySelector("select")) await new Promise((done) => setTimeout(done, 20));
    const select = details.querySelector("select");
    select.value = [...select.options].find((option) => option.textContent === "b56").value;
    select.dispatchEvent(new Event("change"));
    do await new Promise((done) => setTimeout(done, 100)); while (details.querySelector("[aria-busy=true]"));
    details.scrollIntoView();
    await new Promise((done) => setTimeout(done, 300));
})()"##;

#[test]
#[ignore = "full: writes the figures of the documentation"]
fn figures_of_the_documentation() {
    for (name, prepare) in [("scara", SCARA), ("panda7", PANDA)] {
        for theme in ["light", "dark"] {
            let Some(mut tab) = opened(&robot(name), 1200, theme) else { return };
            tab.resize(1200, 760, 0.7);
            tab.run(prepare);
            let file = format!("{}/../docs/figures/page-{name}-{theme}.png", env!("CARGO_MANIFEST_DIR"));
            std::fs::write(file, decoded(&tab.picture())).expect("the figure is written");
            tab.close();
        }
    }
}

/// Decodes base64.
fn decoded(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u8> = text.trim_end_matches('=').bytes().map(digit).collect();
    let group = |four: &[u8]| {
        let bits = four.iter().fold(0, |bits, &digit| bits << 6 | u32::from(digit)) << (6 * (4 - four.len()));
        bits.to_be_bytes()[1..four.len()].to_vec()
    };
    digits.chunks(4).flat_map(group).collect()
}
