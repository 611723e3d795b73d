#include "pipeline/stitch/stitch_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/stitch/stitch_work.h"
#include "stages/refine/mesh_part.h"

namespace voxweld {
namespace {

class StitchStage final : public StageWork {
 public:
  StitchStage(const StitchJob& job, const TopArtifact& top, const UnitPlan& plan)
      : job_(job), plan_(plan), work_(job, top) {}

  Stage stage() const override { return Stage::stitch; }
  std::string noun() const override { return plan_.of_labels() ? "batches" : "tiles"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return plan_.size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    std::vector<Unit> units;
    for (const std::uint64_t number : numbers) {
      const PlannedTile total = plan_.total(number);
      units.push_back(
          {number, plan_.name(number), static_cast<double>(total.vertices + total.polygons)});
    }
    return units;
  }
  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = stitch_artifact_path(job_, plan_, unit);
    return is_current(path, [&] { return work_.key_of(path) == work_.key(unit); });
  }
  std::string missing_text(const StageLook& look) const override {
    return fmt::format("{} of {} tiles missing", look.missing.size(), look.units);
  }

  // A worker keeps the largest brick it has read.
  StageMemory memory(std::span<const std::uint64_t> numbers) override {
    std::uint64_t largest = 0, brick = 0;
    for (const std::uint64_t unit : numbers) {
      largest = std::max(largest, bytes(unit));
      brick = std::max(brick, work_.brick_bytes(unit));
    }
    return {"stitch",
            work_.bytes(),
            largest,
            fmt::format("one tile (output.tile_vertices = {})", job_.merge->tile_vertices),
            "raise run.memory or lower output.tile_vertices",
            brick};
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    const PlannedTile tile = plan_.largest(unit);
    const std::uint64_t vertices = tile.vertices + tile.vertices / 4;
    const std::uint64_t triangles = 2 * tile.polygons;
    const std::uint64_t sided =
        job_.build->parameters.labels.mode == LabelMode::shared ? triangles : 0;
    return stitch_bytes(vertices, tile.polygons) +
           (job_.cubes ? piece_bytes(vertices, triangles, sided) + sided * sizeof(MaterialPair)
                       : 0);
  }
  void begin(RunContext&, std::span<const std::uint64_t>, int threads) override {
    scratch_ = std::vector<StitchScratch>(static_cast<std::size_t>(threads));
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    work_.run(unit.key, stitch_artifact_path(job_, plan_, unit.key),
              scratch_[static_cast<std::size_t>(worker.slot())], worker);
  }
  void end(RunContext&) override { scratch_.clear(); }

 private:
  const StitchJob& job_;
  const UnitPlan& plan_;
  StitchWork work_;
  std::vector<StitchScratch> scratch_;  // one a worker
};

}  // namespace

std::unique_ptr<StageWork> stitch_stage(const StitchJob& job, const TopArtifact& top,
                                        const UnitPlan& plan) {
  return std::make_unique<StitchStage>(job, top, plan);
}

}  // namespace voxweld
