#include "pipeline/run/last_config.h"

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

std::filesystem::path last_path(const Config& config) {
  return config.work.directory / last_config_name;
}

}  // namespace

void write_last_config(const Config& config) {
  write_whole_file(last_path(config), as_bytes(canonical_toml(config)), Durability::rename_only);
}

std::string changed_since_last(const Config& config, Stage stage) {
  if (!std::filesystem::exists(last_path(config))) return "nothing was run here before";
  std::string text;
  try {
    for (const ChangedSetting& change : changed_settings(load_config(last_path(config)), config)) {
      if (!change.read_by(stage)) continue;
      if (!text.empty()) text += ", ";
      text += change.text();
    }
  } catch (const Error&) {
    return {};  // an older config that is no longer valid: nothing to compare with
  }
  return text;
}

}  // namespace voxweld
