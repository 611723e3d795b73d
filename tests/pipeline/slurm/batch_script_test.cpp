#include "pipeline/slurm/batch_script.h"

#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/slurm/command.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using Words = std::vector<std::string>;

BatchScript example() {
  Config config;
  config.slurm.partition = "long,short";
  config.slurm.account = "imaging";
  config.slurm.max_running = 50;
  config.slurm.extra = {"-C avx2", "--comment=\"a b\""};
  config.slurm.prologue = {"module load gcc/12  ", "export TMPDIR=/scratch"};
  BatchScript script = batch_script(config);
  script.name = "voxweld-build";
  script.log = log_pattern("/data/50% \"head\"/logs", true);
  script.array = {.count = 120, .max_running = 50};
  script.dependency = "afterok:12:13";
  script.body = array_body("/data/it's/tasks.txt", Words{"/opt/vox weld", "work", "--quiet"});
  return script;
}

TEST(BatchScript, IsReadable) {
  EXPECT_EQ(render(example()), R"sh(#!/bin/bash
#SBATCH --job-name=voxweld-build
#SBATCH --output="/data/50%% \"head\"/logs/%A_%a.log"
#SBATCH --open-mode=append
#SBATCH --array=0-119%50
#SBATCH --dependency=afterok:12:13
#SBATCH --kill-on-invalid-dep=yes
#SBATCH --partition=long,short
#SBATCH --account=imaging
#SBATCH --time=4:00:00
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --mem=4342M
#SBATCH --requeue
#SBATCH -C avx2
#SBATCH --comment="a b"

module load gcc/12
export TMPDIR=/scratch

set -eu
# Task N of the array takes line N + 1 of the list.
tasks='/data/it'\''s/tasks.txt'
line=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" "$tasks")
if [ -z "$line" ]; then
  echo "$tasks has no line $((SLURM_ARRAY_TASK_ID + 1))" >&2
  exit 2
fi
echo "$(date '+%F %T') task $SLURM_ARRAY_TASK_ID on $(hostname): $line"
read -r -a arguments <<<"$line"
exec '/opt/vox weld' work --quiet "${arguments[@]}"
)sh");
}

TEST(BatchScript, SaysLittleWhereThereIsLittleToSay) {
  BatchScript script;
  script.name = "x";
  script.log = log_pattern("/logs", false);
  script.memory = (std::uint64_t{100} << 20) + 1;
  script.requeue = false;
  script.body = {"true"};
  EXPECT_EQ(render(script), R"(#!/bin/bash
#SBATCH --job-name=x
#SBATCH --output=/logs/%j.log
#SBATCH --open-mode=append
#SBATCH --kill-on-invalid-dep=yes
#SBATCH --time=4:00:00
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --mem=101M
#SBATCH --no-requeue

set -eu
true
)");
  script.array = {.count = 1};
  EXPECT_NE(render(script).find("#SBATCH --array=0-0\n"), std::string::npos);
}

CommandResult bash(const std::string& script, const std::string& options = "-s") {
  return run_command(Words{"bash", options}, {.input = script});
}

TEST(BatchScript, IsBash) {
  const CommandResult result = bash(render(example()), "-n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

// Task `index` of an array over a list of three lines, run as Slurm would.
CommandResult run_task(int index, const Words& prologue = {}) {
  const testing::TempDirectory directory;
  const auto list = directory / "the 'task' list";
  std::ofstream(list) << "build 1 2\nbuild * $HOME\nstitch 7\n";
  BatchScript script;
  script.name = "x";
  script.log = "/logs/x";
  script.prologue = prologue;
  script.body = array_body(list, Words{"printf", "<%s>", "it's"});
  return bash("SLURM_ARRAY_TASK_ID=" + std::to_string(index) + "\n" + render(script));
}

TEST(BatchScript, ATaskTakesItsLine) {
  const CommandResult result = run_task(0);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find(" task 0 on "), std::string::npos);
  EXPECT_TRUE(result.out.ends_with(": build 1 2\n<it's><build><1><2>")) << result.out;
  EXPECT_TRUE(run_task(1).out.ends_with("<it's><build><*><$HOME>"));
  EXPECT_TRUE(run_task(2).out.ends_with("<it's><stitch><7>"));
}

TEST(BatchScript, ATaskWithoutALineFails) {
  const CommandResult result = run_task(3);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.err.ends_with("the 'task' list has no line 4\n")) << result.err;
}

TEST(BatchScript, ThePrologueMayBeSloppy) {
  const CommandResult result = run_task(2, {"false", "echo \"$no_such_variable\""});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(BatchScript, WordsSurviveTheShell) {
  for (const std::string word : {"", "plain/path-1.0", "a b", "it's", "$HOME", "a\\b", "\"", "`id`",
                                 "*", "~", "a;b", "\xc3\xa9", "#x", "-n"}) {
    const CommandResult result = bash("printf '[%s]' " + shell_quote(word));
    EXPECT_EQ(result.out, "[" + word + "]");
  }
  EXPECT_EQ(shell_quote("/data/head-1.nrrd"), "/data/head-1.nrrd");
  EXPECT_EQ(shell_quote("it's"), "'it'\\''s'");
}

TEST(BatchScript, TasksHaveRoomBesidesTheProcess) {
  constexpr std::uint64_t gibibyte = std::uint64_t{1} << 30;
  Config config;
  config.run.memory = gibibyte;
  EXPECT_EQ(task_memory(config), gibibyte + (64U << 20));
  config.run.memory = 100 * gibibyte;
  EXPECT_EQ(task_memory(config), 106 * gibibyte);
  config.slurm.mem = 128 * gibibyte;
  EXPECT_EQ(task_memory(config), 128 * gibibyte);
}

}  // namespace
}  // namespace voxweld
