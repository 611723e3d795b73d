#include "pipeline/run/asset_record.h"

#include <nlohmann/json.hpp>

#include "storage/artifact/container.h"
#include "storage/support/error.h"
#include "storage/support/hash_file.h"

namespace voxweld {
namespace {

// A container of kind "asst", version 1, whose key is the asset's; section 1: the rest as JSON,
// "labels" only where it has some. Its input stamp is of the files' sizes and times.
constexpr std::array<char, 4> asset_kind = {'a', 's', 's', 't'};
constexpr std::uint32_t asset_version = 1;

// Sizes and times of the files: as long as they are the same nobody has to read the files, which
// together are as large as the result. Nothing where one is missing or of another size.
std::optional<Hash128> files_stamp(const std::vector<FileRecord>& files,
                                   const std::filesystem::path& output) {
  KeyHasher stamp;
  for (const FileRecord& file : files) {
    if (!std::filesystem::exists(output / file.path)) return std::nullopt;
    const ReadFile opened(output / file.path);
    if (opened.size() != file.bytes) return std::nullopt;
    stamp.integer(static_cast<std::int64_t>(opened.size())).integer(opened.mtime_ns());
  }
  return stamp.finish();
}

nlohmann::json to_json(const LabelAsset& asset) {
  const MeshMeasure& m = asset.measure;
  return {{"label", asset.label},
          {"level", asset.tile.level},
          {"code", asset.tile.code()},
          {"octree_vertices", asset.octree_vertices},
          {"vertices", asset.vertices},
          {"triangles", asset.triangles},
          {"quads", asset.quads},
          {"polygon_triangles", asset.polygon_triangles},
          // The upper half has the sign.
          {"volume6",
           {static_cast<std::int64_t>(m.volume6 >> 64), static_cast<std::uint64_t>(m.volume6)}},
          {"area2", m.area2},
          {"lo", m.lo},
          {"hi", m.hi},
          {"empty", m.empty},
          {"files", asset.files}};
}

LabelAsset label_asset_of(const nlohmann::json& value) {
  LabelAsset asset;
  asset.label = value.at("label");
  asset.tile.level = value.at("level");
  asset.tile.at = morton_decode(value.at("code").get<std::uint64_t>() >> (3 * asset.tile.level));
  asset.octree_vertices = value.at("octree_vertices");
  asset.vertices = value.at("vertices");
  asset.triangles = value.at("triangles");
  asset.quads = value.at("quads");
  asset.polygon_triangles = value.at("polygon_triangles");
  MeshMeasure& m = asset.measure;
  m.volume6 = static_cast<Wide>(value.at("volume6").at(0).get<std::int64_t>()) << 64 |
              static_cast<Wide>(value.at("volume6").at(1).get<std::uint64_t>());
  m.area2 = value.at("area2");
  m.lo = value.at("lo");
  m.hi = value.at("hi");
  m.empty = value.at("empty");
  asset.files = value.at("files");
  return asset;
}

}  // namespace

void write_asset_record(const std::filesystem::path& path, const AssetRecord& record,
                        const std::filesystem::path& output) {
  nlohmann::json files = nlohmann::json::array();
  for (const FileRecord& file : record.files)
    files.push_back({{"path", file.path},
                     {"format", file.format},
                     {"bytes", file.bytes},
                     {"hash", file.xxh3_128}});
  nlohmann::json body = {
      {"vertices", record.vertices},   {"triangles", record.triangles},
      {"quads", record.quads},         {"polygon_triangles", record.polygon_triangles},
      {"collinear", record.collinear}, {"files", files}};
  for (const LabelAsset& asset : record.labels) body["labels"].push_back(to_json(asset));
  const std::string text = body.dump();
  ArtifactWriter writer(path, {asset_kind, asset_version, record.key});
  writer.section(1, as_bytes(text));
  writer.set_input_stamp(files_stamp(record.files, output).value_or(Hash128{}));
  writer.commit();
}

std::optional<AssetRecord> read_asset_record(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const ArtifactReader reader(path, asset_kind, asset_version);
    std::vector<char> text;
    reader.read_array(1, text);
    const nlohmann::json body = nlohmann::json::parse(text.begin(), text.end());
    AssetRecord record;
    record.key = reader.key();
    record.files_stamp = reader.input_stamp();
    record.vertices = body.at("vertices");
    record.triangles = body.at("triangles");
    record.quads = body.at("quads");
    record.polygon_triangles = body.at("polygon_triangles");
    record.collinear = body.at("collinear");
    for (const auto& file : body.at("files"))
      record.files.push_back(
          {file.at("path"), file.at("format"), "", file.at("bytes"), file.at("hash")});
    if (body.contains("labels"))
      for (const auto& asset : body.at("labels")) record.labels.push_back(label_asset_of(asset));
    return record;
  } catch (const DamagedArtifact&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

bool asset_is_current(const std::filesystem::path& record_path, Hash128 key,
                      const std::filesystem::path& output) {
  const auto record = read_asset_record(record_path);
  if (!record || record->key != key) return false;
  const auto stamp = files_stamp(record->files, output);
  if (!stamp) return false;
  if (*stamp == record->files_stamp) return true;
  for (const FileRecord& file : record->files)
    if (to_hex(hash_file(ReadFile(output / file.path))) != file.xxh3_128) return false;
  restamp_artifact(record_path, *stamp);
  return true;
}

FileRecord write_asset(const std::filesystem::path& output, const std::string& name,
                       const std::string& format, std::span<const std::byte> bytes) {
  write_whole_file(output / name, bytes, Durability::fsync);
  return {name, format, "", bytes.size(), to_hex(hash_bytes(bytes))};
}

}  // namespace voxweld
