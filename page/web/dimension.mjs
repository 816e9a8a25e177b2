/**
 * A row drawn as on a sheet: lengths as dimension lines with arrow heads and value, angles as arcs between the axes before and after, in
 * the order of the convention.
 */

import { set, svg } from "./dom.mjs";
import { withUnit } from "./format.mjs";
import { settle } from "./labels.mjs";
import { links, motion, order, PLACES } from "./kinematics.mjs";
import { along, column, compose, cross, direct, norm, origin, rotation, subtract } from "./vector.mjs";

const TITLES = { a: "a", alpha: "α", d: "d", theta: "θ" };

/** A path through points. @param {any} view @param {number[][]} points */
function path(view, points) {
    return points.map((point, i) => (i === 0 ? "M" : "L") + view.project(point).map((x) => x.toFixed(1)).join(" ")).join("");
}

/** An arrow head at the end of a line on the screen. @param {number[]} from @param {number[]} to */
function head(from, to) {
    const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
    const wing = (turn) => `${(to[0] - 9 * Math.cos(angle + turn)).toFixed(1)} ${(to[1] - 9 * Math.sin(angle + turn)).toFixed(1)}`;
    return `M${wing(0.35)}L${to.map((x) => x.toFixed(1)).join(" ")}L${wing(-0.35)}`;
}

/** A text at a point, which {@link lay} moves to where it hides least. @param {any} view @param {number[]} at @param {string} content */
function label(view, at, content) {
    const [x, y] = view.project(at);
    return svg("text", { x: x.toFixed(1), y: (y - 5).toFixed(1), class: "dimension-text" }, content);
}

/** Lays texts inside of the picture, each below those that it would cover. @param {Element[]} elements @param {number} pixel how much larger texts are than 13 units @param {import("./labels.mjs").Box[]} taken */
function lay(elements, pixel, taken) {
    for (const text of elements.filter((element) => element.tagName === "text")) {
        const at = (name) => Number(text.getAttribute(name));
        const below = Array.from({ length: 12 }, (_, k) => ({ x: at("x"), y: at("y") + 6 * k * pixel, end: false }));
        const { box, at: place } = settle(text.textContent ?? "", below, 1.08 * pixel, taken);
        taken.push(box);
        set(text, place);
    }
    return elements;
}

/** @param {any} view @param {number[]} from @param {number[]} to @param {string} content */
function length(view, from, to, content) {
    const [a, b] = [view.project(from), view.project(to)];
    const middle = from.map((x, i) => (x + to[i]) / 2);
    const seen = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const parts = [svg("path", { d: path(view, [from, to]) })];
    if (seen > 4) parts.push(svg("path", { d: head(a, b) }), svg("path", { d: head(b, a) }));
    parts.push(label(view, middle, content));
    return parts;
}

/** @param {any} view @param {number[]} centre @param {number[]} axis @param {number[]} from a unit vector @param {number} angle @param {number} radius @param {string} content */
function arc(view, centre, axis, from, angle, radius, content) {
    const steps = Math.max(2, Math.ceil(Math.abs(angle) / 0.1));
    const at = (t) => along(centre, radius, direct(rotation(axis, t), from));
    const points = Array.from({ length: steps + 1 }, (_, i) => at((angle * i) / steps));
    const parts = [
        svg("path", { class: "ray", d: path(view, [centre, along(centre, 1.25 * radius, from)]) }),
        svg("path", { class: "ray", d: path(view, [centre, along(centre, 1.25, subtract(at(angle), centre))]) }),
        svg("path", { d: path(view, points) }),
    ];
    if (angle !== 0) {
        const [a, b] = [view.project(points[steps - 1]), view.project(points[steps])];
        parts.push(svg("path", { d: head(a, b) }));
    }
    parts.push(label(view, along(centre, 1.3, subtract(at(angle / 2), centre)), content));
    return parts;
}


/**
 * The elements that draw row i, which starts at a frame.
 *
 * @param {any} view
 * @param {any} data
 * @param {number} i
 * @param {number[][]} start
 * @param {number} q
 * @param {number} size of the arm
 * @param {import("./labels.mjs").Box[]} taken by other texts
 */
export function dimensions(view, data, i, start, q, size, taken) {
    const row = links(data)[i];
    const radius = 0.09 * size;
    const elements = [];
    if (row.dh) {
        let frame = start;
        for (const kind of order(data.convention)) {
            const moved = kind === (row.type === "revolute" ? "theta" : "d");
            const value = row.dh[PLACES[kind]] + (moved ? q : 0);
            const next = compose(frame, motion(kind, value));
            const unit = kind === "a" || kind === "d" ? "m" : "rad";
            const content = `${TITLES[kind]} = ${withUnit(value, unit)}`;
            if (unit === "m") {
                if (value !== 0) elements.push(...length(view, origin(frame), origin(next), content));
            } else if (value !== 0 || moved) {
                const [axis, side] = kind === "theta" ? [2, 0] : [0, 2];
                elements.push(...arc(view, origin(frame), column(frame, axis), column(frame, side), value, radius, content));
            }
            frame = next;
        }
        return lay(elements, view.pixel, taken);
    }
    let frame = start;
    for (const before of row.before) {
        const by = origin(before);
        ["x", "y", "z"].forEach((name, k) => {
            if (by[k] === 0) return;
            const from = origin(frame);
            const to = along(from, by[k], column(frame, k));
            elements.push(...length(view, from, to, `${name} = ${withUnit(by[k], "m")}`));
            frame = frame.map((r, m) => [r[0], r[1], r[2], to[m]]);
        });
        frame = compose(frame, before.map((r) => [r[0], r[1], r[2], 0]));
    }
    const axis = direct(frame, row.axis);
    if (row.type === "prismatic") {
        elements.push(...length(view, origin(frame), along(origin(frame), q, axis), `q = ${withUnit(q, "m")}`));
    } else {
        const other = Math.abs(row.axis[2]) < 0.9 ? column(frame, 2) : column(frame, 0);
        const side = cross(cross(axis, other), axis);
        const unit = side.map((x) => x / (norm(side) || 1));
        elements.push(...length(view, along(origin(frame), -2 * radius, axis), along(origin(frame), 2 * radius, axis), "axis"));
        elements.push(...arc(view, origin(frame), axis, unit, q, radius, `q = ${withUnit(q, "rad")}`));
    }
    return lay(elements, view.pixel, taken);
}
