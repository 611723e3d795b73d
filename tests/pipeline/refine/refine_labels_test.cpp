// simplify.refine with labels.mode = "each": a label's mesh is that of a run of it alone, however the
// work is cut.
#include <fmt/format.h>

#include <cmath>

#include "storage/manifest/manifest.h"
#include "tests/pipeline/run/label_volumes.h"

namespace voxweld::testing {
namespace {

const Settings collapsed = {"simplify.refine=collapse", "simplify.tolerance=0.3"};
const Settings refined_labels = collapsed + Settings{"labels.mode=each"};
const Settings small_parts = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};

// What labels.jsonl says of each label.
std::map<std::uint64_t, LabelRecord> listed(const std::filesystem::path& output) {
  std::map<std::uint64_t, LabelRecord> records;
  LabelListReader reader(output / labels_name);
  while (const auto label = reader.next()) records[label->label] = *label;
  return records;
}

TEST(RefinedLabel, HasTheMeshOfARunOfItAlone) {
  expect_labels_as_alone(ball_labels(SampleType::u16, {40, 36, 33}), collapsed, 0);
  expect_labels_as_alone(ball_labels(SampleType::u64, {33, 20, 20}),
                         collapsed + Settings{"work.brick=16", "output.normals=false"}, 0);
  expect_labels_as_alone(
      cell_labels({40, 33, 30}, 4, 0.0, 7),
      {"simplify.refine=repair", "simplify.tolerance=1", "input.spacing=[1, 0.5, 2.25]"}, 0);
}

TEST(RefinedLabel, HasTheMeshOfARunOfItAloneInManyTiles) {
  expect_labels_as_alone(cell_labels({110, 90, 80}, 6, 0.01, 1), collapsed + small_parts, 3);
}

// So many vertices that one tile is refined in several ranges, beside a small label.
TEST(RefinedLabel, HasTheMeshOfARunOfItAloneInRangesOfCubes) {
  const RawVolume volume = volume_of({96, 96, 90}, [](Index3 at) {
    const Vec3 p = as_vec3(at) * 0.3;
    const bool gyroid = std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) +
                            std::sin(p.z) * std::cos(p.x) >
                        0;
    return at.x < 4 && at.y < 5 && at.z < 6 ? 9 : gyroid ? 1 : 0;
  });
  const Settings settings = {"simplify.refine=collapse", "simplify.tolerance=0.02"};
  expect_labels_as_alone(volume, settings, 0);
  const Scene scene(volume);
  VOXWELD_EXPECT_DONE(scene.run(settings + Settings{"labels.mode=each"}));
  const auto units = units_run(scene.output());
  EXPECT_EQ(units.at("stitch"), 1u);
  EXPECT_GT(units.at("refine"), 4u);
}

TEST(RefinedLabel, HasTheMeshOfARunOfItAloneInNoise) {
  expect_labels_as_alone(cell_labels({30, 27, 18}, 4, 1.0, 2), collapsed + small_parts, 2);
}

TEST(RefinedLabel, HasTheMeshOfARunOfItAloneWithOpenBorders) {
  expect_labels_as_alone(cell_labels({70, 60, 50}, 5, 0.01, 3),
                         collapsed + small_parts + Settings{"surface.border=open"}, 0);
}

TEST(RefinedLabels, AreTheSameWhateverThePartition) {
  const Scene scene(cell_labels({90, 70, 66}, 30, 0.01, 4));
  const Tree tree =
      scene.expect_one_tree(refined_labels + Settings{"output.tile_vertices=1500"},
                            {{"work.brick=16", "work.shard=2", "run.threads=1"},
                             {"work.brick=32", "work.shard=1", "run.threads=3", "work.chunk=16"},
                             {"work.brick=64", "work.shard=1", "work.copy=true"}});
  EXPECT_TRUE(tree.contains("labels.jsonl"));
}

// Each label's triangles by their corners, sorted.
using Triangles = std::vector<std::array<std::array<float, 3>, 3>>;
std::map<std::uint64_t, Triangles> triangles_of(const std::filesystem::path& output) {
  std::map<std::uint64_t, Triangles> found;
  for_each_mesh(output, [&](const DecodedMesh& mesh, std::optional<Material> label) {
    for (const auto& t : mesh.triangles)
      found[*label].push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  });
  for (auto& [label, triangles] : found) {
    for (auto& t : triangles) std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    std::sort(triangles.begin(), triangles.end());
  }
  return found;
}

TEST(RefinedLabels, HaveTheSameTrianglesWhateverTheTiles) {
  const Scene scene(cell_labels({110, 90, 80}, 6, 0.01, 1));
  std::map<std::uint64_t, Triangles> first;
  for (const int vertices : {500000, 4000, 1024}) {
    VOXWELD_EXPECT_DONE(
        scene.run(refined_labels + Settings{fmt::format("output.tile_vertices={}", vertices)}));
    const auto found = triangles_of(scene.output());
    EXPECT_EQ(found.size(), 6u);
    if (first.empty()) first = found;
    EXPECT_TRUE(first == found) << vertices;
  }
}

// With the settings of a label's surface: sound, and nothing intersects.
void expect_sound(const Scene& scene, std::size_t count) {
  VerifyOptions options;
  options.intersections = true;
  const VerifyReport report = verify_output(scene.output(), options);
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_EQ(report.labels, count);
  ASSERT_TRUE(report.intersections);
  EXPECT_EQ(report.intersections->pairs, 0u);
  const nlohmann::json refine = manifest_of(scene.output()).at("refine");
  EXPECT_EQ(refine.at("intersecting_left"), 0);
}

TEST(RefinedLabels, AreSound) {
  const RawVolume volume = cell_labels({80, 70, 66}, 12, 0.005, 5);
  const Scene scene(volume);
  for (const char* mode : {"repair", "collapse"}) {
    SCOPED_TRACE(mode);
    VOXWELD_EXPECT_DONE(
        scene.run(refined_labels + small_parts + Settings{std::string("simplify.refine=") + mode}));
    expect_sound(scene, labels_of(volume).size() - labels_of(volume).count(0));
  }
}

TEST(RefinedLabels, AreSoundWithOpenBorders) {
  const RawVolume volume = cell_labels({80, 70, 66}, 12, 0, 5);
  const Scene scene(volume);
  VOXWELD_EXPECT_DONE(scene.run(refined_labels + small_parts + Settings{"surface.border=open"}));
  const VerifyReport report = expect_good(scene.output());
  EXPECT_EQ(report.labels, labels_of(volume).size());
  EXPECT_GT(report.boundary_edges, 0u);
}

TEST(RefinedLabels, OfWhichThereAreHundredsShareUnits) {
  const RawVolume volume = ball_labels(SampleType::u32, {144, 128, 64});
  const Scene scene(volume);
  const std::size_t count = labels_of(volume).size() - 1;
  ASSERT_GT(count, 250u);
  VOXWELD_EXPECT_DONE(scene.run(refined_labels));
  expect_sound(scene, count);
  const auto units = units_run(scene.output());
  for (const char* stage : {"stitch", "refine", "seams", "mend", "remend", "retile", "encode"}) {
    EXPECT_GT(units.at(stage), 1u) << stage;
    EXPECT_LT(units.at(stage), count / 8) << stage;
  }
  // Collapsed they fit one batch no better: its end is said by labels' numbers.
  EXPECT_EQ(units.at("retile"), units.at("stitch"));
}

TEST(RefinedLabels, AreListedWithWhatIsLeftOfThem) {
  const Scene scene(volume_of({60, 60, 60}, [](Index3 at) {
    const Index3 d = at - splat(30);
    const auto r = d.x * d.x + d.y * d.y + d.z * d.z;
    return r < 150 ? 9 : r < 700 ? 4 : 0;
  }));
  const Settings fine = small_parts + Settings{"labels.mode=each", "simplify.tolerance=0.02"};
  VOXWELD_EXPECT_DONE(scene.run(fine));
  const auto before = listed(scene.output());
  VOXWELD_EXPECT_DONE(
      scene.run(fine + Settings{"simplify.refine=collapse", "simplify.tolerance=0.2"}));
  const auto after = listed(scene.output());
  expect_sound(scene, 2);
  for (const std::uint64_t label : {4, 9}) {
    // Closed, and of genus 0 on each of its surfaces.
    const std::uint64_t shells = label == 4 ? 2 : 1;
    EXPECT_EQ(after.at(label).vertices, after.at(label).triangles / 2 + 2 * shells) << label;
    EXPECT_LT(after.at(label).triangles, before.at(label).triangles / 2) << label;
    EXPECT_NEAR(*after.at(label).volume, *before.at(label).volume, 0.05 * *before.at(label).volume);
  }
  // Merge planned several tiles, and what is left of it is one.
  EXPECT_GT(before.at(4).tiles, after.at(4).tiles);
  EXPECT_EQ(after.at(9).tiles, 1u);
}

// All of its surface lies on the border: nothing is left, and it is listed all the same.
TEST(RefinedLabels, WithoutTrianglesAreListed) {
  const Scene scene(volume_of({40, 30, 30}, [](Index3 at) {
    const Index3 d = at - Index3{25, 15, 15};
    return d.x * d.x + d.y * d.y + d.z * d.z < 90 ? 2 : at.x < 3 ? 3 : 1;
  }));
  const Settings open = small_parts + Settings{"surface.border=open", "labels.mode=each"};
  VOXWELD_EXPECT_DONE(scene.run(open));
  const auto before = listed(scene.output());
  VOXWELD_EXPECT_DONE(scene.run(open + collapsed));
  const auto after = listed(scene.output());
  ASSERT_EQ(after.size(), before.size());
  for (const auto& [label, record] : after)
    EXPECT_EQ(record.triangles == 0, before.at(label).triangles == 0) << label;
  expect_good(scene.output());
  scene.write_volume(volume_of({40, 30, 30}, [](Index3) { return 1; }));
  VOXWELD_EXPECT_DONE(scene.run(open + collapsed));
  EXPECT_EQ(listed(scene.output()).at(1).triangles, 0u);
}

TEST(RefinedLabels, TheManifestSumsThem) {
  const Scene scene(ball_labels(SampleType::u16, {40, 33, 20}));
  const ProgramResult result = scene.run(refined_labels);
  VOXWELD_EXPECT_DONE(result);
  std::uint64_t vertices = 0;
  for (const auto& [label, record] : listed(scene.output())) vertices += record.vertices;
  const nlohmann::json manifest = manifest_of(scene.output());
  EXPECT_EQ(manifest.at("counts").at("vertices"), vertices);
  EXPECT_GT(manifest.at("refine").at("collapses"), 0);
  EXPECT_NE(result.out.find("refined: "), std::string::npos) << result.out;
}

}  // namespace
}  // namespace voxweld::testing
