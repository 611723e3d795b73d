// A piece: one geometry of one tile, and what its triangles belong to.
//   geometry   position, index, perhaps normal; perhaps ids: for each vertex a row of `pairs`
//   pairs      [{inside, outside}]: the labels that a triangle separates, its normal pointing out of
//              `inside`; text, or null for what is around the volume. Null: the piece has no labels
import { BufferAttribute, BufferGeometry, Matrix4 } from "three";

export function make_piece(geometry, { pairs = null, ids = null } = {}) {
  if (!geometry.index) geometry.setIndex(numbers(geometry.attributes.position.count));
  // Without normals of its own a mesh is drawn flat: means of neighbours would be a guess at creases.
  const piece = { geometry, pairs, ids, has_normals: Boolean(geometry.attributes.normal) };
  if (!piece.has_normals) geometry.computeVertexNormals();
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  piece.triangles = geometry.index.count / 3;
  return piece;
}

function numbers(count) {
  const array = new Uint32Array(count);
  for (let i = 0; i < count; ++i) array[i] = i;
  return new BufferAttribute(array, 1);
}

// A triangle's row of `pairs`, from one of its vertices.
export function pair_of(piece, vertex) {
  return piece.pairs === null ? null : piece.pairs[piece.ids === null ? 0 : piece.ids[vertex]];
}

// Moves the triangles that `shown(pair)` keeps to the front, and draws only them.
export function show_pairs(piece, shown) {
  const index = piece.geometry.index, array = index.array;
  if (piece.pairs === null) return piece.geometry.setDrawRange(0, Infinity);
  const keep = piece.pairs.map(shown);
  if (piece.ids === null || keep.every(Boolean))
    return piece.geometry.setDrawRange(0, piece.ids !== null || keep[0] ? Infinity : 0);
  let end = 0;
  for (let i = 0; i < array.length; i += 3) {
    if (!keep[piece.ids[array[i]]]) continue;
    for (let k = 0; k < 3; ++k) {
      const other = array[end + k];
      array[end + k] = array[i + k];
      array[i + k] = other;
    }
    end += 3;
  }
  index.needsUpdate = true;
  piece.geometry.setDrawRange(0, end);
}

// The closed surface of one label: all its triangles, turned to face out of it.
export function label_geometry(piece, label) {
  if (piece.ids === null) return piece.geometry;
  const side = piece.pairs.map((p) => (p.inside === label ? 1 : p.outside === label ? -1 : 0));
  const array = piece.geometry.index.array, out = [];
  for (let i = 0; i < array.length; i += 3) {
    const facing = side[piece.ids[array[i]]];
    if (facing > 0) out.push(array[i], array[i + 1], array[i + 2]);
    if (facing < 0) out.push(array[i], array[i + 2], array[i + 1]);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", piece.geometry.attributes.position);
  geometry.setIndex(new BufferAttribute(new Uint32Array(out), 1));
  geometry.boundingSphere = piece.geometry.boundingSphere;
  return geometry;
}

// Meshes below an object of three's, as pieces: those of one place are put together, since a file
// between labels has a part for each pair. pair_of_mesh says what a mesh separates, or null.
export function pieces_of_object(object, pair_of_mesh) {
  object.updateMatrixWorld(true);
  const inverse = object.matrixWorld.clone().invert();
  const places = new Map();
  object.traverse((mesh) => {
    if (!mesh.isMesh) return;
    const matrix = new Matrix4().multiplyMatrices(inverse, mesh.matrixWorld);
    const key = matrix.elements.join();
    if (!places.has(key)) places.set(key, { matrix, parts: [] });
    places.get(key).parts.push({ geometry: mesh.geometry, label: pair_of_mesh(mesh) });
  });
  return [...places.values()].map(({ matrix, parts }) => ({ matrix, ...put_together(parts) }));
}

function put_together(parts) {
  const labels = parts.map((part) => part.label);
  if (parts.length === 1) return make_piece(parts[0].geometry, labels[0] ?? {});
  const joined = joined_geometry(parts.map((part) => part.geometry));
  if (labels.every((label) => label === null)) return make_piece(joined);
  return make_piece(joined, joined_labels(parts));
}

function joined_labels(parts) {
  const pairs = [], ids = new Uint32Array(parts.reduce((sum, p) => sum + vertices(p.geometry), 0));
  let at = 0;
  for (const { geometry, label } of parts) {
    const first = pairs.length, count = vertices(geometry);
    pairs.push(...(label?.pairs ?? [{ inside: null, outside: null }]));
    for (let i = 0; i < count; ++i) ids[at + i] = first + (label?.ids ? label.ids[i] : 0);
    at += count;
  }
  return { pairs, ids };
}

const vertices = (geometry) => geometry.attributes.position.count;

// Numbers as they are meant, whether they lie one after the other and are floats, or not.
function plain(attribute, out, at) {
  const { count, itemSize, array } = attribute;
  if (array instanceof Float32Array && !attribute.isInterleavedBufferAttribute) return out.set(array, at);
  for (let i = 0; i < count; ++i)
    for (let k = 0; k < itemSize; ++k) out[at + i * itemSize + k] = attribute.getComponent(i, k);
}

function joined_geometry(geometries) {
  const total = geometries.reduce((sum, g) => sum + vertices(g), 0);
  const with_normals = geometries.every((g) => g.attributes.normal);
  const corners = geometries.map((g) => g.index?.array ?? numbers(vertices(g)).array);
  const position = new Float32Array(3 * total);
  const normal = with_normals ? new Float32Array(3 * total) : null;
  const index = new Uint32Array(corners.reduce((sum, c) => sum + c.length, 0));
  let first = 0, corner = 0;
  geometries.forEach((geometry, i) => {
    plain(geometry.attributes.position, position, 3 * first);
    if (normal) plain(geometry.attributes.normal, normal, 3 * first);
    for (const c of corners[i]) index[corner++] = c + first;
    first += vertices(geometry);
  });
  const joined = new BufferGeometry();
  joined.setAttribute("position", new BufferAttribute(position, 3));
  if (normal) joined.setAttribute("normal", new BufferAttribute(normal, 3));
  joined.setIndex(new BufferAttribute(index, 1));
  return joined;
}
