// CRC-32C (Castagnoli), the checksum of Zarr's crc32c codec: reflected polynomial 0x82f63b78,
// initial value and final inversion 0xffffffff (RFC 3720, appendix B.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace voxweld {

// Uses the processor's instruction where there is one; the result is the same either way.
std::uint32_t crc32c(std::span<const std::byte> data);

// The path without the instruction, for the other processors and for the test that both agree.
std::uint32_t crc32c_by_table(std::span<const std::byte> data);

}  // namespace voxweld
