/**
 * Points and directions as arrays of three numbers, frames as arrays of three (or four) rows of four.
 *
 * @typedef {number[]} Vector
 * @typedef {number[][]} Frame
 */

/** @param {Vector} a @param {Vector} b */
export function add(a, b) {
    return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

/** @param {Vector} a @param {Vector} b */
export function subtract(a, b) {
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

/** @param {Vector} a @param {number} s */
export function scale(a, s) {
    return [a[0] * s, a[1] * s, a[2] * s];
}

/** @param {Vector} a @param {Vector} b */
export function dot(a, b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** @param {Vector} a @param {Vector} b */
export function cross(a, b) {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** @param {Vector} a */
export function norm(a) {
    return Math.hypot(a[0], a[1], a[2]);
}

/** a + s b. @param {Vector} a @param {number} s @param {Vector} b */
export function along(a, s, b) {
    return [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
}

/** Any unit vector perpendicular to a unit vector. @param {Vector} a */
export function perpendicular(a) {
    const other = Math.abs(a[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
    const side = cross(a, other);
    return scale(side, 1 / norm(side));
}

/** No rotation, no translation. @returns {Frame} */
export function identity() {
    return [
        [1, 0, 0, 0],
        [0, 1, 0, 0],
        [0, 0, 1, 0],
    ];
}

/** The frame `b`, given in `a`, in the frame that `a` is given in. @param {Frame} a @param {Frame} b @returns {Frame} */
export function compose(a, b) {
    return [0, 1, 2].map((i) =>
        [0, 1, 2, 3].map((j) => a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + (j === 3 ? a[i][3] : 0)),
    );
}

/** A column of a frame: its axes are 0, 1, 2, its origin 3. @param {Frame} frame @param {number} j @returns {Vector} */
export function column(frame, j) {
    return [frame[0][j], frame[1][j], frame[2][j]];
}

/** @param {Frame} frame @returns {Vector} */
export function origin(frame) {
    return column(frame, 3);
}

/** A point of a frame in the outer one. @param {Frame} frame @param {Vector} point @returns {Vector} */
export function place(frame, point) {
    return add(direct(frame, point), origin(frame));
}

/** A direction of a frame in the outer one. @param {Frame} frame @param {Vector} v @returns {Vector} */
export function direct(frame, v) {
    return [0, 1, 2].map((i) => frame[i][0] * v[0] + frame[i][1] * v[1] + frame[i][2] * v[2]);
}

/** A rotation about a unit vector. @param {Vector} axis @param {number} angle @returns {Frame} */
export function rotation(axis, angle) {
    const [x, y, z] = axis;
    const [s, c] = [Math.sin(angle), Math.cos(angle)];
    const t = 1 - c;
    return [
        [c + t * x * x, t * x * y - s * z, t * x * z + s * y, 0],
        [t * x * y + s * z, c + t * y * y, t * y * z - s * x, 0],
        [t * x * z - s * y, t * y * z + s * x, c + t * z * z, 0],
    ];
}

/** A translation. @param {Vector} by @returns {Frame} */
export function translation(by) {
    return [
        [1, 0, 0, by[0]],
        [0, 1, 0, by[1]],
        [0, 0, 1, by[2]],
    ];
}
