// report: a page for people about what a run has made.
#include <fmt/format.h>

#include <filesystem>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/output_file.h"
#include "pipeline/executor/memory_budget.h"
#include "pipeline/executor/prompt_stop.h"
#include "pipeline/report/report.h"
#include "storage/manifest/manifest.h"
#include "storage/manifest/report_file.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::string directory;
  OutputFile output;
};

// A report of ours may be written over, as a run does; other files only where that is asked for.
void check_report_file(const fs::path& file, const ReportArguments& arguments) {
  check_ending(file, std::vector<std::string>{".html", ".htm"}, "a report");
  check_free(file, arguments.output.force || is_report(file));
}

int report(const ReportArguments& arguments, const Program& program) {
  const fs::path directory = arguments.directory;
  require_output(directory);
  const fs::path file =
      arguments.output.path.empty() ? directory / report_name : fs::path(arguments.output.path);
  check_report_file(file, arguments);
  std::string text;
  {
    const PromptStop prompt(program.interrupt);
    text = report_text({.directory = directory, .file = file, .interrupt = &program.interrupt});
  }
  program.interrupt.check();
  write_whole_file(file, as_bytes(text), Durability::rename_only);
  fmt::print("{}: {}\n", file.string(), readable_bytes(static_cast<double>(text.size())));
  return 0;
}

}  // namespace

void add_report_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* command = app.add_subcommand(
      "report",
      "Writes a page about a finished run, as HTML\n"
      "Pictures of the mesh from three sides, slices of the volume with the contour of the "
      "isovalue, its histogram, the figures of the run and its config, in one file that a browser "
      "shows from disk. A run writes it by itself unless output.report is false. Where the volume "
      "is gone or has changed, slices and histogram are left out.");
  add_examples(*command, {{"voxweld report scan.mesh", "writes scan.mesh/report.html"},
                          {"voxweld report scan.mesh -o scan.html", ""}});
  add_file(*command, "directory", arguments->directory, "The output directory of a finished run");
  command
      ->add_option("-o,--output", arguments->output.path,
                   "The file to write (default: report.html in the directory)")
      ->type_name("FILE");
  command->add_flag("--force", arguments->output.force,
                    "Writes over a file that is there and is no report");
  when_chosen(*command, program, [&program, arguments] { return report(*arguments, program); });
}

}  // namespace voxweld
