/** The picture of the arm: layers of an SVG, drawn again at every motion; drag orbits, wheel zooms, keys and buttons choose views. */

import { cuboid } from "./bodies.mjs";
import { dimensions } from "./dimension.mjs";
import { byId, set, svg } from "./dom.mjs";
import { exact, short, withUnit } from "./format.mjs";
import { links, variables } from "./kinematics.mjs";
import { box, settle } from "./labels.mjs";
import { Arm, endFrames, ends, step, unit } from "./scene.mjs";
import { narrow, StickyPicture } from "./sticky_picture.mjs";
import { Ball, Box, drawSolids } from "./solids.mjs";
import { along, column, compose, identity, norm, origin, place, subtract } from "./vector.mjs";
import { HEIGHT, View, VIEWS, WIDTH } from "./view.mjs";

const LAYERS = ["grid", "points", "trail", "ghosts", "links", "bodies", "ellipsoids", "frames", "lost", "dimensions", "marks", "gravity"];

/** The height of a badge of two lines with what is around it, in pixels of the window. */
const BADGE = 55;

/** The narrowest picture that is drawn, px. */
const LEAST = 100;

export class Picture {
    /** @param {any} data @param {import("./state.mjs").State} state */
    constructor(data, state) {
        this.data = data;
        this.state = state;
        this.view = new View();
        this.svg = byId("arm");
        this.svg.append(gradients());
        /** @type {Record<string, SVGGElement>} */
        this.layers = {};
        for (const name of LAYERS) {
            this.layers[name] = svg("g", { class: `layer ${name}` });
            this.svg.append(this.layers[name]);
        }
        this.arm = new Arm(data);
        this.bodies = data.bodies.map((body) => bodySolids(body, data, this.arm.size)).filter((all) => all !== null);
        const names = ["0", ...links(data).map((_, i) => String(i + 1)), "e", ...ends(data).map(({ name }) => name)];
        this.frames = names.map((name) => frameElements(name));
        this.layers.frames.append(...this.frames.map((frame) => frame.element));
        /** Which row is drawn as on a sheet, from 0. @type {number | null} */
        this.row = null;
        /** Other arms or postures that are drawn pale over the arm. @type {(() => Arm[])[]} */
        this.ghosts = [];
        /** What others draw in the picture, after the arm. @type {((picture: Picture) => void)[]} */
        this.extras = [];
        /** Whether the reader chose the scale. */
        this.zoomed = false;
        /** Points beside the arm that stay in the picture. @type {number[][]} */
        this.beside = [];
        /** The boxes of the names of the frames. @type {import("./labels.mjs").Box[]} */
        this.names = [];
        /** The boxes of the texts that others draw, by their layers. @type {Record<string, import("./labels.mjs").Box[]>} */
        this.labels = {};
        /** A pixel of the window in units of the drawing. */
        this.unit = 1;
        /** Points that were laid into the picture since a view was chosen. @type {number[][]} */
        this.seen = [];
        this.sticky = new StickyPicture();
        this.listen();
        state.on("motion", () => this.draw());
        state.on("units", () => this.draw());
    }

    /** Frames of the links and of the end effector at the posture that is shown. */
    pose() {
        const { q } = this.state;
        return { links: robot.linkFrames(q), end: robot.directKinematics(q) };
    }

    /** Lays the arm into the picture. */
    fit() {
        this.seen = [...this.seen, ...this.around()];
        this.view.fit(this.seen);
    }

    /** What a picture of the posture has to show. */
    around() {
        const by = 0.12 * this.arm.size;
        const around = this.arm.points.flatMap((p) => [-1, 1].flatMap((s) => [0, 1, 2].map((k) => p.map((x, i) => (i === k ? x + s * by : x)))));
        return [...this.beside, ...around, [0, 0, 0]];
    }

    /** Whether a part of the arm is outside of the picture. */
    isOutside() {
        return this.arm.points.some((point) => {
            const [x, y] = this.view.project(point);
            return x < 0 || x > WIDTH || y < 0 || y > HEIGHT;
        });
    }

    /** Lays points into the picture beside the arm, and keeps them there. @param {number[][]} points */
    show(points) {
        this.beside = points;
        this.seen = [];
        this.fit();
        this.redraw();
    }

    /** Draws everything. */
    draw() {
        const { links: frames, end } = this.pose();
        this.links = frames;
        this.end = end;
        this.arm.place(this.state.q, frames, end);
        // An arm that has become small in its picture is laid into it anew.
        if (!this.zoomed && this.view.scaleFor(this.around()) > 2.5 * this.view.scale) this.seen = [];
        if (this.seen.length === 0 || (!this.zoomed && this.isOutside())) this.fit();
        this.redraw();
        const at = ["x", "y", "z"].map((name, i) => `${name} = ${withUnit(end[i][3], "m")}`).join(", ");
        const posture = this.data.rows.map((row, i) => `q${i + 1} = ${withUnit(this.state.q[i], row.type === "revolute" ? "rad" : "m")}`);
        byId("arm-description").textContent = `Posture ${posture.join(", ")}. End effector at ${at}. View: ${this.view.name || "turned by hand"}.`;
    }

    /** Draws the same posture again. */
    redraw() {
        const { view, links: frames, end } = this;
        drawSolids(this.layers.links, this.arm.solids, view);
        // An arm that is held against that of the page stands before it, other postures behind it; one that lies on it would only hide it.
        const isBefore = ({ solids }) => solids[0].element.matches(".suspect, .other");
        const isApart = ({ points }) => points.some((point, i) => norm(subtract(point, this.arm.points[i])) > 1e-6 * this.arm.size);
        const ghosts = this.ghosts.flatMap((of) => of()).filter((ghost) => !isBefore(ghost) || isApart(ghost));
        drawSolids(this.layers.ghosts, ghosts.flatMap(({ solids }) => solids), view);
        const side = ghosts.some(isBefore) ? "after" : "before";
        if (this.side !== side) this.layers.links[side](this.layers.ghosts);
        this.side = side;
        this.drawFrames([identity(), ...frames, end, ...endFrames(this.data, frames)]);
        this.drawBodies();
        this.drawGrid();
        this.drawGravity();
        this.drawDimensions();
        for (const extra of this.extras) extra(this);
    }

    /** The frame that row i starts from. @param {number} i */
    start(i) {
        return this.arm.start(i, this.links);
    }

    drawFrames(frames) {
        const length = 0.11 * this.arm.size;
        const { pixel } = this.view;
        this.names = [];
        /** @type {{x: number, y: number, names: string[], text: Element}[]} */
        const shared = [];
        frames.forEach((frame, k) => {
            const { name, element, axes, text } = this.frames[k];
            const at = origin(frame);
            element.setAttribute("data-origin", at.map(exact).join(" "));
            const [x, y] = this.view.project(at);
            axes.forEach((axis, j) => {
                const [u, v] = this.view.project(along(at, length, column(frame, j)));
                set(axis, { x1: x.toFixed(1), y1: y.toFixed(1), x2: u.toFixed(1), y2: v.toFixed(1) });
            });
            // Frames at one place share a name: 3, 4, e.
            const known = shared.find((other) => Math.hypot(other.x - x, other.y - y) < 3);
            if (known) known.names.push(name);
            else shared.push({ x, y, names: [name], text });
            text.textContent = "";
        });
        for (const { x, y, names, text } of shared) {
            text.textContent = names.join(", ");
            const places = [14, -5, 28, -19].flatMap((off) => [5, -5].map((by) => ({ x: x + by, y: y + off * pixel, end: by < 0 })));
            const { box, at } = settle(text.textContent, places, pixel, this.names);
            this.names.push(box);
            set(text, at);
        }
    }

    drawBodies() {
        if (!byId("show-bodies").checked) {
            this.layers.bodies.replaceChildren();
            return;
        }
        const solids = [];
        for (const { carrier, cuboid: shape, box, point, com } of this.bodies) {
            const frame = carrier === "e" ? this.end : this.links[carrier - 1];
            if (box) {
                box.place(compose(frame, shape.frame), shape.edges.map((edge) => edge / 2));
                solids.push(box);
            }
            point.at = place(frame, com);
            solids.push(point);
        }
        drawSolids(this.layers.bodies, solids, this.view);
    }

    drawGrid() {
        const shown = byId("show-grid").checked;
        const { size } = this.arm;
        const length = step(size / 4);
        byId("grid-step").textContent = shown ? `Grid of ${withUnit(length, "m")} in the plane z = 0 of the base` : "";
        if (!shown) {
            this.layers.grid.replaceChildren();
            return;
        }
        const count = Math.ceil((0.9 * size) / length);
        const reach = count * length;
        let d = "";
        const line = (a, b) => {
            const [[x, y], [u, v]] = [this.view.project(a), this.view.project(b)];
            d += `M${x.toFixed(1)} ${y.toFixed(1)}L${u.toFixed(1)} ${v.toFixed(1)}`;
        };
        for (let i = -count; i <= count; i++) {
            line([i * length, -reach, 0], [i * length, reach, 0]);
            line([-reach, i * length, 0], [reach, i * length, 0]);
        }
        if (!this.layers.grid.firstChild) this.layers.grid.append(svg("path"));
        /** @type {Element} */ (this.layers.grid.firstChild).setAttribute("d", d);
    }

    /** The places of texts: of frames, gravity, the badge over the picture, and those of other layers than the one that asks. @param {string} [layer] @returns {import("./labels.mjs").Box[]} */
    texts(layer = "") {
        const others = Object.keys(this.labels).filter((name) => name !== layer).flatMap((name) => this.labels[name]);
        const { pixel } = this.view;
        // With the outline of their letters.
        const frames = byId("show-frames").checked ? this.names.map(({ x, y, width, height }) => ({ x: x - 2, y: y - 3, width: width + 4, height: height + 6 })) : [];
        const badge = byId("singular-posture").textContent;
        const wide = badge.length * 7.4 * this.unit + 24;
        const lines = Math.ceil(wide / (WIDTH - 16));
        const badges = badge ? [{ x: 0, y: 0, width: Math.min(wide, WIDTH), height: (14 + 20 * lines) * this.unit }] : [];
        return [...frames, ...others, box("gravity 9.81 m/s²", { x: 12, y: HEIGHT - 8, end: false }, pixel), { x: 20, y: HEIGHT - 104, width: 52, height: 84 }, ...badges];
    }

    /** An arrow in the corner, as long as it is seen. */
    drawGravity() {
        const { gravity } = this.data;
        const size = norm(gravity);
        const [x, y] = [46, HEIGHT - 60];
        if (size === 0) {
            this.layers.gravity.replaceChildren(svg("text", { x: 12, y: HEIGHT - 14 }, "no gravity"));
            return;
        }
        const [u, v] = this.view.projectDirection(unit(gravity)).map((c) => (c / this.view.scale) * 36);
        const angle = Math.atan2(v, u);
        const wing = (turn) => `${x + u - 9 * Math.cos(angle + turn)} ${y + v - 9 * Math.sin(angle + turn)}`;
        const seen = Math.hypot(u, v) > 3;
        const mark = seen
            ? svg("path", { d: `M${x} ${y}L${x + u} ${y + v}M${wing(0.4)}L${x + u} ${y + v}L${wing(-0.4)}` })
            : svg("circle", { cx: x, cy: y, r: 5 });
        this.layers.gravity.replaceChildren(mark, svg("text", { x: 12, y: HEIGHT - 8 }, `gravity ${short(size)} m/s²`));
    }

    drawDimensions() {
        if (this.row === null) {
            if (this.layers.dimensions.firstChild) this.layers.dimensions.replaceChildren();
            return;
        }
        const i = this.row;
        const elements = dimensions(this.view, this.data, i, this.start(i), variables(this.data, this.state.q)[i], this.arm.size, this.texts());
        this.layers.dimensions.replaceChildren(svg("g", { "data-dimension": i + 1 }, ...elements));
    }

    /** @param {number | null} row */
    focusRow(row) {
        if (this.row === row) return;
        this.row = row;
        this.drawDimensions();
    }

    /** @param {string} name */
    choose(name) {
        this.view.choose(name);
        this.zoomed = false;
        this.seen = [];
        this.draw();
        this.mark();
    }

    /** How the reader looks at the arm. */
    look() {
        const { name, azimuth, elevation, scale, centre } = this.view;
        return { name, azimuth, elevation, zoomed: this.zoomed, scale, centre };
    }

    /** Looks at the arm as in another picture; a scale that nobody chose follows the arm. */
    lookAs({ name, azimuth, elevation, zoomed, scale, centre }) {
        Object.assign(this.view, { name, azimuth, elevation });
        this.view.turn();
        this.zoomed = zoomed;
        this.seen = [];
        this.draw();
        if (zoomed) Object.assign(this.view, { scale, centre });
        this.redraw();
        this.mark();
    }

    mark() {
        for (const button of document.querySelectorAll("button[data-view]")) {
            button.setAttribute("aria-pressed", String(button.getAttribute("data-view") === this.view.name));
        }
    }

    orbit(azimuth, elevation) {
        this.view.orbit(azimuth, elevation);
        this.redraw();
        this.mark();
    }

    zoom(factor) {
        this.zoomed = true;
        this.view.scale *= factor;
        this.redraw();
    }

    listen() {
        for (const button of document.querySelectorAll("button[data-view]")) {
            button.addEventListener("click", () => this.choose(button.getAttribute("data-view") ?? "oblique"));
        }
        for (const name of ["frames", "links"]) {
            byId(`show-${name}`).addEventListener("input", () => {
                this.layers[name].style.display = byId(`show-${name}`).checked ? "" : "none";
            });
        }
        for (const name of ["bodies", "grid"]) byId(`show-${name}`).addEventListener("input", () => this.redraw());
        this.svg.addEventListener("pointerdown", (event) => this.svg.setPointerCapture(event.pointerId));
        this.svg.addEventListener("pointermove", (event) => {
            if (this.svg.hasPointerCapture(event.pointerId)) this.orbit(-event.movementX * 0.01, event.movementY * 0.01);
        });
        this.svg.addEventListener(
            "wheel",
            (event) => {
                // In a narrow window the picture stands in the way of who scrolls.
                if (narrow.matches && !event.ctrlKey && document.activeElement !== this.svg) return;
                event.preventDefault();
                this.zoom(Math.exp(-event.deltaY * 0.001));
            },
            { passive: false },
        );
        const names = Object.keys(VIEWS);
        const keys = {
            ArrowLeft: () => this.orbit(-0.1, 0),
            ArrowRight: () => this.orbit(0.1, 0),
            ArrowUp: () => this.orbit(0, 0.1),
            ArrowDown: () => this.orbit(0, -0.1),
            "+": () => this.zoom(1.2),
            "=": () => this.zoom(1.2),
            "-": () => this.zoom(1 / 1.2),
            1: () => this.choose(names[0]),
            2: () => this.choose(names[1]),
            3: () => this.choose(names[2]),
            0: () => this.choose(names[3]),
        };
        this.svg.addEventListener("keydown", (event) => {
            const act = keys[event.key];
            if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
            event.preventDefault();
            act();
        });
        // Texts keep their size where the picture is narrow.
        new ResizeObserver(() => {
            const { clientWidth: width, clientHeight: height } = this.svg;
            // Out of sight, or too small for any arm: lengths would be infinite, or negative.
            if (Math.min(width, height) < LEAST) return;
            this.unit = Math.max(WIDTH / width, HEIGHT / height);
            this.view.pixel = Math.max(1, Math.min(2, this.unit));
            this.svg.style.setProperty("--pixel", String(this.view.pixel));
            // The badge of a narrow window would lie over the arm.
            this.view.above = narrow.matches ? BADGE * this.unit : 0;
            if (!this.links) return;
            if (!this.zoomed) this.fit();
            // Texts make room for each other by their size.
            this.redraw();
        }).observe(this.svg);
        this.mark();
    }
}

/** The shades across a cylinder. */
function gradients() {
    const all = ["link", "joint", "base"].map((name) => {
        const stop = (offset, shade) => svg("stop", { offset, class: `${name}-${shade}` });
        return svg("linearGradient", { id: `shade-${name}`, x1: 0, y1: 0, x2: 0, y2: 1 }, stop(0, "edge"), stop(0.4, "middle"), stop(1, "edge"));
    });
    return svg("defs", {}, ...all);
}

/** @param {string} name */
function frameElements(name) {
    const axes = ["x", "y", "z"].map((axis) => svg("line", { class: `axis-${axis}` }));
    const text = svg("text", { class: "frame-name" }, name);
    const element = svg("g", { "data-frame": name }, ...axes, text);
    return { name, element, axes, text };
}

/** What is drawn of a body; nothing of one without mass. */
function bodySolids(body, data, size) {
    const shape = cuboid(body);
    if (!shape) return null;
    const heaviest = Math.max(...data.bodies.map((other) => other.mass));
    const point = new Ball(size * 0.02 * Math.cbrt(body.mass / heaviest), "com");
    const box = shape.empty ? null : new Box(shape.possible ? "cuboid" : "cuboid impossible");
    return { carrier: body.frame, cuboid: shape, box, point, com: body.com };
}

