// What writing and reading glTF binaries agree on.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace voxweld::glb {

using Json = nlohmann::ordered_json;

inline constexpr std::uint32_t magic = 0x46546c67;       // "glTF"
inline constexpr std::uint32_t json_chunk = 0x4e4f534a;  // "JSON"
inline constexpr std::uint32_t bin_chunk = 0x004e4942;   // "BIN\0"
inline constexpr std::size_t header_size = 12, chunk_header_size = 8;
inline constexpr const char* draco_extension = "KHR_draco_mesh_compression";
inline constexpr const char* meshopt_extension = "EXT_meshopt_compression";
inline constexpr const char* quantization_extension = "KHR_mesh_quantization";
inline constexpr int component_float = 5126, component_uint32 = 5125;
inline constexpr int component_uint8 = 5121, component_int16 = 5122, component_uint16 = 5123;

// The lowest and the highest of at least one.
inline std::pair<std::array<float, 3>, std::array<float, 3>> bounds_of(
    const std::vector<std::array<float, 3>>& positions) {
  std::array<float, 3> lo = positions.at(0), hi = lo;
  for (const auto& p : positions)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], p[axis]);
      hi[axis] = std::max(hi[axis], p[axis]);
    }
  return {lo, hi};
}

}  // namespace voxweld::glb
