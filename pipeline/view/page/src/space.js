// From the coordinates of the files to the world, and to the scene, whose middle is at 0.
import { Box3, Matrix4, Vector3 } from "three";

export class Space {
  constructor(scene) {
    this.frame = scene.frame ?? null;
    this.unit = scene.unit ?? "";
    this.metres = scene.metres_per_unit ?? null;
    this.to_world = new Matrix4();
    if (this.frame) {
      const columns = this.frame.direction.map((d) => new Vector3(...d));
      this.to_world.makeBasis(...columns).setPosition(...this.frame.origin);
    }
    this.centre = new Vector3();
    this.box = new Box3(); // of what is shown, in the coordinates of the files
    if (scene.bounds) this.set_box(new Box3(new Vector3(...scene.bounds.lo), new Vector3(...scene.bounds.hi)));
  }

  set_box(box) {
    this.box.copy(box);
    this.centre.copy(box.getCenter(new Vector3())).applyMatrix4(this.to_world);
  }

  // Of the box, in the scene.
  corners() {
    const matrix = this.mesh_matrix(), { min, max } = this.box;
    return Array.from({ length: 8 }, (_, n) =>
      new Vector3(n & 1 ? max.x : min.x, n & 2 ? max.y : min.y, n & 4 ? max.z : min.z).applyMatrix4(matrix));
  }

  radius() {
    return Math.max(this.box.getSize(new Vector3()).length() / 2, 1e-9);
  }

  // Of the files' coordinates, to the scene.
  mesh_matrix() {
    return new Matrix4().makeTranslation(this.centre.clone().negate()).multiply(this.to_world);
  }

  // Of a tileset, which is in metres, to the scene.
  metres_matrix() {
    const scale = this.metres ? 1 / this.metres : 1;
    return new Matrix4()
      .makeTranslation(this.centre.clone().negate())
      .multiply(new Matrix4().makeScale(scale, scale, scale));
  }

  // What is told of a point of the scene.
  describe(point) {
    const world = point.clone().add(this.centre);
    const mesh = point.clone().applyMatrix4(this.mesh_matrix().invert());
    if (!this.frame) return { mesh, world: null, voxel: null };
    const { first, spacing } = this.frame;
    const voxel = mesh.toArray().map((x, k) => (x - first[k]) / spacing[k]);
    return { mesh, world, voxel: new Vector3(...voxel) };
  }
}
