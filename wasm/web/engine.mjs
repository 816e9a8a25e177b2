/** The worker with the generator. Requests wait here, and one at a time is with the worker. */

/** How long a request may keep a newer text waiting, ms. */
const PATIENCE = 2000;

/** @typedef {{request: any, done: (answer: any) => void}} Asked */

export class Engine {
    /** @param {string} script the text of the worker @param {{text: string, length: number}} packed the packed module */
    constructor(script, packed) {
        this.address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
        /** @type {Asked[]} */
        this.waiting = [];
        /** @type {Asked | null} */
        this.running = null;
        /** @type {WebAssembly.Module | null} */
        this.module = null;
        this.start().postMessage({ packed });
    }

    start() {
        const worker = new Worker(this.address);
        worker.onmessage = ({ data }) => {
            if (data.module) this.module = data.module;
            else {
                this.running?.done(data.answer);
                this.running = null;
                clearTimeout(this.timer);
            }
            this.go();
        };
        this.worker = worker;
        return worker;
    }

    go() {
        if (this.running || !this.module) return;
        this.running = this.waiting.shift() ?? null;
        if (this.running) this.worker?.postMessage({ request: this.running.request });
    }

    /** The answer to a request; null where it was given up. @param {any} request @returns {Promise<any>} */
    ask(request) {
        return new Promise((done) => {
            this.waiting.push({ request, done });
            this.go();
        });
    }

    /** Gives up what waits, and what runs if it runs on for long. */
    drop() {
        for (const { done } of this.waiting.splice(0)) done(null);
        const running = this.running;
        if (!running) return;
        clearTimeout(this.timer);
        this.timer = setTimeout(() => {
            if (this.running !== running) return;
            running.done(null);
            this.running = null;
            this.worker?.terminate();
            this.start().postMessage({ module: this.module });
            this.go();
        }, PATIENCE);
    }
}
