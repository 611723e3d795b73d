// Whether a brick's octree can be cut.
#include <algorithm>

#include "stages/build/cut_brick.h"
#include "stages/contouring/cell_topology.h"

namespace voxweld {
namespace {

bool is_level(LeafCode leaf) {
  return leaf.level() <= max_brick_level;
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
    if (!names_one(cluster.parent, i) || !is_level(cluster.vertex.leaf)) return false;
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
  const auto is_vertex = [&](std::uint32_t number) { return number < ghost.vertices.size(); };
  const auto fits = [&](const GhostCell& cell) {
    const std::size_t sheets =
        cell_sheets(static_cast<CellSigns>(cell.signs()), cell.joined()).sheets;
    return sheets == 1 ? is_vertex(cell.first()) : cell.first() + sheets <= ghost.apart.size();
  };
  return ghost.roots.size() == ghost.vertices.size() && std::ranges::all_of(ghost.cells, fits) &&
         std::ranges::all_of(ghost.apart, is_vertex) &&
         std::ranges::all_of(ghost.vertices, [&](const GhostVertex& v) {
           return v.brick_vertex < octree.vertices.size();
         });
}

bool polygons_fit(const BrickOctree& octree) {
  std::size_t end = 0;
  for (const BlockCount& block : octree.blocks) {
    if (block.polygon_end < end) return false;
    end = block.polygon_end;
  }
  return end == octree.polygons.size() &&
         std::ranges::all_of(octree.polygons, [&](const PolygonRefs& refs) {
           return std::ranges::all_of(refs, [&](CornerRef ref) {
             return ref.is_foreign() || ref.vertex() < octree.vertices.size();
           });
         });
}

}  // namespace

bool can_be_cut(const BrickOctree& octree) {
  return octree.roots.size() == octree.vertices.size() && levels_fit(octree) &&
         ghosts_fit(octree) && polygons_fit(octree) &&
         std::ranges::all_of(octree.vertices,
                             [](const LeafVertex& vertex) { return is_level(vertex.leaf); }) &&
         std::ranges::all_of(octree.roots, [&](std::uint8_t root) {
           return root == BrickOctree::no_root || root < octree.record.clusters.size();
         });
}

}  // namespace voxweld
