// Volumes of labels, and what to look at in the complex between them.
#pragma once

#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "storage/types/material.h"
#include "tests/support/contour_in_memory.h"
#include "tests/support/lattice_place.h"
#include "tests/support/mesh_check.h"

namespace voxweld::testing {

template <class F>
MemoryVolume labels(Index3 size, F&& label_at) {
  return MemoryVolume::made<std::uint64_t>(size, SampleType::u64, label_at);
}

inline MemoryVolume noise(Index3 size, unsigned count, unsigned seed) {
  std::mt19937 random(seed);
  return labels(size, [&](Index3) { return random() % count; });
}

inline double distance2(Index3 p, const Vec3& c) {
  const Vec3 d = as_vec3(p) - c;
  return dot(d, d);
}

// Cells of random points, some of them of one label; label 0 around a ball.
inline MemoryVolume voronoi(std::int64_t side, unsigned points, unsigned count, unsigned seed) {
  std::mt19937 random(seed);
  const auto real = [&] { return static_cast<double>(random() % 10000) / 10000; };
  std::vector<Vec3> at;
  for (unsigned i = 0; i < points; ++i)
    at.push_back(Vec3{real(), real(), real()} * static_cast<double>(side));
  const double middle = static_cast<double>(side - 1) / 2, radius = middle * 0.85;
  return labels(splat(side), [&](Index3 p) -> std::uint64_t {
    if (distance2(p, {middle, middle, middle}) > radius * radius) return 0;
    std::size_t best = 0;
    for (std::size_t i = 1; i < at.size(); ++i)
      if (distance2(p, at[i]) < distance2(p, at[best])) best = i;
    return 1 + best % count;
  });
}

struct Complex {
  LatticeWeld mesh;
  std::vector<MaterialPair> pairs;  // of the triangles
};

// Of every edge and label: how often the label's boundary runs along it one way more than the
// other.
inline std::size_t unbalanced(const Complex& complex) {
  std::map<std::tuple<std::uint32_t, std::uint32_t, Material>, int> sum;
  for (std::size_t i = 0; i < complex.mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = complex.mesh.triangles[i][k],
                          b = complex.mesh.triangles[i][(k + 1) % 3];
      const int way = a < b ? 1 : -1;
      sum[{std::min(a, b), std::max(a, b), complex.pairs[i].inside}] += way;
      sum[{std::min(a, b), std::max(a, b), complex.pairs[i].outside}] -= way;
    }
  std::size_t count = 0;
  for (const auto& [edge, balance] : sum) count += balance != 0 ? 1 : 0;
  return count;
}

// Components and Euler characteristic of the whole and of each label's boundary.
inline std::map<Material, std::pair<std::size_t, std::int64_t>> topology(const Complex& complex) {
  std::map<Material, std::vector<Triangle>> of_label;
  for (std::size_t i = 0; i < complex.mesh.triangles.size(); ++i) {
    of_label[complex.pairs[i].inside].push_back(complex.mesh.triangles[i]);
    of_label[complex.pairs[i].outside].push_back(complex.mesh.triangles[i]);
  }
  std::map<Material, std::pair<std::size_t, std::int64_t>> result;
  for (const auto& [label, triangles] : of_label)
    result[label] = {connected_components(triangles), euler_characteristic(triangles)};
  return result;
}

}  // namespace voxweld::testing
