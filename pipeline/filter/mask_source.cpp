#include "pipeline/filter/mask_source.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "stages/filter/stored_value.h"
#include "storage/types/counted_from_zero.h"

namespace voxweld {
namespace {

// The mask's samples that are held at once.
constexpr std::uint64_t most_mask_bytes = std::uint64_t{4} << 20;

// Whether the mask keeps what lies under a sample of that value.
class KeptValues {
 public:
  explicit KeptValues(std::vector<LabelRange> ranges) : ranges_(std::move(ranges)) {}

  template <class T>
  bool operator()(T value) const {
    if constexpr (std::is_floating_point_v<T>) {
      return false;  // masks are of integers
    } else {
      if (ranges_.empty()) return value != 0;
      if (std::is_signed_v<T> && value < 0) return false;
      const std::uint64_t label = static_cast<std::make_unsigned_t<T>>(value);
      const auto after = std::ranges::upper_bound(ranges_, label, {}, &LabelRange::first);
      return after != ranges_.begin() && label <= std::prev(after)->last;
    }
  }

 private:
  std::vector<LabelRange> ranges_;  // ascending, apart; empty: all but 0
};

class MaskSource final : public SampleSource {
 public:
  MaskSource(std::shared_ptr<SampleSource> source, std::shared_ptr<SampleSource> mask,
             const FilterConfig& filter, std::vector<std::byte> outside)
      : source_(std::move(source)),
        mask_(std::move(mask)),
        kept_(filter.values),
        outside_(std::move(outside)),
        info_(read_by_any_box(source_->info())) {
    const VolumeInfo& mask_info = mask_->info();
    info_.largest_decode =
        std::max(info_.largest_decode, mask_info.largest_decode + most_mask_bytes);
    info_.files.insert(info_.files.end(), mask_info.files.begin(), mask_info.files.end());
  }

  const VolumeInfo& info() const override { return info_; }

  void read(const Box3& box, std::byte* out) const override {
    source_->read(box, out);
    // In bands of rows, or in parts of one row: the mask may have wide samples.
    const Index3 size = box.size();
    const auto most = static_cast<std::int64_t>(most_mask_bytes / sample_bytes(mask_->info().type));
    const std::int64_t length = std::min(size.x, most);
    const std::int64_t rows = std::clamp<std::int64_t>(most / length, 1, size.y);
    std::vector<std::byte> mask;
    for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
      for (std::int64_t y = box.lo.y; y < box.hi.y; y += rows)
        for (std::int64_t x = box.lo.x; x < box.hi.x; x += length)
          apply(intersect({{x, y, z}, {x + length, y + rows, z + 1}}, box), box, out, mask);
  }

  void each_file(const Box3& box, const FileVisitor& f) const override {
    source_->each_file(box, f);
    mask_->each_file(box, f);
  }

 private:
  // Of a part of `box`, whose samples `out` holds.
  void apply(const Box3& part, const Box3& box, std::byte* out,
             std::vector<std::byte>& mask) const {
    const SampleType type = mask_->info().type;
    mask.resize(static_cast<std::size_t>(part.count()) * sample_bytes(type));
    mask_->read(part, mask.data());
    dispatch_sample_type(type, [&]<class Tag>(Tag) {
      using T = typename Tag::type;
      const std::byte* next = mask.data();
      each_index(part, [&](Index3 p) {
        T value;
        std::memcpy(&value, next, sizeof value);
        next += sizeof value;
        if (kept_(value)) return;
        const Index3 at = p - box.lo, size = box.size();
        const auto index = static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x);
        std::copy(outside_.begin(), outside_.end(), out + index * outside_.size());
      });
    });
  }

  std::shared_ptr<SampleSource> source_, mask_;
  KeptValues kept_;
  std::vector<std::byte> outside_;  // one sample
  VolumeInfo info_;
};

// Whether both say the same of where their samples lie, to a tenth of one; what says nothing agrees.
bool same_place(const VolumeGeometry& a, const VolumeGeometry& b) {
  const auto silent = [](const VolumeGeometry& g) {
    const VolumeGeometry nothing;
    return g.spacing == nothing.spacing && g.origin == nothing.origin &&
           g.direction == nothing.direction;
  };
  if (silent(a) || silent(b)) return true;
  const auto corner = [](const VolumeGeometry& g, int number) {
    Vec3 at = counted_from_zero(g).origin;
    for (int axis = 0; axis < 3; ++axis)
      if ((number >> axis & 1) != 0)
        at = at + g.direction[static_cast<std::size_t>(axis)] *
                      (g.spacing[axis] * static_cast<double>(g.size[axis] - 1));
    return at;
  };
  const double near = 0.1 * std::min({a.spacing.x, a.spacing.y, a.spacing.z});
  for (int number = 0; number < 8; ++number) {
    const Vec3 apart = corner(a, number) - corner(b, number);
    if (!(dot(apart, apart) <= near * near)) return false;
  }
  return true;
}

// The value as a sample. Integers hold whole numbers within their range only.
std::vector<std::byte> sample_of(const FilterRequest& request, const VolumeInfo& info) {
  const double real = request.filter.outside.value_or(0);
  const auto bits = nearest_stored(info.type, info.scale.stored(real));
  if (!bits)
    refuse_filter(request, fmt::format("outside = {:g}: samples of type {} cannot be that; "
                                       "choose a value that they can have",
                                       real, sample_type_name(info.type)));
  std::vector<std::byte> sample(sample_bytes(info.type));
  std::memcpy(sample.data(), &*bits, sample.size());
  return sample;
}

}  // namespace

std::shared_ptr<SampleSource> mask_source(std::shared_ptr<SampleSource> source,
                                          const FilterRequest& request) {
  const std::shared_ptr<SampleSource>& mask = request.mask;
  const std::string path = request.filter.path.string();
  if (const std::string problem = no_labels_text(mask->info()); !problem.empty())
    refuse_filter(request, fmt::format("a mask holds integers, {} {}", path, problem));
  const Index3 size = source->info().geometry.size, own = mask->info().geometry.size;
  if (own != size)
    refuse_filter(
        request,
        fmt::format("{} has {} x {} x {} samples, and what it masks has {} x {} x {}: "
                    "expected the same size; mask before filters that change the size, and "
                    "crop the mask as the volume is cropped",
                    path, own.x, own.y, own.z, size.x, size.y, size.z));
  if (!same_place(source->info().geometry, mask->info().geometry))
    spdlog::warn(
        "filter {}: {} says that it lies elsewhere in the world than what it masks, or turned "
        "otherwise: its samples are taken by their index all the same",
        request.number, path);
  auto outside = sample_of(request, source->info());
  return std::make_shared<MaskSource>(std::move(source), mask, request.filter, std::move(outside));
}

}  // namespace voxweld
