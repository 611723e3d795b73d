// All pieces that are shown: their meshes, how they are coloured, and which labels are seen.
import { BufferAttribute, Color, Group, Mesh, Vector3 } from "three";
import { level_colour, plain_colour, tile_colour } from "./colours.js";
import { line_material, normal_material, surface_material } from "./materials.js";
import { show_pairs } from "./pieces.js";

const byte = (value) => Math.round(255 * Math.min(1, Math.max(0, value)));

export class Surface {
  // labels: a Labels; changed(): something is to be drawn again.
  constructor(labels, changed) {
    this.labels = labels;
    this.changed = changed;
    this.group = new Group(); // of meshes in the coordinates of the files
    this.items = new Set();
    this.mode = "plain";
    this.colour = new Color(plain_colour);
    this.flat = false;
    this.wireframe = false;
    this.planes = [];
    this.levels = [Infinity, -Infinity];
    this.on_added = () => {}; // or has come into sight
    this.on_removed = () => {};
    this.materials = { normal: normal_material(), flat_normal: normal_material(), lines: line_material() };
    this.materials.flat_normal.flatShading = true;
  }

  // about: {tile: number, level (the more the coarser), name, parent}. Returns the item, which remove() takes.
  add(piece, about) {
    const pairs = piece.ids !== null;
    const mesh = new Mesh(piece.geometry);
    const lines = new Mesh(piece.geometry, this.materials.lines);
    lines.raycast = () => {};
    mesh.add(lines);
    const item = { piece, about, mesh, lines, material: surface_material({ pairs }) };
    mesh.userData.item = item;
    if (pairs) this.add_colours(piece.geometry);
    if (piece.pairs) this.labels.found(piece);
    const [lowest, highest] = this.levels;
    this.levels = [Math.min(lowest, about.level), Math.max(highest, about.level)];
    if (this.mode === "level" && (about.level < lowest || about.level > highest))
      for (const other of this.items) this.dress(other);
    (about.parent ?? this.group).add(mesh);
    this.items.add(item);
    this.show(item);
    this.dress(item);
    this.on_added(item);
    this.changed();
    return item;
  }

  add_colours(geometry) {
    const count = geometry.attributes.position.count;
    for (const name of ["color", "back_color"])
      geometry.setAttribute(name, new BufferAttribute(new Uint8Array(4 * count).fill(255), 4, true));
  }

  remove(item) {
    item.mesh.removeFromParent();
    item.piece.geometry.dispose();
    item.material.dispose();
    this.items.delete(item);
    this.on_removed(item);
    this.changed();
  }

  get triangles() {
    let sum = 0;
    for (const item of this.items) sum += item.piece.triangles;
    return sum;
  }

  // Some of the vertices, in the scene: enough to see how far the mesh reaches. Of a tileset's tiles those in sight:
  // the others stand nowhere.
  sample(most = 20000) {
    const shown = [...this.items].filter(({ about }) => about.parent === undefined || about.parent.parent);
    let total = 0;
    for (const { piece } of shown) total += piece.geometry.attributes.position.count;
    const step = Math.ceil(total / most), points = [];
    for (const { piece, mesh } of shown) {
      const position = piece.geometry.attributes.position;
      mesh.updateWorldMatrix(true, false);
      for (let i = 0; i < position.count; i += step)
        points.push(new Vector3().fromBufferAttribute(position, i).applyMatrix4(mesh.matrixWorld));
    }
    return points;
  }

  set(values) {
    Object.assign(this, values);
    for (const item of this.items) this.dress(item);
    this.changed();
  }

  set_planes(planes) {
    this.planes = planes;
    const { normal, flat_normal, lines } = this.materials;
    for (const material of [normal, flat_normal, lines]) material.clippingPlanes = planes;
    for (const item of this.items) item.material.clippingPlanes = planes;
    this.changed();
  }

  // Which labels are seen, or their colours, have changed.
  labels_changed() {
    for (const item of this.items) {
      this.show(item);
      this.dress(item);
    }
    this.changed();
  }

  show(item) {
    const seen = (label) => label !== null && this.labels.visible(label);
    show_pairs(item.piece, (pair) =>
      (pair.inside === null && pair.outside === null) || seen(pair.inside) || seen(pair.outside));
    const range = item.piece.geometry.drawRange;
    item.mesh.visible = range.count > 0;
  }

  dress(item) {
    const { mesh, lines, material, piece } = item;
    const flat = this.flat || !piece.has_normals;
    if (this.mode === "normal") {
      mesh.material = flat ? this.materials.flat_normal : this.materials.normal;
    } else {
      mesh.material = material;
      if (material.flatShading !== flat) {
        material.flatShading = flat;
        material.needsUpdate = true;
      }
    }
    for (const each of [material, this.materials.normal, this.materials.flat_normal]) {
      each.clippingPlanes = this.planes;
      each.polygonOffset = this.wireframe;
    }
    lines.visible = this.wireframe;
    if (this.mode === "label" && piece.ids !== null) {
      material.color.set(0xffffff);
      this.paint(piece);
    } else {
      material.color.copy(this.colour_of(item));
      if (piece.ids !== null) this.paint_white(item);
    }
  }

  colour_of({ about, piece }) {
    if (this.mode === "tile") return tile_colour(about.tile);
    if (this.mode === "level") return level_colour(about.level, ...this.levels);
    const label = piece.pairs?.[0].inside ?? null;
    if (this.mode === "label" && piece.ids === null && label !== null) return this.labels.colour(label);
    return this.colour;
  }

  // The front of a triangle is seen from `outside`, the back from `inside`: each shows the label
  // behind it, or where that is hidden the one before it from within.
  paint(piece) {
    const seen = (label) => label !== null && this.labels.visible(label);
    const of = (label) => (label === null ? this.colour : this.labels.colour(label));
    const sides = piece.pairs.map(({ inside, outside }) => [
      of(seen(inside) ? inside : outside),
      of(seen(outside) ? outside : inside),
    ]);
    const rows = sides.map((pair) => pair.map((c) => [byte(c.r), byte(c.g), byte(c.b)]));
    this.fill(piece, (id, back) => rows[id][back]);
  }

  paint_white(item) {
    const white = [255, 255, 255], { r, g, b } = item.material.color;
    const back = [byte(r), byte(g), byte(b)];
    this.fill(item.piece, (_, is_back) => (is_back ? back : white));
  }

  fill(piece, colour) {
    for (const [back, name] of ["color", "back_color"].entries()) {
      const attribute = piece.geometry.attributes[name];
      for (let i = 0; i < piece.ids.length; ++i) attribute.array.set(colour(piece.ids[i], back), 4 * i);
      attribute.needsUpdate = true;
    }
  }
}
