// XXH3 in vectors of 256 bits; the hashes are the same.
#pragma once

#include <cstddef>

namespace voxweld {

// Feeds data to an XXH3_state_t.
using HashUpdate = void (*)(void* state, const void* data, std::size_t size);
// Null where the processor, or the compiler's target, does not have such vectors.
HashUpdate hash_update_avx2();

}  // namespace voxweld
