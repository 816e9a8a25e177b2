/** Units, theme and print. */

import { byId, html } from "./dom.mjs";
import { short, units } from "./format.mjs";

/** @param {import("./state.mjs").State} state */
export function settings(state) {
    const toggle = (id, kind, names, title) => {
        const button = byId(id);
        button.addEventListener("click", () => {
            units[kind] = units[kind] === names[0] ? names[1] : names[0];
            button.textContent = `${title}: ${units[kind]}`;
            state.changed("units");
        });
    };
    toggle("angle-unit", "angle", ["rad", "deg"], "angles");
    toggle("length-unit", "length", ["m", "mm"], "lengths");

    const dark = matchMedia("(prefers-color-scheme: dark)");
    const theme = byId("theme");
    const root = document.documentElement;
    const current = () => root.dataset.theme ?? (dark.matches ? "dark" : "light");
    const name = () => {
        theme.textContent = current() === "dark" ? "light theme" : "dark theme";
    };
    theme.addEventListener("click", () => {
        root.dataset.theme = current() === "dark" ? "light" : "dark";
        name();
        state.changed("theme");
    });
    dark.addEventListener("change", () => {
        name();
        state.changed("theme");
    });
    name();
    byId("print").addEventListener("click", () => window.print());
    // Sliders are not printed: the posture that the numbers hold for is said in words.
    const posture = html("p", { class: "print-only" });
    byId("arm-pane").append(posture);
    addEventListener("beforeprint", () => {
        const list = (name, values) => `${name} = (${values.map((x) => short(x)).join(", ")})`;
        const { q, dq, ddq } = state;
        posture.textContent = `Posture: ${list("q", q)}, rates ${list("dq", dq)}, accelerations ${list("ddq", ddq)}, in rad, m and s.`;
    });
}
