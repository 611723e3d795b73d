// glTF binaries as other programs decode them: plain accessors, Draco by the npm package draco3dgltf, and
// EXT_meshopt_compression by the npm package meshoptimizer. Nothing of voxweld's is used.
import { readFileSync } from "node:fs";

let draco, meshopt;

// Whether the decoders are there: a text that says what is missing, else nothing.
export async function missing_decoder() {
  try {
    draco = await (await import("draco3dgltf")).default.createDecoderModule({});
    ({ MeshoptDecoder: meshopt } = await import("meshoptimizer/decoder"));
    await meshopt.ready;
  } catch (error) {
    return `draco3dgltf or meshoptimizer is not installed; run tests/npm_packages.sh (${error.message.split("\n")[0]})`;
  }
  return null;
}

export function chunks_of(path) {
  const file = readFileSync(path), length = file.readUInt32LE(12);
  return { json: JSON.parse(file.toString("utf8", 20, 20 + length)), bin: file.subarray(28 + length) };
}

const arrays = { 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const parts = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

function view_of({ json, bin }, number) {
  const view = json.bufferViews[number], how = view.extensions?.EXT_meshopt_compression;
  if (!how) return bin.subarray(view.byteOffset ?? 0, (view.byteOffset ?? 0) + view.byteLength);
  const out = new Uint8Array(how.count * how.byteStride);
  meshopt.decodeGltfBuffer(out, how.count, how.byteStride, bin.subarray(how.byteOffset ?? 0, (how.byteOffset ?? 0) + how.byteLength), how.mode, how.filter);
  return Buffer.from(out.buffer);
}

function plain_values(glb, number) {
  const accessor = glb.json.accessors[number], Type = arrays[accessor.componentType], n = parts[accessor.type];
  const bytes = view_of(glb, accessor.bufferView), size = n * Type.BYTES_PER_ELEMENT;
  const stride = glb.json.bufferViews[accessor.bufferView].byteStride ?? size;
  const out = new Type(accessor.count * n);
  for (let i = 0; i < accessor.count; ++i) {
    const at = bytes.byteOffset + (accessor.byteOffset ?? 0) + i * stride;
    out.set(new Type(bytes.buffer.slice(at, at + size)), i * n);
  }
  return out;
}

// { attributes: name -> values, corners }
function draco_values(glb, primitive) {
  const how = primitive.extensions.KHR_draco_mesh_compression, bytes = view_of(glb, how.bufferView);
  const decoder = new draco.Decoder(), mesh = new draco.Mesh();
  const status = decoder.DecodeArrayToMesh(new Int8Array(bytes), bytes.length, mesh);
  if (!status.ok()) throw new Error(`draco3dgltf: ${status.error_msg()}`);
  const attributes = {};
  for (const [name, id] of Object.entries(how.attributes)) {
    const attribute = decoder.GetAttributeByUniqueId(mesh, id), n = attribute.num_components() * mesh.num_points();
    const pointer = draco._malloc(n * 4);
    decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, draco.DT_FLOAT32, n * 4, pointer);
    attributes[name] = new Float32Array(draco.HEAPF32.buffer, pointer, n).slice();
    draco._free(pointer);
  }
  const n = mesh.num_faces() * 3, pointer = draco._malloc(n * 4);
  decoder.GetTrianglesUInt32Array(mesh, n * 4, pointer);
  const corners = new Uint32Array(draco.HEAPU32.buffer, pointer, n).slice();
  draco._free(pointer);
  draco.destroy(mesh);
  draco.destroy(decoder);
  return { attributes, corners };
}

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

function matrix_of(node) {
  if (node.matrix) return node.matrix;
  const [x, y, z, w] = node.rotation ?? [0, 0, 0, 1], s = node.scale ?? [1, 1, 1], t = node.translation ?? [0, 0, 0];
  const rows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
  ];
  const out = [...identity];
  for (let c = 0; c < 3; ++c) for (let r = 0; r < 3; ++r) out[4 * c + r] = rows[r][c] * s[c];
  for (let r = 0; r < 3; ++r) out[12 + r] = t[r];
  return out;
}

// The one mesh of a file: { json, matrix, accessors: [accessor, values] of each attribute, positions as in the
// file, corners }.
export function read_glb(path) {
  const glb = chunks_of(path), { json } = glb;
  const node = json.nodes.find(({ mesh }) => mesh !== undefined), { primitives } = json.meshes[node.mesh];
  if (primitives.length !== 1) throw new Error(`${path}: ${primitives.length} primitives`);
  const [primitive] = primitives;
  let attributes, corners;
  if (primitive.extensions?.KHR_draco_mesh_compression) ({ attributes, corners } = draco_values(glb, primitive));
  else {
    attributes = Object.fromEntries(Object.entries(primitive.attributes).map(([name, i]) => [name, plain_values(glb, i)]));
    corners = Uint32Array.from(plain_values(glb, primitive.indices));
  }
  return { json, primitive, matrix: matrix_of(node), attributes, corners, positions: attributes.POSITION };
}

// In metres, z up, as 3D Tiles has it: glTF's y-up turned as the specification says.
export function world_positions({ positions, matrix: m }) {
  const out = new Float64Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = [positions[i], positions[i + 1], positions[i + 2]];
    out[i] = m[0] * x + m[4] * y + m[8] * z + m[12];
    out[i + 1] = -(m[2] * x + m[6] * y + m[10] * z + m[14]);
    out[i + 2] = m[1] * x + m[5] * y + m[9] * z + m[13];
  }
  return out;
}
