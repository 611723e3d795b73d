// Small meshes made by hand: a torus and a cube on an output lattice, whole or cut into tiles.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "storage/types/tile_mesh.h"

namespace voxweld::testing {

// Step 1/64, origin -2: samples at multiples of 1, coordinates up to 2^bits / 64 - 2.
inline OutputLattice small_lattice(int bits = 14) {
  return {1.0 / 64, bits, {-2, -2, -2}};
}

inline std::array<std::int32_t, 3> snap(const OutputLattice& lattice, Vec3 p) {
  std::array<std::int32_t, 3> q;
  for (int axis = 0; axis < 3; ++axis)
    q[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(
        std::lround((p[axis] - lattice.origin[static_cast<std::size_t>(axis)]) / lattice.step));
  return q;
}

inline void add_quad(TileMesh& mesh, const std::array<std::uint32_t, 4>& v,
                     const std::array<std::uint8_t, 4>& c = {}) {
  mesh.triangles.push_back({v[0], v[1], v[2]});
  mesh.triangles.push_back({v[0], v[2], v[3]});
  mesh.corner_normals.push_back({c[0], c[1], c[2]});
  mesh.corner_normals.push_back({c[0], c[2], c[3]});
  ++mesh.quads;
}

struct TorusShape {
  int around = 24, across = 12;  // quads
  Vec3 centre{20, 20, 20};
  double radius = 12, tube = 5;
  bool creased = true;  // a second normal cluster along one circle
};

// Outward-facing quads, ids by number.
inline TileMesh make_torus(const TorusShape& shape, const OutputLattice& lattice) {
  TileMesh mesh;
  mesh.lattice = lattice;
  const auto vertex = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % shape.around) * shape.across + j % shape.across);
  };
  for (int i = 0; i < shape.around; ++i) {
    for (int j = 0; j < shape.across; ++j) {
      const double a = 2 * std::numbers::pi * i / shape.around;
      const double b = 2 * std::numbers::pi * j / shape.across;
      const Vec3 n{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
      const Vec3 ring = shape.centre + Vec3{std::cos(a), std::sin(a), 0} * shape.radius;
      mesh.positions.push_back(snap(lattice, ring + n * shape.tube));
      mesh.normals.push_back({pack_normal(n), pack_normal(Vec3{0, 0, 1}), PackedNormal{}});
      mesh.ids.push_back({static_cast<std::uint64_t>(vertex(i, j)) << 2});
    }
  }
  for (int i = 0; i < shape.around; ++i) {
    for (int j = 0; j < shape.across; ++j) {
      const std::uint8_t low = shape.creased && j == 0 ? 1 : 0;
      const std::uint8_t high = shape.creased && j == shape.across - 1 ? 0 : 0;
      add_quad(mesh, {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)},
               {low, low, high, high});
    }
  }
  return mesh;
}

// An axis-aligned cube of `n` x `n` quads a face, vertices shared, one normal cluster an axis.
inline TileMesh make_cube(const OutputLattice& lattice, Vec3 lo, double side, int n = 1) {
  TileMesh mesh;
  mesh.lattice = lattice;
  std::map<std::array<int, 3>, std::uint32_t> index;
  const auto vertex = [&](std::array<int, 3> at) {
    const auto [found, added] = index.try_emplace(at, mesh.positions.size());
    if (!added) return found->second;
    mesh.positions.push_back(
        snap(lattice, lo + Vec3{double(at[0]), double(at[1]), double(at[2])} * (side / n)));
    std::array<PackedNormal, max_clusters> normals;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 normal;
      normal[static_cast<int>(axis)] = at[axis] == n ? 1 : -1;
      normals[axis] = pack_normal(normal);
    }
    mesh.normals.push_back(normals);
    mesh.ids.push_back({std::uint64_t{found->second} << 2});
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
    for (const int end : {0, n}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          std::array<std::array<int, 2>, 4> corners{
              {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
          if (end == 0) std::swap(corners[1], corners[3]);
          std::array<std::uint32_t, 4> v;
          for (std::size_t k = 0; k < 4; ++k) {
            std::array<int, 3> at;
            at[axis] = end;
            at[u] = corners[k][0];
            at[w] = corners[k][1];
            v[k] = vertex(at);
          }
          const auto c = static_cast<std::uint8_t>(axis);
          add_quad(mesh, v, {c, c, c, c});
        }
      }
    }
  }
  return mesh;
}

// The polygons (pairs of triangles) of `mesh` whose first corner lies in a cube of 2^level cells, a
// tile for each cube, in Morton order. Samples are 1 apart: lattice cell = floor(position + 1).
inline std::vector<TileMesh> cut_into_tiles(const TileMesh& mesh, int level) {
  std::map<std::uint64_t, TileMesh> tiles;
  std::map<std::uint64_t, std::map<std::uint32_t, std::uint32_t>> renumbered;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& q = mesh.positions[mesh.triangles[i & ~std::size_t{1}][0]];
    Index3 at;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = static_cast<std::int64_t>(std::floor(
                     mesh.lattice.coordinate(axis, q[static_cast<std::size_t>(axis)]) + 1)) >>
                 level;
    const CellKey key{level, at};
    TileMesh& tile = tiles[key.code()];
    tile.tile = key;
    tile.lattice = mesh.lattice;
    auto& number = renumbered[key.code()];
    auto& corner = tile.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[i][k];
      const auto [found, added] = number.try_emplace(v, tile.positions.size());
      if (added) {
        tile.positions.push_back(mesh.positions[v]);
        tile.ids.push_back(mesh.ids[v]);
        tile.normals.push_back(mesh.normals[v]);
      }
      corner[k] = found->second;
    }
    tile.corner_normals.push_back(mesh.corner_normals[i]);
    if (i % 2 == 0) ++tile.quads;
  }
  std::vector<TileMesh> out;
  for (auto& [code, tile] : tiles) out.push_back(std::move(tile));
  return out;
}

}  // namespace voxweld::testing
