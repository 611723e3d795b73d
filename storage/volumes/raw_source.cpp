#include <algorithm>
#include <cstring>
#include <mutex>
#include <utility>

#include "storage/support/byte_order.h"
#include "storage/support/file_io.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

constexpr std::uint64_t scratch_bytes = std::uint64_t{1} << 20;
// Rows at most this far apart are read in one call, with what lies between. Up to a page the system
// fetches the gap anyway, and copying it costs less than a call.
constexpr std::uint64_t worthwhile_gap_bytes = std::uint64_t{1} << 12;

// The parts of a volume as files, at most `slots` of them open at a time.
class PartFiles {
 public:
  explicit PartFiles(std::vector<DataLayout::Part> parts)
      : parts_(std::move(parts)), open_(std::min(parts_.size(), slots)) {
    if (parts_.size() > slots) return;
    for (std::size_t i = 0; i < parts_.size(); ++i)
      open_[i] = {i, std::make_shared<const ReadFile>(parts_[i].path)};
  }

  std::size_t count() const { return parts_.size(); }
  std::uint64_t offset(std::size_t part) const { return parts_[part].offset; }

  void read(std::size_t part, std::uint64_t offset, std::span<std::byte> out) const {
    if (parts_.size() <= slots)  // all open for good: no lock
      return open_[part].file->read(offset, out);
    file(part)->read(offset, out);
  }

 private:
  static constexpr std::size_t slots = 64;
  struct Slot {
    std::size_t part = 0;
    std::shared_ptr<const ReadFile> file;
  };

  // Neighbouring parts fall into different slots, so that the slices of a box stay open.
  std::shared_ptr<const ReadFile> file(std::size_t part) const {
    const std::lock_guard lock(mutex_);
    Slot& slot = open_[part % slots];
    if (!slot.file || slot.part != part)
      slot = {part, std::make_shared<const ReadFile>(parts_[part].path)};
    return slot.file;
  }

  std::vector<DataLayout::Part> parts_;
  mutable std::mutex mutex_;
  mutable std::vector<Slot> open_;
};

class RawSource final : public SampleSource {
 public:
  RawSource(VolumeInfo info, const DataLayout& layout)
      : info_(std::move(info)),
        files_(layout.parts),
        byte_order_(layout.byte_order),
        width_(sample_bytes(info_.type)) {
    info_.access = Access::box;
    info_.row_major = true;
    info_.largest_decode = scratch_bytes;
    const Index3 size = info_.geometry.size;
    row_bytes_ = static_cast<std::uint64_t>(size.x) * width_;
    slice_bytes_ = row_bytes_ * static_cast<std::uint64_t>(size.y);
    part_bytes_ = slice_bytes_ * static_cast<std::uint64_t>(size.z) / files_.count();
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;

 private:
  void read_bytes(std::uint64_t at, std::span<std::byte> out) const;
  void read_slice(const Box3& box, std::int64_t z, std::byte* out) const;

  VolumeInfo info_;
  PartFiles files_;
  std::endian byte_order_;
  std::size_t width_;
  std::uint64_t row_bytes_, slice_bytes_, part_bytes_;
};

// Bytes [at, at + out.size()) of the volume, from whichever parts hold them.
void RawSource::read_bytes(std::uint64_t at, std::span<std::byte> out) const {
  while (!out.empty()) {
    const std::uint64_t part = at / part_bytes_;
    const std::uint64_t within = at - part * part_bytes_;
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), part_bytes_ - within));
    const auto index = static_cast<std::size_t>(part);
    files_.read(index, files_.offset(index) + within, out.first(count));
    out = out.subspan(count);
    at += count;
  }
}

// One slice of a box whose rows are not whole: several rows a call where they lie close together.
void RawSource::read_slice(const Box3& box, std::int64_t z, std::byte* out) const {
  const auto row = static_cast<std::size_t>(box.size().x) * width_;
  const auto rows = static_cast<std::uint64_t>(box.size().y);
  const bool close = row_bytes_ - row <= worthwhile_gap_bytes && row_bytes_ + row <= scratch_bytes;
  const std::uint64_t batch = close ? (scratch_bytes - row) / row_bytes_ + 1 : 1;
  thread_local std::unique_ptr<std::byte[]> scratch;
  if (batch > 1 && !scratch)
    scratch = std::make_unique_for_overwrite<std::byte[]>(static_cast<std::size_t>(scratch_bytes));

  std::uint64_t at = static_cast<std::uint64_t>(z) * slice_bytes_ +
                     static_cast<std::uint64_t>(box.lo.y) * row_bytes_ +
                     static_cast<std::uint64_t>(box.lo.x) * width_;
  for (std::uint64_t done = 0; done < rows; done += batch, at += batch * row_bytes_) {
    const std::uint64_t here = std::min(batch, rows - done);
    if (here == 1) {
      read_bytes(at, {out, row});
      out += row;
      continue;
    }
    const auto span = static_cast<std::size_t>((here - 1) * row_bytes_ + row);
    read_bytes(at, {scratch.get(), span});
    for (std::uint64_t i = 0; i < here; ++i, out += row)
      std::memcpy(out, scratch.get() + i * row_bytes_, row);
  }
}

void RawSource::read(const Box3& box, std::byte* out) const {
  require_inside(box, info_);
  const Index3 size = info_.geometry.size;
  const bool whole_rows = box.size().x == size.x;
  const bool whole_slices = whole_rows && box.size().y == size.y;
  const auto slice = static_cast<std::size_t>(box.size().x * box.size().y);
  const std::int64_t step = whole_slices ? box.size().z : 1;
  for (std::int64_t z = box.lo.z; z < box.hi.z; z += step) {
    const std::size_t samples = slice * static_cast<std::size_t>(step);
    if (whole_rows)
      read_bytes(static_cast<std::uint64_t>(z) * slice_bytes_ +
                     static_cast<std::uint64_t>(box.lo.y) * row_bytes_,
                 {out, samples * width_});
    else
      read_slice(box, z, out);
    to_native(out, samples, width_, byte_order_);
    out += samples * width_;
  }
}

}  // namespace

std::unique_ptr<SampleSource> make_raw_source(VolumeInfo info, const DataLayout& layout) {
  return std::make_unique<RawSource>(std::move(info), layout);
}

}  // namespace voxweld
