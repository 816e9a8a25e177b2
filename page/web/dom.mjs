/** Elements of the document, made without markup: texts are text nodes, values attributes. */

const SVG = "http://www.w3.org/2000/svg";
const MATH = "http://www.w3.org/1998/Math/MathML";

/**
 * @param {string} namespace
 * @param {string} name
 * @param {Record<string, unknown>} attributes
 * @param {(Node | string)[]} children
 */
function make(namespace, name, attributes, children) {
    const element = namespace ? document.createElementNS(namespace, name) : document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
        if (value === false || value === undefined || value === null) continue;
        element.setAttribute(key, value === true ? "" : String(value));
    }
    element.append(...children);
    return element;
}

/** @param {string} name @param {Record<string, unknown>} attributes @param {...(Node | string)} children @returns {any} */
export function html(name, attributes = {}, ...children) {
    return make("", name, attributes, children);
}

/** @param {string} name @param {Record<string, unknown>} attributes @param {...(Node | string)} children @returns {any} */
export function svg(name, attributes = {}, ...children) {
    return make(SVG, name, attributes, children);
}

/** @param {string} name @param {Record<string, unknown>} attributes @param {...(Node | string)} children @returns {any} */
export function math(name, attributes = {}, ...children) {
    return make(MATH, name, attributes, children);
}

/** The element of an identifier, which the page has. @param {string} id @returns {any} */
export function byId(id) {
    const element = document.getElementById(id);
    if (!element) throw new Error(`the page has no #${id}`);
    return element;
}

/** Sets attributes of an element. @param {Element} element @param {Record<string, unknown>} attributes */
export function set(element, attributes) {
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
}

/** The status line, wherever it stands. @type {any} */
let said = null;

/** Copies a text and says so in the status line, which goes beside the button. @param {any} button @param {string} text @param {string} what */
export async function copy(button, text, what) {
    said ??= byId("said");
    said.textContent = "";
    button.parentElement.append(said);
    try {
        await navigator.clipboard.writeText(text);
        said.textContent = `${what}: copied`;
    } catch {
        // From a file some browsers ask for another way: a selection.
        const area = html("textarea", { "aria-hidden": "true" });
        area.value = text;
        document.body.append(area);
        area.select();
        const done = document.execCommand("copy");
        area.remove();
        said.textContent = done ? `${what}: copied` : `${what}: this browser refuses to copy`;
    }
}
