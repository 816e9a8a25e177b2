/** Elements of the document, made without markup: texts are text nodes, values attributes. */

/** @param {string} name @param {Record<string, unknown>} attributes @param {...(Node | string)} children @returns {any} */
export function html(name, attributes = {}, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
        if (value === false || value === undefined || value === null) continue;
        element.setAttribute(key, value === true ? "" : String(value));
    }
    element.append(...children);
    return element;
}

/** The element of an identifier, which the document has. @param {string} id @returns {any} */
export function byId(id) {
    const element = document.getElementById(id);
    if (!element) throw new Error(`there is no #${id}`);
    return element;
}

/** A text with its words between backticks as code. @param {string} text @returns {(Node | string)[]} */
export function withCode(text) {
    return text.split("`").map((part, k) => (k % 2 === 1 ? html("code", {}, part) : part));
}

/** Copies a text and says so on the button. @param {any} button @param {string} text */
export async function copy(button, text) {
    const name = button.dataset.name ?? button.textContent;
    button.dataset.name = name;
    let done = true;
    try {
        await navigator.clipboard.writeText(text);
    } catch {
        // From a file some browsers ask for another way: a selection.
        const area = html("textarea", { "aria-hidden": "true" });
        area.value = text;
        document.body.append(area);
        area.select();
        done = document.execCommand("copy");
        area.remove();
    }
    button.textContent = done ? "copied" : "this browser refuses to copy";
    setTimeout(() => (button.textContent = name), 1500);
}

/** Offers a file to be kept. @param {string} name @param {Blob} blob */
export function download(name, blob) {
    const link = html("a", { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
