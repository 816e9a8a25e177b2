/** The table of costs: sorted by a click, with bars. */

/** Makes the table sortable. @param {HTMLTableElement} table */
function sortable(table) {
    const body = table.tBodies[0];
    const heads = [...(table.tHead?.rows[0].cells ?? [])];
    heads.forEach((head, column) => {
        head.querySelector("button")?.addEventListener("click", () => {
            const down = head.getAttribute("aria-sort") === "descending";
            for (const other of heads) other.removeAttribute("aria-sort");
            head.setAttribute("aria-sort", down ? "ascending" : "descending");
            const key = (row) => row.cells[column].getAttribute("data-value") ?? row.cells[column].textContent;
            const rows = [...body.rows].sort((a, b) => {
                const [x, y] = [key(a), key(b)];
                const order = Number.isNaN(Number(x)) ? String(x).localeCompare(String(y)) : Number(x) - Number(y);
                return down ? order : -order;
            });
            body.replaceChildren(...rows);
        });
    });
}

export function cost() {
    const table = /** @type {HTMLTableElement | null} */ (document.querySelector("#cost table"));
    if (!table) return;
    sortable(table);
    const weights = [.../** @type {NodeListOf<HTMLElement>} */ (table.querySelectorAll("[data-value]"))];
    const largest = Math.max(...weights.map((cell) => Number(cell.dataset.value)));
    for (const cell of weights) {
        /** @type {HTMLElement} */ (cell.lastElementChild).style.width = `${Math.max(1, (100 * Number(cell.dataset.value)) / (largest || 1))}%`;
    }
}
