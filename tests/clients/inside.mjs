// Points inside of a closed mesh, from which nothing of the outside may be seen. By brute force: it is a test.

// Of a ray with all triangles of the nodes: the distances along it, in units of `towards`.
function hits(nodes, from, towards) {
  const found = [], [dx, dy, dz] = towards;
  for (const { positions: p, corners } of nodes)
    for (let i = 0; i < corners.length; i += 3) {
      const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const hx = dy * vz - dz * vy, hy = dz * vx - dx * vz, hz = dx * vy - dy * vx;
      const det = ux * hx + uy * hy + uz * hz;
      if (det === 0) continue;
      const sx = from[0] - p[a], sy = from[1] - p[a + 1], sz = from[2] - p[a + 2];
      const s = (sx * hx + sy * hy + sz * hz) / det;
      if (s < 0 || s > 1) continue;
      const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
      const t = (dx * qx + dy * qy + dz * qz) / det;
      if (t < 0 || s + t > 1) continue;
      const at = (vx * qx + vy * qy + vz * qz) / det;
      if (at > 1e-9) found.push(at);
    }
  return found;
}

// Whether a closed mesh, oriented outward, has the point inside.
export const is_inside = (nodes, point) => hits(nodes, point, [0.5773, 0.5774, 0.5772]).length % 2 === 1;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// Squared, of the origin to a triangle. After Ericson, "Real-Time Collision Detection" (2005), section 5.1.5.
function squared_distance(a, b, c) {
  const ab = b.map((x, k) => x - a[k]), ac = c.map((x, k) => x - a[k]);
  const along = (from, towards, t) => {
    const at = from.map((x, k) => x + t * towards[k]);
    return dot(at, at);
  };
  const d1 = -dot(ab, a), d2 = -dot(ac, a), d3 = -dot(ab, b), d4 = -dot(ac, b), d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d1 <= 0 && d2 <= 0) return dot(a, a);
  if (d3 >= 0 && d4 <= d3) return dot(b, b);
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return along(a, ab, d1 / (d1 - d3));
  if (d6 >= 0 && d5 <= d6) return dot(c, c);
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return along(a, ac, d2 / (d2 - d6));
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return along(b, c.map((x, k) => x - b[k]), (d4 - d3) / (d4 - d3 + d5 - d6));
  const at = a.map((x, k) => x + ab[k] * (vb / (va + vb + vc)) + ac[k] * (vc / (va + vb + vc)));
  return dot(at, at);
}

// How far the nearest triangle is.
export function clearance(nodes, point) {
  let least = Infinity;
  for (const { positions: p, corners } of nodes) {
    const corner = (i) => [p[3 * i] - point[0], p[3 * i + 1] - point[1], p[3 * i + 2] - point[2]];
    for (let i = 0; i < corners.length; i += 3)
      least = Math.min(least, squared_distance(corner(corners[i]), corner(corners[i + 1]), corner(corners[i + 2])));
  }
  return Math.sqrt(least);
}

// The deepest of some: from the middle of a triangle half way to what lies opposite. outside: on the other side of it,
// where that has something opposite.
export function inside_points(nodes, count, next, { tries = 40, outside = false } = {}) {
  const found = [];
  for (let i = 0; i < tries; ++i) {
    const { positions: p, corners } = nodes[Math.floor(next() * nodes.length)], t = 3 * Math.floor((next() * corners.length) / 3);
    const at = [0, 1, 2].map((k) => p.slice(3 * corners[t + k], 3 * corners[t + k] + 3));
    const u = at[1].map((x, k) => x - at[0][k]), v = at[2].map((x, k) => x - at[0][k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], length = Math.hypot(...n);
    if (length === 0) continue;
    const inward = n.map((x) => (outside ? x : -x) / length), middle = [0, 1, 2].map((k) => (at[0][k] + at[1][k] + at[2][k]) / 3);
    const opposite = hits(nodes, middle, inward);
    if (opposite.length === 0) continue;
    const depth = opposite.reduce((a, b) => Math.min(a, b)) / 2;
    found.push({ depth, point: middle.map((x, k) => x + depth * inward[k]) });
  }
  return found.sort((a, b) => b.depth - a.depth).slice(0, count);
}
