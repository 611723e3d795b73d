#include "storage/store/shard_record.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "storage/artifact/container.h"
#include "storage/support/error.h"
#include "storage/support/hash_file.h"
#include "storage/types/volume.h"

namespace voxweld {
namespace {

constexpr std::array<char, 4> record_kind = {'s', 'h', 'r', 'd'};

enum Section : std::uint64_t { summary = 1, ranges = 2, bins = 3, counts = 4 };

struct SummaryRecord {
  std::uint64_t file_size, hash_lo, hash_hi, chunks, nans, type;
};
struct RangeRecord {
  double lo, hi;
  std::uint64_t flags;
};
constexpr std::uint64_t has_nan = 1, has_nothing = 2;

bool ascending(const std::vector<std::uint32_t>& values) {
  return std::is_sorted(values.begin(), values.end()) &&
         std::adjacent_find(values.begin(), values.end()) == values.end();
}

}  // namespace

ValueRange ShardRecord::range() const {
  ValueRange all;
  for (const ValueRange& chunk : chunks) all = merge(all, chunk);
  return all;
}

void write_shard_record(const std::filesystem::path& path, const ShardRecord& record) {
  const SummaryRecord head = {
      record.file_size,      record.file_hash.lo,
      record.file_hash.hi,   record.chunks.size(),
      record.histogram.nans, static_cast<std::uint64_t>(record.histogram.type)};
  std::vector<RangeRecord> chunk_ranges;
  chunk_ranges.reserve(record.chunks.size());
  for (const ValueRange& range : record.chunks)
    chunk_ranges.push_back({range.empty ? 0 : range.lo, range.empty ? 0 : range.hi,
                            (range.any_nan ? has_nan : 0) | (range.empty ? has_nothing : 0)});
  std::vector<std::uint32_t> bin_numbers;
  std::vector<std::uint64_t> bin_counts;
  for (const HistogramBin& bin : record.histogram.bins) {
    bin_numbers.push_back(bin.bin);
    bin_counts.push_back(bin.count);
  }
  ArtifactWriter writer(path, {record_kind, shard_record_version, record.key});
  writer.section(summary, as_record(head));
  writer.section(ranges, as_section(chunk_ranges));
  writer.section(bins, as_section(bin_numbers));
  writer.section(counts, as_section(bin_counts));
  writer.commit();
}

ShardRecord read_shard_record(const StoreLayout& layout, Index3 shard) {
  const std::filesystem::path path = layout.record_path(shard);
  std::error_code error;
  if (!std::filesystem::exists(path, error) && !error)
    throw DamagedArtifact(path.string(), "missing; ingest this shard again");
  const ArtifactReader reader(path, record_kind, shard_record_version);
  const auto head = reader.read_array<SummaryRecord>(summary);
  const auto chunk_ranges = reader.read_array<RangeRecord>(ranges);
  const auto bin_numbers = reader.read_array<std::uint32_t>(bins);
  const auto bin_counts = reader.read_array<std::uint64_t>(counts);
  const std::int64_t side = layout.chunks();
  if (head.size() != 1 || chunk_ranges.size() != static_cast<std::size_t>(side * side * side) ||
      head[0].chunks != chunk_ranges.size() || bin_numbers.size() != bin_counts.size() ||
      head[0].type != static_cast<std::uint64_t>(layout.type) || !ascending(bin_numbers))
    reader.damaged("is the record of a store with other sizes or samples; ingest again");
  ShardRecord record;
  record.key = reader.key();
  record.file_size = head[0].file_size;
  record.file_hash = {head[0].hash_lo, head[0].hash_hi};
  record.histogram.type = layout.type;
  record.histogram.nans = head[0].nans;
  for (const RangeRecord& range : chunk_ranges)
    record.chunks.push_back(
        {range.lo, range.hi, (range.flags & has_nan) != 0, (range.flags & has_nothing) != 0});
  for (std::size_t i = 0; i < bin_numbers.size(); ++i)
    record.histogram.bins.push_back({bin_numbers[i], bin_counts[i]});
  return record;
}

bool shard_is_current(const StoreLayout& layout, Index3 shard, Hash128 key, ShardCheck check) {
  std::error_code missing;
  const auto size = std::filesystem::file_size(layout.shard_path(shard), missing);
  if (missing || !std::filesystem::exists(layout.record_path(shard), missing)) return false;
  try {
    const ShardRecord record = read_shard_record(layout, shard);
    if (record.key != key || record.file_size != size) return false;
    return check == ShardCheck::size ||
           hash_file(ReadFile(layout.shard_path(shard))) == record.file_hash;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace voxweld
