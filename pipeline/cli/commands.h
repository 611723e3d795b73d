// The commands of the program. Each adds itself to the CLI and leaves what is to be done in `run`;
// main calls it once everything is parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "pipeline/executor/console.h"
#include "pipeline/executor/interrupt.h"
#include "pipeline/executor/log.h"

namespace voxweld {

struct Program {
  LogLevel log_level = LogLevel::info;
  std::shared_ptr<Console> console;
  InterruptFlag interrupt;
  std::function<int()> run;  // of the chosen command; returns the exit code
};

// What main calls where the command is the one that was chosen.
template <class F>
void when_chosen(CLI::App& command, Program& program, F run) {
  command.callback([&program, run] { program.run = run; });
}

// A file that has to be named.
inline void add_file(CLI::App& command, const std::string& name, std::string& file,
                     const std::string& help) {
  command.add_option(name, file, help)->type_name("FILE")->required();
}

// An option whose help tells its default.
template <class T>
CLI::Option* add_value(CLI::App& command, const std::string& name, T& value,
                       const std::string& help) {
  return command.add_option(name, value, help)->capture_default_str();
}

void add_clean_command(CLI::App& app, Program& program);
void add_run_command(CLI::App& app, Program& program);
void add_stage_commands(CLI::App& app, Program& program);    // ingest, build, merge, stitch, encode
void add_cluster_commands(CLI::App& app, Program& program);  // plan, submit, status, cancel, logs
// completion, manual: for packages, not shown in the help.
void add_document_commands(CLI::App& app, Program& program);
void add_edit_command(CLI::App& app, Program& program);
void add_histogram_command(CLI::App& app, Program& program);
void add_info_command(CLI::App& app, Program& program);
void add_init_command(CLI::App& app, Program& program);
void add_verify_command(CLI::App& app, Program& program);
void add_render_command(CLI::App& app, Program& program);
void add_report_command(CLI::App& app, Program& program);
void add_view_command(CLI::App& app, Program& program);
void add_export_command(CLI::App& app, Program& program);
void add_extract_command(CLI::App& app, Program& program);
void add_phantom_command(CLI::App& app, Program& program);
void add_settings_command(CLI::App& app, Program& program);

}  // namespace voxweld
