#include "pipeline/slurm/task_times.h"

#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/slurm/array_folder.h"
#include "pipeline/slurm/slurm_run.h"
#include "storage/manifest/task_report.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {
namespace {

TaskReport report_of(const std::string& node, double ended, double seconds) {
  TaskReport report;
  report.stage = "build";
  report.wall_s = seconds;
  report.ended = ended;
  report.units = 4;
  report.provenance = R"({"host": "h", "slurm": {"node": ")" + node + R"("}})";
  return report;
}

// As a driver leaves it: the config that the tasks read, and a script that names it.
ArrayFolder array_of(const Config& config, const std::string& step, const std::string& name,
                     const std::vector<std::string>& tasks, std::int64_t job) {
  const std::filesystem::path parent = slurm_folder(config);
  const auto file = parent / ("config-" + to_hex(config_fingerprint(config)) + ".toml");
  std::filesystem::create_directories(parent);
  std::ofstream(file) << canonical_toml(config);
  ArrayFolder folder = ArrayFolder::create(parent / step, tasks, name);
  std::ofstream(folder.script_path()) << "exec voxweld build " << file.string() << "\n";
  folder.set_job(job);
  return folder;
}

TEST(TaskTimes, OfArraysThatMadeThisMeshAlone) {
  const TempDirectory work;
  Config config =
      parse_config("[input]\npath = \"a.nrrd\"\n[surface]\nisovalue = 1\n", work / "a.toml");
  config.work.directory = work.path();
  EXPECT_TRUE(task_times(config).empty());
  const auto first =
      array_of(config, "build-1", "one", {"--shards 0", "--shards 1", "--shards 2"}, 7);
  write_task_report(first.report_path(0), report_of("n1", 50, 8));
  TaskReport failed = report_of("n2", 45, 2);
  failed.exit_code = 1;
  write_task_report(first.report_path(1), failed);
  // Killed: it has a log and no report.
  std::ofstream(first.logs() / "7_2.log") << "2026-01-01 10:00:00 task 2 on n3: --shards 2\n";
  Config more = config;  // the same mesh, made in another way
  more.run.threads = 3;
  const auto second = array_of(more, "build-1", "two", {"--shards 1,2", "--shards 9"}, 8);
  write_task_report(second.report_path(0), report_of("n1", 60, 3));
  Config other = config;
  other.surface.inside = SurfaceConfig::Inside::below;
  const auto third = array_of(other, "build-2", "three", {"--shards 0"}, 9);
  write_task_report(third.report_path(0), report_of("n1", 70, 3));

  const std::vector<TaskTime> times = task_times(config);
  ASSERT_EQ(times.size(), 4U);  // the last one of `second` has never begun
  EXPECT_EQ(times[0].node, "n1");
  EXPECT_EQ(times[0].began, 42);
  EXPECT_EQ(times[0].ended, 50);
  EXPECT_EQ(times[0].units, 4U);
  EXPECT_GT(times[0].submitted, 0);
  EXPECT_TRUE(times[1].failed && !times[1].lost && !times[1].again);
  EXPECT_TRUE(times[2].lost);
  EXPECT_EQ(times[2].node, "n3");
  EXPECT_EQ(times[2].stage, "build");
  EXPECT_EQ(times[2].began, times[2].ended);
  EXPECT_TRUE(times[3].again);
}

}  // namespace
}  // namespace voxweld::testing
