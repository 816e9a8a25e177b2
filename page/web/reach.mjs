/**
 * How far the end effector comes within the ranges of the joints, one joint at a time: while the others rest, its tip is at
 *
 *   c + a cos q + b sin q,  or  c + a q  of a joint that slides,
 *
 * which three postures tell; the joint is set to where that is farthest, until no joint gains anything. A search can end at less than the farthest.
 */

import { range } from "./state.mjs";

/** Postures from which the farthest is searched, and times that each joint is set at most. */
const STARTS = 4;
const ROUNDS = 200;
/** Steps of a range that are looked at first. */
const STEPS = 24;

/**
 * The largest value of a function of the tip's position.
 *
 * @param {any[]} rows @param {(q: number[]) => number[]} tip @param {{q: number[], p: number[]}[]} samples @param {(p: number[]) => number} of
 */
function most(rows, tip, samples, of) {
    const starts = samples.map(({ q, p }) => ({ q: q.slice(), value: of(p) })).sort((a, b) => b.value - a.value).slice(0, STARTS);
    for (const start of starts) {
        for (let round = 0; round < ROUNDS; round++) {
            const before = start.value;
            rows.forEach((row, i) => set(row, i, start.q, tip, of));
            start.value = of(tip(start.q));
            if (start.value - before <= 1e-9 * Math.abs(start.value)) break;
        }
    }
    return Math.max(...starts.map(({ value }) => value));
}

/** Sets joint i to where a function of the tip's position is largest. @param {any} row @param {number} i @param {number[]} q @param {(q: number[]) => number[]} tip @param {(p: number[]) => number} of */
function set(row, i, q, tip, of) {
    const turns = row.type === "revolute";
    const at = (x) => tip(q.map((other, k) => (k === i ? x : other)));
    const [p, r, s] = turns ? [0, Math.PI / 2, Math.PI].map(at) : [0, 1, 0].map(at);
    const c = p.map((x, k) => (x + s[k]) / 2);
    const go = (x) => of(c.map((m, k) => (turns ? m + (p[k] - m) * Math.cos(x) + (r[k] - m) * Math.sin(x) : m + (r[k] - m) * x)));
    const [low, high] = range(row);
    let [best, step] = [q[i], (high - low) / STEPS];
    let value = go(best);
    const look = (x) => {
        if (x < low || x > high || go(x) <= value) return;
        [best, value] = [x, go(x)];
    };
    for (let k = 0; k <= STEPS; k++) look(k === STEPS ? high : low + k * step);
    for (; step > 1e-9 * (high - low); step /= 2) [best - step, best + step].forEach(look);
    q[i] = best;
}

/** The farthest from the origin, and the least and the most of the distance from the z axis and of x, y and z. @param {any[]} rows @param {(q: number[]) => number[]} tip @param {{q: number[], p: number[]}[]} samples postures and where the tip is there */
export function extremes(rows, tip, samples) {
    const ends = (of) => [-1, 1].map((sign) => sign * most(rows, tip, samples, (p) => sign * of(p)));
    const away = ([x, y]) => Math.hypot(x, y);
    return { reach: most(rows, tip, samples, (p) => Math.hypot(...p)), away: ends(away), axes: [0, 1, 2].map((k) => ends((p) => p[k])) };
}
