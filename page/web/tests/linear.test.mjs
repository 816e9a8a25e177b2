import assert from "node:assert/strict";
import test from "node:test";

import { cuboid } from "../bodies.mjs";
import { condition, determinant, eigen, lost, manipulability, outline } from "../linear.mjs";
import { combination, line, stretch } from "../lost_motion.mjs";
import { axesAtLine, dependentAxes } from "../dependent_axes.mjs";

const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-12 * Math.max(1, Math.abs(b)), `${a} is not ${b}`);

/** Edges a, b, c and mass m have the moments m (b² + c²)/12 and so on, whatever axes they lie along. */
test("the edges of a cuboid stand in the order of the axes of the frame", () => {
    const [a, b, c] = [0.14, 0.19, 0.15];
    const [x, y, z] = [b * b + c * c, c * c + a * a, a * a + b * b].map((sum) => sum / 4);
    const body = (inertia) => ({ name: "body", frame: 1, mass: 3, com: [0, 0, 0], inertia });
    const edges = (inertia) => cuboid(body(inertia)).edges.map((edge) => Number(edge.toFixed(9)));
    assert.deepEqual(edges([x, 0, y, 0, 0, z]), [a, b, c]);
    assert.deepEqual(edges([y, 0, z, 0, 0, x]), [b, c, a]);
    // Turned by a small angle about z, and about x by nearly a right angle, which exchanges the two.
    const turned = (i, j, angle) => [i * Math.cos(angle) ** 2 + j * Math.sin(angle) ** 2, (i - j) * Math.cos(angle) * Math.sin(angle), i * Math.sin(angle) ** 2 + j * Math.cos(angle) ** 2];
    const [xx, xy, yy] = turned(x, y, 0.2);
    assert.deepEqual(edges([xx, xy, yy, 0, 0, z]), [a, b, c]);
    const [ss, st, tt] = turned(y, z, 1.4);
    assert.deepEqual(edges([x, 0, ss, 0, st, tt]), [a, c, b]);
    // The frame is right-handed, and takes the moments along the edges to the tensor.
    const { frame } = cuboid(body([x, 0, ss, 0, st, tt]));
    near(determinant(frame.map((row) => row.slice(0, 3))), 1);
    [[x, 0, 0], [0, ss, st], [0, st, tt]].forEach((row, i) => row.forEach((value, j) => near([x, z, y].reduce((sum, moment, k) => sum + moment * frame[i][k] * frame[j][k], 0), value)));
});

test("a symmetric matrix is its eigenvalues and eigenvectors", () => {
    const a = [
        [4, 1, -2],
        [1, 2, 0.5],
        [-2, 0.5, 3],
    ];
    const { values, vectors } = eigen(a);
    assert.ok(values[0] >= values[1] && values[1] >= values[2]);
    a.forEach((row, i) => row.forEach((x, j) => near(values.reduce((sum, value, k) => sum + value * vectors[i][k] * vectors[j][k], 0), x)));
});

test("w is the determinant's size, and a singular Jacobian has none", () => {
    const j = [
        [1, 2, 0.3],
        [-0.5, 1, 4],
        [2, 2, -1],
    ];
    near(manipulability(j), Math.abs(determinant(j)));
    assert.ok(condition([[1, 2], [2, 4]]) > 1e15);
    assert.equal(determinant([[1, 2], [2, 4]]), 0);
});

test("the outline of an ellipsoid is that of its widest points", () => {
    // Semi-axes 3, 2, 1 along x, y, z, seen along y.
    const { semi, angle } = outline([[9, 0, 0], [0, 4, 0], [0, 0, 1]], [1, 0, 0], [0, 0, 1]);
    near(semi[0], 3);
    near(semi[1], 1);
    near(Math.sin(angle), 0);
});

test("a cuboid gives its own inertia back, and an impossible tensor says so", () => {
    const [m, a, b, c] = [12, 0.4, 0.3, 0.2];
    const body = (inertia) => ({ name: "", frame: 1, mass: m, com: [0, 0, 0], inertia });
    const of = cuboid(body([(m * (b * b + c * c)) / 12, 0, (m * (a * a + c * c)) / 12, 0, 0, (m * (a * a + b * b)) / 12]));
    assert.deepEqual(of.edges.map((edge) => edge.toFixed(9)).sort(), ["0.200000000", "0.300000000", "0.400000000"]);
    near(of.density, m / (a * b * c));
    assert.ok(of.possible);
    assert.ok(!cuboid(body([1, 0, 1, 0, 0, 3])).possible);
});

test("what is lost is in echelon form, and what rounding leaves is 0", () => {
    // A stretched planar arm: no motion along it. One of two links of 0.5 m and an angle of 0.01: nearly none along the outer link.
    assert.deepEqual(lost([[0, 0], [1, 0.5]]), { most: 0, of: [[1, 0]] });
    const { most, of } = lost([[-0.5 * Math.sin(0.01), -0.5 * Math.sin(0.01)], [0.5 + 0.5 * Math.cos(0.01), 0.5 * Math.cos(0.01)]]);
    assert.ok(most > 0.002 && most < 0.0025 && of.length === 1 && of[0][0] === 1, `${most}`);
    // Two rows that are three times the first one: two combinations, each with 1 at an entry where the other has 0.
    assert.deepEqual(lost([[1, 2, 3], [3, 6, 9], [-3, -6, -9]]).of.map((row) => row.map((x) => Number(x.toFixed(9)))), [[1, 0, 1 / 3].map((x) => Number(x.toFixed(9))), [0, 1, 1]]);
    assert.equal(manipulability([[1e-80, 0], [0, 1]]), 0);
    assert.equal(condition([[1, 1], [1, 1 + 1e-16]]), Infinity);
});

test("what the axes do says why", () => {
    const turn = (k, direction, at) => ({ k, slides: false, direction, at });
    const slide = (k, direction) => ({ k, slides: true, direction, at: [0, 0, 0] });
    const [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const others = [turn(4, x, [0, 3, 1]), turn(5, y, [2, 0, 4])];
    assert.equal(dependentAxes([turn(1, z, [0, 0, 0]), turn(2, y, [1, 1, 0]), turn(3, z, [0, 0, 2]), ...others], 5, 1, null), "the axes of q₁ and q₃ lie on one line");
    assert.equal(dependentAxes([turn(1, z, [0, 0, 0]), turn(2, x, [0, 0, 0]), turn(3, [0.6, 0, 0.8], [0, 0, 0])], 3, 1, null), "the axes of q₁, q₂ and q₃ lie in one plane and go through one point");
    assert.equal(dependentAxes([turn(1, z, [0, 0, 0]), turn(2, x, [0, 0, 0]), turn(3, y, [0, 0, 0]), turn(4, [0.6, 0.48, 0.64], [0, 0, 0])], 4, 1, null), "the axes of q₁, q₂, q₃ and q₄ go through one point");
    assert.equal(dependentAxes([turn(1, z, [0, 0, 0]), turn(2, z, [1, 0, 0])], 2, 1, [2, 0, 5]), "the axes of q₁ and q₂ lie in one plane with the tip: the arm is stretched or folded");
    assert.equal(dependentAxes([slide(1, x), slide(2, x), slide(3, y)], 3, 1, null), "q₁ and q₂ slide along one direction");
    // Three joints of which no two or three do the same, for a task of three rows; two on one line that the task has to spare.
    assert.equal(dependentAxes([turn(1, z, [0, 0, 0]), turn(2, z, [1, 0, 0]), turn(3, z, [0, 1, 0])], 3, 1, null), "");
    assert.equal(dependentAxes([turn(1, z, [0, 0, 0]), turn(2, z, [0, 0, 1]), turn(3, z, [0, 1, 0]), turn(4, x, [0, 1, 7])], 3, 1, null), "");
    const line = { at: [0, 0, 1], direction: x, kind: "move" };
    assert.equal(axesAtLine([turn(1, z, [0, 0, 0]), turn(2, x, [0, 5, 0]), slide(3, y)], line, 1), "no joint can move anything along the line that is drawn: the axis of q₁ meets it; the axis of q₂ is parallel to it; q₃ slides across it");
    assert.equal(axesAtLine([turn(1, z, [0, 1, 0])], line, 1), "");
});

test("the line of a wrench is where it has no moment across it", () => {
    const straight = line([1, 0, 0, 0, 0, 0], [1, 2, 3], false);
    assert.deepEqual([straight.at, straight.direction, straight.text], [[1, 2, 3], [1, 0, 0], "no motion along this line"]);
    assert.equal(line([0, 0, 0, 0, 2, 0], [0, 0, 0], true).text, "hardly any turn about these lines");
    // A force along x whose line lies 0.5 above the tip turns about y at the tip: m = (at - tip) x f.
    assert.deepEqual(line([1, 0, 0, 0, 0.5, 0], [0, 0, 0], false).at, [0, 0, 0.5]);
    assert.equal(line([1, 0, 0, 0.2, 0, 0], [0, 0, 0], false).text, "v + 0.2 ω along this line stays 0");
    // In the picture as far as it goes, about its middle where that is to be seen; nothing of one that is nowhere.
    assert.deepEqual(stretch([300, 240], [100, 0]), [[200, 240], [400, 240]]);
    assert.deepEqual(stretch([-500, 240], [100, 0]), [[12, 240], [212, 240]]);
    assert.equal(stretch([300, -40], [100, 0]), null);
    assert.equal(combination([-1, 0, 0.5], ["vx", "vy", "ωz"]), "−vx + 0.5 ωz");
});
