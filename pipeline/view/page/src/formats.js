// Files of meshes into pieces (pieces.js), by the formats that voxweld writes.
import { Matrix4 } from "three";
import { DRACOLoader } from "three/addons/loaders/DRACOLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { draco_pairs } from "./draco_pairs.js";
import { feature_labels, feature_plugin } from "./features.js";
import { make_piece, pieces_of_object } from "./pieces.js";
import { labelled_ply } from "./ply.js";
import { read_vtp } from "./vtp.js";

export const draco_loader = new DRACOLoader();
draco_loader.setDecoderPath({
  js: new URL("draco/draco_wasm_wrapper.js", document.baseURI).href,
  wasm: new URL("draco/draco_decoder.wasm", document.baseURI).href,
});
draco_loader.setWorkerLimit(Math.min(4, navigator.hardwareConcurrency || 2));
export const meshopt_decoder = MeshoptDecoder;

const gltf_loader = new GLTFLoader();
gltf_loader.setDRACOLoader(draco_loader);
gltf_loader.setMeshoptDecoder(MeshoptDecoder);
gltf_loader.register(feature_plugin);

// Which of a tile's files to load: what is decoded fast comes first, plain text last. Undefined where
// there is a reader for none.
const preferred = ["meshopt", "drc", "glb", "glb-plain", "ply", "vtp", "stl", "obj"];
export function best_file(files) {
  const known = files.filter(({ path }) => readers[ending_of(path)]);
  const rank = ({ format }) => (preferred.indexOf(format) + preferred.length + 1) % (preferred.length + 1);
  return known.sort((a, b) => rank(a) - rank(b))[0];
}

const ending_of = (path) => path.split(".").pop().toLowerCase();

async function read_draco(buffer) {
  const pairs = draco_pairs(buffer);
  const attributeIDs = { position: "POSITION", normal: "NORMAL" };
  const attributeTypes = { position: "Float32Array", normal: "Float32Array" };
  if (pairs !== null) {
    attributeIDs.pair = "GENERIC";
    attributeTypes.pair = "Uint32Array";
  }
  const geometry = await draco_loader.decodeGeometry(buffer, { attributeIDs, attributeTypes, useUniqueIDs: false });
  const ids = pairs === null ? null : geometry.attributes.pair.array;
  geometry.deleteAttribute("pair");
  return [make_piece(geometry, { pairs, ids })];
}

// What a mesh of a glTF file separates: said in `extras`, or for each vertex as a feature id.
export function pair_of_mesh(mesh) {
  const { inside, outside } = { ...mesh.geometry.userData, ...mesh.userData };
  if (inside === undefined) return feature_labels(mesh);
  const label = (number) => (number === null || number === undefined ? null : String(number));
  return { pairs: [{ inside: label(inside), outside: label(outside) }] };
}

// glTF has y up and metres; the viewer has z up.
const z_up = new Matrix4().set(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);

async function read_gltf(buffer) {
  const gltf = await gltf_loader.parseAsync(buffer, "");
  const pieces = pieces_of_object(gltf.scene, pair_of_mesh);
  // The node of a file of voxweld only carries the mesh into the world, as the scene's frame does.
  const is_ours = String(gltf.asset.generator ?? "").startsWith("voxweld");
  for (const piece of pieces) {
    if (!is_ours) piece.geometry.applyMatrix4(z_up.clone().multiply(piece.matrix));
    delete piece.matrix;
  }
  return pieces;
}

async function read_ply(buffer) {
  return [labelled_ply(buffer) ?? make_piece(new PLYLoader().parse(buffer))];
}

async function read_stl(buffer) {
  return [make_piece(new STLLoader().parse(buffer))];
}

async function read_obj(buffer) {
  const object = new OBJLoader().parse(new TextDecoder().decode(buffer));
  return pieces_of_object(object, () => null);
}

const readers = { drc: read_draco, glb: read_gltf, ply: read_ply, stl: read_stl, obj: read_obj, vtp: async (buffer) => [read_vtp(buffer)] };

// By the file's ending.
export async function read_pieces(path, buffer) {
  return readers[ending_of(path)](buffer);
}
