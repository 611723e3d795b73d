#include "pipeline/view/viewer_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "pipeline/view/page_files.h"
#include "pipeline/view/scene.h"
#include "stages/encode/mesh_writers.h"
#include "storage/manifest/manifest.h"
#include "storage/support/claim_folder.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* data_name = "data";

bool is_ours(const fs::directory_entry& entry) {
  if (entry.is_symlink()) return false;
  const std::string name = entry.path().filename().string();
  if (!entry.is_directory() && !entry.is_regular_file()) return false;
  const auto begins = [&](const PageFile& file) {
    return file.name == name || file.name.starts_with(name + "/");
  };
  return name == "api" || name == data_name || std::ranges::any_of(page_files(), begins);
}

// Its "name".
std::optional<std::string> name_in_scene(const fs::path& path) {
  const auto json = nlohmann::json::parse(read_text_file(path), nullptr, false);
  if (!json.is_object() || !json.contains("format") || json["format"] != "voxweld-scene" ||
      !json.contains("name") || !json["name"].is_string())
    return std::nullopt;
  return json["name"].get<std::string>();
}

bool is_scene(const fs::path& path) {
  return name_in_scene(path).has_value();
}

// Where the shown file or directory lies in an output of a run, that; else itself.
fs::path output_around(const fs::path& shown) {
  for (fs::path at = fs::weakly_canonical(shown); at.has_relative_path(); at = at.parent_path())
    if (fs::is_regular_file(at / manifest_name)) return at;
  return shown;
}

// Which files of a scene the page asks for, and the scene with these alone.
class Choice {
 public:
  Choice(const ServedFiles& shown, Json scene) : shown_(shown), scene_(std::move(scene)) {
    scene_.erase("report");
    if (scene_.at("kind") == "file")
      take(scene_.at("file"));
    else if (scene_.contains("tileset"))
      choose_tileset();
    else if (Json& tiles = scene_.at("tiles"); !tiles.empty())
      choose_of(tiles);
    else
      choose_merged();
  }

  const Json& scene() const { return scene_; }
  // By path: how many bytes the output's lists say.
  const std::map<std::string, std::uint64_t>& files() const { return files_; }

 private:
  void take(const Json& file) { files_[file.at("path")] = file.at("bytes"); }
  // Leaves files of this format, and takes them.
  void keep(Json& files, const std::string& format) {
    Json kept = Json::array();
    for (const Json& file : files)
      if (file.at("format") == format) {
        take(file);
        kept.push_back(file);
      }
    files = std::move(kept);
  }
  static std::string smallest(const std::map<std::string, std::uint64_t>& bytes) {
    if (bytes.empty()) return {};
    return std::ranges::min_element(bytes, {}, [](const auto& one) { return one.second; })->first;
  }

  void choose_tileset() {
    std::set<std::string, std::less<>> formats;
    for (const Json& tile : scene_.at("tiles"))
      for (const Json& file : tile.at("files")) formats.insert(file.at("format"));
    const auto format =
        std::ranges::find_if(tileset_formats, [&](auto name) { return formats.contains(name); });
    if (format == tileset_formats.end()) return choose_of(scene_.at("tiles"));
    for (Json& tile : scene_.at("tiles")) keep(tile.at("files"), std::string(*format));
    scene_.at("merged") = Json::array();
    for (const FileRecord& file : read_manifest(shown_.path() / manifest_name).files)
      if (file.role == "tileset") files_[file.path] = file.bytes;
    TileListReader levels(shown_.path() / levels_name);
    while (const auto tile = levels.next())
      for (const FileRecord& file : tile->files)
        if (file.format == *format) files_[file.path] = file.bytes;
  }
  void choose_of(Json& tiles) {
    std::map<std::string, std::uint64_t> bytes;
    for (const Json& tile : tiles)
      for (const Json& file : tile.at("files"))
        bytes[file.at("format")] += file.at("bytes").get<std::uint64_t>();
    const std::string format = smallest(bytes);
    for (Json& tile : tiles) keep(tile.at("files"), format);
    scene_.at("merged") = Json::array();
    scene_.erase("tileset");
  }
  void choose_merged() {
    std::map<std::string, std::uint64_t> bytes;
    for (const Json& file : scene_.at("merged"))
      bytes[file.at("format")] = file.at("bytes").get<std::uint64_t>();
    keep(scene_.at("merged"), smallest(bytes));
  }

  const ServedFiles& shown_;
  Json scene_;
  std::map<std::string, std::uint64_t> files_;
};

class Writer {
 public:
  Writer(const fs::path& folder, const std::function<void()>& between)
      : folder_(folder), between_(between) {}

  void put(const std::string& name, std::span<const std::byte> bytes) {
    begin(name);
    AtomicFile file(folder_ / name);
    file.append(bytes);
    file.commit(Durability::fsync);
    count(bytes.size());
  }
  // In pieces: a file may be larger than memory.
  void copy(const fs::path& from, const std::string& name, std::uint64_t bytes) {
    begin(name);
    const ReadFile source(from);
    if (source.size() != bytes)
      throw InputError(fmt::format(
          "{}: has {} bytes, the output's lists say {}; wait until the run that writes it is done, "
          "or run `voxweld verify`",
          from.string(), source.size(), bytes));
    AtomicFile file(folder_ / name);
    std::vector<std::byte> piece;
    for (std::uint64_t at = 0; at < bytes; at += piece.size()) {
      between_();
      piece.resize(static_cast<std::size_t>(std::min<std::uint64_t>(bytes - at, piece_bytes)));
      source.read(at, piece);
      file.append(piece);
    }
    file.commit(Durability::fsync);
    count(bytes);
  }
  const ViewerFolderTotals& totals() const { return totals_; }

 private:
  static constexpr std::uint64_t piece_bytes = std::uint64_t{1} << 20;
  void begin(const std::string& name) {
    between_();
    make_directories((folder_ / name).parent_path());
  }
  void count(std::uint64_t bytes) {
    ++totals_.files;
    totals_.bytes += bytes;
  }

  const fs::path& folder_;
  const std::function<void()>& between_;
  ViewerFolderTotals totals_;
};

}  // namespace

ViewerFolderTotals write_viewer_folder(const fs::path& shown, const fs::path& folder,
                                       const ViewerFolderOptions& options) {
  require_page();
  const ServedFiles files(shown);
  check_viewable(files);
  const Choice choice(files, Json::parse(scene_text(files)));
  claim_folder({folder, output_around(shown), options.force, "--export", is_ours,
                exported_scene_name, is_scene});
  Writer writer(folder, options.between);
  for (const PageFile& file : page_files())
    writer.put(std::string(file.name), std::as_bytes(std::span(file.bytes)));
  for (const auto& [path, bytes] : choice.files()) {
    const auto from = files.find(path);
    if (!from)
      throw InputError(fmt::format(
          "{}: is missing, or no file; the output's lists name it. `voxweld verify` says more",
          (shown / path).string()));
    writer.copy(*from, std::string(data_name) + "/" + path, bytes);
  }
  // Last, since it says that all else is there.
  const std::string scene = json_text(choice.scene()) + "\n";
  writer.put(exported_scene_name, as_bytes(scene));
  return writer.totals();
}

std::optional<std::string> shown_in_viewer_folder(const fs::path& folder) {
  const fs::path scene = folder / exported_scene_name;
  if (!fs::is_regular_file(scene) || !fs::is_regular_file(folder / "index.html"))
    return std::nullopt;
  return name_in_scene(scene);
}

}  // namespace voxweld
