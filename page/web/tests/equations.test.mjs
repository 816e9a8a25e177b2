import assert from "node:assert/strict";
import test from "node:test";

import { needed } from "../equations.mjs";

test("an entry comes before the steps that it needs, and without the others", () => {
    const line = (label, text, entry = "") => ({ label, text, entry });
    const all = [line("t1", "sin(q2)"), line("t2", "cos(q2)"), line("t3", "t1*m_t2 + 1"), line("t12", "2*t1"), line("b11", "t2 + t12", "1,1"), line("b12", "-t3/2", "1,2")];
    const labels = (entry) => needed(all, entry).map((one) => one.label);
    assert.deepEqual(labels("1,2"), ["b12", "t1", "t3"]);
    assert.deepEqual(labels("1,1"), ["b11", "t1", "t2", "t12"]);
});
