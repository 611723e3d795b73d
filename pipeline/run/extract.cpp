#include "pipeline/run/extract.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipeline/run/run.h"
#include "pipeline/run/stages.h"
#include "pipeline/stage/file_layout.h"
#include "storage/support/directory_lock.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

void check_config(const RunContext& context) {
  const Config& config = context.config;
  if (!collapses_by_sheets(config))
    throw InputError(fmt::format(
        "{}: octrees keep their levels where simplify.enabled = true, simplify.topology = "
        "\"manifold\" and labels.mode is not \"shared\"; of this config a run makes the mesh: "
        "`voxweld run CONFIG --set simplify.tolerance={}`",
        context.config_file.string(), config.simplify.tolerance));
  if (config.simplify.tolerance < context.extraction->tolerance)
    throw InputError(fmt::format(
        "--tolerance {}: {} has simplify.tolerance = {}, and its octrees keep what is at least as "
        "coarse; give {} or more, or run it with a smaller simplify.tolerance",
        config.simplify.tolerance, context.config_file.string(), context.extraction->tolerance,
        context.extraction->tolerance));
}

// All that the cuts are made of.
void check_octrees(const RunContext& context) {
  RunContext finer = context;
  finer.config.simplify.tolerance = context.extraction->tolerance;
  finer.extraction.reset();
  Stages stages(finer);
  for (const Stage stage : {Stage::ingest, Stage::build}) {
    StageWork& work = stages.open(stage);
    StageLook look = work.look({});
    work.prove(finer, look);
    if (look.current()) continue;
    throw InputError(fmt::format(
        "{}: what stage {} makes of it with simplify.tolerance = {} is missing or out of date "
        "({}); run `voxweld run CONFIG` first",
        context.config_file.string(), stage_name(stage), context.extraction->tolerance,
        work.missing_text(look)));
  }
}

std::set<fs::path> stage_folders(const fs::path& work) {
  std::set<fs::path> folders;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(work, missing))
    if (entry.is_directory() && stage_of_folder(entry.path())) folders.insert(entry.path());
  return folders;
}

}  // namespace

void extract_all(RunContext& context) {
  check_config(context);
  check_octrees(context);
  const fs::path work = context.config.work.directory;
  const std::set<fs::path> before = stage_folders(work);
  run_all(context);
  std::set<fs::path> made;
  for (const fs::path& folder : stage_folders(work))
    if (!before.contains(folder)) made.insert(folder);
  // A run of the larger tolerance may have begun to use them.
  if (std::ranges::any_of(made,
                          [](const fs::path& folder) { return lock_holder(folder).has_value(); }))
    return;
  for (const fs::path& folder : made) fs::remove_all(folder);
}

}  // namespace voxweld
