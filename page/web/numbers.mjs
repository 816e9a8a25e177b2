/**
 * What the emitted module gives at the posture of the sliders, and what follows of it. Six digits are shown, all digits stand in
 * `data-value` and are copied.
 */

import { byId, copy, html } from "./dom.mjs";
import { exact, inWords, short, unitOfManipulability, variable } from "./format.mjs";
import { bound, evaluate, parse, zeros } from "./formula.mjs";
import { links } from "./kinematics.mjs";
import { condition, determinant, gram, manipulability, ROUNDING, singular } from "./linear.mjs";
import { VELOCITY } from "./lost_motion.mjs";
import { sizes, withoutNoise } from "./noise.mjs";
import { formula, pairs, setOf, whereSingular } from "./singular.mjs";
import { range } from "./state.mjs";

/** A factor is near zero below this part of what it can be, and zero below that which rounding of it and of q makes. */
const NEAR = 0.02;
const ZERO = 8 * ROUNDING;

/** From this condition number on a posture is called singular. */
const SINGULAR = 1000;

/**
 * @typedef {{name: string, symbol: string, title: string, unit: string, rows: number, columns: number, of: () => any,
 *     unitOf?: (row: number, column: number) => string, size?: (row: number, column: number) => number, rowNames?: string[], columnNames?: string[], more?: (Node | string)[], singular?: boolean, near?: () => number, words?: string[], formula?: string,
 *     buttons?: HTMLElement[]}} Quantity
 */

/** @param {any} data @param {import("./state.mjs").State} state */
export function numbers(data, state, arm) {
    const host = byId("quantities");
    const shown = quantities(data, state, arm).map((quantity) => table(quantity));
    const parts = [["pose", "Pose and Jacobian"], ["singular", "Singular postures"], ["motion", "Equations of motion"]].map(([id, title]) =>
        html("section", { id, "aria-labelledby": `${id}-title` }, html("h3", { id: `${id}-title` }, title)),
    );
    // Values that suffice come before those that are needed.
    parts[1].append(...twoJoints(data, state), html("p", { id: "singular-where" }, ...whereSingular(data)), ...["lost-motion", "singular-why"].map((id) => html("p", { id, class: "near" })));
    let part = 0;
    for (const { element, quantity } of shown) {
        part = quantity.singular ? 1 : part === 1 ? 2 : part;
        parts[part].append(element);
    }
    host.append(...parts.filter((part) => part.childElementCount > 1));
    for (const [name, operations] of data.leftOut) {
        const title = name.replaceAll("_", " ");
        host.append(html("p", { class: "small" }, `The ${title} is left out: ${operations} operations. `, html("code", {}, `armgen generate ROBOT.yaml --functions ${name}`), " prints it."));
    }
    const badge = byId("singular-posture");
    const update = () => {
        for (const one of shown) if (one.element.open || one.quantity.rows === 0) one.update();
        state.singular = Math.max(0, ...shown.map((one) => one.level));
        const near = shown.filter((one) => one.level === state.singular).map(({ quantity }) => quantity);
        const factors = near.filter(({ symbol }) => symbol !== "w").map(({ symbol, formula }) => (formula ? `${symbol}, ${formula},` : symbol));
        const which = factors.length > 0 ? `: ${factors.join(" and ")} of det J ${factors.length > 1 ? "are" : "is"} ${["", "near ", ""][state.singular]}zero` : "";
        const text = ["", `⚠ nearly singular posture${which}`, `⚠ singular posture${which}`][state.singular];
        if (badge.textContent !== text) badge.replaceChildren(...(text ? [html("a", { href: "#singular" }, text)] : []));
        state.changed("singular");
    };
    state.on("motion", update);
    for (const one of shown) one.element.addEventListener("toggle", () => one.element.open && one.update());
    return shown;
}

/** @param {any} data @param {import("./state.mjs").State} state @param {{size: number}} arm @returns {Quantity[]} */
function quantities(data, state, arm) {
    const size = sizes(data, state, arm.size);
    const n = data.rows.length;
    const has = (name) => data.functions.includes(name);
    /** The argument in front of the others, of arms that have it. */
    const g0 = data.gravityIsArgument ? [data.gravity] : [];
    const joints = data.rows.map((row) => row.name);
    const slides = data.rows.map((row) => row.type === "prismatic");
    /** What turns and what slides have units of their own: in the heading where there is one, else at the rows and entries. */
    const mixed = slides.includes(true) && slides.includes(false);
    const force = (i) => (slides[i] ? "N" : "N m");
    const forces = { unit: mixed ? "N m, or N of a joint that slides" : force(0), rowNames: joints.map((name, i) => (mixed ? `${name}, ${force(i)}` : name)) };
    const inertia = (per) => {
        const names = ["kg m²", "kg m", "kg"].map((unit) => unit + per);
        const unitOf = (i, j) => names[Number(slides[i]) + Number(slides[j])];
        return { unit: mixed ? `${names[0]}; ${names[1]} between a joint that turns and one that slides, ${names[2]} of those that slide` : unitOf(0, 0), unitOf };
    };
    /** @type {Quantity[]} */
    const list = [
        { ...matrix("direct_kinematics", "Tₑ", "Pose of the end effector in the base frame: its axes and its origin, m", "", 4, 4, () => robot.directKinematics(state.q)), size: size.pose, rowNames: ["x", "y", "z", ""], columnNames: ["x axis", "y axis", "z axis", "origin"] },
        { ...vector("roll_pitch_yaw", "roll, pitch, yaw", "Orientation of the end effector: Rz(yaw) Ry(pitch) Rx(roll)", "rad", 3, () => rollPitchYaw(robot.directKinematics(state.q)), ["roll", "pitch", "yaw"]), size: () => 1 },
        { ...matrix("geometric_jacobian", "J", "Geometric Jacobian: velocity v, m/s, and angular velocity ω, rad/s, of the end effector in the base frame for a rate of 1 rad/s, or of 1 m/s", "", 6, n, () => robot.geometricJacobian(state.q)), size: size.jacobian, rowNames: VELOCITY, columnNames: joints },
    ];
    if (has("joint_variables")) {
        const names = links(data).map((row) => `${row.name}, ${row.type === "revolute" ? "rad" : "m"}`);
        list.push(vector("joint_variables", "q", "Variables of all joints, followers included", "", names.length, () => robot.jointVariables(state.q), names));
    }
    const rows = data.task.map((row) => VELOCITY[row]).join(" ");
    const task = () => data.task.map((row) => robot.geometricJacobian(state.q)[row]);
    if (data.task.length === n) list.push({ ...scalar("det", "det J", `Determinant of the rows ${rows} of J`, unitOfManipulability(data), () => (manipulability(task()) === 0 ? 0 : determinant(task()))), singular: true });
    (data.determinant?.factors ?? []).forEach((text, k) => {
        const factor = parse(text);
        const lookup = (name) => state.q[Number(name.slice(1)) - 1];
        const zero = data.determinant.singular[k];
        const set = setOf(zero, text);
        const where = set === "" ? "zero where several joints together make it so" : zero.startsWith("q") ? `zero at ${set}` : set;
        const part = () => Math.abs(evaluate(factor, lookup)) / bound(factor, lookup);
        const of = () => (part() < ZERO ? 0 : evaluate(factor, lookup));
        const near = () => Number(part() < NEAR) + Number(part() < ZERO);
        const words = ["", "⚠ near zero: nearly singular", "⚠ zero: singular"];
        const brief = text.length < 60;
        list.push({ ...scalar(`factor_${k + 1}`, `factor ${k + 1}`, "of det J", "", of), more: [...(brief ? [", ", formula(text)] : []), `; ${where} `], formula: brief ? inWords(text) : "", singular: true, near, words, buttons: zeroButtons(zero, data, state) });
    });
    // Where no factor of a determinant says so, as of an arm with more joints than its task asks for.
    const told = data.determinant?.factors?.length > 0 || data.task.length > n;
    const words = ["", "⚠ nearly singular", "⚠ singular"];
    const level = () => (told ? 0 : Number(condition(task()) >= SINGULAR) + Number(condition(task()) === Infinity));
    list.push({ ...scalar("w", "w", `Manipulability √det(J Jᵀ) of the rows ${rows} of J`, unitOfManipulability(data), () => manipulability(task())), singular: true, near: level, words });
    list.push({ ...scalar("condition", "σ₁/σₘ", "Condition number of these rows, largest singular value by smallest", "", () => condition(task())), singular: true });
    if (has("inertia_matrix")) list.push({ ...matrix("inertia_matrix", "B", "Inertia matrix", "", n, n, () => robot.inertiaMatrix(state.q)), ...inertia(""), size: size.inertia, rowNames: joints, columnNames: joints });
    if (has("coriolis_matrix")) {
        list.push({ ...matrix("coriolis_matrix", "C", "Coriolis and centrifugal matrix, by Christoffel symbols", "", n, n, () => robot.coriolisMatrix(state.q, state.dq)), ...inertia("/s"), size: size.coriolis, rowNames: joints, columnNames: joints });
        list.push(scalar("skew_symmetry", "sym(Ḃ − 2C)", "Largest entry of the symmetric part, sym(A) = (A + Aᵀ)/2, which is 0: what is left comes of Ḃ as a quotient of differences", "", () => skewSymmetry(state)));
    }
    if (has("gravity")) list.push({ ...vector("gravity", "g", "Gravity term", "", n, () => robot.gravity(...g0, state.q), joints), ...forces, size: size.gravity });
    if (has("friction")) list.push({ ...vector("friction", "F", "Friction", "", n, () => robot.friction(state.dq), joints), ...forces });
    if (has("load_friction")) list.push({ ...vector("load_friction", "Fₗ", "Friction that grows with the load, Fₗ |g| sign(q̇)", "", n, () => robot.loadFriction(...g0, state.q, state.dq), joints), ...forces });
    if (has("inverse_dynamics")) list.push({ ...vector("inverse_dynamics", "τ", "Torques of the motion, B q̈ + C q̇ + F + g", "", n, () => robot.inverseDynamics(...g0, state.q, state.dq, state.ddq), joints), ...forces, size: size.torque });
    if (has("kinetic_energy")) list.push(scalar("kinetic_energy", "T", "Kinetic energy", "J", () => robot.kineticEnergy(state.q, state.dq)));
    if (has("potential_energy")) list.push({ ...scalar("potential_energy", "U", "Potential energy", "J", () => robot.potentialEnergy(...g0, state.q)), size: size.energy });
    return list;
}

/** Buttons that set a joint to where a factor is zero. @param {string | null} text @param {any} data @param {import("./state.mjs").State} state */
function zeroButtons(text, data, state) {
    const zero = zeros(text ?? "");
    if (!zero) return [];
    const [low, high] = range(data.rows[zero.joint - 1]);
    return zero.values.map(({ value, text }) => {
        const button = html("button", { type: "button" }, `set ${variable(zero.joint)} = ${inWords(text)}`);
        button.addEventListener("click", () => {
            const q = state.q.slice();
            q[zero.joint - 1] = nearest(value, zero.period, q[zero.joint - 1], low, high);
            state.move(q);
        });
        return button;
    });
}

/** The values of two joints that make a longer arm singular, searched for once the page is drawn; nothing of other arms. @param {any} data @param {import("./state.mjs").State} state */
function twoJoints(data, state) {
    if (!data.firstSix?.singular?.every((text) => text?.startsWith("q"))) return [];
    const [list, printed] = [html("div", { class: "controls" }), html("p", { class: "print-only" })];
    const note = html("p", { class: "small" }, "In rad, found by a search, which can miss some. Other singular postures tie three joints or more.");
    const details = html("details", { open: true }, html("summary", {}, "Singular at these values of two joints, whatever the others do"), list, printed, note);
    details.addEventListener("toggle", () => {
        if (list.firstChild) return;
        const w = (q) => Math.sqrt(Math.abs(determinant(gram(robot.geometricJacobian(q)))));
        const smallest = (q) => singular(robot.geometricJacobian(q)).values.at(-1) ?? 0;
        const all = pairs(data, w, smallest);
        const words = (pair) => pair.map(([i, x]) => `${variable(i + 1)} = ${short(x)}`).join(", ");
        printed.textContent = `${all.map(words).join("; ")}.`;
        list.append(
            ...all.map((pair) => {
                const button = html("button", { type: "button" }, `set ${words(pair)}`);
                button.addEventListener("click", () => state.move(state.q.map((x, i) => pair.find(([k]) => k === i)?.[1] ?? x)));
                return button;
            }),
        );
    });
    return [details];
}

/** Of value + k period the one within limits that is nearest to q; the value itself where none is within. @param {number} value @param {number} period @param {number} q @param {number} low @param {number} high */
function nearest(value, period, q, low, high) {
    if (period === 0) return value;
    const [first, last] = [Math.ceil((low - value) / period), Math.floor((high - value) / period)];
    if (first > last) return value;
    return value + period * Math.max(first, Math.min(last, Math.round((q - value) / period)));
}

function matrix(name, symbol, title, unit, rows, columns, of) {
    return { name, symbol, title, unit, rows, columns, of };
}

function vector(name, symbol, title, unit, rows, of, rowNames) {
    return { name, symbol, title, unit, rows, columns: 0, of, rowNames };
}

function scalar(name, symbol, title, unit, of) {
    return { name, symbol, title, unit, rows: 0, columns: 0, of };
}

/** Roll, pitch and yaw of a frame; at pitch = ±90 degrees roll is taken as 0. @param {number[][]} t */
export function rollPitchYaw(t) {
    const pitch = Math.atan2(-t[2][0], Math.hypot(t[0][0], t[1][0]));
    if (Math.hypot(t[0][0], t[1][0]) < 1e-12) return [0, pitch, Math.atan2(-t[0][1], t[1][1])];
    return [Math.atan2(t[2][1], t[2][2]), pitch, Math.atan2(t[1][0], t[0][0])];
}

/** dB/dt by central differences of fourth order along dq, less 2 C: its symmetric part is 0 but for what differences can tell. @param {import("./state.mjs").State} state */
function skewSymmetry(state) {
    const { q, dq } = state;
    const speed = Math.hypot(...dq);
    if (speed === 0) return 0;
    const h = 1e-3 / speed;
    const b = (t) => robot.inertiaMatrix(q.map((x, i) => x + t * dq[i]));
    const [far, near, nearer, farther] = [b(-2 * h), b(-h), b(h), b(2 * h)];
    const c = robot.coriolisMatrix(q, dq);
    let largest = 0;
    for (let i = 0; i < q.length; i++) {
        for (let j = 0; j <= i; j++) {
            const rate = (far[i][j] - 8 * near[i][j] + 8 * nearer[i][j] - farther[i][j]) / (12 * h);
            largest = Math.max(largest, Math.abs(rate - c[i][j] - c[j][i]));
        }
    }
    return largest;
}

/** @param {Quantity} quantity */
function table(quantity) {
    const { name, symbol, title, unit, rows, columns } = quantity;
    const cells = [];
    const said = html("strong", { class: "near" });
    const cell = (row, column) => {
        const attributes = { "data-quantity": name, "data-row": row || undefined, "data-column": column || undefined, title: quantity.unitOf?.(row - 1, column - 1) };
        const td = html(rows === 0 ? "span" : "td", { class: "entry", ...attributes });
        cells.push({ td, value: NaN });
        return td;
    };
    // A lone number stands on a line of its own, which nothing folds away.
    const [whole, first] = rows === 0 ? ["div", "p"] : ["details", "summary"];
    const head = html(first, {}, html("b", {}, symbol));
    const element = html(whole, { id: `number-${name}`, open: rows > 0 || undefined, class: "quantity", "data-of": name }, head);
    if (rows === 0) {
        // The number before the words: after them its unit would look like a symbol that it is the value of.
        head.append(" = ", cell(0, 0), unit ? ` ${unit}` : "", said, html("span", { class: "small" }, `  ${title}`, ...(quantity.more ?? [" "])), ...(quantity.buttons ?? []));
    } else {
        head.append(` ${title}${unit ? `, ${unit}` : ""}`);
        const rowName = (i) => `${i} ${quantity.rowNames?.[i - 1] ?? ""}`;
        const body = html("tbody");
        for (let i = 1; i <= rows; i++) {
            const row = html("tr", {}, html("th", { scope: "row" }, rowName(i)));
            for (let j = 1; j <= Math.max(columns, 1); j++) row.append(cell(i, columns ? j : 0));
            body.append(row);
        }
        const table = html("table", { class: "matrix", "aria-label": `${symbol}: ${title}` });
        if (columns > 0) {
            const names = Array.from({ length: columns }, (_, j) => (quantity.columnNames ? `${j + 1} ${quantity.columnNames[j]}` : String(j + 1)));
            table.append(html("thead", {}, html("tr", {}, html("td"), ...names.map((column) => html("th", { scope: "col" }, column)))));
        }
        table.append(body);
        lightNames(table);
        const scroll = html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": `${symbol}: ${title}` }, table);
        element.append(scroll, copyButtons(quantity));
        lightEquation(table, name);
    }
    const update = () => {
        const flat = [quantity.of()].flat(2);
        cells.forEach((cell, k) => {
            const value = flat[k];
            if (Object.is(cell.value, value)) return;
            cell.value = value;
            cell.td.textContent = short(withoutNoise(quantity, value, Math.floor(k / Math.max(1, columns)), k % Math.max(1, columns)));
            cell.td.setAttribute("data-value", exact(value));
        });
        one.level = quantity.near?.() ?? 0;
        const near = quantity.words?.[one.level] ?? "";
        if (said.textContent !== near) said.textContent = near;
    };
    /** How singular it says that the posture is: 0 not, 1 nearly, 2 quite. */
    const one = { element, update, quantity, level: 0 };
    return one;
}

/** An entry under the pointer lights the names of its row and its column. @param {HTMLElement} table */
function lightNames(table) {
    const light = (target, on) => {
        const td = target instanceof Element ? target.closest("td.entry") : null;
        if (!td) return;
        const row = td.parentElement;
        const column = [...(row?.children ?? [])].indexOf(td);
        for (const name of [row?.firstElementChild, table.querySelector("thead tr")?.children[column]]) name?.classList.toggle("lit", on);
    };
    table.addEventListener("pointerover", (event) => light(event.target, true));
    table.addEventListener("pointerout", (event) => light(event.target, false));
}

/** An entry under the pointer lights its equation, where that is open. @param {HTMLElement} table @param {string} name */
function lightEquation(table, name) {
    /** @type {Element | null} */
    let lit = null;
    table.addEventListener("pointerover", (event) => {
        lit?.classList.remove("used");
        const td = event.target instanceof Element ? event.target.closest("td.entry") : null;
        const [row, column] = ["data-row", "data-column"].map((key) => td?.getAttribute(key) ?? "1");
        lit = td && document.querySelector(`details[data-equation="${name}"][open] [data-entry="${row},${column}"]`);
        lit?.classList.add("used");
    });
}

/** The table as a text of another program, all digits. @param {any} value @param {string} form */
export function tableText(value, form) {
    // The sign of a zero is nobody's.
    const digits = (x) => exact(x === 0 ? 0 : x);
    const rows = value.map((row) => (Array.isArray(row) ? row.map(digits) : [digits(row)]));
    switch (form) {
        case "MATLAB":
            return `[${rows.map((row) => row.join(", ")).join("; ")}]`;
        case "NumPy":
            return Array.isArray(value[0]) ? `np.array([${rows.map((row) => `[${row.join(", ")}]`).join(", ")}])` : `np.array([${rows.flat().join(", ")}])`;
        case "LaTeX":
            return `\\begin{bmatrix}\n${rows.map((row) => row.join(" & ")).join(" \\\\\n")}\n\\end{bmatrix}`;
        default:
            return rows.map((row) => row.join("\t")).join("\n");
    }
}

/** @param {Quantity} quantity */
function copyButtons(quantity) {
    const buttons = ["text", "MATLAB", "NumPy", "LaTeX"].map((form) => {
        const button = html("button", { type: "button", class: "copy", "aria-label": `Copy ${quantity.symbol} as ${form}` }, form);
        button.addEventListener("click", () => copy(button, tableText(quantity.of(), form), `${quantity.symbol} as ${form}`));
        return button;
    });
    return html("div", { class: "controls copies" }, "copy all digits as ", ...buttons);
}

/** Ways from the numbers to their equations, where the page has these. */
export function linkEquations() {
    for (const element of document.querySelectorAll(".quantity[data-of]")) {
        const name = element.getAttribute("data-of") ?? "";
        element.querySelector(":scope > .copies, :scope > p")?.append(...equationLink(name.startsWith("factor_") ? "determinant" : name));
    }
}

/** The way to the equation of a quantity, where the page has it. @param {string} name */
function equationLink(name) {
    const equation = document.querySelector(`[data-equation="${name === "det" ? "determinant" : name}"]`);
    if (!equation) return [];
    equation.id = `equation-${equation.getAttribute("data-equation")}`;
    return [" ", html("a", { href: `#${equation.id}`, class: "small" }, "its equation")];
}
