// A cluster that does not answer, or whose answers are lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include "storage/support/error.h"
#include "tests/pipeline/slurm/fake_slurm.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

using std::chrono::milliseconds;
using testing::FakeSlurm;
using ::testing::HasSubstr;
using testing::NoWaiting;
using testing::unreachable;
using Jobs = std::vector<std::int64_t>;

// The warnings that are logged while it lives.
class Warnings {
 public:
  Warnings() : before_(spdlog::default_logger()) {
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_st>(text_);
    sink->set_pattern("%v");
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", sink));
    spdlog::set_level(spdlog::level::warn);
  }
  ~Warnings() { spdlog::set_default_logger(before_); }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
};

std::string failing(const std::string& message) {
  return "echo 'error: " + message + "' >&2; exit 1";
}

// The lines run only on the first `count` calls.
std::string first_calls(int count, const std::string& lines, const std::string& then) {
  return fmt::format("if [ $n -le {} ]; then {}; fi\n{}", count, lines, then);
}

TEST(SlurmTrouble, AsksAgainWithOneWarning) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("squeue", first_calls(3, failing(unreachable), "echo '5|0|RUNNING|n1|x|None'"));
  EXPECT_EQ(SlurmClient(now.options()).tasks(Jobs{5}).size(), 1U);
  EXPECT_EQ(slurm.calls_of("squeue"), 4U);
  EXPECT_EQ(now.waited, milliseconds(30000));
  EXPECT_EQ(warnings.text(),
            "Slurm does not answer: " + unreachable + "; asking again for up to 10 minutes\n");
}

TEST(SlurmTrouble, GivesUpAtTheLimit) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("squeue", failing(unreachable));
  EXPECT_THAT(testing::error_text<StorageError>([&] { SlurmClient(now.options()).tasks(Jobs{5}); }),
              HasSubstr("has not answered for 10 minutes: " + unreachable));
  EXPECT_EQ(slurm.calls_of("squeue"), 61U);
}

TEST(SlurmTrouble, ACommandThatHangsIsNoAnswer) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("squeue", first_calls(1, "sleep 60", "echo '5|0|RUNNING|n1|x|None'"));
  SlurmClientOptions options = now.options();
  options.time_limit = milliseconds(500);
  EXPECT_EQ(SlurmClient(options).tasks(Jobs{5}).size(), 1U);
  EXPECT_THAT(warnings.text(), HasSubstr("no answer within 500 ms"));
}

TEST(SlurmTrouble, SubmitsWhenTheControllerIsBack) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("sbatch", first_calls(2, failing(unreachable), "echo 9"));
  EXPECT_EQ(SlurmClient(now.options()).submit("/x.sbatch", "x-1"), 9);
  EXPECT_EQ(slurm.calls_of("sbatch"), 3U);
  EXPECT_EQ(slurm.calls_of("squeue"), 5U) << "looked for twice after each failure";
  EXPECT_EQ(slurm.calls_of("scancel"), 0U);
}

// What sbatch does before it loses the answer: the job is in the queue under its name.
const std::string takes_the_job = R"(for word in "$@"; do
  case $word in --job-name=*) echo "$((40 + n))|${word#*=}" >>"$dir/queue" ;; esac
done
)";
const std::string looks_in_queue = R"(touch "$dir/queue"
for word in "$@"; do
  case $word in --name=*) name=${word#*=} ;; esac
done
while IFS='|' read -r job jobname; do
  [ "$jobname" = "$name" ] && echo "$job|0|PENDING||$name|None" && echo "$job|10|RUNNING|n1|$name|None"
done <"$dir/queue"
exit 0)";

TEST(SlurmTrouble, AJobWhoseIdWasLostIsFoundByItsName) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("sbatch", takes_the_job + failing("Socket timed out on send/recv operation"));
  slurm.program("squeue", looks_in_queue);
  EXPECT_EQ(SlurmClient(now.options()).submit("/x.sbatch", "x-1"), 41);
  EXPECT_EQ(slurm.calls_of("sbatch"), 1U) << "submitted once";
}

TEST(SlurmTrouble, SoIsOneWhoseSbatchHung) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("sbatch", takes_the_job + "sleep 60");
  slurm.program("squeue", first_calls(2, failing(unreachable), looks_in_queue));
  SlurmClientOptions options = now.options();
  options.time_limit = milliseconds(500);
  EXPECT_EQ(SlurmClient(options).submit("/x.sbatch", "x-1"), 41);
  EXPECT_EQ(slurm.calls_of("sbatch"), 1U);
  EXPECT_EQ(slurm.calls_of("squeue"), 3U);
}

TEST(SlurmTrouble, SoIsOneThatTurnsUpLate) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("sbatch", takes_the_job + failing("Socket timed out on send/recv operation"));
  slurm.program("squeue", first_calls(1, "exit 0", looks_in_queue));
  EXPECT_EQ(SlurmClient(now.options()).submit("/x.sbatch", "x-1"), 41);
  EXPECT_EQ(slurm.calls_of("sbatch"), 1U);
}

// The controller works through its backlog late: the first request turns up after the second.
TEST(SlurmTrouble, ATwinIsCancelled) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  slurm.program("sbatch",
                takes_the_job + first_calls(1, failing("Socket timed out"), "echo $((40 + n))"));
  slurm.program("squeue", first_calls(2, "exit 0", looks_in_queue));
  EXPECT_EQ(SlurmClient(now.options()).submit("/x.sbatch", "x-1"), 41);
  EXPECT_EQ(slurm.calls().back(), "scancel 42");
  EXPECT_THAT(warnings.text(), HasSubstr("Slurm took job 41 twice; 42 is cancelled"));
}

TEST(SlurmTrouble, AStopIsHeardWhileWaiting) {
  FakeSlurm slurm;
  Warnings warnings;
  InterruptFlag flag;
  SlurmClientOptions options;
  options.interrupt = &flag;
  options.sleep = [&](milliseconds) { flag.request(); };
  slurm.program("squeue", failing(unreachable));
  slurm.program("sbatch", failing(unreachable));
  SlurmClient client(options);
  EXPECT_THROW(client.submit("/x.sbatch", "x-1"), Interrupted);
  // The job may exist all the same.
  EXPECT_THAT(slurm.calls().back(), ::testing::StrEq("scancel --name=x-1"));
  EXPECT_THROW(client.tasks(Jobs{5}), Interrupted);
  const std::size_t before = slurm.calls_of("sbatch");
  EXPECT_THROW(client.submit("/x.sbatch", "x-1"), Interrupted);
  EXPECT_EQ(slurm.calls_of("sbatch"), before) << "nothing new is begun after a stop";
}

TEST(SlurmTrouble, CancelWorksAfterAStopAndGivesUpSoon) {
  FakeSlurm slurm;
  NoWaiting now;
  Warnings warnings;
  InterruptFlag flag;
  flag.request();
  SlurmClientOptions options = now.options();
  options.interrupt = &flag;
  slurm.program("scancel", first_calls(2, failing(unreachable), "exit 0"));
  SlurmClient client(options);
  client.cancel(Jobs{5});
  EXPECT_EQ(slurm.calls_of("scancel"), 3U);
  slurm.program("scancel", failing(unreachable));
  EXPECT_THROW(client.cancel(Jobs{5}), StorageError);
  EXPECT_LE(now.waited, milliseconds(40000));
}

TEST(SlurmTrouble, ReallyWaits) {
  FakeSlurm slurm;
  Warnings warnings;
  slurm.program("squeue", first_calls(2, failing(unreachable), "exit 0"));
  SlurmClientOptions options;
  options.pause = milliseconds(30);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(SlurmClient(options).tasks(Jobs{5}).empty());
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(60));
}

}  // namespace
}  // namespace voxweld
