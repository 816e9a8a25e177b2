/**
 * Frames of rows, by multiplication: what a row means step by step, for drawings of rows and for rows that are not those of the file.
 * The frames of the robot itself come from the emitted module.
 *
 * standard: A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)
 * modified: A_i = Rx(alpha) Tx(a) Rz(theta) Tz(d)
 * urdf:     A_i = origin · motion about or along the axis
 */

import { compose, rotation, translation } from "./vector.mjs";

/**
 * @typedef {{type: string, dh: number[] | null, before: number[][][], axis: number[], after: number[][][], limits: number[] | null,
 *     name: string}} Row
 * @typedef {{kind: "a" | "alpha" | "d" | "theta", value: number}} Move a motion along or about x (a, alpha) or z (d, theta)
 */

const X = [1, 0, 0];
const Z = [0, 0, 1];

/** The rows of all joints; `data.rows` are those of the coordinates, fewer where joints are coupled. @param {any} data @returns {Row[]} */
export function links(data) {
    return data.links ?? data.rows;
}

/** The variables of all joints. @param {any} data @param {number[]} q coordinates */
export function variables(data, q) {
    return data.links ? robot.jointVariables(q) : q;
}

/** The order of the motions of a convention. @param {string} convention */
export function order(convention) {
    return convention === "standard" ? ["theta", "d", "a", "alpha"] : ["alpha", "a", "theta", "d"];
}

/** The place of a value in a row. */
export const PLACES = { a: 0, alpha: 1, d: 2, theta: 3 };

/** The frame of one motion. @param {string} kind @param {number} value */
export function motion(kind, value) {
    switch (kind) {
        case "a":
            return translation([value, 0, 0]);
        case "d":
            return translation([0, 0, value]);
        case "alpha":
            return rotation(X, value);
        default:
            return rotation(Z, value);
    }
}

/**
 * The frame of a row of Denavit and Hartenberg in the one before it.
 *
 * @param {string} convention
 * @param {number[]} dh a, alpha, d, theta
 * @param {boolean} revolute
 * @param {number} q
 */
export function rowFrame(convention, dh, revolute, q) {
    const [a, alpha] = dh;
    const d = revolute ? dh[2] : dh[2] + q;
    const theta = revolute ? dh[3] + q : dh[3];
    const [sa, ca, st, ct] = [Math.sin(alpha), Math.cos(alpha), Math.sin(theta), Math.cos(theta)];
    if (convention === "standard") {
        return [
            [ct, -st * ca, st * sa, a * ct],
            [st, ct * ca, -ct * sa, a * st],
            [0, sa, ca, d],
        ];
    }
    return [
        [ct, -st, 0, a],
        [st * ca, ct * ca, -sa, -d * sa],
        [st * sa, ct * sa, ca, d * ca],
    ];
}

/** The frame of a row of a URDF in the one before it. @param {Row} row @param {number} q */
export function urdfFrame(row, q) {
    const before = row.before.reduce(compose, translation([0, 0, 0]));
    const moved = row.type === "revolute" ? rotation(row.axis, q) : translation(row.axis.map((x) => x * q));
    return compose(before, moved);
}
