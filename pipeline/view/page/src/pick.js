// What lies under a click: its place, and whose it is.
import { BufferAttribute, BufferGeometry, Points, PointsMaterial, Raycaster, Vector2 } from "three";
import { pair_of } from "./pieces.js";

const still_pixels = 4; // a press that moved further was no click

export class Pick {
  // told(found or null)
  constructor({ stage, surface, clipping, space, told }) {
    Object.assign(this, { stage, surface, clipping, space, told });
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(3), 3));
    this.marker = new Points(
      geometry,
      new PointsMaterial({ color: 0xffd166, size: 9, sizeAttenuation: false, depthTest: false, transparent: true }),
    );
    this.marker.visible = false;
    this.marker.frustumCulled = false;
    this.marker.renderOrder = 1e6;
    this.marker.raycast = () => {};
    stage.scene.add(this.marker);
    const canvas = stage.renderer.domElement;
    let from = null;
    canvas.addEventListener("pointerdown", (event) => (from = event.button === 0 ? [event.clientX, event.clientY] : null));
    canvas.addEventListener("pointerup", (event) => {
      if (from && Math.hypot(event.clientX - from[0], event.clientY - from[1]) < still_pixels)
        this.at(event.offsetX, event.offsetY);
      from = null;
    });
  }

  at(x, y) {
    const { clientWidth: width, clientHeight: height } = this.stage.renderer.domElement;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.stage.camera);
    const hit = ray.intersectObject(this.stage.world, true).find(({ object, point }) =>
      object.userData.item && this.clipping.keeps(point));
    this.marker.visible = Boolean(hit);
    if (hit) this.marker.position.copy(hit.point);
    const found = hit ? this.describe(hit) : null;
    this.told(found);
    this.stage.draw();
    return found;
  }

  describe({ object, point, face }) {
    const { piece, about } = object.userData.item;
    return { ...this.space.describe(point), pair: pair_of(piece, face.a), name: about.name, level: about.level };
  }

  clear() {
    this.marker.visible = false;
    this.told(null);
    this.stage.draw();
  }
}
