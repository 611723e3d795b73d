// A tileset (OGC 3D Tiles 1.1): tiles as fine as the view needs, and memory that stays below a cap.
import { TilesRenderer } from "3d-tiles-renderer/three";
import { GLTFExtensionsPlugin } from "3d-tiles-renderer/three/plugins";
import { Box3, Matrix4, Sphere } from "three";
import { draco_loader, meshopt_decoder, pair_of_mesh } from "./formats.js";
import { feature_plugin } from "./features.js";
import { data_url } from "./loader.js";
import { pieces_of_object } from "./pieces.js";

const megabyte = 2 ** 20;

// Of files that have the surface of one label alone: which one, by the file's path below "labels/".
export function labels_by_file(tiles) {
  const labels = new Map();
  for (const { label, files } of tiles)
    if (label != null) for (const { path } of files) labels.set(path.slice(path.indexOf("labels/")), label);
  return labels;
}

export class Tileset {
  // labels: as labels_by_file gives them.
  constructor({ path, labels, stage, surface, space, state, changed }) {
    Object.assign(this, { labels, stage, surface, space, state, changed });
    this.numbers = 0;
    this.tiles = new TilesRenderer(data_url(path));
    this.tiles.registerPlugin(
      new GLTFExtensionsPlugin({
        dracoLoader: draco_loader, meshoptDecoder: meshopt_decoder, autoDispose: false, metadata: false,
        plugins: [feature_plugin],
      }),
    );
    this.set_error(2);
    this.set_cap(1024);
    this.tiles.setCamera(stage.camera);
    this.place();
    stage.world.add(this.tiles.group);
    this.listen();
    stage.before.push(() => this.update());
  }

  place() {
    const { group } = this.tiles;
    this.space.metres_matrix().decompose(group.position, group.quaternion, group.scale);
    group.updateMatrixWorld(true);
  }

  listen() {
    const { tiles } = this;
    tiles.addEventListener("load-root-tileset", () => this.frame());
    const loaded = () => {
      tiles.removeEventListener("tiles-load-end", loaded);
      this.on_loaded?.();
    };
    tiles.addEventListener("tiles-load-end", loaded);
    tiles.addEventListener("load-model", ({ scene, tile }) => this.add(scene, tile));
    tiles.addEventListener("dispose-model", ({ scene }) => {
      for (const item of scene.userData.items ?? []) this.surface.remove(item);
    });
    tiles.addEventListener("load-error", ({ url, error }) => {
      this.state.errors.push(`${String(url).replace(/^.*\/data\//, "")}: ${error?.message ?? error}`);
      this.changed();
    });
    tiles.addEventListener("tile-visibility-change", () => this.surface.on_added());
    for (const event of ["needs-update", "needs-render", "tile-visibility-change", "tiles-load-end"])
      tiles.addEventListener(event, () => this.stage.draw());
  }

  // Where no manifest says how large the scene is, the root does.
  frame() {
    const sphere = new Sphere();
    if (!this.tiles.getBoundingSphere(sphere)) return;
    if (this.space.box.isEmpty()) {
      const box = sphere.getBoundingBox(new Box3());
      const scale = this.space.metres ? 1 / this.space.metres : 1;
      this.space.set_box(box.applyMatrix4(new Matrix4().makeScale(scale, scale, scale)));
      this.place();
    }
    this.on_frame?.();
  }

  // The meshes of a tile become pieces, in their places.
  add(scene, tile) {
    const level = -tile.internal.depth, number = this.numbers++;
    const pieces = pieces_of_object(scene, pair_of_mesh);
    const uri = tile.content?.uri ?? "", label = this.labels.get(uri.slice(uri.lastIndexOf("labels/")));
    if (label !== undefined)
      for (const piece of pieces) piece.pairs ??= [{ inside: label, outside: null }];
    scene.clear();
    scene.userData.items = pieces.map((piece) => {
      const item = this.surface.add(piece, { tile: number, level, name: uri, parent: scene });
      item.mesh.applyMatrix4(piece.matrix);
      return item;
    });
    this.state.tiles_loaded += 1;
    this.changed();
  }

  // True while there is more to come.
  update() {
    const { tiles, stage, state } = this;
    stage.set_depths(); // tiles in front of the near plane of the picture before would be left out
    tiles.setResolutionFromRenderer(stage.camera, stage.renderer);
    tiles.update();
    const { stats } = tiles;
    const busy = stats.downloading + stats.parsing + (stats.queued ?? 0);
    state.status = busy > 0 || !tiles.root ? "loading" : "ready";
    state.tiles_total = stats.visible ?? 0;
    state.cached_bytes = tiles.lruCache.cachedBytes;
    state.triangles = this.visible_triangles();
    this.changed();
    return busy > 0;
  }

  visible_triangles() {
    let sum = 0;
    for (const item of this.surface.items) if (item.about.parent?.parent) sum += item.piece.triangles;
    return sum;
  }

  set_error(pixels) {
    this.tiles.errorTarget = pixels;
    this.stage.draw();
  }

  set_cap(megabytes) {
    this.tiles.lruCache.maxBytesSize = megabytes * megabyte;
    this.tiles.lruCache.minBytesSize = 0.75 * megabytes * megabyte;
    this.stage.draw();
  }

  // Tiles that the view asks for have no room.
  get full() {
    return (this.tiles.stats.refused ?? 0) > 0;
  }

  get error() {
    return this.tiles.errorTarget;
  }
  get cap() {
    return Math.round(this.tiles.lruCache.maxBytesSize / megabyte);
  }
}
