/**
 * Bodies as they are drawn: the cuboid of even density that has the mass and the inertia.
 *
 * With edges a, b, c along its principal axes I1 = m (b² + c²)/12 and so on, so a² = 6 (I2 + I3 - I1)/m. A tensor that no body has gives a
 * square below 0; such an edge is drawn as 0.
 */

import { eigen } from "./linear.mjs";

/** @typedef {{name: string, frame: number | "e", mass: number, com: number[], inertia: number[]}} Body */

/** The orders of three things, those that turn them before those that exchange two. */
const ORDERS = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [2, 1, 0], [0, 2, 1]];

/**
 * Which principal axis is at each axis of the frame: the order in which they are nearest to these altogether.
 *
 * @param {number[][]} vectors the principal axes, as columns
 */
function nearest(vectors) {
    const fit = (order) => order.reduce((sum, k, axis) => sum + Math.abs(vectors[axis][k]), 0);
    return ORDERS.reduce((best, order) => (fit(order) > fit(best) + 1e-9 ? order : best));
}

/**
 * The cuboid: its edges, each at the axis of its carrier's frame that it is nearest to, and its frame in that of its carrier; none without
 * mass.
 *
 * @param {Body} body
 */
export function cuboid(body) {
    const [xx, xy, yy, xz, yz, zz] = body.inertia;
    if (!(body.mass > 0)) return null;
    const principal = eigen([
        [xx, xy, xz],
        [xy, yy, yz],
        [xz, yz, zz],
    ]);
    const order = nearest(principal.vectors);
    const values = order.map((k) => principal.values[k]);
    const vectors = principal.vectors.map((row) => order.map((k) => row[k]));
    const sum = values[0] + values[1] + values[2];
    const squares = values.map((value) => (6 * (sum - 2 * value)) / body.mass);
    // Rounding of a rod or a plate is no fault of the tensor.
    const largest = Math.max(...values.map(Math.abs));
    const possible = squares.every((square) => square * body.mass >= -6e-9 * largest);
    const edges = squares.map((square) => Math.sqrt(Math.max(0, square)));
    // A right-handed frame: the third direction is the product of the others.
    const [x, y] = [0, 1].map((j) => vectors.map((row) => row[j]));
    const z = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    const frame = [0, 1, 2].map((i) => [x[i], y[i], z[i], body.com[i]]);
    const volume = edges[0] * edges[1] * edges[2];
    return { edges, frame, possible, density: volume > 0 ? body.mass / volume : Infinity, empty: largest === 0 };
}
