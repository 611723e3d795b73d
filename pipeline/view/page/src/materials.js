// Materials of the surface. Backs are tinted: a closed surface shows none, so they mark holes and cuts.
import { DoubleSide, MeshBasicMaterial, MeshNormalMaterial, MeshStandardMaterial, ShaderChunk } from "three";

// `pairs`: the back has a colour of its own for each vertex, that of the label behind.
function tell_backs(material, pairs) {
  material.customProgramCacheKey = () => (pairs ? "backs-of-labels" : "backs");
  material.onBeforeCompile = (shader) => {
    if (pairs) {
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nattribute vec4 back_color;\nvarying vec3 v_back;")
        .replace("#include <color_vertex>", "#include <color_vertex>\nv_back = back_color.rgb;");
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", "#include <common>\nvarying vec3 v_back;")
        .replace("#include <color_fragment>", "#include <color_fragment>\nif (!gl_FrontFacing) diffuseColor.rgb = v_back;");
    } else {
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <color_fragment>",
        "#include <color_fragment>\nif (!gl_FrontFacing) diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.42, 0.07, 0.05), 0.75);",
      );
    }
  };
}

// With lines on it the surface is pushed back a little. Else it is not: backs would show at outlines.
const shape = { side: DoubleSide, polygonOffset: false, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };

export function surface_material({ pairs }) {
  const material = new MeshStandardMaterial({ ...shape, roughness: 0.62, metalness: 0, vertexColors: pairs });
  tell_backs(material, pairs);
  return material;
}

export const normal_material = () => new MeshNormalMaterial(shape);

export const line_material = () =>
  new MeshBasicMaterial({ wireframe: true, color: 0x10151c, transparent: true, opacity: 0.45, depthWrite: false });

// Where a fragment's middle lies beside its triangle, as at outlines, a place that is interpolated there
// may be far off: the cut then counts a front and not its back, and leaves specks.
export function cut_within_triangles(material) {
  const of_triangle = (text) => text.replace("varying vec3 vClipPosition", "centroid varying vec3 vClipPosition");
  const { clipping_planes_pars_vertex: vertex, clipping_planes_pars_fragment: fragment } = ShaderChunk;
  material.customProgramCacheKey = () => "cut-within-triangles";
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace("#include <clipping_planes_pars_vertex>", of_triangle(vertex));
    shader.fragmentShader = shader.fragmentShader.replace("#include <clipping_planes_pars_fragment>", of_triangle(fragment));
  };
  return material;
}
