#include "pipeline/build/common_material.h"

#include <cmath>

namespace voxweld {
namespace {

// Materials met so far, as long as they are one.
class Common {
 public:
  void add(Material material) {
    mixed_ = mixed_ || (found_ && *found_ != material);
    found_ = material;
  }
  // Each by its own number.
  void add_own(std::uint64_t first, std::uint64_t last) {
    mixed_ = mixed_ || first != last;
    add(first);
  }
  std::optional<Material> result() const { return mixed_ ? std::nullopt : found_; }

 private:
  std::optional<Material> found_;
  bool mixed_ = false;
};

void add_values(const MaterialRules& rules, std::uint64_t first, std::uint64_t last, Common& out) {
  const auto add_unnamed = [&](std::uint64_t from, std::uint64_t to) {
    rules.others ? out.add_own(from, to) : out.add(exterior);
  };
  for (const MaterialRange& range : rules.ranges) {
    if (range.last < first) continue;
    if (range.first > last) break;
    if (range.first > first) add_unnamed(first, range.first - 1);
    const std::uint64_t from = std::max(first, range.first), to = std::min(last, range.last);
    range.own ? out.add_own(from, to) : out.add(range.material);
    if (to == last) return;
    first = to + 1;
  }
  add_unnamed(first, last);
}

}  // namespace

std::optional<Material> common_material(const MaterialRules& rules, const ValueRange& range) {
  if (range.empty) return exterior;
  // Ranges of 64-bit integers are rounded outward, so one value alone may stand for its neighbours.
  constexpr double exact = 9007199254740992.0;    // 2^53
  constexpr double top = 18446744073709551616.0;  // 2^64
  Common common;
  if (range.lo < 0) common.add(exterior);
  if (range.hi >= 0) {
    const double lo = range.lo < 0 ? 0 : range.lo;
    const bool rounded = range.hi >= exact;
    const auto first = static_cast<std::uint64_t>(rounded ? std::nextafter(lo, 0.0) : lo);
    const double above = rounded ? std::nextafter(range.hi, top) : range.hi;
    add_values(rules, first, above >= top ? exterior : static_cast<std::uint64_t>(above), common);
  }
  return common.result();
}

}  // namespace voxweld
