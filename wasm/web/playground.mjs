/** The playground: a text on one side, on the other what armgen makes of it. */

import { byId, copy, download, html, withCode } from "./elements.mjs";
import { Editor } from "./editor.mjs";
import { Engine } from "./engine.mjs";
import { fileOf, linkOf } from "./link.mjs";
import { locks, meant, takesAll, tips } from "./places.mjs";
import { zip } from "./zip.mjs";

/** How long nobody types before a text is judged, ms. */
const PAUSE = 150;

/** So many faults are listed and underlined: a browser needs seconds for ten thousands. */
const MANY = 500;

const packed = byId("packed");
const engine = new Engine(byId("worker").textContent, { text: packed.textContent, length: Number(packed.dataset.length) });
packed.remove();
const examples = JSON.parse(byId("robots").textContent);
const nonce = byId("own").nonce;
const editor = new Editor(byId("text"), byId("layer"), byId("gutter"));
const root = document.documentElement;

/** The file: its name and the choices of an import. */
const file = { name: "robot.yaml", tip: /** @type {string | null} */ (null), all: false, lock: /** @type {[string, string][]} */ ([]) };
/** The description that the text is or becomes; null while it is faulty. @type {{name: string, text: string} | null} */
let description = null;
/** What counts texts: an answer to an older one is nobody's. */
let version = 0;
/** What each pane shows, by the version that it was made for. @type {Record<string, number>} */
const made = {};
let pane = "page";

/** A request about the description. @param {string} about @param {any} more */
const ask = (about, more = {}) => engine.ask({ about, ...description, ...more });

/** Judges the text, then renews what is seen. */
async function judge() {
    const own = ++version;
    engine.drop();
    const text = editor.text;
    const isModel = text.trimStart().startsWith("<");
    byId("of-import").hidden = !isModel;
    const choices = { tip: file.tip, all: file.all, lock: file.lock, massless: byId("massless").checked, inertia_as_written: byId("as-written").checked };
    const answer = await engine.ask({ about: isModel ? "import" : "check", name: file.name, text, ...choices });
    if (own !== version || !answer) return;
    const judged = isModel ? (answer.file ?? {}) : answer;
    const diagnostics = judged.diagnostics ?? [];
    editor.mark(diagnostics.slice(0, MANY));
    const valid = isModel ? answer.yaml : answer.valid;
    description = valid ? (isModel ? { name: "robot.yaml", text: answer.yaml } : { name: file.name, text }) : null;
    listFaults(diagnostics, answer.fault);
    verdict(diagnostics, answer.fault);
    report(isModel ? answer : null);
    root.dataset.ready ??= String(Math.round(performance.now()));
    if (!description) return stale(true);
    stale(false);
    renew();
}

/** @param {import("./places.mjs").Diagnostic[]} diagnostics @param {string | undefined} fault */
function verdict(diagnostics, fault) {
    const count = (severity) => diagnostics.filter((diagnostic) => diagnostic.severity === severity).length;
    const counted = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
    const [errors, warnings] = [count("error"), count("warning")];
    const words = errors > 0 ? counted(errors, "error") : "valid";
    const element = byId("verdict");
    element.textContent = fault ? "armgen stopped" : warnings > 0 ? `${words}, ${counted(warnings, "warning")}` : words;
    element.className = fault || errors > 0 ? "error" : warnings > 0 ? "warning" : "fine";
}

/** @param {import("./places.mjs").Diagnostic[]} diagnostics @param {string | undefined} fault */
function listFaults(diagnostics, fault) {
    const items = diagnostics.slice(0, MANY).map((diagnostic) => {
        const { code, severity, line, column, message, help, labels } = diagnostic;
        const place = html("button", { type: "button", class: "place" }, `line ${line}`);
        place.addEventListener("click", () => editor.show(diagnostic));
        const label = labels[0]?.text ? ` (${labels[0].text})` : "";
        const others = labels.slice(1).map(({ line, text }) => html("li", {}, `line ${line}: `, ...withCode(text ?? "")));
        const item = html(
            "li",
            { "data-code": code, "data-line": line, "data-column": column, class: severity },
            html("p", {}, place, " ", html("b", {}, severity), " ", ...withCode(message), ...withCode(label)),
            ...(others.length > 0 ? [html("ul", {}, ...others)] : []),
            html("p", { class: "help" }, ...withCode(help)),
        );
        const word = meant(diagnostic);
        if (word !== null && labels.length > 0) {
            const button = html("button", { type: "button", "data-remedy": word }, "write ", html("code", {}, word));
            button.addEventListener("click", () => editor.replace(diagnostic, word));
            item.append(button);
        }
        const choice = (words, attribute, choose) => {
            const button = html("button", { type: "button", ...attribute }, words);
            button.addEventListener("click", () => {
                choose();
                judge();
            });
            return button;
        };
        if (code === "several-tips") {
            const buttons = tips(diagnostic).map((tip) => choice(tip, { "data-tip": tip }, () => (file.tip = tip)));
            const all = takesAll(diagnostic) ? [", or ", choice("take all branches", { "data-all": "" }, () => (file.all = true))] : [];
            item.append(html("p", { class: "tips" }, "take the arm that ends in ", ...buttons, ...all));
        } else {
            const buttons = locks(diagnostic).map(([joint, value]) => choice(`lock ${joint} at ${value}`, { "data-lock": joint }, () => file.lock.push([joint, value])));
            item.append(...buttons);
        }
        return item;
    });
    const more = diagnostics.length - items.length;
    if (more > 0) items.push(html("li", { "data-more": more }, `and ${more} more: mend these first`));
    if (fault) items.unshift(html("li", { class: "error" }, html("p", {}, fault)));
    byId("faults").replaceChildren(...items);
    followCaret();
}

/** Marks the fault at the caret. */
function followCaret() {
    const at = editor.atCaret();
    [...byId("faults").children].forEach((item, k) => item.toggleAttribute("data-here", k === at));
}

/** Panes of a text that is faulty keep what they had, and say so. @param {boolean} is */
function stale(is) {
    byId("panes").classList.toggle("stale", is);
    byId("stale").hidden = !is || pane === "report";
    byId("stale").textContent = Object.keys(made).length > 0 ? "The text has errors. This is of the last valid text." : "The text has errors. Mend them first.";
    if (is) byId("summary").textContent = "";
}

/** Makes what is seen: the pane, the summary, and what the page still lacks. */
async function renew() {
    await makers[pane]();
    await summary();
    if (pane === "page") await rest();
}

async function summary() {
    if (isMade("summary") || !description) return;
    const own = version;
    const answer = await ask("summary");
    if (own !== version || !answer) return;
    made.summary = own;
    // Its first line is the verdict, its last paragraph is about the program.
    const parts = (answer.text ?? answer.fault ?? "").split("\n\n");
    byId("summary").textContent = parts.slice(1, -1).join("\n\n");
}

/** The equations and costs of the page. */
async function rest() {
    const frame = document.querySelector("iframe#page");
    if (isMade("rest") || !isMade("page") || !(frame instanceof HTMLIFrameElement)) return;
    const own = version;
    const answer = await ask("rest");
    if (own !== version || !answer?.rest) return;
    made.rest = own;
    frame.contentWindow?.postMessage({ rest: answer.rest }, "*");
    root.dataset.whole ??= String(Math.round(performance.now()));
}

/** Whether a pane is of this text. @param {string} name */
const isMade = (name) => made[name] === version;

const makers = {
    async page() {
        if (isMade("page") || !description) return;
        const own = version;
        const answer = await ask("picture", { nonce });
        if (own !== version || !answer?.page) return shown("page-said", answer);
        byId("page-said").textContent = "";
        made.page = own;
        const frame = html("iframe", { sandbox: "allow-scripts allow-modals", title: "The arm", class: "coming" });
        frame.srcdoc = answer.page;
        const before = document.querySelector("iframe#page");
        byId("frames").append(frame);
        await heard(frame, "drawn");
        // An edit keeps the posture and the view, where the joints stay the same.
        const left = before instanceof HTMLIFrameElement ? await asked(before, { leave: true }, "left") : null;
        if (left) await asked(frame, { resume: left }, "resumed");
        if (own !== version) return frame.remove();
        for (const other of [...byId("frames").children]) if (other !== frame) other.remove();
        frame.className = "";
        frame.id = "page";
        root.dataset.page ??= String(Math.round(performance.now()));
    },
    async equations() {
        if (!description) return;
        await listFunctions();
        const own = version;
        const quantity = byId("quantity").value;
        const key = JSON.stringify([own, quantity, byId("symbolic").checked]);
        if (byId("equation").dataset.key === key) return;
        byId("equation-said").textContent = "being derived …";
        const answer = await ask("show", { quantity, symbolic: byId("symbolic").checked });
        if (own !== version || !answer) return;
        byId("equation-said").textContent = answer.fault ?? "";
        byId("equation").textContent = answer.text ?? "";
        byId("equation").dataset.key = key;
        byId("copy-latex").hidden = !answer.latex;
        latex = answer.latex ?? "";
        made.equations = own;
    },
    async code() {
        if (!description) return;
        await listFunctions();
        const own = version;
        const [language, only] = [byId("language").value, byId("only").value];
        const key = JSON.stringify([own, language, only]);
        if (byId("code").dataset.key === key) return;
        byId("code-said").textContent = "being generated …";
        const answer = await ask("code", { language, functions: only ? [only] : [] });
        if (own !== version || !answer) return;
        byId("code-said").textContent = answer.fault ?? answer.note ?? "";
        files = answer.files ?? [];
        const names = files.map(([name]) => html("option", {}, name));
        byId("file-name").replaceChildren(...names);
        byId("code").dataset.key = key;
        showFile();
        made.code = own;
    },
    // The report comes with the judgement.
    async report() {},
};
let latex = "";
/** The files of the language that is shown. @type {[string, string][]} */
let files = [];

/** An answer that is none, in words. @param {string} id @param {any} answer */
function shown(id, answer) {
    if (!answer) return;
    const said = answer.fault ?? answer.file?.diagnostics?.filter(({ severity }) => severity === "error").map(({ message, help }) => `${message}; ${help}`).join("\n");
    byId(id).textContent = said || "there is no page of this arm";
}

/** What a frame says under a word. @param {HTMLIFrameElement} frame @param {string} word @returns {Promise<any>} */
function heard(frame, word) {
    return new Promise((done) => {
        const listen = ({ source, data }) => {
            if (source !== frame.contentWindow || !data[word]) return;
            removeEventListener("message", listen);
            done(data[word]);
        };
        addEventListener("message", listen);
    });
}

/** The answer of a frame, or null from one that is too slow. @param {HTMLIFrameElement} frame @param {any} words @param {string} word */
function asked(frame, words, word) {
    frame.contentWindow?.postMessage(words, "*");
    return Promise.race([heard(frame, word), new Promise((late) => setTimeout(late, 1000, null))]);
}

function showFile() {
    const [, text] = files.find(([name]) => name === byId("file-name").value) ?? ["", ""];
    byId("code").textContent = text;
}

/** The functions that the arm has, for the choices of both panes. */
async function listFunctions() {
    if (isMade("functions")) return;
    const own = version;
    const answer = await ask("functions");
    if (own !== version || !answer?.functions) return;
    made.functions = own;
    const there = answer.functions.filter(({ missing }) => missing === null);
    const options = (all) => all.map(({ name, title }) => html("option", { value: name, title }, name));
    const keep = (select, all) => {
        const before = select.value;
        select.replaceChildren(...all);
        if ([...select.options].some(({ value }) => value === before)) select.value = before;
    };
    const others = [html("option", {}, "determinant"), html("option", {}, "inverse_kinematics")];
    const first = byId("quantity").options.length === 0;
    keep(byId("quantity"), [...options(there), ...others]);
    if (first && there.some(({ name }) => name === "inertia_matrix")) byId("quantity").value = "inertia_matrix";
    keep(byId("only"), [html("option", { value: "" }, "all functions"), ...options(there)]);
}

/** The pane of an import. @param {any} answer */
function report(answer) {
    byId("no-import").hidden = answer !== null;
    byId("imported").hidden = !answer?.yaml;
    byId("import-refused").hidden = answer === null || Boolean(answer.yaml);
    byId("lines").replaceChildren(...(answer?.lines ?? []).map((line) => html("li", {}, ...withCode(line))));
    byId("yaml").textContent = answer?.yaml ?? "";
    byId("json").textContent = answer?.report ?? "";
}

/** Takes a file in. @param {string} name @param {string} text */
function take(name, text) {
    file.name = name;
    file.tip = null;
    file.all = false;
    file.lock = [];
    byId("name").textContent = name;
    editor.text = text.replace(/^\ufeff/, "");
    byId("text").setSelectionRange(0, 0);
    document.querySelector(".editor")?.scrollTo(0, 0);
    judge();
}

/** @param {File | undefined} taken */
async function read(taken) {
    if (!taken) return;
    if (taken.size > 8 << 20) {
        byId("verdict").textContent = `${taken.name} is longer than 8 MiB`;
        byId("verdict").className = "error";
        return;
    }
    history.replaceState(null, "", "#");
    take(taken.name, await taken.text());
}

/** Shows a pane. @param {string} name */
function open(name) {
    pane = name;
    for (const tab of document.querySelectorAll("[role=tab]")) {
        const own = tab.getAttribute("data-pane") === name;
        tab.setAttribute("aria-selected", String(own));
        tab.setAttribute("tabindex", own ? "0" : "-1");
        byId(`pane-${tab.getAttribute("data-pane")}`).hidden = !own;
    }
    stale(description === null && version > 0);
    renew();
}

const tabs = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[role=tab]")]);
tabs.forEach((tab, k) => {
    tab.addEventListener("click", () => open(tab.dataset.pane ?? "page"));
    tab.addEventListener("keydown", ({ key }) => {
        const next = { ArrowRight: k + 1, ArrowLeft: k - 1, Home: 0, End: tabs.length - 1 }[key];
        if (next === undefined) return;
        const other = tabs[(next + tabs.length) % tabs.length];
        other.focus();
        other.click();
    });
});

let timer = 0;
byId("text").addEventListener("input", () => {
    clearTimeout(timer);
    timer = setTimeout(judge, PAUSE);
});
for (const kind of ["keyup", "click", "focus"]) byId("text").addEventListener(kind, followCaret);
for (const id of ["massless", "as-written"]) byId(id).addEventListener("input", judge);
byId("file").addEventListener("change", ({ target }) => read(target.files[0]).then(() => (target.value = "")));
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
    const dropped = event.dataTransfer?.files[0];
    if (!dropped) return;
    event.preventDefault();
    read(dropped);
});
byId("examples").append(...Object.keys(examples).map((name) => html("option", {}, name)));
byId("examples").addEventListener("input", ({ target }) => {
    history.replaceState(null, "", "#");
    take(`${target.value}.yaml`, examples[target.value]);
    target.value = "";
});
for (const id of ["quantity", "symbolic"]) byId(id).addEventListener("input", () => makers.equations());
for (const id of ["language", "only"]) byId(id).addEventListener("input", () => makers.code());
byId("file-name").addEventListener("input", showFile);
byId("copy-latex").addEventListener("click", ({ target }) => copy(target, latex));
byId("copy-equation").addEventListener("click", ({ target }) => copy(target, byId("equation").textContent));
byId("copy-code").addEventListener("click", ({ target }) => copy(target, byId("code").textContent));
byId("download").addEventListener("click", () => {
    const name = byId("file-name").value;
    download(name.split("/").at(-1) ?? name, new Blob([byId("code").textContent], { type: "text/plain" }));
});
byId("zip").addEventListener("click", async () => {
    if (description) download("robot.zip", await archive());
});
byId("edit-yaml").addEventListener("click", () => {
    if (description) take(description.name, description.text);
});
byId("download-yaml").addEventListener("click", () => description && download("robot.yaml", new Blob([description.text], { type: "text/yaml" })));
byId("link").addEventListener("click", async ({ target }) => {
    const hash = await linkOf(file.name, editor.text);
    history.replaceState(null, "", `#${hash}`);
    copy(target, location.href);
});

/** All files of all languages, each language in its folder, and the description. */
async function archive() {
    const own = version;
    const all = [[description?.name ?? "robot.yaml", description?.text ?? ""]];
    for (const { value: language } of byId("language").options) {
        byId("code-said").textContent = `being generated: ${language}`;
        const answer = await ask("code", { language, functions: [] });
        if (own !== version || !answer) break;
        all.push(...(answer.files ?? []).map(([name, text]) => [`${language}/${name}`, text]));
    }
    byId("code-said").textContent = "";
    return zip(/** @type {[string, string][]} */ (all));
}

/** The file of the address, or the first example. */
async function begin() {
    const linked = await fileOf(location.hash.slice(1));
    const first = Object.keys(examples)[0];
    if (linked) take(linked.name, linked.text);
    else take(`${first}.yaml`, examples[first]);
}
addEventListener("hashchange", begin);
open("page");
begin();

/** For scripts and tests. */
Object.defineProperty(globalThis, "playground", {
    value: Object.freeze({
        get text() {
            return editor.text;
        },
        setText: (text, name = "robot.yaml") => take(name, text),
        ask: (about, more) => engine.ask({ about, ...more }),
        archive,
    }),
});
