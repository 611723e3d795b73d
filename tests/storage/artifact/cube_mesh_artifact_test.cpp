#include "storage/artifact/cube_mesh_artifact.h"

#include <gtest/gtest.h>

#include <fstream>

#include "storage/artifact/tile_plan_artifact.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::TempDirectory;

RefineMesh triangle(LatticePoint at, bool normals, std::uint32_t samples) {
  RefineMesh mesh;
  for (std::int32_t k = 0; k < 3; ++k) {
    mesh.positions.push_back({at[0] + k, at[1] + k * k, at[2] - k});
    mesh.ids.push_back({static_cast<std::uint64_t>(at[0] + k) << 40});
    if (normals) mesh.normals.push_back({PackedNormal{1, 2}, PackedNormal{3, 4}});
    if (samples > 0) mesh.aims.push_back({k, at[1], at[2]});
  }
  mesh.triangles.push_back({0, 1, 2});
  for (std::uint32_t i = 0; i < samples; ++i) mesh.samples.push_back({at, 0});
  return mesh;
}

RefineMesh between(MaterialPair sides, RefineMesh mesh) {
  mesh.sides.assign(mesh.triangles.size(), sides);
  return mesh;
}

struct Counted {
  std::uint64_t a = 0, b = 0;
};

class CubeMeshFile : public ::testing::Test {
 protected:
  Hash128 write() const {
    CubeMeshWriter out(path(), {1, 2});
    out.piece({0, 3}, {1, 1, 0}, triangle({10, 20, 30}, true, 2), {});
    out.piece({0, 3}, {2, 1, 0}, {}, triangle({50, 0, 5}, false, 0));
    const std::vector<LatticeBox> boxes = {{{1, 2, 3}, {9, 9, 9}}, {{1, 2, 10}, {9, 9, 10}}};
    out.piece({7, 1}, {1, 0, 1}, triangle({7, 8, 9}, true, 0),
              between({4, exterior}, triangle({90, 8, 9}, true, 1)), {boxes, 17});
    const Counted counted{11, 12};
    const std::vector<BlockRecord> blocks = {{0, 64, 1}, {7, 0, 3}};
    const std::vector<LabelChange> changes = {{7, 5}};
    const std::vector<IntersectionRecord> places = {{7, {{1, 2, 3}, {4, 5, 6}}, 2}};
    return out.finish({as_record(counted), blocks, changes, places});
  }
  void expect_damaged() const {
    EXPECT_THROW(
        {
          const CubeMeshArtifact file(path());
          file.counted<Counted>();
          file.blocks();
          file.changes();
          file.intersecting();
          for (std::size_t i = 0; i < file.pieces().size(); ++i) {
            file.read(i, CubePart::inside);
            file.read(i, CubePart::leaving);
            file.holes(i);
          }
        },
        DamagedArtifact);
  }
  std::filesystem::path path() const { return directory_ / "a.cubes"; }

 private:
  const TempDirectory directory_;
};

TEST_F(CubeMeshFile, ReadsBack) {
  const Hash128 content = write();
  const CubeMeshArtifact file(path());
  EXPECT_EQ(file.key(), (Hash128{1, 2}));
  EXPECT_EQ(file.content_hash(), content);
  const CubeMeshSummary& summary = file.summary();
  EXPECT_EQ(summary.pieces, 3u);
  EXPECT_EQ(summary.all.triangles, 4u);
  EXPECT_EQ(summary.all.vertices, 12u);
  EXPECT_EQ(summary.all.samples, 3u);
  EXPECT_EQ(summary.all.sided, 1u);
  EXPECT_EQ(summary.leaving, 2u);
  EXPECT_EQ(summary.lowest, (CubeKey{0, 3}));
  EXPECT_EQ(summary.highest, (CubeKey{7, 1}));
  EXPECT_EQ(summary.box, (LatticeBox{{7, 0, 3}, {92, 24, 30}}));
  EXPECT_EQ(summary.leaving_box, (LatticeBox{{50, 0, 3}, {92, 12, 9}}));
  EXPECT_EQ(file.counted<Counted>().b, 12u);
  EXPECT_EQ(file.blocks()[1], (BlockRecord{7, 0, 3}));
  EXPECT_EQ(file.changes(), std::vector<LabelChange>({{7, 5}}));
  EXPECT_EQ(file.intersecting(), std::vector<IntersectionRecord>({{7, {{1, 2, 3}, {4, 5, 6}}, 2}}));

  const auto& piece = file.pieces()[2];
  EXPECT_EQ(piece.key(), (CubeKey{7, 1}));
  EXPECT_EQ(morton_decode(piece.cube), (Index3{1, 0, 1}));
  EXPECT_EQ(piece.leaving.samples, 1u);
  EXPECT_EQ(piece.leaving_box, (LatticeBox{{90, 8, 7}, {92, 12, 9}}));
  const RefineMesh read = file.read(2, CubePart::leaving), wrote = triangle({90, 8, 9}, true, 1);
  EXPECT_EQ(read.positions, wrote.positions);
  EXPECT_EQ(read.ids, wrote.ids);
  EXPECT_EQ(read.normals, wrote.normals);
  EXPECT_EQ(read.triangles, wrote.triangles);
  EXPECT_EQ(read.sides, (std::vector<MaterialPair>{{4, exterior}}));
  EXPECT_TRUE(file.read(2, CubePart::inside).sides.empty());
  EXPECT_EQ(read.samples, wrote.samples);
  EXPECT_TRUE(file.read(1, CubePart::leaving).normals.empty());
  EXPECT_TRUE(file.read(1, CubePart::inside).triangles.empty());
}

TEST_F(CubeMeshFile, LeavesOutWhatIsNotWanted) {
  write();
  const CubeMeshArtifact file(path());
  const RefineMesh all = file.read(0, CubePart::inside);
  ASSERT_FALSE(all.normals.empty() || all.aims.empty() || all.samples.empty());
  const RefineMesh shape =
      file.read(0, CubePart::inside, {.normals = false, .aims = false, .samples = false});
  EXPECT_TRUE(shape.normals.empty() && shape.aims.empty() && shape.samples.empty());
  EXPECT_EQ(shape.positions, all.positions);
  EXPECT_EQ(shape.ids, all.ids);
  EXPECT_EQ(shape.triangles, all.triangles);
  const PartFields but_aims{.aims = false};
  const RefineMesh sided = file.read(2, CubePart::leaving, but_aims);
  EXPECT_EQ(sided.sides, file.read(2, CubePart::leaving).sides);
  EXPECT_EQ(sided.samples, file.read(2, CubePart::leaving).samples);
}

TEST_F(CubeMeshFile, PatchesSayWhatTheyStandInPlaceOf) {
  write();
  const CubeMeshArtifact file(path());
  EXPECT_EQ(file.pieces()[2].holes, 2u);
  EXPECT_EQ(file.pieces()[2].removed, 17u);
  EXPECT_EQ(file.holes(2),
            (std::vector<LatticeBox>{{{1, 2, 3}, {9, 9, 9}}, {{1, 2, 10}, {9, 9, 10}}}));
  EXPECT_EQ(file.pieces()[0].holes, 0u);
  EXPECT_TRUE(file.holes(0).empty());
  EXPECT_EQ(file.holes_hash(0), file.holes_hash(1));
  EXPECT_NE(file.holes_hash(0), file.holes_hash(2));
}

// Each part has a hash of its own, so that what reads one does not depend on the other.
TEST_F(CubeMeshFile, PartsHaveTheirHashes) {
  write();
  const CubeMeshArtifact file(path());
  EXPECT_NE(file.part_hash(2, CubePart::inside), file.part_hash(2, CubePart::leaving));
  EXPECT_EQ(file.part_hash(0, CubePart::leaving), file.part_hash(1, CubePart::inside));
}

TEST_F(CubeMeshFile, MayBeEmpty) {
  CubeMeshWriter(path(), {5, 6}).finish({});
  const CubeMeshArtifact file(path());
  EXPECT_EQ(file.summary().pieces, 0u);
  EXPECT_TRUE(file.pieces().empty());
  EXPECT_TRUE(file.blocks().empty());
  EXPECT_THROW(file.counted<Counted>(), DamagedArtifact);
}

TEST_F(CubeMeshFile, DamageIsFoundInAnyByte) {
  write();
  const auto whole = read_whole_file(path());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    SCOPED_TRACE(i);
    auto bytes = whole;
    bytes[i] ^= std::byte{1};
    write_whole_file(path(), bytes, Durability::rename_only);
    expect_damaged();
  }
  write_whole_file(path(), std::span(whole).first(whole.size() / 2), Durability::rename_only);
  expect_damaged();
}

// By label, whatever the cubes are.
TEST_F(CubeMeshFile, PiecesMustAscend) {
  CubeMeshWriter out(path(), {});
  out.piece({5, 3}, {1, 1, 0}, triangle({1, 2, 3}, false, 0), {});
  out.piece({4, 9}, {1, 0, 1}, triangle({4, 5, 6}, false, 0), {});
  const Counted counted;
  out.finish({as_record(counted)});
  expect_damaged();
}

// What no checksum finds: whoever wrote it was wrong.
TEST_F(CubeMeshFile, NumbersThatNameNothingAreRefused) {
  const auto refused = [&](const RefineMesh& mesh) {
    CubeMeshWriter out(path(), {});
    out.piece({}, {}, mesh, {});
    const Counted counted;
    out.finish({as_record(counted)});
    expect_damaged();
  };
  RefineMesh mesh = triangle({1, 2, 3}, true, 1);
  mesh.triangles[0][1] = 3;
  refused(mesh);
  mesh = triangle({1, 2, 3}, true, 1);
  mesh.samples[0].triangle = 1;
  refused(mesh);
  mesh = triangle({1, 2, 3}, true, 1);
  mesh.normals.pop_back();
  refused(mesh);
  mesh = between({1, 2}, triangle({1, 2, 3}, true, 1));
  mesh.sides.push_back({2, 3});
  refused(mesh);
}

TEST(TilePlanFile, ReadsBack) {
  const TempDirectory directory;
  const auto path = directory / "tile.plan";
  const std::vector<PlanSource> sources = {{{1, 2}, 3, {4, 5}, {6, 7}}};
  TilePlanWriter out(path, {8, 9});
  for (const Material label : {Material{3}, Material{1} << 50}) {
    out.tile({64, 5, 0, 7, 8});
    out.middle(label + 1);
    out.end_surface(label, label == 3 ? 6 : 9);
  }
  BatchRecord batch;
  batch.material = 3;
  batch.surfaces = batch.tiles = 2;
  out.batch(batch);
  out.finish(sources);
  const TilePlanArtifact file(path);
  EXPECT_EQ(file.key(), (Hash128{8, 9}));
  EXPECT_EQ(file.sources(), sources);
  const MaterialTop tables(file.file());
  EXPECT_EQ(tables.batches().at(0).surfaces, 2u);
  ASSERT_EQ(tables.surface_count(), 2u);
  EXPECT_EQ(tables.surfaces(0, 2)[1].material, Material{1} << 50);
  EXPECT_EQ(tables.surfaces(0, 2)[1].vertices, 9u);
  EXPECT_EQ(tables.tiles(1, 1)[0].polygons, 8u);
  EXPECT_EQ(file.middles(0, 2), (std::vector<std::uint64_t>{4, (std::uint64_t{1} << 50) + 1}));
  auto bytes = read_whole_file(path);
  bytes[65] ^= std::byte{1};
  write_whole_file(path, bytes, Durability::rename_only);
  const TilePlanArtifact damaged(path);
  EXPECT_THROW(MaterialTop(damaged.file()).tiles(0, 2), DamagedArtifact);
}

}  // namespace
}  // namespace voxweld
