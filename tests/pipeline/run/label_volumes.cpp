#include "tests/pipeline/run/label_volumes.h"

#include <cstring>

namespace voxweld::testing {
namespace {

void append(RawVolume& volume, std::uint64_t label) {
  for (std::size_t i = 0; i < sample_bytes(volume.type); ++i)
    volume.samples.push_back(static_cast<std::byte>(label >> 8 * i & 255));
}

}  // namespace

RawVolume ball_labels(SampleType type, Index3 size) {
  RawVolume volume{size, type, {}, 0};
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y)
      for (std::int64_t x = 0; x < size.x; ++x) {
        const Index3 at{x, y, z}, cell{x / 16, y / 16, z / 16};
        const Index3 d = at - cell * 16 - splat(8);
        const bool in = d.x * d.x + d.y * d.y + d.z * d.z < 81;
        std::uint64_t label =
            in ? static_cast<std::uint64_t>(1 + cell.x + 10 * cell.y + 100 * cell.z) : 0;
        if (sample_bytes(type) == 8 && in) label += std::uint64_t{1} << 40;
        append(volume, label);
      }
  return volume;
}

RawVolume cell_labels(Index3 size, std::uint32_t labels, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> one(0, 1);
  std::vector<Vec3> centres;
  for (std::uint32_t i = 0; i < labels; ++i)
    centres.push_back({one(random) * static_cast<double>(size.x),
                       one(random) * static_cast<double>(size.y),
                       one(random) * static_cast<double>(size.z)});
  RawVolume volume{size, SampleType::u16, {}, 0};
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y)
      for (std::int64_t x = 0; x < size.x; ++x) {
        const Vec3 at{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        std::uint32_t nearest = 0;
        for (std::uint32_t i = 1; i < labels; ++i) {
          const Vec3 d = centres[i] - at, best = centres[nearest] - at;
          if (dot(d, d) < dot(best, best)) nearest = i;
        }
        const bool is_noise = one(random) < noise;
        append(volume, is_noise ? random() % (labels + 1) : nearest + 1);
      }
  return volume;
}

std::set<std::uint64_t> labels_of(const RawVolume& volume) {
  std::set<std::uint64_t> labels;
  const std::size_t width = sample_bytes(volume.type);
  for (std::size_t at = 0; at < volume.samples.size(); at += width) {
    std::uint64_t label = 0;
    std::memcpy(&label, volume.samples.data() + at, width);
    labels.insert(label);
  }
  return labels;
}

}  // namespace voxweld::testing
