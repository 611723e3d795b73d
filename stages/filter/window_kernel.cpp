#include <algorithm>

#include "stages/filter/grid_kernel.h"

namespace voxweld {
namespace {

using namespace filter_detail;

// A straight line from (lo, a) to (hi, b), and level beyond both.
struct Ramp {
  double lo, hi, a, b, slope;

  double operator()(double v) const {
    const double inside = a + (v - lo) * slope;
    // NaN is neither and stays what it is.
    const double above = v >= hi ? b : inside;
    return v <= lo ? a : above;
  }
};

Ramp ramp_of(const WindowParameters& p) {
  const auto [a, b] = p.scale.value_or(std::array<double, 2>{p.lo, p.hi});
  // Quarters: a difference of two doubles may be no double.
  const double slope = (b / 4 - a / 4) / (p.hi / 4 - p.lo / 4);
  return {p.lo, p.hi, a, b, p.scale ? slope : 1};
}

class WindowKernel final : public GridKernel {
 public:
  WindowKernel(const SampleGrid& input, const WindowParameters& parameters)
      : GridKernel(input, {input.size, parameters.type}),
        ramp_(ramp_of(parameters)),
        scaled_(parameters.scale.has_value()) {}

  Box3 needs(const Box3& box) const override { return box; }
  bool one_to_one() const override { return true; }
  std::uint64_t scratch_bytes(const Box3&) const override { return 0; }

  void apply(const Box3& box, std::span<const std::byte> samples,
             std::span<std::byte> out) const override {
    dispatch_sample_type(input().type, [&](auto from_tag) {
      using From = typename decltype(from_tag)::type;
      dispatch_sample_type(output().type, [&](auto to_tag) {
        using To = typename decltype(to_tag)::type;
        fill(samples_as<From>(samples), box.count(), samples_as<To>(out));
      });
    });
  }

 private:
  template <class From, class To>
  void fill(const From* from, std::int64_t count, To* __restrict to) const {
    const Ramp ramp = ramp_;
    if (scaled_) {
      for (std::int64_t i = 0; i < count; ++i)
        to[i] = rounded<To>(kept(ramp(static_cast<double>(from[i]))));
    } else {
      for (std::int64_t i = 0; i < count; ++i) {
        const double v = static_cast<double>(from[i]);
        const double above = v >= ramp.hi ? ramp.hi : v;
        to[i] = rounded<To>(v <= ramp.lo ? ramp.lo : above);
      }
    }
  }

  // What rounding has carried beyond the range comes back.
  double kept(double v) const {
    const double least = std::min(ramp_.a, ramp_.b), most = std::max(ramp_.a, ramp_.b);
    const double above = v > most ? most : v;
    return v < least ? least : above;
  }

  Ramp ramp_;
  bool scaled_;
};

}  // namespace

std::unique_ptr<FilterKernel> window_kernel(const SampleGrid& input,
                                            const WindowParameters& parameters) {
  return std::make_unique<WindowKernel>(input, parameters);
}

}  // namespace voxweld
