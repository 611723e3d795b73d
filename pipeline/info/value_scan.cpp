#include "pipeline/info/value_scan.h"

#include <algorithm>
#include <span>
#include <vector>

#include "stages/ingest/statistics.h"
#include "storage/types/volume.h"

namespace voxweld {
namespace {

constexpr std::uint64_t band_bytes = std::uint64_t{8} << 20;

// Appends the samples of the band that lie on the volume's outermost layer: whole rows at its upper
// and lower faces, else the ends of each row.
void append_border(const Box3& band, Index3 size, std::size_t sample_size,
                   std::span<const std::byte> samples, std::vector<std::byte>& out) {
  const std::size_t row = static_cast<std::size_t>(band.size().x) * sample_size;
  std::size_t at = 0;
  for (std::int64_t z = band.lo.z; z < band.hi.z; ++z)
    for (std::int64_t y = band.lo.y; y < band.hi.y; ++y, at += row) {
      const auto line = samples.subspan(at, row);
      const bool whole = z == 0 || z + 1 == size.z || y == 0 || y + 1 == size.y || size.x < 3;
      const auto first = whole ? line : line.first(sample_size);
      out.insert(out.end(), first.begin(), first.end());
      if (whole) continue;
      const auto last = line.last(sample_size);
      out.insert(out.end(), last.begin(), last.end());
    }
}

}  // namespace

ScanResult scan_in_order(const SampleSource& source, const ScanHooks& hooks) {
  const VolumeInfo& info = source.info();
  const Index3 size = info.geometry.size;
  const std::uint64_t row = static_cast<std::uint64_t>(size.x) * sample_bytes(info.type);
  const auto fit = static_cast<std::int64_t>(std::max<std::uint64_t>(1, band_bytes / row));
  // A stream gives whole slices only; of the others a slice may be cut into bands of rows.
  const std::int64_t rows = info.access == Access::stream ? size.y : std::min(fit, size.y);
  const std::int64_t slices = rows == size.y ? std::max<std::int64_t>(1, fit / size.y) : 1;
  HistogramStatistics statistics(info.type), border_statistics(info.type);
  ScanResult result;
  std::vector<std::byte> samples, border;
  for (std::int64_t z = 0; z < size.z; z += slices) {
    for (std::int64_t y = 0; y < size.y; y += rows) {
      if (hooks.interrupt != nullptr) hooks.interrupt->check();
      const Box3 band{{0, y, z},
                      {size.x, std::min(size.y, y + rows), std::min(size.z, z + slices)}};
      samples.resize(static_cast<std::size_t>(band.count()) * sample_bytes(info.type));
      source.read(band, samples.data());
      result.range = merge(result.range, statistics.add(samples));
      if (hooks.samples) hooks.samples(band, samples);
      border.clear();
      append_border(band, size, sample_bytes(info.type), samples, border);
      if (!border.empty()) border_statistics.add(border);
    }
    if (hooks.progress)
      hooks.progress(static_cast<double>(std::min(size.z, z + slices)) /
                     static_cast<double>(size.z));
  }
  result.histogram = statistics.take();
  result.border = border_statistics.take();
  return result;
}

}  // namespace voxweld
