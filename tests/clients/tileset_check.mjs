// Checks tilesets: the rules of the JSON schemas, that what is in a tile and below it lies in its box, that
// no error is above its parent's, and that each level and random mixes of levels are closed. Tiles are decoded
// by draco3dgltf and meshoptimizer.
// Usage: node tileset_check.mjs [--labels] [--mixes N] [--dump FOLDER] TILESET.json ...
//        node tileset_check.mjs              whether the decoders are there
// --labels: of labels, that share triangles or have a mesh each: then each label's boundary has to be closed
// --dump: writes the tiles of the (last) tileset for tileset_distances.py: tiles.json and their numbers, in metres
// Exits 1 where anything is wrong, 77 where a decoder is missing.
import { mkdirSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { parseArgs } from "node:util";
import { chunks_of, missing_decoder } from "./glb.mjs";
import { cuts_of, height_of, read_tileset } from "./tileset_tree.mjs";

const { values: options, positionals: paths } = parseArgs({
  allowPositionals: true,
  options: { labels: { type: "boolean" }, mixes: { type: "string", default: "20" }, dump: { type: "string" } },
});
const missing = await missing_decoder();
if (missing) {
  console.log(`skipped: ${missing}`);
  process.exit(77);
}

// How far outside of an oriented box the points are, in metres: along its axes, which are at right angles.
function outside(box, points) {
  let most = 0;
  for (let a = 0; a < 3; ++a) {
    const axis = box.slice(3 + 3 * a, 6 + 3 * a), half = Math.hypot(...axis);
    if (half === 0) continue;
    const unit = axis.map((x) => x / half);
    for (let i = 0; i < points.length; i += 3) {
      const along = (points[i] - box[0]) * unit[0] + (points[i + 1] - box[1]) * unit[1] + (points[i + 2] - box[2]) * unit[2];
      most = Math.max(most, Math.abs(along) - half);
    }
  }
  return most;
}

function corners_of_box(box) {
  const out = [];
  for (const x of [-1, 1]) for (const y of [-1, 1]) for (const z of [-1, 1])
    for (let r = 0; r < 3; ++r) out.push(box[r] + x * box[3 + r] + y * box[6 + r] + z * box[9 + r]);
  return out;
}

const size_of = (box) => Math.hypot(...box.slice(3));

function box_breaches({ nodes }) {
  const found = [];
  for (const node of nodes) {
    const slack = 1e-6 * size_of(node.box), name = node.path ?? "a tile without content"; // floats have 24 bits
    if (node.positions && outside(node.box, node.positions) > slack) found.push(`${name}: its triangles leave its box`);
    for (let above = node.parent; above; above = above.parent)
      if (node.positions && outside(above.box, node.positions) > slack) found.push(`${name}: its triangles leave a box above it`);
    if (node.parent && outside(node.parent.box, corners_of_box(node.box)) > slack) found.push(`${name}: its box leaves that of its parent`);
    if (node.parent && !node.parent.link && node.error > node.parent.error) found.push(`${name}: its error ${node.error} is above its parent's ${node.parent.error}`);
    if (node.children.length === 0 && node.error !== 0) found.push(`${name}: the finest has the error ${node.error}`);
  }
  return found;
}

// Points of the lattice by number: those of equal bits are one.
function numbered_points() {
  const numbers = new Map();
  return (raw, i) => {
    const key = `${raw[3 * i]},${raw[3 * i + 1]},${raw[3 * i + 2]}`;
    let number = numbers.get(key);
    if (number === undefined) numbers.set(key, (number = numbers.size));
    return number;
  };
}

// Edges that are not used as often in one direction as in the other, or by more than two triangles.
function open_edges(triangles) {
  const uses = new Map(), limit = 2 ** 26;
  for (const t of triangles)
    for (let i = 0; i < 3; ++i) {
      const a = t[i], b = t[(i + 1) % 3], key = a < b ? a * limit + b : b * limit + a;
      uses.set(key, (uses.get(key) ?? 0) + (a < b ? 1 : 1 << 16));
    }
  let open = 0, many = 0;
  for (const use of uses.values()) {
    const forth = use & 0xffff, back = use >> 16;
    open += forth !== back;
    many += forth + back > 2;
  }
  return { open, many };
}

// The tables of pairs of labels: [inside, outside] of each feature id.
const sides = { INT8: Int8Array, UINT8: Uint8Array, INT16: Int16Array, UINT16: Uint16Array, INT32: Int32Array, UINT32: Uint32Array, INT64: BigInt64Array, UINT64: BigUint64Array };
function pairs_of(path) {
  const { json, bin } = chunks_of(path), { schema, propertyTables } = json.extensions.EXT_structural_metadata;
  const [table] = propertyTables, column = (name) => {
    const view = json.bufferViews[table.properties[name].values], Type = sides[schema.classes[table.class].properties[name].componentType];
    const at = bin.byteOffset + (view.byteOffset ?? 0);
    return [...new Type(bin.buffer.slice(at, at + table.count * Type.BYTES_PER_ELEMENT))].map(String);
  };
  const inside = column("inside"), outside_of = column("outside");
  return inside.map((label, i) => [label, outside_of[i]]);
}

function cut_breaches(tileset, mixes) {
  const number_of = numbered_points(), found = [], seen = new Set();
  for (const node of tileset.nodes)
    if (node.positions) {
      node.numbers = Uint32Array.from({ length: node.raw.length / 3 }, (_, i) => number_of(node.raw, i));
      if (node.features) node.pairs = pairs_of(node.path);
      else if (options.labels) { // a file of the label's own
        node.pairs = [[basename(node.path).replace(/[.].*/, ""), "-1"]];
        node.features = new Uint32Array(node.raw.length / 3);
      }
      seen.add(node.matrix.join());
    }
  if (seen.size > 1) found.push("tiles have different transforms");
  const lines = [];
  for (const [name, nodes] of cuts_of(tileset.root, mixes)) {
    const whole = [], labels = new Map();
    for (const node of nodes)
      for (let i = 0; i < node.corners.length; i += 3) {
        const t = [0, 1, 2].map((k) => node.numbers[node.corners[i + k]]);
        if (!options.labels) whole.push(t);
        else
          node.pairs[node.features[node.corners[i]]].forEach((label, side) => {
            if (label === "-1") return;
            if (!labels.has(label)) labels.set(label, []);
            labels.get(label).push(side === 0 ? t : [t[2], t[1], t[0]]);
          });
      }
    const checked = options.labels ? [...labels.values()] : [whole];
    const { open, many } = checked.map(open_edges).reduce((a, b) => ({ open: a.open + b.open, many: a.many + b.many }));
    if (open > 0) found.push(`${name}: ${open} open edges`);
    if (many > 0 && !options.labels) found.push(`${name}: ${many} edges with more than two triangles`);
    const triangles = nodes.reduce((sum, { corners }) => sum + corners.length / 3, 0);
    lines.push({ name, tiles: nodes.length, triangles, open, many });
  }
  return { found, lines };
}

function dump(tileset, folder) {
  mkdirSync(folder, { recursive: true });
  const tiles = [], numbers = new Map(tileset.nodes.map((node, i) => [node, i]));
  tileset.nodes.forEach((node, i) => {
    if (!node.positions) return;
    writeFileSync(join(folder, `${i}.points`), new Uint8Array(node.positions.buffer));
    writeFileSync(join(folder, `${i}.corners`), new Uint8Array(node.corners.buffer));
    const leaves = [], collect = (n) => (n.children.length === 0 ? leaves.push(numbers.get(n)) : n.children.forEach(collect));
    collect(node);
    tiles.push({ number: i, name: node.path, height: height_of(node), error: node.error, leaves });
  });
  writeFileSync(join(folder, "tiles.json"), JSON.stringify({ size: size_of(tileset.root.box), tiles }));
}

let failed = false;
for (const path of paths) {
  const tileset = read_tileset(path), found = [...tileset.breaches, ...box_breaches(tileset)];
  // It is the error of showing nothing: viewers leave out the whole while this takes few pixels.
  if (tileset.error < size_of(tileset.root.box)) found.push(`the tileset's error ${tileset.error} is small beside its box`);
  const cuts = cut_breaches(tileset, Number(options.mixes));
  found.push(...cuts.found);
  const levels = cuts.lines.filter(({ name }) => name.startsWith("level"));
  const mixes = cuts.lines.filter(({ name }) => name.startsWith("mix"));
  console.log(`${basename(dirname(path))}: ${tileset.files.length} tileset file${tileset.files.length > 1 ? "s" : ""}, ${tileset.nodes.filter((n) => n.positions).length} tiles; ` +
    levels.map(({ name, tiles, triangles }) => `${name}: ${tiles} tiles, ${triangles} triangles`).join("; ") +
    `; ${mixes.length} mixes of ${Math.min(...mixes.map((m) => m.triangles))} to ${Math.max(...mixes.map((m) => m.triangles))} triangles` +
    `; open edges: ${cuts.lines.reduce((sum, { open }) => sum + open, 0)}`);
  for (const text of found.slice(0, 20)) console.log(`  ${text}`);
  if (found.length > 20) console.log(`  and ${found.length - 20} more`);
  failed ||= found.length > 0;
  if (options.dump) dump(tileset, options.dump);
}
process.exit(failed ? 1 : 0);
