/** The check against the real arm: measured postures and poses in, the row that is wrong out, drawn as a ghost when it is chosen. */

import { byId, html } from "./dom.mjs";
import { exact, fromUnit, inUnit, units, withUnit } from "./format.mjs";
import { rollPitchYaw } from "./numbers.mjs";
import { Arm } from "./scene.mjs";
import { apart, asWritten, explain, frames, read } from "./suspects.mjs";

/** Suspects that are listed. */
const LISTED = 8;

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function check(data, state, picture) {
    const [field, list, said] = [byId("measured"), byId("suspects"), byId("measured-said")];
    const kinds = data.rows.map((row) => (row.type === "revolute" ? "rad" : "m"));
    /** @type {{arm: any, solids: Arm} | null} */
    let ghost = null;
    picture.ghosts.push(() => {
        if (!ghost) return [];
        const { arm, solids } = ghost;
        const { links, end } = frames(arm, state.q);
        solids.place(state.q.map((q, i) => q * arm.signs[i]), links, end);
        return solids.solids;
    });
    const choose = (suspect, button) => {
        const chosen = button && button.getAttribute("aria-pressed") !== "true";
        for (const other of list.querySelectorAll("button")) other.setAttribute("aria-pressed", "false");
        button?.setAttribute("aria-pressed", String(chosen));
        ghost = chosen ? { arm: suspect.arm, solids: new Arm({ ...data, ...suspect.arm }, "ghost") } : null;
        picture.redraw();
    };
    const update = () => {
        list.replaceChildren();
        said.replaceChildren();
        if (ghost) choose(null, null);
        const { measured, faults } = read(field.value, data.rows.length, fromUnit, kinds);
        for (const fault of faults) said.append(html("p", { class: "warning" }, fault));
        if (measured.length === 0) return;
        const arm = asWritten(data);
        measured.forEach((one, k) => {
            const { position, angle } = apart(arm, one);
            const turned = one.frame ? ` and ${withUnit(angle, "rad")}` : "";
            said.append(html("p", {}, `pose ${k + 1}: ${withUnit(position, "m")}${turned} from the arm of the page`));
        });
        const { before, suspects } = explain(data, measured, picture.arm.size);
        if (before < 1e-3 * picture.arm.size) {
            said.append(html("p", {}, html("strong", {}, "The arm of the page agrees with what was measured.")));
            return;
        }
        if (suspects.length === 0) {
            said.append(html("p", { class: "warning" }, "No single mistake that is looked for explains the differences."));
            return;
        }
        const equal = suspects.filter((suspect) => suspect.equal).length;
        const partly = suspects[0].difference > 0.05 * before ? "No single mistake explains them fully. " : "";
        said.append(html("p", {}, partly + (equal === 1 ? "This one comes nearest:" : `${equal} mistakes come equally near:`)));
        for (const suspect of suspects.slice(0, Math.max(LISTED, equal))) {
            const button = html("button", { type: "button", "aria-pressed": "false" }, "show");
            button.addEventListener("click", () => choose(suspect, button));
            const text = `${suspect.words}; remaining difference ${withUnit(suspect.difference, "m")} `;
            const item = html("li", { "data-row": suspect.row, "data-fault": suspect.fault, "data-difference": exact(suspect.difference) });
            item.append(suspect.equal ? html("strong", {}, text) : text, button);
            list.append(item);
        }
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
        return `${numbers.map((x) => exact(Number(x.toPrecision(8)))).join(" ")}\n`;
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
