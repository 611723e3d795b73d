#include "pipeline/ingest/ingest_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "pipeline/config/settings.h"
#include "pipeline/executor/probe.h"
#include "pipeline/ingest/ingest_layout.h"
#include "pipeline/ingest/label_ingest.h"
#include "pipeline/ingest/open_input.h"
#include "pipeline/ingest/recorded_input.h"
#include "pipeline/ingest/spooled_input.h"
#include "pipeline/ingest/store_stamps.h"
#include "pipeline/ingest/volume_scan.h"
#include "pipeline/stage/artifacts.h"
#include "stages/ingest/statistics.h"
#include "storage/artifact/container.h"
#include "storage/artifact/histogram_artifact.h"
#include "storage/store/shard_record.h"
#include "storage/store/shard_writer.h"
#include "storage/store/store_source.h"
#include "storage/support/error.h"
#include "storage/types/value_range.h"

namespace voxweld {
namespace {

constexpr std::uint64_t band_bytes = std::uint64_t{8} << 20;  // read at once for a shard
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

bool histogram_is_current(const IngestJob& job) {
  if (!std::filesystem::exists(histogram_path(job.folder))) return false;
  try {
    return ArtifactReader(histogram_path(job.folder), histogram_kind, histogram_version).key() ==
           job.stamp;
  } catch (const DamagedArtifact&) {
    return false;
  }
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

// Units are numbered as shards_of; ascending.
std::vector<std::uint64_t> missing_of(const RunContext& context, const StoreLayout& layout,
                                      const IngestJob& job) {
  const std::vector<Index3> shards = shards_of(layout);
  const bool counted = needs_no_counts(job);
  const auto missing = probe_which(shards.size(), [&](std::size_t i) {
    return context.selection.contains(i) && !shard_is_done(job, layout, shards[i], counted);
  });
  return {missing.begin(), missing.end()};
}

// What the shards are read from together, as Unit::together: one layer's slices, the one stream,
// or, where a shard's piece of a row is less than a few pages, the rows.
std::uint64_t read_together(const StoreLayout& layout, const VolumeInfo& info, Index3 shard) {
  constexpr std::uint64_t few_pages = std::uint64_t{16} << 10;
  if (info.access == Access::stream) return 1;
  if (info.access != Access::box) return static_cast<std::uint64_t>(shard.z) + 1;
  const auto side = static_cast<std::uint64_t>(layout.parameters.shard);
  if (!info.row_major || side * sample_bytes(info.type) >= few_pages) return 0;
  return static_cast<std::uint64_t>(shard.z * layout.shard_grid().y + shard.y) + 1;
}

std::vector<Unit> units_of(const StoreLayout& layout, const std::vector<std::uint64_t>& numbers,
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

// What a spool may hold while it is written: enough for large reads, and what one slice takes.
std::uint64_t spooling_bytes(const VolumeInfo& info) {
  const Index3 size = info.geometry.size;
  const std::uint64_t slice = static_cast<std::uint64_t>(size.x) *
                              static_cast<std::uint64_t>(size.y) * sample_bytes(info.type);
  return std::max(spool_memory_needed(info) + slice, std::uint64_t{48} << 20);
}

// Where shards are cut from: the input where boxes of it can be read, else spools of its slices.
class ShardSource {
 public:
  ShardSource(RunContext& context, const IngestJob& job, const std::vector<std::uint64_t>& missing)
      : input_(job.input ? job.input : open_input(context.config)) {
    if (input_->info().access == Access::box) return;
    const StoreLayout layout = store_layout(context.config, job);
    const std::vector<Index3> shards = shards_of(layout);
    LayerPlan plan{job.folder, job.stamp, layout.parameters.shard, {}};
    for (const std::uint64_t number : missing) ++plan.uses[shards[number].z];
    SpoolOptions options;
    options.memory = spooling_bytes(input_->info());
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
    } use{*spools_, shard.z};
    f(*spools_->acquire(shard.z));
  }

 private:
  std::shared_ptr<SampleSource> input_;
  std::optional<LayerSpools> spools_;
};

// Of some shards those that are not in the store.
std::vector<std::uint64_t> unwritten_of(const IngestJob& job, const StoreLayout& layout,
                                        const std::vector<std::uint64_t>& numbers) {
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
            const std::vector<std::uint64_t>& missing)
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
    explicit Worker(SampleType type) : statistics(type) { scratch.band_bytes = band_bytes; }
  };

  void run(const Unit& unit, Worker& worker, WorkerContext& context) {
    const Index3& shard = shards_[unit.key];
    if (std::binary_search(unwritten_.begin(), unwritten_.end(), unit.key))
      source_->with_samples(shard, [&](const SampleSource& samples) {
        write_shard(layout_, shard, store_shard_key(job_, layout_, shard), samples,
                    worker.statistics, worker.scratch);
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

void do_shards(RunContext& context, const IngestJob& job,
               const std::vector<std::uint64_t>& missing) {
  const StoreLayout layout = store_layout(context.config, job);
  const std::vector<Index3> shards = shards_of(layout);
  StageRun stage;
  stage.stage = "ingest";
  stage.noun = "shards";
  stage.reused = context.selection.count(shards.size()) - missing.size();
  stage.memory = ingest_memory(context.config, job);
  if (job.info.access != Access::box) stage.order = UnitOrder::as_given;  // slices rise
  stage.identity = job.folder.filename().string();
  stage.done = [&, counted = needs_no_counts(job)](const Unit& unit) {
    return shard_is_done(job, layout, shards[unit.key], counted);
  };
  const int threads = stage_threads(context, stage.memory);
  std::optional<ShardWork> work;
  if (context.executor->in_process() && !missing.empty())
    work.emplace(context, job, layout, missing);
  std::vector<std::unique_ptr<ShardWork::Worker>> workers;
  workers.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i)
    workers.push_back(std::make_unique<ShardWork::Worker>(layout.type));
  run_stage(context, stage, units_of(layout, missing, job.info), threads,
            [&](const Unit& unit, WorkerContext& worker) {
              work->run(unit, *workers[static_cast<std::size_t>(worker.slot())], worker);
            });
}

void run_shards(RunContext& context, const IngestJob& job) {
  const StoreLayout layout = store_layout(context.config, job);
  context.selection.check("ingest", "shards", shards_of(layout).size());
  if (job.copy && !store_metadata_is_current(layout)) write_store_metadata(layout);
  // From here on no other process has to look at every slice to know what they are.
  if (context.selection.all() && job.input && job.input->info().access != Access::box)
    record_input(job.folder, parameter_hash(context.config, Stage::ingest), job.info);
  do_shards(context, job, missing_of(context, layout, job));
  if (!context.selection.all()) return;
  remove_spools(job.folder);
  if (job.histogram && !histogram_is_current(job))
    write_histogram_artifact(histogram_path(job.folder), {job.stamp, store_histogram(layout)});
  if (!needs_no_counts(job)) join_label_counts(context, job, layout);
}

}  // namespace

IngestJob plan_ingest(const Config& config, const std::filesystem::path& folder,
                      const InterruptFlag* interrupt) {
  IngestJob job;
  job.folder = folder;
  const Hash128 parameters = parameter_hash(config, Stage::ingest);
  const auto known = recorded_input(folder, parameters);
  if (known) {
    job.info = *known;
  } else {
    if (streams_mesh(config)) job.mesh = plan_streamed_mesh(config, folder, interrupt);
    const auto mesh = job.mesh ? job.mesh->volume : open_mesh(config);
    if (mesh) job.solid = mesh->solid();
    job.input = mesh;
    if (!mesh) job.input = open_input(config);
    job.info = job.input->info();
    for (const std::string& warning : job.info.warnings) spdlog::warn("{}", warning);
  }
  const VolumeInfo& info = job.info;
  job.parameters = parameters;
  job.stamp = files_stamp(job, 0, info.files.size());
  job.file_per_slice = info.access == Access::slice && !config.input.crop &&
                       static_cast<std::int64_t>(info.files.size()) == info.geometry.size.z;
  const bool by_box = !known && info.access == Access::box;
  if (config.work.copy == WorkConfig::Copy::never && !by_box)
    throw InputError(
        fmt::format("work.copy = false: {} ({}) can be read by {} only, so a brick store is "
                    "needed; use work.copy = \"auto\"",
                    config.input.path.string(), info.format, access_name(info.access)));
  job.copy =
      (config.work.copy == WorkConfig::Copy::always || !by_box) && config.input.has_samples();
  job.histogram = !config.surface.isovalue.has_value();
  job.labels = config.labels.mode != LabelMode::off;
  return job;
}

IngestStatus ingest_status(const RunContext& context, const IngestJob& job) {
  IngestStatus status;
  if (job.by_shards()) {
    const StoreLayout layout = store_layout(context.config, job);
    status.units = shards_of(layout).size();
    status.missing = missing_of(context, layout, job).size();
    status.metadata_missing = job.copy && !store_metadata_is_current(layout);
  }
  if (job.mesh) {
    status.units = 1;
    status.mesh_missing = context.selection.contains(0) && !bins_are_current(*job.mesh);
    status.missing = status.mesh_missing ? 1 : 0;
  }
  status.histogram_missing = job.histogram && !histogram_is_current(job);
  status.labels_missing = !needs_no_counts(job);
  return status;
}

std::string missing_text(const IngestJob& job, const IngestStatus& status) {
  if (status.mesh_missing) return "the mesh is not cut up into bricks";
  if (status.missing > 0)
    return fmt::format("{} of {} shards {}", status.missing, status.units,
                       job.copy ? "missing" : "whose labels are not counted");
  if (status.metadata_missing) return "the store's zarr.json is missing or changed";
  return status.labels_missing ? "the labels are not counted" : "the histogram is missing";
}

std::vector<Unit> missing_units(const RunContext& context, const IngestJob& job) {
  if (job.mesh && !bins_are_current(*job.mesh)) return {mesh_unit(*job.mesh)};
  if (!job.by_shards()) return {};
  const StoreLayout layout = store_layout(context.config, job);
  return units_of(layout, missing_of(context, layout, job), job.info);
}

StageMemory ingest_memory(const Config& config, const IngestJob& job) {
  if (job.mesh) return streaming_memory();
  StageMemory memory{"ingest", 0, 0, fmt::format("one shard (work.chunk = {})", config.work.chunk),
                     "raise run.memory or lower work.chunk"};
  if (!job.by_shards()) return memory;
  const StoreLayout layout = store_layout(config, job);
  if (job.labels) memory.per_unit_bytes = ShardLabelCounter::memory_bytes(job, layout);
  if (!job.copy) return memory;
  const VolumeInfo& info = job.info;
  memory.base_bytes = info.access == Access::box ? info.largest_decode : spooling_bytes(info);
  memory.per_unit_bytes += shard_writer_bytes(layout, 1, band_bytes) + (std::uint64_t{16} << 20);
  return memory;
}

void run_ingest(RunContext& context, const IngestJob& job) {
  if (job.mesh) {
    run_mesh_ingest(context, *job.mesh);
  } else if (job.by_shards()) {
    run_shards(context, job);
  } else if (job.histogram && !histogram_is_current(job)) {
    write_histogram_artifact(histogram_path(job.folder),
                             {job.stamp, scan_volume(context, *job.input, "ingest").histogram});
  }
}

Volume ingested_volume(const Config& config, const IngestJob& job) {
  if (!job.copy) return {job.input, [stamp = job.stamp](const Box3&) { return stamp; }, job.solid};
  const StoreLayout layout = store_layout(config, job);
  const auto store = std::make_shared<StoreSource>(layout);
  return {store, [stamps = std::make_shared<StoreStamps>(layout)](const Box3& samples) {
            return stamps->of(samples);
          }};
}

std::optional<Histogram> read_histogram(const IngestJob& job) {
  if (!histogram_is_current(job)) return std::nullopt;
  return read_histogram_artifact(histogram_path(job.folder)).histogram;
}

ValueRange whole_range(RunContext& context, const Volume& volume) {
  const Box3 all{{}, volume.geometry().size};
  if (volume.ranges() != nullptr) return volume.ranges()->range(all);
  return scan_volume(context, *volume.source, "scan").range;
}

}  // namespace voxweld
