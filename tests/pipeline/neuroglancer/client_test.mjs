// Shows exports in Neuroglancer itself, in a headless Chromium: that it loads them without a complaint, picks
// coarse levels from afar and fine ones nearby, and draws what is there.
// Usage: node client_test.mjs VOXWELD
//        node client_test.mjs          whether neuroglancer, esbuild and puppeteer-core are there
// Exits 77 where one of these or Chromium is missing (tests/npm_packages.sh).
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { copyFileSync, createReadStream, existsSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { decoded_png } from "../view/picture.mjs";

const [, , voxweld] = process.argv;
const require = createRequire(import.meta.url);

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

function installed(name) {
  try {
    return require.resolve(name);
  } catch {
    return skip(`${name} is not installed; run tests/npm_packages.sh`);
  }
}
// In its package it stands in `lib`.
const library = dirname(installed("neuroglancer"));
const icons = dirname(dirname(installed("ikonate/package.json")));
const { build } = require(installed("esbuild"));
const puppeteer = require(installed("puppeteer-core"));
if (voxweld === undefined) process.exit(0);

function browser_path() {
  const names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
  for (const folder of (process.env.PATH ?? "").split(":"))
    for (const name of names) if (existsSync(join(folder, name))) return join(folder, name);
  return skip("no chromium");
}
const chromium = browser_path();
const place = mkdtempSync(join(tmpdir(), "voxweld-client-"));
process.on("exit", () => rmSync(place, { recursive: true, force: true }));

function run(...args) {
  const done = spawnSync(voxweld, args, { cwd: place, encoding: "utf8" });
  assert.equal(done.status, 0, `voxweld ${args.join(" ")}: ${done.stderr}`);
}

// The package has no bundle of its own. Texts are asked for as "icon.svg?raw".
async function bundle() {
  const texts = {
    name: "texts",
    setup(of) {
      of.onResolve({ filter: /\?raw$/ }, ({ path, resolveDir }) => {
        const file = path.slice(0, -"?raw".length);
        return { path: file.startsWith(".") ? join(resolveDir, file) : join(icons, file), namespace: "text" };
      });
      of.onLoad({ filter: /.*/, namespace: "text" }, ({ path }) =>
        ({ contents: existsSync(path) ? readFileSync(path, "utf8") : "<svg/>", loader: "text" }));
    },
  };
  await build({
    entryPoints: ["main", "chunk_worker", "async_computation"].map((name) => join(library, `${name}.bundle.js`)),
    bundle: true, format: "esm", outdir: join(place, "client"), plugins: [texts], conditions: ["browser"],
    loader: { ".svg": "text", ".html": "file", ".png": "dataurl" }, logLevel: "error",
    define: { NEUROGLANCER_BUILD_INFO: "undefined", global: "globalThis" },
  });
  copyFileSync(join(library, "mesh/draco/neuroglancer_draco.wasm"), join(place, "client/neuroglancer_draco.wasm"));
}

const page_text = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<link rel="stylesheet" href="/client/main.bundle.css"><script type="module" src="/client/main.bundle.js"></script>
<body><div id="neuroglancer-container"></div></body>`;
const types = { ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };
const asked = []; // {path, begin} of what lies under /data/

function answer(request, response) {
  const path = decodeURIComponent(new URL(request.url, "http://x").pathname);
  if (path === "/") return response.writeHead(200, { "content-type": "text/html" }).end(page_text);
  const file = path.startsWith("/data/") ? join(place, path.slice(6)) : join(place, "client", basename(path));
  if (!existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end();
  const size = statSync(file).size, range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? "");
  const [begin, end] = range ? [Number(range[1]), Math.min(Number(range[2]), size - 1)] : [0, size - 1];
  if (path.startsWith("/data/")) asked.push({ path, begin: range ? begin : undefined });
  const head = { "content-type": types[file.match(/\.\w+$/)?.[0]] ?? "application/octet-stream", "content-length": end - begin + 1 };
  if (range) head["content-range"] = `bytes ${begin}-${end}/${size}`;
  response.writeHead(range ? 206 : 200, head);
  createReadStream(file, { start: begin, end }).pipe(response);
}

// Of each fragment of an object where it begins, and its level.
function levels_of(index) {
  const file = readFileSync(index), count = file.readUInt32LE(24), levels = new Map();
  let at = 28 + 16 * count, begin = 0;
  const numbers = Array.from({ length: count }, (_, k) => file.readUInt32LE(at + 4 * k));
  at += 4 * count;
  numbers.forEach((n, level) => {
    for (let i = 0; i < n; ++i) {
      const size = file.readUInt32LE(at + 12 * n + 4 * i);
      if (size > 0) levels.set(begin, level);
      begin += size;
    }
    at += 16 * n;
  });
  return levels;
}

async function shown(browser, port, name, segments, side, scale) {
  const dimensions = Object.fromEntries(["x", "y", "z"].map((axis) => [axis, [1e-9, "m"]]));
  const source = `precomputed://http://127.0.0.1:${port}/data/${name}/`;
  const state = {
    dimensions, position: [side / 2, side / 2, side / 2], projectionScale: scale, layout: "3d", showSlices: false,
    showAxisLines: false, layers: [{ type: "segmentation", name: "mesh", source, segments }],
  };
  asked.length = 0;
  const page = await browser.newPage(), complaints = [];
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("response", (of) => of.status() >= 400 && complaints.push(`${of.url()}: ${of.status()}`));
  await page.setViewport({ width: 600, height: 500 });
  await page.goto(`http://127.0.0.1:${port}/#!${encodeURIComponent(JSON.stringify(state))}`);
  // Until it has asked for nothing for a while.
  for (let before = -1, quiet = 0, tries = 0; quiet < 4 && tries < 60; ++tries) {
    await new Promise((done) => setTimeout(done, 400));
    quiet = asked.length === before && before > 2 ? quiet + 1 : 0;
    before = asked.length;
  }
  const image = decoded_png(Buffer.from(await page.screenshot()));
  await page.close();
  assert.deepEqual(complaints, [], name);
  return image;
}

// Below the bar at the top: the share of pixels that are drawn, and of those with much of it how many hues.
function look(image) {
  const hues = new Map();
  let drawn = 0, all = 0;
  for (let y = 60; y < image.height; ++y)
    for (let x = 60; x < image.width - 60; ++x) {
      const [r, g, b] = image.at(x, y), most = Math.max(r, g, b), least = Math.min(r, g, b);
      ++all;
      if (most < 40) continue;
      ++drawn;
      if (most - least < 20) continue;
      const hue = [r, g, b].map((c) => Math.round((6 * (c - least)) / (most - least))).join();
      hues.set(hue, (hues.get(hue) ?? 0) + 1);
    }
  return { drawn: drawn / all, hues: [...hues.values()].filter((n) => n > 30).length };
}

await bundle();
const settings = ["--set", 'output.levels="auto"', "--set", "output.tile_vertices=1024", "--set", "output.report=false"];
for (const kind of ["gyroid", "labels"]) {
  run("phantom", kind, "--size", kind === "gyroid" ? "96" : "48", "-o", `${kind}.nrrd`);
  run("init", `${kind}.nrrd`, ...(kind === "labels" ? ["--labels"] : []));
  run("run", `${kind}.toml`, ...settings, "--set", ...(kind === "labels" ? ['labels.mode="shared"'] : ["simplify.tolerance=0.02"]));
}
run("export", "gyroid.mesh", "--neuroglancer", "-o", "files");
run("export", "gyroid.mesh", "--neuroglancer", "--legacy", "-o", "old");
run("export", "labels.mesh", "--neuroglancer", "--sharded", "-o", "shards");
run("run", "labels.toml", ...settings, "--set", 'labels.mode="each"', "--set", "output.directory=each.mesh");
run("export", "each.mesh", "--neuroglancer", "-o", "each");

const server = createServer(answer).listen(0, "127.0.0.1");
await new Promise((done) => server.on("listening", done));
const { port } = server.address();
const browser = await puppeteer.launch({
  executablePath: chromium,
  args: ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking"],
});
try {
  const levels = levels_of(join(place, "files/1.index"));
  const top = Math.max(...levels.values());
  assert.ok(top > 0, "the run has levels");
  // Of an object those that were asked for.
  const asked_levels = (object = 1, of = levels) =>
    [...new Set(asked.filter(({ path, begin }) => path.endsWith(`/${object}`) && begin !== undefined).map(({ begin }) => of.get(begin)))].sort();

  const near = look(await shown(browser, port, "files", ["1"], 96, 120));
  assert.ok(near.drawn > 0.1, `nearby ${near.drawn} of the picture is drawn`);
  assert.ok(asked_levels().includes(0), `nearby levels ${asked_levels()} are asked for`);
  const far = look(await shown(browser, port, "files", ["1"], 96, 6000));
  assert.deepEqual(asked_levels(), [top], "from afar");
  assert.ok(far.drawn > 0 && far.drawn < 0.01, `from afar ${far.drawn} of the picture is drawn`);

  const old = look(await shown(browser, port, "old", ["1"], 96, 120));
  assert.ok(Math.abs(old.drawn - near.drawn) < 0.01, `${old.drawn} of the old format is drawn, ${near.drawn} of the other`);

  const ids = JSON.parse(readFileSync(join(place, "shards/segment_properties/info"), "utf8")).inline.ids;
  const labels = look(await shown(browser, port, "shards", ids, 48, 60));
  assert.ok(labels.drawn > 0.1, `of labels ${labels.drawn} of the picture is drawn`);
  assert.ok(labels.hues > 5, `${labels.hues} colours of labels`);

  // A mesh for each label: each object has its own levels.
  const each = look(await shown(browser, port, "each", ids, 48, 60));
  assert.ok(Math.abs(each.drawn - labels.drawn) < 0.02, `${each.drawn} is drawn of a mesh for each label, ${labels.drawn} of the shared one`);
  await shown(browser, port, "each", ids, 48, 3000);
  const coarse = ids.map((id) => [id, levels_of(join(place, `each/${id}.index`))]).filter(([, of]) => Math.max(...of.values()) > 0);
  assert.ok(coarse.length > 10, `${coarse.length} labels have levels`);
  for (const [id, of] of coarse) assert.deepEqual(asked_levels(id, of), [Math.max(...of.values())], `label ${id} from afar`);
  console.log(`near ${near.drawn.toFixed(3)}, far ${far.drawn.toFixed(5)}, old ${old.drawn.toFixed(3)}, labels ${labels.drawn.toFixed(3)} in ${labels.hues} hues`);
} finally {
  await browser.close();
  server.close();
}
