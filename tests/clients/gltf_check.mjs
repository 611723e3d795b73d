// Gives every glTF binary below the folders to the validator of Khronos, and decodes each with draco3dgltf or
// meshoptimizer: as many points and corners as its accessors say, bounds that are theirs to the bit, corners
// that name points, and normals of length 1.
// Usage: node gltf_check.mjs FOLDER ...
//        node gltf_check.mjs             whether the packages are there
// Exits 1 on any error or warning of the validator and any difference, 77 where a package is missing.
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, join } from "node:path";
import { missing_decoder, read_glb } from "./glb.mjs";

let validator, missing = await missing_decoder();
try {
  validator = createRequire(import.meta.url)("gltf-validator");
} catch {
  missing ??= "gltf-validator is not installed; run tests/npm_packages.sh";
}
if (missing) {
  console.log(`skipped: ${missing}`);
  process.exit(77);
}

function differences(path) {
  const found = [], { json, primitive, attributes, corners } = read_glb(path);
  for (const [name, number] of Object.entries(primitive.attributes)) {
    const accessor = json.accessors[number], values = attributes[name];
    if (!values) {
      found.push(`${name} is not among what was decoded`);
      continue;
    }
    const n = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 }[accessor.type];
    if (values.length !== accessor.count * n) found.push(`${name}: ${values.length / n} points, the accessor says ${accessor.count}`);
    for (const [bound, pick] of [["min", Math.min], ["max", Math.max]])
      if (accessor[bound]) {
        const reached = [...accessor[bound]].map((_, k) => values.reduce((best, x, i) => (i % n === k ? pick(best, x) : best), bound === "min" ? Infinity : -Infinity));
        if (reached.some((x, k) => x !== accessor[bound][k])) found.push(`${name}: ${bound} ${reached}, the accessor says ${accessor[bound]}`);
      }
  }
  if (!json.accessors[primitive.attributes.POSITION].min) found.push("POSITION has no bounds");
  if (corners.length !== json.accessors[primitive.indices].count) found.push(`${corners.length} corners, the accessor says ${json.accessors[primitive.indices].count}`);
  const points = attributes.POSITION.length / 3;
  if (corners.some((corner) => corner >= points)) found.push("a corner names no point");
  const normals = attributes.NORMAL ?? [];
  const scale = normals instanceof Int16Array ? 32767 : 1;
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) / scale;
    if (Math.abs(length - 1) > 0.02) {
      found.push(`normal ${i / 3} has the length ${length}`);
      break;
    }
  }
  return { found, triangles: corners.length / 3 };
}

let failed = false;
for (const folder of process.argv.slice(2)) {
  const sums = {};
  for (const name of readdirSync(folder, { recursive: true }).filter((file) => file.endsWith(".glb")).sort()) {
    const path = join(folder, name), kind = name.match(/(\.plain|\.meshopt|)\.glb$/)[0];
    const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(path)), { uri: name, maxIssues: 0 });
    const { found, triangles } = differences(path);
    const sum = (sums[kind] ??= { files: 0, triangles: 0, errors: 0, warnings: 0, infos: 0, codes: new Set(), wrong: 0 });
    sum.files += 1;
    sum.triangles += triangles;
    sum.errors += issues.numErrors;
    sum.warnings += issues.numWarnings;
    sum.infos += issues.numInfos;
    for (const { code, severity } of issues.messages) if (severity >= 2) sum.codes.add(code);
    sum.wrong += found.length > 0;
    for (const { code, pointer, message, severity } of issues.messages) if (severity < 2) console.log(`${path}: ${code} ${pointer ?? ""}: ${message}`);
    for (const text of found) console.log(`${path}: ${text}`);
    failed ||= found.length > 0 || issues.numErrors > 0 || issues.numWarnings > 0;
  }
  for (const [kind, { files, triangles, errors, warnings, infos, codes, wrong }] of Object.entries(sums))
    console.log(`${basename(folder)}: ${files} ${kind} files, ${triangles} triangles: ${errors} errors, ${warnings} warnings, ${infos} infos${codes.size ? ` (${[...codes].join(", ")})` : ""}; ${wrong} decode to something else`);
  if (Object.keys(sums).length === 0) console.log(`${basename(folder)}: no .glb`), (failed = true);
}
process.exit(failed ? 1 : 0);
