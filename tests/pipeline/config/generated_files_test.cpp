// The files under configs/ and what is made for them from the table of settings.
// VOXWELD_UPDATE_CONFIGS=1 in the environment writes the generated ones anew.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "pipeline/config/commented.h"
#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/help.h"
#include "pipeline/config/overloaded.h"
#include "pipeline/config/schema.h"
#include "pipeline/config/settings.h"
#include "pipeline/config/text_layout.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path configs_file(const std::string& name) {
  return std::filesystem::path(VOXWELD_CONFIGS) / name;
}

std::string read_text(const std::filesystem::path& path) {
  const auto bytes = read_whole_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void expect_committed(const std::string& name, const std::string& generated) {
  const auto path = configs_file(name);
  if (std::getenv("VOXWELD_UPDATE_CONFIGS") != nullptr)
    write_whole_file(path, as_bytes(generated), Durability::rename_only);
  ASSERT_TRUE(std::filesystem::exists(path)) << path;
  EXPECT_EQ(read_text(path), generated)
      << name << " is not what the table of settings gives; run this test once with "
      << "VOXWELD_UPDATE_CONFIGS=1 and commit the file";
}

// "integer", "string", "number or string" ...
std::string type_text(const Rule& rule) {
  return std::visit(
      Overloaded{
          [](const PathRule&) { return "string"; },
          [](const ChoiceRule&) { return "string"; },
          [](const ChoiceListRule&) { return "list of strings"; },
          [](const FlagRule&) { return "boolean"; },
          [](const SwitchRule&) { return "boolean or string"; },
          [](const IntegerRule& r) { return r.automatic ? "integer or string" : "integer"; },
          [](const PowerOfTwoRule&) { return "integer"; },
          [](const PositiveNumberRule&) { return "number"; },
          [](const PartRule&) { return "number"; },
          [](const NumberOrWordRule&) { return "number or string"; },
          [](const SpacingRule&) { return "number or list of numbers"; },
          [](const IntegerListRule&) { return "list of integers"; },
          [](const TripleRule&) { return "list of numbers"; },
          [](const NumberRule&) { return "number"; },
          [](const NumberPairRule&) { return "list of numbers"; },
          [](const PerAxisRule& r) {
            return r.whole ? "integer or list of integers" : "number or list of numbers";
          },
          [](const AxesRule&) { return "string"; },
          [](const MemoryRule&) { return "string or integer"; },
          [](const NameRule&) { return "string"; },
          [](const TextRule&) { return "string"; },
          [](const TimeLimitRule&) { return "string"; },
          [](const OptionListRule&) { return "list of strings"; },
          [](const LineListRule&) { return "list of strings"; },
          [](const LabelRule&) { return "integer or string"; },
          [](const LabelListRule& r) { return r.words.empty() ? "list" : "string or list"; }},
      rule);
}

// A bar would end the cell, an angle bracket begin a tag.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<') out += '\\';
    out += c;
  }
  return out;
}

// reruns: a sentence on what a change does.
template <class Item, class Kind>
std::string items_markdown(const ItemTable<Item, Kind>& table, const std::string& reruns) {
  std::string text = fmt::format("\n## [[{}]]\n\n", table.name);
  text += wrapped(table.description + " " + reruns, "");
  text += fmt::format("\n| key | type | accepted | default | {}s | meaning |\n", table.kind_key);
  text += "| --- | --- | --- | --- | --- | --- |\n";
  for (const auto& setting : table.settings)
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", setting.key, type_text(setting.rule),
                        cell(accepted_text(setting.rule)), cell(setting.default_text()),
                        table.kinds_text(setting), cell(setting.description));
  return text;
}

// The settings as Markdown, a table of settings for each table of the config.
std::string settings_markdown() {
  std::string text = "# Settings\n\n";
  text += wrapped(
      "Every key of the config file, its accepted values and its default. \"Re-runs\" names the "
      "stages whose work is done again when the key changes; later stages follow where their "
      "inputs change. Relative paths are relative to the config file's folder.",
      "");
  for (const std::string& table : table_names()) {
    text += fmt::format("\n## [{}]\n\n{}\n\n", table, table_description(table));
    text += "| key | type | accepted | default | re-runs | meaning |\n";
    text += "| --- | --- | --- | --- | --- | --- |\n";
    for (const Setting& setting : settings()) {
      if (setting.table != table) continue;
      text +=
          fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", setting.key, type_text(setting.rule),
                      cell(accepted_text(setting.rule)), cell(setting.default_text()),
                      setting.stages_text(), cell(setting.description));
    }
  }
  return text +
         items_markdown(filter_items(),
                        "A change re-runs ingest; with keep or fill, so does one of "
                        "surface.isovalue or surface.inside.") +
         items_markdown(edit_items(), "A change re-runs build where the edit reaches or reached.");
}

TEST(GeneratedFiles, Schema) {
  expect_committed("voxweld.schema.json", config_schema_json());
}

TEST(GeneratedFiles, Example) {
  expect_committed("example.toml", reference_config());
}

TEST(GeneratedFiles, Settings) {
  expect_committed("SETTINGS.md", settings_markdown());
}

TEST(GeneratedFiles, SchemaNamesEveryKey) {
  const auto schema = nlohmann::json::parse(config_schema_json());
  std::size_t keys = 0;
  for (const std::string& table : table_names())
    keys += schema["properties"][table]["properties"].size();
  EXPECT_EQ(keys, settings().size());
  EXPECT_EQ(schema["properties"].size(), table_names().size() + 2);
  for (const Setting& setting : settings())
    EXPECT_TRUE(schema["properties"][setting.table]["properties"].contains(setting.key))
        << setting.name();
  const auto expect_items = [&](const auto& table) {
    const auto& item = schema["properties"][table.name]["items"];
    EXPECT_EQ(item["properties"].size(), table.settings.size());
    for (const auto& setting : table.settings)
      EXPECT_TRUE(item["properties"].contains(setting.key)) << setting.key;
    EXPECT_EQ(item["required"], nlohmann::json::array({table.kind_key}));
    ASSERT_EQ(item["allOf"].size(), table.kind_names.size());
    for (std::size_t i = 0; i < table.kind_names.size(); ++i)
      EXPECT_EQ(item["allOf"][i]["if"]["properties"][table.kind_key]["const"], table.kind_names[i]);
  };
  expect_items(filter_items());
  expect_items(edit_items());
}

TEST(GeneratedFiles, HelpNamesEveryKey) {
  const std::string help = settings_help();
  for (const Setting& setting : settings()) {
    EXPECT_THAT(help, HasSubstr("\n  " + setting.key + ": "));
    EXPECT_FALSE(setting.description.empty());
    EXPECT_FALSE(setting.default_text().empty()) << setting.name();
    EXPECT_EQ(find_setting(setting.table, setting.key), &setting) << "listed twice";
  }
  const auto expect_items = [&](const auto& table) {
    const std::string of_items = help.substr(help.find("\n[[" + table.name + "]] "));
    for (const auto& setting : table.settings) {
      EXPECT_THAT(of_items, HasSubstr("\n  " + setting.key + ": "));
      EXPECT_FALSE(setting.description.empty());
      EXPECT_FALSE(setting.default_text().empty()) << setting.key;
      EXPECT_EQ(table.find(setting.key), &setting) << "listed twice";
    }
  };
  expect_items(filter_items());
  expect_items(edit_items());
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = help.find('\n', begin)) != std::string::npos; begin = end + 1)
    EXPECT_LE(end - begin, 100U) << help.substr(begin, end - begin);
}

TEST(GeneratedFiles, EveryConfigLoads) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(VOXWELD_CONFIGS)) {
    if (entry.path().extension() != ".toml") continue;
    names.insert(entry.path().filename().string());
    EXPECT_NO_THROW(load_config(entry.path())) << entry.path();
  }
  EXPECT_GE(names.size(), 3U);
}

TEST(GeneratedFiles, ExampleIsTheDefaults) {
  Config expected = parse_config("input.path = \"scan.nrrd\"\nsurface.isovalue = \"otsu\"\n",
                                 configs_file("example.toml"));
  EXPECT_EQ(load_config(configs_file("example.toml")), expected);
}

// Every line that is commented out must be right too when its mark is taken away.
TEST(GeneratedFiles, ExampleLoadsWithEveryKeyActive) {
  std::string text = reference_config();
  const auto is_of_meshes = [](const Setting& s) {
    return s.description.starts_with("Meshes only");
  };
  const auto is_of_collapse = [](const Setting& s) {
    return s.name() == "simplify.triangles" || s.name() == "simplify.ratio";
  };
  for (const std::string header : {"\n# [[filter]]\n", "\n# [[edit]]\n"})
    for (std::size_t at; (at = text.find(header)) != std::string::npos;)
      for (++at; at < text.size() && text[at] != '\n'; at = text.find('\n', at) + 1)
        text.erase(at, 2);
  for (const Setting& setting : settings())
    if (is_of_meshes(setting) || is_of_collapse(setting) || setting.name() == "surface.label")
      continue;
    else if (const auto at = text.find("\n# " + setting.key + " = "); at != std::string::npos)
      text.erase(at + 1, 2);
  const Config config = testing::parse(text);
  const auto types = filter_items().kinds();
  ASSERT_EQ(config.filters.size(), types.size());
  for (std::size_t i = 0; i < types.size(); ++i) EXPECT_EQ(config.filters[i].type, types[i]);
  ASSERT_EQ(config.edits.size(), all_shapes.size());
  for (std::size_t i = 0; i < all_shapes.size(); ++i)
    EXPECT_EQ(config.edits[i].shape, all_shapes[i]);
  EXPECT_TRUE(config.input.crop && config.input.size && config.input.type);
  text = reference_config();  // not all filters go with a label
  text.erase(text.find("\n# label = ") + 1, 2);
  EXPECT_TRUE(testing::parse(text).surface.label);
  for (const std::string key : {"triangles", "ratio"}) {
    text = reference_config();
    text.erase(text.find("\n# " + key + " = ") + 1, 2);
    EXPECT_TRUE(has_target(testing::parse(text))) << key;
  }
  for (const char* fineness : {"resolution", "cell"}) {
    text = reference_config();
    for (const std::string& key : {std::string(fineness), std::string("margin")})
      text.erase(text.find("\n# " + key + " = ") + 1, 2);
    text.replace(text.find("scan.nrrd"), 9, "scan.stl");
    text.erase(text.find("isovalue = \"otsu\"\n"), 18);
    EXPECT_EQ(testing::parse(text).input.format, "mesh");
  }
}

TEST(CommentedConfig, OfAMeshLeavesOutWhatMeshesDoNotTake) {
  MeshSuggestion mesh;
  mesh.path = "part.off";
  mesh.format = "off";
  mesh.triangles = 12;
  mesh.vertices = 8;
  mesh.hi = {1, 2, 3};
  mesh.geometry.size = {20, 30, 40};
  mesh.geometry.spacing = {0.1, 0.1, 0.1};
  mesh.cell = 0.1;
  const std::string text = commented_config(mesh, ConfigExtent::full);
  EXPECT_EQ(testing::parse(text), testing::parse("input.path = \"part.off\"\ninput.cell = 0.1\n"));
  EXPECT_THAT(text, HasSubstr("# 12 triangles and 8 vertices, closed, read as off\n"
                              "# from 0.0, 0.0, 0.0 to 1.0, 2.0, 3.0\n"
                              "# sampled at 20 x 30 x 40 places, 0.1 apart\n"));
  EXPECT_THAT(text, HasSubstr("\n# resolution = "));
  EXPECT_THAT(text, Not(HasSubstr("isovalue = ")));
  EXPECT_THAT(text, Not(HasSubstr("header_bytes")));
  EXPECT_THAT(text, Not(HasSubstr("\n\n\n")));
}

VolumeInfo head() {
  VolumeInfo info;
  info.format = "nifti";
  info.type = SampleType::i16;
  info.geometry.size = {512, 500, 361};
  info.geometry.spacing = {0.5, 0.5, 1.25};
  info.geometry.unit = "mm";
  info.warnings = {"a field is ignored:\n\"evil\" = [1]"};
  return info;
}

InitSuggestion suggestion() {
  InitSuggestion s;
  s.path = "head.nii";
  s.isovalue = 1150;
  s.lowest = -2000;
  s.highest = 4095;
  return s;
}

TEST(CommentedConfig, SaysWhatWasSuggested) {
  const std::string text = commented_config(head(), suggestion(), ConfigExtent::full);
  const Config config = testing::parse(text);
  EXPECT_EQ(config, testing::parse("input.path = \"head.nii\"\nsurface.isovalue = 1150\n"));
  EXPECT_THAT(text,
              HasSubstr("# 512 x 500 x 361 samples of int16, -2000.0 to 4095.0, read as nifti\n"));
  EXPECT_THAT(text, HasSubstr("# spacing 0.5 x 0.5 x 1.25 mm\n"));
  EXPECT_THAT(text, HasSubstr("# Note: a field is ignored: \"evil\" = [1]\n"));
  EXPECT_THAT(text, HasSubstr("\nisovalue = 1150.0\n"));
  EXPECT_THAT(text, HasSubstr("\n# chunk = 32\n"));
  EXPECT_THAT(text, Not(HasSubstr("\n\n\n")));
}

TEST(CommentedConfig, OfLabels) {
  InitSuggestion s = suggestion();
  s.labels = true;
  const std::string text = commented_config(head(), s, ConfigExtent::full);
  EXPECT_EQ(testing::parse(text),
            testing::parse("input.path = \"head.nii\"\nlabels.mode = \"each\"\n"));
  EXPECT_THAT(text, HasSubstr("\n# isovalue = \"otsu\"\n"));
  EXPECT_THAT(text, HasSubstr("\nbackground = [0]\n"));
  EXPECT_THAT(text, Not(HasSubstr("Suggested by")));
}

TEST(CommentedConfig, SaysTheLayoutOfRawFiles) {
  VolumeInfo info = head();
  info.format = "raw";
  InitSuggestion s = suggestion();
  s.path = "a \"b\" \\ c.raw";
  s.inside = SurfaceConfig::Inside::below;
  s.endian = InputConfig::Endian::big;
  s.header_bytes = 352;
  s.spacing = Vec3{1, 2, 3};
  const Config config = testing::parse(commented_config(info, s, ConfigExtent::full));
  EXPECT_EQ(config.input.path, "/data/a \"b\" \\ c.raw");
  EXPECT_EQ(config.input.format, "raw");
  EXPECT_EQ(config.input.size, (Index3{512, 500, 361}));
  EXPECT_EQ(config.input.type, SampleType::i16);
  EXPECT_EQ(config.input.endian, InputConfig::Endian::big);
  EXPECT_EQ(config.input.header_bytes, 352);
  EXPECT_EQ(config.input.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(config.surface.inside, SurfaceConfig::Inside::below);
}

// One comment of one line for each key, and the same config as with all of them.
void expect_brief(const std::string& brief, const std::string& full, std::size_t most_lines) {
  EXPECT_EQ(testing::parse(brief), testing::parse(full)) << brief;
  EXPECT_LE(std::ranges::count(brief, '\n'), static_cast<std::ptrdiff_t>(most_lines)) << brief;
  std::istringstream lines(brief);
  std::string before;
  for (std::string line; std::getline(lines, line); before = line) {
    EXPECT_LE(line.size(), 100U) << line;
    const bool key = line.find(" = ") != std::string::npos;
    EXPECT_TRUE(!key || before.starts_with("# ")) << line;
  }
}

TEST(CommentedConfig, BriefMeansTheSame) {
  VolumeInfo info = head();
  InitSuggestion s = suggestion();
  s.spacing = Vec3{1, 2, 3};
  s.unit = "um";
  for (const bool labels : {false, true})
    for (const char* format : {"nifti", "raw"}) {
      s.labels = labels;
      info.format = format;
      expect_brief(commented_config(info, s, ConfigExtent::brief),
                   commented_config(info, s, ConfigExtent::full), 42);
    }
  MeshSuggestion mesh;
  mesh.path = "part.off";
  mesh.format = "off";
  mesh.unit = "mm";
  mesh.close = MeshClosing::winding;
  mesh.cell = 0.1;
  expect_brief(commented_config(mesh, ConfigExtent::brief),
               commented_config(mesh, ConfigExtent::full), 30);
  mesh.cell.reset();
  mesh.resolution = 100;
  expect_brief(commented_config(mesh, ConfigExtent::brief),
               commented_config(mesh, ConfigExtent::full), 30);
}

}  // namespace
}  // namespace voxweld
