// voxweld edit: the config's text, and the run that follows.
#include <sys/stat.h>

#include "tests/pipeline/cli/workplace.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

// Empty space with a ball in it, so that no volume is needed.
const std::string ball = R"(# A ball.
input.format = "empty"
input.size = [40, 40, 40]
work.brick = 16   # small
work.shard = 1
work.chunk = 16

# The ball itself
[[edit]]
shape = "sphere"
center = [20, 20, 20]
radius = 15
)";

class Edit : public ::testing::Test {
 protected:
  Edit() { write_bytes(config(), ball); }
  std::string config(const std::string& name = "scene") const { return place_.at(name + ".toml"); }
  std::string text() const { return read_bytes(config()); }
  Words words(const Words& more) const {
    Words all = {"edit", config()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ProgramResult edit(const Words& more) const { return place_.run(words(more)); }
  ProgramResult edit_only(Words more) const {
    more.push_back("--no-run");
    return edit(more);
  }
  void refused(const Words& more, const Words& message) const {
    const std::string before = text();
    expect_refused(words(more), message);
    EXPECT_EQ(text(), before);
  }
  Tree output(const std::string& name = "scene") const {
    return output_tree(place_.at(name + ".mesh"));
  }

  Workplace place_;
};

const Words box = {"--add",      "box",    "--op",  "subtract", "--center",
                   "20,20,-3.5", "--size", "4,5,6", "--rotate", "0, 0, 30"};
const std::string box_text = R"(
[[edit]]
op = "subtract"
shape = "box"
center = [20, 20, -3.5]
size = [4, 5, 6]
rotate = [0, 0, 30]
)";

TEST_F(Edit, AddsAndRemoves) {
  EXPECT_EQ(edit_only(box).out,
            config() +
                ": edit 2 added: subtract box center = [20.0, 20.0, -3.5], size = [4.0, "
                "5.0, 6.0], rotate = [0.0, 0.0, 30.0]\n");
  EXPECT_EQ(text(), ball + box_text);
  EXPECT_FALSE(std::filesystem::exists(place_.at("scene.work")));
  EXPECT_EQ(edit_only({"--remove", "2"}).out, config() + ": edit 2 removed\n");
  EXPECT_EQ(text(), ball);
}

TEST_F(Edit, ChangesTheEditOfThatNumber) {
  edit_only(box);
  edit_only({"--change", "1", "--radius", "12.5", "--center", "-1,2,3"});
  std::string expected = ball + box_text;
  expected.replace(expected.find("[20, 20, 20]"), 12, "[-1, 2, 3]");
  expected.replace(expected.find("= 15"), 4, "= 12.5");
  EXPECT_EQ(text(), expected);
  // Of another shape it has other keys.
  edit_only({"--change", "2", "--shape", "cylinder", "--radius", "3", "--height", "9"});
  EXPECT_EQ(text(), expected.substr(0, expected.find("\n[[edit]]\nop")) +
                        "\n[[edit]]\nop = \"subtract\"\nshape = \"cylinder\"\ncenter = [20, 20, "
                        "-3.5]\nradius = 3\nheight = 9\n");
}

TEST_F(Edit, ListsWithNumbers) {
  edit_only(box);
  EXPECT_EQ(edit({"--list"}).out,
            "1 add sphere center = [20.0, 20.0, 20.0], radius = 15.0\n"
            "2 subtract box center = [20.0, 20.0, -3.5], size = [4.0, 5.0, 6.0], rotate = [0.0, "
            "0.0, 30.0]\n");
  write_bytes(config(), "input.path = 'a.nrrd'\nsurface.isovalue = 1\n");
  EXPECT_EQ(edit({"--list"}).out, "no edits\n");
  write_bytes(config(), "edit = [{shape = 'plane', center = [1, 2, 3]}]\n" +
                            ball.substr(0, ball.find("\n# The ball")));
  EXPECT_EQ(edit({"--list"}).out, "1 add plane center = [1.0, 2.0, 3.0]\n");
  refused({"--remove", "1"}, {"scene.toml:1:", "[[edit]]"});
}

TEST_F(Edit, LeavesTheFileAloneWhereItIsRefused) {
  refused({"--add", "ball"}, {"--add ball", "\"sphere\", \"box\"", "found \"ball\""});
  refused({"--add", "sphere"}, {"left as it is", "scene.toml:14:1: edit 2: missing key center"});
  refused({"--add", "sphere", "--center", "1,2", "--radius", "4"},
          {"--center 1,2: center: expected three finite numbers", "found [1, 2]"});
  refused({"--add", "sphere", "--center", "1,2,3", "--radius", "-4"},
          {"--radius -4: radius: expected a finite number above 0", "found -4"});
  refused({"--change", "1", "--height", "4"}, {"edit 1: a sphere has no height", "radius"});
  refused({"--change", "1", "--center", "[1"}, {"--center [1", "not valid TOML"});
  refused({"--change", "2", "--radius", "4"}, {"there is no edit 2", "1 to 1", "--list"});
  refused({"--remove", "0"}, {"there is no edit 0"});
  refused({"--remove", "1"}, {"left as it is", "no edits have no surface"});
  refused({"--change", "1", "--radius", "9", "--set", "run.threads=-1"}, {"run.threads"});
  refused({"--change", "1"}, {"expected a key to change", "--radius"});
  refused({"--add", "mesh", "--path", "none.off"}, {"left as it is", "none.off: no such mesh"});
  write_bytes(place_.at("open.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  refused({"--add", "mesh", "--path", place_.at("open.off")}, {"left as it is", "is not closed"});
  refused({"--remove", "1", "--radius", "3"}, {"--radius", "--remove"});
  refused({"--add", "sphere", "--shape", "box"}, {"--shape", "--change"});
  refused({}, {"--add", "--change", "--remove", "--list", "none"});
  refused({"--list", "--remove", "1"}, {"several"});
  write_bytes(config(), ball + "[ran]\nthreads = 1\n");
  refused({"--change", "1", "--radius", "9"}, {"scene.toml:13:2: unknown table [ran]"});
  expect_refused({"edit", place_.at("none.toml"), "--remove", "1"}, {"no such config file"});
}

TEST_F(Edit, KeepsCrlfAndAMissingLastLineBreak) {
  write_bytes(config(), "input.format = \"empty\"\r\ninput.size = [9, 9, 9] # n\xc3\xa4h\r\n");
  edit_only({"--add", "sphere", "--center", "4,4,4", "--radius", "3"});
  const std::string one = text();
  EXPECT_EQ(one,
            "input.format = \"empty\"\r\ninput.size = [9, 9, 9] # n\xc3\xa4h\r\n\r\n"
            "[[edit]]\r\nshape = \"sphere\"\r\ncenter = [4, 4, 4]\r\nradius = 3\r\n");
  write_bytes(config(), one.substr(0, one.size() - 2));
  edit_only({"--add", "plane", "--center", "4,4,4", "--op", "intersect"});
  EXPECT_TRUE(
      text().ends_with("radius = 3\r\n\r\n[[edit]]\r\nop = \"intersect\"\r\n"
                       "shape = \"plane\"\r\ncenter = [4, 4, 4]"));
  edit_only({"--remove", "2"});
  EXPECT_EQ(text(), one.substr(0, one.size() - 2));
}

TEST_F(Edit, WritesThroughLinksAndKeepsPermissions) {
  std::filesystem::create_symlink(config(), config("link"));
  ASSERT_EQ(chmod(config().c_str(), 0640), 0);
  place_.run({"edit", config("link"), "--change", "1", "--radius", "14", "--no-run"});
  EXPECT_TRUE(std::filesystem::is_symlink(config("link")));
  EXPECT_THAT(text(), HasSubstr("radius = 14"));
  struct stat status {};
  ASSERT_EQ(stat(config().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640U);
}

TEST_F(Edit, RunsWhatChangedAsIfItHadAlwaysBeenSo) {
  place_.run({"run", config()});
  const Tree before = output();
  const Words corner = {"--add", "sphere", "--op", "add", "--center", "5,5,5", "--radius", "2"};
  const ProgramResult added = edit(corner);
  // Of 27 shards it reaches one, and its border what lies beside it.
  EXPECT_THAT(added.out, HasSubstr(" of 27 shards built, "));
  EXPECT_THAT(added.out, Not(HasSubstr("done: 27 of 27")));
  EXPECT_THAT(added.out, HasSubstr(place_.at("scene.mesh") + ": "));
  EXPECT_NE(difference(before, output()), "");

  write_bytes(config("fresh"), text());
  place_.run({"run", config("fresh")});
  EXPECT_EQ(difference(output("fresh"), output()), "");

  edit({"--remove", "2"});
  EXPECT_EQ(text(), ball);
  EXPECT_EQ(difference(before, output()), "");
  EXPECT_THAT(edit({"--change", "1", "--radius", "15"}).out, HasSubstr("done: 0 of 27 shards"));
}

}  // namespace
}  // namespace voxweld::testing
