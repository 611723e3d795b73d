#include "pipeline/report/volume_samples.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

#include "pipeline/info/value_scan.h"
#include "stages/ingest/statistics.h"
#include "storage/types/chunk_grid.h"

namespace voxweld {
namespace {

void check(const InterruptFlag* interrupt) {
  if (interrupt != nullptr) interrupt->check();
}

Slice empty_slice(const VolumeInfo& info, int axis, const SampleRequest& request) {
  const Index3 size = info.geometry.size;
  Slice slice;
  slice.axis = axis;
  slice.index = size[axis] / 2;
  const int across = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
  slice.columns = sampled_side(across, size[across], request.side);
  slice.rows = sampled_side(up, size[up], request.side);
  const auto count = static_cast<std::size_t>(slice.columns.count * slice.rows.count);
  if (request.labels)
    slice.labels.resize(count, exterior);
  else
    slice.values.resize(count);
  return slice;
}

template <class T>
Material label_of(T stored) {
  if constexpr (std::is_floating_point_v<T>) return exterior;
  if constexpr (std::is_signed_v<T>)
    if (stored < 0) return exterior;
  return static_cast<Material>(stored);
}

// The samples i of a side that lie in [lo, hi).
struct Span {
  std::int64_t begin = 0, end = 0;
};
Span samples_in(const SampledSide& side, std::int64_t lo, std::int64_t hi) {
  const auto not_below = [&](std::int64_t bound) {
    const std::int64_t i = (bound - side.first + side.step - 1) / side.step;
    return bound <= side.first ? 0 : std::min(i, side.count);
  };
  return {not_below(lo), not_below(hi)};
}

// Puts into the slice what of it the box holds.
void take(Slice& slice, const VolumeInfo& info, const Box3& box,
          std::span<const std::byte> samples) {
  if (slice.index < box.lo[slice.axis] || slice.index >= box.hi[slice.axis]) return;
  const SampledSide &columns = slice.columns, &rows = slice.rows;
  const Span across = samples_in(columns, box.lo[columns.axis], box.hi[columns.axis]);
  const Span up = samples_in(rows, box.lo[rows.axis], box.hi[rows.axis]);
  const Index3 extent = box.size();
  dispatch_sample_type(info.type, [&]<class T>(SampleTag<T>) {
    for (std::int64_t row = up.begin; row < up.end; ++row)
      for (std::int64_t column = across.begin; column < across.end; ++column) {
        Index3 at;
        at[slice.axis] = slice.index;
        at[columns.axis] = columns.at(column);
        at[rows.axis] = rows.at(row);
        const Index3 in{at.x - box.lo.x, at.y - box.lo.y, at.z - box.lo.z};
        const auto offset = static_cast<std::size_t>((in.z * extent.y + in.y) * extent.x + in.x);
        T stored;
        std::memcpy(&stored, samples.data() + offset * sizeof(T), sizeof(T));
        if (slice.labels.empty())
          slice.values[slice.place(column, row)] = info.scale.real(static_cast<double>(stored));
        else
          slice.labels[slice.place(column, row)] = label_of(stored);
      }
  });
}

// Reads boxes into the same buffer.
class BoxReader {
 public:
  BoxReader(const SampleSource& source, const InterruptFlag* interrupt)
      : source_(source), interrupt_(interrupt) {}
  std::span<const std::byte> read(const Box3& box) {
    check(interrupt_);
    samples_.resize(static_cast<std::size_t>(box.count()) * sample_bytes(source_.info().type));
    source_.read(box, samples_.data());
    return samples_;
  }

 private:
  const SampleSource& source_;
  const InterruptFlag* interrupt_;
  std::vector<std::byte> samples_;
};

constexpr std::int64_t no_box = -1;

// Where the band of rows around sample `at` of the axis begins and ends: one sample, or, of a source
// in chunks, a chunk, so that none is decoded twice.
std::pair<std::int64_t, std::int64_t> band_around(const VolumeInfo& info, int axis,
                                                  std::int64_t at) {
  const std::int64_t chunk = info.chunk[axis], first = info.chunk_first[axis];
  if (chunk <= 1) return {at, at + 1};
  const std::int64_t from_first = at - first;
  const std::int64_t number =
      from_first >= 0 ? from_first / chunk : -((chunk - 1 - from_first) / chunk);
  const std::int64_t lo = first + number * chunk;
  return {std::max<std::int64_t>(0, lo), std::min(info.geometry.size[axis], lo + chunk)};
}

// Of a slice across rows of a file a box of many samples would be most of the volume: each is read
// by itself.
bool by_single_samples(const VolumeInfo& info, const Slice& slice) {
  return slice.axis == 0 && info.row_major && info.chunk == splat(1);
}

void read_slice(BoxReader& reader, const VolumeInfo& info, Slice& slice) {
  const SampledSide &columns = slice.columns, &rows = slice.rows;
  Box3 box{{}, info.geometry.size};
  box.lo[slice.axis] = slice.index;
  box.hi[slice.axis] = slice.index + 1;
  std::int64_t read_to = no_box;
  for (std::int64_t row = 0; row < rows.count; ++row) {
    if (rows.at(row) < read_to) continue;
    std::tie(box.lo[rows.axis], box.hi[rows.axis]) = band_around(info, rows.axis, rows.at(row));
    read_to = box.hi[rows.axis];
    if (!by_single_samples(info, slice)) {
      take(slice, info, box, reader.read(box));
      continue;
    }
    for (std::int64_t column = 0; column < columns.count; ++column) {
      box.lo[columns.axis] = columns.at(column);
      box.hi[columns.axis] = columns.at(column) + 1;
      take(slice, info, box, reader.read(box));
    }
  }
}

// Every n-th of the rows or chunks, all of them where the volume is small. n is odd, so that rows of
// all y and chunks of all places get their turn where sizes are powers of two.
std::uint64_t stride_of(std::uint64_t pieces, std::uint64_t wanted) {
  const std::uint64_t stride = pieces / std::max<std::uint64_t>(1, wanted);
  return stride <= 1 ? 1 : stride | 1U;
}

void count_samples(BoxReader& reader, const VolumeInfo& info, const SampleRequest& request,
                   SampleSurvey& out) {
  constexpr std::uint64_t least_chunks = 8;
  HistogramStatistics statistics(info.type);
  const Index3 size = info.geometry.size;
  const auto count = [&](const Box3& box) {
    statistics.add(reader.read(box));
    out.counted += static_cast<std::uint64_t>(box.count());
  };
  const auto most = static_cast<std::uint64_t>(request.most);
  if (info.chunk != splat(1)) {
    const ChunkGrid grid(info);
    const std::uint64_t chunks = grid.runs(1);
    const auto in_chunk = static_cast<std::uint64_t>(Box3{{}, info.chunk}.count());
    const std::uint64_t stride =
        stride_of(chunks, std::max(least_chunks, most / std::max<std::uint64_t>(1, in_chunk)));
    for (std::uint64_t i = stride / 2; i < chunks; i += stride) count(grid.run(i, 1));
  } else {
    const auto rows = static_cast<std::uint64_t>(size.y * size.z);
    const std::uint64_t stride = stride_of(rows, most / static_cast<std::uint64_t>(size.x));
    for (std::uint64_t i = stride / 2; i < rows; i += stride) {
      const auto y = static_cast<std::int64_t>(i) % size.y,
                 z = static_cast<std::int64_t>(i) / size.y;
      count({{0, y, z}, {size.x, y + 1, z + 1}});
    }
  }
  out.histogram = statistics.take();
}

bool gives_boxes(const VolumeInfo& info) {
  return info.access == Access::box || info.access == Access::chunks;
}

}  // namespace

SampledSide sampled_side(int axis, std::int64_t size, int most) {
  SampledSide side;
  side.axis = axis;
  side.step = (size + most - 1) / most;
  side.count = (size - 1) / side.step + 1;
  side.first = (size - 1 - (side.count - 1) * side.step) / 2;
  return side;
}

SampleSurvey look_at_samples(const SampleSource& source, const SampleRequest& request) {
  const VolumeInfo& info = source.info();
  SampleSurvey out;
  for (int i = 0; i < 3; ++i)
    out.slices[static_cast<std::size_t>(i)] = empty_slice(info, 2 - i, request);
  if (gives_boxes(info)) {
    BoxReader reader(source, request.interrupt);
    for (Slice& slice : out.slices) read_slice(reader, info, slice);
    count_samples(reader, info, request, out);
    return out;
  }
  ScanHooks hooks;
  hooks.interrupt = request.interrupt;
  hooks.samples = [&](const Box3& piece, std::span<const std::byte> samples) {
    for (Slice& slice : out.slices) take(slice, info, piece, samples);
    out.counted += static_cast<std::uint64_t>(piece.count());
  };
  out.histogram = scan_in_order(source, hooks).histogram;
  return out;
}

}  // namespace voxweld
