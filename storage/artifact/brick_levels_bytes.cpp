#include "storage/artifact/brick_levels_bytes.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

// Written as they lie in memory.
static_assert(sizeof(KeptCluster) == 36 && sizeof(BlockMerge) == 8 &&
              std::is_trivially_copyable_v<KeptCluster> &&
              std::is_trivially_copyable_v<BlockMerge>);

template <class T>
void put_values(const std::vector<T>& values, std::vector<std::byte>& out) {
  const auto bytes = as_section(values);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

template <class T>
void take_values_of(std::span<const std::byte>& bytes, std::size_t count, std::vector<T>& values) {
  values.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(values.data()), bytes.data(), count * sizeof(T));
  bytes = bytes.subspan(count * sizeof(T));
}

bool levels_fit(const BrickOctree& octree) {
  const BrickLevels& levels = octree.levels;
  const auto names_one = [&](std::uint32_t parent, std::size_t end) {
    return parent == BrickLevels::none || parent < end;
  };
  if (levels.errors.size() != octree.vertices.size() ||
      levels.parents.size() != octree.vertices.size())
    return false;
  for (const std::uint32_t parent : levels.parents)
    if (!names_one(parent, levels.clusters.size())) return false;
  for (std::size_t i = 0; i < levels.clusters.size(); ++i) {
    const KeptCluster& cluster = levels.clusters[i];
    if (!names_one(cluster.parent, i)) return false;
    if (cluster.parent != BrickLevels::none &&
        !(cluster.error < levels.clusters[cluster.parent].error))
      return false;
  }
  std::vector<std::uint64_t> fewer(octree.blocks.size());
  return std::ranges::all_of(levels.merges, [&](const BlockMerge& merge) {
    return merge.block() < octree.blocks.size() &&
           (fewer[merge.block()] += merge.fewer()) < octree.blocks[merge.block()].vertices;
  });
}

bool ghosts_fit(const BrickOctree& octree) {
  const GhostLayer& ghost = octree.ghost;
  // Of a cell either a vertex or a place in `apart`.
  const std::size_t most = std::max(ghost.vertices.size(), ghost.apart.size());
  const auto is_vertex = [&](std::uint32_t number) { return number < ghost.vertices.size(); };
  return ghost.roots.size() == ghost.vertices.size() &&
         std::ranges::all_of(ghost.cells, [&](const GhostCell& c) { return c.first() < most; }) &&
         std::ranges::all_of(ghost.apart, is_vertex) &&
         std::ranges::all_of(ghost.vertices, [&](const GhostVertex& v) {
           return v.brick_vertex < octree.vertices.size();
         });
}

}  // namespace

void put_levels(const BrickLevels& levels, std::vector<std::byte>& out) {
  put_values(levels.errors, out);
  put_values(levels.parents, out);
  put_values(levels.clusters, out);
  put_values(levels.merges, out);
}

BrickLevels levels_of(std::span<const std::byte> bytes, const LevelsSize& size) {
  BrickLevels levels;
  take_values_of(bytes, size.vertices, levels.errors);
  take_values_of(bytes, size.vertices, levels.parents);
  take_values_of(bytes, size.clusters, levels.clusters);
  take_values_of(bytes, size.merges, levels.merges);
  return levels;
}

bool names_what_it_has(const BrickOctree& octree) {
  if (!levels_fit(octree) || !ghosts_fit(octree)) return false;
  const auto is_corner = [&](CornerRef ref) {
    return ref.is_foreign() || ref.vertex() < octree.vertices.size();
  };
  const auto is_root = [&](std::uint8_t root) {
    return root == BrickOctree::no_root || root < octree.record.clusters.size();
  };
  return octree.roots.size() == octree.vertices.size() &&
         std::ranges::all_of(octree.roots, is_root) &&
         std::ranges::all_of(octree.polygons, [&](const PolygonRefs& refs) {
           return std::ranges::all_of(refs, is_corner);
         });
}

}  // namespace voxweld
