#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/run_context.h"
#include "pipeline/run/report_task.h"
#include "pipeline/run/run.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {
namespace {

// The units a task is to do, and where it says how it went.
void add_task_options(CLI::App& command, RunArguments& arguments, Stage stage) {
  if (stage == Stage::merge) return;
  const std::string units = unit_option(stage);
  auto* list = command.add_option(
      "--" + units, arguments.units,
      "Only these " + units + ", by number: 0-63,70. What they need must be there" +
          (stage == Stage::encode ? "; the merged mesh is the one after the last tile" : ""));
  list->type_name("LIST");
  command
      .add_option("--part", arguments.part,
                  "Only every N-th from the K-th on, K from 0. All N parts are the whole stage")
      ->type_name("K/N")
      ->excludes(list);
}

void add_force(CLI::App& command, RunArguments& arguments) {
  command.add_flag("--force", arguments.force,
                   "Writes into output.directory even where it holds the meshes of another config "
                   "or files that voxweld did not write");
}

UnitSelection selection_of(const RunArguments& arguments, Stage stage) {
  if (!arguments.units.empty())
    return UnitSelection::list(arguments.units, std::string("--") + unit_option(stage));
  return arguments.part.empty() ? UnitSelection() : UnitSelection::part(arguments.part);
}

// In a folder the tasks of a job array find names of their own.
std::filesystem::path report_path(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  const char* task = std::getenv("SLURM_ARRAY_TASK_ID");
  return path / fmt::format("{}.json", task != nullptr ? task : "task");
}

int run_stage_command(Program& program, const RunArguments& arguments, Stage stage) {
  LocalExecutor executor;
  RunContext context = make_context(program, arguments, executor);
  context.selection = selection_of(arguments, stage);
  context.inputs_checked = arguments.inputs_checked;
  const auto report = [&](const std::exception* error) {
    if (!arguments.report.empty())
      write_task_report(report_path(arguments.report),
                        task_report(context, std::string(stage_name(stage)), error));
  };
  try {
    run_one(context, stage);
  } catch (const std::exception& error) {
    report(&error);
    throw;
  }
  report(nullptr);
  if (stage == Stage::encode && context.selection.all()) print_summary(context, false);
  return 0;
}

void run_surface(Program& program, const RunArguments& arguments, bool one_of_several) {
  LocalExecutor here;
  RunContext context = make_context(program, arguments, here);
  if (arguments.dry_run) {
    if (one_of_several) fmt::print("isovalue {}:\n", arguments.isovalue);
    fmt::print("{}", dry_run(context));
    return;
  }
  if (one_of_several) spdlog::info("isovalue {}", arguments.isovalue);
  run_where_asked(program, context);
  print_summary(context, arguments.json);
  std::fflush(stdout);  // the next one may take hours
}

}  // namespace

void add_run_command(CLI::App& app, Program& program) {
  CLI::App* run = app.add_subcommand(
      "run",
      "Makes the meshes a config asks for\n"
      "Does what is missing of all stages and nothing twice: an interrupted run goes on where "
      "it stopped, and after a change of the config only what depends on it is made again.");
  add_examples(*run, {{"voxweld run scan.toml",
                       "the meshes go into scan.mesh, intermediate files into scan.work"},
                      {"voxweld run scan.toml --set surface.isovalue=300 --set run.memory=8GiB",
                       "with other values than the file has"},
                      {"voxweld run scan.toml --dry-run", "says what would be done, and why"}});
  auto arguments = std::make_shared<RunArguments>();
  add_config_options(*run, *arguments);
  add_force(*run, *arguments);
  run->add_flag("--dry-run", arguments->dry_run, "Says what would run and why, and runs nothing");
  run->add_flag("--json", arguments->json, "Prints the manifest on standard output at the end");
  when_chosen(*run, program, [&program, arguments] {
    const std::vector<RunArguments> surfaces = each_surface(*arguments);
    const bool several = surfaces.size() > 1;
    if (several && arguments->json) fmt::print("[");
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      if (several && arguments->json && i > 0) fmt::print(",");
      run_surface(program, surfaces[i], several);
    }
    if (several && arguments->json) fmt::print("]\n");
    return 0;
  });
}

void add_stage_commands(CLI::App& app, Program& program) {
  static constexpr std::array<const char*, all_stages.size()> help = {
      "Stage 1: copies the input into a brick store, where needed\n"
      "Volumes that can be read a box at a time stay where they are. A mesh too large for "
      "run.memory is cut into pieces, one for each brick.",
      "Stage 2: makes a simplified octree of each brick",
      "Stage 3: joins the bricks' octrees at the top and plans the tiles",
      "Stage 4: makes the triangles of each tile",
      "With simplify.triangles or ratio, after stage 4: counts what collapse would leave",
      "After stage 4, unless simplify.refine is off: repairs and collapses inside cubes of 64 "
      "cells\n"
      "With \"repair\" it only finds what intersects.",
      "With simplify.triangles or ratio: counts anew in shifted cubes what the rest would leave",
      "Unless simplify.refine is off: the same in shifted cubes, where the first had their "
      "borders\n"
      "With \"repair\" it mends what intersects, in boxes around it.",
      "Unless simplify.refine is off: mends what still intersects, mostly where both had their "
      "borders",
      "Unless simplify.refine is off: mends what mend left, mostly at the borders of its boxes",
      "Unless simplify.refine is off: plans tiles of the refined mesh and cuts it into them",
      "Unless output.levels is 1: makes the coarser levels of detail",
      "Stage 5: writes the compressed mesh files and the manifest"};
  for (const Stage stage : all_stages) {
    auto one = std::make_shared<RunArguments>();
    CLI::App* command =
        app.add_subcommand(std::string(stage_name(stage)), help[static_cast<std::size_t>(stage)])
            ->group("One stage at a time (`run` does all of them)");
    add_config_options(*command, *one);
    add_task_options(*command, *one, stage);
    if (stage == Stage::encode) add_force(*command, *one);
    command
        ->add_option("--report", one->report,
                     "Writes time, memory and errors to this file, as JSON. In a folder the file "
                     "is named after the task's number in its Slurm array")
        ->type_name("FILE");
    command->add_flag("--inputs-checked", one->inputs_checked,
                      "Does not check that what the stage needs is complete: for one task among "
                      "thousands, where it was checked before");
    when_chosen(*command, program,
                [&program, one, stage] { return run_stage_command(program, *one, stage); });
  }
}

}  // namespace voxweld
