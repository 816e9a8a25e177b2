/**
 * The HTML that nbconvert makes of a notebook, in Chromium from the disk: the page of the robot in it becomes ready, without a message
 * or a request. node notebook.mjs FILE [PICTURE]
 */

import assert from "node:assert/strict";
import { resolve } from "node:path";

import { Browser } from "../../wasm/tests/browser.mjs";

const [file, picture] = process.argv.slice(2);
const browser = new Browser();
try {
    const page = await browser.page(resolve(file), 1280, true);
    const robot = await page.frame();
    await robot.until("document.documentElement.dataset.ready > 0");
    assert.equal(await robot.run("document.title"), await page.run("document.querySelector('iframe').title"));
    if (picture) {
        await page.run("document.querySelector('iframe').scrollIntoView()");
        await new Promise((done) => setTimeout(done, 1000)); // until it is drawn there
        await page.picture(picture);
    }
    assert.deepEqual([...page.said(), ...robot.said()], []);
    assert.deepEqual([...page.asked(), ...robot.asked()].filter((url) => !url.startsWith("file:")), []);
} finally {
    browser.close();
}
