/** The generator beside the page: one request after the other, each with an answer. */

/** @type {any} */
let module = null;
/** @type {any} */
let instance = null;

/** A packed module: the zlib format, 13 bits as two characters of 91. @param {string} text @param {number} length of the packed bytes */
export function unpacked(text, length) {
    const bytes = new Uint8Array(length + 2);
    const digit = (at) => {
        const code = text.charCodeAt(at);
        return code > 60 ? code - 36 : code - 35;
    };
    let [at, word, bits] = [0, 0, 0];
    for (let k = 0; k < text.length; k += 2) {
        word = (word << 13) | (digit(k) * 91 + digit(k + 1));
        bits += 13;
        for (; bits >= 8; bits -= 8) bytes[at++] = word >>> (bits - 8);
        word &= (1 << bits) - 1;
    }
    return bytes.subarray(0, length);
}

/** @param {{text: string, length: number}} packed */
async function compiled({ text, length }) {
    const stream = new Blob([unpacked(text, length)]).stream().pipeThrough(new DecompressionStream("deflate"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

/** @param {any} request */
function answer(request) {
    instance ??= new WebAssembly.Instance(module);
    const { memory, room, call, answer } = instance.exports;
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    // Room that is made may move the memory.
    const at = room(bytes.length);
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    try {
        const length = call();
        const result = JSON.parse(new TextDecoder().decode(new Uint8Array(memory.buffer, answer(), length)));
        // What an arm of many joints has taken is given back.
        if (memory.buffer.byteLength > 256 << 20) instance = null;
        return result;
    } catch (fault) {
        // The memory of a module that has stopped is lost.
        instance = null;
        return { fault: `armgen stopped, which is a fault of armgen, or the arm is too large for this browser: ${fault}` };
    }
}

globalThis.onmessage = async ({ data }) => {
    if (data.packed) {
        module = await compiled(data.packed);
        postMessage({ module });
    } else if (data.module) {
        module = data.module;
    } else {
        postMessage({ answer: answer(data.request) });
    }
};
