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
    const sub = (base, index) => make(options, "msub", {}, base, index);
    const joint = /^(ddqr|dqr|ddq|dq|q|tau)(\d+)$/.exec(text);
    if (joint) {
        const [, letter, index] = joint;
        const dots = letter.startsWith("ddq") ? "¨" : letter.startsWith("dq") ? "." : "";
        const base = mi(letter === "tau" ? "τ" : "q");
        // As accents, dots fall onto the letter where a font has no table of mathematics.
        const dotted = dots ? make(options, "mover", {}, base, make(options, "mo", { stretchy: "false" }, dots)) : base;
        return sub(dotted, letter.endsWith("r") ? make(options, "mrow", {}, mi("r"), mn(index)) : mn(index));
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
    return head && tail ? sub(mi(head), make(options, "mtext", {}, tail)) : mi(text);
}

/** A constant. @param {string} exact @param {number} value @param {Options} options @param {() => Node} whole */
function constant(exact, value, options, whole) {
    const decimal = short(value);
    if (options.exact) return whole();
    const approximate = exact.length > 6 || exact.includes("/");
    return make(options, "mn", approximate ? { title: `${exact} = ${value}` } : {}, decimal);
}

/** @param {any} inner @param {Options} options */
function inParentheses(inner, options) {
    return make(options, "mrow", {}, make(options, "mo", { stretchy: "false" }, "("), inner, make(options, "mo", { stretchy: "false" }, ")"));
}

/** A sum as a factor has parentheses. @param {import("./formula.mjs").Node} node @param {Options} options */
function factorOf(node, options) {
    return node.kind === "sum" ? inParentheses(mathml(node, options), options) : mathml(node, options);
}

/** The terms of a sum, each with its sign. @param {any} node @param {Options} options @returns {any[][]} */
export function termsOf(node, options) {
    return node.terms.map((term, i) => {
        const sign = () => make(options, "mo", { form: i === 0 ? "prefix" : "infix" }, term.negative ? "−" : "+");
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
        const alone = ["name", "number"].includes(inner.kind) || (inner.kind === "call" && inner.name === "sqrt");
        return alone ? mathml(inner, options) : parentheses(mathml(inner, options));
    };
    switch (node.kind) {
        case "sum":
            return mrow(...termsOf(node, options).flat());
        case "product": {
            const line = (factors) => {
                const parts = [];
                factors.forEach(({ node: inner }, i) => {
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
        case "approximate":
            return make(options, "mn", { title: `about ${node.text}: the exact constant is too long to be written` }, `≈${short(Number(node.text))}`);
        default:
            return nameElement(node.text, options);
    }
}
