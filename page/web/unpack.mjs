/** Texts that lie packed in the page: base64 of the zlib format. */

/** @param {string} packed @returns {Promise<string>} */
export function unpack(packed) {
    const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(stream).text();
}
