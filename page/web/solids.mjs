/**
 * Solids in an orthographic view. A cylinder is its silhouette: two lines and two half ellipses, shaded across, and the ellipse of the end
 * that is nearer. A box is its faces that look towards the viewer. Each solid gives its depth, by which they are drawn from behind.
 */

import { column, dot, norm, origin, subtract } from "./vector.mjs";
import { set, svg } from "./dom.mjs";

/** Digits of coordinates on the screen. @param {number} x */
function pixel(x) {
    return Math.round(x * 100) / 100;
}

export class Cylinder {
    /** @param {number} radius @param {string} kind its class: what it is a part of */
    constructor(radius, kind) {
        this.radius = radius;
        this.from = [0, 0, 0];
        this.to = [0, 0, 0];
        this.body = svg("path", { class: "body" });
        this.cap = svg("ellipse", { class: "cap" });
        this.element = svg("g", { class: `solid ${kind}` }, this.body, this.cap);
    }

    /** @param {number[]} from @param {number[]} to */
    between(from, to) {
        this.from = from;
        this.to = to;
    }

    /** @param {import("./view.mjs").View} view */
    draw(view) {
        const axis = subtract(this.to, this.from);
        const length = norm(axis);
        const r = pixel(this.radius * view.scale);
        if (length === 0) {
            this.element.setAttribute("display", "none");
            return -Infinity;
        }
        this.element.removeAttribute("display");
        const [x, y] = view.project(this.from);
        const [u, v] = view.projectDirection(axis);
        const shown = pixel(Math.hypot(u, v));
        const toward = dot(axis, view.toward) / length;
        const narrow = pixel(r * Math.abs(toward));
        const angle = shown === 0 ? 0 : (Math.atan2(v, u) * 180) / Math.PI;
        this.element.setAttribute("transform", `translate(${pixel(x)} ${pixel(y)}) rotate(${pixel(angle)})`);
        const arc = `A${narrow} ${r} 0 0 1`;
        this.body.setAttribute("d", `M0 ${-r}L${shown} ${-r}${arc} ${shown} ${r}L0 ${r}${arc} 0 ${-r}Z`);
        set(this.cap, { cx: toward > 0 ? shown : 0, cy: 0, rx: narrow, ry: r });
        return (view.depth(this.from) + view.depth(this.to)) / 2;
    }
}

export class Ball {
    /** @param {number} radius @param {string} kind */
    constructor(radius, kind) {
        this.radius = radius;
        this.at = [0, 0, 0];
        this.element = svg("circle", { class: `solid ${kind} ball` });
    }

    /** @param {import("./view.mjs").View} view */
    draw(view) {
        const [x, y] = view.project(this.at);
        set(this.element, { cx: pixel(x), cy: pixel(y), r: pixel(this.radius * view.scale) });
        return view.depth(this.at);
    }
}

export class Box {
    /** @param {string} kind */
    constructor(kind) {
        this.frame = [];
        this.half = [0, 0, 0];
        this.faces = [0, 1, 2].map((i) => svg("path", { class: `face face-${i}` }));
        this.element = svg("g", { class: `solid ${kind}` }, ...this.faces);
    }

    /** @param {number[][]} frame its middle and the directions of its edges @param {number[]} half half of its edges */
    place(frame, half) {
        this.frame = frame;
        this.half = half;
    }

    /** @param {import("./view.mjs").View} view */
    draw(view) {
        const middle = origin(this.frame);
        const axes = [0, 1, 2].map((i) => column(this.frame, i));
        const [x, y] = view.project(middle);
        const edges = axes.map((axis, i) => view.projectDirection(axis).map((c) => c * this.half[i]));
        for (let i = 0; i < 3; i++) {
            const side = Math.sign(dot(axes[i], view.toward)) || 1;
            const [j, k] = [(i + 1) % 3, (i + 2) % 3];
            const corner = (a, b) => {
                const at = (c) => (c === 0 ? x : y) + side * edges[i][c] + a * edges[j][c] + b * edges[k][c];
                return `${pixel(at(0))} ${pixel(at(1))}`;
            };
            this.faces[i].setAttribute("d", `M${corner(-1, -1)}L${corner(1, -1)}L${corner(1, 1)}L${corner(-1, 1)}Z`);
        }
        return view.depth(middle);
    }
}

/** Draws solids, those behind first; the document is touched only where the order changes. @param {Element} layer @param {any[]} solids @param {any} view */
export function drawSolids(layer, solids, view) {
    const depths = new Map(solids.map((solid) => [solid.element, solid.draw(view)]));
    const sorted = [...depths.keys()].sort((a, b) => depths.get(a) - depths.get(b));
    const children = layer.children;
    if (children.length !== sorted.length || sorted.some((element, i) => children[i] !== element)) layer.replaceChildren(...sorted);
}
