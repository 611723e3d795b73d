// A closed mesh over several cubes, with triangles of all sizes, for tests of refine.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "stages/refine/refine_range.h"

namespace voxweld::testing {

// 200 samples a side: four cubes an axis, and five in the second pass.
inline RefineFrame torus_frame() {
  RefineFrame frame;
  frame.lattice = {0.25, 10, {-1, -1, -1}};
  frame.size = {200, 200, 200};
  return frame;
}

inline RefineMesh torus() {
  // Coarse on one side, fine on the other; ids in no order of place.
  constexpr std::uint32_t around = 60, across = 24;
  RefineMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double s = static_cast<double>(i) / around;
      const double u = 2 * std::numbers::pi * s * (0.4 + 0.6 * s);
      const double v = 2 * std::numbers::pi * j / across;
      const double r = 270 + 110 * std::cos(v);
      mesh.positions.push_back({static_cast<std::int32_t>(400 + r * std::cos(u)),
                                static_cast<std::int32_t>(400 + r * std::sin(u)),
                                static_cast<std::int32_t>(400 + 110 * std::sin(v))});
      mesh.aims.push_back(mesh.positions.back());
      if ((i + j) % 7 == 0) mesh.aims.back()[2] += 3;
      mesh.ids.push_back({(std::uint64_t{i} * across + j) * 7919 % 100003});
      mesh.normals.push_back({PackedNormal{static_cast<std::int16_t>(i), 1}});
    }
  const auto add = [&](std::array<std::uint32_t, 3> t) {
    const auto lowest = std::ranges::min_element(t, {}, [&](auto v) { return mesh.ids[v]; });
    std::rotate(t.begin(), lowest, t.end());
    mesh.triangles.push_back(t);
  };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
      const std::uint32_t a = i * across + j, b = i1 * across + j, c = i1 * across + j1,
                          d = i * across + j1;
      add({a, b, c});
      add({a, c, d});
    }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); t += 5)
    mesh.samples.push_back({mesh.positions[mesh.triangles[t][1]], t});
  return mesh;
}

// As if it lay between labels; what a triangle separates depends on its ids alone.
inline RefineMesh with_sides(RefineMesh mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint64_t label = mesh.ids_of(t)[0].bits % 3;
    mesh.sides.push_back({label, label == 0 ? exterior : label + 1});
  }
  return mesh;
}

// The same mesh, its triangles and vertices in other orders.
inline RefineMesh shuffled(const RefineMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint32_t> vertices(mesh.positions.size()), place(mesh.positions.size()),
      triangles(mesh.triangles.size());
  std::iota(vertices.begin(), vertices.end(), 0U);
  std::iota(triangles.begin(), triangles.end(), 0U);
  std::shuffle(vertices.begin(), vertices.end(), random);
  std::shuffle(triangles.begin(), triangles.end(), random);
  RefineMesh out;
  for (const std::uint32_t v : vertices) {
    place[v] = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(mesh.positions[v]);
    out.ids.push_back(mesh.ids[v]);
    out.aims.push_back(mesh.aims[v]);
    out.normals.push_back(mesh.normals[v]);
  }
  for (const std::uint32_t t : triangles) {
    const auto as = static_cast<std::uint32_t>(out.triangles.size());
    for (const SurfaceSample& sample : mesh.samples)
      if (sample.triangle == t) out.samples.push_back({sample.point, as});
    auto triangle = mesh.triangles[t];
    for (std::uint32_t& v : triangle) v = place[v];
    out.triangles.push_back(triangle);
    if (!mesh.sides.empty()) out.sides.push_back(mesh.sides[t]);
  }
  return out;
}

// A triangle by what it is, wherever it stands in a mesh.
using Shape = std::tuple<std::array<std::uint64_t, 3>, std::array<LatticePoint, 3>, MaterialPair>;
inline Shape shape_of(const RefineMesh& mesh, std::size_t t) {
  const auto& c = mesh.triangles[t];
  return {{mesh.ids[c[0]].bits, mesh.ids[c[1]].bits, mesh.ids[c[2]].bits},
          {mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]},
          mesh.sides.empty() ? MaterialPair{} : mesh.sides[t]};
}
inline std::multiset<Shape> shapes_of(const RefineMesh& mesh) {
  std::multiset<Shape> shapes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) shapes.insert(shape_of(mesh, t));
  return shapes;
}

inline bool same_mesh(const RefineMesh& a, const RefineMesh& b) {
  return a.positions == b.positions && a.ids == b.ids && a.aims == b.aims &&
         a.normals == b.normals && a.triangles == b.triangles && a.sides == b.sides &&
         a.samples == b.samples;
}

}  // namespace voxweld::testing
