/**
 * Postures at a pose, by searching: damped steps of Newton from the places of a fixed sequence, and of what they find each once.
 *
 *   (J'J + mu |e|²) dq = J'e,   e = (p* - p, the rotation vector of R* R'), lengths over the size of the arm
 *
 * A search can miss a posture. That none is missing says what `armgen generate --ik` writes.
 */

import { solve } from "./linear.mjs";
import { add, column, cross, dot, norm, origin, scale, subtract } from "./vector.mjs";

/** Places that the search starts from, and steps from each. */
const STARTS = 600;
const STEPS = 30;
/** More postures than this are never apart from each other: some joints move while the end effector stays. */
export const MOST = 16;

/**
 * Points between 0 and 1 in so many dimensions (Roberts' additive recurrence: the k-th point has the fractional parts of k g^-i, g the root
 * of g^(n+1) = g + 1).
 *
 * @param {number} dimensions @param {number} count
 */
export function sequence(dimensions, count) {
    let g = 1.5;
    for (let i = 0; i < 60; i++) g = (1 + g) ** (1 / (dimensions + 1));
    const steps = Array.from({ length: dimensions }, (_, i) => g ** -(i + 1));
    return Array.from({ length: count }, (_, k) => steps.map((step) => (0.5 + (k + 1) * step) % 1));
}

/** How far a frame is from another: the difference of the origins, and the rotation vector. @param {number[][]} from @param {number[][]} to */
function apart(from, to) {
    let [sine, cosine] = [[0, 0, 0], -0.5];
    for (let j = 0; j < 3; j++) {
        const [a, b] = [column(from, j), column(to, j)];
        sine = add(sine, scale(cross(a, b), 0.5));
        cosine += dot(a, b) / 2;
    }
    const size = norm(sine);
    return [...subtract(origin(to), origin(from)), ...scale(sine, size === 0 ? 0 : Math.atan2(size, cosine) / size)];
}

/** The same angle from -pi on, below pi. @param {number} x */
function turned(x) {
    return x - 2 * Math.PI * Math.floor((x + Math.PI) / (2 * Math.PI));
}

/** The same angle within limits where there is one, else below half a turn. @param {number} x @param {number[] | null} limits */
function settled(x, limits) {
    const angle = turned(x);
    const turns = [0, 1, -1].map((k) => angle + 2 * Math.PI * k);
    return turns.find((turn) => limits && turn >= limits[0] && turn <= limits[1]) ?? angle;
}

/**
 * Whether two postures are nearly the same, turns apart.
 *
 * @param {{type: string}[]} rows @param {number[]} one @param {number[]} other @param {number} size of the arm
 * @param {number} within half an angle, or a length over the size
 */
export function alike(rows, one, other, size, within) {
    return rows.every((row, i) => {
        const by = one[i] - other[i];
        return (row.type === "revolute" ? Math.abs(Math.sin(by / 2)) : Math.abs(by) / size) < within;
    });
}

/**
 * Postures at the pose of `q`, which is the first of them; undefined where they are not apart from each other.
 *
 * @param {{directKinematics: (q: number[]) => number[][], geometricJacobian: (q: number[]) => number[][]}} module
 * @param {{type: string, limits: number[] | null}[]} rows
 * @param {number[]} task the rows of the Jacobian that the arm can choose
 * @param {number[]} q
 * @param {number | null} held a joint that stays as it is, from 0
 * @param {number} size of the arm
 * @returns {number[][] | undefined}
 */
export function posturesAt(module, rows, task, q, held, size) {
    const target = module.directKinematics(q);
    const free = rows.map((_, i) => i).filter((i) => i !== held);
    const unit = (i) => (rows[i].type === "revolute" ? 1 : size);
    const scaled = (e) => e.map((x, i) => (i < 3 ? x / size : x));
    const oriented = task.some((row) => row >= 3);
    const found = [q];
    for (const part of sequence(free.length, STARTS)) {
        const at = q.slice();
        free.forEach((i, k) => {
            const [low, high] = rows[i].type === "revolute" ? [-Math.PI, Math.PI] : (rows[i].limits ?? [-size, size]);
            at[i] = low + part[k] * (high - low);
        });
        for (let step = 0; step < STEPS; step++) {
            const whole = scaled(apart(module.directKinematics(at), target));
            const e = task.map((row) => whole[row]);
            const square = e.reduce((sum, x) => sum + x * x, 0);
            if (square < 1e-24) {
                const all = oriented ? whole : whole.slice(0, 3);
                if (Math.max(...all.map(Math.abs)) > 1e-10) break;
                const posture = at.map((x, i) => (rows[i].type === "revolute" ? settled(x, rows[i].limits) : x));
                if (!found.some((other) => alike(rows, other, posture, size, 1e-4))) found.push(posture);
                if (found.length > MOST) return undefined;
                break;
            }
            const jacobian = module.geometricJacobian(at);
            const j = task.map((row) => free.map((i) => (jacobian[row][i] * unit(i)) / (row < 3 ? size : 1)));
            const normal = free.map((_, a) => free.map((_, b) => j.reduce((sum, row) => sum + row[a] * row[b], 0) + (a === b ? 1e-3 * square : 0)));
            const by = solve(normal, free.map((_, a) => j.reduce((sum, row, k) => sum + row[a] * e[k], 0)));
            if (!by) break;
            const most = Math.max(...by.map(Math.abs));
            free.forEach((i, k) => {
                at[i] += by[k] * unit(i) * Math.min(1, 1 / most);
            });
        }
    }
    return found;
}
