// plan, submit, status, cancel, logs: a config's work on a Slurm cluster.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/run_context.h"
#include "pipeline/slurm/slurm_chain.h"
#include "pipeline/slurm/slurm_status.h"
#include "pipeline/slurm/work_plan.h"
#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

struct ClusterArguments {
  RunArguments run;
  bool watch = false;
  bool json = false;
  std::optional<std::uint64_t> unit;
};

SlurmClient make_client(const Program& program) {
  SlurmClientOptions options;
  options.interrupt = &program.interrupt;
  return SlurmClient(options);
}

// These are of work on a cluster, whatever run.executor says of `voxweld run`.
RunContext cluster_context(Program& program, const RunArguments& arguments, Executor& executor) {
  RunArguments all = arguments;
  all.overrides.push_back("run.executor=slurm");
  return make_context(program, all, executor);
}

int submit(Program& program, const ClusterArguments& arguments) {
  LocalExecutor here;
  RunContext context = cluster_context(program, arguments.run, here);
  SlurmClient client = make_client(program);
  const SlurmSetup setup = set_up_slurm(context.config, client);
  const std::vector<SubmittedStep> steps = submit_chain(context, setup, client);
  if (arguments.json) {
    nlohmann::json out = nlohmann::json::array();
    for (const SubmittedStep& step : steps)
      out.push_back({{"step", step.name},
                     {"job", step.job},
                     {"tasks", step.tasks},
                     {"folder", step.folder.string()}});
    fmt::print("{}\n", json_text(out, 2));
    return 0;
  }
  for (const SubmittedStep& step : steps)
    fmt::print("job {:<8} {:<12} {:>6} {}  {}\n", step.job, step.name, step.tasks,
               step.tasks == 1 ? "task " : "tasks", step.folder.string());
  return 0;
}

// Of a run on the cluster, or, where nothing was ever sent there, of the config's own executor.
RunContext status_context(Program& program, const RunArguments& arguments, Executor& executor) {
  RunContext context = make_context(program, arguments, executor);
  if (known_arrays(context.config).empty()) return context;
  return cluster_context(program, arguments, executor);
}

int show_status(Program& program, const ClusterArguments& arguments) {
  const std::vector<RunArguments> surfaces = each_surface(arguments.run);
  if (surfaces.size() > 1) {
    int code = 0;
    for (const RunArguments& surface : surfaces) {
      ClusterArguments one = arguments;
      one.run = surface;
      if (!one.json) fmt::print("isovalue {}:\n", surface.isovalue);
      code = std::max(code, show_status(program, one));
    }
    return code;
  }
  LocalExecutor here;
  SlurmClient client = make_client(program);
  for (;;) {
    RunContext context = status_context(program, surfaces.front(), here);
    const RunStatus status = run_status(context, client);
    if (arguments.json)
      fmt::print("{}\n", json_text(to_json(status), 2));
    else
      fmt::print("{}", to_text(status));
    std::fflush(stdout);
    if (!arguments.watch || status.finished || !status.queued()) return status.finished ? 0 : 1;
    fmt::print("\n");
    for (int i = 0; i < 100; ++i) {  // ten seconds
      program.interrupt.check();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
}

int cancel(Program& program, const ClusterArguments& arguments) {
  LocalExecutor here;
  const RunContext context = cluster_context(program, arguments.run, here);
  SlurmClient client = make_client(program);
  std::vector<std::int64_t> jobs;
  for (const QueuedTasks& queued : queued_tasks(known_arrays(context.config), client))
    if (queued.alive()) jobs.push_back(queued.array.job);
  if (!jobs.empty()) client.cancel(jobs);
  fmt::print("{} {} cancelled; what is finished is kept\n", jobs.size(),
             jobs.size() == 1 ? "job" : "jobs");
  return 0;
}

int show_plan(Program& program, const ClusterArguments& arguments) {
  LocalExecutor here;
  const RunContext context = cluster_context(program, arguments.run, here);
  const Jobs jobs(context.config, context.interrupt);
  std::int64_t slots = 1;
  try {
    slots = cluster_cpus(context.config.slurm.partition) / context.config.slurm.cpus_per_task;
  } catch (const Error&) {  // a plan can be made where there is no cluster
  }
  const WorkPlan plan = plan_work(context, jobs, std::max<std::int64_t>(slots, 1));
  fmt::print("{}", arguments.json ? json_text(to_json(plan), 2) + "\n" : to_text(plan));
  return 0;
}

int show_logs(Program& program, const ClusterArguments& arguments) {
  LocalExecutor here;
  RunContext context = cluster_context(program, arguments.run, here);
  RunStatus status;
  if (!arguments.unit) status.failed = failed_tasks(context.config);
  const std::string text = task_logs(context.config, status, arguments.unit);
  if (text.empty())
    throw InputError(arguments.unit
                         ? fmt::format("no task has had number {} yet", *arguments.unit)
                         : std::string("no task has failed; name a shard or tile by its number"));
  fmt::print("{}", text);
  return 0;
}

using Command = int (*)(Program&, const ClusterArguments&);

struct Added {
  CLI::App& command;
  ClusterArguments& arguments;  // live as long as the command
};

Added add(CLI::App& app, Program& program, const char* name, const char* help, Command run) {
  auto arguments = std::make_shared<ClusterArguments>();
  CLI::App* command = app.add_subcommand(name, help)->group("On a Slurm cluster");
  add_config_options(*command, arguments->run);
  when_chosen(*command, program, [&program, arguments, run] { return run(program, *arguments); });
  return {*command, *arguments};
}

}  // namespace

void add_cluster_commands(CLI::App& app, Program& program) {
  const Added plan = add(app, program, "plan",
                         "Estimates tasks, files, disk and core-hours of the work\n"
                         "Beside each estimate stands what the tasks have used so far.",
                         show_plan);
  plan.command.add_flag("--json", plan.arguments.json, "Prints it as JSON");
  const Added submits = add(app, program, "submit",
                            "Hands the whole work to Slurm and returns\n"
                            "It becomes jobs that wait for each other; `voxweld status` says how "
                            "far they are. [slurm] in the config says what to ask for.",
                            submit);
  add_examples(submits.command, {{"voxweld submit scan.toml --set slurm.partition=compute", ""},
                                 {"voxweld status scan.toml --watch", "until it is done"}});
  submits.command.add_flag("--json", submits.arguments.json, "Prints the jobs as JSON");
  const Added status = add(app, program, "status",
                           "Says how far the work is and what is in Slurm's queue\n"
                           "Exits with 1 until all of it is done.",
                           show_status);
  status.command.add_flag(
      "--watch", status.arguments.watch,
      "Says it every ten seconds, until all is done or nothing is in the queue");
  status.command.add_flag("--json", status.arguments.json, "Prints it as JSON");
  add(app, program, "cancel", "Takes the jobs from Slurm's queue; finished work is kept", cancel);
  const Added logs = add(app, program, "logs",
                         "Prints the logs of failed tasks, or of one shard or tile", show_logs);
  logs.command.add_option("number", logs.arguments.unit,
                          "A shard or tile: the logs of all tasks that had it");
}

}  // namespace voxweld
