/**
 * Logs played on the arm, with their plots: a time line, the trail of the tip, the desired one beside it where the log has errors of the
 * tip, curves over time with a common cursor. Another run can be laid over one: its curves of the same names, at its sample at or before each
 * time, its trail, and the arm in its posture as a ghost.
 */

import { byId, html, set, svg } from "./dom.mjs";
import { instant, short } from "./format.mjs";
import { typed } from "./formula.mjs";
import { unpack } from "./unpack.mjs";
import { Arm } from "./scene.mjs";
import { origin } from "./vector.mjs";

const COLOURS = ["#0b5cad", "#c05600", "#1b7a2f", "#8a1c7c", "#8c6d00", "#b3261e", "#00727a", "#5a5a5a"];
const DARK = ["#7db9f5", "#ffb27a", "#63d47c", "#f2a1e6", "#e6c84f", "#ff8a80", "#5fd4dc", "#b8b8b8"];

/**
 * @typedef {{names: string[], units: string[], columns: (number | null)[][]}} Log
 */

/** The kinds of columns: what begins their names, and the title of their plot. */
const KINDS = [
    ["q_", "joint variables"],
    ["dq_", "rates"],
    ["eq_", "errors of the joints, desired − actual"],
    ["tau_", "torques and forces"],
    ["estimate_", "estimates of the parameters"],
    ["e_", "errors of the end effector, desired − actual"],
];

/** The titles of columns whose names say too little. */
const TITLES = {
    __proto__: null,
    z_norm: "norm of z = DᵀQξ, the weighed error of robust control",
    w: "manipulability w of the task",
    w_followed: "manipulability w of the rows that are followed",
    loop_gain: "sampling period times the largest eigenvalue of JᵀKJ, stable below 2",
    angle: "turn of the end effector about z₀",
    distance: "distance of the end effector from the z₀ axis",
    velocity_step: "largest change of the velocity in one sample",
};

/** Columns by plot: kind, title, unit, places. @param {Log} log */
export function plots(log) {
    const all = new Map();
    log.names.forEach((name, i) => {
        if (i === 0) return;
        const kind = KINDS.find(([prefix]) => name.startsWith(prefix));
        // Of a log that a model was judged by: both torques of a joint, in a plot of its own.
        const judged = /^(?:measured|predicted)_(.*)$/.exec(name);
        const title = judged ? `${judged[1]}: torque, measured and predicted` : kind ? kind[1] : ["x", "y", "z"].includes(name) ? "position of the end effector" : (TITLES[name] ?? name.replaceAll("_", " "));
        const key = `${title}|${log.units[i]}`;
        if (!all.has(key)) all.set(key, { title, unit: log.units[i], columns: [] });
        all.get(key).columns.push(i);
    });
    return [...all.values()];
}

/** The sample at or before a time. @param {(number | null)[]} times @param {number} t */
export function sampleAt(times, t) {
    let [low, high] = [0, times.length - 1];
    while (low < high) {
        const middle = Math.ceil((low + high) / 2);
        if (Number(times[middle]) <= t) low = middle;
        else high = middle - 1;
    }
    return low;
}

/**
 * Columns of another log at the times of one: the sample at or before each, as values are held; nothing before its first and after its last.
 * @param {{columns: (number | null)[][]}} log its times are asked for @param {Log} other @param {string[]} names
 */
export function laidOver(log, other, names) {
    const times = other.columns[0];
    const end = Number(times[times.length - 1]);
    const at = log.columns[0].map((t) => (Number(t) < Number(times[0]) || Number(t) > end ? null : sampleAt(times, Number(t))));
    return names.map((name) => {
        const column = other.columns[other.names.indexOf(name)];
        return at.map((k) => (k === null || !column ? null : column[k]));
    });
}

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function logs(data, state, picture) {
    const runs = [.../** @type {NodeListOf<HTMLDetailsElement>} */ (document.querySelectorAll("details[data-log]"))];
    if (runs.length === 0) return;
    const [time, timed, value, play, said] = ["time", "time-of", "time-value", "log-play", "playback-said"].map(byId);
    /**
     * @type {{name: string, log: Log, places: number[], rates: number[], trails: {path: number[][], kind: string}[],
     *     over: {log: Log, places: number[]} | null, charts: any[]} | null}
     */
    let active = null;
    const opened = new Map();
    let moving = 0;

    const shownTime = () => Number(active?.log.columns[0][k]);
    // The sample that is shown, and where the cursors stand as long as the pointer is in no plot.
    let k = 0;
    const mark = () => {
        if (!active) return;
        const { charts, log } = active;
        for (const chart of charts) {
            const left = chart.valToPos(log.columns[0][k], "x");
            if (Math.abs(left - chart.cursor.left) > 0.5) chart.setCursor({ left, top: 0 }, false);
        }
    };
    const show = (t) => {
        if (!active) return;
        const { log } = active;
        k = sampleAt(log.columns[0], t);
        time.value = String(t);
        // That of the sample which is shown, as in the legends.
        value.value = instant(shownTime());
        time.setAttribute("aria-valuetext", `${value.value} s`);
        if (active.places.length > 0) {
            const q = active.places.map((place) => log.columns[place][k]);
            const rates = active.rates.map((place) => log.columns[place][k] ?? 0);
            if (rates.length > 0) state.dq = rates.map(Number);
            if (q.every((x) => x !== null)) state.move(q);
        }
        mark();
    };
    /** Follows a run: from its start, or from where it was followed until now. @param {any} run */
    const choose = (run) => {
        const again = active?.name === run.name;
        active = run;
        timed.textContent = `${run.name}, time`;
        const times = run.log.columns[0];
        time.min = String(times[0] ?? 0);
        time.max = String(times[times.length - 1] ?? 1);
        const [own, lacking, taken, wrong] = run.rates.length > 0 ? ["q and q̇", "Accelerations", "q̈ is that", "τ is"] : ["q", "Rates", "q̇ and q̈ are those", "C, τ and T are"];
        const held = `${lacking} are not in the log of ${run.name}: ${taken} of the fields here, 0 unless others were typed, and ${wrong} not the run's.`;
        byId("followed").textContent = run.places.length > 0 ? held : "";
        for (const control of [play, time, value]) control.disabled = false;
        said.textContent = run.places.length > 0 ? `The arm follows ${run.name}: the numbers take its ${own}, and the parameters of the data sheet, whatever the run had. ${held}` : `${run.name} has no joints: its plots are shown, and the arm stays.`;
        picture.sticky.keep("run", run.places.length > 0 ? byId("logs") : null);
        show(again ? time.valueAsNumber : Number(times[0] ?? 0));
    };
    const layer = picture.layers.trail;
    picture.extras.push(() => {
        if (!active) {
            if (layer.firstChild) layer.replaceChildren();
            return;
        }
        const d = (path) => path.map((point, i) => `${i === 0 ? "M" : "L"}${picture.view.project(point).map((x) => x.toFixed(1)).join(" ")}`).join("");
        layer.replaceChildren(...active.trails.map(({ path, kind }) => svg("path", { class: kind, d: d(path) })));
    });
    // The arm of the run that is laid over, at the same time.
    const other = new Arm(data, "ghost other");
    picture.ghosts.push(() => {
        const over = active?.over;
        if (!over || over.places.length === 0) return [];
        const names = over.places.map((place) => over.log.names[place]);
        const q = laidOver({ columns: [[shownTime()]] }, over.log, names).map(([value]) => value);
        // It has not begun, or has ended.
        if (!q.every((x) => x !== null)) return [];
        other.place(q, robot.linkFrames(q), robot.directKinematics(q));
        return [other];
    });
    const pause = () => {
        cancelAnimationFrame(moving);
        moving = 0;
        play.textContent = "play";
        play.setAttribute("aria-pressed", "false");
    };
    play.addEventListener("click", () => {
        if (moving) return pause();
        const end = Number(time.max);
        let t = Number(time.value) >= end ? Number(time.min) : Number(time.value);
        let before = performance.now();
        play.textContent = "pause";
        play.setAttribute("aria-pressed", "true");
        const tick = () => {
            const now = performance.now();
            t = Math.min(end, t + (now - before) / 1000);
            before = now;
            show(t);
            if (t >= end) pause();
            else moving = requestAnimationFrame(tick);
        };
        moving = requestAnimationFrame(tick);
        return undefined;
    });
    state.on("sweep", pause);
    time.addEventListener("input", () => {
        pause();
        show(time.valueAsNumber);
    });
    value.addEventListener("focus", pause);
    value.addEventListener("change", () => {
        const t = typed(value.value);
        show(Number.isFinite(t) ? Math.max(Number(time.min), Math.min(Number(time.max), t)) : shownTime());
    });
    // Arrow keys go from sample to sample.
    time.addEventListener("keydown", (event) => {
        const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
        if (!by || event.altKey || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        pause();
        show(Number(active?.log.columns[0][k + by] ?? shownTime()));
    });

    const texts = new Map();
    /** The log of a run, unpacked once. @param {string} name @returns {Promise<Log>} */
    const load = (name) => {
        if (!texts.has(name)) texts.set(name, unpack(data.runs[name].log).then((text) => JSON.parse(text)));
        return texts.get(name);
    };
    const placesOf = (log) => data.rows.map((row) => log.names.indexOf(`q_${row.name}`)).filter((place) => place >= 0);
    /** Draws the plots of a run, with another one laid over them. @param {any} run @param {string} other */
    const draw = async (run, other) => {
        run.other = other;
        const over = other === "" ? null : { name: other, log: await load(other) };
        // Another choice while the log was unpacked.
        if (run.other !== other) return;
        for (const chart of run.charts) chart.destroy();
        run.trails = trails(run.log, run.places);
        run.over = over && { log: over.log, places: placesOf(over.log) };
        if (over) run.trails.push(...trails(over.log, run.over.places).map(({ path, kind }) => ({ path, kind: `${kind} other` })));
        run.charts = plots(run.log).map((plot) => chart(run.host, run.log, plot, run.name, over));
        // A pointer that leaves takes its cursor with it.
        for (const one of run.charts) one.over.addEventListener("mouseleave", () => setTimeout(() => active === run && mark()));
        // Charts draw themselves once this task is done; their cursor is set then.
        await null;
        choose(run);
    };
    const open = async (details) => {
        const name = details.getAttribute("data-log") ?? "";
        if (opened.has(name)) {
            if (opened.get(name)) choose(opened.get(name));
            return;
        }
        opened.set(name, null);
        const { log: packed, figures } = data.runs[name];
        for (const [title, text] of figures) {
            const source = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(await unpack(text))}`;
            details.querySelector(".figures")?.append(html("figure", { class: "drawn-figure" }, html("img", { src: source, alt: title, loading: "lazy" }), html("figcaption", {}, title)));
        }
        if (packed === null) return;
        const log = await load(name);
        const ratesOf = data.rows.map((row) => log.names.indexOf(`dq_${row.name}`));
        const rates = ratesOf.every((place) => place >= 0) ? ratesOf : [];
        /** @type {any} */
        const run = { name, log, places: placesOf(log), rates, trails: [], over: null, charts: [], host: details.querySelector(".plots") };
        // A run that goes on under the button would move the cursor away from the pointer, which is then taken for a drag.
        run.host.addEventListener("pointerdown", pause, { capture: true });
        // The arm goes to the time of a click; that the pointer passes over a plot moves its cursor alone.
        run.host.addEventListener("click", (event) => {
            const chart = run.charts.find((one) => one.over.contains(event.target));
            if (!chart) return;
            const index = chart.posToIdx(event.clientX - chart.over.getBoundingClientRect().left);
            pause();
            if (active !== run) choose(run);
            show(Number(log.columns[0][index]));
        });
        opened.set(name, run);
        const others = Object.keys(data.runs).filter((other) => other !== name && data.runs[other].log !== null);
        if (others.length > 0) {
            const select = html("select", {}, html("option", { value: "" }, "nothing"), ...others.map((other) => html("option", { value: other }, other)));
            select.addEventListener("change", () => draw(run, select.value));
            run.host.before(html("p", { class: "controls" }, html("label", { class: "lay-over" }, "laid over it: ", select)));
        }
        await draw(run, "");
    };
    for (const details of runs) {
        details.addEventListener("toggle", () => {
            if (details.open) open(details);
            else if (active?.name === details.getAttribute("data-log")) leave();
        });
    }
    const leave = () => {
        pause();
        active = null;
        for (const control of [play, time, value]) control.disabled = true;
        byId("followed").textContent = "";
        timed.textContent = "time";
        said.textContent = "No run is followed.";
        picture.sticky.keep("run", null);
        picture.redraw();
    };
    // On paper the curves are those of the light theme.
    for (const event of ["beforeprint", "afterprint"]) {
        addEventListener(event, () => {
            printing = event === "beforeprint";
            for (const run of opened.values()) for (const chart of run?.charts ?? []) chart.redraw(false);
        });
    }
    state.on("theme", () => {
        for (const run of opened.values()) for (const chart of run?.charts ?? []) chart.redraw(false);
    });
    addEventListener("resize", () => {
        for (const run of opened.values()) {
            for (const chart of run?.charts ?? []) chart.setSize({ width: width(chart.root.parentElement), height: HEIGHT });
        }
    });
}

const HEIGHT = 190;

/** Ticks with as many digits as their step asks for, so that no two are the same. @param {number[]} all */
export function tickLabels(all) {
    const step = all.length > 1 ? all[1] - all[0] : 0;
    const size = Math.max(...all.map(Math.abs));
    const few = all.map((x) => short(Number(x.toPrecision(6))));
    // Times since 1970 differ behind these digits.
    if (size < 1e-4 || (size >= 1e6 && new Set(few).size === all.length)) return few;
    let digits = 0;
    while (digits < 12 && Math.abs(step - Number(step.toFixed(digits))) > 1e-6 * step) digits++;
    return all.map((x) => String(Number(x.toFixed(digits))).replace("-", "−"));
}

/** @param {Element | null} host */
function width(host) {
    return Math.max(240, Math.min(760, (host?.clientWidth ?? 600) - 4));
}

/** The way of the tip, and the desired one: the tip and the error of it. @param {Log} log @param {number[]} places */
function trails(log, places) {
    if (places.length === 0) return [];
    const errors = ["e_x", "e_y", "e_z"].map((name) => log.names.indexOf(name));
    /** @type {number[][]} */
    const actual = [];
    /** @type {number[][]} */
    const desired = [];
    for (let k = 0; k < log.columns[0].length; k++) {
        const q = places.map((place) => log.columns[place][k]);
        if (q.includes(null)) continue;
        const tip = origin(robot.directKinematics(q));
        actual.push(tip);
        if (errors.every((place) => place >= 0)) desired.push(tip.map((x, i) => x + Number(log.columns[errors[i]][k])));
    }
    const all = [{ path: actual, kind: "actual" }];
    if (desired.length > 0) all.unshift({ path: desired, kind: "desired" });
    return all;
}

let printing = false;

function isDark() {
    if (printing) return false;
    const { theme } = document.documentElement.dataset;
    return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

/**
 * @param {any} host @param {Log} log @param {any} plot @param {string} name
 * @param {{name: string, log: Log} | null} over
 */
function chart(host, log, plot, name, over) {
    const ink = () => (isDark() ? "#a9b5c1" : "#525d69");
    const grid = () => (isDark() ? "#2b343d" : "#dfe4e9");
    const axis = (label) => ({ label, stroke: ink, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid }, font: "11px sans-serif", labelFont: "12px sans-serif", labelSize: 18, size: 46, values: (_, all) => tickLabels(all) });
    const curve = (label, k, dash, weight) => ({
        label,
        hues: [COLOURS, DARK].map((all) => all[k % all.length]),
        stroke: (_, i) => series[i - 1].hues[Number(isDark())],
        dash,
        width: weight,
        points: { show: false },
        value: (_, x) => (x === null || x === undefined ? "–" : short(Number(x.toPrecision(5)))),
    });
    const series = plot.columns.map((column, k) => curve(log.names[column], k, k >= COLOURS.length ? [6, 3] : undefined, 1.5));
    const values = plot.columns.map((column) => log.columns[column]);
    if (over) {
        // The same colours, dotted: a curve and its like are seen as a pair.
        const names = plot.columns.map((column) => log.names[column]);
        laidOver(log, over.log, names).forEach((column, k) => {
            if (column.every((x) => x === null)) return;
            series.push(curve(`${names[k]}, ${over.name}`, k, [2, 3], 2));
            values.push(column);
        });
    }
    // What is no part of the canvas, which is drawn anew with another theme, has the colours of both.
    const colour = (_, i) => `light-dark(${series[i - 1].hues})`;
    const options = {
        title: plot.unit ? `${plot.title}, ${plot.unit}` : plot.title,
        width: width(host),
        height: HEIGHT,
        scales: { x: { time: false } },
        // Its values stand in the legend; a line across would lie where nothing is.
        cursor: { y: false, sync: { key: name }, points: { stroke: colour, fill: colour } },
        legend: { markers: { stroke: colour, dash: (_, k) => (k > 0 && series[k - 1].dash ? "dotted" : "solid") } },
        series: [{ label: "t", value: (_, x) => (x === null ? "–" : `${instant(x)} s`) }, ...series],
        axes: [{ ...axis("t, s"), size: 30 }, { ...axis(plot.unit), size: 64 }],
    };
    const drawn = new uPlot(options, [log.columns[0], ...values], host);
    describe(drawn, options.title);
    return drawn;
}

/** Gives a plot its name, and a curve that a click takes away or brings back a switch that keys reach. @param {any} drawn @param {string} title */
function describe(drawn, title) {
    const names = drawn.series.slice(1).map(({ label }) => label);
    set(drawn.ctx.canvas, { role: "img", "aria-label": `Plot over time: ${title}; curves ${names.join(", ")}` });
    drawn.root.querySelector(".u-legend").setAttribute("role", "presentation");
    const switches = [...drawn.root.querySelectorAll(".u-series > th")].slice(1);
    for (const one of switches) {
        set(one, { role: "switch", "aria-checked": true, tabindex: 0 });
        one.addEventListener("keydown", (event) => {
            if (event.key !== "Enter" && event.key !== " ") return;
            event.preventDefault();
            one.click();
        });
    }
    (drawn.hooks.setSeries ??= []).push(() => switches.forEach((one, k) => one.setAttribute("aria-checked", String(drawn.series[k + 1].show))));
}
