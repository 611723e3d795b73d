#include "pipeline/stage/context.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "pipeline/executor/memory_pool.h"

namespace voxweld {

std::uint64_t program_bytes(std::uint64_t memory) {
  constexpr std::uint64_t least = std::uint64_t{40} << 20, slack = std::uint64_t{16} << 20;
  std::uint64_t resident = resident_bytes();
  if (resident >= memory / 32) {
    release_free_memory();  // what the stage before used counts against no other
    resident = resident_bytes();
  }
  return std::max(least, resident + slack);
}

void warn_of_nans(const Config& config, const NanCount& nans) {
  if (nans.samples == 0) return;
  // In the file's own samples, or in those that the filters leave.
  const bool own = config.filters.empty();
  const Index3 shift = own && config.input.crop ? config.input.crop->lo : Index3{};
  const Index3 lo = nans.box.lo + shift, hi = nans.box.hi + shift - splat(1);
  spdlog::warn(
      "{}: {} {} NaN{} and count as outside. They lie in the samples {} to {} along x, {} to {} "
      "along y, {} to {} along z; give them numbers if the material goes on there",
      config.input.path.string(), nans.samples, nans.samples == 1 ? "sample is" : "samples are",
      own ? "" : " behind the filters", lo.x, hi.x, lo.y, hi.y, lo.z, hi.z);
}

int stage_threads(const RunContext& context, StageMemory memory) {
  memory.base_bytes += program_bytes(context.budget().total);
  return threads_within(context.budget(), memory, context.threads);
}

namespace {

// The program may have grown since the threads were counted: then units wait for each other sooner.
std::uint64_t units_share(const RunContext& context, const StageMemory& memory, int threads) {
  const std::uint64_t taken =
      memory.base_bytes + static_cast<std::uint64_t>(threads) * memory.per_worker_bytes;
  const std::uint64_t total = context.budget().total;
  return std::max(total > taken ? total - taken : 0, memory.per_unit_bytes);
}

}  // namespace

void run_stage(RunContext& context, const StageRun& stage, const std::vector<Unit>& units,
               int threads, const UnitWork& work) {
  StageMemory memory = stage.memory;
  memory.base_bytes += program_bytes(context.budget().total);
  keep_freed_memory(context.budget().total, threads);
  const StageMeter meter;
  StageStart start{stage.stage, stage.noun, units.size(), 0,
                   stage.reused - (stage.apart_reused ? 1 : 0)};
  for (const Unit& unit : units) {
    start.weight += unit.weight;
    if (unit.apart) start.apart = unit.name;
  }
  StageProgress progress(context.console, context.progress, start);
  Elsewhere elsewhere;
  const auto pool = std::make_shared<MemoryPool>(units_share(context, memory, threads));
  RunOptions options;
  options.threads = threads;
  options.order = stage.order;
  options.progress = &progress;
  options.interrupt = context.interrupt;
  options.done = stage.done;
  options.check_input = context.check_input;
  options.identity = stage.identity;
  options.memory = pool;
  options.elsewhere = &elsewhere;
  const UnitWork within = [&](const Unit& unit, WorkerContext& worker) {
    const MemoryLoan loan(*pool, stage.bytes ? stage.bytes(unit) : 0, context.interrupt);
    work(unit, worker);
  };
  context.executor->run_units(stage.stage, units, within, options);
  StageFigures figures = meter.read();
  if (!context.executor->in_process()) {
    figures.cpu_s = elsewhere.figures.cpu_s;
    figures.peak_resident = elsewhere.figures.peak_resident;
    context.nans.add(elsewhere.nans);
  }
  progress.finish(figures);
  context.reports.push_back({stage.stage, units.size() + stage.reused, units.size(), figures});
}

}  // namespace voxweld
