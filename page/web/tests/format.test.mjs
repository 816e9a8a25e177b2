import assert from "node:assert/strict";
import test from "node:test";

import { digitsIn, fromUnit, instant, unitOfManipulability, units } from "../format.mjs";
import { listed, meant } from "../sliders.mjs";

test("degrees stand as they were typed, and all digits of others are the same angle again", () => {
    units.angle = "deg";
    for (let k = -7200; k <= 7200; k++) {
        const typed = k / 20;
        assert.equal(digitsIn(fromUnit(typed, "rad"), "rad"), String(typed + 0));
    }
    for (let k = 1; k <= 2000; k++) {
        const value = Math.sin(k) * 3;
        assert.ok(Math.abs(fromUnit(Number(digitsIn(value, "rad")), "rad") - value) <= 4e-16 * Math.abs(value));
    }
    units.angle = "rad";
    assert.equal(digitsIn(0.1 + 0.2, "rad"), "0.30000000000000004");
});

test("late times differ, and early ones have no digits of rounding", () => {
    assert.deepEqual([0, 2e-5, 0.1 + 0.2, 1000.001, 1764118000.1, -2.5].map(instant), ["0", "2·10⁻⁵", "0.3", "1000.001", "1764118000.1", "−2.5"]);
});

test("w of as many rows as joints is in m for each velocity, less the joints that slide", () => {
    const of = (task, types) => unitOfManipulability({ task, rows: types.map((type) => ({ type })) });
    const [turns, slides] = ["revolute", "prismatic"];
    assert.equal(of([0, 1, 2, 5], [turns, turns, slides, turns]), "m²");
    assert.equal(of([0, 1, 2, 3, 4, 5], Array(7).fill(turns)), "m³");
    assert.equal(of([0, 1], [turns, turns, slides]), "");
    assert.equal(of([2], [slides]), "");
});

test("a list is what programs write, YAML as well", () => {
    assert.deepEqual(listed("- 0.1\n- -0.2\n"), ["0.1", "-0.2"]);
    assert.deepEqual(listed("q: [0.1, pi/2]"), ["0.1", "pi/2"]);
    assert.deepEqual(listed("1 - 2"), []);
    assert.deepEqual(listed("[30 deg, 45°, 0.1]"), ["30deg", "45°", "0.1"]);
});

test("degrees are angles whatever the fields are in, and no lengths", () => {
    for (const angle of ["rad", "deg"]) {
        units.angle = angle;
        assert.equal(meant("30 deg", "rad"), (30 * Math.PI) / 180);
    }
    units.angle = "rad";
    assert.ok(Number.isNaN(meant("30 deg", "m")));
});
