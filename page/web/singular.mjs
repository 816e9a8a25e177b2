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

/** Pieces of a turn in which a factor is looked at. */
const PIECES = 1440;

/** The angles from -pi on, below pi, at which a function of an angle is zero; `size` is what it can be. @param {(x: number) => number} of @param {number} size */
export function roots(of, size) {
    const step = (2 * Math.PI) / PIECES;
    const at = (k) => (k - PIECES / 2) * step;
    const found = [];
    for (let k = 0; k < PIECES; k++) {
        let [low, high] = [at(k), at(k + 1)];
        const isZero = () => Math.abs(of(low)) <= 64 * ROUNDING * size;
        if (isZero()) {
            // At a multiple of what a turn was divided into.
        } else if (of(low) * of(high) < 0) {
            for (let i = 0; i < 60; i++) {
                const middle = (low + high) / 2;
                if (of(low) * of(middle) <= 0) high = middle;
                else low = middle;
            }
        } else if (Math.abs(of(low)) > Math.min(Math.abs(of(at(k - 1))), Math.abs(of(high)))) {
            continue;
        } else {
            // It comes near and goes away again: where it is least it may touch zero.
            for ([low, high] = [at(k - 1), at(k + 1)]; high - low > 1e-9; ) {
                const [a, b] = [low + (high - low) / 3, high - (high - low) / 3];
                if (Math.abs(of(a)) < Math.abs(of(b))) high = b;
                else low = a;
            }
            if (!isZero()) continue;
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
    const node = parse(factor);
    if (!/(sin|cos)\(/.test(factor)) return `${variable(joint)} with ${inWords(factor)} = 0`;
    const all = roots((x) => evaluate(node, () => x), bound(node, () => 0)).map(short);
    return all.length === 0 ? "never" : `${variable(joint)} = ${all.join(", ")} mod 2 π`;
}

/** The number of a zero such as `q3 = atan(-4318/203) mod pi`, for whom it is to be typed; nothing for one that is plain. @param {string} zero */
function rounded(zero) {
    const angle = /= (.*atan.*) mod/.exec(zero)?.[1];
    return angle === undefined ? "" : ` (${short(evaluate(parse(angle), () => Math.PI))})`;
}

/** A formula, set. @param {string} text */
export function formula(text) {
    return html("span", {}, math("math", {}, mathml(parse(text), { exact: false, count: 0, steps: "" })));
}

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
    return [...shared, all, ...(tells ? [" That of the first six is zero nowhere but where ", ...needed, ": only there can the arm be singular, and is where those of the other choices are zero as well."] : [])];
}
