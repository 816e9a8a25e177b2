// What would stop a reader who sees little, uses no pointer, or listens: a list of faults.
(() => {
    const faults = [];
    const say = (element, what) => faults.push(`${what}: ${element.outerHTML.slice(0, 120)}`);
    const visible = (element) => element.checkVisibility({ visibilityProperty: true });
    const all = (selector) => [...document.querySelectorAll(selector)];
    const text = (element) => (element?.textContent ?? "").replace(/\s+/g, " ").trim();

    // Names: of every control, of pictures, regions and tables; a name holds the text that is seen.
    const named = (element) => {
        const by = element.getAttribute("aria-labelledby");
        if (by) return by.split(" ").map((id) => text(document.getElementById(id))).join(" ").trim();
        const labels = [...(element.labels ?? [])].map(text).join(" ");
        const content = ["BUTTON", "A", "SUMMARY"].includes(element.tagName) ? text(element) : "";
        return element.getAttribute("aria-label") || labels || content || element.getAttribute("alt") || text(element.querySelector(":scope > title, :scope > caption"));
    };
    for (const element of all("button, input, select, textarea, a[href], summary, img, svg[role], canvas, table:not([role=presentation]), [role=region], [role=group], section, nav")) {
        if (!visible(element)) continue;
        const name = named(element);
        if (!name && !(element.tagName === "TABLE" && element.closest("[role=region][aria-label]"))) say(element, "no name");
        if (element.tagName === "BUTTON" && !name.includes(text(element))) say(element, "the name is another than the text");
    }
    for (const fieldset of all("fieldset")) if (!text(fieldset.querySelector("legend"))) say(fieldset, "no legend");
    for (const th of all("table:not([role=presentation]) th")) if (!["row", "col", "rowgroup", "colgroup"].includes(th.scope)) say(th, "no scope");
    const ids = all("[id]").map((element) => element.id);
    for (const id of new Set(ids.filter((id, i) => ids.indexOf(id) !== i))) faults.push(`two elements are #${id}`);
    for (const attribute of ["for", "aria-labelledby", "aria-describedby"]) {
        for (const element of all(`[${attribute}]`)) {
            for (const id of element.getAttribute(attribute).split(" ")) if (!document.getElementById(id)) say(element, `${attribute} names nothing`);
        }
    }
    all("h1, h2, h3, h4").reduce((before, heading) => {
        const level = Number(heading.tagName[1]);
        if (level > before + 1) say(heading, "a level of headings is left out");
        return level;
    }, 0);
    if (!document.documentElement.lang || !document.title) faults.push("no language, or no title");

    // Contrast of every text with what it stands on.
    const channels = (colour) => colour.match(/[\d.]+/g).map(Number);
    const light = ([r, g, b]) => {
        const linear = [r, g, b].map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
    };
    const ground = (element) => {
        for (let at = element; at; at = at.parentElement) {
            const colour = channels(getComputedStyle(at).backgroundColor);
            if ((colour[3] ?? 1) === 1) return colour;
            if (colour[3] > 0) say(at, "a ground that is seen through is not judged");
        }
        return [255, 255, 255];
    };
    const seen = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    let least = Infinity;
    while (walker.nextNode()) {
        const element = walker.currentNode.parentElement;
        if (!walker.currentNode.data.trim() || seen.has(element) || !visible(element) || element.closest("script, style, title, desc")) continue;
        seen.add(element);
        const style = getComputedStyle(element);
        const ink = channels(element.closest("svg") ? style.fill : style.color);
        const [a, b] = [light(ink), light(ground(element))].sort((x, y) => y - x);
        const ratio = (a + 0.05) / (b + 0.05);
        least = Math.min(least, ratio);
        if (ratio < 4.5) say(element, `contrast ${ratio.toFixed(2)}`);
    }
    return { faults: faults.slice(0, 12), texts: seen.size, least: Number(least.toFixed(2)) };
})()
