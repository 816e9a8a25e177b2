/** Files in one archive, stored without compression (PKWARE, APPNOTE 6.3, sections 4.3.7, 4.3.12 and 4.3.16). */

/** The table of CRC-32, polynomial 0xEDB88320. */
const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
    let c = n;
    for (let k = 0; k < 8; k++) c = c & 1 ? (c >>> 1) ^ 0xedb88320 : c >>> 1;
    return c;
});

/** @param {Uint8Array} bytes */
export function crc32(bytes) {
    let crc = 0xffffffff;
    for (const byte of bytes) crc = TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
    return (crc ^ 0xffffffff) >>> 0;
}

/** Numbers as bytes, the lowest first; [number, how many bytes]. @param {[number, number][]} fields */
function bytesOf(fields) {
    return Uint8Array.from(fields.flatMap(([number, length]) => Array.from({ length }, (_, k) => (number >>> (8 * k)) & 255)));
}

/** An archive of texts by their paths; the same files give the same bytes. @param {[string, string][]} files */
export function zip(files) {
    const encoder = new TextEncoder();
    const parts = [];
    const directory = [];
    let at = 0;
    for (const [path, text] of files) {
        const [name, content] = [encoder.encode(path), encoder.encode(text)];
        // Version 2.0, names in UTF-8, stored, 1980-01-01: what both headers share.
        const shared = /** @type {[number, number][]} */ ([[20, 2], [0x800, 2], [0, 2], [0, 2], [0x21, 2], [crc32(content), 4], [content.length, 4], [content.length, 4], [name.length, 2], [0, 2]]);
        parts.push(bytesOf([[0x04034b50, 4], ...shared]), name, content);
        directory.push(bytesOf([[0x02014b50, 4], [20, 2], ...shared, [0, 2], [0, 2], [0, 2], [0, 4], [at, 4]]), name);
        at += 30 + name.length + content.length;
    }
    const length = directory.reduce((sum, part) => sum + part.length, 0);
    const end = bytesOf([[0x06054b50, 4], [0, 2], [0, 2], [files.length, 2], [files.length, 2], [length, 4], [at, 4], [0, 2]]);
    return new Blob([...parts, ...directory, end], { type: "application/zip" });
}
