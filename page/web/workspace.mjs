/**
 * Where the end effector comes to, by points of a fixed sequence over the limits, how well it moves there, and ellipsoids at the tip.
 */

import { byId, html, svg } from "./dom.mjs";
import { inUnit, short, unitName, unitOfManipulability, variable, withUnit } from "./format.mjs";
import { evaluate, parse, zeros } from "./formula.mjs";
import { determinant, gram, manipulability, outline, eigen } from "./linear.mjs";
import { extremes } from "./reach.mjs";
import { step } from "./scene.mjs";
import { sequence } from "./search.mjs";
import { range } from "./state.mjs";
import { origin } from "./vector.mjs";

const POINTS = 2000;
/** Cells of the map of w, along each joint. */
const CELLS = 48;
/** Side of the map, px. */
const SIDE = 384;

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function workspace(data, state, picture) {
    const tip = (q) => origin(robot.directKinematics(q));
    /** @type {{q: number[], p: number[]}[] | null} */
    let samples = null;
    const reach = () => {
        samples ??= sequence(data.rows.length, POINTS).map((part) => {
            const q = data.rows.map((row, i) => {
                const [low, high] = range(row);
                return low + part[i] * (high - low);
            });
            return { q, p: tip(q) };
        });
        return samples;
    };
    const layer = picture.layers.points;
    const path = svg("path");
    picture.extras.push(() => {
        if (!byId("show-points").checked) {
            if (layer.firstChild) layer.replaceChildren();
            return;
        }
        if (!layer.firstChild) layer.append(path);
        path.setAttribute("d", reach().map(({ p }) => `M${picture.view.project(p).map((x) => x.toFixed(1)).join(" ")}h0`).join(""));
    });
    ellipsoids(data, state, picture);
    for (const name of ["points", "velocity", "force"]) byId(`show-${name}`).addEventListener("input", () => picture.redraw());
    const details = byId("reach");
    /** @type {ReturnType<typeof extremes> | null} */
    let ends = null;
    const draw = () => {
        if (!details.open) return;
        ends ??= extremes(data.rows, tip, reach());
        details.querySelector("div")?.replaceChildren(...views(reach().map(({ p }) => p), ends, assumed(data.rows)));
    };
    details.addEventListener("toggle", draw);
    state.on("units", draw);
    map(data, state, picture);
}

/** The ranges of the joints that have no limits, in words. @param {any[]} rows */
export function assumed(rows) {
    const free = (type) => rows.flatMap((row, i) => (row.limits || row.type !== type ? [] : [variable(i + 1)]));
    const said = (names, range) => (names.length === 0 ? [] : [`${names.join(", ")} ${names.length === 1 ? "has" : "have"} no limits: ${range}`]);
    return [...said(free("revolute"), "a whole turn was taken"), ...said(free("prismatic"), `−${withUnit(1, "m")} to ${withUnit(1, "m")} was assumed`)].join("; ");
}

/** The points from the side and from above, and how far they go. @param {number[][]} points @param {ReturnType<typeof extremes>} ends @param {string} ranges that were assumed */
function views(points, ends, ranges) {
    const size = ends.reach || 1;
    const unit = step(size);
    const picture = (title, [across, up], all) => {
        const at = (x) => ((x / size) * 110).toFixed(1);
        const d = all.map(([x, y]) => `M${at(x)} ${at(-y)}h0`).join("");
        const axes = svg("path", { class: "axes", d: "M-118 0H118M0 -118V118" });
        // A length of both axes, for scale.
        const tick = at(unit);
        const ticks = svg("path", { class: "axes", d: `M${tick} -3V3M-3 -${tick}H3` });
        const text = (x, y, words, anchor) => svg("text", { x, y, "text-anchor": anchor }, words);
        const names = [text(118, 132, across, "end"), text(0, -124, up, "middle"), text(tick, 13, withUnit(unit, "m"), "middle"), text(6, 3 - Number(tick), withUnit(unit, "m"), "start")];
        return html("figure", {}, svg("svg", { viewBox: "-120 -136 240 274", class: "reach", role: "img", "aria-label": title }, axes, ticks, svg("path", { d }), ...names), html("figcaption", {}, title));
    };
    const about = (x) => withUnit(Math.abs(x) < 1e-4 * size ? 0 : Number(x.toPrecision(4)), "m");
    const extent = (/** @type {number[]} */ [low, high]) => `${about(low)} to ${about(high)}`;
    const [x, y, z] = ends.axes.map(extent);
    return [
        picture(`From the side, all directions about the z axis laid over each other: distance from it ${extent(ends.away)}, z ${z}.`, ["distance", "z"], points.map(([x, y, z]) => [Math.hypot(x, y), z])),
        picture(`From above, all heights laid over each other: x ${x}, y ${y}.`, ["x", "y"], points),
        html("p", {}, `Reach: ${about(size)} from the origin of the base. These lengths are the extremes within the limits, searched for from the outermost of ${points.length} postures, whose points are shown; a search can miss a farther one${ranges && `. ${ranges}`}.`),
    ];
}

/** Velocity and force ellipsoids of the translation at the tip, for rates and torques of unit norm. */
function ellipsoids(data, state, picture) {
    const layer = picture.layers.ellipsoids;
    const said = byId("ellipsoid-axes");
    picture.extras.push(() => {
        const elements = [];
        const words = [];
        const j = robot.geometricJacobian(state.q).slice(0, 3);
        const a = gram(j);
        const [x, y] = picture.view.project(origin(picture.end));
        const draw = (matrix, kind, title) => {
            const axes = eigen(matrix).values.map((value) => Math.sqrt(Math.max(0, value)));
            words.push(`${title}: semi-axes ${axes.map((x) => short(Number(x.toPrecision(4)))).join(", ")}`);
            const { semi, angle } = outline(matrix, picture.view.right, picture.view.up);
            const scale = (0.2 * picture.arm.size * picture.view.scale) / (axes[0] || 1);
            const turn = (-angle * 180) / Math.PI;
            elements.push(svg("ellipse", { class: kind, rx: (semi[0] * scale).toFixed(1), ry: (semi[1] * scale).toFixed(1), transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) rotate(${turn.toFixed(1)})` }));
        };
        if (byId("show-velocity").checked) draw(a, "velocity", "Velocity ellipsoid of the tip, m/s for rates of norm 1");
        if (byId("show-force").checked) {
            const { values, vectors } = eigen(a);
            if (values[2] > 1e-12 * values[0]) {
                const inverse = a.map((_, i) => a.map((_, k) => values.reduce((sum, value, m) => sum + (vectors[i][m] * vectors[k][m]) / value, 0)));
                draw(inverse, "force", "Force ellipsoid, N for torques of norm 1");
            } else {
                words.push("Force ellipsoid: none at a singular posture, which bears any force along the lost direction");
            }
        }
        if (elements.length > 0 || layer.firstChild) layer.replaceChildren(...elements);
        const text = words.join(". ");
        if (said.textContent !== text) said.textContent = text;
    });
}

/** w of the task over two joints as brightness, where a factor of the determinant changes its sign as lines. */
function map(data, state, picture) {
    const details = byId("w-map");
    const [first, second] = [byId("w-first"), byId("w-second")];
    if (data.rows.length < 2) {
        details.remove();
        return;
    }
    data.rows.forEach((row, i) => {
        for (const select of [first, second]) select.append(html("option", { value: i }, `${variable(i + 1)} ${row.name}`));
    });
    // The joints at which a factor of the determinant is zero, before others: w is 0 whatever joints do that change none.
    const [inner, outer] = data.rows.length > 2 ? [1, 2] : [0, 1];
    const named = (data.determinant?.singular ?? []).flatMap((text) => zeros(text ?? "")?.joint ?? []).map((joint) => joint - 1);
    const two = [...new Set([...named, inner, outer])].slice(0, 2).sort((a, b) => a - b);
    [first.value, second.value] = two.map(String);
    const canvas = /** @type {HTMLCanvasElement} */ (byId("w-canvas"));
    const square = data.task.length === data.rows.length;
    const factors = (data.determinant?.factors ?? []).map(parse);
    const draw = () => {
        if (!details.open) return;
        const [i, j] = [Number(first.value), Number(second.value)];
        const [[a, b], [c, d]] = [range(data.rows[i]), range(data.rows[j])];
        const at = (k, low, high) => low + ((k + 0.5) / CELLS) * (high - low);
        const values = [];
        // Of each factor: where two of them change together, as in a folded arm, the determinant changes not at all.
        const signs = [];
        for (let y = 0; y < CELLS; y++) {
            for (let x = 0; x < CELLS; x++) {
                const q = state.q.slice();
                q[i] = at(x, a, b);
                q[j] = at(y, c, d);
                const jacobian = robot.geometricJacobian(q);
                const task = data.task.map((row) => jacobian[row]);
                const det = square ? determinant(task) : NaN;
                values.push(square ? Math.abs(det) : manipulability(task));
                const each = factors.length > 0 ? factors.map((factor) => evaluate(factor, (name) => q[Number(name.slice(1)) - 1])) : [det];
                signs.push(each.map((value) => value < 0));
            }
        }
        const [largest, smallest] = [Math.max(...values), Math.min(...values)];
        const lowest = values.indexOf(smallest);
        const scale = picture.arm.size ** data.task.length;
        const unit = (k) => (data.rows[k].type === "revolute" ? "rad" : "m");
        // Names and ends of the axes, in the reader's units.
        for (const [k, low, high, id] of [[i, a, b, "w-across"], [j, c, d, "w-up"]]) {
            const name = `${variable(k + 1)} ${data.rows[k].name}, ${unitName(unit(k))}`;
            byId(id).replaceChildren(...[short(inUnit(low, unit(k))), name, short(inUnit(high, unit(k)))].map((text) => html("span", {}, text)));
        }
        const nothing = i === j || !(largest > 1e-12 * scale);
        canvas.parentElement?.toggleAttribute("hidden", nothing);
        if (nothing) {
            byId("w-said").textContent = i === j ? "Choose two different joints." : "w is 0 at all of these postures: the arm is singular whatever these two joints do. Move another joint.";
            return;
        }
        const context = canvas.getContext("2d");
        if (!context) return;
        const cell = SIDE / CELLS;
        values.forEach((w, k) => {
            const part = largest > 0 ? w / largest : 0;
            const [x, y] = [k % CELLS, Math.floor(k / CELLS)];
            context.fillStyle = `hsl(${230 - 180 * part} 75% ${22 + 58 * part}%)`;
            context.fillRect(x * cell, SIDE - (y + 1) * cell, cell + 0.5, cell + 0.5);
        });
        context.fillStyle = "#ffffff";
        const change = (k, other) => square && signs[k].some((sign, i) => sign !== signs[other][i]);
        signs.forEach((_, k) => {
            const [x, y] = [k % CELLS, Math.floor(k / CELLS)];
            if (x + 1 < CELLS && change(k, k + 1)) context.fillRect((x + 1) * cell - 1, SIDE - (y + 1) * cell, 2.5, cell);
            if (y + 1 < CELLS && change(k, k + CELLS)) context.fillRect(x * cell, SIDE - (y + 1) * cell - 1, cell, 2.5);
        });
        context.strokeStyle = "#ff3b30";
        context.lineWidth = 2;
        context.strokeRect(((state.q[i] - a) / (b - a)) * SIDE - 5, SIDE - ((state.q[j] - c) / (d - c)) * SIDE - 5, 10, 10);
        const held = state.q.flatMap((x, k) => (k === i || k === j ? [] : [`${variable(k + 1)} = ${withUnit(x, unit(k))}`]));
        const size = `${short(largest)} ${unitOfManipulability(data)}`.trim();
        byId("w-said").textContent =
            `${held.length > 0 ? `The slice of all postures at ${held.join(", ")}. ` : ""}Across: ${variable(i + 1)} from ${withUnit(a, unit(i))} to ${withUnit(b, unit(i))}; up: ${variable(j + 1)} from ${withUnit(c, unit(j))} to ${withUnit(d, unit(j))}; ` +
            `w from 0 (dark) to ${size} (bright), the least that is drawn ${short(Number(smallest.toPrecision(3)))} at ${variable(i + 1)} = ${withUnit(Number(at(lowest % CELLS, a, b).toPrecision(3)), unit(i))}, ${variable(j + 1)} = ${withUnit(Number(at(Math.floor(lowest / CELLS), c, d).toPrecision(3)), unit(j))}${square ? ", white lines where a factor of det J changes its sign" : ""}; the square is the posture that is shown. `;
        byId("w-said").append(html("a", { href: "#singular" }, "Where the arm is singular"));
    };
    details.addEventListener("toggle", draw);
    let waiting = 0;
    const later = () => {
        if (!details.open) return;
        clearTimeout(waiting);
        waiting = window.setTimeout(draw, 150);
    };
    state.on("motion", later);
    state.on("units", draw);
    for (const select of [first, second]) select.addEventListener("input", draw);
}
