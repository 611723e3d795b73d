// Small volumes with connected pieces, and what is left of them found by plain flood fill.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "storage/types/box.h"
#include "storage/types/sample_type.h"
#include "storage/types/volume.h"

namespace voxweld::testing {

using Pattern = std::function<bool(Index3)>;

inline std::size_t index_in(Index3 size, Index3 p) {
  return static_cast<std::size_t>(p.x + size.x * (p.y + size.y * p.z));
}

// A volume in memory.
class HeldVolume : public SampleSource {
 public:
  HeldVolume(SampleType type, Index3 size) {
    info_.type = type;
    info_.geometry.size = size;
    samples.resize(static_cast<std::size_t>(size.x * size.y * size.z) * sample_bytes(type));
  }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override {
    const std::size_t bytes = sample_bytes(info_.type);
    each_index(box, [&](Index3 p) {
      std::memcpy(out, &samples[index_in(info_.geometry.size, p) * bytes], bytes);
      out += bytes;
    });
  }
  std::vector<std::byte> samples;

 protected:
  VolumeInfo info_;
};

// Samples of the pattern lie in [100, 120], the others in [0, 90].
inline HeldVolume held_volume(SampleType type, Index3 size, const Pattern& inside, unsigned seed) {
  HeldVolume volume(type, size);
  std::mt19937 random(seed);
  dispatch_sample_type(type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    each_index(size, [&](Index3 p) {
      const auto dice = random();
      const T value = static_cast<T>(inside(p) ? 100 + dice % 21 : dice % 91);
      std::memcpy(&volume.samples[index_in(size, p) * sizeof value], &value, sizeof value);
    });
  });
  return volume;
}

inline Pattern noise(double density, unsigned seed) {
  return [density, seed](Index3 p) {
    std::uint64_t x = seed + static_cast<std::uint64_t>(p.x + 1009 * p.y + 1000003 * p.z);
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9U + 0x9e3779b97f4a7c15U;
    x = (x ^ x >> 27) * 0x94d049bb133111ebU;
    return static_cast<double>((x ^ x >> 31) >> 11) < density * 0x1p53;
  };
}

struct FloodPiece {
  std::uint64_t samples = 0, first = 0;
  bool border = false;
};
struct FloodPieces {
  std::vector<std::uint32_t> labels;  // from 1; 0: not of interest
  std::vector<FloodPiece> pieces;     // in order of their first samples
};

inline FloodPieces flood(Index3 size, const Pattern& wanted) {
  FloodPieces found;
  const Box3 all{{}, size};
  found.labels.resize(static_cast<std::size_t>(all.count()));
  each_index(size, [&](Index3 seed) {
    if (!wanted(seed) || found.labels[index_in(size, seed)] != 0) return;
    const auto label = static_cast<std::uint32_t>(found.pieces.size() + 1);
    FloodPiece piece{0, index_in(size, seed), false};
    std::vector<Index3> open{seed};
    found.labels[index_in(size, seed)] = label;
    while (!open.empty()) {
      const Index3 p = open.back();
      open.pop_back();
      ++piece.samples;
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          Index3 q = p;
          q[axis] += step;
          if (!all.contains(q)) {
            piece.border = true;
          } else if (wanted(q) && found.labels[index_in(size, q)] == 0) {
            found.labels[index_in(size, q)] = label;
            open.push_back(q);
          }
        }
    }
    found.pieces.push_back(piece);
  });
  return found;
}

}  // namespace voxweld::testing
