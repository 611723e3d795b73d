// Mend where its boxes lie across the borders of units, each of which does them for itself.
#include <random>

#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "tests/pipeline/refine/refine_work.h"

namespace voxweld::testing {
namespace {

// Noise where a border of the first pass' cubes (x = 64) and one of the second's (y = 32) meet, and
// nothing elsewhere. value(random) of a sample there, 0 of all others. (Of most seeds nothing is left
// for mend.)
template <class F>
RawVolume noise_at_borders(unsigned seed, F&& value) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, 255);
  return volume_of({110, 84, 30}, [&](Index3 s) {
    const bool within = s.x > 50 && s.x < 80 && s.y > 24 && s.y < 42 && s.z > 6 && s.z < 22;
    return within ? value(any(random)) : 0;
  });
}

struct Mended {
  std::size_t units = 0;  // that have changed something
  RefineCounts counts;
};
Mended mended_in(const Scene& scene) {
  Mended mended;
  for (const std::filesystem::path& path : artifacts_of(scene, "mend", ".cubes")) {
    const CubeMeshArtifact artifact(path);
    mended.units += artifact.pieces().empty() ? 0 : 1;
    mended.counts.add(artifact.counted<RefineCounts>());
  }
  return mended;
}

// Its files, of small tiles.
Tree expect_one_mend(const Scene& scene, const Settings& settings) {
  const Settings small = settings + Settings{"output.tile_vertices=1024"};
  Tree tree = scene.expect_one_tree(small, {{"work.brick=16", "work.shard=2"},
                                            {"work.brick=32", "work.shard=1", "run.threads=3"}});
  VOXWELD_EXPECT_DONE(scene.run(small));
  const Mended mended = mended_in(scene);
  EXPECT_GT(mended.units, 1u);
  EXPECT_GT(mended.counts.cubes, 0u);
  EXPECT_GT(mended.counts.pairs_before, 0u);
  EXPECT_LT(mended.counts.pairs_left * 4, mended.counts.pairs_before);
  const VerifyReport report = expect_good(scene.output());
  EXPECT_GT(report.triangles, 1000u);
  return tree;
}

void expect_one_merged_mesh(const Scene& scene, const Settings& settings) {
  const Tree tree = expect_one_mend(scene, settings);
  const Tree other = scene.clean_tree(settings + Settings{"output.tile_vertices=3000"});
  EXPECT_EQ(difference(merged_files(tree), merged_files(other)), "");
}

TEST(MendRun, IsTheSameHoweverItIsCut) {
  const Scene scene(noise_at_borders(9, [](int any) { return any; }));
  expect_one_merged_mesh(scene, {"surface.isovalue=100", "simplify.refine=collapse"});
}

TEST(MendRun, OfEachLabelIsTheSameHoweverItIsCut) {
  const Scene scene(noise_at_borders(45, [](int any) { return any / 90; }));
  expect_one_mend(scene, {"labels.mode=each", "simplify.refine=collapse"});
}

TEST(MendRun, OfSharedLabelsIsTheSameHoweverItIsCut) {
  const Scene scene(noise_at_borders(5, [](int any) { return any / 90; }));
  expect_one_merged_mesh(scene, {"labels.mode=shared", "simplify.refine=collapse"});
}

}  // namespace
}  // namespace voxweld::testing
