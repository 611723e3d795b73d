// CRC-32C (Castagnoli), the checksum of Zarr's crc32c codec: reflected polynomial 0x82f63b78,
// initial value and final inversion 0xffffffff (RFC 3720, appendix B.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace voxweld {

// By the processor's instruction where the program is built for one, else by tables.
std::uint32_t crc32c(std::span<const std::byte> data);

}  // namespace voxweld
