import assert from "node:assert/strict";
import test from "node:test";

import { units } from "../format.mjs";
import { asWritten, commonVector, doubtedUnits, explain, frames, read, suspects } from "../suspects.mjs";

const identity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]];
const arm = (rows, convention = "standard") => ({
    convention,
    base: identity,
    tool: identity,
    rows: rows.map((dh, i) => ({ name: `joint${i + 1}`, type: "revolute", dh, before: [], axis: [0, 0, 1], after: [], limits: null })),
});

const RIGHT = Math.PI / 2;
/** The rows a, alpha, d, theta of robots/ur5.yaml, robots/puma560.yaml and robots/panda7.yaml; size: the sum of their lengths. */
const ARMS = {
    ur5: [[0, -RIGHT, 0.089159, 0], [0.425, 0, 0, 0], [0.39225, 0, 0, 0], [0, -RIGHT, 0.10915, 0], [0, RIGHT, 0.09465, 0], [0, 0, 0.0823, 0]],
    puma: [[0, RIGHT, 0, 0], [0.4318, 0, 0, 0], [0.0203, -RIGHT, 0.15005, 0], [0, RIGHT, 0.4318, 0], [0, -RIGHT, 0, 0], [0, 0, 0, 0]],
    panda: [[0, -RIGHT, 0.333, 0], [0, RIGHT, 0, 0], [0.0825, RIGHT, 0.316, 0], [0.0825, RIGHT, 0, 2 * RIGHT], [0, -RIGHT, 0.384, 0], [0.088, RIGHT, 0, 2 * RIGHT], [0, 0, 0.107, 0]],
};
const size = (data) => data.rows.reduce((sum, row) => sum + Math.abs(row.dh[0]) + Math.abs(row.dh[2]), 0);

/** Postures of a fixed sequence. */
function postures(joints, count, seed) {
    let x = seed;
    const next = () => (x = (x * 16807) % 2147483647) / 2147483647;
    return Array.from({ length: count }, () => Array.from({ length: joints }, () => 5 * next() - 2.5));
}

/** The true arm is the one of the page; the rows of the page hold one planted mistake. How often the row is named, alone or first. */
function planted(data, count, oriented, seed) {
    let [all, alone, wrong] = [0, 0, 0];
    suspects(data).forEach((fault, k) => {
        if (fault.row === 0) return;
        const described = { ...data, rows: fault.arm.rows };
        // A joint that counts the other way is a mistake of the page that no row of it shows: the true arm has it.
        const truth = fault.fault === "reversed" ? fault.arm : asWritten(data);
        const page = fault.fault === "reversed" ? data : described;
        const measured = postures(data.rows.length, count, seed + k).map((q) => {
            const { end } = frames(truth, q);
            return { q, position: end.map((row) => row[3]), frame: oriented ? end : null };
        });
        const found = explain(page, measured, size(data));
        // Some mistakes change nothing that was measured.
        if (found.before < 1e-9) return;
        all++;
        const equal = found.suspects.filter((suspect) => suspect.equal);
        if (equal.length > 0 && equal.every((suspect) => suspect.row === fault.row)) alone++;
        if (!equal.some((suspect) => suspect.row === fault.row)) wrong++;
    });
    return { all, alone, wrong };
}

test("one full pose names the planted row alone for nine in ten, and two never name a wrong row first", () => {
    for (const [name, rows] of Object.entries(ARMS)) {
        const data = arm(rows);
        let [all, alone] = [0, 0];
        for (const seed of [11, 1234, 77777]) {
            const one = planted(data, 1, true, seed);
            all += one.all;
            alone += one.alone;
            assert.equal(one.wrong, 0, `${name}: one pose`);
            assert.equal(planted(data, 2, true, seed).wrong, 0, `${name}: two poses`);
        }
        console.log(`${name}: ${alone} of ${all} planted mistakes named alone by one full pose`);
        const positions = [11, 1234, 77777].map((seed) => planted(data, 1, false, seed));
        const [some, of] = [positions.reduce((sum, one) => sum + one.alone, 0), positions.reduce((sum, one) => sum + one.all, 0)];
        console.log(`${name}: ${some} of ${of} that move the tip named alone by one position`);
        assert.ok(some >= 0.83 * of, `${name}: ${some} of ${of} by one position`);
        assert.ok(alone >= 0.9 * all, `${name}: ${alone} of ${all}`);
    }
});

test("a convention is found, and an arm that is right is left alone", () => {
    const data = arm(ARMS.ur5, "modified");
    const [q] = postures(6, 1, 5);
    const { end } = frames(asWritten(arm(ARMS.ur5)), q);
    const measured = [{ q, position: end.map((row) => row[3]), frame: end }];
    assert.equal(explain(data, measured, 1).suspects[0].fault, "convention");
    assert.ok(explain(arm(ARMS.ur5), measured, 1).before < 1e-12);
});

/** What a UR5 with another row, or tool, measures at some postures. */
function measuredBy(rows, all, tool = identity) {
    const truth = { ...asWritten(arm(rows)), tool };
    return all.map((q) => ({ q, position: frames(truth, q).end.map((row) => row[3]), frame: null }));
}

test("a length that is wrong by some amount has no suspect, and the vector by which it moves the end effector is said", () => {
    const data = arm(ARMS.ur5);
    const longer = ARMS.ur5.map((row, i) => (i === 0 ? [row[0], row[1], row[2] + 0.05, row[3]] : row));
    const stretched = measuredBy(longer, [0.3, -1.2, 2].map((q1) => [q1, 0, 0, 0, 0, 0]));
    assert.deepEqual(explain(data, stretched, size(data)).suspects, []);
    assert.deepEqual(commonVector(asWritten(data), stretched), { vector: [0, 0, 0.05], own: false });
    const tool = [[1, 0, 0, 0], [0, 1, 0, 0.02], [0, 0, 1, 0.03], [0, 0, 0, 1]];
    assert.deepEqual(commonVector(asWritten(data), measuredBy(ARMS.ur5, postures(6, 3, 7), tool)), { vector: [0, 0.02, 0.03], own: true });
    const upper = ARMS.ur5.map((row, i) => (i === 1 ? [row[0] + 0.05, ...row.slice(1)] : row));
    assert.equal(commonVector(asWritten(data), measuredBy(upper, postures(6, 3, 7))), null);
});

test("positions in mm and angles in degrees are asked about, and those of the chosen units are not", () => {
    const data = arm(ARMS.ur5);
    const measured = measuredBy(ARMS.ur5, postures(6, 3, 9));
    const asked = (times, turned) => doubtedUnits(data, measured.map(({ q, position }) => ({ q: q.map((x) => x * turned), position: position.map((x) => x * times), frame: null })), size(data)).map((doubt) => doubt.instead);
    assert.deepEqual([asked(1, 1), asked(1000, 1), asked(1, 57.3), asked(1000, 57.3)], [[], ["mm"], ["deg"], ["mm", "deg"]]);
    [units.length, units.angle] = ["mm", "deg"];
    assert.deepEqual([asked(1, 57.3), asked(0.001, 1)], [[], ["m"]]);
    [units.length, units.angle] = ["m", "rad"];
});

test("lines are read, and what is none is said", () => {
    const { measured, faults } = read("1 2; 3, 4 5\n\n1 x 3 4 5\n1 2 3\n1 2 3 4 5 0 0 0", 2, (x) => x, ["rad", "rad"]);
    assert.deepEqual(measured.map((one) => [one.q, one.position, one.frame !== null]), [[[1, 2], [3, 4, 5], false], [[1, 2], [3, 4, 5], true]]);
    assert.deepEqual(faults.map((fault) => fault.slice(0, 6)), ["line 3", "line 4"]);
});

test("commas for points are named", () => {
    const fault = (text) => read(text, 2, (x) => x, ["rad", "rad"]).faults[0] ?? "";
    const said = "line 1: 10 numbers; 2 joints and x y z are 5, with roll pitch yaw 8. Commas were read as separators: write points, 0.4 -1.1 …";
    assert.equal(fault("0,4 -1,1 0,5; 0,25\t1,0"), said);
    assert.equal(fault("1, 2, 3"), "line 1: 3 numbers; 2 joints and x y z are 5, with roll pitch yaw 8");
    assert.ok(!fault("0.1,0.2,0.3").includes("Commas") && !fault("1,2,3").includes("Commas"));
});
