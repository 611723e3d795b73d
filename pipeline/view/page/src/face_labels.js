// Labels of triangles become labels of vertices, as pieces.js has them.
import { BufferAttribute, BufferGeometry } from "three";
import { make_piece } from "./pieces.js";

// Rows of pairs, and each triangle's. A label below 0 is what lies around.
function pairs_of(inside, outside) {
  const rows = new Map(), pairs = [], of_faces = new Uint32Array(inside.length);
  const text = (label) => (label === null || label < 0 ? null : String(label));
  for (let i = 0; i < inside.length; ++i) {
    const a = inside[i], b = outside === null ? null : outside[i];
    if (!rows.has(a)) rows.set(a, new Map());
    const row = rows.get(a);
    if (!row.has(b)) row.set(b, pairs.push({ inside: text(a), outside: text(b) }) - 1);
    of_faces[i] = row.get(b);
  }
  return { pairs, of_faces };
}

function gathered(array, width, from) {
  const out = new Float32Array(width * from.length);
  for (let i = 0; i < from.length; ++i)
    for (let k = 0; k < width; ++k) out[width * i + k] = array[width * from[i] + k];
  return new BufferAttribute(out, width);
}

// A piece of plain arrays: position and normal of vertices (normal may be null), three corners of each
// triangle, and where there are labels those inside and outside of each (outside may be null). A vertex
// that triangles of several pairs share is there once for each.
export function piece_of_arrays({ position, normal, corners, inside = null, outside = null }) {
  const geometry = new BufferGeometry();
  if (inside === null || inside.length === 0) {
    geometry.setAttribute("position", new BufferAttribute(position, 3));
    if (normal) geometry.setAttribute("normal", new BufferAttribute(normal, 3));
    geometry.setIndex(new BufferAttribute(corners, 1));
    return make_piece(geometry);
  }
  const { pairs, of_faces } = pairs_of(inside, outside);
  const count = position.length / 3, owner = new Int32Array(count).fill(-1), more = new Map();
  const from = Array.from({ length: count }, (_, i) => i), owners = [];
  const index = new Uint32Array(corners.length);
  for (let i = 0; i < corners.length; ++i) {
    const v = corners[i], pair = of_faces[Math.floor(i / 3)];
    if (owner[v] < 0) owner[v] = pair;
    if (owner[v] === pair) {
      index[i] = v;
      continue;
    }
    const key = v * pairs.length + pair;
    if (!more.has(key)) {
      more.set(key, from.push(v) - 1);
      owners.push(pair);
    }
    index[i] = more.get(key);
  }
  const ids = new Uint32Array(from.length);
  for (let v = 0; v < count; ++v) ids[v] = Math.max(0, owner[v]);
  ids.set(owners, count);
  geometry.setAttribute("position", gathered(position, 3, from));
  if (normal) geometry.setAttribute("normal", gathered(normal, 3, from));
  geometry.setIndex(new BufferAttribute(index, 1));
  return make_piece(geometry, { pairs, ids });
}
