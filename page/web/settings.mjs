/** Units, theme and print. */

import { byId, html } from "./dom.mjs";
import { short, units } from "./format.mjs";

/** Nodes of equations from which on no more are opened at once: browsers take minutes to print many more. */
const NODES = 12000;

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
    const unfold = byId("unfold");
    const said = byId("unfold-said");
    unfold.addEventListener("click", async () => {
        const open = unfold.textContent === "open all";
        said.textContent = "";
        unfold.setAttribute("aria-busy", "true");
        /** @type {string[]} */
        const closed = [];
        unfold.textContent = open ? "fold all" : "open all";
        // Runs move the arm when they are opened.
        const all = /** @type {NodeListOf<HTMLDetailsElement>} */ (document.querySelectorAll("#content details:not([data-log], #check details)"));
        const isEquation = (details) => details.matches("[data-equation]");
        for (const details of all) {
            const full = isEquation(details) && document.querySelectorAll("math *").length > NODES;
            if (open && full && !details.open) closed.push(named(details));
            if (details.open === open || (open && full)) continue;
            details.open = open;
            // One after the other: an equation is set when it is opened, and one with more lines than are set at once stays folded in.
            const isBusy = () => open && isEquation(details) && (!details.querySelector(".copies") || details.querySelector("[aria-busy=true]"));
            do await new Promise(requestAnimationFrame);
            while (isBusy());
            if (!open || !details.querySelector(".lines + .controls > :not([hidden])")) continue;
            details.open = false;
            closed.push(named(details));
        }
        unfold.setAttribute("aria-busy", "false");
        // Not where all has been folded in meanwhile.
        if (closed.length > 0 && unfold.textContent === "fold all") said.textContent = `Left closed, too long to be opened all at once: ${closed.join(", ")}.`;
    });
    // Sliders are not printed: the posture that the numbers hold for is said in words.
    const posture = html("p", { class: "print-only" });
    const folded = html("p", { class: "print-only small" });
    byId("arm-pane").append(posture, folded);
    addEventListener("beforeprint", () => {
        folded.textContent = leftOut();
        const list = (name, values) => `${name} = (${values.map((x) => short(x)).join(", ")})`;
        const { q, dq, ddq } = state;
        posture.textContent = `Posture: ${list("q", q)}, rates ${list("q̇", dq)}, accelerations ${list("q̈", ddq)}, in rad, m and s.`;
    });
}

/** What a section that is folded in is called. @param {Element} details */
function named(details) {
    return (details.querySelector("summary b") ?? details.querySelector("summary"))?.textContent ?? "";
}

/** What is folded in, and so is not printed, in words. */
function leftOut() {
    const parts = [...document.querySelectorAll("#content > section")].flatMap((section) => {
        const all = [...section.querySelectorAll("details")];
        const closed = all.filter((details) => !details.open && !details.parentElement?.closest("details:not([open])"));
        const title = section.querySelector("h2")?.textContent ?? "";
        const names = closed.map(named);
        if (closed.length === 0) return [];
        return [`${title} (${closed.length === all.length && all.length > 3 ? "all" : names.join("; ")})`];
    });
    return parts.length === 0 ? "" : `Not printed, since it was folded in: ${parts.join(", ")}.`;
}
