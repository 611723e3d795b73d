// The labels of the scene: their names, colours, and which are seen.
import { Color } from "three";
import { label_colour } from "./colours.js";

export class Labels {
  constructor(rows) {
    this.rows = new Map(); // label -> {label, name, colour, triangles, bounds}
    this.hidden = new Set();
    for (const row of rows) this.rows.set(row.label, { ...row, colour: new Color(...row.colour) });
    this.listed = this.rows.size > 0;
    this.on_found = () => {};
  }

  get size() {
    return this.rows.size;
  }

  // Those that no list names, of a file by itself.
  found(piece) {
    if (this.listed) return;
    let any = false;
    for (const { inside, outside } of piece.pairs)
      for (const label of [inside, outside]) {
        if (label === null || this.rows.has(label)) continue;
        this.rows.set(label, { label, name: "", colour: label_colour(label), triangles: null, bounds: null });
        any = true;
      }
    if (any) this.on_found();
  }

  sorted() {
    return [...this.rows.values()].sort((a, b) => (BigInt(a.label) < BigInt(b.label) ? -1 : 1));
  }

  visible(label) {
    return !this.hidden.has(label);
  }

  colour(label) {
    return this.rows.get(label)?.colour ?? label_colour(label);
  }

  name(label) {
    const name = this.rows.get(label)?.name;
    return name ? `${label} ${name}` : label;
  }

  show(label, yes) {
    if (yes) this.hidden.delete(label);
    else this.hidden.add(label);
  }

  show_all(yes) {
    this.hidden = new Set(yes ? [] : this.rows.keys());
  }

  show_only(label) {
    this.show_all(false);
    this.hidden.delete(label);
  }
}
