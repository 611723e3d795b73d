#include "pipeline/info/value_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <vector>

#include "pipeline/config/config.h"
#include "stages/ingest/statistics.h"
#include "storage/support/error.h"
#include "storage/types/volume.h"
#include "storage/volumes/data_layout.h"

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

// Files below the folder, as far as `enough`.
std::uint64_t files_below(const std::filesystem::path& folder, std::uint64_t enough) {
  std::uint64_t files = 0;
  std::error_code error;
  using Entries = std::filesystem::recursive_directory_iterator;
  for (Entries entry(folder, error), end; !error && entry != end && files < enough;
       entry.increment(error))
    if (std::error_code gone; entry->is_regular_file(gone)) ++files;
  return files;
}

// How many of an array's files there are, as far as `enough`: beside the one that describes it, or
// in that, where it is a zip file. Each member of those takes 76 bytes at least.
std::uint64_t files_there(const InputFile& first, std::uint64_t enough) {
  const std::filesystem::path path = first.path;
  if (path.extension() == ".json" || path.filename() == ".zarray")
    return files_below(path.parent_path(), enough + 1) - 1;
  return first.state.size / 76;
}

// Refuses what a scan would not come to the end of.
void check_scan(const SampleSource& source) {
  const VolumeInfo& info = source.info();
  const Index3 size = info.geometry.size;
  const std::string name = info.files.empty() ? info.format : info.files.front().path;
  double samples = 1;
  for (int a = 0; a < 3; ++a) {
    samples *= static_cast<double>(size[a]);
    if (size[a] > most_samples)
      throw InputError(
          fmt::format("{}: {} x {} x {} samples: volumes may have {} a side; correct the size",
                      name, size.x, size.y, size.z, most_samples));
  }
  constexpr double soon = 0x1p36, sparse = 1024;  // a minute or so
  if (samples <= soon || info.piece_files == 0) return;
  const auto needed = static_cast<std::uint64_t>(info.piece_files / sparse) + 1;
  const std::uint64_t there = files_there(info.files.front(), needed);
  if (there >= needed) return;
  throw InputError(
      fmt::format("{}: {} x {} x {} samples in {:.0f} files, of which {} are there: going through "
                  "the fill values in place of the others would take too long; correct the shape",
                  name, size.x, size.y, size.z, info.piece_files, there));
}

}  // namespace

ScanResult scan_in_order(const SampleSource& source, const ScanHooks& hooks) {
  const VolumeInfo& info = source.info();
  const Index3 size = info.geometry.size;
  const std::uint64_t row = static_cast<std::uint64_t>(size.x) * sample_bytes(info.type);
  const auto fit = static_cast<std::int64_t>(std::max<std::uint64_t>(1, band_bytes / row));
  check_scan(source);
  // A stream gives whole slices where they are small, else bands of rows.
  const bool whole = info.access == Access::stream &&
                     row <= large_slice_bytes / static_cast<std::uint64_t>(size.y);
  const std::int64_t rows = whole ? size.y : std::min(fit, size.y);
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
