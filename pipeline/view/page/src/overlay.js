// What lies over the picture: where the axes point, and how long a stretch is.
import { Vector3 } from "three";

const colours = ["#ef6f6c", "#8ccf7e", "#6ea8fe"];

export class Axes {
  constructor(element, stage, space) {
    Object.assign(this, { element, stage, space });
    stage.after.push(() => this.draw());
  }

  draw() {
    const turn = this.stage.camera.quaternion.clone().invert();
    const ends = ["x", "y", "z"].map((name, k) => {
      const way = new Vector3().setComponent(k, 1).transformDirection(this.space.mesh_matrix()).applyQuaternion(turn);
      return { name, colour: colours[k], x: 36 + 23 * way.x, y: 36 - 23 * way.y, tx: 36 + 31 * way.x, ty: 36 - 31 * way.y, z: way.z };
    });
    ends.sort((a, b) => a.z - b.z);
    const lines = ends.map(({ name, colour, x, y, tx, ty, z }) =>
      `<g stroke="${colour}" fill="${colour}" opacity="${z < -0.3 ? 0.55 : 1}"><line x1="36" y1="36" x2="${x.toFixed(1)}" y2="${y.toFixed(1)}" stroke-width="2"/>` +
      `<text x="${tx.toFixed(1)}" y="${ty.toFixed(1)}" stroke="none">${name}</text></g>`);
    this.element.innerHTML = `<svg viewBox="0 0 72 72" width="72" height="72" aria-hidden="true">${lines.join("")}</svg>`;
  }
}

// The largest of 1, 2 and 5 times a power of ten that is not above it.
export function round_down(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return [5, 2, 1].map((n) => n * power).find((n) => n <= length * (1 + 1e-9)) ?? power;
}

const digits = (number) => Number(number.toPrecision(3)).toString();

export class ScaleBar {
  constructor(element, stage, space, target) {
    Object.assign(this, { element, stage, space, target });
    stage.after.push(() => this.draw());
  }

  // Of the plane through the point that the camera turns around.
  draw() {
    const { camera, renderer } = this.stage;
    const height = renderer.domElement.clientHeight;
    const distance = camera.position.distanceTo(this.target());
    const per_pixel = (2 * distance * Math.tan((camera.fov * Math.PI) / 360)) / height;
    const length = round_down(140 * per_pixel);
    if (!Number.isFinite(length) || length <= 0) return;
    const unit = this.space.unit || (this.space.frame ? "units" : "");
    const text = `${digits(length)} ${unit}`;
    const width = `${Math.round(length / per_pixel)}px`;
    if (this.text === text && this.width === width) return;
    Object.assign(this, { text, width });
    this.element.replaceChildren(document.createTextNode(text), document.createElement("i"));
    this.element.style.width = width;
  }
}
