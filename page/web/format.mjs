/** Numbers for people, and the units that they are shown in. */

/** Six digits at most. @param {number} value */
export function short(value) {
    if (value === 0) return "0";
    if (!Number.isFinite(value)) return String(value).replace("Infinity", "∞").replace("-", "−");
    const size = Math.abs(value);
    let text;
    if (size < 1e-4 || size >= 1e6) {
        const [digits, exponent] = value.toExponential(5).split("e");
        text = `${trimmed(digits)}·10${raised(Number(exponent))}`;
    } else {
        text = trimmed(value.toFixed(Math.max(0, 5 - Math.floor(Math.log10(size)))));
    }
    return text.replaceAll("-", "−");
}

/** A time, s: to a microsecond, however late it is. @param {number} t */
export function instant(t) {
    return Math.abs(t) < 1e-4 ? short(t) : String(Number(t.toFixed(6))).replace("-", "−");
}

/** An exponent. @param {number} exponent */
function raised(exponent) {
    return String(exponent).replace(/./g, (digit) => (digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]));
}

/**
 * The unit of w and det J: m for each row of a velocity, less one for each joint that slides; empty where there is none, as of more joints than
 * rows that turn and slide. @param {{task: number[], rows: {type: string}[]}} data
 */
export function unitOfManipulability({ task, rows }) {
    const slides = rows.filter((row) => row.type === "prismatic").length;
    const power = task.filter((row) => row < 3).length - slides;
    if (power === 0 || (slides > 0 && task.length !== rows.length)) return "";
    return power === 1 ? "m" : `m${raised(power)}`;
}

/** The variable of joint k from 1, as it stands in a text. @param {number | string} k @param {string} [letter] */
export function variable(k, letter = "q") {
    return letter + String(k).replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[Number(digit)]);
}

/** A formula of the description's notation in a text: q₂ for q2, 2 sin(q₂) for 2*sin(q2). @param {string} formula */
export function inWords(formula) {
    const variables = formula.replace(/\bq(\d+)/g, (_, k) => variable(k));
    return variables.replaceAll("*", " ").replaceAll("+-", "±").replaceAll("-", "−").replace(/\bpi\b/g, "π");
}

/** Without what rounding left instead of 0, and without the sign of 0. @param {number} value */
export function tidy(value) {
    return Math.abs(value) < 1e-12 ? 0 : value;
}

/** @param {string} digits */
function trimmed(digits) {
    return digits.includes(".") ? digits.replace(/\.?0+$/, "") : digits;
}

/** All digits: read back it is the same number, zeros of both signs included. @param {number} value */
export function exact(value) {
    return Object.is(value, -0) ? "-0" : String(value);
}

/** The units chosen by the reader; what is computed is always in m and rad. */
export const units = { length: "m", angle: "rad" };

/** A number that is shown in the unit of the reader. @param {number} value @param {string} unit m, rad, or another */
export function inUnit(value, unit) {
    if (unit === "m" && units.length === "mm") return value * 1000;
    if (unit === "rad" && units.angle === "deg") return (value * 180) / Math.PI;
    return value;
}

/** A number of the reader's unit in m or rad. @param {number} value @param {string} unit */
export function fromUnit(value, unit) {
    if (unit === "m" && units.length === "mm") return value / 1000;
    if (unit === "rad" && units.angle === "deg") return (value * Math.PI) / 180;
    return value;
}

/** The digits of a number in the unit of the reader: the fewest from fifteen on that are this one in m or rad again, so that 30 degrees are not 29.999999999999996. @param {number} value @param {string} unit */
export function digitsIn(value, unit) {
    const whole = inUnit(value, unit);
    const brief = [15, 16, 17].map((count) => Number(whole.toPrecision(count))).find((x) => fromUnit(x, unit) === value);
    return exact(brief ?? whole);
}

/** The name of the unit that the reader sees. @param {string} unit */
export function unitName(unit) {
    if (unit === "m") return units.length;
    if (unit === "rad") return units.angle;
    return unit;
}

/** With its unit. @param {number} value @param {string} unit */
export function withUnit(value, unit) {
    const shown = inUnit(value, unit);
    // A turn of 90 degrees is 90, not 90.00000000000001.
    return unitName(unit) === "deg" ? `${short(shown)}°` : `${short(shown)} ${unitName(unit)}`;
}
