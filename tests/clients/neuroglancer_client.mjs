// Outputs of any size in Neuroglancer itself: exported with their levels of detail, checked by `verify`, and looked at
// from afar, whole, and from nearby. Prints what each look asked for.
// Usage: node neuroglancer_client.mjs PROGRAM FOLDER OUTPUT...
// Exports and pictures stay in FOLDER, an export until the next one of that name.
import { spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { levels_of, look, with_neuroglancer } from "../pipeline/neuroglancer/neuroglancer_page.mjs";
import { checks } from "./browser.mjs";

const [, , program, folder, ...outputs] = process.argv, { say, check, end } = checks("neuroglancer");
const quiet_tenths = 80;

function run(...args) {
  const done = spawnSync(program, args, { encoding: "utf8" });
  check(done.status === 0, `${basename(program)} ${args.join(" ")}: ${done.stderr}`);
  return done.status === 0;
}

const read_json = (...path) => JSON.parse(readFileSync(join(...path), "utf8"));

// The objects; and of the volume the corners, in nanometres.
function contents(output, path) {
  const { transform, segment_properties } = read_json(path, "info");
  const { ids } = read_json(path, segment_properties, "info").inline, { frame } = read_json(output, "manifest.json");
  const place = (p) => [0, 1, 2].map((r) => transform[4 * r + 3] + p.reduce((sum, x, c) => sum + transform[4 * r + c] * x, 0));
  const corners = [place(frame.first), place(frame.first.map((x, k) => x + (frame.size[k] - 1) * frame.spacing[k]))];
  return { corners, objects: ids.map((id) => ({ id, levels: levels_of(join(path, `${id}.index`)) })) };
}

async function look_at(name, output, { asked, shown }) {
  const { corners: [lo, hi], objects } = contents(output, join(folder, name));
  const middle = lo.map((x, k) => (x + hi[k]) / 2), diagonal = Math.hypot(...lo.map((x, k) => hi[k] - x)), found = {};
  for (const [place, scale] of [["far", 25], ["whole", 1], ["near", 0.2]]) {
    const start = performance.now();
    const { image, file, complaints } = await shown(name, objects.map(({ id }) => id), middle, scale * diagonal, quiet_tenths);
    const seconds = (performance.now() - start) / 1000 - quiet_tenths / 10;
    writeFileSync(join(folder, `neuroglancer_${name.replace(/\.ng$/, "")}_${place}.png`), file);
    const counts = new Map(objects.flatMap(({ levels }) => [...levels.values()]).sort().map((level) => [level, 0]));
    let bytes = 0;
    for (const { id, levels } of objects)
      for (const one of asked.filter(({ path, begin }) => path.endsWith(`/${id}`) && begin !== undefined)) {
        counts.set(levels.get(one.begin), counts.get(levels.get(one.begin)) + 1);
        bytes += one.bytes;
      }
    const { drawn } = look(image);
    found[place] = { drawn, counts };
    say(`neuroglancer ${name} ${place}: fragments ${[...counts].map(([level, n]) => `${n} of level ${level}`).join(", ")}, ` +
      `${(bytes / 1e6).toFixed(1)} MB, ${(100 * drawn).toFixed(1)} % of the picture is drawn, still after ${Math.max(0, seconds).toFixed(0)} s`);
    check(complaints.length === 0, `${name} ${place}: ${complaints.join()}`);
  }
  const { far, whole, near } = found;
  check(far.drawn > 0 && far.drawn < 0.01, `${name}: from afar ${far.drawn} of the picture is drawn`);
  check(whole.drawn > 0.05, `${name}: as a whole ${whole.drawn} of the picture is drawn`);
  check(near.drawn > 0.2, `${name}: nearby ${near.drawn} of the picture is drawn`);
  if (far.counts.size > 1) check(far.counts.get(0) === 0 || objects.length > 1, `${name}: from afar the finest level is asked for`);
  check(near.counts.get(0) > 0, `${name}: nearby the finest level is not asked for`);
}

const names = new Map();
for (const output of outputs) {
  const name = `${basename(resolve(output)).replace(/\.mesh$/, "")}.ng`, path = join(folder, name);
  if (run("export", output, "--neuroglancer", "--force", "-o", path) && run("verify", path)) names.set(name, output);
}
await with_neuroglancer(resolve(folder), async (client) => {
  for (const [name, output] of names) await look_at(name, output, client);
});
end([]);
