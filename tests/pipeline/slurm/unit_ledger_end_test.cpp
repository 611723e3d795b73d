// How tasks end without what they were to do: tried again or given up, and what is said of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/slurm/unit_ledger.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;

// What becomes of a unit whose only task ended so: the error, empty when it is tried again.
std::string error_after(const FlightEnd& end, std::int64_t retries = 3) {
  const testing::TempDirectory directory;
  Unit unit;
  unit.key = 4;
  unit.name = "shard 4";
  UnitLedger ledger(
      {&unit, 1}, [](const Unit&) { return false; }, retries);
  EXPECT_TRUE(ledger.take_off({7, 0, ArrayFolder(directory.path()), {4}}));
  ledger.fail(ledger.flights().front(), end, 0);
  EXPECT_EQ(ledger.open(), ledger.errors().empty());
  return ledger.errors().empty() ? "" : ledger.errors().front().message;
}

FlightEnd ended(const std::string& state) {
  FlightEnd end;
  end.slurm_state = state;
  return end;
}

TEST(UnitLedgerEnd, TriesAgainWhatMayGoWell) {
  EXPECT_EQ(error_after(ended("FAILED")), "");
  EXPECT_EQ(error_after(ended("NODE_FAIL")), "");
  EXPECT_EQ(error_after(ended("")), "");
  FlightEnd launch = ended("PENDING");
  launch.stuck = "launch failed requeued held";
  EXPECT_EQ(error_after(launch), "");
}

TEST(UnitLedgerEnd, GivesUpWhatIsHeldOrCancelled) {
  FlightEnd held = ended("PENDING");
  held.stuck = "JobHeldUser";
  EXPECT_THAT(error_after(held), HasSubstr("would not start its task (JobHeldUser)"));
  FlightEnd cancelled = ended("CANCELLED");
  EXPECT_THAT(error_after(cancelled), HasSubstr("cancelled"));
  cancelled.report.emplace();  // it was told to stop, and said so
  cancelled.report->exit_code = 1;
  cancelled.report->failures.push_back({std::nullopt, "interrupted", 1, ""});
  EXPECT_THAT(error_after(cancelled), HasSubstr("cancelled"));
}

TEST(UnitLedgerEnd, SaysWhatToDo) {
  FlightEnd end = ended("FAILED");
  end.last_words = "slurmstepd: error: Exceeded job memory limit";
  EXPECT_THAT(error_after(end, 0), HasSubstr("raise slurm.mem"));
  EXPECT_THAT(error_after(end, 0), HasSubstr("Exceeded job memory limit"));
  end.last_words = "the disk of /work is full";
  EXPECT_THAT(error_after(end, 0), HasSubstr("FAILED; last it said: the disk of /work is full"));
}

TEST(UnitLedgerEnd, SaysTheSameOnce) {
  const testing::TempDirectory directory;
  std::vector<Unit> units(3);
  for (std::size_t i = 0; i < units.size(); ++i) units[i].key = i;
  UnitLedger ledger(
      units, [](const Unit&) { return false; }, 0);
  for (std::size_t i = 0; i < units.size(); ++i) {
    const auto task = static_cast<std::int64_t>(i);
    ledger.take_off({7, task, ArrayFolder(directory / std::to_string(i)), {i}});
    FlightEnd end = ended(i == 2 ? "TIMEOUT" : "FAILED");
    end.last_words = "node" + std::to_string(i) + ": no";
    ledger.fail(ledger.flights().back(), end, 0);
  }
  const auto errors = ledger.errors();
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0].message, "its task ended as FAILED; last it said: node0: no; log: " +
                                   (directory / "0/logs").string());
  EXPECT_EQ(errors[1].message, errors[0].message);
  EXPECT_THAT(errors[2].message, HasSubstr("TIMEOUT"));
}

}  // namespace
}  // namespace voxweld
