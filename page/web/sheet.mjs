/** The data sheet: rows that are drawn while they are in focus, numbers in the reader's units, the tables of frames and bodies. */

import { cuboid } from "./bodies.mjs";
import { byId, html } from "./dom.mjs";
import { short, tidy, units, withUnit } from "./format.mjs";

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function sheet(data, state, picture) {
    const table = byId("sheet");
    const rowOf = (target) => {
        const row = target instanceof Element ? target.closest("tr[data-row]") : null;
        return row ? Number(row.getAttribute("data-row")) - 1 : null;
    };
    const focused = () => rowOf(document.activeElement);
    const show = (row) => {
        picture.focusRow(row);
        for (const element of table.querySelectorAll("tr[data-row]")) {
            element.classList.toggle("drawn", row !== null && Number(element.getAttribute("data-row")) === row + 1);
        }
    };
    table.addEventListener("focusin", (event) => show(rowOf(event.target)));
    table.addEventListener("focusout", () => show(null));
    table.addEventListener("pointerover", (event) => show(rowOf(event.target) ?? focused()));
    table.addEventListener("pointerleave", () => show(focused()));

    const numbers = [...document.querySelectorAll("#content .number[data-unit]")];
    const inUnits = () => {
        for (const number of numbers) {
            const unit = number.getAttribute("data-unit") ?? "";
            number.textContent = withUnit(Number(number.getAttribute("data-value")), unit);
        }
    };
    inUnits();
    state.on("units", inUnits);

    const frames = frameTable(data, state);
    state.on("motion", frames);
    state.on("units", frames);
    const bodies = () => byId("bodies").replaceChildren(bodyTable(data));
    bodies();
    state.on("units", bodies);
}

/** Origins and axes of all frames at q = 0 and at the posture of the sliders. @param {any} data @param {import("./state.mjs").State} state */
function frameTable(data, state) {
    const names = ["0", ...data.rows.map((_, i) => String(i + 1)), "e"];
    const columns = ["origin", "x axis", "y axis", "z axis"];
    const cells = [];
    const groups = html("tr", {}, html("td"), ...["at q = 0", "at the posture of the sliders"].map((when) => html("th", { scope: "colgroup", colspan: 4 }, when)));
    const head = html("tr", {}, html("th", { scope: "col" }, "frame"));
    const origins = [];
    for (let k = 0; k < 2; k++) {
        for (const column of columns) head.append(html("th", { scope: "col" }, column));
        origins.push(head.children[1 + 4 * k]);
    }
    const body = html("tbody");
    for (const name of names) {
        const row = html("tr", {}, html("th", { scope: "row" }, name));
        const own = Array.from({ length: 8 }, () => html("td"));
        row.append(...own);
        cells.push(own);
        body.append(row);
    }
    const table = html("table", { class: "frames" }, html("caption", {}, "Origins and axes of the frames, in the base frame"), html("thead", {}, groups, head), body);
    byId("frames").append(html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Frames" }, table));
    const zero = state.q.map(() => 0);
    const write = (q, from) => {
        const identity = [
            [1, 0, 0, 0],
            [0, 1, 0, 0],
            [0, 0, 1, 0],
        ];
        [identity, ...robot.linkFrames(q), robot.directKinematics(q)].forEach((frame, k) => {
            [3, 0, 1, 2].forEach((column, j) => {
                const text = [0, 1, 2].map((i) => (column === 3 ? length(frame[i][3]) : brief(frame[i][column]))).join("  ");
                const cell = cells[k][from + j];
                if (cell.textContent !== text) cell.textContent = text;
            });
        });
    };
    const update = () => {
        // What is folded in is not kept.
        if (!byId("frames").closest("details").open) return;
        for (const name of origins) name.textContent = `origin, ${units.length}`;
        write(zero, 0);
        write(state.q, 4);
    };
    byId("frames").closest("details").addEventListener("toggle", update);
    return update;
}

/** @param {number} x */
function length(x) {
    return brief(units.length === "mm" ? x * 1000 : x);
}

/** Five digits. @param {number} x */
function brief(x) {
    return short(tidy(Number(x.toPrecision(5))));
}

/** @param {any} data */
function bodyTable(data) {
    const columns = ["body", "frame", "mass, kg", `centre of mass in that frame, ${units.length}`, `edges of its cuboid, ${units.length}`, "density of the cuboid, kg/m³", "inertia tensor"];
    const head = html("tr", {}, ...columns.map((column) => html("th", { scope: "col" }, column)));
    const rows = data.bodies.map((body) => {
        const shape = cuboid(body);
        const lengths = (values) => values.map(length).join("  ");
        const cells = shape
            ? [
                  lengths(body.com),
                  shape.empty ? "no inertia" : lengths(shape.edges),
                  Number.isFinite(shape.density) ? short(Number(shape.density.toPrecision(4))) : shape.empty ? "none" : "flat: none",
                  shape.possible ? "possible" : "⚠ impossible: no body has these moments",
              ]
            : ["none", "none", "none", "none: no mass"];
        return html(
            "tr",
            { class: shape && !shape.possible ? "doubtful" : "" },
            html("th", { scope: "row" }, body.name),
            ...[String(body.frame), short(body.mass), ...cells].map((text) => html("td", {}, text)),
        );
    });
    const caption = html("caption", {}, "Each body as the cuboid of even density that has its inertia; tick “bodies” to see them on the arm");
    const table = html("table", { class: "bodies" }, caption, html("thead", {}, head), html("tbody", {}, ...rows));
    return html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Bodies" }, table);
}
