/**
 * Formulas as MathML, which browsers set themselves. Dots for rates, subscripts, a thin space between factors; constants as decimals of six
 * digits, or exact, with both in the tooltip.
 */

import { math } from "./dom.mjs";
import { short } from "./format.mjs";
import { quotient } from "./formula.mjs";

const GREEK = { pi: "π", phi: "φ", tau: "τ" };
const THIN = "0.167em";

/** @typedef {{exact: boolean, count: number, steps: string}} Options what is to be shown, how many nodes were made, the letter of steps */

/** @param {Options} options @param {string} name @param {Record<string, unknown>} attributes @param {...any} children */
function make(options, name, attributes, ...children) {
    options.count++;
    return math(name, attributes, ...children);
}

/** A name: a variable of a joint, a step, or a parameter. @param {string} text @param {Options} options */
export function nameElement(text, options) {
    const mi = (content) => make(options, "mi", {}, content);
    const mn = (content) => make(options, "mn", {}, content);
    // What leans over its own foot has its index below the overhang.
    const sub = (base, index) => make(options, "msub", /^[TVWY]$/.test(base.textContent ?? "") ? { class: "overhang" } : {}, base, index);
    const joint = /^(ddqr|dqr|ddq|dq|qr|q|tau)(\d*)$/.exec(text);
    if (joint) {
        const [, letter, index] = joint;
        const dots = letter.startsWith("ddq") ? "¨" : letter.startsWith("dq") ? "." : "";
        const base = mi(letter === "tau" ? "τ" : "q");
        // As accents, dots fall onto the letter where a font has no table of mathematics.
        const dotted = dots ? make(options, "mover", {}, base, make(options, "mo", { stretchy: "false" }, dots)) : base;
        const below = [...(letter.endsWith("r") ? [mi("r")] : []), ...(index ? [mn(index)] : [])];
        if (below.length === 0) return dotted;
        return sub(dotted, below.length === 1 ? below[0] : make(options, "mrow", {}, ...below));
    }
    if (GREEK[text]) return mi(GREEK[text]);
    const step = new RegExp(`^${options.steps}(\\d+)$`).exec(text);
    if (step && options.steps) {
        const element = sub(mi(options.steps), mn(step[1]));
        element.setAttribute("data-step", text);
        return element;
    }
    const under = /^([A-Za-z]+)_?(\w*?)$/.exec(text.replace(/^([A-Za-z]+)(\d+)$/, "$1_$2"));
    const [head, tail] = under && text.includes("_") ? [text.slice(0, text.indexOf("_")), text.slice(text.indexOf("_") + 1)] : (under?.slice(1) ?? [text, ""]);
    return head && tail ? sub(mi(GREEK[head] ?? head), indexElement(tail, options)) : mi(text);
}

/** An index: a letter alone is slanted, so that l is no 1. @param {string} text @param {Options} options */
function indexElement(text, options) {
    const parts = (text.match(/[A-Za-z]+|\d+|[^A-Za-z\d]+/g) ?? []).map((part) => {
        const kind = /^\d/.test(part) ? "mn" : part.length === 1 ? "mi" : "mtext";
        return make(options, kind, {}, part.replaceAll("_", " "));
    });
    return parts.length === 1 ? parts[0] : make(options, "mrow", {}, ...parts);
}

/** The symbol of a quantity: T_e(q), C' dq, (J B^-1 J')^-1, d(ddq)/dq. @param {string} symbol @param {Options} options */
export function symbolElement(symbol, options) {
    const partial = /^d(tau|\(ddq\))\/d/.test(symbol);
    const words = symbol.replace(/d\((d*q)\)/g, "d $1").replace(/^dtau/, "d tau").replace(/\/dq/, "/d q").replace(/^dJ/, "d J").replace("/dt", "/d t");
    const mo = (text, attributes = {}) => make(options, "mo", { stretchy: "false", ...attributes }, text);
    const parts = [];
    let differential = false;
    for (const [token] of words.matchAll(/[A-Za-z]\w*|\^-1|[^\sA-Za-z^]/g)) {
        if (token === "^-1" || token === "'") {
            const power = token === "'" ? make(options, "mi", { mathvariant: "normal" }, "T") : make(options, "mrow", {}, mo("−", { form: "prefix" }), make(options, "mn", {}, "1"));
            parts.push(make(options, "msup", {}, parts.pop(), power));
        } else if (/^\w/.test(token)) {
            const space = parts.length > 0 && !differential && parts.at(-1).localName !== "mo" ? [make(options, "mspace", { width: THIN })] : [];
            differential = token === "d";
            parts.push(...space, differential ? make(options, "mi", { mathvariant: "normal" }, partial ? "∂" : "d") : nameElement(token, options));
        } else {
            differential = false;
            parts.push(mo(token, token === "," ? { separator: "true", rspace: "0.25em" } : token === "/" ? { lspace: "0", rspace: "0" } : {}));
        }
    }
    return make(options, "mrow", {}, ...parts);
}

/** A number of six digits: 5·10⁻⁵ has a power, not an e. @param {number} value @param {Options} options @param {Record<string, unknown>} [attributes] @param {string} [before] */
function decimalElement(value, options, attributes = {}, before = "") {
    const text = short(value);
    if (!text.includes("·")) return make(options, "mn", attributes, before + text);
    const [digits, exponent] = value.toExponential().split("e");
    const mantissa = make(options, "mn", {}, before + short(Number(Number(digits).toPrecision(6))));
    const minus = Number(exponent) < 0 ? [make(options, "mo", { form: "prefix" }, "−")] : [];
    const power = make(options, "mrow", {}, ...minus, make(options, "mn", {}, String(Math.abs(Number(exponent)))));
    return make(options, "mrow", attributes, mantissa, make(options, "mo", { lspace: "0.1em", rspace: "0.1em" }, "·"), make(options, "msup", {}, make(options, "mn", {}, "10"), power));
}

/** A constant. @param {string} exact @param {number} value @param {Options} options @param {() => Node} whole */
function constant(exact, value, options, whole) {
    if (options.exact) return whole();
    const approximate = exact.length > 6 || exact.includes("/");
    return decimalElement(value, options, approximate ? { title: `${exact} = ${value}` } : {});
}

/** @param {any} inner @param {Options} options */
function inParentheses(inner, options) {
    return make(options, "mrow", {}, make(options, "mo", { stretchy: "false" }, "("), inner, make(options, "mo", { stretchy: "false" }, ")"));
}

/** A sum as a factor has parentheses. @param {import("./formula.mjs").Node} node @param {Options} options */
function factorOf(node, options) {
    return node.kind === "sum" ? inParentheses(mathml(node, options), options) : mathml(node, options);
}

/** Whether a factor is a function of something: what stood behind sin q₂ would be taken for a part of the angle. @param {import("./formula.mjs").Node} node */
function isCall(node) {
    return node.kind === "call" && node.name !== "sqrt";
}

/**
 * The terms of a sum, each with its sign; where each of them stands in an element of its own, an operator that begins it has a space behind it
 * only, since a space of the text stands before it. @param {any} node @param {Options} options @param {boolean} [apart] @returns {any[][]}
 */
export function termsOf(node, options, apart = false) {
    return node.terms.map((term, i) => {
        const form = i === 0 ? { form: "prefix" } : { form: "infix", ...(apart ? { lspace: "0", rspace: "0.25em" } : {}) };
        const sign = () => make(options, "mo", form, term.negative ? "−" : "+");
        return [...(i > 0 || term.negative ? [sign()] : []), factorOf(term.node, options)];
    });
}

/** @param {import("./formula.mjs").Node} node @param {Options} options @returns {any} */
export function mathml(node, options) {
    const mo = (content, attributes = {}) => make(options, "mo", attributes, content);
    const mrow = (...children) => make(options, "mrow", {}, ...children);
    const parentheses = (inner) => inParentheses(inner, options);
    const factor = (inner) => factorOf(inner, options);
    // What a power is taken of: cos q² would be the cosine of a square.
    const base = (inner) => {
        const alone = inner.kind === "name" || (inner.kind === "number" && (options.exact || !short(Number(inner.text)).includes("·"))) || (inner.kind === "call" && inner.name === "sqrt");
        return alone ? mathml(inner, options) : parentheses(mathml(inner, options));
    };
    switch (node.kind) {
        case "sum":
            return mrow(...termsOf(node, options).flat());
        case "product": {
            const line = (factors) => {
                const parts = [];
                const ordered = [...factors.filter(({ node: inner }) => !isCall(inner)), ...factors.filter(({ node: inner }) => isCall(inner))];
                ordered.forEach(({ node: inner }, i) => {
                    if (i > 0) parts.push(make(options, "mspace", { width: THIN }));
                    parts.push(factor(inner));
                });
                return parts.length === 1 ? parts[0] : mrow(...parts);
            };
            const above = node.factors.filter((one) => !one.divided);
            const below = node.factors.filter((one) => one.divided);
            if (below.length === 0) return line(above);
            const lone = below.length === 1 && below[0].node.kind === "sum" ? mathml(below[0].node, options) : line(below);
            return make(options, "mfrac", {}, line(above), lone);
        }
        case "power":
            return make(options, "msup", {}, base(node.base), mrow(...(node.exponent < 0 ? [mo("−", { form: "prefix" })] : []), make(options, "mn", {}, String(Math.abs(node.exponent)))));
        case "call": {
            if (node.name === "sqrt") return make(options, "msqrt", {}, mathml(node.argument, options));
            const name = make(options, "mi", {}, node.name === "atan" ? "arctan" : node.name);
            if (node.argument.kind === "name") return mrow(name, make(options, "mspace", { width: THIN }), mathml(node.argument, options));
            return mrow(name, parentheses(mathml(node.argument, options)));
        }
        case "number":
            return constant(node.text, Number(node.text), options, () => make(options, "mn", {}, node.text));
        case "fraction":
            return constant(`${node.numerator}/${node.denominator}`, quotient(node.numerator, node.denominator), options, () =>
                make(options, "mfrac", {}, make(options, "mn", {}, node.numerator), make(options, "mn", {}, node.denominator)),
            );
        case "decimal":
            return decimalElement(node.value, options, { title: `${node.text} = ${node.value}` });
        case "approximate":
            return decimalElement(Number(node.text), options, { title: `about ${node.text}: the exact constant is too long to be written` }, "≈");
        default:
            return nameElement(node.text, options);
    }
}
