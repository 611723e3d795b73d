#include <fmt/format.h>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/run_context.h"
#include "pipeline/run/clean.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

struct CleanArguments {
  std::vector<std::string> configs, overrides;
  CleanOptions options;
};

// What is said of a work directory.
std::string text_of(const CleanReport& report, const CleanOptions& options) {
  std::string text;
  for (const CleanedPath& one : report.removed)
    text += fmt::format("{} {}  {}\n", options.dry_run ? "would remove" : "removed",
                        one.path.string(), readable_bytes(static_cast<double>(one.bytes)));
  for (const std::filesystem::path& config : report.unknown)
    text += fmt::format(
        "{}: its input is not ingested as it is now, so it is not known which work of later stages "
        "it would use; all of that stays\n",
        config.string());
  text += fmt::format("{}: {} {}, {} {}", report.directory.string(),
                      readable_bytes(static_cast<double>(report.bytes())),
                      options.dry_run ? "would be freed" : "freed", counted(report.kept, "folders"),
                      report.kept == 1 ? "stays" : "stay");
  if (!report.removed.empty()) text += "; work there of configs that are not named goes too";
  return text + "\n";
}

int clean_configs(Program& program, const CleanArguments& arguments) {
  LocalExecutor executor;
  std::vector<std::unique_ptr<RunContext>> contexts;
  for (const std::string& config : arguments.configs) {
    RunArguments run;
    run.config = config;
    run.overrides = arguments.overrides;
    for (const RunArguments& surface : each_surface(run))
      contexts.push_back(std::make_unique<RunContext>(make_context(program, surface, executor)));
  }
  for (const CleanReport& report : clean(contexts, arguments.options))
    fmt::print("{}", text_of(report, arguments.options));
  return 0;
}

}  // namespace

void add_clean_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<CleanArguments>();
  CLI::App* command = app.add_subcommand(
      "clean",
      "Removes work that no run of a config would use any more\n"
      "Every change of a config leaves the work of the earlier one in work.directory, so that it "
      "can be gone back to. This removes all of it that a run of the config as it is now would not "
      "use. Meshes stay as they are. Where several configs share a work directory, name all of "
      "them: the work of those that are not named goes too.");
  add_examples(*command,
               {{"voxweld clean scan.toml --dry-run", "says what would go, and how much it is"},
                {"voxweld clean a.toml b.toml", "keeps what either of the two uses"}});
  command->add_option("config", arguments->configs, "The config files (TOML)")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--set", arguments->overrides,
                   "Gives a key of the configs another value, as `voxweld run` takes it. May be "
                   "given again")
      ->type_name("KEY=VALUE")
      ->take_all();
  command->add_flag("--all", arguments->options.all, "Removes all work, also what the configs use");
  command->add_flag("--dry-run", arguments->options.dry_run,
                    "Says what would be removed, and removes nothing");
  when_chosen(*command, program,
              [&program, arguments] { return clean_configs(program, *arguments); });
}

}  // namespace voxweld
