// Octree artifacts give back what was put into them, whatever lists a brick has.
#include "storage/artifact/shard_artifact.h"

#include <gtest/gtest.h>

#include "storage/support/error.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {
namespace {

constexpr int level = min_brick_level;
constexpr std::uint64_t code = 5;

// Of two vertices and three polygons; lists: which it has beside the plain ones.
BrickOctree brick(const std::string& lists) {
  BrickOctree made;
  made.root.state = NodeState::split;
  made.vertices.resize(2);
  made.polygons = {PolygonRefs{CornerRef::local(1)}, {}, PolygonRefs{CornerRef::foreign(3, 7, 2)}};
  made.blocks = {{3, 2}};
  made.ghost.cells = {{9 | 15u << 24, 0}};
  made.ghost.vertices.resize(1);
  if (lists == "emit_levels") made.emit_levels = {1, 2, 4};
  if (lists == "pairs") {
    made.pairs = {{3, 4}, {4, exterior}};
    made.polygon_pairs = {0, 1, 1};
    made.ghost.sheets_of_edges = {0x155};
  }
  if (lists == "sheets") {
    made.roots = {0, BrickOctree::no_root};
    made.record.clusters.resize(1);
    made.levels.errors = {0.25F, 0.5F};
    made.levels.parents = {BrickLevels::none, BrickLevels::none};
    made.ghost.apart = {0, 0};
    made.ghost.roots = {0};
  }
  return made;
}

void expect_same_stitched(const BrickOctree& a, const BrickOctree& b) {
  EXPECT_EQ(a.vertices.size(), b.vertices.size());
  EXPECT_EQ(a.polygons, b.polygons);
  EXPECT_EQ(a.emit_levels, b.emit_levels);
  EXPECT_EQ(a.pairs, b.pairs);
  EXPECT_EQ(a.polygon_pairs, b.polygon_pairs);
  EXPECT_EQ(a.roots, b.roots);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  EXPECT_EQ(a.blocks[0].polygon_end, b.blocks[0].polygon_end);
  EXPECT_EQ(a.ghost.cells[0].code_signs, b.ghost.cells[0].code_signs);
  EXPECT_EQ(a.ghost.sheets_of_edges, b.ghost.sheets_of_edges);
  EXPECT_EQ(a.ghost.apart, b.ghost.apart);
  EXPECT_EQ(a.ghost.roots, b.ghost.roots);
}

PieceHead put(ShardArtifactWriter& out, Material material, const BrickOctree& octree) {
  AboveBytes above;
  put_above(octree, above);
  return out.piece(material, octree, filled_blocks(octree.blocks), above);
}

class ShardArtifacts : public ::testing::TestWithParam<const char*> {
 protected:
  const TempDirectory directory_;
  const std::filesystem::path path_ = directory_ / "0-0-0.octree";
};

TEST_P(ShardArtifacts, GiveBackABrick) {
  const BrickOctree made = brick(GetParam());
  ShardArtifactWriter out(path_, {}, {});
  out.begin_brick(code);
  const PieceHead heads[] = {put(out, 7, brick("plain")), put(out, 9, made)};
  out.end_brick();
  for (const PieceHead& head : heads) out.directory(head.piece);
  out.finish({});

  const ShardArtifact artifact(path_);
  const std::vector<PieceRecord> pieces = artifact.pieces(9);
  ASSERT_EQ(pieces.size(), 1u);
  BrickOctree read;
  artifact.read_piece(pieces[0], level, read);
  expect_same_stitched(made, read);

  const ArtifactReader file(path_, shard_kind, shard_version);
  std::vector<Material> materials;
  each_piece_in(file, code, [&](const PieceHead& head) {
    materials.push_back(head.piece.key.material);
    read_octree(file, head, level, read);
    const PieceBytes bytes = read_piece_bytes(file, head);
    EXPECT_EQ(bytes.blocks().size(), 1u);
    EXPECT_EQ(bytes.record().size(), head.piece.record_bytes);
  });
  EXPECT_EQ(materials, (std::vector<Material>{7, 9}));
  expect_same_stitched(made, read);
  EXPECT_EQ(read.record.clusters.size(), made.record.clusters.size());
  EXPECT_EQ(read.levels.errors, made.levels.errors);
}

// Whatever a directory says of a piece: memory is taken for no more than the brick has.
TEST_P(ShardArtifacts, APieceLongerThanItsBrickIsDamage) {
  ShardArtifactWriter out(path_, {}, {});
  out.begin_brick(code);
  PieceHead head = put(out, 7, brick(GetParam()));
  out.end_brick();
  head.piece.vertices = 0xffffffff;
  out.directory(head.piece);
  out.finish({});
  const ShardArtifact artifact(path_);
  BrickOctree read;
  EXPECT_THROW(artifact.read_piece(artifact.pieces(7).at(0), level, read), DamagedArtifact);
}

INSTANTIATE_TEST_SUITE_P(Lists, ShardArtifacts,
                         ::testing::Values("plain", "emit_levels", "pairs", "sheets"),
                         [](const auto& lists) { return std::string(lists.param); });

}  // namespace
}  // namespace voxweld::testing
