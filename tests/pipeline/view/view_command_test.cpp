// `voxweld view` as a user runs it.
#include <csignal>

#include "pipeline/view/page_files.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

class ViewCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    if (page_files().empty()) GTEST_SKIP() << "built without the viewer's page";
    place_.run_scene({});
  }
  // Ended as Ctrl-C ends it.
  ProgramResult view(const Arguments& more) const {
    return run_voxweld(Arguments{"view", place_.at("scene.mesh")} + more, Stop{SIGINT, 0.5});
  }

  Workplace place_;
};

TEST_F(ViewCommand, TellsItsAddressAndEndsWell) {
  const ProgramResult result = view({});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, MatchesRegex(".*scene.mesh: http://127.0.0.1:[0-9]+/\n"));
  EXPECT_THAT(result.err, HasSubstr("Ctrl-C"));
  EXPECT_THAT(result.err, Not(HasSubstr("warning")));
  EXPECT_LT(result.seconds, 5);
}

TEST_F(ViewCommand, OpensTheBrowser) {
  const std::string program = place_.at("xdg-open");
  write_bytes(program,
              "#!/bin/sh\necho noise; printf %s \"$1\" >\"" + place_.at("opened") + "\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  {
    const Environment path({{"PATH", place_.at("") + ":" + std::getenv("PATH")}});
    const ProgramResult result = view({"--open"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr(read_bytes(place_.at("opened")) + "\n"));
    EXPECT_THAT(read_bytes(place_.at("opened")), HasSubstr("http://127.0.0.1:"));
    EXPECT_THAT(result.out + result.err, Not(HasSubstr("noise")));
  }
  const Environment path({{"PATH", place_.at("tools")}});
  const ProgramResult result = view({"--open"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("warning: cannot start xdg-open"));
}

TEST_F(ViewCommand, WarnsWhereOthersCanRead) {
  const ProgramResult result = view({"--host", "0.0.0.0"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("warning: 0.0.0.0: other machines"));
}

TEST_F(ViewCommand, RefusesWhatItCannotShow) {
  expect_refused({"view", place_.at("nothing")}, {"nothing", "no such file or directory"});
  expect_refused({"view", place_.at("scene.toml")}, {"scene.toml", "not a mesh file", ".drc"});
  expect_refused({"view", place_.at("scene.work")},
                 {"scene.work", "manifest.json", "finished run"});
  expect_refused({"view", place_.at("scene.mesh"), "--port", "70000"}, {"--port", "65535"});
  expect_refused({"view", place_.at("scene.mesh"), "--host", "no.such.host.invalid"},
                 {"cannot listen on no.such.host.invalid", "--host"});
}

TEST(ViewWithoutPage, SaysHowToGetIt) {
  if (!page_files().empty()) GTEST_SKIP() << "built with the viewer's page";
  const Workplace place;
  write_bytes(place.at("a.ply"), "");
  expect_refused({"view", place.at("a.ply")},
                 {"this build of voxweld has no viewer", "VOXWELD_VIEWER=ON"});
}

}  // namespace
}  // namespace voxweld::testing
