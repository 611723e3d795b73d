// 3d-tiles-renderer in a headless Chromium: it opens tileset.json and chooses tiles itself, for several errors on the
// screen and distances. From outside and from inside, as many fronts as backs of triangles lie behind each other at
// each pixel, or one back more: no gap at the mixes of levels that it chooses.
// Usage: node tiles_renderer_client.mjs OUT_FOLDER OUTPUT ...
import { join } from "node:path";
import { checks, need, save_picture, with_page } from "./browser.mjs";
import { clearance, inside_points, is_inside } from "./inside.mjs";
import { cut_of, height_of, random_numbers, read_tileset } from "./tileset_tree.mjs";

await need("three", "3d-tiles-renderer");
const [, , out, ...outputs] = process.argv, { say, check, end } = checks("tiles-renderer"), labelled = ["cells", "frog"];
const directions = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

async function look(page, name) {
  const tileset = read_tileset(join(out, `${name}.mesh/tileset.json`)), shared = labelled.includes(name);
  const finest = cut_of(tileset.root, () => false), top = cut_of(tileset.root, () => true);
  const size = Math.hypot(...tileset.root.box.slice(3));
  await page.evaluate((url) => window.client.open(url), `/data/${name}.mesh/tileset.json`);
  const sum = { looks: 0, mixed: 0, pixels: 0, gaps: 0, most: 0 }, seen_counts = [];
  const add = ({ all, wrong, empty, failures, kinds }, where, inside) => {
    const gaps = shared ? (inside ? empty : 0) : wrong;
    check(failures.length === 0, `${name} ${where}: ${failures.join()}`);
    sum.pixels += all;
    sum.gaps += gaps;
    sum.looks += 1;
    sum.mixed += kinds > 1;
    return gaps;
  };
  for (const [pixels, distance] of [[0.05, 2.5], [2, 2.5], [8, 1.5], [8, 6], [200, 2.5]]) {
    let found, turns = 0; // a pixel may be lost where triangles are cut at the picture's edges: then turned a little
    do found = await page.evaluate((...how) => window.client.picture(...how), [1, -1.3 + 0.1 * turns, 0.7], pixels, distance);
    while (!shared && found.layers.wrong > 0 && ++turns < 4);
    const where = `at ${pixels} pixels from ${distance} radii`, surface = 1 - found.background / found.all;
    check(add({ ...found, ...found.layers }, where, false) === 0, `${name} ${where}: gaps`);
    check(surface > 0.01, `${name} ${where}: the surface fills ${surface}`);
    seen_counts.push(found.triangles);
    const saved = await save_picture(page, join(out, `tiles-renderer_${name}_${pixels}px_${distance}r.png`));
    check(Math.abs(saved - surface) < 0.02, `${name} ${where}: the surface fills ${saved} of the saved picture, not ${surface}`);
  }
  const count = (nodes) => nodes.reduce((all, { corners }) => all + corners.length / 3, 0);
  check(seen_counts[0] === count(finest), `${name}: ${seen_counts[0]} triangles, the mesh has ${count(finest)}`);
  check(seen_counts[4] === count(top), `${name}: ${seen_counts[4]} triangles, the coarsest level has ${count(top)}`);
  for (const { point } of inside_points(finest, 2, random_numbers(7)))
    for (const pixels of [4, 40]) {
      const near = clearance(finest, point) / 8; // coarser tiles may be nearer than the finest
      for (const direction of directions) {
        let gaps, tries = 0; // as above
        do {
          const turned = direction.map((x, k) => x + 0.1 * tries * (k + 1));
          const found = await page.evaluate((...how) => window.client.inside(...how), point, turned, pixels, near);
          gaps = add(found, `${pixels} pixels`, true);
          if (gaps > 0) sum.gaps -= gaps;
        } while (gaps > 0 && ++tries < 4);
        if (gaps > 0 && !is_inside(cut_of(tileset.root, (node) => height_of(node) <= 1), point)) continue; // a thin wall
        check(gaps === 0, `${name}: from inside at ${point} towards ${direction}, at ${pixels} pixels: ${gaps} pixels show a gap`);
        sum.gaps += gaps;
      }
    }
  say(`${name}: ${seen_counts.join(", ")} triangles from outside; ${sum.looks} looks, ${sum.mixed} with several levels: ${sum.gaps} of ${sum.pixels} pixels show a gap`);
}

end(await with_page(out, "tiles_page.html", /tiles versions at 1.1 or higher have limited support/, async (page) => {
  for (const name of outputs) await look(page, name);
}));
