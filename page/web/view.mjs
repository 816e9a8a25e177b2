/**
 * An orthographic view: directions right and up on the screen and towards the viewer, a scale and what stands in the middle.
 *
 * The viewer stands at azimuth and elevation: front sees x to the right and z up, side y to the right, top x to the right and y up.
 */

import { cross, dot, subtract } from "./vector.mjs";

/** Azimuth and elevation of the views, rad. */
export const VIEWS = {
    front: [-Math.PI / 2, 0],
    side: [0, 0],
    top: [-Math.PI / 2, Math.PI / 2],
    oblique: [-0.95, 0.42],
};

/** Width and height of the picture, in units of the drawing. */
export const WIDTH = 600;
export const HEIGHT = 480;

export class View {
    constructor() {
        this.name = "oblique";
        this.azimuth = VIEWS.oblique[0];
        this.elevation = VIEWS.oblique[1];
        this.centre = [0, 0, 0];
        this.scale = 100;
        /** A pixel of the window in units of the drawing, where the picture is narrow. */
        this.pixel = 1;
        /** What stands over the upper edge, in units of the drawing. */
        this.above = 0;
        /** Directions towards the viewer, and to the right and up on the screen. */
        this.toward = [0, 0, 1];
        this.right = [1, 0, 0];
        this.up = [0, 1, 0];
        this.turn();
    }

    /** Computes the directions. */
    turn() {
        const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
        const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
        this.toward = [ce * ca, ce * sa, se];
        this.right = [-sa, ca, 0];
        this.up = cross(this.toward, this.right);
    }

    /** One of the views by name. @param {string} name */
    choose(name) {
        this.name = name;
        [this.azimuth, this.elevation] = VIEWS[name];
        this.turn();
    }

    /** Turns about the vertical and up or down. @param {number} azimuth @param {number} elevation */
    orbit(azimuth, elevation) {
        this.name = "";
        this.azimuth += azimuth;
        this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + elevation));
        this.turn();
    }

    /** The scale at which points fill the picture. @param {number[][]} points */
    scaleFor(points) {
        const [width, height] = [this.right, this.up].map((direction) => {
            const all = points.map((point) => dot(point, direction));
            return Math.max(...all) - Math.min(...all) || 1e-9;
        });
        return Math.min((0.8 * WIDTH) / width, (0.8 * HEIGHT - this.lower()) / height);
    }

    /** How much less high the arm is than in an empty picture: a tenth is free at each edge. */
    lower() {
        return Math.max(0, this.above - 0.1 * HEIGHT);
    }

    /** Lays points into the picture, with a margin. @param {number[][]} points */
    fit(points) {
        const low = [Infinity, Infinity, Infinity];
        const high = [-Infinity, -Infinity, -Infinity];
        const directions = [this.right, this.up, this.toward];
        for (const point of points) {
            directions.forEach((direction, i) => {
                const at = dot(point, direction);
                low[i] = Math.min(low[i], at);
                high[i] = Math.max(high[i], at);
            });
        }
        const middle = low.map((x, i) => (x + high[i]) / 2);
        this.centre = [0, 1, 2].map((i) => directions.reduce((sum, direction, k) => sum + middle[k] * direction[i], 0));
        this.scale = this.scaleFor(points);
    }

    /** A point on the screen: x to the right, y down. @param {number[]} point */
    project(point) {
        const p = subtract(point, this.centre);
        return [WIDTH / 2 + this.scale * dot(p, this.right), (HEIGHT + this.lower()) / 2 - this.scale * dot(p, this.up)];
    }

    /** A direction on the screen, for a length of 1 m. @param {number[]} direction */
    projectDirection(direction) {
        return [this.scale * dot(direction, this.right), -this.scale * dot(direction, this.up)];
    }

    /** How near to the viewer. @param {number[]} point */
    depth(point) {
        return dot(point, this.toward);
    }
}
