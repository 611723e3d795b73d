// Folders that are made of an output: exports for Neuroglancer, and the viewer's page.
#include <nlohmann/json.hpp>

#include "pipeline/info/kinds.h"
#include "pipeline/neuroglancer/folder.h"
#include "pipeline/neuroglancer/folder_check.h"
#include "pipeline/neuroglancer/folder_reader.h"
#include "pipeline/view/viewer_folder.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// No `info` of an export comes near it.
constexpr std::uint64_t most_info_bytes = std::uint64_t{1} << 20;

struct LevelSum {
  std::uint64_t objects = 0, fragments = 0, bytes = 0;
};

// Of the fragments that have triangles; the finest level first.
std::vector<LevelSum> levels_of(const FolderReader& reader, const fs::path& folder,
                                std::uint64_t id) {
  std::vector<LevelSum> levels;
  if (reader.legacy()) {
    levels.push_back({1});
    for (const std::string& name : reader.legacy_names(id)) {
      ++levels[0].fragments;
      levels[0].bytes += fs::file_size(folder / name);
    }
    return levels;
  }
  for (const FragmentLevel& level : reader.object(id).index.levels) {
    LevelSum& sum = levels.emplace_back();
    for (const FragmentEntry& fragment : level.fragments) {
      sum.fragments += fragment.bytes > 0 ? 1 : 0;
      sum.bytes += fragment.bytes;
    }
    sum.objects = sum.fragments > 0 ? 1 : 0;
  }
  return levels;
}

InfoDocument facts_of(std::uint64_t id, const std::vector<LevelSum>& levels) {
  LevelSum all;
  for (const LevelSum& level : levels) {
    all.fragments += level.fragments;
    all.bytes += level.bytes;
  }
  return {{"object", id},
          {"levels", levels.size()},
          {"fragments", all.fragments},
          {"bytes", all.bytes}};
}

void add(std::vector<LevelSum>& sums, const std::vector<LevelSum>& levels) {
  if (sums.size() < levels.size()) sums.resize(levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    sums[i].objects += levels[i].objects;
    sums[i].fragments += levels[i].fragments;
    sums[i].bytes += levels[i].bytes;
  }
}

InfoDocument facts_of(const std::vector<LevelSum>& sums) {
  InfoDocument levels = InfoDocument::array();
  for (std::size_t i = 0; i < sums.size(); ++i)
    levels.push_back({{"level", i},
                      {"objects", sums[i].objects},
                      {"fragments", sums[i].fragments},
                      {"bytes", sums[i].bytes}});
  return levels;
}

void count_files(const fs::path& folder, InfoDocument& document) {
  std::uint64_t files = 0, bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    ++files;
    bytes += entry.file_size();
  }
  document["bytes"] = bytes;
  document["files"] = files;
}

}  // namespace

bool is_neuroglancer_export(const fs::path& folder) {
  if (!is_export_folder(folder)) return false;
  const fs::path info = folder / info_name;
  if (!fs::is_regular_file(info) || fs::file_size(info) > most_info_bytes) return false;
  const auto json = nlohmann::json::parse(read_text_file(info), nullptr, false);
  if (!json.is_object() || !json.contains("@type") || !json["@type"].is_string()) return false;
  const std::string type = json["@type"];
  return type == "neuroglancer_legacy_mesh" || type == "neuroglancer_multilod_draco";
}

std::optional<InfoDocument> describe_viewer_folder(const fs::path& folder) {
  const auto shown = shown_in_viewer_folder(folder);
  if (!shown) return std::nullopt;
  InfoDocument document = new_document("viewer_folder", folder);
  count_files(folder, document);
  document["shown"] = *shown;
  return document;
}

InfoDocument describe_export(const fs::path& folder, const InfoOptions& options) {
  const FolderReader reader(folder);
  InfoDocument document = new_document("neuroglancer_export", folder);
  count_files(folder, document);
  document["format"] = reader.legacy() ? "legacy" : "multilod_draco";
  document["sharded"] = reader.sharding().has_value();
  document["border"] = reader.open_border() ? "open" : "closed";
  document["objects"] = reader.ids().size();
  std::vector<LevelSum> sums;
  InfoDocument objects = InfoDocument::array();
  for (const std::uint64_t id : reader.ids()) {
    if (options.hooks.interrupt != nullptr) options.hooks.interrupt->check();
    const std::vector<LevelSum> levels = levels_of(reader, folder, id);
    add(sums, levels);
    if (options.verbose) objects.push_back(facts_of(id, levels));
  }
  document["levels"] = facts_of(sums);
  if (options.verbose) document["object_list"] = objects;
  if (!options.check) return document;
  document["check"] = {{"files", document["files"]},
                       {"bytes", document["bytes"]},
                       {"damaged", InfoDocument::array()}};
  for (const std::string& problem : check_folder(folder, 0, options.hooks.interrupt).problems)
    document["check"]["damaged"].push_back({{"path", folder.string()}, {"what", problem}});
  return document;
}

}  // namespace voxweld
