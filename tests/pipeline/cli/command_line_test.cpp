#include <sstream>

#include "storage/readers/open_volume.h"
#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

TEST(CommandLine, EverySubcommandExplainsItself) {
  const ProgramResult all = run_voxweld({"--help"});
  EXPECT_EQ(all.exit_code, 0);
  for (const char* name :
       {"run",    "ingest", "build",  "merge",  "stitch",  "survey",   "refine", "recount",
        "seams",  "mend",   "remend", "retile", "encode",  "edit",     "init",   "info",
        "verify", "render", "report", "export", "phantom", "settings", "clean",  "view"}) {
    EXPECT_THAT(all.out, HasSubstr(std::string("\n  ") + name + " "));
    const ProgramResult help = run_voxweld({name, "--help"});
    EXPECT_EQ(help.exit_code, 0) << name;
    EXPECT_GT(help.out.size(), 40u) << name;
    EXPECT_EQ(help.err, "") << name;
  }
}

TEST(CommandLine, SaysItsVersion) {
  const ProgramResult result = run_voxweld({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out.rfind("voxweld ", 0), 0u) << result.out;
}

TEST(CommandLine, RefusesWhatItDoesNotKnow) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {}, {"polish"}, {"info"}, {"info", "x", "--no-such"}, {"init", "x", "--size", "1"}}) {
    const ProgramResult result = run_voxweld(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err, "");
    EXPECT_EQ(result.out, "");
  }
}

TEST(CommandLine, NamesWhatWasProbablyMeant) {
  expect_refused({"rnu"}, {"\"rnu\"", "did you mean \"run\"?", "`voxweld --help`"});
  expect_refused({"run", "x.toml", "--dryrun"}, {"voxweld run", "did you mean \"--dry-run\"?"});
  expect_refused({"run", "x.toml", "--log-levle=info"}, {"did you mean \"--log-level\"?"});
  expect_refused({"polish"}, {"no command is called \"polish\";"});
  expect_refused({}, {"expected a command"});
}

TEST(CommandLine, SaysWhatToDoAboutOptions) {
  expect_refused({"init", "a.stl", "--cell", "1", "--resolution", "40"},
                 {"voxweld init: --", "--cell", "--resolution",
                  " do not go together; leave one of them out; `voxweld init --help` explains"});
  expect_refused({"settings", "output.levels", "--json"},
                 {"NAME and --json do not go together; leave one of them out"});
  for (const char* option : {"--sharded", "--legacy"})
    expect_refused({"export", "a.mesh", option, "-o", "a.ply"},
                   {std::string(option) + " goes only with --neuroglancer; add that, or leave " +
                    option + " out"});
  expect_refused({"export", "a.mesh", "--neuroglancer", "--sharded", "--legacy", "-o", "a.ng"},
                 {"--sharded", "--legacy", " do not go together; leave one of them out"});
  expect_refused({"render"}, {"INPUT is missing: an output directory, or a mesh file"});
  expect_refused({"render", "a.mesh"}, {"--output FILE is missing: the PNG to write;"});
  expect_refused({"render", "a.mesh", "-o"},
                 {"--output: expected a value after it, found nothing"});
  expect_refused({"render", "a.mesh", "-o", "a.png", "-o", "b.png"},
                 {"--output is there 2 times; give it once"});
  expect_refused({"render", "a.mesh", "-o", "a.png", "--width", "0.5"},
                 {"--width: expected a whole number, found 0.5"});
  expect_refused({"render", "a.mesh", "-o", "a.png", "--zoom", "much"},
                 {"--zoom: expected a number, found much"});
  expect_refused({"view", "a.mesh", "--port", "70000"},
                 {"--port: expected a number from 0 to 65535, found 70000"});
  expect_refused({"init", "a.stl", "--close", "maybe"},
                 {"--close: expected no or winding, found maybe"});
  expect_refused({"init", "a.stl", "--cell", "0"}, {"--cell: expected a number above 0, found 0"});
  expect_refused({"verify", "a", "b"}, {"the argument \"b\" is not expected; leave it out"});
  expect_refused({"verify", "a", "b", "c"},
                 {"the arguments \"b\", \"c\" are not expected; leave them out"});
}

TEST(CommandLine, HelpFitsATerminalAndShowsHow) {
  for (const char* name :
       {"run", "init", "info", "edit", "verify", "render", "report", "phantom", "view"}) {
    const std::string help = run_voxweld({name, "--help"}).out;
    EXPECT_THAT(help, HasSubstr(std::string("Usage: voxweld ") + name + " [OPTIONS] "));
    EXPECT_THAT(help, HasSubstr(std::string("\nExamples:\n  voxweld ") + name));
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
  }
}

TEST(CommandLine, SettingsInAllThreeForms) {
  EXPECT_THAT(run_voxweld({"settings"}).out, HasSubstr("isovalue"));
  EXPECT_THAT(run_voxweld({"settings", "--example"}).out, HasSubstr("[surface]"));
  EXPECT_TRUE(
      nlohmann::json::parse(run_voxweld({"settings", "--json"}).out, nullptr, false).is_object());
}

TEST(CommandLine, SettingsOfOneKeyOrTable) {
  const std::string all = run_voxweld({"settings"}).out;
  const std::string key = run_voxweld({"settings", "simplify.tolerance"}).out;
  EXPECT_THAT(key,
              ::testing::StartsWith("[simplify] How far to simplify the mesh.\n  tolerance: "));
  EXPECT_THAT(key, HasSubstr("default: 0.1; re-runs: build"));
  EXPECT_THAT(key, ::testing::Not(HasSubstr("metric")));
  const std::string table = run_voxweld({"settings", "surface"}).out;
  EXPECT_THAT(table, HasSubstr("\n  isovalue: "));
  EXPECT_THAT(all, HasSubstr(table));
  EXPECT_THAT(run_voxweld({"settings", "directory"}).out,
              ::testing::AllOf(HasSubstr("[work]"), HasSubstr("[output]")));
  EXPECT_THAT(run_voxweld({"settings", "edit.radius"}).out, HasSubstr("\n  radius: "));
  expect_refused({"settings", "surface.isovalu"},
                 {"no table and no key of the config is called \"surface.isovalu\"",
                  "did you mean surface.isovalue?", "`voxweld settings` lists all"});
  expect_refused({"settings", "polish"}, {"called \"polish\"; `voxweld settings` lists all"});
}

TEST(CommandLine, WhatInfoKnowsIsShort) {
  const Workplace place;
  write_bytes(place.at("a.txt"), "no volume");
  const ProgramResult result = run_voxweld({"info", place.at("a.txt")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("a.txt: a file of an unknown kind; info knows volumes (nrrd"));
  EXPECT_LT(result.err.size(), place.at("a.txt").size() + 300);
}

TEST(CommandLine, NamesTheFormatsOfTheTable) {
  EXPECT_THAT(run_voxweld({"--help"}).out, HasSubstr("Volumes it reads: " + reader_names()));
  const std::string settings = run_voxweld({"settings"}).out;
  for (const VolumeReader& reader : volume_readers()) {
    EXPECT_THAT(settings, HasSubstr('"' + reader.name + '"'));
    for (const char* command : {"info", "init"})
      EXPECT_THAT(run_voxweld({command, "--help"}).out, HasSubstr(reader.files)) << command;
  }
}

}  // namespace
}  // namespace voxweld::testing
