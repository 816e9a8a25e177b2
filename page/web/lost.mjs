/**
 * Which motion is lost at a singular posture: combinations u of the rows of J with u' J = 0, in words and as lines in the picture.
 *
 * u = (f, m) is a wrench at the tip that no torque answers. Its line goes through r = tip + f x m / |f|² along f, and its pitch is
 * h = f·m / |f|²: with h = 0 no point of the line moves along it, with f = 0 there is no turn about m.
 */

import { byId, svg } from "./dom.mjs";
import { short } from "./format.mjs";
import { lost } from "./linear.mjs";
import { add, along, cross, dot, norm, origin, scale } from "./vector.mjs";
import { HEIGHT, WIDTH } from "./view.mjs";

export const VELOCITY = ["vx", "vy", "vz", "ωx", "ωy", "ωz"];

/** As a sum: vx − 0.5 ωz. @param {number[]} of one number for each row @param {string[]} names */
export function combination(of, names) {
    const terms = of.flatMap((x, k) => (x === 0 ? [] : [{ x, text: Math.abs(x) === 1 ? names[k] : `${short(Number(Math.abs(x).toPrecision(4)))} ${names[k]}` }]));
    return terms.map(({ x, text }, k) => (k === 0 ? (x < 0 ? "−" : "") : x < 0 ? " − " : " + ") + text).join("");
}

/** The line of a wrench at the tip, and what does not happen at it; `hardly` of a posture that is nearly singular. @param {number[]} wrench @param {number[]} tip @param {boolean} hardly */
export function line(wrench, tip, hardly) {
    const [f, m] = [wrench.slice(0, 3), wrench.slice(3)];
    const no = hardly ? "hardly any" : "no";
    if (norm(f) === 0) return { at: tip, direction: scale(m, 1 / norm(m)), text: `${no} turn about this line` };
    const pitch = dot(f, m) / dot(f, f);
    const rest = Math.abs(pitch) < 1e-6 * Math.max(norm(m) / norm(f), 1e-3);
    const text = rest ? `${no} motion along this line` : `v ${pitch < 0 ? "−" : "+"} ${short(Number(Math.abs(pitch).toPrecision(4)))} ω along this line ${hardly ? "hardly moves" : "stays 0"}`;
    return { at: add(tip, scale(cross(f, m), 1 / dot(f, f))), direction: scale(f, 1 / norm(f)), text };
}

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function lostMotion(data, state, picture) {
    const said = byId("lost-motion");
    const layer = picture.layers.lost;
    /** @type {{at: number[], direction: number[], text: string}[]} */
    let lines = [];
    const draw = () => {
        const size = picture.arm.size;
        const shown = byId("show-lost").checked ? lines.filter(({ at }) => norm(at) < 3 * size) : [];
        if (shown.length === 0 && !layer.firstChild) return;
        const elements = shown.flatMap(({ at: middle, direction, text }, k) => {
            const [[x, y], [u, v]] = [-0.35, 0.35].map((s) => picture.view.project(along(middle, s * size, direction)).map((c) => Math.round(c * 10) / 10));
            const left = u > WIDTH / 2;
            // At the end of the line, or where it leaves the picture.
            const inside = (c, high) => Math.max(20, Math.min(high - 12, c));
            const at = { x: inside(u, WIDTH), y: inside(v - 8 - 16 * k, HEIGHT), "text-anchor": left ? "end" : "start" };
            return [svg("path", { d: `M${x} ${y}L${u} ${v}` }), svg("text", at, text)];
        });
        layer.replaceChildren(...elements);
    };
    state.on("singular", () => {
        lines = [];
        let text = "";
        if (state.singular > 0 && data.task.length <= data.rows.length) {
            const jacobian = robot.geometricJacobian(state.q);
            const { most, of } = lost(data.task.map((row) => jacobian[row]));
            const names = data.task.map((row) => VELOCITY[row]);
            const all = of.map((one) => combination(one, names));
            text = most === 0 ? `Lost: whatever the rates, ${all.map((one) => `${one} = 0`).join(", and ")}.` : `Nearly lost: ${all[0]}, at most ${short(Number(most.toPrecision(3)))} for rates of norm 1.`;
            const tip = origin(robot.directKinematics(state.q));
            lines = of.map((one) => line(VELOCITY.map((_, row) => (data.task.includes(row) ? one[data.task.indexOf(row)] : 0)), tip, most > 0));
        }
        if (said.textContent !== text) said.textContent = text;
        draw();
    });
    picture.extras.push(draw);
    byId("show-lost").addEventListener("input", draw);
}
