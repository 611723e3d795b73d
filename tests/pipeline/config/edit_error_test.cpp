// Edits that are wrong: the message names the place, the edit, the key, what is accepted and what
// was found.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "pipeline/config/edit_settings.h"
#include "tests/pipeline/config/config_texts.h"
#include "tests/pipeline/config/wrong_items.h"

namespace voxweld {
namespace {

using testing::error_of;
using testing::least_config;
using testing::WrongKey;

// Of a key its shape comes first.
const std::vector<WrongKey> wrong_edit_keys = testing::read_wrong_keys(R"table(
sphere op: "add", "subtract", "intersect" or "replace" (default: "add")
  "substract" (a string); did you mean "subtract"? | "Add" (a string); did you mean "add"?
  "xor" (a string) | 1
sphere material: an integer of at least 0, in quotes above 9223372036854775807 (default: none; \
between labels add and replace need it)
  -1 | 1.5 | "7-9" (a string)
sphere shape: "sphere", "box", "cylinder", "cone", "torus", "plane" or "mesh"
  "ball" (a string) | "Spere" (a string); did you mean "sphere"? | ["box"] (a list of 1)
sphere center: three finite numbers: [x, y, z]
box size: three finite numbers above 0: [x, y, z]
plane axis: three finite numbers, not all 0: [x, y, z] (default: [0.0, 0.0, 1.0])
box rotate: three finite numbers: [x, y, z] (default: [0.0, 0.0, 0.0])
  3 | [1, 2] (a list of 2) | [1, 2, 3, 4] (a list of 4) | [1, 2, inf] (a list of 3)
  [nan, 2, 3] (a list of 3) | [1, "2", 3] (a list of 3) | {x = 1} => a table | "1 2 3" (a string)
sphere radius: a finite number above 0
mesh scale: a finite number above 0 (default: 1.0)
cone height: a finite number above 0
torus tube: a finite number above 0
  0 | -0.5 | inf | nan | true (a boolean) | [1] (a list of 1) | 9007199254740993
  "4" (a string); write numbers without quotes
mesh path: a path in quotes
  "" (a string) | 3; write paths in quotes
mesh close: "no" or "winding" (default: "no")
  false (a boolean) | "windng" (a string); did you mean "winding"?
box size: three finite numbers above 0: [x, y, z]
  [1, 2, 0] (a list of 3) | [-1, 2, 3] (a list of 3)
plane axis: three finite numbers, not all 0: [x, y, z] (default: [0.0, 0.0, 1.0])
  [0, 0.0, -0.0] (a list of 3) | "z" (a string)
)table");

const std::string sphere_text =
    "[[edit]]\nshape = \"sphere\"\ncenter = [1, 2, 3]\nradius = 4\n";  // lines 3 to 6

TEST(EditError, CoversEveryKey) {
  std::set<std::string> covered;
  for (const WrongKey& key : wrong_edit_keys) covered.insert(testing::split(key.name, " ")[1]);
  EXPECT_EQ(covered.size(), edit_settings().size());
}

TEST(EditError, NamesPlaceEditKeyExpectedAndFound) {
  testing::expect_values_refused(wrong_edit_keys, {"edit", "shape", sphere_text, 8});
}

TEST(EditError, UnknownKeys) {
  EXPECT_EQ(error_of(least_config(sphere_text + "raduis = 3\n")),
            "/data/scan.toml:7:1: edit 1: unknown key raduis; did you mean radius? A sphere takes "
            "op, material, shape, center, radius");
  EXPECT_EQ(
      error_of(least_config("[[edit]]\nshape = \"plane\"\n  color = 3\n")),
      "/data/scan.toml:5:3: edit 1: unknown key color. A plane takes op, material, shape, center, "
      "axis");
  EXPECT_EQ(
      error_of(least_config("[[edit]]\nshpae = \"plane\"\n")),
      "/data/scan.toml:4:1: edit 1: unknown key shpae; did you mean shape? An edit takes op, "
      "material, shape, path, center, radius, height, tube, size, axis, scale, rotate, close");
  EXPECT_EQ(
      error_of(least_config(sphere_text + sphere_text + "[edit.more]\na = 1\n")),
      "/data/scan.toml:11:7: edit 2: unknown key more. A sphere takes op, material, shape, center, "
      "radius");
}

TEST(EditError, KeysOfOtherShapes) {
  EXPECT_EQ(
      error_of(least_config("[[edit]]\nheight = 3\nshape = \"sphere\"\n")),
      "/data/scan.toml:4:1: edit 1: a sphere has no height. A sphere takes op, material, shape, "
      "center, radius");
  for (const SolidShape shape : all_shapes) {
    for (const EditSetting& setting : edit_settings()) {
      if (setting.taken_by(shape)) continue;
      const std::string message =
          error_of(least_config("[[edit]]\nshape = " + toml_string(shape_name(shape)) + "\n" +
                                setting.key + " = " + setting.sample + "\n"));
      EXPECT_TRUE(message.starts_with(fmt::format("/data/scan.toml:5:1: edit 1: a {} has no {}. ",
                                                  shape_name(shape), setting.key)))
          << message;
    }
  }
}

TEST(EditError, MissingKeys) {
  EXPECT_EQ(error_of(least_config(sphere_text + "[[edit]]\n")),
            "/data/scan.toml:7:1: edit 2: missing key shape (expected \"sphere\", \"box\", "
            "\"cylinder\", \"cone\", \"torus\", \"plane\" or \"mesh\"): Which solid it is.");
  EXPECT_EQ(error_of(least_config("[[edit]]\nop = \"add\"\ncenter = [0, 0, 0]\nheight = 3\n")),
            "/data/scan.toml:3:1: edit 1: missing key shape (expected \"sphere\", \"box\", "
            "\"cylinder\", \"cone\", \"torus\", \"plane\" or \"mesh\"): Which solid it is.");
  for (const SolidShape shape : all_shapes) {
    for (const EditSetting& missing : edit_settings()) {
      if (!missing.required_by(shape) || missing.key == "shape") continue;
      std::string text = "[[edit]]\nshape = " + toml_string(shape_name(shape)) + "\n";
      for (const EditSetting& setting : edit_settings())
        if (setting.taken_by(shape) && setting.key != "shape" && setting.key != missing.key)
          text += setting.key + " = " + setting.sample + "\n";
      EXPECT_EQ(error_of(least_config(text)),
                fmt::format("/data/scan.toml:3:1: edit 1: missing key {} (expected {}): {}",
                            missing.key, accepted_text(missing.rule), missing.description));
    }
  }
}

TEST(EditError, TheTubeFitsTheRing) {
  EXPECT_EQ(error_of(least_config("[[edit]]\nshape = \"torus\"\ncenter = [0, 0, 0]\n"
                                  "tube = 3\nradius = 2.5\n")),
            "/data/scan.toml:6:8: edit 1: tube = 3.0: expected at most radius = 2.5, so that the "
            "ring has a hole; lower tube or raise radius");
}

TEST(EditError, NothingIsBeyondAnyVolume) {
  EXPECT_EQ(error_of(least_config("[[edit]]\nshape = \"sphere\"\ncenter = [0, 2e9, 0]\n"
                                  "radius = 2.5\n")),
            "/data/scan.toml:5:10: edit 1: center: expected numbers up to 1e+09, found [0, "
            "2000000000.0, 0]");
}

TEST(EditError, OneTableIsNoEdit) {
  const std::string advice =
      "found a single table [edit]; write [[edit]], which may stand any number of times";
  EXPECT_EQ(error_of(least_config("[edit]\nshape = \"sphere\"\n")),
            "/data/scan.toml:3:2: " + advice);
  EXPECT_EQ(error_of(least_config("edit.shape = \"sphere\"\n")), "/data/scan.toml:3:1: " + advice);
  EXPECT_EQ(error_of(least_config("edit = 3\n")),
            "/data/scan.toml:3:1: expected tables [[edit]] with keys op, material, shape, path, "
            "center, radius, "
            "height, tube, size, axis, scale, rotate, close, found 3");
  EXPECT_EQ(error_of(least_config("edit = [1, 2]\n")),
            "/data/scan.toml:3:1: expected tables [[edit]] with keys op, material, shape, path, "
            "center, radius, "
            "height, tube, size, axis, scale, rotate, close, found [1, 2] (a list of 2)");
}

TEST(EditError, OtherTablesAreNotLists) {
  const std::string tables =
      "The tables are input, work, surface, labels, simplify, output, run, slurm and any number of "
      "[[filter]] and [[edit]]";
  EXPECT_EQ(error_of(least_config("[[edits]]\nshape = \"sphere\"\n")),
            "/data/scan.toml:3:1: unknown table [[edits]]; did you mean [[edit]]? " + tables);
  EXPECT_EQ(error_of(least_config("[[cameras]]\n")),
            "/data/scan.toml:3:1: unknown table [[cameras]]. " + tables);
  EXPECT_EQ(error_of(least_config("[[ouput]]\n")),
            "/data/scan.toml:3:1: unknown table [[ouput]]; did you mean [output]? " + tables);
}

TEST(EditError, TheFirstErrorInTheFileIsTold) {
  EXPECT_THAT(error_of(least_config("[[edit]]\nshape = \"sphere\"\n[run]\nthreads = -1\n")),
              ::testing::HasSubstr(":3:1: edit 1: missing key center"));
  EXPECT_THAT(error_of(least_config("[run]\nthreads = -1\n[[edit]]\nshape = \"sphere\"\n")),
              ::testing::HasSubstr(":4:11: run.threads: expected"));
}

TEST(EditError, OverridesDoNotNameEdits) {
  for (const char* option : {"edit.radius=3", "edit[1].radius=3", "edit[1].radius", "edit = []",
                             "edit", " edit.1.shape = \"box\"", "edits=3"})
    EXPECT_EQ(error_of(least_config(sphere_text), {option}),
              std::string("--set ") +
                  toml_string(option).substr(1, toml_string(option).size() - 2) +
                  ": edits are written in the config file only, as [[edit]] tables");
}

TEST(EditError, HostileNamesAreEscapedAndCut) {
  const std::string message =
      error_of(least_config("[[edit]]\n\"a\\u001b[2J" + std::string(5000, 'b') + "\" = 1\n"));
  EXPECT_LT(message.size(), 300U);
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
}

// Whatever the bytes, the answer is a config or one InputError.
TEST(EditError, SurvivesDamagedText) {
  const std::string whole = least_config(sphere_text + "[[edit]]\nshape = \"box\"\n");
  const auto attempt = [](const std::string& text) {
    try {
      testing::parse(text);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("/data/scan.toml"));
    }
  };
  for (std::size_t size = 0; size < whole.size(); ++size) attempt(whole.substr(0, size));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const char c : {'\0', '\n', '"', '[', ']', '\xff', '.', '=', '{'}) {
      std::string text = whole;
      text[at] = c;
      attempt(text);
    }
  }
}

}  // namespace
}  // namespace voxweld
