/** What the program writes, in a folder of its own: the reference of the playground. */

import { spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const PROGRAM = process.env.ARMGEN ?? "armgen";

export const LANGUAGES = { rust: "robot.rs", c: "robot.h", cuda: "robot.cuh", python: "robot.py", javascript: "robot.mjs", matlab: "+robot" };

/** Runs the program beside a file of this name and text; the files that it wrote, in the order of their names. @param {string} name @param {string} text @param {string[]} words */
export function run(name, text, words) {
    const folder = mkdtempSync(join(tmpdir(), "armgen-"));
    const out = join(folder, "out");
    mkdirSync(out);
    writeFileSync(join(folder, name), text);
    const ended = spawnSync(PROGRAM, words, { cwd: folder, encoding: "utf8", maxBuffer: 1 << 28 });
    if (ended.error) throw ended.error;
    const files = readdirSync(out, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
    const paths = files.map(({ parentPath, path, name }) => join(parentPath ?? path, name).slice(out.length + 1)).sort();
    return { code: ended.status, said: ended.stderr, printed: ended.stdout, files: paths.map((path) => [path, readFileSync(join(out, path), "utf8")]) };
}

/** The files of a module in a language, with inverse kinematics where the arm and the language have it. @param {string} name @param {string} text @param {keyof typeof LANGUAGES} language @param {boolean} ik */
export function module(name, text, language, ik) {
    const { code, said, files } = run(name, text, ["generate", name, "--language", language, "--out", `out/${LANGUAGES[language]}`, ...(ik ? ["--ik"] : [])]);
    if (code !== 0) throw new Error(said);
    return files;
}

/** @param {[string, string][]} files */
export const sorted = (files) => [...files].sort(([a], [b]) => (a < b ? -1 : 1));

/** Whether files are the same; their names and lengths where not, since the texts are long. @param {[string, string][]} ours @param {[string, string][]} theirs */
export function difference(ours, theirs) {
    if (JSON.stringify(ours) === JSON.stringify(theirs)) return null;
    const lengths = (files) => files.map(([name, text]) => `${name} ${text.length}`).join(", ");
    const first = ours.findIndex(([name, text], k) => name !== theirs[k]?.[0] || text !== theirs[k]?.[1]);
    const [a, b] = [ours[first]?.[1] ?? "", theirs[first]?.[1] ?? ""].map((text) => text.split("\n"));
    const line = a.findIndex((words, k) => words !== b[k]);
    return `${lengths(ours)} | ${lengths(theirs)} | ${a[line]} | ${b[line]}`;
}
