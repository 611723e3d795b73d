// Which samples are inside, decided in the sample's own type.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "stages/contouring/parameters.h"

namespace voxweld {

// v >= threshold (or <=): exactly the comparison of v with the real number isovalue, for every
// type, since the threshold is the isovalue rounded to the next representable value on the inner
// side. NaN is outside.
template <class T>
struct InsideTest {
  bool above = true;
  bool never = false;  // no value of T is inside
  T threshold = 0;

  bool operator()(T value) const {
    return !never && (above ? value >= threshold : value <= threshold);
  }
};

namespace inside_detail {

template <class T>
T round_inward(const Isovalue& isovalue, bool above) {
  if constexpr (std::is_integral_v<T>) {
    return static_cast<T>(above ? std::ceil(isovalue.value) : std::floor(isovalue.value));
  } else {
    T rounded = static_cast<T>(isovalue.value);
    const double back = static_cast<double>(rounded);
    if (above && back < isovalue)
      rounded = std::nextafter(rounded, std::numeric_limits<T>::infinity());
    if (!above && back > isovalue)
      rounded = std::nextafter(rounded, -std::numeric_limits<T>::infinity());
    return rounded;
  }
}

}  // namespace inside_detail

// Precondition: isovalue is a number; that of integers is finite.
template <class T>
InsideTest<T> make_inside_test(const Isovalue& isovalue, Inside inside) {
  using Limits = std::numeric_limits<T>;
  InsideTest<T> test;
  test.above = inside == Inside::above;
  // Beyond the type's range every value is on one side. 2^digits is asked for too, since a double
  // cannot hold the largest 64-bit integer.
  if constexpr (std::is_integral_v<T>) {
    const double top = static_cast<double>(Limits::max());
    const double bottom = static_cast<double>(Limits::lowest());
    if (isovalue.rest != 0) {
      const __int128 integer = isovalue.integer();
      const bool high = integer > Limits::max(), low = integer < Limits::lowest();
      test.never = (high && test.above) || (low && !test.above);
      test.threshold = high ? Limits::max() : low ? Limits::lowest() : static_cast<T>(integer);
      return test;
    }
    if (isovalue.value > top || isovalue.value >= std::ldexp(1.0, Limits::digits)) {
      test.never = test.above;
      test.threshold = Limits::max();
      return test;
    }
    if (isovalue.value < bottom) {
      test.never = !test.above;
      test.threshold = Limits::lowest();
      return test;
    }
  } else {
    if (std::abs(isovalue.value) > static_cast<double>(Limits::max())) {
      const bool high = isovalue.value > 0;  // only an infinity lies beyond
      test.threshold = high ? (test.above ? Limits::infinity() : Limits::max())
                            : (test.above ? Limits::lowest() : -Limits::infinity());
      return test;
    }
  }
  test.threshold = inside_detail::round_inward<T>(isovalue, test.above);
  return test;
}

}  // namespace voxweld
