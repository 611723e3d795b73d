// What large_client.mjs asks of the page of `voxweld view`, as the pages of this folder have it in window.client.
// Is bundled and given to the page.
import { Vector3, WebGLRenderer } from "three";
import { through } from "./seen.mjs";

const { view, state } = window.voxweld, { stage, tileset, movement, surface } = view, { camera } = stage;
// Of its own, without smoothing, which would make a narrow gap a faint one.
const renderer = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });

// Without pictures meanwhile: without a graphics card one takes seconds.
stage.draw = () => {};
async function settled() {
  for (let quiet = 0; quiet < 6 && state.errors.length === 0; ) {
    quiet = tileset.update() || state.status !== "ready" ? 0 : quiet + 1;
    await new Promise((done) => setTimeout(done, 15));
  }
  stage.draw_now();
}

async function seen_from(pixels, within) {
  tileset.set_error(pixels);
  await settled();
  const levels = new Set([...surface.items].filter(({ about }) => about.parent?.parent).map(({ about }) => about.level));
  renderer.setSize(512, 512, false);
  return {
    layers: through(renderer, stage.scene, camera, within, true), failures: state.errors, tiles: state.tiles_total,
    triangles: tileset.visible_triangles(), kinds: levels.size,
  };
}

window.client = {
  async open() {
    movement.touched = true;
    await settled();
  },
  picture(direction, pixels, distance) {
    const { center, radius } = stage.sphere;
    camera.up.set(0, 0, 1);
    camera.position.set(...direction).normalize().multiplyScalar(radius * distance).add(center);
    movement.target.copy(center);
    movement.orbit.update();
    return seen_from(pixels, false);
  },
  // point: in metres, as tiles have it.
  inside(point, direction, pixels, near, within = true) {
    const { matrixWorld } = tileset.tiles.group, place = new Vector3(...point).applyMatrix4(matrixWorld);
    camera.up.set(direction[2], direction[0], direction[1]);
    camera.position.copy(place);
    movement.target.copy(new Vector3(...direction).multiplyScalar(stage.sphere.radius / 100).add(place));
    camera.lookAt(movement.target);
    return seen_from(pixels, within);
  },
  cost(pictures) {
    const gl = stage.renderer.getContext(), pixel = new Uint8Array(4), start = performance.now();
    for (let i = 0; i < pictures; ++i) {
      stage.draw_now();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // which waits for the picture
    }
    return { seconds: (performance.now() - start) / 1000 / pictures, bytes: state.cached_bytes };
  },
};
