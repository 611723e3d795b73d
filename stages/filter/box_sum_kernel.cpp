#include "stages/filter/box_sum_kernel.h"

#include <algorithm>
#include <utility>

#include "stages/filter/row_sums.h"

namespace voxweld::filter_detail {
namespace {

template <class A>
std::uint64_t box_sums_bytes(const Box3& box, const Box3& in, Index3 radius) {
  const std::int64_t taps = 2 * std::max({radius.x, radius.y, radius.z}) + 1;
  return buffer_bytes<A>(in.size().x * in.size().y) + buffer_bytes<A>(box.size().x) +
         buffer_bytes<A>(box.size().x + 2 * radius.x) + 2 * buffer_bytes<const void*>(taps);
}

// First along z, then y, then x, a slice of the result at a time. store(row of sums, number of the
// row in the box) for each row. samples: those of `in`.
template <class A, class T, class Store>
void box_sums(const T* samples, const Box3& box, const Box3& in, const SumAxes& axes,
              Store&& store) {
  const Index3 n = in.size(), r = axes.radius;
  const std::int64_t width = box.size().x, taps = 2 * std::max({r.x, r.y, r.z}) + 1;
  const auto slice = buffer_of<A>(n.x * n.y), row = buffer_of<A>(width);
  const auto line = buffer_of<A>(width + 2 * r.x);
  const auto sources = buffer_of<const T*>(taps);
  const auto sums = buffer_of<const A*>(taps);
  const auto weights = [&](std::size_t axis) {
    return axes.weights[axis].empty() ? nullptr : axes.weights[axis].data();
  };
  // The row's samples are in the middle of the line; beyond the volume the nearest goes on.
  const std::int64_t before = in.lo.x - (box.lo.x - r.x), after = before + n.x;
  std::int64_t number = 0;
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z) {
    for (std::int64_t k = 0; k <= 2 * r.z; ++k)
      sources[static_cast<std::size_t>(k)] =
          samples + (std::clamp(z - r.z + k, in.lo.z, in.hi.z - 1) - in.lo.z) * n.x * n.y;
    sum_rows(sources.get(), weights(2), r.z, n.x * n.y, slice.get());
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y) {
      for (std::int64_t k = 0; k <= 2 * r.y; ++k)
        sums[static_cast<std::size_t>(k)] =
            slice.get() + (std::clamp(y - r.y + k, in.lo.y, in.hi.y - 1) - in.lo.y) * n.x;
      sum_rows(sums.get(), weights(1), r.y, n.x, line.get() + before);
      std::fill_n(line.get(), before, line[static_cast<std::size_t>(before)]);
      std::fill_n(line.get() + after, width + 2 * r.x - after,
                  line[static_cast<std::size_t>(after - 1)]);
      for (std::int64_t k = 0; k <= 2 * r.x; ++k)
        sums[static_cast<std::size_t>(k)] = line.get() + k;
      sum_rows(sums.get(), weights(0), r.x, width, row.get());
      store(row.get(), number++);
    }
  }
}

template <class A>
using StoreRow = void (*)(const A* row, double divisor, std::int64_t count, std::byte* out);

template <class A>
StoreRow<A> row_storing(SampleType type) {
  return dispatch_sample_type(type, [](auto tag) -> StoreRow<A> {
    using Out = typename decltype(tag)::type;
    return [](const A* row, double divisor, std::int64_t count, std::byte* out) {
      Out* to = reinterpret_cast<Out*>(out);
      if (divisor == 1) {
        for (std::int64_t x = 0; x < count; ++x) to[x] = rounded<Out>(static_cast<double>(row[x]));
      } else {
        for (std::int64_t x = 0; x < count; ++x)
          to[x] = rounded<Out>(static_cast<double>(row[x]) / divisor);
      }
    };
  });
}

// Whether sums of that many samples fit in 32 bits, of which a vector holds twice as many.
bool sums_are_short(SampleType type, const SumAxes& axes) {
  for (const auto& weights : axes.weights)
    if (!weights.empty()) return false;
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) count *= 2 * static_cast<double>(axes.radius[axis]) + 1;
  return dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    return std::is_integral_v<T> && sizeof(T) <= 2 && count * 0x1p16 < 0x1p31;
  });
}

class BoxSumKernel final : public GridKernel {
 public:
  BoxSumKernel(const SampleGrid& input, SumAxes axes, double divisor, SampleType type)
      : GridKernel(input, {input.size, type}), axes_(std::move(axes)), divisor_(divisor) {
    short_sums_ = sums_are_short(input.type, axes_);
  }

  Box3 needs(const Box3& box) const override { return widened(box, axes_.radius, input().size); }

  void apply(const Box3& box, std::span<const std::byte> samples,
             std::span<std::byte> out) const override {
    dispatch_sample_type(input().type, [&](auto tag) {
      using T = typename decltype(tag)::type;
      if constexpr (std::is_integral_v<T> && sizeof(T) <= 2)
        if (short_sums_) return sum<std::int32_t>(box, samples_as<T>(samples), out);
      sum<double>(box, samples_as<T>(samples), out);
    });
  }

  std::uint64_t scratch_bytes(const Box3& box) const override {
    return short_sums_ ? box_sums_bytes<std::int32_t>(box, needs(box), axes_.radius)
                       : box_sums_bytes<double>(box, needs(box), axes_.radius);
  }

 private:
  template <class A, class T>
  void sum(const Box3& box, const T* samples, std::span<std::byte> out) const {
    const std::int64_t width = box.size().x;
    const std::size_t row_bytes = static_cast<std::size_t>(width) * sample_bytes(output().type);
    const StoreRow<A> store = row_storing<A>(output().type);
    box_sums<A>(samples, box, needs(box), axes_, [&](const A* row, std::int64_t number) {
      store(row, divisor_, width, out.data() + static_cast<std::size_t>(number) * row_bytes);
    });
  }

  SumAxes axes_;
  double divisor_;
  bool short_sums_ = false;
};

}  // namespace

std::unique_ptr<FilterKernel> box_sum_kernel(const SampleGrid& input, SumAxes axes, double divisor,
                                             SampleType type) {
  return std::make_unique<BoxSumKernel>(input, std::move(axes), divisor, type);
}

}  // namespace voxweld::filter_detail
