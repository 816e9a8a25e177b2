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
import { whereSingular } from "./singular.mjs";
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
// Measured postures are of joints whose mistakes are looked for one by one.
if (!data.links) check(data, state, picture);
workspace(data, state, picture);
postures(data, state, picture);
logs(data, state, picture);
state.move(home(data));
document.documentElement.dataset.ready = String(Math.round(performance.now()));
if (!data.equations) {
    addEventListener("message", heard);
    parent.postMessage({ drawn: true }, "*");
}

/** What only the second of two steps has. */
function rest() {
    linkEquations();
    equations(data, state, shown);
    cost();
}

/** The words of the window around the page: the second step, and the posture and view that pass from a page to the next. @param {MessageEvent} event */
function heard({ source, data: said }) {
    if (source !== parent) return;
    if (said.rest && !data.equations) later(said.rest);
    if (said.leave) parent.postMessage({ left: { joints: joints(), q: state.q, dq: state.dq, ddq: state.ddq, look: picture.look() } }, "*");
    if (said.resume) {
        resume(said.resume);
        parent.postMessage({ resumed: true }, "*");
    }
}

/** What makes the joints of another text the same joints. */
function joints() {
    return data.rows.map(({ name, type }) => `${type} ${name}`);
}

/** Where the reader was, if the arm has the same joints; limits may have changed. */
function resume({ joints: before, q, dq, ddq, look }) {
    if (String(before) !== String(joints())) return;
    Object.assign(state, { dq, ddq });
    state.move(q.map((x, i) => Math.min(Math.max(x, data.rows[i].limits?.[0] ?? -Infinity), data.rows[i].limits?.[1] ?? Infinity)));
    picture.lookAs(look);
}

/** The second step. */
function later(parts) {
    for (const name of ["equations", "cost"]) {
        const place = byId(name).querySelector("[data-later]");
        if (place) place.outerHTML = parts[name];
    }
    data.equations = parts.data;
    data.determinant = parts.determinant;
    byId("singular-where").replaceChildren(...whereSingular(data));
    rest();
    state.changed("motion");
    document.documentElement.dataset.whole = String(Math.round(performance.now()));
}
