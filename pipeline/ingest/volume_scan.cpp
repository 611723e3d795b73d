#include "pipeline/ingest/volume_scan.h"

#include <algorithm>

#include "pipeline/ingest/ingest_layout.h"
#include "stages/ingest/statistics.h"
#include "storage/types/chunk_grid.h"
#include "storage/types/volume.h"

namespace voxweld {
namespace {

// Boxes of whole rows, or of whole chunks where there are any, each about ingest_band_bytes.
std::vector<Box3> bands_of(const VolumeInfo& info) {
  const Index3 size = info.geometry.size;
  if (info.chunk != splat(1)) {
    const ChunkGrid grid(info);
    const std::int64_t length = grid.run_length(ingest_band_bytes);
    std::vector<Box3> runs(grid.runs(length));
    for (std::size_t i = 0; i < runs.size(); ++i) runs[i] = grid.run(i, length);
    return runs;
  }
  const std::uint64_t row = static_cast<std::uint64_t>(size.x) * sample_bytes(info.type);
  const auto rows = static_cast<std::int64_t>(std::max<std::uint64_t>(1, ingest_band_bytes / row));
  std::vector<Box3> bands;
  if (rows < size.y) {
    for (std::int64_t z = 0; z < size.z; ++z)
      for (std::int64_t y = 0; y < size.y; y += rows)
        bands.push_back({{0, y, z}, {size.x, std::min(size.y, y + rows), z + 1}});
    return bands;
  }
  const std::int64_t slices = rows / size.y;
  for (std::int64_t z = 0; z < size.z; z += slices)
    bands.push_back({{0, 0, z}, {size.x, size.y, std::min(size.z, z + slices)}});
  return bands;
}

}  // namespace

ScanResult scan_volume(RunContext& context, const SampleSource& source, const std::string& stage) {
  const VolumeInfo& info = source.info();
  const std::vector<Box3> bands = bands_of(info);
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
