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

// The middles of the fragments of level 0, in nanometres, and how wide these are.
function fragments_of(index, transform) {
  const file = readFileSync(index), number = (k) => file.readFloatLE(4 * k), levels = file.readUInt32LE(24);
  const n = file.readUInt32LE(28 + 16 * levels), start = 28 + 20 * levels;
  const place = (p) => [0, 1, 2].map((r) => transform[4 * r + 3] + p.reduce((sum, x, c) => sum + transform[4 * r + c] * x, 0));
  const lattice = Array.from({ length: n }, (_, i) => [0, 1, 2].map((k) => file.readUInt32LE(start + 4 * (k * n + i))));
  const middles = lattice.map((at) => place(at.map((x, k) => number(3 + k) + (x + 0.5) * number(k))));
  return { middles, width: Math.abs(transform[0] + transform[1] + transform[2]) * number(0) };
}

function objects_of(path) {
  const info = JSON.parse(readFileSync(join(path, "info"), "utf8"));
  const { ids } = JSON.parse(readFileSync(join(path, info.segment_properties, "info"), "utf8")).inline;
  return ids.map((id) => {
    const index = join(path, `${id}.index`);
    return { id, levels: levels_of(index), ...fragments_of(index, info.transform) };
  });
}

async function look_at(name, { asked, shown }) {
  const objects = objects_of(join(folder, name)), middles = objects.flatMap((one) => one.middles);
  const width = Math.max(...objects.map((one) => one.width));
  const side = (k, most) => most(...middles.map((at) => at[k])), lo = [0, 1, 2].map((k) => side(k, Math.min) - width / 2);
  const hi = [0, 1, 2].map((k) => side(k, Math.max) + width / 2), middle = lo.map((x, k) => (x + hi[k]) / 2);
  const diagonal = Math.hypot(...lo.map((x, k) => hi[k] - x)), away = (at) => Math.hypot(...at.map((x, k) => x - middle[k]));
  const nearest = middles.reduce((best, at) => (away(at) < away(best) ? at : best));
  const found = {};
  for (const [place, at, scale] of [["far", middle, 25 * diagonal], ["whole", middle, diagonal], ["near", nearest, 0.1 * diagonal]]) {
    const start = performance.now();
    const { image, file, complaints } = await shown(name, objects.map(({ id }) => id), at, scale, quiet_tenths);
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

const names = [];
for (const output of outputs) {
  const name = `${basename(resolve(output)).replace(/\.mesh$/, "")}.ng`, path = join(folder, name);
  if (run("export", output, "--neuroglancer", "--force", "-o", path) && run("verify", path)) names.push(name);
}
await with_neuroglancer(resolve(folder), async (client) => {
  for (const name of names) await look_at(name, client);
});
end([]);
