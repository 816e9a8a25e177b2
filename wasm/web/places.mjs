/** Lines and columns of diagnostics as places in the text of a field, which counts in units of UTF-16. */

/**
 * @typedef {{line: number, column: number, end_line: number, end_column: number, text?: string}} Place
 * @typedef {Place & {code: string, severity: string, message: string, help: string, labels: Place[]}} Diagnostic
 */

/** Where each line begins. @param {string} text */
export function lineStarts(text) {
    const starts = [0];
    for (let at = text.indexOf("\n"); at >= 0; at = text.indexOf("\n", at + 1)) starts.push(at + 1);
    return starts;
}

/** Line and column, from 1 and in characters, as an offset. @param {string} text @param {number[]} starts @param {number} line @param {number} column */
export function offset(text, starts, line, column) {
    const start = starts[Math.min(line, starts.length) - 1];
    const end = (starts[line] ?? text.length + 1) - 1;
    let at = start;
    for (let k = 1; k < column && at < end; k++) at += (text.codePointAt(at) ?? 0) > 0xffff ? 2 : 1;
    return at;
}

/** A place as a range that shows: at least one character of its line. @param {string} text @param {number[]} starts @param {Place} place @returns {[number, number]} */
export function range(text, starts, place) {
    const from = offset(text, starts, place.line, place.column);
    const to = offset(text, starts, place.end_line, place.end_column);
    if (to > from) return [from, to];
    const end = (starts[place.line] ?? text.length + 1) - 1;
    return from < end ? [from, from + 1] : [Math.max(starts[place.line - 1] ?? 0, from - 1), from];
}

/** Ranges that do not overlap, in order: of two at one place the error. @param {{from: number, to: number, severity: string}[]} ranges */
export function apart(ranges) {
    const order = [...ranges].sort((a, b) => a.from - b.from || (a.severity === "error" ? -1 : 1));
    const kept = [];
    let end = 0;
    for (const one of order) {
        const from = Math.max(one.from, end);
        if (one.to <= from) continue;
        kept.push({ ...one, from });
        end = one.to;
    }
    return kept;
}

/** Links that a refusal of several tips names, those of its remedy first. @param {Diagnostic} diagnostic @returns {string[]} */
export function tips(diagnostic) {
    const [remedies, others] = [diagnostic.help.matchAll(/`--tip ([^`]+)`/g), diagnostic.message.matchAll(/`([^`]+)` \(/g)];
    return [...new Set([...remedies, ...others].map((match) => match[1]))];
}

/** Whether the remedy of a refusal of several tips takes all of them. @param {Diagnostic} diagnostic */
export function takesAll(diagnostic) {
    return diagnostic.help.includes("`--all`");
}

/** What a remedy puts in the place of a fault: the word that was meant. @param {Diagnostic} diagnostic @returns {string | null} */
export function meant(diagnostic) {
    return diagnostic.help.match(/did you mean `([^`]+)`/)?.[1] ?? null;
}

/** Joints that a remedy locks, with their values. @param {Diagnostic} diagnostic @returns {[string, string][]} */
export function locks(diagnostic) {
    return [...diagnostic.help.matchAll(/`--lock ([^`=]+)=([^`]+)`/g)].map(([, joint, value]) => [joint, value]);
}
