// Samples that are no numbers: they count as outside, and the user hears of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "storage/types/box.h"
#include "storage/types/sample_type.h"

namespace voxweld {

struct NanCount {
  std::uint64_t samples = 0;
  Box3 box;  // the smallest that holds them

  void add(const NanCount& other) {
    if (other.samples == 0) return;
    if (samples == 0) box = other.box;
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = std::min(box.lo[a], other.box.lo[a]);
      box.hi[a] = std::max(box.hi[a], other.box.hi[a]);
    }
    samples += other.samples;
  }
};

// Those of `part` among the samples of `held`, which holds it: native byte order, x fastest, of any
// alignment. Of integers there are none.
inline NanCount count_nans(SampleType type, std::span<const std::byte> samples, const Box3& held,
                           const Box3& part) {
  NanCount found;
  if (type != SampleType::f32 && type != SampleType::f64) return found;
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    const auto is_nan = [](const std::byte* at) {
      T value;
      std::memcpy(&value, at, sizeof value);
      return value != value;
    };
    const Index3 size = held.size();
    const std::int64_t count = part.size().x;
    for (std::int64_t z = part.lo.z; z < part.hi.z; ++z)
      for (std::int64_t y = part.lo.y; y < part.hi.y; ++y) {
        const Index3 at = Index3{part.lo.x, y, z} - held.lo;
        const std::byte* row =
            samples.data() + ((at.z * size.y + at.y) * size.x + at.x) * std::int64_t{sizeof(T)};
        const auto nan_at = [&](std::int64_t i) {
          return is_nan(row + i * std::int64_t{sizeof(T)});
        };
        std::int64_t nans = 0;
        for (std::int64_t i = 0; i < count; ++i) nans += nan_at(i) ? 1 : 0;
        if (nans == 0) continue;
        std::int64_t first = 0, last = count - 1;
        while (!nan_at(first)) ++first;
        while (!nan_at(last)) --last;
        found.add({static_cast<std::uint64_t>(nans),
                   {{part.lo.x + first, y, z}, {part.lo.x + last + 1, y + 1, z + 1}}});
      }
  });
  return found;
}

}  // namespace voxweld
