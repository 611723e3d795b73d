// Which job is an array's: the one of its name, whatever its id.
#include "pipeline/slurm/queued_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/slurm/fake_slurm.h"

namespace voxweld {
namespace {

using ::testing::ElementsAre;
using testing::FakeSlurm;
using testing::give_queue;
using ::testing::IsEmpty;
using testing::TempDirectory;

class QueuedTasksTest : public ::testing::Test {
 protected:
  QueuedTasksTest() { give_queue(slurm); }
  ArrayFolder folder(const std::string& name, std::int64_t job = 0) {
    const ArrayFolder folder = ArrayFolder::create(step, {"--shards 0"}, name);
    if (job != 0) folder.set_job(job);
    return folder;
  }
  void queue(const std::string& lines) { std::ofstream(slurm.path() / "queue") << lines; }
  std::vector<QueuedTasks> found() {
    SlurmClient client;
    return queued_tasks(arrays_of_step(step), client);
  }

  FakeSlurm slurm;
  TempDirectory temp;
  std::filesystem::path step = temp / "build-1";
};

std::vector<std::int64_t> jobs(const std::vector<QueuedTasks>& found) {
  std::vector<std::int64_t> jobs;
  for (const QueuedTasks& one : found) jobs.push_back(one.array.job);
  return jobs;
}

TEST_F(QueuedTasksTest, NothingSubmittedNothingAsked) {
  EXPECT_THAT(found(), IsEmpty());
  EXPECT_THAT(slurm.calls(), IsEmpty());
}

TEST_F(QueuedTasksTest, AreFoundByIdAndByNameAlone) {
  folder("a", 7);
  folder("b");
  folder("c", 9);  // forgotten
  folder("d");     // never submitted
  queue("7|0|RUNNING|n1|a|None\n7|1|COMPLETED|n1|a|None\n8|0|COMPLETED|n1|b|None\n");
  const auto queued = found();
  EXPECT_THAT(jobs(queued), ElementsAre(7, 8));
  EXPECT_EQ(queued[0].array.step, "build-1");
  EXPECT_EQ(queued[0].tasks.size(), 2U);
  EXPECT_TRUE(queued[0].alive());
  EXPECT_EQ(queued[1].array.folder.name(), "b");
  EXPECT_FALSE(queued[1].alive());
}

// A controller that lost its last seconds gives their ids again.
TEST_F(QueuedTasksTest, AJobOfAnotherNameIsAnothers) {
  folder("a", 7);
  folder("b", 7);
  queue("7|0|RUNNING|n1|somebody|None\n");
  EXPECT_THAT(found(), IsEmpty());
  queue("7|0|RUNNING|n1|b|None\n");
  ASSERT_EQ(found().size(), 1U);
  EXPECT_EQ(found()[0].array.folder.name(), "b");
}

TEST_F(QueuedTasksTest, AJobThatSlurmTookTwiceIsThereTwice) {
  folder("a");
  queue("7|0|RUNNING|n1|a|None\n8|0|PENDING||a|Resources\n");
  EXPECT_THAT(jobs(found()), ElementsAre(7, 8));
}

TEST_F(QueuedTasksTest, AFolderThatWasLeftUnfinishedHasNone) {
  std::filesystem::remove(folder("a", 7).path() / "name");
  queue("7|0|RUNNING|n1||None\n");
  EXPECT_THAT(found(), IsEmpty());
}

}  // namespace
}  // namespace voxweld
