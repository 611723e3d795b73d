#include "stages/whole/contour_volume.h"

#include "stages/build/label_bricks.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/merge/shard_reduction.h"
#include "stages/stitch/lattice_plan.h"
#include "stages/stitch/stitch_tile.h"

namespace voxweld {
namespace {

// The octree is put together from cubes of so many bricks a side. The result is the same for any;
// of so few small volumes have several, as large ones have in the program.
constexpr int cube_bricks = 2;

HaloBlock block_of(const VolumeSamples& samples) {
  const Index3 size = samples.size;
  return {samples.type, size, {{}, size}, samples.bytes.data(), size.x, size.x * size.y};
}

class Planner : public TopSink {
 public:
  explicit Planner(VolumeContour& out) : out_(out) {}
  void leaf(const TopLeaf& leaf, bool) override { out_.top.push_back(leaf); }
  void tile(const PlannedTile& tile) override { out_.plan.push_back(tile); }

 private:
  VolumeContour& out_;
};

class Pieces : public BrickPieces {
 public:
  explicit Pieces(const VolumeBricks& bricks) : bricks_(bricks) {}

  // Those with a surface that the tile meets.
  std::vector<CellKey> of_tile(const PlannedTile& tile) const {
    const int level = bricks_.options.brick_level;
    const std::uint64_t cells = std::uint64_t{1} << (3 * tile.level);
    auto at = bricks_.octrees.lower_bound(tile.code >> (3 * level));
    const auto end = bricks_.octrees.upper_bound((tile.code + cells - 1) >> (3 * level));
    std::vector<CellKey> keys;
    for (; at != end; ++at)
      if (!at->second.vertices.empty()) keys.push_back({level, morton_decode(at->first)});
    return keys;
  }
  const BrickOctree& brick(const CellKey& key) override {
    return bricks_.octrees.at(morton_encode(key.at));
  }
  const GhostLayer* ghost(Index3 brick, int) override {
    const auto found = bricks_.octrees.find(morton_encode(brick));
    return found == bricks_.octrees.end() ? nullptr : &found->second.ghost;
  }

 private:
  const VolumeBricks& bricks_;
};

AboveBricks above_all(const VolumeBricks& bricks, const std::vector<ShardNode>& shards,
                      const ReducedNode& top) {
  std::vector<ShardClusters> parts;
  parts.reserve(shards.size());
  for (const ShardNode& shard : shards) parts.push_back({shard.key.code(), &shard.clusters});
  std::vector<std::uint64_t> codes;
  codes.reserve(bricks.octrees.size());
  for (const auto& [code, octree] : bricks.octrees)
    codes.push_back(code << (3 * bricks.options.brick_level));
  return bricks_above(parts, top, codes);
}

}  // namespace

BrickGrid VolumeBricks::grid() const {
  return BrickGrid(size, options.brick_level, cube_bricks);
}

VolumeBricks build_bricks(const VolumeSamples& samples, const ContourParameters& parameters,
                          const ContourOptions& options) {
  VolumeBricks bricks{samples.size, parameters, options};
  const BrickGrid grid = bricks.grid();
  BrickScratch scratch;
  each_index({{}, grid.bricks()}, [&](Index3 at) {
    build_brick(block_of(samples), place_of_brick(grid, at), parameters, scratch,
                bricks.octrees[morton_encode(at)]);
  });
  return bricks;
}

std::map<Material, VolumeBricks> build_label_bricks(const VolumeSamples& samples,
                                                    const ContourParameters& parameters,
                                                    const ContourOptions& options) {
  std::map<Material, VolumeBricks> all;
  const VolumeBricks none{samples.size, parameters, options};
  const BrickGrid grid = none.grid();
  LabelBricks bricks;
  bricks.fill(block_of(samples), parameters);
  each_index({{}, grid.bricks()}, [&](Index3 at) {
    bricks.each(place_of_brick(grid, at), parameters,
                [&](Material material, const BrickOctree& octree) {
                  if (octree.root.state == NodeState::outside) return;
                  VolumeBricks& label = all.try_emplace(material, none).first->second;
                  label.octrees[morton_encode(at)] = octree;
                });
  });
  return all;
}

VolumeContour plan_tiles(const VolumeBricks& bricks) {
  VolumeContour contour;
  const BrickGrid grid = bricks.grid();
  Planner sink(contour);
  TopReduction top(grid, bricks.parameters, bricks.options.tile_vertices, sink);
  auto brick = bricks.octrees.begin();
  const bool by_sheets = collapses_by_sheets(bricks.parameters);
  std::vector<ShardNode> shards;
  for (const BrickGrid::Cube& cube : grid.all_cubes()) {
    CubeReduction reduction(grid, cube.key, bricks.parameters);
    for (; brick != bricks.octrees.end(); ++brick) {
      const CellKey key{grid.brick_level(), morton_decode(brick->first)};
      if (!cube.key.cells().contains(key.cells())) break;
      const BrickOctree& octree = brick->second;
      add_brick(contour.counts, octree.counts, octree.root.state);
      reduction.add(key, octree.root, octree.polygons.size(), filled_blocks(octree.blocks));
      if (by_sheets && !octree.vertices.empty()) reduction.add_record(key, octree.record);
    }
    ShardNode node = reduction.finish();
    top.add(node);
    if (node.clusters.record.has_surface()) shards.push_back(std::move(node));
    add(contour.counts, reduction.counts());
    contour.collapsed_above += reduction.collapsed();
  }
  top.finish();
  add(contour.counts, top.counts());
  contour.collapsed_above += top.collapsed();
  if (by_sheets) contour.above = above_all(bricks, shards, top.reduced());
  return contour;
}

TileMesh stitch_tile(const VolumeBricks& bricks, const VolumeContour& plan,
                     const PlannedTile& tile) {
  const ContourOptions& options = bricks.options;
  const Vec3 spacing = bricks.parameters.spacing;
  const OutputLattice lattice = plan_lattice({bricks.size, spacing, options.precision});
  const StitchParameters parameters{{lattice, spacing, {}, bricks.size},
                                    options.first,
                                    options.normals,
                                    bricks.parameters.simplify.overhang > 0};
  Pieces pieces(bricks);
  if (collapses_by_sheets(bricks.parameters))
    return stitch_tile(tile, parameters, pieces.of_tile(tile), plan.above, pieces);
  return stitch_tile(tile, parameters, pieces.of_tile(tile), plan.top, pieces);
}

VolumeContour contour_bricks(const VolumeBricks& bricks) {
  VolumeContour contour = plan_tiles(bricks);
  for (const PlannedTile& tile : contour.plan)
    contour.tiles.push_back(stitch_tile(bricks, contour, tile));
  return contour;
}

VolumeContour contour_volume(const VolumeSamples& samples, const ContourParameters& parameters,
                             const ContourOptions& options) {
  return contour_bricks(build_bricks(samples, parameters, options));
}

TileMesh join_tiles(std::span<const TileMesh> tiles) {
  MeshAccumulator all;
  for (const TileMesh& tile : tiles) all.append(tile);
  return all.take();
}

}  // namespace voxweld
