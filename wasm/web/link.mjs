/** The text of a file in the address, behind `#`: deflated, in the alphabet of base64 that needs no escapes. Nothing is sent. */

/** @param {Uint8Array} bytes @param {CompressionStream | DecompressionStream} stream @returns {Promise<Uint8Array>} */
async function through(bytes, stream) {
    return new Uint8Array(await new Response(new Blob([/** @type {any} */ (bytes)]).stream().pipeThrough(/** @type {any} */ (stream))).arrayBuffer());
}

/** @param {Uint8Array} bytes */
function toBase64(bytes) {
    let text = "";
    for (let at = 0; at < bytes.length; at += 0x8000) text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
    return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** @param {string} text */
export function fromBase64(text) {
    return Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
}

/** The part of an address behind `#` that holds a file. @param {string} name @param {string} text @returns {Promise<string>} */
export async function linkOf(name, text) {
    const bytes = new TextEncoder().encode(JSON.stringify([name, text]));
    return `1${toBase64(await through(bytes, new CompressionStream("deflate-raw")))}`;
}

/** The longest file that a link may unfold to: a short link must not fill the memory. */
const LONGEST = 4 << 20;

/** The file of a link; none where it is no link, or damaged. @param {string} link @returns {Promise<{name: string, text: string} | null>} */
export async function fileOf(link) {
    if (!/^1[\w-]+$/.test(link)) return null;
    try {
        const stream = new Blob([fromBase64(link.slice(1))]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
        const parts = [];
        let length = 0;
        for (const reader = stream.getReader(); ; ) {
            const { done, value } = await reader.read();
            if (done) break;
            length += value.length;
            if (length > LONGEST) return null;
            parts.push(value);
        }
        const [name, text] = JSON.parse(await new Blob(parts).text());
        return typeof name === "string" && typeof text === "string" ? { name, text } : null;
    } catch {
        return null;
    }
}
