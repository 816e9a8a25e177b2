/**
 * In a narrow window the picture stays in sight, below the contents, while what acts on it is seen farther down: a row in focus, a run that is
 * followed, arms that are drawn as ghosts.
 */

import { byId } from "./dom.mjs";

/** The window that has one column. */
export const narrow = matchMedia("(max-width: 800px)");

/** The most that the picture takes of the window then: a part of its height, and px. */
const PART = 0.3;
const MOST = 256;

export class StickyPicture {
    constructor() {
        /** What acts on the picture, by its kind. @type {Map<string, Element>} */
        this.acting = new Map();
        this.main = document.querySelector("main");
        this.place = byId("picture-place");
        /** How high the contents are, which stay above it. */
        this.contents = 0;
        /** How high the picture is while it is kept, px; the style has it from here. */
        this.height = 0;
        const contents = /** @type {HTMLElement} */ (document.querySelector("nav"));
        new ResizeObserver(() => {
            this.contents = contents.offsetHeight;
            document.documentElement.style.setProperty("--contents", `${this.contents}px`);
        }).observe(contents);
        const update = () => this.update();
        addEventListener("scroll", update, { passive: true });
        this.measure();
        addEventListener("resize", () => {
            this.measure();
            this.set(false);
            update();
        });
        document.addEventListener("focusin", ({ target }) => this.keep("focus", target instanceof Element ? target.closest("#sheet, #singular") : null));
        document.addEventListener("focusout", () => this.keep("focus", null));
    }

    measure() {
        this.height = Math.min(PART * innerHeight, MOST);
        document.documentElement.style.setProperty("--picture", `${this.height}px`);
    }

    /** Keeps the picture while an element is seen that acts on it in this way; none: no longer. @param {string} kind @param {Element | null} element */
    keep(kind, element) {
        if (element) this.acting.set(kind, element);
        else this.acting.delete(kind);
        // What was pressed is not to be covered.
        if (this.update(true)) document.activeElement?.scrollIntoView({ block: "nearest" });
    }

    /** Whether it is kept from now on; what is `pressed` comes below it. @param {boolean} [pressed] */
    update(pressed = false) {
        const top = this.contents;
        const below = top + (pressed ? 0 : this.height);
        const seen = [...this.acting.values()].some((element) => {
            const box = element.getBoundingClientRect();
            return box.top < innerHeight && box.bottom > below;
        });
        const own = this.place.getBoundingClientRect();
        return this.set(narrow.matches && seen && own.bottom - own.height / 2 < top);
    }

    /** @param {boolean} kept */
    set(kept) {
        if (this.main?.classList.contains("kept") === kept) return false;
        // Its place stays as high as it was.
        this.place.style.minHeight = kept ? `${this.place.getBoundingClientRect().height}px` : "";
        this.main?.classList.toggle("kept", kept);
        return kept;
    }
}
