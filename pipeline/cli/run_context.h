// What the commands that work on a config have in common.
#pragma once

#include "pipeline/cli/commands.h"
#include "pipeline/stage/context.h"

namespace voxweld {

struct RunArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string isovalue;  // of a config with a list of them, the one to work on; empty: all
  bool dry_run = false;
  bool json = false;
  bool force = false;
  std::string units;            // of one stage: a list
  std::string part;             // or a share, "K/N"
  std::string report;           // where to leave a task's report
  bool inputs_checked = false;  // of one stage: whoever started it looked at what it needs
};

void add_config_options(CLI::App& command, RunArguments& arguments);

// The config read and checked; program and executor live as long as the context. InputError where
// it has a list of isovalues, and arguments.isovalue is none of them.
RunContext make_context(Program& program, const RunArguments& arguments, Executor& executor);

// The arguments of each surface that they ask for: one, or, of a list of isovalues, as many.
std::vector<RunArguments> each_surface(const RunArguments& arguments);

// What is missing of all stages, on the executor the config names instead of the context's.
void run_where_asked(Program& program, RunContext& context);
// The last lines of a run: what there is now and where.
void print_summary(const RunContext& context, bool json);

}  // namespace voxweld
