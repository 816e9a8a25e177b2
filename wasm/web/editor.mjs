/** The text: a plain field over a layer with the same text, whose marks are underlined, and numbers of lines. */

import { html } from "./elements.mjs";
import { apart, lineStarts, range } from "./places.mjs";

export class Editor {
    /** @param {HTMLTextAreaElement} field @param {HTMLElement} layer @param {HTMLElement} gutter */
    constructor(field, layer, gutter) {
        this.field = field;
        this.layer = layer;
        this.gutter = gutter;
        /** @type {import("./places.mjs").Diagnostic[]} */
        this.diagnostics = [];
        /** Where the lines of a text begin, for the last text that was asked for. */
        this.lines = { text: "", starts: [0] };
        field.addEventListener("input", () => {
            // Until the new text is judged, the marks of the old one are nobody's.
            this.mark([]);
        });
    }

    get text() {
        return this.field.value;
    }

    set text(text) {
        this.field.value = text;
        this.mark([]);
    }

    /** Where each line begins. */
    get starts() {
        const text = this.text;
        if (this.lines.text !== text) this.lines = { text, starts: lineStarts(text) };
        return this.lines.starts;
    }

    /** The ranges of a diagnostic, its own first. @param {import("./places.mjs").Diagnostic} diagnostic */
    ranges(diagnostic) {
        const { starts } = this;
        const { text } = this.lines;
        const places = diagnostic.labels.length > 0 ? diagnostic.labels : [diagnostic];
        return places.map((place) => range(text, starts, place));
    }

    /** Underlines diagnostics. @param {import("./places.mjs").Diagnostic[]} diagnostics */
    mark(diagnostics) {
        this.diagnostics = diagnostics;
        const { text, starts } = this;
        const own = diagnostics.map((diagnostic) => {
            const [from, to] = this.ranges(diagnostic)[0];
            return { from, to, severity: diagnostic.severity };
        });
        const parts = [];
        let at = 0;
        for (const { from, to, severity } of apart(own)) {
            parts.push(text.slice(at, from), html("mark", { class: severity }, text.slice(from, to)));
            at = to;
        }
        // A last line without a character has no height.
        this.layer.replaceChildren(...parts, `${text.slice(at)}\n `);
        const worst = new Map();
        for (const { line, severity } of diagnostics) if (worst.get(line) !== "error") worst.set(line, severity);
        const numbers = starts.map((_, k) => {
            const severity = worst.get(k + 1);
            return severity ? html("b", { class: severity }, `${k + 1}\n`) : `${k + 1}\n`;
        });
        this.gutter.replaceChildren(...joined(numbers));
    }

    /** The diagnostic at the caret, by its number. */
    atCaret() {
        const caret = this.field.selectionStart;
        return this.diagnostics.findIndex((diagnostic) => this.ranges(diagnostic).some(([from, to]) => from <= caret && caret <= to));
    }

    /** Puts the caret on a diagnostic. @param {import("./places.mjs").Diagnostic} diagnostic */
    show(diagnostic) {
        const [from, to] = this.ranges(diagnostic)[0];
        this.field.focus();
        this.field.setSelectionRange(from, to);
        const scroller = this.layer.closest(".editor");
        const line = this.starts.findLastIndex((start) => start <= from);
        const height = this.layer.scrollHeight / (this.starts.length + 1);
        if (scroller) scroller.scrollTop = Math.max(0, line * height - scroller.clientHeight / 3);
    }

    /** Puts a word in the place of a diagnostic, as if it were typed. @param {import("./places.mjs").Diagnostic} diagnostic @param {string} word */
    replace(diagnostic, word) {
        const [from, to] = this.ranges(diagnostic)[0];
        this.field.focus();
        this.field.setRangeText(word, from, to, "end");
        this.field.dispatchEvent(new Event("input", { bubbles: true }));
    }
}

/** Texts side by side as one. @param {(string | Node)[]} parts */
function joined(parts) {
    /** @type {(string | Node)[]} */
    const all = [];
    for (const part of parts) {
        const last = all.length - 1;
        if (typeof part === "string" && typeof all[last] === "string") all[last] += part;
        else all.push(part);
    }
    return all;
}
