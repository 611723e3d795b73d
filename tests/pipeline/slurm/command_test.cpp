#include "pipeline/slurm/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "storage/support/error.h"

namespace voxweld {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using Words = std::vector<std::string>;

CommandResult shell(const std::string& script, const CommandOptions& options = {}) {
  return run_command(Words{"sh", "-c", script}, options);
}

TEST(Command, KeepsOutputsApart) {
  const CommandResult result = shell("echo to out; echo to err >&2; exit 7");
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_EQ(result.out, "to out\n");
  EXPECT_EQ(result.err, "to err\n");
  EXPECT_FALSE(result.timed_out);
}

TEST(Command, TakesWordsAsTheyAre) {
  const CommandResult result =
      run_command(Words{"printf", "[%s]", "a b", "$HOME", "it's", "", "*"});
  EXPECT_EQ(result.out, "[a b][$HOME][it's][][*]");
}

TEST(Command, GivesInputAndElseNothing) {
  std::string much(1 << 20, 'x');
  EXPECT_EQ(run_command(Words{"cat"}, {.input = much}).out, much);
  EXPECT_EQ(run_command(Words{"cat"}).out, "");
  // Input that nobody reads is no trouble.
  EXPECT_EQ(run_command(Words{"true"}, {.input = much}).exit_code, 0);
}

TEST(Command, ReadsMuchOfBoth) {
  const CommandResult result =
      shell("head -c 3000000 /dev/zero; head -c 2000000 /dev/zero >&2; head -c 1 /dev/zero");
  EXPECT_EQ(result.out.size(), 3000001U);
  EXPECT_EQ(result.err.size(), 2000000U);
}

TEST(Command, IsKilledWithItsChildrenWhenTheTimeIsUp) {
  const auto begin = steady_clock::now();
  const CommandResult result =
      shell("echo before; sleep 60 & sleep 60; echo after", {.time_limit = milliseconds(200)});
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.out, "before\n");
  EXPECT_EQ(result.exit_code, 128 + SIGKILL);
  EXPECT_LT(steady_clock::now() - begin, std::chrono::seconds(10));
  // One that has closed its outputs is waited for no longer.
  EXPECT_TRUE(shell("exec >&- 2>&-; sleep 60", {.time_limit = milliseconds(200)}).timed_out);
}

TEST(Command, TellsSignals) {
  EXPECT_EQ(shell("kill -TERM $$").exit_code, 128 + SIGTERM);
}

TEST(Command, HidesVariables) {
  setenv("VOXWELD_TEST_HIDDEN", "1", 1);
  setenv("VOXWELD_TEST_SHOWN", "2", 1);
  const CommandResult result = shell("echo \"${VOXWELD_TEST_HIDDEN-none} $VOXWELD_TEST_SHOWN\"",
                                     {.hidden_variables = {"VOXWELD_TEST_HID"}});
  EXPECT_EQ(result.out, "none 2\n");
}

// Ctrl-C reaches the whole group of a terminal: it shall end us in our own time, not a program half
// way through.
TEST(Command, HasAGroupOfItsOwnAndOrdinarySignals) {
  EXPECT_EQ(shell("[ $(cut -d' ' -f5 /proc/$$/stat) = $$ ] && echo own").out, "own\n");
  const auto before = std::signal(SIGTERM, SIG_IGN);
  EXPECT_EQ(shell("kill -TERM $$; echo ignored").out, "");
  std::signal(SIGTERM, before);
}

TEST(Command, NamesWhatCannotBeStarted) {
  try {
    run_command(Words{"no-such-program-here", "x"});
    FAIL();
  } catch (const StorageError& error) {
    EXPECT_EQ(error.error_number(), ENOENT);
    EXPECT_THAT(error.what(), ::testing::StartsWith("cannot run no-such-program-here: "));
  }
}

}  // namespace
}  // namespace voxweld
