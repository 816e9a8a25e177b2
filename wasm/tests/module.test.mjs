/** The module in Node: what it answers is what the program writes. */

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import test from "node:test";
import { difference, LANGUAGES, module, run, sorted } from "./program.mjs";

const compiled = new WebAssembly.Module(readFileSync(process.env.ARMGEN_MODULE));
const { exports: instance } = new WebAssembly.Instance(compiled);

/** @param {any} request */
function call(request) {
    const bytes = new TextEncoder().encode(typeof request === "string" ? request : JSON.stringify(request));
    const at = instance.room(bytes.length);
    new Uint8Array(instance.memory.buffer, at, bytes.length).set(bytes);
    const length = instance.call();
    return JSON.parse(new TextDecoder().decode(new Uint8Array(instance.memory.buffer, instance.answer(), length)));
}

const folder = (path) => readdirSync(new URL(path, import.meta.url)).filter((name) => /\.(yaml|urdf|xml)$/.test(name));
const text = (path) => readFileSync(new URL(path, import.meta.url), "utf8");

test("the module asks for nothing", () => {
    assert.deepEqual(WebAssembly.Module.imports(compiled), []);
});

for (const name of folder("../../robots/").filter((name) => name.endsWith(".yaml"))) {
    const own = { name, text: text(`../../robots/${name}`) };
    test(`${name}: verdict and summary`, () => {
        const { files } = JSON.parse(run(name, own.text, ["check", name, "--format", "json"]).printed);
        assert.deepEqual(call({ about: "check", ...own }), files[0]);
        assert.equal(call({ about: "summary", ...own }).text, run(name, own.text, ["check", name]).printed);
    });
    for (const language of Object.keys(LANGUAGES)) {
        test(`${name}: ${language}`, () => {
            const { files, note } = call({ about: "code", language, functions: [], ...own });
            const ik = note === null && ["rust", "c", "cuda"].includes(language);
            assert.equal(difference(sorted(files), module(name, own.text, language, ik)), null);
        });
    }
}

test("equations are those of the program", () => {
    const own = { name: "scara.yaml", text: text("../../robots/scara.yaml") };
    for (const quantity of ["inertia_matrix", "gravity", "determinant", "inverse_kinematics"]) {
        const shown = call({ about: "show", quantity, ...own });
        assert.equal(shown.text, run(own.name, own.text, ["show", own.name, quantity]).printed, quantity);
        if (shown.latex !== null) assert.equal(shown.latex, run(own.name, own.text, ["show", own.name, quantity, "--format", "latex"]).printed, quantity);
    }
    assert.match(call({ about: "show", quantity: "inertia_matrx", ...own }).fault, /did you mean `inertia_matrix`/);
});

test("faulty files have the faults of the program", () => {
    let count = 0;
    for (const name of folder("../../tests/bad/")) {
        const own = { name, text: text(`../../tests/bad/${name}`) };
        const { files } = JSON.parse(run(name, own.text, ["check", name, "--format", "json"]).printed);
        // The last check needs all programs: what makes these has its fault.
        const late = files[0].diagnostics.some(({ code }) => code === "number-out-of-range");
        const found = call({ about: "check", ...own });
        if (!late) assert.deepEqual(found.diagnostics, files[0].diagnostics, name);
        count++;
    }
    assert.ok(count > 100, `${count} files`);
});

test("what is no request has an answer", () => {
    for (const request of ["", "{", "[]", "null", '{"about": "nothing"}', '{"about": "code", "language": "basic"}', '{"about": "show"}']) {
        assert.equal(typeof call(request).fault, "string", request);
    }
    for (const about of ["check", "import", "summary", "picture", "rest", "functions", "show", "code"]) {
        assert.equal(typeof call({ about, text: "joints: {", language: "rust" }), "object", about);
    }
});
