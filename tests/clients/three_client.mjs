// three.js in a headless Chromium: the merged .glb and the tiles of each level are drawn. Tiles of one level, and of
// random mixes of levels, are looked at from outside and from inside: at each pixel as many fronts as backs of
// triangles lie behind each other, or from inside one back more. So there is no gap.
// Usage: node three_client.mjs OUT_FOLDER OUTPUT ...
import { existsSync } from "node:fs";
import { join, relative } from "node:path";
import { checks, need, save_picture, with_page } from "./browser.mjs";
import { clearance, inside_points, is_inside } from "./inside.mjs";
import { cuts_of, random_numbers, read_tileset } from "./tileset_tree.mjs";

await need("three");
const [, , out, ...outputs] = process.argv, { say, check, end } = checks("three"), mixes = 8, labelled = ["cells", "frog"];

async function merged(page, name) {
  for (const file of ["mesh.glb", "mesh.meshopt.glb", "mesh.plain.glb"]) {
    if (!existsSync(join(out, `${name}.mesh`, file))) continue;
    await page.evaluate(() => window.client.forget());
    const triangles = await page.evaluate((url) => window.client.show([url]), `/data/${name}.mesh/${file}`);
    const seen = await page.evaluate(() => window.client.picture([1, 0.7, 1.3])), surface = 1 - seen.background / seen.all;
    const saved = await save_picture(page, join(out, `three_${name}_${file.replace(/\.glb$/, "")}.png`));
    check(Math.abs(saved - surface) < 0.02, `${name} ${file}: the surface fills ${saved} of the saved picture, not ${surface}`);
    say(`${name} ${file}: ${triangles} triangles, ${(100 * surface).toFixed(1)} % of the picture, ${seen.colours} colours`);
    check(surface > 0.1 && surface < 0.9, `${name} ${file}: the surface fills ${surface}`);
    check(!labelled.includes(name) || seen.colours > 30, `${name} ${file}: ${seen.colours} colours`);
  }
}

async function tiles(page, name) {
  const tileset = read_tileset(join(out, `${name}.mesh/tileset.json`)), cuts = cuts_of(tileset.root, mixes), next = random_numbers(7);
  const size = Math.hypot(...tileset.root.box.slice(3)), points = inside_points(cuts[0][1], 3, next), shared = labelled.includes(name);
  await page.evaluate(() => window.client.forget());
  const sum = { outside: 0, inside: 0, pixels: 0, gaps: 0, turned: 0, left_out: 0, most: 0 };
  const add = ({ all, wrong, empty, most }, where, inside) => {
    const gaps = shared ? (inside ? empty : 0) : wrong; // triangles between two labels have no outside
    check(gaps === 0, `${name} ${where}: ${gaps} of ${all} pixels show a gap`);
    check(most < 255, `${name} ${where}: too many layers to count`);
    sum.pixels += all;
    sum.gaps += gaps;
    sum.most = Math.max(sum.most, most);
    sum[inside ? "inside" : "outside"] += 1;
  };
  // What the test would see of a gap: a whole tile is missing. (Of grains each is closed by itself.)
  if (!shared && name !== "grains") {
    const urls = cuts[0][1].slice(1).map(({ path }) => `/data/${relative(out, path)}`);
    await page.evaluate((list) => window.client.show(list), urls);
    const { layers } = await page.evaluate(() => window.client.picture([1, 0.7, 1.3]));
    check(layers.wrong > 0, `${name}: a missing tile is not seen`);
  }
  for (const [cut, nodes] of cuts) {
    const urls = nodes.map(({ path }) => `/data/${relative(out, path)}`);
    const triangles = await page.evaluate((list) => window.client.show(list), urls);
    check(triangles === nodes.reduce((all, { corners }) => all + corners.length / 3, 0), `${name} ${cut}: ${triangles} triangles`);
    const seen = await page.evaluate(() => window.client.picture([1, 0.7, 1.3])), surface = 1 - seen.background / seen.all;
    check(surface > 0.1 && surface < 0.9, `${name} ${cut}: the surface fills ${surface}`);
    if (!shared) add(seen.layers, `${cut}, from outside`, false);
    if (cut.startsWith("level") || cut === "mix 1") await save_picture(page, join(out, `three_${name}_${cut.replace(" ", "_")}.png`));
    for (const { point } of points) {
      const near = clearance(nodes, point) / 2; // and so nothing is cut off
      if (near < 1e-4 * size || (!shared && !is_inside(nodes, point))) {
        sum.left_out += 1; // the middle of a thin wall may lie outside of a coarse mesh, or on it
        continue;
      }
      const [x, y, z] = point; // glTF's y is up
      // A pixel may be lost where triangles are cut at the edges of the picture. A gap is there however one turns, and
      // when one looks nearer.
      let found, turns = 0;
      do found = await page.evaluate((...where) => window.client.around(...where), [x, z, -y], near, size, 0.3 * turns, turns === 3);
      while ((shared ? found.empty : found.wrong) > 0 && ++turns < 4);
      sum.turned += turns;
      add(found, `${cut}, from inside at ${point.map((p) => p.toPrecision(4))}`, true);
    }
  }
  say(`${name}: ${cuts.length} choices of tiles (${mixes} mixes), looked at ${sum.outside} times from outside and ${sum.inside} times around from inside: ` +
    `${sum.gaps} of ${sum.pixels} pixels show a gap (up to ${sum.most} layers); ${sum.turned} looks repeated, ${sum.left_out} points left out, outside of a coarse mesh`);
  check(sum.inside >= cuts.length, `${name}: only ${sum.inside} looks from inside`);
}

end(await with_page(out, "three_page.html", /^$/, async (page) => {
  for (const name of outputs) {
    await merged(page, name);
    await tiles(page, name);
  }
}));
