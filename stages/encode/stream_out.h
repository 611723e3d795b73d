// What streams of meshes are written with.
#pragma once

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "stages/encode/byte_sink.h"
#include "storage/types/leaf_vertex.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

// Gathers small writes.
class StreamOut {
 public:
  explicit StreamOut(const ByteSink& sink) : sink_(sink) { bytes_.reserve(full + 4096); }

  template <class T>
  void put(const T& value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
    if (bytes_.size() >= full) flush();
  }
  template <class... Args>
  void text(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(line_), format, std::forward<Args>(args)...);
    const auto* const begin = reinterpret_cast<const std::byte*>(line_.data());
    bytes_.insert(bytes_.end(), begin, begin + line_.size());
    line_.clear();
    if (bytes_.size() >= full) flush();
  }
  void flush() {
    sink_(bytes_);
    bytes_.clear();
  }

 private:
  static constexpr std::size_t full = std::size_t{1} << 18;
  const ByteSink& sink_;
  std::vector<std::byte> bytes_;
  fmt::memory_buffer line_;
};

using Floats = std::array<float, 3>;

inline Floats as_floats(Vec3 v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Zero where they cancel out.
inline Floats mean_direction(const std::array<PackedNormal, max_clusters>& normals) {
  Vec3 sum{};
  for (const PackedNormal normal : normals)
    if (normal != no_normal) sum = sum + unpack_normal(normal);
  const double length = std::sqrt(dot(sum, sum));
  return length > 1e-6 ? as_floats(sum * (1 / length)) : Floats{};
}

}  // namespace voxweld
