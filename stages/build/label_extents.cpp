#include "stages/build/label_extents.h"

#include <algorithm>

namespace voxweld {

// Neighbours along x are mostly of one label: a run of them is one box.
void LabelExtents::add_row(const std::uint32_t* row, Index3 first, std::int64_t end) {
  for (Index3 at = first; at.x < end;) {
    const std::uint32_t label = row[at.x - first.x];
    std::int64_t x = at.x + 1;
    while (x < end && row[x - first.x] == label) ++x;
    const Box3 run{at, {x, at.y + 1, at.z + 1}};
    Found& found = found_[label];
    if (found.count == 0) {
      met_.push_back(label);
      found.samples = run;
    } else {
      found.samples = {min(found.samples.lo, run.lo), max(found.samples.hi, run.hi)};
    }
    found.count += x - at.x;
    at.x = x;
  }
}

std::span<const LabelExtent> LabelExtents::find(const HaloBlock& block, const BrickPlace& place,
                                                std::uint32_t labels, std::uint32_t left_out) {
  for (const std::uint32_t label : met_) found_[label] = {};
  met_.clear();
  extents_.clear();
  if (found_.size() < labels) found_.resize(labels);
  // Lattice point u is sample u - 1.
  const std::int64_t side = std::int64_t{1} << place.level;
  const Box3 of_signs{place.origin - splat(2), place.origin + splat(side + 1)};
  const Box3 of_cells{place.origin - splat(1), place.origin + splat(side)};
  const Box3 held = intersect(of_signs, block.samples);
  if (held.empty()) return extents_;
  const auto* data = reinterpret_cast<const std::uint32_t*>(block.data);
  for (std::int64_t z = held.lo.z; z < held.hi.z; ++z)
    for (std::int64_t y = held.lo.y; y < held.hi.y; ++y) {
      const Index3 d = Index3{held.lo.x, y, z} - block.samples.lo;
      add_row(data + d.z * block.slice + d.y * block.row + d.x, {held.lo.x, y, z}, held.hi.x);
    }
  std::sort(met_.begin(), met_.end());
  for (const std::uint32_t label : met_) {
    const Found& found = found_[label];
    if (label == left_out || intersect(found.samples, of_cells).empty()) continue;
    extents_.push_back({label, found.samples, found.count == of_signs.count()});
  }
  return extents_;
}

}  // namespace voxweld
