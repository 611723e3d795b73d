#include "stages/filter/median_rows.h"

namespace voxweld {
namespace {

using namespace filter_detail;

class MedianKernel final : public GridKernel {
 public:
  MedianKernel(const SampleGrid& input, Index3 radius)
      : GridKernel(input, input), radius_(radius) {}

  Box3 needs(const Box3& box) const override { return widened(box, radius_, input().size); }

  void apply(const Box3& box, std::span<const std::byte> samples,
             std::span<std::byte> out) const override {
    dispatch_sample_type(input().type, [&](auto tag) {
      using T = typename decltype(tag)::type;
      const KeyRowsShape shape = shape_of(box);
      KeyRows<T> rows(shape, samples_as<T>(samples));
      T* to = samples_as<T>(out);
      if (is_cube())
        fill_cubes(shape, rows, to);
      else if (is_small())
        each_row(shape, rows, to, [&](std::int64_t y, std::int64_t z, Key<T>* keys) {
          fill_from_rows(rows, shape, y, z, keys);
        });
      else
        fill_large(shape, rows, to);
    });
  }

  std::uint64_t scratch_bytes(const Box3& box) const override {
    return dispatch_sample_type(input().type, [&](auto tag) {
      using T = typename decltype(tag)::type;
      const KeyRowsShape shape = shape_of(box);
      const std::uint64_t bytes =
          buffer_bytes<Key<T>>(shape.keys()) + buffer_bytes<Key<T>>(shape.box.size().x);
      if (is_cube()) return bytes + MedianOfCube<T>::bytes(shape);
      if (is_small()) return bytes;
      const std::uint64_t pointers = buffer_bytes<const void*>(window_rows());
      if constexpr (sizeof(T) <= 2)
        if (slides<T>()) return bytes + pointers + SlidingHistogram<Key<T>>::bytes();
      return bytes + pointers + MedianByBits<Key<T>>::bytes(window_rows(), radius_.x);
    });
  }

 private:
  KeyRowsShape shape_of(const Box3& box) const { return {box, needs(box), radius_}; }
  std::int64_t window_rows() const { return (2 * radius_.y + 1) * (2 * radius_.z + 1); }
  bool is_small() const { return radius_.x <= 1 && radius_.y <= 1 && radius_.z <= 1; }
  bool is_cube() const { return radius_ == splat(1); }

  // fill(y, z, keys of the row) for each row of the box.
  template <class T, class Fill>
  static void each_row(const KeyRowsShape& shape, KeyRows<T>& rows, T* to, Fill&& fill) {
    const Box3& box = shape.box;
    const std::int64_t width = box.size().x;
    const auto keys = buffer_of<Key<T>>(width);
    for (std::int64_t z = box.lo.z; z < box.hi.z; ++z) {
      rows.go_to(z);
      for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, to += width) {
        fill(y, z, keys.get());
        for (std::int64_t x = 0; x < width; ++x)
          to[x] = value_of<T>(keys[static_cast<std::size_t>(x)]);
      }
    }
  }

  template <class T>
  static void fill_cubes(const KeyRowsShape& shape, KeyRows<T>& rows, T* to) {
    MedianOfCube<T> cube(shape);
    each_row(shape, rows, to,
             [&](std::int64_t y, std::int64_t z, Key<T>* keys) { cube.fill(rows, y, z, keys); });
  }

  // Whether moving the window costs less than looking at all of it, or its samples are too many for
  // a key of theirs to count.
  template <class T>
  bool slides() const {
    return sizeof(T) <= 2 && window_rows() * (2 * radius_.x + 1) > 255;
  }

  template <class T>
  void fill_large(const KeyRowsShape& shape, KeyRows<T>& rows, T* to) const {
    if constexpr (sizeof(T) <= 2)
      if (slides<T>()) return fill_windows(shape, rows, SlidingHistogram<Key<T>>(), to);
    fill_windows(shape, rows, MedianByBits<Key<T>>(window_rows(), radius_.x), to);
  }

  template <class T, class Medians>
  void fill_windows(const KeyRowsShape& shape, KeyRows<T>& rows, Medians medians, T* to) const {
    const auto window = buffer_of<const Key<T>*>(window_rows());
    each_row(shape, rows, to, [&](std::int64_t y, std::int64_t z, Key<T>* keys) {
      std::size_t i = 0;
      for (std::int64_t k = -radius_.z; k <= radius_.z; ++k)
        for (std::int64_t j = -radius_.y; j <= radius_.y; ++j) window[i++] = rows.row(y + j, z + k);
      medians.fill(window.get(), window_rows(), radius_.x, shape.box.size().x, keys);
    });
  }

  Index3 radius_;
};

}  // namespace

std::unique_ptr<FilterKernel> median_kernel(const SampleGrid& input, Index3 radius) {
  return std::make_unique<MedianKernel>(input, radius);
}

}  // namespace voxweld
