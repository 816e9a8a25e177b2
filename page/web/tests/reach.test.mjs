import assert from "node:assert/strict";
import test from "node:test";

import { extremes } from "../reach.mjs";
import { sequence } from "../search.mjs";

/** Where the first joint is not at a step of its range when the arm points along x. */
const OFFSET = 0.123;
/** Two links of 0.5 and 0.3 m in a plane on a column of 1 m, and a quill below; nothing but their tip. */
const tip = ([a, b, d]) => {
    const [first, second] = [a - OFFSET, a - OFFSET + b];
    return [0.5 * Math.cos(first) + 0.3 * Math.cos(second), 0.5 * Math.sin(first) + 0.3 * Math.sin(second), 1 - d];
};
const rows = (first, second) => [{ type: "revolute", limits: first }, { type: "revolute", limits: second }, { type: "prismatic", limits: [0.1, 0.4] }];
const samples = (rows) =>
    sequence(3, 200).map((part) => {
        const q = rows.map(({ limits }, i) => {
            const [low, high] = limits ?? [-Math.PI, Math.PI];
            return low + part[i] * (high - low);
        });
        return { q, p: tip(q) };
    });

/** @param {number} found @param {number} expected */
function near(found, expected) {
    assert.ok(Math.abs(found - expected) < 1e-7, `${found}, not ${expected}`);
}

test("an arm that turns about z comes as far in every direction", () => {
    const free = rows(null, null);
    const { reach, away, axes } = extremes(free, tip, samples(free));
    near(reach, Math.hypot(0.8, 0.9));
    [0.2, 0.8].forEach((x, k) => near(away[k], x));
    for (const axis of axes.slice(0, 2)) [-0.8, 0.8].forEach((x, k) => near(axis[k], x));
    [0.6, 0.9].forEach((x, k) => near(axes[2][k], x));
});

test("limits are where they are", () => {
    const limited = rows([OFFSET, OFFSET + Math.PI / 2], [0.5, 1]);
    const { away, axes } = extremes(limited, tip, samples(limited));
    // The law of cosines at both limits of the elbow.
    [1, 0.5].forEach((b, k) => near(away[k], Math.sqrt(0.34 + 0.3 * Math.cos(b))));
    near(axes[0][1], 0.5 + 0.3 * Math.cos(0.5));
    near(axes[0][0], 0.3 * Math.cos(Math.PI / 2 + 1));
});
