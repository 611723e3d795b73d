// Labels as feature ids: each vertex has a number in the attribute _FEATURE_ID_0, and a property table
// says which labels its triangles separate.
// Based on: the extensions EXT_mesh_features and EXT_structural_metadata of glTF, and Cesium's "3D
// Metadata Specification", section "Binary Table Format".

const features = "EXT_mesh_features", metadata = "EXT_structural_metadata";

const arrays = {
  INT8: Int8Array, UINT8: Uint8Array, INT16: Int16Array, UINT16: Uint16Array, INT32: Int32Array, UINT32: Uint32Array,
  INT64: BigInt64Array, UINT64: BigUint64Array,
};
const all_bits = 2n ** 64n - 1n;

// The labels of a column, as text; null for what is around the volume.
async function label_column(parser, table, name) {
  const schema = parser.json.extensions[metadata].schema;
  const property = schema?.classes?.[table.class]?.properties?.[name];
  const column = table.properties?.[name], type = arrays[property?.componentType];
  if (!column || !type || property.type !== "SCALAR") return null;
  const bytes = await parser.getDependency("bufferView", column.values);
  const none = property.noData === undefined ? null : BigInt(property.noData);
  return Array.from(new type(bytes.slice(0, table.count * type.BYTES_PER_ELEMENT)), (value) =>
    BigInt(value) === none || BigInt(value) === all_bits ? null : String(value));
}

// [{inside, outside}] of a table, or null where it tells no labels.
async function table_pairs(parser, number) {
  const table = parser.json.extensions?.[metadata]?.propertyTables?.[number];
  if (!table) return null;
  const inside = await label_column(parser, table, "inside");
  if (inside === null) return null;
  const outside = await label_column(parser, table, "outside");
  return inside.map((label, i) => ({ inside: label, outside: outside?.[i] ?? null }));
}

// For GLTFLoader.register(): leaves the table of a mesh's feature ids with the mesh.
export const feature_plugin = (parser) => ({
  name: "voxweld-features",
  async afterRoot() {
    for (const [mesh, place] of parser.associations) {
      if (!mesh.isMesh || place?.meshes === undefined) continue;
      const primitive = parser.json.meshes[place.meshes].primitives[place.primitives ?? 0];
      const number = primitive.extensions?.[features]?.featureIds?.[0]?.propertyTable;
      if (number !== undefined) mesh.userData.feature_pairs = await table_pairs(parser, number);
    }
  },
});

// {pairs, ids} as pieces.js has them, or null where the mesh has no feature ids. Without a table an id
// is a label by itself.
export function feature_labels(mesh) {
  const attribute = mesh.geometry.attributes._feature_id_0;
  if (!attribute) return null;
  const ids = Uint32Array.from({ length: attribute.count }, (_, i) => Math.round(attribute.getX(i)));
  const table = mesh.userData.feature_pairs ?? null;
  if (table !== null) return { pairs: table, ids: ids.map((id) => Math.min(id, table.length - 1)) };
  const rows = new Map(), pairs = [];
  const row_of = (id) => {
    if (!rows.has(id)) rows.set(id, pairs.push({ inside: String(id), outside: null }) - 1);
    return rows.get(id);
  };
  return { ids: ids.map(row_of), pairs };
}
