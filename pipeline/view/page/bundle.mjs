// Bundles the page into one script, with the decoders and the licences of all that is in it.
// Usage: node bundle.mjs OUT      beside the node_modules of package-lock.json
import { build } from "esbuild";
import { copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";

const out = process.argv[2];
mkdirSync(join(out, "draco"), { recursive: true });
const result = await build({
  entryPoints: ["src/main.js"],
  outfile: join(out, "viewer.js"),
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
  metafile: true,
  logLevel: "warning",
});
for (const file of ["index.html", "viewer.css"]) copyFileSync(file, join(out, file));
const draco = "node_modules/three/examples/jsm/libs/draco/gltf";
for (const file of ["draco_wasm_wrapper.js", "draco_decoder.wasm"])
  copyFileSync(join(draco, file), join(out, "draco", file));

// The packages that something was taken from.
const packages = new Set(["three"]);
for (const input of Object.keys(result.metafile.inputs)) {
  const found = input.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)\//);
  if (found) packages.add(found[1]);
}
let text = "The page of voxweld's viewer has parts of these packages.\n";
for (const name of [...packages].sort()) {
  const folder = resolve("node_modules", name);
  const facts = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  text += `\n== ${name} ${facts.version} (${facts.license})\n\n`;
  const licence = readdirSync(folder).find((file) => /^licen[cs]e/i.test(file));
  if (licence) text += readFileSync(join(folder, licence), "utf8").trim() + "\n";
}
// The decoder that three.js brings along.
text += "\n== Draco (Apache-2.0)\n\nCopyright 2016 The Draco Authors.\n";
if (!existsSync(join(out, "viewer.js"))) throw new Error("esbuild wrote no viewer.js");
writeFileSync(join(out, "licences.txt"), text);
