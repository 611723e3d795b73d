// The first bytes of a Draco buffer, checked before Draco allocates by what they state.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace voxweld {

// FormatError, starting with `where`, unless the buffer starts as a Draco mesh of bitstream 2.2
// without metadata (what Draco 1.4 and later write) whose stated counts are plausible for its size.
void check_draco_header(std::span<const std::byte> bytes, const std::string& where);

}  // namespace voxweld
