import assert from "node:assert/strict";
import test from "node:test";

import { folded, bound, evaluate, parse, print, quotient, typed, zeros } from "../formula.mjs";

test("formulas are read and printed back", () => {
    for (const text of [
        "0",
        "-1/4",
        "10*cos(q2) + 10763/500",
        "-sin(q1 + q2 - q4)",
        "-5*(dq1 + dq2)*sin(q2)",
        "t1*t2/t3/t4",
        "1/(t1 - 2*t3)",
        "m_l1*a^2 - 2*sqrt(3)*sign(dq1)",
        "(1/2*sqrt(2) + 1)*q3^(-2)",
        "sin(q1+q2-q3)*phi".replace("q1+q2-q3", "q1 + q2 - q3"),
        "(≈-1.25e-7)*pi",
    ]) {
        assert.equal(print(parse(text)), text);
    }
});

test("formulas have their values", () => {
    const lookup = (name) => ({ q1: 0.3, q2: 1.1, t1: 2, t2: 3 })[name];
    const check = (text, value) => assert.equal(evaluate(parse(text), lookup), value);
    check("-1/4", -0.25);
    check("10*cos(q2) + 3/2", 10 * Math.cos(1.1) + 1.5);
    check("t1*t2/4/t1", 0.75);
    check("t1^3 - t2^(-1)", 8 - 1 / 3);
    check("2*(t1 - t2)", -2);
    check("-(t1 + t2)*2 - 1", -11);
    assert.equal(bound(parse("1/2*sin(q1) - 3*cos(q2)"), lookup), 3.5);
});

test("what is no formula is refused", () => {
    for (const text of ["", "1 +", "sin(q1", "a b", "2**3", "<img>"]) assert.throws(() => parse(text), text);
});

test("fractions of more digits than a float holds have values", () => {
    assert.equal(quotient(`1${"0".repeat(400)}`, `2${"0".repeat(400)}`), 0.5);
    assert.equal(quotient("1", `4${"0".repeat(310)}`), 2.5e-311);
    assert.equal(quotient(`3${"0".repeat(305)}`, "2"), 1.5e305);
});

test("zeros of a factor are read from their words", () => {
    const read = (text) => {
        const zero = zeros(text);
        return zero && [zero.joint, zero.period, ...zero.values.map(({ value }) => value)];
    };
    const [pi, turn] = [Math.PI, 2 * Math.PI];
    assert.deepEqual(read("q2 = 0 mod pi"), [2, pi, 0]);
    assert.deepEqual(read("q10 = pi/2 mod pi"), [10, pi, pi / 2]);
    assert.deepEqual(read("q3 = atan(-4318/203) mod pi"), [3, pi, Math.atan(-4318 / 203)]);
    assert.deepEqual(read("q1 = +-2 pi/3 mod 2 pi"), [1, turn, turn / 3, -turn / 3]);
    assert.deepEqual(read("q1 = 1 or 3"), [1, 0, 1, 3]);
    assert.deepEqual(read("q1 = -1/5"), [1, 0, -0.2]);
    for (const text of ["never", "q1 = atan2(1, 2) +- acos(1/3) mod 2 pi", "q1 with q1^3 + 1 = 0", ""]) assert.equal(read(text), null, text);
});

test("constants with roots and functions are one decimal, and the value stays", () => {
    const shown = (text) => print(folded(parse(text))).replace(/sqrt\(2\)\*cos\(7\/10\)/g, "C");
    assert.equal(shown("cos(q1)*sqrt(2)*cos(7/10)"), "cos(q1)*(C)");
    assert.equal(shown("1/2*cos(q1) + 3/4"), "1/2*cos(q1) + 3/4");
    assert.equal(shown("sin(q1 + pi/2) - (1 - sqrt(2)*cos(7/10))*t1"), "sin(q1 + pi/2) + (-((1 - C)))*t1");
    const terms = folded(parse("q1 + 1 - sqrt(2) + q2 + 1/4")).terms;
    assert.deepEqual(terms.map(({ negative, node }) => [negative, node.kind]), [[false, "name"], [true, "decimal"], [false, "name"]].with(1, [1.25 - Math.SQRT2 < 0, "decimal"]));
    for (const text of ["-sqrt(3)*(cos(2)*q1 - 1/3*sqrt(2)*sin(3)/q2)^2", "q1/sqrt(2)", "cos(4)*cos(q1 + atan(2))", "-(sqrt(2) - 5)"]) {
        const lookup = (name) => ({ q1: 0.3, q2: 0.7, t1: 2 })[name];
        const [before, after] = [parse(text), folded(parse(text))].map((node) => evaluate(node, lookup));
        assert.ok(Math.abs(before - after) < 1e-14 * Math.abs(before), text);
    }
});

test("fields take numbers and expressions of pi", () => {
    const same = (text, value) => assert.ok(Object.is(typed(text), value), text);
    for (const value of [1.5, -0, 1e-7, -68.75493541569878, 1.2e21]) same(Object.is(value, -0) ? "-0" : String(value), value);
    same(" pi ", Math.PI);
    same("−π/4", -Math.PI / 4);
    same("2*(pi - 1)", 2 * (Math.PI - 1));
    same(".5 + 1.", 1.5);
    same("1e3/4", 250);
    for (const text of ["30 deg", "30deg", "30°", "deg(30)", "3e1 deg"]) same(text, (30 * Math.PI) / 180);
    same("pi/2 - 45°", Math.PI / 2 - Math.PI / 4);
    for (const text of ["", "deg", "30 deg 2", "30 degrees", "pi pi", "q1", "0x10", "1,5", "Infinity", "constructor(1)", "alert(1)", "1.2.3", "(".repeat(100000)]) assert.ok(!Number.isFinite(typed(text)), text);
});
