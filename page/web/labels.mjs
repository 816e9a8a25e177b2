/** Where texts of the picture stand: inside of it, and beside each other. */

import { HEIGHT, WIDTH } from "./view.mjs";

/** @typedef {{x: number, y: number, width: number, height: number}} Box with its upper left corner */
/** @typedef {{x: number, y: number, end: boolean}} Place of a text: where it begins, or ends */

/** About how wide a letter is, for a size of 13 units and in bold. */
const LETTER = 8.3;
const LINE = 16;

/** How much of a box others cover. @param {Box} a @param {Box} b */
function common(a, b) {
    const along = (x, width) => Math.max(0, Math.min(a[x] + a[width], b[x] + b[width]) - Math.max(a[x], b[x]));
    return along("x", "width") * along("y", "height");
}

/** The box of a text, moved into the picture. @param {string} text @param {Place} at @param {number} pixel */
export function box(text, { x, y, end }, pixel) {
    const [width, height] = [LETTER * pixel * text.length, LINE * pixel];
    const inside = (c, size, whole) => Math.max(4, Math.min(whole - size - 4, c));
    return { x: inside(end ? x - width : x, width, WIDTH), y: inside(y - 0.8 * height, height, HEIGHT), width, height };
}

/**
 * The place of a text, of those that are thought of the one that covers least: other texts, and points of what is drawn.
 *
 * @param {string} text @param {Place[]} places the best first @param {number} pixel how much larger texts are than 13 units
 * @param {Box[]} taken by other texts @param {number[][]} points
 */
export function settle(text, places, pixel, taken, points = []) {
    const found = places.map((place, order) => {
        const own = box(text, place, pixel);
        const covered = points.filter(([x, y]) => x > own.x && x < own.x + own.width && y > own.y && y < own.y + own.height).length;
        const cost = taken.reduce((sum, other) => sum + 10 * common(own, other), 0) + 120 * covered + order;
        return { own, cost, end: place.end };
    });
    const { own, end } = found.reduce((best, one) => (one.cost < best.cost ? one : best));
    return { box: own, at: { x: (end ? own.x + own.width : own.x).toFixed(1), y: (own.y + 0.8 * own.height).toFixed(1), "text-anchor": end ? "end" : "start" } };
}
