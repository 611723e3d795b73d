// What of merge's plan of labels is one unit of refine, and which artifacts a unit looks into.
#include "pipeline/stage/refine_units.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/batch_planner.h"
#include "storage/artifact/top_artifact.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {
namespace {

PlannedTile tile_of(int level, Index3 at, std::uint64_t vertices) {
  const CellKey key{level, at};
  return {key.code(), static_cast<std::uint32_t>(level), 0, vertices, vertices};
}

// A plan as merge makes it.
std::vector<RefineUnit> units_of(
    const std::vector<std::pair<Material, std::vector<PlannedTile>>>& plan) {
  const TempDirectory directory;
  const auto path = directory / "top.tree";
  TopArtifactWriter out(path, {});
  BatchPlanner batches(out, 500000);
  for (const auto& [label, tiles] : plan) {
    for (const PlannedTile& tile : tiles) out.tile(tile);
    out.end_surface(label);
    batches.add(label, tiles, 0, [](KeyHasher&, const PlannedTile&) {});
  }
  batches.finish();
  out.finish({}, {});
  return refine_units(TopArtifact(path), LabelMode::each);
}

TEST(RefineUnits, OfSmallLabelsHaveSeveral) {
  const auto units = units_of({{3, {tile_of(7, {}, 100)}},
                               {5, {tile_of(7, {}, 200)}},
                               {8, {tile_of(7, {}, 65000)}},
                               {9, {tile_of(7, {}, 65000)}}});
  ASSERT_EQ(units.size(), 2u);
  EXPECT_EQ(units[0].first_label, 3u);
  EXPECT_EQ(units[0].end_label, 9u);
  EXPECT_EQ(units[0].labels, 3u);
  EXPECT_EQ(units[0].range.vertices, 65300u);
  EXPECT_TRUE(units[0].whole);
  EXPECT_EQ(units[0].name(), "3 labels from 3 on");
  EXPECT_EQ(units[1].name(), "label 9");
}

TEST(RefineUnits, OfALargeLabelAreRanges) {
  const auto units = units_of({{3, {tile_of(8, {}, 100)}},
                               {4, {tile_of(8, {}, 131072)}},
                               {7, {tile_of(8, {}, 50)}},
                               {9, {tile_of(7, {}, 30), tile_of(7, {1, 0, 0}, 40)}}});
  ASSERT_EQ(units.size(), 1u + 8u + 1u + 2u);
  EXPECT_EQ(units[0].end_label, 4u);
  for (std::size_t i = 1; i < 9; ++i) {
    EXPECT_EQ(units[i].first_label, 4u);
    EXPECT_EQ(units[i].end_label, 5u);
    EXPECT_FALSE(units[i].whole);
  }
  EXPECT_EQ(units[1].range.cubes.begin, 0u);
  EXPECT_EQ(units[8].range.cubes.end, CubeRange{}.end);
  EXPECT_EQ(units[9].first_label, 7u);
  EXPECT_EQ(units[10].name(), "label 9 cubes from 0-0-0 on");
  EXPECT_EQ(units[11].name(), "label 9 cubes from 2-0-0 on");
}

// No two units of a plan leave their artifacts in one place.
TEST(RefineUnits, HavePathsOfTheirOwn) {
  const auto units = units_of({{3, {tile_of(8, {}, 100)}},
                               {4, {tile_of(8, {}, 140000)}},
                               {Material{1} << 40, {tile_of(8, {}, 60000)}},
                               {(Material{1} << 40) + 1, {tile_of(8, {}, 60000)}}});
  RefineJob job;
  job.folder = "refine";
  std::set<std::filesystem::path> paths;
  for (const RefineUnit& unit : units) paths.insert(refine_artifact_path(job, unit));
  EXPECT_EQ(paths.size(), units.size());
}

TEST(PieceSpans, SayWhichArtifactsToLookInto) {
  PieceSpans spans;
  spans.add(2, {1, 5}, {3, 9}, true);
  spans.add(0, {}, {}, false);
  spans.add(3, {4, 0}, {4, 7}, false);  // tiles of one label, whose cubes overlap
  spans.add(3, {4, 2}, {4, 20}, false);
  spans.add(3, {4, 1}, {4, 3}, false);
  spans.add(1, {6, 1}, {6, 1}, false);
  const auto found = [&](const CubeKey& begin, const CubeKey& end) {
    std::vector<std::size_t> numbers;
    spans.each(begin, end, [&](std::size_t i) { numbers.push_back(i); });
    return numbers;
  };
  using Numbers = std::vector<std::size_t>;
  EXPECT_EQ(found({0, 0}, {1, 5}), Numbers());
  EXPECT_EQ(found({0, 0}, {1, 6}), Numbers({0}));
  EXPECT_EQ(found({2, 0}, {3, 0}), Numbers({0}));
  EXPECT_EQ(found({4, 0}, {4, 1}), Numbers({2}));
  EXPECT_EQ(found({4, 4}, {4, 8}), Numbers({2, 3}));
  EXPECT_EQ(found({4, 0}, {4, 99}), Numbers({2, 3, 4}));
  EXPECT_EQ(found({4, 8}, {4, 99}), Numbers({3}));
  EXPECT_EQ(found({5, 0}, {7, 0}), Numbers({5}));
  EXPECT_EQ(found({7, 0}, {8, 0}), Numbers());
  // Patches of the same labels.
  spans.add(1, {3, 9}, {3, 9}, true);
  spans.add(0, {}, {}, false);
  spans.add(2, {4, 6}, {6, 1}, false);
  EXPECT_EQ(found({2, 0}, {3, 0}), Numbers({0}));
  EXPECT_EQ(found({2, 0}, {4, 0}), Numbers({0, 6}));
  EXPECT_EQ(found({4, 4}, {4, 8}), Numbers({2, 3, 8}));
  EXPECT_EQ(found({7, 0}, {8, 0}), Numbers());
}

TEST(PartReads, PutTogetherLastWhatNoOtherPartHasVerticesOf) {
  const auto piece = [](std::uint64_t cube, std::uint64_t inside, std::uint64_t leaving) {
    CubePieceRecord record;
    record.cube = cube;
    record.inside = {inside, inside, 0, 0};
    record.leaving = {leaving, leaving, 0, 0};
    return record;
  };
  std::vector<PartRead> parts;
  add_parts({0, 0, true}, piece(7, 100, 10), parts);
  add_parts({0, 1, true}, piece(3, 200, 0), parts);
  add_parts({1, 0, true}, piece(7, 50, 20), parts);  // of another tile
  add_parts({2, 0, false}, piece(5, 400, 30), parts);
  EXPECT_EQ(put_in_order(parts), 10u + 20u + 30u + 50u);
  std::vector<std::tuple<std::size_t, std::size_t, CubePart, bool>> order;
  order.reserve(parts.size());
  for (const PartRead& part : parts)
    order.emplace_back(part.piece.artifact, part.piece.piece, part.part, part.last);
  using enum CubePart;
  EXPECT_EQ(order, (decltype(order){{2, 0, leaving, false},
                                    {0, 0, leaving, false},
                                    {1, 0, leaving, false},
                                    {0, 1, inside, true},
                                    {1, 0, inside, false},
                                    {0, 0, inside, true}}));
}

}  // namespace
}  // namespace voxweld::testing
