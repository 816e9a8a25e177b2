// A client of yaml-language-server: reads {schema, texts} from standard input, writes for each text whether the editor would mark something.

import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const { schema, texts } = JSON.parse(readFileSync(0, "utf8"));
const folder = mkdtempSync(join(tmpdir(), "editor-"));
const path = join(folder, "robot.schema.json");
writeFileSync(path, JSON.stringify(schema));

const server = spawn("yaml-language-server", ["--stdio"], { stdio: ["pipe", "pipe", "inherit"] });
const answers = new Map();
const marked = new Map();
let rest = Buffer.alloc(0);
server.stdout.on("data", (bytes) => {
    rest = Buffer.concat([rest, bytes]);
    for (;;) {
        const end = rest.indexOf("\r\n\r\n");
        if (end < 0) return;
        const length = Number(/Content-Length: (\d+)/.exec(rest.subarray(0, end).toString())[1]);
        if (rest.length < end + 4 + length) return;
        const message = JSON.parse(rest.subarray(end + 4, end + 4 + length).toString());
        rest = rest.subarray(end + 4 + length);
        if (message.method === "textDocument/publishDiagnostics") marked.get(message.params.uri)?.(message.params.diagnostics);
        // A request of the server: it has no settings but those in the text.
        else if (message.method && message.id !== undefined) send({ id: message.id, result: (message.params?.items ?? []).map(() => null) });
        else if (message.id !== undefined) answers.get(message.id)?.(message.result);
    }
});

function send(message) {
    const text = JSON.stringify({ jsonrpc: "2.0", ...message });
    server.stdin.write(`Content-Length: ${Buffer.byteLength(text)}\r\n\r\n${text}`);
}

await new Promise((done) => {
    answers.set(1, done);
    send({ id: 1, method: "initialize", params: { processId: process.pid, rootUri: null, capabilities: {} } });
});
send({ method: "initialized", params: {} });
const found = [];
for (const [k, text] of texts.entries()) {
    const uri = `file://${folder}/${k}.yaml`;
    const diagnostics = await new Promise((done) => {
        marked.set(uri, done);
        const textDocument = { uri, languageId: "yaml", version: 1, text: `# yaml-language-server: $schema=${path}\n${text}` };
        send({ method: "textDocument/didOpen", params: { textDocument } });
    });
    found.push(diagnostics.length > 0);
    marked.delete(uri);
    send({ method: "textDocument/didClose", params: { textDocument: { uri } } });
}
server.kill();
rmSync(folder, { recursive: true, force: true });
console.log(JSON.stringify(found));
