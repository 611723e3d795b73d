// A config with a list of isovalues: a set of meshes each.
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class IsovalueList : public ::testing::Test {
 protected:
  IsovalueList() {
    place_.phantom("ball.nrrd");
    write("two.toml", "[180, 200]", "ball.mesh");
  }
  void write(const std::string& config, const std::string& isovalue, const std::string& output) {
    write_bytes(place_.at(config), "[input]\npath = \"ball.nrrd\"\n[surface]\nisovalue = " +
                                       isovalue + "\n[output]\ndirectory = \"" + output +
                                       "\"\n[work]\ndirectory = \"" + config + ".work\"\n");
  }
  std::string mesh(const std::string& folder) const {
    return read_bytes(place_.at(folder + "/mesh.drc"));
  }
  const Workplace place_;
};

TEST_F(IsovalueList, MakesTheMeshesThatEachWouldMakeAlone) {
  const ProgramResult run = place_.run({"run", place_.at("two.toml")});
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("ball.mesh/isovalue-180: "), HasSubstr("ball.mesh/isovalue-200: ")));
  for (const char* value : {"180", "200"}) {
    write("one.toml", value, std::string("one-") + value);
    place_.run({"run", place_.at("one.toml")});
    EXPECT_EQ(mesh(std::string("ball.mesh/isovalue-") + value), mesh(std::string("one-") + value));
    place_.run({"verify", place_.at(std::string("ball.mesh/isovalue-") + value)});
  }
  EXPECT_NE(mesh("one-180"), mesh("one-200"));
}

TEST_F(IsovalueList, CopiesTheSamplesOnce) {
  const ProgramResult run = place_.run({"run", place_.at("two.toml"), "--set", "work.copy=true"});
  const std::size_t copied = run.err.find("ingest: 1 shard\n");
  ASSERT_NE(copied, std::string::npos);
  EXPECT_THAT(run.err.substr(copied + 5), AllOf(HasSubstr("ingest: 1 shard, done already"),
                                                Not(HasSubstr("ingest: 1 shard\n"))));
}

TEST_F(IsovalueList, OneOfThemCanBeNamed) {
  const std::string config = place_.at("two.toml");
  const ProgramResult run = place_.run({"run", config, "--isovalue", "200"});
  EXPECT_THAT(run.out, Not(HasSubstr("isovalue-180")));
  EXPECT_FALSE(std::filesystem::exists(place_.at("ball.mesh/isovalue-180")));
  expect_refused({"build", config}, {"two.toml", "--isovalue", "180, 200"});
  expect_refused({"run", config, "--isovalue", "190"}, {"--isovalue 190", "180, 200"});
  write("one.toml", "180", "one");
  expect_refused({"run", place_.at("one.toml"), "--isovalue", "180"}, {"no list of isovalues"});
  place_.run({"build", config, "--isovalue", "180"});
}

TEST_F(IsovalueList, AllCommandsGoThroughIt) {
  const std::string config = place_.at("two.toml");
  EXPECT_THAT(place_.run({"run", config, "--dry-run"}).out,
              AllOf(HasSubstr("isovalue 180:\n"), HasSubstr("isovalue 200:\n")));
  const auto manifests = nlohmann::json::parse(place_.run({"run", config, "--json"}).out);
  ASSERT_EQ(manifests.size(), 2U);
  EXPECT_NE(manifests[0]["counts"], manifests[1]["counts"]);
  EXPECT_THAT(place_.run({"status", config}).out,
              AllOf(HasSubstr("isovalue 180:\n"), HasSubstr("isovalue 200:\n")));
  EXPECT_THAT(place_.run({"clean", config}).out, HasSubstr("0 B freed"));
}

TEST_F(IsovalueList, WhereAnOutputIsAskedForTheFolderNamesThem) {
  place_.run({"run", place_.at("two.toml")});
  const std::string folder = place_.at("ball.mesh");
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"verify", folder},
           {"info", folder},
           {"render", folder, "-o", place_.at("x.png")},
           {"export", folder, "-o", place_.at("x.ply"), "--world"}})
    expect_refused(command, {folder, "no manifest.json", "isovalue-180, isovalue-200; name one"});
}

TEST_F(IsovalueList, InfoSaysWhichItIs) {
  place_.run({"run", place_.at("two.toml")});
  const nlohmann::json info = place_.info(place_.at("ball.mesh/isovalue-200"));
  EXPECT_EQ(info.at("surface").at("isovalue"), 200);
  EXPECT_EQ(info.at("config"), place_.at("two.toml"));
  EXPECT_FALSE(info.contains("labels"));
  EXPECT_FALSE(info.contains("filter"));
}

TEST_F(IsovalueList, IsForSamples) {
  for (const auto& [key, value] : {std::pair("surface.label", "5"), {"labels.mode", "each"}})
    expect_refused({"run", place_.at("two.toml"), "--set", std::string(key) + "=" + value},
                   {"surface.isovalue", "a list of isovalues is for samples", key});
}

}  // namespace
}  // namespace voxweld::testing
