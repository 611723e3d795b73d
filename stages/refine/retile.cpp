#include "stages/refine/retile.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "stages/contouring/normal_clusters.h"
#include "stages/exact/orientation.h"

namespace voxweld {
namespace {

constexpr std::uint32_t not_in_tile = 0xffffffffu;

struct BlockCount {
  std::uint64_t code = 0, triangles = 0;
};

// Blocks that have triangles, as they are met first; f(number of its block) for each triangle.
template <class F>
std::vector<BlockCount> find_blocks(const RefineMesh& mesh, const CubeLattice& lattice, F&& f) {
  std::vector<BlockCount> blocks;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;  // by code
  NearbyCubes nearby(lattice);
  std::uint32_t block = 0;
  for (const auto& corners : mesh.triangles) {
    if (nearby.moves_to(mesh.positions[corners[0]]) || blocks.empty()) {
      const std::uint64_t code = CellKey{tile_block_level, nearby.cube()}.code();
      const auto next = static_cast<std::uint32_t>(blocks.size());
      block = numbers.try_emplace(code, next).first->second;
      if (block == next) blocks.push_back({code, 0});
    }
    ++blocks[block].triangles;
    f(block);
  }
  return blocks;
}

// A place in one order of all triangles.
struct Place {
  VertexId first, second;  // mostly tell which of a block comes first
  std::uint32_t triangle = 0;
};

// By block, then by ids. (To sort those of one block after the other takes a third of the time of
// sorting all.)
std::vector<Place> in_order(const RefineMesh& mesh, const CubeLattice& lattice) {
  std::vector<std::uint32_t> block_of;
  block_of.reserve(mesh.triangles.size());
  const auto blocks =
      find_blocks(mesh, lattice, [&](std::uint32_t block) { block_of.push_back(block); });
  std::vector<std::uint32_t> by_code(blocks.size());
  std::iota(by_code.begin(), by_code.end(), 0U);
  std::ranges::sort(by_code, {}, [&](std::uint32_t b) { return blocks[b].code; });
  std::vector<std::size_t> next(blocks.size());
  std::size_t begin = 0;
  for (const std::uint32_t b : by_code) begin = (next[b] = begin) + blocks[b].triangles;
  std::vector<Place> order(mesh.triangles.size());
  for (std::uint32_t t = 0; t < order.size(); ++t)
    order[next[block_of[t]]++] = {mesh.ids[mesh.triangles[t][0]], mesh.ids[mesh.triangles[t][1]],
                                  t};
  auto first = order.begin();
  for (const std::uint32_t b : by_code) {
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(next[b]);
    std::sort(first, end, [&](const Place& x, const Place& y) {
      if (x.first != y.first) return x.first < y.first;
      if (x.second != y.second) return x.second < y.second;
      return mesh.ids_of(x.triangle) < mesh.ids_of(y.triangle);
    });
    first = end;
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
  std::vector<CubeCount> counts;
  for (const auto& [code, triangles] : find_blocks(mesh, blocks, [](std::uint32_t) {}))
    counts.push_back({code, tile_block_level, 0, triangles});
  std::ranges::sort(counts, {}, &CubeCount::code);
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
  for (const auto& [first, second, t] : in_order(mesh, blocks)) {
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
  // Of triangles their block and their place; of the tile vectors that may have grown to twice their
  // content, and hold old and new while they grow. Pairs of labels are at worst one for each triangle, and
  // sorted first.
  return triangles * (44 + 45) + vertices * 100 + sided * (2 * sizeof(MaterialPair) + 12);
}

}  // namespace voxweld
