/**
 * The one mistake that explains measured poses: every row with one value changed as such values are mistaken, held against what was
 * measured.
 *
 * The difference of a pose is |p - p'| and, where an orientation was measured, the angle between both times the size of the arm, added as
 * squares; of several poses the root of their mean, in m.
 */

import { compose, identity, origin, rotation, subtract, norm } from "./vector.mjs";
import { units, withUnit } from "./format.mjs";
import { rowFrame, urdfFrame } from "./kinematics.mjs";

/**
 * @typedef {{q: number[], position: number[], frame: number[][] | null}} Measured
 * @typedef {{row: number, fault: string, words: string, arm: Variant}} Suspect row 0: no single row
 * @typedef {{convention: string, rows: any[], base: number[][], tool: number[][], signs: number[]}} Variant
 */

/** The arm of the page. @param {any} data @returns {Variant} */
export function asWritten(data) {
    return { convention: data.convention, rows: data.rows, base: data.base, tool: data.tool, signs: data.rows.map(() => 1) };
}

/** The frames of the links and of the end effector. @param {Variant} arm @param {number[]} q */
export function frames(arm, q) {
    let frame = arm.base;
    const links = arm.rows.map((row, i) => {
        const moved = arm.signs[i] * q[i];
        const own = row.dh ? rowFrame(arm.convention, row.dh, row.type === "revolute", moved) : urdfFrame(row, moved);
        frame = compose(frame, own);
        return frame;
    });
    return { links, end: compose(frame, arm.tool) };
}

const RIGHT = Math.PI / 2;

/** What can be mistaken in a row: the name, and the values a, alpha, d, theta instead. @param {number[]} dh @returns {[string, string, number[]][]} */
function mistaken([a, alpha, d, theta]) {
    return [
        ["a-sign", "the other sign", [-a, alpha, d, theta]],
        ["alpha-sign", "the other sign", [a, -alpha, d, theta]],
        ["d-sign", "the other sign", [a, alpha, -d, theta]],
        ["theta-sign", "the other sign", [a, alpha, d, -theta]],
        ["alpha+90", "90° more", [a, alpha + RIGHT, d, theta]],
        ["alpha-90", "90° less", [a, alpha - RIGHT, d, theta]],
        ["alpha+180", "180° more", [a, alpha + 2 * RIGHT, d, theta]],
        ["theta+90", "90° more", [a, alpha, d, theta + RIGHT]],
        ["theta-90", "90° less", [a, alpha, d, theta - RIGHT]],
        ["theta+180", "180° more", [a, alpha, d, theta + 2 * RIGHT]],
        ["exchanged", "exchanged", [d, alpha, a, theta]],
        ["a*1000", "1000 times as long", [a * 1000, alpha, d, theta]],
        ["a/1000", "a thousandth of it", [a / 1000, alpha, d, theta]],
        ["d*1000", "1000 times as long", [a, alpha, d * 1000, theta]],
        ["d/1000", "a thousandth of it", [a, alpha, d / 1000, theta]],
    ];
}

/** An angle as a part of pi, where it is one; else in the unit of the reader. @param {number} angle */
function angleText(angle) {
    for (const below of [1, 2, 3, 4, 6]) {
        const above = Math.round((angle * below) / Math.PI);
        if (Math.abs(angle - (above * Math.PI) / below) > 1e-12) continue;
        if (above === 0) return "0";
        return `${above === 1 ? "" : above === -1 ? "-" : `${above} `}pi${below === 1 ? "" : `/${below}`}`;
    }
    return withUnit(angle, "rad");
}

/** What the row is and should be: `alpha is pi/2, should be -pi/2`; of the joint's own variable it is the offset. @param {any} row @param {number[]} dh */
function instead(row, dh) {
    const names = ["a", "alpha", row.type === "revolute" ? "d" : "offset of d", row.type === "revolute" ? "offset of theta" : "theta"];
    const changed = names.flatMap((name, k) => (dh[k] === row.dh[k] ? [] : [k]));
    const text = (value, k) => (k % 2 === 1 ? angleText(value) : withUnit(value, "m"));
    return changed.map((k) => `${names[k]} is ${text(row.dh[k], k)}, should be ${text(dh[k], k)}`).join("; ");
}

/** Whether two rows are the same frames. @param {number[]} one @param {number[]} other */
function same(one, other) {
    const turn = (x) => Math.abs(Math.sin(x / 2)) < 1e-9;
    return one[0] === other[0] && one[2] === other[2] && turn(one[1] - other[1]) && turn(one[3] - other[3]);
}

/** Every suspect. @param {any} data @returns {Suspect[]} */
export function suspects(data) {
    const arm = asWritten(data);
    const all = [];
    data.rows.forEach((row, i) => {
        const name = `row ${i + 1} (${row.name})`;
        if (row.dh) {
            /** Mistakes that are the same row are one suspect. */
            const found = [];
            for (const [fault, words, dh] of mistaken(row.dh)) {
                if (same(dh, row.dh)) continue;
                const other = found.find((one) => same(one.dh, dh));
                if (other) {
                    other.suspect.words = other.suspect.words.replace(/\)$/, `, or ${words}, which is the same)`);
                    continue;
                }
                const rows = arm.rows.map((other, k) => (k === i ? { ...row, dh } : other));
                const suspect = { row: i + 1, fault, words: `${name}: ${instead(row, dh)} (${words})`, arm: { ...arm, rows } };
                found.push({ dh, suspect });
                all.push(suspect);
            }
        }
        const signs = arm.signs.map((sign, k) => (k === i ? -sign : sign));
        all.push({ row: i + 1, fault: "reversed", words: `${name}: the joint counts the other way, q${i + 1} should be -q${i + 1}`, arm: { ...arm, signs } });
    });
    if (data.convention !== "urdf") {
        const convention = data.convention === "standard" ? "modified" : "standard";
        all.push({ row: 0, fault: "convention", words: `convention: the rows are taken as ${data.convention}, should be ${convention}`, arm: { ...arm, convention } });
    }
    const moved = norm(origin(data.tool)) > 0 || data.tool.some((row, i) => row.slice(0, 3).some((x, j) => x !== (i === j ? 1 : 0)));
    if (moved) all.push({ row: 0, fault: "tool", words: "the tool was left out of what was measured", arm: { ...arm, tool: identity() } });
    return all;
}

/** Whether arms that explain the same positions differ in the orientation at one of them. @param {Suspect[]} equal @param {Measured[]} measured */
export function differInOrientation(equal, measured) {
    const ends = ({ arm }) => measured.map(({ q }) => frames(arm, q).end);
    const first = ends(equal[0]);
    return equal.some((suspect) => ends(suspect).some((end, k) => angle(end, first[k]) > 1e-6));
}

/** The angle between two frames. @param {number[][]} a @param {number[][]} b */
function angle(a, b) {
    let square = 0;
    for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) square += (a[i][j] - b[i][j]) ** 2;
    // |R - R'|² = 8 sin²(angle/2), which keeps its digits where angles are small.
    return 2 * Math.asin(Math.min(1, Math.sqrt(square / 8)));
}

/** How far an arm is from a measured pose: position in m, orientation in rad (0 where none was measured). @param {Variant} arm @param {Measured} measured */
export function apart(arm, measured) {
    const { end } = frames(arm, measured.q);
    return { position: norm(subtract(origin(end), measured.position)), angle: measured.frame ? angle(end, measured.frame) : 0 };
}

/** The difference of an arm from all that was measured, m. @param {Variant} arm @param {Measured[]} all @param {number} size */
export function difference(arm, all, size) {
    const squares = all.map((measured) => {
        const { position, angle } = apart(arm, measured);
        return position ** 2 + (size * angle) ** 2;
    });
    return Math.sqrt(squares.reduce((sum, square) => sum + square, 0) / all.length);
}

/**
 * Suspects that leave at most half of the difference of the arm as it is written, smallest first; those that explain as much as the first are marked, and
 * stand in the order of the rows, of which rounding knows nothing.
 *
 * @param {any} data @param {Measured[]} measured @param {number} size
 */
export function explain(data, measured, size) {
    const before = difference(asWritten(data), measured, size);
    const all = suspects(data).map((suspect) => ({ ...suspect, difference: difference(suspect.arm, measured, size) }));
    const least = Math.min(...all.map((suspect) => suspect.difference)) * 1.02 + 1e-9 * size;
    const marked = all.map((suspect) => ({ ...suspect, equal: suspect.difference <= least }));
    const place = ({ equal, difference }) => (equal ? 0 : difference);
    marked.sort((a, b) => place(a) - place(b));
    return { before, suspects: marked.filter((suspect) => suspect.difference <= 0.5 * before) };
}

/**
 * The vector by which all measured positions differ from those of an arm, m, up to a tenth of it: in the base frame, else in the frame of the
 * end effector; null where they differ by several.
 *
 * @param {Variant} arm @param {Measured[]} measured @returns {{vector: number[], own: boolean} | null} own: in the frame of the end effector
 */
export function commonVector(arm, measured) {
    const ends = measured.map(({ q }) => frames(arm, q).end);
    const apart = measured.map(({ position }, k) => subtract(position, origin(ends[k])));
    const turned = apart.map((vector, k) => vector.map((_, j) => vector.reduce((sum, x, i) => sum + ends[k][i][j] * x, 0)));
    for (const all of [apart, turned]) {
        const mean = all[0].map((_, i) => all.reduce((sum, vector) => sum + vector[i], 0) / all.length);
        if (all.some((vector) => norm(subtract(vector, mean)) > 0.1 * norm(mean))) continue;
        return { vector: mean.map((x) => (Math.abs(x) < 0.01 * norm(mean) ? 0 : Number(x.toPrecision(3)))), own: all === turned };
    }
    return null;
}

/**
 * The units that what was measured seems to have instead of those that are chosen: m and mm where all positions are ten times as far from the
 * base as the arm is long, or all within a hundredth of it; degrees where a joint turns more than once and beyond its limits.
 *
 * @param {any} data @param {Measured[]} measured @param {number} size @returns {{kind: string, instead: string, words: string}[]}
 */
export function doubtedUnits(data, measured, size) {
    const far = measured.map(({ position }) => norm(subtract(position, origin(data.base))) / size);
    const turns = ({ q }) => data.rows.some((row, i) => row.type === "revolute" && Math.abs(q[i]) > Math.max(2 * Math.PI, ...(row.limits ?? []).map(Math.abs)) + 1e-6);
    const all = [];
    if (units.length === "m" && Math.min(...far) > 10) all.push({ kind: "length", instead: "mm", words: `The positions are ${Math.round(Math.min(...far))} times as far away as the arm is long` });
    if (units.length === "mm" && Math.max(...far) < 0.01) all.push({ kind: "length", instead: "m", words: "The positions are within a hundredth of the arm's size" });
    if (units.angle === "rad" && measured.some(turns)) all.push({ kind: "angle", instead: "deg", words: "A joint turns by more than 2 π" });
    return all;
}

/**
 * Lines `q1 ... qn x y z` or `q1 ... qn x y z roll pitch yaw`, numbers separated by spaces, commas or semicolons.
 *
 * @param {string} text @param {number} joints @param {(value: number, unit: string) => number} convert @param {string[]} units of the joints
 */
export function read(text, joints, convert, units) {
    const measured = [];
    const faults = [];
    text.split("\n").forEach((line, k) => {
        // Brackets of a copied vector and what stands behind # mean nothing.
        const words = line.replace(/#.*/, "").split(/[\s,;[\]()]+/).filter((word) => word !== "");
        if (words.length === 0) return;
        const numbers = words.map(Number);
        const wrong = words.find((_, i) => !Number.isFinite(numbers[i]));
        if (wrong !== undefined) {
            faults.push(`line ${k + 1}: “${wrong}” is no number`);
        } else if (numbers.length !== joints + 3 && numbers.length !== joints + 6) {
            faults.push(`line ${k + 1}: ${numbers.length} numbers; ${joints} joints and x y z are ${joints + 3}, with roll pitch yaw ${joints + 6}${commas(line)}`);
        } else {
            const q = units.map((unit, i) => convert(numbers[i], unit));
            const position = numbers.slice(joints, joints + 3).map((x) => convert(x, "m"));
            const angles = numbers.slice(joints + 3).map((x) => convert(x, "rad"));
            measured.push({ q, position, frame: angles.length === 3 ? fromRollPitchYaw(angles) : null });
        }
    });
    return { measured, faults };
}

/** What is said of a line with commas for points. @param {string} line */
function commas(line) {
    const number = /(?<![\d.,])[-+−]?\d+,\d+(?![\d.,])/g;
    const words = line.match(number);
    return words ? `. Commas were read as separators: write points, ${words.slice(0, 2).join(" ").replaceAll(",", ".")}${words.length > 2 ? " …" : ""}` : "";
}

/** Rz(yaw) Ry(pitch) Rx(roll). @param {number[]} angles roll, pitch, yaw */
export function fromRollPitchYaw([roll, pitch, yaw]) {
    return [rotation([0, 0, 1], yaw), rotation([0, 1, 0], pitch), rotation([1, 0, 0], roll)].reduce(compose);
}
