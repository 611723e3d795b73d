#include "pipeline/ingest/label_ingest.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/ingest/ingest_layout.h"
#include "pipeline/ingest/label_tally.h"
#include "pipeline/stage/artifacts.h"
#include "storage/store/store_source.h"

namespace voxweld {
namespace {

constexpr std::size_t labels_of_shard = std::size_t{1} << 15;  // in memory
constexpr std::size_t least_labels = std::size_t{1} << 12;     // while all are added up

bool are_counted(const std::filesystem::path& path, Hash128 key) {
  return is_current(path, [&] { return LabelCounts(path).key() == key; });
}

// Boxes of whole rows of chunks, y filled first: a store's chunks are decoded once.
std::vector<Box3> bands_of(const Box3& samples, std::int64_t chunk, SampleType type) {
  const std::int64_t width = samples.size().x;
  const std::uint64_t row = static_cast<std::uint64_t>(width * chunk * chunk) * sample_bytes(type);
  const auto rows = static_cast<std::int64_t>(std::max<std::uint64_t>(1, ingest_band_bytes / row));
  const std::int64_t across = (samples.size().y + chunk - 1) / chunk;
  const std::int64_t y_step = std::min(rows, across) * chunk;
  const std::int64_t z_step = std::max<std::int64_t>(1, rows / across) * chunk;
  std::vector<Box3> bands;
  for (std::int64_t z = samples.lo.z; z < samples.hi.z; z += z_step)
    for (std::int64_t y = samples.lo.y; y < samples.hi.y; y += y_step)
      bands.push_back(
          intersect({{samples.lo.x, y, z}, {samples.hi.x, y + y_step, z + z_step}}, samples));
  return bands;
}

void write_counts(const std::filesystem::path& path, Hash128 key, LabelTally& tally,
                  std::uint64_t negatives) {
  LabelCountsWriter out(path, key);
  tally.finish([&](const LabelCount& count) { out.add(count); });
  out.commit(negatives);
}

}  // namespace

bool labels_are_counted(const IngestJob& job) {
  return are_counted(label_counts_path(job.folder), label_counts_key(job.stamp));
}

bool shard_labels_are_counted(const IngestJob& job, const StoreLayout& layout, Index3 shard) {
  return are_counted(label_counts_path(job.folder, shard),
                     label_counts_key(store_shard_key(job, layout, shard)));
}

void ShardLabelCounter::count(Index3 shard, const WorkerContext& worker) {
  // A store's metadata may be written after the counter was made.
  std::shared_ptr<const SampleSource> source = job_.input;
  if (job_.copy) source = std::make_shared<StoreSource>(layout_);
  LabelTally tally(job_.folder, labels_of_shard);
  std::vector<std::byte> samples;
  for (const Box3& band :
       bands_of(layout_.shard_samples(shard), layout_.parameters.chunk, layout_.type)) {
    worker.check_interrupt();
    samples.resize(static_cast<std::size_t>(band.count()) * sample_bytes(layout_.type));
    source->read(band, samples.data());
    tally.add(layout_.type, band, samples);
  }
  write_counts(label_counts_path(job_.folder, shard),
               label_counts_key(store_shard_key(job_, layout_, shard)), tally, tally.negatives());
}

std::uint64_t ShardLabelCounter::memory_bytes(const IngestJob& job, const StoreLayout& layout) {
  const std::int64_t chunk = layout.parameters.chunk;
  const auto row = static_cast<std::uint64_t>(
                       std::min(layout.parameters.shard, layout.geometry.size.x) * chunk * chunk) *
                   sample_bytes(layout.type);
  // A store's chunk, encoded and decoded.
  const std::uint64_t decode = job.copy ? 3 * layout.zarr().form().bytes : job.info.largest_decode;
  return std::max(ingest_band_bytes, row) + decode + LabelTally::memory_bytes(labels_of_shard);
}

void join_label_counts(const RunContext& context, const IngestJob& job, const StoreLayout& layout) {
  const std::uint64_t memory = context.budget().total;
  const std::uint64_t free = memory - std::min(memory, program_bytes());
  LabelTally tally(job.folder, std::max(least_labels, LabelTally::labels_within(free / 2)));
  std::uint64_t negatives = 0;
  const std::vector<Index3> shards = shards_of(layout);
  for (std::size_t i = 0; i < shards.size(); ++i) {
    if (context.interrupt != nullptr) context.interrupt->check();
    if (context.progress.enabled && context.console != nullptr)
      context.console->status(
          fmt::format("ingest: adding up the labels of shard {} of {}", i + 1, shards.size()));
    const LabelCounts counts(label_counts_path(job.folder, shards[i]));
    negatives += counts.summary().negatives;
    counts.each([&](const LabelCount& count) {
      tally.add(count);
      return true;
    });
  }
  write_counts(label_counts_path(job.folder), label_counts_key(job.stamp), tally, negatives);
  if (context.console != nullptr) context.console->clear_status();
}

std::optional<LabelCounts> read_label_counts(const IngestJob& job) {
  if (!labels_are_counted(job)) return std::nullopt;
  return LabelCounts(label_counts_path(job.folder));
}

}  // namespace voxweld
