#include "pipeline/report/timeline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <vector>

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

TaskTime task(const std::string& stage, const std::string& node, double submitted, double began,
              double ended) {
  TaskTime time;
  time.stage = stage;
  time.node = node;
  time.submitted = submitted;
  time.began = began;
  time.ended = ended;
  return time;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Timeline, IsEmptyForALocalRun) {
  EXPECT_EQ(timeline({}).html, "");
}

// Eight seconds on two nodes with a place each; eight of the sixteen were worked.
TEST(Timeline, TellsWaitingFailuresAndRetriesOfACaseByHand) {
  std::vector<TaskTime> tasks = {task("build", "a", 100, 101, 105),
                                 task("build", "b", 100, 101, 103),
                                 task("build", "b", 105, 106, 108)};
  tasks[1].failed = true;
  tasks[2].again = true;
  const Timeline found = timeline(tasks);
  EXPECT_THAT(found.intro, HasSubstr("3 tasks on 2 nodes, 8.0 s from"));
  EXPECT_THAT(found.intro, HasSubstr("50 % of the time"));
  EXPECT_THAT(found.intro, HasSubstr("1 failed and 0 left no report"));
  EXPECT_THAT(found.intro, HasSubstr("1 task did what others had left undone"));
  // In 2000 columns: 1 s to 5 s, 6 s to 8 s, and the failure from 1 s to 3 s.
  EXPECT_THAT(found.html, HasSubstr("M250 0.1h1000v.8h-1000z"));
  EXPECT_THAT(found.html, HasSubstr("M1500 0.1h500v.8h-500z"));
  EXPECT_THAT(found.html, HasSubstr("class=\"failed\" d=\"M250 0.1h500v.8h-500z\""));
  EXPECT_THAT(found.html, HasSubstr(">2 s</span>"));
}

TEST(Timeline, TasksAtTheSameTimeLieInDifferentLanes) {
  const std::vector<TaskTime> tasks = {task("build", "a", 0, 0, 6), task("build", "a", 0, 0, 4),
                                       task("merge", "a", 5, 6, 8)};
  const Timeline found = timeline(tasks);
  EXPECT_THAT(found.html, HasSubstr("viewBox=\"0 0 2000 2\""));
  EXPECT_THAT(found.html, HasSubstr("M0 0.1h1500v.8h-1500zM0 1.1h1000v.8h-1000z"));
  EXPECT_THAT(found.intro, HasSubstr("25 % of the time"));  // 12 s of 2 x 8 s
  EXPECT_EQ(count_of(found.html, "class=\"swatch\""), 2U);
}

TEST(Timeline, StaysSmallOnALargeClusterAndEscapesNames) {
  std::vector<TaskTime> tasks;
  for (int node = 0; node < 100; ++node)
    for (int i = 0; i < 1000; ++i)
      tasks.push_back(task("build", fmt::format("n<{}>", node), 0, 100 * i, 100 * i + 1));
  const Timeline found = timeline(tasks);
  EXPECT_EQ(count_of(found.html, "<div class=\"node\">"), 40U);
  EXPECT_THAT(found.intro, HasSubstr("The 40 nodes that worked most are drawn"));
  EXPECT_LT(found.html.size(), 2'000'000U);
  EXPECT_GT(count_of(found.html, "n&lt;0&gt;"), 0U);
  EXPECT_EQ(count_of(found.html, "n<0>"), 0U);
}

TEST(Timeline, TasksWithoutAReportAreDrawnWhereTheirLogsEnd) {
  std::vector<TaskTime> tasks = {task("build", "a", 0, 1, 4), task("build", "", 0, 2, 2)};
  tasks[1].lost = true;
  const Timeline found = timeline(tasks);
  EXPECT_THAT(found.intro, HasSubstr("0 failed and 1 left no report"));
  EXPECT_THAT(found.html, HasSubstr("class=\"failed\" d=\"M1000 0.1h8v.8h-8z\""));
  EXPECT_THAT(found.html, HasSubstr("<span>unknown</span>"));
}

}  // namespace
}  // namespace voxweld::testing
