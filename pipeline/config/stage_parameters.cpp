#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>

#include "pipeline/config/edit_settings.h"
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

// Another shape has other keys, so it is told alone.
std::vector<ChangedSetting> changed_keys(const EditConfig& before, const EditConfig& after,
                                         std::size_t number) {
  std::vector<ChangedSetting> changed;
  for (const EditSetting& setting : edit_settings()) {
    const bool compared =
        before.shape == after.shape ? setting.taken_by(before.shape) : setting.key == "shape";
    if (compared && setting.get(before) != setting.get(after))
      changed.push_back({nullptr, fmt::format("edit {}: {}", number, setting.key),
                         to_toml(setting.get(before)), to_toml(setting.get(after))});
  }
  return changed;
}

std::vector<ChangedSetting> changed_edits(const std::vector<EditConfig>& before,
                                          const std::vector<EditConfig>& after) {
  if (before.size() != after.size())
    return {
        {nullptr, "number of edits", std::to_string(before.size()), std::to_string(after.size())}};
  std::vector<std::size_t> numbers;  // from 1
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i] != after[i]) numbers.push_back(i + 1);
  if (numbers.empty()) return {};
  const std::size_t first = numbers.front();
  if (numbers.size() == 1) return changed_keys(before[first - 1], after[first - 1], first);
  constexpr std::size_t most_told = 5;
  const std::size_t untold = numbers.size() - std::min(numbers.size(), most_told);
  numbers.resize(numbers.size() - untold);
  const std::string more = untold > 0 ? fmt::format(" and {} more", untold) : "";
  return {{nullptr, fmt::format("edits {}{}", fmt::join(numbers, ", "), more), {}, {}}};
}

}  // namespace

bool ChangedSetting::read_by(Stage stage) const {
  return setting == nullptr ? stage == Stage::build : setting->read_by(stage);
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
  return hasher.finish();
}

std::vector<ChangedSetting> changed_settings(const Config& before, const Config& after) {
  std::vector<ChangedSetting> changed;
  for (const Setting& setting : settings())
    if (setting.get(before) != setting.get(after))
      changed.push_back({&setting, setting.name(), shown(setting, before), shown(setting, after)});
  for (ChangedSetting& change : changed_edits(before.edits, after.edits))
    changed.push_back(std::move(change));
  return changed;
}

Hash128 result_hash(const Config& config) {
  KeyHasher hasher;
  for (const Stage stage : all_stages) hasher.hash(parameter_hash(config, stage));
  return hasher.text(config.input.path.string()).finish();
}

Hash128 config_fingerprint(const Config& config) {
  KeyHasher hasher;
  for (const Setting& setting : settings())
    feed_parameter(hasher, {setting.name(), setting.get(config)});
  // A config without edits keeps the fingerprint it had before there were any.
  if (!config.edits.empty()) feed_edits(hasher, config.edits);
  return hasher.finish();
}

}  // namespace voxweld
