import assert from "node:assert/strict";
import test from "node:test";

import { frames } from "../suspects.mjs";
import { posturesAt } from "../search.mjs";
import { column, compose, cross, identity, origin, subtract } from "../vector.mjs";

const RIGHT = Math.PI / 2;
/** An arm of standard rows a, alpha, d, theta, as the emitted module would be. */
function module(rows) {
    const arm = { convention: "standard", base: identity(), tool: identity(), signs: rows.map(() => 1), rows: rows.map((dh) => ({ type: "revolute", dh })) };
    const geometricJacobian = (q) => {
        const { links, end } = frames(arm, q);
        const columns = q.map((_, i) => {
            const before = i === 0 ? arm.base : links[i - 1];
            const axis = column(before, 2);
            return [...cross(axis, subtract(origin(end), origin(before))), ...axis];
        });
        return [0, 1, 2, 3, 4, 5].map((i) => columns.map((one) => one[i]));
    };
    return { directKinematics: (q) => frames(arm, q).end, geometricJacobian };
}
const joints = (n, limits = null) => Array.from({ length: n }, () => ({ type: "revolute", limits }));
const PUMA = [[0, RIGHT, 0, 0], [0.4318, 0, 0, 0], [0.0203, -RIGHT, 0.15005, 0], [0, RIGHT, 0.4318, 0], [0, -RIGHT, 0, 0], [0, 0, 0, 0]];
const PANDA = [[0, -RIGHT, 0.333, 0], [0, RIGHT, 0, 0], [0.0825, RIGHT, 0.316, 0], [0.0825, RIGHT, 0, 2 * RIGHT], [0, -RIGHT, 0.384, 0], [0.088, RIGHT, 0, 2 * RIGHT], [0, 0, 0.107, 0]];
const WHOLE = [0, 1, 2, 3, 4, 5];

/** Each posture reaches the pose, and none is there twice. */
function held(arm, found, size) {
    const target = arm.directKinematics(found[0]);
    for (const q of found) {
        arm.directKinematics(q).forEach((row, i) => row.forEach((x, j) => assert.ok(Math.abs(x - target[i][j]) < 1e-9 * size, `${q}`)));
    }
    found.forEach((q, i) => found.slice(0, i).forEach((other) => assert.ok(q.some((x, k) => Math.abs(Math.sin((x - other[k]) / 2)) > 1e-4))));
}

test("the other posture of two links has the elbow on the other side", () => {
    const [first, second] = [0.5, 0.3];
    const arm = module([[first, 0, 0, 0], [second, 0, 0, 0]]);
    const q = [0.4, 1.1];
    const found = posturesAt(arm, joints(2), [0, 1], q, null, 0.8);
    assert.equal(found.length, 2);
    // Seen from the shoulder both have the tip at the angle q1 + b, b = atan2(a2 s2, a1 + a2 c2).
    const b = Math.atan2(second * Math.sin(q[1]), first + second * Math.cos(q[1]));
    assert.deepEqual(found[1].map((x) => Number(x.toFixed(9))), [q[0] + 2 * b, -q[1]].map((x) => Number(x.toFixed(9))));
});

test("a Puma has eight postures, a Panda some with its last joint held, and a stretched wrist no list of them", () => {
    const puma = module(PUMA);
    for (const q of [[0.5, 0.7, -2.2, 0.9, 1.1, -0.4], [-1, 0.2, 0.3, 2, -0.7, 0.1]]) {
        const found = posturesAt(puma, joints(6), WHOLE, q, null, 1.4);
        assert.equal(found.length, 8);
        held(puma, found, 1);
    }
    assert.equal(posturesAt(puma, joints(6), WHOLE, [0.5, 0.7, -2.2, 0.9, 0, -0.4], null, 1.4), undefined);
    const panda = module(PANDA);
    const q = [0.3, -0.5, 0.2, -1.9, 0.4, 1.6, 0.7];
    const found = posturesAt(panda, joints(7), WHOLE, q, 6, 1.3);
    assert.ok(found.length >= 4 && found.every((other) => Math.abs(other[6] - 0.7) < 1e-12), `${found.length}`);
    held(panda, found, 1);
});

test("a posture is within limits where a turn more or less brings it there", () => {
    const arm = module([[0.5, 0, 0, 0], [0.3, 0, 0, 0]]);
    const [, other] = posturesAt(arm, joints(2, [0, 6.2]), [0, 1], [0.4, 1.1], null, 0.8);
    assert.ok(Math.abs(other[1] - (2 * Math.PI - 1.1)) < 1e-9, `${other}`);
});
