/** The data sheet: rows that are drawn while they are in focus, numbers in the reader's units, the tables of frames and bodies. */

import { cuboid } from "./bodies.mjs";
import { byId, html } from "./dom.mjs";
import { short, tidy, units, withUnit } from "./format.mjs";
import { links } from "./kinematics.mjs";

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

/** Origins and axes of all frames at the posture of the sliders, and at q = 0. @param {any} data @param {import("./state.mjs").State} state */
function frameTable(data, state) {
    const names = ["0", ...links(data).map((_, i) => String(i + 1)), "e"];
    const make = (when) => {
        const origin = html("th", { scope: "col" });
        const head = html("tr", {}, html("th", { scope: "col" }, "frame"), origin, ...["x axis", "y axis", "z axis"].map((axis) => html("th", { scope: "col" }, axis)));
        const cells = names.map(() => Array.from({ length: 4 }, () => html("td")));
        const body = html("tbody", {}, ...names.map((name, k) => html("tr", {}, html("th", { scope: "row" }, name), ...cells[k])));
        const table = html("table", { class: "frames" }, html("caption", {}, `Origins and axes of the frames in the base frame, ${when}`), html("thead", {}, head), body);
        byId("frames").append(html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": `Frames ${when}` }, table));
        return { origin, cells };
    };
    const [here, there] = ["at the posture of the sliders", "at q = 0"].map(make);
    const zero = state.q.map(() => 0);
    const write = (q, { origin, cells }) => {
        origin.textContent = `origin, ${units.length}`;
        const identity = [
            [1, 0, 0, 0],
            [0, 1, 0, 0],
            [0, 0, 1, 0],
        ];
        [identity, ...robot.linkFrames(q), robot.directKinematics(q)].forEach((frame, k) => {
            [3, 0, 1, 2].forEach((column, j) => {
                const text = [0, 1, 2].map((i) => (column === 3 ? length(frame[i][3]) : short(tidy(Number(frame[i][column].toFixed(4)))))).join("  ");
                if (cells[k][j].textContent !== text) cells[k][j].textContent = text;
            });
        });
    };
    const update = () => {
        // What is folded in is not kept.
        if (!byId("frames").closest("details").open) return;
        write(state.q, here);
        write(zero, there);
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

/** Whether there is such a body, in words. @param {any} body @param {any} shape its cuboid */
function verdict(body, shape) {
    const alone = body.inertia.filter((element) => element !== 0).length === 1;
    if (!shape.possible) return alone ? "planar: one moment alone" : "impossible";
    if (body.doubt) return `doubtful: ${body.doubt}`;
    return body.said.length > 0 ? "doubtful" : "possible";
}

/** @param {any} data */
function bodyTable(data) {
    const columns = ["body", "frame", "mass, kg", `centre of mass in that frame, ${units.length}`, "inertia tensor about it, kg\u00a0m²", `edges of its cuboid, ${units.length}`, "density of the cuboid, kg/m³", "such a body"];
    const head = html("tr", {}, ...columns.map((column) => html("th", { scope: "col" }, column)));
    const rows = data.bodies.flatMap((body) => {
        const shape = cuboid(body);
        const lengths = (values) => values.map(length).join("\n");
        // Moments below each other, beside them the products that are not 0.
        const element = (name, k) => `${name} ${brief(body.inertia[k])}`;
        const product = (name, k) => (body.inertia[k] === 0 ? "" : `  ${element(name, k)}`);
        const tensor = [element("xx", 0) + product("xy", 1), element("yy", 2) + product("xz", 3), element("zz", 5) + product("yz", 4)].join("\n");
        // What the linter says of the tensor, in its own words.
        const impossible = shape !== null && !shape.possible;
        const said = body.said.length === 0 && impossible ? ["no solid body has these moments"] : body.said;
        const cells = shape
            ? [
                  lengths(body.com),
                  tensor,
                  shape.empty ? "no inertia" : lengths(shape.edges),
                  Number.isFinite(shape.density) ? short(Number(shape.density.toPrecision(4))) : shape.empty ? "none" : "flat: none",
                  verdict(body, shape),
              ]
            : ["none", tensor, "none", "none", "no mass"];
        const row = html(
            "tr",
            { class: cells.at(-1) === "possible" || !shape ? "" : "doubtful" },
            html("th", { scope: "row" }, body.name),
            ...[String(body.frame), short(body.mass), ...cells].map((text) => html("td", {}, text)),
        );
        if (said.length === 0) return [row];
        const words = said.map((message) => html("p", { class: "warning" }, html("strong", {}, "Warning"), ": ", ...message.split("\u0060").map((part, k) => (k % 2 ? html("code", {}, part) : part))));
        return [row, html("tr", { class: "said" }, html("td", { colspan: columns.length }, ...words))];
    });
    const caption = html("caption", {}, "Each body as the cuboid of even density that has its inertia; its edges are listed by the axis of the frame, x, y, z, that each is nearest to", html("span", { class: "keys" }, "; tick “bodies” to see them on the arm"));
    const table = html("table", { class: "bodies" }, caption, html("thead", {}, head), html("tbody", {}, ...rows));
    return html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Bodies" }, table);
}
