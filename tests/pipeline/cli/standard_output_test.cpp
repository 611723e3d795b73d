// Standard output may be closed or full, and standard error too: nothing is lost without a word.
#include <fmt/format.h>

#include <cstdlib>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Said {
  int exit_code = -1;
  std::string err;
};

// The program, with its streams as the shell is told to set them: ">/dev/full".
Said run_with_streams(const Workplace& place, const std::string& arguments,
                      const std::string& streams) {
  const std::string err = place.at("err");
  write_bytes(err, "");
  const int status = std::system(
      fmt::format("'{}' {} 2>'{}' {}", program_path().string(), arguments, err, streams).c_str());
  return {WEXITSTATUS(status), read_bytes(err)};
}

TEST(StandardOutput, ThatCannotBeWrittenIsSaidOfEveryCommand) {
  const Workplace place;
  place.run_scene({"output.formats=[\"drc\"]"});
  const std::string mesh = fmt::format("'{}'", place.at("scene.mesh"));
  const std::vector<std::string> commands = {"settings",
                                             "settings --json",
                                             "--help",
                                             "--version",
                                             "info --help",
                                             "manual",
                                             "completion bash",
                                             "info " + mesh,
                                             "info --json " + mesh,
                                             "verify " + mesh,
                                             "run '" + place.at("scene.toml") + "' --json",
                                             "run '" + place.at("scene.toml") + "'",
                                             "clean '" + place.at("scene.toml") + "' --dry-run"};
  for (const std::string& command : commands)
    for (const char* streams : {">/dev/full", ">&-"}) {
      const Said said = run_with_streams(place, command, streams);
      EXPECT_EQ(said.exit_code, 1) << command << streams;
      EXPECT_THAT(said.err, HasSubstr("error: cannot write to standard output: ")) << command;
      EXPECT_THAT(said.err, Not(HasSubstr("bug"))) << command;
    }
}

TEST(StandardOutput, NoFileGetsWhatIsSaidWhereStreamsAreClosed) {
  const Workplace place;
  const std::string made = read_bytes(place.phantom("scene.nrrd"));
  const std::string phantom = "phantom gyroid --size 24 --type uint8 -o ";
  run_with_streams(place, phantom + "'" + place.at("closed.nrrd") + "'", ">&- 2>&- <&-");
  EXPECT_EQ(read_bytes(place.at("closed.nrrd")), made);
  place.run({"init", place.at("scene.nrrd"), "-o", place.at("scene.toml")});
  const Said said =
      run_with_streams(place, "run '" + place.at("scene.toml") + "'", ">/dev/null 2>&-");
  EXPECT_EQ(said.exit_code, 0);
  place.run({"verify", place.at("scene.mesh")});
}

}  // namespace
}  // namespace voxweld::testing
