#include "stages/contouring/stored_surface.h"

#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "stages/contouring/inside_test.h"

namespace voxweld {
namespace {

// The values of a type in ascending order, from 0 to `last`; of floats the infinities are the ends.
template <class T, bool real = std::is_floating_point_v<T>>
struct Ranks {
  using Bits = std::make_unsigned_t<T>;
  static constexpr std::uint64_t last = std::numeric_limits<Bits>::max();
  static T value(std::uint64_t rank) {
    const auto lowest = static_cast<Bits>(std::numeric_limits<T>::lowest());
    return static_cast<T>(static_cast<Bits>(static_cast<Bits>(rank) + lowest));
  }
};
template <class T>
struct Ranks<T, true> {
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  static constexpr std::uint64_t infinity = std::bit_cast<Bits>(std::numeric_limits<T>::infinity());
  static constexpr std::uint64_t last = 2 * infinity + 1;
  static T value(std::uint64_t rank) {
    if (rank > infinity) return std::bit_cast<T>(static_cast<Bits>(rank - infinity - 1));
    return -std::bit_cast<T>(static_cast<Bits>(infinity - rank));
  }
};

// The test as it has to be. Real values never turn back as stored ones rise, rounding included, so
// the samples inside are the upper or the lower ones of the type, and their end can be searched for.
template <class T>
InsideTest<T> real_test(const SurfaceParameters& surface, const ValueScale& scale) {
  const bool above = surface.inside == Inside::above;
  const auto is_inside = [&](std::uint64_t rank) {
    const Isovalue real = scale.real(static_cast<double>(Ranks<T>::value(rank)));
    return above ? real >= surface.isovalue : real <= surface.isovalue;
  };
  InsideTest<T> test;
  test.above = above == (scale.slope > 0);
  const auto behind = [&](std::uint64_t rank) { return is_inside(rank) == test.above; };
  if (!behind(Ranks<T>::last)) {  // all are on one side
    test.never = test.above;
    test.threshold = Ranks<T>::value(Ranks<T>::last);
    return test;
  }
  std::uint64_t first = 0;
  for (std::uint64_t end = Ranks<T>::last; first < end;) {
    const std::uint64_t middle = first + (end - first) / 2;
    if (behind(middle))
      end = middle;
    else
      first = middle + 1;
  }
  test.never = !test.above && first == 0;
  test.threshold = Ranks<T>::value(test.above || first == 0 ? first : first - 1);
  return test;
}

template <class T>
bool same(const InsideTest<T>& a, const InsideTest<T>& b) {
  return a.above == b.above && a.never == b.never && (a.never || a.threshold == b.threshold);
}

// An isovalue that no value of an integer type reaches.
template <class T>
Isovalue out_of_reach(bool above) {
  using Limits = std::numeric_limits<T>;
  return Isovalue::of(above ? static_cast<__int128>(Limits::max()) + 1
                            : static_cast<__int128>(Limits::lowest()) - 1);
}

template <class T>
void convert(SurfaceParameters& surface, const ValueScale& scale) {
  const InsideTest<T> wanted = real_test<T>(surface, scale);
  surface.inside = wanted.above ? Inside::above : Inside::below;
  // Where the surface runs between two samples. Rounding may put it on the wrong side of one.
  surface.isovalue = (surface.isovalue.value - scale.intercept) / scale.slope;
  if (std::isfinite(surface.isovalue.value) &&
      same(make_inside_test<T>(surface.isovalue, surface.inside), wanted))
    return;
  if constexpr (std::is_integral_v<T>)
    surface.isovalue =
        wanted.never ? out_of_reach<T>(wanted.above) : Isovalue::of(wanted.threshold);
  else
    surface.isovalue = static_cast<double>(wanted.threshold);
}

}  // namespace

void to_stored(SurfaceParameters& surface, const ValueScale& scale, SampleType type) {
  if (scale.identity()) return;
  dispatch_sample_type(type,
                       [&](auto tag) { convert<typename decltype(tag)::type>(surface, scale); });
}

}  // namespace voxweld
