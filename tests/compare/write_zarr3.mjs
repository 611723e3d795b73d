// Writes Zarr arrays of version 3 with zarrita. usage: node write_zarr3.mjs FOLDER
import { join } from "node:path";
import process from "node:process";
import { FileSystemStore } from "@zarrita/storage";
import * as zarr from "zarrita";

const folder = process.argv[2];
const shape = [4, 5, 7];
const types = {
  uint8: Uint8Array, int8: Int8Array, uint16: Uint16Array, int16: Int16Array, uint32: Uint32Array,
  int32: Int32Array, uint64: BigUint64Array, int64: BigInt64Array, float32: Float32Array,
  float64: Float64Array,
};

function samples(type) {
  const whole = type.includes("64") && !type.startsWith("float");
  const at = (i) => (i * 2654435761) % 251;
  const count = shape.reduce((a, b) => a * b);
  const values = Array.from({ length: count }, (_, i) =>
    whole ? BigInt(at(i)) : type.startsWith("float") ? at(i) / 8 : at(i) % 127);
  return types[type].from(values);
}

async function write(name, type, options = {}) {
  const store = new FileSystemStore(join(folder, `v3_${name}.zarr`));
  const array = await zarr.create(store, {
    shape, chunkShape: [3, 2, 4], dtype: type, fillValue: 0, ...options,
  });
  const stride = [35, 7, 1];
  await zarr.set(array, null, { data: samples(type), shape, stride });
}

const bytes = (endian) => ({ name: "bytes", configuration: { endian } });
for (const type of Object.keys(types)) {
  await write(type, type, { codecs: [bytes("little")] });
  await write(`${type}_big`, type, { codecs: [bytes("big")] });
}
await write("transposed", "int16", {
  codecs: [{ name: "transpose", configuration: { order: [2, 0, 1] } }, bytes("little")],
});
await write("names", "int16", { codecs: [bytes("little")], dimensionNames: ["y", "x", "z"] });
await write("dots", "int16", { codecs: [bytes("little")], chunkSeparator: "." });
await write("for_ome", "uint16", { codecs: [bytes("little")] });
