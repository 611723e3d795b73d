#include "storage/spool/box_reader.h"

#include <algorithm>
#include <cstring>
#include <memory>

namespace voxweld {
namespace {

constexpr std::uint64_t scratch_bytes = std::uint64_t{1} << 20;
// Copying this much from the page cache costs about as much as a system call.
constexpr std::uint64_t worthwhile_gap = 16 << 10;

struct RowRun {
  std::uint64_t offset = 0;  // of the first row's first wanted byte
  std::uint64_t stride = 0;  // bytes from row to row in the file
  std::uint64_t width = 0;   // wanted bytes of a row
  std::uint64_t rows = 0;
};

void read_rows_together(const ReadFile& file, const RowRun& run, std::byte* out) {
  const std::uint64_t span = (run.rows - 1) * run.stride + run.width;
  const std::uint64_t most = std::min(scratch_bytes, span);
  const std::uint64_t batch = 1 + (most - run.width) / run.stride;
  const auto scratch = std::make_unique_for_overwrite<std::byte[]>(most);
  for (std::uint64_t row = 0; row < run.rows; row += batch) {
    const std::uint64_t rows = std::min(batch, run.rows - row);
    const std::uint64_t bytes = (rows - 1) * run.stride + run.width;
    file.read(run.offset + row * run.stride, std::span(scratch.get(), bytes));
    for (std::uint64_t i = 0; i < rows; ++i, out += run.width)
      std::memcpy(out, scratch.get() + i * run.stride, run.width);
  }
}

void read_run(const ReadFile& file, const RowRun& run, std::byte* out) {
  const bool together = run.rows > 1 && run.stride - run.width <= worthwhile_gap &&
                        run.stride + run.width <= scratch_bytes;
  if (together) {
    read_rows_together(file, run, out);
    return;
  }
  for (std::uint64_t row = 0; row < run.rows; ++row, out += run.width)
    file.read(run.offset + row * run.stride, std::span(out, run.width));
}

}  // namespace

void read_raw_box(const ReadFile& file, const RawArray& layout, const Box3& box, std::byte* out) {
  const auto bytes = [&](std::int64_t samples) {
    return static_cast<std::uint64_t>(samples) * layout.sample_size;
  };
  const Index3 size = box.size();
  const std::uint64_t stride = bytes(layout.size.x);
  const std::uint64_t slice = stride * static_cast<std::uint64_t>(layout.size.y);
  const auto begin_of = [&](std::int64_t z) {
    return layout.offset + static_cast<std::uint64_t>(z) * slice +
           static_cast<std::uint64_t>(box.lo.y) * stride + bytes(box.lo.x);
  };
  const bool whole_rows = size.x == layout.size.x;
  if (whole_rows && size.y == layout.size.y) {
    file.read(begin_of(box.lo.z), std::span(out, bytes(box.count())));
    return;
  }
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z, out += bytes(size.x * size.y)) {
    if (whole_rows)
      file.read(begin_of(z), std::span(out, bytes(size.x * size.y)));
    else
      read_run(file, {begin_of(z), stride, bytes(size.x), static_cast<std::uint64_t>(size.y)}, out);
  }
}

}  // namespace voxweld
