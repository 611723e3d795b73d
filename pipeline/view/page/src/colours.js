// By what a piece is coloured, and the colours for it. All are linear, as three computes.
import { Color } from "three";

export const modes = [
  { name: "plain", title: "One colour" },
  { name: "normal", title: "Direction of the surface" },
  { name: "tile", title: "Tile" },
  { name: "label", title: "Label" },
  { name: "level", title: "Level" },
];

export const plain_colour = "#b9c4d0";

// Hues a golden angle apart, so that neighbours in number differ.
export function tile_colour(number) {
  return new Color().setHSL((number * 0.6180339887498949) % 1, 0.5, 0.6 - 0.14 * (number % 3 === 1), "srgb");
}

// From blue (fine) to red (coarse).
export function level_colour(level, lowest, highest) {
  const t = highest > lowest ? (level - lowest) / (highest - lowest) : 0;
  return new Color().setHSL(0.6 - 0.6 * t, 0.6, 0.58, "srgb");
}

// As voxweld gives to labels that have none (stages/encode/label_colour.cpp).
export function label_colour(label) {
  const turns = Number(BigInt(label) % 1000003n) * 0.6180339887498949;
  const hue = 6 * (turns - Math.floor(turns));
  const of = (shift) => 0.25 + 0.6 * Math.min(1, Math.max(0, Math.abs(((hue + shift) % 6) - 3) - 1));
  return new Color(of(0), of(4), of(2));
}

export const css = (colour) => `#${colour.getHexString()}`;
