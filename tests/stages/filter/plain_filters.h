// The filters as plainly as they can be written, sample by sample on a whole volume, to judge the
// real ones by.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "stages/filter/kernel.h"

namespace voxweld::testing {

template <class T>
struct Grid {
  Index3 size;
  std::vector<T> values;

  const T& at(Index3 p) const {
    const Index3 q = max(min(p, size - splat(1)), splat(0));
    return values[static_cast<std::size_t>((q.z * size.y + q.y) * size.x + q.x)];
  }
  template <class F>
  static Grid made(Index3 size, F&& f) {
    Grid grid{size, {}};
    each_index(size, [&](Index3 p) { grid.values.push_back(static_cast<T>(f(p))); });
    return grid;
  }
};

template <class T>
SampleType type_of() {
  for (int i = 0; i < 10; ++i) {
    const auto type = static_cast<SampleType>(i);
    if (dispatch_sample_type(
            type, [](auto tag) { return std::is_same_v<typename decltype(tag)::type, T>; }))
      return type;
  }
  return SampleType::f64;
}

// Of the whole range of the type, or of few values, so that there are ties. Doubles: without the
// largest, of which sums overflow.
template <class T>
Grid<T> random_grid(Index3 size, std::mt19937_64& random, bool few) {
  return Grid<T>::made(size, [&](Index3) {
    if (few) return static_cast<T>(random() % 5);
    if constexpr (std::is_floating_point_v<T>)
      return static_cast<T>(static_cast<double>(random() >> 11) * 0x1p-43 - 512);
    else
      return static_cast<T>(random());
  });
}

// To the nearest, ties to even.
template <class T>
T plain_rounded(long double v) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(v);
  } else {
    if (std::isnan(v)) return 0;
    const long double least = std::numeric_limits<T>::min(), most = std::numeric_limits<T>::max();
    return static_cast<T>(std::clamp(std::nearbyint(v), least, most));
  }
}

template <class T>
std::vector<T> window_of(const Grid<T>& in, Index3 at, Index3 radius) {
  std::vector<T> values;
  each_index(Box3{at - radius, at + radius + splat(1)},
             [&](Index3 p) { values.push_back(in.at(p)); });
  return values;
}

template <class T>
bool before(T a, T b) {
  return a < b || (b != b && a == a);
}

template <class T>
Grid<T> plain_median(const Grid<T>& in, Index3 radius) {
  return Grid<T>::made(in.size, [&](Index3 at) {
    std::vector<T> values = window_of(in, at, radius);
    std::sort(values.begin(), values.end(), before<T>);
    return values[values.size() / 2];
  });
}

template <class T>
Grid<double> plain_mean(const Grid<T>& in, Index3 radius) {
  return Grid<double>::made(in.size, [&](Index3 at) {
    const std::vector<T> values = window_of(in, at, radius);
    long double sum = 0;
    for (const T v : values) sum += static_cast<long double>(v);
    return static_cast<double>(sum / static_cast<long double>(values.size()));
  });
}

inline std::vector<long double> plain_weights(double sigma) {
  const auto radius = static_cast<int>(std::floor(4 * sigma + 0.5));
  std::vector<long double> weights;
  long double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const long double s = sigma;
    weights.push_back(sigma > 0 ? std::exp(-0.5L * k * k / (s * s)) : 1);
    sum += weights.back();
  }
  for (long double& w : weights) w /= sum;
  return weights;
}

template <class T>
Grid<double> plain_gaussian(const Grid<T>& in, Vec3 sigma) {
  const auto wx = plain_weights(sigma.x), wy = plain_weights(sigma.y), wz = plain_weights(sigma.z);
  const auto radius_of = [](const auto& w) { return static_cast<std::int64_t>(w.size() / 2); };
  const Index3 r{radius_of(wx), radius_of(wy), radius_of(wz)};
  return Grid<double>::made(in.size, [&](Index3 at) {
    long double sum = 0;
    each_index(r + r + splat(1), [&](Index3 k) {
      sum += static_cast<long double>(in.at(at - r + k)) * wx[static_cast<std::size_t>(k.x)] *
             wy[static_cast<std::size_t>(k.y)] * wz[static_cast<std::size_t>(k.z)];
    });
    return static_cast<double>(sum);
  });
}

template <class T>
std::vector<T> block_of(const Grid<T>& in, Index3 at, Index3 factor) {
  std::vector<T> values;
  each_index(factor, [&](Index3 k) {
    values.push_back(in.at(Index3{at.x * factor.x, at.y * factor.y, at.z * factor.z} + k));
  });
  return values;
}

template <class T>
Grid<double> plain_block_mean(const Grid<T>& in, Index3 factor) {
  return Grid<double>::made(divide(in.size, factor), [&](Index3 at) {
    long double sum = 0;
    for (const T v : block_of(in, at, factor)) sum += static_cast<long double>(v);
    return static_cast<double>(sum / static_cast<long double>(factor.x * factor.y * factor.z));
  });
}

template <class T>
Grid<T> plain_block_max(const Grid<T>& in, Index3 factor) {
  return Grid<T>::made(divide(in.size, factor), [&](Index3 at) {
    const std::vector<T> values = block_of(in, at, factor);
    return *std::max_element(values.begin(), values.end(), before<T>);
  });
}

template <class T>
Grid<T> plain_block_mode(const Grid<T>& in, Index3 factor) {
  return Grid<T>::made(divide(in.size, factor), [&](Index3 at) {
    std::map<T, int, bool (*)(T, T)> counts(before<T>);
    for (const T v : block_of(in, at, factor)) ++counts[v];
    return std::max_element(counts.begin(), counts.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  });
}

// The box of the result, made from a copy of exactly what it needs.
template <class Out, class T>
std::vector<Out> filtered(const FilterKernel& kernel, const Grid<T>& in, const Box3& box) {
  std::vector<T> samples;
  each_index(kernel.needs(box), [&](Index3 p) { samples.push_back(in.at(p)); });
  std::vector<Out> out(static_cast<std::size_t>(box.count()));
  kernel.apply(box, std::as_bytes(std::span(samples)), std::as_writable_bytes(std::span(out)));
  return out;
}
template <class Out, class T>
std::vector<Out> filtered(const FilterKernel& kernel, const Grid<T>& in) {
  return filtered<Out>(kernel, in, {{}, kernel.output().size});
}

inline Box3 random_box(Index3 size, std::mt19937_64& random) {
  Box3 box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::uint64_t>(size[axis]);
    box.lo[axis] = static_cast<std::int64_t>(random() % n);
    box.hi[axis] =
        box.lo[axis] + 1 +
        static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(size[axis] - box.lo[axis]));
  }
  return box;
}

inline Index3 random_index(std::int64_t least, std::int64_t most, std::mt19937_64& random) {
  Index3 p;
  for (int axis = 0; axis < 3; ++axis)
    p[axis] =
        least + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most - least + 1));
  return p;
}

}  // namespace voxweld::testing
