/**
 * What is shown: the posture, rates and accelerations, and who has to know when they change.
 *
 * Kinds of changes: "motion" (q, dq or ddq), "singular" (after every motion, once it is known whether the posture is), "units" (m or mm, rad or deg), "view", "sweep" (the joints begin to sweep), "theme".
 */

export class State {
    /** @param {number} joints */
    constructor(joints) {
        this.q = new Array(joints).fill(0);
        this.dq = new Array(joints).fill(0);
        this.ddq = new Array(joints).fill(0);
        /** Whether the posture is singular: 0 no, 1 nearly, 2 yes. */
        this.singular = 0;
        /** @type {Map<string, (() => void)[]>} */
        this.listeners = new Map();
    }

    /** @param {string} kind @param {() => void} listener */
    on(kind, listener) {
        this.listeners.set(kind, [...(this.listeners.get(kind) ?? []), listener]);
    }

    /** @param {string} kind */
    changed(kind) {
        for (const listener of this.listeners.get(kind) ?? []) listener();
    }

    /** @param {number[]} q */
    move(q) {
        this.q = q.slice();
        this.changed("motion");
    }
}

/** Where a page starts: 0, and the middle of the limits that exclude it. @param {any} data */
export function home(data) {
    return data.rows.map(({ limits }) => (limits && (limits[0] > 0 || limits[1] < 0) ? (limits[0] + limits[1]) / 2 : 0));
}

/** The range of a slider. @param {any} row */
export function range(row) {
    return row.limits ?? (row.type === "revolute" ? [-Math.PI, Math.PI] : [-1, 1]);
}
