// voxweld: the command line. Exit codes: 0 done, 1 a failure under way, 2 the user's to mend.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <new>
#include <system_error>

#include "pipeline/cli/commands.h"
#include "pipeline/cli/help_formatter.h"
#include "pipeline/cli/parse_error.h"
#include "pipeline/cli/standard_streams.h"
#include "pipeline/executor/resources.h"
#include "storage/readers/open_volume.h"
#include "storage/support/error.h"
#include "storage/support/refused_text.h"

namespace voxweld {
namespace {

constexpr const char* description =
    "Turns scanned volumes too large for memory into watertight, simplified meshes.\n"
    "A config file says which volume to read, which surface to extract and what to write. "
    "`voxweld init` writes one, `voxweld run` does what it says. Work that is done is kept: run "
    "again after a change or a failure, and only what is missing is made.";

constexpr const char* first_steps =
    "First steps:\n"
    "  voxweld init scan.nii.gz        writes scan.toml; look at its isovalue\n"
    "  voxweld run scan.toml           writes the meshes into scan.mesh\n"
    "  voxweld verify scan.mesh        checks that they are closed and complete\n"
    "  voxweld render scan.mesh -o scan.png\n"
    "\n"
    "`voxweld COMMAND --help` explains a command, `voxweld settings` every key of a\n"
    "config. Exit codes: 0 done; 1 a failure under way, run again to go on;\n"
    "2 something to mend first.\n"
    "Volumes it reads: ";

int fail(const std::string& message, int code) {
  spdlog::error("{}", message);
  return code;
}

int fail_by_bug(const std::exception& error) {
  return fail(
      fmt::format("internal error: {}. This is a bug: please report it with the command and config",
                  error.what()),
      1);
}

int guarded(Program& program) {
  try {
    const InterruptScope scope(program.interrupt);
    const int code = program.run();
    finish_standard_output();
    return code;
  } catch (const Error& error) {
    return fail(error.what(), error.exit_code());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(refused_text(error), 1);
  } catch (const std::system_error& error) {
    if (standard_output_failed())
      return fail(fmt::format("cannot write to standard output: {}", error.code().message()), 1);
    return fail_by_bug(error);
  } catch (const std::bad_alloc&) {
    return fail("out of memory; lower run.memory or run.threads so that voxweld asks for less", 1);
  } catch (const std::exception& error) {
    return fail_by_bug(error);
  }
}

// Help and the version.
int show(const CLI::App& app, const CLI::Success& shown) {
  const int code = app.exit(shown);
  try {
    finish_standard_output();
  } catch (const Error& error) {
    return fail(error.what(), error.exit_code());
  }
  return code;
}

void set_up(CLI::App& app, std::string& level) {
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "Shows this help");
  app.set_version_flag("--version", "voxweld " VOXWELD_VERSION, "Shows the version");
  app.require_subcommand(1);
  app.fallthrough();
  add_value(app, "--log-level", level, "What to say on standard error while a command works")
      ->check(CLI::IsMember({"quiet", "warning", "info", "debug"}));
}

// In the order in which one meets them.
void add_commands(CLI::App& app, Program& program) {
  add_init_command(app, program);
  add_run_command(app, program);
  add_verify_command(app, program);
  add_view_command(app, program);
  add_render_command(app, program);
  add_report_command(app, program);
  add_export_command(app, program);
  add_extract_command(app, program);
  add_info_command(app, program);
  add_histogram_command(app, program);
  add_edit_command(app, program);
  add_settings_command(app, program);
  add_clean_command(app, program);
  add_phantom_command(app, program);
  add_stage_commands(app, program);
  add_cluster_commands(app, program);
  add_document_commands(app, program);
}

int run_main(int argc, char** argv) {
  Program program;
  program.console = Console::standard_error();
  CLI::App app{description, "voxweld"};
  std::string level = "info";
  set_up(app, level);
  add_commands(app, program);
  app.footer(first_steps + reader_names());  // each command has its own
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& shown) {
    set_up_logging(program.log_level, program.console);
    return show(app, shown);
  } catch (const CLI::ParseError& error) {
    set_up_logging(program.log_level, program.console);
    return fail(parse_error_text(app, error), 2);
  }
  program.log_level = parse_log_level(level).value();
  set_up_logging(program.log_level, program.console);
  return guarded(program);
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  voxweld::hold_standard_streams();
  voxweld::tune_allocator(2);
  return voxweld::run_main(argc, argv);
} catch (const std::exception& error) {  // before there is a log to say it in
  std::fputs(error.what(), stderr);
  return 1;
}
