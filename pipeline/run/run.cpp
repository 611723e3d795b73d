#include "pipeline/run/run.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <set>

#include "pipeline/build/build_stage.h"
#include "pipeline/encode/output_files.h"
#include "pipeline/executor/error_set.h"
#include "pipeline/ingest/label_rules.h"
#include "pipeline/merge/merge_stage.h"
#include "pipeline/run/jobs.h"
#include "pipeline/run/last_config.h"
#include "pipeline/stitch/stitch_stage.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

void check_surface(RunContext& context, const Jobs& jobs) {
  const MergeCounts counts = TopArtifact(jobs.merge().path()).counts();
  if (counts.crossing_edges != 0) return;
  if (const std::size_t edits = context.config.edits.size(); edits > 0)
    throw InputError(fmt::format(
        "no surface: after the {} of the config all samples are on one side; leave out or change "
        "some of the [[edit]] tables",
        edits == 1 ? "one edit" : fmt::format("{} edits", edits)));
  if (context.config.input.is_mesh())
    throw InputError(fmt::format(
        "{}: no surface: no sample lies inside the mesh; raise input.resolution or lower "
        "input.cell, which is {:g} now",
        context.config.input.path.string(), jobs.volume().geometry().spacing.x));
  const ValueRange range = whole_range(context, jobs.volume());
  if (context.config.labels.mode != LabelMode::off)
    throw InputError(fmt::format(
        "labels.mode: no surface: no sample of {} is of a label that is not left out; the values "
        "run from {} to {}",
        context.config.input.path.string(), range.lo, range.hi));
  if (const auto& label = context.config.surface.label)
    throw InputError(
        fmt::format("surface.label = {}: no sample of {} is of that value; they run from {} to {}",
                    *label, context.config.input.path.string(), range.lo, range.hi));
  throw InputError(fmt::format(
      "surface.isovalue = {}: no surface: no sample is {} it. The values of {} run from {} to {}; "
      "choose one "
      "between",
      context.config.surface.isovalue.value(),
      context.config.surface.inside == SurfaceConfig::Inside::above ? "at or above" : "at or below",
      context.config.input.path.string(), range.lo, range.hi));
}

// A directory that cannot be written is better found now than after hours of work. Nothing is made
// yet: where there is no surface nothing shall be left.
void check_writable(const std::filesystem::path& directory, const std::string& key) {
  std::filesystem::path there = directory;
  std::error_code error;
  while (!std::filesystem::exists(there, error) && there.has_relative_path())
    there = there.parent_path();
  const bool folder = std::filesystem::is_directory(there, error);
  if (folder && access(there.c_str(), W_OK | X_OK) == 0) return;
  throw InputError(fmt::format("{} = \"{}\": cannot be written: {}; choose another directory", key,
                               directory.string(),
                               folder ? fmt::format("{}: {}", there.string(), std::strerror(errno))
                                      : fmt::format("{} is not a directory", there.string())));
}

// Something of the input cannot be read, and that is the user's to mend. What the rest of it is
// enough for is built meanwhile: when it is mended only the remainder is left to do.
void ingest_or_build_the_rest(RunContext& context, Jobs& jobs) {
  try {
    run_ingest(context, jobs.ingest());
  } catch (const Error& error) {
    const IngestStatus status = ingest_status(context, jobs.ingest());
    if (error.exit_code() != 2 || status.missing == status.units ||
        !context.config.surface.isovalue.has_value() || asks_for_sizes(context.config.labels))
      throw;
    spdlog::warn("{} of {} shards of the input cannot be read; building what the others allow",
                 status.missing, status.units);
    jobs.open_volume(context.config);
    jobs.build_what_is_there();
    run_build(context, jobs.build());
    throw;
  }
}

// Of tasks that were killed on other hosts, and of those that do what another has done: the stages
// are complete, so nobody needs them.
void clear_temporaries_of_tasks(const Config& config, const Jobs& jobs) {
  for (const std::filesystem::path& folder :
       {jobs.ingest().folder, jobs.build().folder, jobs.merge().folder, jobs.stitch().folder,
        jobs.encode().folder, config.output.directory / "tiles",
        config.output.directory / "labels"})
    remove_needless_temporaries(folder, true);
  remove_needless_temporaries(config.output.directory, false);
}

// ingest -> build -> merge -> stitch -> encode
void run_stages(RunContext& context) {
  Jobs jobs(context.config, context.interrupt);
  check_budget(context, jobs);
  warn_of_large_tiles(context);
  ingest_or_build_the_rest(context, jobs);
  jobs.open_volume(context.config);
  run_build(context, jobs.build());
  run_merge(context, jobs.merge());
  check_surface(context, jobs);
  check_plan(context, jobs);
  run_stitch(context, jobs.stitch());
  run_encode(context, jobs.encode(), make_manifest(context, jobs));
  if (!context.executor->in_process()) clear_temporaries_of_tasks(context.config, jobs);
}

// Of runs that were killed. Only where we write: the directories may hold others' files too.
void clear_temporaries(const Config& config) {
  for (const std::filesystem::path& folder : {config.work.directory, config.output.directory})
    remove_stale_temporaries(folder, false);
  for (const char* folder : {"tiles", "labels"})
    remove_stale_temporaries(config.output.directory / folder, true);
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(config.work.directory, error))
    for (const Stage stage : all_stages)
      if (entry.path().filename().string().starts_with(std::string(stage_name(stage)) + "-"))
        remove_stale_temporaries(entry.path(), true);
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

bool build_is_current(RunContext& context, const BuildJob& job) {
  BuildStatus status = build_status(context, job);
  prove(context, job, status);
  return status.current();
}

}  // namespace

void run_all(RunContext& context) {
  const Config asked = context.config;
  std::set<std::string> mended;
  check_writable(asked.work.directory, "work.directory");
  check_writable(asked.output.directory, "output.directory");
  clear_temporaries(asked);
  for (bool done = false; !done;) {
    context.config = asked;
    context.reports.clear();
    write_last_config(asked);
    try {
      run_stages(context);
      done = true;
    } catch (const Error& error) {
      if (!is_only_damage(error)) throw;
      mend(error, mended);
    }
  }
}

void run_one(RunContext& context, Stage stage) {
  Jobs jobs(context.config, context.interrupt);
  check_budget(context, jobs);
  const auto need = [&](Stage before, const std::function<bool()>& there) {
    if (!context.inputs_checked && !there())
      throw InputError(
          fmt::format("stage {} needs what stage {} makes, and that is missing or out of date; run "
                      "`voxweld {} CONFIG` first, or `voxweld run CONFIG` for all",
                      stage_name(stage), stage_name(before), stage_name(before)));
  };
  if (stage == Stage::ingest) return run_ingest(context, jobs.ingest());
  if (context.selection.all())
    need(Stage::ingest, [&] { return ingest_status(context, jobs.ingest()).current(); });
  jobs.open_volume(context.config);
  if (stage == Stage::build) return run_build(context, jobs.build());
  // A task reads the few artifacts that its share needs, and those say whether they fit.
  const bool share = !context.selection.all();
  if (!share) need(Stage::build, [&] { return build_is_current(context, jobs.build()); });
  if (stage == Stage::merge) return run_merge(context, jobs.merge());
  need(Stage::merge,
       [&] { return share ? merge_is_there(jobs.merge()) : merge_is_current(jobs.merge()); });
  check_surface(context, jobs);
  check_plan(context, jobs);
  if (stage == Stage::stitch) return run_stitch(context, jobs.stitch());
  need(Stage::stitch, [&] {
    return missing_tiles(context, jobs.stitch(), TopArtifact(jobs.merge().path())).empty();
  });
  run_encode(context, jobs.encode(), make_manifest(context, jobs));
}

std::string dry_run(RunContext& context) {
  std::string text;
  const auto say = [&](Stage stage, const std::string& what) {
    text += fmt::format("{:<7} {}\n", stage_name(stage), what);
  };
  const auto later = [&](Stage from, const std::string& why) {
    for (const Stage stage : all_stages)
      if (stage >= from) say(stage, "would run: " + why);
  };
  const auto because = [&](Stage stage) {
    const std::string why = changed_since_last(context.config, stage);
    return why.empty() ? std::string() : " (" + why + ")";
  };
  Jobs jobs(context.config, context.interrupt);
  const IngestStatus ingest = ingest_status(context, jobs.ingest());
  if (!ingest.current()) {
    say(Stage::ingest, "would run: " + missing_text(jobs.ingest(), ingest) +
                           (ingest.missing > 0 ? because(Stage::ingest) : ""));
    later(Stage::build, "waits for ingest");
    return text;
  }
  say(Stage::ingest, jobs.ingest().copy || jobs.ingest().mesh
                         ? "up to date"
                         : "nothing to do: the input is read in place");
  jobs.open_volume(context.config);
  BuildStatus shards = build_status(context, jobs.build());
  prove(context, jobs.build(), shards);
  const std::size_t all = jobs.build().grid.all_shards().size();
  if (!shards.missing.empty()) {
    say(Stage::build, fmt::format("would run: {} of {} shards missing{}", shards.missing.size(),
                                  all, because(Stage::build)));
    later(Stage::merge, "waits for build");
    return text;
  }
  say(Stage::build, "up to date");
  if (!merge_is_current(jobs.merge())) {
    say(Stage::merge, "would run" + because(Stage::merge));
    later(Stage::stitch, "waits for merge");
    return text;
  }
  say(Stage::merge, "up to date");
  const TopArtifact top(jobs.merge().path());
  const std::uint64_t units = unit_plan(top, context.config.labels.mode)->size();
  const auto tiles = missing_tiles(context, jobs.stitch(), top);
  if (!tiles.empty()) {
    say(Stage::stitch, fmt::format("would run: {} of {} tiles missing{}", tiles.size(), units,
                                   because(Stage::stitch)));
    later(Stage::encode, "waits for stitch");
    return text;
  }
  say(Stage::stitch, "up to date");
  const EncodeStatus status = encode_status(context, jobs.encode(), top);
  if (status.missing.empty() && !status.merged_missing) {
    say(Stage::encode, output_is_finished(context.config.output.directory)
                           ? "up to date"
                           : "would run: the manifest or the list of tiles is missing");
  } else {
    say(Stage::encode,
        fmt::format("would run: {} of {} tiles{} missing{}", status.missing.size(), units,
                    status.merged_missing ? " and the merged mesh" : "", because(Stage::encode)));
  }
  return text;
}

}  // namespace voxweld
