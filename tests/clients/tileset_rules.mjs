// What the JSON schemas of 3D Tiles 1.1 say of a tileset of explicit tiles: which properties there have to be,
// of which types, and that there is no other one. Written after the specification (Open Geospatial Consortium,
// "3D Tiles Specification" 1.1, OGC 22-025r4, 2023). Implicit tiling, metadata and extensions are refused here,
// since voxweld writes none.

const number = (value) => typeof value === "number" && Number.isFinite(value);
const text = (value) => typeof value === "string" && value.length > 0;
const object = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
const numbers = (count) => (value) => Array.isArray(value) && value.length === count && value.every(number);
const at_least_0 = (value) => number(value) && value >= 0;

// name -> [needed, rule, what it has to be]
const asset = {
  version: [true, (value) => value === "1.1", '"1.1"'],
  tilesetVersion: [false, text, "a text"],
  generator: [false, text, "a text"], // of earlier schemas; asset allows more properties
  extras: [false, () => true, ""],
};
const volume = {
  box: [false, numbers(12), "12 numbers"],
  region: [false, numbers(6), "6 numbers"],
  sphere: [false, (value) => numbers(4)(value) && value[3] >= 0, "4 numbers"],
};
const content = {
  uri: [true, text, "a text"],
  boundingVolume: [false, object, "an object"],
};
const tile = {
  boundingVolume: [true, object, "an object"],
  geometricError: [true, at_least_0, "a number of at least 0"],
  refine: [false, (value) => value === "ADD" || value === "REPLACE", '"ADD" or "REPLACE"'],
  transform: [false, numbers(16), "16 numbers"],
  viewerRequestVolume: [false, object, "an object"],
  content: [false, object, "an object"],
  children: [false, (value) => Array.isArray(value) && value.length > 0, "a list that is not empty"],
};
const tileset = {
  asset: [true, object, "an object"],
  geometricError: [true, at_least_0, "a number of at least 0"],
  root: [true, object, "an object"],
  extras: [false, () => true, ""],
};

function breaches_of(value, rules, where) {
  if (!object(value)) return [`${where}: no object`];
  const found = [];
  for (const [name, [needed, rule, wanted]] of Object.entries(rules)) {
    if (!(name in value)) needed && found.push(`${where}.${name} is missing`);
    else if (!rule(value[name])) found.push(`${where}.${name} is ${JSON.stringify(value[name])}, not ${wanted}`);
  }
  for (const name of Object.keys(value)) if (!(name in rules)) found.push(`${where}.${name} is not known`);
  return found;
}

function volume_breaches(value, where) {
  const found = breaches_of(value, volume, where);
  if (object(value) && Object.keys(value).length !== 1) found.push(`${where} has not one of box, region and sphere`);
  return found;
}

function tile_breaches(value, where, root) {
  const found = breaches_of(value, tile, where);
  if (!object(value)) return found;
  if (root && !("refine" in value)) found.push(`${where}.refine is missing: a root needs it`);
  if ("boundingVolume" in value) found.push(...volume_breaches(value.boundingVolume, `${where}.boundingVolume`));
  if (object(value.content)) {
    found.push(...breaches_of(value.content, content, `${where}.content`));
    if (object(value.content.boundingVolume)) found.push(...volume_breaches(value.content.boundingVolume, `${where}.content.boundingVolume`));
  }
  if (Array.isArray(value.children)) {
    value.children.forEach((child, i) => found.push(...tile_breaches(child, `${where}.children[${i}]`, false)));
    if (new Set(value.children.map((child) => JSON.stringify(child))).size < value.children.length) found.push(`${where}.children has one twice`);
  }
  return found;
}

// Texts; none where the document keeps all rules.
export function schema_breaches(document) {
  const found = breaches_of(document, tileset, "tileset");
  if (object(document?.asset)) found.push(...breaches_of(document.asset, asset, "asset"));
  if (object(document?.root)) found.push(...tile_breaches(document.root, "root", true));
  return found;
}
