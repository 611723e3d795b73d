// Decodes what `.meshopt.glb` files have compressed with the npm package meshoptimizer, and compares the
// triangles with those of the same mesh without compression: places to the bit, feature ids, and normals
// to a hundredth. Prints what differs and exits 1 if anything does. Without files: exits 0 when the package
// is there to run, 2 when it is not.
//
//   node meshopt_check.mjs a.meshopt.glb a.plain.glb [b.meshopt.glb b.plain.glb ...]
import { readFileSync } from "node:fs";
import process from "node:process";

let MeshoptDecoder;
try {
  ({ MeshoptDecoder } = await import("meshoptimizer/decoder"));
} catch {
  console.error("the npm package meshoptimizer is not installed; run tests/npm_packages.sh");
  process.exit(2);
}
await MeshoptDecoder.ready;

function chunksOf(path) {
  const file = readFileSync(path);
  const length = file.readUInt32LE(12);
  return { json: JSON.parse(file.toString("utf8", 20, 20 + length)), bin: file.subarray(28 + length) };
}

function viewOf({ json, bin }, number) {
  const view = json.bufferViews[number];
  const how = view.extensions?.EXT_meshopt_compression;
  if (!how) return bin.subarray(view.byteOffset, view.byteOffset + view.byteLength);
  const out = new Uint8Array(how.count * how.byteStride);
  const source = bin.subarray(how.byteOffset, how.byteOffset + how.byteLength);
  MeshoptDecoder.decodeGltfBuffer(out, how.count, how.byteStride, source, how.mode, how.filter);
  return Buffer.from(out.buffer);
}

// f(view, offset) of each item of the accessor.
function itemsOf(glb, number, size, f) {
  const accessor = glb.json.accessors[number];
  const stride = glb.json.bufferViews[accessor.bufferView].byteStride ?? size;
  const view = viewOf(glb, accessor.bufferView);
  return Array.from({ length: accessor.count }, (_, i) => f(view, i * stride, accessor));
}

function normalAt(view, at, accessor) {
  const part = (i) =>
    accessor.componentType === 5126 ? view.readFloatLE(at + 4 * i) : view.readInt16LE(at + 2 * i) / 32767;
  return [part(0), part(1), part(2)];
}

// Sorted: the triangles as text, each from its least corner on, with the normals of those corners.
function trianglesOf(path) {
  const glb = chunksOf(path);
  const { attributes, indices } = glb.json.meshes[0].primitives[0];
  const places = itemsOf(glb, attributes.POSITION, 12, (view, at) => view.toString("hex", at, at + 12));
  const ids =
    "_FEATURE_ID_0" in attributes
      ? itemsOf(glb, attributes._FEATURE_ID_0, 4, (view, at) => view.readFloatLE(at))
      : places.map(() => 0);
  const normals = "NORMAL" in attributes ? itemsOf(glb, attributes.NORMAL, 12, normalAt) : null;
  const corners = itemsOf(glb, indices, 4, (view, at) => view.readUInt32LE(at));
  const triangles = [];
  for (let t = 0; t < corners.length; t += 3) {
    let of = corners.slice(t, t + 3).map((point) => ({
      text: `${places[point]} ${ids[point]}`,
      normal: normals?.[point] ?? [0, 0, 0],
    }));
    const least = of.map((c) => c.text).sort()[0];
    while (of[0].text !== least) of = [...of.slice(1), of[0]];
    triangles.push({ text: of.map((c) => c.text).join(), normals: of.flatMap((c) => c.normal) });
  }
  return triangles.sort((a, b) => (a.text < b.text ? -1 : a.text > b.text ? 1 : 0));
}

let failed = false;
for (let i = 2; i + 1 < process.argv.length; i += 2) {
  const [path, other] = process.argv.slice(i, i + 2);
  const found = trianglesOf(path);
  const expected = trianglesOf(other);
  const wrong = expected.filter((t, k) => t.text !== found[k]?.text).length;
  const turned = expected.filter((t, k) =>
    t.normals.some((n, at) => !(Math.abs(n - (found[k]?.normals[at] ?? 9)) < 0.01))).length;
  const same = found.length === expected.length && wrong === 0 && turned === 0;
  console.log(`${path}: ${found.length} of ${expected.length} triangles, ${wrong} differ, ${turned} have other normals`);
  failed ||= !same;
}
process.exit(failed ? 1 : 0);
