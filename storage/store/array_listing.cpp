#include "storage/store/array_listing.h"

#include <algorithm>

#include "storage/store/n5.h"
#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"

namespace voxweld {
namespace {

constexpr std::size_t most_datasets = 256, most_folders = 4096;
constexpr int most_depth = 8;

bool is_zarr_array(const StoreFolder& folder) {
  if (folder.holds(".zarray")) return true;
  const auto text = folder.text("zarr.json");
  if (!text) return false;
  const std::string file = (folder / "zarr.json").name();
  const nlohmann::ordered_json document = parse_zarr_document(*text, file);
  // What is neither is left to the parser, who says so.
  return !document.is_object() || !document.contains("node_type") ||
         document.at("node_type") != "group";
}

struct Listing {
  ArrayFamily family;
  std::vector<std::string> found;
  std::size_t folders = 0;

  void add_below(const StoreFolder& folder, const std::string& path,
                 const std::vector<Pyramid>& pyramids, int depth) {
    const auto names = folder.list();
    if (!names || depth == most_depth) return;
    for (const std::string& name : *names) {
      if (found.size() >= most_datasets || folders >= most_folders) return;
      const StoreFolder child = folder / name;
      if (name.starts_with('.') || name.ends_with(".json") || in_pyramid(name, pyramids)) continue;
      ++folders;
      add(child, path.empty() ? name : path + '/' + name, depth + 1);
    }
  }

 private:
  void add(const StoreFolder& folder, const std::string& path, int depth) {
    FolderContents contents;
    try {
      contents = contents_of(folder, family);
    } catch (const FormatError&) {
      return;  // not for a list to judge: named by itself it says what is wrong
    }
    if (contents.array || !contents.pyramids.empty()) found.push_back(path);
    if (!contents.array) add_below(folder, path, contents.pyramids, depth);
  }

  // Folders that only lead to the arrays of a pyramid are none of their own.
  static bool in_pyramid(const std::string& name, const std::vector<Pyramid>& pyramids) {
    for (const Pyramid& pyramid : pyramids)
      for (const Pyramid::Level& level : pyramid.levels)
        if (level.path == name || level.path.starts_with(name + '/')) return true;
    return false;
  }
};

}  // namespace

FolderContents contents_of(const StoreFolder& folder, ArrayFamily family) {
  FolderContents contents;
  if (family == ArrayFamily::n5) {
    const auto text = folder.text("attributes.json");
    contents.array = text && is_n5_array(*text);
    if (auto pyramid = contents.array ? std::nullopt : n5_pyramid_of(folder))
      contents.pyramids.push_back(std::move(*pyramid));
    return contents;
  }
  contents.pyramids = ome_pyramids_of(folder);
  contents.array = contents.pyramids.empty() && is_zarr_array(folder);
  return contents;
}

std::vector<std::string> datasets_below(const StoreFolder& folder, ArrayFamily family) {
  Listing listing{family, {}};
  const FolderContents contents = contents_of(folder, family);
  listing.add_below(folder, "", contents.pyramids, 0);
  return std::move(listing.found);
}

}  // namespace voxweld
