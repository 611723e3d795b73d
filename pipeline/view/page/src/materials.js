// Materials of the surface. Backs are tinted: a closed surface shows none, so they mark holes and cuts.
import { DoubleSide, MeshBasicMaterial, MeshNormalMaterial, MeshStandardMaterial, ShaderChunk } from "three";

// Where a fragment's middle lies beside its triangle, as at outlines, a place that is interpolated there
// may be far off, and cuts would leave specks: it is to be taken within the triangle.
function cut_within_triangles(shader) {
  const within = (text) => text.replace("varying vec3 vClipPosition", "centroid varying vec3 vClipPosition");
  const { clipping_planes_pars_vertex: vertex, clipping_planes_pars_fragment: fragment } = ShaderChunk;
  shader.vertexShader = shader.vertexShader.replace("#include <clipping_planes_pars_vertex>", within(vertex));
  shader.fragmentShader = shader.fragmentShader.replace("#include <clipping_planes_pars_fragment>", within(fragment));
}

const red_back = "if (!gl_FrontFacing) diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.42, 0.07, 0.05), 0.9);";
const own_back = "if (!gl_FrontFacing) diffuseColor.rgb = v_back;";

function insert(text, after, more) {
  return text.replace(`#include <${after}>`, `#include <${after}>\n${more}`);
}

// Shaders with these changes; name: of the changes, by which three keeps programs apart.
function changed(material, name, change = () => {}) {
  material.customProgramCacheKey = () => name;
  material.onBeforeCompile = (shader) => {
    cut_within_triangles(shader);
    change(shader);
  };
  return material;
}

function tell_backs(shader) {
  shader.fragmentShader = insert(shader.fragmentShader, "color_fragment", red_back);
}

// The back has a colour of its own for each vertex, that of the label behind.
function colour_backs(shader) {
  shader.vertexShader = insert(shader.vertexShader, "common", "attribute vec4 back_color;\nvarying vec3 v_back;");
  shader.vertexShader = insert(shader.vertexShader, "color_vertex", "v_back = back_color.rgb;");
  shader.fragmentShader = insert(shader.fragmentShader, "common", "varying vec3 v_back;");
  shader.fragmentShader = insert(shader.fragmentShader, "color_fragment", own_back);
}

// With lines on it the surface is pushed back a little. Else it is not: backs would show at outlines.
const shape = { side: DoubleSide, polygonOffset: false, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };

// pairs: its vertices have colours for both sides.
export function surface_material({ pairs }) {
  const material = new MeshStandardMaterial({ ...shape, roughness: 0.62, metalness: 0, vertexColors: pairs });
  return pairs ? changed(material, "labels", colour_backs) : changed(material, "surface", tell_backs);
}

export const normal_material = () => changed(new MeshNormalMaterial(shape), "normal");

// Nothing to see: for counting (clipping.js).
export const hidden_material = (settings) => changed(new MeshBasicMaterial(settings), "hidden");

export const line_material = () =>
  new MeshBasicMaterial({ wireframe: true, color: 0x10151c, transparent: true, opacity: 0.38, depthWrite: false });
