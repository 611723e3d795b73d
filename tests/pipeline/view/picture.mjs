// Pictures that a browser has taken: their pixels, and how many are of a kind.
import { inflateSync } from "node:zlib";

// Rows of 8-bit RGB or RGBA, without interlacing.
export function decoded_png(file) {
  const chunks = [];
  let width, height, channels;
  for (let at = 8; at < file.length; ) {
    const size = file.readUInt32BE(at), type = file.toString("latin1", at + 4, at + 8);
    if (type === "IHDR") {
      [width, height] = [file.readUInt32BE(at + 8), file.readUInt32BE(at + 12)];
      channels = { 2: 3, 6: 4 }[file[at + 17]];
    }
    if (type === "IDAT") chunks.push(file.subarray(at + 8, at + 8 + size));
    at += 12 + size;
  }
  const raw = inflateSync(Buffer.concat(chunks)), stride = width * channels, pixels = Buffer.alloc(height * stride);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const a = x >= channels ? pixels[y * stride + x - channels] : 0, b = y > 0 ? pixels[(y - 1) * stride + x] : 0;
      const c = x >= channels && y > 0 ? pixels[(y - 1) * stride + x - channels] : 0;
      const p = a + b - c, [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
      const paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
      pixels[y * stride + x] = raw[y * (stride + 1) + 1 + x] + [0, a, b, (a + b) >> 1, paeth][filter];
    }
  }
  return { width, height, at: (x, y) => [...pixels.subarray((y * width + x) * channels, (y * width + x) * channels + 3)] };
}

// The background of the page.
const back = [0x15, 0x18, 0x1d];
export const is_back = (pixel) => pixel.every((value, i) => Math.abs(value - back[i]) <= 2);
// A surface from behind.
export const is_red = ([r, g, b]) => r > 35 && r > 1.3 * g && r > 1.3 * b;

// Of the pixels in a part of the picture, those that pass.
export function share(image, test, [x0, y0, x1, y1] = [0, 0, 1, 1]) {
  let all = 0, found = 0;
  for (let y = Math.floor(y0 * image.height); y < y1 * image.height; ++y)
    for (let x = Math.floor(x0 * image.width); x < x1 * image.width; ++x) {
      ++all;
      found += test(image.at(x, y));
    }
  return found / all;
}

// Pixels that differ, of all.
export function difference(a, b) {
  let found = 0;
  for (let y = 0; y < a.height; ++y)
    for (let x = 0; x < a.width; ++x) found += a.at(x, y).some((value, i) => Math.abs(value - b.at(x, y)[i]) > 8);
  return found / (a.width * a.height);
}
