#include "tests/support/contour_in_memory.h"

#include "stages/merge/octree_reduction.h"
#include "stages/merge/tile_planner.h"
#include "stages/stitch/lattice_plan.h"
#include "stages/stitch/tile_stitcher.h"

namespace voxweld::testing {
namespace {

struct Collector : ReductionSink {
  MemoryContour* out = nullptr;
  TilePlanner* planner = nullptr;
  int brick_level = 0;
  void leaf(CellKey key, const RootRecord& record) override {
    ++out->counts.vertices;
    ++out->counts.leaves[static_cast<std::size_t>(key.level)];
    if (key.level > brick_level)
      out->top.push_back(
          {key.code(), static_cast<std::uint32_t>(key.level), record.vertex, record.residual});
  }
  void cube(const CubeCount& count) override { planner->push(count); }
};

void add_counts(const BrickCounts& from, bool root_leaf, BrickCounts& to) {
  to.active_cells += from.active_cells;
  to.crossing_edges += from.crossing_edges;
  if (root_leaf) return;
  to.vertices += from.vertices;
  for (std::size_t l = 0; l < from.leaves.size(); ++l) to.leaves[l] += from.leaves[l];
  to.worst_residual = std::max(to.worst_residual, from.worst_residual);
  to.worst_finest = std::max(to.worst_finest, from.worst_finest);
}

void reduce_all(const MemoryBricks& bricks, Collector& sink) {
  const int level = bricks.options.brick_level, domain = domain_level(bricks.size);
  const CellKey root{std::max(domain, level), {}};
  OctreeReduction reduction(root, domain, bricks.parameters, sink);
  for (const auto& [code, brick] : bricks.octrees) {
    const CellKey key{level, morton_decode(code)};
    const bool leaf = brick.root.state == NodeState::leaf;
    add_counts(brick.counts, leaf, sink.out->counts);
    reduction.push({key, brick.root, leaf ? brick.polygons.size() : 0});
    if (brick.root.state != NodeState::split) continue;
    std::uint32_t begin = 0;
    for (std::size_t b = 0; b < brick.blocks.size(); ++b) {
      sink.cube({key.code() + (b << (3 * block_level)), block_level, brick.blocks[b].vertices,
                 brick.blocks[b].polygon_end - begin});
      begin = brick.blocks[b].polygon_end;
    }
  }
  OctreeReduction::settle(reduction.finish(), sink);
  sink.out->collapsed_above = reduction.collapsed();
}

}  // namespace

Index3 MemoryBricks::count() const {
  const std::int64_t side = std::int64_t{1} << options.brick_level;
  return {size.x / side + 1, size.y / side + 1, size.z / side + 1};
}

BrickPlace MemoryBricks::place(Index3 brick) const {
  return {brick * (std::int64_t{1} << options.brick_level), options.brick_level};
}

MemoryContour plan_in_memory(const MemoryBricks& bricks) {
  MemoryContour contour;
  TilePlanner planner(std::max(domain_level(bricks.size), block_level),
                      bricks.options.tile_vertices,
                      [&](const PlannedTile& tile) { contour.plan.push_back(tile); });
  Collector sink;
  sink.out = &contour;
  sink.planner = &planner;
  sink.brick_level = bricks.options.brick_level;
  reduce_all(bricks, sink);
  planner.finish();
  return contour;
}

TileMesh stitch_in_memory(const MemoryBricks& bricks, const MemoryContour& contour,
                          const PlannedTile& tile) {
  const int level = bricks.options.brick_level;
  StitchParameters parameters;
  parameters.frame.lattice =
      plan_lattice({bricks.size, bricks.parameters.spacing, bricks.options.precision});
  parameters.frame.spacing = bricks.parameters.spacing;
  TileStitcher stitcher(tile.key(), parameters, contour.top);
  const std::uint64_t begin = tile.code, end = begin + (std::uint64_t{1} << (3 * tile.level));
  for (const auto& [code, brick] : bricks.octrees) {
    const std::uint64_t first = code << (3 * level), last = (code + 1) << (3 * level);
    if (last <= begin || first >= end || brick.vertices.empty()) continue;
    StitchBrick part{{level, morton_decode(code)},
                     brick.vertices,
                     brick.polygons,
                     brick.emit_levels,
                     brick.pairs,
                     brick.polygon_pairs,
                     &brick.skin,
                     {}};
    if (static_cast<int>(tile.level) < level) {
      const std::uint64_t b0 = (begin - first) >> (3 * block_level),
                          b1 = (end - first) >> (3 * block_level);
      const std::size_t p0 = b0 == 0 ? 0 : brick.blocks[b0 - 1].polygon_end;
      const std::size_t count = brick.blocks[b1 - 1].polygon_end - p0;
      part.polygons = part.polygons.subspan(p0, count);
      if (!part.polygon_pairs.empty()) part.polygon_pairs = part.polygon_pairs.subspan(p0, count);
      if (!part.emit_levels.empty()) part.emit_levels = part.emit_levels.subspan(p0, count);
    }
    for (int d = 1; d < 8; ++d) {
      const auto up =
          bricks.octrees.find(morton_encode(part.key.at + Index3{d & 1, d >> 1 & 1, d >> 2}));
      if (up != bricks.octrees.end()) part.upper[static_cast<std::size_t>(d)] = &up->second.skin;
    }
    stitcher.add(part);
  }
  return stitcher.finish();
}

MemoryContour contour_in_memory(const MemoryVolume& volume, const ContourParameters& parameters,
                                const MemoryOptions& options) {
  MemoryBricks bricks{volume.size, parameters, options, {}};
  BrickScratch scratch;
  const Index3 count = bricks.count();
  const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                        volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
  for (std::int64_t z = 0; z < count.z; ++z)
    for (std::int64_t y = 0; y < count.y; ++y)
      for (std::int64_t x = 0; x < count.x; ++x)
        build_brick(block, bricks.place({x, y, z}), parameters, scratch,
                    bricks.octrees[morton_encode({x, y, z})]);
  MemoryContour contour = plan_in_memory(bricks);
  for (const PlannedTile& tile : contour.plan)
    contour.tiles.push_back(stitch_in_memory(bricks, contour, tile));
  return contour;
}

LatticeWeld weld_tiles(const std::vector<TileMesh>& tiles) {
  LatticeWeld welded;
  std::map<std::array<std::int32_t, 3>, std::uint32_t> index;
  for (const TileMesh& tile : tiles)
    for (const auto& triangle : tile.triangles) {
      std::array<std::uint32_t, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [at, fresh] = index.emplace(tile.positions[triangle[k]],
                                               static_cast<std::uint32_t>(welded.vertices.size()));
        if (fresh) welded.vertices.push_back(at->first);
        corners[k] = at->second;
      }
      welded.triangles.push_back(corners);
    }
  return welded;
}

}  // namespace voxweld::testing
