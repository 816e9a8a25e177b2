/** Fields for the acceleration of free fall, of arms that have it as an argument. */

import { byId, html } from "./dom.mjs";

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function freeFall(data, state, picture) {
    if (!data.gravityIsArgument) return;
    const fields = ["x", "y", "z"].map((axis, i) => {
        const field = html("input", { type: "number", step: "any", value: String(data.gravity[i]), "aria-label": `gravity along ${axis}, m/s²` });
        field.addEventListener("input", () => {
            if (field.value === "" || !Number.isFinite(Number(field.value))) return;
            data.gravity[i] = Number(field.value);
            picture.drawGravity();
            state.changed("motion");
        });
        return html("label", {}, `g0 ${axis} `, field);
    });
    byId("arm-pane").append(html("div", { class: "controls", role: "group", "aria-label": "Gravity in the base frame" }, ...fields, " m/s²"));
}
