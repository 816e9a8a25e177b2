import assert from "node:assert/strict";
import test from "node:test";

import { laidOver, plots, sampleAt, tickLabels } from "../logs.mjs";
import { sequence } from "../search.mjs";

test("columns of one kind and unit share a plot", () => {
    const names = ["t", "q_a", "q_b", "e_x", "e_rz", "x", "z", "w"];
    const units = ["s", "rad", "m", "m", "rad", "m", "m", ""];
    const of = plots({ names, units, columns: [] }).map((plot) => [plot.title, plot.unit, plot.columns]);
    assert.deepEqual(of, [
        ["joint variables", "rad", [1]],
        ["joint variables", "m", [2]],
        ["errors of the end effector, desired − actual", "m", [3]],
        ["errors of the end effector, desired − actual", "rad", [4]],
        ["position of the end effector", "m", [5, 6]],
        ["manipulability w of the task", "", [7]],
    ]);
});

test("both torques of a judged joint share a plot", () => {
    const names = ["t", "measured_a", "measured_b", "predicted_a", "predicted_b"];
    const of = plots({ names, units: ["s", "N m", "N", "N m", "N"], columns: [] }).map((plot) => [plot.title, plot.unit, plot.columns]);
    assert.deepEqual(of, [
        ["a: torque, measured and predicted", "N m", [1, 3]],
        ["b: torque, measured and predicted", "N", [2, 4]],
    ]);
});

test("the sample of a time is the last one before it", () => {
    const times = [0, 0.5, 1, 4];
    assert.deepEqual([-1, 0, 0.6, 1, 3.9, 4, 9].map((t) => sampleAt(times, t)), [0, 0, 1, 2, 2, 3, 3]);
});

test("no two ticks of an axis have the same label", () => {
    const ticks = (first, step) => tickLabels(Array.from({ length: 6 }, (_, k) => first + k * step));
    assert.deepEqual(ticks(0, 0.0005), ["0", "0.0005", "0.001", "0.0015", "0.002", "0.0025"]);
    assert.deepEqual(ticks(-1, 0.25), ["−1", "−0.75", "−0.5", "−0.25", "0", "0.25"]);
    assert.deepEqual(ticks(12.3456, 0.00002).slice(0, 2), ["12.3456", "12.34562"]);
    assert.deepEqual(ticks(0, 2e-7).slice(0, 2), ["0", "2·10⁻⁷"]);
    assert.deepEqual(ticks(1764118000, 0.05).slice(0, 3), ["1764118000", "1764118000.05", "1764118000.1"]);
    for (const step of [0.001, 0.002, 0.0025, 0.005, 0.1, 2, 50]) for (const first of [0, 0.1, 7, 100]) assert.equal(new Set(ticks(first, step)).size, 6, `${first} ${step}`);
});

test("the sequence fills every box of a grid", () => {
    const points = sequence(2, 400);
    const boxes = new Set(points.map(([x, y]) => Math.floor(x * 10) * 10 + Math.floor(y * 10)));
    assert.equal(boxes.size, 100);
});

test("another log is held from sample to sample, and nothing beyond its ends", () => {
    const log = { names: ["t", "q_a"], units: ["s", "rad"], columns: [[0, 1, 2, 3, 4], [0, 0, 0, 0, 0]] };
    const other = { names: ["t", "q_b", "q_a"], units: ["s", "rad", "rad"], columns: [[1, 2.5, 3], [7, 7, 7], [10, 20, 30]] };
    assert.deepEqual(laidOver(log, other, ["q_a", "q_c"]), [[null, 10, 10, 30, null], [null, null, null, null, null]]);
});
