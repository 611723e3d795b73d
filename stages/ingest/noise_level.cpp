#include "stages/ingest/noise_level.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace voxweld {
namespace {

// Bins of 1/64 of their value.
constexpr int dropped_bits = 46;
constexpr std::size_t bin_count = std::size_t{1} << (63 - dropped_bits);

// One in four, and where that is of a normal distribution's magnitudes.
constexpr std::uint64_t parts = 4;
constexpr double normal_quantile = 0.31863936396437514;
// The root of the summed squares of a third difference's weights, 1 -3 3 -1.
constexpr double third_weight = 4.4721359549995796;
constexpr double rounding_noise = 0.28867513459481287;  // 1 / sqrt(12)

// To 1 or 1.5 times a power of two, whichever it is in ratio nearer to.
double rounded(double level) {
  if (!(level > 0)) return 0;
  int exponent = 0;
  const double m = std::frexp(level, &exponent);  // from 1/2 to 1
  const double kept = m * m < 0.5 * 0.75 ? 0.5 : m * m < 0.75 ? 0.75 : 1.0;
  return std::ldexp(kept, exponent);
}

bool is_integer(SampleType type) {
  return type != SampleType::f32 && type != SampleType::f64;
}

}  // namespace

NoiseMeter::NoiseMeter(SampleType type, const Isovalue& isovalue)
    : type_(type), isovalue_(isovalue.value), bins_(bin_count) {}

void NoiseMeter::add(Index3 size, const std::byte* samples) {
  dispatch_sample_type(type_, [&](auto tag) {
    using T = typename decltype(tag)::type;
    add_typed(size, reinterpret_cast<const T*>(samples));
  });
}

template <class T>
void NoiseMeter::add_typed(Index3 size, const T* samples) {
  const std::int64_t all = size.x * size.y * size.z;
  std::int64_t below = 0;
  for (std::int64_t i = 0; i < all; ++i) below += static_cast<double>(samples[i]) < isovalue_;
  if (below == 0 || below == all) return;  // as of most boxes: nothing crosses
  const std::array<std::int64_t, 3> strides{1, size.x, size.x * size.y};
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t stride = strides[static_cast<std::size_t>(axis)];
    Box3 steps{{}, size};  // from one sample to the next, with one more on both sides
    ++steps.lo[axis];
    steps.hi[axis] -= 2;
    for (std::int64_t z = steps.lo.z; z < steps.hi.z; ++z)
      for (std::int64_t y = steps.lo.y; y < steps.hi.y; ++y)
        for (std::int64_t x = steps.lo.x; x < steps.hi.x; ++x) {
          const T* p = samples + (z * size.y + y) * size.x + x;
          const auto low = static_cast<double>(p[0]), high = static_cast<double>(p[stride]);
          if ((low < isovalue_) == (high < isovalue_)) continue;
          const double third =
              (static_cast<double>(p[2 * stride]) - static_cast<double>(p[-stride])) -
              3 * (high - low);
          if (!std::isfinite(third)) continue;
          ++bins_[std::bit_cast<std::uint64_t>(std::abs(third)) >> dropped_bits];
          ++count_;
        }
  }
}

double NoiseMeter::quantile() const {
  const std::uint64_t wanted = count_ / parts;
  std::uint64_t below = 0;
  std::size_t bin = 0;
  while (below + bins_[bin] <= wanted) below += bins_[bin++];
  return std::bit_cast<double>(static_cast<std::uint64_t>(bin) << dropped_bits);
}

double NoiseMeter::level() const {
  if (count_ == 0) return 0;
  const double seen = quantile() / (normal_quantile * third_weight);
  return rounded(is_integer(type_) ? std::max(seen, rounding_noise) : seen);
}

}  // namespace voxweld
