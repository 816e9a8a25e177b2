import assert from "node:assert/strict";
import test from "node:test";

import { needed, sixDigits } from "../equations.mjs";

test("an entry comes before the steps that it needs, and without the others", () => {
    const line = (label, text, entry = "") => ({ label, text, entry });
    const all = [line("t1", "sin(q2)"), line("t2", "cos(q2)"), line("t3", "t1*m_t2 + 1"), line("t12", "2*t1"), line("b11", "t2 + t12", "1,1"), line("b12", "-t3/2", "1,2")];
    const labels = (entry) => needed(all, entry).map((one) => one.label);
    assert.deepEqual(labels("1,2"), ["b12", "t1", "t3"]);
    assert.deepEqual(labels("1,1"), ["b11", "t1", "t2", "t12"]);
});

test("LaTeX of six digits has no long fraction, and names and indices stay", () => {
    const exact = "t_{1234567} &= \\frac{16685527}{1000000000}\\,\\cos q_{6} - \\frac{1}{40000} + 12345678 + \\frac{\\pi}{2} + \\frac{1}{4}\\,\\sqrt{2}";
    assert.equal(sixDigits(exact), "t_{1234567} &= 0.0166855\\,\\cos q_{6} - 2.5\\cdot 10^{-5} + 1.23457\\cdot 10^{7} + \\frac{\\pi}{2} + 0.25\\,\\sqrt{2}");
});
