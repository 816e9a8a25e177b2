/**
 * Why a posture is singular, by what the axes of the joints do: two on one line, three parallel ones in one plane, four through one point, two in
 * one plane with the tip. Where it is none of these, what every axis does at the line of the lost motion.
 *
 * Columns of J of which k span fewer than k dimensions move the end effector as fewer joints would; if those that are left are fewer than the
 * rows of the task, the posture is singular, whatever the others do.
 */

import { variable } from "./format.mjs";
import { add, along, cross, dot, norm, scale, subtract } from "./vector.mjs";

/** How far lines and directions may be off, as parts of the arm's length and of 1. */
const NEAR = 1e-7;
/** More joints than this are not gone through by threes and fours. */
const MANY = 12;

/** @typedef {{k: number, slides: boolean, direction: number[], at: number[]}} Axis k from 1; `at` is the point of the axis that is nearest to the tip */

/** The axes of the joints, of a Jacobian at the tip. @param {number[][]} jacobian 6 by n @param {boolean[]} slides @param {number[]} tip @returns {Axis[]} */
export function axes(jacobian, slides, tip) {
    return slides.map((slides, i) => {
        const [v, w] = [0, 3].map((from) => [0, 1, 2].map((row) => jacobian[from + row][i]));
        return { k: i + 1, slides, direction: slides ? v : w, at: slides ? tip : add(tip, cross(w, v)) };
    });
}

/** q₁, q₂ and q₄. @param {Axis[]} of */
function names(of) {
    const all = of.map(({ k }) => variable(k));
    return all.length < 2 ? all.join("") : `${all.slice(0, -1).join(", ")} and ${all.at(-1)}`;
}

/** The rank of a set of vectors. @param {number[][]} vectors */
function rank(vectors) {
    const basis = [];
    for (const vector of vectors) {
        const rest = basis.reduce((left, one) => along(left, -dot(left, one), one), vector);
        if (norm(rest) > NEAR) basis.push(scale(rest, 1 / norm(rest)));
    }
    return basis.length;
}

/** All groups of so many axes. @param {Axis[]} all @param {number} count @returns {Axis[][]} */
function groups(all, count) {
    if (count === 0) return [[]];
    return all.flatMap((axis, i) => groups(all.slice(i + 1), count - 1).map((rest) => [axis, ...rest]));
}

/** The point of one axis that is nearest to another; none of parallel ones. @param {Axis} a @param {Axis} b */
function crossing(a, b) {
    const normal = cross(a.direction, b.direction);
    if (norm(normal) < NEAR) return null;
    return along(a.at, dot(cross(subtract(b.at, a.at), b.direction), normal) / dot(normal, normal), a.direction);
}

/** How far a point is from an axis. @param {number[]} point @param {Axis} axis */
function away(point, axis) {
    return norm(cross(subtract(point, axis.at), axis.direction));
}

/**
 * Kinds of groups: how many axes take part, how many dimensions they span when they do, whether they do, and the words.
 *
 * @typedef {{slides: boolean, count: number, spans: number, holds: (of: Axis[]) => boolean, words: (of: string) => string}} Kind
 */

/** @param {number} size the arm's length @param {number[] | null} tip where the task has no orientation @returns {Kind[]} */
function kinds(size, tip) {
    const near = NEAR * size;
    const to = (axis, point) => scale(subtract(axis.at, point), 1 / size);
    const directions = (of) => rank(of.map((axis) => axis.direction));
    const parallel = (of) => directions(of) === 1;
    const meet = (of) => {
        const other = of.find((axis) => directions([of[0], axis]) > 1);
        const point = other && crossing(of[0], other);
        return Boolean(point) && of.every((axis) => away(/** @type {number[]} */ (point), axis) < near);
    };
    const inPlane = (of, point) => rank(of.flatMap((axis) => [axis.direction, to(axis, point)])) < 3;
    const turns = (count, spans, holds, words) => ({ slides: false, count, spans, holds, words });
    const slides = (count, spans, holds, words) => ({ slides: true, count, spans, holds, words });
    const bent = ": the arm is stretched or folded";
    return [
        turns(1, 0, ([axis]) => tip !== null && away(tip, axis) < near, (of) => `the axis of ${of} goes through the tip`),
        turns(2, 1, (of) => parallel(of) && away(of[0].at, of[1]) < near, (of) => `the axes of ${of} lie on one line`),
        turns(2, 1, (of) => tip !== null && inPlane(of, tip), (of) => `the axes of ${of} lie in one plane with the tip${bent}`),
        turns(3, 2, (of) => parallel(of) && inPlane(of, of[0].at), (of) => `the axes of ${of} are parallel and lie in one plane${bent}`),
        turns(3, 2, (of) => directions(of) === 2 && meet(of), (of) => `the axes of ${of} lie in one plane and go through one point`),
        turns(4, 3, parallel, (of) => `the axes of ${of} are parallel`),
        turns(4, 3, (of) => directions(of) === 3 && meet(of), (of) => `the axes of ${of} go through one point`),
        slides(2, 1, parallel, (of) => `${of} slide along one direction`),
        slides(3, 2, (of) => directions(of) === 2, (of) => `${of} slide in one plane`),
    ];
}

/**
 * What makes the joints fewer than the rows of the task, in words; empty where it is none of what is looked for.
 *
 * @param {Axis[]} all @param {number} rows of the task @param {number} size the arm's length @param {number[] | null} tip where the task has no orientation
 */
export function dependentAxes(all, rows, size, tip) {
    for (const { slides, count, spans, holds, words } of kinds(size, tip)) {
        const candidates = all.filter((axis) => axis.slides === slides);
        if (count > 2 && candidates.length > MANY) continue;
        /** As large as they can be. @type {Axis[][]} */
        const sets = [];
        for (const group of groups(candidates, count).filter(holds)) {
            if (sets.some((set) => group.every((axis) => set.includes(axis)))) continue;
            const set = [...group];
            for (const axis of candidates) {
                if (!set.includes(axis) && groups(set, count - 1).every((rest) => holds([...rest, axis]))) set.push(axis);
            }
            sets.push(set.sort((a, b) => a.k - b.k));
        }
        const left = sets.reduce((joints, set) => joints - (set.length - spans), all.length);
        if (sets.length > 0 && left < rows) return sets.map((set) => words(names(set))).join("; ");
    }
    return "";
}

/** What each axis does at a line along which nothing moves; empty where one does none of it. @param {Axis[]} all @param {{at: number[], direction: number[], kind: string}} line of kind move, or turn, about which nothing turns @param {number} size */
export function axesAtLine(all, line, size) {
    if (line.kind === "turn") return "every axis about which a joint turns is perpendicular to the line that is drawn";
    /** @type {Record<string, Axis[]>} */
    const doing = { meet: [], "are parallel to": [], "slide across": [] };
    for (const axis of all) {
        const normal = cross(axis.direction, line.direction);
        const meets = Math.abs(dot(subtract(axis.at, line.at), normal)) < NEAR * size * norm(normal);
        if (axis.slides && Math.abs(dot(axis.direction, line.direction)) < NEAR) doing["slide across"].push(axis);
        else if (!axis.slides && norm(normal) < NEAR) doing["are parallel to"].push(axis);
        else if (!axis.slides && meets) doing.meet.push(axis);
        else return "";
    }
    const said = Object.entries(doing).flatMap(([does, of]) => (of.length === 0 ? [] : [`${does.startsWith("slide") ? "" : of.length > 1 ? "the axes of " : "the axis of "}${names(of)} ${of.length > 1 ? does : ONE[does]} it`]));
    return `no joint can move anything along the line that is drawn: ${said.join("; ")}`;
}

const ONE = { meet: "meets", "are parallel to": "is parallel to", "slide across": "slides across" };
