// When a driver says that nothing can run: in time, and not all the time.
#include "pipeline/slurm/idle_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* drained =
    "Nodes required for job are DOWN, DRAINED or reserved for jobs in higher priority partitions";

TaskState pending(const std::string& reason) {
  TaskState task;
  task.reason = reason;
  return task;
}

TaskState running() {
  TaskState task;
  task.state = TaskState::running;
  return task;
}

std::string look(IdleWatch& watch, double now, const std::vector<TaskState>& tasks) {
  for (const TaskState& task : tasks) watch.see(task);
  return watch.end_look(now);
}

TEST(IdleWatch, SaysOnceAMinuteThatNodesAreOutOfUse) {
  IdleWatch watch;
  const std::vector<TaskState> tasks = {pending("Priority"), pending(drained)};
  std::vector<double> said;
  for (double now = 100; now < 250; now += 5) {
    const std::string words = look(watch, now, tasks);
    if (words.empty()) continue;
    said.push_back(now);
    EXPECT_THAT(words, StartsWith(std::string("2 tasks wait and none runs; Slurm says ") + drained +
                                  ": `sinfo -R` says"));
  }
  EXPECT_EQ(said, (std::vector<double>{110, 170, 230}));
}

TEST(IdleWatch, IsQuietWhileSomethingRunsOrWaitsItsTurn) {
  IdleWatch watch;
  for (double now = 0; now < 300; now += 5) {
    EXPECT_EQ(look(watch, now, {pending(drained), running()}), "");
    EXPECT_EQ(look(watch, now, {pending("Resources"), pending("Priority")}), "");
    EXPECT_EQ(look(watch, now, {}), "");
  }
}

TEST(IdleWatch, AnOutageThatComesAndGoesIsNoSpam) {
  IdleWatch watch;
  int said = 0;
  for (double now = 0; now < 240; now += 5) {
    const bool out = static_cast<int>(now) % 30 < 20;
    said += look(watch, now, {out ? pending("PartitionDown") : running()}).empty() ? 0 : 1;
  }
  EXPECT_EQ(said, 4);
}

TEST(IdleWatch, KnowsWhatConcernsNodes) {
  for (const char* reason : {drained, "ReqNodeNotAvail, UnavailableNodes:node[1-3]",
                             "PartitionDown", "PartitionInactive", "Reservation"}) {
    IdleWatch watch;
    look(watch, 0, {pending(reason)});
    EXPECT_THAT(look(watch, 20, {pending(reason)}), HasSubstr(reason));
  }
}

}  // namespace
}  // namespace voxweld
