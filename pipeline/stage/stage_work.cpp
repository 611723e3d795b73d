#include "pipeline/stage/stage_work.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/executor/probe.h"

namespace voxweld {

const char* unit_option(Stage stage) {
  if (stage == Stage::ingest || stage == Stage::build) return "shards";
  return Stage::survey <= stage && stage <= Stage::remend ? "ranges" : "tiles";
}

std::vector<std::uint64_t> StageLook::to_do() const {
  std::vector<std::uint64_t> all = missing;
  all.insert(all.end(), unproven.begin(), unproven.end());
  std::sort(all.begin(), all.end());
  return all;
}

StageLook StageWork::look(const UnitSelection& selection) {
  StageLook look;
  look.units = size();
  const auto missing =
      probe_which(look.units, [&](std::size_t i) { return selection.contains(i) && !done(i); });
  look.missing.assign(missing.begin(), missing.end());
  return look;
}

std::string StageWork::missing_text(const StageLook& look) const {
  return look.to_do().empty()
             ? look.rest
             : fmt::format("{} of {} {} missing", look.to_do().size(), look.units, noun());
}

std::uint64_t StageWork::largest_bytes(std::span<const std::uint64_t> numbers) {
  std::vector<std::uint64_t> needs(numbers.size());
  probe_all(numbers.size(), [&](std::size_t i) { needs[i] = bytes(numbers[i]); });
  const auto largest = std::ranges::max_element(needs);
  return largest == needs.end() ? 0 : *largest;
}

namespace {

// reused: how many units are there already.
void do_units(RunContext& context, StageWork& work, std::uint64_t reused,
              const std::vector<std::uint64_t>& numbers) {
  const bool here = context.executor->in_process();
  StageRun stage;
  stage.stage = std::string(stage_name(work.stage()));
  stage.noun = work.noun();
  stage.reused = reused;
  const std::optional<std::uint64_t> apart = work.apart();
  stage.apart_reused = apart && context.selection.contains(*apart) &&
                       !std::binary_search(numbers.begin(), numbers.end(), *apart);
  stage.order = work.order();
  stage.identity = work.identity();
  stage.done = [&](const Unit& unit) { return work.done(unit.key); };
  if (here) {
    stage.memory = work.memory(numbers);
    stage.bytes = [&](const Unit& unit) { return work.bytes(unit.key); };
  }
  const int threads = stage_threads(context, stage.memory);
  if (here) work.begin(context, numbers, threads);
  run_stage(context, stage, work.units(numbers), threads,
            [&](const Unit& unit, WorkerContext& worker) { work.run(unit, worker); });
  if (here) work.end(context);
}

}  // namespace

void do_stage(RunContext& context, StageWork& work) {
  if (context.interrupt != nullptr) context.interrupt->check();
  context.selection.check(stage_name(work.stage()), unit_option(work.stage()), work.size());
  StageLook look = work.look(context.selection);
  // Elsewhere the one that does a unit first looks whether it has to.
  if (context.executor->in_process()) work.prove(context, look);
  const std::vector<std::uint64_t> numbers = look.to_do();
  work.open(context, look);
  context.nans = {};
  std::uint64_t before = 0;
  auto first = numbers.begin();
  for (const std::uint64_t end : work.rounds()) {
    if (end == before) continue;
    const auto last = std::lower_bound(first, numbers.end(), end);
    const std::uint64_t asked = context.selection.count(end) - context.selection.count(before);
    do_units(context, work, asked - static_cast<std::uint64_t>(last - first), {first, last});
    first = last;
    before = end;
  }
  warn_of_nans(context.config, context.nans);
  if (context.selection.all()) work.close(context);
}

}  // namespace voxweld
