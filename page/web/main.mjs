/** The page: reads its data, makes its parts, draws for the first time. */

import { check } from "./check.mjs";
import { cost } from "./cost.mjs";
import { byId } from "./dom.mjs";
import { equations } from "./equations.mjs";
import { freeFall } from "./free_fall.mjs";
import { logs } from "./logs.mjs";
import { lostMotion } from "./lost_motion.mjs";
import { numbers } from "./numbers.mjs";
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
equations(data, state, numbers(data, state, picture.arm));
lostMotion(data, state, picture);
cost();
check(data, state, picture);
workspace(data, state, picture);
postures(data, state, picture);
logs(data, state, picture);
state.move(home(data));
document.documentElement.dataset.ready = String(Math.round(performance.now()));
