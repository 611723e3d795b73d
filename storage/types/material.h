// Materials: what the values of a label volume stand for once labels are chosen and merged.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <limits>
#include <vector>

namespace voxweld {

// A label's number after merging: its own value unless a map says otherwise.
using Material = std::uint64_t;

// What is around the volume, and all labels that were not chosen. No label stands for it: a map
// cannot name it and a sample of this value is refused.
inline constexpr Material exterior = std::numeric_limits<std::uint64_t>::max();

// What stands for the surface in a list of materials where there is but one.
inline constexpr Material sole_material = 0;

// off: samples are compared with an isovalue. each: one closed mesh for every material. shared: one
// complex of all of them, each polygon between two.
enum class LabelMode : std::uint8_t { off, each, shared };

// What a polygon separates: its normal points out of `inside`, the smaller of the two.
struct MaterialPair {
  Material inside = exterior, outside = exterior;
  friend constexpr auto operator<=>(const MaterialPair&, const MaterialPair&) = default;
};

// The values first .. last, both included.
struct MaterialRange {
  std::uint64_t first = 0, last = 0;
  bool own = false;  // each is a material by its own number, and `material` not looked at
  Material material = exterior;  // or all of them are this one
  friend bool operator==(const MaterialRange&, const MaterialRange&) = default;
};

struct MaterialRules {
  std::vector<MaterialRange> ranges;  // ascending, disjoint
  bool others = true;  // values in no range are materials by their own number; else left out

  Material of(std::uint64_t value) const {
    const auto after =
        std::upper_bound(ranges.begin(), ranges.end(), value,
                         [](std::uint64_t v, const MaterialRange& r) { return v < r.first; });
    if (after != ranges.begin()) {
      const MaterialRange& range = *(after - 1);
      if (value <= range.last) return range.own ? value : range.material;
    }
    return others ? value : exterior;
  }
  friend bool operator==(const MaterialRules&, const MaterialRules&) = default;
};

}  // namespace voxweld
