// voxweld: the command line. Exit codes: 0 done, 1 a failure under way, 2 the user's to mend.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <new>

#include "pipeline/cli/commands.h"
#include "pipeline/executor/resources.h"
#include "storage/readers/open_volume.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr const char* description =
    "Out-of-core surface meshes from scanned volumes: crack-free, watertight, simplified, "
    "compressed.\n"
    "A config file says which volume, which surface, what to write; `voxweld init INPUT` writes "
    "one.";

constexpr const char* footer =
    "First steps:\n"
    "  voxweld init scan.nii.gz -o scan.toml\n"
    "  voxweld run scan.toml\n"
    "  voxweld verify scan.mesh\n"
    "Exit codes: 0 done, 1 a failure under way (run again to go on), 2 something to mend first.\n"
    "Volumes it reads: ";

int fail(const std::string& message, int code) {
  spdlog::error("{}", message);
  return code;
}

int guarded(Program& program) {
  try {
    const InterruptScope scope(program.interrupt);
    return program.run();
  } catch (const Error& error) {
    return fail(error.what(), error.exit_code());
  } catch (const std::bad_alloc&) {
    return fail("out of memory; lower run.memory or run.threads so that voxweld asks for less", 1);
  } catch (const std::exception& error) {
    return fail(
        fmt::format(
            "internal error: {}. This is a bug: please report it with the command and config",
            error.what()),
        1);
  }
}

int run_main(int argc, char** argv) {
  Program program;
  program.console = Console::standard_error();
  CLI::App app{description, "voxweld"};
  app.footer(footer + reader_names());
  app.set_version_flag("--version", "voxweld " VOXWELD_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  std::string level = "info";
  app.add_option("--log-level", level, "What to say on standard error: quiet, warning, info, debug")
      ->check(CLI::IsMember({"quiet", "warning", "info", "debug"}))
      ->capture_default_str();
  add_run_commands(app, program);
  add_cluster_commands(app, program);
  add_edit_command(app, program);
  add_init_command(app, program);
  add_info_command(app, program);
  add_verify_command(app, program);
  add_render_command(app, program);
  add_export_command(app, program);
  add_phantom_command(app, program);
  add_settings_command(app, program);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  program.log_level = parse_log_level(level).value();
  set_up_logging(program.log_level, program.console);
  return guarded(program);
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  voxweld::tune_allocator(2);
  return voxweld::run_main(argc, argv);
} catch (const std::exception& error) {  // before there is a log to say it in
  std::fputs(error.what(), stderr);
  return 1;
}
