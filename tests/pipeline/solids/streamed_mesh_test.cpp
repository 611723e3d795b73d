// Meshes read by pieces against the same in memory, part by part: triangles, open edges, the
// answers of the bins.
#include "pipeline/solids/streamed_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <tuple>

#include "pipeline/solids/binned_mesh.h"
#include "pipeline/solids/closed_mesh.h"
#include "pipeline/solids/edge_parity.h"
#include "pipeline/solids/mesh_survey.h"
#include "stages/solids/mesh_solid.h"
#include "storage/support/error.h"
#include "tests/pipeline/solids/mesh_formats.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

// So little that everything goes through scratch files many times.
constexpr std::uint64_t little = std::uint64_t{256} << 10;

class StreamedMeshTest : public ::testing::Test {
 protected:
  MeshWork work(std::uint64_t memory = little) const {
    return {directory_ / "scratch", memory, {}};
  }
  TempDirectory directory_;
};

// A ball with corners that are written twice, triangles without area, polygons' worth of order
// lost.
TriangleMesh untidy_ball(int levels) {
  TriangleMesh mesh = dented_ball({20, 21, 19}, 16, levels);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 7) {
    auto& t = mesh.triangles[i];
    mesh.vertices.push_back(mesh.vertices[t[0]]);
    t[0] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }
  mesh.vertices.push_back({-3, 50, 2});  // of no triangle
  std::mt19937 random(1);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  const auto t = mesh.triangles[3];
  mesh.triangles.push_back({t[0], t[1], t[1]});
  mesh.triangles.push_back({t[2], t[2], t[2]});
  return mesh;
}

TEST_F(StreamedMeshTest, EveryFormatGivesTheTrianglesOfMemory) {
  const TriangleMesh ball = untidy_ball(6);
  for (const std::string& name : mesh_file_names()) {
    const auto path = directory_ / name;
    write_mesh(path, ball);
    const MeshFile whole = read_mesh_file(path);
    const SpooledMesh spooled(path, work());
    EXPECT_EQ(spooled.file().content, whole.content) << name;
    EXPECT_EQ(spooled.triangles(), whole.mesh.triangles.size()) << name;
    std::size_t next = 0, different = 0;
    spooled.each([&](const SpooledMesh::Corners& corners) {
      const auto& t = whole.mesh.triangles.at(next++);
      for (std::size_t i = 0; i < 3; ++i)
        different += corners[i] == whole.mesh.vertices[t[i]] ? 0 : 1;
    });
    EXPECT_EQ(next, whole.mesh.triangles.size());
    EXPECT_EQ(different, 0U) << name;
    const Bounds bounds = bounds_of(whole.mesh);
    EXPECT_EQ(spooled.bounds().lo, bounds.lo);
    EXPECT_EQ(spooled.bounds().hi, bounds.hi);
    const bool numbered = !name.ends_with(".stl") && !name.ends_with(".obj");
    EXPECT_EQ(spooled.vertex_bounds().lo.x, numbered ? -3 : bounds.lo.x) << name;
    check_spooled_mesh(path, spooled, work());  // it is closed
  }
}

// Whoever waits is told what is done, and how far it is.
TEST_F(StreamedMeshTest, TellsHowFarItIs) {
  for (const std::string name : {"ball.stl", "little.ply"}) {
    const auto path = directory_ / name;
    write_mesh(path, untidy_ball(8));
    std::map<std::string, std::vector<std::uint64_t>> told;
    MeshWork telling = work();
    telling.progress = [&](std::string_view what, std::uint64_t triangles) {
      told[std::string(what)].push_back(triangles);
    };
    const SpooledMesh spooled(path, telling);
    check_spooled_mesh(path, spooled, telling);
    EXPECT_EQ(told.size(), name == "ball.stl" ? 2U : 4U) << name;
    for (const auto& [what, counts] : told) {
      EXPECT_TRUE(std::ranges::is_sorted(counts)) << name << ": " << what;
      EXPECT_GT(counts.back(), spooled.triangles() / 3) << name << ": " << what;
      EXPECT_LE(counts.back(), spooled.triangles() + 2) << name << ": " << what;
    }
  }
}

TEST_F(StreamedMeshTest, RefusesWhatTheReaderRefuses) {
  const auto error = [&](const std::string& text) {
    const auto path = directory_ / "a.off";
    std::ofstream(path) << text;
    try {
      SpooledMesh(path, work());
    } catch (const Error& e) {
      EXPECT_EQ(e.exit_code(), 2);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(error("OFF\n3 1 0\n0 0 0\n1 0 x\n"), HasSubstr("a.off: line 4: expected a number"));
  EXPECT_THAT(error("OFF\n3 1 0\n0 0 0\n1 0 inf\n"), HasSubstr("vertex 1 has a coordinate inf"));
  EXPECT_THAT(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n"),
              HasSubstr("a.off: no triangles"));
}

using EdgeKey = std::tuple<double, double, double, double, double, double>;

EdgeKey key_of(Vec3 a, Vec3 b) {
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}

TEST_F(StreamedMeshTest, OddEdgesAreThoseOfAMap) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> coordinate(-3, 3);
  const auto place = [&] {
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = coordinate(random) * (random() % 2 == 0 ? 1.0 : -1.0);
    return p;  // with zeros of both signs
  };
  for (const std::uint64_t memory : {std::uint64_t{1} << 30, std::uint64_t{1} << 12}) {
    EdgeParity parity(directory_ / "scratch", memory);
    std::map<EdgeKey, int> expected;
    for (int i = 0; i < 60000; ++i) {
      const Vec3 a = place(), b = place();
      parity.add(a, b);
      ++expected[std::min(key_of(a + Vec3{}, b + Vec3{}), key_of(b + Vec3{}, a + Vec3{}))];
    }
    std::erase_if(expected, [](const auto& entry) { return entry.second % 2 == 0; });
    auto next = expected.begin();
    parity.finish([&](const PlaceEdge& edge) {
      ASSERT_NE(next, expected.end());
      EXPECT_EQ(key_of(edge.low, edge.high), (next++)->first);
    });
    EXPECT_EQ(next, expected.end());
  }
}

// The holes are told as they are of a mesh in memory; of very many their first edges.
TEST_F(StreamedMeshTest, OpenMeshesAreRefusedAsInMemory) {
  TriangleMesh mesh = untidy_ball(6);
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const Vec3 p = mesh.vertices[t[0]];
    return (p.z > 33 && p.x > 20) || (p.x < 8 && p.y < 20);
  });
  const auto path = directory_ / "a.off";
  write_mesh(path, mesh);
  const std::string in_memory = error_text<InputError>(
      [&] { read_closed_mesh(path, std::uint64_t{1} << 40, MeshClosing::no); });
  EXPECT_THAT(in_memory, HasSubstr("in 2 holes (in the file's own coordinates"));
  const auto streamed = [&] {
    return error_text<InputError>(
        [&] { check_spooled_mesh(path, SpooledMesh(path, work()), work()); });
  };
  EXPECT_THAT(streamed(), HasSubstr(in_memory.substr(0, in_memory.find("; close it"))));
  TriangleMesh soup = untidy_ball(6);
  soup.triangles.resize(soup.triangles.size() / 2);
  write_mesh(path, soup);
  EXPECT_THAT(streamed(), HasSubstr("more holes than run.memory has room for (the first edges"));
}

// Bins of a mesh against the mesh itself.
struct Binned {
  TriangleMesh mesh;
  std::shared_ptr<const MeshSolid> whole;
  std::shared_ptr<const BinnedMesh> bins;
  MeshBinning binning;
};

class MeshBinningTest : public StreamedMeshTest {
 protected:
  Binned bin(const TriangleMesh& mesh, double cell, std::int64_t shard) const {
    const auto path = directory_ / "a.off";
    write_mesh(path, mesh);
    const MeshFile file = read_mesh_file(path);
    InputConfig input;
    input.path = path;
    input.cell = cell;
    Binned result{file.mesh, nullptr, nullptr, {BrickGrid({1, 1, 1}, 3, 1), {}, {}, {}, {}}};
    const VolumeGeometry geometry = mesh_geometry(input, bounds_of(file.mesh));
    for (Vec3& v : result.mesh.vertices) v = in_frame(v, geometry);
    const VolumeFrame frame{geometry.size, geometry.spacing};
    result.whole = std::make_shared<MeshSolid>(result.mesh, frame, file.content);
    result.binning = {BrickGrid(geometry.size, 3, static_cast<int>(shard)), geometry,
                      directory_ / "bins", file.content, file.content};
    bin_mesh(SpooledMesh(path, work()), result.binning, work(), limits_);
    result.bins = std::make_shared<BinnedMesh>(result.binning, result.whole->bounds());
    return result;
  }
  BinLimits limits_{std::uint64_t{1} << 30, std::uint64_t{1} << 29, std::uint64_t{1} << 29};
};

template <class F>
void each_brick(const BrickGrid& grid, F&& f) {
  each_index(grid.bricks(), f);
}

std::vector<std::array<std::int64_t, 4>> row_ends(const LatticeSolid& solid, const Box3& samples) {
  // Flips cancel in pairs: what is left of each place.
  std::map<std::array<std::int64_t, 3>, bool> odd;
  solid.each_flip(samples, [&](const LatticeSolid::Flip& flip) {
    bool& there = odd[{flip.z, flip.y, flip.x}];
    there = !there;
  });
  std::vector<std::array<std::int64_t, 4>> ends;
  for (const auto& [at, there] : odd)
    if (there) ends.push_back({at[0], at[1], at[2], 1});
  return ends;
}

int expect_bins_answer(const Binned& binned) {
  int sides = 0;
  each_brick(binned.binning.grid, [&](Index3 brick) {
    const Box3 samples = binned.binning.samples_of(brick);
    const auto side = binned.whole->side(samples);
    EXPECT_EQ(binned.bins->side(samples), side);
    sides += side == true ? 1 : 0;
    const auto piece = binned.bins->near(samples);
    EXPECT_EQ(row_ends(*piece, samples), row_ends(*binned.whole, samples));
    EXPECT_EQ(piece->source(), binned.whole->source());
  });
  EXPECT_EQ(binned.bins->bounds().lo, binned.whole->bounds().lo);
  EXPECT_EQ(binned.bins->bounds().hi, binned.whole->bounds().hi);
  return sides;
}

TEST_F(MeshBinningTest, BricksAnswerAsTheWhole) {
  for (const std::int64_t shard : {1, 2, 4}) {
    std::filesystem::remove_all(directory_ / "bins");
    EXPECT_GT(expect_bins_answer(bin(untidy_ball(6), 0.6, shard)), 20);
  }
  // Large triangles, whole shards inside.
  std::filesystem::remove_all(directory_ / "bins");
  TriangleMesh box = box_mesh({-30, -30, -30}, {30, 25, 20});
  std::mt19937 random(9);
  turn(box, random);
  EXPECT_GT(expect_bins_answer(bin(box, 1, 2)), 50);
}

TEST_F(MeshBinningTest, WhatIsThereStaysAndWhatIsNotIsMade) {
  const Binned first = bin(untidy_ball(5), 0.6, 2);
  const auto path = first.binning.bins_path({0, 1, 1});
  ASSERT_TRUE(std::filesystem::exists(path));
  const auto other = first.binning.bins_path({1, 1, 0});
  const auto time = std::filesystem::last_write_time(other);
  std::filesystem::remove(path);
  std::filesystem::remove(first.binning.table_path());
  const Binned second = bin(untidy_ball(5), 0.6, 2);
  EXPECT_TRUE(std::filesystem::exists(path));
  EXPECT_EQ(std::filesystem::last_write_time(other), time);
  expect_bins_answer(second);
}

TEST_F(MeshBinningTest, ABrickWithTooManyTrianglesIsRefused) {
  limits_.while_building = 30000;
  const std::string said = error_text<InputError>([&] { bin(untidy_ball(6), 0.6, 2); });
  EXPECT_THAT(said, HasSubstr("run.memory = 1GiB is too small: stage build needs at "
                              "least 1025MiB for one brick (work.brick = 8) with the "));
  EXPECT_THAT(said, HasSubstr("triangles of the mesh that reach brick "));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "bins" / "table"));
}

}  // namespace
}  // namespace voxweld::testing
