// The cells of the octree that tiles are of, as wire boxes.
import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments } from "three";
import { level_colour } from "./colours.js";

const edges = [0, 1, 1, 3, 3, 2, 2, 0, 4, 5, 5, 7, 7, 6, 6, 4, 0, 4, 1, 5, 2, 6, 3, 7];

export function tile_boxes(tiles) {
  const boxes = new Map();
  for (const tile of tiles) boxes.set([tile.level, ...tile.at].join(), tile);
  const levels = tiles.map((tile) => tile.level);
  const lowest = levels.reduce((a, b) => Math.min(a, b), Infinity);
  const highest = levels.reduce((a, b) => Math.max(a, b), -Infinity);
  const points = new Float32Array(boxes.size * edges.length * 3), colours = new Float32Array(points.length);
  let at = 0;
  for (const { level, box } of boxes.values()) {
    const colour = level_colour(level, lowest, highest).lerp(new Color(1, 1, 1), 0.35);
    for (const corner of edges) {
      for (let k = 0; k < 3; ++k) points[at + k] = corner & (1 << k) ? box.hi[k] : box.lo[k];
      colour.toArray(colours, at);
      at += 3;
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setAttribute("color", new BufferAttribute(colours, 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.7 }));
  lines.raycast = () => {};
  lines.visible = false;
  return lines;
}
