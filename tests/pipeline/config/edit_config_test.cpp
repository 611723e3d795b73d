// Edits that are right: how they are read, written, told apart and kept out of stage parameters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>

#include "pipeline/config/edit_settings.h"
#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using testing::least_config;
using testing::parse;

std::vector<EditConfig> edits(const std::string& text) {
  return parse(least_config(text)).edits;
}

TEST(EditConfig, EveryShapeAndKeyIsRead) {
  const auto found = edits(R"(
[[edit]]
shape = "sphere"
center = [1, -2.5, 3]
radius = 4
[[edit]]
op = "subtract"
shape = "box"
center = [0, 0, 0]
size = [4, 5, 6.5]
rotate = [10, -20, 400]
[[edit]]
op = "intersect"
shape = "cylinder"
center = [1, 2, 3]
radius = 0.5
height = 12
axis = [1, 1, 0]
[[edit]]
op = "add"
shape = "cone"
center = [1, 2, 3]
radius = 2
height = 3
[[edit]]
shape = "torus"
center = [1, 2, 3]
radius = 2
tube = 2
axis = [0, 0, -7]
[[edit]]
op = "intersect"
shape = "plane"
center = [1, 2, 3]
axis = [-1, 0, 0]
[[edit]]
shape = "mesh"
path = "parts/../part.stl"
[[edit]]
shape = "mesh"
path = "/elsewhere/part.ply"
center = [1, 2, 3]
scale = 25.4
rotate = [0, 0, 90]
)");
  const std::vector<EditConfig> expected = {
      {.center = {1, -2.5, 3}, .radius = 4},
      {.op = EditOp::subtract,
       .shape = SolidShape::box,
       .size = {4, 5, 6.5},
       .rotate = {10, -20, 400}},
      {.op = EditOp::intersect,
       .shape = SolidShape::cylinder,
       .center = {1, 2, 3},
       .radius = 0.5,
       .height = 12,
       .axis = {1, 1, 0}},
      {.shape = SolidShape::cone, .center = {1, 2, 3}, .radius = 2, .height = 3},
      {.shape = SolidShape::torus, .center = {1, 2, 3}, .radius = 2, .tube = 2, .axis = {0, 0, -7}},
      {.op = EditOp::intersect,
       .shape = SolidShape::plane,
       .center = {1, 2, 3},
       .axis = {-1, 0, 0}},
      {.shape = SolidShape::mesh, .path = "/data/part.stl"},
      {.shape = SolidShape::mesh,
       .center = {1, 2, 3},
       .rotate = {0, 0, 90},
       .path = "/elsewhere/part.ply",
       .scale = 25.4}};
  EXPECT_EQ(found, expected);
}

TEST(EditConfig, OtherFormsOfTomlSayTheSame) {
  const auto expected = edits(
      "[[edit]]\nshape = \"sphere\"\ncenter = [1, 2, 3]\nradius = 4\n"
      "[[edit]]\nshape = \"plane\"\ncenter = [0, 0, 0]\n");
  EXPECT_EQ(edits("edit = [{shape = \"sphere\", center = [1, 2, 3], radius = 4},\n"
                  "  {center = [0, -0.0, 0], shape = \"plane\"}]\n"),
            expected);
  EXPECT_EQ(edits("[[edit]]\nradius = 4\ncenter = [1.0, 2.0, 3.0]\nshape = \"sphere\"\n"
                  "[run]\nthreads = 1\n"
                  "[[ edit ]]\ncenter = [0, 0, 0]\nshape = \"plane\"\nop = \"add\"\n"),
            expected);
  EXPECT_TRUE(edits("edit = []\n").empty());
}

TEST(EditConfig, CanonicalTomlHasThemLast) {
  const Config config = parse(least_config(
      "[[edit]]\nshape = \"cone\"\ncenter = [1, 2, 0.1]\nheight = 3\nradius = 1\n"
      "[[edit]]\nop = \"intersect\"\nshape = \"box\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\n"
      "[slurm]\nretries = 1\n"));
  const std::string text = canonical_toml(config);
  EXPECT_EQ(text.substr(text.find("\n[[edit]]")), R"(
[[edit]]
op = "add"
shape = "cone"
center = [1.0, 2.0, 0.1]
radius = 1.0
height = 3.0
axis = [0.0, 0.0, 1.0]

[[edit]]
op = "intersect"
shape = "box"
center = [0.0, 0.0, 0.0]
size = [1.0, 1.0, 1.0]
rotate = [0.0, 0.0, 0.0]
)");
  EXPECT_EQ(parse_config(text, "/elsewhere/other.toml"), config);
  EXPECT_EQ(canonical_toml(parse(least_config())).find("edit"), std::string::npos);
}

// Doubles of every magnitude that is taken, by their bits.
double any_coordinate() {
  const auto value = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
  return std::abs(value) <= 1e9 ? value + 0.0 : 0.1;
}
double any_length() {
  const double value = std::abs(any_coordinate());
  return value == 0 ? 1 : value;
}
Vec3 any_vector() {
  return {any_coordinate(), any_coordinate(), any_coordinate()};
}

EditConfig any_edit() {
  EditConfig edit;
  edit.op = static_cast<EditOp>(*rc::gen::inRange(0, 3));
  if (*rc::gen::inRange(0, 2) == 1) edit.material = *rc::gen::inRange<std::uint64_t>(0, 1000);
  edit.shape = *rc::gen::elementOf(all_shapes);
  edit.center = any_vector();
  const auto has = [&](const char* key) { return find_edit_setting(key)->taken_by(edit.shape); };
  if (has("radius")) edit.radius = any_length();
  if (has("height")) edit.height = any_length();
  if (has("tube")) edit.tube = std::min(any_length(), edit.radius);
  if (has("size")) edit.size = {any_length(), any_length(), any_length()};
  if (has("axis")) edit.axis = {any_coordinate(), any_coordinate(), any_length()};
  if (has("rotate")) edit.rotate = any_vector();
  if (has("path")) edit.path = "/parts/\"a\" part.stl";
  if (has("scale")) edit.scale = any_length();
  if (has("close")) edit.close = static_cast<MeshClosing>(*rc::gen::inRange(0, 2));
  return edit;
}

RC_GTEST_PROP(EditConfig, CanonicalTomlReadsBackEqual, ()) {
  Config config = parse(least_config());
  for (int i = *rc::gen::inRange(0, 5); i > 0; --i) config.edits.push_back(any_edit());
  const std::string text = canonical_toml(config);
  const Config again = parse_config(text, "/elsewhere/other.toml");
  RC_ASSERT(again == config);
  RC_ASSERT(canonical_toml(again) == text);
  RC_ASSERT(config_fingerprint(again) == config_fingerprint(config));
  RC_ASSERT(changed_settings(config, again).empty());
}

// One edit with every value another.
const std::map<std::string, std::string> other_values = {
    {"op", "\"intersect\""},   {"shape", ""},
    {"path", "\"other.stl\""}, {"scale", "2"},
    {"center", "[1, 2, 4]"},   {"radius", "3"},
    {"height", "11"},          {"tube", "0.5"},
    {"size", "[4, 5, 7]"},     {"axis", "[0, 0.5, 1]"},
    {"rotate", "[0, 0, 31]"},  {"close", "\"no\""},
    {"material", "8"}};

std::string sample(SolidShape shape, const std::string& changed_key = {}) {
  std::string text = "[[edit]]\n";
  for (const EditSetting& setting : edit_settings()) {
    if (!setting.taken_by(shape)) continue;
    const std::string value = setting.key == "shape"       ? toml_string(shape_name(shape))
                              : setting.key == changed_key ? other_values.at(setting.key)
                                                           : setting.sample;
    text += setting.key + " = " + value + "\n";
  }
  return text;
}

TEST(EditConfig, EveryChangeIsTold) {
  ASSERT_EQ(other_values.size(), edit_settings().size());
  for (const SolidShape shape : all_shapes) {
    const Config before = parse(least_config(sample(shape) + sample(shape)));
    for (const EditSetting& setting : edit_settings()) {
      if (!setting.taken_by(shape) || setting.key == "shape") continue;
      const Config after = parse(least_config(sample(shape) + sample(shape, setting.key)));
      EXPECT_NE(config_fingerprint(before), config_fingerprint(after)) << setting.key;
      const auto changes = changed_settings(before, after);
      ASSERT_EQ(changes.size(), 1U) << setting.key;
      EXPECT_EQ(changes[0].name, "edit 2: " + setting.key);
      EXPECT_NE(changes[0].before, changes[0].after);
      // The build keys each shard by the edits that touch it.
      for (const Stage stage : all_stages) {
        EXPECT_EQ(parameter_hash(before, stage), parameter_hash(after, stage));
        EXPECT_EQ(changes[0].read_by(stage), stage == Stage::build);
      }
    }
  }
}

std::string change_between(const std::string& before, const std::string& after) {
  std::string text;
  for (const ChangedSetting& change :
       changed_settings(parse(least_config(before)), parse(least_config(after))))
    text += (text.empty() ? "" : ", ") + change.text();
  return text;
}

TEST(EditConfig, ChangesAreToldShortly) {
  const auto sphere = [](int radius) {
    return "[[edit]]\nshape = \"sphere\"\ncenter = [1, 2, 3]\nradius = " + std::to_string(radius) +
           "\n";
  };
  EXPECT_EQ(change_between("", sphere(1)), "number of edits was 0, is 1");
  EXPECT_EQ(change_between(sphere(1), sphere(2)), "edit 1: radius was 1.0, is 2.0");
  EXPECT_EQ(change_between(sphere(1), sample(SolidShape::box)),
            "edit 1: shape was \"sphere\", is \"box\"");
  EXPECT_EQ(change_between(sphere(1) + sphere(2), sphere(2) + sphere(1)), "edits 1, 2 changed");
  std::string before;
  std::string after;
  for (int i = 1; i < 9; ++i) {
    before += sphere(i);
    after += sphere(i == 3 ? i : i + 1);
  }
  EXPECT_EQ(change_between(before, after), "edits 1, 2, 4, 5, 6 and 2 more changed");
  EXPECT_EQ(change_between("surface.border = \"open\"\n" + sphere(1), sphere(1)),
            "surface.border was \"open\", is \"closed\"");
}

TEST(EditConfig, TheFingerprintKnowsOrderAndNumber) {
  const auto print = [](const std::string& text) {
    return config_fingerprint(parse(least_config(text)));
  };
  const std::string a = sample(SolidShape::sphere);
  const std::string b = sample(SolidShape::box);
  EXPECT_NE(print(a + b), print(b + a));
  EXPECT_NE(print(a), print(a + a));
  EXPECT_NE(print(""), print(a));
  EXPECT_NE(print(sample(SolidShape::cylinder)), print(sample(SolidShape::cone)));
}

}  // namespace
}  // namespace voxweld
