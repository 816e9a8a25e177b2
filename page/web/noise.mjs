/** What rounding leaves of sums whose terms cancel: it is shown as 0. */

import { ROUNDING } from "./linear.mjs";

/** What rounding leaves of terms that are as large as 1. */
const NOISE = 16 * ROUNDING;

/**
 * A number as it is shown: 0 where it is no more than rounding leaves of the terms of its size that it is the sum of.
 *
 * @param {{size?: (row: number, column: number) => number} | undefined} quantity @param {number} value @param {number} row from 0 @param {number} column
 */
export function withoutNoise(quantity, value, row, column) {
    return Math.abs(value) <= NOISE * (quantity?.size?.(row, column) ?? 0) ? 0 : value;
}

/** How large the terms of each quantity are, of which entries are sums. @param {any} data @param {import("./state.mjs").State} state @param {number} length of the arm, m */
export function sizes(data, state, length) {
    const mass = data.bodies.reduce((sum, body) => sum + body.mass, 0);
    /** A joint that turns moves the arm's length a unit, one that slides 1. */
    const lever = data.rows.map((row) => (row.type === "revolute" ? length : 1));
    const speed = () => Math.max(0, ...state.dq.map((x, i) => Math.abs(x) * lever[i]));
    const acceleration = () => Math.max(0, ...state.ddq.map((x, i) => Math.abs(x) * lever[i])) + (length > 0 ? speed() ** 2 / length : 0);
    const weight = () => mass * Math.hypot(...data.gravity);
    return {
        pose: (_, j) => (j === 3 ? length : 1),
        jacobian: (i, j) => (i > 2 ? 1 : lever[j]),
        inertia: (i, j) => mass * lever[i] * lever[j],
        coriolis: (i, j) => (mass * lever[i] * lever[j] * speed()) / length,
        gravity: (i) => weight() * lever[i],
        torque: (i) => (weight() + mass * acceleration()) * lever[i],
        energy: () => weight() * length,
    };
}
