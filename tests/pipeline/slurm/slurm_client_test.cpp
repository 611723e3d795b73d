// What is asked of a cluster that answers.
#include "pipeline/slurm/slurm_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "storage/support/error.h"
#include "tests/pipeline/slurm/fake_slurm.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

using testing::FakeSlurm;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using testing::NoWaiting;
using Jobs = std::vector<std::int64_t>;
using Words = std::vector<std::string>;

TEST(SlurmClient, Submits) {
  FakeSlurm slurm;
  slurm.program("sbatch", "echo 77");
  EXPECT_EQ(SlurmClient().submit("/data/a b/build.sbatch", "build-1"), 77);
  EXPECT_EQ(slurm.calls(), Words{"sbatch --parsable --job-name=build-1 /data/a b/build.sbatch"});
}

TEST(SlurmClient, NamesAreUniqueAndSafeToAskFor) {
  const std::string name = unique_job_name("voxweld, head 'a'");
  EXPECT_THAT(name, MatchesRegex("voxweld__head__a_-[0-9a-f]{16}"));
  EXPECT_NE(name, unique_job_name("voxweld, head 'a'"));
}

TEST(SlurmClient, ListsTasks) {
  FakeSlurm slurm;
  slurm.program("squeue", "echo '5|0|RUNNING|n1|x-1|None'; echo '6|N/A|PENDING||y|Resources'");
  const auto tasks = SlurmClient().tasks(Jobs{5, 6});
  ASSERT_EQ(tasks.size(), 2U);
  EXPECT_EQ(tasks[0], (TaskState{5, 0, TaskState::running, "RUNNING", "None", "n1", "x-1"}));
  EXPECT_EQ(tasks[1], (TaskState{6, -1, TaskState::pending, "PENDING", "Resources", "", "y"}));
  EXPECT_EQ(slurm.calls(), Words{"squeue -h -r -t all -j 5,6 -o %F|%K|%T|%N|%j|%r"});
}

TEST(SlurmClient, ListsTasksByName) {
  FakeSlurm slurm;
  slurm.program("squeue", "echo '5|0|RUNNING|n1|x-1|None'");
  const auto tasks = SlurmClient().tasks_named(Words{"x-1", "x-2"});
  ASSERT_EQ(tasks.size(), 1U);
  EXPECT_EQ(tasks[0].job, 5);
  EXPECT_EQ(slurm.calls(), Words{fmt::format("squeue -h -r -t all --user={} --name=x-1,x-2 -o "
                                             "%F|%K|%T|%N|%j|%r",
                                             geteuid())});
}

TEST(SlurmClient, AThousandNamesAreAskedForInTurns) {
  FakeSlurm slurm;
  slurm.program("squeue", "echo \"$n|0|RUNNING|n1|x-1|None\"");
  EXPECT_EQ(SlurmClient().tasks_named(Words(2500, unique_job_name("voxweld-build"))).size(), 3U);
}

TEST(SlurmClient, TakesFromTheQueueOnlyWhatWaits) {
  FakeSlurm slurm;
  slurm.program("squeue", "echo '5|0|PENDING||x-2|Resources'; echo '5|1|PENDING||x-2|Resources'");
  SlurmClient().cancel_pending(Words{"x-1", "x-2"});
  ASSERT_EQ(slurm.calls().size(), 2U);
  EXPECT_THAT(slurm.calls()[0], HasSubstr(" -t PENDING "));
  EXPECT_EQ(slurm.calls()[1],
            fmt::format("scancel --state=PENDING --user={} --name=x-2", geteuid()));
}

TEST(SlurmClient, NoJobsNoQuestions) {
  FakeSlurm slurm;
  SlurmClient client;
  EXPECT_TRUE(client.tasks({}).empty());
  EXPECT_TRUE(client.tasks_named({}).empty());
  client.cancel_pending({});
  client.cancel({});
  EXPECT_THAT(slurm.calls(), IsEmpty());
}

TEST(SlurmClient, ForgottenJobsAreAbsent) {
  FakeSlurm slurm;
  slurm.program("squeue", R"(case "$*" in
  *'-j 6 '*) echo '6|2|RUNNING|n1|x|None' ;;
  *) echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1 ;;
esac)");
  SlurmClient client;
  EXPECT_TRUE(client.tasks(Jobs{5}).empty());
  const auto tasks = client.tasks(Jobs{5, 6});
  ASSERT_EQ(tasks.size(), 1U);
  EXPECT_EQ(tasks[0].job, 6);
}

TEST(SlurmClient, OtherErrorsOfSqueueAreErrors) {
  FakeSlurm slurm;
  slurm.program("squeue", "echo 'squeue: error: Something else' >&2; exit 1");
  EXPECT_THROW(SlurmClient().tasks(Jobs{5}), StorageError);
}

TEST(SlurmClient, Cancels) {
  FakeSlurm slurm;
  SlurmClient client;
  client.cancel(Jobs{5, 6});
  EXPECT_EQ(slurm.calls(), Words{"scancel 5 6"});
  client.cancel_tasks({});
  client.cancel_tasks(std::vector<std::pair<std::int64_t, std::int64_t>>{{5, 0}, {6, 13}});
  EXPECT_EQ(slurm.calls(), (Words{"scancel 5 6", "scancel 5_0 6_13"}));
  slurm.program("scancel",
                "echo 'scancel: error: Kill job error on job id 5: Invalid job id specified' >&2\n"
                "exit 1");
  client.cancel(Jobs{5});
  slurm.program("scancel",
                "echo 'scancel: error: Kill job error on job id 5: Access/permission denied' >&2\n"
                "exit 1");
  EXPECT_EQ(testing::error_text<StorageError>([&] { client.cancel(Jobs{5}); }),
            "scancel failed: Kill job error on job id 5: Access/permission denied; cancel by "
            "hand: scancel 5");
}

// Filters and formats that a user has set for squeue would hide tasks.
TEST(SlurmClient, TheUsersSettingsOfTheProgramsDoNotReachThem) {
  FakeSlurm slurm;
  setenv("SQUEUE_PARTITION", "other", 1);
  setenv("SBATCH_ARRAY_INX", "1-3", 1);
  setenv("SBATCH_ACCOUNT", "mine", 1);
  slurm.program("squeue", "echo \"5|0|${SQUEUE_PARTITION-RUNNING}|n1|x|None\"");
  slurm.program("sbatch",
                "[ \"${SBATCH_ARRAY_INX-none} $SBATCH_ACCOUNT\" = 'none mine' ] && echo 3");
  EXPECT_EQ(SlurmClient().tasks(Jobs{5}).at(0).slurm_state, "RUNNING");
  EXPECT_EQ(SlurmClient().submit("/x.sbatch", "x-1"), 3);
  for (const char* name : {"SQUEUE_PARTITION", "SBATCH_ARRAY_INX", "SBATCH_ACCOUNT"})
    unsetenv(name);
}

TEST(SlurmClient, TheScriptWinsOverTheEnvironment) {
  FakeSlurm slurm;
  setenv("SBATCH_PARTITION", "other", 1);
  slurm.program("sbatch", "[ -z \"${SBATCH_PARTITION-}\" ] && echo 1 || echo 2");
  const auto script = slurm.path() / "x.sbatch";
  std::ofstream(script) << "#!/bin/bash\n#SBATCH --time=10\n";
  EXPECT_EQ(SlurmClient().submit(script, "x-1"), 2);
  std::ofstream(script) << "#!/bin/bash\n#SBATCH --partition=long\n";
  EXPECT_EQ(SlurmClient().submit(script, "x-1"), 1);
  unsetenv("SBATCH_PARTITION");
}

TEST(SlurmClient, SaysItsVersion) {
  FakeSlurm slurm;
  slurm.program("sbatch", "echo 'slurm-wlm 22.05.8'");
  EXPECT_EQ(SlurmClient().version(), "slurm-wlm 22.05.8");
  EXPECT_EQ(slurm.calls(), (Words{"sbatch --version", "squeue --version", "scancel --version"}));
}

TEST(SlurmClient, TellsWaitingFromStandingStill) {
  TaskState task;
  for (const char* reason : {"Resources", "Priority", "None", "BeginTime", "Dependency",
                             "JobArrayTaskLimit", "QOSMaxJobsPerUserLimit", "PartitionDown"}) {
    task.reason = reason;
    EXPECT_EQ(standstill(task), "") << reason;
  }
  task.reason = "PartitionTimeLimit";
  EXPECT_EQ(standstill(task),
            "PartitionTimeLimit: lower slurm.time, which is above the limit, or change "
            "slurm.partition or slurm.qos");
  for (const char* reason :
       {"PartitionConfig", "JobHeldUser", "launch failed requeued held",
        "launch_failed_requeued_held", "InvalidQOS", "DependencyNeverSatisfied"}) {
    task.reason = reason;
    EXPECT_NE(standstill(task), "") << reason;
  }
  task.state = TaskState::running;
  EXPECT_EQ(standstill(task), "");
}

TEST(SlurmClient, MissingProgramsAreTheUsersToMend) {
  const testing::TempDirectory nothing;
  const std::string path = std::getenv("PATH");
  setenv("PATH", nothing.path().c_str(), 1);
  const std::string message = testing::error_text<InputError>([] { SlurmClient().version(); });
  const std::string later = testing::error_text<InputError>([] { SlurmClient().tasks(Jobs{1}); });
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("cannot run sbatch: "));
  EXPECT_THAT(message, HasSubstr("run.executor = \"local\""));
  EXPECT_THAT(later, HasSubstr("cannot run squeue: "));
}

TEST(SlurmClient, SoIsAMachineThatKnowsNoCluster) {
  FakeSlurm slurm;
  slurm.program("sbatch",
                "echo 'sbatch: error: fetch_config: DNS SRV lookup failed' >&2\n"
                "echo 'sbatch: fatal: Could not establish a configuration source' >&2; exit 1");
  const std::string message = testing::error_text<InputError>([] { SlurmClient().version(); });
  EXPECT_THAT(message, HasSubstr("DNS SRV lookup failed; Could not establish a configuration"));
  EXPECT_THAT(message, HasSubstr("where the cluster's jobs are submitted"));
}

TEST(SlurmClient, RefusedRequestsNameTheirKeys) {
  FakeSlurm slurm;
  NoWaiting now;
  slurm.program("sbatch",
                "echo 'sbatch: error: invalid partition specified: nowhere' >&2\n"
                "echo 'sbatch: error: Batch job submission failed: Invalid partition name "
                "specified' >&2; exit 1");
  EXPECT_EQ(testing::error_text<InputError>(
                [&] { SlurmClient(now.options()).submit("/x.sbatch", "x-1"); }),
            "sbatch: the cluster refuses the job: invalid partition specified: nowhere; Batch job "
            "submission failed: Invalid partition name specified; this is likely about "
            "slurm.partition");
  EXPECT_EQ(now.waited.count(), 0);
  EXPECT_EQ(slurm.calls().size(), 1U) << "nothing was submitted, so nothing is looked for";
  slurm.program("sbatch", "echo 'sbatch: error: Unspecified error' >&2; exit 1");
  EXPECT_THROW(SlurmClient(now.options()).submit("/x.sbatch", "x-1"), StorageError);
}

}  // namespace
}  // namespace voxweld
