// Which key belongs to which stage, said a second time and in full: a slip here costs either stale
// results or needless work.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "pipeline/config/settings.h"
#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using testing::least_config;
using testing::parse;

using Stages = std::set<Stage>;

struct KeyChange {
  std::string value;  // another value than the base has
  Stages stages;      // whose parameters it changes
};

const std::map<std::string, KeyChange>& key_changes() {
  constexpr auto ingest = Stage::ingest;
  constexpr auto build = Stage::build;
  constexpr auto merge = Stage::merge;
  constexpr auto stitch = Stage::stitch;
  constexpr auto refine = Stage::refine;
  constexpr auto seams = Stage::seams;
  constexpr auto survey = Stage::survey;
  constexpr auto recount = Stage::recount;
  constexpr auto encode = Stage::encode;
  static const std::map<std::string, KeyChange> changes = {
      {"input.path", {"\"other.raw\"", {}}},
      {"input.format", {"\"auto\"", {ingest}}},
      {"input.crop", {"[0, 0, 0, 5, 5, 5]", {ingest, build}}},
      {"input.spacing", {"0.5", {build, merge, stitch}}},
      {"input.unit", {"\"um\"", {encode}}},
      {"input.size", {"[8, 8, 9]", {ingest, build}}},
      {"input.type", {"\"int8\"", {ingest, build}}},
      {"input.endian", {"\"big\"", {ingest, build}}},
      {"input.header_bytes", {"1", {ingest, build}}},
      {"input.follow", {"true", {}}},
      {"input.dataset", {"\"/entry/data\"", {ingest, build}}},
      {"input.series", {"\"2\"", {ingest, build}}},
      {"input.level", {"1", {ingest, build}}},
      {"input.channel", {"1", {ingest, build}}},
      {"input.time", {"1", {ingest, build}}},
      {"input.resample", {"\"uniform\"", {ingest, build}}},
      {"input.resolution", {"100", {build, merge, stitch}}},
      {"input.cell", {"0.25", {build, merge, stitch}}},
      {"input.margin", {"3", {build, merge, stitch}}},
      {"input.close", {"\"winding\"", {build}}},
      {"work.directory", {"\"elsewhere\"", {}}},
      {"work.chunk", {"64", {ingest}}},
      {"work.brick", {"32", {ingest, build}}},
      {"work.shard", {"2", {ingest, build}}},
      {"work.copy", {"true", {}}},
      {"surface.isovalue", {"\"otsu\"", {build}}},
      {"surface.label", {"5", {build}}},  // the isovalue's number: another would contradict it
      {"labels.mode", {"\"each\"", {build}}},
      // Keyed by what they come to: AreKeyedByEffect.
      {"labels.select", {"[1]", {}}},
      {"labels.background", {"[]", {}}},
      {"labels.map", {"\"labels.csv\"", {}}},
      {"labels.min_voxels", {"5", {}}},
      {"labels.max_voxels", {"5", {}}},
      {"surface.inside", {"\"below\"", {build}}},
      {"surface.border", {"\"open\"", {build, stitch}}},
      {"surface.gradient", {"\"central\"", {build}}},
      {"simplify.enabled", {"false", {build, merge}}},
      {"simplify.tolerance", {"0.2", {build, merge, survey, refine, recount, seams}}},
      {"simplify.tolerance_unit", {"\"physical\"", {build, merge, survey, refine, recount, seams}}},
      {"simplify.metric", {"\"sum\"", {build, merge}}},
      {"simplify.topology", {"\"free\"", {build, merge}}},
      {"simplify.qef", {"\"normal\"", {build, merge}}},
      {"simplify.refine", {"\"repair\"", {}}},  // keyed by what it comes to
      {"simplify.intersections", {"\"report\"", {survey, refine, recount, seams}}},
      {"simplify.triangles", {"1000", {refine, seams}}},
      {"simplify.ratio", {"0.5", {refine, seams}}},
      {"output.directory", {"\"elsewhere\"", {}}},
      {"output.formats", {"[\"drc\"]", {encode}}},
      {"output.merged", {"true", {encode}}},
      {"output.tiles", {"false", {encode}}},
      {"output.tile_vertices", {"4096", {merge}}},
      {"output.levels", {"3", {Stage::levels}}},
      {"output.precision", {"0.02", {stitch}}},
      {"output.normals", {"false", {stitch}}},
      {"output.report", {"false", {}}},
      {"run.executor", {"\"slurm\"", {}}},
      {"run.threads", {"2", {}}},
      {"run.memory", {"\"1GiB\"", {}}},
      {"slurm.partition", {"\"long\"", {}}},
      {"slurm.account", {"\"imaging\"", {}}},
      {"slurm.qos", {"\"high\"", {}}},
      {"slurm.time", {"\"30\"", {}}},
      {"slurm.cpus_per_task", {"8", {}}},
      {"slurm.mem", {"\"8GiB\"", {}}},
      {"slurm.max_array", {"100", {}}},
      {"slurm.max_running", {"10", {}}},
      {"slurm.shards_per_task", {"2", {}}},
      {"slurm.retries", {"0", {}}},
      {"slurm.extra", {"[\"--exclusive\"]", {}}},
      {"slurm.prologue", {"[\"module load gcc\"]", {}}},
  };
  return changes;
}

// Of an input that takes the key.
std::string base_text(const std::string& key = {}) {
  if (key == "input.cell") return "input.path = \"part.stl\"\ninput.cell = 0.5\n";
  if (key == "input.resolution" || key == "input.margin" || key == "input.close")
    return "input.path = \"part.stl\"\ninput.resolution = 50\n";
  return least_config("input.format = \"raw\"\ninput.size = [8, 8, 8]\ninput.type = \"uint8\"\n");
}

Config base() {
  return parse(base_text());
}

TEST(StageParameters, EveryKeyChangesItsStagesAndNoOther) {
  EXPECT_EQ(key_changes().size(), settings().size());
  for (const Setting& setting : settings()) {
    const auto found = key_changes().find(setting.name());
    ASSERT_NE(found, key_changes().end()) << setting.name();
    const auto& [value, expected] = found->second;
    const std::string text = base_text(setting.name());
    const Config before = parse(text);
    const Config after = parse(text, {setting.name() + "=" + value});
    Stages changed;
    for (const Stage stage : all_stages)
      if (parameter_hash(before, stage) != parameter_hash(after, stage)) changed.insert(stage);
    EXPECT_EQ(changed, expected) << setting.name();

    const auto differences = changed_settings(before, after);
    ASSERT_EQ(differences.size(), 1U) << setting.name();
    EXPECT_EQ(differences[0].setting, &setting);
    EXPECT_NE(differences[0].before, differences[0].after);
    EXPECT_NE(config_fingerprint(before), config_fingerprint(after)) << setting.name();
  }
}

TEST(StageParameters, AreKeyedByEffect) {
  std::set<std::string> names;
  for (const Setting& setting : settings()) {
    if (!setting.by_effect) continue;
    names.insert(setting.name());
    EXPECT_TRUE(setting.read_by(Stage::build)) << setting.name();
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"labels.select", "labels.background", "labels.map",
                                   "labels.min_voxels", "labels.max_voxels", "simplify.refine"}));
}

TEST(StageParameters, OfByEffectAreInTheResult) {
  const auto result = [](const std::vector<std::string>& overrides) {
    return result_hash(parse(base_text(), overrides));
  };
  const Hash128 open = result({});
  EXPECT_EQ(open, result({"simplify.refine=auto"}));
  EXPECT_EQ(open, result({"simplify.refine=collapse"}));
  EXPECT_NE(open, result({"simplify.refine=repair"}));
  EXPECT_NE(open, result({"simplify.refine=off"}));
  for (const char* off : {"simplify.enabled=false", "simplify.topology=free"})
    EXPECT_EQ(result({off}), result({off, "simplify.refine=off"})) << off;
  EXPECT_NE(result({"labels.mode=each"}), result({"labels.mode=each", "labels.select=[1]"}));
}

TEST(StageParameters, HowAValueIsWrittenDoesNotMatter) {
  const Config a =
      parse(least_config("input.spacing = 2\nsimplify.tolerance = 1\n"
                         "run.memory = 4294967296\noutput.tiles = true\n"));
  const Config b = parse(
      "surface.isovalue = 5.0\ninput.path = \"./scan.nrrd\"\n"
      "simplify.tolerance = 1.0e0\ninput.spacing = [2.0, 2, 2]\n");
  EXPECT_EQ(a, b);
  for (const Stage stage : all_stages)
    EXPECT_EQ(parameter_hash(a, stage), parameter_hash(b, stage)) << stage_name(stage);
  EXPECT_EQ(config_fingerprint(a), config_fingerprint(b));
  EXPECT_TRUE(changed_settings(a, b).empty());
  EXPECT_EQ(parameter_hash(parse(least_config(), {"surface.isovalue=0.0"}), Stage::build),
            parameter_hash(parse(least_config(), {"surface.isovalue=-0.0"}), Stage::build));
}

TEST(StageParameters, AreNamedInTableOrder) {
  const auto parameters = stage_parameters(base(), Stage::stitch);
  ASSERT_EQ(parameters.size(), 7U);
  EXPECT_EQ(parameters[0].name, "input.spacing");
  EXPECT_EQ(parameters[0].value, std::nullopt);
  EXPECT_EQ(parameters[1].name, "input.resolution");
  EXPECT_EQ(parameters[2].name, "input.cell");
  EXPECT_EQ(parameters[3].name, "input.margin");
  EXPECT_EQ(parameters[4].name, "surface.border");
  EXPECT_EQ(parameters[4].value, ConfigValue{std::string("closed")});
  EXPECT_EQ(parameters[5].name, "output.precision");
  EXPECT_EQ(parameters[5].value, ConfigValue{0.01});
  EXPECT_EQ(parameters[6].name, "output.normals");
}

TEST(StageParameters, ChangesAreToldAsToml) {
  const auto changes =
      changed_settings(parse(least_config()), parse(least_config("input.crop = [0, 0, 0, 4, 4, 4]\n"
                                                                 "surface.border = \"open\"\n")));
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[0].setting->name(), "input.crop");
  EXPECT_EQ(changes[0].before, "the whole volume");
  EXPECT_EQ(changes[0].after, "[0, 0, 0, 4, 4, 4]");
  EXPECT_EQ(changes[1].setting->name(), "surface.border");
  EXPECT_EQ(changes[1].before, "\"closed\"");
  EXPECT_EQ(changes[1].after, "\"open\"");
}

}  // namespace
}  // namespace voxweld
