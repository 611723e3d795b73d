#include <algorithm>

#include "stages/filter/grid_kernel.h"
#include "stages/filter/sample_keys.h"

namespace voxweld {
namespace {

using namespace filter_detail;

// The rows of the input below one row of the result, in the order in which they are summed.
template <class T>
struct RowBundle {
  const T* first = nullptr;
  Index3 factor;
  std::int64_t row = 0, slice = 0;  // samples from one to the next

  template <class F>
  void each(F&& f) const {
    for (std::int64_t z = 0; z < factor.z; ++z)
      for (std::int64_t y = 0; y < factor.y; ++y) f(first + z * slice + y * row);
  }
};

// Column by column along z and y, then along x.
template <class A, class T, class Out>
void mean_row(const RowBundle<T>& rows, std::int64_t width, A* __restrict columns, Out* out) {
  const Index3 f = rows.factor;
  const std::int64_t count = width * f.x;
  std::fill_n(columns, count, A{});
  rows.each([&](const T* row) {
    for (std::int64_t x = 0; x < count; ++x) columns[x] += static_cast<A>(row[x]);
  });
  const double divisor =
      static_cast<double>(f.x) * static_cast<double>(f.y) * static_cast<double>(f.z);
  // The common factor, as a constant: the loop becomes vectors.
  if (f.x == 2) {
    for (std::int64_t x = 0; x < width; ++x)
      out[x] = rounded<Out>(static_cast<double>(columns[2 * x] + columns[2 * x + 1]) / divisor);
    return;
  }
  for (std::int64_t x = 0; x < width; ++x) {
    A sum = columns[x * f.x];
    for (std::int64_t i = 1; i < f.x; ++i) sum += columns[x * f.x + i];
    out[x] = rounded<Out>(static_cast<double>(sum) / divisor);
  }
}

template <class T>
void max_row(const RowBundle<T>& rows, std::int64_t width, Key<T>* __restrict columns, T* out) {
  const std::int64_t fx = rows.factor.x, count = width * fx;
  std::fill_n(columns, count, Key<T>{});
  rows.each([&](const T* row) {
    for (std::int64_t x = 0; x < count; ++x) {
      const Key<T> key = key_of(row[x]);
      columns[x] = columns[x] < key ? key : columns[x];
    }
  });
  for (std::int64_t x = 0; x < width; ++x)
    out[x] = value_of<T>(*std::max_element(columns + x * fx, columns + (x + 1) * fx));
}

// The value that most have, of several the least. Sorts the keys.
template <class K>
K most_frequent(K* keys, std::int64_t count) {
  if (std::all_of(keys, keys + count, [&](K k) { return k == keys[0]; })) return keys[0];
  std::sort(keys, keys + count);
  K best = keys[0];
  for (std::int64_t i = 0, most = 0; i < count;) {
    const std::int64_t begin = i;
    while (i < count && keys[i] == keys[begin]) ++i;
    if (i - begin <= most) continue;
    most = i - begin;
    best = keys[begin];
  }
  return best;
}

template <class T>
void mode_row(const RowBundle<T>& rows, std::int64_t width, Key<T>* keys, T* out) {
  const std::int64_t fx = rows.factor.x;
  for (std::int64_t x = 0; x < width; ++x) {
    std::int64_t count = 0;
    rows.each([&](const T* row) {
      for (std::int64_t i = 0; i < fx; ++i) {
        // -0 and 0 are one value: their sum with 0 is 0.
        const T v = row[x * fx + i];
        if constexpr (std::is_floating_point_v<T>)
          keys[count++] = key_of(v + T{0});
        else
          keys[count++] = key_of(v);
      }
    });
    out[x] = value_of<T>(most_frequent(keys, count));
  }
}

class DownsampleKernel final : public GridKernel {
 public:
  DownsampleKernel(const SampleGrid& input, Index3 factor, DownsampleMethod method, SampleType type)
      : GridKernel(input, {divide(input.size, factor), type}), factor_(factor), method_(method) {}

  Box3 needs(const Box3& box) const override {
    const auto scaled = [&](Index3 p) {
      return Index3{p.x * factor_.x, p.y * factor_.y, p.z * factor_.z};
    };
    return {scaled(box.lo), scaled(box.hi)};
  }

  void apply(const Box3& box, std::span<const std::byte> samples,
             std::span<std::byte> out) const override {
    dispatch_sample_type(input().type, [&](auto tag) {
      using T = typename decltype(tag)::type;
      switch (method_) {
        case DownsampleMethod::mean:
          return apply_mean<T>(box, samples, out);
        case DownsampleMethod::max:
          return each_row<Key<T>, T, T>(box, samples, out, max_row<T>);
        case DownsampleMethod::mode:
          return each_row<Key<T>, T, T>(box, samples, out, mode_row<T>);
      }
    });
  }

  std::uint64_t scratch_bytes(const Box3& box) const override {
    return buffer_bytes<double>(scratch_count(box));
  }

 private:
  std::int64_t scratch_count(const Box3& box) const {
    return method_ == DownsampleMethod::mode ? factor_.x * factor_.y * factor_.z
                                             : box.size().x * factor_.x;
  }

  template <class T>
  void apply_mean(const Box3& box, std::span<const std::byte> samples,
                  std::span<std::byte> out) const {
    dispatch_sample_type(output().type, [&](auto tag) {
      using Out = typename decltype(tag)::type;
      if constexpr (std::is_integral_v<T> && sizeof(T) <= 2) {
        const double count = static_cast<double>(factor_.x) * static_cast<double>(factor_.y) *
                             static_cast<double>(factor_.z);
        if (count * 0x1p16 < 0x1p31)
          return each_row<std::int32_t, T, Out>(box, samples, out, mean_row<std::int32_t, T, Out>);
      }
      each_row<double, T, Out>(box, samples, out, mean_row<double, T, Out>);
    });
  }

  template <class Scratch, class T, class Out, class F>
  void each_row(const Box3& box, std::span<const std::byte> samples, std::span<std::byte> out,
                F&& f) const {
    const Index3 n = needs(box).size(), size = box.size();
    const auto scratch = buffer_of<Scratch>(scratch_count(box));
    RowBundle<T> rows{nullptr, factor_, n.x, n.x * n.y};
    Out* to = samples_as<Out>(out);
    for (std::int64_t z = 0; z < size.z; ++z)
      for (std::int64_t y = 0; y < size.y; ++y, to += size.x) {
        rows.first = samples_as<T>(samples) + z * factor_.z * rows.slice + y * factor_.y * rows.row;
        f(rows, size.x, scratch.get(), to);
      }
  }

  Index3 factor_;
  DownsampleMethod method_;
};

}  // namespace

std::unique_ptr<FilterKernel> downsample_kernel(const SampleGrid& input, Index3 factor,
                                                DownsampleMethod method, SampleType type) {
  return std::make_unique<DownsampleKernel>(input, factor, method,
                                            method == DownsampleMethod::mean ? type : input.type);
}

}  // namespace voxweld
