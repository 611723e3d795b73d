// Pictures whose pixels tell whether a mesh is closed, in the page of a client that draws with three.js.
//
// Of a closed mesh whose triangles face outward, a ray from a point crosses one back more than fronts if the point
// is inside, and as many if it is outside. Renderers draw triangles that share corners without a gap and without
// an overlap. So a picture that counts fronts and backs at each pixel, without a depth test, shows each gap.
import * as THREE from "three";

export const background = 0xff00ff;

// Each front adds 1 to green, each back 1 to blue.
export const layers = new THREE.ShaderMaterial({
  side: THREE.DoubleSide, forceSinglePass: true, depthTest: false, depthWrite: false, transparent: true,
  blending: THREE.CustomBlending, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor, blendEquation: THREE.AddEquation,
  vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
  fragmentShader: "void main() { gl_FragColor = gl_FrontFacing ? vec4(0.0, 1.0 / 255.0, 0.0, 1.0) : vec4(0.0, 0.0, 1.0 / 255.0, 1.0); }",
});

function pixels_of(renderer) {
  const gl = renderer.getContext(), { drawingBufferWidth: w, drawingBufferHeight: h } = gl, pixels = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels;
}

// Of a picture with the background above.
export function counts(renderer) {
  const pixels = pixels_of(renderer), found = { all: pixels.length / 4, background: 0 }, colours = new Set();
  for (let i = 0; i < pixels.length; i += 4) {
    const [r, g, b] = [pixels[i], pixels[i + 1], pixels[i + 2]];
    found.background += r > 250 && g < 5 && b > 250;
    colours.add((r >> 4) * 256 + (g >> 4) * 16 + (b >> 4));
  }
  return { ...found, colours: colours.size };
}

// Of a picture of layers: pixels with as many backs more than fronts as wanted, others, and those without a triangle.
// places: of others, by their numbers.
function layer_counts(renderer, wanted, places = []) {
  const pixels = pixels_of(renderer), found = { all: pixels.length / 4, empty: 0, wrong: 0, most: 0 };
  for (let i = 0; i < pixels.length; i += 4) {
    const [, fronts, backs] = pixels.subarray(i, i + 3);
    found.empty += fronts + backs === 0;
    if (backs - fronts !== wanted) {
      found.wrong += 1;
      places.push(i / 4);
    }
    found.most = Math.max(found.most, fronts, backs);
  }
  return found;
}

const zoom = 16, most_places = 40;

// Of pixels that are wrong, those that are wrong too where the same triangles are drawn larger. One that is lost where
// the picture's edge cuts a triangle is not; a gap is, and is wider then.
function gaps_at(renderer, scene, camera, places, wanted) {
  if (places.length > most_places) return places.length; // a hole
  const gl = renderer.getContext(), { drawingBufferWidth: w, drawingBufferHeight: h } = gl, near = camera.clone();
  const view = camera.view?.enabled ? camera.view : { fullWidth: w, fullHeight: h, offsetX: 0, offsetY: 0, width: w, height: h };
  const wide = view.width / zoom, tall = view.height / zoom;
  return places.filter((place) => {
    const x = ((place % w) + 0.5) / w, y = 1 - (Math.floor(place / w) + 0.5) / h; // from the top
    near.setViewOffset(view.fullWidth, view.fullHeight, view.offsetX + x * view.width - wide / 2, view.offsetY + y * view.height - tall / 2, wide, tall);
    renderer.render(scene, near);
    const larger = [];
    layer_counts(renderer, wanted, larger);
    return larger.some((one) => Math.abs((one % w) + 0.5 - w / 2) <= zoom && Math.abs(Math.floor(one / w) + 0.5 - h / 2) <= zoom);
  }).length;
}

// Draws the layers alone.
function with_layers(renderer, scene, draw) {
  const { background: before, overrideMaterial } = scene;
  scene.background = null;
  scene.overrideMaterial = layers;
  renderer.setClearColor(0x000000, 1);
  const found = draw();
  scene.background = before;
  scene.overrideMaterial = overrideMaterial;
  return found;
}

// Looks from a point in all six directions and adds what is seen. near: nothing is nearer to the point. turn: in
// radians, of all directions. closely: a pixel is wrong only where a look nearer confirms it.
export function around(renderer, scene, point, near, size, turn, closely = false) {
  const camera = new THREE.PerspectiveCamera(91, 1, near, size * 4), sum = { all: 0, empty: 0, wrong: 0, most: 0 };
  const turned = new THREE.Matrix4().makeRotationAxis(new THREE.Vector3(1, 2, 3).normalize(), turn), target = new THREE.Vector3();
  camera.position.set(...point);
  return with_layers(renderer, scene, () => {
    for (const [x, y, z] of [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]) {
      camera.up.set(z, x, y).applyMatrix4(turned);
      camera.lookAt(target.set(x, y, z).applyMatrix4(turned).add(camera.position));
      renderer.render(scene, camera);
      const places = [], seen = layer_counts(renderer, 1, places);
      if (closely) seen.wrong = gaps_at(renderer, scene, camera, places, 1);
      for (const name of ["all", "empty", "wrong"]) sum[name] += seen[name];
      sum.most = Math.max(sum.most, seen.most);
    }
    return sum;
  });
}

// Looks through a camera: from outside of all, or from inside. closely: gaps, of the wrong pixels, are those that a
// look nearer confirms.
export function through(renderer, scene, camera, inside = false, closely = false) {
  return with_layers(renderer, scene, () => {
    renderer.render(scene, camera);
    const places = [], wanted = inside ? 1 : 0, found = layer_counts(renderer, wanted, places);
    return closely ? { ...found, gaps: gaps_at(renderer, scene, camera, places, wanted) } : found;
  });
}
