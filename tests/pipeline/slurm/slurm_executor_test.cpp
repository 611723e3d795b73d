// A stage on a cluster: what is submitted, what is taken over from a driver that died, and what is
// somebody else's.
#include "pipeline/slurm/slurm_executor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "pipeline/slurm/array_folder.h"
#include "storage/support/error.h"
#include "tests/pipeline/slurm/fake_slurm.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

using testing::FakeSlurm;
using testing::give_queue;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TempDirectory;

class SlurmExecutorTest : public ::testing::Test {
 protected:
  SlurmExecutorTest() {
    give_queue(slurm);
    setup.config.slurm.retries = 0;
    setup.config.slurm.shards_per_task = 2;
    setup.config_file = temp / "config.toml";
    setup.program = "/opt/voxweld";
    setup.folder = temp / "slurm";
    setup.poll_s = 0.01;
    setup.visible_after_s = 0;
    setup.stuck_after_s = 0;
  }

  // Of four units, whose results are there from the moment on that squeue was called so often.
  void run(std::size_t done_after_squeues) {
    std::vector<Unit> units;
    for (std::uint64_t key = 0; key < 4; ++key)
      units.push_back({key, fmt::format("shard {}", key)});
    options.identity = "build-1";
    options.done = [=, this](const Unit&) {
      return slurm.calls_of("squeue") >= done_after_squeues;
    };
    SlurmClient client;
    SlurmExecutor(setup, client).run_units("build", units, {}, options);
  }
  std::string failure() {
    return testing::error_text<Error>([&] { run(1000000); });
  }
  // As a driver leaves it that died before sbatch returned.
  ArrayFolder left_behind(const std::string& name) const {
    return ArrayFolder::create(setup.folder / "build-1", {"--shards 0-2", "--shards 3"}, name);
  }
  void queue(const std::string& lines) { std::ofstream(slurm.path() / "queue") << lines; }
  std::vector<ArrayFolder> arrays() const { return ArrayFolder::all(setup.folder / "build-1"); }

  FakeSlurm slurm;
  TempDirectory temp;
  SlurmSetup setup;
  RunOptions options;
};

TEST_F(SlurmExecutorTest, SubmitsAndWrites) {
  run(1);
  EXPECT_EQ(slurm.calls_of("sbatch"), 1U);
  ASSERT_EQ(arrays().size(), 1U);
  EXPECT_THAT(arrays()[0].name(), StartsWith("voxweld-build-"));
  EXPECT_EQ(arrays()[0].job(), 101);
  EXPECT_THAT(slurm.calls()[0], HasSubstr("--job-name=" + arrays()[0].name()));
}

TEST_F(SlurmExecutorTest, AnArrayWhoseIdWasNeverWrittenIsTakenOver) {
  const ArrayFolder folder = left_behind("voxweld-build-7f");
  queue("7|0|RUNNING|n1|voxweld-build-7f|None\n7|1|PENDING||voxweld-build-7f|Resources\n");
  run(2);
  EXPECT_EQ(slurm.calls_of("sbatch"), 0U);
  EXPECT_EQ(folder.job(), 7);
}

TEST_F(SlurmExecutorTest, OneThatNeverReachedSlurmIsSubmittedAnew) {
  left_behind("voxweld-build-7f");
  run(2);
  EXPECT_EQ(slurm.calls_of("sbatch"), 1U);
  EXPECT_EQ(arrays().size(), 2U);
}

TEST_F(SlurmExecutorTest, AJobOfAnotherNameIsNotTakenOver) {
  left_behind("voxweld-build-7f").set_job(7);
  queue("7|0|RUNNING|n1|voxweld-stitch-33|None\n7|1|RUNNING|n1|voxweld-stitch-33|None\n");
  run(2);
  EXPECT_EQ(slurm.calls_of("sbatch"), 1U);
}

TEST_F(SlurmExecutorTest, NothingIsLeftInTheQueue) {
  left_behind("voxweld-build-1a").set_job(6);  // the units of both are the same
  left_behind("voxweld-build-2b").set_job(7);
  queue(
      "6|0|RUNNING|n1|voxweld-build-1a|None\n6|1|PENDING||voxweld-build-1a|Resources\n"
      "7|0|RUNNING|n1|voxweld-build-2b|None\n7|1|RUNNING|n1|voxweld-build-2b|None\n");
  run(2);
  EXPECT_EQ(slurm.calls_of("scancel"), 1U);
  EXPECT_EQ(slurm.calls().back(),
            fmt::format("scancel --state=PENDING --user={} --name=voxweld-build-1a", geteuid()));
}

TEST_F(SlurmExecutorTest, WhatCannotBeTakenFromTheQueueStopsNothing) {
  slurm.program("squeue", "case $* in *PENDING*) echo no >&2; exit 1 ;; esac");
  EXPECT_NO_THROW(run(1));
}

// The controller forgot the array and gave its id to somebody else.
TEST_F(SlurmExecutorTest, AJobWhoseIdIsGivenAgainIsLost) {
  slurm.program("sbatch", "echo '101|0|RUNNING|n1|other|None' >\"$dir/queue\"; echo 101");
  EXPECT_THAT(failure(), HasSubstr("its task was lost"));
  EXPECT_EQ(slurm.calls_of("scancel"), 0U);
}

// Nor is it waited for that the results come to be seen.
TEST_F(SlurmExecutorTest, NothingIsTriedAgainOnAnInputThatHasChanged) {
  setup.visible_after_s = 1e6;
  setup.config.slurm.retries = 3;
  slurm.program("sbatch", R"(for word in "$@"; do
  case $word in --job-name=*) name=${word#*=} ;; esac
done
printf '101|0|COMPLETED|n1|%s|None\n101|1|PENDING||%s|None\n' "$name" "$name" >"$dir/queue"
echo 101)");
  options.check_input = [] { throw InputError("scan.raw has changed"); };
  EXPECT_THAT(failure(), HasSubstr("scan.raw has changed"));
  EXPECT_EQ(slurm.calls_of("sbatch"), 1U);
  EXPECT_THAT(slurm.calls().back(), StartsWith("scancel --state=PENDING"));
}

TEST_F(SlurmExecutorTest, AnInputIsLookedAtOnlyWhereResultsAreMissing) {
  options.check_input = [] { throw InputError("scan.raw has changed"); };
  EXPECT_NO_THROW(run(1));
}

}  // namespace
}  // namespace voxweld
