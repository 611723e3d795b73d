// Moving the camera: turning around a point, or flying. Keys move it in both.
import { Box3, Euler, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const keys = { KeyW: [0, 1, 0], KeyS: [0, -1, 0], KeyA: [-1, 0, 0], KeyD: [1, 0, 0], KeyE: [0, 0, 1], KeyQ: [0, 0, -1] };
const fast = 4, crossing_seconds = 6;
const filled = 0.94; // of the picture
const tap_ms = 40; // how long a key counts as held that was only tapped

export const sides = {
  Front: [0, -1, 0], Back: [0, 1, 0], Left: [-1, 0, 0], Right: [1, 0, 0], Top: [0, 0, 1], Bottom: [0, 0, -1],
};
const first_side = [0.62, -0.92, 0.5];

// In NIfTI's world y points to the front of a patient, in DICOM's to the back.
const turns = { RAS: -1 };

export class Movement {
  // space: of the frame, which says where the front is.
  constructor(stage, space, changed) {
    this.stage = stage;
    this.changed = changed;
    this.turn = turns[space] ?? 1;
    this.touched = false; // by the user: then nothing else moves it
    this.flying = false;
    this.down = new Set();
    this.orbit = new OrbitControls(stage.camera, stage.renderer.domElement);
    this.orbit.zoomToCursor = true;
    this.orbit.addEventListener("change", () => this.moved());
    this.orbit.addEventListener("start", () => (this.touched = true));
    this.listen(stage.renderer.domElement);
    stage.before.push(() => this.step());
  }

  get target() {
    return this.orbit.target;
  }

  moved() {
    this.stage.draw();
    this.changed();
  }

  listen(canvas) {
    canvas.addEventListener("pointerdown", (event) => {
      canvas.focus();
      if (this.flying) canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (this.flying && event.buttons !== 0) this.look(event.movementX, event.movementY);
    });
    canvas.addEventListener("wheel", (event) => {
      if (this.flying) this.move(new Vector3(0, 0, Math.sign(event.deltaY) * this.stage.sphere.radius * 0.05));
    }, { passive: true });
    window.addEventListener("blur", () => this.down.clear());
    window.addEventListener("keyup", (event) => this.down.delete(event.code));
  }

  // True where the key is one of moving.
  key_down(event) {
    if (!keys[event.code] || event.ctrlKey || event.metaKey || event.altKey) return false;
    this.fast = event.shiftKey;
    if (this.down.size === 0) this.last = performance.now() - tap_ms;
    this.down.add(event.code);
    this.stage.draw();
    return true;
  }

  // Where keys are held: some way on. True: more to come.
  step() {
    if (this.down.size === 0) return false;
    const now = performance.now(), seconds = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    const way = new Vector3();
    for (const key of this.down) way.add(new Vector3(...keys[key]));
    const size = Math.min(this.stage.sphere.radius, 2 * this.distance() + 0.02 * this.stage.sphere.radius);
    way.multiplyScalar(((2 * size) / crossing_seconds) * seconds * (this.fast ? fast : 1));
    this.move(new Vector3(way.x, way.z, -way.y));
    return true;
  }

  distance() {
    return this.stage.camera.position.distanceTo(this.target);
  }

  // In the camera's directions: right, up, back.
  move(way) {
    this.touched = true;
    way.applyQuaternion(this.stage.camera.quaternion);
    this.stage.camera.position.add(way);
    this.target.add(way);
    this.moved();
  }

  look(x, y) {
    this.touched = true;
    const { camera } = this.stage, distance = this.distance();
    const ahead = this.target.clone().sub(camera.position).normalize();
    const angles = new Euler(Math.asin(ahead.z), 0, Math.atan2(ahead.y, ahead.x));
    angles.z -= x * 0.004;
    angles.x = Math.min(1.55, Math.max(-1.55, angles.x - y * 0.004));
    const flat = Math.cos(angles.x);
    ahead.set(flat * Math.cos(angles.z), flat * Math.sin(angles.z), Math.sin(angles.x));
    this.target.copy(camera.position).addScaledVector(ahead, distance);
    camera.lookAt(this.target);
    this.moved();
  }

  fly(yes) {
    this.flying = yes;
    this.orbit.enabled = !yes;
    this.moved();
  }

  way_to([x, y, z]) {
    return new Vector3(this.turn * x, this.turn * y, z).normalize();
  }

  // All of the points, from a side.
  frame(side = null) {
    const { camera } = this.stage;
    const chosen = side ?? (this.touched ? null : first_side);
    const back = chosen ? this.way_to(chosen) : camera.position.clone().sub(this.target).normalize();
    new Box3().setFromPoints(this.stage.points).getCenter(this.target);
    camera.position.copy(this.target).add(back);
    camera.lookAt(this.target);
    // What is near looks larger, so that the middle of the points is not that of the picture.
    for (let round = 0; round < 3; ++round) {
      const { distance, right, up } = this.fitting();
      const shift = round < 2 ? new Vector3(right * distance, up * distance, 0) : new Vector3();
      this.target.add(shift.applyQuaternion(camera.quaternion));
      camera.position.copy(this.target).addScaledVector(back, distance);
    }
    this.orbit.update();
    this.moved();
  }

  // The distance from which every point is just within the picture, and where the middle of the points is
  // seen from there, as tangents.
  fitting() {
    const { camera, points } = this.stage, turn = camera.quaternion.clone().invert();
    const tall = Math.tan((camera.fov * Math.PI) / 360) * filled, wide = tall * camera.aspect;
    const seen = points.map((point) => point.clone().sub(this.target).applyQuaternion(turn));
    let distance = 0;
    for (const { x, y, z } of seen) distance = Math.max(distance, z + Math.abs(x) / wide, z + Math.abs(y) / tall);
    const middle = (of) => {
      let lo = Infinity, hi = -Infinity;
      for (const at of seen) {
        const tangent = of(at) / (distance - at.z);
        lo = Math.min(lo, tangent);
        hi = Math.max(hi, tangent);
      }
      return (lo + hi) / 2;
    };
    return { distance, right: middle((at) => at.x), up: middle((at) => at.y) };
  }

  reset() {
    this.touched = false;
    this.frame();
  }

  state() {
    const round = (v) => v.toArray().map((x) => Number(x.toPrecision(6)));
    return [...round(this.stage.camera.position), ...round(this.target)];
  }

  restore(numbers) {
    if (numbers.length !== 6 || !numbers.every(Number.isFinite)) return;
    this.touched = true;
    this.stage.camera.position.fromArray(numbers, 0);
    this.target.fromArray(numbers, 3);
    this.orbit.update();
  }
}
