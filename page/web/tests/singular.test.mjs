import assert from "node:assert/strict";
import test from "node:test";

import { refined, roots, setOf } from "../singular.mjs";

test("zeros of a function of an angle are all found, also where it touches zero", () => {
    const near = (found, expected) => {
        assert.equal(found.length, expected.length, `${found}`);
        found.forEach((x, k) => assert.ok(Math.abs(x - expected[k]) < 1e-7, `${found}`));
    };
    near(roots(Math.sin, 1e-14), [-Math.PI, 0]);
    near(roots((x) => Math.cos(x) - 0.5, 1e-14), [-Math.PI / 3, Math.PI / 3]);
    near(roots((x) => 1 - Math.cos(x - 0.123), 1e-14), [0.123]);
    near(roots((x) => 1.0001 - Math.cos(x), 1e-14), []);
    near(roots((x) => Math.abs(Math.sin(x - 1)), 1e-7, 120), [1 - Math.PI, 1]);
});

test("a zero is refined to the digits that the function has there", () => {
    assert.ok(Math.abs(refined((x) => Math.abs(Math.sin(x)), Math.PI + 3e-8) - Math.PI) < 1e-15);
    const bent = (x) => Math.abs(Math.sin(x - 0.3) + 0.5 * (x - 0.3) ** 2);
    assert.ok(Math.abs(refined(bent, 0.3 + 2e-8) - 0.3) < 1e-15);
    assert.equal(refined((x) => Math.abs(Math.sin(x)), 3e-9), 0);
});

test("a set is said with numbers where no formula says it", () => {
    assert.equal(setOf("q2 = 0 mod pi", "sin(q2)"), "q₂ = 0 mod π");
    assert.equal(setOf("q3 = atan(-1/2) mod pi", "cos(q3) + 2*sin(q3)"), "q₃ = atan(−1/2) mod π (−0.463648)");
    assert.equal(setOf(null, "sin(q2 + q3)"), "");
    assert.equal(setOf("q4 with 2*cos(2*q4) - 2*cos(q4) = 0", "cos(2*q4) - cos(q4)"), "q₄ = −2.0944, 0, 2.0944 mod 2 π");
    assert.equal(setOf("q4 with cos(2*q4) + 3 = 0", "cos(2*q4) + 3"), "never");
    assert.equal(setOf("q1 with q1^3 - 2 = 0", "q1^3 - 2"), "q₁ with q1^3 − 2 = 0".replace("q1", "q₁"));
});
