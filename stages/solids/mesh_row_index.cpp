#include "stages/solids/mesh_row_index.h"

#include <algorithm>

namespace voxweld {
namespace {

using Rows = MeshRowIndex::Rows;

Rows bins(const Rows& rows, int shift) {
  Rows found;
  for (std::size_t a = 0; a < 2; ++a) {
    found.lo[a] = rows.lo[a] >> shift;
    found.hi[a] = ((rows.hi[a] - 1) >> shift) + 1;
  }
  return found;
}

// In doubles, which do not overflow; the limits they are held to are far below 2^53.
double count(const Rows& rows) {
  return static_cast<double>(rows.hi[0] - rows.lo[0]) *
         static_cast<double>(rows.hi[1] - rows.lo[1]);
}

Rows hull(std::span<const Rows> all) {
  Rows found;
  bool any = false;
  for (const Rows& rows : all) {
    if (rows.empty()) continue;
    for (std::size_t a = 0; a < 2; ++a) {
      found.lo[a] = any ? std::min(found.lo[a], rows.lo[a]) : rows.lo[a];
      found.hi[a] = any ? std::max(found.hi[a], rows.hi[a]) : rows.hi[a];
    }
    any = true;
  }
  return found;
}

// The finest bins of which there are at most twice as many as triangles, and which list each
// triangle four times on average.
int choose_shift(std::span<const Rows> reached, const Rows& all) {
  constexpr double spare = 64;
  const auto triangles = static_cast<double>(reached.size());
  for (int shift = 0;; ++shift) {
    const double bin_count = count(bins(all, shift));
    if (bin_count > 2 * triangles + spare) continue;
    double listed = 0;
    for (const Rows& rows : reached)
      if (!rows.empty()) listed += count(bins(rows, shift));
    if (listed <= 4 * triangles + spare || bin_count <= 1) return shift;
  }
}

}  // namespace

MeshRowIndex::MeshRowIndex(std::span<const Rows> reached) {
  const Rows all = hull(reached);
  if (all.empty()) return;
  shift_ = choose_shift(reached, all);
  bins_ = bins(all, shift_);
  const std::int64_t width = bins_.hi[0] - bins_.lo[0];
  first_.assign(static_cast<std::size_t>(width * (bins_.hi[1] - bins_.lo[1])) + 1, 0);
  const auto each_listed = [&](auto&& f) {
    for (std::size_t i = 0; i < reached.size(); ++i) {
      if (reached[i].empty()) continue;
      const Rows of_one = bins_of(reached[i]);
      for (std::int64_t v = of_one.lo[1]; v < of_one.hi[1]; ++v)
        for (std::int64_t u = of_one.lo[0]; u < of_one.hi[0]; ++u)
          f(i, static_cast<std::size_t>((v - bins_.lo[1]) * width + u - bins_.lo[0]));
    }
  };
  each_listed([&](std::size_t, std::size_t bin) { ++first_[bin]; });
  std::uint32_t end = 0;
  for (std::uint32_t& first : first_) first = end += first;
  triangles_.resize(end);
  // Filled from each list's end, so that first_ comes to stand on its beginning.
  each_listed([&](std::size_t i, std::size_t bin) {
    triangles_[--first_[bin]] = static_cast<std::uint32_t>(i);
  });
}

Rows MeshRowIndex::bins_of(const Rows& rows) const {
  return bins(rows, shift_);
}

std::span<const std::uint32_t> MeshRowIndex::list(std::int64_t bin_u, std::int64_t bin_v) const {
  const auto bin = static_cast<std::size_t>((bin_v - bins_.lo[1]) * (bins_.hi[0] - bins_.lo[0]) +
                                            bin_u - bins_.lo[0]);
  return std::span(triangles_).subspan(first_[bin], first_[bin + 1] - first_[bin]);
}

std::span<const std::uint32_t> MeshRowIndex::at(std::int64_t u, std::int64_t v) const {
  const std::int64_t bin_u = u >> shift_, bin_v = v >> shift_;
  if (bin_u < bins_.lo[0] || bin_u >= bins_.hi[0] || bin_v < bins_.lo[1] || bin_v >= bins_.hi[1])
    return {};
  return list(bin_u, bin_v);
}

}  // namespace voxweld
