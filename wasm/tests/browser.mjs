/** Headless Chromium, driven through the DevTools protocol: texts that end with a zero byte over two pipes. */

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const OPTIONS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--remote-debugging-pipe"];

/** How long anything may take on a processor that others use, ms. */
const LIMIT = 180_000;

export class Browser {
    constructor() {
        this.profile = mkdtempSync(join(tmpdir(), "chromium-"));
        this.child = spawn(process.env.CHROMIUM ?? "chromium", [...OPTIONS, `--user-data-dir=${this.profile}`, "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
        /** @type {Map<number, (message: any) => void>} */
        this.open = new Map();
        /** @type {any[]} */
        this.events = [];
        this.sent = 0;
        let rest = Buffer.alloc(0);
        /** @type {import("node:stream").Readable} */ (this.child.stdio[4]).on("data", (/** @type {Buffer} */ bytes) => {
            rest = Buffer.concat([rest, bytes]);
            for (let end = rest.indexOf(0); end >= 0; end = rest.indexOf(0)) {
                const message = JSON.parse(rest.subarray(0, end).toString());
                rest = rest.subarray(end + 1);
                if (message.id) this.open.get(message.id)?.(message);
                else this.events.push(message);
            }
        });
    }

    /** @param {string} method @param {any} params @param {string} [sessionId] @returns {Promise<any>} */
    call(method, params = {}, sessionId) {
        const id = ++this.sent;
        /** @type {import("node:stream").Writable} */ (this.child.stdio[3]).write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
        return new Promise((done, fail) => {
            const late = setTimeout(() => fail(new Error(`no answer: ${method}`)), LIMIT);
            this.open.set(id, ({ result, error }) => {
                clearTimeout(late);
                this.open.delete(id);
                if (error) fail(new Error(`${method}: ${error.message}`));
                else done(result);
            });
        });
    }

    /**
     * A page of a file on the disk. With `frames` its sandboxed frames wait for `frame()`.
     * @param {string} path @param {number} width
     */
    async page(path, width = 1280, frames = false) {
        const { targetId } = await this.call("Target.createTarget", { url: "about:blank" });
        const { sessionId } = await this.call("Target.attachToTarget", { targetId, flatten: true });
        const page = await new Page(this, sessionId).observed();
        if (frames) await page.call("Target.setAutoAttach", { autoAttach: true, waitForDebuggerOnStart: true, flatten: true, filter: [{ type: "iframe" }] });
        await page.call("Emulation.setDeviceMetricsOverride", { width, height: 900, deviceScaleFactor: 1, mobile: width < 600 });
        await page.call("Page.navigate", { url: `file://${path}` });
        return page;
    }

    /** A moment, while the browser works. */
    static pause() {
        return new Promise((done) => setTimeout(done, 20));
    }

    /** Ends the browser by its own means: killed, it leaves children that still write into its profile. */
    close() {
        this.child.on("exit", () => rmSync(this.profile, { recursive: true, force: true, maxRetries: 20 }));
        this.call("Browser.close").catch(() => this.child.kill());
    }
}

class Page {
    /** @param {Browser} browser @param {string} session */
    constructor(browser, session) {
        this.browser = browser;
        this.session = session;
    }

    /** @param {string} method @param {any} [params] */
    call(method, params) {
        return this.browser.call(method, params, this.session);
    }

    /** The page, with its messages and requests as events. */
    async observed() {
        for (const domain of ["Runtime", "Log", "Network", "Page"]) await this.call(`${domain}.enable`);
        return this;
    }

    /** The page in the first sandboxed frame, which has a session of its own. */
    async frame() {
        for (const end = Date.now() + LIMIT; Date.now() < end; await Browser.pause()) {
            const attached = this.browser.events.find(({ method, sessionId }) => sessionId === this.session && method === "Target.attachedToTarget");
            if (!attached) continue;
            const frame = await new Page(this.browser, attached.params.sessionId).observed();
            await frame.call("Runtime.runIfWaitingForDebugger");
            return frame;
        }
        throw new Error("no frame");
    }

    /** The value of an expression, after its promise. @param {string} expression */
    async run(expression) {
        const { result, exceptionDetails } = await this.call("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
        if (exceptionDetails) throw new Error(`${expression.slice(0, 200)}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
        return result.value;
    }

    /** Waits until an expression is true. @param {string} expression */
    async until(expression) {
        for (const end = Date.now() + LIMIT; Date.now() < end; ) {
            if (await this.run(expression).catch(() => false)) return;
            await Browser.pause();
        }
        throw new Error(`never: ${expression}\n${JSON.stringify(this.said())}`);
    }

    /** @param {string} path */
    async picture(path) {
        const { data } = await this.call("Page.captureScreenshot", { format: "png" });
        (await import("node:fs")).writeFileSync(path, Buffer.from(data, "base64"));
    }

    /** Console messages, exceptions, what the browser reports. */
    said() {
        const kinds = ["Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"];
        return this.browser.events.filter(({ method, sessionId }) => sessionId === this.session && kinds.includes(method)).map(({ params }) => JSON.stringify(params));
    }

    /** Requests, but for what is in the file itself. */
    asked() {
        const requests = this.browser.events.filter(({ method, sessionId }) => sessionId === this.session && method === "Network.requestWillBeSent");
        return requests.map(({ params }) => params.request.url).filter((url) => !/^(data|blob|about):/.test(url));
    }
}
