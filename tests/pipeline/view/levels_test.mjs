// Drives the page of `voxweld view` on a mesh with levels of detail: coarse from afar and fine nearby, never a hole
// where levels meet or change, and memory below its cap.
// Usage: node levels_test.mjs VOXWELD
// Exits 77 as page_test.mjs does, and where esbuild or three is missing.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { look, patience_ms, place, run, run_tests, skip } from "./viewer.mjs";

const here = dirname(fileURLToPath(import.meta.url)), require = createRequire(import.meta.url);

// How gaps are seen (tests/clients/README.md), as a script for the page.
async function seeing_script() {
  let esbuild;
  try {
    esbuild = require("esbuild");
    require.resolve("three");
  } catch {
    skip("esbuild or three is not installed; run tests/npm_packages.sh");
  }
  const contents = `import { through } from "../../clients/seen.mjs";
    import { WebGLRenderer } from "three";
    export { through };
    // Without smoothing, which would make a narrow gap a faint one.
    export const renderer = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
    renderer.setSize(900, 700, false);`;
  const { outputFiles } = await esbuild.build({
    stdin: { contents, resolveDir: here }, bundle: true, format: "iife", globalName: "seen", write: false, logLevel: "error",
  });
  return `delete window.__THREE__; // else three complains of being there twice
    ${outputFiles[0].text} window.seen = seen;`;
}

const name = "gyroid.mesh";

function make_mesh() {
  run("phantom", "gyroid", "--size", "128", "-o", "gyroid.nrrd");
  writeFileSync(join(place, "gyroid.toml"),
    `[input]\npath = "gyroid.nrrd"\n[surface]\nisovalue = 32767.5\ninside = "below"\n` +
    `[output]\nlevels = "auto"\nformats = ["glb"]\nmerged = false\nreport = false\ntile_vertices = 4000\n`);
  run("run", "gyroid.toml");
  return JSON.parse(readFileSync(join(place, name, "manifest.json"))).levels;
}

// A mesh for each label.
const labelled = "labels.mesh";
function make_labels() {
  run("phantom", "labels", "--size", "96", "-o", "labels.nrrd");
  writeFileSync(join(place, "labels.toml"),
    `[input]\npath = "labels.nrrd"\n[labels]\nmode = "each"\n` +
    `[output]\nlevels = "auto"\nformats = ["glb"]\nreport = false\ntile_vertices = 4000\n`);
  run("run", "labels.toml");
  return JSON.parse(readFileSync(join(place, labelled, "manifest.json")));
}

const seeing = await seeing_script(), levels = make_mesh();
const [finest, coarsest] = [levels[0], levels.at(-1)];

async function open(visit, what = name) {
  const { page } = await visit(what);
  await page.evaluate(seeing);
  return page;
}

// From so many radii away, a little to the side; the picture's middle is the mesh's.
const stand = (page, radii) => look(page, `
  const { camera, sphere } = view.stage, away = sphere.radius / 1.15 * ${radii};
  view.movement.touched = true;
  camera.position.set(0.3, -1, 0.25).normalize().multiplyScalar(away).add(sphere.center);
  view.movement.target.copy(sphere.center);
  view.movement.orbit.update();`);

const settle = async (page) => {
  await page.evaluate(() => window.voxweld.view.stage.draw_now());
  await page.waitForFunction(() => window.voxweld.state.status === "ready", { timeout: patience_ms });
};

// What is in sight: triangles, tiles by depth in the tileset (0: the coarsest), and pixels that show a gap. A pixel
// may be lost where the picture's edge cuts a triangle: then it is seen again, turned a little.
const sight = (page) => page.evaluate(() => {
  const { stage, surface, tileset } = window.voxweld.view, { through, renderer } = window.seen, tiles = {};
  stage.draw_now(); // which chooses the tiles for where the camera is
  const camera = stage.camera.clone();
  let gaps, turns = 0;
  do {
    camera.rotateZ(0.05 * turns);
    camera.updateMatrixWorld(true);
    gaps = through(renderer, stage.scene, camera).wrong;
  } while (gaps > 0 && ++turns < 4);
  for (const { about } of surface.items) if (about.parent?.parent) tiles[-about.level] = (tiles[-about.level] ?? 0) + 1;
  return { gaps, tiles, depths: Object.keys(tiles).length, triangles: tileset.visible_triangles() };
});

// As a user moves a slider of the panel.
const slide = (page, title, value) => page.evaluate((name, at) => {
  const slider = [...document.querySelectorAll("#panel input[type=range]")].find((input) => input.title === name);
  slider.value = at;
  slider.dispatchEvent(new Event("input"));
}, title, value);
const panel_says = (page, what) => page.waitForFunction((text) => new RegExp(text).test(document.getElementById("panel").innerText),
  { timeout: patience_ms }, what.source);

const tests = {
  // Also where tiles were loaded that are not in sight.
  async "the first view has the mesh in its middle"(visit) {
    const page = await open(visit);
    for (const pixels of [2, 8, 0.5]) {
      await look(page, `view.tileset.set_error(${pixels})`);
      await settle(page);
      const off = await page.evaluate(() => {
        const { movement, stage } = window.voxweld.view;
        window.voxweld.view.tileset.on_loaded();
        return { touched: movement.touched, share: movement.target.length() / stage.sphere.radius };
      });
      assert.equal(off.touched, false);
      assert.ok(off.share < 0.1, `at ${pixels} pixels the view's middle is ${off.share} radii off the mesh's`);
    }
  },

  async "coarse from afar, fine nearby, coarse again; and no gap at any mix"(visit) {
    const page = await open(visit), found = [];
    for (const radii of [60, 2, 1.2, 60]) {
      await stand(page, radii);
      await settle(page);
      found.push(await sight(page));
      assert.equal(found.at(-1).gaps, 0, `${radii} radii away: ${JSON.stringify(found.at(-1))}`);
    }
    const [far, middle, near, again] = found;
    assert.equal(far.triangles, coarsest.triangles);
    assert.ok(middle.depths > 1 && middle.triangles > far.triangles && middle.triangles < finest.triangles, JSON.stringify(middle));
    assert.equal(near.triangles, finest.triangles);
    assert.deepEqual(again, far);
  },

  async "while tiles load no gap is seen either, and a tile that is missing is"(visit) {
    const { page, complaints } = await visit(name);
    await page.evaluate(seeing);
    await look(page, "view.tileset.tiles.lruCache.minBytesSize = 0"); // nothing stays that is out of sight
    const mixes = new Set();
    for (const [radii, pixels] of [[60, 8], [2.5, 4], [1.4, 0.5], [3, 8]]) {
      await look(page, `view.tileset.set_error(${pixels})`);
      await stand(page, radii);
      for (let status = "loading"; status === "loading"; status = await page.evaluate(() => window.voxweld.state.status)) {
        const seen = await sight(page);
        assert.equal(seen.gaps, 0, `${radii} radii away, at ${pixels} pixels: ${JSON.stringify(seen)}`);
        mixes.add(JSON.stringify(seen.tiles));
      }
    }
    assert.ok(mixes.size > 3, `tiles by depth: ${[...mixes].join(" ")}`);
    await look(page, "view.tileset.set_error(2)"); // several tiles
    await settle(page);
    const hidden = await page.evaluate(() => {
      const { surface, stage } = window.voxweld.view, { through, renderer } = window.seen;
      const { mesh } = [...surface.items].find(({ about }) => about.parent?.parent);
      mesh.visible = false;
      return through(renderer, stage.scene, stage.camera).wrong;
    });
    assert.ok(hidden > 100, `${hidden} pixels where a tile is missing`);
    // This test looks elsewhere while tiles load: those that are out of sight by then the page gives up itself.
    const given_up = (text) => /\.glb: net::ERR_ABORTED$/.test(text);
    complaints.splice(0, complaints.length, ...complaints.filter((text) => !given_up(text)));
  },

  async "the sliders set how fine and how much, and the panel tells what that came to"(visit) {
    const page = await open(visit);
    await stand(page, 2.5);
    await slide(page, "Error in pixels", 0);
    await settle(page);
    const fine = await sight(page);
    await panel_says(page, new RegExp(`1 px[^]*1024 MiB[^]*${finest.tiles} tiles in sight, [0-9]+ loaded, [0-9.]+ MB in memory`));
    await slide(page, "Error in pixels", 6);
    await settle(page);
    const coarse = await sight(page);
    assert.deepEqual([fine.triangles, coarse.triangles], [finest.triangles, coarsest.triangles]);
    await panel_says(page, /64 px[^]*1 tiles? in sight/);
    await slide(page, "Memory for tiles", 7);
    await panel_says(page, /128 MiB/);
  },

  async "an exported folder shows the same from any web server"(visit) {
    run("view", name, "--export", "gyroid.page");
    const seen = [];
    for (const what of [name, "gyroid.page"]) {
      const { page } = await visit(what);
      await page.evaluate(seeing);
      await stand(page, 3);
      await settle(page);
      seen.push(await sight(page));
    }
    assert.deepEqual(seen[1], seen[0]);
    assert.equal(seen[1].gaps, 0);
  },

  async "labels are a few tiles from afar and a file each from nearby, with names, colours and without gaps"(visit) {
    const { levels: of_labels, counts } = make_labels(), page = await open(visit, labelled);
    // Of what is in sight the labels, and how many triangles each shows.
    const labels = () => page.evaluate(() => {
      const { surface, tileset } = window.voxweld.view, shown = new Set();
      let files = 0, drawn = 0;
      for (const { piece, mesh, about } of surface.items) {
        if (!about.parent?.parent) continue;
        ++files;
        for (const { inside } of piece.pairs ?? []) shown.add(inside);
        if (mesh.visible) drawn += Math.min(piece.geometry.drawRange.count / 3, piece.triangles);
      }
      return { labels: shown.size, files, drawn, triangles: tileset.visible_triangles(), mode: surface.mode };
    });
    const found = [];
    const go_to = async ([radii, pixels]) => {
      await look(page, `view.tileset.set_error(${pixels})`);
      await stand(page, radii);
      await settle(page);
    };
    for (const where of [[60, 2], [2.5, 2], [2.5, 0.2]]) {
      await go_to(where);
      const seen = await sight(page);
      assert.equal(seen.gaps, 0, `${where}: ${JSON.stringify(seen)}`);
      found.push(await labels());
    }
    const [far, between, near] = found;
    assert.ok(between.triangles > far.triangles && between.triangles < near.triangles, JSON.stringify(found));
    assert.equal(far.triangles, of_labels.at(-1).triangles);
    assert.deepEqual([far.files, far.labels, far.mode], [1, counts.labels, "label"]);
    assert.deepEqual([near.triangles, near.files, near.labels], [of_labels[0].triangles, counts.labels, counts.labels]);
    const [first] = readFileSync(join(place, labelled, "labels.jsonl"), "utf8").split("\n");
    for (const where of [[60, 2], [2.5, 0.2]]) {
      await go_to(where);
      await look(page, `view.labels.show_only("${JSON.parse(first).label}"); view.surface.labels_changed()`);
      const one = await labels();
      assert.ok(one.drawn > 0 && one.drawn < one.triangles / 20, JSON.stringify(one));
      await look(page, `view.labels.show_all(true); view.surface.labels_changed()`);
      assert.equal((await labels()).drawn, one.triangles);
    }
  },

  async "memory stays below its cap, and a coarser surface has no gap"(visit) {
    const page = await open(visit), cap = 5; // MiB; all tiles take 12
    await stand(page, 60);
    await look(page, `view.tileset.set_cap(${cap})`);
    const bytes = () => page.evaluate(() => (window.voxweld.view.stage.draw_now(), window.voxweld.state.cached_bytes));
    await page.waitForFunction((most) => (window.voxweld.view.stage.draw_now(), window.voxweld.state.cached_bytes <= most),
      { timeout: patience_ms }, cap * 2 ** 20);
    await look(page, "view.tileset.set_error(0.5)");
    await stand(page, 1.6);
    await panel_says(page, /memory is full/);
    const seen = await sight(page), used = await bytes();
    assert.equal(seen.gaps, 0, JSON.stringify(seen));
    assert.ok(seen.triangles < finest.triangles, "not all of it");
    assert.ok(used < (cap + 1) * 2 ** 20, `${used} bytes`);
  },
};
await run_tests(tests);
