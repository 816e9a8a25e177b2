/**
 * Sliders, and fields for exact numbers, or expressions such as -pi/4. A range holds fifteen digits only, so the field beside it rules where
 * it was typed. A field holds all digits; the six of them that it has room for are shown while nobody types. What is being typed counts once
 * it is finished, by Enter or when the field is left: half of a number is another number.
 */

import { byId, copy } from "./dom.mjs";
import { digitsIn, fromUnit, inUnit, short, unitName, units, variable } from "./format.mjs";
import { typed } from "./formula.mjs";
import { range } from "./state.mjs";

/** Fields with a text that is no number, and what the number was: the text stays until that is another one, or all of them are set. @type {Map<any, {all: number[], value: number}>} */
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
            shown: state.q,
        };
    });
    /** Sets the joints from one on, or all of them where there is a number for each. @param {number} i @param {string} text */
    const fill = (i, text) => {
        const [words, { field, fault }] = [listed(text), parts[i]];
        typing.delete(field);
        const first = words.length === parts.length ? 0 : i;
        const fits = first + words.length <= parts.length;
        fault.hidden = fits;
        fault.textContent = `${words.length} numbers: a posture has ${parts.length}, and from ${variable(i + 1)} on there are ${parts.length - i} joints`;
        if (!fits) return;
        state.move(state.q.map((x, k) => (words[k - first] === undefined ? x : meant(words[k - first], parts[k].unit) + 0)));
    };
    parts.forEach((part, i) => {
        [part.range.min, part.range.max] = range(data.rows[i]).map(String);
        part.range.addEventListener("input", () => {
            refused.delete(part.field);
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
                    refused.set(field, { all: values(), value: values()[i] });
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
                const text = field.value.trim();
                const wrong = text !== "" && !Number.isFinite(meant(text, unit));
                if (wrong && field === part.field && isList(text)) return fill(i, text);
                // Digits that were added to a number may have been meant to take its place.
                const sum = !wrong && !inRadians(text) && Number.isNaN(Number(text.replaceAll("−", "-")));
                part.fault.hidden = !wrong && !sum;
                part.fault.textContent = sum ? `${text} was taken for ${short(typed(text))}` : fault(text, unit);
                if (wrong) return;
                refused.delete(field);
                field.value = digitsIn(values()[i], unit);
                field.removeAttribute("aria-invalid");
                if (document.activeElement === field) field.select();
            });
            field.addEventListener("keydown", (event) => {
                if (event.key === "Escape") {
                    const was = [typing.delete(field), refused.delete(field)];
                    if (!was.includes(true)) return;
                    restore(field, values()[i], unit);
                    part.fault.hidden = true;
                    field.select();
                }
                const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
                if (!sign || event.ctrlKey || event.metaKey || event.altKey) return;
                event.preventDefault();
                if (typing.has(field)) field.dispatchEvent(new Event("change"));
                refused.delete(field);
                const step = unitName(unit) === unit ? 0.01 : 1;
                values()[i] = fromUnit(Number((inUnit(values()[i], unit) + sign * step).toPrecision(15)), unit);
                state.changed("motion");
            });
            // What was typed and then typed back is no change.
            field.addEventListener("blur", () => typing.has(field) && field.dispatchEvent(new Event("change")));
            selectWhenEntered(field);
        };
        listen(part.field, () => state.q, part.unit);
        listen(part.rate, () => state.dq, part.unit);
        listen(part.acceleration, () => state.ddq, part.unit);
        part.field.addEventListener("paste", (event) => {
            const text = event.clipboardData?.getData("text") ?? "";
            if (!isList(text)) return;
            event.preventDefault();
            fill(i, text);
        });
    });
    const show = () => {
        parts.forEach((part, i) => {
            const q = state.q[i];
            if (part.range.valueAsNumber !== q) part.range.value = String(q);
            const fields = /** @type {[any, number[]][]} */ ([[part.field, state.q], [part.rate, state.dq], [part.acceleration, state.ddq]]);
            const set = fields.filter(([field, all]) => write(field, all, i, part.unit));
            // A posture that is set is another one, whatever was said before.
            if ((set.length > 0 || part.shown !== state.q) && !fields.some(([field]) => refused.has(field))) part.fault.hidden = true;
            part.shown = state.q;
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
        [state.dq, state.ddq] = [state.dq, state.ddq].map((all) => all.map(() => 0));
        state.move(state.q.map(() => 0));
    });
    // In the units of the fields, so that it can be pasted into one of them.
    byId("copy-q").addEventListener("click", () => {
        const used = [...new Set(parts.map(({ unit }) => unitName(unit)))].join(" and ");
        copy(byId("copy-q"), `[${state.q.map((x, i) => digitsIn(x, parts[i].unit)).join(", ")}]`, `q in ${used}`);
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

/** The numbers of a list, as other programs write one: [0.1, -pi/4, 0], or one a line, with a dash as in YAML or without; none of what is no list. @param {string} text */
export function listed(text) {
    const inside = /^[^[({]*[[({]+([^\])}]*)[\])}]+[\s;]*$/.exec(text)?.[1] ?? text.replace(/^\s*- /gm, "");
    const words = inside.replace(/(\d)\s+(deg\b|°)/g, "$1$2").split(/[\s,;]+/).filter((word) => word !== "");
    return words.every((word) => Number.isFinite(typed(word))) ? words : [];
}

/** A number, or several apart, with commas for their points: 1,5, or 0,1; 0,2. */
const COMMAS = /^\s*[-+−]?\d+,\d+([\s;]+[-+−]?\d+,\d+)*\s*$/;

/** Whether a text is several numbers. @param {string} text */
function isList(text) {
    return listed(text).length > 1 && !COMMAS.test(text);
}

/** Why a text is no number. @param {string} text @param {string} unit */
function fault(text, unit) {
    if (COMMAS.test(text)) return `“${text}” has commas for points: write ${text.trim().replaceAll(",", ".")}`;
    const said = `“${text}” is not a number. Write one`;
    if (unit === "m") return `${said} in ${unitName(unit)} without its unit, such as ${units.length === "mm" ? "250 or 1000/3" : "0.25 or 1/3"}`;
    return `${said}, such as ${units.angle === "deg" ? "30 (deg)" : "0.5 (rad)"}, −pi/4 (always rad) or 30 deg`;
}

/** What was typed, in rad or m: an expression with pi or with degrees is in rad whatever the fields are in. @param {string} text @param {string} unit */
export function meant(text, unit) {
    if (unit !== "rad" && /deg|°/.test(text)) return NaN;
    return inRadians(text) ? typed(text) : fromUnit(typed(text), unit);
}

/** @param {string} text */
function inRadians(text) {
    return /pi|π|deg|°/.test(text);
}

/**
 * Leaves a field alone that holds the number already, while somebody types into it, and one whose text is said to be no number, as long as
 * nobody has set its number, alone or with all of its kind. @param {any} field @param {number[]} all @param {number} i @param {string} unit
 */
function write(field, all, i, unit) {
    const before = refused.get(field);
    if (typing.has(field) || meant(field.value, unit) === all[i] || (before?.all === all && before.value === all[i])) return false;
    refused.delete(field);
    restore(field, all[i], unit);
    return true;
}

/** Writes a number into its field. @param {any} field @param {number} value @param {string} unit */
function restore(field, value, unit) {
    field.value = digitsIn(value, unit);
    field.removeAttribute("aria-invalid");
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
