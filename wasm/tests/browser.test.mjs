/**
 * The playground in Chromium, opened from the disk. With ARMGEN_CORPUS, a folder of URDFs and MuJoCo models, also files of strangers, as many
 * as ARMGEN_FILES says.
 */

import assert from "node:assert/strict";
import { readdirSync, readFileSync, statSync } from "node:fs";
import { basename, join } from "node:path";
import test, { after, before } from "node:test";
import { Browser } from "./browser.mjs";
import { difference, LANGUAGES, module, run, sorted } from "./program.mjs";

const FILE = process.env.ARMGEN_PLAYGROUND ?? "";
const repository = (path) => readFileSync(new URL(`../../${path}`, import.meta.url), "utf8");
/** @type {Browser} */
let browser;
before(() => (browser = new Browser()));
after(() => browser.close());

/** A page that has judged its first text. */
async function opened(hash = "", width = 1280) {
    const page = await browser.page(FILE + hash, width);
    await page.until("document.documentElement.dataset.ready");
    return page;
}

/** Nothing was said and nothing asked for. */
function quiet(page) {
    assert.deepEqual(page.said(), []);
    assert.equal(page.asked().length, 1, page.asked().join(" "));
}

const put = (text, name) => `playground.setText(${JSON.stringify(text)}, ${JSON.stringify(name)})`;
const faults = "[...document.querySelectorAll('#faults li[data-code]')].map((item) => [item.dataset.code, item.dataset.line, item.dataset.column])";

test("the file is small", () => {
    assert.ok(statSync(FILE).size <= 2_000_000, `${statSync(FILE).size} bytes`);
});

test("an arm is drawn, and its equations follow", async () => {
    const page = await opened();
    await page.until("document.documentElement.dataset.whole");
    assert.match(await page.run("document.querySelector('#verdict').textContent"), /^valid/);
    assert.equal(await page.run("document.querySelector('iframe#page').srcdoc.includes('<title>scara</title>')"), true);
    assert.match(await page.run("document.querySelector('#summary').textContent"), /robot +scara/);
    quiet(page);
});

test("the second step brings the factors that all minors share", async () => {
    const page = await opened();
    await page.run(put(repository("tests/data/iiwa14.yaml"), "iiwa14.yaml"));
    await page.run("document.querySelector('#link').click()");
    await page.until("location.hash.length > 1");
    const other = await opened(await page.run("location.hash"));
    await other.until("document.documentElement.dataset.whole");
    await other.call("Target.setAutoAttach", { autoAttach: true, waitForDebuggerOnStart: false, flatten: true, filter: [{ type: "iframe" }] });
    const frame = await other.frame();
    assert.match(await frame.run("document.querySelector('#singular-where').textContent"), /^Singular wherever q₄ = 0/);
});

test("a fault is underlined at its place, its remedy put in by a click", async () => {
    const page = await opened();
    const text = repository("robots/scara.yaml");
    const faulty = text.replace("gravity:", "gravty:");
    await page.run(`(() => { const field = document.querySelector("#text"); field.value = ${JSON.stringify(faulty)}; field.dispatchEvent(new Event("input", { bubbles: true })); })()`);
    await page.until("document.querySelector('#faults li[data-code=unknown-key]')");
    const line = faulty.split("\n").findIndex((line) => line.startsWith("gravty")) + 1;
    assert.deepEqual((await page.run(faults)).find(([code]) => code === "unknown-key"), ["unknown-key", String(line), "1"]);
    assert.deepEqual(await page.run("[...document.querySelectorAll('#layer mark.error')].map((mark) => mark.textContent)[0]"), "gravty");
    // Over the word: the layer and the field have the same text at the same place.
    assert.equal(await page.run("document.querySelector('#layer').textContent.trimEnd() === document.querySelector('#text').value.trimEnd()"), true);
    await page.run("document.querySelector('button[data-remedy=gravity]').click()");
    await page.until("document.querySelector('#verdict').textContent.startsWith('valid')");
    assert.equal(await page.run("playground.text"), text);
    quiet(page);
});

test("an arm of a URDF with several tips is chosen by a button", async () => {
    const page = await opened();
    // A finger that follows itself: the remedy is to lock it.
    const fingers = repository("import/tests/bad/several-tips-fingers.urdf");
    const text = fingers.replace('<mimic joint="j2"/>', "").replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><mimic joint="j2"/>');
    await page.run(put(text, "arm.urdf"));
    await page.until("document.querySelector('#faults li[data-code=several-tips] button[data-tip]')");
    const tip = await page.run("document.querySelector('button[data-tip]').dataset.tip");
    await page.run("document.querySelector('button[data-tip]').click()");
    await page.until("document.querySelector('button[data-lock=j2]')");
    await page.run("document.querySelector('button[data-lock]').click()");
    await page.until("document.querySelector('#yaml').textContent !== ''");
    const { files } = run("arm.urdf", text, ["import", "arm.urdf", "--tip", tip, "--lock", "j2=0", "--out", "out/robot.yaml", "--report", "out/report.json"]);
    assert.deepEqual(Object.fromEntries(files), await page.run("({ 'robot.yaml': document.querySelector('#yaml').textContent, 'report.json': document.querySelector('#json').textContent })"));
    quiet(page);
});

test("all branches of a URDF are taken by a button", async () => {
    const page = await opened();
    const text = repository("import/tests/bad/several-tips-fingers.urdf");
    await page.run(put(text, "arm.urdf"));
    await page.until("document.querySelector('button[data-all]')");
    await page.run("document.querySelector('button[data-all]').click()");
    await page.until("document.querySelector('#yaml').textContent !== ''");
    const { files } = run("arm.urdf", text, ["import", "arm.urdf", "--all", "--out", "out/robot.yaml"]);
    assert.equal(await page.run("document.querySelector('#yaml').textContent"), Object.fromEntries(files)["robot.yaml"]);
    quiet(page);
});

test("every pane shows what the program writes", async () => {
    const page = await opened();
    const own = { name: "scara.yaml", text: repository("robots/scara.yaml") };
    await page.run("document.querySelector('[data-pane=equations]').click()");
    await page.until("document.querySelector('#equation').textContent !== ''");
    assert.equal(await page.run("document.querySelector('#equation').textContent"), run(own.name, own.text, ["show", own.name, "inertia_matrix"]).printed);
    await page.run("document.querySelector('[data-pane=code]').click()");
    for (const language of Object.keys(LANGUAGES)) {
        await page.run(`(() => { const select = document.querySelector("#language"); select.value = "${language}"; select.dispatchEvent(new Event("input")); })()`);
        const [[name, text]] = module(own.name, own.text, language, ["rust", "c", "cuda"].includes(language));
        await page.until(`document.querySelector("#file-name").value.startsWith(${JSON.stringify(name.split(".")[0].split("/")[0])}) && [...document.querySelector("#file-name").options].some(({ value }) => value === ${JSON.stringify(name)})`);
        await page.run(`(() => { const select = document.querySelector("#file-name"); select.value = ${JSON.stringify(name)}; select.dispatchEvent(new Event("input")); })()`);
        assert.equal(await page.run("document.querySelector('#code').textContent"), text, language);
    }
    assert.ok((await page.run("playground.archive().then((archive) => archive.size)")) > 300_000);
    quiet(page);
});

test("an edit keeps posture and view where the joints stay the same", async () => {
    const page = await opened();
    await page.until("document.documentElement.dataset.whole");
    const tell = (words, answer) => `new Promise((done) => {
        const frame = document.querySelector("iframe#page").contentWindow;
        addEventListener("message", ({ source, data }) => source === frame && data.${answer} && done(data.${answer}));
        frame.postMessage(${words}, "*");
    })`;
    const left = async () => {
        const { q, look } = await page.run(tell("{ leave: true }", "left"));
        return [q[0], look.azimuth];
    };
    const first = await page.run(tell("{ leave: true }", "left"));
    assert.deepEqual([first.q[0], first.look.name], [0, "oblique"]);
    const moved = { ...first, q: [0.5, ...first.q.slice(1)], look: { ...first.look, name: "", azimuth: 0.25 } };
    await page.run(tell(`{ resume: ${JSON.stringify(moved)} }`, "resumed"));
    const text = repository("robots/scara.yaml");
    const shows = (name) => page.until(`document.querySelector("iframe#page")?.srcdoc.includes("<title>${name}</title>")`);
    await page.run(put(text.replace(/^name: .*/m, "name: other"), "robot.yaml"));
    await shows("other");
    assert.deepEqual(await left(), [0.5, 0.25]);
    // Another arm begins where every arm begins.
    await page.run(put(repository("robots/ur5.yaml"), "ur5.yaml"));
    await shows("ur5");
    assert.deepEqual(await left(), [0, first.look.azimuth]);
    quiet(page);
});

test("a link carries a text", async () => {
    const page = await opened();
    await page.run(put("name: ü\n", "ü.yaml"));
    await page.run("document.querySelector('#link').click()");
    await page.until("location.hash.length > 1");
    const other = await opened(await page.run("location.hash"));
    assert.deepEqual(await other.run("[playground.text, document.querySelector('#name').textContent]"), ["name: ü\n", "ü.yaml"]);
    quiet(other);
});

test("markup in a text stays text", async () => {
    const page = await opened();
    const hostile = `name: "</script><img src=x onerror=hacked=1>"\n"</textarea><script>hacked=1</script>": 1\n`;
    await page.run(put(hostile, "<img src=x onerror=hacked=1>.yaml"));
    await page.until("document.querySelectorAll('#faults li').length > 0");
    assert.deepEqual(await page.run("[typeof hacked, document.images.length]"), ["undefined", 0]);
    quiet(page);
});

test("a long text and what is no robot are judged", async () => {
    const page = await opened();
    for (const text of ["", "x".repeat(256 << 10), `${"a: 1\n".repeat(50_000)}`, "<robot>", "<mujoco/>", "{".repeat(100_000)]) {
        const before = await page.run("document.querySelector('#verdict').textContent = ''");
        await page.run(put(text, "a.yaml"));
        await page.until(`document.querySelector('#verdict').textContent !== ${JSON.stringify(before)}`);
        assert.match(await page.run("document.querySelector('#verdict').textContent"), /^\d+ errors?/, text.slice(0, 20));
        if (text.startsWith("a: 1")) {
            assert.deepEqual(await page.run("[document.querySelector('#verdict').textContent, document.querySelector('[data-more]').textContent]"), ["50001 errors", "and 49501 more: mend these first"]);
        }
    }
    quiet(page);
});

test("nothing is wider than a telephone", async () => {
    const page = await opened("", 390);
    await page.until("document.documentElement.dataset.page");
    for (const pane of ["page", "equations", "code", "report"]) {
        await page.run(`document.querySelector('[data-pane=${pane}]').click()`);
        assert.ok((await page.run("document.documentElement.scrollWidth")) <= 390, pane);
    }
    quiet(page);
});

const corpus = process.env.ARMGEN_CORPUS;
test("files of strangers give the descriptions and the code of the program", { skip: corpus ? false : "no ARMGEN_CORPUS" }, async (t) => {
    const all = readdirSync(corpus ?? "", { recursive: true }).map((path) => join(corpus ?? "", String(path))).filter((path) => /\.(urdf|xml)$/.test(path)).sort();
    const wanted = Number(process.env.ARMGEN_FILES ?? 100);
    const page = await opened();
    const counts = { descriptions: 0, refused: 0, modules: 0 };
    // In an order that mixes their origins, until there are enough arms.
    const mixed = all.map((path, k) => ({ path, at: (k * 0.618034) % 1 })).sort((a, b) => a.at - b.at);
    for (const { path } of mixed) {
        if (counts.descriptions === wanted) break;
        const [name, text] = [basename(path), readFileSync(path, "utf8").replaceAll("\r\n", "\n")];
        const imported = (tip) => run(name, text, ["import", name, "--massless", ...(tip ? ["--tip", tip] : []), "--out", "out/robot.yaml"]);
        let [result, tip] = [imported(null), null];
        if (result.said.includes("[several-tips]")) {
            tip = result.said.match(/choose one: `--tip ([^`]+)`/)?.[1] ?? null;
            result = imported(tip);
        }
        const { yaml } = await page.run(`playground.ask("import", ${JSON.stringify({ name, text, tip, massless: true })})`);
        assert.equal(yaml ?? undefined, result.files[0]?.[1], path);
        if (!yaml) {
            counts.refused++;
            continue;
        }
        const language = Object.keys(LANGUAGES)[counts.descriptions++ % 6];
        const code = await page.run(`playground.ask("code", ${JSON.stringify({ name: "robot.yaml", text: yaml, language, functions: [] })})`);
        if (!code.files) continue;
        const ik = code.note === null && ["rust", "c", "cuda"].includes(language);
        assert.equal(difference(sorted(code.files), module("robot.yaml", yaml, language, ik)), null, path);
        counts.modules++;
    }
    t.diagnostic(JSON.stringify(counts));
    quiet(page);
});
