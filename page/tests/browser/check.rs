//! The check against the real arm, and the other postures for a pose.

use armgen_codegen::source::Source;

use super::pages::{opened, robot};
use super::MOVE;

/// For poses of the true arm and a description with a wrong value, the row of that value is the first suspect, with a ghost to draw.
#[test]
#[ignore = "wide"]
fn a_planted_mistake_is_the_first_suspect() {
    let truth = robot("ur5");
    let Some(mut tab) = opened(&truth, 1600, "light") else { return };
    let poses = tab.run(&format!(
        "{MOVE}(1); document.getElementById('measured-add').click(); {MOVE}(2); document.getElementById('measured-add').click(); \
         document.getElementById('measured').value"
    ));
    assert_eq!(tab.run("document.querySelectorAll('#suspects li').length"), 0, "the true arm agrees");
    // The check does not search for a wrong length, so it shows the vector and names no suspect. It asks about other units, and a
    // button takes the same numbers in them.
    let others = tab.run(
        "(() => { const field = document.getElementById('measured'), said = () => document.getElementById('measured-said'), seen = []; \
         const lines = field.value.trim().split('\\n').map((line) => line.split(' ').map(Number)); \
         const put = (change) => { field.value = lines.map((line) => line.map(change).slice(0, 9).join(' ')).join('\\n'); field.dispatchEvent(new Event('input')); \
             seen.push([...said().children].slice(2).map((line) => line.textContent)); }; \
         put((x, i) => (i === 8 ? x + 0.05 : x)); seen.push(document.querySelectorAll('#suspects li').length); \
         put((x, i) => (i > 5 ? x * 1000 : x)); const text = field.value; said().querySelector('button').click(); \
         seen.push(field.value === text, said().lastChild.textContent, document.getElementById('length-unit').textContent); return seen; })()",
    );
    let none =
        "No single mistake that is looked for explains the differences. Lengths that are wrong by any amount are not looked for.";
    let vector = "All positions differ by about (0, 0, 0.05) m: a length along that direction, the base or the tool.";
    assert_eq!(others[0], serde_json::json!([none, vector]));
    let asked = others[2][0].as_str().expect("a question");
    assert!(asked.contains("times as far away as the arm is long: are these mm? Units: m, rad,"), "{others}");
    assert_eq!(others[2].as_array().map(Vec::len), Some(1), "{others}");
    let agrees = "The arm of the page agrees with what was measured.";
    assert_eq!(
        serde_json::json!([others[1], others[3], others[4], others[5]]),
        serde_json::json!([0, true, agrees, "lengths: mm"])
    );
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
    let marks = serde_json::json!(["measured, pose 1", "mistake mended"]);
    assert_eq!(first, serde_json::json!(["5", "alpha-sign", true, true, first[4], true, marks]));
    assert_eq!(tab.run("document.getElementById('measured-said').lastChild.textContent"), "This one explains them:");
    // For a single position without orientation, several mistakes fit equally well; the page explains how to distinguish them.
    let alone = tab.run(
        "(() => { const field = document.getElementById('measured'); \
         field.value = field.value.split('\\n')[0].split(' ').slice(0, 9).join(' '); field.dispatchEvent(new Event('input')); \
         return [document.querySelectorAll('#suspects li strong').length > 1, \
                 document.getElementById('measured-said').textContent.includes('Positions alone'), \
                 document.querySelectorAll('#arm .marks text').length]; })()",
    );
    assert_eq!(alone, serde_json::json!([true, true, 0]));
    // With the wrist stretched the arm is singular in every posture of the other joints; the map reports it instead of drawing noise.
    let drawn = tab.run(
        "(async () => { document.getElementById('zero').click(); const map = document.getElementById('w-map'), said = () => document.getElementById('w-said').textContent; \
         map.open = true; await new Promise((done) => setTimeout(done, 100)); const named = said().startsWith('The slice of all postures at q₁ = 0 rad, q₂ = 0 rad, q₄ = 0 rad, q₆ = 0 rad. Across: q₃') && !map.querySelector('.map').hidden; \
         const across = document.getElementById('w-first'); across.value = '1'; document.getElementById('w-second').value = '2'; across.dispatchEvent(new Event('input')); \
         const stretched = named && said().includes('singular whatever') && map.querySelector('.map').hidden; map.open = false; \
         const q5 = document.getElementById('q5'); q5.value = '1'; q5.dispatchEvent(new Event('input', { bubbles: true })); \
         for (const id of ['show-points', 'show-velocity', 'show-force', 'show-bodies']) document.getElementById(id).click(); \
         for (const id of ['reach', 'w-map']) document.getElementById(id).open = true; await new Promise((done) => setTimeout(done, 300)); \
         return [document.querySelectorAll('#arm .ellipsoids ellipse').length, document.querySelectorAll('#reach svg').length, \
                 /\\(dark\\) to [\\d.]+ m³ \\(bright\\).* a factor of det J changes its sign/.test(said()), stretched, document.getElementById('w-across').textContent, \
                 document.querySelector('#reach text').textContent === 'distance']; })()",
    );
    assert_eq!(drawn, serde_json::json!([2, 2, true, true, "−3.14159q₂ joint2, rad3.14159", true]));
    tab.close();
}

/// The page lists the other postures for a pose and draws them as ghosts; buttons apply them. A redundant arm keeps one joint fixed.
#[test]
#[ignore = "wide"]
fn other_postures_at_a_pose_are_ghosts() {
    // The number of postures; the number of ghosts; the end effector's motion when the second posture is applied; and the fixed joint.
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
