#include "stages/encode/mesh_accumulator.h"

#include <fmt/format.h>

#include <algorithm>

#include "storage/support/error.h"

namespace voxweld {
namespace {

using Position = std::array<std::int32_t, 3>;
using Normals = std::array<PackedNormal, max_clusters>;
using Triangle = std::array<std::uint32_t, 3>;
using Clusters = std::array<std::uint8_t, 3>;

}  // namespace

void MeshAccumulator::check(const TileMesh& tile) const {
  if (mesh_.triangles.empty()) return;
  if (!(tile.lattice == mesh_.lattice))
    throw InputError("cannot join tiles: they lie on different output lattices");
  if (tile.corner_normals.empty() != mesh_.corner_normals.empty())
    throw InputError("cannot join tiles: only some of them have normals");
  if (tile.triangle_pairs.empty() != mesh_.triangle_pairs.empty())
    throw InputError("cannot join tiles: only some of them say which labels they separate");
}

std::uint32_t MeshAccumulator::add_vertex(const TileMesh& tile, std::uint32_t v) {
  const VertexId id = tile.ids[v];
  const std::uint64_t hash = mix_bits(id.bits);
  const std::uint32_t found =
      table_.find(hash, [&](std::uint32_t i) { return mesh_.ids[i] == id; });
  if (found != VertexTable::none) {
    if (mesh_.positions[found] != tile.positions[v])
      throw InputError(fmt::format(
          "cannot join tiles: vertex {:#x} is at ({}, {}, {}) in one and at ({}, {}, {}) in "
          "another",
          id.bits, mesh_.positions[found][0], mesh_.positions[found][1], mesh_.positions[found][2],
          tile.positions[v][0], tile.positions[v][1], tile.positions[v][2]));
    return found;
  }
  if (mesh_.ids.size() >= VertexTable::none)
    throw InputError("the merged mesh has more than 4,294,967,294 vertices: write tiles only");
  const auto index = static_cast<std::uint32_t>(mesh_.ids.size());
  mesh_.ids.push_back(id);
  mesh_.positions.push_back(tile.positions[v]);
  if (!tile.normals.empty()) mesh_.normals.push_back(tile.normals[v]);
  table_.insert(hash, index);
  return index;
}

void MeshAccumulator::append(const TileMesh& tile) {
  if (tile.triangles.empty()) return;
  check(tile);
  if (mesh_.triangles.empty()) {
    mesh_.tile = tile.tile;
    mesh_.lattice = tile.lattice;
  }
  merged_.assign(tile.positions.size(), VertexTable::none);
  for (const Triangle& t : tile.triangles) {
    Triangle& out = mesh_.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& m = merged_[t[k]];
      if (m == VertexTable::none) m = add_vertex(tile, t[k]);
      out[k] = m;
    }
  }
  mesh_.corner_normals.insert(mesh_.corner_normals.end(), tile.corner_normals.begin(),
                              tile.corner_normals.end());
  append_pairs(tile);
  mesh_.quads += tile.quads;
  mesh_.polygon_triangles += tile.polygon_triangles;
  mesh_.collinear += tile.collinear;
}

void MeshAccumulator::append_pairs(const TileMesh& tile) {
  std::vector<std::uint32_t> place;
  for (const MaterialPair& pair : tile.pairs) {
    const auto [at, is_new] =
        pairs_.try_emplace(pair, static_cast<std::uint32_t>(mesh_.pairs.size()));
    if (is_new) mesh_.pairs.push_back(pair);
    place.push_back(at->second);
  }
  for (const std::uint32_t pair : tile.triangle_pairs) mesh_.triangle_pairs.push_back(place[pair]);
}

void MeshAccumulator::sort_pairs() {
  std::vector<std::uint32_t> place(mesh_.pairs.size());
  std::uint32_t next = 0;
  for (const auto& [pair, met] : pairs_) {
    place[met] = next;
    mesh_.pairs[next++] = pair;
  }
  for (std::uint32_t& pair : mesh_.triangle_pairs) pair = place[pair];
  pairs_.clear();
}

TileMesh MeshAccumulator::take() {
  sort_pairs();
  table_.clear();
  merged_ = {};
  TileMesh out = std::move(mesh_);
  mesh_ = {};
  return out;
}

std::uint64_t accumulator_memory_bytes(std::uint64_t vertices, std::uint64_t triangles,
                                       bool normals) {
  // A vector's capacity is at most twice its size, and while it grows it holds the old array as
  // well: once more the size, of one array at a time. The table is at least 40 % full.
  const std::uint64_t vertex =
      sizeof(Position) + sizeof(VertexId) + (normals ? sizeof(Normals) : 0) + 5;
  const std::uint64_t triangle = sizeof(Triangle) + (normals ? sizeof(Clusters) : 0);
  const std::uint64_t growing = std::max(vertices * sizeof(Normals), triangles * sizeof(Triangle));
  return 2 * (vertices * vertex + triangles * triangle) + growing + (std::uint64_t{1} << 20);
}

}  // namespace voxweld
