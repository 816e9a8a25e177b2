import assert from "node:assert/strict";
import test from "node:test";
import { apart, lineStarts, locks, meant, offset, range, takesAll, tips } from "../places.mjs";

test("columns count characters, offsets units of UTF-16", () => {
    const text = "a\n😀b: c\n\nend";
    const starts = lineStarts(text);
    assert.deepEqual(starts, [0, 2, 9, 10]);
    assert.equal(offset(text, starts, 1, 1), 0);
    assert.equal(offset(text, starts, 2, 1), 2);
    assert.equal(offset(text, starts, 2, 2), 4);
    assert.equal(text.slice(offset(text, starts, 2, 2), offset(text, starts, 2, 3)), "b");
    // Beyond the end of a line or of the text is its end.
    assert.equal(offset(text, starts, 1, 9), 1);
    assert.equal(offset(text, starts, 4, 99), text.length);
    assert.equal(offset(text, starts, 99, 1), 10);
});

test("every place shows", () => {
    const text = "ab\n\nc";
    const at = (line, column, end_line, end_column) => range(text, lineStarts(text), { line, column, end_line, end_column });
    assert.deepEqual(at(1, 1, 1, 3), [0, 2]);
    assert.deepEqual(at(1, 2, 1, 2), [1, 2]);
    assert.deepEqual(at(1, 3, 1, 3), [1, 2]);
    assert.deepEqual(at(3, 2, 3, 2), [4, 5]);
});

test("of two faults at one place the error shows", () => {
    const ranges = apart([
        { from: 0, to: 4, severity: "warning" },
        { from: 0, to: 2, severity: "error" },
        { from: 3, to: 6, severity: "error" },
    ]);
    assert.deepEqual(ranges, [
        { from: 0, to: 2, severity: "error" },
        { from: 2, to: 4, severity: "warning" },
        { from: 4, to: 6, severity: "error" },
    ]);
});

test("remedies are read from diagnostics", () => {
    const message = "several links may be the tip: `a` (7 joints), `b` (8 joints, and 1 leaf fixed to its last link)";
    const help = "choose one: `--tip hand` (7 joints); or end the arm where it branches: `--tip a` (6 joints)";
    assert.deepEqual(tips({ message, help }), ["hand", "a", "b"]);
    assert.deepEqual([takesAll({ help }), takesAll({ help: `${help}; or take all branches: \`--all\`` })], [false, true]);
    assert.deepEqual(locks({ help: "stands at 0: `--lock left=0` `--lock right=-pi/4`" }), [["left", "0"], ["right", "-pi/4"]]);
    assert.equal(meant({ help: "did you mean `gravity`? keys here: name" }), "gravity");
    assert.equal(meant({ help: "keys here: name" }), null);
});
