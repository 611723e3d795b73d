// Contouring options, end to end: what each promises of the mesh that comes out.
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "pipeline/output/load.h"
#include "pipeline/output/verify.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

const Settings tiled = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};

void expect_verified(const Scene& scene) {
  const VerifyReport report = expect_good(scene.output());
  EXPECT_GT(report.triangles, 0u);
  EXPECT_TRUE(report.merged_checked);
}

// Blobs that reach the border on all sides: a few waves.
RawVolume waves(Index3 size) {
  return volume_of(size, [](Index3 at) {
    const double v = std::sin(0.31 * static_cast<double>(at.x)) +
                     std::sin(0.27 * static_cast<double>(at.y)) +
                     std::sin(0.35 * static_cast<double>(at.z));
    return static_cast<int>(128 + 40 * v);
  });
}

DecodedMesh merged_mesh(const Scene& scene) {
  return load_mesh(scene.output() / "mesh.drc");
}

using Point = std::array<float, 3>;  // equal for one vertex to the bit
using Balance = std::map<std::pair<Point, Point>, int>;

// Of each edge, its uses in one direction less those in the other.
Balance edge_balance(const DecodedMesh& mesh) {
  Balance balance;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point a = mesh.positions[t[k]], b = mesh.positions[t[(k + 1) % 3]];
      balance[std::pair(std::min(a, b), std::max(a, b))] += a < b ? 1 : -1;
    }
  return balance;
}

struct Crossings {
  std::uint64_t closed = 0;  // the ring's edges included
  std::uint64_t open = 0;    // both ends are samples
};

// Counted edge by edge from the samples, all around them outside.
Crossings count_crossings(const RawVolume& volume) {
  const auto inside = [&](Index3 at) {
    return Box3{{}, volume.size}.contains(at) &&
           static_cast<double>(volume.samples[static_cast<std::size_t>(volume.index(at))]) >=
               volume.isovalue;
  };
  Crossings count;
  each_index({splat(-1), volume.size + splat(1)}, [&](Index3 a) {
    for (const Index3 step : {Index3{1, 0, 0}, Index3{0, 1, 0}, Index3{0, 0, 1}}) {
      const Index3 b = a + step;
      if (inside(a) == inside(b)) continue;
      ++count.closed;
      const Box3 real{{}, volume.size};
      if (real.contains(a) && real.contains(b)) ++count.open;
    }
  });
  return count;
}

TEST(Options, WithoutSimplificationEachCrossingEdgeIsAQuad) {
  for (const RawVolume& volume :
       {noise_volume({23, 18, 33}, 1), noise_volume({40, 1, 3}, 2), waves({35, 30, 40})}) {
    const Scene scene(volume);
    const Crossings expected = count_crossings(volume);
    const Settings settings = tiled + Settings{"simplify.enabled=false"};
    VOXWELD_EXPECT_DONE(scene.run(settings));
    const auto counts = manifest_of(scene.output()).at("counts");
    EXPECT_EQ(counts.at("quads"), expected.closed);
    EXPECT_EQ(counts.at("polygon_triangles"), 0);
    EXPECT_EQ(merged_mesh(scene).triangles.size(), 2 * expected.closed);
    expect_verified(scene);
    VOXWELD_EXPECT_DONE(scene.run(settings + Settings{"surface.border=open"}));
    EXPECT_EQ(manifest_of(scene.output()).at("counts").at("quads"), expected.open);
  }
}

// However many tiles there are: the manifest says how many files, their list says which.
TEST(Options, TheManifestIsASummaryOfTheFiles) {
  const Scene scene(waves({64, 50, 40}));
  VOXWELD_EXPECT_DONE(scene.run(tiled));
  const auto manifest = manifest_of(scene.output());
  std::uint64_t files = 0, bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scene.output())) {
    if (entry.path().extension() != ".drc" && entry.path().extension() != ".glb") continue;
    ++files;
    bytes += entry.file_size();
  }
  EXPECT_GT(manifest.at("counts").at("tiles"), 4);
  EXPECT_EQ(manifest.at("counts").at("files"), files);
  EXPECT_EQ(manifest.at("counts").at("bytes"), bytes);
  std::set<std::string> roles;
  for (const auto& file : manifest.at("files")) roles.insert(file.at("role"));
  EXPECT_EQ(manifest.at("files").size(), 3u);
  EXPECT_EQ(roles, (std::set<std::string>{"list", "merged"}));
}

TEST(Options, TheDefaultsGiveAClosedManifold) {
  for (const RawVolume& volume : {noise_volume({31, 32, 33}, 3), waves({64, 50, 40})}) {
    const Scene scene(volume);
    VOXWELD_EXPECT_DONE(scene.run(tiled));
    expect_verified(scene);
    for (const auto& [edge, balance] : edge_balance(merged_mesh(scene))) ASSERT_EQ(balance, 0);
  }
}

TEST(Options, AnOpenBorderIsOpenOnTheBorderOnly) {
  const RawVolume volume = waves({64, 50, 40});
  for (const char* enabled : {"simplify.enabled=false", "simplify.enabled=true"}) {
    SCOPED_TRACE(enabled);
    const Scene scene(volume);
    VOXWELD_EXPECT_DONE(scene.run(tiled + Settings{"surface.border=open", enabled}));
    expect_verified(scene);
    std::size_t open = 0;
    for (const auto& [edge, balance] : edge_balance(merged_mesh(scene))) {
      if (balance == 0) continue;
      ++open;
      for (const Point& p : {edge.first, edge.second}) {
        bool on_border = false;
        for (int axis = 0; axis < 3; ++axis) {
          const float at = p[static_cast<std::size_t>(axis)];
          on_border = on_border || at <= 0 || at >= static_cast<float>(volume.size[axis] - 1);
        }
        EXPECT_TRUE(on_border) << p[0] << " " << p[1] << " " << p[2];
      }
    }
    EXPECT_GT(open, 100u);
  }
}

// What reaches no border is the same either way.
TEST(Options, AnOpenBorderChangesNothingInside) {
  const Scene scene("sphere", 40);
  Tree closed = scene.clean_tree(tiled);
  Tree open = scene.clean_tree(tiled + Settings{"surface.border=open"});
  for (Tree* tree : {&closed, &open}) tree->erase("manifest");  // it says which border it is
  EXPECT_GT(closed.size(), 3U);
  EXPECT_EQ(difference(closed, open), "");
}

TEST(Options, FreeTopologyKeepsEdgesBalanced) {
  for (const RawVolume& volume : {noise_volume({31, 32, 33}, 4), waves({64, 50, 40})}) {
    const Scene scene(volume);
    const Settings settings = tiled + Settings{"simplify.topology=free", "simplify.tolerance=1.5"};
    VOXWELD_EXPECT_DONE(scene.run(settings));
    const DecodedMesh mesh = merged_mesh(scene);
    EXPECT_GT(mesh.triangles.size(), 100u);
    for (const auto& [edge, balance] : edge_balance(mesh)) ASSERT_EQ(balance, 0);
    expect_verified(scene);
    EXPECT_EQ(difference(output_tree(scene.output()),
                         scene.clean_tree(settings + Settings{"work.brick=64", "work.copy=true"})),
              "");
  }
}

TEST(Options, NormalEquationsRun) {
  const Scene scene(waves({50, 50, 40}));
  VOXWELD_EXPECT_DONE(scene.run(tiled + Settings{"simplify.qef=normal"}));
  expect_verified(scene);
}

// The sum of squares bounds every term, so at equal tolerance it collapses less.
TEST(Options, TheSumMetricIsTheStricterOne) {
  const Scene scene(waves({50, 50, 40}));
  const auto run = [&](const char* metric) {
    VOXWELD_EXPECT_DONE(scene.run(tiled + Settings{"simplify.tolerance=0.3", metric}));
    expect_verified(scene);
    const auto manifest = manifest_of(scene.output());
    EXPECT_LE(manifest.at("error").at("reached").get<double>(), 0.3);
    return manifest.at("counts").at("vertices").get<std::uint64_t>();
  };
  EXPECT_GT(run("simplify.metric=sum"), run("simplify.metric=rms"));
}

TEST(Options, TheOtherSideAndTheOtherGradient) {
  const Scene scene(waves({40, 40, 40}));
  for (const char* gradient : {"surface.gradient=central", "surface.gradient=eno"}) {
    VOXWELD_EXPECT_DONE(scene.run(tiled + Settings{"surface.inside=below", gradient}));
    expect_verified(scene);
  }
}

TEST(Options, TilesMayBeLeftOut) {
  const Scene scene(waves({40, 40, 40}));
  const Tree with = scene.clean_tree(tiled + Settings{"output.merged=true"});
  const Tree without =
      scene.clean_tree(tiled + Settings{"output.merged=true", "output.tiles=false"});
  EXPECT_EQ(with.at("mesh.drc"), without.at("mesh.drc"));
  for (const auto& [name, hash] : without) EXPECT_FALSE(name.starts_with("tiles/")) << name;
}

}  // namespace
}  // namespace voxweld::testing
