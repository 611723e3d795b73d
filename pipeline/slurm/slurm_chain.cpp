#include "pipeline/slurm/slurm_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "pipeline/build/build_stage.h"
#include "pipeline/run/tile_vertices.h"
#include "pipeline/slurm/batch_script.h"
#include "pipeline/slurm/queued_tasks.h"
#include "pipeline/slurm/task_cost.h"
#include "pipeline/slurm/task_plan.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

constexpr const char* chain_prefix = "submitted-";

// The steps of one chain as they are submitted, each told whom it waits for.
class Chain {
 public:
  Chain(const SlurmSetup& setup, SlurmClient& client) : setup_(setup), client_(client) {}

  // An array of `voxweld STAGE CONFIG LINE`. The step behind waits for it, however it ends.
  void array(const std::string& stage, const std::vector<std::string>& lines) {
    const ArrayFolder folder = folder_of(stage, lines);
    submit(stage, folder, lines.size(),
           stage_script(setup_, stage, folder, lines.size(), dependency()));
    waits_for_ = fmt::format("afterany:{}", steps_.back().job);
  }

  // A job of these commands, each `voxweld WORDS...`, which is needed for all that follows.
  void job(const std::string& name, const std::vector<std::vector<std::string>>& commands) {
    const ArrayFolder folder = folder_of(name, {name});
    BatchScript script = array_script(setup_, name, folder, 1, dependency());
    for (const auto& words : commands) {
      std::string line = shell_quote(setup_.program.string());
      for (const std::string& word : words) line.append(" ").append(shell_quote(word));
      script.body.push_back(line);
    }
    submit(name, folder, 1, render(script));
    needs_ = steps_.back().job;
    waits_for_.clear();
  }

  std::vector<std::string> command(const std::string& name) const {
    return {name, setup_.config_file.string(), "--set",
            fmt::format("run.threads={}", setup_.config.slurm.cpus_per_task)};
  }
  std::vector<SubmittedStep> take() { return std::move(steps_); }
  void withdraw() {
    std::vector<std::int64_t> jobs;
    for (const SubmittedStep& step : steps_) jobs.push_back(step.job);
    if (!jobs.empty()) client_.cancel(jobs);
  }

 private:
  ArrayFolder folder_of(const std::string& name, const std::vector<std::string>& lines) const {
    return ArrayFolder::create(setup_.folder / (chain_prefix + name), lines,
                               unique_job_name("voxweld-" + name));
  }

  std::string dependency() const {
    if (needs_ == 0) return waits_for_;
    return fmt::format("afterok:{}{}{}", needs_, waits_for_.empty() ? "" : ",", waits_for_);
  }

  void submit(const std::string& name, const ArrayFolder& folder, std::size_t tasks,
              const std::string& text) {
    write_whole_file(folder.script_path(), as_bytes(text), Durability::rename_only);
    const std::int64_t job = client_.submit(folder.script_path(), folder.name());
    steps_.push_back({name, job, tasks, folder.path()});
    folder.set_job(job);
  }

  const SlurmSetup& setup_;
  SlurmClient& client_;
  std::vector<SubmittedStep> steps_;
  std::string waits_for_;   // the array before, however it ends
  std::int64_t needs_ = 0;  // the last job, which has to end well
};

std::vector<std::string> lines_of(const SlurmSetup& setup, StageName stage,
                                  const std::vector<Unit>& units) {
  std::vector<PlannedTask> tasks = plan_stage_tasks(setup, stage, units);
  // One array a step: where there would be more tasks than it may have, they get larger.
  const auto most = static_cast<std::size_t>(setup.config.slurm.max_array);
  std::vector<std::string> lines;
  const std::size_t count = std::min(tasks.size(), most);
  for (std::size_t i = 0; i < count; ++i) {
    PlannedTask task = std::move(tasks[i]);
    for (std::size_t j = i + count; j < tasks.size(); j += count)
      task.units.insert(task.units.end(), tasks[j].units.begin(), tasks[j].units.end());
    std::sort(task.units.begin(), task.units.end());
    lines.push_back(task_arguments(stage, task));
  }
  return lines;
}

// Before the tiles are known they are dealt out by turns.
std::vector<std::string> parts(const SlurmSetup& setup, std::size_t build_tasks) {
  const auto most = static_cast<std::size_t>(setup.config.slurm.max_array);
  const std::size_t count = std::clamp<std::size_t>(
      std::max(build_tasks, 2 * static_cast<std::size_t>(setup.slots)), 1, most);
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < count; ++i) lines.push_back(fmt::format("--part {}/{}", i, count));
  return lines;
}

// Units of refine, seams and mend, and of survey and recount, read of all artifacts before them, so that one
// lost task would fail them all: a job makes up for it first.
void add_refine(Chain& chain, const Config& config, const std::vector<std::string>& lines) {
  std::string before = "stitch";
  for (const Stage stage : stages_of(config)) {
    if (stage <= Stage::stitch || stage == Stage::encode) continue;
    if (before != stage_name(Stage::levels)) chain.job(before + "-rest", {chain.command(before)});
    before = stage_name(stage);
    // Its rounds wait for each other: one job does all.
    if (stage == Stage::levels)
      chain.job(before, {chain.command(before)});
    else
      chain.array(before, lines);
  }
}

void refuse_if_submitted(const Config& config, SlurmClient& client) {
  for (const QueuedTasks& queued : queued_tasks(known_arrays(config), client))
    if (queued.alive())
      throw InputError(
          fmt::format("job {} of this config is in Slurm already; `voxweld status` shows it, "
                      "`voxweld cancel` ends it",
                      queued.array.job));
}

}  // namespace

std::vector<SubmittedStep> submit_chain(RunContext& context, const SlurmSetup& setup,
                                        SlurmClient& client) {
  refuse_if_submitted(context.config, client);
  const Jobs jobs(context.config, context.interrupt);
  check_budget(context, jobs);
  warn_of_large_tiles(context);
  const auto ingest_work = ingest_stage(context.config, jobs.ingest());
  const std::vector<Unit> ingest = ingest_work->units(ingest_work->look(context.selection).to_do());
  const BrickGrid grid = brick_grid(context.config, jobs.ingest().info.geometry);
  std::vector<std::uint64_t> shards(grid.all_shards().size());
  std::iota(shards.begin(), shards.end(), std::uint64_t{0});
  const auto build = lines_of(setup, "build", shard_units(grid, shards));

  Chain chain(setup, client);
  try {
    if (!ingest.empty()) chain.array("ingest", lines_of(setup, "ingest", ingest));
    chain.job("ingest-rest", {chain.command("ingest")});
    chain.array("build", build);
    chain.job("merge", {chain.command("build"), chain.command("merge")});
    chain.array("stitch", parts(setup, build.size()));
    if (refines(context.config)) add_refine(chain, context.config, parts(setup, build.size()));
    chain.array("encode", parts(setup, build.size()));
    auto finish = chain.command("run");
    finish.insert(finish.end(), {"--set", "run.executor=local"});
    chain.job("finish", {finish});
  } catch (const std::exception&) {
    chain.withdraw();  // half a chain would end in nothing
    throw;
  }
  return chain.take();
}

}  // namespace voxweld
