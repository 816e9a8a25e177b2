// The controls that Tab must reach, in the order of the document: marks each that gets the focus, with whether that is seen.
(() => {
    const controls = [...document.querySelectorAll("button, input, select, textarea, a[href], summary, [tabindex]")].filter(
        (element) => element.checkVisibility({ visibilityProperty: true }) && !element.disabled && !(element.type === "radio" && !element.checked),
    );
    globalThis.visited = [];
    document.addEventListener("focusin", () => {
        const element = document.activeElement;
        const style = getComputedStyle(element);
        globalThis.visited.push([controls.indexOf(element), style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2, element.outerHTML.slice(0, 100)]);
    });
    globalThis.wanted = controls;
    return controls.length;
})()
