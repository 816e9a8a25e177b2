//! The data sheet: rows drawn on the arm, units, bodies, and messages about them.

use armgen_codegen::source::Source;
use serde_json::Value;

use super::pages::{opened, robot};
use super::MOVE;

/// The picture draws a focused row as on a data sheet and marks violated limits; keys turn the arm.
#[test]
#[ignore = "wide"]
fn rows_are_drawn_and_limits_marked() {
    let text = robot("scara").text().replacen("    type: revolute\n", "    type: revolute\n    limits: {position: [-1, 1]}\n", 1);
    let source = Source::new("limited.yaml", text);
    let Some(mut tab) = opened(&source, 1600, "light") else { return };
    let texts = "document.querySelector('#sheet tr[data-row=\"1\"]').focus(); \
                 [...document.querySelectorAll('#arm g[data-dimension=\"1\"] text')].map((text) => text.textContent)";
    assert_eq!(tab.run(texts), serde_json::json!(["θ = 0 rad", "d = 1 m", "a = 0.5 m"]));
    assert_eq!(tab.run("document.activeElement.blur(); document.querySelectorAll('#arm g[data-dimension]').length"), 0);
    // A warning about several rows appears at each, with its line.
    let warned = "[...document.querySelectorAll('#sheet [data-warning=\"triangle-inequality\"]')].map((warning) => \
                  [warning.closest('tr').dataset.row, /line \\d+/.exec(warning.textContent)[0]])";
    assert_eq!(tab.run(warned), serde_json::json!([["1", "line 35"], ["2", "line 49"], ["4", "line 77"]]));
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

/// Entries show units if the arm mixes revolute and prismatic joints; bodies show tensors and the linter's messages about them.
/// A tick in the list of layers moves no slider, the tables of frames fit, and the wheel scrolls a narrow window.
#[test]
#[ignore = "wide"]
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
    let wide = "[...document.querySelectorAll('#frames .scroll, #bodies .scroll')].filter((table) => table.scrollWidth > table.clientWidth).length";
    for name in ["everything", "panda7"] {
        let Some(mut tab) = opened(&robot(name), 1600, "light") else { return };
        for unit in ["m", "mm"] {
            assert_eq!(tab.run(&format!("{MOVE}(2); {wide}")), 0, "{name}: a table is cut off, in {unit}");
            tab.run("document.getElementById('length-unit').click()");
        }
        tab.close();
    }
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
    let [large, doubt, massless, said, planar, again] = bodies[..] else { panic!("{bodies:?}") };
    assert!(large.contains("xx 1") && large.contains("6.804·10⁻¹²") && large.ends_with("doubtful: lighter than foam"), "{large}");
    assert!(doubt.contains("radius of gyration of 100 m") && !doubt.contains('`'), "{doubt}");
    assert!(massless.contains("zz 2") && massless.ends_with("no mass"), "{massless}");
    assert!(said.contains("one moment of inertia alone belongs to no solid body"), "{said}");
    assert_eq!(again, said, "what holds for two bodies is said of both");
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
