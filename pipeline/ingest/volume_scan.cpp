#include "pipeline/ingest/volume_scan.h"

#include <algorithm>

#include "pipeline/ingest/ingest_layout.h"
#include "stages/ingest/statistics.h"
#include "storage/types/chunk_grid.h"
#include "storage/types/volume.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {

void each_scan_piece(const VolumeInfo& info, const std::function<void(const Box3&)>& f) {
  constexpr std::uint64_t bytes = ingest_band_bytes;
  const Index3 size = info.geometry.size;
  // What says that it is larger may be damaged, and is asked for less at once.
  constexpr std::uint64_t largest_chunk = std::uint64_t{256} << 20;
  if (const ChunkGrid grid(info); info.chunk != splat(1) && grid.chunk_bytes() <= largest_chunk) {
    const std::int64_t length = grid.run_length(bytes);
    for (std::uint64_t i = 0; i < grid.runs(length); ++i) f(grid.run(i, length));
    return;
  }
  const std::uint64_t row = static_cast<std::uint64_t>(size.x) * sample_bytes(info.type);
  const auto fit = static_cast<std::int64_t>(std::max<std::uint64_t>(1, bytes / row));
  // A stream gives whole slices where they are small, else bands of rows.
  const bool whole = info.access == Access::stream &&
                     row <= large_slice_bytes / static_cast<std::uint64_t>(size.y);
  const std::int64_t rows = whole ? size.y : std::min(fit, size.y);
  const std::int64_t slices = rows == size.y ? std::max<std::int64_t>(1, fit / size.y) : 1;
  for (std::int64_t z = 0; z < size.z; z += slices)
    for (std::int64_t y = 0; y < size.y; y += rows)
      f(Box3{{0, y, z}, {size.x, std::min(size.y, y + rows), std::min(size.z, z + slices)}});
}

ScanResult scan_volume(RunContext& context, const SampleSource& source, const std::string& stage) {
  const VolumeInfo& info = source.info();
  std::vector<Box3> bands;
  each_scan_piece(info, [&](const Box3& piece) { bands.push_back(piece); });
  StageRun run;
  run.stage = stage;
  run.noun = "bands";
  run.order = UnitOrder::as_given;
  std::int64_t largest_band = 0;
  for (const Box3& band : bands) largest_band = std::max(largest_band, band.count());
  // A worker keeps its band and its bins.
  run.memory = {stage,
                0,
                0,
                "one band of samples",
                "raise run.memory",
                static_cast<std::uint64_t>(largest_band) * sample_bytes(info.type) +
                    info.largest_decode + (std::uint64_t{16} << 20)};
  const int threads = stage_threads(context, run.memory);
  struct Worker {
    std::vector<std::byte> samples;
    HistogramStatistics statistics;
    ValueRange range;
    explicit Worker(SampleType type) : statistics(type) {}
  };
  std::vector<std::unique_ptr<Worker>> workers;
  workers.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) workers.push_back(std::make_unique<Worker>(info.type));
  std::vector<Unit> units;
  for (std::size_t i = 0; i < bands.size(); ++i)
    units.push_back({i, "samples of slice " + std::to_string(bands[i].lo.z),
                     static_cast<double>(bands[i].count())});
  run_stage(context, run, units, threads, [&](const Unit& unit, WorkerContext& context_of) {
    Worker& worker = *workers[static_cast<std::size_t>(context_of.slot())];
    const Box3& band = bands[unit.key];
    worker.samples.resize(static_cast<std::size_t>(band.count()) * sample_bytes(info.type));
    source.read(band, worker.samples.data());
    worker.range = merge(worker.range, worker.statistics.add(worker.samples));
    context_of.add_bytes(worker.samples.size());
  });
  ScanResult result;
  result.histogram.type = info.type;
  for (const auto& worker : workers) {  // adding is exact, so the order of workers is no matter
    add(result.histogram, worker->statistics.take());
    result.range = merge(result.range, worker->range);
  }
  return result;
}

}  // namespace voxweld
