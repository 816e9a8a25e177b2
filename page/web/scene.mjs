/**
 * The arm as solids: links as cylinders along the path that each row describes, joints as cylinders about their axes, prismatic ones as a
 * rail with a slide.
 *
 * standard: from frame i - 1 along its z by d, then along x of frame i by a
 * modified: from frame i - 1 along its x by a, then along z of frame i by d
 * urdf:     from frame i - 1 to the origin, then along the axis if the joint slides
 *
 * Where an arm branches, frame i - 1 is the one that the row starts from.
 */

import { links, variables } from "./kinematics.mjs";
import { Ball, Box, Cylinder } from "./solids.mjs";
import { along, column, compose, cross, direct, norm, origin, perpendicular, scale } from "./vector.mjs";

/** The rows of all joints, with all that a page has of them. @param {any} data @returns {any[]} */
function rows(data) {
    return links(data);
}

/** The end effectors but the first one. @param {any} data @returns {{name: string, link: number, tool: number[][]}[]} */
export function ends(data) {
    return data.ends ?? [];
}

/** Their frames. @param {any} data @param {number[][][]} frames those of the links, from 1 */
export function endFrames(data, frames) {
    return ends(data).map(({ link, tool }) => compose(frames[link], tool));
}

/** How long an arm is, m: the sum of the lengths of its rows and of what its slides can add. @param {any} data */
export function size(data) {
    let length = 0;
    for (const row of rows(data)) {
        for (const frame of [...row.before, ...row.after]) length += norm(origin(frame));
        if (row.type === "prismatic" && row.limits) length += Math.max(...row.limits.map(Math.abs)) / 2;
    }
    length += norm(origin(data.tool)) + norm(origin(data.base)) / 2;
    if (length > 0) return length;
    const reach = data.bodies.map((body) => norm(body.com));
    return Math.max(0, ...reach) || 1;
}

/** The corners of a row: where it begins, where it bends, where it ends, and its joint's place and axis. @param {any} data @param {number} i @param {number[][]} start @param {number[][]} end @param {number} q */
function bend(data, i, start, end, q) {
    const row = rows(data)[i];
    if (data.convention === "urdf") {
        const before = row.before.reduce(compose, start);
        const at = origin(before);
        return { points: [origin(start), at, origin(end)], joint: at, axis: direct(before, row.axis), moved: 1 };
    }
    const [a, , d] = row.dh;
    if (data.convention === "standard") {
        const z = column(start, 2);
        const corner = along(origin(start), row.type === "prismatic" ? d + q : d, z);
        const joint = i === 0 && row.type === "revolute" ? corner : origin(start);
        return { points: [origin(start), corner, origin(end)], joint, axis: z, moved: 0 };
    }
    const corner = along(origin(start), a, column(start, 0));
    const joint = i === 0 && row.type === "revolute" ? origin(end) : corner;
    return { points: [origin(start), corner, origin(end)], joint, axis: column(end, 2), moved: 1 };
}

export class Arm {
    /** @param {any} data @param {string} [kind] a class for all of its solids */
    constructor(data, kind = "") {
        this.data = data;
        this.size = size(data);
        const [link, joint] = [this.size * 0.016, this.size * 0.028];
        this.half = this.size * 0.045;
        /** @type {any[]} */
        this.rows = rows(data).map((row) => {
            const prismatic = row.type === "prismatic";
            return {
                prismatic,
                segments: [new Cylinder(link, `link ${kind}`), new Cylinder(link, `link ${kind}`)],
                ball: new Ball(link, `link ${kind}`),
                joint: prismatic ? new Box(`joint ${kind}`) : new Cylinder(joint, `joint ${kind}`),
                rail: prismatic ? new Box(`rail ${kind}`) : null,
            };
        });
        this.tool = new Cylinder(link * 0.7, `link ${kind}`);
        /** The links to the end effectors but the first one. @type {Cylinder[]} */
        this.tools = ends(data).map(() => new Cylinder(link * 0.7, `link ${kind}`));
        this.base = new Cylinder(this.size * 0.06, `base ${kind}`);
        /** @type {(Ball | Box | Cylinder)[]} */
        this.solids = [this.base, this.tool, ...this.tools];
        for (const row of this.rows) {
            this.solids.push(...row.segments, row.ball, row.joint);
            if (row.rail) this.solids.push(row.rail);
        }
        /** Points that a picture of it shows. */
        this.points = [];
    }

    /** The frame that a row starts from: where arms branch, in that of its parent. @param {number} i @param {number[][][]} frames */
    start(i, frames) {
        const { branch } = rows(this.data)[i];
        if (branch) return branch.parent === null ? branch.start : compose(frames[branch.parent], branch.start);
        return i === 0 ? this.data.base : frames[i - 1];
    }

    /** @param {number[]} coordinates @param {number[][][]} frames those of the links, from 1 @param {number[][]} end that of the end effector */
    place(coordinates, frames, end) {
        const { data } = this;
        const q = variables(data, coordinates);
        this.points = [];
        const up = column(data.base, 2);
        this.base.between(along(origin(data.base), -0.03 * this.size, up), origin(data.base));
        this.rows.forEach((row, i) => {
            const start = this.start(i, frames);
            const { points, joint, axis, moved } = bend(data, i, start, frames[i], q[i]);
            this.points.push(...points);
            row.segments[0].between(points[0], points[1]);
            row.segments[1].between(points[1], points[2]);
            row.ball.at = points[1];
            if (row.prismatic) {
                const side = perpendicular(axis);
                const third = cross(axis, side);
                const carrier = moved === 0 ? points[1] : points[2];
                const rest = along(carrier, -q[i], axis);
                const [low, high] = rows(data)[i].limits ?? [Math.min(0, q[i]), Math.max(0, q[i])];
                const middle = along(rest, (low + high) / 2, axis);
                const frame = (at) => [0, 1, 2].map((k) => [side[k], third[k], axis[k], at[k]]);
                row.rail.place(frame(middle), [this.half * 0.18, this.half * 0.18, (high - low) / 2 + this.half * 0.5]);
                row.joint.place(frame(carrier), [this.half * 0.55, this.half * 0.55, this.half * 0.7]);
            } else {
                row.joint.between(along(joint, -this.half, axis), along(joint, this.half, axis));
            }
        });
        this.tool.between(origin(frames[data.tip]), origin(end));
        this.points.push(origin(end));
        endFrames(data, frames).forEach((frame, k) => {
            this.tools[k].between(origin(frames[ends(data)[k].link]), origin(frame));
            this.points.push(origin(frame));
        });
    }
}

/** A step of a grid: 1, 2 or 5 times a power of ten, about a length. @param {number} length */
export function step(length) {
    const power = 10 ** Math.floor(Math.log10(length));
    const digit = [5, 2, 1].find((digit) => digit * power <= length);
    return (digit ?? 1) * power;
}

/** A direction as long as 1. @param {number[]} v */
export function unit(v) {
    const length = norm(v);
    return length === 0 ? v : scale(v, 1 / length);
}
