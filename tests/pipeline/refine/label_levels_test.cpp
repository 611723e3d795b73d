// Levels of detail with labels.mode = "each": coarse tiles that hold parts of many labels, each of which
// is closed at any mix of levels.
#include <map>
#include <random>

#include "tests/pipeline/refine/level_mix.h"
#include "tests/pipeline/refine/refine_work.h"

namespace voxweld::testing {
namespace {

const Settings each_with_levels = {
    "simplify.refine=collapse",  "work.brick=16",           "work.shard=2",
    "output.tile_vertices=1024", "simplify.tolerance=0.05", "labels.mode=each",
    "output.levels=\"auto\""};

// Slabs and bars of some tiles each_with_levels, balls of one, and specks.
RawVolume slabs_and_balls() {
  return volume_of({88, 76, 72}, [](Index3 at) -> std::uint64_t {
    const Index3 cell = {at.x / 11, at.y / 11, at.z / 11};
    const Index3 in = at - cell * 11 - splat(5);
    const std::int64_t r2 = in.x * in.x + in.y * in.y + in.z * in.z;
    const auto number = static_cast<std::uint64_t>(cell.x + 8 * cell.y + 56 * cell.z);
    if (at.z < 30) {
      if (number % 3 == 0 && r2 < 17) return 20 + number % 200;
      if (number % 3 == 1 && r2 < 1) return 20 + number % 200;
      return 0;
    }
    return at.z < 36 ? 1 : 2 + static_cast<std::uint64_t>((at.x + at.z / 3) / 30);
  });
}

// What is shown of each label.
std::map<Material, WeldedMesh> shown_labels(const std::vector<const ListedMesh*>& shown) {
  struct Part {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
  };
  std::map<Material, Part> parts;
  for (const ListedMesh* one : shown)
    for (std::size_t t = 0; t < one->mesh.triangles.size(); ++t) {
      EXPECT_EQ(one->record.label.has_value(), one->mesh.pairs.empty());
      Material label = one->record.label.value_or(0);
      if (!one->mesh.pairs.empty()) {
        const MaterialPair& pair = one->mesh.pairs[one->mesh.triangle_pairs[t]];
        EXPECT_EQ(pair.outside, exterior);
        label = pair.inside;
      }
      Part& part = parts[label];
      const auto first = static_cast<std::uint32_t>(part.vertices.size());
      for (const std::uint32_t v : one->mesh.triangles[t]) {
        const auto& p = one->mesh.positions[v];
        part.vertices.push_back({p[0], p[1], p[2]});
      }
      part.triangles.push_back({first, first + 1, first + 2});
    }
  std::map<Material, WeldedMesh> welded;
  for (const auto& [label, part] : parts) welded[label] = weld(part.vertices, part.triangles);
  return welded;
}

double extent(const WeldedMesh& mesh) {
  Vec3 lo = mesh.vertices.front(), hi = lo;
  for (const Vec3& p : mesh.vertices)
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], p[a]);
      hi[a] = std::max(hi[a], p[a]);
    }
  return std::sqrt(dot(hi - lo, hi - lo));
}

TEST(LabelLevels, AnyMixIsClosedAndOfOneTopology) {
  const Scene scene(slabs_and_balls());
  VOXWELD_EXPECT_DONE(scene.run(each_with_levels + Settings{"output.levels=4"}));
  EXPECT_EQ(expect_good(scene.output()).levels, 3u);
  const auto all = all_meshes(scene.output());
  std::vector<const ListedMesh*> finest;
  for (const ListedMesh& one : all)
    if (one.record.lod == 0) finest.push_back(&one);
  const auto whole = shown_labels(finest);
  EXPECT_GT(whole.size(), 60u);
  std::mt19937 random(5);
  std::size_t mixed = 0, left_out = 0;
  for (int mix = 0; mix < 20; ++mix) {
    const auto shown = any_mix(all, random);
    std::set<int> lods;
    for (const ListedMesh* one : shown) lods.insert(one->record.lod);
    mixed += lods.size() > 1 ? 1 : 0;
    const double coarsest = 0.05 * std::pow(4, *lods.rbegin());
    const auto labels = shown_labels(shown);
    for (const auto& [label, finest_mesh] : whole) {
      SCOPED_TRACE(fmt::format("mix {} label {}", mix, label));
      const auto found = labels.find(label);
      if (found == labels.end()) {
        EXPECT_LT(extent(finest_mesh), coarsest);
        ++left_out;
        continue;
      }
      const WeldedMesh& mesh = found->second;
      EXPECT_TRUE(check_edges(mesh.triangles).closed());
      EXPECT_EQ(nonmanifold_vertices(mesh.triangles).size(), 0u);
      EXPECT_EQ(component_eulers(mesh.triangles), component_eulers(finest_mesh.triangles));
    }
  }
  EXPECT_GT(mixed, 3u);
  EXPECT_GT(left_out, 0u);  // the specks
}

TEST(LabelLevels, HaveFewerTrianglesAndKeepTheirTolerance) {
  const Scene scene(slabs_and_balls());
  VOXWELD_EXPECT_DONE(scene.run(each_with_levels));
  const auto listed = manifest_of(scene.output()).at("levels");
  ASSERT_GE(listed.size(), 3u);
  for (std::size_t level = 1; level < listed.size(); ++level) {
    SCOPED_TRACE(listed[level].dump());
    EXPECT_LT(listed[level].at("triangles"), listed[level - 1].at("triangles"));
    EXPECT_LE(listed[level].at("p99"), listed[level].at("tolerance").get<double>() * 1.19);
    EXPECT_EQ(listed[level].at("intersecting_left"), 0);
  }
}

TEST(LabelLevels, AreTheSameWhateverThePartition) {
  const Scene scene(slabs_and_balls());
  const Tree tree = scene.expect_one_tree(
      each_with_levels, {{"work.brick=32", "work.shard=1", "run.threads=3"},
                         {"work.brick=128", "work.shard=1", "work.copy=true", "run.memory=64GiB"}});
  EXPECT_TRUE(tree.contains("tileset.json"));
  EXPECT_TRUE(tree.contains("levels.jsonl"));
}

// The files of the labels themselves are those of a run without levels.
TEST(LabelLevels, ChangeNothingOfTheLabels) {
  const Scene scene(slabs_and_balls());
  const Tree none = scene.clean_tree(each_with_levels + Settings{"output.levels=1"});
  VOXWELD_EXPECT_DONE(scene.run(each_with_levels));
  const Tree some = output_tree(scene.output());
  for (const auto& [name, content] : none)
    if (name.starts_with("labels/")) {
      ASSERT_TRUE(some.contains(name)) << name;
      EXPECT_EQ(some.at(name), content) << name;
    }
}

TEST(LabelLevels, GoOnAndLoseNothing) {
  const Scene scene(slabs_and_balls());
  const Tree clean = scene.clean_tree(each_with_levels);
  VOXWELD_EXPECT_DONE(scene.run(each_with_levels));
  expect_goes_on(scene, each_with_levels, clean, {"levels", "retile"});
  expect_damage_is_mended(Scene(slabs_and_balls()), each_with_levels, 3,
                          {{"levels", ".cubes", "encode"}, {"levels", ".cubes", "levels"}});
  expect_kills_lose_nothing(Scene(slabs_and_balls()), each_with_levels, 3, 0.5);
}

TEST(LabelLevels, AreShownAndExported) {
  const Scene scene(slabs_and_balls());
  VOXWELD_EXPECT_DONE(scene.run(each_with_levels));
  const std::string output = scene.output().string();
  expect_levels_are_exported(scene);
  const std::string folder = (scene.directory() / "neuroglancer").string();
  VOXWELD_EXPECT_DONE(run_voxweld({"export", output, "--neuroglancer", "-o", folder}));
  const ProgramResult verified = run_voxweld({"verify", folder});
  VOXWELD_EXPECT_DONE(verified);
  EXPECT_NE(verified.out.find("level 2"), std::string::npos) << verified.out;
  expect_refused(scene.run(each_with_levels + Settings{"output.formats=[\"stl\"]"}),
                 "has no place for them");
}

}  // namespace
}  // namespace voxweld::testing
