/** Other postures at the pose that is shown, listed, and drawn as ghosts while the list is open. */

import { byId, html } from "./dom.mjs";
import { inUnit, short, tidy, unitName, variable } from "./format.mjs";
import { Arm } from "./scene.mjs";
import { alike, MOST, posturesAt } from "./search.mjs";

/** How long the arm rests before postures are searched for, ms. */
const REST = 150;

/** @param {any} data @param {import("./state.mjs").State} state @param {import("./picture.mjs").Picture} picture */
export function postures(data, state, picture) {
    const [details, said, list, held] = ["postures", "postures-said", "postures-found", "postures-held"].map(byId);
    const joints = data.rows.length;
    const spare = joints - data.task.length;
    if (spare > 1) {
        said.textContent = `The arm has ${spare} joints more than a pose needs: postures at a pose are no list.`;
        return;
    }
    if (spare === 1) {
        byId("postures-held-label").hidden = false;
        data.rows.forEach((row, i) => held.append(html("option", { value: i }, `${variable(i + 1)} ${row.name}`)));
        held.value = String(joints - 1);
    }
    const holding = () => (spare === 1 ? Number(held.value) : null);
    /** What was found: the pose, and its postures. @type {{pose: number[][], found: number[][], arms: Arm[]} | null} */
    let at = null;
    /** The posture of the list under the pointer or in focus. */
    let lit = -1;
    const near = (a, b, scale) => Math.abs(a - b) < 1e-9 * scale;
    const isShown = (q) => alike(data.rows, q, state.q, picture.arm.size, 1e-9);
    picture.ghosts.push(() => {
        if (!at || !details.open) return [];
        return at.arms.flatMap((arm, k) => {
            const q = at?.found[k] ?? [];
            if (isShown(q)) return [];
            arm.place(q, robot.linkFrames(q), robot.directKinematics(q));
            for (const { element } of arm.solids) element.classList.toggle("lit", k === lit);
            return [arm];
        });
    });
    const light = (k) => {
        if (lit === k) return;
        lit = k;
        picture.redraw();
    };
    const table = () => {
        if (!at) return;
        const unit = (i) => (data.rows[i].type === "revolute" ? "rad" : "m");
        const columns = ["", ...data.rows.map((row, i) => `${variable(i + 1)} ${row.name}, ${unitName(unit(i))}`), ""];
        const head = html("tr", {}, ...columns.map((column) => html(column ? "th" : "td", column ? { scope: "col" } : {}, column)));
        const rows = at.found.map((q, k) => {
            const outside = data.rows.map((row, i) => (row.limits && (q[i] < row.limits[0] || q[i] > row.limits[1]) ? variable(i + 1) : "")).filter((name) => name);
            const take = html("button", { type: "button", "aria-label": `take posture ${k + 1}` }, "take");
            take.addEventListener("click", () => state.move(q));
            const remark = isShown(q) ? "shown" : outside.length > 0 ? `⚠ outside its limits: ${outside.join(", ")}` : "";
            const cells = q.map((x, i) => html("td", { class: "entry" }, short(inUnit(x, unit(i)))));
            const row = html("tr", { "data-posture": k + 1 }, html("th", { scope: "row" }, String(k + 1)), ...cells, html("td", {}, take, ` ${remark}`));
            for (const event of ["pointerenter", "focusin"]) row.addEventListener(event, () => light(k));
            for (const event of ["pointerleave", "focusout"]) row.addEventListener(event, () => light(-1));
            return row;
        });
        const focused = document.activeElement?.closest("[data-posture]")?.getAttribute("data-posture");
        const found = html("table", {}, html("thead", {}, head), html("tbody", {}, ...rows));
        list.replaceChildren(html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Postures at this pose" }, found));
        if (focused) list.querySelector(`[data-posture="${focused}"] button`)?.focus();
    };
    const find = () => {
        if (!details.open) return;
        const found = posturesAt(robot, data.rows, data.task, state.q, holding(), picture.arm.size)?.map((q) => q.map(tidy)) ?? null;
        at = found ? { pose: robot.directKinematics(state.q), found, arms: found.map(() => new Arm(data, "ghost posture")) } : null;
        lit = -1;
        const beside = spare === 1 ? ` with ${variable(Number(held.value) + 1)} held` : "";
        const searched = "Found by a search, which can miss some; what armgen generate --ik writes says whether all are there.";
        if (!found) {
            said.textContent = `More than ${MOST} postures${beside}: here some joints can move while the end effector stays. Move the arm out of its singular posture.`;
            list.replaceChildren();
        } else {
            said.textContent = found.length === 1 ? `No other posture was found${beside}. ${searched}` : `${found.length} postures${beside}, pale in the picture. ${searched}`;
            table();
        }
        picture.sticky.keep("postures", found && found.length > 1 ? details : null);
        picture.redraw();
    };
    let waiting = 0;
    const forget = () => {
        at = null;
        list.replaceChildren();
        said.textContent = "";
        if (!details.open) picture.sticky.keep("postures", null);
        picture.redraw();
    };
    state.on("motion", () => {
        if (!details.open) return;
        const pose = robot.directKinematics(state.q);
        const rests = at?.pose.slice(0, 3).every((row, i) => row.every((x, j) => near(x, pose[i][j], j === 3 ? picture.arm.size : 1)));
        if (rests) return table();
        if (at) forget();
        clearTimeout(waiting);
        waiting = window.setTimeout(find, REST);
    });
    details.addEventListener("toggle", () => (details.open ? find() : forget()));
    held.addEventListener("input", find);
    state.on("units", table);
}
