// A tileset with all its nested files as one tree, with the meshes of its tiles decoded.
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { read_glb, world_positions } from "./glb.mjs";
import { schema_breaches } from "./tileset_rules.mjs";

// Calls visit({ tile, file, depth, parent }) for each tile, the contents of nested files in place of the tiles
// that name them. Returns the list of files and what breaks the schemas.
function walk(path, visit, parent = null, depth = 0, seen = { files: [], breaches: [] }) {
  const document = JSON.parse(readFileSync(path, "utf8"));
  seen.files.push(path);
  seen.breaches.push(...schema_breaches(document).map((what) => `${path}: ${what}`));
  const enter = (tile, above, level) => {
    const uri = tile.content?.uri;
    if (uri?.endsWith(".json")) {
      const link = visit({ tile, file: path, depth: level, parent: above, link: true });
      walk(join(dirname(path), uri), visit, link, level, seen);
      return;
    }
    const node = visit({ tile, file: path, depth: level, parent: above, link: false });
    for (const child of tile.children ?? []) enter(child, node, level + 1);
  };
  enter(document.root, parent, depth);
  return seen;
}

// { root, nodes, files, breaches, error }: nodes in the order of the files; each has uri, path, box, error,
// children, depth, and positions (world, metres, z up), raw (as in the file), corners where it has content.
// wanted(tile): whether to read its content; of a large tileset not all has room.
export function read_tileset(path, wanted = () => true) {
  const nodes = [];
  const seen = walk(path, ({ tile, file, depth, parent, link }) => {
    const node = { tile, box: tile.boundingVolume.box, error: tile.geometricError, depth, parent, link, children: [] };
    if (!link && tile.content && wanted(tile)) {
      node.path = join(dirname(file), tile.content.uri);
      const glb = read_glb(node.path);
      Object.assign(node, { positions: world_positions(glb), raw: glb.positions, corners: glb.corners, matrix: glb.matrix, features: glb.attributes._FEATURE_ID_0 });
    }
    parent?.children.push(node);
    nodes.push(node);
    return node;
  });
  return { root: nodes[0], nodes, ...seen, error: JSON.parse(readFileSync(path, "utf8")).geometricError };
}

// 0 where nothing finer is; else one more than the highest below. A link stands where its file's root does.
export function height_of(node) {
  if (node.link) return height_of(node.children[0]);
  return node.children.length === 0 ? 0 : 1 + Math.max(...node.children.map(height_of));
}

// Numbers from 0 to 1, the same at each run.
export function random_numbers(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

// A choice of tiles that covers the mesh once: shown(node) says where to stop.
export function cut_of(node, shown) {
  if (node.positions && (node.children.length === 0 || shown(node))) return [node];
  return node.children.flatMap((child) => cut_of(child, shown));
}

// Of each level as a whole, and of as many random ones as asked for: [name, nodes].
export function cuts_of(root, random, seed = 1) {
  const cuts = [], next = random_numbers(seed);
  for (let level = 0; level <= height_of(root); ++level) cuts.push([`level ${level}`, cut_of(root, (node) => height_of(node) <= level)]);
  for (let i = 0; i < random; ++i) {
    const share = 0.2 + 0.6 * next();
    cuts.push([`mix ${i + 1}`, cut_of(root, (node) => node !== root && next() < share)]);
  }
  return cuts;
}
