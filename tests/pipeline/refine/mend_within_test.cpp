// More places intersect than may be in memory at once: then boxes end where cubes do, and what lies across
// these is left to the next stage, whose cubes are others.
#include <algorithm>
#include <numeric>
#include <set>

#include "pipeline/executor/executor.h"
#include "pipeline/refine/mend_stage.h"
#include "pipeline/run/jobs.h"
#include "pipeline/stage/refine_units.h"
#include "pipeline/stage/unit_plan.h"
#include "stages/refine/find_pairs.h"
#include "stages/refine/mesh_part.h"
#include "storage/artifact/top_artifact.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

using Shapes = std::vector<LatticeTriangle>;

// What a run that repairs has left up to refine, or one that collapses edges up to seams; and what the
// next stages make of it here.
class Repair {
 public:
  Repair(const Scene& scene, const Settings& settings)
      : config_(load_config(scene.config(), settings + scene.in("scene"))), jobs_(config_) {
    VOXWELD_EXPECT_DONE(scene.run(settings));
    jobs_.open_volume(config_);
    top_.emplace(jobs_.merge().path());
    units_ = refine_units(*top_, config_.labels.mode, cubes_of(jobs_.seams().frame));
    folder_ = scene.directory();
    if (!only_repairs(config_)) {
      layers_.push_back({Stage::seams, refined_meshes(jobs_.seams(), units_)});
      return;
    }
    const auto plan = unit_plan(*top_, config_.labels.mode, collapses_by_sheets(config_));
    MeshLayer stitched;
    for (std::uint64_t unit = 0; unit < plan->size(); ++unit)
      stitched.paths.push_back(stitch_artifact_path(jobs_.stitch(), *plan, unit));
    layers_.push_back(stitched);
    places_ = {Stage::refine, refined_meshes(jobs_.refine(), units_)};
  }

  std::size_t units() const { return units_.size(); }
  // One more layer.
  void mend(RefineJob job) {
    job.folder = folder_ / ("layer" + std::to_string(layers_.size()));
    RefineInputs inputs{job, units_, layers_, 0};
    inputs.places = places_;
    const std::unique_ptr<StageWork> work = mend_stage(inputs);
    std::vector<std::uint64_t> numbers(units_.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    RunOptions options;
    options.threads = 2;
    LocalExecutor().run_units(
        "mend", work->units(numbers),
        [&](const Unit& unit, WorkerContext& worker) { work->run(unit, worker); }, options);
    for (const std::uint64_t unit : numbers) EXPECT_TRUE(work->done(unit));
    places_ = {job.stage, refined_meshes(job, units_)};
    layers_.push_back(*places_);
  }
  const Jobs& jobs() const { return jobs_; }

  RefineMesh mesh() const {
    CubeMeshes meshes(layers_);
    MeshGather gather;
    for (std::size_t i = 0; i < meshes.size(); ++i)
      for (std::size_t p = 0; p < meshes.open(i)->pieces().size(); ++p)
        for (const CubePart part : {CubePart::inside, CubePart::leaving})
          gather.add(meshes.read(i, p, part));
    return gather.take();
  }
  // Boxes of what the last layer says intersects.
  std::vector<LatticeBox> listed() const {
    std::vector<LatticeBox> boxes;
    for (const std::filesystem::path& path : places_->paths)
      for (const IntersectionRecord& record : CubeMeshArtifact(path).intersecting())
        boxes.push_back(record.box);
    return boxes;
  }
  FoundPairs found() const {
    return find_range_pairs(mesh(), CubeLattice(jobs_.seams().frame, 0), CubeRange{});
  }

 private:
  Config config_;
  Jobs jobs_;
  std::optional<TopArtifact> top_;
  std::vector<RefineUnit> units_;
  std::vector<MeshLayer> layers_;
  std::optional<MeshLayer> places_;  // none: layers_ say it
  std::filesystem::path folder_;
};

RefineJob with_most(RefineJob job, std::uint64_t places) {
  job.room.most_places = places;
  job.parameters.intersections = IntersectionRule::none;
  return job;
}

Shapes shapes_of(const RefineMesh& mesh) {
  Shapes shapes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) shapes.push_back(mesh.shape(t));
  std::ranges::sort(shapes);
  return shapes;
}

// Each edge has as many triangles on the one side as on the other.
bool is_closed(const RefineMesh& mesh) {
  std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& c : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace(c[k], c[(k + 1) % 3]);
  return std::ranges::all_of(edges, [&](const auto& edge) {
    return edges.count(edge) == edges.count({edge.second, edge.first});
  });
}

TEST(MendWithin, IsTheSameHoweverItIsCutAndLosesNothing) {
  const Scene scene("porous", 128);
  Shapes first;
  for (const char* tiles : {"output.tile_vertices=2000", "output.tile_vertices=20000"}) {
    SCOPED_TRACE(tiles);
    Repair repair(scene, {"simplify.refine=repair", tiles});
    EXPECT_GT(repair.units(), 4u);
    const std::size_t before = repair.found().pairs;
    EXPECT_GT(before, 200u);
    repair.mend(with_most(repair.jobs().seams(), 3));
    const std::size_t within = repair.found().pairs;
    EXPECT_LT(within, before / 4);
    EXPECT_GT(within, 0u) << "nothing lies across cubes";
    const RefineMesh halfway = repair.mesh();
    std::vector<LatticeBox> left;
    for (const std::uint32_t t : repair.found().intersecting) left.push_back(halfway.box(t));
    EXPECT_TRUE(std::ranges::is_permutation(repair.listed(), left)) << "all are listed, once each";
    repair.mend(repair.jobs().mend());
    EXPECT_EQ(repair.found().pairs, 0u);
    EXPECT_TRUE(repair.listed().empty());
    EXPECT_TRUE(is_closed(repair.mesh()));
    const Shapes shapes = shapes_of(repair.mesh());
    if (first.empty()) first = shapes;
    EXPECT_TRUE(shapes == first);
  }
}

class MendAcross : public ::testing::TestWithParam<const char*> {};

// Boxes of mend and remend reach over units' borders, even if not all can be planned at once. What
// collapse only reports is left for them here; it is listed by cubes of the second pass.
TEST_P(MendAcross, BoxesAreTheSameHoweverUnitsAreCut) {
  const Scene scene("porous", 128);
  for (const std::uint64_t most : {std::uint64_t{0}, MendRoom{}.most_places}) {
    Shapes first;
    for (const char* tiles : {"output.tile_vertices=2000", "output.tile_vertices=20000"}) {
      SCOPED_TRACE(std::to_string(most) + " " + tiles);
      Repair repair(scene, {GetParam(), "simplify.intersections=report", tiles});
      const std::size_t before = repair.found().pairs;
      EXPECT_GT(before, 50u);
      repair.mend(with_most(repair.jobs().mend(), most));
      const FoundPairs halfway = repair.found();
      EXPECT_LT(halfway.pairs, before / 4);
      std::set<std::pair<LatticePoint, LatticePoint>> left, listed;
      const RefineMesh mesh = repair.mesh();
      for (const std::uint32_t t : halfway.intersecting)
        left.emplace(mesh.box(t).lo, mesh.box(t).hi);
      for (const LatticeBox& box : repair.listed()) listed.emplace(box.lo, box.hi);
      EXPECT_TRUE(std::ranges::includes(listed, left)) << "a place is lost";
      if (most == 0) {
        EXPECT_GT(halfway.pairs, 0u) << "nothing lies across walls";
        // Of some that lie across the other triangle was mended.
        EXPECT_LT(listed.size(), 2 * left.size());
      } else {
        EXPECT_EQ(listed.size(), left.size()) << "places are listed where there are none";
      }
      repair.mend(with_most(repair.jobs().remend(), most));
      EXPECT_EQ(repair.found().pairs, 0u);
      EXPECT_TRUE(is_closed(repair.mesh()));
      const Shapes shapes = shapes_of(repair.mesh());
      if (first.empty()) first = shapes;
      EXPECT_TRUE(shapes == first);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Modes, MendAcross,
                         ::testing::Values("simplify.refine=repair", "simplify.refine=collapse"));

}  // namespace
}  // namespace voxweld::testing
