// Reads a Zarr array with zarrita: its samples, raw, go to OUT, their type and shape to OUT.json.
// Strides count
// samples.
// usage: node read_zarr3.mjs FOLDER OUT
import { writeFileSync } from "node:fs";
import process from "node:process";
import { FileSystemStore } from "@zarrita/storage";
import * as zarr from "zarrita";

const [folder, out] = process.argv.slice(2);
const array = await zarr.open(new FileSystemStore(folder), { kind: "array" });
const { data, shape, stride } = await zarr.get(array, null);
const types = {
  Int8Array: "i1", Uint8Array: "u1", Int16Array: "<i2", Uint16Array: "<u2", Int32Array: "<i4",
  Uint32Array: "<u4", BigInt64Array: "<i8", BigUint64Array: "<u8", Float16Array: "<f2",
  Float32Array: "<f4", Float64Array: "<f8", BoolArray: "u1",
};
const type = types[data.constructor.name];
if (!type) throw new Error(`Error: samples in a ${data.constructor.name}`);
const bytes = data.buffer
  ? Buffer.from(data.buffer, data.byteOffset, data.byteLength)
  : Buffer.from([...data].map(Number));
writeFileSync(out, bytes);
writeFileSync(`${out}.json`, JSON.stringify({ type, shape, stride }));
