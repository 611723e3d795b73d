// What the log of a task that did not report says.
#include "pipeline/slurm/task_log.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

std::string of_log(const std::string& text) {
  const testing::TempDirectory directory;
  std::ofstream(directory / "1_0.log") << text;
  return last_words(directory / "1_0.log");
}

TEST(TaskLog, TakesTheLastErrorElseTheLastLine) {
  const std::string first = "2026-01-02 03:04:05 task 3 on node1: --shards 0-7\n";
  EXPECT_EQ(of_log(""), "");
  EXPECT_EQ(of_log(first + "\n"), "");
  EXPECT_EQ(of_log(first + "build: 2 shards\n"), "build: 2 shards");
  EXPECT_EQ(of_log(first + "slurmstepd: error: no\nslurmstepd: Error: Killed\nbuild: 2\n"),
            "slurmstepd: Error: Killed");
  EXPECT_EQ(of_log("a\x1b[2Jb"), "a [2Jb");
  EXPECT_LT(of_log(std::string(9000, 'x')).size(), 400U);
}

// As bash 5.2 and Slurm 22.05 say it of a task whose program and folder its node does not have.
TEST(TaskLog, SaysThatTheProgramIsMissing) {
  const std::string chdir =
      "slurmstepd-node1: error: couldn't chdir to `/tmp/x': No such file or directory: going to "
      "/tmp instead\n";
  const std::string first = "2026-01-02 03:04:05 task 0 on node1: --shards 0-7\n";
  const std::string missing =
      "job00011/slurm_script: line 31: /opt/voxweld: No such file or directory";
  EXPECT_EQ(of_log(chdir + chdir + first + missing + "\n"), missing);
  const std::string denied = "slurm_script: line 31: /opt/voxweld: Permission denied";
  EXPECT_EQ(of_log(chdir + first + denied + "\n"), denied);
  const std::string folder = "slurm_script: line 31: exec: /opt: cannot execute: Is a directory";
  EXPECT_EQ(of_log(chdir + first + "slurm_script: line 31: /opt: Is a directory\n" + folder + "\n"),
            folder);
  EXPECT_EQ(of_log(chdir + first + "build: 2 shards\n"), "build: 2 shards");
  EXPECT_EQ(of_log(chdir), "");
}

TEST(TaskLog, SaysNothingWithoutALog) {
  const testing::TempDirectory directory;
  EXPECT_EQ(last_words(directory / "none"), "");
  EXPECT_EQ(last_words(directory.path()), "");
}

TEST(TaskLog, KnowsWantOfMemory) {
  for (const char* words :
       {"slurmstepd: error: Exceeded job memory limit", "slurmstepd: error: Detected 1 oom-kill",
        "StepId=2.batch exceeded memory limit (9 > 8), being killed", "Out Of Memory",
        "error: out of memory"})
    EXPECT_TRUE(is_of_memory(words)) << words;
  EXPECT_FALSE(is_of_memory("encode: 2 meshes"));
}

}  // namespace
}  // namespace voxweld
