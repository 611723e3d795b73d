#include "pipeline/info/value_scan.h"

#include <algorithm>
#include <vector>

#include "stages/ingest/statistics.h"
#include "storage/types/value_range.h"

namespace voxweld {
namespace {

constexpr std::uint64_t band_bytes = std::uint64_t{8} << 20;

}  // namespace

ScanResult scan_in_order(const SampleSource& source, const ScanHooks& hooks) {
  const VolumeInfo& info = source.info();
  const Index3 size = info.geometry.size;
  const std::uint64_t row = static_cast<std::uint64_t>(size.x) * sample_bytes(info.type);
  const auto fit = static_cast<std::int64_t>(std::max<std::uint64_t>(1, band_bytes / row));
  // A stream gives whole slices only; of the others a slice may be cut into bands of rows.
  const std::int64_t rows = info.access == Access::stream ? size.y : std::min(fit, size.y);
  const std::int64_t slices = rows == size.y ? std::max<std::int64_t>(1, fit / size.y) : 1;
  HistogramStatistics statistics(info.type);
  ScanResult result;
  std::vector<std::byte> samples;
  for (std::int64_t z = 0; z < size.z; z += slices) {
    for (std::int64_t y = 0; y < size.y; y += rows) {
      if (hooks.interrupt != nullptr) hooks.interrupt->check();
      const Box3 band{{0, y, z},
                      {size.x, std::min(size.y, y + rows), std::min(size.z, z + slices)}};
      samples.resize(static_cast<std::size_t>(band.count()) * sample_bytes(info.type));
      source.read(band, samples.data());
      result.range = merge(result.range, statistics.add(samples));
    }
    if (hooks.progress)
      hooks.progress(static_cast<double>(std::min(size.z, z + slices)) /
                     static_cast<double>(size.z));
  }
  result.histogram = statistics.take();
  return result;
}

}  // namespace voxweld
