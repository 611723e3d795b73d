#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "stages/build/brick_leaves.h"
#include "stages/merge/cluster_reduction.h"
#include "tests/stages/cluster_volumes.h"
#include "tests/support/mesh_check.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;
using testing::noise_volume;
using testing::plates;

ContourParameters with(double tolerance) {
  return testing::by_sheets(tolerance);
}

// One brick on its way.
struct Brick {
  BrickFrame frame;
  SignGrid signs;
  ActiveCells cells;
  HermiteEdges edges;
  BrickNodes nodes;
  BrickLeaves leaves;
  BrickOctree octree;

  Brick(const MemoryVolume& volume, const ContourParameters& parameters, CellKey key,
        const BrickNodes::Options& options = {})
      : frame{key.lo(), key.level, domain_level(volume.size)}, nodes(options) {
    const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                          volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
    const int side = frame.side();
    signs.fill(block, frame.origin, side, parameters.surface);
    cells.count(signs, side, {{}, splat(side)});
    cells.find(signs);
    octree.blocks.assign(std::size_t{1} << 3 * (key.level - block_level), {});
    if (cells.size() == 0) return;
    edges.compute(block, frame.origin, side, signs, parameters);
    nodes.simplify(frame, signs, cells, edges, parameters);
    leaves.collect(frame, cells, nodes, octree);
  }
};

CellKey whole(const MemoryVolume& volume) {
  return {std::max(domain_level(volume.size), min_brick_level), {}};
}

// A vertex as it is in the end, wherever it was found.
struct FinalVertex {
  int level = 0;
  FirstSheet first;
  std::array<float, 3> offset{};
  std::array<PackedNormal, max_clusters> normals{};
  bool shares = false;
  friend bool operator==(const FinalVertex&, const FinalVertex&) = default;
};
using Sheet = std::pair<std::uint64_t, int>;  // Morton code of its cell, number
using FinalSheets = std::map<Sheet, FinalVertex>;

struct FinalOctree {
  FinalSheets sheets;
  LeafCounts counts;
  std::map<std::uint64_t, std::uint32_t> planned;  // vertices by block
  std::size_t above = 0;                           // sheets whose vertex lies above the bricks
};

FinalVertex vertex_of(const ClusterLeaf& leaf, bool covered) {
  return {static_cast<int>(leaf.level), leaf.first, leaf.vertex.offset, leaf.vertex.normals,
          leaf.shares != 0 || covered};
}

// By bricks of this level, put together in cubes of two bricks a side, and these in the whole.
FinalOctree by_bricks(const MemoryVolume& volume, const ContourParameters& parameters, int level) {
  FinalOctree all;
  const CellKey root{std::max(domain_level(volume.size), level + 2), {}};
  ClusterReduction top(root, domain_level(volume.size), parameters);
  struct Shard {
    std::vector<std::unique_ptr<Brick>> bricks;  // they point into themselves
    std::vector<CellKey> keys;
    ReducedNode node;
  };
  std::vector<Shard> shards;
  const std::int64_t cubes = std::int64_t{1} << (root.level - level - 1);
  for (std::uint64_t code = 0; code < static_cast<std::uint64_t>(cubes * cubes * cubes); ++code) {
    const CellKey cube{level + 1, morton_decode(code)};
    ClusterReduction reduction(cube, domain_level(volume.size), parameters);
    Shard shard;
    for (int octant = 0; octant < 8; ++octant) {
      const CellKey key = cube.child(octant);
      if (key.lo().x > volume.size.x || key.lo().y > volume.size.y || key.lo().z > volume.size.z)
        continue;
      auto brick = std::make_unique<Brick>(volume, parameters, key);
      if (brick->octree.vertices.empty()) continue;
      reduction.push(key, brick->octree.record);
      add(all.counts, brick->octree.counts.by_level);
      shard.bricks.push_back(std::move(brick));
      shard.keys.push_back(key);
    }
    if (shard.bricks.empty()) continue;
    shard.node = reduction.finish();
    add(all.counts, shard.node.counts);
    top.push(cube, shard.node.record);
    shards.push_back(std::move(shard));
  }
  const ReducedNode reduced = top.finish();
  add(all.counts, reduced.counts);
  for (const ClusterRecord& cluster : reduced.record.clusters) add(all.counts, cluster.leaves);
  for (std::size_t s = 0; s < shards.size(); ++s) {
    const Shard& shard = shards[s];
    for (std::size_t b = 0; b < shard.bricks.size(); ++b) {
      const Brick& brick = *shard.bricks[b];
      const LinkedNode &node = shard.node.nodes[b], &above = reduced.nodes[s];
      const std::uint64_t origin = shard.keys[b].code();
      for (std::size_t i = 0; i < brick.octree.blocks.size(); ++i)
        if (brick.octree.blocks[i].vertices != 0)
          all.planned[(origin >> (3 * block_level)) + i] = brick.octree.blocks[i].vertices;
      for (std::size_t cell = 0; cell < brick.cells.size(); ++cell) {
        const CellSheets& sheets = brick.cells.sheets(cell);
        for (std::size_t k = 0; k < sheets.crossings; ++k) {
          const int edge = sheets.edges[k];
          const std::uint32_t number = brick.leaves.vertex(brick.cells, cell, edge, brick.octree);
          const LeafVertex& v = brick.octree.vertices[number];
          FinalVertex final{v.leaf.level(),
                            FirstSheet::make(origin + v.leaf.code(), v.leaf.sheet()), v.offset,
                            v.normals, v.leaf.shares() || node.covered != 0 || above.covered != 0};
          const std::uint8_t cluster = brick.octree.roots[number];
          if (cluster != BrickOctree::no_root) {
            const ClusterLink link = shard.node.links[node.first_link + cluster];
            if (link.leaf != no_cluster)
              final = vertex_of(shard.node.leaves[link.leaf], above.covered != 0);
            if (link.root != no_cluster) {
              const ClusterLink higher = reduced.links[above.first_link + link.root];
              if (higher.leaf != no_cluster) final = vertex_of(reduced.leaves[higher.leaf], false);
            }
          }
          if (final.level > level) ++all.above;
          all.sheets[{origin + brick.cells.code(cell),
                      sheets.sheet_of_edge[static_cast<std::size_t>(edge)]}] = final;
        }
      }
    }
  }
  return all;
}

// f(volume, parameters) for some of each kind, each within a trace of what it is.
template <class F>
void each_case(const F& f) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (const bool is_noise : {false, true})
      for (const double tolerance : {0.05, 0.5, testing::infinite}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << (is_noise ? ", noise" : ", plates")
                                          << ", tolerance " << tolerance);
        f(is_noise ? noise_volume(37, seed) : plates(61, seed), with(tolerance));
      }
}

TEST(SheetClusters, AreTheSameHoweverTheVolumeIsCutIntoBricks) {
  std::size_t above = 0;
  each_case([&](const MemoryVolume& volume, const ContourParameters& parameters) {
    const FinalOctree small = by_bricks(volume, parameters, 4),
                      large = by_bricks(volume, parameters, 6);
    EXPECT_TRUE(small.sheets == large.sheets);
    EXPECT_EQ(small.counts.leaves, large.counts.leaves);
    EXPECT_EQ(small.counts.errors, large.counts.errors);
    EXPECT_EQ(small.planned, large.planned);
    above += small.above;
  });
  EXPECT_GT(above, 1000u);  // or there was nothing to test
}

// Of vertices that lie in each other's nodes, and of those alone, all say that they share.
TEST(SheetClusters, VerticesWhoseNodesOverlapAreMarked) {
  std::size_t overlaps = 0;
  for (unsigned seed = 0; seed < 3; ++seed)
    for (const double tolerance : {0.1, testing::infinite}) {
      const FinalOctree octree = by_bricks(plates(45, seed), with(tolerance), 4);
      std::map<std::pair<int, FirstSheet>, bool> vertices;
      for (const auto& [sheet, v] : octree.sheets) vertices[{v.level, v.first}] = v.shares;
      for (const auto& [sheet, v] : octree.sheets)
        for (int level = v.level + 1; level <= 6; ++level) {
          const std::uint64_t node = v.first.code() >> (3 * level);
          for (auto at = vertices.lower_bound({level, FirstSheet::make(node << (3 * level), 0)});
               at != vertices.end() && at->first.first == level &&
               at->first.second.code() >> (3 * level) == node;
               ++at) {
            EXPECT_TRUE(at->second && v.shares);
            ++overlaps;
          }
        }
    }
  EXPECT_GT(overlaps, 100u);
}

// Of a vertex the box of the cells that it stands for.
struct Cells {
  Index3 lo = splat(1 << 20), hi = splat(-1);
  FinalVertex vertex;
};
std::map<std::pair<int, FirstSheet>, Cells> cells_of_vertices(const FinalOctree& octree) {
  std::map<std::pair<int, FirstSheet>, Cells> vertices;
  for (const auto& [sheet, v] : octree.sheets) {
    Cells& cells = vertices[{v.level, v.first}];
    const Index3 cell = morton_decode(sheet.first);
    for (int a = 0; a < 3; ++a) {
      cells.lo[a] = std::min(cells.lo[a], cell[a]);
      cells.hi[a] = std::max(cells.hi[a], cell[a]);
    }
    cells.vertex = v;
  }
  return vertices;
}

// However large its node is, and wherever the planes of its few cells may meet.
TEST(SheetClusters, AVertexLiesWithinACellOfTheCellsItStandsFor) {
  std::size_t collapsed = 0;
  each_case([&](const MemoryVolume& volume, const ContourParameters& parameters) {
    for (const auto& [name, cells] : cells_of_vertices(by_bricks(volume, parameters, 4))) {
      const FinalVertex& v = cells.vertex;
      const CellKey node = CellKey::of(v.first.code() >> (3 * v.level) << (3 * v.level), v.level);
      collapsed += v.level > 0 ? 1 : 0;
      for (int a = 0; a < 3; ++a) {
        const double centre =
            (static_cast<double>(node.at[a]) + 0.5) * static_cast<double>(node.side());
        const double at = centre + static_cast<double>(v.offset[static_cast<std::size_t>(a)]);
        EXPECT_GE(at, static_cast<double>(cells.lo[a]) - 1 - 1e-4);
        EXPECT_LE(at, static_cast<double>(cells.hi[a]) + 2 + 1e-4);
      }
    }
  });
  EXPECT_GT(collapsed, 1000u);
}

// What signs say of a node is what the shapes of its children say.
TEST(SheetClusters, SignsSayWhatShapesDo) {
  for (unsigned seed = 0; seed < 3; ++seed)
    for (const bool is_noise : {false, true})
      for (const double tolerance : {0.05, testing::infinite}) {
        const MemoryVolume volume = is_noise ? noise_volume(30, seed) : plates(61, seed);
        const Brick plain(volume, with(tolerance), whole(volume), {.rules = {}, .signs = false}),
            quick(volume, with(tolerance), whole(volume));
        ASSERT_EQ(plain.octree.vertices.size(), quick.octree.vertices.size());
        std::map<std::uint32_t, LeafVertex> a, b;
        for (const LeafVertex& v : plain.octree.vertices) a[v.leaf.bits] = v;
        for (const LeafVertex& v : quick.octree.vertices) b[v.leaf.bits] = v;
        for (const auto& [leaf, v] : a) {
          ASSERT_TRUE(b.contains(leaf));
          EXPECT_EQ(v.offset, b[leaf].offset);
          EXPECT_EQ(v.normals, b[leaf].normals);
        }
        EXPECT_EQ(plain.octree.record.curves.size(), quick.octree.record.curves.size());
      }
}

// The polygons of a volume that is one brick.
std::vector<testing::Triangle> mesh_of(const Brick& brick) {
  std::vector<testing::Triangle> triangles;
  each_index(splat(brick.frame.side()), [&](Index3 p) {
    const LocalCell at{static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z)};
    for (int axis = 0; axis < 3; ++axis) {
      if (!brick.edges.has(axis, at.x, at.y, at.z)) continue;
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      std::array<std::uint32_t, 4> quad;
      for (unsigned k = 0; k < 4; ++k) {
        const unsigned around = k ^ k >> 1;  // 0 1 3 2
        Index3 cell = p;
        cell[b] -= around & 1;
        cell[c] -= around >> 1;
        const int corner = static_cast<int>((around & 1) << b | (around >> 1) << c);
        const std::size_t i = brick.cells.index_of(static_cast<std::uint32_t>(morton_encode(cell)));
        quad[k] = brick.leaves.vertex(brick.cells, i, edge_at(axis, corner), brick.octree);
      }
      if (!brick.signs.inside(at.x, at.y, at.z)) std::swap(quad[1], quad[3]);
      std::vector<std::uint32_t> corners;
      for (std::size_t k = 0; k < 4; ++k)
        if (quad[k] != quad[(k + 3) % 4]) corners.push_back(quad[k]);
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      for (std::size_t k = 1; k + 1 < corners.size(); ++k)
        triangles.push_back({corners[0], corners[k], corners[k + 1]});
    }
  });
  return triangles;
}

TEST(SheetClusters, MeshesKeepTheirTopologyAtAnyTolerance) {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const bool is_noise : {false, true}) {
      const MemoryVolume volume = is_noise ? noise_volume(28, seed) : plates(45, seed);
      const Brick fine(volume, with(0), whole(volume));
      const testing::MeshSummary before = testing::summarize(mesh_of(fine));
      EXPECT_TRUE(before.sound());
      std::size_t triangles = mesh_of(fine).size();
      for (const double tolerance : {0.1, 0.5, testing::infinite}) {
        const Brick brick(volume, with(tolerance), whole(volume));
        EXPECT_EQ(testing::summarize(mesh_of(brick)), before) << "seed " << seed;
        EXPECT_LE(mesh_of(brick).size(), triangles);
        EXPECT_LE(brick.octree.counts.by_level.worst_collapsed(), tolerance);
        triangles = mesh_of(brick).size();
      }
    }
}

// Each sheet goes to the highest of its clusters that may collapse, even where one below may not:
// so plates thinner than a cell, whose edges block the nodes there, become few vertices.
TEST(SheetClusters, FarFewerVerticesThanWhereOneCellBlocksAllAbove) {
  const MemoryVolume volume = plates(61, 2);
  const Brick brick(volume, with(0.2), whole(volume));
  ContourParameters safe = with(0.2);
  safe.simplify.topology = Topology::safe;
  const Brick blocked(volume, safe, whole(volume));
  EXPECT_LT(2 * brick.octree.vertices.size(), blocked.octree.vertices.size());
}

}  // namespace
}  // namespace voxweld
