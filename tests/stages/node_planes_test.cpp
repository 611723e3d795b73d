// The planes of a node of 2^3 cells against those of its cells, one by one.
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <memory>

#include "stages/build/node_planes.h"
#include "stages/contouring/node_solver.h"
#include "tests/stages/cluster_volumes.h"
#include "tests/stages/plain_node_planes.h"
#include "tests/stages/with_all_kernels.h"

namespace voxweld {
namespace {

using testing::MemoryVolume;

constexpr int cells_a_side = 32;

// Sides and crossings of a volume's first brick.
struct Contoured {
  SignGrid signs;
  HermiteEdges edges;

  Contoured(const MemoryVolume& volume, int cells, Vec3 spacing) {
    ContourParameters parameters = testing::by_sheets(0.1);
    parameters.spacing = spacing;
    const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                          volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
    signs.fill(block, {}, cells, parameters.surface);
    edges.compute(block, {}, cells, signs, parameters);
  }
};

// Sums of what a QEF is made of, about the brick's corner.
struct Sums {
  double planes = 0;
  std::array<double, 10> squares{};
  std::array<double, 3> mass{}, normals{};

  void add(const SheetPlanes& of, Vec3 centre) {
    for (const HermitePlane& plane : of.planes()) {
      const double weight = plane.weight;
      std::array<double, 4> row{};
      for (std::size_t a = 0; a < 3; ++a) {
        const double at = centre[static_cast<int>(a)] + plane.point[a];
        row[a] = plane.normal[a];
        row[3] += row[a] * at;
        mass[a] += weight * at;
      }
      planes += weight;
      std::size_t k = 0;
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i; j < 4; ++j) squares[k++] += weight * row[i] * row[j];
    }
    for (const NormalSum& normal : of.normals())
      for (std::size_t a = 0; a < 3; ++a) normals[a] += static_cast<double>(normal[a]);
  }
};

void expect_near(const Sums& found, const Sums& expected) {
  EXPECT_EQ(found.planes, expected.planes);
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_NEAR(found.squares[i], expected.squares[i], 1e-9 * (1 + std::abs(expected.squares[i])));
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_NEAR(found.mass[a], expected.mass[a], 1e-9 * (1 + std::abs(expected.mass[a])));
    EXPECT_NEAR(found.normals[a], expected.normals[a], 1e-4);
  }
}

// Returns how many nodes were compared.
int expect_sums_of_cells(const MemoryVolume& volume, Vec3 spacing) {
  const Contoured brick(volume, cells_a_side, spacing);
  ActiveCells cells;
  cells.count(brick.signs, cells_a_side, {{}, splat(cells_a_side)});
  cells.find(brick.signs);
  const auto centre = [&](LocalCell c, double half) {
    return Vec3{(c.x + half) * spacing.x, (c.y + half) * spacing.y, (c.z + half) * spacing.z};
  };
  SheetPlanes planes;
  int nodes = 0;
  for (std::size_t i = 0; i < cells.size(); ++nodes) {
    const std::uint32_t node = cells.code(i) >> 3;
    Sums of_cells, of_node;
    for (; i < cells.size() && cells.code(i) >> 3 == node; ++i) {
      gather_planes(cells.at(i), cells.sheets(i), all_sheets, brick.edges, spacing, planes);
      of_cells.add(planes, centre(cells.at(i), 0.5));
    }
    const LocalCell c = decode_local(node << 3);
    testing::gather_node_planes(c, brick.signs.crossings(c.x, c.y, c.z), brick.edges, spacing,
                                planes);
    EXPECT_LE(planes.count, max_planes);
    of_node.add(planes, centre(c, 1));
    expect_near(of_node, of_cells);
    if (::testing::Test::HasFailure()) break;
  }
  return nodes;
}

TEST(NodePlanes, AreThoseOfItsCells) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    EXPECT_GT(expect_sums_of_cells(testing::noise_volume(30, seed), {1, 1, 1}), 2000);
    EXPECT_GT(expect_sums_of_cells(testing::plates(30, seed), {0.5, 1, 3}), 300);
  }
}

// Every edge that a node can have, each as often as cells of it have it: all corners are of two
// kinds, by turns.
TEST(NodePlanes, OfAllItsEdges) {
  const auto chess = MemoryVolume::made<float>(splat(8), SampleType::f32, [](Index3 s) {
    return (s.x + s.y + s.z) % 2 == 0 ? 1.0F : -1.0F;
  });
  const Contoured brick(chess, 8, {1, 1, 1});
  SheetPlanes planes;
  testing::gather_node_planes({2, 2, 2}, brick.signs.crossings(2, 2, 2), brick.edges, {1, 1, 1},
                              planes);
  ASSERT_EQ(planes.count, max_planes);
  int weight = 0;
  for (const HermitePlane& plane : planes.planes()) weight += plane.weight;
  EXPECT_EQ(weight, 8 * 12);
}

// What is compared of a batch, to the bit.
struct BatchBits {
  int rows = 0;
  std::vector<std::uint64_t> doubles;

  void add(const LaneArray& values) {
    for (const double v : values) doubles.push_back(std::bit_cast<std::uint64_t>(v));
  }
  static BatchBits of(const PlaneBatch& planes) {
    BatchBits bits{planes.rows, {}};
    const auto filled = static_cast<std::size_t>(std::max(planes.rows, 3));
    for (std::size_t k = 0; k < filled; ++k)
      for (const LaneArray& value : planes.plane[k]) bits.add(value);
    for (const LaneArray& mass : planes.mass) bits.add(mass);
    return bits;
  }
  friend bool operator==(const BatchBits&, const BatchBits&) = default;
};

// Nodes eight at a time, the last batch not full, and one by one.
class Batches {
 public:
  Batches(Vec3 spacing, NormalSense sense)
      : spacing_(spacing), sense_(sense), at_once_(spacing), plain_(parameters(spacing)) {
    plain_.clear_planes();
  }

  void add(LocalCell c, const NodeCrossings& crossings, const HermiteEdges& edges) {
    at_once_.gather(count_, c, crossings, edges);
    testing::gather_node_planes(c, crossings, edges, spacing_, planes_);
    plain_.set_planes(count_, planes_.planes());
    directions_[count_] = one_direction(planes_.normals(), sense_);
    if (++count_ == lanes) compare();
  }
  void compare() {
    if (count_ == 0) return;
    auto planes = std::make_unique<PlaneBatch>();
    for (auto& row : planes->plane)
      for (LaneArray& value : row) value.fill(7);  // what an earlier batch left
    at_once_.compute(*planes);
    EXPECT_EQ(BatchBits::of(*planes), BatchBits::of(plain_.planes()));
    for (std::size_t i = 0; i < count_; ++i) {
      EXPECT_EQ(at_once_.direction(i, sense_), directions_[i]);
      ones += directions_[i] ? 1 : 0;
    }
    nodes += static_cast<int>(count_);
    count_ = 0;
    at_once_.clear();
    plain_.clear_planes();
  }

  int nodes = 0, ones = 0;

 private:
  static ContourParameters parameters(Vec3 spacing) {
    ContourParameters parameters = testing::by_sheets(0.1);
    parameters.spacing = spacing;
    return parameters;
  }
  Vec3 spacing_;
  NormalSense sense_;
  NodePlanes at_once_;
  NodeSolver plain_;
  SheetPlanes planes_;
  std::array<std::optional<NormalSum>, lanes> directions_;
  std::size_t count_ = 0;
};

void expect_the_same_at_once(const MemoryVolume& volume, Vec3 spacing, NormalSense sense) {
  const Contoured brick(volume, cells_a_side, spacing);
  Batches batches(spacing, sense);
  each_index(splat(cells_a_side / 2), [&](Index3 node) {
    const LocalCell c{static_cast<int>(2 * node.x), static_cast<int>(2 * node.y),
                      static_cast<int>(2 * node.z)};
    const NodeCrossings crossings = brick.signs.crossings(c.x, c.y, c.z);
    if ((crossings[0] | crossings[1] | crossings[2]) != 0) batches.add(c, crossings, brick.edges);
  });
  batches.compare();
  EXPECT_GT(batches.nodes, 100);
  EXPECT_GT(batches.ones, batches.nodes / 200);
  EXPECT_LT(batches.ones, batches.nodes);
}

TEST(NodePlanes, AtOnceAreThoseOfOneAfterTheOther) {
  testing::with_all_kernels([] {
    for (const NormalSense sense : {NormalSense::outward, NormalSense::either})
      for (unsigned seed = 0; seed < 3; ++seed) {
        expect_the_same_at_once(testing::noise_volume(30, seed), {1, 1, 1}, sense);
        expect_the_same_at_once(testing::plates(30, seed), {0.5, 1, 3}, sense);
      }
  });
}

// What earlier nodes left where a node has no edge.
TEST(NodePlanes, WhereThereIsNoEdgeNothingHasASay) {
  testing::with_all_kernels([] {
    auto clean = std::make_unique<NodeEdges>(), dirty = std::make_unique<NodeEdges>();
    clean->rows = dirty->rows = 4;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t lane = 0; lane < lanes; ++lane)
        for (std::size_t i = 0; i < 4; ++i) {
          const bool is_there = (k + lane) % 3 == 0;
          clean->row[k].edge[i][lane] = is_there ? 0.25F * static_cast<float>(i + 1) : 0;
          dirty->row[k].edge[i][lane] =
              is_there ? clean->row[k].edge[i][lane] : std::numeric_limits<float>::quiet_NaN();
          if (is_there) clean->row[k].place[lane] = EdgePlace::make(1, 2, 1, 1);
          dirty->row[k].place[lane] = clean->row[k].place[lane];
        }
    auto expected = std::make_unique<PlaneBatch>(), found = std::make_unique<PlaneBatch>();
    NodeDirections of_clean, of_dirty;
    plane_kernel()(*clean, {1, 2, 1}, 0.9F, *expected, of_clean);
    plane_kernel()(*dirty, {1, 2, 1}, 0.9F, *found, of_dirty);
    EXPECT_EQ(BatchBits::of(*found), BatchBits::of(*expected));
    EXPECT_EQ(of_dirty.total, of_clean.total);
    EXPECT_EQ(of_dirty.is_one, of_clean.is_one);
    EXPECT_NE(of_clean.is_one[0], 0);
  });
}

}  // namespace
}  // namespace voxweld
