#include <algorithm>

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

}  // namespace

std::vector<StageParameter> stage_parameters(const Config& config, Stage stage) {
  std::vector<StageParameter> parameters;
  for (const Setting& setting : settings())
    if (setting.read_by(stage)) parameters.push_back({setting.name(), setting.get(config)});
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
      changed.push_back({&setting, shown(setting, before), shown(setting, after)});
  return changed;
}

Hash128 config_fingerprint(const Config& config) {
  KeyHasher hasher;
  for (const Setting& setting : settings())
    feed_parameter(hasher, {setting.name(), setting.get(config)});
  return hasher.finish();
}

}  // namespace voxweld
