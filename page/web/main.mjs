/** The page: reads its data, makes its parts, draws for the first time. */

import { check } from "./check.mjs";
import { cost } from "./cost.mjs";
import { byId } from "./dom.mjs";
import { equations } from "./equations.mjs";
import { freeFall } from "./free_fall.mjs";
import { logs } from "./logs.mjs";
import { lostMotion } from "./lost_motion.mjs";
import { linkEquations, numbers } from "./numbers.mjs";
import { Picture } from "./picture.mjs";
import { postures } from "./postures.mjs";
import { settings } from "./settings.mjs";
import { sheet } from "./sheet.mjs";
import { player, sliders } from "./sliders.mjs";
import { home, State } from "./state.mjs";
import { workspace } from "./workspace.mjs";

const data = JSON.parse(byId("data").textContent);
const state = new State(data.rows.length);
settings(state);
sliders(data, state);
player(data, state);
const picture = new Picture(data, state);
freeFall(data, state, picture);
sheet(data, state, picture);
const shown = numbers(data, state, picture.arm);
lostMotion(data, state, picture);
if (data.equations) rest();
check(data, state, picture);
workspace(data, state, picture);
postures(data, state, picture);
logs(data, state, picture);
state.move(home(data));
document.documentElement.dataset.ready = String(Math.round(performance.now()));
if (!data.equations) {
    addEventListener("message", later);
    parent.postMessage({ drawn: true }, "*");
}

/** What only the second of two steps has. */
function rest() {
    linkEquations();
    equations(data, state, shown);
    cost();
}

/** The second step, from the window around the page. @param {MessageEvent} event */
function later({ source, data: parts }) {
    if (source !== parent || !parts.rest) return;
    removeEventListener("message", later);
    for (const name of ["equations", "cost"]) {
        const place = byId(name).querySelector("[data-later]");
        if (place) place.outerHTML = parts.rest[name];
    }
    data.equations = parts.rest.data;
    rest();
    state.changed("motion");
    document.documentElement.dataset.whole = String(Math.round(performance.now()));
}
