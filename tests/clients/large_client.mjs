// An output of any size, as a client draws it: from afar, nearer, before a face, and at the middle from outside and
// from inside of the surface. Prints what each look cost. No gap may be seen; in CesiumJS, from inside no background.
// Usage: node large_client.mjs CLIENT PROGRAM OUTPUT PICTURES [PIXELS]
// CLIENT: view (the page of `PROGRAM view`), tiles-renderer or cesium. PIXELS: the error on the screen, else 2.
import { spawn } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { is_back } from "../pipeline/view/picture.mjs";
import { checks, need, save_picture, with_page } from "./browser.mjs";
import { clearance, inside_points } from "./inside.mjs";
import { random_numbers, read_tileset } from "./tileset_tree.mjs";

const [, , client, program, given, pictures, pixels_text = "2"] = process.argv, pixels = Number(pixels_text);
const output = resolve(given), { say, check, end } = checks(`${client} large`);
const here = dirname(fileURLToPath(import.meta.url)), require = createRequire(import.meta.url);
const directions = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
await need(...{ view: ["three", "esbuild"], "tiles-renderer": ["three", "3d-tiles-renderer"], cesium: ["cesium"] }[client]);

// The finest tiles near the middle, which alone are decoded here.
function middle_of(path) {
  const { root } = JSON.parse(readFileSync(path, "utf8")), box = root.boundingVolume.box;
  const near = ({ children, boundingVolume: { box: b } }) =>
    !children?.length && [0, 1, 2].every((k) => Math.abs(b[k] - box[k]) <= b[3 + 4 * k] + 0.02 * box[3 + 4 * k]);
  return { box, nodes: read_tileset(path, near).nodes.filter(({ positions }) => positions) };
}

// MB of the browser's processes, what they share once.
function browser_memory(pid) {
  const parents = new Map();
  for (const name of readdirSync("/proc").filter((one) => /^\d+$/.test(one)))
    try {
      parents.set(Number(name), Number(readFileSync(`/proc/${name}/stat`, "utf8").split(") ")[1].split(" ")[1]));
    } catch { /* has ended */ }
  const own = (one) => one === pid || (parents.has(one) && own(parents.get(one)));
  let sum = 0;
  for (const one of parents.keys())
    try {
      if (own(one)) sum += Number(readFileSync(`/proc/${one}/smaps_rollup`, "utf8").match(/Pss: +(\d+)/)[1]);
    } catch { /* has ended */ }
  return Math.round(sum / 1024);
}

const MB = (bytes) => (bytes / 1e6).toFixed(1);

// One place, in some directions.
async function look(page, name, asks, within) {
  const sum = { seconds: 0, triangles: 0, tiles: 0, levels: 0, gaps: 0, lost: 0 };
  for (const ask of asks) {
    const start = performance.now(), found = await ask(), { wrong, gaps, most } = found.layers ?? found;
    sum.seconds += (performance.now() - start) / 1000;
    check(found.failures.length === 0, `${name}: ${found.failures.join()}`);
    check(!(most >= 255), `${name}: too many triangles behind each other to be counted`);
    if (client !== "cesium") sum.lost += wrong - gaps;
    sum.gaps += client !== "cesium" ? gaps : within ? found.background : 0;
    for (const what of ["triangles", "tiles"]) sum[what] = Math.max(sum[what], found[what]);
    sum.levels = Math.max(sum.levels, found.kinds);
  }
  const { seconds, bytes } = await page.evaluate(() => window.client.cost(2));
  const loaded = await page.evaluate(() => performance.getEntriesByType("resource")
    .filter(({ name: from }) => /\.(glb|json)$/.test(from)).map(({ encodedBodySize }) => encodedBodySize));
  // The page of voxweld has a panel over its canvas.
  const shown = client === "view" ? page : await page.$("canvas");
  const share = await save_picture(shown, join(pictures, `large_${client}_${name}.png`), client === "view" ? is_back : undefined);
  say(`${client} ${name}: ${sum.triangles} triangles in ${sum.tiles} tiles of ${sum.levels} errors, ${sum.gaps} pixels of gaps${sum.lost > 0 ? ` (${sum.lost} lost by the renderer)` : ""}, ` +
    `surface ${(100 * share).toFixed(0)} %; still after ${sum.seconds.toFixed(1)} s, ${seconds.toFixed(2)} s a picture; ` +
    `so far ${loaded.length} files, ${MB(loaded.reduce((a, b) => a + b, 0))} MB; tiles ${MB(bytes)} MB, browser ${browser_memory(page.browser().process().pid)} MB`);
  check(sum.gaps === 0, `${name}: ${sum.gaps} pixels show a gap`);
  check(sum.triangles > 0 && share > 0.002, `${name}: ${sum.triangles} triangles, the surface fills ${share}`);
  return sum;
}

async function looks(page) {
  const { box, nodes } = middle_of(join(output, "tileset.json")), radius = Math.hypot(box[3], box[7], box[11]);
  await page.evaluate((url) => {
    performance.setResourceTimingBufferSize(1e5);
    window.client.closely = true;
    return window.client.open(url);
  }, `/data/${basename(output)}/tileset.json`);
  const from = (...how) => page.evaluate((...all) => window.client.picture(...all), ...how);
  const at = (...how) => page.evaluate((...all) => window.client.inside(...all), ...how);
  const outside = (distance) => [() => from([1, -1.3, 0.7], pixels, distance)];
  const around = (point, near, within, ways = directions) => ways.map((way) => () => at(point, way, pixels, near, within));
  const far = await look(page, "far", outside(10), false);
  await look(page, "medium", outside(2.5), false);
  const before = [box[0], box[1] - 1.06 * box[7], box[2]];
  const face = await look(page, "face", around(before, 0.01 * box[7], false, [[0.05, 1, 0.02]]), false);
  check(far.triangles < face.triangles, `${far.triangles} triangles from afar, ${face.triangles} before a face`);
  for (const within of [false, true]) {
    const [{ point }] = inside_points(nodes, 1, random_numbers(7), { outside: !within });
    const near = clearance(nodes, point) / 8;
    say(`${client}: ${within ? "inside" : "outside"} at ${point.map((x) => x.toPrecision(6)).join(", ")}, ${(near * 8 / radius).toPrecision(2)} radii from the surface`);
    await look(page, within ? "inside" : "hollow", around(point, near, within), within);
    if (client !== "tiles-renderer") continue;
    const { gaps } = await page.evaluate((...how) => window.client.moved(...how), near / 50, within);
    say(`${client}: ${gaps} pixels of gaps with every second tile moved by ${(near / 50).toPrecision(2)}`);
    check(gaps > 0, "no gap is seen where tiles are out of their places");
  }
  await look(page, "far_again", outside(10), false);
}

async function serve() {
  const server = spawn(program, ["view", output], { stdio: ["ignore", "pipe", "inherit"] });
  process.on("exit", () => server.kill("SIGINT"));
  const address = await new Promise((done, failed) => {
    server.stdout.on("data", (text) => done(String(text).match(/http:\S+/)[0]));
    server.on("exit", (code) => failed(new Error(`${program} view ended with ${code}`)));
    server.on("error", failed);
  });
  const { outputFiles } = await require("esbuild").build({
    entryPoints: [join(here, "large_view_page.mjs")], bundle: true, format: "iife", write: false, logLevel: "error",
  });
  // Else three complains of being there twice.
  const script = `new Promise((done) => {
    const wait = () => window.voxweld?.view ? done() : setTimeout(wait, 50);
    wait();
  }).then(() => { delete window.__THREE__; ${outputFiles[0].text} })`;
  return { address, script };
}

const expected = /tiles versions at 1.1 or higher have limited support/;
if (client === "view") {
  const { address, script } = await serve();
  end(await with_page(dirname(output), address, expected, looks, script));
} else end(await with_page(dirname(output), client === "cesium" ? "cesium_page.html" : "tiles_page.html", expected, looks));
