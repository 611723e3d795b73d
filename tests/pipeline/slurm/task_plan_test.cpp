// Units to tasks: which go where, how many, and in what order.
#include "pipeline/slurm/task_plan.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "pipeline/stage/unit_selection.h"

namespace voxweld {
namespace {

std::vector<Unit> equal_units(std::size_t count, double weight) {
  std::vector<Unit> units(count);
  for (std::size_t i = 0; i < count; ++i) units[i] = {i, "", weight, 0};
  return units;
}

std::map<std::uint64_t, std::size_t> task_of_each(const std::vector<PlannedTask>& tasks) {
  std::map<std::uint64_t, std::size_t> task_of;
  for (std::size_t t = 0; t < tasks.size(); ++t)
    for (const std::uint64_t key : tasks[t].units)
      EXPECT_TRUE(task_of.emplace(key, t).second) << "unit " << key << " is in two tasks";
  return task_of;
}

// What holds for every plan; returns the weight of the heaviest undivided piece.
double check_plan(const std::vector<Unit>& units, const std::vector<PlannedTask>& tasks) {
  const auto task_of = task_of_each(tasks);
  EXPECT_EQ(task_of.size(), units.size());
  std::vector<double> weights(tasks.size());
  std::map<std::uint64_t, std::pair<std::size_t, double>> groups;  // their task and weight
  double heaviest = 0;
  for (const Unit& unit : units) {
    const auto at = task_of.find(unit.key);
    if (at == task_of.end()) {
      ADD_FAILURE() << "unit " << unit.key << " is in no task";
      continue;
    }
    weights[at->second] += unit.weight;
    heaviest = std::max(heaviest, unit.weight);
    if (unit.together == 0) continue;
    auto& [task, weight] = groups.try_emplace(unit.together, at->second, 0.0).first->second;
    EXPECT_EQ(task, at->second) << "group " << unit.together << " is parted";
    heaviest = std::max(heaviest, weight += unit.weight);
  }
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    EXPECT_FALSE(tasks[t].units.empty());
    EXPECT_TRUE(std::is_sorted(tasks[t].units.begin(), tasks[t].units.end()));
    EXPECT_NEAR(tasks[t].weight, weights[t], 1e-6 * (1 + weights[t]));
    EXPECT_LE(tasks[t].weight, tasks[t > 0 ? t - 1 : 0].weight) << "not the largest first";
  }
  return heaviest;
}

std::vector<Unit> random_units() {
  const auto count = *rc::gen::inRange<std::size_t>(1, 200);
  const auto groups = *rc::gen::inRange<std::uint64_t>(1, 12);
  std::vector<Unit> units(count);
  std::uint64_t key = 0;
  for (Unit& unit : units) {
    key += *rc::gen::inRange<std::uint64_t>(1, 5);
    unit.key = key;
    unit.weight = *rc::gen::element(0.0, 1.0, 3.0, 250.0, 1e9) * *rc::gen::inRange(0, 100);
    unit.together = *rc::gen::inRange<std::uint64_t>(0, groups);
  }
  const auto swaps = *rc::gen::inRange<std::size_t>(0, count);  // order is not the caller's duty
  for (std::size_t i = 0; i < swaps; ++i)
    std::swap(units[i], units[*rc::gen::inRange<std::size_t>(0, count)]);
  return units;
}

RC_GTEST_PROP(TaskPlan, HoldsForAnyUnits, ()) {
  const std::vector<Unit> units = random_units();
  TaskPlanRequest request;
  request.seconds_per_weight = *rc::gen::element(0.0, 1e-9, 0.01, 50.0);
  request.cpus_per_task = *rc::gen::inRange<std::int64_t>(1, 65);
  request.slots = *rc::gen::inRange<std::int64_t>(1, 300);
  request.units_per_task = *rc::gen::element<std::int64_t>(0, 0, 1, 7, 1000);
  check_plan(units, plan_tasks(units, request));
  RC_ASSERT(!::testing::Test::HasFailure());
}

// A task is as long as it should be, give or take half of an undivided piece.
RC_GTEST_PROP(TaskPlan, TasksTakeSecondsToMinutes, ()) {
  const std::vector<Unit> units = random_units();
  TaskPlanRequest request;
  request.seconds_per_weight = *rc::gen::element(1e-6, 0.01, 2.0);
  request.cpus_per_task = *rc::gen::inRange<std::int64_t>(1, 9);
  request.slots = *rc::gen::inRange<std::int64_t>(1, 50);
  const std::vector<PlannedTask> tasks = plan_tasks(units, request);
  const double seconds = request.seconds_per_weight / static_cast<double>(request.cpus_per_task);
  const double piece = check_plan(units, tasks) * seconds;
  double total = 0;
  for (const Unit& unit : units) total += unit.weight * seconds;
  // Shorter than that only where slots would stay empty.
  const double shortest = std::min(5.0, std::max(1.0, total / static_cast<double>(request.slots)));
  std::size_t short_tasks = 0;
  for (const PlannedTask& task : tasks) {
    RC_ASSERT(task.weight * seconds <= std::max(180 + piece / 2, piece) * (1 + 1e-9));
    short_tasks += task.weight * seconds < (shortest - piece / 2) * (1 - 1e-9) ? 1 : 0;
  }
  RC_ASSERT(short_tasks <= 1U);  // the last
}

TEST(TaskPlan, SeveralTasksForEachSlot) {
  const auto tasks = plan_tasks(equal_units(1000, 1), {1, 1, 10, 0});
  EXPECT_EQ(tasks.size(), 40U);
}

TEST(TaskPlan, NoTaskIsTooShortOrTooLong) {
  EXPECT_EQ(plan_tasks(equal_units(1000, 1), {0.01, 1, 2, 0}).size(), 2U);  // 10 s in all
  EXPECT_EQ(plan_tasks(equal_units(1000, 1), {1.8, 1, 1, 0}).size(), 10U);  // 1800 s in all
  EXPECT_EQ(plan_tasks(equal_units(1000, 1), {7.2, 4, 1, 0}).size(), 10U);  // on 4 processors
}

TEST(TaskPlan, NoSlotStaysEmptyForTheSakeOfLongTasks) {
  EXPECT_EQ(plan_tasks(equal_units(1000, 1), {0.01, 1, 5, 0}).size(), 5U);      // of 2 s
  EXPECT_EQ(plan_tasks(equal_units(1000, 1), {0.01, 1, 1000, 0}).size(), 10U);  // of a second
}

TEST(TaskPlan, OneUnitIsOneTask) {
  for (const double weight : {0.0, 1.0, 1e12}) {
    const auto tasks = plan_tasks(equal_units(1, weight), {0.01, 4, 100, 0});
    ASSERT_EQ(tasks.size(), 1U);
    EXPECT_EQ(tasks[0].units, std::vector<std::uint64_t>{0});
  }
  EXPECT_TRUE(plan_tasks({}, {}).empty());
}

TEST(TaskPlan, UnitsWithoutWeight) {
  for (const double seconds : {0.0, 0.01}) {
    const auto units = equal_units(100, 0);
    const auto tasks = plan_tasks(units, {seconds, 1, 10, 0});
    check_plan(units, tasks);
    EXPECT_EQ(tasks.size(), 1U);
  }
}

TEST(TaskPlan, UnitsPerTaskIsObeyed) {
  const auto tasks = plan_tasks(equal_units(10, 1), {100, 1, 1, 4});
  ASSERT_EQ(tasks.size(), 3U);
  EXPECT_EQ(tasks[0].units, (std::vector<std::uint64_t>{0, 1, 2, 3}));
  EXPECT_EQ(tasks[1].units, (std::vector<std::uint64_t>{4, 5, 6, 7}));
  EXPECT_EQ(tasks[2].units, (std::vector<std::uint64_t>{8, 9}));
}

TEST(TaskPlan, AGroupThatDoesNotFitBeginsATask) {
  std::vector<Unit> units = equal_units(9, 1);
  for (std::size_t i = 3; i < 6; ++i) units[i].together = 7;
  const auto tasks = plan_tasks(units, {0, 1, 1, 4});
  ASSERT_EQ(tasks.size(), 3U);
  for (const PlannedTask& task : tasks) EXPECT_LE(task.units.size(), 4U);
  EXPECT_EQ(tasks[0].units, (std::vector<std::uint64_t>{3, 4, 5, 6}));
}

TEST(TaskPlan, AGroupScatteredAmongOthersIsNotParted) {
  std::vector<Unit> units = equal_units(12, 1);
  for (std::size_t i = 0; i < units.size(); ++i) units[i].together = 1 + i % 3;
  const auto tasks = plan_tasks(units, {0, 1, 1, 1});
  check_plan(units, tasks);
  EXPECT_EQ(tasks.size(), 3U);
  EXPECT_EQ(tasks[0].units, (std::vector<std::uint64_t>{0, 3, 6, 9}));
}

TEST(TaskPlan, AQuarterOfAMillionUnitsAreNothing) {
  std::vector<Unit> units = equal_units(260000, 1);
  for (Unit& unit : units) unit.weight = static_cast<double>(unit.key * 2654435761U % 1000);
  const auto began = std::chrono::steady_clock::now();
  const auto tasks = plan_tasks(units, {0.015, 4, 500, 0});
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(5));
  EXPECT_GE(tasks.size(), 2600U);  // 487,000 s in tasks of 180 s
  EXPECT_LE(tasks.size(), 2800U);
  EXPECT_EQ(task_of_each(tasks).size(), units.size());
}

RC_GTEST_PROP(TaskPlan, ArgumentsNameTheUnits, ()) {
  const std::vector<Unit> units = random_units();
  for (const PlannedTask& task : plan_tasks(units, {0, 1, 3, 0})) {
    const std::string text = task_arguments("stitch", task);
    RC_ASSERT(text.starts_with("--tiles "));
    const auto selection = UnitSelection::list(text.substr(8, text.find(' ', 8) - 8), "--tiles");
    for (std::uint64_t key = 0; key <= task.units.back() + 1; ++key)
      RC_ASSERT(selection.contains(key) ==
                std::binary_search(task.units.begin(), task.units.end(), key));
  }
}

TEST(TaskPlan, RangesOfCubesHaveTheirOwnOption) {
  const PlannedTask task{{3, 4, 9}, 1};
  for (const char* stage : {"survey", "refine", "recount", "seams", "mend", "remend"}) {
    const std::string text = task_arguments(stage, task);
    EXPECT_EQ(text, "--ranges 3-4,9 --inputs-checked");
    EXPECT_TRUE(task_selection(text).contains(4));
    EXPECT_FALSE(task_selection(text).contains(5));
  }
  EXPECT_EQ(task_arguments("retile", task), "--tiles 3-4,9 --inputs-checked");
}

RC_GTEST_PROP(TaskPlan, LinesAreReadBack, ()) {
  const std::vector<Unit> units = random_units();
  std::vector<std::uint64_t> some;  // as many as were still missing, and others
  for (const Unit& unit : units)
    if (*rc::gen::inRange(0, 3) > 0) some.push_back(unit.key);
  some.push_back(1000000);
  std::sort(some.begin(), some.end());
  std::vector<std::string> lines = {"--part 0/3", "--part 2/3", "--inputs-checked",
                                    "--tiles 3,9 --inputs-checked"};
  for (const PlannedTask& task : plan_tasks(units, {0, 1, 3, 0}))
    lines.push_back(task_arguments("build", task));
  for (const std::string& line : lines) {
    const UnitSelection selection = task_selection(line);
    std::vector<std::uint64_t> expected;
    for (const std::uint64_t key : some)
      if (selection.contains(key)) expected.push_back(key);
    RC_ASSERT(selection.among(some) == expected);
  }
}

// A driver that takes over reads them all at once.
TEST(TaskPlan, ReadingThousandsOfLinesBackIsNothing) {
  const std::vector<Unit> units = equal_units(262144, 1);
  std::vector<std::uint64_t> keys;
  keys.reserve(units.size());
  for (const Unit& unit : units) keys.push_back(unit.key);
  std::size_t found = 0;
  const auto began = std::chrono::steady_clock::now();
  for (const PlannedTask& task : plan_tasks(units, {0, 1, 4000, 0}))
    found += task_selection(task_arguments("build", task)).among(keys).size();
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(2));
  EXPECT_EQ(found, units.size());
}

TEST(TaskPlan, ArgumentsOfEachStage) {
  const PlannedTask task{{0, 1, 2, 7}, 4};
  EXPECT_EQ(task_arguments("ingest", task), "--shards 0-2,7");
  EXPECT_EQ(task_arguments("build", task), "--shards 0-2,7");
  EXPECT_EQ(task_arguments("encode", task), "--tiles 0-2,7 --inputs-checked");
  EXPECT_EQ(task_arguments("merge", task), "--inputs-checked");
  EXPECT_FALSE(task_arguments("merge", task).empty());
}

}  // namespace
}  // namespace voxweld
