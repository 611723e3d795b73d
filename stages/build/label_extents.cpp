#include "stages/build/label_extents.h"

#include <algorithm>

namespace voxweld {
namespace {

std::int16_t small(std::int64_t v) {
  return static_cast<std::int16_t>(v);
}

}  // namespace

// Neighbours along x are mostly of one label: a run of them is one box.
void LabelExtents::add_row(const std::uint32_t* row, Index3 first, std::int64_t end) {
  for (Index3 at = first; at.x < end;) {
    const std::uint32_t label = row[at.x - first.x];
    std::int64_t x = at.x + 1;
    while (x < end && row[x - first.x] == label) ++x;
    const std::array<std::int16_t, 3> lo{small(at.x), small(at.y), small(at.z)};
    const std::array<std::int16_t, 3> hi{small(x), small(at.y + 1), small(at.z + 1)};
    Found& found = found_[label];
    if (found.count == 0) {
      met_.push_back(label);
      found.lo = lo;
      found.hi = hi;
    } else {
      for (std::size_t a = 0; a < 3; ++a) {
        found.lo[a] = std::min(found.lo[a], lo[a]);
        found.hi[a] = std::max(found.hi[a], hi[a]);
      }
    }
    found.count += static_cast<std::uint32_t>(x - at.x);
    at.x = x;
  }
}

Box3 LabelExtents::samples(std::uint32_t label) const {
  const Found& f = found_[label];
  return {of_signs_.lo + Index3{f.lo[0], f.lo[1], f.lo[2]},
          of_signs_.lo + Index3{f.hi[0], f.hi[1], f.hi[2]}};
}

std::span<const std::uint32_t> LabelExtents::find(const HaloBlock& block, const BrickPlace& place,
                                                  std::uint32_t labels, std::uint32_t left_out) {
  for (const std::uint32_t label : met_) found_[label] = {};
  met_.clear();
  if (found_.size() < labels) found_.resize(labels);
  // Lattice point u is sample u - 1.
  const std::int64_t side = std::int64_t{1} << place.level;
  of_signs_ = {place.origin - splat(2), place.origin + splat(side + 1)};
  const Box3 of_cells{place.origin - splat(1), place.origin + splat(side)};
  const Box3 held = intersect(of_signs_, block.samples);
  if (held.empty()) return {};
  const auto* data = reinterpret_cast<const std::uint32_t*>(block.data);
  for (std::int64_t z = held.lo.z; z < held.hi.z; ++z)
    for (std::int64_t y = held.lo.y; y < held.hi.y; ++y) {
      const Index3 first{held.lo.x, y, z}, d = first - block.samples.lo;
      add_row(data + d.z * block.slice + d.y * block.row + d.x, first - of_signs_.lo,
              held.hi.x - of_signs_.lo.x);
    }
  std::sort(met_.begin(), met_.end());
  const auto wanted = [&](std::uint32_t label) {
    return label != left_out && !intersect(samples(label), of_cells).empty();
  };
  // Those that are not wanted stay behind the others, to be forgotten by the next call.
  const auto end = std::stable_partition(met_.begin(), met_.end(), wanted);
  return {met_.data(), static_cast<std::size_t>(end - met_.begin())};
}

std::uint64_t LabelExtents::memory_bytes(std::uint64_t samples) {
  return samples * 2 * (sizeof(Found) + sizeof(std::uint32_t));  // vectors may have grown to twice
}

}  // namespace voxweld
