// Neuroglancer itself in a headless Chromium, and a server for what it shows. Exits 77 where neuroglancer, esbuild,
// puppeteer-core or Chromium is missing (tests/npm_packages.sh).
import { copyFileSync, createReadStream, existsSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { browser_options, skip } from "../view/chromium.mjs";
import { decoded_png } from "../view/picture.mjs";

const require = createRequire(import.meta.url);

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

// The package has no bundle of its own. Texts are asked for as "icon.svg?raw".
async function bundle(folder) {
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
    bundle: true, format: "esm", outdir: folder, plugins: [texts], conditions: ["browser"],
    loader: { ".svg": "text", ".html": "file", ".png": "dataurl" }, logLevel: "error",
    define: { NEUROGLANCER_BUILD_INFO: "undefined", global: "globalThis" },
  });
  copyFileSync(join(library, "mesh/draco/neuroglancer_draco.wasm"), join(folder, "neuroglancer_draco.wasm"));
}

const page_text = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<link rel="stylesheet" href="/client/main.bundle.css"><script type="module" src="/client/main.bundle.js"></script>
<body><div id="neuroglancer-container"></div></body>`;
const types = { ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

// asked: {path, begin, bytes} of what lies under /data/ is put there.
function answer(data, client, asked, request, response) {
  const path = decodeURIComponent(new URL(request.url, "http://x").pathname);
  if (path === "/") return response.writeHead(200, { "content-type": "text/html" }).end(page_text);
  const file = path.startsWith("/data/") ? join(data, path.slice(6)) : join(client, basename(path));
  if (!existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end();
  const size = statSync(file).size, range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? "");
  const [begin, end] = range ? [Number(range[1]), Math.min(Number(range[2]), size - 1)] : [0, size - 1];
  if (path.startsWith("/data/")) asked.push({ path, begin: range ? begin : undefined, bytes: end - begin + 1 });
  const head = { "content-type": types[file.match(/\.\w+$/)?.[0]] ?? "application/octet-stream", "content-length": end - begin + 1 };
  if (range) head["content-range"] = `bytes ${begin}-${end}/${size}`;
  response.writeHead(range ? 206 : 200, head);
  createReadStream(file, { start: begin, end }).pipe(response);
}

// Of each fragment of an object where it begins, and its level.
export function levels_of(index) {
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

// Below the bar at the top: the share of pixels that are drawn, and of those with much of it how many hues.
export function look(image) {
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

async function shown(browser, port, asked, name, segments, position, scale, patience = 16) {
  const dimensions = Object.fromEntries(["x", "y", "z"].map((axis) => [axis, [1e-9, "m"]]));
  const source = `precomputed://http://127.0.0.1:${port}/data/${name}/`;
  const state = {
    dimensions, position, projectionScale: scale, layout: "3d", showSlices: false,
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
  for (let before = -1, quiet = 0, tries = 0; quiet < patience / 4 && tries < 10 * patience; ++tries) {
    await new Promise((done) => setTimeout(done, 400));
    quiet = asked.length === before && before > 2 ? quiet + 1 : 0;
    before = asked.length;
  }
  const file = Buffer.from(await page.screenshot());
  await page.close();
  return { image: decoded_png(file), file, complaints };
}

// Calls test({ shown, asked }) with a browser. data: the folder in which exports lie.
// shown(name, segments, position, scale, patience): the picture of an export, once Neuroglancer has asked for nothing
// for a while; patience: tenths of seconds of that. position in nanometres, scale in nanometres of the picture's height.
// asked: what it has asked for since: {path, begin, bytes}.
export async function with_neuroglancer(data, test) {
  const client = mkdtempSync(join(tmpdir(), "voxweld-client-")), asked = [];
  process.on("exit", () => rmSync(client, { recursive: true, force: true }));
  const options = browser_options();
  await bundle(client);
  const server = createServer((...of) => answer(data, client, asked, ...of)).listen(0, "127.0.0.1");
  await new Promise((done) => server.on("listening", done));
  const browser = await puppeteer.launch({ ...options, protocolTimeout: 600000 });
  try {
    await test({ asked, shown: (...how) => shown(browser, server.address().port, asked, ...how) });
  } finally {
    await browser.close();
    server.close();
  }
}
