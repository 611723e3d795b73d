// Work directories, their stages' folders, and configs.
#include <algorithm>
#include <map>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/settings.h"
#include "pipeline/info/kinds.h"
#include "pipeline/stage/file_layout.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

std::string stage_of(const fs::path& folder) {
  const auto stage = stage_of_folder(folder);
  return stage ? std::string(stage_name(*stage)) : std::string();
}

fs::path without_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

struct Contents {
  std::uint64_t files = 0, bytes = 0;
};

// Counts all files below; with `check` reads those that carry checksums of ours.
Contents survey(const fs::path& folder, const InfoOptions& options, CheckResult& check) {
  Contents contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (options.hooks.interrupt != nullptr) options.hooks.interrupt->check();
    std::error_code gone;  // a run may be at work here
    if (!entry.is_regular_file(gone)) continue;
    const auto bytes = entry.file_size(gone);
    if (gone) continue;
    ++contents.files;
    contents.bytes += bytes;
    if (!options.check) continue;
    try {
      if (const auto head = artifact_head(entry.path()))
        check.read(check_artifact(entry.path(), *head));
    } catch (const DamagedArtifact& damage) {
      check.read(bytes);
      check.damaged(damage.path(), std::string(damage.what()).substr(damage.path().size() + 2));
    }
  }
  return contents;
}

// The shards of a store have their checksums in records beside them.
void check_store(const fs::path& folder, const InfoOptions& options, InfoDocument& check) {
  const fs::path array = folder / "volume.zarr";
  if (!fs::exists(array / "zarr.json")) return;
  const InfoDocument store = describe_store(array, options);
  for (const char* key : {"files", "bytes"})
    check[key] = check[key].get<std::uint64_t>() + store["check"][key].get<std::uint64_t>();
  for (const auto& damaged : store["check"]["damaged"])
    if (std::ranges::find(check["damaged"], damaged) == check["damaged"].end())
      check["damaged"].push_back(damaged);
}

std::vector<fs::path> stage_folders(const fs::path& path) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.is_directory() && !stage_of(entry.path()).empty()) folders.push_back(entry.path());
  // In the order the stages run, then by name.
  const auto rank = [](const fs::path& folder) {
    const auto stage = std::ranges::find_if(
        all_stages, [&](Stage s) { return stage_name(s) == stage_of(folder); });
    return std::pair(stage - all_stages.begin(), folder.filename().string());
  };
  std::ranges::sort(folders, {}, rank);
  return folders;
}

InfoDocument value_of(const ConfigValue& value) {
  return std::visit(
      [](const auto& data) -> InfoDocument {
        using T = std::decay_t<decltype(data)>;
        if constexpr (std::is_same_v<T, ConfigValue::List>) {
          InfoDocument list = InfoDocument::array();
          for (const ConfigValue& item : data) list.push_back(value_of(item));
          return list;
        } else if constexpr (std::is_same_v<T, UnusableValue>) {
          return nullptr;
        } else {
          return data;
        }
      },
      value.data);
}

}  // namespace

bool is_stage_directory(const fs::path& path) {
  return !stage_of(without_slash(path)).empty();
}

bool is_work_directory(const fs::path& path) {
  return fs::exists(path / "last-run.toml") || !stage_folders(path).empty();
}

InfoDocument describe_work_directory(const fs::path& path, const InfoOptions& options) {
  InfoDocument document = new_document("work_directory", path);
  CheckResult check;
  const Contents all = survey(path, options, check);
  document["bytes"] = all.bytes;
  document["files"] = all.files;
  document["stages"] = InfoDocument::array();
  InfoDocument checked = check.facts();
  InfoOptions counting = options;
  counting.check = false;  // all of it is checked already
  for (const fs::path& folder : stage_folders(path)) {
    const Contents contents = survey(folder, counting, check);
    document["stages"].push_back({{"stage", stage_of(folder)},
                                  {"folder", folder.filename().string()},
                                  {"files", contents.files},
                                  {"bytes", contents.bytes}});
    if (options.check) check_store(folder, options, checked);
  }
  if (options.check) document["check"] = checked;
  return document;
}

InfoDocument describe_stage_directory(const fs::path& path, const InfoOptions& options) {
  InfoDocument document = new_document("stage_directory", path);
  CheckResult check;
  const Contents contents = survey(path, options, check);
  document["bytes"] = contents.bytes;
  document["stage"] = stage_of(without_slash(path));
  document["files"] = contents.files;
  if (!options.check) return document;
  document["check"] = check.facts();
  check_store(path, options, document["check"]);
  return document;
}

namespace {

template <class Item, class Kind>
void add_items(InfoDocument& document, const ItemTable<Item, Kind>& table,
               const std::vector<Item>& items) {
  for (const Item& item : items) {
    InfoDocument one = InfoDocument::object();
    for (const auto& value : table.values_of(item)) one[value.setting->key] = value_of(value.value);
    document[table.name].push_back(std::move(one));
  }
}

}  // namespace

InfoDocument settings_facts(const Config& config) {
  InfoDocument facts = InfoDocument::object();
  for (const Setting& setting : settings())
    if (const auto value = setting.get(config))
      facts[setting.table][setting.key] = value_of(*value);
  add_items(facts, filter_items(), config.filters);
  add_items(facts, edit_items(), config.edits);
  return facts;
}

InfoDocument describe_config(const fs::path& path) {
  const Config config = load_config(path);
  InfoDocument document = file_document("config", path);
  document["settings"] = settings_facts(config);
  return document;
}

}  // namespace voxweld
