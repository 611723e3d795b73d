// Reads brick stores with zarrita, an independent implementation of Zarr, and compares every value
// with the raw samples they were written from.
//
//   tests/npm_packages.sh                     (once)
//   ninja -C build write_sample_stores && node zarrita_check.mjs build/write_sample_stores
//
// ctest runs it as "zarrita". Exit status: 0 equal, 1 different, 77 zarrita is not installed.
// Without the program's path: 0 when zarrita is there to run, else 77.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import process from "node:process";

async function loadZarrita() {
  try {
    const zarr = await import("zarrita");
    const { FileSystemStore } = await import("@zarrita/storage");
    return { zarr, FileSystemStore };
  } catch (error) {
    if (error.code !== "ERR_MODULE_NOT_FOUND") throw error;
    console.log("skipped: zarrita is not installed; run tests/npm_packages.sh");
    process.exit(77);
  }
}

function bytesOf(typed) {
  return Buffer.from(typed.buffer, typed.byteOffset, typed.byteLength);
}

// <name>.zarr beside <name>.raw, C order, little-endian.
async function check({ zarr, FileSystemStore }, directory, name) {
  const store = new FileSystemStore(join(directory, `${name}.zarr`));
  const array = await zarr.open(store, { kind: "array" });
  const { data, shape } = await zarr.get(array, null);
  const expected = readFileSync(join(directory, `${name}.raw`));
  const equal = bytesOf(data).equals(expected);
  console.log(`${equal ? "equal" : "DIFFERENT"}: ${name} ${array.dtype} [${shape}]`);
  return equal;
}

const zarrita = await loadZarrita();
const writer = process.argv[2];
if (!writer) process.exit(0);
const directory = mkdtempSync(join(tmpdir(), "voxweld-zarrita-"));
try {
  execFileSync(writer, [directory], { stdio: "inherit" });
  const names = readdirSync(directory).filter((file) => file.endsWith(".raw"));
  let equal = names.length > 0;
  for (const file of names.sort())
    equal = (await check(zarrita, directory, file.slice(0, -4))) && equal;
  process.exitCode = equal ? 0 : 1;
} finally {
  rmSync(directory, { recursive: true, force: true });
}
