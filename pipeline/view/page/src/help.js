// What the keys and the mouse do.
import { make } from "./dom.js";

const keys = [
  ["Drag", "turn"], ["Right drag", "shift"], ["Wheel", "nearer, farther"], ["Click", "place, tile and label"],
  ["W A S D", "move"], ["Q E", "down, up"], ["Shift", "move faster"], ["V", "fly: drag to look around"],
  ["R", "first view"], ["F", "fit all"], ["1 – 5", "colour"], ["L", "triangles as lines"],
  ["T", "flat triangles"], ["B", "boxes of tiles"], ["X Y Z", "cut along an axis"], ["C", "fill what is cut"],
  ["P", "save a picture"], ["H", "panel"], ["?", "this help"], ["Esc", "close, forget the point"],
];

export class Help {
  constructor(dialog) {
    this.dialog = dialog;
    const rows = keys.flatMap(([key, what]) => [
      make("dt", {}, ...key.split(" ").map((k) => (k.length < 6 && k !== "–" ? make("kbd", {}, k) : k)).flatMap((k) => [k, " "])),
      make("dd", {}, what),
    ]);
    dialog.append(
      make("h2", {}, "Keys"), make("dl", {}, ...rows),
      make("p", { class: "quiet" }, "Back sides are red: a closed surface shows none. The address of the page keeps the view."),
      make("p", { class: "quiet" }, make("a", { href: "licences.txt", target: "_blank" }, "Licences"), " of what this page is made of"),
      make("form", { method: "dialog" }, make("button", { autofocus: true }, "Close")),
    );
    dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  }

  toggle() {
    if (this.dialog.open) this.dialog.close();
    else this.dialog.showModal();
  }
}
