#include "pipeline/neuroglancer/folder_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>

#include "pipeline/neuroglancer/folder.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// The number before `ending`, where that is all there is.
std::optional<std::uint64_t> numbered(const std::string& name, std::string_view ending) {
  if (!name.ends_with(ending)) return std::nullopt;
  std::uint64_t id = 0;
  const char* end = name.data() + name.size() - ending.size();
  const auto [at, error] = std::from_chars(name.data(), end, id);
  if (error != std::errc() || at != end) return std::nullopt;
  return id;
}

nlohmann::json read_json(const fs::path& path) {
  nlohmann::json json = nlohmann::json::parse(read_text_file(path), nullptr, false);
  if (!json.is_object()) throw FormatError(path.string() + ": is no JSON object");
  return json;
}

std::vector<std::uint64_t> read_numbers(const ReadFile& file, std::uint64_t offset,
                                        std::uint64_t bytes) {
  if (offset + bytes < offset || offset + bytes > file.size() || bytes % 8 != 0)
    throw FormatError(fmt::format("{}: names {} bytes at {}, and has {}", file.path(), bytes,
                                  offset, file.size()));
  std::vector<std::uint64_t> numbers(bytes / 8);
  file.read(offset, std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

}  // namespace

bool is_export_folder(const fs::path& folder) {
  return fs::exists(folder / info_name) && !fs::exists(folder / manifest_name);
}

FolderReader::FolderReader(fs::path folder) : folder_(std::move(folder)) {
  const fs::path path = folder_ / info_name;
  if (!fs::exists(path))
    throw InputError(folder_.string() +
                     ": has no `info`: no export was finished there; run `voxweld export` again");
  const nlohmann::json info = read_json(path);
  try {
    const std::string type = info.at("@type").get<std::string>();
    legacy_ = type == "neuroglancer_legacy_mesh";
    if (!legacy_ && type != "neuroglancer_multilod_draco")
      throw FormatError(
          fmt::format("{}: is of type {}, which voxweld does not write", path.string(), type));
    if (!info.contains("generator"))
      throw InputError(path.string() + ": was not written by voxweld, which reads its own alone");
    if (!legacy_ && info.at("vertex_quantization_bits").get<int>() != fragment_bits)
      throw FormatError(path.string() + ": expected 16 bits for positions");
    open_border_ = info.value("border", "closed") == "open";
    if (info.contains("sharding")) {
      const nlohmann::json& sharding = info.at("sharding");
      sharding_ =
          Sharding{sharding.at("minishard_bits").get<int>(), sharding.at("shard_bits").get<int>()};
      if (sharding_->minishard_bits < 0 || sharding_->minishard_bits > 24 ||
          sharding_->shard_bits < 0 || sharding_->shard_bits > 40)
        throw FormatError(path.string() + ": states more shards than there can be");
    }
  } catch (const nlohmann::json::exception& e) {
    throw FormatError(fmt::format("{}: {}", path.string(), e.what()));
  }
  if (sharding_)
    find_shards();
  else
    find_files();
}

void FolderReader::find_files() {
  for (const auto& entry : fs::directory_iterator(folder_))
    if (const auto id = numbered(entry.path().filename().string(), legacy_ ? ":0" : ".index"))
      ids_.push_back(*id);
  std::ranges::sort(ids_);
}

void FolderReader::find_shards() {
  for (const auto& entry : fs::directory_iterator(folder_))
    if (entry.path().extension() == ".shard") read_shard(entry.path());
  for (const auto& [id, place] : manifests_) ids_.push_back(id);
}

void FolderReader::read_shard(const fs::path& path) {
  const ReadFile file(path);
  const std::uint64_t minishards = std::uint64_t{1} << sharding_->minishard_bits;
  const std::uint64_t begin = 16 * minishards;
  const std::vector<std::uint64_t> ends = read_numbers(file, 0, begin);
  for (std::uint64_t m = 0; m < minishards; ++m) {
    if (ends[2 * m + 1] < ends[2 * m])
      throw FormatError(fmt::format("{}: minishard {} ends before it begins", path.string(), m));
    const auto numbers = read_numbers(file, begin + ends[2 * m], ends[2 * m + 1] - ends[2 * m]);
    const std::size_t n = numbers.size() / 3;
    std::uint64_t id = 0, offset = begin;
    for (std::size_t i = 0; i < n; ++i) {
      id += numbers[i];
      offset += numbers[n + i];
      if (sharding_->minishard(id) != m)
        throw FormatError(fmt::format("{}: minishard {} has object {}", path.string(), m, id));
      manifests_[id] = {path, offset, numbers[2 * n + i]};
      offset += numbers[2 * n + i];
    }
  }
}

ExportedObject FolderReader::object(std::uint64_t id) const {
  ExportedObject object;
  object.id = id;
  if (!sharding_) {
    object.data = folder_ / fmt::to_string(id);
    const fs::path path = folder_ / fmt::format("{}.index", id);
    object.index = read_index(read_whole_file(path), path.string());
    return object;
  }
  const Place& place = manifests_.at(id);
  const ReadFile file(place.file);
  object.data = place.file;
  if (place.offset + place.size > file.size())
    throw FormatError(fmt::format("{}: object {} lies past its end", file.path(), id));
  std::vector<std::byte> bytes(place.size);
  file.read(place.offset, bytes);
  object.index = read_index(bytes, fmt::format("{}: object {}", file.path(), id));
  std::uint64_t data = 0;
  for (const FragmentLevel& level : object.index.levels)
    for (const FragmentEntry& fragment : level.fragments) data += fragment.bytes;
  if (data > place.offset)
    throw FormatError(
        fmt::format("{}: object {} has more fragments than the file", file.path(), id));
  object.offset = place.offset - data;
  return object;
}

FragmentMesh FolderReader::fragment(const ExportedObject& object, const FragmentEntry& entry,
                                    std::uint64_t offset) const {
  std::vector<std::byte> bytes(entry.bytes);
  ReadFile(object.data).read(object.offset + offset, bytes);
  return decode_fragment(bytes, fmt::format("{}: fragment of {} bytes at {}", object.data.string(),
                                            entry.bytes, object.offset + offset));
}

std::vector<std::string> FolderReader::legacy_names(std::uint64_t id) const {
  const fs::path path = folder_ / fmt::format("{}:0", id);
  try {
    return read_json(path).at("fragments").get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception& e) {
    throw FormatError(fmt::format("{}: {}", path.string(), e.what()));
  }
}

LegacyMesh FolderReader::legacy_fragment(const std::string& name) const {
  const fs::path path = folder_ / name;
  const std::vector<std::byte> bytes = read_whole_file(path);
  const auto damaged = [&](const std::string& what) {
    throw FormatError(fmt::format("{}: {}", path.string(), what));
  };
  std::uint32_t vertices = 0;
  if (bytes.size() < 4) damaged("is no fragment: it ends too early");
  std::memcpy(&vertices, bytes.data(), 4);
  const std::uint64_t positions = std::uint64_t{12} * vertices;
  if (bytes.size() - 4 < positions || (bytes.size() - 4 - positions) % 12 != 0)
    damaged(fmt::format("states {} vertices in {} bytes", vertices, bytes.size()));
  LegacyMesh mesh;
  mesh.positions.resize(vertices);
  mesh.triangles.resize((bytes.size() - 4 - positions) / 12);
  std::memcpy(mesh.positions.data(), bytes.data() + 4, positions);
  std::memcpy(mesh.triangles.data(), bytes.data() + 4 + positions, 12 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v >= vertices) damaged(fmt::format("a triangle names vertex {} of {}", v, vertices));
  return mesh;
}

}  // namespace voxweld
