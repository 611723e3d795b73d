#include "pipeline/filter/filter_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/filter/mask_source.h"
#include "stages/filter/kernel.h"
#include "storage/types/counted_from_zero.h"

namespace voxweld {
namespace {

// What one read holds beside the caller's buffer, as far as halos allow: larger boxes are cut. The
// smaller the pieces, the more of them is halo.
constexpr std::uint64_t most_with_halo = std::uint64_t{48} << 20;
constexpr std::uint64_t most_without_halo = std::uint64_t{4} << 20;

std::uint64_t bytes_of(const Box3& box, SampleType type) {
  return static_cast<std::uint64_t>(box.count()) * sample_bytes(type);
}

// Where a box that is part of `whole` goes in the buffer of `whole`.
void copy_box(const Box3& box, const std::byte* from, const Box3& whole, std::byte* to,
              std::size_t width) {
  const Index3 size = whole.size();
  const auto row = static_cast<std::size_t>(box.size().x) * width;
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, from += row) {
      const Index3 at = Index3{box.lo.x, y, z} - whole.lo;
      const auto offset = static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x);
      std::copy_n(from, row, to + offset * width);
    }
}

class KernelSource final : public SampleSource {
 public:
  KernelSource(std::shared_ptr<SampleSource> source, std::unique_ptr<FilterKernel> kernel,
               VolumeInfo info)
      : source_(std::move(source)), kernel_(std::move(kernel)), info_(std::move(info)) {
    if (kernel_->one_to_one()) most_held_ = most_without_halo;
    // One sample may need more than is meant to be held.
    const Box3 one{{}, splat(1)};
    info_.largest_decode = source_->info().largest_decode + std::max(most_held_, held_bytes(one));
  }

  const VolumeInfo& info() const override { return info_; }

  void read(const Box3& box, std::byte* out) const override { read_part(box, box, out); }

  void each_file(const Box3& box, const FileVisitor& f) const override {
    source_->each_file(kernel_->needs(box), f);
  }

 private:
  std::uint64_t held_bytes(const Box3& box) const {
    return bytes_of(kernel_->needs(box), kernel_->input().type) + kernel_->scratch_bytes(box) +
           bytes_of(box, info_.type);
  }

  // Of a part of `box`, whose buffer `out` is.
  void read_part(const Box3& part, const Box3& box, std::byte* out) const {
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (part.size()[axis] >= part.size()[longest]) longest = axis;
    const std::int64_t side = part.size()[longest];
    if (side > 1 && held_bytes(part) > most_held_) {
      Box3 lower = part, upper = part;
      lower.hi[longest] = upper.lo[longest] = part.lo[longest] + side / 2;
      read_part(lower, box, out);
      read_part(upper, box, out);
      return;
    }
    const Box3 needed = kernel_->needs(part);
    std::vector<std::byte> samples(bytes_of(needed, kernel_->input().type));
    source_->read(needed, samples.data());
    const std::uint64_t bytes = bytes_of(part, info_.type);
    if (part == box) return kernel_->apply(part, samples, {out, bytes});
    std::vector<std::byte> result(bytes);
    kernel_->apply(part, samples, result);
    copy_box(part, result.data(), box, out, sample_bytes(info_.type));
  }

  std::shared_ptr<SampleSource> source_;
  std::unique_ptr<FilterKernel> kernel_;
  VolumeInfo info_;
  std::uint64_t most_held_ = most_with_halo;
};

VolumeGeometry flipped(VolumeGeometry geometry, const std::array<bool, 3>& axes) {
  geometry = counted_from_zero(geometry);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3& direction = geometry.direction[static_cast<std::size_t>(axis)];
    if (!axes[static_cast<std::size_t>(axis)]) continue;
    const double length = geometry.spacing[axis] * static_cast<double>(geometry.size[axis] - 1);
    geometry.origin = geometry.origin + direction * length;
    direction = Vec3{} - direction;
  }
  return geometry;
}

VolumeGeometry permuted(const VolumeGeometry& before, const std::array<int, 3>& order) {
  const VolumeGeometry from = counted_from_zero(before);
  VolumeGeometry geometry = from;
  for (int axis = 0; axis < 3; ++axis) {
    const int old = order[static_cast<std::size_t>(axis)];
    geometry.size[axis] = from.size[old];
    geometry.spacing[axis] = from.spacing[old];
    geometry.direction[static_cast<std::size_t>(axis)] =
        from.direction[static_cast<std::size_t>(old)];
  }
  return geometry;
}

// A sample lies in the middle of those it is made from.
VolumeGeometry coarser(VolumeGeometry geometry, Index3 factor) {
  geometry = counted_from_zero(geometry);
  for (int axis = 0; axis < 3; ++axis) {
    const auto times = static_cast<double>(factor[axis]);
    geometry.origin = geometry.origin + geometry.direction[static_cast<std::size_t>(axis)] *
                                            (geometry.spacing[axis] * (times - 1) / 2);
    geometry.spacing[axis] *= times;
    geometry.size[axis] /= factor[axis];
  }
  return geometry;
}

// The config's numbers are real values, the kernel's are stored ones.
WindowParameters window_parameters(const FilterConfig& filter, const VolumeInfo& info,
                                   SampleType type) {
  WindowParameters window;
  window.lo = info.scale.stored(filter.clip[0]);
  window.hi = info.scale.stored(filter.clip[1]);
  window.scale = filter.scale;
  window.type = type;
  if (window.lo > window.hi) {  // the stored values fall where the real ones rise
    std::swap(window.lo, window.hi);
    if (window.scale) std::swap((*window.scale)[0], (*window.scale)[1]);
  }
  return window;
}

DownsampleMethod method_of(FilterConfig::Method method) {
  switch (method) {
    case FilterConfig::Method::mean:
      return DownsampleMethod::mean;
    case FilterConfig::Method::max:
      return DownsampleMethod::max;
    case FilterConfig::Method::mode:
      break;
  }
  return DownsampleMethod::mode;
}

void check_factor(const FilterRequest& request, Index3 size) {
  const Index3 factor = request.filter.factor;
  for (int axis = 0; axis < 3; ++axis)
    if (factor[axis] > size[axis])
      refuse_filter(request,
                    fmt::format("factor = [{}, {}, {}]: expected at most the samples there are "
                                "along each axis, {} x {} x {}; lower it",
                                factor.x, factor.y, factor.z, size.x, size.y, size.z));
}

std::unique_ptr<FilterKernel> kernel_of(const FilterRequest& request, const VolumeInfo& info) {
  const FilterConfig& filter = request.filter;
  const SampleGrid grid{info.geometry.size, info.type};
  const SampleType type = filter.sample_type.value_or(info.type);
  switch (filter.type) {
    case FilterType::window:
      return window_kernel(grid, window_parameters(filter, info, type));
    case FilterType::gaussian:
      return gaussian_kernel(grid, filter.sigma, type);
    case FilterType::mean:
      return mean_kernel(grid, filter.radius, type);
    case FilterType::median:
      return median_kernel(grid, filter.radius);
    case FilterType::downsample:
      check_factor(request, grid.size);
      return downsample_kernel(grid, filter.factor, method_of(filter.method), type);
    case FilterType::flip:
      return flip_kernel(grid, filter.flipped);
    case FilterType::permute:
      return permute_kernel(grid, filter.order);
    case FilterType::mask:
    case FilterType::keep:
    case FilterType::fill:
      break;
  }
  return nullptr;
}

}  // namespace

std::shared_ptr<SampleSource> filter_source(std::shared_ptr<SampleSource> source,
                                            const FilterRequest& request) {
  const FilterConfig& filter = request.filter;
  if (filter.type == FilterType::mask) return mask_source(std::move(source), request);
  VolumeInfo info = read_by_any_box(source->info());
  auto kernel = kernel_of(request, source->info());
  VolumeGeometry& geometry = info.geometry;
  if (filter.type == FilterType::flip) geometry = flipped(geometry, filter.flipped);
  if (filter.type == FilterType::permute) geometry = permuted(geometry, filter.order);
  if (filter.type == FilterType::downsample) geometry = coarser(geometry, filter.factor);
  info.type = kernel->output().type;
  // Then the samples are the real values.
  if (filter.type == FilterType::window && filter.scale) info.scale = {};
  return std::make_shared<KernelSource>(std::move(source), std::move(kernel), std::move(info));
}

bool reads_through(const FilterConfig& filter) {
  switch (filter.type) {
    case FilterType::window:
    case FilterType::flip:
    case FilterType::permute:
    case FilterType::mask:
      return true;
    default:
      return false;
  }
}

bool moves_samples(const FilterConfig& filter) {
  return filter.type == FilterType::downsample || filter.type == FilterType::flip ||
         filter.type == FilterType::permute;
}

}  // namespace voxweld
