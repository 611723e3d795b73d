#include "tests/measure/cluster_model.h"

#include <gtest/gtest.h>

namespace voxweld {
namespace {

constexpr double exact = 1e-9;

std::vector<TaskLoad> tasks_of(std::vector<PieceCost> units) {
  std::vector<TaskLoad> tasks;
  for (const PieceCost& unit : units) tasks.push_back({{}, {unit}});
  return tasks;
}

TEST(ClusterModel, OneSlotTakesTheSumOfAll) {
  const auto tasks = tasks_of({{0, 0, 1}, {0, 0, 2}, {0, 0, 4}});
  const ArrayTimes times = simulate_array(tasks, {});
  EXPECT_NEAR(times.wall_s, 7, exact);
  EXPECT_NEAR(times.ends[1], 3, exact);
  EXPECT_NEAR(times.slot_s, 7, exact);
}

TEST(ClusterModel, SlotsForAllTakeTheLongestAndItsStart) {
  ClusterMachine machine;
  machine.slots = 100;
  machine.starts_per_s = 2;
  const ArrayTimes times = simulate_array(tasks_of({{0, 0, 1}, {0, 0, 9}, {0, 0, 1}}), machine);
  EXPECT_NEAR(times.wall_s, 1 + 9, exact);  // the second starts at 1 s
  EXPECT_NEAR(times.ends[0], 0.5 + 1, exact);
}

TEST(ClusterModel, ManyShortTasksTakeTheirStarts) {
  ClusterMachine machine;
  machine.slots = 1000;
  machine.starts_per_s = 10;
  const std::vector<TaskLoad> tasks(500, {{}, {{0, 0, 0.01}}});
  EXPECT_NEAR(simulate_array(tasks, machine).wall_s, 50 + 0.01, 1e-6);
}

TEST(ClusterModel, AllShareTheBandwidth) {
  ClusterMachine machine;
  machine.slots = 8;
  machine.stream_bytes_per_s = 5;
  machine.bytes_per_s = 10;
  // Two streams have 5 each; eight have 10 / 8 each.
  EXPECT_NEAR(simulate_array(tasks_of({{0, 50, 0}, {0, 50, 0}}), machine).wall_s, 10, exact);
  EXPECT_NEAR(simulate_array(tasks_of(std::vector<PieceCost>(8, {0, 50, 0})), machine).wall_s, 40,
              exact);
}

TEST(ClusterModel, WhoLeavesLeavesHisPartToTheOthers) {
  ClusterMachine machine;
  machine.slots = 2;
  machine.bytes_per_s = 10;
  // 5 each until the first has its 10, at 2 s; then 10 for what is left of 30.
  const ArrayTimes times = simulate_array(tasks_of({{0, 10, 0}, {0, 30, 0}}), machine);
  EXPECT_NEAR(times.ends[0], 2, exact);
  EXPECT_NEAR(times.ends[1], 4, exact);
}

TEST(ClusterModel, RoundTripsTakeTheirLatencyOrTheServersRate) {
  ClusterMachine machine;
  machine.slots = 100;
  machine.round_trip_s = 0.001;
  machine.trips_per_s = 20000;
  EXPECT_NEAR(simulate_array(tasks_of({{1000, 0, 1}}), machine).wall_s, 2, exact);
  const auto many = tasks_of(std::vector<PieceCost>(100, {1000, 0, 1}));
  EXPECT_NEAR(simulate_array(many, machine).wall_s, 5 + 1, 1e-6);
}

TEST(ClusterModel, ThreadsOfATaskShareItsUnitsAfterItsStart) {
  ClusterMachine machine;
  machine.threads_a_task = 2;
  const TaskLoad task{{0, 0, 1}, {{0, 0, 3}, {0, 0, 1}, {0, 0, 1}, {0, 0, 4}}};
  // 3, and 1 + 1 + 4.
  EXPECT_NEAR(simulate_array(std::vector{task}, machine).wall_s, 1 + 6, exact);
}

TEST(ClusterModel, TasksWithNothingToDoEnd) {
  EXPECT_EQ(simulate_array({}, {}).wall_s, 0);
  EXPECT_EQ(simulate_array(std::vector<TaskLoad>(3), {}).ends.size(), 3u);
}

TEST(ClusterModel, TheDriverSettlesOneTaskAfterAnother) {
  DriverLoad load;
  load.first_pause_s = load.poll_s = 5;
  load.look_s = 1;
  load.settle_s = {10, 20};
  // A look at 5 s finds nothing; the one at 11 s finds both.
  EXPECT_NEAR(simulate_driver(std::vector{7.0, 8.0}, load), 12 + 30, exact);
}

TEST(ClusterModel, LooksAreDividedAmongThreads) {
  ClusterMachine machine;
  machine.round_trip_s = 0.001;
  machine.trips_per_s = 50000;
  machine.stream_bytes_per_s = 100;
  EXPECT_NEAR(look_seconds({1000, 200, 0}, 1, machine), 1 + 2, exact);
  EXPECT_NEAR(look_seconds({1000, 200, 0}, 4, machine), 0.25 + 0.5, exact);
  EXPECT_NEAR(look_seconds({1000, 0, 0}, 1000, machine), 0.02, exact);  // the servers' rate
}

}  // namespace
}  // namespace voxweld
