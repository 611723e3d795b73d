#include "pipeline/slurm/slurm_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/support/error.h"

namespace voxweld::slurm_text {
namespace {

TEST(SlurmText, ReadsJobIds) {
  EXPECT_EQ(submitted_job("123\n"), 123);
  EXPECT_EQ(submitted_job("123;cluster\n"), 123);
  EXPECT_EQ(submitted_job("Welcome to the cluster\n\n4294967290\n"), 4294967290);
  for (const char* wrong : {"", "\n", "Submitted batch job 12\n", "12x\n", "-3\n"})
    EXPECT_EQ(submitted_job(wrong), std::nullopt) << wrong;
}

TEST(SlurmText, ReadsTasks) {
  const auto tasks = parse_tasks(
      "12|0|RUNNING|node[1-2]|x-1|None\n"
      "12|7|PENDING||x-1|(launch failed | requeued held)\n"
      "13|N/A|COMPLETED|node3|a b|None\n");
  const std::vector<TaskState> expected = {
      {12, 0, TaskState::running, "RUNNING", "None", "node[1-2]", "x-1"},
      {12, 7, TaskState::pending, "PENDING", "(launch failed | requeued held)", "", "x-1"},
      {13, -1, TaskState::gone, "COMPLETED", "None", "node3", "a b"}};
  EXPECT_EQ(tasks, expected);
  EXPECT_TRUE(parse_tasks("").empty());
}

TEST(SlurmText, KnowsSlurmsWordsForStates) {
  const auto state = [](const std::string& word) {
    return parse_tasks("1|2|" + word + "|||\n").at(0).state;
  };
  for (const char* word : {"PENDING", "REQUEUED", "REQUEUE_HOLD", "SPECIAL_EXIT"})
    EXPECT_EQ(state(word), TaskState::pending) << word;
  for (const char* word : {"RUNNING", "CONFIGURING", "SUSPENDED", "STOPPED"})
    EXPECT_EQ(state(word), TaskState::running) << word;
  for (const char* word : {"COMPLETING", "STAGE_OUT"})
    EXPECT_EQ(state(word), TaskState::completing) << word;
  for (const char* word : {"COMPLETED", "CANCELLED", "FAILED", "TIMEOUT", "NODE_FAIL", "PREEMPTED",
                           "OUT_OF_MEMORY", "BOOT_FAIL", "DEADLINE", "REVOKED"})
    EXPECT_EQ(state(word), TaskState::gone) << word;
}

TEST(SlurmText, RefusesOtherLines) {
  for (const char* wrong :
       {"JOBID PARTITION\n", "12\n", "12|3\n", "x|3|RUNNING|||\n", "12|3||||\n"})
    EXPECT_THROW(parse_tasks(wrong), StorageError) << wrong;
}

TEST(SlurmText, TellsSilenceFromRefusal) {
  for (const char* words :
       {"sbatch: error: Batch job submission failed: Unable to contact slurm controller (connect "
        "failure)",
        "slurm_load_jobs error: Socket timed out on send/recv operation",
        "slurm_msg_sendto: address:port=10.0.0.1:6817 msg_type=2021: Unexpected missing socket "
        "error",
        "sbatch: error: Batch job submission failed: Connection refused",
        "scancel: error: Kill job error on job id 3: Transport endpoint is not connected",
        "slurm_load_jobs error: Slurm backup controller in standby mode"}) {
    EXPECT_TRUE(is_unanswered(words)) << words;
    EXPECT_EQ(likely_setting(words), "") << words;
  }
  for (const char* words : {"sbatch: error: invalid partition specified: none",
                            "slurm_load_jobs error: Invalid job id specified", ""})
    EXPECT_FALSE(is_unanswered(words)) << words;
}

TEST(SlurmText, TellsWhoseAnErrorIs) {
  using ::testing::HasSubstr;
  const std::vector<std::pair<const char*, const char*>> known = {
      {"Batch job submission failed: Invalid partition name specified", "slurm.partition"},
      {"invalid partition specified: none", "slurm.partition"},
      {"Batch job submission failed: Invalid account or account/partition combination specified",
       "slurm.account"},
      {"Batch job submission failed: Invalid qos specification", "slurm.qos"},
      {"Invalid --time specification", "slurm.time"},
      {"Requested time limit is invalid (missing or exceeds some limit)", "slurm.time"},
      {"Memory specification can not be satisfied", "slurm.mem"},
      {"CPU count per node can not be satisfied", "slurm.cpus_per_task"},
      {"Requested node configuration is not available", "slurm.mem"},
      {"Batch job submission failed: Invalid job array specification", "slurm.max_array"},
      {"Job violates accounting/QOS policy (job submit limit, user's size and/or time limits)",
       "slurm.qos"},
      {"User's group not permitted to use this partition", "slurm.partition"},
      {"Invalid feature specification", "slurm.extra"},
      {"unrecognized option '--frobnicate'", "slurm.extra"}};
  for (const auto& [words, key] : known)
    EXPECT_THAT(likely_setting(words), HasSubstr(key)) << words;
  EXPECT_EQ(likely_setting("Batch job submission failed: Unspecified error"), "");
}

TEST(SlurmText, KnowsForgottenJobs) {
  EXPECT_TRUE(is_unknown_job("slurm_load_jobs error: Invalid job id specified\n"));
  EXPECT_TRUE(
      is_unknown_job("scancel: error: Kill job error on job id 3: Invalid job id specified\n"
                     "scancel: error: Kill job error on job id 4: Job/step already completing or "
                     "completed\n"));
  EXPECT_FALSE(is_unknown_job("scancel: error: Kill job error on job id 3: Access denied\n"));
  EXPECT_FALSE(is_unknown_job(""));
}

TEST(SlurmText, KnowsTasksThatNeverStart) {
  TaskState task;
  task.slurm_state = "PENDING";
  for (const char* reason :
       {"JobHeldUser", "JobHeldAdmin", "JobHoldMaxRequeue", "launch failed requeued held",
        "launch_failed_requeued_held", "DependencyNeverSatisfied", "QOSMaxMemoryPerJob",
        "AssocMaxCpuPerJobLimit", "BadConstraints", "PartitionTimeLimit", "InvalidAccount"}) {
    task.reason = reason;
    EXPECT_EQ(stuck_reason(task), reason);
  }
  for (const char* reason : {"None", "Resources", "Priority", "Dependency", "JobArrayTaskLimit",
                             "BeginTime", "ReqNodeNotAvail, UnavailableNodes:n1", "PartitionDown",
                             "QOSMaxCpuPerUserLimit", "AssocGrpCpuLimit", "Licenses"}) {
    task.reason = reason;
    EXPECT_EQ(stuck_reason(task), "") << reason;
  }
  task.slurm_state = "REQUEUE_HOLD";
  task.reason = "";
  EXPECT_EQ(stuck_reason(task), "REQUEUE_HOLD");
  task.state = TaskState::running;
  EXPECT_EQ(stuck_reason(task), "");
  EXPECT_TRUE(is_failed_launch("launch failed requeued held"));
  EXPECT_TRUE(is_failed_launch("JobHoldMaxRequeue"));
  EXPECT_FALSE(is_failed_launch("JobHeldUser"));
}

TEST(SlurmText, SaysErrorsInOneLine) {
  EXPECT_EQ(said("sbatch: error: QOSMaxSubmitJobPerUserLimit\nsbatch: error: failed: x\n"),
            "QOSMaxSubmitJobPerUserLimit; failed: x");
  EXPECT_EQ(said("\n"), "no message");
  EXPECT_EQ(said("a\x1b[2Jb"), "a [2Jb");
  EXPECT_LT(said(std::string(5000, 'x')).size(), 700U);
}

}  // namespace
}  // namespace voxweld::slurm_text
