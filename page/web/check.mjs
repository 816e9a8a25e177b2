/** The check against the real arm: measured postures and poses in, the row that is wrong out, drawn as a ghost when it is chosen. */

import { byId, html, svg } from "./dom.mjs";
import { exact, fromUnit, inUnit, short, tidy, units, withUnit } from "./format.mjs";
import { settle } from "./labels.mjs";
import { rollPitchYaw } from "./numbers.mjs";
import { Arm } from "./scene.mjs";
import { apart, asWritten, commonVector, differInOrientation, doubtedUnits, explain, frames, read } from "./suspects.mjs";
import { origin } from "./vector.mjs";

/** Suspects that are listed. */
const LISTED = 8;

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function check(data, state, picture) {
    const [field, list, said] = [byId("measured"), byId("suspects"), byId("measured-said")];
    const kinds = data.rows.map((row) => (row.type === "revolute" ? "rad" : "m"));
    /** The suspect that is drawn, and the first of what was measured. @type {{arm: any, solids: Arm, measured: any} | null} */
    let ghost = null;
    const place = () => {
        const { arm, solids } = /** @type {any} */ (ghost);
        const { links, end } = frames(arm, state.q);
        solids.place(state.q.map((q, i) => q * arm.signs[i]), links, end);
        return origin(end);
    };
    picture.ghosts.push(() => {
        if (!ghost) return [];
        place();
        return [ghost.solids];
    });
    const layer = picture.layers.marks;
    picture.extras.push(() => {
        picture.labels.marks = [];
        if (!ghost) {
            if (layer.firstChild) layer.replaceChildren();
            return;
        }
        const taken = picture.texts("marks");
        const mark = (point, kind, text, below) => {
            const [x, y] = picture.view.project(point).map((c) => Math.round(c * 10) / 10);
            const cross = svg("path", { class: kind, d: `M${x - 8} ${y - 8}l16 16m0 -16l-16 16` });
            const { pixel } = picture.view;
            const places = [26, 44, -12, 62, -30, 80, -48, 98, -66, 116, -84].flatMap((off) => [{ x: x + 12, y: y + off * pixel, end: false }, { x: x - 12, y: y + off * pixel, end: true }]);
            const { box, at } = settle(text, places, pixel, taken);
            taken.push(box);
            picture.labels.marks.push(box);
            const words = svg("text", { ...at, class: kind }, text);
            return below ? [words] : [cross, words];
        };
        layer.replaceChildren(...mark(ghost.measured.position, "measured", "measured, pose 1", false), ...mark(place(), "suspect", "mistake mended", true));
    });
    const choose = (suspect, button, measured) => {
        const chosen = button && button.getAttribute("aria-pressed") !== "true";
        for (const other of list.querySelectorAll("button")) other.setAttribute("aria-pressed", "false");
        button?.setAttribute("aria-pressed", String(chosen));
        ghost = chosen ? { arm: suspect.arm, solids: new Arm({ ...data, ...suspect.arm }, "ghost suspect"), measured } : null;
        picture.sticky.keep("suspect", ghost && byId("check"));
        if (!ghost) return picture.show([]);
        state.move(measured.q);
        place();
        picture.show([...ghost.solids.points, measured.position]);
    };
    const update = () => {
        list.replaceChildren();
        said.replaceChildren();
        if (ghost) choose(null, null, null);
        const { measured, faults } = read(field.value, data.rows.length, fromUnit, kinds);
        for (const fault of faults) said.append(html("p", { class: "warning" }, fault));
        if (measured.length === 0) return;
        const arm = asWritten(data);
        measured.forEach((one, k) => {
            const { position, angle } = apart(arm, one);
            const turned = one.frame ? ` and ${withUnit(tidy(angle), "rad")}` : "";
            said.append(html("p", {}, `pose ${k + 1}: ${withUnit(tidy(position), "m")}${turned} from the arm of the page`));
        });
        const { before, suspects } = explain(data, measured, picture.arm.size);
        if (before < 1e-3 * picture.arm.size) {
            said.append(html("p", {}, html("strong", {}, "The arm of the page agrees with what was measured.")));
            return;
        }
        const whole = suspects[0]?.difference < 1e-3 * picture.arm.size;
        const doubts = doubtedUnits(data, measured, picture.arm.size);
        if (doubts.length > 0 && !whole) {
            for (const doubt of doubts) said.append(doubted(doubt));
            return;
        }
        if (suspects.length === 0) {
            said.append(html("p", { class: "warning" }, "No single mistake that is looked for explains the differences. Lengths that are wrong by any amount are not looked for."));
        }
        const common = whole ? null : commonVector(arm, measured);
        if (common) {
            const by = `by about (${common.vector.map((x) => short(inUnit(x, "m"))).join(", ")}) ${units.length}`;
            const where = common.own ? " in the frame of the end effector: the tool, or a length of the last row." : ": a length along that direction, the base or the tool.";
            said.append(html("p", {}, `${measured.length > 1 ? "All positions differ" : "The position differs"} ${by}${where}`));
        }
        if (suspects.length === 0) return;
        const near = suspects.filter((suspect) => suspect.equal);
        const equal = near.length;
        const partly = !whole && suspects[0].difference > 0.05 * before ? "No single mistake explains them fully. " : "";
        const one = whole ? "This one explains them:" : "This one comes nearest:";
        const several = whole ? `${equal} mistakes explain them equally well:` : `${equal} mistakes come equally near:`;
        said.append(html("p", {}, partly + (equal === 1 ? one : several)));
        if (equal > 1 && measured.every(({ frame }) => !frame) && differInOrientation(near, measured)) {
            said.append(html("p", {}, "Positions alone cannot tell these apart; roll, pitch and yaw at the ends of the lines would."));
        }
        for (const suspect of suspects.slice(0, Math.max(LISTED, equal))) {
            const button = html("button", { type: "button", "aria-pressed": "false" }, "show");
            button.addEventListener("click", () => choose(suspect, button, measured[0]));
            const text = `${suspect.words}; remaining difference ${withUnit(tidy(suspect.difference), "m")}`;
            const item = html("li", { "data-row": suspect.row, "data-fault": suspect.fault, "data-difference": exact(suspect.difference) });
            item.append(button, suspect.equal ? html("strong", {}, text) : text);
            list.append(item);
        }
    };
    /** A question about units, with a button that takes what stands in the field in the other ones. @param {{kind: string, instead: string, words: string}} doubt */
    const doubted = ({ kind, instead, words }) => {
        const name = instead === "deg" ? "degrees" : instead;
        const button = html("button", { type: "button" }, `take them as ${name}`);
        button.addEventListener("click", () => {
            const text = field.value;
            byId(`${kind}-unit`).click();
            // Other units have converted it.
            field.value = text;
            update();
        });
        return html("p", { class: "warning" }, `${words}: are these ${name}? Units: ${units.length}, ${units.angle}, by the buttons “lengths” and “angles” at the top. `, button);
    };
    field.addEventListener("input", update);
    // What was typed keeps its meaning when other units are chosen.
    let typed = { ...units };
    state.on("units", () => {
        const chosen = { ...units };
        Object.assign(units, typed);
        const { measured, faults } = read(field.value, data.rows.length, fromUnit, kinds);
        Object.assign(units, chosen);
        typed = chosen;
        if (measured.length > 0 && faults.length === 0) field.value = measured.map(written).join("");
        update();
    });
    /** A line of the field. @param {import("./suspects.mjs").Measured} one */
    const written = ({ q, position, frame }) => {
        const numbers = [
            ...q.map((x, i) => inUnit(x, kinds[i])),
            ...position.map((x) => inUnit(x, "m")),
            ...(frame ? rollPitchYaw(frame).map((x) => inUnit(x, "rad")) : []),
        ];
        return `${numbers.map((x) => exact(tidy(Number(x.toPrecision(8))))).join(" ")}\n`;
    };
    byId("measured-add").addEventListener("click", () => {
        const { end } = picture.pose();
        const line = written({ q: state.q, position: [0, 1, 2].map((i) => end[i][3]), frame: end });
        field.value += (field.value && !field.value.endsWith("\n") ? "\n" : "") + line;
        update();
    });
    const placeholder = () => {
        const q = data.rows.map((_, i) => `q${i + 1}`).join(" ");
        field.placeholder = `${q}  x y z  roll pitch yaw     (${units.angle}, ${units.length})`;
    };
    state.on("units", placeholder);
    placeholder();
}
