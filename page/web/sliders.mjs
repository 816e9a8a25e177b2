/**
 * Sliders, and fields for exact numbers, or expressions such as -pi/4. A range holds fifteen digits only, so the field beside it rules where
 * it was typed. A field holds all digits; the six of them that it has room for are shown while nobody types. What is being typed counts once
 * it is finished, by Enter or when the field is left: half of a number is another number.
 */

import { byId, copy } from "./dom.mjs";
import { exact, fromUnit, inUnit, short, unitName } from "./format.mjs";
import { typed } from "./formula.mjs";
import { range } from "./state.mjs";

/** Fields with a text that is no number, and what the number was: the text stays until that is another one. @type {Map<any, number>} */
const refused = new Map();

/** Fields into which somebody types. @type {Set<any>} */
const typing = new Set();

/** @param {any} data @param {import("./state.mjs").State} state */
export function sliders(data, state) {
    const parts = data.rows.map((row, i) => {
        const k = i + 1;
        return {
            unit: row.type === "revolute" ? "rad" : "m",
            limits: row.limits,
            range: byId(`q${k}`),
            field: byId(`q${k}-value`),
            outside: byId(`q${k}-outside`),
            fault: byId(`q${k}-fault`),
            rate: byId(`dq${k}`),
            acceleration: byId(`ddq${k}`),
        };
    });
    parts.forEach((part, i) => {
        [part.range.min, part.range.max] = range(data.rows[i]).map(String);
        part.range.addEventListener("input", () => {
            state.q[i] = part.range.valueAsNumber + 0;
            state.changed("motion");
        });
        const listen = (field, values, unit) => {
            const take = () => {
                typing.delete(field);
                const value = meant(field.value, unit);
                const wrong = !Number.isFinite(value);
                field.setAttribute("aria-invalid", String(wrong));
                if (wrong) {
                    refused.set(field, values()[i]);
                    return;
                }
                refused.delete(field);
                // A zero has no sign.
                values()[i] = value + 0;
                state.changed("motion");
            };
            field.addEventListener("input", (event) => {
                if (event instanceof InputEvent && event.inputType !== "") typing.add(field);
                else take();
            });
            // What is left standing and is no number is said to be none.
            field.addEventListener("change", () => {
                if (typing.has(field)) take();
                const { badInput } = field.validity;
                const text = field.value.trim();
                const wrong = badInput || (text !== "" && !Number.isFinite(typed(text)));
                // Digits that were added to a number may have been meant to take its place.
                const sum = !wrong && !ofPi(text) && Number.isNaN(Number(text.replaceAll("−", "-")));
                part.fault.hidden = !wrong && !sum;
                part.fault.textContent = badInput ? "this field takes digits alone" : sum ? `${text} was taken for ${short(typed(text))}` : fault(text, unit);
                if (wrong) return;
                refused.delete(field);
                field.value = exact(inUnit(values()[i], unit));
                field.removeAttribute("aria-invalid");
                if (document.activeElement === field) field.select();
            });
            field.addEventListener("keydown", (event) => {
                if (event.key !== "Escape" || !typing.delete(field)) return;
                field.value = exact(inUnit(values()[i], unit));
                field.select();
            });
            selectWhenEntered(field);
        };
        listen(part.field, () => state.q, part.unit);
        part.field.addEventListener("paste", (event) => {
            const words = listed(event.clipboardData?.getData("text") ?? "");
            if (words.length < 2) return;
            event.preventDefault();
            typing.delete(part.field);
            const fits = words.length === parts.length;
            part.fault.hidden = fits;
            if (fits) return state.move(words.map((word, k) => meant(word, parts[k].unit) + 0));
            part.fault.textContent = `${words.length} numbers were pasted; a posture of this arm has ${parts.length}`;
        });
        listen(part.rate, () => state.dq, part.unit);
        listen(part.acceleration, () => state.ddq, part.unit);
        part.field.addEventListener("keydown", (event) => {
            const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
            if (!sign || event.ctrlKey || event.metaKey || event.altKey) return;
            event.preventDefault();
            if (typing.has(part.field)) part.field.dispatchEvent(new Event("change"));
            const step = unitName(part.unit) === part.unit ? 0.01 : 1;
            state.q[i] = fromUnit(inUnit(state.q[i], part.unit) + sign * step, part.unit);
            state.changed("motion");
        });
    });
    const show = () => {
        parts.forEach((part, i) => {
            const q = state.q[i];
            if (part.range.valueAsNumber !== q) part.range.value = String(q);
            if (write(part.field, q, part.unit)) part.fault.hidden = true;
            write(part.rate, state.dq[i], part.unit);
            write(part.acceleration, state.ddq[i], part.unit);
            [part.field, part.rate, part.acceleration].forEach((field, k) => {
                const brief = short(inUnit([q, state.dq[i], state.ddq[i]][k], part.unit));
                const around = field.parentElement;
                if (around.getAttribute("data-short") !== brief) around.setAttribute("data-short", brief);
            });
            const { limits } = part;
            const outside = limits !== null && (q < limits[0] || q > limits[1]);
            if (part.outside.hidden === outside) part.outside.hidden = !outside;
        });
    };
    state.on("motion", show);
    state.on("units", () => {
        for (const span of document.querySelectorAll("#sliders [data-unit]")) {
            span.textContent = unitName(span.getAttribute("data-unit") ?? "");
        }
        show();
    });
    byId("zero").addEventListener("click", () => {
        refused.clear();
        state.dq.fill(0);
        state.ddq.fill(0);
        state.move(state.q.map(() => 0));
    });
    // In the units of the fields, so that it can be pasted into one of them.
    byId("copy-q").addEventListener("click", () => {
        const used = [...new Set(parts.map(({ unit }) => unitName(unit)))].join(" and ");
        copy(byId("copy-q"), `[${state.q.map((x, i) => exact(inUnit(x, parts[i].unit))).join(", ")}]`, `q in ${used}`);
    });
}

/** A field that is entered has all of its text selected: what is typed then takes its place. @param {any} field */
function selectWhenEntered(field) {
    let entered = false;
    field.addEventListener("pointerdown", () => (entered = document.activeElement !== field));
    field.addEventListener("focus", () => field.select());
    // The button that goes up puts the caret where it is; who has marked a part keeps that.
    field.addEventListener("click", () => {
        if (entered && field.selectionStart === field.selectionEnd) field.select();
        entered = false;
    });
}

/** The numbers of a list, as other programs write one: [0.1, -pi/4, 0], or one a line; none of what is no list. @param {string} text */
export function listed(text) {
    const inside = /^[^[({]*[[({]+([^\])}]*)[\])}]+[\s;]*$/.exec(text)?.[1] ?? text;
    const words = inside.split(/[\s,;]+/).filter((word) => word !== "");
    return words.every((word) => Number.isFinite(typed(word))) ? words : [];
}

/** Why a text is no number. @param {string} text @param {string} unit */
function fault(text, unit) {
    const several = listed(text);
    if (/^\s*[-+−]?\d+,\d+\s*$/.test(text)) return `“${text}” is no number: a decimal point is a point, ${text.trim().replace(",", ".")}`;
    if (several.length > 1) return `“${text}” are ${several.length} numbers: a posture is pasted as a whole, not typed`;
    return `“${text}” is no number: digits in ${unitName(unit)}, pi in ${unit}, + − * / and parentheses are`;
}

/** What was typed, in rad or m: an expression with pi is in rad whatever the fields are in. @param {string} text @param {string} unit */
function meant(text, unit) {
    return ofPi(text) ? typed(text) : fromUnit(typed(text), unit);
}

/** @param {string} text */
function ofPi(text) {
    return /pi|π/.test(text);
}

/** Leaves a field alone that holds the number already, while somebody types into it, and one whose text is said to be no number. @param {any} field @param {number} value @param {string} unit */
function write(field, value, unit) {
    if (typing.has(field) || meant(field.value, unit) === value || refused.get(field) === value) return false;
    refused.delete(field);
    field.value = exact(inUnit(value, unit));
    field.removeAttribute("aria-invalid");
    return true;
}

/** Sweeps the joints one after the other, and stops at a touch; with reduced motion it steps. @param {any} data @param {import("./state.mjs").State} state */
export function player(data, state) {
    const button = byId("play");
    const reduced = matchMedia("(prefers-reduced-motion: reduce)");
    let stop = () => {};
    const play = () => {
        state.changed("sweep");
        const home = state.q.slice();
        const begin = performance.now();
        const [each, joints] = [reduced.matches ? 4 : 3, data.rows.length];
        let timer = 0;
        const tick = () => {
            const seconds = (performance.now() - begin) / 1000;
            const joint = Math.floor(seconds / each);
            if (joint >= joints) {
                state.move(home);
                stop();
                return;
            }
            let phase = (seconds / each) % 1;
            if (reduced.matches) phase = Math.floor(phase * 4) / 4;
            const [low, high] = range(data.rows[joint]);
            const q = home.slice();
            const wave = Math.sin(2 * Math.PI * phase);
            q[joint] = wave > 0 ? home[joint] + wave * (high - home[joint]) : home[joint] + wave * (home[joint] - low);
            state.move(q);
            timer = reduced.matches ? window.setTimeout(tick, 500) : requestAnimationFrame(tick);
        };
        stop = () => {
            if (reduced.matches) clearTimeout(timer);
            else cancelAnimationFrame(timer);
            button.textContent = "sweep joints";
            button.setAttribute("aria-pressed", "false");
            stop = () => {};
        };
        button.textContent = "stop";
        button.setAttribute("aria-pressed", "true");
        tick();
    };
    button.addEventListener("click", () => {
        if (button.getAttribute("aria-pressed") === "true") stop();
        else play();
    });
    for (const event of ["pointerdown", "keydown"]) {
        document.addEventListener(event, (touched) => {
            if (touched.target !== button) stop();
        });
    }
}
