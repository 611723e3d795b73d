// A glTF binary whose vertices have feature ids, and a property table that says which labels the
// triangles separate (EXT_mesh_features, EXT_structural_metadata): two tetrahedra, one of label 7 in
// what is around it, one between label 9 and label 7. Its place in the world is its node's, with y up.

const corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
const faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

export function feature_glb() {
  const position = [], ids = [], index = [];
  for (const feature of [0, 1]) {
    for (const face of faces) index.push(...face.map((corner) => corner + 4 * feature));
    for (const [x, y, z] of corners) position.push(x + 2 * feature, y, z), ids.push(feature);
  }
  const pieces = [
    new Uint8Array(new Float32Array(position).buffer), new Uint8Array(new Float32Array(ids).buffer),
    new Uint8Array(new Uint32Array(index).buffer),
    new Uint8Array(new Int16Array([7, 9]).buffer), new Uint8Array(new Int16Array([-1, 7]).buffer),
  ];
  const views = [];
  let size = 0;
  for (const piece of pieces) {
    views.push({ buffer: 0, byteOffset: size, byteLength: piece.length });
    size += Math.ceil(piece.length / 8) * 8;
  }
  const label = { type: "SCALAR", componentType: "INT16", noData: -1 };
  const document = {
    asset: { version: "2.0", generator: "a test" },
    extensionsUsed: ["EXT_mesh_features", "EXT_structural_metadata"],
    extensions: { EXT_structural_metadata: {
      schema: { id: "labels", classes: { label_pair: { properties: { inside: label, outside: label } } } },
      propertyTables: [{ class: "label_pair", count: 2, properties: { inside: { values: 3 }, outside: { values: 4 } } }],
    } },
    scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, scale: [2, 2, 2] }],
    meshes: [{ primitives: [{
      attributes: { POSITION: 0, _FEATURE_ID_0: 1 }, indices: 2,
      extensions: { EXT_mesh_features: { featureIds: [{ featureCount: 2, attribute: 0, propertyTable: 0 }] } },
    }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 8, type: "VEC3", min: [0, 0, 0], max: [3, 1, 1] },
      { bufferView: 1, componentType: 5126, count: 8, type: "SCALAR" },
      { bufferView: 2, componentType: 5125, count: index.length, type: "SCALAR" },
    ],
    bufferViews: views, buffers: [{ byteLength: size }],
  };
  const json = Buffer.from(JSON.stringify(document)), padding = Buffer.alloc((4 - (json.length % 4)) % 4, " ");
  const head = (length, type) => {
    const bytes = Buffer.alloc(8);
    bytes.writeUInt32LE(length, 0);
    bytes.write(type, 4, "latin1");
    return bytes;
  };
  const binary = Buffer.alloc(size);
  pieces.forEach((piece, i) => binary.set(piece, views[i].byteOffset));
  const chunks = [head(json.length + padding.length, "JSON"), json, padding, head(size, "BIN\0"), binary];
  const magic = Buffer.alloc(12);
  magic.write("glTF", 0, "latin1");
  magic.writeUInt32LE(2, 4);
  magic.writeUInt32LE(12 + chunks.reduce((sum, chunk) => sum + chunk.length, 0), 8);
  return Buffer.concat([magic, ...chunks]);
}
