#include "pipeline/config/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "pipeline/config/setting_rows.h"

namespace voxweld {

namespace rows {

Setting row(SettingWords words, const binding::Binding<Config>& bound, Stages stages) {
  const auto default_value = bound.get(Config{});
  return {{words.key, bound.rule, words.description, false, words.default_note, default_value},
          words.table,
          stages,
          false,
          false,
          bound.set,
          bound.get};
}

Setting required(Setting setting) {
  setting.required = true;
  setting.default_note = "required";
  return setting;
}

Setting when_given(Setting setting) {
  setting.when_given = true;
  return setting;
}

Setting by_effect(Setting setting) {
  setting.by_effect = true;
  return setting;
}

}  // namespace rows

namespace {

std::vector<Setting> make_settings() {
  std::vector<Setting> all;
  using namespace rows;
  for (auto make : {input_settings, work_settings, surface_settings, labels_settings,
                    simplify_settings, output_settings, run_settings, slurm_settings})
    for (Setting& setting : make()) all.push_back(std::move(setting));
  return all;
}

}  // namespace

std::string_view stage_name(Stage stage) {
  constexpr std::array<std::string_view, all_stages.size()> names = {
      "ingest", "build", "merge",  "stitch", "survey", "refine", "recount",
      "seams",  "mend",  "remend", "retile", "levels", "encode"};
  return names[static_cast<std::size_t>(stage)];
}

std::vector<Stage> stages_of(const Config& config) {
  std::vector<Stage> stages(all_stages.begin(), all_stages.end());
  if (!refines(config))
    std::erase_if(stages,
                  [](Stage stage) { return Stage::stitch < stage && stage < Stage::encode; });
  if (!mends(config))
    std::erase_if(stages,
                  [](Stage stage) { return stage == Stage::mend || stage == Stage::remend; });
  if (only_repairs(config) && !mends(config)) std::erase(stages, Stage::seams);
  if (!has_levels(config)) std::erase(stages, Stage::levels);
  if (!has_target(config))
    std::erase_if(stages,
                  [](Stage stage) { return stage == Stage::survey || stage == Stage::recount; });
  return stages;
}

bool has_stage(const Config& config, Stage stage) {
  const std::vector<Stage> stages = stages_of(config);
  return std::ranges::find(stages, stage) != stages.end();
}

std::string_view refine_name(SimplifyConfig::Refine mode) {
  const Rule& rule = find_setting("simplify", "refine")->rule;
  return std::get<ChoiceRule>(rule).names[static_cast<std::size_t>(mode)];
}

bool refines(const Config& config) {
  return refine_mode(config) != SimplifyConfig::Refine::off;
}

bool mends(const Config& config) {
  return refines(config) && config.simplify.intersections == SimplifyConfig::Intersections::none;
}

bool only_repairs(const Config& config) {
  return refine_mode(config) == SimplifyConfig::Refine::repair;
}

std::int64_t planned_tile_vertices(const Config& config) {
  const OutputConfig& output = config.output;
  return output.planned_vertices > 0 ? output.planned_vertices : output.tile_vertices;
}

bool has_levels(const Config& config) {
  return config.output.levels != 1;
}

bool Setting::read_by(Stage stage) const {
  return std::ranges::find(stages, stage) != stages.end();
}

std::string Setting::stages_text() const {
  std::vector<std::string_view> names;
  for (const Stage stage : stages) names.push_back(stage_name(stage));
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::string KeyFacts::default_text() const {
  if (!default_note.empty()) return default_note;
  return default_value ? to_toml(*default_value) : "";
}

std::span<const Setting> settings() {
  static const std::vector<Setting> all = make_settings();
  return all;
}

const Setting* find_setting(std::string_view table, std::string_view key) {
  for (const Setting& setting : settings())
    if (setting.table == table && setting.key == key) return &setting;
  return nullptr;
}

std::vector<std::string> table_names() {
  std::vector<std::string> names;
  for (const Setting& setting : settings())
    if (names.empty() || names.back() != setting.table) names.push_back(setting.table);
  return names;
}

std::vector<std::string> key_names(std::string_view table) {
  std::vector<std::string> names;
  for (const Setting& setting : settings())
    if (setting.table == table) names.push_back(setting.key);
  return names;
}

std::string_view table_description(std::string_view table) {
  if (table == "input") return "The volume, and what its file does not say.";
  if (table == "work") return "How the work is cut up and where it is kept.";
  if (table == "surface") return "Which surface to extract.";
  if (table == "labels") return "Label volumes: which labels to mesh, and how.";
  if (table == "simplify") return "How far to simplify the mesh.";
  if (table == "output") return "What to write.";
  if (table == "run") return "What the run may use. Never changes the result.";
  return "How the tasks of run.executor = \"slurm\" are submitted. Never changes the result.";
}

}  // namespace voxweld
