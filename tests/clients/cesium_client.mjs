// CesiumJS in a headless Chromium: it opens tileset.json and chooses tiles itself, for several errors on the screen.
// From inside of the closed mesh no pixel shows the background. Of labels, a click tells the labels on both sides of
// the triangle: those of the volume there.
// Usage: node cesium_client.mjs OUT_FOLDER OUTPUT ...
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { gunzipSync } from "node:zlib";
import { checks, need, save_picture, with_page } from "./browser.mjs";
import { clearance, inside_points, is_inside } from "./inside.mjs";
import { cut_of, random_numbers, read_tileset } from "./tileset_tree.mjs";

await need("cesium");
const [, , out, ...outputs] = process.argv, { say, check, end } = checks("cesium"), labelled = ["cells", "frog"];
const directions = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

async function look(page, name) {
  const tileset = read_tileset(join(out, `${name}.mesh/tileset.json`)), shared = labelled.includes(name);
  const finest = cut_of(tileset.root, () => false), top = cut_of(tileset.root, () => true);
  await page.evaluate((url) => window.client.open(url), `/data/${name}.mesh/tileset.json`);
  // Without a graphics card more than a thousand tiles take CesiumJS a second a picture: of these, coarse ones only.
  const many = finest.length > 500, ways = [[0.05, 2.5], [2, 2.5], [8, 1.5], [200, 2.5]].slice(many ? 2 : 0), seen_counts = [];
  for (const [pixels, distance] of ways) {
    const found = await page.evaluate((...how) => window.client.picture(...how), [1, -1.3, 0.7], pixels, distance);
    const where = `${name} at ${pixels} pixels from ${distance} radii`, surface = 1 - found.background / found.all;
    check(found.failures.length === 0, `${where}: ${found.failures.join()}`);
    check(surface > 0.05, `${where}: the surface fills ${surface}`);
    check(!shared || found.colours > 30, `${where}: ${found.colours} colours`);
    seen_counts.push(found.triangles);
    const saved = await save_picture(page, join(out, `cesium_${name}_${pixels}px_${distance}r.png`));
    check(Math.abs(saved - surface) < 0.02, `${where}: the surface fills ${saved} of the saved picture, not ${surface}`);
  }
  const count = (nodes) => nodes.reduce((all, { corners }) => all + corners.length / 3, 0);
  check(many || seen_counts[0] === count(finest), `${name}: ${seen_counts[0]} triangles, the mesh has ${count(finest)}`);
  check(seen_counts.at(-1) === count(top), `${name}: ${seen_counts.at(-1)} triangles, the coarsest level has ${count(top)}`);
  let pixels_seen = 0, gaps = 0, looks = 0, mixed = 0, fronts = 0;
  for (const { point } of inside_points(finest, 1, random_numbers(7)))
    for (const pixels of many ? [40] : [4, 40]) {
      if (!shared && !is_inside(top, point)) continue; // a thin wall, outside of the coarsest mesh
      const near = Math.min(clearance(finest, point), clearance(top, point)) / 4;
      for (const direction of directions) {
        const found = await page.evaluate((...how) => window.client.inside(...how), point, direction, pixels, near);
        check(found.background === 0, `${name}: from inside at ${point} towards ${direction}, at ${pixels} pixels: ${found.background} pixels of background`);
        pixels_seen += found.all;
        gaps += found.background;
        fronts += shared ? 0 : found.fronts;
        looks += 1;
        mixed += found.kinds > 1;
      }
    }
  check(looks > 0, `${name}: no point inside`);
  say(`${name}: ${seen_counts.join(", ")} triangles from outside; ${looks} looks from inside, ${mixed} with several levels: ${gaps} of ${pixels_seen} pixels show the background` +
    (shared ? "" : `, ${fronts} the front of a triangle`));
}

// The label of a sample, by nearest place in metres: of a volume that voxweld phantom wrote.
function volume_of(path) {
  const file = readFileSync(path), end_of_head = file.indexOf("\n\n"), head = file.toString("latin1", 0, end_of_head);
  const [nx, ny, nz] = head.match(/sizes: (\d+) (\d+) (\d+)/).slice(1).map(Number);
  const bytes = /encoding: gz/.test(head) ? gunzipSync(file.subarray(end_of_head + 2)) : file.subarray(end_of_head + 2);
  const samples = new Uint16Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + 2 * nx * ny * nz)), spacing = 0.0005;
  return (place) => {
    const [x, y, z] = place.map((p) => Math.round(p / spacing));
    return x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz ? 0 : samples[x + nx * (y + ny * z)];
  };
}

async function clicks(page) {
  const label_at = volume_of(join(out, "cells.nrrd")), next = random_numbers(3), found = { hits: 0, misses: 0, right: 0 }, pairs = new Set();
  await page.evaluate((url) => window.client.open(url), "/data/cells.mesh/tileset.json");
  for (const pixels of [0.05, 8]) {
    await page.evaluate((...how) => window.client.picture(...how), [1, -1.3, 0.7], pixels, 2.5);
    for (let i = 0; i < 40; ++i) {
      const picked = await page.evaluate((...at) => window.client.pick(...at), 250 + 400 * next(), 150 + 400 * next());
      if (!picked) {
        found.misses += 1;
        continue;
      }
      found.hits += 1;
      // Behind what is seen, along the ray: within two samples the label has to be there.
      // Nothing is outside, for which the table has the number that stands for none.
      const { inside, outside } = picked.properties;
      const behind = [0.5, 1, 1.5, 2, 2.5].map((n) => String(label_at(picked.place.map((x, k) => x + n * 0.0005 * picked.direction[k]))));
      pairs.add(`${inside} ${outside}`);
      found.right += behind.includes(inside) && outside === "undefined" && picked.properties.inside_name === `cell ${inside}`;
    }
  }
  say(`cells: ${found.hits} clicks picked a feature, ${found.misses} nothing; ${found.right} the label that the volume has there, with its name; ${pairs.size} pairs of labels`);
  check(found.hits > 40, `cells: only ${found.hits} clicks picked a feature`);
  check(found.right >= 0.95 * found.hits, `cells: only ${found.right} of ${found.hits} clicks tell the label`);
}

end(await with_page(out, "cesium_page.html", /^$/, async (page) => {
  for (const name of outputs) await look(page, name);
  if (outputs.includes("cells")) await clicks(page);
}));
