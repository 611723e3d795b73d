// The viewer: puts the parts together, and is what they change the view through.
import { Box3 } from "three";
import { tile_boxes } from "./boxes.js";
import { Clipping } from "./clipping.js";
import { modes } from "./colours.js";
import { bytes_text, grouped, make, number_text } from "./dom.js";
import { Help } from "./help.js";
import { listen_to_keys } from "./keys.js";
import { Labels } from "./labels.js";
import { Link } from "./link.js";
import { Loader, jobs_of } from "./loader.js";
import { Movement } from "./movement.js";
import { Axes, ScaleBar } from "./overlay.js";
import { Panel } from "./panel.js";
import { Pick } from "./pick.js";
import { Space } from "./space.js";
import { Stage } from "./stage.js";
import { Surface } from "./surface.js";
import { labels_by_file, Tileset } from "./tileset.js";

const $ = (id) => document.getElementById(id);

export class View {
  constructor(scene) {
    this.scene = scene;
    this.state = {
      status: "loading", tiles_loaded: 0, tiles_total: 0, bytes_loaded: 0, bytes_total: 0, triangles: 0, left_out: 0, errors: [],
    };
    this.space = new Space(scene);
    this.labels = new Labels(scene.labels);
    this.stage = new Stage($("stage"));
    this.surface = new Surface(this.labels, () => this.stage.draw());
    this.stage.world.add(this.surface.group);
    this.clipping = new Clipping(this.stage, this.surface, this.space, this.labels);
    this.clipping.closed = scene.border !== "open";
    this.movement = new Movement(this.stage, scene.frame?.space, () => this.changed());
    this.link = new Link(this);
    this.choose_modes();
    this.place();
    this.add_boxes();
    if (scene.tileset) this.add_tileset();
    this.add_overlay();
    this.first_view();
    listen_to_keys(this);
    this.load();
  }

  choose_modes() {
    const { scene } = this, has_labels = scene.labels.length > 0;
    const many = scene.tileset || scene.tiles.length > 1;
    const wanted = { label: has_labels, tile: many, level: many };
    this.modes = modes.filter(({ name }) => wanted[name] ?? true);
    this.first_mode = has_labels ? "label" : "plain";
    this.first_colour = this.surface.colour.getHexString();
    this.surface.mode = this.first_mode;
  }

  // The scene's middle comes to where the scene's coordinates begin.
  place() {
    const { group } = this.surface;
    group.matrix.copy(this.space.mesh_matrix());
    group.matrixAutoUpdate = false;
    group.updateMatrixWorld(true);
    this.stage.sphere.radius = 1.15 * this.space.radius();
    if (!this.space.box.isEmpty()) this.stage.points = this.space.corners();
    this.clipping.update();
  }

  add_boxes() {
    this.boxes = tile_boxes(this.scene.tiles);
    this.has_boxes = this.scene.tiles.length > 0;
    this.surface.group.add(this.boxes);
  }

  add_tileset() {
    const { scene, stage, surface, space, state } = this;
    const changed = () => this.progress();
    const labels = labels_by_file(scene.tiles ?? []);
    this.tileset = new Tileset({ path: scene.tileset, labels, stage, surface, space, state, changed });
    this.tileset.on_frame = () => {
      this.place();
      this.fit();
    };
    this.tileset.on_loaded = () => {
      const points = this.movement.touched ? [] : this.surface.sample();
      if (points.length === 0) return;
      this.stage.points = points;
      this.fit();
    };
  }

  add_overlay() {
    const { stage, space, surface, clipping } = this;
    new Axes($("axes"), stage, space);
    new ScaleBar($("scale"), stage, space, () => this.movement.target);
    this.pick = new Pick({ stage, surface, clipping, space, told: (found) => this.tell_point(found) });
    this.help = new Help($("help"));
    this.panel = new Panel($("panel"), this);
    $("panel-toggle").addEventListener("click", () => this.toggle_panel());
    this.set_margin();
    window.addEventListener("resize", () => this.set_margin());
    document.title = `${this.scene.name} – voxweld`;
    this.heading = make("p");
    $("title").append(make("h1", {}, this.scene.name), this.heading);
  }

  first_view() {
    if (!this.space.box.isEmpty()) this.movement.frame();
    this.link.restore();
  }

  async load() {
    if (this.tileset) return this.stage.draw();
    let jobs;
    try {
      jobs = jobs_of(this.scene);
    } catch (error) {
      return this.fail(error.message);
    }
    if (jobs.length === 0) return this.fail("There is no mesh to show: the surface is empty");
    this.loader = new Loader(this.state, (piece, job) => this.add_piece(piece, job), () => this.progress());
    const bounds = new Box3();
    this.loader.add = (piece, job) => {
      bounds.union(piece.geometry.boundingBox);
      this.add_piece(piece, job, bounds);
    };
    await this.loader.start(jobs);
    this.loaded(bounds);
  }

  // Unless the user has looked elsewhere.
  fit() {
    if (!this.movement.touched) this.movement.frame();
  }

  add_piece(piece, job, bounds) {
    if (this.scene.kind === "file") {
      this.space.set_box(bounds);
      this.place();
      this.fit();
    }
    this.surface.add(piece, { tile: job.tile, level: job.level, name: job.file.path });
  }

  // Now that it is known how large the mesh is, the view fits it and not the volume.
  loaded(bounds) {
    if (!bounds.isEmpty()) {
      this.stage.points = this.surface.sample();
      this.fit();
    }
    if (this.surface.levels[0] !== this.surface.levels[1]) this.surface.set({});
    this.clipping.changed();
    this.panel.show();
    if (this.state.left_out > 0) this.offer_rest();
  }

  offer_rest() {
    const note = this.note(`${grouped(this.state.left_out)} tiles are left out, since there are so many triangles. `, false, 0);
    note.append(make("button", { onclick: async () => {
      note.remove();
      await this.loader.go_on(Infinity);
      this.clipping.changed();
    } }, "Load the rest"));
  }

  // Once a picture, however many pieces of files have come.
  progress() {
    if (this.progress_wanted) return;
    this.progress_wanted = true;
    requestAnimationFrame(() => {
      this.progress_wanted = false;
      this.tell_progress();
    });
  }

  tell_progress() {
    const { state } = this, loading = state.status === "loading";
    $("progress").hidden = !loading;
    if (state.bytes_total > 0) $("progress-bar").style.width = `${(100 * state.bytes_loaded) / state.bytes_total}%`;
    const triangles = `${grouped(state.triangles)} triangles`;
    const tiles = `${grouped(state.tiles_loaded)} of ${grouped(state.tiles_total)} tiles`;
    const bytes = `${bytes_text(state.bytes_loaded)} of ${bytes_text(state.bytes_total)}`;
    if (this.tileset) this.heading.textContent = `${triangles} in sight${loading ? ", loading" : ""}`;
    else this.heading.textContent = loading ? `${triangles}, ${tiles}, ${bytes}` : triangles;
    while ((this.errors_told ??= 0) < state.errors.length) this.note(state.errors[this.errors_told++], true, 0);
    if (this.tileset) this.panel.show();
  }

  // What the user changes.

  changed() {
    this.link.changed();
    this.stage.draw();
  }

  shown() {
    this.panel?.show();
    this.changed();
  }

  set_mode(mode) {
    if (!this.modes.some(({ name }) => name === mode)) return;
    this.surface.set({ mode });
    this.clipping.changed();
    this.shown();
  }

  set_surface(values) {
    this.surface.set(values);
    this.shown();
  }

  set_boxes(yes) {
    this.boxes.visible = yes && this.has_boxes;
    this.shown();
  }

  set_cut(axis, values) {
    this.clipping.set(axis, values);
    this.shown();
  }

  set_caps(yes) {
    this.clipping.set_caps(yes);
    this.shown();
  }

  set_flying(yes) {
    this.movement.fly(yes);
    this.shown();
  }

  labels_found() {
    if (this.modes.some(({ name }) => name === "label")) return;
    this.modes = modes.filter(({ name }) => name === "label" || this.modes.some((mode) => mode.name === name));
    this.panel.modes_changed();
    this.set_mode((this.first_mode = "label"));
  }

  toggle_panel() {
    document.body.classList.toggle("bare");
    this.set_margin();
  }

  set_margin() {
    this.stage.set_margin(document.body.classList.contains("bare") ? 0 : $("panel").offsetWidth);
  }

  async save_picture() {
    const url = URL.createObjectURL(await this.stage.picture());
    make("a", { href: url, download: this.scene.name.replace(/\.[^.]*$/, "") + ".png" }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  }

  // What is told.

  tell_point(found) {
    const box = $("point");
    box.hidden = found === null;
    this.state.point = found;
    if (found === null) return;
    const place = (v) => v.toArray().map((x) => number_text(x)).join("  ");
    const unit = this.scene.unit ? ` ${this.scene.unit}` : "";
    const rows = [["Voxel", found.voxel && place(found.voxel)], ["World", found.world && place(found.world) + unit],
      ["Mesh", !found.world && place(found.mesh)], ["Tile", found.name]];
    if (found.pair) {
      const name = (label) => (label === null ? "outside" : this.labels.name(label));
      const { inside, outside } = found.pair;
      rows.push(["Label", outside === null ? name(inside) : `${name(inside)} | ${name(outside)}`]);
    }
    const lines = rows.filter(([, value]) => value).map(([name, value]) =>
      make("tr", {}, make("th", {}, name), make("td", {}, value)));
    box.replaceChildren(make("table", {}, ...lines),
      make("button", { title: "Close", onclick: () => this.pick.clear() }, "×"));
  }

  note(text, bad = false, seconds = 4) {
    const note = make("p", bad ? { class: "bad" } : {}, text);
    $("notes").append(note);
    if (seconds > 0) setTimeout(() => note.remove(), 1000 * seconds);
    return note;
  }

  fail(text) {
    this.state.status = "error";
    this.state.errors.push(text);
    this.tell_progress();
  }
}
