// The panel at the side: everything that can be set, and the figures of the run.
import { bytes_text, grouped, make, number_text, row, section, slider_of, switch_of } from "./dom.js";
import { LabelList } from "./label_list.js";
import { sides } from "./movement.js";

const axis_names = ["x", "y", "z"];

export class Panel {
  constructor(element, view) {
    this.view = view;
    this.shows = []; // each shows the state of its element
    element.append(
      this.look(), this.cut(), this.camera(), ...(view.tileset ? [this.tiles()] : []), ...this.labels(), this.facts(),
    );
  }

  show() {
    for (const show of this.shows) show();
  }

  switch_for(text, key, get, set) {
    const made = switch_of(text, key, set);
    this.shows.push(() => made.set(get()));
    return made.element;
  }

  look() {
    const { view } = this, { surface } = view;
    const choice = make("select", { onchange: () => view.set_mode(choice.value) });
    choice.setAttribute("aria-label", "Colour by");
    this.modes_changed = () =>
      choice.replaceChildren(...view.modes.map(({ name, title }) => make("option", { value: name }, title)));
    this.modes_changed();
    const colour = make("input", { type: "color", title: "Colour of the surface", oninput: () => {
      surface.colour.set(colour.value);
      surface.set({});
      view.changed();
    } });
    this.shows.push(() => {
      choice.value = surface.mode;
      colour.value = "#" + surface.colour.getHexString();
      colour.hidden = surface.mode !== "plain";
    });
    return section("Surface",
      row(make("span", { class: "quiet" }, "Colour"), make("div", { class: "grow" }, choice), colour),
      this.switch_for("Triangles as lines", "L", () => surface.wireframe, (on) => view.set_surface({ wireframe: on })),
      this.switch_for("Flat triangles", "T", () => surface.flat, (on) => view.set_surface({ flat: on })),
      view.has_boxes
        ? this.switch_for("Boxes of tiles", "B", () => view.boxes.visible, (on) => view.set_boxes(on))
        : null);
  }

  cut() {
    const { view } = this, { clipping } = view;
    const rows = axis_names.map((name, k) => {
      const box = make("input", { type: "checkbox", onchange: () => view.set_cut(k, { on: box.checked }) });
      box.setAttribute("aria-label", `Cut along ${name}`);
      const slider = slider_of({ min: 0, max: 1, step: 0.001, title: `Where ${name} is cut`, changed: (at) =>
        view.set_cut(k, { at, on: true }) });
      const flip = make("button", { title: "Keeps the other side", onclick: () =>
        view.set_cut(k, { flipped: !clipping.axes[k].flipped, on: true }) }, "⇄");
      const value = make("span", { class: "value" });
      this.shows.push(() => {
        const axis = clipping.axes[k];
        box.checked = axis.on;
        if (document.activeElement !== slider) slider.value = axis.at;
        value.textContent = view.space.box.isEmpty() ? "" : number_text(clipping.place(k));
      });
      return row(make("label", { class: "switch", style: "flex: none" }, box, name), make("div", { class: "grow" }, slider), value, flip);
    });
    return section("Cut", ...rows,
      this.switch_for("Fill what is cut", "C", () => clipping.caps, (on) => view.set_caps(on)));
  }

  tiles() {
    const { tileset } = this.view;
    const error = make("span", { class: "value" }), cap = make("span", { class: "value" });
    const errors = slider_of({ min: 0, max: 6, step: 0.5, title: "Error in pixels", changed: (power) => {
      tileset.set_error(2 ** power);
      this.show();
    } });
    const caps = slider_of({ min: 7, max: 13, step: 1, title: "Memory for tiles", changed: (power) => {
      tileset.set_cap(2 ** power);
      this.show();
    } });
    const used = make("p", { class: "quiet" });
    const full = make("p", { class: "quiet" }, "The memory is full: what is in sight is coarser than asked for.");
    this.shows.push(() => {
      errors.value = Math.log2(tileset.error);
      caps.value = Math.log2(tileset.cap);
      error.textContent = `${number_text(tileset.error)} px`;
      cap.textContent = `${tileset.cap} MiB`;
      const { cached_bytes = 0, tiles_loaded, tiles_total } = this.view.state;
      used.textContent =
        `${tiles_total} ${tiles_total === 1 ? "tile" : "tiles"} in sight, ${tiles_loaded} loaded, ${bytes_text(cached_bytes)} in memory`;
      full.hidden = !tileset.full;
    });
    return section("Tileset",
      row(make("span", { class: "quiet" }, "Error"), make("div", { class: "grow" }, errors), error),
      row(make("span", { class: "quiet" }, "Memory"), make("div", { class: "grow" }, caps), cap), used, full);
  }

  labels() {
    const { view } = this;
    const list = new LabelList(view.labels, () => {
      view.surface.labels_changed();
      view.clipping.changed();
      view.changed();
    });
    const part = section("Labels", ...list.elements);
    const show = () => (part.hidden = view.labels.size === 0);
    view.labels.on_found = () => {
      list.filter();
      show();
      view.labels_found();
    };
    this.shows.push(() => {
      show();
      list.draw();
    });
    return [part];
  }

  camera() {
    const { view } = this;
    const buttons = Object.entries(sides).map(([name, side]) =>
      make("button", { onclick: () => view.movement.frame(side) }, name));
    const copy = make("button", { title: "Copies a link to this view", onclick: async () => {
      view.link.write();
      try {
        await navigator.clipboard.writeText(location.href);
        view.note("The link is copied");
      } catch {
        view.note("The address of this page is the link");
      }
    } }, "Link");
    return section("View",
      make("div", { class: "buttons" }, ...buttons),
      this.switch_for("Fly", "V", () => view.movement.flying, (on) => view.set_flying(on)),
      make("div", { class: "buttons" },
        make("button", { title: "The first view (R)", onclick: () => view.movement.reset() }, "Reset"),
        make("button", { title: "Saves a picture (P)", onclick: () => view.save_picture() }, "Picture"), copy),
      row(make("button", { class: "grow", title: "Keys and help (?)", onclick: () => view.help.toggle() }, "Keys and help")));
  }

  facts() {
    const { scene } = this.view, facts = [];
    const add = (name, value) => value !== "" && value != null && facts.push(make("dt", {}, name), make("dd", {}, String(value)));
    const unit = scene.unit || "";
    if (scene.frame) add("Samples", scene.frame.size.join(" × "));
    if (scene.frame) add("Spacing", `${[...new Set(scene.frame.spacing.map(number_text))].join(" × ")} ${unit}`);
    if (scene.counts) {
      add("Triangles", grouped(scene.counts.triangles));
      add("Vertices", grouped(scene.counts.vertices));
      add("Tiles", grouped(scene.counts.tiles));
      if (scene.counts.labels > 0) add("Labels", grouped(scene.counts.labels));
      add("Files", bytes_text(scene.counts.bytes));
    }
    if (scene.error) add("Tolerance", `${number_text(scene.error.tolerance)} ${scene.error.unit}`);
    if (scene.error) add("Error reached", `${number_text(scene.error.reached)} ${scene.error.unit}`);
    if (scene.refine?.intersecting_left !== undefined) add("Crossings left", grouped(scene.refine.intersecting_left));
    if (scene.made) add("Made", scene.made.replace("T", " ").replace("Z", " UTC"));
    if (scene.file) add("File", bytes_text(scene.file.bytes));
    const report = scene.report
      ? make("p", {}, make("a", { href: "data/" + scene.report, target: "_blank" }, "Report of the run"))
      : null;
    return section("Figures", make("dl", { class: "facts" }, ...facts), report);
  }
}
