// Tables that sort by any column and show long lists in portions.

import { element } from "./element.js";
import { count } from "./format.js";

const PORTION = 100;

export class SortedTable {
  /**
   * `columns`: {name, title, value(row) to sort by, show(row) as nodes or text, numeric}.
   * `options`: {rows, sort (column's name), descending, caption, onRow(row), keyOf(row)}.
   */
  constructor(columns, options) {
    Object.assign(this, { columns, options });
    this.sort = options.sort;
    this.descending = options.descending ?? false;
    this.shown = PORTION;
    this.filter = () => true;
    this.selected = null;
    this.heads = columns.map((column) => this.#head(column));
    this.body = element("tbody");
    this.more = element("button", { type: "button", class: "more", onclick: () => this.#showMore() });
    const table = element("table", {}, element("caption", { class: "unseen" }, options.caption),
      element("thead", {}, element("tr", {}, this.heads)), this.body);
    this.root = element("div", { class: "table" }, element("div", { class: "scroll" }, table), this.more);
    this.setRows(options.rows);
  }

  setRows(rows) {
    this.rows = rows;
    this.shown = PORTION;
    this.#fill();
  }

  setFilter(filter) {
    this.filter = filter;
    this.#fill();
  }

  /** Marks a row and makes sure that it stands in the table. */
  select(key) {
    this.selected = key;
    const at = this.#sorted().findIndex((row) => this.options.keyOf(row) === key);
    if (at >= this.shown) this.shown = Math.ceil((at + 1) / PORTION) * PORTION;
    this.#fill();
  }

  #head(column) {
    const sort = () => {
      this.descending = this.sort === column.name ? !this.descending : Boolean(column.numeric);
      this.sort = column.name;
      this.#fill();
    };
    return element("th", { scope: "col", class: column.numeric ? "number" : null },
      element("button", { type: "button", title: column.title, onclick: sort }, column.name));
  }

  #sorted() {
    const { value } = this.columns.find((column) => column.name === this.sort);
    const sign = this.descending ? -1 : 1;
    const compare = (a, b) => {
      if (a === b) return 0;
      if (a === null || a === undefined) return sign;  // what is unknown stands last
      if (b === null || b === undefined) return -sign;
      return a < b ? -1 : 1;
    };
    return this.rows.filter(this.filter)
      .map((row, i) => [value(row), i, row])
      .sort((a, b) => sign * compare(a[0], b[0]) || a[1] - b[1])
      .map(([, , row]) => row);
  }

  #fill() {
    this.columns.forEach((column, i) => {
      const order = this.descending ? "descending" : "ascending";
      if (column.name === this.sort) this.heads[i].setAttribute("aria-sort", order);
      else this.heads[i].removeAttribute("aria-sort");
    });
    const rows = this.#sorted();
    this.body.replaceChildren(...rows.slice(0, this.shown).map((row) => this.#row(row)));
    const left = rows.length - this.shown;
    this.more.hidden = left <= 0;
    this.more.textContent = `Show ${count(Math.min(left, PORTION * 5))} more of ${count(rows.length)}`;
  }

  #row(row) {
    const { keyOf, onRow } = this.options;
    const key = keyOf(row);
    const cells = this.columns.map((column) =>
      element("td", { class: column.numeric ? "number" : null }, column.show(row)));
    return element("tr", {
      "data-key": key,
      "aria-selected": onRow ? String(key === this.selected) : null,
      tabindex: onRow ? 0 : null,
      onclick: () => onRow?.(row),
      onkeydown: (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        onRow?.(row);
      },
    }, cells);
  }

  #showMore() {
    this.shown += PORTION * 5;
    this.#fill();
  }
}
