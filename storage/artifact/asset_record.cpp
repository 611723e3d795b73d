#include "storage/artifact/asset_record.h"

#include <nlohmann/json.hpp>

#include "storage/artifact/container.h"
#include "storage/support/error.h"
#include "storage/support/hash_file.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

// A container of kind "asst" whose key is the asset's; section 1: the files and counts as JSON,
// section 2: LabelAssetRecord, only where it has labels. Its input stamp is of the files' sizes and
// times.
constexpr std::array<char, 4> asset_kind = {'a', 's', 's', 't'};
constexpr std::uint32_t asset_version = 3;
constexpr std::uint64_t body_section = 1, labels_section = 2;

// Sizes and times of the files: as long as they are the same nobody has to read the files, which
// together are as large as the result. Nothing where one is missing or of another size.
std::optional<Hash128> files_stamp(const std::vector<FileRecord>& files,
                                   const std::filesystem::path& output) {
  KeyHasher stamp;
  for (const FileRecord& file : files) {
    // A link to itself is no file either.
    if (std::error_code unknown; !std::filesystem::exists(output / file.path, unknown))
      return std::nullopt;
    const ReadFile opened(output / file.path);
    if (opened.size() != file.bytes) return std::nullopt;
    const FileState& state = opened.state();
    stamp.integer(static_cast<std::int64_t>(state.size));
    stamp.integer(state.mtime_ns).integer(state.ctime_ns);
  }
  return stamp.finish();
}

// A label's line of section 2, as it lies in memory.
struct LabelAssetRecord {
  std::uint64_t label, level, code, octree_vertices, vertices, triangles, quads, polygon_triangles,
      files, empty;
  std::array<std::uint64_t, 2> volume6;  // the lower half first
  double area2;
  LatticePoint lo, hi;
};
static_assert(sizeof(LabelAssetRecord) == 13 * 8 + 24);

LabelAssetRecord packed(const LabelAsset& asset) {
  const MeshMeasure& m = asset.measure;
  return {asset.label,
          static_cast<std::uint64_t>(asset.tile.level),
          asset.tile.code(),
          asset.octree_vertices,
          asset.vertices,
          asset.triangles,
          asset.quads,
          asset.polygon_triangles,
          asset.files,
          m.empty ? 1U : 0U,
          {static_cast<std::uint64_t>(m.volume6), static_cast<std::uint64_t>(m.volume6 >> 64)},
          m.area2,
          m.lo,
          m.hi};
}

LabelAsset unpacked(const LabelAssetRecord& record) {
  LabelAsset asset;
  asset.label = record.label;
  asset.tile = CellKey::of(record.code, record.level);
  asset.octree_vertices = record.octree_vertices;
  asset.vertices = record.vertices;
  asset.triangles = record.triangles;
  asset.quads = record.quads;
  asset.polygon_triangles = record.polygon_triangles;
  asset.files = record.files;
  MeshMeasure& m = asset.measure;
  // The upper half has the sign.
  m.volume6 = static_cast<Wide>(static_cast<std::int64_t>(record.volume6[1])) << 64 |
              static_cast<Wide>(record.volume6[0]);
  m.area2 = record.area2;
  m.lo = record.lo;
  m.hi = record.hi;
  m.empty = record.empty != 0;
  return asset;
}

void read_labels(const ArtifactReader& reader, std::vector<LabelAsset>& labels) {
  if (reader.find(labels_section) == nullptr) return;
  std::vector<LabelAssetRecord> records;
  reader.read_array(labels_section, records);
  labels.reserve(records.size());
  for (const LabelAssetRecord& record : records) {
    if (record.level > max_levels) reader.damaged("a label's tile is of no level");
    labels.push_back(unpacked(record));
  }
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
  if (record.box) body["box"] = {record.box->lo, record.box->hi};
  const std::string text = json_text(body);
  ArtifactWriter writer(path, {asset_kind, asset_version, record.key});
  writer.section(body_section, as_bytes(text));
  if (!record.labels.empty()) {
    std::vector<LabelAssetRecord> labels;
    labels.reserve(record.labels.size());
    for (const LabelAsset& asset : record.labels) labels.push_back(packed(asset));
    writer.section(labels_section, as_section(labels));
  }
  writer.set_input_stamp(files_stamp(record.files, output).value_or(Hash128{}));
  writer.commit();
}

std::optional<AssetRecord> read_asset_record(const std::filesystem::path& path, RecordParts parts) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const ArtifactReader reader(path, asset_kind, asset_version);
    std::vector<char> text;
    reader.read_array(body_section, text);
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
    if (body.contains("box")) record.box = {body["box"].at(0), body["box"].at(1)};
    if (parts == RecordParts::all) read_labels(reader, record.labels);
    return record;
  } catch (const DamagedArtifact&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

bool asset_is_current(const std::filesystem::path& record_path, Hash128 key,
                      const std::filesystem::path& output) {
  const auto record = read_asset_record(record_path, RecordParts::files);
  if (!record || record->key != key) return false;
  const auto stamp = files_stamp(record->files, output);
  if (!stamp) return false;
  if (*stamp == record->files_stamp) return true;
  for (const FileRecord& file : record->files)
    if (to_hex(hash_file(ReadFile(output / file.path))) != file.xxh3_128) return false;
  restamp_artifact(record_path, *stamp);
  return true;
}

void AssetFile::append(std::span<const std::byte> bytes) {
  hash_.update(bytes);
  file_.append(bytes);
}

FileRecord AssetFile::finish(const std::string& format) {
  FileRecord record{name_, format, "", file_.size(), to_hex(hash_.finish())};
  file_.commit(Durability::fsync);
  return record;
}

}  // namespace voxweld
