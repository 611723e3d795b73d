// What writing and reading glTF binaries agree on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace voxweld::glb {

using Json = nlohmann::ordered_json;

inline constexpr std::uint32_t magic = 0x46546c67;       // "glTF"
inline constexpr std::uint32_t json_chunk = 0x4e4f534a;  // "JSON"
inline constexpr std::uint32_t bin_chunk = 0x004e4942;   // "BIN\0"
inline constexpr std::size_t header_size = 12, chunk_header_size = 8;
inline constexpr const char* draco_extension = "KHR_draco_mesh_compression";

}  // namespace voxweld::glb
