// Which unit is where: tried again, given up, done by whoever did it.
#include "pipeline/slurm/unit_ledger.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <fstream>
#include <set>

#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::TempDirectory;
using Keys = std::vector<std::uint64_t>;

constexpr double later = 1e6;  // after any pause

Keys keys_of(const std::vector<Unit>& units) {
  Keys keys;
  for (const Unit& unit : units) keys.push_back(unit.key);
  return keys;
}

TaskReport report_of(std::vector<TaskFailure> failures) {
  TaskReport report;
  report.exit_code = failures.empty() ? 0 : failures.front().exit_code;
  report.failures = std::move(failures);
  return report;
}

FlightEnd ended_as(const std::string& state, std::optional<TaskReport> report = {}) {
  FlightEnd end;
  end.slurm_state = state;
  end.report = std::move(report);
  return end;
}

// A ledger of the units 0, 10, 20 ... of weights 1, 2, 3 ..., and the results that are there.
class UnitLedgerTest : public ::testing::Test {
 protected:
  UnitLedger ledger(std::size_t count, std::int64_t retries = 3) {
    std::vector<Unit> units;
    for (std::size_t i = 0; i < count; ++i)
      units.push_back({10 * i, fmt::format("shard {}", i), static_cast<double>(i + 1), 0});
    return {units, [this](const Unit& unit) { return there.count(unit.key) != 0; }, retries};
  }
  Flight flight(Keys keys, std::int64_t task = 0) const {
    return {77, task, ArrayFolder(temp / "array-000"), std::move(keys), {}};
  }
  // Everything that may be tried takes off as one task and comes down without results; again and
  // again until nothing is open. Returns how often.
  int fly_until_settled(UnitLedger& ledger, const FlightEnd& end) const {
    int flights = 0;
    for (double now = 0; ledger.open() && flights < 100; now += later, ++flights) {
      EXPECT_TRUE(ledger.take_off(flight(keys_of(ledger.ready(now)))));
      land(ledger, end, now);
    }
    return flights;
  }
  static void land(UnitLedger& ledger, const FlightEnd& end, double now) {
    for (Flight& flight : ledger.flights()) {
      ledger.fail(flight, end, now);
      flight.units.clear();
    }
    ledger.sweep();
  }

  TempDirectory temp;
  std::set<std::uint64_t> there;
};

TEST_F(UnitLedgerTest, AllUnitsAreReadyAtFirst) {
  UnitLedger none = ledger(0);
  EXPECT_FALSE(none.open());
  UnitLedger three = ledger(3);
  EXPECT_TRUE(three.open());
  EXPECT_THAT(keys_of(three.ready(0)), ElementsAre(0, 10, 20));
  EXPECT_THAT(three.errors(), IsEmpty());
}

TEST_F(UnitLedgerTest, RetriesAreBounded) {
  for (const std::int64_t retries : {0, 1, 3}) {
    UnitLedger two = ledger(2, retries);
    EXPECT_EQ(fly_until_settled(two, ended_as("NODE_FAIL")), retries + 1);
    EXPECT_EQ(two.errors().size(), 2U);
    EXPECT_THAT(two.ready(1e9), IsEmpty());
  }
}

TEST_F(UnitLedgerTest, WhatTheUserHasToMendIsNotTriedAgain) {
  UnitLedger two = ledger(2);
  EXPECT_EQ(fly_until_settled(
                two, ended_as("FAILED", report_of({{{}, "volume.nrrd: too short", 2, ""}}))),
            1);
  ASSERT_EQ(two.errors().size(), 2U);
  EXPECT_EQ(two.errors()[1].exit_code, 2);
  EXPECT_THAT(two.errors()[1].message, HasSubstr("volume.nrrd: too short"));
  EXPECT_THAT(two.errors()[1].message, Not(HasSubstr("tried")));
}

TEST_F(UnitLedgerTest, ADamagedArtifactIsNotTriedAgain) {
  UnitLedger two = ledger(2);
  ASSERT_TRUE(two.take_off(flight({0, 10})));
  land(two, ended_as("FAILED", report_of({{10, "a.octree: bad checksum", 1, "a.octree"}})), 0);
  ASSERT_EQ(two.errors().size(), 1U);
  EXPECT_EQ(two.errors()[0].key, 10U);
  EXPECT_EQ(two.errors()[0].damaged_path, "a.octree");
  EXPECT_EQ(two.errors()[0].exit_code, 1);
  EXPECT_THAT(keys_of(two.ready(later)), ElementsAre(0));  // not its fault
}

// scancel sends SIGTERM first, and voxweld reports that it was asked to stop.
TEST_F(UnitLedgerTest, ACancelledTaskIsNotTriedAgain) {
  const TaskFailure asked{{}, "stopped on request", 1, ""};
  const TaskFailure own{0, "cannot write x", 1, ""};
  for (const auto& report : {std::optional<TaskReport>(), std::optional(report_of({asked})),
                             std::optional(report_of({own}))}) {
    UnitLedger one = ledger(1);
    EXPECT_EQ(fly_until_settled(one, ended_as("CANCELLED", report)), 1);
    ASSERT_EQ(one.errors().size(), 1U);
    EXPECT_THAT(one.errors()[0].message,
                HasSubstr(report && report->failures[0].unit ? "cannot write x" : "cancelled"));
  }
}

// So does Slurm itself; why it did so is what helps.
TEST_F(UnitLedgerTest, ATaskThatWasStoppedSaysByWhat) {
  const TaskReport asked = report_of({{{}, "stopped on request", 1, ""}});
  for (const auto& [state, hint] : std::map<std::string, std::string>{
           {"TIMEOUT", "slurm.time"}, {"OUT_OF_MEMORY", "slurm.mem"}, {"PREEMPTED", ""}}) {
    UnitLedger one = ledger(1, 2);
    EXPECT_EQ(fly_until_settled(one, ended_as(state, asked)), 3);
    const std::string message = one.errors().at(0).message;
    EXPECT_THAT(message, HasSubstr("its task ended as " + state));
    EXPECT_THAT(message, HasSubstr(hint));
    EXPECT_THAT(message, Not(HasSubstr("on request")));
  }
}

TEST_F(UnitLedgerTest, ResultsCountWhoeverMadeThem) {
  UnitLedger three = ledger(3);
  ASSERT_TRUE(three.take_off(flight({0, 10, 20})));
  there = {0, 10, 20};
  std::size_t most = 100;
  EXPECT_THAT(three.look(three.flights()[0], most, false), ElementsAre(1.0, 2.0, 3.0));
  three.sweep();
  EXPECT_THAT(three.flights(), IsEmpty());
  EXPECT_FALSE(three.open());
  EXPECT_THAT(three.errors(), IsEmpty());
}

TEST_F(UnitLedgerTest, LooksUpToTheFirstThatIsMissing) {
  UnitLedger four = ledger(4);
  ASSERT_TRUE(four.take_off(flight({0, 10, 20, 30})));
  there = {0, 20};
  std::size_t most = 100;
  EXPECT_THAT(four.look(four.flights()[0], most, true), ElementsAre(1.0));
  EXPECT_EQ(most, 98U);  // 0, and 10 in vain
  EXPECT_EQ(four.flights()[0].units, (Keys{10, 20, 30}));
  EXPECT_THAT(four.look(four.flights()[0], most, false), ElementsAre(3.0));
  EXPECT_EQ(four.flights()[0].units, (Keys{10, 30}));
}

TEST_F(UnitLedgerTest, LooksAtNoMoreThanAllowed) {
  UnitLedger four = ledger(4);
  ASSERT_TRUE(four.take_off(flight({0, 10, 20, 30})));
  there = {0, 10, 20, 30};
  std::size_t most = 3;
  EXPECT_EQ(four.look(four.flights()[0], most, true).size(), 3U);
  EXPECT_EQ(most, 0U);
  EXPECT_TRUE(four.look(four.flights()[0], most, true).empty());
  EXPECT_EQ(four.flights()[0].units, Keys{30});
  EXPECT_TRUE(four.open());
}

TEST_F(UnitLedgerTest, PausesGrowUpToAMinute) {
  UnitLedger one = ledger(1, 10);
  double now = 1000;
  for (const double pause : {2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0}) {
    ASSERT_TRUE(one.take_off(flight({0})));
    land(one, ended_as("NODE_FAIL"), now);
    EXPECT_THAT(one.ready(now + pause - 0.01), IsEmpty());
    EXPECT_THAT(keys_of(one.ready(now + pause)), ElementsAre(0));
    EXPECT_TRUE(one.open());
    now += pause;
  }
}

TEST_F(UnitLedgerTest, AUnitFliesInOneTaskOnly) {
  UnitLedger three = ledger(3);
  ASSERT_TRUE(three.take_off(flight({0, 10}, 0)));
  ASSERT_TRUE(three.take_off(flight({10, 20, 999}, 1)));  // 999 is no unit of the stage
  EXPECT_EQ(three.flights()[1].units, Keys{20});
  EXPECT_FALSE(three.take_off(flight({0, 10, 20}, 2)));
  EXPECT_EQ(three.flights().size(), 2U);
  EXPECT_THAT(three.ready(later), IsEmpty());
  // Nor one that is done or given up.
  there = {0, 10};
  std::size_t most = 100;
  three.look(three.flights()[0], most, false);
  three.fail(three.flights()[1], ended_as("CANCELLED"), 0);
  three.flights()[1].units.clear();
  three.sweep();
  EXPECT_FALSE(three.take_off(flight({0, 10, 20}, 3)));
  EXPECT_FALSE(three.open());
}

TEST_F(UnitLedgerTest, AFailureIsToldOfItsUnitAlone) {
  UnitLedger three = ledger(3, 0);
  ASSERT_TRUE(three.take_off(flight({0, 10, 20})));
  land(three,
       ended_as("FAILED", report_of({{20, "cannot write b", 1, ""},
                                     {{}, "disk full", 1, ""},
                                     {0, "bad a", 2, ""}})),
       0);
  const std::vector<UnitError> errors = three.errors();
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_THAT(errors[0].message, HasSubstr("bad a"));
  EXPECT_EQ(errors[0].exit_code, 2);
  EXPECT_THAT(errors[1].message, HasSubstr("disk full"));
  EXPECT_THAT(errors[2].message, HasSubstr("cannot write b"));
}

TEST_F(UnitLedgerTest, ErrorsNameUnitReasonTriesAndLog) {
  std::filesystem::create_directories(temp / "array-000" / "logs");
  const auto log = temp / "array-000" / "logs" / "77_5.log";
  std::ofstream(log) << "it began\n";
  UnitLedger two = ledger(2, 1);
  for (const double now : {0.0, later}) {
    ASSERT_TRUE(two.take_off(flight({10}, 5)));
    land(two, ended_as("NODE_FAIL"), now);
  }
  ASSERT_EQ(two.errors().size(), 1U);
  EXPECT_EQ(two.errors()[0].unit, "shard 1");
  EXPECT_EQ(two.errors()[0].message,
            "its task ended as NODE_FAIL (tried 2 times); log: " + log.string());
  EXPECT_EQ(two.errors()[0].exit_code, 1);
}

TEST_F(UnitLedgerTest, ATaskOfWhichNothingIsKnown) {
  UnitLedger lost = ledger(1, 0);
  fly_until_settled(lost, ended_as(""));
  EXPECT_THAT(lost.errors().at(0).message, HasSubstr("its task was lost"));
  UnitLedger unseen = ledger(1, 0);
  fly_until_settled(unseen, ended_as("COMPLETED", report_of({})));
  EXPECT_THAT(unseen.errors().at(0).message, HasSubstr("work.directory"));
}

// However tasks end, every unit is settled: done or told of, after no more tries than allowed.
RC_GTEST_FIXTURE_PROP(UnitLedgerTest, EverythingIsSettledInTheEnd, ()) {
  const auto count = *rc::gen::inRange<std::size_t>(1, 30);
  const auto retries = *rc::gen::inRange<std::int64_t>(0, 4);
  there.clear();
  UnitLedger all = ledger(count, retries);
  std::map<std::uint64_t, int> tries;
  double now = 0;
  for (int round = 0; all.open(); ++round, now += later) {
    RC_ASSERT(round <= retries);
    for (const std::uint64_t key : keys_of(all.ready(now))) {
      ++tries[key];
      RC_ASSERT(all.take_off(flight({key}, static_cast<std::int64_t>(key))));
      if (*rc::gen::inRange(0, 3) > 0) there.insert(key);
    }
    for (Flight& one : all.flights()) {
      std::size_t most = 1000;
      all.look(one, most, *rc::gen::arbitrary<bool>());
      const std::string state = *rc::gen::element<std::string>("FAILED", "", "NODE_FAIL");
      all.fail(one, ended_as(state), now);
      one.units.clear();
    }
    all.sweep();
  }
  RC_ASSERT(all.errors().size() + there.size() == count);
  for (const UnitError& error : all.errors()) {
    RC_ASSERT(there.count(error.key) == 0U);
    RC_ASSERT(tries[error.key] == retries + 1);
  }
}

}  // namespace
}  // namespace voxweld
