// The error of each level in the manifest. That it is the same for every partition, and the same of
// cuts, the tests of these say: they compare all of the manifest's `error`.
#include <algorithm>

#include "tests/pipeline/run/edit_scene.h"
#include "tests/pipeline/run/label_volumes.h"

namespace voxweld::testing {
namespace {

const Settings small_bricks = {"work.brick=16", "work.shard=2"};

struct Levels {
  std::vector<std::uint64_t> leaves;
  std::vector<double> errors;
};

Levels levels_of(const Scene& scene) {
  const nlohmann::json manifest = manifest_of(scene.output());
  Levels levels;
  manifest.at("counts").at("leaves").get_to(levels.leaves);
  manifest.at("error").at("levels").get_to(levels.errors);
  return levels;
}

Levels levels_of_run(const Scene& scene, const Settings& settings) {
  scene.forget();
  VOXWELD_EXPECT_DONE(scene.run(settings));
  return levels_of(scene);
}

std::string box(Vec3 lo, Vec3 hi) {
  const Vec3 center = (lo + hi) * 0.5, size = hi - lo;
  return fmt::format(
      "[[edit]]\nop = \"add\"\nshape = \"box\"\ncenter = [{}, {}, {}]\nsize = [{}, {}, {}]\n",
      center.x, center.y, center.z, size.x, size.y, size.z);
}

// Two boxes, of which the one is higher by 0.2. Where its wall goes through a cell, two of the cell's
// four crossings are at either height. Their mean is 0.1 from both: so is the error. In eight cells
// with that one at a side, a quarter of the crossings is at one of the heights. So the vertex is
// 0.15 from these and 0.05 from the others, which is an error of 0.2 * sqrt(1/4 * 3/4). All else can
// be told exactly.
TEST(ErrorLevels, OfAStepAreAsTheyAreByHand) {
  const Scene scene(noise_volume({8, 8, 8}, 0));
  // Lattice points are one further than samples: the wall is in cell 21.
  EditScene(scene, {40, 40, 40})
      .set(box({4.3, 4.4, 4.2}, {34.3, 34.4, 20.3}) + box({20.5, 4.4, 4.2}, {34.3, 34.4, 20.5}));
  for (const char* topology : {"simplify.topology=manifold", "simplify.topology=safe"}) {
    SCOPED_TRACE(topology);
    const Settings settings = small_bricks + Settings{topology};
    const Levels strict = levels_of_run(scene, settings + Settings{"simplify.tolerance=0.05"});
    EXPECT_NEAR(strict.errors.at(0), 0.1, 1e-6);
    for (std::size_t l = 1; l < strict.errors.size(); ++l) EXPECT_LE(strict.errors[l], 0.05);
    const Levels loose = levels_of_run(scene, settings + Settings{"simplify.tolerance=0.09"});
    EXPECT_NEAR(loose.errors.at(0), 0, 1e-6);
    EXPECT_NEAR(loose.errors.at(1), 0.2 * std::sqrt(3.0) / 4, 1e-6);
  }
}

void expect_consistent(const Scene& scene, double tolerance) {
  const Levels levels = levels_of(scene);
  const nlohmann::json error = manifest_of(scene.output()).at("error");
  ASSERT_EQ(levels.errors.size(), levels.leaves.size());
  ASSERT_GT(levels.errors.size(), 2u);
  EXPECT_EQ(levels.errors[0], error.at("finest").get<double>());
  EXPECT_EQ(*std::max_element(levels.errors.begin() + 1, levels.errors.end()),
            error.at("reached").get<double>());
  for (std::size_t l = 0; l < levels.errors.size(); ++l) {
    EXPECT_TRUE(levels.leaves[l] > 0 || levels.errors[l] == 0) << l;
    EXPECT_TRUE(l == 0 || levels.errors[l] <= tolerance) << l;
  }
  EXPECT_GT(std::ranges::count_if(levels.errors, [](double e) { return e > 0; }), 2);
}

TEST(ErrorLevels, AreWithinTheToleranceHoweverCellsCollapse) {
  const Scene surface("porous", 64), labels(cell_labels({50, 40, 36}, 5, 0.01, 3));
  for (const char* topology : {"manifold", "safe", "free"})
    for (const double tolerance : {0.1, 0.7}) {
      SCOPED_TRACE(fmt::format("{} {}", topology, tolerance));
      const Settings settings = {fmt::format("simplify.topology={}", topology),
                                 fmt::format("simplify.tolerance={}", tolerance)};
      levels_of_run(surface, settings + small_bricks);
      expect_consistent(surface, tolerance);
    }
  for (const char* mode : {"each", "shared"}) {
    levels_of_run(labels, small_bricks + Settings{fmt::format("labels.mode={}", mode),
                                                  "simplify.tolerance=0.4"});
    expect_consistent(labels, 0.4);
  }
}

TEST(ErrorLevels, OfLabelsAreTheLargestOfAny) {
  const Scene scene(cell_labels({50, 40, 36}, 4, 0.01, 3));
  const Settings settings = small_bricks + Settings{"simplify.tolerance=0.5"};
  Levels sum;
  for (int label = 1; label <= 4; ++label) {
    const Levels alone =
        levels_of_run(scene, settings + Settings{fmt::format("surface.label={}", label),
                                                 fmt::format("surface.isovalue={}", label)});
    sum.leaves.resize(std::max(sum.leaves.size(), alone.leaves.size()));
    sum.errors.resize(sum.leaves.size());
    for (std::size_t l = 0; l < alone.leaves.size(); ++l) {
      sum.leaves[l] += alone.leaves[l];
      sum.errors[l] = std::max(sum.errors[l], alone.errors[l]);
    }
  }
  const Levels all = levels_of_run(scene, settings + Settings{"labels.mode=each"});
  EXPECT_EQ(all.leaves, sum.leaves);
  EXPECT_EQ(all.errors, sum.errors);
}

}  // namespace
}  // namespace voxweld::testing
