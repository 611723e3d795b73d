// A tileset (OGC 3D Tiles 1.1) of a run's own tiles: one level below an empty root. Enough to see that
// the viewer reads one.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

export function tileset_of(directory) {
  const { frame } = JSON.parse(readFileSync(join(directory, "manifest.json")));
  const metres = { mm: 1e-3, m: 1, "": 1 }[frame.unit];
  const lines = readFileSync(join(directory, "tiles.jsonl"), "utf8").trim().split("\n");
  const box = (lo, hi) => {
    const half = lo.map((x, k) => (metres * (hi[k] - x)) / 2), middle = lo.map((x, k) => (metres * (hi[k] + x)) / 2);
    return { box: [...middle, half[0], 0, 0, 0, half[1], 0, 0, 0, half[2]] };
  };
  const children = lines.map((line) => {
    const { tile, files } = JSON.parse(line), side = 2 ** tile.level;
    const lo = tile.at.map((x, k) => (x * side - 1) * frame.spacing[k]);
    return {
      boundingVolume: box(lo, lo.map((x, k) => x + side * frame.spacing[k])),
      geometricError: 0,
      content: { uri: files.find(({ format }) => format === "glb").path },
    };
  });
  const end = frame.size.map((n, k) => n * frame.spacing[k]);
  const root = {
    boundingVolume: box(frame.spacing.map((x) => -x), end),
    geometricError: 100, refine: "REPLACE", children,
  };
  writeFileSync(join(directory, "tileset.json"), JSON.stringify({ asset: { version: "1.1" }, geometricError: 1000, root }));
}
