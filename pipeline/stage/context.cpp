#include "pipeline/stage/context.h"

#include <algorithm>
#include <utility>

namespace voxweld {

std::uint64_t program_bytes() {
  constexpr std::uint64_t least = std::uint64_t{40} << 20, slack = std::uint64_t{16} << 20;
  return std::max(least, resident_bytes() + slack);
}

int stage_threads(const RunContext& context, StageMemory memory) {
  memory.base_bytes += program_bytes();
  return threads_within(context.budget(), memory, context.threads);
}

void run_stage(RunContext& context, const StageRun& stage, const std::vector<Unit>& units,
               int threads, const UnitWork& work) {
  release_free_memory();
  const StageMeter meter;
  StageStart start{stage.stage, stage.noun, units.size(), 0, stage.reused};
  for (const Unit& unit : units) start.weight += unit.weight;
  StageProgress progress(context.console, context.progress, start);
  StageFigures elsewhere;
  const RunOptions options{threads,    stage.order,    &progress, context.interrupt,
                           stage.done, stage.identity, &elsewhere};
  context.executor->run_units(stage.stage, units, work, options);
  StageFigures figures = meter.read();
  if (!context.executor->in_process()) {
    figures.cpu_s = elsewhere.cpu_s;
    figures.peak_resident = elsewhere.peak_resident;
  }
  progress.finish(figures);
  context.reports.push_back({stage.stage, units.size() + stage.reused, units.size(), figures});
}

}  // namespace voxweld
