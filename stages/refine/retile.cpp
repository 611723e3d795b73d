#include "stages/refine/retile.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "stages/contouring/normal_clusters.h"
#include "stages/exact/orientation.h"

namespace voxweld {
namespace {

constexpr std::uint32_t not_in_tile = 0xffffffffu;

// What f(triangle, value) makes of a value for each block that has triangles, by the blocks' codes.
template <class Value, class F>
std::map<std::uint64_t, Value> by_block(const RefineMesh& mesh, const CubeLattice& blocks, F&& f) {
  std::map<std::uint64_t, Value> values;
  NearbyCubes nearby(blocks);
  auto last = values.end();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (nearby.moves_to(mesh.positions[mesh.triangles[t][0]]) || last == values.end())
      last = values.try_emplace(CellKey{tile_block_level, nearby.cube()}.code()).first;
    f(t, last->second);
  }
  return values;
}

// One order of all triangles of a mesh: by block, then by ids. (To sort those of one block after the
// other takes a third of the time of sorting all.)
std::vector<std::uint32_t> in_order(const RefineMesh& mesh, const CubeLattice& blocks) {
  const auto lists = by_block<std::vector<std::uint32_t>>(
      mesh, blocks, [](std::uint32_t t, std::vector<std::uint32_t>& list) { list.push_back(t); });
  std::vector<std::uint32_t> order;
  order.reserve(mesh.triangles.size());
  struct Place {
    VertexId first;  // mostly tells the order
    std::uint32_t triangle;
  };
  std::vector<Place> sorted;
  for (const auto& [code, list] : lists) {
    sorted.clear();
    for (const std::uint32_t t : list) sorted.push_back({mesh.ids[mesh.triangles[t][0]], t});
    std::ranges::sort(sorted, [&](const Place& a, const Place& b) {
      if (a.first != b.first) return a.first < b.first;
      return mesh.ids_of(a.triangle) < mesh.ids_of(b.triangle);
    });
    for (const Place& place : sorted) order.push_back(place.triangle);
  }
  return order;
}

void add_corner_normals(const RefineMesh& mesh, const std::array<std::uint32_t, 3>& triangle,
                        TileMesh& tile) {
  const Index3 normal = exact_normal(mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                                     mesh.positions[triangle[2]]);
  if (normal == Index3{}) ++tile.collinear;
  if (mesh.normals.empty()) return;
  const Vec3 direction = as_vec3(normal);
  const NormalSense sense = mesh.sides.empty() ? NormalSense::outward : NormalSense::either;
  const auto cluster = [&](std::uint32_t v) {
    return nearest_cluster(mesh.normals[v], direction, sense);
  };
  tile.corner_normals.push_back({cluster(triangle[0]), cluster(triangle[1]), cluster(triangle[2])});
}

// Those there are, ascending.
std::vector<MaterialPair> distinct_sides(const RefineMesh& mesh) {
  std::vector<MaterialPair> pairs = mesh.sides;
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return {pairs.begin(), pairs.end()};
}

}  // namespace

RefineMesh to_refine_mesh(TileMesh tile) {
  RefineMesh mesh;
  mesh.sides.reserve(tile.triangle_pairs.size());
  for (const std::uint32_t pair : tile.triangle_pairs) mesh.sides.push_back(tile.pairs[pair]);
  for (auto& triangle : tile.triangles) {
    const auto lowest =
        std::ranges::min_element(triangle, {}, [&](std::uint32_t v) { return tile.ids[v]; });
    std::rotate(triangle.begin(), lowest, triangle.end());
  }
  mesh.positions = std::move(tile.positions);
  mesh.ids = std::move(tile.ids);
  mesh.aims = std::move(tile.aims);
  mesh.normals = std::move(tile.normals);
  mesh.triangles = std::move(tile.triangles);
  return mesh;
}

CubeLattice tile_blocks(const RefineFrame& frame) {
  return CubeLattice(frame, 0, tile_block_level);
}

std::uint64_t block_code(const RefineMesh& mesh, std::size_t triangle, const CubeLattice& blocks) {
  const Index3 block = blocks.cube_of(mesh.positions[mesh.triangles[triangle][0]]);
  return CellKey{tile_block_level, block}.code();
}

std::vector<CubeCount> count_blocks(const RefineMesh& mesh, const CubeLattice& blocks) {
  const auto triangles =
      by_block<std::uint64_t>(mesh, blocks, [](std::uint32_t, std::uint64_t& count) { ++count; });
  std::vector<CubeCount> counts;
  counts.reserve(triangles.size());
  for (const auto& [code, count] : triangles) counts.push_back({code, tile_block_level, 0, count});
  return counts;
}

bool belongs_to(const RefineMesh& mesh, std::size_t triangle, const CubeLattice& blocks,
                CellKey tile) {
  const std::uint64_t code = block_code(mesh, triangle, blocks), begin = tile.code();
  return begin <= code && code - begin < std::uint64_t{1} << (3 * tile.level);
}

TileMesh to_tile_mesh(const RefineMesh& mesh, CellKey tile, const OutputLattice& lattice,
                      const CubeLattice& blocks) {
  TileMesh out;
  out.tile = tile;
  out.lattice = lattice;
  out.polygon_triangles = mesh.triangles.size();
  out.pairs = distinct_sides(mesh);
  out.positions.reserve(mesh.positions.size());
  out.ids.reserve(mesh.positions.size());
  out.normals.reserve(mesh.normals.size());
  out.triangles.reserve(mesh.triangles.size());
  out.corner_normals.reserve(mesh.normals.empty() ? 0 : mesh.triangles.size());
  out.triangle_pairs.reserve(mesh.sides.size());
  std::vector<std::uint32_t> number(mesh.positions.size(), not_in_tile);
  for (const std::uint32_t t : in_order(mesh, blocks)) {
    auto triangle = mesh.triangles[t];
    add_corner_normals(mesh, triangle, out);
    for (std::uint32_t& v : triangle) {
      if (number[v] == not_in_tile) {
        number[v] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[v]);
        out.ids.push_back(mesh.ids[v]);
        if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
      }
      v = number[v];
    }
    out.triangles.push_back(triangle);
    if (mesh.sides.empty()) continue;
    const auto pair = std::ranges::lower_bound(out.pairs, mesh.sides[t]);
    out.triangle_pairs.push_back(static_cast<std::uint32_t>(pair - out.pairs.begin()));
  }
  return out;
}

std::uint64_t retile_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t sided) {
  // Lists of triangles, at worst one block of all; of the tile vectors that may have grown to twice their content, and hold old
  // and new while they grow. Pairs of labels are at worst one for each triangle, and sorted first.
  return triangles * (44 + 45) + vertices * 100 + sided * (2 * sizeof(MaterialPair) + 12);
}

}  // namespace voxweld
