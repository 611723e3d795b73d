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

namespace voxweld {
namespace {

// Appends the samples of the box that lie on the volume's outermost layer: whole rows at its upper
// and lower faces, else the ends of each row.
void append_border(const Box3& box, Index3 size, std::size_t sample_size,
                   std::span<const std::byte> samples, std::vector<std::byte>& out) {
  const std::size_t row = static_cast<std::size_t>(box.size().x) * sample_size;
  const auto append = [&](std::span<const std::byte> part) {
    out.insert(out.end(), part.begin(), part.end());
  };
  std::size_t at = 0;
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, at += row) {
      const auto line = samples.subspan(at, row);
      if (z == 0 || z + 1 == size.z || y == 0 || y + 1 == size.y) {
        append(line);
        continue;
      }
      if (box.lo.x == 0) append(line.first(sample_size));
      if (box.hi.x == size.x && size.x > 1) append(line.last(sample_size));
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
  check_scan(source);
  HistogramStatistics statistics(info.type), border_statistics(info.type);
  ScanResult result;
  std::vector<std::byte> samples, border;
  double done = 0;
  each_scan_piece(info, [&](const Box3& piece) {
    if (hooks.interrupt != nullptr) hooks.interrupt->check();
    samples.resize(static_cast<std::size_t>(piece.count()) * sample_bytes(info.type));
    source.read(piece, samples.data());
    result.range = merge(result.range, statistics.add(samples));
    if (hooks.samples) hooks.samples(piece, samples);
    border.clear();
    append_border(piece, size, sample_bytes(info.type), samples, border);
    if (!border.empty()) border_statistics.add(border);
    done += static_cast<double>(piece.count());
    if (hooks.progress) hooks.progress(done / static_cast<double>(Box3{{}, size}.count()));
  });
  result.histogram = statistics.take();
  result.border = border_statistics.take();
  return result;
}

}  // namespace voxweld
