/**
 * Where an arm is singular, in words.
 *
 * Of as many joints as rows of the task: where a factor of det J is zero. Of more joints n than rows m J loses rank where all determinants of m
 * of its columns are zero, whose squares add up to det(J Jᵀ) (Cauchy and Binet): that of one choice of columns alone says where J may lose it.
 */

import { html, math } from "./dom.mjs";
import { inWords, short, variable } from "./format.mjs";
import { bound, evaluate, parse, zeros } from "./formula.mjs";
import { mathml } from "./mathml.mjs";
import { ROUNDING } from "./linear.mjs";
import { sequence } from "./search.mjs";

/**
 * The angles from -pi on, below pi, at which a function of an angle is zero: below `least`, where that is not told by its signs.
 *
 * @param {(x: number) => number} of @param {number} least @param {number} [pieces] of a turn, in each of which it is looked at
 */
export function roots(of, least, pieces = 1440) {
    const step = (2 * Math.PI) / pieces;
    const at = (k) => (k - pieces / 2) * step;
    const values = Array.from({ length: pieces + 2 }, (_, k) => of(at(k - 1)));
    const found = [];
    for (let k = 0; k < pieces; k++) {
        let [low, high] = [at(k), at(k + 1)];
        const [before, here, after] = values.slice(k, k + 3);
        if (Math.abs(here) <= least) {
            // At a multiple of what a turn was divided into.
        } else if (here * after < 0) {
            for (let i = 0; i < 60; i++) {
                const middle = (low + high) / 2;
                if (of(low) * of(middle) <= 0) high = middle;
                else low = middle;
            }
        } else if (Math.abs(here) > Math.min(Math.abs(before), Math.abs(after))) {
            continue;
        } else {
            // It comes near and goes away again: where it is least it may touch zero.
            for ([low, high] = [at(k - 1), at(k + 1)]; high - low > 1e-9; ) {
                const [a, b] = [low + (high - low) / 3, high - (high - low) / 3];
                if (Math.abs(of(a)) < Math.abs(of(b))) high = b;
                else low = a;
            }
            if (Math.abs(of(low)) > least) continue;
        }
        const root = Math.abs(low) < 1e-8 ? 0 : low;
        if (!found.some((other) => Math.abs(other - root) < 1e-7)) found.push(root);
    }
    return found;
}

/** Where a factor is zero of which one joint decides, or why never; empty where several joints do. @param {string | null} zero as the description's notation has it @param {string} factor */
export function setOf(zero, factor) {
    const [, joint] = /^q(\d+) with /.exec(zero ?? "") ?? [];
    if (!zero?.startsWith("q")) return zero ?? "";
    if (!joint) return inWords(zero) + rounded(zero);
    if (!/(sin|cos)\(/.test(factor)) return `${variable(joint)} with ${inWords(factor)} = 0`;
    const all = rootsOf(factor).map(short);
    return all.length === 0 ? "never" : `${variable(joint)} = ${all.join(", ")} mod 2 π`;
}

/** The angles at which a factor of one angle is zero. @param {string} factor */
function rootsOf(factor) {
    const node = parse(factor);
    return roots((x) => evaluate(node, () => x), 64 * ROUNDING * bound(node, () => 0));
}

/** The number of a zero such as `q3 = atan(-4318/203) mod pi`, for whom it is to be typed; nothing for one that is plain. @param {string} zero */
function rounded(zero) {
    const angle = /= (.*atan.*) mod/.exec(zero)?.[1];
    return angle === undefined ? "" : ` (${short(evaluate(parse(angle), () => Math.PI))})`;
}

/** A formula, set; one that is wider than a narrow window scrolls by itself. @param {string} text */
export function formula(text) {
    const box = text.length > NARROW ? { class: "scroll", tabindex: 0, role: "region", "aria-label": "formula" } : {};
    return html("span", box, math("math", {}, mathml(parse(text), { exact: false, count: 0, steps: "" })));
}

/** Longest formula that fits a narrow window. */
const NARROW = 30;

/** Longest formula that stands in a sentence. */
const LONG = 200;

/** The sets of some factors, one after the other. @param {string[]} factors @param {(string | null)[]} singular */
function sets(factors, singular) {
    const all = factors.map((factor, k) => {
        const set = setOf(singular[k], factor);
        return set === "" ? (factor.length > LONG ? [`factor ${k + 1} is zero`] : [formula(factor), " = 0"]) : set === "never" ? [] : [set];
    });
    return all.filter((set) => set.length > 0).flatMap((set, k) => (k === 0 ? set : ["; or ", ...set]));
}

/**
 * Values of two joints at which a longer arm is singular whatever the others do: of those of the first six joints with what a search finds
 * beside each. The first joint and the last of all change nothing.
 *
 * @param {any} data @param {(q: number[]) => number} w @param {(q: number[]) => number} smallest singular value of J, which has digits where w has none any more
 * @returns {[number, number][][]} joints from 0, and their values
 */
export function pairs(data, w, smallest) {
    const { factors, singular } = data.firstSix;
    const alone = factors.flatMap((factor, f) => {
        const { joint, period, values } = zeros(singular[f]) ?? { joint: Number(singular[f].match(/\d+/)), period: 0, values: rootsOf(factor).map((value) => ({ value })) };
        return values.flatMap(({ value }) => (period === Math.PI ? [value, value > 0 ? value - Math.PI : value + Math.PI] : [value]).map((value) => [joint - 1, withZero(value)]));
    });
    // What the others do.
    const elsewhere = sequence(data.rows.length, 3).map((part) => part.map((x) => 6 * x - 3));
    /** @type {[number, number][][]} */
    const found = [];
    for (const [i, x] of alone) {
        for (let k = 1; k < data.rows.length - 1; k++) {
            if (k === i || data.rows[k].type !== "revolute") continue;
            const posture = (y, others) => others.map((other, m) => (m === i ? x : m === k ? y : other));
            const at = (y, others) => w(posture(y, others));
            const [first, ...rest] = elsewhere;
            const least = 1e-6 * Math.max(...[0, 1, 2, 3, 4, 5].map((y) => at(y, first)));
            for (const y of roots((y) => at(y, first), least, 120)) {
                const pair = /** @type {[number, number][]} */ ([[i, x], [k, y]]).sort(([a], [b]) => a - b);
                const isKnown = found.some((other) => other.every(([m, z], j) => m === pair[j][0] && Math.abs(Math.sin((z - pair[j][1]) / 2)) < 1e-6));
                if (isKnown || !rest.every((others) => at(y, others) < 10 * least)) continue;
                const exact = refined((y) => smallest(posture(y, first)), y);
                found.push(/** @type {[number, number][]} */ (pair.map(([m, z]) => [m, m === k ? exact : z])));
            }
        }
    }
    return found;
}

/** A zero x to all digits where a function grows as |x - root|: a secant between two places, one on each side. @param {(x: number) => number} of @param {number} near */
export function refined(of, near) {
    let x = near;
    for (const h of [1e-6, 1e-7, 1e-8]) {
        const [a, b] = [of(x - h), of(x + h)];
        if (a + b > 0) x += (h * (a - b)) / (a + b);
    }
    return withZero(x);
}

/** A zero x without its rounding where it is 0. @param {number} x */
function withZero(x) {
    return Math.abs(x) < 1e-14 ? 0 : x;
}

/** The sentences. @param {any} data @returns {(Node | string)[]} */
export function whereSingular(data) {
    const [joints, rows] = [data.rows.length, data.task.length];
    const { factors, common, singular } = data.determinant ?? {};
    if (joints < rows) return [`Of ${rows} rows of the task ${joints} joints never reach more than ${joints} at once.`];
    if (joints === rows) {
        if (!factors) return [];
        const where = sets(factors, singular);
        return where.length === 0 ? ["Nowhere."] : ["Singular where ", ...where, "; and nowhere else."];
    }
    const shared = common ? ["Singular wherever ", ...sets(common, singular), ". "] : [];
    const all = `${shared.length > 0 ? "Elsewhere it is" : "Singular"} where the determinants of all choices of ${rows} columns of J are zero at once; w² is the sum of their squares.`;
    const { factors: six, singular: zero } = data.firstSix ?? {};
    const needed = six ? sets(six, zero) : [];
    // One that is always zero says nothing, and one of which several joints decide as little as w does.
    const tells = six && zero.every((text) => text !== null && text !== "at every q");
    return [...shared, all, ...(tells ? [" That of the first six is zero nowhere but where ", ...needed, ". Only there can the arm be singular, and it is singular there only where the determinants of all other choices are zero as well."] : [])];
}
