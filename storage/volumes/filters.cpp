#include "storage/volumes/filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "storage/support/error.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

constexpr std::int64_t band_bytes = std::int64_t{1} << 20;

class SourceWithInfo final : public SampleSource {
 public:
  SourceWithInfo(std::shared_ptr<SampleSource> source, VolumeInfo info)
      : source_(std::move(source)), info_(std::move(info)) {}
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override { source_->read(box, out); }
  void each_file(const Box3& box, const FileVisitor& f) const override {
    source_->each_file(box, f);
  }

 private:
  std::shared_ptr<SampleSource> source_;
  VolumeInfo info_;
};

class CropSource final : public SampleSource {
 public:
  CropSource(std::shared_ptr<SampleSource> source, const Box3& crop)
      : source_(std::move(source)), crop_(crop), info_(source_->info()) {
    VolumeGeometry& geometry = info_.geometry;
    const Index3 full = geometry.size;
    for (int axis = 0; axis < 3; ++axis)
      geometry.first[axis] += geometry.spacing[axis] * static_cast<double>(crop.lo[axis]);
    geometry.size = crop.size();
    const auto width = static_cast<std::int64_t>(sample_bytes(info_.type));
    const std::int64_t row = full.x * width;
    by_rows_ =
        info_.access == Access::rows ||
        (info_.access == Access::stream &&
         static_cast<std::uint64_t>(row) > large_slice_bytes / static_cast<std::uint64_t>(full.y));
    band_rows_ = by_rows_ ? std::clamp<std::int64_t>(band_bytes / row, 1, full.y) : full.y;
    whole_ = crop.size().x == full.x && (crop.size().y == full.y || info_.access == Access::rows);
    if (info_.access == Access::box || info_.access == Access::chunks) whole_ = true;
    for (int axis = 0; axis < 3; ++axis)
      info_.chunk_first[axis] = (info_.chunk_first[axis] - crop.lo[axis]) % info_.chunk[axis];
    if (!whole_) info_.largest_decode += static_cast<std::uint64_t>(band_rows_ * row);
  }

  const VolumeInfo& info() const override { return info_; }

  void read(const Box3& box, std::byte* out) const override {
    require_inside(box, info_);
    const Box3 wanted{box.lo + crop_.lo, box.hi + crop_.lo};
    if (whole_) return source_->read(wanted, out);
    for (std::int64_t z = wanted.lo.z; z < wanted.hi.z; ++z) out = read_slice(wanted, z, out);
  }
  void each_file(const Box3& box, const FileVisitor& f) const override {
    source_->each_file({box.lo + crop_.lo, box.hi + crop_.lo}, f);
  }

 private:
  // The source gives whole rows (or slices) only: read bands of them and keep the wanted part.
  std::byte* read_slice(const Box3& wanted, std::int64_t z, std::byte* out) const {
    const Index3 full = source_->info().geometry.size;
    const auto width = static_cast<std::int64_t>(sample_bytes(info_.type));
    const std::int64_t y_end = by_rows_ ? wanted.hi.y : full.y;
    std::int64_t y = by_rows_ ? wanted.lo.y : 0;
    for (; y < y_end; y += band_rows_) {
      const Box3 band{{0, y, z}, {full.x, std::min(y + band_rows_, y_end), z + 1}};
      band_.resize(static_cast<std::size_t>(band.count() * width));
      source_->read(band, band_.data());
      const auto keep = static_cast<std::size_t>(wanted.size().x * width);
      for (std::int64_t row = std::max(y, wanted.lo.y); row < std::min(band.hi.y, wanted.hi.y);
           ++row, out += keep)
        std::memcpy(out, band_.data() + ((row - y) * full.x + wanted.lo.x) * width, keep);
    }
    return out;
  }

  std::shared_ptr<SampleSource> source_;
  Box3 crop_;
  VolumeInfo info_;
  bool whole_ = true;     // the source takes the boxes of the crop as they are
  bool by_rows_ = false;  // else it gives whole slices only
  std::int64_t band_rows_ = 1;
  mutable std::vector<std::byte> band_;  // used by one thread at a time: access is not box
};

class EmptySource final : public RangedSource {
 public:
  explicit EmptySource(const VolumeGeometry& geometry) {
    info_.format = "empty";
    info_.type = SampleType::u8;
    info_.geometry = geometry;
    info_.access = Access::box;
  }

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    std::memset(out, 0, static_cast<std::size_t>(box.count()));
  }
  ValueRange range(const Box3&) const override {
    ValueRange zero;
    zero.empty = false;
    return zero;
  }

 private:
  VolumeInfo info_;
};

std::string text(Index3 v) {
  return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}

}  // namespace

std::unique_ptr<SampleSource> crop_source(std::shared_ptr<SampleSource> source, const Box3& box) {
  const Index3 size = source->info().geometry.size;
  if (box.empty() || !Box3{{}, size}.contains(box))
    throw InputError(fmt::format(
        "crop from {} to {}: expected a box that is not empty and lies inside the volume of {} x "
        "{} x {} samples (the upper corner is not part of the crop)",
        text(box.lo), text(box.hi), size.x, size.y, size.z));
  return std::make_unique<CropSource>(std::move(source), box);
}

std::unique_ptr<SampleSource> source_with_info(std::shared_ptr<SampleSource> source,
                                               VolumeInfo info) {
  return std::make_unique<SourceWithInfo>(std::move(source), std::move(info));
}

std::unique_ptr<SampleSource> override_source(std::shared_ptr<SampleSource> source,
                                              const GeometryOverrides& overrides) {
  VolumeInfo info = source->info();
  if (overrides.spacing) {
    const Vec3 s = *overrides.spacing;
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(s[axis]) || s[axis] <= 0)
        throw InputError(
            fmt::format("spacing ({}, {}, {}): expected three positive numbers", s.x, s.y, s.z));
    info.geometry.spacing = s;
  }
  if (!overrides.unit.empty()) info.geometry.unit = canonical_unit(overrides.unit);
  return source_with_info(std::move(source), std::move(info));
}

std::unique_ptr<RangedSource> empty_source(const VolumeGeometry& geometry) {
  return std::make_unique<EmptySource>(geometry);
}

}  // namespace voxweld
