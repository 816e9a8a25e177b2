/**
 * Which motion is lost at a singular posture: combinations u of the rows of J with u' J = 0, in words and as lines in the picture.
 *
 * u = (f, m) is a wrench at the tip that no torque answers. Its line goes through r = tip + f x m / |f|² along f, and its pitch is
 * h = f·m / |f|²: with h = 0 no point of the line moves along it, with f = 0 there is no turn about any line along m, wherever it is.
 */

import { byId, svg } from "./dom.mjs";
import { short } from "./format.mjs";
import { settle } from "./labels.mjs";
import { lost } from "./linear.mjs";
import { add, along, cross, dot, norm, origin, scale } from "./vector.mjs";
import { HEIGHT, WIDTH } from "./view.mjs";
import { axesAtLine, axes, dependentAxes } from "./dependent_axes.mjs";

export const VELOCITY = ["vx", "vy", "vz", "ωx", "ωy", "ωz"];

/** How far parallel lines are apart, in units of the drawing. */
const BESIDE = 28;

/** As a sum: vx − 0.5 ωz. @param {number[]} of one number for each row @param {string[]} names */
export function combination(of, names) {
    const terms = of.flatMap((x, k) => (x === 0 ? [] : [{ x, text: Math.abs(x) === 1 ? names[k] : `${short(Number(Math.abs(x).toPrecision(4)))} ${names[k]}` }]));
    return terms.map(({ x, text }, k) => (k === 0 ? (x < 0 ? "−" : "") : x < 0 ? " − " : " + ") + text).join("");
}

/** The line of a wrench at the tip, and what does not happen at it; `hardly` of a posture that is nearly singular. @param {number[]} wrench @param {number[]} tip @param {boolean} hardly */
export function line(wrench, tip, hardly) {
    const [f, m] = [wrench.slice(0, 3), wrench.slice(3)];
    const no = hardly ? "hardly any" : "no";
    if (norm(f) === 0) return { at: tip, direction: scale(m, 1 / norm(m)), kind: "turn", text: `${no} turn about these lines` };
    const pitch = dot(f, m) / dot(f, f);
    const rest = Math.abs(pitch) < 1e-6 * Math.max(norm(m) / norm(f), 1e-3);
    const text = rest ? `${no} motion along this line` : `v ${pitch < 0 ? "−" : "+"} ${short(Number(Math.abs(pitch).toPrecision(4)))} ω along this line ${hardly ? "hardly moves" : "stays 0"}`;
    return { at: add(tip, scale(cross(f, m), 1 / dot(f, f))), direction: scale(f, 1 / norm(f)), kind: rest ? "move" : "screw", text };
}

/** The stretch of a line that is drawn, in the picture: about its middle if that is to be seen, else where the line is; none where it is nowhere. @param {number[]} middle on the screen @param {number[]} by half of the stretch */
export function stretch(middle, by) {
    let [first, last] = [-Infinity, Infinity];
    [WIDTH, HEIGHT].forEach((size, k) => {
        const ends = [12, size - 12].map((edge) => (edge - middle[k]) / by[k]).sort((a, b) => a - b);
        // A line along an edge is within it all the way, or nowhere.
        if (Math.abs(by[k]) < 1e-9) ends.splice(0, 2, ...(middle[k] > 12 && middle[k] < size - 12 ? [-Infinity, Infinity] : [Infinity, -Infinity]));
        [first, last] = [Math.max(first, ends[0]), Math.min(last, ends[1])];
    });
    if (first >= last) return null;
    const low = Math.max(first, Math.min(-1, last - 2));
    return [low, Math.min(last, low + 2)].map((s) => middle.map((c, k) => c + s * by[k]));
}

/** The elements of a line, or of three that stand for all parallel ones, and of its words, and where these are. @param {{at: number[], direction: number[], kind: string, text: string}} line @param {import("./picture.mjs").Picture} picture @param {import("./labels.mjs").Box[]} taken */
function drawn({ at, direction, kind, text }, picture, taken) {
    const { view, arm } = picture;
    const middle = view.project(at);
    const by = view.projectDirection(scale(direction, 0.35 * arm.size));
    const links = arm.points.map((point) => view.project(point)).flatMap((to, k, all) => [0, 0.25, 0.5, 0.75].map((s) => to.map((c, i) => c + s * ((all[k - 1] ?? to)[i] - c))));
    const place = (places, words, points) => {
        const { box, at } = settle(words, places, view.pixel, taken, points);
        taken.push(box);
        return svg("text", at, words);
    };
    /** @param {number[]} end @param {boolean} right */
    const around = ([x, y], right) => [-8, 16 * view.pixel + 2, -24, 34 * view.pixel].map((off) => ({ x: x + (right ? -4 : 4), y: y + off, end: right }));
    if (Math.hypot(...by) < 8) {
        // A line towards the reader.
        const [x, y] = middle;
        if (x < 0 || x > WIDTH || y < 0 || y > HEIGHT) return [];
        const mark = svg("path", { d: `M${x - 8} ${y}a8 8 0 1 0 16 0a8 8 0 1 0 -16 0M${x - 1} ${y}h2` });
        const beside = [-10, 22, -30, 42, -50, 62, -70].flatMap((off) => [14, -14].map((by) => ({ x: x + by, y: y + off * view.pixel, end: by < 0 })));
        return [mark, place(beside, `${text}, seen along ${kind === "turn" ? "them" : "it"}`, links)];
    }
    const aside = [-by[1], by[0]].map((c) => (c * BESIDE) / Math.hypot(...by));
    const all = (kind === "turn" ? [0, -1, 1] : [0]).flatMap((s) => stretch(middle.map((c, k) => c + s * aside[k]), by) ?? []);
    if (all.length === 0) return [];
    const [[x, y], [u, v]] = all;
    const d = all.map((end, k) => (k % 2 ? "L" : "M") + end.map((c) => c.toFixed(1)).join(" ")).join("");
    const lines = all.flatMap((end, k) => (k % 2 ? Array.from({ length: 41 }, (_, i) => end.map((c, j) => c + ((all[k - 1][j] - c) * i) / 40)) : []));
    const points = [...links, ...lines];
    const places = [[u, v], [x, y]].flatMap((end) => [...around(end, end[0] > WIDTH / 2), ...around(end, end[0] <= WIDTH / 2)]);
    return [svg("path", { d }), place([...places, ...around([(x + u) / 2, (y + v) / 2], false)], text, points)];
}

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function lostMotion(data, state, picture) {
    const [said, because] = [byId("lost-motion"), byId("singular-why")];
    const slides = data.rows.map((row) => row.type === "prismatic");
    const layer = picture.layers.lost;
    /** @type {{at: number[], direction: number[], kind: string, text: string}[]} */
    let lines = [];
    const draw = () => {
        const shown = byId("show-lost").checked ? lines.filter(({ at }) => norm(at) < 3 * picture.arm.size) : [];
        if (shown.length === 0 && !layer.firstChild) return;
        const taken = picture.texts("lost");
        const others = taken.length;
        layer.replaceChildren(...shown.flatMap((line) => drawn(line, picture, taken)));
        picture.labels.lost = taken.slice(others);
    };
    const write = (element, text) => element.textContent !== text && (element.textContent = text);
    state.on("singular", () => {
        lines = [];
        let [text, why] = ["", ""];
        if (state.singular > 0 && data.task.length <= data.rows.length) {
            const jacobian = robot.geometricJacobian(state.q);
            const { most, of } = lost(data.task.map((row) => jacobian[row]));
            const names = data.task.map((row) => VELOCITY[row]);
            const all = of.map((one) => combination(one, names));
            text = most === 0 ? `Lost: whatever the rates, ${all.map((one) => `${one} = 0`).join(", and ")}.` : `Nearly lost: ${all[0]}, at most ${short(Number(most.toPrecision(3)))} for rates of norm 1.`;
            const tip = origin(robot.directKinematics(state.q));
            lines = of.map((one) => line(VELOCITY.map((_, row) => (data.task.includes(row) ? one[data.task.indexOf(row)] : 0)), tip, most > 0));
            // A column of J is the axis of a joint unless joints are coupled.
            if (state.singular === 2 && !data.links) why = reason(axes(jacobian, slides, tip), data.task, lines, picture.arm.size, tip);
        }
        write(said, text);
        write(because, why);
        draw();
    });
    picture.extras.push(draw);
    byId("show-lost").addEventListener("input", draw);
}

/** Why, in a sentence; empty where it is nothing that is looked for. @param {import("./dependent_axes.mjs").Axis[]} all @param {number[]} task @param {{at: number[], direction: number[], kind: string}[]} lines @param {number} size @param {number[]} tip */
function reason(all, task, lines, size, tip) {
    const straight = lines.find(({ kind }) => kind !== "screw");
    const words = dependentAxes(all, task.length, size, task.every((row) => row < 3) ? tip : null) || (straight ? axesAtLine(all, straight, size) : "");
    return words && `Why: ${words}.`;
}
