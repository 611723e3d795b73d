// The list of labels: only the rows in sight are in the page, since there may be thousands.
import { css } from "./colours.js";
import { grouped, make, row } from "./dom.js";

const row_height = 24;

export class LabelList {
  // changed(): what is seen has changed.
  constructor(labels, changed) {
    Object.assign(this, { labels, changed });
    this.search = make("input", { type: "search", placeholder: "Number or name", oninput: () => this.filter() });
    this.search.setAttribute("aria-label", "Search labels");
    this.box = make("div", { id: "labels", onscroll: () => this.draw() });
    this.told = make("span", { class: "quiet grow" });
    const all = (yes) => () => {
      labels.show_all(yes);
      this.apply();
    };
    this.elements = [
      this.search,
      row(this.told, make("button", { onclick: all(true) }, "All"), make("button", { onclick: all(false) }, "None")),
      this.box,
    ];
    this.filter();
  }

  filter() {
    const words = this.search.value.trim().toLowerCase();
    this.rows = this.labels.sorted().filter(({ label, name }) =>
      words === "" || label.startsWith(words) || name.toLowerCase().includes(words));
    this.box.style.height = `${Math.min(280, Math.max(1, this.rows.length) * row_height)}px`;
    this.draw();
  }

  apply() {
    this.draw();
    this.changed();
  }

  draw() {
    const { labels, rows, box } = this;
    const hidden = labels.hidden.size;
    this.told.textContent = `${grouped(labels.size - hidden)} of ${grouped(labels.size)} shown`;
    const first = Math.max(0, Math.floor(box.scrollTop / row_height) - 4);
    const last = Math.min(rows.length, first + Math.ceil((box.clientHeight || 280) / row_height) + 8);
    const space = make("div");
    space.style.height = `${rows.length * row_height}px`;
    box.replaceChildren(space, ...rows.slice(first, last).map((label, i) => this.row_of(label, first + i)));
  }

  row_of({ label, name, colour, triangles }, number) {
    const { labels } = this, seen = labels.visible(label);
    const swatch = make("span", { class: "swatch" });
    swatch.style.background = css(colour);
    const check = make("input", { type: "checkbox", checked: seen, onchange: () => {
      labels.show(label, check.checked);
      this.apply();
    } });
    check.setAttribute("aria-label", `Label ${label}`);
    const only = make("button", { class: "only", title: "Shows this label alone", onclick: () => {
      labels.show_only(label);
      this.apply();
    } }, "only");
    const element = make("div", { class: seen ? "label" : "label off" }, check, swatch,
      make("span", { class: "name", title: name || label }, name ? `${label} ${name}` : label), only,
      make("span", { class: "count" }, triangles === null ? "" : grouped(triangles)));
    element.style.top = `${number * row_height}px`;
    return element;
  }
}
