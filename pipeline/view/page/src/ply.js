// PLY files whose triangles have labels, as voxweld writes them: binary, `label` and perhaps `label_outside` of
// each face. three's reader leaves these out.
import { piece_of_arrays } from "./face_labels.js";

const types = {
  char: [1, "getInt8"], uchar: [1, "getUint8"], short: [2, "getInt16"], ushort: [2, "getUint16"],
  int: [4, "getInt32"], uint: [4, "getUint32"], float: [4, "getFloat32"], double: [8, "getFloat64"],
};
const most_header = 65536;

// {elements: {name: {count, size, properties: {name: {type, at, list}}}}, begin}, or null where the header is not
// one of such a file.
function header_of(buffer) {
  const text = new TextDecoder("latin1").decode(new Uint8Array(buffer, 0, Math.min(buffer.byteLength, most_header)));
  const end = text.indexOf("end_header\n");
  if (end < 0 || !/^ply\nformat binary_little_endian 1.0\n/.test(text)) return null;
  const elements = {};
  let element = null;
  for (const [word, ...rest] of text.slice(0, end).split("\n").map((line) => line.trim().split(/\s+/))) {
    if (word === "element") element = elements[rest[0]] = { count: Number(rest[1]), size: 0, properties: {} };
    if (word !== "property") continue;
    const list = rest[0] === "list", type = list ? rest[2] : rest[0], name = rest.at(-1);
    if (!types[type] || (list && rest[1] !== "uchar")) return null;
    element.properties[name] = { type, at: element.size + (list ? 1 : 0), list };
    element.size += (list ? 1 : 0) + (list ? 3 : 1) * types[type][0];
  }
  const corners = elements.face?.properties.vertex_indices;
  const fits = elements.vertex && corners?.list && Object.keys(elements).join() === "vertex,face";
  return fits && elements.face.properties.label ? { elements, begin: end + "end_header\n".length } : null;
}

// So many numbers of a property of each of an element's items.
function column(view, begin, { count, size, properties }, name, width = 1, out = new Float64Array(width * count)) {
  const { type, at } = properties[name], [bytes, get] = types[type];
  for (let i = 0; i < count; ++i)
    for (let k = 0; k < width; ++k) out[width * i + k] = view[get](begin + i * size + at + k * bytes, true);
  return out;
}

function vectors(view, begin, vertex, names) {
  const out = new Float32Array(3 * vertex.count);
  names.forEach((name, k) => {
    const values = column(view, begin, vertex, name);
    for (let i = 0; i < vertex.count; ++i) out[3 * i + k] = values[i];
  });
  return out;
}

// A piece, or null where the file has no labels or is written in another way.
export function labelled_ply(buffer) {
  const header = header_of(buffer);
  if (header === null) return null;
  const { elements: { vertex, face }, begin } = header, view = new DataView(buffer);
  const faces = begin + vertex.count * vertex.size, end = faces + face.count * face.size;
  if (buffer.byteLength < end) throw new Error(`ends after ${buffer.byteLength} of ${end} bytes`);
  const corner_count = face.properties.vertex_indices.at - 1;
  for (let i = 0; i < face.count; ++i) if (view.getUint8(faces + i * face.size + corner_count) !== 3) return null;
  return piece_of_arrays({
    position: vectors(view, begin, vertex, ["x", "y", "z"]),
    normal: vertex.properties.nx ? vectors(view, begin, vertex, ["nx", "ny", "nz"]) : null,
    corners: column(view, faces, face, "vertex_indices", 3, new Uint32Array(3 * face.count)),
    inside: column(view, faces, face, "label"),
    outside: face.properties.label_outside ? column(view, faces, face, "label_outside") : null,
  });
}
