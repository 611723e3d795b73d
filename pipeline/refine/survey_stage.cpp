#include "pipeline/refine/survey_stage.h"

#include "pipeline/refine/collapse_choice.h"
#include "pipeline/refine/range_stage.h"
#include "storage/artifact/collapse_survey_artifact.h"

namespace voxweld {
namespace {

class SurveyStage final : public RangeStage {
 public:
  explicit SurveyStage(const RefineInputs& inputs)
      : RangeStage(inputs),
        others_(job_.frame, 1 - job_.pass),
        tolerances_(tried_tolerances(job_)) {}

  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path,
                      [&] { return read_collapse_survey(path).key == key(unit, reads(unit)); });
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const std::vector<RangeReads> all = reads(unit.key);
    CollapseSurvey sum;
    sum.left.resize(tolerances_.size());
    for (const RangeReads& read : all)
      sum.add(survey_range(read.read([&] { worker.check_interrupt(); }), cubes_, others_,
                           range_of(unit.key), job_.parameters, tolerances_));
    write_collapse_survey(path_of(unit.key), key(unit.key, all), sum);
  }

 private:
  Hash128 key(std::uint64_t unit, const std::vector<RangeReads>& reads) const {
    return key_of(unit, reads).bytes(as_section(tolerances_)).finish();
  }

  CubeLattice others_;
  std::vector<double> tolerances_;
};

}  // namespace

std::unique_ptr<StageWork> survey_stage(const RefineInputs& inputs) {
  return std::make_unique<SurveyStage>(inputs);
}

}  // namespace voxweld
