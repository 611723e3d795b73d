// Input volumes, brick stores and spools.
#include <fmt/format.h>

#include <algorithm>

#include "pipeline/info/kinds.h"
#include "pipeline/info/label_survey.h"
#include "storage/spool/spool.h"
#include "storage/spool/spool_record.h"
#include "storage/store/foreign_array.h"
#include "storage/store/layout.h"
#include "storage/store/shard_record.h"
#include "storage/store/store_source.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/types/volume.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Up to this many bytes of samples are looked at unasked: well under a second.
constexpr std::uint64_t cheap_bytes = std::uint64_t{64} << 20;

std::string compression_text(const ZarrArray& array) {
  if (!array.codecs.compressor) return "none";
  const Compressor& c = *array.codecs.compressor;
  if (c.kind == CompressorKind::blosc) return fmt::format("blosc {} level {}", c.cname, c.level);
  const char* name = compressor_name(c.kind);
  if (c.kind == CompressorKind::lz4 || c.kind == CompressorKind::lz4_blocks) return name;
  return fmt::format("{} level {}", name, c.level);
}

std::uint64_t size_of(const fs::path& path) {
  std::error_code missing;
  const auto size = fs::file_size(path, missing);
  return missing ? 0 : size;
}

// What the records of a store say, and with `check` what its shard files hold.
struct StoreSurvey {
  std::uint64_t total = 0, present = 0, bytes = 0;
  Histogram histogram;
  ValueRange range;
  InfoDocument list = InfoDocument::array();
  CheckResult check;
};

void survey_shard(const StoreLayout& layout, Index3 at, const InfoOptions& options,
                  StoreSurvey& survey) {
  ++survey.total;
  const fs::path file = layout.shard_path(at), record_path = layout.record_path(at);
  const std::uint64_t bytes = size_of(file);
  if (!fs::exists(record_path) || !fs::exists(file)) return;
  ++survey.present;
  survey.bytes += bytes;
  try {
    const ShardRecord record = read_shard_record(layout, at);
    if (record.file_size != bytes)
      throw DamagedArtifact(file.string(), fmt::format("has {} bytes, its record expects {}", bytes,
                                                       record.file_size));
    add(survey.histogram, record.histogram);
    survey.range = merge(survey.range, record.range());
    if (options.verbose)
      survey.list.push_back({{"at", facts_of(at)},
                             {"bytes", bytes},
                             {"range", range_facts(real_range(record.range(), layout.scale))}});
    if (!options.check) return;
    survey.check.read(bytes);
    if (hash_file(file, options.hooks.interrupt) != record.file_hash)
      throw DamagedArtifact(file.string(), "is not what its record says: wrong checksum");
  } catch (const DamagedArtifact& damage) {
    if (!options.check) throw;
    const std::string prefix = damage.path() + ": ";
    survey.check.damaged(damage.path(), std::string(damage.what()).substr(prefix.size()));
  }
}

StoreSurvey survey_store(const StoreLayout& layout, const InfoOptions& options) {
  StoreSurvey survey;
  survey.histogram.type = layout.type;
  const Index3 grid = layout.shard_grid();
  for (std::int64_t z = 0; z < grid.z; ++z) {
    for (std::int64_t y = 0; y < grid.y; ++y)
      for (std::int64_t x = 0; x < grid.x; ++x) survey_shard(layout, {x, y, z}, options, survey);
    if (options.hooks.interrupt != nullptr) options.hooks.interrupt->check();
    if (options.hooks.progress)
      options.hooks.progress(static_cast<double>(z + 1) / static_cast<double>(grid.z));
  }
  return survey;
}

}  // namespace

InfoDocument describe_volume(const InfoOptions& options) {
  const std::shared_ptr<SampleSource> source = open_volume(options.input);
  const VolumeInfo& info = source->info();
  InfoDocument document = new_document("volume", options.input.path);
  add_volume_facts(document, info, options.verbose);
  if (info.format == "zarr" || info.format == "n5") {
    const ZarrArray array = read_foreign_array(options.input, info.format);
    document["zarr"] = {{"chunk", facts_of(array.axes_of(array.chunk))},
                        {"file", facts_of(array.axes_of(array.file))},
                        {"compression", compression_text(array)}};
  }
  const auto bytes = document["sample_bytes"].get<std::uint64_t>();
  if (!options.histogram && !options.labels && !options.check && bytes > cheap_bytes)
    return document;
  ScanResult scan;
  InfoDocument labels;
  if (options.labels)
    labels = label_facts(*source, options.hooks, scan);
  else
    scan = scan_in_order(*source, options.hooks);
  document["values"] = value_facts(scan.histogram, scan.range, info.scale);
  if (options.labels) document["labels"] = labels;
  if (options.check) {
    // Reading all of it is the check: a foreign file has no checksum but those of its format.
    document["check"] = CheckResult().facts();
    document["check"]["files"] = info.files.size();
    document["check"]["bytes"] = document["file_bytes"];
  }
  return document;
}

fs::path store_records(const fs::path& array) {
  if (fs::exists(default_records_directory(array))) return default_records_directory(array);
  if (array.filename() == "volume.zarr" && fs::exists(array.parent_path() / "records"))
    return array.parent_path() / "records";
  return {};
}

InfoDocument describe_store(const fs::path& array, const InfoOptions& options) {
  const StoreLayout layout = read_store_layout(array, store_records(array));
  const StoreSurvey survey = survey_store(layout, options);
  VolumeInfo info;
  info.format = "zarr";
  info.type = layout.type;
  info.geometry = layout.geometry;
  info.scale = layout.scale;
  info.files.push_back({(array / "zarr.json").string(), size_of(array / "zarr.json"), 0});
  InfoDocument document = new_document("brick_store", array);
  document["bytes"] = survey.bytes;
  add_volume_facts(document, info, false);
  for (const char* key : {"largest_decode_bytes", "files", "file_bytes", "warnings"})
    document.erase(key);
  document["records"] = layout.records.string();
  document["chunk"] = layout.parameters.chunk;
  document["shard"] = layout.parameters.shard;
  document["compression"] = compression_text(layout.zarr());
  document["shards"] = {{"total", survey.total}, {"present", survey.present}};
  document["values"] = value_facts(survey.histogram, survey.range, info.scale);
  if (options.labels) document["labels"] = label_facts(StoreSource(layout), options.hooks);
  if (options.verbose) document["shard_list"] = survey.list;
  if (options.check) document["check"] = survey.check.facts();
  return document;
}

InfoDocument describe_shard_record(const fs::path& path, const InfoOptions& options) {
  // <records>/K/J/I.shard; the array is what holds or stands beside <records>.
  const fs::path full = fs::absolute(path).lexically_normal();
  const fs::path row = full.parent_path(), plane = row.parent_path();
  const fs::path records = plane.parent_path();
  const fs::path array = records.filename() == ".voxweld" ? records.parent_path()
                                                          : records.parent_path() / "volume.zarr";
  const auto number = [&](const fs::path& name) {
    const std::string text = name.string();
    const bool digits = !text.empty() && text.size() < 10 &&
                        std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
    if (!digits || !fs::exists(array / "zarr.json"))
      throw FormatError(path.string() +
                        ": the record of a shard whose brick store is not there; expected it at " +
                        array.string());
    return std::stoll(text);
  };
  const Index3 at{number(full.stem()), number(row.filename()), number(plane.filename())};
  const StoreLayout layout = read_store_layout(array, records);
  const ShardRecord record = read_shard_record(layout, at);
  InfoDocument document = new_document("shard_record", path);
  document["bytes"] = size_of(path);
  document["key"] = to_hex(record.key);
  document["array"] = array.string();
  document["at"] = facts_of(at);
  document["shard_bytes"] = record.file_size;
  document["shard_hash"] = to_hex(record.file_hash);
  document["values"] = value_facts(record.histogram, record.range(), layout.scale);
  if (!options.check) return document;
  CheckResult check;
  const fs::path file = layout.shard_path(at);
  check.read(size_of(file));
  if (!shard_is_current(layout, at, record.key, ShardCheck::content))
    check.damaged(file.string(), "missing, or not what its record says; ingest again");
  document["check"] = check.facts();
  return document;
}

InfoDocument describe_spool(const fs::path& samples, const InfoOptions& options) {
  const SpoolRecord record = read_spool_record(samples);
  InfoDocument document = new_document("spool_record", samples);
  document["bytes"] = size_of(samples) + size_of(spool_record_path(samples));
  document["key"] = to_hex(record.key);
  document["data_hash"] = to_hex(record.data_hash);
  add_volume_facts(document, record.info, options.verbose);
  if (!options.check) return document;
  verify_spool(samples, record.key);
  document["check"] = CheckResult().read(document["bytes"]).facts();
  return document;
}

}  // namespace voxweld
