#include "pipeline/run/ingest_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "pipeline/config/settings.h"
#include "pipeline/run/histogram_artifact.h"
#include "pipeline/run/open_input.h"
#include "pipeline/run/recorded_input.h"
#include "pipeline/run/volume_scan.h"
#include "stages/ingest/statistics.h"
#include "storage/artifact/container.h"
#include "storage/spool/spool.h"
#include "storage/store/shard_record.h"
#include "storage/store/shard_writer.h"
#include "storage/store/store_source.h"
#include "storage/support/error.h"
#include "storage/types/value_range.h"

namespace voxweld {
namespace {

constexpr std::uint64_t band_bytes = std::uint64_t{8} << 20;  // read at once for a shard

StoreLayout layout_of(const Config& config, const IngestJob& job) {
  StoreLayout layout;
  layout.array = job.folder / "volume.zarr";
  layout.records = job.folder / "records";
  layout.type = job.info.type;
  layout.geometry = job.info.geometry;
  layout.parameters.chunk = config.work.chunk;
  layout.parameters.shard = config.work.brick * config.work.shard;
  return layout;
}

std::vector<Index3> shards_of(const StoreLayout& layout) {
  std::vector<Index3> shards;
  const Index3 grid = layout.shard_grid();
  for (std::int64_t z = 0; z < grid.z; ++z)
    for (std::int64_t y = 0; y < grid.y; ++y)
      for (std::int64_t x = 0; x < grid.x; ++x) shards.push_back({x, y, z});
  return shards;
}

std::vector<Index3> missing_of(const StoreLayout& layout, Hash128 stamp) {
  std::vector<Index3> missing;
  for (const Index3& shard : shards_of(layout))
    if (!shard_is_current(layout, shard, stamp)) missing.push_back(shard);
  return missing;
}

std::filesystem::path histogram_path(const IngestJob& job) {
  return job.folder / "histogram";
}

bool histogram_is_current(const IngestJob& job) {
  if (!std::filesystem::exists(histogram_path(job))) return false;
  try {
    return ArtifactReader(histogram_path(job), histogram_kind, histogram_version).key() ==
           job.stamp;
  } catch (const DamagedArtifact&) {
    return false;
  }
}

// The input where boxes of it can be read, else its spool.
std::shared_ptr<const SampleSource> by_boxes(RunContext& context, const IngestJob& job) {
  const VolumeInfo& info = job.info;
  const auto input = job.input ? job.input : open_input(context.config.input);
  if (input->info().access == Access::box) return input;
  const auto path = job.folder / "spool.raw";
  if (!spool_is_current(path, job.stamp)) {
    spdlog::info("{} is read slice by slice: spooling {} once", context.config.input.path.string(),
                 readable_bytes(static_cast<double>(spool_bytes(info))));
    SpoolOptions options;
    // A budget smaller than the program leaves nothing, which spool_volume refuses with a figure.
    options.memory =
        context.config.run.memory - std::min(context.config.run.memory, program_bytes());
    options.progress = [&](const SpoolProgress&) {
      if (context.interrupt != nullptr) context.interrupt->check();
    };
    spool_volume(*input, path, job.stamp, options);
  }
  return open_spool(path, job.stamp);
}

void remove_spool(const IngestJob& job) {
  std::error_code ignored;
  std::filesystem::remove(job.folder / "spool.raw.record", ignored);
  std::filesystem::remove(job.folder / "spool.raw", ignored);
}

void run_copy(RunContext& context, const IngestJob& job) {
  const StoreLayout layout = layout_of(context.config, job);
  const std::vector<Index3> missing = missing_of(layout, job.stamp);
  StageRun stage;
  stage.stage = "ingest";
  stage.noun = "shards";
  stage.reused = shards_of(layout).size() - missing.size();
  stage.memory = ingest_memory(context.config, job);
  const int threads = stage_threads(context, stage.memory);
  std::shared_ptr<const SampleSource> source;
  const StageMeter spool_meter;
  if (!missing.empty()) source = by_boxes(context, job);
  const StageFigures spooling = spool_meter.read();
  if (!store_metadata_is_current(layout)) write_store_metadata(layout);
  struct Worker {
    ShardScratch scratch;
    HistogramStatistics statistics;
    explicit Worker(SampleType type) : statistics(type) {}
  };
  std::vector<std::unique_ptr<Worker>> workers;
  for (int i = 0; i < threads; ++i) {
    workers.push_back(std::make_unique<Worker>(layout.type));
    workers.back()->scratch.band_bytes = band_bytes;
  }
  std::vector<Unit> units;
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const Index3& s = missing[i];
    units.push_back({i, fmt::format("store shard {}/{}/{}", s.x, s.y, s.z),
                     static_cast<double>(layout.shard_samples(s).count())});
  }
  run_stage(context, stage, units, threads, [&](const Unit& unit, WorkerContext& worker_context) {
    Worker& worker = *workers[static_cast<std::size_t>(worker_context.slot())];
    write_shard(layout, missing[unit.key], job.stamp, *source, worker.statistics, worker.scratch);
    worker_context.add_bytes(
        static_cast<std::uint64_t>(layout.shard_samples(missing[unit.key]).count()) *
        sample_bytes(layout.type));
  });
  StageFigures& figures = context.reports.back().figures;
  figures.wall_s += spooling.wall_s;
  figures.cpu_s += spooling.cpu_s;
  figures.peak_resident = std::max(figures.peak_resident, spooling.peak_resident);
  remove_spool(job);
  if (job.input && job.input->info().access != Access::box)
    record_input(job.folder, parameter_hash(context.config, Stage::ingest), job.info);
}

}  // namespace

IngestJob plan_ingest(const Config& config, const std::filesystem::path& folder) {
  IngestJob job;
  job.folder = folder;
  const Hash128 parameters = parameter_hash(config, Stage::ingest);
  const auto known = recorded_input(folder, parameters);
  if (known) {
    job.info = *known;
  } else {
    job.input = open_input(config.input);
    job.info = job.input->info();
    for (const std::string& warning : job.info.warnings) spdlog::warn("{}", warning);
  }
  const VolumeInfo& info = job.info;
  KeyHasher stamp;
  stamp.hash(parameters);
  for (const InputFile& file : info.files)
    stamp.text(file.path).integer(static_cast<std::int64_t>(file.size)).integer(file.mtime_ns);
  job.stamp = stamp.finish();
  const bool by_box = !known && info.access == Access::box;
  if (config.work.copy == WorkConfig::Copy::never && !by_box)
    throw InputError(
        fmt::format("work.copy = false: {} ({}) can be read by {} only, so a brick store is "
                    "needed; use work.copy = \"auto\"",
                    config.input.path.string(), info.format, access_name(info.access)));
  job.copy = config.work.copy == WorkConfig::Copy::always || !by_box;
  job.histogram = !config.surface.isovalue.has_value();
  return job;
}

IngestStatus ingest_status(const Config& config, const IngestJob& job) {
  if (job.copy) {
    const StoreLayout layout = layout_of(config, job);
    return {shards_of(layout).size(), missing_of(layout, job.stamp).size(),
            !store_metadata_is_current(layout)};
  }
  if (job.histogram) return {1, histogram_is_current(job) ? 0u : 1u, false};
  return {};
}

StageMemory ingest_memory(const Config& config, const IngestJob& job) {
  StageMemory memory{"ingest", 0, 0, fmt::format("one shard (work.chunk = {})", config.work.chunk),
                     "raise run.memory or lower work.chunk"};
  if (!job.copy) return memory;
  const VolumeInfo& info = job.info;
  if (info.access == Access::box) memory.base_bytes = info.largest_decode;
  memory.per_unit_bytes =
      shard_writer_bytes(layout_of(config, job), 1, band_bytes) + (std::uint64_t{16} << 20);
  return memory;
}

void run_ingest(RunContext& context, const IngestJob& job) {
  if (job.copy) {
    run_copy(context, job);
  } else if (job.histogram && !histogram_is_current(job)) {
    write_histogram_artifact(histogram_path(job),
                             {job.stamp, scan_volume(context, *job.input, "ingest").histogram});
  }
}

Volume ingested_volume(const Config& config, const IngestJob& job) {
  if (!job.copy) return {job.input, nullptr, job.stamp};
  const StoreLayout layout = layout_of(config, job);
  const auto store = std::make_shared<StoreSource>(layout);
  KeyHasher stamp;
  for (const Index3& shard : shards_of(layout))
    stamp.hash(read_shard_record(layout, shard).file_hash);
  return {store, store.get(), stamp.finish()};
}

std::optional<Histogram> read_histogram(const Config& config, const IngestJob& job) {
  Histogram histogram;
  histogram.type = job.info.type;
  if (job.copy) {
    const StoreLayout layout = layout_of(config, job);
    for (const Index3& shard : shards_of(layout))
      add(histogram, read_shard_record(layout, shard).histogram);
    return histogram;
  }
  if (!histogram_is_current(job)) return std::nullopt;
  return read_histogram_artifact(histogram_path(job)).histogram;
}

ValueRange whole_range(RunContext& context, const Volume& volume) {
  const Box3 all{{}, volume.geometry().size};
  if (volume.ranges != nullptr) return volume.ranges->range(all);
  return scan_volume(context, *volume.source, "scan").range;
}

}  // namespace voxweld
