#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/settings.h"

namespace voxweld {
namespace {

std::string shown(const Setting& setting, const Config& config) {
  const auto value = setting.get(config);
  return value ? to_toml(*value) : setting.default_note;
}

void feed_parameter(KeyHasher& hasher, const StageParameter& parameter) {
  hasher.text(parameter.name).integer(parameter.value ? 1 : 0);
  if (parameter.value) feed(hasher, *parameter.value);
}

void feed_edits(KeyHasher& hasher, const std::vector<EditConfig>& edits) {
  hasher.text(edit_table).integer(static_cast<std::int64_t>(edits.size()));
  for (const EditConfig& edit : edits)
    for (const EditValue& value : values_of(edit)) feed(hasher, value.value);
}

// Which values a filter has depends on its type, so each is fed with its key.
void feed_filters(KeyHasher& hasher, const std::vector<FilterConfig>& filters) {
  hasher.text(filter_table).integer(static_cast<std::int64_t>(filters.size()));
  for (const FilterConfig& filter : filters) {
    const auto values = filter_items().values_of(filter);
    hasher.integer(static_cast<std::int64_t>(values.size()));
    for (const auto& value : values) feed(hasher.text(value.setting->key), value.value);
  }
}

// Pieces are of what is inside the surface: where it lies decides what their filters do.
bool filters_see_surface(const Config& config) {
  return std::ranges::any_of(config.filters, &FilterConfig::is_global);
}
// isovalue is a number or the name of a rule.
bool is_seen_by_filters(const Setting& setting) {
  return setting.table == "surface" && (setting.key == "isovalue" || setting.key == "inside");
}

template <class Item, class Kind>
std::string shown(const ItemSetting<Item, Kind>& setting, const Item& item) {
  const auto value = setting.get(item);
  return value ? to_toml(*value) : setting.default_note;
}

// Another kind has other keys, so it is told alone.
template <class Item, class Kind>
std::vector<ChangedSetting> changed_keys(const ItemTable<Item, Kind>& table, const Item& before,
                                         const Item& after, std::size_t number) {
  std::vector<ChangedSetting> changed;
  const Kind kind = before.*table.kind;
  for (const auto& setting : table.settings) {
    const bool compared =
        kind == after.*table.kind ? setting.taken_by(kind) : setting.key == table.kind_key;
    if (compared && setting.get(before) != setting.get(after))
      changed.push_back({nullptr,
                         fmt::format("{} {}: {}", table.name, number, setting.key),
                         shown(setting, before),
                         shown(setting, after),
                         {table.stage}});
  }
  return changed;
}

template <class Item, class Kind>
std::vector<ChangedSetting> changed_items(const ItemTable<Item, Kind>& table,
                                          const std::vector<Item>& before,
                                          const std::vector<Item>& after) {
  if (before.size() != after.size())
    return {{nullptr,
             fmt::format("number of {}s", table.name),
             std::to_string(before.size()),
             std::to_string(after.size()),
             {table.stage}}};
  std::vector<std::size_t> numbers;  // from 1
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i] != after[i]) numbers.push_back(i + 1);
  if (numbers.empty()) return {};
  const std::size_t first = numbers.front();
  if (numbers.size() == 1) return changed_keys(table, before[first - 1], after[first - 1], first);
  constexpr std::size_t most_told = 5;
  const std::size_t untold = numbers.size() - std::min(numbers.size(), most_told);
  numbers.resize(numbers.size() - untold);
  const std::string more = untold > 0 ? fmt::format(" and {} more", untold) : "";
  return {{nullptr,
           fmt::format("{}s {}{}", table.name, fmt::join(numbers, ", "), more),
           {},
           {},
           {table.stage}}};
}

// The stages that read the setting in one of the two.
std::vector<Stage> readers_of(const Setting& setting, const Config& before, const Config& after) {
  std::vector<Stage> stages = setting.stages;
  if (is_seen_by_filters(setting) && (filters_see_surface(before) || filters_see_surface(after)))
    stages.push_back(Stage::ingest);
  return stages;
}

}  // namespace

bool ChangedSetting::read_by(Stage stage) const {
  return std::ranges::find(stages, stage) != stages.end();
}

std::string ChangedSetting::text() const {
  if (before.empty() && after.empty()) return name + " changed";
  return fmt::format("{} was {}, is {}", name, before, after);
}

std::vector<StageParameter> stage_parameters(const Config& config, Stage stage) {
  std::vector<StageParameter> parameters;
  for (const Setting& setting : settings())
    if (setting.read_by(stage) && !setting.by_effect &&
        !(setting.when_given && !setting.get(config)))
      parameters.push_back({setting.name(), setting.get(config)});
  return parameters;
}

Hash128 parameter_hash(const Config& config, Stage stage) {
  KeyHasher hasher;
  hasher.text(stage_name(stage));
  for (const StageParameter& parameter : stage_parameters(config, stage))
    feed_parameter(hasher, parameter);
  // A config without filters keeps the keys it had before there were any.
  if (stage == Stage::ingest && !config.filters.empty()) {
    feed_filters(hasher, config.filters);
    for (const Setting& setting : settings())
      if (filters_see_surface(config) && is_seen_by_filters(setting))
        feed_parameter(hasher, {setting.name(), setting.get(config)});
  }
  return hasher.finish();
}

std::vector<ChangedSetting> changed_settings(const Config& before, const Config& after) {
  std::vector<ChangedSetting> changed;
  for (const Setting& setting : settings())
    if (setting.get(before) != setting.get(after))
      changed.push_back({&setting, setting.name(), shown(setting, before), shown(setting, after),
                         readers_of(setting, before, after)});
  for (ChangedSetting& change : changed_items(filter_items(), before.filters, after.filters))
    changed.push_back(std::move(change));
  for (ChangedSetting& change : changed_items(edit_items(), before.edits, after.edits))
    changed.push_back(std::move(change));
  return changed;
}

Hash128 result_hash(const Config& config) {
  KeyHasher hasher;
  for (const Stage stage : stages_of(config)) hasher.hash(parameter_hash(config, stage));
  Config asked = config;
  asked.simplify.refine = refine_mode(config);
  for (const Setting& setting : settings())
    if (const auto value = setting.get(asked); setting.by_effect && value != setting.default_value)
      feed_parameter(hasher, {setting.name(), value});
  return hasher.text(config.input.path.string()).finish();
}

Hash128 config_fingerprint(const Config& config) {
  KeyHasher hasher;
  for (const Setting& setting : settings())
    feed_parameter(hasher, {setting.name(), setting.get(config)});
  // A config without filters or edits keeps the fingerprint it had before there were any.
  if (!config.filters.empty()) feed_filters(hasher, config.filters);
  if (!config.edits.empty()) feed_edits(hasher, config.edits);
  return hasher.finish();
}

}  // namespace voxweld
