#include "pipeline/refine/refine_stage.h"

#include <map>

#include "pipeline/executor/probe.h"
#include "pipeline/refine/range_stage.h"
#include "pipeline/stage/cube_mesh.h"
#include "stages/refine/retile.h"

namespace voxweld {
namespace {

class RefineStage final : public RangeStage {
 public:
  explicit RefineStage(const RefineInputs& inputs)
      : RangeStage(inputs),
        choice_(inputs.choice),
        // What comes out is read by another pass, or by retile in blocks of the first one's cubes.
        cubes_after_(job_.frame, job_.next),
        blocks_(tile_blocks(job_.frame)) {}

  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return CubeMeshArtifact(path).key() == key(unit, reads(unit)); });
  }
  StageLook look(const UnitSelection& selection) override {
    StageLook look = StageWork::look(selection);
    if (choice_ != nullptr && selection.all() && !choice_->on_disk())
      look.rest = "the choice of its tolerance is missing";
    return look;
  }
  void open(RunContext&, const StageLook&) override {
    if (choice_ == nullptr) return;
    if (!choice_->on_disk()) choice_->write();
    choice_->tell();
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const std::vector<RangeReads> all = reads(unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key, all));
    RefineCounts counts;
    std::vector<BlockRecord> blocks;
    std::vector<IntersectionRecord> intersecting;
    Changes changes = changes_before(unit.key);
    for (const RangeReads& read : all) {
      RefineCounts one;
      RefineMesh mesh = refine_range(read.read([&] { worker.check_interrupt(); }), cubes_,
                                     range_of(unit.key), job_.parameters, one);
      if (job_.stage == Stage::seams) {
        add_blocks(read.label(), mesh, blocks_, blocks);
        add_intersections(read.label(), mesh, mesh.intersecting, cubes_, intersecting);
        mesh.aims.clear();  // nobody asks for them any more
      }
      add_pieces(file, read.label(), mesh, cubes_after_);
      changes[read.label()] += one.collapses;  // each took a vertex
      counts.add(one);
    }
    const std::vector<LabelChange> changed = records_of(changes);
    file.finish({as_record(counts), blocks, changed, intersecting});
  }

 private:
  using Changes = std::map<Material, std::uint64_t>;  // vertices that a label has lost

  static std::vector<LabelChange> records_of(const Changes& changes) {
    std::vector<LabelChange> records;
    for (const auto& [label, lost] : changes)
      if (lost > 0) records.push_back({label, lost});
    return records;
  }
  // Both passes have the same units.
  Changes changes_before(std::uint64_t unit) {
    Changes changes;
    if (job_.stage == Stage::seams)
      for (const LabelChange& change : meshes_.open(unit)->changes())
        changes[change.label] = change.lost_vertices;
    return changes;
  }
  Hash128 key(std::uint64_t unit, const std::vector<RangeReads>& reads) {
    KeyHasher key = key_of(unit, reads);
    key.bytes(as_section(records_of(changes_before(unit))));
    if (job_.target) key.real(job_.parameters.tolerance);
    return key.finish();
  }

  CollapseChoice* choice_;
  CubeLattice cubes_after_, blocks_;
};

}  // namespace

std::unique_ptr<StageWork> refine_stage(const RefineInputs& inputs) {
  return std::make_unique<RefineStage>(inputs);
}

std::vector<std::filesystem::path> refined_meshes(const RefineJob& job,
                                                  const std::vector<RefineUnit>& units) {
  std::vector<std::filesystem::path> paths;
  paths.reserve(units.size());
  for (const RefineUnit& unit : units) paths.push_back(refine_artifact_path(job, unit));
  return paths;
}

RefineCounts refine_counts(const RefineJob& job, const std::vector<RefineUnit>& units) {
  const auto paths = refined_meshes(job, units);
  std::vector<RefineCounts> counts(paths.size());
  probe_all(paths.size(),
            [&](std::size_t i) { counts[i] = CubeMeshArtifact(paths[i]).counted<RefineCounts>(); });
  RefineCounts sum;
  for (const RefineCounts& one : counts) sum.add(one);
  return sum;
}

}  // namespace voxweld
