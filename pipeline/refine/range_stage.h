// What the stages have in common whose units are ranges of cubes.
#pragma once

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/refine/refine_stage.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// Labels of a unit are done one after the other: it takes the memory of the largest.
class RangeStage : public StageWork {
 public:
  explicit RangeStage(const RefineInputs& inputs);

  Stage stage() const override { return job_.stage; }
  std::string noun() const override { return "ranges"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return units_.size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override;
  StageMemory memory(std::span<const std::uint64_t> numbers) override;
  std::uint64_t bytes(std::uint64_t unit) override;

 protected:
  std::filesystem::path path_of(std::uint64_t unit) const {
    return refine_artifact_path(job_, units_[unit]);
  }
  const CubeRange& range_of(std::uint64_t unit) const { return units_[unit].range.cubes; }
  // Of several labels one of each that is there.
  std::vector<RangeReads> reads(std::uint64_t unit);
  // Feeds whose it is; then also what is read.
  KeyHasher begin_key(std::uint64_t unit) const;
  KeyHasher key_of(std::uint64_t unit, const std::vector<RangeReads>& reads) const;

  // What a step takes at most: putting together what it reads; and the work on it, of which `own` stays.
  static std::uint64_t reading_bytes(const PartCounts& all, std::uint64_t largest_part);
  static std::uint64_t refining_bytes(const PartCounts& all, const PartCounts& own);

  const RefineJob& job_;
  const std::vector<RefineUnit>& units_;
  std::uint64_t tile_vertices_;
  CubeMeshes meshes_;
  CubeLattice cubes_;
};

}  // namespace voxweld
