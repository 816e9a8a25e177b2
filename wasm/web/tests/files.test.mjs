import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";
import { fileOf, linkOf } from "../link.mjs";
import { crc32, zip } from "../zip.mjs";

test("a link holds a file", async () => {
    for (const text of ["", "name: arm\n", "ü😀\u0000\n".repeat(50_000)]) {
        const link = await linkOf("müller.yaml", text);
        assert.match(link, /^1[\w-]+$/);
        assert.deepEqual(await fileOf(link), { name: "müller.yaml", text });
    }
});

test("what is no link is none", async () => {
    const link = await linkOf("a.yaml", "name: arm\n");
    for (const other of ["", "1", "2abc", "equations", link.slice(0, -4), `${link}!`, `1${"A".repeat(99)}`]) assert.equal(await fileOf(other), null, other);
    // A short link that unfolds to more than any text.
    assert.equal(await fileOf(await linkOf("a.yaml", "0".repeat(5 << 20))), null);
});

test("the checksum is that of the specification", () => {
    // The check value of CRC-32/ISO-HDLC.
    assert.equal(crc32(new TextEncoder().encode("123456789")), 0xcbf43926);
});

test("others read the archive", async (t) => {
    const files = [["c/robot.h", "int x;\n"], ["+robot/ü.m", "ü\n".repeat(1000)], ["empty", ""]];
    const path = join(mkdtempSync(join(tmpdir(), "zip-")), "a.zip");
    writeFileSync(path, Buffer.from(await zip(files).arrayBuffer()));
    const read = "import json, sys, zipfile; z = zipfile.ZipFile(sys.argv[1]); assert z.testzip() is None; print(json.dumps([[i.filename, z.read(i).decode()] for i in z.infolist()]))";
    try {
        assert.deepEqual(JSON.parse(execFileSync("python3", ["-c", read, path], { encoding: "utf8", env: { ...process.env, PYTHONIOENCODING: "utf-8" } })), files);
    } catch (error) {
        if (error.code !== "ENOENT") throw error;
        t.skip("no python3");
    }
});
