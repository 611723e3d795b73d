// Drives the page of `voxweld view` in a headless Chromium: that it loads all there is, without a word
// in the console, and that what is drawn is what it should be.
// Usage: node page_test.mjs VOXWELD
//        node page_test.mjs          whether puppeteer-core and Chromium are there
// Exits 77 where there is no Chromium, no puppeteer-core (tests/npm_packages.sh) or no viewer.
import assert from "node:assert/strict";
import { cpSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { feature_glb } from "./feature_glb.mjs";
import { make_meshes } from "./meshes.mjs";
import { difference, is_back, is_red, share } from "./picture.mjs";
import { tileset_of } from "./tileset.mjs";
import { look, patience_ms, picture, place, run, run_tests, triangles_of } from "./viewer.mjs";

const tests = {
  async "a run loads all of its tiles"(visit) {
    const { page } = await visit("gyroid.mesh");
    const state = await page.evaluate(() => window.voxweld.state);
    const tiles = readFileSync(join(place, "gyroid.mesh/tiles.jsonl"), "utf8").trim().split("\n").length;
    assert.ok(tiles > 3, `${tiles} tiles`);
    assert.equal(state.tiles_loaded, tiles);
    assert.equal(state.tiles_total, tiles);
    assert.equal(state.triangles, triangles_of("gyroid.mesh"));
    assert.equal(state.bytes_loaded, state.bytes_total);
    assert.deepEqual(state.errors, []);
    const image = await picture(page);
    assert.ok(share(image, is_back) > 0.1, "background around it");
    assert.ok(share(image, is_back) < 0.85, "a surface");
  },

  async "exported folders show the same from any web server"(visit) {
    for (const name of ["gyroid.mesh", "gyroid.mesh/mesh.drc"]) {
      const folder = `${name.replaceAll("/", "-")}.page`;
      run("view", name, "--export", folder);
      const pictures = [];
      for (const what of [name, folder]) {
        const { page } = await visit(what);
        assert.deepEqual(await page.evaluate(() => window.voxweld.state.errors), []);
        assert.equal(await page.evaluate(() => window.voxweld.state.triangles), triangles_of("gyroid.mesh"));
        pictures.push(await picture(page));
      }
      assert.ok(share(pictures[1], is_back) < 0.85, "a surface");
      assert.ok(difference(pictures[0], pictures[1]) < 0.001, "the same picture");
    }
  },

  async "a closed surface shows no background in its middle, and no back"(visit) {
    const { page } = await visit("solids.mesh");
    const image = await picture(page), middle = [0.3, 0.35, 0.44, 0.65]; // left of the panel
    assert.equal(share(image, is_back, middle), 0);
    assert.ok(share(image, is_red) < 0.0005, `backs: ${share(image, is_red)}`);
  },

  async "a cut is filled where material is cut, and open where that is wanted"(visit) {
    const { page } = await visit("solids.mesh");
    const whole = await picture(page);
    await look(page, "view.movement.frame([0, -1, 0]); view.set_cut(1, {on: true, at: 0.5, flipped: true})");
    const filled = await picture(page), middle = [0.3, 0.35, 0.44, 0.65];
    assert.equal(share(filled, is_back, middle), 0);
    assert.ok(share(filled, is_red) < 0.0005, "no back is seen");
    const shades = new Set();
    share(filled, (pixel) => (shades.add(pixel.join()), false), [0.34, 0.45, 0.38, 0.55]);
    assert.ok(shades.size <= 6, `a cap is plain: ${shades.size} shades`);
    await look(page, "view.set_caps(false)");
    assert.ok(share(await picture(page), is_red, middle) > 0.95, "backs are seen");
    await look(page, "view.set_cut(1, {on: false}); view.movement.reset()");
    assert.ok(difference(whole, await picture(page)) < 0.001, "as before");
  },

  async "lines, flat triangles, boxes and colours change the picture"(visit) {
    const { page } = await visit("gyroid.mesh");
    const plain = await picture(page);
    const changes = {
      lines: ["view.set_surface({wireframe: true})", "view.set_surface({wireframe: false})"],
      flat: ["view.set_surface({flat: true})", "view.set_surface({flat: false})"],
      boxes: ["view.set_boxes(true)", "view.set_boxes(false)"],
      normal: ["view.set_mode('normal')", "view.set_mode('plain')"],
      tile: ["view.set_mode('tile')", "view.set_mode('plain')"],
    };
    for (const [name, [on, off]] of Object.entries(changes)) {
      await look(page, on);
      assert.ok(difference(plain, await picture(page)) > 0.004, `${name} on`);
      await look(page, off);
      assert.equal(difference(plain, await picture(page)), 0, `${name} off`);
    }
  },

  async "keys do what the help says"(visit) {
    const { page } = await visit("gyroid.mesh");
    const state = () => page.evaluate(() => {
      const { surface, boxes, clipping, movement, help } = window.voxweld.view;
      return { lines: surface.wireframe, flat: surface.flat, boxes: boxes.visible, x: clipping.axes[0].on,
        caps: clipping.caps, fly: movement.flying, mode: surface.mode, help: help.dialog.open };
    });
    const first = await state();
    for (const [key, name] of Object.entries({ l: "lines", t: "flat", b: "boxes", x: "x", c: "caps", v: "fly", "?": "help" })) {
      await page.keyboard.press(key);
      assert.equal((await state())[name], !first[name], key);
      await page.keyboard.press(key);
      assert.deepEqual(await state(), first, `${key} again`);
    }
    await page.keyboard.press("2");
    assert.equal((await state()).mode, "normal");
    const before = await page.evaluate(() => window.voxweld.view.stage.camera.position.toArray());
    await page.keyboard.down("w");
    const moved = (from) => window.voxweld.view.stage.camera.position.toArray().join() !== from;
    await page.waitForFunction(moved, { timeout: patience_ms }, before.join());
    await page.keyboard.up("w");
  },

  async "a click tells the place"(visit) {
    const { page } = await visit("solids.mesh");
    await look(page, "view.movement.frame([0, 0, 1])"); // from above: the ball's top
    const middle = await page.evaluate(() => (innerWidth - document.getElementById("panel").offsetWidth) / 2);
    await page.mouse.click(middle, 320);
    const point = await page.evaluate(() => {
      const { voxel, world, name } = window.voxweld.state.point;
      return { voxel: voxel.toArray(), world: world.toArray(), name, text: document.getElementById("point").innerText };
    });
    for (const [found, wanted] of [[point.voxel, [20, 20, 35]], [point.world, [20, 20, 35]]])
      found.forEach((x, k) => assert.ok(Math.abs(x - wanted[k]) < 0.6, `${found}`));
    assert.match(point.name, /^tiles\/.*\.drc$/);
    assert.match(point.text, /Voxel/);
    await page.mouse.click(5, 320);
    assert.equal(await page.evaluate(() => window.voxweld.state.point), null);
  },

  async "a mirrored and turned volume lies in the world as its frame says"(visit) {
    run("phantom", "sphere", "--size", "32", "--type", "uint8", "-o", "ball.nrrd");
    const file = readFileSync(join(place, "ball.nrrd")), end = file.indexOf("\n\n");
    const head = file.toString("latin1", 0, end)
      .replace(/space dimension: 3/, "space: left-posterior-superior")
      .replace(/space directions: .*/, "space directions: (-0.5,0,0) (0,0,1) (0,1,0)")
      .replace(/space origin: .*/, "space origin: (100,50,-20000)");
    writeFileSync(join(place, "turned.nrrd"), Buffer.concat([Buffer.from(head, "latin1"), file.subarray(end)]));
    run("init", "turned.nrrd");
    run("run", "turned.toml");
    const { page } = await visit("turned.mesh");
    const image = await picture(page);
    assert.ok(share(image, is_back) < 0.8 && share(image, is_red) < 0.0005, `backs: ${share(image, is_red)}`);
    await look(page, "view.movement.frame([0, 0, 1])");
    const middle = await page.evaluate(() => (innerWidth - document.getElementById("panel").offsetWidth) / 2);
    await page.mouse.click(middle, 320);
    const { voxel, world } = await page.evaluate(() => {
      const { voxel, world } = window.voxweld.state.point;
      return { voxel: voxel.toArray(), world: world.toArray() };
    });
    [100 - 0.5 * voxel[0], 50 + voxel[2], -20000 + voxel[1]].forEach((x, k) => assert.ok(Math.abs(x - world[k]) < 0.01, `${world}`));
    assert.ok(voxel[1] > 20 && Math.abs(voxel[0] - 15.5) < 2 && Math.abs(voxel[2] - 15.5) < 2, `the top: ${voxel}`);
    await look(page, "view.set_cut(2, {on: true, at: 0.5}); view.movement.frame([0, 1, 0])");
    const cut = await picture(page);
    assert.ok(share(cut, is_back) < 0.9 && share(cut, is_red) < 0.0005, "what is cut is filled");
  },

  async "a link keeps the view"(visit) {
    const { page, again } = await visit("gyroid.mesh");
    await look(page, "view.movement.frame([1, 0, 0]); view.movement.touched = true; view.set_cut(2, {on: true, at: 0.4}); view.set_mode('tile'); view.set_surface({wireframe: true}); view.link.write()");
    const image = await picture(page), hash = await page.evaluate(() => location.hash);
    assert.match(hash, /camera=.*colour=tile.*lines=1.*cut=z/);
    assert.ok(difference(image, await picture((await again(hash)).page)) < 0.01);
    await again("#camera=1,2,x&colour=none&cut=q<9,x<,z>99&only=&hide=77&plain=zz"); // nothing of it holds
  },

  async "labels have their colours, and can be hidden"(visit) {
    for (const name of ["cells.mesh", "shared.mesh"]) {
      const { page } = await visit(name);
      const rows = readFileSync(join(place, name, "labels.jsonl"), "utf8").trim().split("\n").map((line) => JSON.parse(line));
      assert.equal(await page.evaluate(() => window.voxweld.view.labels.size), rows.length, name);
      assert.equal(await page.evaluate(() => window.voxweld.view.surface.mode), "label");
      assert.equal(await page.evaluate(() => window.voxweld.state.triangles), triangles_of(name), name);
      const all = await picture(page);
      const label = rows.sort((a, b) => b.triangles - a.triangles)[0].label;
      await look(page, `view.labels.show_only("${label}"); view.surface.labels_changed()`);
      const one = await picture(page);
      assert.ok(share(one, is_back) > share(all, is_back) + 0.02, name);
      const drawn = await page.evaluate(() => [...window.voxweld.view.surface.items].reduce((sum, { mesh, piece }) =>
        sum + (mesh.visible ? Math.min(piece.geometry.drawRange.count, piece.geometry.index.count) / 3 : 0), 0));
      assert.equal(drawn, rows[0].triangles, `${name}: its triangles and no others`);
      await look(page, `view.labels.show_all(false); view.surface.labels_changed()`);
      assert.equal(share(await picture(page), is_back), 1, `${name}: nothing`);
      await look(page, `view.labels.show_all(true); view.surface.labels_changed()`);
      assert.equal(difference(all, await picture(page)), 0, `${name}: all again`);
    }
  },

  async "the caps of labels have their colours"(visit) {
    for (const name of ["cells.mesh", "shared.mesh"]) {
      const { page } = await visit(name);
      await look(page, "view.movement.frame([0, -1, 0]); view.set_cut(1, {on: true, at: 0.5, flipped: true})");
      const image = await picture(page), colours = new Map();
      share(image, (pixel) => (colours.set(pixel.join(), (colours.get(pixel.join()) ?? 0) + 1), false));
      const plain = [...colours].filter(([colour, count]) => count > 400 && !is_back(colour.split(",").map(Number)));
      assert.ok(plain.length >= 8, `${name}: ${plain.length} plain areas`);
    }
  },

  async "single files of all formats"(visit) {
    const triangles = triangles_of("gyroid.mesh");
    for (const name of ["gyroid.mesh/mesh.drc", "gyroid.glb", "gyroid.ply", "gyroid.stl", "gyroid.obj"]) {
      const { page } = await visit(name);
      const state = await page.evaluate(() => window.voxweld.state);
      assert.deepEqual([state.triangles, state.errors], [triangles, []], name);
      assert.ok(share(await picture(page), is_back) < 0.85, name);
    }
    const { page } = await visit("shared.mesh/mesh.glb"); // labels that no list names
    assert.equal(await page.evaluate(() => window.voxweld.state.triangles), triangles_of("shared.mesh"));
    assert.ok((await page.evaluate(() => window.voxweld.view.labels.size)) > 5);
  },

  async "labels of triangles in .ply and .vtp, files and tiles"(visit) {
    const labels = (page) => page.evaluate(() => window.voxweld.view.labels.sorted().map(({ label }) => label));
    const drawn = async (page, label) => {
      await look(page, `view.labels.show_only("${label}"); view.surface.labels_changed()`);
      return page.evaluate(() => [...window.voxweld.view.surface.items].reduce((sum, { mesh, piece }) =>
        sum + (mesh.visible ? Math.min(piece.geometry.drawRange.count, piece.geometry.index.count) / 3 : 0), 0));
    };
    const rows = readFileSync(join(place, "shared.mesh/labels.jsonl"), "utf8").trim().split("\n").map((line) => JSON.parse(line));
    const wanted = rows.map(({ label }) => String(label)), [largest] = rows.sort((a, b) => b.triangles - a.triangles);
    for (const name of ["plain.mesh/mesh.ply", "plain.mesh/mesh.vtp", "plain.mesh", "shared.ply", "each.ply"]) {
      const { page } = await visit(name);
      const state = await page.evaluate(() => window.voxweld.state);
      assert.deepEqual(state.errors, [], name);
      assert.deepEqual(await labels(page), wanted, name);
      assert.equal(await page.evaluate(() => window.voxweld.view.surface.mode), "label", name);
      assert.equal(state.triangles, triangles_of(name === "each.ply" ? "cells.mesh" : "plain.mesh"), name);
      const count = await drawn(page, largest.label);
      if (name === "each.ply") assert.ok(count > 100 && count < state.triangles / 2, `${count} triangles`);
      else assert.equal(count, largest.triangles, name);
      assert.ok(share(await picture(page), is_back) > 0.5, name);
    }
    const { page } = await visit("gyroid.mesh/mesh.vtp"); // without labels, with normals
    assert.equal(await page.evaluate(() => window.voxweld.state.triangles), triangles_of("gyroid.mesh"));
    const covered = async (of) => share(await picture(of), is_back);
    assert.ok(Math.abs((await covered(page)) - (await covered((await visit("gyroid.ply")).page))) < 0.005, "as the .ply"); // the first view goes by some of the vertices
    const file = readFileSync(join(place, "plain.mesh/mesh.vtp"));
    writeFileSync(join(place, "half.vtp"), file.subarray(0, file.length / 2));
    writeFileSync(join(place, "text.vtp"), "<VTKFile/>");
    for (const [broken, says] of [["half.vtp", /ends after the file/], ["text.vtp", /is not written as voxweld writes/]])
      assert.match((await (await visit(broken)).page.evaluate(() => window.voxweld.state.errors)).join(), says);
  },

  async "labels as feature ids of a glTF"(visit) {
    writeFileSync(join(place, "features.glb"), feature_glb());
    const { page } = await visit("features.glb");
    const found = await page.evaluate(() => {
      const { labels, surface, space, state } = window.voxweld.view, [{ piece }] = surface.items;
      return { labels: labels.sorted().map(({ label }) => label), pairs: piece.pairs, mode: surface.mode,
        triangles: state.triangles, box: [...space.box.min.toArray(), ...space.box.max.toArray()] };
    });
    assert.deepEqual(found.labels, ["7", "9"]);
    assert.deepEqual(found.pairs, [{ inside: "7", outside: null }, { inside: "9", outside: "7" }]);
    assert.equal(found.mode, "label");
    assert.equal(found.triangles, 8);
    assert.deepEqual(found.box, [0, -2, 0, 6, 0, 2], "its node's place, and z up");
    await look(page, `view.labels.show("7", false); view.surface.labels_changed()`);
    assert.equal(await page.evaluate(() => [...window.voxweld.view.surface.items][0].piece.geometry.drawRange.count), 12);
  },

  async "labels are found by name and number"(visit) {
    const { page } = await visit("cells.mesh");
    const shown = () => page.evaluate(() => [...document.querySelectorAll("#labels .label")].map((row) => row.querySelector(".name").innerText));
    const all = await shown();
    assert.ok(all.length > 5);
    await page.type("#panel input[type=search]", all[1]);
    const some = await shown();
    assert.ok(some.includes(all[1]) && some.length < all.length && some.every((text) => text.startsWith(all[1])), `${some}`);
    const hidden = () => page.evaluate(() => window.voxweld.view.labels.hidden.size);
    await page.click("#labels .label input");
    assert.equal(await hidden(), 1);
    await page.evaluate(() => [...document.querySelectorAll("#panel button")].find((b) => b.innerText === "All").click());
    assert.equal(await hidden(), 0);
  },

  async "more triangles than can be wanted are asked for first"(visit) {
    cpSync(join(place, "gyroid.mesh"), join(place, "large.mesh"), { recursive: true });
    const list = join(place, "large.mesh/tiles.jsonl");
    const lines = readFileSync(list, "utf8").trim().split("\n").map((line) => JSON.parse(line));
    for (const line of lines) line.triangles = 15e6;
    writeFileSync(list, lines.map((line) => JSON.stringify(line) + "\n").join(""));
    const { page } = await visit("large.mesh");
    const state = await page.evaluate(() => window.voxweld.state);
    assert.ok(state.tiles_loaded > 0 && state.tiles_loaded < lines.length, `${state.tiles_loaded} of ${lines.length}`);
    assert.equal(state.tiles_loaded + state.left_out, lines.length);
    await page.click("#notes button");
    await page.waitForFunction((n) => window.voxweld.state.tiles_loaded === n && window.voxweld.state.status === "ready",
      { timeout: patience_ms }, lines.length);
  },

  async "a surface without triangles, and formats without a reader"(visit) {
    cpSync(join(place, "solids.mesh"), join(place, "empty.mesh"), { recursive: true });
    const list = join(place, "empty.mesh/tiles.jsonl"), tile = readFileSync(list, "utf8");
    writeFileSync(list, tile.replaceAll(".glb", ".abc").replaceAll(".drc", ".abc"));
    assert.match((await (await visit("empty.mesh")).page.evaluate(() => window.voxweld.state.errors)).join(), /reads none of the formats/);
    writeFileSync(list, "");
    const manifest = join(place, "empty.mesh/manifest.json"), { merged, files, ...rest } = JSON.parse(readFileSync(manifest));
    writeFileSync(manifest, JSON.stringify({ ...rest, merged: null, files: files.filter(({ role }) => role !== "merged") }));
    const { page } = await visit("empty.mesh");
    assert.match((await page.evaluate(() => window.voxweld.state.errors)).join(), /surface is empty/);
    await page.waitForFunction(() => document.getElementById("notes").innerText.includes("surface is empty"));
  },

  async "a tileset is loaded as the view needs"(visit) {
    tileset_of(join(place, "gyroid.mesh"));
    const { page, again } = await visit("gyroid.mesh");
    const all_shown = (of) => of.waitForFunction((n) => window.voxweld.state.triangles === n, { timeout: patience_ms }, triangles_of("gyroid.mesh"));
    await all_shown(page);
    const cut = (await again("#cut=y>0.5")).page; // before there is a tile
    await all_shown(cut);
    assert.ok(share(await picture(cut), is_red) < 0.001, "what is cut from the first is filled");
    rmSync(join(place, "gyroid.mesh/tileset.json"));
    assert.deepEqual(await page.evaluate(() => window.voxweld.state.errors), []);
    const image = await picture(page);
    assert.ok(share(image, is_back) > 0.1 && share(image, is_back) < 0.85);
    await look(page, "view.set_mode('level')");
    assert.ok(difference(image, await picture(page)) > 0.05);
    await look(page, "view.movement.frame([0, -1, 0]); view.set_cut(1, {on: true, at: 0.5, flipped: true})");
    assert.ok(share(await picture(page), is_red) < 0.001, "what is cut is filled");
    const text = await page.evaluate(() => document.getElementById("panel").innerText);
    assert.match(text, /TILESET|Tileset/);
  },

  async "a damaged tile is told, and the others are shown"(visit) {
    const tiles = readdirSync(join(place, "gyroid.mesh/tiles")).filter((name) => name.endsWith(".drc"));
    const file = join(place, "gyroid.mesh/tiles", tiles[0]), bytes = readFileSync(file);
    writeFileSync(file, bytes.subarray(0, bytes.length / 2));
    const { page } = await visit("gyroid.mesh");
    writeFileSync(file, bytes);
    const state = await page.evaluate(() => window.voxweld.state);
    assert.equal(state.errors.length, 1);
    assert.match(state.errors[0], new RegExp(tiles[0]));
    assert.equal(state.tiles_loaded, state.tiles_total - 1);
    await page.waitForFunction((name) => document.getElementById("notes").innerText.includes(name), {}, tiles[0]);
  },
};

make_meshes(place, run);
await run_tests(tests);
