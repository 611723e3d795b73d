// The canvas: camera, lights, and drawing when something has changed.
import {
  Color, DirectionalLight, Group, HemisphereLight, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer,
} from "three";

const back = 0x15181d;

function new_renderer() {
  try {
    return new WebGLRenderer({ antialias: true, stencil: true });
  } catch {
    throw new Error("This browser draws nothing in three dimensions (WebGL 2): turn on its graphics acceleration, " +
      "or take another browser. `voxweld render` draws pictures without one.");
  }
}

export class Stage {
  constructor(element) {
    this.element = element;
    this.renderer = new_renderer();
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setClearColor(back);
    element.append(this.renderer.domElement);
    this.renderer.domElement.tabIndex = 0;
    this.scene = new Scene();
    this.scene.background = new Color(back);
    this.camera = new PerspectiveCamera(38, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
    this.add_lights();
    // What is shown, in the world's directions and unit; its middle lies at 0, where floats are fine.
    this.world = new Group();
    this.scene.add(this.world);
    this.sphere = new Sphere(new Vector3(), 1); // all that is drawn
    this.points = []; // what a first view shows
    this.before = []; // called before each picture; true: and the next one is to be drawn too
    this.after = [];
    this.wanted = false;
    new ResizeObserver(() => this.resize()).observe(element);
    this.resize();
  }

  add_lights() {
    this.scene.add(new HemisphereLight(0xdfe8f5, 0x59524a, 1.35));
    const head = new DirectionalLight(0xffffff, 2.1);
    head.position.set(-0.5, 0.8, 1);
    this.camera.add(head, head.target);
    this.scene.add(this.camera);
  }

  // The part of the canvas that the panel leaves free.
  set_margin(pixels) {
    this.margin = pixels;
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    const margin = Math.min(this.margin ?? 0, width / 2);
    this.camera.aspect = (width - margin) / height;
    // The middle of the view is the middle of what is free.
    if (margin > 0) this.camera.setViewOffset(width - margin, height, 0, 0, width, height);
    else this.camera.clearViewOffset();
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // Soon.
  draw() {
    if (this.wanted) return;
    this.wanted = true;
    requestAnimationFrame(() => {
      this.wanted = false;
      this.draw_now();
    });
  }

  draw_now() {
    for (const f of this.before) if (f()) this.draw();
    this.set_depths();
    this.renderer.render(this.scene, this.camera);
    for (const f of this.after) f();
  }

  // As near and far as the sphere asks for.
  set_depths() {
    const { camera, sphere } = this;
    camera.updateMatrixWorld();
    const distance = camera.getWorldPosition(new Vector3()).distanceTo(sphere.center);
    camera.near = Math.max(distance - 1.05 * sphere.radius, sphere.radius / 2000);
    camera.far = distance + 1.05 * sphere.radius;
    camera.updateProjectionMatrix();
  }

  picture() {
    this.draw_now();
    return new Promise((done) => this.renderer.domElement.toBlob(done, "image/png"));
  }
}
