/**
 * Formulas as `armgen show` prints them in plain text: read, evaluated, printed again. Fields take them, too, with decimals.
 *
 * sum     = ["-"] product { ("+" | "-") product }
 * product = power { ("*" | "/") power }
 * power   = atom ["^" (digits | "(" "-" digits ")")]
 * atom    = decimal | "≈" decimal | name ["(" sum ")"] | "(" sum ")"
 */

/**
 * @typedef {{kind: "sum", terms: {negative: boolean, node: Node}[]}
 *     | {kind: "product", factors: {divided: boolean, node: Node}[]}
 *     | {kind: "power", base: Node, exponent: number}
 *     | {kind: "call", name: string, argument: Node}
 *     | {kind: "number", text: string}
 *     | {kind: "fraction", numerator: string, denominator: string}
 *     | {kind: "approximate", text: string}
 *     | {kind: "decimal", text: string, value: number}
 *     | {kind: "name", text: string}} Node
 */

const TOKEN = /\s*(≈-?[\d.]+(?:e-?\d+)?|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[A-Za-z_]\w*|[-+*/^()])/y;

/** @param {string} text @returns {Node} */
export function parse(text) {
    const tokens = [];
    TOKEN.lastIndex = 0;
    while (TOKEN.lastIndex < text.length) {
        const at = TOKEN.lastIndex;
        const match = TOKEN.exec(text);
        if (!match) throw new Error(`no formula at ${at}: ${text.slice(at, at + 20)}`);
        tokens.push(match[1]);
    }
    let next = 0;
    const take = (token) => {
        if (tokens[next] !== token) throw new Error(`${token} expected, not ${tokens[next]}`);
        next++;
    };
    const sum = () => {
        const terms = [];
        let negative = tokens[next] === "-";
        if (negative) next++;
        for (;;) {
            terms.push({ negative, node: product() });
            if (tokens[next] !== "+" && tokens[next] !== "-") break;
            negative = tokens[next++] === "-";
        }
        return terms.length === 1 && !terms[0].negative ? terms[0].node : { kind: "sum", terms };
    };
    const product = () => {
        const factors = [{ divided: false, node: power() }];
        while (tokens[next] === "*" || tokens[next] === "/") {
            const divided = tokens[next++] === "/";
            const node = power();
            const before = factors[factors.length - 1];
            // 10763/500 is one number.
            if (divided && factors.length === 1 && before.node.kind === "number" && node.kind === "number") {
                before.node = { kind: "fraction", numerator: before.node.text, denominator: node.text };
            } else {
                factors.push({ divided, node });
            }
        }
        return factors.length === 1 ? factors[0].node : { kind: "product", factors };
    };
    const power = () => {
        const base = atom();
        if (tokens[next] !== "^") return base;
        next++;
        if (tokens[next] !== "(") return { kind: "power", base, exponent: Number(tokens[next++]) };
        next++;
        take("-");
        const exponent = -Number(tokens[next++]);
        take(")");
        return { kind: "power", base, exponent };
    };
    const atom = () => {
        const token = tokens[next++];
        if (token === undefined) throw new Error("a formula ends too early");
        if (token === "(") {
            const inner = sum();
            take(")");
            return inner;
        }
        if (token.startsWith("≈")) return { kind: "approximate", text: token.slice(1) };
        if (/^[\d.]/.test(token)) return { kind: "number", text: token };
        if (!/^[A-Za-z_]/.test(token)) throw new Error(`${token} is no operand`);
        if (tokens[next] !== "(") return { kind: "name", text: token };
        next++;
        const argument = sum();
        take(")");
        return { kind: "call", name: token, argument };
    };
    const all = sum();
    if (next !== tokens.length) throw new Error(`${tokens[next]} is left`);
    return all;
}

/** The value of a fraction whose digits may be more than a float has. @param {string} numerator @param {string} denominator */
export function quotient(numerator, denominator) {
    if (numerator.length < 300 && denominator.length < 300) return Number(numerator) / Number(denominator);
    const digits = 40;
    const shift = denominator.length - numerator.length + digits;
    const ten = (power) => 10n ** BigInt(Math.max(0, power));
    const whole = (BigInt(numerator) * ten(shift)) / (BigInt(denominator) * ten(-shift));
    return Number(`${whole}e${-shift}`);
}

const FUNCTIONS = { __proto__: null, sin: Math.sin, cos: Math.cos, sqrt: Math.sqrt, atan: Math.atan, acos: Math.acos, sign: Math.sign, deg: (x) => (x * Math.PI) / 180 };

/** The value of a formula, its names looked up. @param {Node} node @param {(name: string) => number} lookup @returns {number} */
export function evaluate(node, lookup) {
    switch (node.kind) {
        case "sum":
            return node.terms.reduce((total, term) => total + (term.negative ? -1 : 1) * evaluate(term.node, lookup), 0);
        case "product":
            return node.factors.reduce((total, factor) => {
                const value = evaluate(factor.node, lookup);
                return factor.divided ? total / value : total * value;
            }, 1);
        case "power":
            return evaluate(node.base, lookup) ** node.exponent;
        case "call":
            return FUNCTIONS[node.name](evaluate(node.argument, lookup));
        case "number":
            return Number(node.text);
        case "fraction":
            return quotient(node.numerator, node.denominator);
        case "approximate":
            return Number(node.text);
        case "decimal":
            return node.value;
        default:
            return node.text === "pi" ? Math.PI : lookup(node.text);
    }
}

/** Whether no variable enters, and whether it is more than fractions and pi. @param {Node} node @returns {{constant: boolean, long: boolean}} */
function kind(node) {
    const all = (nodes) => nodes.map(kind).reduce((a, b) => ({ constant: a.constant && b.constant, long: a.long || b.long }), { constant: true, long: false });
    switch (node.kind) {
        case "sum":
            return all(node.terms.map((term) => term.node));
        case "product":
            return all(node.factors.map((factor) => factor.node));
        case "power":
            return kind(node.base);
        case "call":
            return { constant: node.name in FUNCTIONS && kind(node.argument).constant, long: true };
        case "name":
            return { constant: node.text === "pi", long: false };
        default:
            return { constant: true, long: false };
    }
}

/** @param {Node} node @returns {Node} */
function decimal(node) {
    const value = evaluate(node, () => NaN);
    const size = /** @type {Node} */ ({ kind: "decimal", value: Math.abs(value), text: value < 0 ? `-(${print(node)})` : print(node) });
    return value < 0 ? { kind: "sum", terms: [{ negative: true, node: size }] } : size;
}

/** A formula in which the parts that no variable enters are one decimal each where they have roots or functions: 1.08165 cos(q1) for sqrt(2)*cos(7/10)*cos(q1). @param {Node} node @returns {Node} */
export function folded(node) {
    const { constant, long } = kind(node);
    if (constant) return long ? decimal(node) : node;
    /** Parts with the constants among them as one, where the first of them was. */
    const gathered = (parts, whole, one) => {
        const constants = parts.filter((part) => kind(part.node).constant);
        const rest = parts.map((part) => (constants.includes(part) ? part : { ...part, node: folded(part.node) }));
        if (!constants.some((part) => kind(part.node).long)) return rest;
        return rest.flatMap((part) => (part === constants[0] ? [one(decimal(whole(constants)))] : constants.includes(part) ? [] : [part]));
    };
    switch (node.kind) {
        case "sum": {
            const terms = gathered(node.terms, (terms) => ({ kind: "sum", terms }), (node) => ({ negative: false, node }));
            // A sign is that of its term.
            return { kind: "sum", terms: terms.map((term) => (term.node.kind === "sum" && term.node.terms.length === 1 ? { negative: term.negative !== term.node.terms[0].negative, node: term.node.terms[0].node } : term)) };
        }
        case "product": {
            const factors = gathered(node.factors, (factors) => ({ kind: "product", factors }), (node) => ({ divided: false, node }));
            const negative = factors.find(({ node }) => node.kind === "sum" && node.terms.length === 1 && node.terms[0].negative && node.terms[0].node.kind === "decimal");
            const product = /** @type {Node} */ ({ kind: "product", factors: factors.map((factor) => (factor === negative ? { ...factor, node: factor.node.terms[0].node } : factor)) });
            return negative ? { kind: "sum", terms: [{ negative: true, node: product }] } : product;
        }
        case "power":
            return { ...node, base: folded(node.base) };
        case "call":
            return { ...node, argument: folded(node.argument) };
        default:
            return node;
    }
}

/** The number that somebody typed, as 1.5, -pi/4 or 2*(pi - 1), degrees as 30 deg, 30° or deg(30); NaN where it is none. @param {string} text */
export function typed(text) {
    const plain = text.trim().replaceAll("π", "pi").replaceAll("−", "-").replace(/((?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(?:°|deg\b)/gi, "deg($1)");
    // A number alone keeps its bits.
    if (/^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(plain)) return Number(plain);
    try {
        return Number(evaluate(parse(plain), () => NaN));
    } catch {
        return NaN;
    }
}

/**
 * The joint and its values in `q3 = atan(-1/2) mod pi`, `q1 = +-2 pi/3 mod 2 pi` or `q2 = 1 or 3`; null where a text is none of these.
 *
 * @param {string} text @returns {{joint: number, period: number, values: {value: number, text: string}[]} | null}
 */
export function zeros(text) {
    const match = /^q(\d+) = (.*?)(?: mod (2 )?pi)?$/.exec(text);
    if (!match || match[2].includes("atan2") || match[2].includes(" with ")) return null;
    const period = !text.endsWith(" pi") ? 0 : match[3] ? 2 * Math.PI : Math.PI;
    const both = (text) => (text.startsWith("+-") ? [text.slice(2), `-${text.slice(2)}`] : [text]);
    const values = match[2].split(" or ").flatMap(both).map((text) => {
        const value = evaluate(parse(text.replaceAll(" pi", "*pi")), () => NaN);
        return { value, text: text.length < 10 ? text : String(Number(value.toPrecision(6))) };
    });
    return { joint: Number(match[1]), period, values };
}

/** How large a formula can become with sines and cosines of any angle: its terms' sizes added. @param {Node} node @param {(name: string) => number} lookup @returns {number} */
export function bound(node, lookup) {
    switch (node.kind) {
        case "sum":
            return node.terms.reduce((total, term) => total + bound(term.node, lookup), 0);
        case "product":
            return node.factors.reduce((total, { divided, node }) => (divided ? total / Math.abs(evaluate(node, lookup)) : total * bound(node, lookup)), 1);
        case "power":
            return bound(node.base, lookup) ** node.exponent;
        case "call":
            return node.name === "sqrt" ? evaluate(node, lookup) : 1;
        default:
            return Math.abs(evaluate(node, lookup));
    }
}

/** A formula in plain text again. @param {Node} node @returns {string} */
export function print(node) {
    const inside = (inner) => (inner.kind === "sum" ? `(${print(inner)})` : print(inner));
    switch (node.kind) {
        case "sum":
            return node.terms.map((term, i) => (i === 0 ? (term.negative ? "-" : "") : term.negative ? " - " : " + ") + inside(term.node)).join("");
        case "product":
            return node.factors.map((factor, i) => (i === 0 ? "" : factor.divided ? "/" : "*") + inside(factor.node)).join("");
        case "power":
            return `${inside(node.base)}^${node.exponent < 0 ? `(${node.exponent})` : node.exponent}`;
        case "call":
            return `${node.name}(${print(node.argument)})`;
        case "fraction":
            return `${node.numerator}/${node.denominator}`;
        case "approximate":
            return `(≈${node.text})`;
        case "decimal":
            return `(${node.text})`;
        default:
            return node.text;
    }
}
