// Which triangles the rows of samples along one axis may meet: lists of triangles by square bins of
// rows, one after the other in one array.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/box.h"

namespace voxweld {

// The two axes across each axis, the lower first.
inline constexpr std::array<std::array<int, 2>, 3> axes_across = {{{1, 2}, {0, 2}, {0, 1}}};

class MeshRowIndex {
 public:
  // Half-open, in samples, on the two axes across.
  struct Rows {
    std::array<std::int64_t, 2> lo{}, hi{};
    bool empty() const { return hi[0] <= lo[0] || hi[1] <= lo[1]; }
  };

  MeshRowIndex() = default;
  // reached[i]: the rows that may meet triangle i. Bins are as fine as memory in proportion to the
  // number of triangles lets them be.
  explicit MeshRowIndex(std::span<const Rows> reached);

  // The triangles that the row may meet, and others.
  std::span<const std::uint32_t> at(std::int64_t u, std::int64_t v) const;

  // f(part, triangles): the part of `rows` in each bin, where the bin has triangles.
  template <class F>
  void each_bin(const Rows& rows, F&& f) const;

  std::uint64_t bytes() const {
    return (first_.capacity() + triangles_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  Rows bins_of(const Rows& rows) const;
  std::span<const std::uint32_t> list(std::int64_t bin_u, std::int64_t bin_v) const;

  int shift_ = 0;  // a bin has 2^shift_ rows a side
  Rows bins_;      // that there are
  std::vector<std::uint32_t> first_, triangles_;
};

template <class F>
void MeshRowIndex::each_bin(const Rows& rows, F&& f) const {
  if (rows.empty()) return;
  const Rows wanted = bins_of(rows);
  for (std::int64_t v = std::max(wanted.lo[1], bins_.lo[1]);
       v < std::min(wanted.hi[1], bins_.hi[1]); ++v)
    for (std::int64_t u = std::max(wanted.lo[0], bins_.lo[0]);
         u < std::min(wanted.hi[0], bins_.hi[0]); ++u) {
      const auto triangles = list(u, v);
      if (triangles.empty()) continue;
      const std::array<std::int64_t, 2> bin{u, v};
      Rows part;
      for (std::size_t a = 0; a < 2; ++a) {
        part.lo[a] = std::max(rows.lo[a], bin[a] << shift_);
        part.hi[a] = std::min(rows.hi[a], (bin[a] + 1) << shift_);
      }
      f(part, triangles);
    }
}

}  // namespace voxweld
