// Cutting along the axes of the volume, and caps where material is cut: the backs and fronts that a
// ray meets behind the cut are counted in the stencil; where they differ, it begins within material.
import {
  AlwaysStencilFunc, BackSide, Box3, DecrementWrapStencilOp, DoubleSide, FrontSide, Group, IncrementWrapStencilOp,
  Mesh, MeshStandardMaterial, NotEqualStencilFunc, Plane, PlaneGeometry, ReplaceStencilOp, Vector3,
} from "three";
import { hidden_material } from "./materials.js";
import { label_geometry } from "./pieces.js";

const names = ["x", "y", "z"];
const most_bodies = 512; // of a cut: each has its own passes

const counting = (side, op) => ({
  side, stencilWrite: true, stencilFunc: AlwaysStencilFunc, stencilFail: op, stencilZFail: op, stencilZPass: op,
  colorWrite: false, depthWrite: false, depthTest: false,
});
const filling = {
  side: DoubleSide, roughness: 0.9, stencilWrite: true, stencilRef: 0, stencilFunc: NotEqualStencilFunc,
  stencilFail: ReplaceStencilOp, stencilZFail: ReplaceStencilOp, stencilZPass: ReplaceStencilOp,
};

export class Clipping {
  constructor(stage, surface, space, labels) {
    Object.assign(this, { stage, surface, space, labels });
    this.axes = names.map(() => ({ on: false, at: 0.5, flipped: false }));
    this.caps = true;
    this.closed = true; // else there is nothing that a cap could close
    this.dirty = false;
    this.cap_group = new Group();
    surface.group.add(this.cap_group);
    this.passes = [];
    this.closed_geometry = new WeakMap(); // item -> Map of label -> geometry
    surface.on_added = () => (this.dirty ||= this.planes.length > 0);
    surface.on_removed = (item) => this.forget(item);
    stage.before.push(() => this.rebuild());
  }

  set(axis, values) {
    Object.assign(this.axes[axis], values);
    this.update();
  }

  set_caps(yes) {
    this.caps = yes;
    this.update();
  }

  update() {
    this.surface.group.updateMatrixWorld(true);
    const matrix = this.surface.group.matrixWorld;
    this.planes = [];
    this.axes.forEach((axis, k) => {
      axis.plane = null;
      if (!axis.on) return;
      const normal = new Vector3().setComponent(k, axis.flipped ? 1 : -1);
      axis.plane = new Plane(normal, axis.flipped ? -this.place(k) : this.place(k)).applyMatrix4(matrix);
      this.planes.push(axis.plane);
    });
    this.surface.set_planes(this.planes);
    this.changed();
  }

  // Where the cut is, in the coordinates of the files.
  place(k) {
    const lo = this.space.box.min.getComponent(k), hi = this.space.box.max.getComponent(k);
    return lo + this.axes[k].at * (hi - lo);
  }

  keeps(point) {
    return this.planes.every((plane) => plane.distanceToPoint(point) >= 0);
  }

  planes = [];

  changed() {
    this.dirty = true;
    this.stage.draw();
  }

  forget(item) {
    for (const geometry of this.closed_geometry.get(item)?.values() ?? []) geometry.dispose();
    this.closed_geometry.delete(item);
    this.dirty ||= this.planes.length > 0;
  }

  clear() {
    for (const { mesh, material, geometry } of this.passes) {
      mesh.removeFromParent();
      material.dispose();
      geometry?.dispose();
    }
    this.passes = [];
  }

  rebuild() {
    if (!this.dirty) return;
    this.dirty = false;
    this.clear();
    if (!this.caps || !this.closed) return;
    let order = 10;
    this.axes.forEach((axis, k) => {
      if (!axis.plane) return;
      const others = this.planes.filter((plane) => plane !== axis.plane);
      for (const body of this.bodies(axis.plane)) {
        this.count(body, axis.plane, order);
        this.fill(body, k, others, order + 1);
        order += 2;
      }
    });
  }

  // What is closed by itself: all of a surface, or each label; only those that the plane meets.
  bodies(plane) {
    const bodies = new Map();
    const add = (label, item) => {
      if (label !== null && !this.labels.visible(label)) return;
      if (!bodies.has(label)) bodies.set(label, { label, items: [], box: new Box3() });
      const body = bodies.get(label);
      body.items.push(item);
      body.box.union(item.piece.geometry.boundingBox.clone().applyMatrix4(item.mesh.matrixWorld));
    };
    for (const item of this.surface.items) {
      if (item.about.parent && !item.about.parent.parent) continue; // a tile that is not in sight
      item.mesh.updateWorldMatrix(true, false);
      const { pairs, ids } = item.piece;
      const all = pairs === null ? [null] : ids === null ? [pairs[0].inside] : pairs.flatMap((p) => [p.inside, p.outside]);
      for (const label of new Set(all)) if (pairs === null || label !== null) add(label, item);
    }
    return [...bodies.values()].filter((body) => this.box_of(body).intersectsPlane(plane)).slice(0, most_bodies);
  }

  box_of(body) {
    const bounds = body.label === null ? null : this.labels.rows.get(body.label)?.bounds;
    if (!bounds) return body.box;
    return new Box3(new Vector3(...bounds.lo), new Vector3(...bounds.hi)).applyMatrix4(this.surface.group.matrixWorld);
  }

  geometry_of(item, label) {
    if (item.piece.ids === null) return item.piece.geometry;
    if (!this.closed_geometry.has(item)) this.closed_geometry.set(item, new Map());
    const known = this.closed_geometry.get(item);
    if (!known.has(label)) known.set(label, label_geometry(item.piece, label));
    return known.get(label);
  }

  count(body, plane, order) {
    for (const [side, op] of [[BackSide, IncrementWrapStencilOp], [FrontSide, DecrementWrapStencilOp]]) {
      const material = hidden_material({ ...counting(side, op), clippingPlanes: [plane] });
      for (const item of body.items) {
        const mesh = new Mesh(this.geometry_of(item, body.label), material);
        mesh.raycast = () => {};
        mesh.renderOrder = order;
        item.mesh.add(mesh);
        mesh.updateMatrixWorld(true); // the group of a tileset does not look for new children
        this.passes.push({ mesh, material });
      }
    }
  }

  fill(body, k, others, order) {
    const size = this.space.box.getSize(new Vector3()).addScalar(2 * this.space.radius() * 0.05);
    const [u, v] = [[1, 2], [2, 0], [0, 1]][k];
    const geometry = new PlaneGeometry(size.getComponent(u), size.getComponent(v));
    const material = new MeshStandardMaterial({ ...filling, clippingPlanes: others });
    material.color.copy(this.colour_of(body));
    const mesh = new Mesh(geometry, material);
    mesh.raycast = () => {};
    // The plane's own x, y, z become the axes u, v, k.
    const axis = (n) => new Vector3().setComponent(n, 1);
    mesh.matrix.makeBasis(axis(u), axis(v), axis(k));
    mesh.matrix.setPosition(this.space.box.getCenter(new Vector3()).setComponent(k, this.place(k)));
    mesh.matrixAutoUpdate = false;
    mesh.renderOrder = order;
    mesh.onAfterRender = (renderer) => renderer.clearStencil();
    this.cap_group.add(mesh);
    this.passes.push({ mesh, material, geometry });
  }

  colour_of(body) {
    const { mode, colour } = this.surface;
    if (mode === "label" && body.label !== null) return this.labels.colour(body.label);
    return mode === "plain" ? colour.clone().multiplyScalar(0.72) : colour.clone().setRGB(0.3, 0.33, 0.37);
  }

  state() {
    return this.axes
      .map(({ on, at, flipped }, k) => (on ? `${names[k]}${flipped ? ">" : "<"}${Number(at.toFixed(4))}` : ""))
      .filter(Boolean)
      .join(",");
  }

  restore(text) {
    for (const part of text.split(",")) {
      const [, name, sign, at] = part.match(/^([xyz])([<>])([0-9.]+)$/) ?? [];
      if (name) Object.assign(this.axes[names.indexOf(name)], { on: true, at: Math.min(1, Number(at)), flipped: sign === ">" });
    }
    this.update();
  }
}
