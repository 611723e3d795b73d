// Meshes as solids, end to end: what comes out against what went in.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <random>

#include "stages/solids/mesh_boundary.h"
#include "storage/meshes/mesh_file.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/run/mesh_scene.h"
#include "tests/support/sharp_edges.h"
#include "tests/support/test_names.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// Empty space around a mesh, which lies in it by its center alone.
class MeshScene {
 public:
  MeshScene(const fs::path& path, const TriangleMesh& mesh, int resolution)
      : scene_(RawVolume{{1, 1, 1}, SampleType::u8, {std::byte{}}, 1}) {
    const auto [lo, hi] = bounds_of(mesh);
    cell = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}) / resolution;
    for (int a = 0; a < 3; ++a) {
      size[a] = static_cast<std::int64_t>(std::ceil((hi[a] - lo[a]) / cell)) + 5;
      center[a] = 2 * cell - lo[a];
    }
    set(path);
  }
  void set(const fs::path& path, const std::string& more = {}) const {
    std::ofstream(scene_.config()) << fmt::format(
        "[input]\nformat = \"empty\"\nsize = [{}, {}, {}]\nspacing = {}\n[run]\nthreads = 2\n"
        "[[edit]]\nshape = \"mesh\"\npath = '{}'\ncenter = [{}, {}, {}]\n{}\n",
        size.x, size.y, size.z, cell, path.string(), center.x, center.y, center.z, more);
  }
  const Scene& scene() const { return scene_; }
  std::string bytes(const Settings& settings = {}) const {
    VOXWELD_EXPECT_DONE(scene_.run(settings));
    return to_hex(hash_bytes(read_whole_file(scene_.output() / "mesh.drc")));
  }
  // What came out, in the mesh's own coordinates.
  TriangleMesh result() const { return welded_mesh(scene_.output() / "mesh.drc", Vec3{} - center); }

  double cell = 1;
  Index3 size;
  Vec3 center;

 private:
  Scene scene_;
};

struct SharedMesh {
  const char* file;
  bool sharp;
};
void PrintTo(const SharedMesh& mesh, std::ostream* out) {
  *out << mesh.file;
}
class SharedMeshes : public ::testing::TestWithParam<SharedMesh> {};

TEST_P(SharedMeshes, ComeOutAsTheyWentIn) {
  const fs::path path = shared_mesh(GetParam().file);
  if (path.empty()) GTEST_SKIP() << GetParam().file << " is not there";
  const TriangleMesh mesh = read_mesh_file(path).mesh;
  const MeshScene space(path, mesh, 256);
  VOXWELD_EXPECT_DONE(space.scene().run());
  expect_good(space.scene().output());
  const TriangleMesh result = space.result();
  const double volume = std::abs(volume_of(mesh));
  EXPECT_NEAR(volume_of(result), volume, 1e-3 * volume);
  const Spread away = distances(result.vertices, mesh, space.cell);
  const Spread missed = distances(mesh.vertices, result, space.cell);
  fmt::print(
      "{}: {} triangles to {}; volume {:+.5f} %; cells from vertices to the source: mean "
      "{:.4f}, most {:.3f}; from the source's: mean {:.4f}, most {:.3f}\n",
      GetParam().file, mesh.triangles.size(), result.triangles.size(),
      100 * (volume_of(result) / volume - 1), away.mean(), away.most, missed.mean(), missed.most);
  EXPECT_LT(away.mean(), 0.05);
  EXPECT_LT(away.most, 1);
  if (!GetParam().sharp) return;
  const auto features = points_on(sharp_edges(mesh, 40), space.cell);
  for (const double tolerance : {0.1, 0.01}) {
    VOXWELD_EXPECT_DONE(space.scene().run({fmt::format("simplify.tolerance={}", tolerance)}));
    const Spread edges = distances(features, sharp_edges(space.result(), 20), space.cell);
    fmt::print(
        "  tolerance {}: {} points of sharp edges, {:.2f} % within 0.1 cells of one that came out; "
        "mean {:.4f}, most {:.3f}\n",
        tolerance, edges.count, 100 * edges.share(), edges.mean(), edges.most);
    EXPECT_GT(edges.share(), tolerance < 0.1 ? 0.95 : 0.86);
  }
}

INSTANTIATE_TEST_SUITE_P(MeshEdit, SharedMeshes,
                         ::testing::Values(SharedMesh{"meshes/fandisk.obj", true},
                                           SharedMesh{"volgallery_fandisk/fandisk.stl", true},
                                           SharedMesh{"meshes/rocker-arm.obj", false},
                                           SharedMesh{"meshes/anchor_dense.off", false},
                                           SharedMesh{"meshes/joint.off", true},
                                           SharedMesh{"meshes/knot2.off", false}),
                         [](const auto& tested) { return test_name(tested.param.file); });

// Corners on lattice points, faces in their planes and rows along its edges come with the halves.
TriangleMesh nasty_mesh() {
  TriangleMesh mesh = dented_ball({30, 30, 30}, 20, 5);
  for (Vec3& v : mesh.vertices) v.x = std::round(2 * v.x) / 2;
  return mesh;
}

TEST(MeshEdit, NeitherOrderNorPartitionMatters) {
  const TempDirectory folder;
  TriangleMesh mesh = nasty_mesh();
  write_off(folder / "a.off", mesh);
  const MeshScene space(folder / "a.off", mesh, 100);
  const std::string expected = space.bytes();
  EXPECT_EQ(space.bytes({"work.brick=32", "run.threads=1"}), expected);
  EXPECT_EQ(space.bytes({"work.brick=16", "work.shard=2", "run.threads=4"}), expected);
  std::mt19937 random(5);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  for (auto& t : mesh.triangles) std::swap(t[0], t[random() % 3]);
  write_off(folder / "b.off", mesh);
  space.set(folder / "b.off");
  EXPECT_EQ(space.bytes(), expected);
}

TEST(MeshEdit, WhatIsInTheFileCountsNotItsName) {
  const TempDirectory folder;
  TriangleMesh mesh = dented_ball({}, 10, 3);
  write_off(folder / "a.off", mesh);
  const MeshScene space(folder / "a.off", mesh, 40);
  const std::string first = space.bytes();
  fs::rename(folder / "a.off", folder / "b.off");
  space.set(folder / "b.off");
  EXPECT_EQ(space.bytes(), first);
  EXPECT_EQ(units_run(space.scene().output())["build"], 0U);
  mesh.vertices[0] = mesh.vertices[0] * 1.05;
  write_off(folder / "b.off", mesh);
  EXPECT_NE(space.bytes(), first);
}

TEST(MeshEdit, PlacedByScaleRotateAndCenter) {
  const TempDirectory folder;
  write_off(folder / "a.off", box_mesh({0, 0, 0}, {1, 2, 4}));
  const MeshScene space(folder / "a.off", box_mesh({-6, -6, 0}, {6, 6, 12}), 24);
  space.set(folder / "a.off", "scale = 2.5\nrotate = [0, 0, 90]");
  VOXWELD_EXPECT_DONE(space.scene().run());
  const auto [lo, hi] = bounds_of(space.result());
  const Vec3 expected_lo{-5, 0, 0}, expected_hi{0, 2.5, 10};
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(lo[a], expected_lo[a], 0.02 * space.cell);
    EXPECT_NEAR(hi[a], expected_hi[a], 0.02 * space.cell);
  }
}

// In boxes whose faces lie anywhere in the cells volumes are exact, but for the output's lattice.
TEST(MeshEdit, SubtractsAndIntersects) {
  const TempDirectory folder;
  const TriangleMesh whole = box_mesh({0.3, 0.3, 0.3}, {20.4, 20.45, 20.6});
  write_off(folder / "a.off", whole);
  write_off(folder / "b.off", box_mesh({10.3, 10.15, 10.7}, {30, 30, 30}));
  const MeshScene space(folder / "a.off", whole, 40);
  const auto volume_with = [&](const std::string& op) {
    space.set(folder / "a.off", fmt::format("[[edit]]\nop = \"{}\"\nshape = \"mesh\"\npath = '{}'\n"
                                            "center = [{}, {}, {}]",
                                            op, (folder / "b.off").string(), space.center.x,
                                            space.center.y, space.center.z));
    VOXWELD_EXPECT_DONE(space.scene().run());
    expect_good(space.scene().output());
    return volume_of(space.result());
  };
  const double common = 10.1 * 10.3 * 9.9, all = volume_of(whole);
  EXPECT_NEAR(volume_with("intersect"), common, 2e-3 * common);
  EXPECT_NEAR(volume_with("subtract"), all - common, 1e-3 * all);
}

TEST(MeshEdit, RefusedMeshes) {
  const TempDirectory folder;
  TriangleMesh mesh = dented_ball({}, 10, 3);
  const MeshScene space(folder / "a.off", mesh, 40);
  const auto error = [&](int exit_code = 2) {
    const ProgramResult result = space.scene().run();
    EXPECT_EQ(result.exit_code, exit_code);
    return result.err;
  };
  EXPECT_THAT(error(), ::testing::HasSubstr("a.off: no such mesh file; check the path"));
  mesh.triangles.erase(mesh.triangles.begin() + 7);
  mesh.triangles.pop_back();
  write_off(folder / "a.off", mesh);
  EXPECT_THAT(error(), ::testing::HasSubstr(
                           "a.off: the mesh is not closed, so it has no inside: 6 of its edges "
                           "have an odd number of triangles, in 2 holes ("));
  write_off(folder / "a.off", dented_ball({}, 1e9, 3));
  EXPECT_THAT(error(), ::testing::HasSubstr("voxels from the volume's first sample; expected"));
  mesh = dented_ball({}, 10, 3);
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  write_off(folder / "a.off", mesh);
  EXPECT_THAT(error(0), ::testing::HasSubstr("a.off: its triangles face inward"));
}

}  // namespace
}  // namespace voxweld::testing
