// Shows exports in Neuroglancer itself, in a headless Chromium: that it loads them without a complaint, picks
// coarse levels from afar and fine ones nearby, and draws what is there.
// Usage: node client_test.mjs VOXWELD
//        node client_test.mjs          whether neuroglancer, esbuild and puppeteer-core are there
// Exits 77 where one of these or Chromium is missing (tests/npm_packages.sh).
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { levels_of, look, with_neuroglancer } from "./neuroglancer_page.mjs";

const [, , given] = process.argv;
if (given === undefined) process.exit(0);
const voxweld = resolve(given);
const place = mkdtempSync(join(tmpdir(), "voxweld-exports-"));
process.on("exit", () => rmSync(place, { recursive: true, force: true }));

function run(...args) {
  const done = spawnSync(voxweld, args, { cwd: place, encoding: "utf8" });
  assert.equal(done.status, 0, `voxweld ${args.join(" ")}: ${done.stderr}`);
}

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

await with_neuroglancer(place, async ({ asked, shown }) => {
  const seen = async (name, segments, side, scale) => {
    const { image, complaints } = await shown(name, segments, [side / 2, side / 2, side / 2], scale);
    assert.deepEqual(complaints, [], name);
    return look(image);
  };
  const levels = levels_of(join(place, "files/1.index"));
  const top = Math.max(...levels.values());
  assert.ok(top > 0, "the run has levels");
  // Of an object those that were asked for.
  const asked_levels = (object = 1, of = levels) =>
    [...new Set(asked.filter(({ path, begin }) => path.endsWith(`/${object}`) && begin !== undefined).map(({ begin }) => of.get(begin)))].sort();

  const near = await seen("files", ["1"], 96, 120);
  assert.ok(near.drawn > 0.1, `nearby ${near.drawn} of the picture is drawn`);
  assert.ok(asked_levels().includes(0), `nearby levels ${asked_levels()} are asked for`);
  const far = await seen("files", ["1"], 96, 6000);
  assert.deepEqual(asked_levels(), [top], "from afar");
  assert.ok(far.drawn > 0 && far.drawn < 0.01, `from afar ${far.drawn} of the picture is drawn`);

  const old = await seen("old", ["1"], 96, 120);
  assert.ok(Math.abs(old.drawn - near.drawn) < 0.01, `${old.drawn} of the old format is drawn, ${near.drawn} of the other`);

  const ids = JSON.parse(readFileSync(join(place, "shards/segment_properties/info"), "utf8")).inline.ids;
  const labels = await seen("shards", ids, 48, 60);
  assert.ok(labels.drawn > 0.1, `of labels ${labels.drawn} of the picture is drawn`);
  assert.ok(labels.hues > 5, `${labels.hues} colours of labels`);

  // A mesh for each label: each object has its own levels.
  const each = await seen("each", ids, 48, 60);
  assert.ok(Math.abs(each.drawn - labels.drawn) < 0.02, `${each.drawn} is drawn of a mesh for each label, ${labels.drawn} of the shared one`);
  await seen("each", ids, 48, 3000);
  const coarse = ids.map((id) => [id, levels_of(join(place, `each/${id}.index`))]).filter(([, of]) => Math.max(...of.values()) > 0);
  assert.ok(coarse.length > 10, `${coarse.length} labels have levels`);
  for (const [id, of] of coarse) assert.deepEqual(asked_levels(id, of), [Math.max(...of.values())], `label ${id} from afar`);
  console.log(`near ${near.drawn.toFixed(3)}, far ${far.drawn.toFixed(5)}, old ${old.drawn.toFixed(3)}, labels ${labels.drawn.toFixed(3)} in ${labels.hues} hues`);
});
