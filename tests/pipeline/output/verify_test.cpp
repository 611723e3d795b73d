#include "pipeline/output/verify.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/support/error.h"
#include "tests/pipeline/output/output_directory.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::expect_problem;
using ::testing::HasSubstr;
using testing::of_tile;
using testing::OutputDirectory;
using testing::verified;
using testing::without_last_triangle;

// A torus of 48 x 24 quads in tiles of 8^3 cells.
OutputDirectory torus_output() {
  OutputDirectory out;
  out.tiles = testing::cut_into_tiles(
      testing::make_torus({.around = 48, .across = 24}, testing::small_lattice()), 3);
  return out;
}

// A vertex of tile 5 that is not on its seams (used by six triangles there).
std::uint32_t inner_vertex(const TileMesh& mesh) {
  std::vector<int> uses(mesh.positions.size());
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++uses[v];
  return static_cast<std::uint32_t>(std::find(uses.begin(), uses.end(), 6) - uses.begin());
}

TEST(Verify, FindsNothingWrongWithAWholeTorus) {
  const OutputDirectory output = torus_output();
  ASSERT_GT(output.tiles.size(), 20u);
  for (const int threads : {1, 4}) {
    const VerifyReport report = verified(output, {.threads = threads});
    EXPECT_TRUE(report.good()) << to_text(report);
    EXPECT_EQ(report.tiles, output.tiles.size());
    EXPECT_EQ(report.vertices, 48u * 24);
    EXPECT_EQ(report.triangles, 2u * 48 * 24);
    EXPECT_EQ(report.files, 2 * output.tiles.size() + 2);
    EXPECT_GT(report.seam_vertices, 100u);
    EXPECT_EQ(report.boundary_edges, 0u);
    EXPECT_TRUE(report.merged_checked);
    EXPECT_THAT(to_json_text(report), HasSubstr("\"good\":true"));
  }
}

TEST(Verify, TilesOfAnySizeAndNoMergedMesh) {
  for (const int level : {0, 1, 2, 6}) {
    OutputDirectory output = torus_output();
    output.tiles = testing::cut_into_tiles(
        testing::make_torus({.around = 48, .across = 24}, testing::small_lattice()), level);
    output.merged = output.glb = false;
    const VerifyReport report = verified(output);
    EXPECT_TRUE(report.good()) << level << to_text(report);
    EXPECT_EQ(report.vertices, 48u * 24);
  }
}

TEST(Verify, TheMergedMeshMayBeAllThereIs) {
  OutputDirectory output = torus_output();
  output.listed = false;
  const VerifyReport report = verified(output, {.intersections = true});
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_EQ(report.tiles, 0U);
  EXPECT_EQ(report.vertices, 48u * 24);
  EXPECT_EQ(report.triangles, 2u * 48 * 24);
  EXPECT_EQ(report.files, 2U);
  EXPECT_EQ(report.boundary_edges, 0U);
  ASSERT_TRUE(report.intersections);
  EXPECT_EQ(report.intersections->pairs, 0U);
  output.remerge = without_last_triangle;
  expect_problem(output, "the mesh at (");
}

TEST(Verify, MergedMeshesThatWereStreamed) {
  OutputDirectory output = torus_output();
  output.streamed = true;
  const VerifyReport report = verified(output);
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_TRUE(report.merged_checked);
  EXPECT_EQ(report.files, 2 * output.tiles.size() + 4);
  output.remerge = without_last_triangle;
  for (const char* file : {"mesh.ply", "mesh.stl", "mesh.obj", "mesh.vtp"})
    expect_problem(output, fmt::format("{}: its 2303 triangles are not the 2304", file));
  output.remerge = [](TileMesh& mesh) { mesh.lattice.step *= 3; };
  expect_problem(output, "mesh.ply: ");
}

TEST(Verify, EndsWhereAStopIsAskedFor) {
  const testing::TempDirectory directory;
  torus_output().write(directory.path());
  InterruptFlag stop;
  VerifyOptions options;
  options.interrupt = &stop;
  EXPECT_TRUE(verify_output(directory.path(), options).good());
  stop.request();
  EXPECT_THROW(verify_output(directory.path(), options), Interrupted);
}

TEST(Verify, MissingTriangleIsACrack) {
  OutputDirectory output = torus_output();
  output.damage = of_tile(5, without_last_triangle);
  expect_problem(output, "a crack");
  expect_problem(output, "triangles, ");
}

TEST(Verify, MissingTileIsACrack) {
  OutputDirectory output = torus_output();
  output.tiles.erase(output.tiles.begin() + 7);
  output.merged = false;
  expect_problem(output, "a crack");
}

TEST(Verify, FlippedTriangleIsNotOriented) {
  OutputDirectory output = torus_output();
  output.damage =
      of_tile(5, [](TileMesh& mesh) { std::swap(mesh.triangles[3][0], mesh.triangles[3][1]); });
  expect_problem(output, "expected once each");
}

TEST(Verify, MovedVertexOnASeamIsACrackAndInsideDiffersFromTheMergedMesh) {
  OutputDirectory output = torus_output();
  output.damage = of_tile(5, [](TileMesh& mesh) {
    for (auto& q : mesh.positions) ++q[0];
  });
  expect_problem(output, "a crack");
  output.damage = of_tile(5, [](TileMesh& mesh) { ++mesh.positions[inner_vertex(mesh)][1]; });
  expect_problem(output, "are not the");
  output.merged = false;  // then nothing can tell
  EXPECT_TRUE(verified(output).good());
}

// Two tori that touch in one vertex, in one tile or across tiles.
TEST(Verify, BowTieIsNotManifold) {
  const auto lattice = testing::small_lattice();
  for (const int level : {2, 3, 6}) {
    OutputDirectory output;
    TileMesh both = testing::make_cube(lattice, {4, 4, 4}, 6, 6);
    const TileMesh second = testing::make_cube(lattice, {10, 10, 10}, 6, 6);
    const auto base = static_cast<std::uint32_t>(both.positions.size());
    both.positions.insert(both.positions.end(), second.positions.begin(), second.positions.end());
    both.normals.insert(both.normals.end(), second.normals.begin(), second.normals.end());
    for (const VertexId id : second.ids) both.ids.push_back({id.bits + 1});
    for (auto t : second.triangles)
      both.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    both.corner_normals.insert(both.corner_normals.end(), second.corner_normals.begin(),
                               second.corner_normals.end());
    output.tiles = testing::cut_into_tiles(both, level);
    expect_problem(output, "not 2-manifold");
    output.merged = false;
    expect_problem(output, "not 2-manifold: the triangles around");
  }
}

// A closed piece of one tile lies in another's cube and touches its inside in one vertex.
TEST(Verify, VertexInsideOneTileUsedByAnotherIsNotManifold) {
  const auto lattice = testing::small_lattice();
  OutputDirectory output;
  output.tiles = {testing::make_cube(lattice, {4, 4, 4}, 6, 6),
                  testing::make_cube(lattice, {10, 10, 10}, 2, 2)};
  output.tiles[0].tile = {4, {0, 0, 0}};
  output.tiles[1].tile = {4, {1, 0, 0}};
  for (VertexId& id : output.tiles[1].ids) ++id.bits;
  output.merged = false;
  expect_problem(output, "surrounded in its tile and used by another");
}

TEST(Verify, DegenerateTrianglesAreFound) {
  OutputDirectory output = torus_output();
  output.merged = false;
  output.damage = of_tile(5, [](TileMesh& mesh) {
    // Two distinct vertices of one triangle at one position.
    mesh.positions[mesh.triangles[0][1]] = mesh.positions[mesh.triangles[0][0]];
  });
  expect_problem(output, "two equal corners");
}

TEST(Verify, WrongCountsAreFound) {
  OutputDirectory output = torus_output();
  output.relist = of_tile(2, [](TileRecord& record) { ++record.vertices; });
  expect_problem(output, "vertices, ");
  output.relist = of_tile(2, [](TileRecord& record) { ++record.quads; });
  expect_problem(output, "quads and polygon triangles");
  output.relist = nullptr;
  output.restate = [](Manifest& m) { ++m.counts.vertices; };
  expect_problem(output, "counts.vertices");
  output.restate = [](Manifest& m) { ++m.counts.tiles; };
  expect_problem(output, "counts.tiles");
}

TEST(Verify, WrongSizeHashOrMissingFileIsNamed) {
  OutputDirectory output = torus_output();
  output.relist = of_tile(2, [](TileRecord& record) { record.files[1].xxh3_128[0] = 'x'; });
  expect_problem(output, "tiles/2.glb: damaged: its hash");
  output.relist = of_tile(2, [](TileRecord& record) { ++record.files[0].bytes; });
  expect_problem(output, "tiles/2.drc: has");
  output.relist = of_tile(2, [](TileRecord& record) { record.files[0].path = "tiles/none.drc"; });
  expect_problem(output, "none.drc");
  output.relist = of_tile(2, [](TileRecord& record) { record.files.clear(); });
  expect_problem(output, "lists no file of a known format");
}

TEST(Verify, DamagedFilesAreReportedNotThrown) {
  const testing::TempDirectory directory;
  torus_output().write(directory.path());
  const auto path = directory / "tiles/3.drc";
  const auto whole = read_whole_file(path);
  for (std::size_t size = 0; size < whole.size(); size += 37) {
    write_whole_file(path, std::span(whole).first(size), Durability::rename_only);
    const VerifyReport report = verify_output(directory.path());
    EXPECT_FALSE(report.good());
    EXPECT_LE(report.problems.size(), 20u);
  }
}

TEST(Verify, MergedMeshMustBeTheTiles) {
  OutputDirectory output = torus_output();
  output.remerge = [](TileMesh& mesh) { mesh.positions[7][0] += 2; };
  expect_problem(output, "mesh.drc: its 2304 triangles are not");
  output.remerge = without_last_triangle;
  expect_problem(output, "OpenMesh finds 3 boundary edges");
}

// The torus cut off by the border: a ring of quads left out.
OutputDirectory open_output(bool on_border) {
  TileMesh torus = testing::make_torus({.around = 48, .across = 24, .centre = {16, 20, 20}},
                                       testing::small_lattice());
  // x <= 0 for the outermost polygons: those are left out.
  TileMesh kept = torus;
  kept.triangles.clear();
  kept.corner_normals.clear();
  for (std::size_t i = 0; i < torus.triangles.size(); i += 2) {
    bool outside = true;
    const std::int32_t limit = testing::snap(torus.lattice, {on_border ? 0.0 : 2.0, 0, 0})[0];
    for (std::size_t k = 0; k < 2; ++k)
      for (const std::uint32_t v : torus.triangles[i + k])
        outside = outside && torus.positions[v][0] <= limit;
    for (std::size_t k = 0; k < 2 && !outside; ++k) {
      kept.triangles.push_back(torus.triangles[i + k]);
      kept.corner_normals.push_back(torus.corner_normals[i + k]);
    }
  }
  EXPECT_LT(kept.triangles.size(), torus.triangles.size());
  OutputDirectory output;
  output.tiles = testing::cut_into_tiles(kept, 3);
  return output;
}

TEST(Verify, OpenBordersAreAllowedOnTheBorderOnly) {
  OutputDirectory output = open_output(true);
  output.open = true;
  const VerifyReport report = verified(output);
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_GT(report.boundary_edges, 0u);
  output.open = false;
  expect_problem(output, "a crack");
  output = open_output(false);
  output.open = true;
  expect_problem(output, "a crack");
  output.restate = [](Manifest& m) { m.border_slack = 2.5; };
  EXPECT_TRUE(verified(output).good());
}

TEST(Verify, FreeTopologyAsksForBalancedEdgesOnly) {
  const auto lattice = testing::small_lattice();
  OutputDirectory output;
  // Two cubes that share an edge: four triangles around it, two each way.
  TileMesh both = testing::make_cube(lattice, {4, 4, 4}, 4, 1);
  const TileMesh second = testing::make_cube(lattice, {8, 8, 4}, 4, 1);
  for (const auto& t : second.triangles) {
    auto& corner = both.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& q = second.positions[t[k]];
      const auto found = std::find(both.positions.begin(), both.positions.end(), q);
      corner[k] = static_cast<std::uint32_t>(found - both.positions.begin());
      if (found != both.positions.end()) continue;
      both.positions.push_back(q);
      both.normals.push_back(second.normals[t[k]]);
      both.ids.push_back({second.ids[t[k]].bits + 1});
    }
  }
  both.corner_normals.resize(both.triangles.size());
  both.quads = both.triangles.size() / 2;
  output.tiles = testing::cut_into_tiles(both, 3);
  expect_problem(output, "not 2-manifold");
  output.free_topology = true;
  const VerifyReport report = verified(output);
  EXPECT_TRUE(report.good()) << to_text(report);
  output.damage = of_tile(0, without_last_triangle);
  expect_problem(output, "a crack");
}

TEST(Verify, NeedsAManifestAndAList) {
  const testing::TempDirectory directory;
  EXPECT_THROW(verify_output(directory.path()), StorageError);
  torus_output().write(directory.path());
  std::filesystem::remove(directory / tiles_name);
  EXPECT_THROW(verify_output(directory.path()), StorageError);
  write_whole_file(directory / tiles_name, as_bytes("{]\n"), Durability::rename_only);
  EXPECT_THROW(verify_output(directory.path()), FormatError);
}

}  // namespace
}  // namespace voxweld
