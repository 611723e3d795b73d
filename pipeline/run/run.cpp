#include "pipeline/run/run.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <set>

#include "pipeline/encode/encode_stage.h"
#include "pipeline/encode/output_files.h"
#include "pipeline/executor/error_set.h"
#include "pipeline/ingest/label_rules.h"
#include "pipeline/ingest/noise_choice.h"
#include "pipeline/merge/merge_stage.h"
#include "pipeline/run/checks.h"
#include "pipeline/run/last_config.h"
#include "pipeline/run/output_claim.h"
#include "pipeline/run/stages.h"
#include "pipeline/run/tile_vertices.h"
#include "pipeline/stage/file_layout.h"
#include "pipeline/stage/work_claim.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

// Something of the input cannot be read, and that is the user's to mend. What the rest of it is
// enough for is built meanwhile: when it is mended only the remainder is left to do. Not where the
// whole volume decides something: its isovalue, the sizes of labels, its noise.
void build_what_is_there(RunContext& context, Stages& stages) {
  const StageLook look = stages.open(Stage::ingest).look(context.selection);
  if (look.missing.size() == look.units || !context.config.surface.isovalue.has_value() ||
      asks_for_sizes(context.config.labels) ||
      (asks_for_noise(context.config) && !noise_is_known(context.config, stages.jobs().ingest())))
    return;
  spdlog::warn("{} of {} shards of the input cannot be read; building what the others allow",
               look.missing.size(), look.units);
  StageWork& build = stages.open(Stage::build);
  const WorkClaim claim(context, stages.jobs().build().folder);
  stages.jobs().build_what_is_there();
  do_stage(context, build);
}

void ingest_or_build_the_rest(RunContext& context, Stages& stages) {
  try {
    do_stage(context, stages.open(Stage::ingest));
  } catch (const Error& error) {
    if (error.exit_code() == 2) build_what_is_there(context, stages);
    throw;
  }
}

// Of tasks that were killed on other hosts, and of those that do what another has done: the stages
// are complete, so nobody needs them.
void clear_temporaries_of_tasks(const Config& config, const Jobs& jobs) {
  std::vector<std::filesystem::path> folders = jobs.later_folders();
  folders.insert(folders.end(),
                 {jobs.ingest().folder, config.output.directory / "tiles",
                  config.output.directory / "labels", config.output.directory / levels_folder});
  for (const std::filesystem::path& folder : folders) remove_needless_temporaries(folder, true);
  remove_needless_temporaries(config.output.directory, false);
}

// While it lives, executors can ask whether the input has changed.
class InputWatch {
 public:
  InputWatch(RunContext& context, Stages& stages) : context_(context), stages_(stages) {
    context_.check_input = [this] { check(); };
  }
  ~InputWatch() { context_.check_input = nullptr; }
  InputWatch(const InputWatch&) = delete;
  InputWatch& operator=(const InputWatch&) = delete;

  void check() {
    if (changed_file(stages_.jobs().ingest())) stages_.check_input();
  }

 private:
  RunContext& context_;
  Stages& stages_;
};

// Calls work. Where that fails because the input has changed under it, that is what is said.
template <class F>
void on_steady_input(RunContext& context, Stages& stages, F&& work) {
  InputWatch watch(context, stages);
  try {
    work();
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    spdlog::debug("{}", error.what());
    watch.check();
    throw;
  }
}

// ingest -> build -> merge -> stitch -> (refine -> seams -> mend -> remend -> retile -> (levels ->)) encode; where a
// number of triangles is asked for, survey before refine and recount before seams
void run_stages(RunContext& context) {
  Stages stages(context);
  check_budget(context, stages.jobs());
  warn_of_large_tiles(context);
  on_steady_input(context, stages, [&] {
    ingest_or_build_the_rest(context, stages);
    stages.open(Stage::build);
    const WorkClaim claim(context, stages.jobs().build().folder);
    for (const Stage stage : stages_of(context.config)) {
      if (stage == Stage::ingest) continue;
      claim.check();
      check_before(context, stages, stage);
      if (stage == Stage::build) warn_of_idle_edits(stages);
      do_stage(context, stages.open(stage));
    }
  });
  if (!context.executor->in_process()) clear_temporaries_of_tasks(context.config, stages.jobs());
}

// Of runs that were killed. Only where we write: the directories may hold others' files too.
void clear_temporaries(const Config& config) {
  for (const std::filesystem::path& folder : {config.work.directory, config.output.directory})
    remove_stale_temporaries(folder, false);
  for (const char* folder : {"tiles", "labels", levels_folder})
    remove_stale_temporaries(config.output.directory / folder, true);
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(config.work.directory, error))
    if (stage_of_folder(entry.path())) remove_stale_temporaries(entry.path(), true);
}

// Removes what failed its checks, so that the next pass makes it again. Throws the error itself
// when something is damaged for the second time: then it is not chance.
void mend(const std::exception& error, std::set<std::string>& mended) {
  const auto paths = damaged_paths(error);
  for (const std::string& path : paths) {
    if (!mended.insert(path).second) throw;
    spdlog::warn("{}; it is removed and made again", error.what());
    std::filesystem::remove(path);
  }
}

// The stage whose units are those of encode.
Stage last_mesh_stage(const Config& config) {
  return refines(config) ? Stage::retile : Stage::stitch;
}

// Whether nothing of the stage is left to do. A task that does a share reads the few artifacts that
// its share needs, and those say whether they fit: there, a look at all of them is left out.
bool is_current(RunContext& context, Stages& stages, Stage stage) {
  const bool share = !context.selection.all();
  if (share && stage == Stage::ingest) return true;
  StageWork& work = stages.open(stage);
  if (share && stage != last_mesh_stage(context.config))
    return stage != Stage::merge || merge_is_there(stages.jobs().merge());
  StageLook look = work.look(context.selection);
  work.prove(context, look);
  return look.current();
}

std::string would_run(StageWork& work, const StageLook& look, const std::string& changes) {
  std::string what = work.missing_text(look);
  if (!what.empty()) what = ": " + what;
  return "would run" + what + (changes.empty() ? "" : " (" + changes + ")");
}

}  // namespace

void run_all(RunContext& context, const std::function<void()>& at_end) {
  const Config asked = context.config;
  std::set<std::string> mended;
  check_directories(asked);
  const OutputClaim claim(context);
  clear_temporaries(asked);
  for (bool done = false; !done;) {
    context.config = asked;
    context.reports.clear();
    if (!context.extraction) write_last_config(asked);
    try {
      run_stages(context);
      done = true;
    } catch (const Error& error) {
      if (!is_only_damage(error)) throw;
      mend(error, mended);
    }
  }
  if (at_end) at_end();
}

// Of a config that does not refine.
std::string_view why_off(const Config& config) {
  if (config.simplify.refine == SimplifyConfig::Refine::off) return "";
  return config.simplify.enabled ? ", that is \"off\" with simplify.topology = \"free\""
                                 : ", that is \"off\" with simplify.enabled = false";
}

// Why a run of the config has no such stage.
InputError no_such_stage(const Config& config, Stage stage) {
  const auto error = [&](const std::string& why, const char* advice) {
    return InputError(
        fmt::format("{}: a run of this config has no stage {}; {}, or leave this command out", why,
                    stage_name(stage), advice));
  };
  const SimplifyConfig& simplify = config.simplify;
  if (!refines(config))
    return error(
        fmt::format("simplify.refine = \"{}\"{}", refine_name(simplify.refine), why_off(config)),
        "set it to \"repair\" or \"collapse\"");
  if (stage == Stage::mend || stage == Stage::remend || stage == Stage::seams)
    return error(fmt::format("simplify.intersections = {}",
                             to_toml(*find_setting("simplify", "intersections")->get(config))),
                 "remove that key");
  if (stage == Stage::levels) return error("output.levels = 1", "give more of them, or \"auto\"");
  return error("neither simplify.triangles nor simplify.ratio is given", "give one of them");
}

void run_one(RunContext& context, Stage stage) {
  const std::vector<Stage> all = stages_of(context.config);
  if (std::ranges::find(all, stage) == all.end()) throw no_such_stage(context.config, stage);
  Stages stages(context);
  check_budget(context, stages.jobs());
  // Tasks that do shares work beside each other, for a run that has claimed all.
  const bool whole = context.selection.all() && !context.inputs_checked;
  std::optional<OutputClaim> output_claim;
  std::optional<WorkClaim> work_claim;
  if (stage == Stage::encode && context.selection.all()) output_claim.emplace(context);
  for (const Stage before : all) {
    if (before == Stage::build && whole) {
      stages.open(Stage::build);
      work_claim.emplace(context, stages.jobs().build().folder);
    }
    if (before == stage) break;
    if (context.inputs_checked || is_current(context, stages, before)) continue;
    throw InputError(
        fmt::format("stage {} needs what stage {} makes, and that is missing or out of date; run "
                    "`voxweld {} CONFIG` first, or `voxweld run CONFIG` for all",
                    stage_name(stage), stage_name(before), stage_name(before)));
  }
  on_steady_input(context, stages, [&] {
    if (work_claim) work_claim->check();
    StageWork& work = stages.open(stage);
    check_before(context, stages, stage);
    do_stage(context, work);
  });
}

std::string dry_run(RunContext& context) {
  std::string text;
  const auto say = [&](Stage stage, const std::string& what) {
    text += fmt::format("{:<7} {}\n", stage_name(stage), what);
  };
  check_directories(context.config);
  check_claim(context);
  Stages stages(context);
  check_budget(context, stages.jobs());
  warn_of_large_tiles(context);
  std::optional<Stage> waits_for;
  for (const Stage stage : stages_of(context.config)) {
    if (waits_for) {
      say(stage, fmt::format("would run: waits for {}", stage_name(*waits_for)));
      continue;
    }
    check_before(context, stages, stage);
    StageWork& work = stages.open(stage);
    if (stage == Stage::build) warn_of_idle_edits(stages);
    StageLook look = work.look(context.selection);
    work.prove(context, look);
    check_work(context, work, look);
    if (look.current()) {
      say(stage, work.current_text());
      continue;
    }
    const bool units = !look.missing.empty();
    say(stage, would_run(work, look, units ? changed_since_last(context.config, stage) : ""));
    waits_for = stage;
  }
  return text;
}

}  // namespace voxweld
