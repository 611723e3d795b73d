// VTK's PolyData as voxweld writes it: an XML header, and raw arrays behind it, each with its size in front.
// Based on: Kitware, "VTK File Formats" (2021), section "XML File Formats".
import { piece_of_arrays } from "./face_labels.js";

const mark = '<AppendedData encoding="raw">', most_header = 65536;
const types = { Float32: Float32Array, Int32: Int32Array, Int64: BigInt64Array };

// The header as XML, and where the arrays begin.
function header_of(buffer) {
  const text = new TextDecoder("latin1").decode(new Uint8Array(buffer, 0, Math.min(buffer.byteLength, most_header)));
  const end = text.indexOf(mark), begin = text.indexOf("_", end) + 1;
  const xml = end < 0 ? null : new DOMParser().parseFromString(text.slice(0, end) + "</VTKFile>", "application/xml");
  const root = xml?.documentElement;
  const wanted = { type: "PolyData", byte_order: "LittleEndian", header_type: "UInt64" };
  const fits = root?.nodeName === "VTKFile" && !root.hasAttribute("compressor") &&
    Object.entries(wanted).every(([name, value]) => root.getAttribute(name) === value);
  if (!fits || begin === 0)
    throw new Error("is not written as voxweld writes .vtp: PolyData with raw appended arrays, without compression");
  return { piece: root.querySelector("PolyData > Piece"), begin };
}

// The values of an array, or null where there is none of the name.
function array_of(buffer, { piece, begin }, parent, name, length) {
  const node = [...piece.querySelectorAll(`${parent} > DataArray`)].find((each) => each.getAttribute("Name") === name);
  if (!node) return null;
  const type = types[node.getAttribute("type")], at = begin + Number(node.getAttribute("offset"));
  if (!type) throw new Error(`the array ${name} has type ${node.getAttribute("type")}`);
  const bytes = length * type.BYTES_PER_ELEMENT;
  if (at + 8 + bytes > buffer.byteLength) throw new Error(`the array ${name} ends after the file`);
  if (Number(new DataView(buffer).getBigUint64(at, true)) !== bytes)
    throw new Error(`the array ${name} has not ${length} values`);
  return new type(buffer.slice(at + 8, at + 8 + bytes));
}

export function read_vtp(buffer) {
  const header = header_of(buffer);
  const count = (name) => Number(header.piece.getAttribute(name));
  const points = count("NumberOfPoints"), triangles = count("NumberOfPolys");
  const corners = array_of(buffer, header, "Polys", "connectivity", 3 * triangles);
  const position = array_of(buffer, header, "Points", "Points", 3 * points);
  if (corners === null || position === null) throw new Error("has no triangles");
  return piece_of_arrays({
    position, normal: array_of(buffer, header, "PointData", "Normals", 3 * points),
    corners: Uint32Array.from(corners, Number),
    inside: array_of(buffer, header, "CellData", "label", triangles),
    outside: array_of(buffer, header, "CellData", "label_outside", triangles),
  });
}
