#include "stages/build/label_field.h"

#include <algorithm>
#include <type_traits>

namespace voxweld {
namespace {

std::size_t offset(Index3 at, Index3 size) {
  return static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x);
}

}  // namespace

// Of box and `reach` around it, whatever the volume's border.
void LabelField::fill_indicator(const HaloBlock& block, std::uint64_t label, const Box3& box) {
  const Index3 lo = box.lo - splat(reach), size = box.size() + splat(std::int64_t{2} * reach);
  field_.resize(static_cast<std::size_t>(size.x * size.y * size.z));
  dispatch_sample_type(block.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    if constexpr (std::is_integral_v<T>) {
      const LabelTest<T> is_label(label);
      const T* data = reinterpret_cast<const T*>(block.data);
      const auto clamped = [&](Index3 at, int axis) {
        return std::clamp<std::int64_t>(at[axis], 0, block.size[axis] - 1) - block.samples.lo[axis];
      };
      // Of a row the samples that the volume has, and how far its outermost ones go on.
      const std::int64_t first = std::clamp<std::int64_t>(lo.x, 0, block.size.x - 1);
      const std::int64_t last = std::clamp<std::int64_t>(lo.x + size.x - 1, 0, block.size.x - 1);
      const std::int64_t before = first - lo.x, own = last - first + 1;
      const T* const from = data + (first - block.samples.lo.x);
      std::int32_t* out = field_.data();
      for (Index3 at = lo; at.z < lo.z + size.z; ++at.z)
        for (at.y = lo.y; at.y < lo.y + size.y; ++at.y, out += size.x) {
          const T* row = from + clamped(at, 2) * block.slice + clamped(at, 1) * block.row;
          for (std::int64_t x = 0; x < own; ++x) out[before + x] = is_label(row[x]) ? 1 : 0;
          std::fill(out, out + before, out[before]);
          std::fill(out + before + own, out + size.x, out[before + own - 1]);
        }
    }
  });
}

// In place of `field_`, of `size`: each value by the five along the axis that it is the first of.
void LabelField::filter_along(int axis, Index3 size) {
  Index3 less = size;
  less[axis] -= std::int64_t{2} * reach;
  rows_.resize(static_cast<std::size_t>(less.x * less.y * less.z));
  const std::size_t step = axis == 0   ? 1
                           : axis == 1 ? static_cast<std::size_t>(size.x)
                                       : static_cast<std::size_t>(size.x * size.y);
  std::int32_t* out = rows_.data();
  for (std::int64_t z = 0; z < less.z; ++z)
    for (std::int64_t y = 0; y < less.y; ++y) {
      const std::int32_t* p = field_.data() + offset({0, y, z}, size);
      for (std::int64_t x = 0; x < less.x; ++x, ++p)
        *out++ = p[0] + 4 * p[step] + 6 * p[2 * step] + 4 * p[3 * step] + p[4 * step];
    }
  std::swap(field_, rows_);
}

HaloBlock LabelField::filter(const HaloBlock& block, std::uint64_t label, const Box3& box) {
  fill_indicator(block, label, box);
  Index3 size = box.size() + splat(std::int64_t{2} * reach);
  for (int axis = 0; axis < 3; ++axis) {
    filter_along(axis, size);
    size[axis] -= std::int64_t{2} * reach;
  }
  return {SampleType::i32, block.size,     box, reinterpret_cast<const std::byte*>(field_.data()),
          size.x,          size.x * size.y};
}

}  // namespace voxweld
