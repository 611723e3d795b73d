// XXH3 in vectors of 256 bits; the hashes are the same.
#pragma once

#include <cstddef>

#include "storage/support/hash.h"

namespace voxweld {

struct WideHash {
  void (*update)(void* state, const void* data, std::size_t size);  // of an XXH3_state_t
  Hash128 (*hash)(const void* data, std::size_t size);              // of all at once
};

// Null where the processor, or the compiler's target, does not have such vectors.
const WideHash* hash_avx2();

}  // namespace voxweld
