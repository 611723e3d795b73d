// The completion scripts, sourced by their shells, and the manual page.
#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

#include "pipeline/config/settings.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

// What each line of a shell's output begins with; tabs end it.
Words output_of(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  EXPECT_NE(pipe, nullptr);
  Words lines;
  std::string line;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
    if (c == '\n')
      lines.push_back(line.substr(0, line.find('\t'))), line.clear();
    else
      line += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return lines;
}

bool has(const char* shell) {
  return std::system(fmt::format("command -v {} >/dev/null", shell).c_str()) == 0;
}

class Completion : public ::testing::Test {
 protected:
  // The script in a file beside which the shell is started.
  std::string script(const std::string& shell) const {
    const std::string path = place_.at("script." + shell);
    write_bytes(path, place_.run({"completion", shell}).out);
    return path;
  }

  // What bash offers where the tab key is hit at the end of the line.
  Words bash(const std::string& line) const {
    const std::string words = R"(COMP_WORDBREAKS=$' \t\n"><=;|&(:')";
    write_bytes(
        place_.at("try.sh"),
        fmt::format("cd {}; source {}; {}; COMP_LINE='{}'; COMP_POINT={}; _voxweld; "
                    "[ ${{#COMPREPLY[@]}} -eq 0 ] || printf '%s\\n' \"${{COMPREPLY[@]}}\"\n",
                    place_.at(""), script("bash"), words, line, line.size()));
    return output_of("bash --norc " + place_.at("try.sh"));
  }

  const Workplace place_;
};

TEST_F(Completion, BashKnowsCommandsAndTheirOptions) {
  EXPECT_THAT(bash("voxweld ru"), ElementsAre("run"));
  EXPECT_THAT(bash("voxweld "), Contains("settings"));
  EXPECT_THAT(bash("voxweld "), Not(Contains("completion"))) << "hidden";
  EXPECT_THAT(bash("voxweld run scan.toml --d"), ElementsAre("--dry-run"));
  EXPECT_THAT(bash("voxweld run -"), Contains("--log-level"));
  EXPECT_THAT(bash("voxweld run -"), Not(Contains("--shards")));
  EXPECT_THAT(bash("voxweld --log-level quiet build -"), Contains("--shards"));
}

TEST_F(Completion, BashKnowsTheWordsAnOptionTakes) {
  EXPECT_THAT(bash("voxweld --log-level "), ElementsAre("quiet", "warning", "info", "debug"));
  EXPECT_THAT(bash("voxweld phantom gy"), ElementsAre("gyroid"));
  EXPECT_THAT(bash("voxweld edit scan.toml --op s"), ElementsAre("subtract"));
  EXPECT_THAT(bash("voxweld phantom gyroid --size "), ElementsAre());
}

TEST_F(Completion, BashKnowsTheKeysOfAConfig) {
  EXPECT_EQ(bash("voxweld run scan.toml --set ").size(), settings().size());
  EXPECT_THAT(bash("voxweld run --set surface.iso"), ElementsAre("surface.isovalue="));
  EXPECT_THAT(bash("voxweld run --set surface.inside="), ElementsAre("above", "below"));
  EXPECT_THAT(bash("voxweld run --set output.merged=t"), ElementsAre("true"));
}

TEST_F(Completion, BashKnowsFiles) {
  write_bytes(place_.at("scan.toml"), "");
  EXPECT_THAT(bash("voxweld run sca"), ElementsAre("scan.toml"));
  EXPECT_THAT(bash("voxweld render x.mesh -o sca"), ElementsAre("scan.toml"));
}

TEST_F(Completion, Fish) {
  if (!has("fish")) GTEST_SKIP() << "no fish";
  const auto fish = [&](const std::string& line) {
    return output_of(fmt::format("cd {}; fish --no-config -c 'source {}; complete -C \"{}\"'",
                                 place_.at(""), script("fish"), line));
  };
  EXPECT_THAT(fish("voxweld ru"), ElementsAre("run"));
  EXPECT_THAT(fish("voxweld run --dr"), ElementsAre("--dry-run"));
  EXPECT_THAT(fish("voxweld run --set surface.iso"), ElementsAre("surface.isovalue="));
  EXPECT_THAT(fish("voxweld run --set surface.inside="), Contains("surface.inside=above"));
  EXPECT_THAT(fish("voxweld phantom gy"), ElementsAre("gyroid"));
  write_bytes(place_.at("scan.toml"), "");
  EXPECT_THAT(fish("voxweld run sca"), ElementsAre("scan.toml"));
  EXPECT_THAT(fish("voxweld settings sca"), ElementsAre());
}

// zsh completes only at a terminal: here the script is loaded, and its specifications are read.
TEST_F(Completion, Zsh) {
  if (!has("zsh")) GTEST_SKIP() << "no zsh";
  const std::string load =
      fmt::format("autoload -U compinit; compinit -u -D; source {}", script("zsh"));
  EXPECT_THAT(output_of(fmt::format("zsh -fc '{}; print $_comps[voxweld]'", load)),
              ElementsAre("_voxweld"));
  const std::string fake =
      "_arguments() { state=argument; [[ $1 == -C ]] || print -l -- \"$@\" }; words=(run)";
  EXPECT_THAT(output_of(fmt::format("zsh -fc '{}; {}; _voxweld'", load, fake)),
              Contains(HasSubstr("*--set[Gives a key of the config another value")));
}

TEST(Manual, HasEveryCommandOptionAndKey) {
  const Workplace place;
  const std::string page = place.run({"manual"}).out;
  for (const char* name : {"init", "run", "verify", "status"})
    EXPECT_THAT(page, HasSubstr(fmt::format("\n.SS \"voxweld {} ", name)));
  for (const char* option : {"\\-\\-dry\\-run", "\\-\\-tiles LIST", "\\-\\-log\\-level",
                             "\\-\\-cut\\-x NUMBER", "\\-\\-full"})
    EXPECT_THAT(page, HasSubstr(option));
  for (const Setting& setting : settings())
    EXPECT_THAT(page, HasSubstr(fmt::format("\n.B \"{}\"\n", setting.key)));
  EXPECT_THAT(page, HasSubstr("VOXWELD_MODULE_DIR"));
  if (!has("mandoc")) return;
  EXPECT_THAT(
      output_of(fmt::format("{} manual | mandoc -T lint -W error", program_path().string())),
      ElementsAre());
}

}  // namespace
}  // namespace voxweld::testing
