#include "stages/filter/stored_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace voxweld {
namespace {

template <class T>
std::optional<StoredBits> nearest_of(double number) {
  if (!std::isfinite(number)) return {};
  if constexpr (std::is_integral_v<T>) {
    // 2^digits is a double, which the largest integer of 64 bits is not.
    const double rounded = std::nearbyint(number);
    const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (rounded >= end || rounded < static_cast<double>(std::numeric_limits<T>::lowest()))
      return {};
    return stored_bits(static_cast<T>(rounded));
  } else {
    // A double beyond the floats has no defined conversion.
    if (std::abs(number) > static_cast<double>(std::numeric_limits<T>::max())) return {};
    return stored_bits(static_cast<T>(number));
  }
}

}  // namespace

std::optional<StoredBits> nearest_stored(SampleType type, double number) {
  return dispatch_sample_type(
      type, [&](auto tag) { return nearest_of<typename decltype(tag)::type>(number); });
}

bool is_inside(SampleType type, StoredBits bits, const Isovalue& isovalue, Inside inside) {
  return dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    return make_inside_test<T>(isovalue, inside)(stored_value<T>(bits));
  });
}

std::string stored_text(SampleType type, StoredBits bits) {
  return dispatch_sample_type(type, [&](auto tag) {
    return fmt::format("{}", stored_value<typename decltype(tag)::type>(bits));
  });
}

StoredRange merge(SampleType type, const StoredRange& a, const StoredRange& b) {
  if (a.empty) return b;
  if (b.empty) return a;
  return dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const auto value = [](StoredBits bits) { return stored_value<T>(bits); };
    return StoredRange{false, stored_bits(std::min(value(a.least), value(b.least))),
                       stored_bits(std::max(value(a.greatest), value(b.greatest)))};
  });
}

}  // namespace voxweld
