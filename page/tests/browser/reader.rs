//! Input by a reader and the messages of the page: fields, formulas, singular postures, missing data.

use super::pages::{opened, robot};
use super::MOVE;

/// A click selects the whole field; input counts when it is complete; Escape restores the number. A list pasted into one field sets
/// several joints, in the units of the fields.
#[test]
#[ignore = "wide"]
fn typing_counts_when_it_is_finished() {
    let Some(mut tab) = opened(&robot("scara"), 1600, "light") else { return };
    let held = "[document.getElementById('q1').valueAsNumber, document.getElementById('q1-value').value]";
    tab.run(
        "(() => { const q = document.getElementById('q1-value'); q.value = '-0.7'; q.dispatchEvent(new Event('input')); })()",
    );
    tab.click("#q1-value");
    tab.type_text("1.5");
    assert_eq!(tab.run(held), serde_json::json!([-0.7, "1.5"]), "the arm waits for the whole number");
    tab.press("Enter");
    assert_eq!(tab.run(held), serde_json::json!([1.5, "1.5"]));
    tab.type_text("2");
    tab.press("Escape");
    assert_eq!(tab.run(held), serde_json::json!([1.5, "1.5"]));
    tab.click("#dq1");
    tab.type_text("3");
    tab.click("#q2-value");
    assert_eq!(
        tab.run(
            "[document.getElementById('dq1').value, document.querySelector('[data-quantity=kinetic_energy]').dataset.value > 0]"
        ),
        serde_json::json!(["3", true])
    );
    let pasted = tab.run(
        "(() => { const field = document.getElementById('q2-value'), seen = []; \
         const paste = (text) => { const clipboardData = new DataTransfer(); clipboardData.setData('text/plain', text); \
             const event = new ClipboardEvent('paste', { clipboardData, cancelable: true, bubbles: true }); field.dispatchEvent(event); \
             const fault = document.getElementById('q2-fault'); \
             seen.push([event.defaultPrevented, [1, 2, 3, 4].map((k) => document.getElementById(`q${k}-value`).value), fault.hidden ? '' : fault.textContent]); }; \
         paste('[0.1, -pi/4, 0.3, -0]'); paste('array([0.5, 0.2])'); paste('2*(pi - 1)/3'); paste('1,5'); paste('1,2,3,4,5'); paste('1;2\\n3\\t4'); \
         paste('- 7\\n- 8'); document.getElementById('angle-unit').click(); paste('90 pi/4 0.5 0'); return seen; })()",
    );
    // A list of all joints sets the posture; a shorter list starts at the joint of its field.
    let from_there_on = ["0.1", "0.5", "0.2", "0"];
    let too_many = "5 numbers: a posture has 4, and from q₂ on there are 3 joints";
    let expected = serde_json::json!([
        [true, ["0.1", "-0.7853981633974483", "0.3", "0"], ""],
        [true, from_there_on, ""],
        [false, from_there_on, ""],
        [false, from_there_on, ""],
        [true, from_there_on, too_many],
        [true, ["1", "2", "3", "4"], ""],
        [true, ["1", "7", "8", "4"], ""],
        [true, ["90", "45", "0.5", "0"], ""]
    ]);
    assert_eq!(pasted, expected);
    // Degrees stay as typed, in rates as well. The page names decimal commas, and a typed list counts like a pasted list.
    let typed = tab.run(
        "(() => { const seen = []; const type = (id, text) => { const field = document.getElementById(id), fault = document.getElementById(`${id.match(/q\\d/)[0]}-fault`); \
             field.value = text; for (const kind of ['input', 'change']) field.dispatchEvent(new Event(kind, { bubbles: true })); \
             seen.push([field.value, fault.hidden ? '' : fault.textContent]); }; \
         type('q1-value', '30'); type('dq1', '30'); type('dq1', 'pi/6'); type('ddq1', '1,5'); type('q2-value', '0,1; 0,2'); type('q2-value', '10, 0.2'); \
         seen.push(document.getElementById('q3-value').value, robot.directKinematics([1, 2, 3, 4].map((k) => [30 * Math.PI / 180, 10 * Math.PI / 180, 0.2, 0][k - 1]))[0][3] === \
             Number(document.querySelector('[data-quantity=direct_kinematics][data-row=\"1\"][data-column=\"4\"]').dataset.value)); return seen; })()",
    );
    let commas = |text: &str, points: &str| format!("“{text}” has commas for points: write {points}");
    let expected = serde_json::json!([
        ["30", ""],
        ["30", ""],
        ["30", ""],
        ["1,5", commas("1,5", "1.5")],
        ["0,1; 0,2", commas("0,1; 0,2", "0.1; 0.2")],
        ["10", ""],
        "0.2",
        true
    ]);
    assert_eq!(typed, expected);
    tab.close();
}

/// The page states the ranges it assumed for joints without limits, rescales a picture that has become small, and explains symbols.
/// The choice of names keeps its place on the screen, long equations fold again, the cost table shows whole names, and the print lists
/// the folded sections.
#[test]
#[ignore = "wide"]
fn what_is_left_open_is_said() {
    let Some(mut tab) = opened(&robot("scara"), 360, "light") else { return };
    let seen = tab.run(
        "(async () => { const seen = []; const put = (id, value) => { const field = document.getElementById(id); field.value = value; field.dispatchEvent(new Event('input')); }; \
         const reach = document.getElementById('reach'); reach.open = true; await new Promise((done) => setTimeout(done, 100)); \
         seen.push(reach.querySelector('p').textContent.split('. ').at(-1)); \
         const width = () => document.querySelector('#arm .base').getBoundingClientRect().width; const before = width(); \
         put('q3-value', '50'); const far = width(); put('q3-value', '0'); seen.push([far < before / 5, width() > 0.5 * before]); \
         for (const details of document.querySelectorAll('details[data-equation=inertia_matrix], details[data-equation=regressor], details[data-equation=coriolis_matrix]')) details.open = true; \
         await new Promise((done) => setTimeout(done, 300)); const names = document.querySelector('input[value=symbolic]'); names.scrollIntoView({ block: 'center' }); \
         const top = names.getBoundingClientRect().top; names.click(); await new Promise((done) => setTimeout(done, 300)); \
         seen.push(Math.abs(names.getBoundingClientRect().top - top - document.getElementById('names').hidden) < 2, document.getElementById('names').textContent.includes('ml1 = 20')); \
         seen.push([...document.querySelectorAll('.costs tbody th')].every((th) => th.getClientRects().length === 1 && th.scrollWidth <= th.clientWidth)); \
         const weights = () => [...document.querySelectorAll('.costs td.weight')].map((td) => Number(td.dataset.value)); \
         document.querySelector('.costs thead th:last-child button').click(); seen.push(weights().every((weight, k, all) => k === 0 || weight <= all[k - 1])); \
         const nav = document.querySelector('nav'); scrollTo(0, 5000); seen.push(nav.getBoundingClientRect().top === 0); \
         dispatchEvent(new Event('beforeprint')); seen.push(document.querySelector('#arm-pane > .print-only.small').textContent.startsWith('Not printed, since it was folded in: Data sheet (Motors and friction; Parameters)')); \
         return seen; })()",
    );
    let assumed = "q₁, q₂, q₄ have no limits: a whole turn was taken; q₃ has no limits: −1 m to 1 m was assumed.";
    assert_eq!(seen, serde_json::json!([assumed, [true, true], true, true, true, true, true, true]));
    tab.close();
    let Some(mut tab) = opened(&robot("panda7"), 1600, "light") else { return };
    let folded = tab.run(
        "(async () => { const details = document.querySelector('details[data-equation=inverse_dynamics]'); details.open = true; \
         const ready = async () => { do await new Promise((done) => setTimeout(done, 30)); while (!details.querySelector('.copies') || details.querySelector('[aria-busy=true]')); \
             return details.querySelectorAll('.lines > div').length; }; \
         const button = (word) => [...details.querySelectorAll('button')].find((one) => one.textContent.startsWith(word)); \
         const first = await ready(); if (!button('show').textContent.includes('more')) return 'all at once'; button('show').click(); const more = await ready(); \
         button('show fewer').click(); return [more > first, (await ready()) === first]; })()",
    );
    assert_eq!(folded, serde_json::json!([true, true]));
    // A button opens all folded sections, up to the size that can be printed, and folds them again.
    let all = tab.run(
        "(async () => { const button = document.getElementById('unfold'), seen = []; \
         for (let k = 0; k < 2; k++) { button.click(); while (button.getAttribute('aria-busy') === 'true') await new Promise((done) => setTimeout(done, 30)); \
             const said = document.getElementById('unfold-said').textContent; seen.push(k === 0 ? /^Left closed, .*: .*τ.*, /.test(said) : said === ''); \
             seen.push([button.textContent, document.getElementById('w-map').open, document.querySelectorAll('[data-equation]:not([open])').length > 5, \
                        [...document.querySelectorAll('[data-equation][open]:not([data-equation=inverse_dynamics])')].every((one) => !one.querySelector('.lines + .controls > :not([hidden])'))]); } return seen; })()",
    );
    assert_eq!(all, serde_json::json!([true, ["fold all", true, true, true], true, ["open all", false, true, true]]));
    tab.close();
}

/// The page reports a copy next to its button, and LaTeX has the chosen digits.
#[test]
#[ignore = "wide"]
fn a_copy_is_said_where_it_was_asked_for() {
    let Some(mut tab) = opened(&robot("scara"), 1600, "light") else { return };
    let seen = tab.run(
        "(async () => { const seen = [], texts = []; navigator.clipboard.writeText = async (text) => { texts.push(text); }; \
         const details = document.querySelector('[data-equation=geometric_jacobian]'); details.open = true; \
         const ready = async () => { do await new Promise((done) => setTimeout(done, 20)); while (!details.querySelector('.copies')); }; await ready(); \
         const said = document.getElementById('said'); const press = async (button) => { button.click(); await new Promise((done) => setTimeout(done, 20)); \
             seen.push([said.parentElement === button.parentElement, said.textContent]); }; \
         await press(details.querySelector('.copy')); document.querySelector('input[value=exact]').click(); await ready(); await new Promise((done) => setTimeout(done, 100)); \
         await press(details.querySelector('.copy')); await press(document.querySelector('#number-geometric_jacobian [aria-label$=NumPy]')); \
         await press(document.getElementById('copy-q')); \
         return [seen, texts.slice(0, 2).map((text) => text.includes('0.5'))]; })()",
    );
    let latex = serde_json::json!([true, "geometric_jacobian as LaTeX: copied"]);
    let expected =
        serde_json::json!([[latex, latex, [true, "J as NumPy: copied"], [true, "q in rad and m: copied"]], [true, false]]);
    assert_eq!(seen, expected);
    tab.close();
}

/// No factor follows a sine as if it belonged to its angle, and a small constant has a power of ten. Rates, torques and derivatives
/// have their symbols. Rounding errors appear as 0, but the stored number stays as computed.
#[test]
#[ignore = "wide"]
fn formulas_and_numbers_cannot_be_misread() {
    let Some(mut tab) = opened(&robot("scara"), 1600, "light") else { return };
    let seen = tab.run(
        "(async () => { const seen = []; const text = (name, entry) => document.querySelector(`[data-equation=${name}] [data-entry=\"${entry}\"]`).textContent; \
         for (const name of ['coriolis_matrix', 'friction', 'inverse_dynamics', 'known_torque', 'geometric_jacobian_dot']) { \
             const details = document.querySelector(`details[data-equation=${name}]`); details.open = true; \
             while (!details.querySelector('.copies')) await new Promise((done) => setTimeout(done, 5)); } \
         const entries = [['coriolis_matrix', '1,1'], ['coriolis_matrix', '1,2'], ['friction', '1,1'], ['inverse_dynamics', '4,1'], ['geometric_jacobian_dot', '1,2']]; \
         for (const [name, entry] of entries) seen.push(text(name, entry)); \
         seen.push(document.querySelector('[data-equation=known_torque] math').textContent, document.querySelectorAll('[data-equation=friction] msup').length, \
             document.querySelector('[data-equation=inverse_dynamics_derivatives_by_dq] summary').textContent); \
         document.querySelector('input[value=symbolic]').click(); await new Promise((done) => setTimeout(done, 200)); \
         const index = [...document.querySelectorAll('[data-equation=inverse_dynamics] msub')].find((one) => one.textContent === 'Il1'); \
         seen.push([...index.lastChild.children].map((part) => part.localName + part.textContent)); \
         const low = (sub) => sub.children[1].getBoundingClientRect().bottom - sub.children[0].getBoundingClientRect().bottom > 0.1 * sub.children[0].getBoundingClientRect().height; \
         seen.push([...document.querySelectorAll('[data-equation=inverse_dynamics] msub')].filter((sub) => sub.children[0].localName === 'mi').every(low)); return seen; })()",
    );
    let expected = serde_json::json!([
        "−5q.2sinq2",
        "−5(q.1+q.2)sinq2",
        "5·10−5q.1",
        "τ4=2q.4 −1.02q¨1 −1.02q¨2 +1.4q¨4 = 0",
        "(dJ/dt)12=−0.5(q.1+q.2)cos(q1+q2) ",
        "τknown(q,q.,q.r,q¨r)=",
        2,
        "∂τ/∂q̇ inverse dynamics derivatives by q̇, 4 × 4",
        ["mil", "mn1"],
        true
    ]);
    assert_eq!(seen, expected);
    tab.close();
    let Some(mut tab) = opened(&robot("puma560"), 1600, "light") else { return };
    let noise = tab.run(&format!(
        "(() => {{ {MOVE}(1); for (const q of document.querySelectorAll('input[id$=-value]')) {{ q.value = 'pi/2'; q.dispatchEvent(new Event('input')); }} \
         const entries = [...document.querySelectorAll('td[data-quantity]')]; \
         const small = entries.filter((entry) => Math.abs(Number(entry.dataset.value)) < 1e-15 && Number(entry.dataset.value) !== 0); \
         const minus = entries.filter((entry) => entry.textContent === '−0' || entry.textContent === '-0'); \
         return [small.length > 2, small.every((entry) => entry.textContent === '0'), minus.length, \
                 entries.filter((entry) => entry.textContent === '0').length < entries.length / 2]; }})()"
    ));
    assert_eq!(noise, serde_json::json!([true, true, 0, true]));
    tab.close();
}

/// For a singular posture the page describes the motion of the axes, in the plural if several factors are zero. The line of the lost
/// motion and its label appear in every view, and cover neither a frame's name nor the badge.
#[test]
#[ignore = "wide"]
fn a_singular_posture_says_why() {
    for (name, why) in [
        ("scara", "Why: the axes of q₁, q₂ and q₄ are parallel and lie in one plane: the arm is stretched or folded."),
        ("ur5", "Why: the axes of q₂, q₃ and q₄ are parallel and lie in one plane: the arm is stretched or folded."),
        ("panda7", "Why: the axes of q₁, q₃ and q₅ lie on one line."),
        ("puma560", "Why: the axes of q₄ and q₆ lie on one line."),
    ] {
        let Some(mut tab) = opened(&robot(name), 1600, "light") else { return };
        let seen = tab.run(
            "(() => { const box = (element) => element.getBoundingClientRect(); \
             const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top; const faults = []; \
             for (const view of ['oblique', 'front', 'side', 'top']) { document.querySelector(`button[data-view=${view}]`).click(); \
                 const arm = box(document.getElementById('arm')); const words = box(document.querySelector('#arm .lost text')); \
                 const line = box(document.querySelector('#arm .lost path')); \
                 const within = (one) => one.left >= arm.left && one.right <= arm.right && one.top >= arm.top && one.bottom <= arm.bottom; \
                 const others = [...document.querySelectorAll('#arm .frame-name, #arm .gravity text, #singular-posture a')].map(box); \
                 const names = [...document.querySelectorAll('#arm .frame-name')].filter((name) => name.textContent).map(box); \
                 if (names.some((name, k) => names.some((other, i) => i < k && !apart(name, other)))) faults.push(`names, ${view}`); \
                 if (!within(line) || !within(words) || others.some((other) => !apart(words, other))) faults.push(view); } \
             const texts = [...document.querySelectorAll('#singular a')].map((link) => document.querySelector(link.hash) !== null); \
             return [document.getElementById('singular-why').textContent, faults, texts.every((there) => there), document.getElementById('singular-posture').textContent]; })()",
        );
        assert_eq!((&seen[0], &seen[1], &seen[2]), (&why.into(), &serde_json::json!([]), &true.into()), "{name}: {seen}");
        if name == "scara" {
            let names =
                "[...document.querySelectorAll('#arm .frame-name')].map((name) => name.textContent).filter((name) => name)";
            tab.run("document.querySelector('button[data-view=front]').click()");
            assert_eq!(tab.run(names), serde_json::json!(["0", "1", "2", "3, 4, e"]));
        }
        if name == "ur5" {
            assert_eq!(seen[3], "⚠ singular posture: factor 1, sin(q₃), and factor 2, sin(q₅), of det J are zero");
        }
        tab.close();
    }
}

/// Fields of joints accept expressions and show six of all the digits they keep. A text that is not a number gets a message and
/// stays, even when another joint moves.
#[test]
#[ignore = "wide"]
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
         slide('q2'); slide('q1'); document.getElementById('angle-unit').click(); \
         for (const text of ['-0.3-0.4', '-0.7']) { put(text); seen.push(fault.hidden || fault.textContent); } return seen; })()",
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
        ["17.188733853924695", true],
        // A term typed after the existing number makes a sum, and the page explains it.
        ["-0.7", "−0.7", "-0.700", false, false],
        "-0.3-0.4 was taken for −0.7",
        ["-0.7", "−0.7", "-0.700", true, false],
        true
    ]);
    assert_eq!(seen, expected);
    let shown = "[...document.querySelectorAll('#sliders .rate .unit')].every((unit) => unit.checkVisibility())";
    assert_eq!(tab.run(shown), true, "units of rates are seen in a narrow window");
    tab.close();
}

/// A refused text disappears with its warning when the joint is set: by the same number, by a posture, directly, or by Escape.
/// Degrees are accepted, and a text that is not a number gets a remedy. The sliders of a wide window have enough space.
#[test]
#[ignore = "wide"]
fn what_sets_a_joint_ends_its_warning() {
    let Some(mut tab) = opened(&robot("scara"), 1600, "light") else { return };
    let seen = tab.run(
        "(async () => { const one = (id) => document.getElementById(id), seen = []; const fire = (id, kind) => one(id).dispatchEvent(new Event(kind, { bubbles: true })); \
         const put = (id, text) => { one(id).value = text; fire(id, 'input'); fire(id, 'change'); }; \
         const held = (k) => [one(`q${k}-value`).value, one(`q${k}-fault`).hidden, one(`q${k}-value`).hasAttribute('aria-invalid')]; \
         const refuse = () => { put('q3-value', '1,5'); if (held(3)[1] || !held(3)[2]) seen.push('not refused'); }; \
         const ways = { list: () => put('q1-value', '0.1 0.2'), zero: () => one('zero').click(), slider: () => fire('q3', 'input'), \
             sweep: () => { one('play').click(); one('play').click(); }, field: () => put('q3-value', one('q3').value), \
             arrows: () => ['ArrowUp', 'ArrowDown'].forEach((key) => one('q3-value').dispatchEvent(new KeyboardEvent('keydown', { key }))), \
             escape: () => one('q3-value').dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' })) }; \
         for (const [name, way] of Object.entries(ways)) { refuse(); way(); seen.push([name, ...held(3)]); } \
         put('q3-value', '0.1+0.2'); seen.push(held(3)[1]); put('q1-value', '1 2'); seen.push(held(3)[1]); \
         refuse(); put('dq3', 'x'); one('zero').click(); seen.push([one('dq3').value, ...held(3)]); return seen; })()",
    );
    let ways =
        ["list", "zero", "slider", "sweep", "field", "arrows", "escape"].map(|way| serde_json::json!([way, "0", true, false]));
    let mut expected = ways.to_vec();
    expected.extend([false.into(), true.into(), serde_json::json!(["0", "0", true, false])]);
    assert_eq!(seen, serde_json::json!(expected));
    let said = tab.run(
        "(() => { const seen = []; for (const [k, text] of [[1, '30 deg'], [1, '45°'], [1, 'thirty'], [3, '30 deg']]) { const field = document.getElementById(`q${k}-value`); \
             field.value = text; for (const kind of ['input', 'change']) field.dispatchEvent(new Event(kind, { bubbles: true })); \
             seen.push(document.getElementById(`q${k}-fault`).hidden ? field.value : document.getElementById(`q${k}-fault`).textContent); } \
         return [...seen, [...document.querySelectorAll('#sliders input[type=range]')].every((slider) => slider.clientWidth >= 140)]; })()",
    );
    let expected = serde_json::json!([
        "0.5235987755982988",
        "0.7853981633974483",
        "“thirty” is not a number. Write one, such as 0.5 (rad), −pi/4 (always rad) or 30 deg",
        "“30 deg” is not a number. Write one in m without its unit, such as 0.25 or 1/3",
        true
    ]);
    assert_eq!(said, expected);
    tab.close();
}

/// A sentence gives the singular postures of an arm. For the Panda it uses the determinant of the first six joints; its factors are those
/// of the first six columns of the Jacobian.
#[test]
#[ignore = "wide"]
fn where_an_arm_is_singular_is_said() {
    let where_said = "document.getElementById('singular-where').textContent.split('. Only')[0]";
    for (name, said) in [
        ("scara", "Singular where q₂ = 0 mod π; and nowhere else."),
        ("ur5", "Singular where q₃ = 0 mod π; or q₅ = 0 mod π; or 0.0157787sin(q2+q3+q4)−0.0653905cos(q2+q3)−0.0708502cosq2 = 0; and nowhere else."),
        (
            "panda7",
            "Singular where the determinants of all choices of 6 columns of J are zero at once; w² is the sum of their squares. That of the first six is \
             zero nowhere but where q₂ = 0 mod π; or q₄ = −0.467002, 0, 2.63084, 2.67459 mod 2 π; or q₅ = π/2 mod π",
        ),
    ] {
        let Some(mut tab) = opened(&robot(name), 1600, "light") else { return };
        // The browser inserts spaces between the parts of a formula.
        let text = tab.run(where_said).as_str().expect("a text").replace(['\u{2062}', '\u{2061}', '\u{200a}', '\u{2009}'], "");
        assert_eq!(text, said, "{name}");
        if name == "panda7" {
            let product = tab.run("JSON.parse(document.getElementById('data').textContent).firstSix.factors.map((factor) => `(${factor})`).join('*')");
            let product = product.as_str().expect("factors").replace("sin(", "Math.sin(").replace("cos(", "Math.cos(");
            let ratios = format!(
                "[1, 2, 3, 4, 5].map((k) => {{ const q = Array.from({{ length: 7 }}, (_, i) => Math.sin(1.7 * k + 2.3 * i)), [q1, q2, q3, q4, q5] = q; \
                 const minor = (rows, columns) => rows.length === 0 ? 1 : columns.reduce((sum, c, i) => \
                     sum + (i % 2 ? -1 : 1) * rows[0][c] * minor(rows.slice(1), columns.filter((other) => other !== c)), 0); \
                 return Math.abs(minor(robot.geometricJacobian(q), [0, 1, 2, 3, 4, 5]) / ({product})); }}).map((ratio) => Math.abs(ratio - 1) < 1e-9)"
            );
            assert_eq!(tab.run(&ratios), serde_json::json!([true, true, true, true, true]));
            // Two joints at computed values make the arm singular in every posture of the others.
            let pairs = tab.run(&format!(
                "(async () => {{ {MOVE}(1); const details = document.querySelector('#singular details'); details.open = true; \
                 while (!details.querySelector('button')) await new Promise((done) => setTimeout(done, 20)); \
                 const badge = () => document.getElementById('singular-posture').textContent; const seen = [badge()]; \
                 for (const button of details.querySelectorAll('button')) {{ {MOVE}(2); button.click(); seen.push(`${{button.textContent}}: ${{badge()}}`); }} return seen; }})()"
            ));
            let pairs: Vec<&str> = pairs.as_array().expect("a list").iter().filter_map(serde_json::Value::as_str).collect();
            assert_eq!(pairs[0], "");
            assert!(pairs.contains(&"set q₂ = 0, q₄ = 0: ⚠ singular posture") && pairs.len() >= 9, "{pairs:?}");
            assert!(pairs[1..].iter().all(|said| said.ends_with(": ⚠ singular posture")), "{pairs:?}");
        }
        tab.close();
    }
}
