// What operator new has given out and not got back, in bytes, in programs this is linked into.
#pragma once

#include <cstdint>

namespace voxweld::testing {

std::uint64_t live_bytes();
// The most there were since the last forget_peak().
std::uint64_t peak_bytes();
void forget_peak();

}  // namespace voxweld::testing
