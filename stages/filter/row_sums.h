// Sums of rows, sample by sample. The order of a sum is the same at every place: the middle, then
// pairs from the farthest inwards. So a volume that is turned over gives the result turned over.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>

namespace voxweld::filter_detail {

// Exact where A holds it: A is double, or an integer that the sum is known to fit in.
template <class A, class T>
A pair_sum(T a, T b) {
  if constexpr (std::is_integral_v<T> && sizeof(T) <= 2) {
    return static_cast<A>(static_cast<int>(a) + static_cast<int>(b));
  } else {
    return static_cast<A>(a) + static_cast<A>(b);
  }
}

// weights == nullptr: all 1.
template <bool weighted, class A, class T>
void sum_row_part(const T* const* rows, const double* weights, std::int64_t radius,
                  std::int64_t begin, std::int64_t count, A* __restrict out) {
  const auto weight = [&](std::int64_t k) {
    if constexpr (weighted)
      return static_cast<A>(weights[k]);
    else
      return std::integral_constant<int, 1>{};
  };
  const auto times = [](A sum, [[maybe_unused]] auto w) {
    if constexpr (weighted)
      return sum * w;
    else
      return sum;
  };
  const T* middle = rows[radius] + begin;
  const auto w0 = weight(0);
  std::int64_t k = radius;
  if (k % 2 == 0) {
    for (std::int64_t x = 0; x < count; ++x) out[x] = times(static_cast<A>(middle[x]), w0);
  } else {
    const T *a = rows[0] + begin, *b = rows[2 * radius] + begin;
    const auto w = weight(k--);
    for (std::int64_t x = 0; x < count; ++x)
      out[x] = times(static_cast<A>(middle[x]), w0) + times(pair_sum<A>(a[x], b[x]), w);
  }
  // Two pairs at a time, so that the sum is fetched and put back half as often.
  for (; k > 0; k -= 2) {
    const T *a = rows[radius - k] + begin, *b = rows[radius + k] + begin;
    const T *c = rows[radius - k + 1] + begin, *d = rows[radius + k - 1] + begin;
    const auto outer = weight(k), inner = weight(k - 1);
    for (std::int64_t x = 0; x < count; ++x)
      out[x] =
          (out[x] + times(pair_sum<A>(a[x], b[x]), outer)) + times(pair_sum<A>(c[x], d[x]), inner);
  }
}

// out[x] is the sum of rows[0][x] to rows[2 radius][x], each times the weight of its distance from
// the middle. weights == nullptr: all 1. Parts of the row stay in the nearest cache.
template <class A, class T>
void sum_rows(const T* const* rows, const double* weights, std::int64_t radius, std::int64_t count,
              A* out) {
  constexpr std::int64_t part = 512;
  for (std::int64_t begin = 0; begin < count; begin += part) {
    const std::int64_t n = std::min(part, count - begin);
    if constexpr (std::is_floating_point_v<A>)
      if (weights != nullptr) {
        sum_row_part<true>(rows, weights, radius, begin, n, out + begin);
        continue;
      }
    sum_row_part<false>(rows, weights, radius, begin, n, out + begin);
  }
}

}  // namespace voxweld::filter_detail
