#include "pipeline/ingest/shard_ingest.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "pipeline/executor/probe.h"
#include "pipeline/ingest/filtered_input.h"
#include "pipeline/ingest/ingest_layout.h"
#include "pipeline/ingest/label_ingest.h"
#include "pipeline/ingest/open_input.h"
#include "pipeline/ingest/recorded_input.h"
#include "pipeline/ingest/spooled_input.h"
#include "pipeline/stage/artifacts.h"
#include "stages/ingest/statistics.h"
#include "storage/artifact/histogram_artifact.h"
#include "storage/store/shard_record.h"
#include "storage/store/shard_writer.h"

namespace voxweld {
namespace {

constexpr std::size_t records_ahead = 64;  // a record of 16-bit samples may take half a megabyte

Histogram store_histogram(const StoreLayout& layout) {
  Histogram histogram;
  histogram.type = layout.type;
  const std::vector<Index3> shards = shards_of(layout);
  probe_in_order<Histogram>(
      shards.size(), records_ahead,
      [&](std::size_t i) { return read_shard_record(layout, shards[i]).histogram; },
      [&](std::size_t, Histogram&& one) { add(histogram, one); });
  return histogram;
}

bool shard_is_written(const IngestJob& job, const StoreLayout& layout, Index3 shard) {
  return !job.copy || shard_is_current(layout, shard, store_shard_key(job, layout, shard));
}

// Whether nothing is left to do for it. counted: nobody asks for its labels any more.
bool shard_is_done(const IngestJob& job, const StoreLayout& layout, Index3 shard, bool counted) {
  return shard_is_written(job, layout, shard) &&
         (counted || shard_labels_are_counted(job, layout, shard));
}

bool needs_no_counts(const IngestJob& job) {
  return !job.labels || labels_are_counted(job);
}

// The layer of spools that the shard is cut from.
std::int64_t layer_of(const StoreLayout& layout, const VolumeInfo& info, Index3 shard) {
  const std::int64_t side = layout.parameters.shard;
  return shard.z * side / spool_height(info, side);
}

// What the shards are read from together, as Unit::together: one layer's slices, the one stream,
// or, where a shard's piece of a row is less than a few pages, the rows.
std::uint64_t read_together(const StoreLayout& layout, const VolumeInfo& info, Index3 shard) {
  constexpr std::uint64_t few_pages = std::uint64_t{16} << 10;
  if (info.access == Access::stream) return 1;
  if (info.access != Access::box)
    return static_cast<std::uint64_t>(layer_of(layout, info, shard)) + 1;
  const auto side = static_cast<std::uint64_t>(layout.parameters.shard);
  if (!info.row_major || side * sample_bytes(info.type) >= few_pages) return 0;
  return static_cast<std::uint64_t>(shard.z * layout.shard_grid().y + shard.y) + 1;
}

std::vector<Unit> units_of(const StoreLayout& layout, std::span<const std::uint64_t> numbers,
                           const VolumeInfo& info) {
  const std::vector<Index3> shards = shards_of(layout);
  std::vector<Unit> units;
  for (const std::uint64_t number : numbers) {
    const Index3& s = shards[number];
    units.push_back({number, fmt::format("store shard {}/{}/{}", s.x, s.y, s.z),
                     static_cast<double>(layout.shard_samples(s).count()),
                     read_together(layout, info, s)});
  }
  return units;
}

// What a spool may hold while it is written: enough for large reads, and what one slice takes. Of
// chunks what several threads decode, as long as it is no large part of all memory.
std::uint64_t spooling_bytes(const VolumeInfo& info, const RunConfig& run) {
  constexpr std::uint64_t most_threads = 16;
  const std::uint64_t one = spool_memory_needed(info);
  if (info.access == Access::chunks)
    return one * std::clamp<std::uint64_t>(run.memory / 4 / one, 1, most_threads);
  const Index3 size = info.geometry.size;
  const std::uint64_t slice = static_cast<std::uint64_t>(size.x) *
                              static_cast<std::uint64_t>(size.y) * sample_bytes(info.type);
  return std::max(one + slice, std::uint64_t{48} << 20);
}

// Where shards are cut from: the input where boxes of it can be read, else spools of its slices.
class ShardSource {
 public:
  ShardSource(RunContext& context, const IngestJob& job, std::span<const std::uint64_t> missing)
      : input_(job.input ? job.input : open_input(context.config)) {
    if (input_->info().access == Access::box) return;
    const StoreLayout layout = store_layout(context.config, job);
    const std::vector<Index3> shards = shards_of(layout);
    layer_of_ = [info = input_->info(), layout](Index3 shard) {
      return layer_of(layout, info, shard);
    };
    LayerPlan plan{
        job.folder, job.stamp, spool_height(input_->info(), layout.parameters.shard), {}};
    for (const std::uint64_t number : missing) ++plan.uses[layer_of_(shards[number])];
    SpoolOptions options;
    options.memory = spooling_bytes(input_->info(), context.config.run);
    options.threads = context.threads;
    options.progress = [interrupt = context.interrupt](const SpoolProgress&) {
      if (interrupt != nullptr) interrupt->check();
    };
    spools_.emplace(input_, std::move(plan), std::move(options));
  }

  // Calls f with a source that has the shard's samples.
  template <class F>
  void with_samples(Index3 shard, F&& f) {
    if (!spools_) return f(*input_);
    struct Use {
      LayerSpools& spools;
      std::int64_t layer;
      ~Use() { spools.release(layer); }
    } use{*spools_, layer_of_(shard)};
    f(*spools_->acquire(use.layer));
  }

 private:
  std::shared_ptr<SampleSource> input_;
  std::function<std::int64_t(Index3)> layer_of_;
  std::optional<LayerSpools> spools_;
};

// Counts the NaNs of what is read.
class NanWatch final : public SampleSource {
 public:
  NanWatch(const SampleSource& source, NanCount& nans) : source_(source), nans_(nans) {}
  const VolumeInfo& info() const override { return source_.info(); }
  void read(const Box3& box, std::byte* out) const override {
    source_.read(box, out);
    const SampleType type = info().type;
    const std::size_t bytes = static_cast<std::size_t>(box.count()) * sample_bytes(type);
    nans_.add(count_nans(type, {out, bytes}, box, box));
  }

 private:
  const SampleSource& source_;
  NanCount& nans_;
};

// Of some shards those that are not in the store.
std::vector<std::uint64_t> unwritten_of(const IngestJob& job, const StoreLayout& layout,
                                        std::span<const std::uint64_t> numbers) {
  const std::vector<Index3> shards = shards_of(layout);
  std::vector<std::uint64_t> unwritten;
  for (const std::size_t i : probe_which(numbers.size(), [&](std::size_t n) {
         return !shard_is_written(job, layout, shards[numbers[n]]);
       }))
    unwritten.push_back(numbers[i]);
  return unwritten;
}

// Writes shards and counts their labels, in this process.
class ShardWork {
 public:
  ShardWork(RunContext& context, const IngestJob& job, const StoreLayout& layout,
            std::span<const std::uint64_t> missing)
      : job_(job),
        layout_(layout),
        shards_(shards_of(layout)),
        unwritten_(unwritten_of(job, layout, missing)),
        counted_(needs_no_counts(job)),
        counter_(job, layout) {
    if (!unwritten_.empty()) source_.emplace(context, job, unwritten_);
  }

  struct Worker {
    ShardScratch scratch;
    HistogramStatistics statistics;
    NanCount nans;
    explicit Worker(SampleType type) : statistics(type) { scratch.band_bytes = ingest_band_bytes; }
  };

  void run(const Unit& unit, Worker& worker, WorkerContext& context) {
    const Index3& shard = shards_[unit.key];
    if (std::binary_search(unwritten_.begin(), unwritten_.end(), unit.key))
      source_->with_samples(shard, [&](const SampleSource& samples) {
        write_shard(layout_, shard, store_shard_key(job_, layout_, shard),
                    NanWatch(samples, worker.nans), worker.statistics, worker.scratch);
      });
    if (!counted_ && !shard_labels_are_counted(job_, layout_, shard))
      counter_.count(shard, context);
    context.add_bytes(static_cast<std::uint64_t>(layout_.shard_samples(shard).count()) *
                      sample_bytes(layout_.type));
  }

 private:
  const IngestJob& job_;
  const StoreLayout& layout_;
  const std::vector<Index3> shards_;
  const std::vector<std::uint64_t> unwritten_;  // ascending
  const bool counted_;
  ShardLabelCounter counter_;
  std::optional<ShardSource> source_;
};

// Copies shards to the brick store, counts their labels, or both.
class ShardIngest final : public StageWork {
 public:
  ShardIngest(const Config& config, const IngestJob& job)
      : job_(job),
        run_(config.run),
        filtered_(!config.filters.empty()),
        record_key_(input_record_key(config)),
        layout_(store_layout(config, job)),
        shards_(shards_of(layout_)),
        counted_(needs_no_counts(job)) {}

  Stage stage() const override { return Stage::ingest; }
  std::string noun() const override { return "shards"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return shards_.size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    return units_of(layout_, numbers, job_.info);
  }
  bool done(std::uint64_t unit) override {
    return shard_is_done(job_, layout_, shards_[unit], counted_);
  }
  StageLook look(const UnitSelection& selection) override {
    counted_ = needs_no_counts(job_);
    StageLook look = StageWork::look(selection);
    if (job_.copy && !store_metadata_is_current(layout_))
      look.rest = "the store's zarr.json is missing or changed";
    else if (!counted_)
      look.rest = "the labels are not counted";
    else
      look.rest = missing_besides(job_);
    return look;
  }
  std::string missing_text(const StageLook& look) const override {
    if (look.missing.empty()) return look.rest;
    return fmt::format("{} of {} shards {}", look.missing.size(), look.units,
                       job_.copy ? "missing" : "whose labels are not counted");
  }
  std::string current_text() const override {
    return job_.copy ? "up to date" : read_in_place_text;
  }

  // A worker keeps its buffers.
  StageMemory memory(std::span<const std::uint64_t>) override;
  // Slices rise.
  UnitOrder order() const override {
    return job_.info.access == Access::box ? UnitOrder::largest_first : UnitOrder::as_given;
  }
  void open(RunContext& context, const StageLook& look) override {
    if (!look.current()) finish_earlier(context, job_);
    if (job_.copy && !store_metadata_is_current(layout_)) write_store_metadata(layout_);
    // From here on no other process has to look at every slice to know what they are.
    // Of a volume of files that nobody lists, each shard is keyed by its own.
    if (context.selection.all() && job_.input && job_.input->info().access != Access::box &&
        !lies_in_unlisted_files(job_))
      record_input(job_.folder, record_key_, job_.info);
  }
  void begin(RunContext& context, std::span<const std::uint64_t> missing, int threads) override {
    if (missing.empty()) return;
    work_.emplace(context, job_, layout_, missing);
    for (int i = 0; i < threads; ++i)
      workers_.push_back(std::make_unique<ShardWork::Worker>(layout_.type));
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    work_->run(unit, *workers_[static_cast<std::size_t>(worker.slot())], worker);
  }
  void end(RunContext& context) override {
    work_.reset();
    for (const auto& worker : workers_) context.nans.add(worker->nans);
    workers_.clear();
  }
  void close(RunContext& context) override {
    remove_spools(job_.folder);
    if (makes_histogram(job_) && !histogram_is_current(job_))
      write_histogram_artifact(histogram_path(job_.folder), {job_.stamp, store_histogram(layout_)});
    if (!needs_no_counts(job_)) join_label_counts(context, job_, layout_);
  }

 private:
  const IngestJob& job_;
  const RunConfig run_;
  const bool filtered_;
  const Hash128 record_key_;
  const StoreLayout layout_;
  const std::vector<Index3> shards_;
  bool counted_;
  std::optional<ShardWork> work_;
  std::vector<std::unique_ptr<ShardWork::Worker>> workers_;
};

StageMemory ShardIngest::memory(std::span<const std::uint64_t>) {
  StageMemory memory{"ingest", 0, 0,
                     fmt::format("one shard (work.chunk = {})", layout_.parameters.chunk),
                     "raise run.memory or lower work.chunk"};
  if (job_.labels) memory.per_worker_bytes = ShardLabelCounter::memory_bytes(job_, layout_);
  if (!job_.copy) return memory;
  const VolumeInfo& info = job_.info;
  memory.base_bytes = info.access == Access::box ? info.largest_decode : spooling_bytes(info, run_);
  // What the input asks for does not shrink with the store's chunks.
  if (info.largest_decode > run_.memory / 4) {
    memory.unit = fmt::format("the input, of which a piece takes {} to decode",
                              readable_bytes(static_cast<double>(info.largest_decode)));
    memory.advice = "raise run.memory, or rewrite the input in smaller pieces";
  }
  // Each worker filters for itself.
  if (filtered_) memory.per_worker_bytes += std::exchange(memory.base_bytes, 0);
  memory.per_worker_bytes +=
      shard_writer_bytes(layout_, 1, ingest_band_bytes) + (std::uint64_t{16} << 20);
  return memory;
}

}  // namespace

std::unique_ptr<StageWork> shard_ingest(const Config& config, const IngestJob& job) {
  return std::make_unique<ShardIngest>(config, job);
}

}  // namespace voxweld
