/**
 * Equations: each section is set when it is opened, from a text that is kept packed. Closed forms as a matrix, or one below another where
 * they are long; others as numbered steps. Never more nodes at once than a browser lays out in a moment.
 */

import { byId, copy, html, math } from "./dom.mjs";
import { exact, inWords, short } from "./format.mjs";
import { folded, parse } from "./formula.mjs";
import { mathml, nameElement, symbolElement, termsOf } from "./mathml.mjs";
import { withoutNoise } from "./noise.mjs";
import { unpack } from "./unpack.mjs";

/** Nodes that are set until somebody asks for more, and those of them that are set before the browser lays out what there is. */
const NODES = 2500;
const SLICE = 500;
/** Characters of an entry that stands in a matrix, and of all entries of a row. */
const ENTRY = 44;
const LINE = 110;
/** Characters of a whole matrix. */
const CHARACTERS = 4000;

/**
 * @typedef {{symbol: string, rows: number, columns: number, entries: string[][], form: string, steps?: [string, string][],
 *     factors?: string[], common_factors?: string[], singular?: (string | null)[]}} Form
 * @typedef {{letter: string, columnNames: string[] | null, nominal: Form, symbolic: Form | null, latex: string[]}} Equation
 */

/**
 * @param {any} data
 * @param {import("./state.mjs").State} state
 * @param {{quantity: import("./numbers.mjs").Quantity}[]} shown what has its numbers on the page
 */
export function equations(data, state, shown) {
    const quantities = new Map(shown.map(({ quantity }) => [quantity.name, quantity]));
    const quantityOf = (details) => {
        const name = details.getAttribute("data-equation") ?? "";
        return quantities.get(name === "determinant" ? "det" : name);
    };
    /** Writes the numbers at the posture beside the entries of an open section. @param {HTMLDetailsElement} details */
    const evaluate = (details) => {
        const quantity = quantityOf(details);
        const own = quantity?.of();
        for (const element of details.querySelectorAll("[data-number]")) {
            const place = element.getAttribute("data-number") ?? "";
            const [i, j] = place.split(",").map((index) => Number(index) - 1);
            const factor = quantities.get(place);
            const value = factor?.of() ?? (Array.isArray(own) ? [own[i]].flat()[j] : own);
            const digits = exact(value);
            if (element.getAttribute("data-value") === digits) continue;
            element.setAttribute("data-value", digits);
            element.textContent = `= ${short(factor ? value : withoutNoise(quantity, value, i, j))}`;
        }
    };
    const chosen = (name) => document.querySelector(`input[name="${name}"]:checked`)?.getAttribute("value");
    const sections = [.../** @type {NodeListOf<HTMLDetailsElement>} */ (document.querySelectorAll("details[data-equation]"))];
    /** @type {Map<number, Promise<Record<string, Equation>>>} */
    const packets = new Map();
    /** An equation; its packet is unpacked once. @param {string} name @returns {Promise<Equation>} */
    const load = async (name) => {
        const k = data.equations.of[name];
        const packet = packets.get(k) ?? unpack(data.equations.packets[k]).then((text) => JSON.parse(text));
        packets.set(k, packet);
        return (await packet)[name];
    };
    /** The entries that were chosen, by the names of their equations. @type {Map<string, string>} */
    const entries = new Map();
    /** @param {HTMLDetailsElement} details */
    const set = async (details) => {
        const name = details.getAttribute("data-equation") ?? "";
        const equation = await load(name);
        const symbolic = chosen("form") === "symbolic" && equation.symbolic !== null;
        const form = symbolic ? /** @type {Form} */ (equation.symbolic) : equation.nominal;
        const quantity = quantityOf(details);
        const options = { exact: chosen("digits") === "exact", count: 0, steps: form.steps?.[0]?.[0].replace(/\d+$/, "") ?? "", numbered: quantity !== undefined, evaluate: () => evaluate(details), entries, name };
        const content = written(equation, form, options);
        if (chosen("form") === "symbolic" && !symbolic) content.prepend(html("p", { class: "small" }, "No name of a parameter stands in it."));
        const button = html("button", { type: "button", class: "copy" }, "copy as LaTeX");
        button.addEventListener("click", () => {
            const latex = equation.latex[symbolic ? 1 : 0] ?? equation.latex[0];
            copy(button, chosen("digits") === "exact" ? latex : sixDigits(latex), `${name} as LaTeX`);
        });
        const host = details.querySelector("div");
        const link = quantity ? [html("a", { href: `#number-${quantity.name}` }, "its numbers")] : [];
        host?.replaceChildren(content, html("div", { class: "controls copies" }, button, ...link));
        evaluate(details);
    };
    for (const details of sections) {
        details.addEventListener("toggle", () => {
            if (!details.open) return;
            if (details.querySelector("math")) evaluate(details);
            else set(details);
        });
        markUses(details);
    }
    const key = byId("names");
    const parameters = document.getElementById("parameters");
    if (!parameters) {
        const names = /** @type {HTMLInputElement} */ (document.querySelector('input[value="symbolic"]'));
        names.disabled = true;
        names.labels?.[0].setAttribute("title", "the description names no parameters");
    }
    key.append("Names are those of the description's parameters; what has none, such as a length, is a number. ");
    for (const [k, row] of [...(parameters?.querySelectorAll("tbody tr") ?? [])].entries()) {
        const [name, value] = [...row.children].map((cell) => cell.querySelector(".number")?.textContent || cell.textContent || "");
        key.append(k > 0 ? "; " : "", html("span", {}, math("math", {}, nameElement(name, { exact: false, count: 0, steps: "" })), ` = ${value}`));
    }
    for (const input of document.querySelectorAll('input[name="form"], input[name="digits"]')) {
        input.addEventListener("input", async () => {
            key.hidden = chosen("form") !== "symbolic";
            // What is set anew has another height: what was switched stays where it is.
            const top = () => input.getBoundingClientRect().top;
            const before = top();
            await Promise.all(sections.map((details) => (details.open ? set(details) : details.querySelector("div")?.replaceChildren())));
            scrollBy({ top: top() - before, behavior: "instant" });
        });
    }
    state.on("motion", () => {
        for (const details of sections) if (details.open && quantityOf(details)) evaluate(details);
    });
    addEventListener("beforeprint", () => {
        for (const table of document.querySelectorAll("details[open] .lines")) table.dispatchEvent(new Event("print"));
    });
    // A link to a section opens it.
    const follow = () => {
        const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
        if (target instanceof HTMLDetailsElement) target.open = true;
    };
    addEventListener("hashchange", follow);
    follow();
    requestAnimationFrame(placeIndices);
}

/** Without a font of mathematics browsers leave indices on the line of their letters: the style then lowers them. */
function placeIndices() {
    const [letter, index] = [math("mi", {}, "t"), math("mn", {}, "1")];
    const probe = math("math", {}, math("msub", {}, letter, index));
    byId("equations").append(probe);
    const [{ bottom, height }, below] = [letter, index].map((element) => element.getBoundingClientRect());
    document.documentElement.toggleAttribute("data-plain-math", below.bottom - bottom < 0.25 * height);
    probe.remove();
}

/** LaTeX with its fractions, and whole numbers of more than six digits, as decimals of six digits. @param {string} latex */
export function sixDigits(latex) {
    return latex.replace(/\\frac\{(\d+)\}\{(\d+)\}|(?<![\w{.]|% )\d{7,}/g, (all, above, below) => {
        const value = above ? above / below : Number(all);
        const [digits, exponent] = value.toExponential(5).split("e");
        return short(value).includes("·") ? `${Number(digits)}\\cdot 10^{${Number(exponent)}}` : short(value);
    });
}

/** A step under the pointer marks its uses. @param {Element} details */
function markUses(details) {
    let marked = [];
    details.addEventListener("pointerover", (event) => {
        for (const element of marked) element.classList.remove("used");
        const step = event.target instanceof Element ? event.target.closest("[data-step]")?.getAttribute("data-step") : null;
        marked = step ? [...details.querySelectorAll(`[data-step="${step}"]`)] : [];
        for (const element of marked) element.classList.add("used");
    });
}

/**
 * @param {Equation} equation @param {Form} form
 * @param {any} options numbered: whether the page computes it, evaluate: writes the numbers of what was set, entries: what was chosen of which name
 */
function written(equation, form, options) {
    const host = html("div", { class: "formulas" });
    if (fits(form)) {
        host.append(matrix(equation, form, options));
    } else {
        const all = lines(equation, form);
        const head = html("p", {}, math("math", {}, symbolElement(form.symbol, options)), note(form));
        const body = html("div");
        const [choice, first] = entryChoice(all, options, (chosen) => list(body, chosen, { ...options, count: 0 }));
        host.append(head, ...choice, body);
        list(body, first, options);
    }
    const factors = form.factors ?? form.common_factors;
    if (factors) {
        const head = form.factors ? "Factors:" : "Times the factors that all minors of J share, each of them the determinant of J without one column:";
        host.append(html("p", {}, head));
        const items = factors.map((factor, k) => {
            const zero = form.singular?.[k];
            const words = zero === null || zero === undefined ? "zero where several joints together make it so" : zero.startsWith("q") ? `zero at ${inWords(zero)}` : zero;
            const number = form.factors ? [html("span", { class: "at", "data-number": `factor_${k + 1}` })] : [];
            return html("li", {}, math("math", {}, mathml(read(factor, options), options)), " ", ...number, `, ${words}`);
        });
        host.append(html("ol", {}, ...items));
    }
    return host;
}

/** A formula with its constants as they are asked for. @param {string} text @param {{exact: boolean}} options */
function read(text, { exact }) {
    return exact ? parse(text) : folded(parse(text));
}

/** Whether a form is a matrix that fits a line. @param {Form} form */
function fits(form) {
    if (form.form !== "closed" || form.columns > 12 || form.entries.flat().join("").length > CHARACTERS) return false;
    const width = (j) => Math.max(...form.entries.map((row) => shown(row[j])));
    let total = 0;
    for (let j = 0; j < form.columns; j++) {
        if (width(j) > ENTRY && form.rows * form.columns > 1) return false;
        total += width(j) + 3;
    }
    return total <= LINE;
}

/** About how wide a text is once its constants have six digits. @param {string} text */
function shown(text) {
    return text.replace(/\d{7,}\/\d+|\d+\/\d{4,}/g, "0.123456").length;
}

/** @param {Form} form */
function isSymmetric(form) {
    return form.rows > 1 && form.rows === form.columns && form.entries.every((row, i) => row.every((entry, j) => entry === form.entries[j][i]));
}

/** @param {Form} form */
function note(form) {
    const notes = [];
    const symmetric = isSymmetric(form);
    if (symmetric) notes.push("symmetric: its upper half is listed");
    if (form.entries.flat().includes("0")) notes.push(symmetric ? "what is not listed there is 0" : "what is not listed is 0");
    return notes.length > 0 ? ` (${notes.join("; ")})` : "";
}

/** @param {Equation} equation @param {Form} form @param {any} options */
function matrix(equation, form, options) {
    const cell = (entry, i, j) => {
        const [place, formula] = [`${i + 1},${j + 1}`, mathml(read(entry, options), options)];
        // A constant is its number.
        if (!options.numbered || !/[A-Za-z]/.test(entry)) return math("mtd", { "data-entry": place }, formula);
        return math("mtd", {}, math("munder", {}, math("mrow", { "data-entry": place }, formula), math("mtext", { class: "at", "data-number": place })));
    };
    if (form.rows === 1 && form.columns === 1) {
        const entry = mathml(read(form.entries[0][0], options), options);
        return html("div", { class: "scroll equation", tabindex: 0, role: "region", "aria-label": "Formula" }, math("math", { display: "block" }, math("mrow", {}, symbolElement(form.symbol, options), math("mo", {}, "="), entry, ...(options.numbered ? [math("mtext", { class: "at", "data-number": "1,1" })] : []))));
    }
    const rows = form.entries.map((row, i) => math("mtr", {}, ...row.map((entry, j) => cell(entry, i, j))));
    if (equation.columnNames) {
        rows.unshift(math("mtr", {}, ...equation.columnNames.map((name) => math("mtd", {}, nameElement(name, options)))));
    }
    const table = math("math", { display: "block" }, math("mtable", {}, ...rows));
    const head = math("math", {}, math("mrow", {}, symbolElement(form.symbol, options), math("mo", {}, "=")));
    return html("div", { class: "scroll equation", tabindex: 0, role: "region", "aria-label": "Matrix" }, head, html("div", { class: "brackets" }, table));
}

/** The name of an entry: b₁₂, g₃, y with the name of its column. @param {Equation} equation @param {Form} form @param {number} i @param {number} j @param {any} options */
function entryName(equation, form, i, j, options) {
    if (form.rows === 1 && form.columns === 1) return symbolElement(form.symbol, options);
    const index = math("mn", {}, entryIndex(equation, form, i, j));
    const [letter, own] = equation.letter.split("_");
    // An entry of what has no letter of its own is one of the whole: (∂τ/∂q)₁₂.
    const whole = /^d(?!dq$)./.test(letter) && symbolElement(form.symbol.replace(/\(q[^)]*\)$/, ""), options);
    const base = whole ? math("mrow", {}, math("mo", { stretchy: "false", rspace: "0" }, "("), whole, math("mo", { stretchy: "false", lspace: "0" }, ")")) : nameElement(letter, options);
    const names = equation.columnNames ? [nameElement(equation.columnNames[j], options)] : [];
    options.count += 4;
    return math("msub", {}, base, math("mrow", {}, ...(own ? [math("mtext", {}, `${own},`)] : []), index, ...names));
}

/** Its numbers: 12, 3, or that of the row before the name of the column. @param {Equation} equation @param {Form} form @param {number} i @param {number} j */
function entryIndex(equation, form, i, j) {
    const large = form.rows > 9 || form.columns > 9;
    return equation.columnNames ? `${i + 1},` : form.columns === 1 ? `${i + 1}` : `${i + 1}${large ? "," : ""}${j + 1}`;
}

/** The same in plain text: b12, g3. @param {Equation} equation @param {Form} form @param {number} i @param {number} j */
function entryLabel(equation, form, i, j) {
    const letter = /^d(?!dq$)./.test(equation.letter) ? "" : equation.letter.replace("tau", "τ").replace("ddq", "q̈").replace("_", " ");
    return `${letter} ${entryIndex(equation, form, i, j)} ${equation.columnNames?.[j] ?? ""}`.trim().replace(/^([a-zτ]̈?) (\d)/u, "$1$2");
}

/**
 * A choice of one entry, which is then shown with the steps that it needs alone; nothing where there are no steps. Also the lines of what was
 * chosen before, in another form. @param {any[]} all @param {{entries: Map<string, string>, name: string}} options @param {(chosen: any[]) => void} show @returns {[any[], any[]]}
 */
function entryChoice(all, { entries: kept, name }, show) {
    const entries = all.filter((line) => line.entry !== "");
    if (entries.length < 2 || entries.length === all.length) return [[], all];
    const select = html("select", {}, html("option", { value: "" }, "all"), ...entries.map((line) => html("option", { value: line.entry }, line.label)));
    const chosen = () => (select.value === "" ? all : needed(all, select.value));
    select.addEventListener("change", () => {
        kept.set(name, select.value);
        show(chosen());
    });
    const before = kept.get(name);
    if (entries.some(({ entry }) => entry === before)) select.value = before;
    return [[html("p", { class: "controls entries" }, html("label", {}, "entry ", select))], chosen()];
}

/** The line of an entry, and after it the steps that it needs, in their order. @param {any[]} all @param {string} entry */
export function needed(all, entry) {
    const steps = new Map(all.filter((line) => line.entry === "").map((line) => [line.label, line]));
    const found = new Set(all.filter((line) => line.entry === entry));
    const [first] = found;
    // A set that grows is gone through to its new end.
    for (const line of found) for (const name of line.text.match(/[A-Za-z_]\w*/g) ?? []) if (steps.has(name)) found.add(steps.get(name));
    return [first, ...all.filter((line) => line !== first && found.has(line))];
}

/** Steps and entries that are not zero; of a symmetric matrix the upper half. @param {Equation} equation @param {Form} form */
function lines(equation, form) {
    const symmetric = isSymmetric(form);
    const all = (form.steps ?? []).map(([name, text]) => ({ name: (options) => nameElement(name, options), label: name, text, entry: "" }));
    form.entries.forEach((row, i) =>
        row.forEach((text, j) => {
            if (text === "0" || (symmetric && j < i)) return;
            all.push({ name: (options) => entryName(equation, form, i, j, options), label: entryLabel(equation, form, i, j), text, entry: `${i + 1},${j + 1}` });
        }),
    );
    return all;
}

/**
 * A line `name = formula`. The terms of a sum stand each by itself, so that a long one wraps as text does.
 *
 * @param {any} name @param {import("./formula.mjs").Node} node @param {any} options
 */
function line(name, node, options) {
    const terms = node.kind === "sum" ? termsOf(node, options, true) : [[mathml(node, options)]];
    return terms.flatMap((term, i) => [math("math", {}, math("mrow", {}, ...(i === 0 ? [name, math("mo", {}, "=")] : []), ...term)), " "]);
}

/** Sets lines up to so many nodes, a slice a frame, and the others when they are asked for. @param {HTMLElement} host @param {any[]} all @param {any} options */
function list(host, all, options) {
    let next = 0;
    const table = html("div", { class: "lines scroll", tabindex: 0, role: "region", "aria-label": "Formulas" });
    const more = html("button", { type: "button" });
    const fewer = html("button", { type: "button", hidden: true }, "show fewer");
    host.replaceChildren(table, html("div", { class: "controls" }, more, fewer));
    const append = (end) => {
        while (next < all.length && options.count < end) {
            const { name, text, entry } = all[next++];
            const number = entry && options.numbered ? [html("span", { class: "at", "data-number": entry })] : [];
            table.append(html("div", { "data-entry": entry || undefined }, ...line(name(options), read(text, options), options), ...number));
        }
        if (options.numbered) options.evaluate();
    };
    const slice = (until) => {
        append(Math.min(until, options.count + SLICE));
        // Of lines that others have taken the place of no more are set.
        const busy = host.firstChild === table && next < all.length && options.count < until;
        table.setAttribute("aria-busy", String(busy));
        more.hidden = busy || next === all.length;
        more.textContent = `show ${Math.min(all.length - next, next)} more of ${all.length} lines`;
        if (busy) requestAnimationFrame(() => setTimeout(() => slice(until)));
    };
    // On paper there is no button: all lines are set, and those that were not there taken away afterwards.
    table.addEventListener("print", () => {
        const [count, before] = [options.count, next];
        append(Infinity);
        const back = () => {
            while (table.children.length > before) table.lastChild?.remove();
            [options.count, next] = [count, before];
        };
        addEventListener("afterprint", back, { once: true });
    });
    more.addEventListener("click", () => {
        options.count = 0;
        fewer.hidden = false;
        slice(NODES);
    });
    fewer.addEventListener("click", () => {
        list(host, all, { ...options, count: 0 });
        host.closest("details")?.scrollIntoView({ block: "nearest" });
    });
    slice(options.count + NODES);
}
