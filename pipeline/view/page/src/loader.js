// Loads the files of a run, a few at a time, and tells how far it has come.
import { best_file, read_pieces } from "./formats.js";

const at_once = 4;
// More than this is not loaded unasked: some 60 bytes each, here and on the graphics card.
const most_triangles = 40e6;

// data/PATH, whatever characters a name has.
export const data_url = (path) => "data/" + path.split("/").map(encodeURIComponent).join("/");

// The file's bytes, in one piece; told as they come.
export async function fetch_bytes(path, came) {
  const answer = await fetch(data_url(path));
  if (!answer.ok) throw new Error(`${answer.status} ${answer.statusText}`);
  const length = Number(answer.headers.get("Content-Length"));
  const reader = answer.body.getReader();
  let bytes = new Uint8Array(length), at = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (at + value.length > bytes.length) {
      const larger = new Uint8Array(2 * (at + value.length));
      larger.set(bytes.subarray(0, at));
      bytes = larger;
    }
    bytes.set(value, at);
    at += value.length;
    came(value.length);
  }
  if (at < length) throw new Error(`ends after ${at} of ${length} bytes`);
  return at === bytes.length ? bytes.buffer : bytes.slice(0, at).buffer;
}

// What there is to load: tiles, or the whole mesh where there are none. An error where there is no reader
// for any of a tile's formats.
export function jobs_of(scene) {
  const jobs = all_jobs(scene);
  const other = jobs.findIndex(({ file }) => file === undefined);
  if (other < 0) return jobs;
  const files = scene.tiles[other]?.files ?? scene.merged;
  throw new Error(`The page reads none of the formats of this mesh: ${files.map((file) => file.format).join(", ")}`);
}

function all_jobs(scene) {
  if (scene.kind === "file") return [{ file: scene.file, tile: 0, level: 0, triangles: 0 }];
  if (scene.tiles.length > 0)
    return scene.tiles.map((tile, number) => ({
      file: best_file(tile.files), tile: number, level: tile.level, at: tile.at,
      triangles: tile.triangles, label: tile.label ?? null,
    }));
  if (scene.merged.length === 0) return [];
  return [{ file: best_file(scene.merged), tile: 0, level: 0, triangles: scene.counts.triangles }];
}

export class Loader {
  // add(piece, job): shows it. changed(): the state has changed.
  constructor(state, add, changed) {
    Object.assign(this, { state, add, changed });
    this.waiting = [];
  }

  start(jobs) {
    const { state } = this;
    this.waiting = [...jobs];
    state.tiles_total = jobs.length;
    state.bytes_total = jobs.reduce((sum, job) => sum + job.file.bytes, 0);
    return this.go_on(most_triangles);
  }

  // Until there are so many triangles.
  async go_on(most) {
    const { state } = this;
    state.status = "loading";
    let planned = state.triangles;
    const work = async () => {
      while (this.waiting.length > 0) {
        planned += this.waiting[0].triangles;
        if (planned > most && state.tiles_loaded > 0) return;
        await this.load(this.waiting.shift());
      }
    };
    await Promise.all(Array.from({ length: at_once }, work));
    state.left_out = this.waiting.length;
    state.status = "ready";
    this.changed();
  }

  async load(job) {
    const { state } = this;
    try {
      const bytes = await fetch_bytes(job.file.path, (count) => {
        state.bytes_loaded += count;
        this.changed();
      });
      for (const piece of await read_pieces(job.file.path, bytes)) {
        if (piece.pairs === null && job.label != null) piece.pairs = [{ inside: job.label, outside: null }];
        state.triangles += piece.triangles;
        this.add(piece, job);
      }
      state.tiles_loaded += 1;
    } catch (error) {
      state.errors.push(`${job.file.path}: ${error?.message ?? error}`);
    }
    this.changed();
  }
}
